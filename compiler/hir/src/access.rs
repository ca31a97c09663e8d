//! Who may write a place, what can be assigned, and what may be referred to (semantics.md \[S5\] \[R1\]).

use crate::body::*;
use crate::collect::charts;
use crate::defs::*;
use crate::expr::*;
use crate::types::Type;
use plcc_diag::{Diagnostic, codes};

impl Checker<'_, '_> {
    /// Reports it if a place may not be written (\[S5\]). `passed` says it goes to a VAR_IN_OUT or an output.
    pub fn check_writable(&mut self, place: &Place) -> bool {
        // Behind a reference only the path from there on counts.
        let from = place.steps.iter().rposition(|step| matches!(step, Step::Deref)).map_or(0, |n| n + 1);
        let var = match &place.root {
            Root::Var(var) if from == 0 => Some(*var),
            Root::Address(address) => {
                if address.area == Area::Input {
                    self.report(
                        Diagnostic::new(codes::NOT_WRITABLE, place.span, "an input address cannot be written")
                            .help("the process image sets %I before each scan; write to %Q or %M"),
                    );
                    return false;
                }
                return true;
            }
            _ => None,
        };
        if let Some(var) = var
            && charts::is_step(self.cx, var)
        {
            let text = self.place_text(place);
            self.report(
                Diagnostic::new(codes::NOT_WRITABLE, place.span, format!("`{text}` belongs to the chart"))
                    .help("steps are activated and left by transitions only"),
            );
            return false;
        }
        // The first member from the outside decides for instances: inputs may be written, outputs not.
        for step in &place.steps[from..] {
            match step {
                Step::Member(member) if self.cx.defs.vars[*member].section == Section::Output => {
                    let name = self.cx.defs.vars[*member].name.clone();
                    self.report(
                        Diagnostic::new(
                            codes::NOT_WRITABLE,
                            place.span,
                            format!("`{name}` is an output of the instance and cannot be assigned from outside"),
                        )
                        .help("only the function block itself writes its outputs"),
                    );
                    return false;
                }
                Step::Member(member) if self.cx.defs.vars[*member].section == Section::InOut => {
                    let name = self.cx.defs.vars[*member].name.clone();
                    self.report(
                        Diagnostic::new(
                            codes::NOT_WRITABLE,
                            place.span,
                            format!("the VAR_IN_OUT `{name}` cannot be assigned from outside"),
                        )
                        .help("connect a variable in the call, and assign that"),
                    );
                    return false;
                }
                _ => {}
            }
        }
        let Some(var) = var else { return true };
        let v = self.cx.defs.vars[var].clone();
        let (name, span) = (v.name, v.span);
        if v.constant {
            self.report(
                Diagnostic::new(codes::NOT_WRITABLE, place.span, format!("`{name}` is a CONSTANT"))
                    .also(span, "declared here")
                    .help("a constant keeps its initial value; remove CONSTANT if it is meant to change"),
            );
            return false;
        }
        if let Some(input) = self.edge_input_of(var) {
            let Var { name, span, .. } = self.cx.defs.vars[input].clone();
            self.report(
                Diagnostic::new(
                    codes::NOT_WRITABLE,
                    place.span,
                    format!("`{name}` is an edge input: inside its POU it cannot be assigned"),
                )
                .also(span, "declared here")
                .help("use a variable of its own"),
            );
            return false;
        }
        if v.section == Section::Input && v.owner == self.scope && !self.member_write(place) {
            self.report(
                Diagnostic::new(codes::INPUT_WRITTEN, place.span, format!("the input `{name}` is assigned here"))
                    .also(span, "declared as VAR_INPUT here")
                    .help("use a variable of its own for the changed value"),
            );
        }
        if v.address.is_some_and(|a| a.area == Area::Input) {
            self.report(
                Diagnostic::new(
                    codes::INPUT_WRITTEN,
                    place.span,
                    format!("`{name}` lies in %I, the next scan overwrites it"),
                )
                .also(span, "located here")
                .help("the process image sets %I before each scan"),
            );
        }
        true
    }

    /// The edge input whose pulse a variable is.
    fn edge_input_of(&self, pulse: VarId) -> Option<VarId> {
        self.cx.edges.iter().find(|(_, e)| e.pulse == pulse).map(|(input, _)| *input)
    }

    /// Whether a path leads into an instance (whose inputs anyone may write).
    fn member_write(&self, place: &Place) -> bool {
        place.steps.iter().any(|s| matches!(s, Step::Member(_)))
    }

    /// Whether values of this type can be assigned.
    pub fn assignable(&mut self, place: &Place) -> bool {
        match self.cx.defs.types.get(place.ty) {
            Type::Instance(pou) => {
                let name = self.cx.defs.pous[*pou].name.clone();
                self.report(
                    Diagnostic::new(
                        codes::NOT_WRITABLE,
                        place.span,
                        format!("an instance of `{name}` cannot be assigned"),
                    )
                    .help("assign its inputs, or pass the instance as VAR_IN_OUT"),
                );
                false
            }
            Type::AnyArray { .. } => {
                self.report(
                    Diagnostic::new(codes::NOT_WRITABLE, place.span, "an ARRAY [*] cannot be assigned as a whole")
                        .help("its size is that of the call; assign the elements in a loop"),
                );
                false
            }
            _ => true,
        }
    }

    /// Gives the range check of an assignment the name of its variable.
    pub fn name_range_check(&self, value: &mut Expr, place: &Place) {
        if let ExprKind::RangeCheck { name, .. } = &mut value.kind {
            *name = self.place_text(place);
        }
    }

    /// Whether references may point to it: not to a bit (\[R1\]).
    pub fn addressable(&mut self, place: &Place, what: &str) -> bool {
        let bit = matches!(place.steps.last(), Some(Step::Bit(_) | Step::Part(..)))
            || match &place.root {
                Root::Var(var) => {
                    place.steps.is_empty() && self.cx.defs.vars[*var].address.is_some_and(|a| a.bit.is_some())
                }
                Root::Address(a) => a.bit.is_some(),
                _ => false,
            };
        if let Root::Var(var) = place.root
            && charts::is_step(self.cx, var)
        {
            let text = self.place_text(place);
            self.report(
                Diagnostic::new(codes::NO_REFERENCE, place.span, format!("{what} cannot refer to `{text}`"))
                    .help("a step belongs to its chart; copy the value to a variable and pass that"),
            );
            return false;
        }
        if bit {
            self.report(
                Diagnostic::new(codes::NO_REFERENCE, place.span, format!("{what} cannot refer to a single bit"))
                    .help("copy it to a BOOL variable and pass that"),
            );
        }
        !bit
    }
}
