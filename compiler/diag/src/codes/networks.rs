//! E041x and E042x: Ladder Diagram, Function Block Diagram, and charts that are drawn.

use super::{Code, CodeInfo, Severity};

codes! {
    DUPLICATE_ID "E0410" Error "two elements have the same local id" "";
    DANGLING_CONNECTION "E0411" Error "a connection begins nowhere" "";
    CHART_GRAPH "E0412" Error "a chart is drawn wrongly" "";
    UNCONNECTED_PIN "E0413" Error "a pin is not connected" "";
    SEVERAL_SOURCES "E0414" Error "several connections end in one pin" "";
    NO_POWER_RAIL "E0415" Error "an element of a rung has no power rail" "";
    UNKNOWN_CONNECTOR "E0416" Error "a continuation has no connector" "";
    NO_MEMORY "E0417" Error "a FUNCTION cannot remember" "";
    ENDLESS_LOOP "E0418" Error "a loop of connections holds nothing that could be evaluated" "";
    LOOP_BROKEN "H0419" Hint "a value of the cycle before is used" "";
    NO_CONDITION "E0420" Error "nothing gives a transition its value" "";
    UNKNOWN_PIN "E0421" Error "a block has no such output" "";
    IDLE_ELEMENT "W0422" Warning "a drawn variable takes no value" "";
}
