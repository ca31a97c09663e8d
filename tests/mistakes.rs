//! Typical mistakes: each is one edit of a correct program, and gives exactly one message, at its line, with useful help.

use plcc_hir::Profile;
use plcc_tests::compile::diagnose;

/// A program without any message. It has a bit of everything, so that a mistake in one place can be felt in others.
const CORRECT: &str = "\
TYPE
  Mode : (Idle, Run, Fault);
  Motor : STRUCT
    speed : REAL;
    hours : DINT;
  END_STRUCT;
  Percent : INT (0..100);
END_TYPE

FUNCTION Scale : REAL
VAR_INPUT
  raw : INT;
  gain : REAL := 1.0;
END_VAR
Scale := INT_TO_REAL(raw) * gain;
END_FUNCTION

FUNCTION_BLOCK Counter
VAR_INPUT
  pulse : BOOL;
  preset : INT;
END_VAR
VAR_OUTPUT
  done : BOOL;
  value : INT;
END_VAR
VAR_IN_OUT
  total : DINT;
END_VAR
VAR
  edge : R_TRIG;
  spare : BOOL;
END_VAR
spare := NOT pulse;
edge(CLK := pulse);
IF edge.Q THEN
  value := value + 1;
  total := total + 1;
END_IF;
done := value >= preset;
END_FUNCTION_BLOCK

PROGRAM Main
VAR_INPUT
  start : BOOL;
  level : INT;
END_VAR
VAR CONSTANT
  COUNT : INT := 4;
  HIGH : INT := 90;
END_VAR
VAR
  mode : Mode;
  motors : ARRAY [1..COUNT] OF Motor;
  table : ARRAY [1..3, 0..1] OF INT;
  counter : Counter;
  delay : TON;
  total : DINT;
  sum : REAL;
  i : INT;
  share : Percent;
  lamp : BOOL;
END_VAR

