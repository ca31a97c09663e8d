//! Code in a relocatable object file: for an executable (with `main`) or to be embedded in a C program.

use crate::module::{Extras, define};
use crate::{CodegenError, target};
use cranelift_object::{ObjectBuilder, ObjectModule};
use plcc_mir::ir::Program;

/// What an object is made for.
#[derive(Debug, Clone, Copy, Default)]
pub struct ObjectOptions<'a> {
    /// The target; `None` is the kind of machine we run on.
    pub triple: Option<&'a str>,
    /// The image of an executable. With it the object has a `main` that calls
    /// `plcc_main(argc, argv, image, image_len, plc_app_init, plc_app_scan)`.
    pub image: Option<&'a [u8]>,
    /// The variables that `plc_app_var` finds; without them there is no such function.
    pub vars: Option<&'a [Var]>,
}

/// A row of the table of variables: a `struct plc_var` of the C header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Var {
    /// Name as in `--watch`.
    pub path: String,
    /// Where in the region.
    pub offset: u32,
    /// Bytes.
    pub size: u32,
    /// Type number.
    pub ty: u16,
    /// Flags.
    pub flags: u16,
}

/// Compiles a verified program to the bytes of an object file; the same program gives the same bytes.
pub fn compile(program: &Program, options: ObjectOptions) -> Result<Vec<u8>, CodegenError> {
    let isa = target::object(options.triple)?;
    let builder = ObjectBuilder::new(isa, "plcc", cranelift_module::default_libcall_names())?;
    let mut module = ObjectModule::new(builder);
    define(&mut module, program, Extras { image: options.image, vars: options.vars })?;
    module.finish().emit().map_err(|e| CodegenError::Module(e.to_string()))
}
