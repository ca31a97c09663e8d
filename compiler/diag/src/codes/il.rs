//! E045x: Instruction List.

use super::{Code, CodeInfo, Severity};

codes! {
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
}
