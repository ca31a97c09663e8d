//! What is to run: resources, tasks, program instances (from a CONFIGURATION, or one PROGRAM without).

use crate::body::{Expr, Place};
use crate::defs::{Defs, PouId, VarId};
use crate::init::Init;
use plcc_diag::Span;
use smol_str::SmolStr;
use std::borrow::Cow;

/// The application.
#[derive(Debug, Clone, Default)]
pub struct Application {
    /// Of the CONFIGURATION; empty without one.
    pub name: SmolStr,
    /// At least one.
    pub resources: Vec<Resource>,
    /// VAR_ACCESS: names by which variables are reached from outside.
    pub access: Vec<Access>,
}

/// A variable of a program instance, through the instances in it.
pub type VarPath = Vec<VarId>;

/// `NAME : P1.x : INT READ_ONLY`.
#[derive(Debug, Clone)]
pub struct Access {
    /// The name.
    pub name: SmolStr,
    /// What it names: a path as traces write it, or an address.
    pub path: String,
    /// READ_WRITE.
    pub writable: bool,
    /// Where.
    pub span: Span,
}

/// A resource.
#[derive(Debug, Clone, Default)]
pub struct Resource {
    /// Empty without CONFIGURATION.
    pub name: SmolStr,
    /// In order of declaration. The last one may be the unnamed task of programs without a task.
    pub tasks: Vec<Task>,
    /// In order of declaration.
    pub programs: Vec<Program>,
    /// Its own globals that stand in the place of another resource's of the same name and type: that one, the own.
    pub globals: Vec<(VarId, VarId)>,
}

impl Application {
    /// The declarations as a resource sees them: a global that several resources have is its own.
    pub fn defs_of<'d>(&self, resource: usize, defs: &'d Defs) -> Cow<'d, Defs> {
        let globals = &self.resources[resource].globals;
        if globals.is_empty() {
            return Cow::Borrowed(defs);
        }
        let mut own = defs.clone();
        for (name, var) in globals {
            own.vars[*name] = defs.vars[*var].clone();
        }
        Cow::Owned(own)
    }

    /// Whether the code of a resource can use a global.
    pub fn has_global(&self, resource: usize, var: VarId, defs: &Defs) -> bool {
        let own = |v: VarId| defs.vars[v].resource.is_none_or(|r| r as usize == resource);
        own(var) || self.resources[resource].globals.iter().any(|(name, _)| *name == var)
    }
}

/// A task.
#[derive(Debug, Clone)]
pub struct Task {
    /// Its name; empty for that of programs without a task, which runs last in every base tick (semantics.md \[C1\]).
    pub name: SmolStr,
    /// Period in nanoseconds; `None`: every base tick.
    pub interval_ns: Option<i64>,
    /// Runs on its rising edge.
    pub single: Option<Place>,
    /// 0 is the highest.
    pub priority: u32,
    /// Longest execution in nanoseconds of real time.
    pub watchdog_ns: i64,
    /// The reaction time that it has to keep, nanoseconds.
    pub deadline_ns: Option<i64>,
}

/// A program instance.
#[derive(Debug, Clone)]
pub struct Program {
    /// Its name; that of the PROGRAM without CONFIGURATION.
    pub name: SmolStr,
    /// The PROGRAM.
    pub pou: PouId,
    /// Index into `tasks`.
    pub task: usize,
    /// Copied into inputs before each execution.
    pub inputs: Vec<(VarId, Expr)>,
    /// Copied from outputs after each execution.
    pub outputs: Vec<(VarId, Place)>,
    /// Variables of this instance with an address of their own (VAR_CONFIG): copied from %I and %M before, to %Q and %M
    /// after each execution.
    pub located: Vec<(VarPath, Place)>,
    /// Initial values of variables of this instance (VAR_CONFIG).
    pub initial: Vec<(VarPath, Init)>,
    /// Where.
    pub span: Span,
}
