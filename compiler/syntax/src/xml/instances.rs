//! Configurations: resources, tasks, program instances and their global variables.

use super::Reader;
use super::nodes::{attribute, child, children, find, named};
use crate::ast::*;
use plcc_diag::{Diagnostic, codes};
use roxmltree::{Attribute, Node};

impl Reader<'_, '_> {
    /// A `configuration`. One that runs nothing (a library has such) gives its global variables only.
    pub(super) fn configuration(&mut self, node: Node) {
        let runs = node.descendants().any(|n| n.tag_name().name() == "pouInstance");
        let sections = self.global_sections(node);
        if !runs {
            for resource in named(node, "resource") {
                let more = self.global_sections(resource);
                self.out.items.extend(more.into_iter().map(Item::Globals));
            }
            self.out.items.extend(sections.into_iter().map(Item::Globals));
            return;
        }
        let Some(name) = self.name(node, "name") else { return };
        let resources = named(node, "resource").filter_map(|r| self.resource(r)).collect();
        let span = self.whole(node);
        self.out.items.push(Item::Config(Configuration { name, sections, resources, span }));
    }

    /// VAR_GLOBAL, VAR_ACCESS and VAR_CONFIG of a configuration or resource.
    fn global_sections(&mut self, node: Node) -> Vec<VarSection> {
        let mut sections = Vec::new();
        for list in children(node) {
            match list.tag_name().name() {
                "globalVars" => sections.push(self.section(list, SectionKind::Global)),
                "accessVars" => {
                    let vars = named(list, "accessVariable").filter_map(|v| self.access_variable(v)).collect();
                    let span = self.whole(list);
                    sections.push(VarSection { kind: SectionKind::Access, qualifiers: Vec::new(), vars, span });
                }
                "configVars" => {
                    let vars = named(list, "configVariable").filter_map(|v| self.config_variable(v)).collect();
                    let span = self.whole(list);
                    sections.push(VarSection { kind: SectionKind::Config, qualifiers: Vec::new(), vars, span });
                }
                _ => {}
            }
        }
        sections
    }

    /// `alias` of the variable at `instancePathAndName`.
    fn access_variable(&mut self, node: Node) -> Option<VarDecl> {
        let name = self.name(node, "alias")?;
        let path = self.path(node)?;
        let ty = self.ty(child(node, "type")?);
        let read_write = match attribute(node, "direction") {
            Some("readWrite") => Some(true),
            Some("readOnly") => Some(false),
            _ => None,
        };
        let span = self.whole(node);
        Some(VarDecl { names: vec![name], path, at: None, ty, edge: None, read_write, init: None, span })
    }

    /// Address or initial value of the variable at `instancePathAndName`.
    fn config_variable(&mut self, node: Node) -> Option<VarDecl> {
        let mut path = self.path(node)?;
        let ty = self.ty(child(node, "type")?);
        let at = find(node, "address").map(|a| (a.value().trim().into(), self.value_span(a)));
        let init = child(node, "initialValue").and_then(|i| self.initial_value(i, &ty));
        let span = self.whole(node);
        let first = path.remove(0);
        Some(VarDecl { names: vec![first], path, at, ty, edge: None, read_write: None, init, span })
    }

    /// The names of `instancePathAndName`; at least one.
    fn path(&mut self, node: Node) -> Option<Vec<Name>> {
        let found = self.required(node, "instancePathAndName")?;
        let span = self.value_span(found);
        found.value().split('.').map(|part| self.checked_name(part, span)).collect()
    }

    fn resource(&mut self, node: Node) -> Option<Resource> {
        let name = self.name(node, "name")?;
        let sections = self.global_sections(node);
        let mut tasks = Vec::new();
        let mut programs = Vec::new();
        for part in children(node) {
            match part.tag_name().name() {
                "task" => {
                    let Some(task) = self.task(part) else { continue };
                    let instances = named(part, "pouInstance");
                    programs.extend(instances.filter_map(|p| self.program(p, Some(task.name.clone()))));
                    tasks.push(task);
                }
                "pouInstance" => programs.extend(self.program(part, None)),
                "globalVars" | "accessVars" | "configVars" => {}
                _ => self.unknown(part, "a resource"),
            }
        }
        let span = self.whole(node);
        Some(Resource { name: Some(name), on: None, sections, tasks, programs, span })
    }

    fn task(&mut self, node: Node) -> Option<TaskDecl> {
        let name = self.name(node, "name")?;
        let mut properties = Vec::new();
        for (attribute_name, property) in [("single", "SINGLE"), ("interval", "INTERVAL"), ("priority", "PRIORITY")] {
            let Some(found) = find(node, attribute_name).filter(|a| !a.value().trim().is_empty()) else { continue };
            let span = self.value_span(found);
            let value = match property {
                "INTERVAL" => match clock_time(found.value().trim()) {
                    Some(text) => {
                        let prefix = Some(Name { text: "T".into(), span });
                        let literal = Literal { kind: LiteralKind::Duration, prefix, text: text.into() };
                        Some(Expr { kind: ExprKind::Literal(literal), span, depth: 1, parens: false })
                    }
                    None if found.value().contains(':') => self.bad_interval(found),
                    None => self.expression_of(node, attribute_name, "the interval"),
                },
                _ => self.expression_of(node, attribute_name, "this attribute"),
            };
            properties.extend(value.map(|v| (Name { text: property.into(), span }, v)));
        }
        Some(TaskDecl { name, properties, span: self.tag(node) })
    }

    fn bad_interval(&mut self, found: Attribute) -> Option<Expr> {
        let span = self.value_span(found);
        let message = format!("`{}` is no interval", found.value());
        self.say(Diagnostic::new(codes::XML_VALUE, span, message).help("write a duration: T#20ms, or 00:00:00.020"));
        None
    }

    fn program(&mut self, node: Node, task: Option<Name>) -> Option<ProgramDecl> {
        let name = self.name(node, "name")?;
        // 1.01 says `type`.
        let attribute_name =
            if find(node, "typeName").is_none() && find(node, "type").is_some() { "type" } else { "typeName" };
        let program = self.name(node, attribute_name)?;
        let span = self.tag(node);
        Some(ProgramDecl { qualifier: None, name, task, program, args: Vec::new(), fb_tasks: Vec::new(), span })
    }
}

/// `hh:mm:ss.fraction` of 1.01, and `PT0.02S`, as the text of a duration.
fn clock_time(text: &str) -> Option<String> {
    if let Some(seconds) = text.strip_prefix("PT").and_then(|t| t.strip_suffix('S')) {
        return decimal(seconds).then(|| format!("{seconds}s"));
    }
    let mut parts = text.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next()?);
    let whole = |t: &str| !t.is_empty() && t.len() < 10 && t.bytes().all(|b| b.is_ascii_digit());
    if parts.next().is_some() || !whole(hours) || !whole(minutes) || !decimal(seconds) {
        return None;
    }
    let total = hours.parse::<u64>().ok()? * 3600 + minutes.parse::<u64>().ok()? * 60;
    let (integer, fraction) = seconds.split_once('.').unwrap_or((seconds, ""));
    let total = total + integer.parse::<u64>().ok()?;
    Some(if fraction.is_empty() { format!("{total}s") } else { format!("{total}.{fraction}s") })
}

fn decimal(text: &str) -> bool {
    let (integer, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let digits = |t: &str| !t.is_empty() && t.len() < 10 && t.bytes().all(|b| b.is_ascii_digit());
    digits(integer) && digits(fraction)
}
