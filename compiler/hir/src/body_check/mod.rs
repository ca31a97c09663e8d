//! Bodies to [`Body`](crate::body::Body): one module per notation.

pub(crate) mod il;
pub(crate) mod sfc;
mod st;

use crate::body::Body;
use crate::cx::Cx;
use crate::defs::*;
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
}

fn check<'a>(cx: &mut Cx<'a>, id: PouId, body: &'a ast::Body) -> Body {
    // An action's names are those of its POU.
    let scope = cx.defs.pous[id].owner.unwrap_or(id);
    match body {
        ast::Body::St(stmts) => st::check(cx, scope, stmts),
        ast::Body::Il(body) => il::check(cx, scope, body),
        ast::Body::Sfc(chart) => sfc::check(cx, id, scope, chart),
    }
}