delay(IN := start, PT := T#2s);
counter(pulse := start, preset := 10, total := total);

CASE mode OF
  Idle:
    IF delay.Q THEN
      mode := Run;
    END_IF;
  Run:
    IF NOT start THEN
      mode := Idle;
    ELSIF level > HIGH THEN
      mode := Fault;
    END_IF;
  Fault:
    lamp := counter.done;
END_CASE;

CASE level OF
  0: table[1, 0] := 1;
  1..9, 20: table[2, 0] := level;
ELSE
  table[3, 1] := -1;
END_CASE;

sum := 0.0;
FOR i := 1 TO COUNT DO
  motors[i].speed := Scale(raw := level, gain := 0.5);
  motors[i].hours := total;
  sum := sum + motors[i].speed;
END_FOR;

WHILE total > 1000 DO
  total := total - 1000;
END_WHILE;

REPEAT
  share := share + 1;
UNTIL share >= 50
END_REPEAT;

IF level > HIGH AND start THEN
  lamp := TRUE;
ELSE
  lamp := sum > 10.0;
END_IF;
END_PROGRAM
";

/// One mistake.
struct Mistake {
    /// In a few words.
    what: &'static str,
    /// Text that stands once in the correct program ...
    from: &'static str,
    /// ... and what is written instead.
    to: &'static str,
    /// The only message's code.
    code: &'static str,
    /// Text that stands once in the wrong program: the message points into its first line.
    at: &'static str,
    /// A part of the help.
    help: &'static str,
}

#[rustfmt::skip]
const MISTAKES: &[Mistake] = &[
    // Signs and words that are missing or wrong.
    Mistake { what: "missing `;` behind an assignment", from: "sum := 0.0;", to: "sum := 0.0",
        code: "E0114", at: "sum := 0.0", help: "`;`" },
    Mistake { what: "missing `;` behind a declaration", from: "delay : TON;", to: "delay : TON",
        code: "E0114", at: "delay : TON", help: "`;`" },
    Mistake { what: "missing `;` behind a call", from: "PT := T#2s);", to: "PT := T#2s)",
        code: "E0114", at: "PT := T#2s)", help: "`;`" },
    Mistake { what: "missing END_IF", from: "  lamp := sum > 10.0;\nEND_IF;", to: "  lamp := sum > 10.0;",
        code: "E0101", at: "IF level > HIGH AND start", help: "END_IF" },
    Mistake { what: "missing END_IF inside of a CASE", from: "      mode := Run;\n    END_IF;", to: "      mode := Run;",
        code: "E0101", at: "IF delay.Q THEN", help: "END_IF" },
    Mistake { what: "missing END_FOR", from: "speed;\nEND_FOR;", to: "speed;",
        code: "E0101", at: "FOR i := 1", help: "END_FOR" },
    Mistake { what: "missing END_VAR", from: "  spare : BOOL;\nEND_VAR", to: "  spare : BOOL;",
        code: "E0101", at: "VAR\n  edge", help: "END_VAR" },
    Mistake { what: "missing END_CASE", from: "  table[3, 1] := -1;\nEND_CASE;", to: "  table[3, 1] := -1;",
        code: "E0101", at: "CASE level OF", help: "END_CASE" },
    Mistake { what: "missing END_FUNCTION", from: "* gain;\nEND_FUNCTION", to: "* gain;",
        code: "E0101", at: "FUNCTION Scale", help: "END_FUNCTION" },
    Mistake { what: "missing THEN", from: "IF delay.Q THEN", to: "IF delay.Q",
        code: "E0115", at: "IF delay.Q", help: "THEN" },
    Mistake { what: "missing DO", from: "TO COUNT DO", to: "TO COUNT",
        code: "E0115", at: "TO COUNT", help: "DO" },
    Mistake { what: "missing OF", from: "CASE mode OF", to: "CASE mode",
        code: "E0115", at: "CASE mode", help: "OF" },
    Mistake { what: "missing UNTIL", from: "UNTIL share >= 50\n", to: "",
        code: "E0115", at: "END_REPEAT", help: "UNTIL" },
    Mistake { what: "missing `:` in a declaration", from: "total : DINT;\n  sum", to: "total DINT;\n  sum",
        code: "E0115", at: "total DINT;", help: ":" },
    Mistake { what: "missing `)`", from: "INT_TO_REAL(raw)", to: "INT_TO_REAL(raw",
        code: "E0115", at: "INT_TO_REAL(raw", help: ")" },
    Mistake { what: "missing `)` of a call", from: "total := total);", to: "total := total;",
        code: "E0115", at: "total := total;", help: "`)`" },
    Mistake { what: "missing `)` of a parenthesis", from: "IF level > HIGH AND start", to: "IF (level > HIGH AND start",
        code: "E0115", at: "IF (level", help: "`)`" },
    Mistake { what: "missing `]`", from: "motors[i].hours", to: "motors[i.hours",
        code: "E0115", at: "motors[i.hours", help: "]" },
    Mistake { what: "missing operand", from: "total - 1000;", to: "total - ;",
        code: "E0116", at: "total - ;", help: "variable" },
    Mistake { what: "two END_PROGRAMs", from: "END_PROGRAM\n", to: "END_PROGRAM\nEND_PROGRAM \n",
        code: "E0102", at: "END_PROGRAM ", help: "remove it" },
    Mistake { what: "END_IF twice", from: "  lamp := sum > 10.0;\nEND_IF;", to: "  lamp := sum > 10.0;\nEND_IF;\nEND_IF; ",
        code: "E0102", at: "END_IF; ", help: "remove it" },
    Mistake { what: "the END word of another construct", from: "total - 1000;\nEND_WHILE", to: "total - 1000;\nEND_IF ",
        code: "E0103", at: "END_IF ;", help: "END_WHILE" },
    Mistake { what: "END-IF", from: "  lamp := sum > 10.0;\nEND_IF", to: "  lamp := sum > 10.0;\nEND-IF",
        code: "E0104", at: "END-IF", help: "END_IF" },
    Mistake { what: "ELSE IF", from: "ELSIF level", to: "ELSE IF level",
        code: "E0105", at: "ELSE IF", help: "ELSIF" },
    Mistake { what: "a misspelt keyword", from: "WHILE total", to: "WHLIE total",
        code: "E0125", at: "WHLIE total", help: "WHILE" },
    Mistake { what: "ELSEIF", from: "ELSIF level", to: "ELSEIF level",
        code: "E0125", at: "ELSEIF", help: "`ELSIF`" },
    Mistake { what: "a misspelt FOR", from: "FOR i := 1", to: "FRO i := 1",
        code: "E0125", at: "FRO i", help: "`FOR`" },
    Mistake { what: "a misspelt REPEAT", from: "REPEAT\n", to: "REPAET\n",
        code: "E0125", at: "REPAET", help: "`REPEAT`" },
    Mistake { what: "a misspelt CASE", from: "CASE level OF", to: "CSAE level OF",
        code: "E0125", at: "CSAE", help: "`CASE`" },
    Mistake { what: "a misspelt ELSE", from: "ELSE\n  lamp", to: "ESLE\n  lamp",
        code: "E0125", at: "ESLE", help: "`ELSE`" },
    Mistake { what: "a misspelt THEN", from: "IF delay.Q THEN", to: "IF delay.Q THNE",
        code: "E0125", at: "THNE", help: "`THEN`" },
    Mistake { what: "a misspelt END_FOR", from: "END_FOR", to: "END_FRO",
        code: "E0125", at: "END_FRO", help: "`END_FOR`" },
    Mistake { what: "a misspelt VAR_INPUT", from: "VAR_INPUT\n  start", to: "VAR_INPTU\n  start",
        code: "E0125", at: "VAR_INPTU", help: "`VAR_INPUT`" },
    Mistake { what: "missing IF", from: "IF delay.Q THEN", to: "delay.Q THEN",
        code: "E0115", at: "delay.Q THEN", help: "`IF`" },
    Mistake { what: "missing FOR", from: "FOR i := 1", to: "i := 1",
        code: "E0115", at: "i := 1 TO", help: "`FOR`" },
    Mistake { what: "missing CASE", from: "CASE level OF", to: "level OF",
        code: "E0115", at: "level OF", help: "`CASE`" },
    Mistake { what: "a doubled IF", from: "IF delay.Q THEN", to: "IF IF delay.Q THEN",
        code: "E0117", at: "IF IF", help: "remove" },
    Mistake { what: "missing VAR_INPUT", from: "VAR_INPUT\n  start : BOOL;", to: "  start : BOOL;",
        code: "E0115", at: "start : BOOL", help: "VAR_INPUT" },
    Mistake { what: "missing VAR before CONSTANT", from: "VAR CONSTANT\n", to: "CONSTANT\n",
        code: "E0115", at: "CONSTANT\n", help: "VAR" },
    Mistake { what: "a word too many behind PROGRAM", from: "PROGRAM Main\n", to: "PROGRAM Main Station\n",
        code: "E0117", at: "Main Station", help: "remove" },
    Mistake { what: "missing `:` behind a CASE label", from: "  Run:\n", to: "  Run\n",
        code: "E0115", at: "  Run\n", help: "`:`" },
    Mistake { what: "missing `;` before a structure", from: "(Idle, Run, Fault);", to: "(Idle, Run, Fault)",
        code: "E0114", at: "(Idle, Run, Fault)", help: "`;`" },
    Mistake { what: "an enumeration without its parenthesis", from: "Mode : (Idle", to: "Mode : Idle",
        code: "E0117", at: "Mode : Idle", help: "parentheses" },
    Mistake { what: "a declaration without its name", from: "  spare : BOOL;\nEND_VAR\nspare := NOT pulse;\n", to: "  : BOOL;\nEND_VAR\n",
        code: "E0117", at: "  : BOOL;", help: "`name : type;`" },
    Mistake { what: "an input without its name", from: "  raw : INT;", to: "  : INT;",
        code: "E0117", at: "  : INT;\n  gain", help: "`name : type;`" },
    Mistake { what: "a component without its name", from: "    speed : REAL;", to: "    : REAL;",
        code: "E0117", at: "    : REAL;", help: "`name : type;`" },
    Mistake { what: "a type without its name", from: "  Motor : STRUCT", to: "  : STRUCT",
        code: "E0117", at: "  : STRUCT", help: "`name : type;`" },
    Mistake { what: "a function block without its name", from: "FUNCTION_BLOCK Counter", to: "FUNCTION_BLOCK",
        code: "E0117", at: "FUNCTION_BLOCK\nVAR_INPUT\n  pulse", help: "FUNCTION_BLOCK Motor" },
    Mistake { what: "a function without its name", from: "FUNCTION Scale : REAL", to: "FUNCTION : REAL",
        code: "E0117", at: "FUNCTION : REAL", help: "FUNCTION Motor" },
    Mistake { what: "an enumeration value that is missing between two commas", from: "(Idle, Run, Fault)", to: "(Idle, , Fault)",
        code: "E0116", at: "(Idle, , Fault)", help: "remove a `,`" },
    Mistake { what: "a name twice before `:`", from: "  share : Percent;", to: "  share share : Percent;",
        code: "E0117", at: "share share", help: "remove one" },
    Mistake { what: "ELSIF twice", from: "ELSIF level", to: "ELSIF ELSIF level",
        code: "E0117", at: "ELSIF ELSIF", help: "remove one" },
    Mistake { what: "missing REPEAT", from: "REPEAT\n  share", to: "  share",
        code: "E0115", at: "UNTIL share", help: "`REPEAT`" },
    Mistake { what: "missing END_REPEAT", from: "UNTIL share >= 50\nEND_REPEAT;", to: "UNTIL share >= 50;",
        code: "E0101", at: "REPEAT\n", help: "END_REPEAT" },
    Mistake { what: "missing UNTIL before the condition", from: "UNTIL share >= 50", to: "share >= 50 ",
        code: "E0115", at: "share >= 50 ", help: "UNTIL" },
    Mistake { what: "missing `(` of a call", from: "delay(IN := start", to: "delay IN := start",
        code: "E0115", at: "delay IN", help: "`(`" },
    Mistake { what: "missing END_STRUCT, and what is declared behind it", from: "  END_STRUCT;\n", to: "",
        code: "E0101", at: "Motor : STRUCT", help: "END_STRUCT" },
    Mistake { what: "missing type of a constant", from: "COUNT : INT := 4;", to: "COUNT := 4;",
        code: "E0116", at: "COUNT := 4", help: "`COUNT : INT`" },
    Mistake { what: "missing value of a constant", from: "COUNT : INT := 4;", to: "COUNT : INT := ;",
        code: "E0116", at: "COUNT : INT := ;", help: "literal" },
    Mistake { what: "a section behind the first statement, with its uses", from: "  lamp : BOOL;\nEND_VAR\n", to: "END_VAR\ntotal := 0;\nVAR lamp : BOOL; END_VAR\n",
        code: "E0120", at: "VAR lamp", help: "before the body" },
    Mistake { what: "missing PROGRAM", from: "PROGRAM Main\n", to: "Main\n",
        code: "E0119", at: "Main\n", help: "PROGRAM" },
    Mistake { what: "missing `,` between arguments", from: "raw := level, gain", to: "raw := level gain",
        code: "E0115", at: "level gain", help: "," },
    Mistake { what: "missing `:=` in an assignment", from: "lamp := counter.done", to: "lamp counter.done",
        code: "E0114", at: "lamp counter", help: "`;`" },
    Mistake { what: "`=` for `:=`", from: "mode := Fault", to: "mode = Fault",
        code: "E0113", at: "mode = Fault", help: ":=" },
    Mistake { what: "`==` for `=`", from: "level > HIGH AND", to: "level == HIGH AND",
        code: "E0111", at: "==", help: "`=`" },
    Mistake { what: "`!=` for `<>`", from: "level > HIGH AND", to: "level != HIGH AND",
        code: "E0111", at: "!=", help: "`<>`" },
    Mistake { what: "`&&` for AND", from: "HIGH AND start", to: "HIGH && start",
        code: "E0111", at: "&&", help: "AND" },
    Mistake { what: "`: =`", from: "sum := 0.0", to: "sum : = 0.0",
        code: "E0112", at: ": =", help: ":=" },
    Mistake { what: "a comment that is not closed", from: "sum := 0.0;", to: "sum := 0.0; (* start",
        code: "E0107", at: "(* start", help: "*)" },
    Mistake { what: "a reserved word as a name", from: "  lamp : BOOL;", to: "  lamp, until : BOOL;",
        code: "E0118", at: "until :", help: "another name" },
    Mistake { what: "variables behind the first statement", from: "sum := 0.0;", to: "sum := 0.0;\nVAR extra : INT; END_VAR",
        code: "E0120", at: "VAR extra", help: "before the body" },
    Mistake { what: "a statement outside of any POU", from: "FUNCTION Scale", to: "start := TRUE;\nFUNCTION Scale",
        code: "E0119", at: "start := TRUE", help: "PROGRAM" },

    // Habits from other languages.
    Mistake { what: "`i++`", from: "lamp := TRUE;", to: "total++;",
        code: "E0116", at: "total++", help: "`total := total + 1`" },
    Mistake { what: "`+=`", from: "sum := sum + motors[i].speed;", to: "sum += motors[i].speed;",
        code: "E0116", at: "sum +=", help: "`sum := sum + ...`" },
    Mistake { what: "`:` behind ELSE", from: "ELSE\n  lamp", to: "ELSE:\n  lamp",
        code: "E0117", at: "ELSE:", help: "remove it" },
    Mistake { what: "CASE before a value", from: "  0: table[1, 0]", to: "  CASE 0: table[1, 0]",
        code: "E0117", at: "  CASE 0", help: "`1:`" },
    Mistake { what: "BREAK", from: "table[2, 0] := level;", to: "table[2, 0] := level; BREAK;",
        code: "E0201", at: "BREAK", help: "EXIT" },
    Mistake { what: "DEFAULT", from: "ELSE\n  table", to: "DEFAULT: table",
        code: "E0201", at: "DEFAULT:", help: "ELSE" },
    Mistake { what: "a value behind RETURN", from: "Scale := INT_TO_REAL(raw) * gain;", to: "RETURN INT_TO_REAL(raw) * gain;",
        code: "E0117", at: "RETURN INT", help: "by its name" },
    Mistake { what: "bounds separated by `:`", from: "[1..COUNT]", to: "[1:COUNT]",
        code: "E0117", at: "[1:COUNT]", help: "`..`" },
    Mistake { what: "a length for bounds", from: "[1..COUNT]", to: "[4]",
        code: "E0117", at: "[4]", help: "`[0..3]`" },
    Mistake { what: "an array declared behind its name", from: "motors : ARRAY [1..COUNT] OF Motor;", to: "motors[4] : Motor;",
        code: "E0117", at: "motors[4] : Motor", help: "ARRAY [0..4] OF" },
    Mistake { what: "an element in parentheses", from: "motors[i].hours := total", to: "motors(i) := total",
        code: "E0206", at: "motors(i)", help: "`motors[...]`" },
    Mistake { what: "subscripts in brackets of their own", from: "table[1, 0] := 1", to: "table[1][0] := 1",
        code: "E0315", at: "table[1][0]", help: "one pair of brackets" },
    Mistake { what: "STRUCT before the name", from: "Motor : STRUCT", to: "STRUCT Motor",
        code: "E0117", at: "STRUCT Motor", help: "`Motor : STRUCT`" },
    Mistake { what: "initial values in braces", from: "counter : Counter;", to: "counter : Counter := {preset := 4};",
        code: "E0116", at: "counter : Counter", help: "(x := 1" },
    Mistake { what: "initial values without `:=`", from: "delay : TON;", to: "delay : TON(PT := 2);",
        code: "E0307", at: "delay : TON", help: "`:=`" },
    Mistake { what: "a decimal comma", from: "sum > 10.0;", to: "sum > 10,5;",
        code: "E0117", at: "10,5", help: "`10.5`" },
    Mistake { what: "a fraction for an integer", from: "preset := 10,", to: "preset := 10.0,",
        code: "E0301", at: "preset := 10.0", help: "`10`" },
    Mistake { what: "a comma in an address", from: "  lamp : BOOL;", to: "  lamp AT %QX0,1 : BOOL;",
        code: "E0117", at: "%QX0,1", help: "`%QX0.1`" },
    Mistake { what: "an address without %", from: "  lamp : BOOL;", to: "  lamp AT QX0.1 : BOOL;",
        code: "E0213", at: "QX0.1", help: "`%`" },
    Mistake { what: "a hexadecimal number of C", from: "level > HIGH AND", to: "level > 0x5A AND",
        code: "E0110", at: "0x5A", help: "16#5A" },
    Mistake { what: "a reserved word as a name, with its uses", from: "VAR_INPUT\n  raw : INT;", to: "VAR_INPUT\n  to, raw : INT := 1;",
        code: "E0118", at: "  to, raw", help: "another name" },
    Mistake { what: "two comparisons at once", from: "IF level > HIGH AND start", to: "IF 5 < level < HIGH",
        code: "E0310", at: "5 < level", help: "1 < x AND x < 5" },
    Mistake { what: "an enumeration value in quotes", from: "mode := Fault", to: "mode := 'Fault'",
        code: "E0301", at: "'Fault'", help: "without quotes" },
    Mistake { what: "a function block called by its type, twice", from: "delay(IN := start, PT := T#2s);", to: "TON(IN := start, PT := T#2s);\nlamp := TON.Q;",
        code: "E0321", at: "TON(IN", help: "instance" },
    Mistake { what: "the value of an instance's call", from: "lamp := counter.done", to: "lamp := delay(IN := start).Q",
        code: "E0206", at: "delay(IN := start).Q", help: "statement" },
    Mistake { what: "an output fetched the wrong way round", from: "preset := 10, total", to: "preset := 10, lamp := done, total",
        code: "E0327", at: "lamp := done", help: "`done => lamp`" },
    Mistake { what: "a text in double quotes", from: "  lamp : BOOL;", to: "  lamp : BOOL;\n  text : STRING := \"hello\";",
        code: "E0301", at: "\"hello\"", help: "single quotes" },
    Mistake { what: "texts joined with +", from: "  lamp : BOOL;\nEND_VAR\n", to: "  lamp : BOOL;\n  text : STRING;\nEND_VAR\ntext := text + 'x';",
        code: "E0310", at: "text + 'x'", help: "CONCAT" },

    Mistake { what: "FOR ... DOWNTO", from: "FOR i := 1 TO COUNT DO", to: "FOR i := 4 DOWNTO 1 DO",
        code: "E0117", at: "DOWNTO", help: "BY -1" },
    Mistake { what: "FOR ... STEP", from: "TO COUNT DO", to: "TO COUNT STEP 2 DO",
        code: "E0125", at: "STEP 2", help: "`BY`" },
    Mistake { what: "FOR ... IN", from: "FOR i := 1 TO COUNT DO", to: "FOR i IN 1..4 DO",
        code: "E0117", at: "FOR i IN", help: "FOR i := first TO last" },
    Mistake { what: "`^` for a power", from: "* gain;", to: "^ 2.0 * gain;",
        code: "E0117", at: "^ 2.0", help: "`x ** y`" },
    Mistake { what: "POW", from: "INT_TO_REAL(raw) * gain", to: "POW(INT_TO_REAL(raw), gain)",
        code: "E0322", at: "POW(", help: "EXPT" },
    Mistake { what: "PRINT", from: "lamp := TRUE;", to: "PRINT('on');",
        code: "E0322", at: "PRINT(", help: "--watch" },
    Mistake { what: "a misspelt TRUE", from: "lamp := TRUE;", to: "lamp := TURE;",
        code: "E0201", at: "TURE", help: "`TRUE`" },
    Mistake { what: "a duration without `#`", from: "PT := T#2s", to: "PT := T2s",
        code: "E0201", at: "PT := T2s", help: "`T#5s`" },
    Mistake { what: "`,` between conditions", from: "IF level > HIGH AND start THEN", to: "IF level > HIGH, start THEN",
        code: "E0117", at: "HIGH, start", help: "AND or OR" },
    Mistake { what: "`:=` in a condition", from: "IF delay.Q THEN", to: "IF lamp := delay.Q THEN",
        code: "E0117", at: "IF lamp", help: "compared with `=`" },
    Mistake { what: "two assignments in one", from: "lamp := TRUE;", to: "lamp := counter.done := TRUE;",
        code: "E0117", at: "counter.done := TRUE", help: "write several" },
    Mistake { what: "`? :`", from: "lamp := TRUE;", to: "lamp := start ? TRUE : FALSE;",
        code: "E0106", at: "start ?", help: "SEL(" },
    Mistake { what: "`=` in a call", from: "delay(IN := start, PT := T#2s);", to: "delay(IN = start);",
        code: "E0113", at: "IN = start", help: "`IN := ...`" },
    Mistake { what: "a comment with `#`", from: "sum := 0.0;", to: "sum := 0.0;\n# start\n",
        code: "E0111", at: "# start", help: "`//`" },
    Mistake { what: "a comment with `--`", from: "sum := 0.0;", to: "sum := 0.0;\n-- start\n",
        code: "E0111", at: "-- start", help: "`//`" },
    Mistake { what: "VAR_CONSTANT", from: "VAR CONSTANT\n", to: "VAR_CONSTANT\n",
        code: "E0125", at: "VAR_CONSTANT", help: "`VAR CONSTANT`" },

    Mistake { what: "`->`", from: "motors[i].hours := total", to: "motors[i]->hours := total",
        code: "E0116", at: "motors[i]->hours", help: "with a point" },
    Mistake { what: "a component of a whole array", from: "motors[i].hours := total", to: "motors.hours := total",
        code: "E0204", at: "motors.hours", help: "`motors[...].hours`" },
    Mistake { what: "a component of a type", from: "motors[i].hours := total", to: "Motor.hours := total",
        code: "E0206", at: "Motor.hours", help: "`x : Motor;`" },
    Mistake { what: "initial values without names", from: "sum : REAL;\n  i", to: "m : Motor := (1.0, 2);\n  sum : REAL;\n  i",
        code: "E0117", at: "(1.0, 2)", help: "by name" },
    Mistake { what: "`:` for `:=` in initial values", from: "sum : REAL;\n  i", to: "m : Motor := (speed : 1.0);\n  sum : REAL;\n  i",
        code: "E0117", at: "(speed : 1.0)", help: "`:=`" },
    Mistake { what: "`,` between components", from: "    speed : REAL;", to: "    speed : REAL,",
        code: "E0117", at: "    speed : REAL,", help: "ends with `;`" },
    Mistake { what: "FUNCTION BLOCK", from: "FUNCTION_BLOCK Counter", to: "FUNCTION BLOCK Counter",
        code: "E0125", at: "FUNCTION BLOCK", help: "`FUNCTION_BLOCK`" },
    Mistake { what: "a function block with a result type", from: "FUNCTION_BLOCK Counter", to: "FUNCTION_BLOCK Counter : INT",
        code: "E0117", at: "Counter : INT", help: "VAR_OUTPUT" },
    Mistake { what: "parameters behind the name", from: "Scale : REAL\nVAR_INPUT\n  raw : INT;\n  gain : REAL := 1.0;\nEND_VAR\n", to: "Scale(raw : INT, gain : REAL) : REAL\n",
        code: "E0117", at: "Scale(raw : INT", help: "VAR_INPUT" },
    Mistake { what: "VAR INPUT", from: "VAR_INPUT\n  pulse", to: "VAR INPUT\n  pulse",
        code: "E0125", at: "VAR INPUT", help: "`VAR_INPUT`" },
    Mistake { what: "VAR_INOUT, and what is connected to it", from: "VAR_IN_OUT", to: "VAR_INOUT",
        code: "E0125", at: "VAR_INOUT", help: "`VAR_IN_OUT`" },
    Mistake { what: "VAR_IN, and what is passed to it", from: "VAR_INPUT\n  pulse", to: "VAR_IN\n  pulse",
        code: "E0125", at: "VAR_IN\n", help: "`VAR_INPUT`" },
    Mistake { what: "an END word cut short", from: "END_FUNCTION_BLOCK", to: "END_FUNCTION_BL",
        code: "E0125", at: "END_FUNCTION_BL", help: "`END_FUNCTION_BLOCK`" },

    // Names.
    Mistake { what: "a misspelt variable", from: "lamp := counter.done", to: "lmap := counter.done",
        code: "E0201", at: "lmap", help: "`lamp`" },
    Mistake { what: "an undeclared variable", from: "lamp := counter.done", to: "horn := counter.done",
        code: "E0201", at: "horn", help: "VAR" },
    Mistake { what: "a misspelt enumeration value", from: "mode := Run;", to: "mode := Runn;",
        code: "E0201", at: "Runn", help: "`Run`" },
    Mistake { what: "a misspelt function", from: "INT_TO_REAL", to: "INT_TO_RAEL",
        code: "E0322", at: "INT_TO_RAEL", help: "`INT_TO_REAL`" },
    Mistake { what: "a misspelt type", from: "lamp : BOOL", to: "lamp : BOOLEAN",
        code: "E0203", at: "BOOLEAN", help: "`BOOL`" },
    Mistake { what: "a misspelt component", from: "motors[i].hours", to: "motors[i].huors",
        code: "E0204", at: "huors", help: "`hours`" },
    Mistake { what: "a misspelt output", from: "IF delay.Q", to: "IF delay.Done",
        code: "E0204", at: "delay.Done", help: "IN, PT, Q, ET" },
    Mistake { what: "a misspelt parameter", from: "Scale(raw :=", to: "Scale(rwa :=",
        code: "E0323", at: "rwa", help: "`raw`" },
    Mistake { what: "a duplicate variable", from: "  lamp : BOOL;", to: "  lamp : BOOL;\n  Sum : INT;",
        code: "E0202", at: "  Sum : INT", help: "rename" },
    Mistake { what: "a duplicate variable of another type", from: "  mode : Mode;\n", to: "  mode : Mode;\n  Table : REAL;\n",
        code: "E0202", at: "  table : ARRAY", help: "rename" },
    Mistake { what: "a duplicate constant", from: "  HIGH : INT := 90;\n", to: "  HIGH : INT := 90;\n  count : REAL;\n",
        code: "E0202", at: "  count : REAL", help: "rename" },
    Mistake { what: "a duplicate component", from: "    hours : DINT;\n", to: "    hours : DINT;\n    Hours : REAL;\n",
        code: "E0202", at: "    Hours : REAL", help: "rename" },
    Mistake { what: "a duplicate enumeration value", from: "(Idle, Run, Fault)", to: "(Idle, Run, Fault, idle)",
        code: "E0202", at: "(Idle, Run", help: "rename" },
    Mistake { what: "a duplicate POU", from: "PROGRAM Main", to: "FUNCTION scale : INT\nscale := 1;\nEND_FUNCTION\nPROGRAM Main",
        code: "E0202", at: "FUNCTION scale", help: "rename" },
    Mistake { what: "an inner variable from outside", from: "lamp := counter.done", to: "lamp := counter.edge.Q",
        code: "E0207", at: "counter.edge", help: "output" },

    // Types and literals.
    Mistake { what: "a real for an integer", from: "table[3, 1] := -1;", to: "table[3, 1] := sum;",
        code: "E0301", at: ":= sum;", help: "REAL_TO_INT" },
    Mistake { what: "an integer as a condition", from: "IF delay.Q", to: "IF level",
        code: "E0301", at: "IF level THEN", help: "<> 0" },
    Mistake { what: "a number for TIME", from: "PT := T#2s", to: "PT := 2000",
        code: "E0301", at: "PT := 2000", help: "T#" },
    Mistake { what: "a narrower target", from: "mode := Fault", to: "table[1, 1] := total",
        code: "E0301", at: "table[1, 1]", help: "DINT_TO_INT" },
    Mistake { what: "a number for an enumeration", from: "mode := Fault", to: "mode := 2",
        code: "E0301", at: "mode := 2", help: "Idle, Run, Fault" },
    Mistake { what: "AND of a number and a BOOL", from: "level > HIGH AND start", to: "level AND start",
        code: "E0310", at: "level AND start", help: "INT_TO_WORD" },
    Mistake { what: "a constant that does not fit", from: "HIGH : INT := 90", to: "HIGH : INT := 90000",
        code: "E0302", at: "90000", help: "32767" },
    Mistake { what: "a constant outside of a subrange", from: "share : Percent;", to: "share : Percent := 150;",
        code: "E0302", at: "150", help: "0 to 100" },
    Mistake { what: "a duration with an unknown unit", from: "T#2s", to: "T#2min",
        code: "E0110", at: "T#2min", help: "`m`" },
    Mistake { what: "a digit that the base does not have", from: "preset := 10", to: "preset := 2#102",
        code: "E0336", at: "2#102", help: "0 and 1" },
    Mistake { what: "division by zero", from: "total - 1000;", to: "total / 0;",
        code: "E0311", at: "total / 0", help: "divisor" },

    // Arrays.
    Mistake { what: "array bounds the wrong way round", from: "[1..COUNT]", to: "[COUNT..1]",
        code: "E0303", at: "[COUNT..1]", help: "lower bound comes first" },
    Mistake { what: "a variable as a bound", from: "[1..COUNT]", to: "[1..level]",
        code: "E0309", at: "[1..level]", help: "CONSTANT" },
    Mistake { what: "too few subscripts", from: "table[1, 0] := 1", to: "table[1] := 1",
        code: "E0315", at: "table[1] ", help: "one subscript per dimension" },
    Mistake { what: "too many subscripts", from: "motors[i].hours", to: "motors[i, 1].hours",
        code: "E0315", at: "motors[i, 1]", help: "one subscript per dimension" },
    Mistake { what: "a constant index out of bounds", from: "table[1, 0] := 1", to: "table[4, 0] := 1",
        code: "E0316", at: "table[4, 0]", help: "inside the bounds" },
    Mistake { what: "subscripts on a scalar", from: "lamp := TRUE", to: "lamp[1] := TRUE",
        code: "E0314", at: "lamp[1]", help: "only arrays" },

    // Calls.
    Mistake { what: "a parameter of the wrong type", from: "Scale(raw := level", to: "Scale(raw := sum",
        code: "E0301", at: "raw := sum", help: "REAL_TO_INT" },
    Mistake { what: "a missing VAR_IN_OUT", from: ", total := total)", to: ")",
        code: "E0329", at: "counter(pulse", help: "`total := variable`" },
    Mistake { what: "a VAR_IN_OUT of another type", from: "total := total)", to: "total := level)",
        code: "E0328", at: "total := level)", help: "same type" },
    Mistake { what: "an expression for a VAR_IN_OUT", from: "total := total)", to: "total := total + 1)",
        code: "E0206", at: "total := total + 1)", help: "variable" },
    Mistake { what: "a doubled parameter", from: "gain := 0.5)", to: "raw := 1)",
        code: "E0326", at: "raw := 1)", help: "remove" },
    Mistake { what: "positional and named", from: "Scale(raw := level", to: "Scale(level",
        code: "E0324", at: "Scale(level", help: "`name := value`" },
    Mistake { what: "too many arguments", from: "Scale(raw := level, gain := 0.5)", to: "Scale(level, 0.5, 2)",
        code: "E0325", at: "Scale(level, 0.5, 2)", help: "raw, gain" },
    Mistake { what: "a missing argument", from: "INT_TO_REAL(raw)", to: "INT_TO_REAL()",
        code: "E0337", at: "INT_TO_REAL()", help: "IN" },
    Mistake { what: "an output fetched with `:=`", from: "preset := 10,", to: "preset := 10, done := lamp,",
        code: "E0327", at: "done := lamp", help: "=>" },
    Mistake { what: "a function block as a function", from: "lamp := sum > 10.0", to: "lamp := TON(IN := start, PT := T#1s)",
        code: "E0321", at: "TON(", help: "instance" },
    Mistake { what: "a program called as a function", from: "lamp := TRUE", to: "Main()",
        code: "E0321", at: "Main()", help: "tasks" },
    Mistake { what: "recursion", from: "INT_TO_REAL(raw)", to: "Scale(raw, 1.0)",
        code: "E0335", at: "Scale(raw, 1.0)", help: "loop" },

    // Who may write what.
    Mistake { what: "assigning to a constant", from: "lamp := TRUE", to: "HIGH := 80",
        code: "E0320", at: "HIGH := 80", help: "CONSTANT" },
    Mistake { what: "assigning to an output from outside", from: "lamp := TRUE", to: "counter.value := 0",
        code: "E0320", at: "counter.value := 0", help: "only the function block itself" },
    Mistake { what: "assigning to a FOR variable", from: "motors[i].hours := total", to: "i := i + 1",
        code: "E0331", at: "i := i + 1", help: "WHILE" },
    Mistake { what: "assigning to a function", from: "lamp := TRUE", to: "Scale := 1.0 ",
        code: "E0206", at: "Scale := 1.0 ", help: "call it" },
    Mistake { what: "assigning to an enumeration value", from: "mode := Fault", to: "Fault := mode",
        code: "E0206", at: "Fault := mode", help: "variable" },

    // Statements.
    Mistake { what: "overlapping CASE labels", from: "1..9, 20:", to: "1..9, 5:",
        code: "E0333", at: "1..9, 5:", help: "once" },
    Mistake { what: "a CASE label twice", from: "  Fault:\n", to: "  Run: ;\n  Fault:\n",
        code: "E0333", at: "  Run: ;", help: "once" },
    Mistake { what: "a variable as a CASE label", from: "1..9, 20:", to: "1..9, i:",
        code: "E0309", at: "1..9, i:", help: "CONSTANT" },
    Mistake { what: "a forgotten CASE value", from: "  Fault:\n    lamp := counter.done;\n", to: "",
        code: "W0349", at: "CASE mode OF", help: "ELSE" },
    Mistake { what: "EXIT outside of a loop", from: "lamp := TRUE", to: "EXIT",
        code: "E0330", at: "EXIT", help: "inside FOR" },
    Mistake { what: "a FOR that counts with step 0", from: "TO COUNT DO", to: "TO COUNT BY 0 DO",
        code: "E0334", at: "BY 0", help: "BY 1" },
    Mistake { what: "an expression as a statement", from: "lamp := TRUE;", to: "lamp;",
        code: "E0332", at: "lamp;", help: ":=" },
    Mistake { what: "a BOOL as FOR variable", from: "FOR i := 1 TO COUNT", to: "FOR lamp := 1 TO COUNT",
        code: "E0310", at: "FOR lamp", help: "INT" },

    // Habits of other languages and of haste, second part.
    Mistake { what: "braces around the statements of an IF", from: "IF delay.Q THEN\n      mode := Run;\n    END_IF;", to: "IF delay.Q {\n      mode := Run;\n    }",
        code: "E0117", at: "IF delay.Q {", help: "END_IF" },
    Mistake { what: "braces with ELSE IF and ELSE", from: "IF level > HIGH AND start THEN\n  lamp := TRUE;\nELSE\n  lamp := sum > 10.0;\nEND_IF;", to: "if (level > HIGH) {\n  lamp := TRUE;\n} else if (start) {\n  lamp := FALSE;\n} else {\n  lamp := sum > 10.0;\n}",
        code: "E0117", at: "if (level", help: "END_IF" },
    Mistake { what: "braces around a loop", from: "WHILE total > 1000 DO\n  total := total - 1000;\nEND_WHILE;", to: "while (total > 1000) {\n  total := total - 1000;\n}",
        code: "E0117", at: "while (", help: "END_WHILE" },
    Mistake { what: "the head of a loop in C", from: "FOR i := 1 TO COUNT DO", to: "FOR (i := 1; i <= COUNT; i++) DO",
        code: "E0117", at: "FOR (i", help: "FOR i := 0 TO 9 DO" },
    Mistake { what: "a misspelt VAR_IN_OUT in a call", from: "total := total);", to: "totl := total);",
        code: "E0323", at: "totl := total", help: "`total`" },
    Mistake { what: "the opposite of an unknown output", from: "preset := 10, total", to: "preset := 10, NOT dne => lamp, total",
        code: "E0323", at: "NOT dne", help: "`done`" },
    Mistake { what: "a misspelt value behind its type", from: "mode := Run;", to: "mode := Mode#Rnu;",
        code: "E0204", at: "Mode#Rnu", help: "`Run`" },
    Mistake { what: "a misspelt value behind a point", from: "mode := Run;", to: "mode := Mode.Rnu;",
        code: "E0204", at: "Mode.Rnu", help: "`Run`" },
    Mistake { what: "a misspelt type before a value", from: "mode := Run;", to: "mode := Mdoe#Run;",
        code: "E0203", at: "Mdoe#Run", help: "`Mode`" },
    Mistake { what: "RETURN for the result", from: "Scale := INT_TO_REAL", to: "RETURN := INT_TO_REAL",
        code: "E0201", at: "RETURN :=", help: "`Name := value;`" },
    Mistake { what: "a result without its type", from: "FUNCTION Scale : REAL", to: "FUNCTION Scale",
        code: "E0116", at: "FUNCTION Scale", help: "`FUNCTION Scale : INT`" },
    Mistake { what: "CONST", from: "VAR CONSTANT", to: "CONST",
        code: "E0125", at: "CONST\n", help: "VAR CONSTANT" },
    Mistake { what: "VAR CONST", from: "VAR CONSTANT", to: "VAR CONST",
        code: "E0125", at: "VAR CONST\n", help: "VAR CONSTANT" },
    Mistake { what: "missing STRUCT", from: "Motor : STRUCT", to: "Motor :",
        code: "E0115", at: "Motor :\n", help: "STRUCT" },
    Mistake { what: "`;` between the values of an enumeration", from: "(Idle, Run, Fault);", to: "(Idle; Run; Fault);",
        code: "E0117", at: "(Idle;", help: "`,`" },
    Mistake { what: "an enumeration in braces", from: "(Idle, Run, Fault);", to: "{Idle, Run, Fault};",
        code: "E0116", at: "{Idle", help: "(Red, Green)" },
    Mistake { what: "an enumeration in brackets", from: "(Idle, Run, Fault);", to: "[Idle, Run, Fault];",
        code: "E0117", at: "[Idle", help: "(Red, Green)" },
    Mistake { what: "a subrange in brackets", from: "INT (0..100)", to: "INT [0..100]",
        code: "E0117", at: "INT [0..100]", help: "`INT (0..100)`" },
    Mistake { what: "a subrange with TO", from: "INT (0..100)", to: "INT (0 TO 100)",
        code: "E0117", at: "INT (0 TO 100)", help: "`INT (0..100)`" },
    Mistake { what: "three points", from: "INT (0..100)", to: "INT (0...100)",
        code: "E0117", at: "INT (0...100)", help: "two points" },
    Mistake { what: "an array without OF", from: "[1..COUNT] OF Motor", to: "[1..COUNT] Motor",
        code: "E0115", at: "[1..COUNT] Motor", help: "OF INT" },
    Mistake { what: "an array without brackets", from: "ARRAY [1..COUNT] OF", to: "ARRAY 1..COUNT OF",
        code: "E0117", at: "ARRAY 1..COUNT", help: "ARRAY [0..4] OF INT" },
    Mistake { what: "an array in parentheses", from: "ARRAY [1..COUNT] OF", to: "ARRAY (1..COUNT) OF",
        code: "E0117", at: "ARRAY (1..COUNT)", help: "ARRAY [0..4] OF INT" },
    Mistake { what: "a constant for bounds", from: "ARRAY [1..COUNT] OF", to: "ARRAY [COUNT] OF",
        code: "E0117", at: "ARRAY [COUNT]", help: "ARRAY [0..4] OF INT" },
    Mistake { what: "bounds with TO", from: "ARRAY [1..COUNT] OF", to: "ARRAY [1 TO COUNT] OF",
        code: "E0117", at: "ARRAY [1 TO COUNT]", help: "ARRAY [0..4] OF INT" },
    Mistake { what: "brackets for each dimension", from: "[1..3, 0..1]", to: "[1..3][0..1]",
        code: "E0117", at: "[1..3][0..1]", help: "one pair of brackets" },
    Mistake { what: "a misspelt ARRAY", from: "table : ARRAY", to: "table : ARAY",
        code: "E0117", at: "ARAY", help: "`ARRAY`" },
    Mistake { what: "`==` for an initial value", from: "HIGH : INT := 90;", to: "HIGH : INT == 90;",
        code: "E0111", at: "HIGH : INT == 90", help: "`:=`" },
    Mistake { what: "NOT behind its operand", from: "IF NOT start THEN", to: "IF start NOT THEN",
        code: "E0117", at: "IF start NOT", help: "`NOT x`" },
    Mistake { what: "`~` for NOT", from: "IF NOT start THEN", to: "IF ~start THEN",
        code: "E0106", at: "IF ~start", help: "NOT" },
    Mistake { what: "DIV", from: "total := total - 1000;", to: "total := total DIV 1000;",
        code: "E0117", at: "DIV 1000", help: "`x / y`" },
    Mistake { what: "a call without parentheses", from: "sum := 0.0;", to: "sum := ABS sum;",
        code: "E0117", at: "ABS sum", help: "`ABS(...)`" },
    Mistake { what: "a blank behind `T#`", from: "PT := T#2s", to: "PT := T# 2s",
        code: "E0110", at: "T# 2s", help: "no blank" },
    Mistake { what: "a decimal comma in a duration", from: "PT := T#2s", to: "PT := T#2,5s",
        code: "E0110", at: "T#2,5s", help: "`T#2.5s`" },
    Mistake { what: "SWITCH", from: "CASE level OF", to: "SWITCH level OF",
        code: "E0125", at: "SWITCH", help: "`CASE`" },
    Mistake { what: "a text in back quotes", from: "sum := 0.0;", to: "sum := `0`;",
        code: "E0106", at: "`0`", help: "single quotes" },
    Mistake { what: "an address that is none", from: "  lamp : BOOL;", to: "  lamp AT %IZ0 : BOOL;",
        code: "E0110", at: "%IZ0", help: "%IX0.0" },
    Mistake { what: "a list for each row", from: "table : ARRAY [1..3, 0..1] OF INT;", to: "table : ARRAY [1..3, 0..1] OF INT := [[1, 2], [3, 4], [5, 6]];",
        code: "E0307", at: "table : ARRAY", help: "one list" },
    Mistake { what: "elements in parentheses", from: "table : ARRAY [1..3, 0..1] OF INT;", to: "table : ARRAY [1..3, 0..1] OF INT := (1,2,3,4,5,6);",
        code: "E0117", at: "table : ARRAY", help: "brackets" },
    Mistake { what: "one value for an array", from: "table : ARRAY [1..3, 0..1] OF INT;", to: "table : ARRAY [1..3, 0..1] OF INT := 0;",
        code: "E0307", at: "table : ARRAY", help: "[1, 2" },
    Mistake { what: "a component compared in its initial value", from: "OF Motor;", to: "OF Motor := [(speed = 1.0)];",
        code: "E0113", at: "(speed =", help: "`speed := ...`" },
    Mistake { what: "a misspelt component in its initial value", from: "OF Motor;", to: "OF Motor := [(sped := 1.0)];",
        code: "E0204", at: "(sped", help: "`speed`" },
    Mistake { what: "a value for an instance", from: "delay(IN := start, PT := T#2s);", to: "delay := start;",
        code: "E0301", at: "delay := start", help: "called" },
    Mistake { what: "a value for an array", from: "sum := 0.0;", to: "table := 0;",
        code: "E0301", at: "table := 0", help: "one by one" },
    Mistake { what: "a value for a structure", from: "sum := 0.0;", to: "motors[1] := 0;",
        code: "E0301", at: "motors[1] := 0", help: "one by one" },
    Mistake { what: "a label of another type", from: "1..9, 20:", to: "Run:",
        code: "E0301", at: "  Run: table", help: "TO_INT(...)" },
    Mistake { what: "a real without digits behind the point", from: "sum := 0.0;", to: "sum := 1.;",
        code: "E0117", at: "sum := 1.;", help: "`1.0`" },
    Mistake { what: "a real without digits before the point", from: "sum := 0.0;", to: "sum := .5;",
        code: "E0117", at: "sum := .5;", help: "`0.5`" },
    Mistake { what: "a binary number of C", from: "sum := 0.0;", to: "table[1, 1] := 0b101;",
        code: "E0110", at: "0b101", help: "`2#101`" },
    Mistake { what: "a letter behind a real", from: "sum := 0.0;", to: "sum := 1.5f;",
        code: "E0110", at: "1.5f", help: "`1.5`" },
    Mistake { what: "a hexadecimal number of Pascal", from: "sum := 0.0;", to: "table[1, 1] := $FF;",
        code: "E0106", at: "$FF", help: "`16#FF`" },
    Mistake { what: "units of a duration in the wrong order", from: "T#2s", to: "T#5ms2s",
        code: "E0336", at: "T#5ms2s", help: "T#1d2h" },
    Mistake { what: "missing END_REPEAT before the next statement", from: "UNTIL share >= 50\nEND_REPEAT;", to: "UNTIL share >= 50",
        code: "E0101", at: "REPEAT\n", help: "END_REPEAT" },
    Mistake { what: "`:` for THEN", from: "IF delay.Q THEN", to: "IF delay.Q:",
        code: "E0115", at: "IF delay.Q:", help: "THEN" },
    Mistake { what: "`:` for DO", from: "WHILE total > 1000 DO", to: "WHILE total > 1000:",
        code: "E0115", at: "WHILE total > 1000:", help: "DO" },
    Mistake { what: "BEGIN and END", from: "IF delay.Q THEN\n      mode := Run;\n    END_IF;", to: "IF delay.Q THEN BEGIN\n      mode := Run;\n    END;\n    END_IF;",
        code: "E0117", at: "IF delay.Q THEN BEGIN", help: "END_IF" },
    Mistake { what: "BEGIN before the body", from: "delay(IN := start", to: "BEGIN\ndelay(IN := start",
        code: "E0117", at: "BEGIN\n", help: "remove" },
    Mistake { what: "`;` between arguments", from: "pulse := start, preset := 10, total := total", to: "pulse := start; preset := 10; total := total",
        code: "E0117", at: "counter(pulse := start;", help: "`,`" },
];

/// Where `part` stands in `text`, once.
fn place(m: &Mistake, text: &str, part: &str) -> Result<usize, String> {
    match &text.match_indices(part).map(|(at, _)| at).collect::<Vec<_>>()[..] {
        [at] => Ok(*at),
        all => Err(format!("{}: `{part}` stands {} times\n", m.what, all.len())),
    }
}

/// The line, from 1, of an offset.
fn line(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

/// What is wrong with the messages of a mistake.
fn judge(m: &Mistake) -> Result<(), String> {
    place(m, CORRECT, m.from)?;
    let text = CORRECT.replacen(m.from, m.to, 1);
    let expected_line = line(&text, place(m, &text, m.at)?);
    let (_, diags, sources) = diagnose(&text, Profile::Strict);
    let list = diags.sorted();
    let shown: String = list
        .iter()
        .map(|d| {
            format!("    {}: {}: {} / {}\n", sources.position(d.primary.span), d.code, d.message, d.help.join(" / "))
        })
        .collect();
    let [only] = list[..] else { return Err(format!("{}: {} messages\n{shown}", m.what, list.len())) };
    let found_line = line(&text, only.primary.span.start as usize);
    let mut wrong = Vec::new();
    if only.code.info().code != m.code {
        wrong.push(format!("{} instead of {}", only.code, m.code));
    }
    if found_line != expected_line {
        wrong.push(format!("line {found_line} instead of {expected_line}"));
    }
    if m.help.is_empty() || !only.help.iter().any(|h| h.contains(m.help)) {
        wrong.push(format!("the help does not say `{}`", m.help));
    }
    if wrong.is_empty() { Ok(()) } else { Err(format!("{}: {}\n{shown}", m.what, wrong.join(", "))) }
}

#[test]
fn the_correct_program_has_no_message() {
    let (_, diags, sources) = diagnose(CORRECT, Profile::Strict);
    let list: Vec<String> =
        diags.sorted().iter().map(|d| format!("{}: {}", sources.position(d.primary.span), d.message)).collect();
    assert!(list.is_empty(), "{list:#?}");
}

#[test]
fn each_mistake_gives_one_message_at_its_line_with_help() {
    assert!(MISTAKES.len() >= 40);
    let wrong: Vec<String> = MISTAKES.iter().filter_map(|m| judge(m).err()).collect();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), MISTAKES.len(), wrong.join(""));
}

