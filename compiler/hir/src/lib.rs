//! The typed, resolved form of a program. Every notation becomes this as early as possible; nothing after it knows ST, IL,
//! SFC, LD, FBD or XML.
//!
//! In: syntax trees of all files. Out: [`Defs`] with checked bodies and the [`Application`]. Memory layout, code and files
//! are the business of others.

mod access;
pub mod address;
pub mod app;
mod arguments;
pub mod body;
mod body_check;
mod call;
pub mod chart;
pub mod chart_structure;
mod collect;
mod comparison;
mod config;
mod constant;
mod consts;
mod cx;
mod cycles;
pub mod defs;
mod doubt;
mod edges;
mod expr;
mod foreign_code;
mod habits;
pub mod init;
mod initial;
mod initial_references;
mod lints;
mod literal;
pub mod network;
mod open_array;
mod operators;
mod place;
pub mod print;
mod references;
mod resolve;
mod resources;
pub mod rules;
pub mod shape;
mod sizes;
pub mod specials;
mod std_args;
mod std_bcd;
mod std_call;
pub mod structure;
mod text;
mod text_constant;
mod time_arithmetic;
pub mod types;
mod var_config;
pub mod visit;

pub use app::Application;
pub use body::Body;
pub use config::{DEFAULT_WATCHDOG_NS, Selection, TaskSelection};
pub use consts::default_scalar;
pub use cx::{Unit, elem_of, similar, type_name};
pub use cycles::calls_of;
pub use defs::*;
pub use init::Init;
pub use types::{RefKind, Type, TypeId, Types};

use plcc_diag::Diagnostics;

/// What checking gives.
#[derive(Debug)]
pub struct Checked {
    /// All declarations and bodies.
    pub defs: Defs,
    /// What is to run; `None` after an error or for a library without a PROGRAM.
    pub app: Option<Application>,
    /// Errors that profile codesys would not have: if they are all, one closing note says so (semantics.md \[P1\]).
    pub codesys_only: usize,
}

/// Checks all files: names, types, bodies, configuration. Messages go to `diags`; checking goes on behind each mistake.
pub fn check(units: &[Unit], selection: &Selection, diags: &mut Diagnostics) -> Checked {
    let mut cx = cx::Cx::new(units);
    let mistakes = diags.iter().filter(|d| d.severity() == plcc_diag::Severity::Error);
    cx.half_read = mistakes.map(|d| d.primary.span.file).collect();
    collect::collect(&mut cx, units);
    cx.resolve_all();
    edges::check_types(&mut cx);
    cycles::containment(&mut cx);
    cx.init_all();
    body_check::check_all(&mut cx);
    cycles::recursion(&mut cx);
    references::spread_addresses(&mut cx.defs);
    lints::run(&mut cx, units);
    let app = config::configure(&mut cx, units, selection);
    let doubtful = doubt::Doubtful::of(units);
    // Only behind a message of the parser: some error must remain.
    if !cx.half_read.is_empty() && !doubtful.is_empty() {
        cx.codesys_only = 0;
        cx.diags.retain(|d| !doubtful.touches(d.primary.span));
    }
    if !cx.half_read.is_empty() {
        doubt::find_unnamed(units, &mut cx.diags);
    }
    diags.append(cx.diags);
    Checked { defs: cx.defs, app, codesys_only: cx.codesys_only }
}
