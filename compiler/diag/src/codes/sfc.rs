//! E043x and E047x: Sequential Function Chart and the structure of charts.

use super::{Code, CodeInfo, Severity};

codes! {
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
}
