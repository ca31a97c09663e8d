//! E02xx: names and declarations.

use super::{Code, CodeInfo, Severity};

codes! {
    UNKNOWN_NAME "E0201" Error "a name is not declared" "\
Every variable is declared in a VAR section of its POU or as VAR_GLOBAL. Names do not differ by case.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR level : INT; END_VAR\n\
levl := 3;\n\
END_PROGRAM\n\
```\n";
    DUPLICATE_NAME "E0202" Error "a name is declared twice" "\
Inside one scope a name stands for one thing; upper and lower case do not differ.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a : INT; A : REAL; END_VAR\n\
a := 1;\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_TYPE "E0203" Error "a type is not known" "\
A type is elementary (INT, REAL ...), declared in a TYPE block, or a function block. Programs and functions are no types.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INTEGER; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_MEMBER "E0204" Error "a component does not exist" "\
Structures have the components of their declaration; instances of function blocks show their inputs and outputs; enumerations their values.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TON; END_VAR\n\
t(IN := TRUE, PT := T#1s);\n\
IF t.Done THEN RETURN; END_IF;\n\
END_PROGRAM\n\
```\n";
    AMBIGUOUS_NAME "E0205" Error "several enumerations have this value" "\
Write the type in front of the value: `Color#Red`.\n\
\n\
```st\n\
TYPE Lamp : (Red, Green); END_TYPE\n\
TYPE Wine : (Red, White); END_TYPE\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
IF Red = Red THEN x := 1; END_IF;\n\
END_PROGRAM\n\
```\n";
    NOT_A_VARIABLE "E0206" Error "a variable is needed" "\
Only variables, their components and elements have a place in memory. POUs, types and expressions have none.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
TON := x;\n\
END_PROGRAM\n\
```\n";
    INNER_VARIABLE "E0207" Error "an inner variable is not visible" "\
From outside, an instance shows its VAR_INPUT and VAR_OUTPUT only.\n\
\n\
```st\n\
FUNCTION_BLOCK Pump\n\
VAR hours : INT; END_VAR\n\
hours := hours + 1;\n\
END_FUNCTION_BLOCK\n\
PROGRAM Main\n\
VAR p : Pump; x : INT; END_VAR\n\
x := p.hours;\n\
END_PROGRAM\n\
```\n";
    EXTERNAL_MISSING "E0208" Error "VAR_EXTERNAL without VAR_GLOBAL" "\
VAR_EXTERNAL makes a global variable visible; somewhere a VAR_GLOBAL of this name must declare it.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_EXTERNAL speed : INT; END_VAR\n\
speed := 1;\n\
END_PROGRAM\n\
```\n";
    EXTERNAL_MISMATCH "E0209" Error "VAR_EXTERNAL and VAR_GLOBAL differ" "\
Both declarations name the same variable and must give it the same type.\n\
\n\
```st\n\
VAR_GLOBAL speed : INT; END_VAR\n\
PROGRAM Main\n\
VAR_EXTERNAL speed : REAL; END_VAR\n\
speed := 1.0;\n\
END_PROGRAM\n\
```\n";
    MISPLACED_SECTION "E0210" Error "a variable section stands in the wrong place" "\
VAR_GLOBAL belongs to the top level of a file or a CONFIGURATION; the other sections belong to a POU.\n\
\n\
```st\n\
VAR_INPUT x : INT; END_VAR\n\
PROGRAM Main\n\
VAR y : INT; END_VAR\n\
y := 1;\n\
END_PROGRAM\n\
```\n";
    ACTION_WITHOUT_POU "E0211" Error "an ACTION belongs to no POU" "\
Actions are part of a PROGRAM or FUNCTION_BLOCK and work on its variables.\n\
\n\
```st\n\
FUNCTION F : INT\n\
F := 1;\n\
ACTION Act : F := 2; END_ACTION\n\
END_FUNCTION\n\
```\n";
    BAD_ADDRESS "E0213" Error "an address is wrong" "\
A located variable is declared `AT %` with an area (I, Q, M), a size (X B W D L) and a number; for X a bit may follow. The number counts units of its own size: `%MW1` is bytes 2 and 3.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x AT %IX0.9 : BOOL; END_VAR\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_LABEL "E0214" Error "a jump target does not exist" "\
JMP goes to a label of the same body.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
JMP finish;\n\
x := 1;\n\
END_PROGRAM\n\
```\n";
    HIDES_STANDARD "H0215" Hint "a standard function or block is hidden" "\
A POU of your own with the name of a standard one is used instead of it everywhere in the project.\n\
\n\
```st\n\
FUNCTION_BLOCK TON\n\
VAR_INPUT x : BOOL; END_VAR\n\
END_FUNCTION_BLOCK\n\
```\n";
    GLOBAL_WITHOUT_EXTERNAL "H0216" Hint "a global is used without VAR_EXTERNAL" "\
The standard wants a global variable to be declared VAR_EXTERNAL where it is used. plcc finds it without.\n\
\n\
```st\n\
VAR_GLOBAL speed : INT; END_VAR\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
x := speed;\n\
END_PROGRAM\n\
```\n";
    UNUSED_LABEL "W0217" Warning "no jump leads to a label" "\
The label has no use.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
again:\n\
x := 1;\n\
END_PROGRAM\n\
```\n";
    FOREIGN_CODE "W0219" Warning "foreign code is not executed" "\
A pragma in a body that holds statements of another language (there is a `;` in it, or a `=` that is no `:=`) was meant for another\n\
compiler. plcc skips it: variables that only such code writes keep their initial values.\n\
\n\
```st\n\
FUNCTION Now : DINT\n\
{Now = time(NULL);}\n\
END_FUNCTION\n\
```\n";
    BAD_EDGE "E0218" Error "R_EDGE or F_EDGE in the wrong place" "\
A VAR_INPUT of type BOOL may be declared R_EDGE or F_EDGE: inside its POU it is TRUE only in the call that saw the edge. What was before must be remembered, which a FUNCTION_BLOCK or PROGRAM can and a FUNCTION cannot.\n\
\n\
```st\n\
FUNCTION Count : INT\n\
VAR_INPUT pulse : BOOL R_EDGE; END_VAR\n\
IF pulse THEN Count := 1; END_IF;\n\
END_FUNCTION\n\
```\n";
}
