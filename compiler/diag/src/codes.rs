//! The code table: one row per cause. Numbers by phase: E01xx syntax, E02xx names, E03xx types and calls, E04xx IL and SFC,
//! E05xx configuration and project, E06xx run time; W likewise for warnings, H for hints.

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A hint on style or on another reading; changes nothing.
    Hint,
    /// Compiles, but is probably not meant so.
    Warning,
    /// No code is generated.
    Error,
}

/// A row of the table.
#[derive(Debug)]
pub struct CodeInfo {
    /// `E0301`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// A few words, for lists.
    pub title: &'static str,
    /// The page behind `plcc explain`. Its first fenced block is a complete source that yields exactly this code
    /// (a test compiles it); codes of the run time and of the driver have none.
    pub page: &'static str,
}

/// A reference to a row.
#[derive(Clone, Copy)]
pub struct Code(&'static CodeInfo);

impl Code {
    /// The row.
    pub fn info(self) -> &'static CodeInfo {
        self.0
    }
}

impl PartialEq for Code {
    fn eq(&self, other: &Self) -> bool {
        self.0.code == other.0.code
    }
}
impl Eq for Code {}
impl std::fmt::Debug for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.code)
    }
}
impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.code)
    }
}

/// The row with this code, in any case.
pub fn find(code: &str) -> Option<&'static CodeInfo> {
    ALL.iter().map(|c| c.info()).find(|c| c.code.eq_ignore_ascii_case(code))
}

macro_rules! codes {
    ($($name:ident $code:literal $severity:ident $title:literal $page:literal;)*) => {
        $(
            #[doc = concat!($code, ": ", $title)]
            pub const $name: Code = Code(&CodeInfo {
                code: $code, severity: Severity::$severity, title: $title, page: $page,
            });
        )*
        /// Every row, in order.
        pub const ALL: &[Code] = &[$($name),*];
    };
}

