//! CONFIGURATION.

use super::{Arg, Expr, Name, Qualifier, VarSection};
use plcc_diag::Span;

/// A configuration.
#[derive(Debug, Clone)]
pub struct Configuration {
    /// Its name.
    pub name: Name,
    /// VAR_GLOBAL, VAR_ACCESS, VAR_CONFIG.
    pub sections: Vec<VarSection>,
    /// Its resources; tasks and programs outside of any RESOURCE make one without a name.
    pub resources: Vec<Resource>,
    /// From CONFIGURATION to END_CONFIGURATION.
    pub span: Span,
}

/// A resource.
#[derive(Debug, Clone)]
pub struct Resource {
    /// `None`: tasks and programs stand in the CONFIGURATION itself.
    pub name: Option<Name>,
    /// The type behind ON.
    pub on: Option<Name>,
    /// VAR_GLOBAL.
    pub sections: Vec<VarSection>,
    /// TASKs.
    pub tasks: Vec<TaskDecl>,
    /// Program instances in order.
    pub programs: Vec<ProgramDecl>,
    /// From RESOURCE to END_RESOURCE.
    pub span: Span,
}

/// `TASK T(INTERVAL := T#10ms, PRIORITY := 1);`
#[derive(Debug, Clone)]
pub struct TaskDecl {
    /// Its name.
    pub name: Name,
    /// INTERVAL, PRIORITY, SINGLE and whatever else was written.
    pub properties: Vec<(Name, Expr)>,
    /// The whole declaration.
    pub span: Span,
}

/// `PROGRAM P1 WITH T : Main(in := g, out => h);`
#[derive(Debug, Clone)]
pub struct ProgramDecl {
    /// RETAIN, NON_RETAIN.
    pub qualifier: Option<(Qualifier, Span)>,
    /// The instance.
    pub name: Name,
    /// The task behind WITH.
    pub task: Option<Name>,
    /// The PROGRAM.
    pub program: Name,
    /// Connections. `fb WITH task` appears in `fb_tasks`.
    pub args: Vec<Arg>,
    /// Function block instances given to a task of their own.
    pub fb_tasks: Vec<(Expr, Name)>,
    /// The whole declaration.
    pub span: Span,
}
