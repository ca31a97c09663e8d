//! E03xx: types, expressions, calls.

use super::{Code, CodeInfo, Severity};

codes! {
    TYPE_MISMATCH "E0301" Error "a value has the wrong type" "\
Implicit conversions keep every value: INT to DINT, INT to REAL, BYTE to WORD. All others are written, so that a reader sees them: `REAL_TO_INT(x)`.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i : INT; r : REAL; END_VAR\n\
i := r;\n\
END_PROGRAM\n\
```\n";
    OUT_OF_RANGE "E0302" Error "a constant does not fit" "\
A constant must lie in the range of the type that its place asks for.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i : SINT; END_VAR\n\
i := 200;\n\
END_PROGRAM\n\
```\n";
    BAD_BOUNDS "E0303" Error "bounds or lengths are wrong" "\
The lower bound of an array or subrange comes first; a string has 1 to 1048576 characters.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a : ARRAY [5..1] OF INT; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    CYCLIC_TYPE "E0304" Error "a type contains itself" "\
A structure or function block cannot hold itself by value: it would have no size.\n\
\n\
```st\n\
TYPE Node : STRUCT next : Node; END_STRUCT; END_TYPE\n\
PROGRAM Main\n\
VAR n : Node; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    CYCLIC_VALUE "E0305" Error "an initial value depends on itself" "\
Initial values are computed in the order in which they need each other; a cycle has no start.\n\
\n\
```st\n\
VAR_GLOBAL CONSTANT a : INT := b; b : INT := a; END_VAR\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    BAD_BASE_TYPE "E0306" Error "a base type cannot be used" "\
Enumerations and subranges are based on integers or bit strings.\n\
\n\
```st\n\
TYPE Level : REAL (0..10); END_TYPE\n\
PROGRAM Main\n\
VAR x : Level; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    BAD_INITIALISER "E0307" Error "an initial value has the wrong form" "\
Arrays take lists `[1, 2, 3(0)]`, structures and instances named components `(a := 1)`, everything else one value.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a : ARRAY [1..2] OF INT := [1, 2, 3]; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    EMPTY_TYPE "E0308" Error "a structure has no components" "\
Declare at least one component.\n\
\n\
```st\n\
TYPE Nothing : STRUCT END_STRUCT; END_TYPE\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    NOT_CONSTANT "E0309" Error "a constant is needed" "\
Bounds, lengths, labels and initial values are fixed before the program runs.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR n : INT; a : ARRAY [1..n] OF INT; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    WRONG_OPERAND "E0310" Error "an operator does not take this type" "\
Arithmetic needs numbers (or durations), AND OR XOR NOT need BOOL or bit strings, < and > need an order, both sides need a common type.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : BOOL; i : INT; END_VAR\n\
i := i + x;\n\
END_PROGRAM\n\
```\n";
    ZERO_DIVISOR "E0311" Error "division by the constant 0" "\
An integer division by 0 has no result and would stop the program.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i : INT; END_VAR\n\
i := i / 0;\n\
END_PROGRAM\n\
```\n";
    TOO_LARGE "E0312" Error "the variables need too much memory" "\
The memory region of a resource is smaller than 2^31 bytes.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : ARRAY [1..1000000000] OF LINT; END_VAR\n\
a[1] := 1;\n\
b := a;\n\
END_PROGRAM\n\
```\n";
    NO_VALUE "E0313" Error "a call gives no value" "\
Function blocks, actions and functions without result type give no value; use their outputs.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TON; x : BOOL; END_VAR\n\
x := t(IN := TRUE);\n\
END_PROGRAM\n\
```\n";
    NOT_AN_ARRAY "E0314" Error "only arrays are indexed" "\
Square brackets choose an element of an array.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i : INT; END_VAR\n\
i[1] := 2;\n\
END_PROGRAM\n\
```\n";
    WRONG_SUBSCRIPTS "E0315" Error "wrong number of subscripts" "\
Write one subscript per dimension, separated by commas.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a : ARRAY [1..2, 1..3] OF INT; END_VAR\n\
a[1] := 2;\n\
END_PROGRAM\n\
```\n";
    CONSTANT_INDEX "E0316" Error "a constant index is out of bounds" "\
The element does not exist.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a : ARRAY [1..3] OF INT; END_VAR\n\
a[4] := 2;\n\
END_PROGRAM\n\
```\n";
    NO_PARTS "E0317" Error "no such bit or part" "\
Bits and parts (`w.3`, `d.%B0`) exist in BYTE, WORD, DWORD and LWORD, from 0 up.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR w : WORD; END_VAR\n\
w.16 := TRUE;\n\
END_PROGRAM\n\
```\n";
    NOT_A_REFERENCE "E0318" Error "only references are followed" "\
`^` follows REF_TO and POINTER TO; a REFERENCE TO is followed without it.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i : INT; END_VAR\n\
i^ := 1;\n\
END_PROGRAM\n\
```\n";
    NO_REFERENCE "E0319" Error "no reference to a bit" "\
References and VAR_IN_OUT name whole variables; a bit of a word or of %I, %Q, %M has no address of its own.\n\
\n\
```st\n\
FUNCTION_BLOCK Set\n\
VAR_IN_OUT b : BOOL; END_VAR\n\
b := TRUE;\n\
END_FUNCTION_BLOCK\n\
PROGRAM Main\n\
VAR w : WORD; s : Set; END_VAR\n\
s(b := w.3);\n\
END_PROGRAM\n\
```\n";
    ATTEMPT_FAILS "W0319" Warning "an assignment attempt that always gives NULL" "\
`?=` assigns a reference if it refers to something of the target's type, else NULL. Types without inheritance are the same\n\
or never the same, so this statement always assigns NULL.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i : INT; a : REF_TO INT; b : REF_TO REAL; END_VAR\n\
a := REF(i);\n\
b ?= a;\n\
END_PROGRAM\n\
```\n";
    NOT_WRITABLE "E0320" Error "this cannot be assigned" "\
Constants, outputs of instances (from outside), input addresses and whole instances are not assigned.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR CONSTANT limit : INT := 5; END_VAR\n\
limit := 6;\n\
END_PROGRAM\n\
```\n";
    NOT_CALLABLE "E0321" Error "this cannot be called" "\
Functions, instances of function blocks and actions are called. A FUNCTION_BLOCK itself needs an instance, a PROGRAM a task.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : BOOL; END_VAR\n\
TON(IN := x);\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_FUNCTION "E0322" Error "there is no such function or instance" "\
The name is neither a standard function nor a POU or instance of this project.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : REAL; END_VAR\n\
x := SQROOT(2.0);\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_PARAMETER "E0323" Error "there is no such parameter" "\
Arguments name the VAR_INPUT, VAR_OUTPUT and VAR_IN_OUT of the callee.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TON; END_VAR\n\
t(IN := TRUE, TIME := T#1s);\n\
END_PROGRAM\n\
```\n";
    MIXED_ARGUMENTS "E0324" Error "arguments with and without names" "\
In one call all arguments have names, or none has.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
x := LIMIT(0, IN := x, MX := 5);\n\
END_PROGRAM\n\
```\n";
    TOO_MANY_ARGUMENTS "E0325" Error "wrong number of arguments" "\
The callee has another number of parameters.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : REAL; END_VAR\n\
x := SQRT(x, x);\n\
END_PROGRAM\n\
```\n";
    DUPLICATE_ARGUMENT "E0326" Error "a parameter is given twice" "\
Each parameter is given once in a call.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TON; END_VAR\n\
t(IN := TRUE, IN := FALSE);\n\
END_PROGRAM\n\
```\n";
    WRONG_DIRECTION "E0327" Error ":= and => are mixed up" "\
`name := value` gives an input its value, `name => variable` fetches an output.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TON; q : BOOL; END_VAR\n\
t(IN := TRUE, Q := q);\n\
END_PROGRAM\n\
```\n";
    IN_OUT_MISMATCH "E0328" Error "a VAR_IN_OUT has another type" "\
A VAR_IN_OUT is the caller's variable itself, so both have the same type.\n\
\n\
```st\n\
FUNCTION_BLOCK Inc\n\
VAR_IN_OUT n : INT; END_VAR\n\
n := n + 1;\n\
END_FUNCTION_BLOCK\n\
PROGRAM Main\n\
VAR x : DINT; i : Inc; END_VAR\n\
i(n := x);\n\
END_PROGRAM\n\
```\n";
    MISSING_IN_OUT "E0329" Error "a VAR_IN_OUT is not connected" "\
Without the caller's variable it has no memory; connect it in every call.\n\
\n\
```st\n\
FUNCTION_BLOCK Inc\n\
VAR_IN_OUT n : INT; END_VAR\n\
n := n + 1;\n\
END_FUNCTION_BLOCK\n\
PROGRAM Main\n\
VAR i : Inc; END_VAR\n\
i();\n\
END_PROGRAM\n\
```\n";
    OUTSIDE_LOOP "E0330" Error "EXIT or CONTINUE outside of a loop" "\
They belong inside FOR, WHILE or REPEAT.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
EXIT;\n\
END_PROGRAM\n\
```\n";
    CONTROL_VARIABLE "E0331" Error "a FOR variable is assigned in its loop" "\
The loop counts by itself; an assignment would be lost or make the loop endless.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i, n : INT; END_VAR\n\
FOR i := 1 TO 10 DO\n\
\x20 n := n + i;\n\
\x20 i := 10;\n\
END_FOR;\n\
END_PROGRAM\n\
```\n";
    NO_EFFECT "E0332" Error "a statement has no effect" "\
A statement assigns (`:=`), calls or controls. `=` compares.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
x + 5;\n\
END_PROGRAM\n\
```\n";
    CASE_LABEL "E0333" Error "a CASE label is wrong" "\
Labels are constants of the selector's type, each value stands once, ranges are not empty.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
CASE x OF\n\
\x20 1..5: x := 0;\n\
\x20 3: x := 1;\n\
END_CASE;\n\
END_PROGRAM\n\
```\n";
    ZERO_STEP "E0334" Error "FOR with step 0" "\
The loop would never end.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i, n : INT; END_VAR\n\
FOR i := 1 TO 10 BY 0 DO n := n + 1; END_FOR;\n\
END_PROGRAM\n\
```\n";
    RECURSION "E0335" Error "POUs call each other in a circle" "\
IEC 61131-3 forbids recursion: memory and time of a program are bounded.\n\
\n\
```st\n\
FUNCTION F : INT\n\
VAR_INPUT n : INT; END_VAR\n\
F := n * F(n := n - 1);\n\
END_FUNCTION\n\
```\n";
    LITERAL_VALUE "E0336" Error "a literal is wrong" "\
A literal's text must be a value of its type.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TIME; END_VAR\n\
t := T#5s10m;\n\
END_PROGRAM\n\
```\n";
    MISSING_ARGUMENT "E0337" Error "an argument is missing" "\
A standard function needs all of its inputs.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; END_VAR\n\
x := LIMIT(0, x);\n\
END_PROGRAM\n\
```\n";
    REFERENCE_TO "E0338" Error "REFERENCE TO belongs to profile codesys" "\
REFERENCE TO, which is followed wherever it is named and bound with REF=, is a form of CODESYS. The standard's reference is\n\
REF_TO: bound with `r := REF(x)`, followed with `r^`.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x : INT; r : REFERENCE TO INT := x; END_VAR\n\
r := 1;\n\
END_PROGRAM\n\
```\n";
    NOT_YET "E0399" Error "not implemented yet" "\
plcc knows this part of the language but cannot compile it yet.\n";
    LAX_CONVERSION "W0340" Warning "accepted by profile codesys only" "\
Profile strict refuses this: it can lose information, or mixes numbers and bit strings.\n\
\n\
```st codesys\n\
PROGRAM Main\n\
VAR i : INT; r : REAL := 2.5; END_VAR\n\
i := r;\n\
END_PROGRAM\n\
```\n";
    LOSES_PRECISION "W0341" Warning "an integer may lose digits in a real" "\
REAL holds integers up to 2^24 exactly, LREAL up to 2^53.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT d : DINT; END_VAR\n\
VAR r : REAL; END_VAR\n\
r := d;\n\
END_PROGRAM\n\
```\n";
    WRAPS_FIRST "W0342" Warning "the operation is done before it is widened" "\
Each operation is done at the type of its operands and wraps there; a wider target does not help.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b : INT; END_VAR\n\
VAR d : DINT; END_VAR\n\
d := a * b;\n\
END_PROGRAM\n\
```\n";
    STRING_CUT "W0343" Warning "a text is longer than its variable" "\
The characters that do not fit are cut off.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_OUTPUT s : STRING[3] := 'abcdef'; END_VAR\n\
\n\
END_PROGRAM\n\
```\n";
    REAL_EQUALITY "W0344" Warning "reals are compared with = or <>" "\
Rounding makes equality of computed reals a matter of luck.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b : REAL; END_VAR\n\
VAR q : BOOL; END_VAR\n\
q := a = b;\n\
END_PROGRAM\n\
```\n";
    BITS_AS_NUMBER "W0345" Warning "a bit string is used as a number" "\
It counts by its value; a conversion says that this is meant.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR w : WORD := 1; a : ARRAY [0..3] OF INT; END_VAR\n\
a[w] := 1;\n\
END_PROGRAM\n\
```\n";
    INPUT_WRITTEN "W0346" Warning "an input is assigned" "\
The value of a VAR_INPUT comes from the caller; %I comes from the process image.\n\
\n\
```st\n\
FUNCTION_BLOCK Fb\n\
VAR_INPUT x : INT; END_VAR\n\
x := x + 1;\n\
END_FUNCTION_BLOCK\n\
```\n";
    LAX_CONTROL_VARIABLE "W0347" Warning "a FOR variable is assigned in its loop" "\
Profile codesys accepts this; the loop then counts like the WHILE loop it abbreviates.\n\
\n\
```st codesys\n\
PROGRAM Main\n\
VAR i, n : INT; END_VAR\n\
FOR i := 1 TO 10 DO\n\
\x20 n := n + i;\n\
\x20 i := 10;\n\
END_FOR;\n\
END_PROGRAM\n\
```\n";
    SHARED_CONTROL_VARIABLE "W0348" Warning "nested FOR loops share their variable" "\
The inner loop changes what the outer body sees; the outer count is not affected.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR i, n : INT; END_VAR\n\
FOR i := 1 TO 3 DO\n\
\x20 FOR i := 1 TO 2 DO n := n + 1; END_FOR;\n\
END_FOR;\n\
END_PROGRAM\n\
```\n";
    CASE_INCOMPLETE "W0349" Warning "CASE does not handle every enumeration value" "\
Values without a label do nothing; add them, or an ELSE that says so.\n\
\n\
```st\n\
TYPE Temp : (Cold, Warm, Hot); END_TYPE\n\
PROGRAM Main\n\
VAR_INPUT t : Temp; END_VAR\n\
VAR x : INT; END_VAR\n\
CASE t OF\n\
\x20 Cold: x := 1;\n\
\x20 Warm: x := 2;\n\
END_CASE;\n\
END_PROGRAM\n\
```\n";
    TEXTBOOK_PIN "H0350" Hint "a pin has another name in the standard" "\
SR has the pins S1, R, Q1 and RS has S, R1, Q1: the 1 marks the dominant input. Textbooks write S, R and Q; plcc takes them too.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT b : BOOL; END_VAR\n\
VAR latch : SR; END_VAR\n\
latch(S := b, R := FALSE);\n\
END_PROGRAM\n\
```\n";
    UNUSED_VARIABLE "W0351" Warning "a variable is never used" "\
No statement of its POU, its actions or another declaration names the variable.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR spare : INT; END_VAR\n\
VAR_OUTPUT lamp : BOOL; END_VAR\n\
lamp := TRUE;\n\
END_PROGRAM\n\
```\n";
    NEVER_WRITTEN "W0352" Warning "a variable is never written" "\
It keeps its initial value for ever: an assignment was forgotten, or it is meant to be a CONSTANT, an input (VAR_INPUT)\n\
or a located variable (AT %IX0.0). Outputs that nobody assigns are reported too.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR limit : INT; END_VAR\n\
VAR_INPUT level : INT; END_VAR\n\
VAR_OUTPUT alarm : BOOL; END_VAR\n\
alarm := level > limit;\n\
END_PROGRAM\n\
```\n";
    NO_RESULT "W0353" Warning "a function never assigns its result" "\
A function gives its result by an assignment to its own name; without one it always gives the initial value of its type.\n\
\n\
```st\n\
FUNCTION Twice : INT\n\
VAR_INPUT x : INT; END_VAR\n\
VAR_OUTPUT y : INT; END_VAR\n\
y := 2 * x;\n\
END_FUNCTION\n\
```\n";
    UNREACHABLE "W0354" Warning "a statement is never reached" "\
What stands before it always goes elsewhere: RETURN, EXIT, CONTINUE, a jump, or a loop that never ends.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_OUTPUT a : INT; END_VAR\n\
a := 1;\n\
RETURN;\n\
a := 2;\n\
END_PROGRAM\n\
```\n";
    CALLED_TWICE "W0355" Warning "an instance is called twice in one cycle" "\
Timers measure, counters count and edges are found between two calls of an instance. Called at two places of one way\n\
through the body, the second call sees what the first one left.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR t : TON; END_VAR\n\
VAR_INPUT a, b : BOOL; END_VAR\n\
VAR_OUTPUT x, y : BOOL; END_VAR\n\
t(IN := a, PT := T#1s, Q => x);\n\
t(IN := b, PT := T#1s, Q => y);\n\
END_PROGRAM\n\
```\n";
}
