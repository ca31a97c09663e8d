//! E041x and E042x: Ladder Diagram, Function Block Diagram, and charts that are drawn.

use super::{Code, CodeInfo, Severity};

codes! {
    DUPLICATE_ID "E0410" Error "two elements have the same local id" "\
Connections name the element where they begin by its local id, so each element of a body needs its own.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>\n\
\u{20}  <outVariable localId=\"1\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nGive each element a local id of its own. Editors do that; look for elements that were copied by hand.\n";
    DANGLING_CONNECTION "E0411" Error "a connection begins nowhere" "\
A connection names an element by its local id, and there is no such element in this body, or it has no output.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <outVariable localId=\"1\"><connectionPointIn><connection refLocalId=\"7\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nDraw the connection again.\n";
    CHART_GRAPH "E0412" Error "a chart is drawn wrongly" "\
A chart is a sequence of steps and transitions: behind each step come transitions, behind each transition steps. A simultaneous divergence or convergence stands where several steps follow or precede one transition, a selection where several transitions do. An action block belongs to one step.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><SFC>\n\
\u{20}  <step localId=\"1\" name=\"Idle\" initialStep=\"true\"><connectionPointOut/></step>\n\
\u{20}  <actionBlock localId=\"2\"><connectionPointIn/><action><reference name=\"q\"/></action></actionBlock>\n\
\u{20} </SFC>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nDraw the missing step, transition, divergence or connection.\n";
    UNCONNECTED_PIN "E0413" Error "a pin is not connected" "\
Inputs of standard functions need a value, as do coils, connectors in use and conditions. Inputs of function blocks and of own functions may stay open: they keep their value, or take their initial value.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <block localId=\"1\" typeName=\"NOT\">\n\
\u{20}   <inputVariables>\n\
\u{20}    <variable formalParameter=\"IN\"><connectionPointIn/></variable>\n\
\u{20}   </inputVariables>\n\
\u{20}   <outputVariables><variable formalParameter=\"OUT\"><connectionPointOut/></variable></outputVariables>\n\
\u{20}  </block>\n\
\u{20}  <outVariable localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nConnect a variable, a constant or a block.\n";
    SEVERAL_SOURCES "E0414" Error "several connections end in one pin" "\
In Function Block Diagram a pin takes one value. Only in Ladder Diagram do lines that meet mean OR.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}   <variable name=\"b\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>\n\
\u{20}  <inVariable localId=\"2\"><connectionPointOut/><expression>b</expression></inVariable>\n\
\u{20}  <outVariable localId=\"3\"><connectionPointIn><connection refLocalId=\"1\"/><connection refLocalId=\"2\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nPut a block OR, AND or another one between them.\n";
    NO_POWER_RAIL "E0415" Error "an element of a rung has no power rail" "\
Power flows from the left power rail through contacts and blocks to coils, jumps and returns. Nothing leads to this element, so it could never do anything.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><LD>\n\
\u{20}  <contact localId=\"2\"><connectionPointIn/><connectionPointOut/><variable>a</variable></contact>\n\
\u{20}  <coil localId=\"3\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn><connectionPointOut/><variable>q</variable></coil>\n\
\u{20} </LD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nConnect the rung to the left power rail.\n";
    UNKNOWN_CONNECTOR "E0416" Error "a continuation has no connector" "\
A connector ends a line, and continuations of the same name in the same body go on with its value. There must be exactly one connector of that name.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <continuation localId=\"1\" name=\"power\"><connectionPointOut/></continuation>\n\
\u{20}  <outVariable localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nDraw the connector, or correct the name.\n";
    NO_MEMORY "E0417" Error "a FUNCTION cannot remember" "\
Edges and loops of connections need to know what was in the call before. A FUNCTION starts afresh at each call.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"function\">\n\
\u{20} <interface>\n\
\u{20}  <returnType><BOOL/></returnType>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <inVariable localId=\"2\"><connectionPointOut/><expression>a</expression></inVariable>\n\
\u{20}  <outVariable localId=\"3\" edge=\"rising\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn><expression>Main</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nMake the POU a FUNCTION_BLOCK.\n";
    ENDLESS_LOOP "E0418" Error "a loop of connections holds nothing that could be evaluated" "\
A connector takes its value from its own continuation.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <connector localId=\"1\" name=\"loop\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn></connector>\n\
\u{20}  <continuation localId=\"2\" name=\"loop\"><connectionPointOut/></continuation>\n\
\u{20}  <outVariable localId=\"3\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nConnect the connector to a variable or a block.\n";
    LOOP_BROKEN "H0419" Hint "a value of the cycle before is used" "\
A connection leads back to an element that is evaluated earlier, or an execution order asks for that. The value that comes is that of the cycle before; in the first cycle it is the initial value. A loop without execution orders is broken behind a function block in it, else behind its rightmost element.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>\n\
\u{20}  <block localId=\"2\" typeName=\"OR\">\n\
\u{20}   <inputVariables>\n\
\u{20}    <variable formalParameter=\"IN1\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn></variable>\n\
\u{20}    <variable formalParameter=\"IN2\"><connectionPointIn><connection refLocalId=\"2\" formalParameter=\"OUT\"/></connectionPointIn></variable>\n\
\u{20}   </inputVariables>\n\
\u{20}   <outputVariables><variable formalParameter=\"OUT\"><connectionPointOut/></variable></outputVariables>\n\
\u{20}  </block>\n\
\u{20}  <outVariable localId=\"3\"><connectionPointIn><connection refLocalId=\"2\" formalParameter=\"OUT\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nNothing needs to be done. To choose another order give executionOrderIds, or lead the loop through a variable.\n";
    NO_CONDITION "E0420" Error "nothing gives a transition its value" "\
The condition of a named transition in LD or FBD is what its variable or coil with the name of the transition takes.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20} </interface>\n\
\u{20} <transitions><transition name=\"Go\"><body><FBD>\n\
\u{20}  <inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>\n\
\u{20} </FBD></body></transition></transitions>\n\
\u{20} <body><SFC>\n\
\u{20}  <step localId=\"1\" name=\"Idle\" initialStep=\"true\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn><connectionPointOut/></step>\n\
\u{20}  <transition localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><connectionPointOut/><condition><reference name=\"Go\"/></condition></transition>\n\
\u{20} </SFC>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nEnd the network in a variable or coil with the name of the transition.\n";
    UNKNOWN_PIN "E0421" Error "a block has no such output" "\
A connection begins at an output that the block does not have, or does not say at which of several outputs it begins.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <inputVars>\n\
\u{20}   <variable name=\"a\"><type><BOOL/></type></variable>\n\
\u{20}  </inputVars>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20}  <localVars>\n\
\u{20}   <variable name=\"t\"><type><derived name=\"TON\"/></type></variable>\n\
\u{20}  </localVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>\n\
\u{20}  <block localId=\"2\" typeName=\"TON\" instanceName=\"t\">\n\
\u{20}   <inputVariables><variable formalParameter=\"IN\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn></variable></inputVariables>\n\
\u{20}   <outputVariables><variable formalParameter=\"Q\"><connectionPointOut/></variable></outputVariables>\n\
\u{20}  </block>\n\
\u{20}  <outVariable localId=\"3\"><connectionPointIn><connection refLocalId=\"2\" formalParameter=\"QQ\"/></connectionPointIn><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nDraw the connection again from the output that is meant.\n";
    IDLE_ELEMENT "W0422" Warning "a drawn variable takes no value" "\
Nothing is connected to the variable, so the network does not change it.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
\u{20}<pou name=\"Main\" pouType=\"program\">\n\
\u{20} <interface>\n\
\u{20}  <outputVars>\n\
\u{20}   <variable name=\"q\"><type><BOOL/></type></variable>\n\
\u{20}  </outputVars>\n\
\u{20} </interface>\n\
\u{20} <body><FBD>\n\
\u{20}  <outVariable localId=\"1\"><connectionPointIn/><expression>q</expression></outVariable>\n\
\u{20} </FBD>\n\
\u{20} </body>\n\
\u{20}</pou>\n\
</pous></types></project>\n\
```\n\nConnect it, or remove it.\n";
}