// A page says what is wrong, why it matters, and what to write instead; its first ```st block shows the mistake.
codes! {
    // ---- E01xx: lexical and syntax ----
    UNCLOSED_BLOCK "E0101" Error "a block is not closed" "\
A construct that opens with a keyword (IF, FOR, VAR, PROGRAM ...) closes with its own END word. Here an outer construct ends, or the \
file does, while the inner one is still open.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THEN\n  x := 0;\nEND_PROGRAM\n```\n\n\
Write the missing END word where the block should end.\n";
    STRAY_END "E0102" Error "an END word closes nothing" "\
An END word stands where no construct of its kind is open: it was written twice, or its opening word is missing.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := 1;\nEND_IF;\nEND_PROGRAM\n```\n\n\
Remove the END word, or write the opening word where the construct begins.\n";
    WRONG_END "E0103" Error "a construct is closed by the END word of another" "\
Each construct has its own END word. Here one is closed by the word of a different construct.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THEN\n  x := 0;\nEND_WHILE;\nEND_PROGRAM\n```\n\n\
Write the END word that belongs to the opening word.\n";
    SPLIT_END "E0104" Error "an END word is spelled in two parts" "\
END words are one word with an underline: END_IF, not END-IF, END IF or ENDIF.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THEN\n  x := 0;\nEND-IF;\nEND_PROGRAM\n```\n\n\
Write `END_IF`.\n";
    ELSE_IF "E0105" Error "ELSE IF instead of ELSIF" "\
`ELSE IF` opens a second IF inside the ELSE branch, which needs an END_IF of its own. A further condition of the same IF is ELSIF.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 5 THEN\n  x := 0;\nELSE IF x > 3 THEN\n  x := 1;\nEND_IF;\nEND_PROGRAM\n```\n\n\
Write `ELSIF x > 3 THEN`.\n";
    BAD_CHARACTER "E0106" Error "a character that has no meaning" "\
Outside of comments and strings a program consists of ASCII letters, digits, underlines and the signs of the language.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := 1 @;\nEND_PROGRAM\n```\n\n\
Remove the character.\n";
    UNCLOSED_COMMENT "E0107" Error "a comment or pragma is not closed" "\
A comment `(* *)` or `/* */` and a pragma `{ }` reach to their closing sign. `(* *)` nest: each `(*` inside needs its own `*)`.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM\n(* the end\n```\n\n\
Write the closing sign where the comment ends.\n";
    UNCLOSED_STRING "E0108" Error "a string is not closed on its line" "\
A string literal ends on the line on which it starts. A line feed inside a text is written `$N`.\n\n```st\nPROGRAM Main\nVAR s : STRING; END_VAR\ns := 'abc\n;\nEND_PROGRAM\n```\n\n\
Write the closing quote.\n";
    SMART_QUOTES "E0109" Error "typographic quotes" "\
Word processors and web pages replace straight quotes by typographic ones, which are no quotes in a program.\n\n```st\nPROGRAM Main\nVAR s : STRING; END_VAR\ns := ‘abc’;\nEND_PROGRAM\n```\n\n\
Write `'abc'`.\n";
    BAD_LITERAL "E0110" Error "a literal or an address is not well formed" "\
A number with letters behind it, a duration with an unknown unit, an address with unknown letters, or a type prefix without a value.\n\n```st\nPROGRAM Main\nVAR t : TIME; END_VAR\nt := T#1min30s;\nEND_PROGRAM\n```\n\n\
The units of a duration are d, h, m, s, ms, us, ns: `T#1m30s`.\n";
    FOREIGN_OPERATOR "E0111" Error "an operator of another language" "\
`==`, `!=`, `&&`, `||` and `!` are written `=`, `<>`, AND, OR and NOT in IEC 61131-3.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x == 1 THEN\n  x := 2;\nEND_IF;\nEND_PROGRAM\n```\n\n\
Write `x = 1`.\n";
    SPLIT_ASSIGN "E0112" Error "the sign `:=` is misspelled" "\
`:=` is one sign: no blank may stand inside, and no second `:` before it.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx : = 1;\nEND_PROGRAM\n```\n\n\
Write `:=`.\n";
    EQUALS_FOR_ASSIGN "E0113" Error "`=` where `:=` is meant" "\
`=` compares two values, `:=` assigns. A comparison alone is no statement.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx = 1;\nEND_PROGRAM\n```\n\n\
Write `x := 1;`.\n";
    MISSING_SEMICOLON "E0114" Error "a `;` is missing" "\
Each statement and each declaration ends with `;`.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := 1\nx := 2;\nEND_PROGRAM\n```\n\n\
Write `;` behind the statement.\n";
    MISSING_WORD "E0115" Error "a word or sign of a construct is missing" "\
IF and ELSIF need THEN, FOR and WHILE need DO, CASE needs OF, an opening parenthesis needs a closing one, a declaration needs `:`.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0\n  x := 1;\nEND_IF;\nEND_PROGRAM\n```\n\n\
Write the missing word.\n";
    MISSING_OPERAND "E0116" Error "an expression or a type is missing" "\
An operator, an assignment, a condition or a declaration stands without what belongs behind it.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := ;\nEND_PROGRAM\n```\n\n\
Write the missing expression or type.\n";
    UNEXPECTED "E0117" Error "something that does not belong here" "\
The text up to this place allows only certain continuations, which the message names.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := 1 2;\nEND_PROGRAM\n```\n\n\
The statement or declaration around it is left out of the further checks.\n";
    RESERVED_WORD "E0118" Error "a reserved word is used as a name" "\
The words that open or close a construct cannot be names.\n\n```st\nPROGRAM Main\nVAR for : INT; END_VAR\nEND_PROGRAM\n```\n\n\
Choose another name.\n";
    OUTSIDE_POU "E0119" Error "text outside of any declaration" "\
A file consists of PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE, VAR_GLOBAL and CONFIGURATION. Statements stand inside of a POU.\n\n```st\nx := 1;\nPROGRAM Main\nEND_PROGRAM\n```\n\n\
Move the statement into a POU.\n";
    DECLARATION_IN_BODY "E0120" Error "variables declared behind the first statement" "\
All sections with variables stand before the body of their POU.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nx := 1;\nVAR y : INT; END_VAR\nEND_PROGRAM\n```\n\n\
Move the section to the other ones.\n";
    NOT_SUPPORTED "E0121" Error "a construct that plcc does not support" "\
Object orientation (CLASS, INTERFACE, METHOD, PROPERTY, NAMESPACE) is not part of the language that plcc compiles.\n\n```st\nINTERFACE I\nEND_INTERFACE\nPROGRAM Main\nEND_PROGRAM\n```\n\n\
Use a FUNCTION_BLOCK with actions.\n";
    NESTED_TOO_DEEPLY "E0122" Error "nested too deeply" "\
Blocks nest at most 200 deep, parentheses 1000, expressions 4000: no text written by a person comes near.\n\n\
Divide the expression or move inner blocks to a function.\n";
    TOO_MANY_ERRORS "E0123" Error "too many syntax errors" "\
After 200 syntax errors in one file, or 100 in one declaration, no further ones are reported.\n\n\
Correct the first ones and compile again.\n";
    BAD_ASSOCIATION "E0124" Error "an action association is not well formed" "\
A step lists its actions as `name(qualifier, time, indicators);`. Only the name is required; without a qualifier it means N.\n\n```st\nPROGRAM Main\nVAR b : BOOL; END_VAR\nINITIAL_STEP S1: b(1 + 2); END_STEP\nTRANSITION FROM S1 TO S1 := TRUE; END_TRANSITION\nEND_PROGRAM\n```\n\n\
Write for example `b(N);` or `b(L, T#5s);`.\n";
    MISSPELLED "E0125" Error "a reserved word is misspelled" "\
A word that differs by one letter from a reserved word stands where only that reserved word makes sense.\n\n\
```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THNE\n  x := 0;\nEND_IF;\nEND_PROGRAM\n```\n\n\
Write the reserved word.\n";
    OPTIONAL_SEMICOLON "H0101" Hint "no `;` behind END_IF and its kind" "\
The standard ends every statement with `;`, also behind END_IF, END_CASE, END_FOR, END_WHILE and END_REPEAT. plcc does without.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THEN\n  x := 0;\nEND_IF\nx := 1;\nEND_PROGRAM\n```\n\n\
Write `END_IF;` for other tools.\n";
    // ---- E02xx: names and declarations ----
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
    // ---- E03xx: types, expressions, calls ----
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
`^` follows REF_TO and POINTER TO.\n\
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
    // ---- E0430..: Sequential Function Chart ----
    UNKNOWN_STEP "E0430" Error "a transition names no step" "\
FROM and TO name steps of the same chart.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp; END_STEP\n\
STEP Run: END_STEP\n\
TRANSITION FROM Idle TO Run := go; END_TRANSITION\n\
TRANSITION FROM Run TO Idel := NOT go; END_TRANSITION\n\
END_PROGRAM\n\
```\n";
    NO_INITIAL_STEP "E0431" Error "a network has no initial step" "\
Steps that transitions connect are one network, and each network starts with its one INITIAL_STEP. Here none of the steps is ever active.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
STEP Idle: lamp; END_STEP\n\
STEP Run: END_STEP\n\
TRANSITION FROM Idle TO Run := go; END_TRANSITION\n\
TRANSITION FROM Run TO Idle := NOT go; END_TRANSITION\n\
END_PROGRAM\n\
```\n";
    SEVERAL_INITIAL_STEPS "E0432" Error "a network has several initial steps" "\
Steps that transitions connect are one network, and it starts with exactly one INITIAL_STEP. To start several sequences together, begin with a step from which one transition leads to all of them, or write separate networks.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp; END_STEP\n\
INITIAL_STEP Run: END_STEP\n\
TRANSITION FROM Idle TO Run := go; END_TRANSITION\n\
END_PROGRAM\n\
```\n";
    TRANSITION_WITHOUT_STEPS "E0433" Error "a transition has no FROM or no TO" "\
A transition leads from one or more steps to one or more steps.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp; END_STEP\n\
TRANSITION FROM Idle := go; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nA sequence that ends has a last step without a transition behind it.\n";
    STEP_TWICE "E0434" Error "a step stands twice in one FROM or TO" "\
FROM and TO are sets of steps; a step can be active once.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp; END_STEP\n\
STEP Run: END_STEP\n\
TRANSITION FROM Idle TO (Run, Run) := go; END_TRANSITION\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_QUALIFIER "E0435" Error "there is no such action qualifier" "\
The qualifiers are N, S, R, L, D, P, P1, P0, SD, DS and SL.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp(LS, T#5s); END_STEP\n\
END_PROGRAM\n\
```\n";
    ACTION_TIME "E0436" Error "the duration of an action is missing or means nothing" "\
L, D, SD, DS and SL take a TIME: `lamp(L, T#5s)`. The other qualifiers take none.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp(L); END_STEP\n\
END_PROGRAM\n\
```\n";
    NOT_AN_ACTION "E0437" Error "a step names no action" "\
A step acts on ACTION blocks of its POU and on BOOL variables.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR speed : INT; END_VAR\n\
INITIAL_STEP Idle: speed(S); END_STEP\n\
END_PROGRAM\n\
```\n\nPut the assignment into an ACTION block and name that.\n";
    EQUAL_PRIORITIES "E0438" Error "two transitions behind one step have the same PRIORITY" "\
When both conditions hold, exactly one transition fires: that with the lower number. Without numbers the order of the text decides.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR go, lamp : BOOL; END_VAR\n\
INITIAL_STEP Idle: lamp; END_STEP\n\
STEP A: END_STEP\n\
STEP B: END_STEP\n\
TRANSITION (PRIORITY := 1) FROM Idle TO A := go; END_TRANSITION\n\
TRANSITION (PRIORITY := 1) FROM Idle TO B := go; END_TRANSITION\n\
END_PROGRAM\n\
```\n";
    CHART_IN_FUNCTION "E0439" Error "a function cannot be a chart" "\
A chart remembers which steps are active; a FUNCTION remembers nothing between its calls.\n\
\n\
```st\n\
FUNCTION F : INT\n\
VAR_INPUT go : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
END_FUNCTION\n\
```\n\nMake it a FUNCTION_BLOCK.\n";
    CHART_OPTION "W0440" Warning "an option of charts has no effect" "\
`{sfc_firing := 'strong'}` and `{sfc_transition := 'edge'}` stand between the declarations of a POU and its first step.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR lamp : BOOL; END_VAR\n\
{sfc_firing := 'strnog'}\n\
INITIAL_STEP Idle: lamp; END_STEP\n\
END_PROGRAM\n\
```\n";
    // ---- E0470..: the structure of charts ----
    NEVER_REACHED "E0470" Error "a step is never reached" "\
No run of the chart activates the step, whatever the conditions do: no transition leads to it, or only from steps that are themselves never active.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Run: END_STEP\n\
STEP Flush: END_STEP\n\
TRANSITION FROM Idle TO Run := a; END_TRANSITION\n\
TRANSITION FROM Run TO Idle := b; END_TRANSITION\n\
TRANSITION FROM Flush TO Idle := c; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nAdd the transition that leads to it, or remove the step.\n";
    NEVER_FIRES "E0471" Error "a transition can never fire" "\
A convergence fires when all steps behind FROM are active. Each of these is active at some time, but never all of them together, whatever the conditions do.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO Left := a; END_TRANSITION\n\
TRANSITION FROM Idle TO Right := b; END_TRANSITION\n\
TRANSITION FROM (Left, Right) TO Done := c; END_TRANSITION\n\
TRANSITION FROM Left TO Idle := d; END_TRANSITION\n\
TRANSITION FROM Right TO Idle := d; END_TRANSITION\n\
TRANSITION FROM Done TO Idle := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nSteps behind alternatives are never active together. Write one transition for each of them, or begin the branches simultaneously: `FROM Idle TO (Left, Right)`.\n";
    TOTALLY_STUCK "E0472" Error "the chart gets totally stuck" "\
A step waits for ever for a transition that can never fire, and the whole chart stands still. It is not an end step, which has no transition behind it. The help shows the shortest way there.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO Left := a; END_TRANSITION\n\
TRANSITION FROM Idle TO Right := b; END_TRANSITION\n\
TRANSITION FROM (Left, Right) TO Done := c; END_TRANSITION\n\
TRANSITION FROM Done TO Idle := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nHere alternatives are joined as if they were simultaneous branches. Write one transition for each of them, or begin them simultaneously: `FROM Idle TO (Left, Right)`.\n";
    CAN_BE_STUCK "W0473" Warning "the chart can get totally stuck" "\
It depends on the conditions whether the chart comes to a marking in which a step waits for ever and nothing else goes on. The help shows the shortest way there.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Off: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION\n\
TRANSITION FROM Right TO Off := b; END_TRANSITION\n\
TRANSITION FROM (Left, Right) TO Done := c; END_TRANSITION\n\
TRANSITION FROM Done TO Idle := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nHere a branch ends outside while its convergence waits for it. Lead the alternative back into the branch, or join both ways.\n";
    PARTIALLY_STUCK "E0474" Error "a part of the chart gets stuck" "\
A step waits for ever while other steps go on: a loop is never left, although a convergence waits for it. The help shows the shortest way there.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Pump: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION\n\
TRANSITION FROM Right TO Pump := b; END_TRANSITION\n\
TRANSITION FROM Pump TO Right := c; END_TRANSITION\n\
TRANSITION FROM (Left, Done) TO Idle := d; END_TRANSITION\n\
TRANSITION FROM (Left, Idle) TO Done := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nGive the loop a way out, and let the convergence wait for a step that is reached.\n";
    CAN_BE_PARTIALLY_STUCK "W0475" Warning "a part of the chart can get stuck" "\
It depends on the conditions whether a step comes to wait for ever while others go on. The help shows the shortest way there.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Pump: END_STEP\n\
STEP Rest: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION\n\
TRANSITION FROM Right TO Pump := b; END_TRANSITION\n\
TRANSITION FROM Pump TO Rest := c; END_TRANSITION\n\
TRANSITION FROM Rest TO Pump := d; END_TRANSITION\n\
TRANSITION FROM (Left, Right) TO Done := d; END_TRANSITION\n\
TRANSITION FROM Done TO Idle := a; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nGive the loop a way back to where the convergence waits.\n";
    ACTIVATED_TWICE "E0476" Error "a step is activated while it is active" "\
Whatever the conditions do, a transition at last activates a step that is still active. The chart has then lost one of its two sequences: both run on as one.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION\n\
TRANSITION FROM Left TO Done := b; END_TRANSITION\n\
TRANSITION FROM Right TO Done := c; END_TRANSITION\n\
TRANSITION FROM Done TO Idle := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nHere simultaneous branches are joined as if they were alternatives. Write one transition: `FROM (Left, Right) TO Done`.\n";
    CAN_BE_ACTIVATED_TWICE "W0477" Warning "a step can be activated while it is active" "\
It depends on the conditions whether a transition activates a step that is still active. The chart has then lost one of its two sequences: both run on as one.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION\n\
TRANSITION FROM Left TO Done := b; END_TRANSITION\n\
TRANSITION FROM (Left, Right) TO Idle := c; END_TRANSITION\n\
TRANSITION FROM Right TO Done := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nJoin simultaneous branches by one transition with all their last steps behind FROM.\n";
    LEAVES_BRANCH "W0478" Warning "a transition jumps out of a simultaneous branch" "\
The transition leaves one of several simultaneous branches and goes on outside, past their convergence, while the others stay active. When the branches begin again, steps are activated that are still active.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b, c, d : BOOL; END_VAR\n\
INITIAL_STEP Idle: END_STEP\n\
STEP Left: END_STEP\n\
STEP Right: END_STEP\n\
STEP Done: END_STEP\n\
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION\n\
TRANSITION FROM Right TO Idle := b; END_TRANSITION\n\
TRANSITION FROM (Left, Right) TO Done := c; END_TRANSITION\n\
TRANSITION FROM Done TO Idle := d; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nLeave all branches together: `FROM (Left, Right) TO Idle`.\n";
    RULES_DIFFER "W0479" Warning "only the strong firing rule keeps a step from being activated while active" "\
With `{sfc_firing := 'strong'}` a transition waits until its succeeding steps are inactive, and this chart needs that: by the weak rule, which most controllers use, it would activate a step that is active.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a, b : BOOL; END_VAR\n\
{sfc_firing := 'strong'}\n\
INITIAL_STEP Feed: END_STEP\n\
STEP Belt: END_STEP\n\
TRANSITION FROM Feed TO (Feed, Belt) := a; END_TRANSITION\n\
TRANSITION FROM (Feed, Belt) TO Feed := b; END_TRANSITION\n\
END_PROGRAM\n\
```\n\nWrite the waiting down: let the step be left before it is activated again.\n";
    NOT_PROVED "W0480" Warning "the structure of a chart is not proved" "\
The chart has more markings (sets of steps that can be active together) than the analysis visits, even after it was simplified. What was found is right, but steps that wait for ever or are activated twice may have been missed.\n\nBranches that meet only where they begin and end are easy to prove, however many there are. Move sequences that have little to do with each other to charts of their own.\n";
    // ---- E045x: Instruction List ----
    UNKNOWN_OPERATOR "E0450" Error "there is no such operator of IL" "\
An instruction begins with an operator of Instruction List or with the name of a function. Instances of function blocks and actions are called with CAL. `plcc explain JMPC` says what an operator does.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : BOOL; END_VAR\n\
LD a\n\
JPMC done\n\
ST b\n\
done:\n\
END_PROGRAM\n\
```\n";
    CR_TYPE "E0451" Error "the current result has the wrong type" "\
The current result has the type of what was loaded or computed last. An operator that does not take this type is an error on its own line; a conversion function (`INT_TO_WORD`) or a comparison (`NE 0`) before it makes another type of it.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR count : INT; flag : BOOL; END_VAR\n\
LD count\n\
AND flag\n\
ST flag\n\
END_PROGRAM\n\
```\n";
    NO_CR "E0452" Error "there is no current result" "\
An operator that works on the current result needs an instruction before it that gives one: LD, LDN, or a function. At the start of a body and of a parenthesis there is none; CAL gives none.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : BOOL; END_VAR\n\
AND a\n\
ST b\n\
END_PROGRAM\n\
```\n";
    TORN_CR "E0453" Error "the current result differs between the ways to a label" "\
Where ways meet at a label the current result must have one type, whichever way was taken. Here one way brings another type, or none.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a : BOOL; n : INT; END_VAR\n\
LD a\n\
JMPC store\n\
LD n\n\
store: ST n\n\
END_PROGRAM\n\
```\n";
    MISSING_IL_OPERAND "E0454" Error "an operator has no operand" "\
All operators but NOT, RET, RETC and RETCN need an operand on their line. Behind `AND(` the operand may stand on the same line, or as `LD x` on the next.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : BOOL; END_VAR\n\
LD a\n\
AND\n\
ST b\n\
END_PROGRAM\n\
```\n";
    TOO_MANY_OPERANDS "E0455" Error "an operator has too many operands" "\
An operator works on the current result and one operand; NOT and RET take none. Only a function takes several, separated by commas, behind the current result as its first argument.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b, c : INT; END_VAR\n\
LD a\n\
ADD b, c\n\
ST c\n\
END_PROGRAM\n\
```\n";
    EXPRESSION_OPERAND "E0456" Error "an operand of IL is an expression" "\
An operand is a variable or a constant; each operation is an instruction of its own.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : INT; END_VAR\n\
LD a + 1\n\
ST b\n\
END_PROGRAM\n\
```\n";
    PARENTHESIS_LABEL "E0457" Error "a label, jump or return in a parenthesis" "\
What stands between `AND(` and `)` is evaluated as a whole: no jump leads into it or out of it, and RET cannot leave it.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : BOOL; END_VAR\n\
LD a\n\
AND( b\n\
RETC\n\
)\n\
ST b\n\
END_PROGRAM\n\
```\n";
    PARENTHESIS_JUMP "E0458" Error "a jump leads into a parenthesis" "\
What stands between `AND(` and `)` is evaluated as a whole. Put the label before it.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR a, b : BOOL; END_VAR\n\
LD a\n\
AND( b\n\
inside: OR a\n\
)\n\
JMPC inside\n\
END_PROGRAM\n\
```\n";
    UNREACHABLE_INSTRUCTION "W0459" Warning "an instruction is never reached" "\
Behind JMP and RET control goes on elsewhere; without a label that a jump names nothing leads to the next instruction.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a : BOOL; END_VAR\n\
VAR_OUTPUT b : BOOL; END_VAR\n\
LD a\n\
ST b\n\
RET\n\
STN b\n\
END_PROGRAM\n\
```\n";
    STN_FOR_RESET "W0460" Warning "STN where R was probably meant" "\
`R x` resets x when the current result is TRUE and leaves it alone otherwise. `STN x` stores the negated current result each time: when the condition is FALSE, x becomes TRUE.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT danger : BOOL; END_VAR\n\
VAR_OUTPUT none, red : BOOL; END_VAR\n\
LD danger\n\
AND none\n\
S red\n\
STN none\n\
END_PROGRAM\n\
```\n";
    // ---- E05xx: configuration and project ----
    SEVERAL_CONFIGURATIONS "E0501" Error "there are several CONFIGURATIONs" "\
A project has one.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a : INT; END_VAR\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
CONFIGURATION D\n\
PROGRAM P : Main;\n\
END_CONFIGURATION\n\
```\n";
    SEVERAL_PROGRAMS "E0502" Error "which PROGRAM is to run?" "\
Without a CONFIGURATION the only PROGRAM runs; with several, --program or a CONFIGURATION chooses.\n\
\n\
```st\n\
PROGRAM A\n\
END_PROGRAM\n\
PROGRAM B\n\
END_PROGRAM\n\
```\n";
    UNKNOWN_PROGRAM "E0503" Error "there is no such PROGRAM" "\
The name must be that of a PROGRAM of the project.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a : INT; END_VAR\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
PROGRAM P : Mian;\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
```\n";
    UNKNOWN_TASK "E0504" Error "there is no such TASK" "\
WITH names a TASK of the same RESOURCE.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a : INT; END_VAR\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
PROGRAM P WITH Fast : Main;\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
```\n";
    BAD_TASK "E0505" Error "a TASK property is wrong" "\
A TASK has INTERVAL (a positive TIME), PRIORITY (0 is the highest) and SINGLE.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a : INT; END_VAR\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
TASK T(INTERVALL := T#10ms, PRIORITY := 1);\n\
PROGRAM P WITH T : Main;\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
```\n";
    NO_PROGRAM "E0506" Error "nothing is to run" "\
A CONFIGURATION gives programs to tasks: `PROGRAM P1 WITH T1 : Main;`\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_INPUT a : INT; END_VAR\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
```\n";
    TASKS_TWICE "E0507" Error "tasks are declared twice" "\
Tasks stand in a CONFIGURATION or in [tasks] of project.toml, not in both.\n";
    UNKNOWN_PATH "E0508" Error "an instance path leads nowhere" "\
VAR_CONFIG and VAR_ACCESS name variables from the outside: resource, program instance, then the variable, through instances\n\
of function blocks.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x AT %I* : BOOL; END_VAR\n\
VAR_OUTPUT y : BOOL; END_VAR\n\
y := x;\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
VAR_CONFIG\n\
R.P.x AT %IX0.0 : BOOL;\n\
R.P.z AT %IX0.1 : BOOL;\n\
END_VAR\n\
END_CONFIGURATION\n\
```\n";
    OPEN_ADDRESS "W0509" Warning "a variable was left without its address" "\
`AT %I*` leaves the address to the VAR_CONFIG of the CONFIGURATION, one for each instance. Without one the variable is connected\n\
to nothing.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR x AT %I* : BOOL; END_VAR\n\
VAR_OUTPUT y : BOOL; END_VAR\n\
y := x;\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE R ON PLC\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
```\n";
    // ---- E06xx: faults at run time (plcc_stdlib::fault) ----
    FAULT_DIVISION_BY_ZERO "E0601" Error "division by zero" "\
An integer was divided by 0 with / or MOD. Test the divisor first. The task stopped, outputs went to their safe state.\n";
    FAULT_INDEX_OUT_OF_BOUNDS "E0602" Error "index out of bounds" "\
An array was indexed outside of its declared bounds. The message names the array, the index and the bounds. The task stopped, outputs went to their safe state.\n";
    FAULT_SUBRANGE_VIOLATION "E0603" Error "value outside its subrange" "\
A value outside of the limits was assigned to a variable of a subrange type. The task stopped, outputs went to their safe state.\n";
    FAULT_NULL_REFERENCE "E0604" Error "NULL reference" "\
A reference that points nowhere was followed with ^. Compare it with NULL first. The task stopped, outputs went to their safe state.\n";
    FAULT_BAD_REFERENCE "E0605" Error "reference outside addressable memory" "\
A pointer was followed that points to no variable whose address was taken. The task stopped, outputs went to their safe state.\n";
    FAULT_NEGATIVE_SHIFT "E0606" Error "negative shift count" "\
SHL, SHR, ROL or ROR was called with a negative count. The task stopped, outputs went to their safe state.\n";
    FAULT_FOR_STEP_ZERO "E0607" Error "FOR step is zero" "\
The step of a FOR loop was 0 when the loop started; it would never end. The task stopped, outputs went to their safe state.\n";
    FAULT_DEADLINE "E0608" Error "deadline exceeded" "\
One execution of a task took longer than its watchdog allows (1 s of real time when nothing else is said). The line is one of the loop that ran. The task stopped, outputs went to their safe state.\n";
    STEP_ACTIVATED_TWICE "W0609" Warning "a step was activated while it was active" "\
Two ways through a chart met in one step: from here on there is one active step where there were two. Often a branch was left \
without waiting for the others, or a convergence was bypassed. The chart goes on; each step is reported once.\n\n\
With `{sfc_firing := 'strong'}` a transition waits until the steps behind it are inactive.\n";
}
