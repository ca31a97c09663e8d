//! How functions of the program call each other: which of the hidden parameters and results a function has.
//!
//! `fn(region, [instance], [frame], arguments...) -> ([status], [result])`. The three pointers are addresses, so that a
//! place costs no addition; a status is there only if the function can leave with a fault.

use crate::prim::clif_type;
use cranelift_codegen::ir::{AbiParam, Signature, types};
use cranelift_codegen::isa::CallConv;
use index_vec::IndexVec;
use plcc_mir::ir::{Base, Exit, Func, FuncId, Inst, Place, Program};
use plcc_mir::verify::bottom_up;
use plcc_stdlib::fault::Fault;

/// The hidden part of a signature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Shape {
    /// Works on an instance.
    pub instance: bool,
    /// It or a callee has a frame.
    pub frame: bool,
    /// It or a callee can fault; the first result is the status.
    pub status: bool,
    /// One of these faults may be the deadline, which no call catches.
    pub deadline: bool,
}

/// The shapes of all functions.
pub fn shapes(program: &Program) -> IndexVec<FuncId, Shape> {
    let order = bottom_up(program).unwrap_or_else(|id| plcc_diag::bug!("`{}` calls itself", program.funcs[id].name));
    let mut shapes = IndexVec::from_vec(vec![Shape::default(); program.funcs.len()]);
    for id in order {
        shapes[id] = shape(&program.funcs[id], &shapes);
    }
    shapes
}

fn shape(func: &Func, shapes: &IndexVec<FuncId, Shape>) -> Shape {
    let mut shape = Shape { instance: func.has_instance, frame: func.frame_bytes > 0, ..Shape::default() };
    let in_frame = |place: &Place| place.base == Base::Frame;
    let exit_in_frame =
        |exit: &Exit| exit.instance.iter().map(|p| &**p).chain(exit.owed.iter().map(|(p, _)| p)).any(in_frame);
    for inst in func.blocks.iter().flat_map(|b| &b.insts) {
        match inst {
            Inst::Load { place, .. } | Inst::Store { place, .. } | Inst::AddressOf { place, .. } => {
                shape.frame |= in_frame(place);
            }
            Inst::Copy { dst, src, .. } => shape.frame |= in_frame(dst) || in_frame(src),
            Inst::Zero { dst, .. } => shape.frame |= in_frame(dst),
            Inst::Call { callee, instance, status, exit, .. } => {
                shape.frame |= exit.instance.as_deref().is_some_and(in_frame);
                let callee = shapes[*callee];
                shape.frame |= callee.frame || instance.as_ref().is_some_and(in_frame);
                shape.deadline |= callee.deadline;
                shape.status |= if status.is_some() { callee.deadline } else { callee.status };
            }
            Inst::CallText { texts, .. } => shape.frame |= texts.iter().any(|text| in_frame(&text.place)),
            Inst::Check { fault, exit, .. } => {
                shape.frame |= exit_in_frame(exit);
                shape.status = true;
                shape.deadline |= *fault == Fault::Deadline;
            }
            Inst::Poll { exit } => {
                shape.frame |= exit_in_frame(exit);
                shape.status = true;
                shape.deadline = true;
            }
            Inst::Const { .. } | Inst::Prim { .. } | Inst::CallRt { .. } => {}
        }
    }
    shape
}

/// The signature of a function.
pub fn signature(func: &Func, shape: Shape, call_conv: CallConv) -> Signature {
    let mut signature = Signature::new(call_conv);
    let pointers = 1 + usize::from(shape.instance) + usize::from(shape.frame);
    signature.params.extend(std::iter::repeat_n(AbiParam::new(types::I64), pointers));
    signature.params.extend(func.params.iter().map(|r| AbiParam::new(clif_type(*r))));
    if shape.status {
        signature.returns.push(AbiParam::new(types::I32));
    }
    signature.returns.extend(func.result.map(|r| AbiParam::new(clif_type(r))));
    signature
}
