//! E06xx: faults at run time (`plcc_stdlib::fault`).

use super::{Code, CodeInfo, Severity};

codes! {
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