/// Words and signs of a text.
fn tokens(text: &str) -> Vec<std::ops::Range<usize>> {
    let word = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'#';
    let bytes = text.as_bytes();
    let mut out: Vec<std::ops::Range<usize>> = Vec::new();
    for (i, byte) in bytes.iter().enumerate().filter(|(_, b)| !b.is_ascii_whitespace()) {
        match out.last_mut().filter(|t| t.end == i) {
            Some(last) if word(*byte) && word(bytes[i - 1]) => last.end += 1,
            Some(last) if [":=", "..", "<=", ">=", "<>", "=>"].contains(&&text[last.start..=i]) => last.end += 1,
            _ => out.push(i..i + 1),
        }
    }
    out
}

/// Slips at every place: a word or sign that is left out or written twice. Most give one message, none a flood.
#[test]
fn a_slip_anywhere_gives_few_messages() {
    let (mut all, mut more) = (0, Vec::new());
    for t in tokens(CORRECT) {
        let left_out = format!("{} {}", &CORRECT[..t.start], &CORRECT[t.end..]);
        let twice = format!("{} {}", &CORRECT[..t.end], &CORRECT[t.start..]);
        for (how, text) in [("without", left_out), ("twice", twice)] {
            let (_, diags, _) = diagnose(&text, Profile::Strict);
            let messages = diags.sorted().len();
            let place = line(CORRECT, t.start);
            assert!(messages <= 2, "line {place}, {how} `{}`: {messages} messages", &CORRECT[t.clone()]);
            all += 1;
            if messages > 1 {
                more.push(format!("line {place}, {how} `{}`: {messages}", &CORRECT[t.clone()]));
            }
        }
    }
    assert!(more.len() * 100 <= all * 2, "{} of {all} slips give several messages:\n{}", more.len(), more.join("\n"));
}
