//! E013x: files in PLCopen TC6 XML.

use super::{Code, CodeInfo, Severity};

codes! {
    XML_SYNTAX "E0130" Error "a file is not well-formed XML" "\
An `.xml` file must be XML: every element is closed, attributes stand in quotes, `<` and `&` are written `&lt;` and `&amp;` in texts outside of CDATA sections. Document type declarations are not read, nor files of more than 64 MB or with more than 200 elements open at once.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">\n\
  <types>\n\
</project>\n\
```\n\nExport the file again; editors write well-formed files.\n";
    NOT_PLCOPEN "E0131" Error "an XML file is no PLCopen project" "\
plcc reads PLCopen TC6 XML, versions 2.01 and 1.01. Its root is `<project>` in a name space that begins with `http://www.plcopen.org/xml/tc6`.\n\
\n\
```xml\n\
<project><types/></project>\n\
```\n\nExport the project as PLCopen XML. Other XML files do not belong into the list of sources.\n";
    XML_MISSING "E0132" Error "an element or attribute is missing in an XML file" "\
PLCopen TC6 XML says which attributes and elements there must be, such as the name of a variable or the local id of a block.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
  <pou name=\"Main\" pouType=\"program\">\n\
    <interface><localVars><variable name=\"x\"/></localVars></interface>\n\
  </pou>\n\
</pous></types></project>\n\
```\n\nExport the file again, or add what is missing.\n";
    XML_VALUE "E0133" Error "an attribute of an XML file has no meaning" "\
Local ids and execution orders are numbers, names are names of IEC 61131-3, kinds and modifiers are words of PLCopen TC6 XML.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
  <pou name=\"Main\" pouType=\"procedure\"/>\n\
</pous></types></project>\n\
```\n\nHere: `program`, `functionBlock` or `function`.\n";
    XML_UNKNOWN "E0134" Error "an element of an XML file has no meaning where it stands" "\
What plcc would leave out could change what the program does, so elements that PLCopen TC6 XML does not know are errors. What vendors add in `<addData>` or in name spaces of their own is skipped.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
  <pou name=\"Main\" pouType=\"program\"><body><CFC/></body></pou>\n\
</pous></types></project>\n\
```\n\nExport the POU in one of the five notations of the standard.\n";
    LOOSE_COMMENT "W0135" Warning "a comment in an XML file is not closed" "\
Comments nest, and each needs its own end. Editors of PLCopen XML write comments that do not nest, so in an XML file `(* a (* b *)` counts as closed, and a comment on the last line of a text ends with it.\n\
\n\
```xml\n\
<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
  <pou name=\"Main\" pouType=\"program\"><body><ST>\n\
    (* the end of this text *\n\
  </ST></body></pou>\n\
</pous></types></project>\n\
```\n\nClose the comment.\n";
}
