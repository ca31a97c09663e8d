//! CONFIGURATION.

use super::{Context, ResourceItem};
use crate::ast::*;
use plcc_diag::{Span, codes};

impl Context<'_> {
    /// `TASK T(INTERVAL := T#10ms, PRIORITY := 1);`
    pub fn task(&self, name: Name, args: Vec<Arg>, l: u32, r: u32) -> ResourceItem {
        let mut properties = Vec::with_capacity(args.len());
        for arg in args {
            match arg.kind {
                ArgKind::Input(name, Some(value)) => properties.push((name, value)),
                ArgKind::Positional(Expr { kind: ExprKind::Error, .. }) => {}
                _ => self.report(
                    codes::UNEXPECTED,
                    arg.span,
                    "this is not a property of a TASK",
                    "properties are named: `INTERVAL := T#10ms`, `PRIORITY := 1`, `SINGLE := start`",
                ),
            }
        }
        ResourceItem::Task(Box::new(TaskDecl { name, properties, span: self.span(l, r) }))
    }

    /// `PROGRAM P1 WITH T : Main(...);`
    #[allow(clippy::too_many_arguments)]
    pub fn program(
        &self,
        qualifiers: Vec<(Qualifier, Span)>,
        name: Name,
        task: Option<Name>,
        program: Name,
        connections: Vec<(Arg, Option<Name>)>,
        l: u32,
        r: u32,
    ) -> ResourceItem {
        let (mut args, mut fb_tasks) = (Vec::new(), Vec::new());
        for (arg, with) in connections {
            match (arg.kind, with) {
                (ArgKind::Positional(fb), Some(task)) => fb_tasks.push((fb, task)),
                (kind, _) => args.push(Arg { kind, span: arg.span }),
            }
        }
        let qualifier = qualifiers.into_iter().next();
        let span = self.span(l, r);
        ResourceItem::Program(Box::new(ProgramDecl { qualifier, name, task, program, args, fb_tasks, span }))
    }

    /// A configuration. Tasks and programs outside of any RESOURCE make one without a name, which comes first.
    pub fn configuration(&self, name: Name, items: Vec<ResourceItem>, l: u32, r: u32) -> Configuration {
        let span = self.span(l, r);
        let (mut sections, mut resources, mut loose) = (Vec::new(), Vec::new(), Vec::new());
        for item in items {
            match item {
                ResourceItem::Section(section) => sections.push(*section),
                ResourceItem::Resource(resource) => resources.push(*resource),
                item => loose.push(item),
            }
        }
        if !loose.is_empty() {
            resources.insert(0, resource(None, None, loose, span));
        }
        Configuration { name, sections, resources, span }
    }
}

/// A resource from its flat list.
pub fn resource(name: Option<Name>, on: Option<Name>, items: Vec<ResourceItem>, span: Span) -> Resource {
    let mut resource = Resource { name, on, sections: Vec::new(), tasks: Vec::new(), programs: Vec::new(), span };
    for item in items {
        match item {
            ResourceItem::Section(section) => resource.sections.push(*section),
            ResourceItem::Task(task) => resource.tasks.push(*task),
            ResourceItem::Program(program) => resource.programs.push(*program),
            ResourceItem::Resource(_) => {}
        }
    }
    resource
}
