//! The interface of a POU: its sections of variables and its result.

use super::Reader;
use super::nodes::{child, children, named};
use crate::ast::*;
use roxmltree::Node;

impl Reader<'_, '_> {
    /// The sections of an `interface`, in order, and the type of a function's result.
    pub(super) fn interface(&mut self, pou: Node) -> (Vec<VarSection>, Option<TypeExpr>) {
        let Some(interface) = child(pou, "interface") else { return (Vec::new(), None) };
        let mut sections = Vec::new();
        let mut result = None;
        for part in children(interface) {
            let kind = match part.tag_name().name() {
                "returnType" => {
                    result = Some(self.ty(part));
                    continue;
                }
                "localVars" => SectionKind::Var,
                "tempVars" => SectionKind::Temp,
                "inputVars" => SectionKind::Input,
                "outputVars" => SectionKind::Output,
                "inOutVars" => SectionKind::InOut,
                "externalVars" => SectionKind::External,
                "globalVars" => SectionKind::Global,
                _ => {
                    self.unknown(part, "an interface");
                    continue;
                }
            };
            sections.push(self.section(part, kind));
        }
        (sections, result)
    }

    /// A list of variables.
    pub(super) fn section(&mut self, list: Node, kind: SectionKind) -> VarSection {
        let qualifiers = self.qualifiers(list);
        let vars = named(list, "variable").filter_map(|v| self.variable(v)).collect();
        VarSection { kind, qualifiers, vars, span: self.whole(list) }
    }
}
