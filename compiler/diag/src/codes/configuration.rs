//! E05xx: configuration and project.

use super::{Code, CodeInfo, Severity};

codes! {
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
    FOREIGN_GLOBAL "E0510" Error "a global of another RESOURCE" "\
A VAR_GLOBAL of a RESOURCE exists in that RESOURCE only. What several resources use stands in the CONFIGURATION; or each\n\
RESOURCE has its own, of the same name and type.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_EXTERNAL level : INT; END_VAR\n\
level := level + 1;\n\
END_PROGRAM\n\
CONFIGURATION C\n\
RESOURCE A ON PLC\n\
VAR_GLOBAL level : INT; END_VAR\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
RESOURCE B ON PLC\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
END_CONFIGURATION\n\
```\n";
    SHARED_REFERENCE "E0511" Error "resources cannot share a reference" "\
Resources work on copies of the CONFIGURATION's globals, each in a memory of its own: a reference of one means nothing in\n\
the other. Share the value, or declare the variable in one RESOURCE.\n\
\n\
```st\n\
PROGRAM Main\n\
VAR_EXTERNAL p : REF_TO INT; END_VAR\n\
VAR x : INT; END_VAR\n\
p := REF(x);\n\
END_PROGRAM\n\
CONFIGURATION C\n\
VAR_GLOBAL p : REF_TO INT; END_VAR\n\
RESOURCE A ON PLC\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
RESOURCE B ON PLC\n\
PROGRAM P : Main;\n\
END_RESOURCE\n\
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
}
