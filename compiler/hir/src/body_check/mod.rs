//! Bodies to [`Body`](crate::body::Body): one module per notation.

pub(crate) mod il;
pub(crate) mod sfc;
pub(crate) mod st;

use crate::body::Body;
use crate::cx::Cx;
use crate::defs::*;
use crate::expr::Checker;
use crate::types::Types;
use plcc_syntax::ast;

/// Checks every body.
pub(crate) fn check_all(cx: &mut Cx) {
    for id in cx.defs.pous.indices() {
        let body = match cx.pou_slots[id].body {
            Some(body) => {
                let mut checked = check(cx, id, body);
                checked.stmts.splice(..0, crate::edges::triggers(cx, id));
                checked
            }
            None => Body::default(),
        };
        cx.defs.bodies.push(body);
    }
    sfc::write_all(cx);
}

/// Gives the variables that bring values to the next cycle the types of these values: they are read before they are assigned.
fn infer_kept(cx: &mut Cx<'_>, pou: PouId) {
    for n in 0..cx.defs.pous[pou].vars.len() {
        let var = cx.defs.pous[pou].vars[n];
        let Some((ast::TypeExpr { kind: ast::TypeExprKind::Inferred(Some(like)), .. }, _)) = cx.var_slots[var].decl
        else {
            continue;
        };
        if cx.defs.vars[var].ty != Types::ERROR {
            continue;
        }
        let trial = cx.trial();
        let mut checker = Checker { cx, scope: Some(pou), temps: Default::default() };
        let ty = checker.any_value(like).ty;
        cx.undo(trial);
        cx.defs.vars[var].ty = ty;
    }
}

fn check<'a>(cx: &mut Cx<'a>, id: PouId, body: &'a ast::Body) -> Body {
    // An action's names are those of its POU.
    let scope = cx.defs.pous[id].owner.unwrap_or(id);
    infer_kept(cx, scope);
    match body {
        ast::Body::St(stmts) => st::check(cx, scope, stmts),
        ast::Body::Il(body) => il::check(cx, scope, body),
        ast::Body::Sfc(chart) => sfc::check(cx, id, scope, chart),
        // `network::lower` comes first.
        ast::Body::Network(network) => plcc_diag::bug!("a network that was not lowered: {:?}", network.span),
    }
}
