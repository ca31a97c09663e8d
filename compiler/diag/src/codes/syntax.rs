//! E01xx: lexical forms and syntax.

use super::{Code, CodeInfo, Severity};

codes! {
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
}
