//! Everything a program consists of in a module: its functions, the bodies of the standard library that it calls, the
//! tables, the entry points. Which module it is (memory or object) is left to the caller.

use crate::CodegenError;
use crate::compile::{Job, compile_all};
use crate::entry;
use crate::func::{Env, rt_signature, text_signature, translate};
use crate::object::Var;
use crate::shape::{shapes, signature};
use cranelift_codegen::Context;
use cranelift_codegen::ir;
use cranelift_module::{FuncId, Linkage, Module};
use index_vec::IndexVec;
use plcc_mir::ir::{Inst, Program};
use plcc_stdlib::rt::RtFn;
use plcc_stdlib::rt::strings::TextFn;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// What goes into a module besides the program.
#[derive(Default, Clone, Copy)]
pub struct Extras<'a> {
    /// The image of an executable: `main` is added.
    pub image: Option<&'a [u8]>,
    /// The table of variables: `plc_app_var` is added.
    pub vars: Option<&'a [Var]>,
}

/// The entry points that every module has.
#[derive(Debug, Clone, Copy)]
pub struct Entries {
    /// `plc_app_init`.
    pub init: FuncId,
    /// `plc_app_scan`.
    pub scan: FuncId,
}

/// A module in the making: all is declared, nothing compiled.
pub struct Declared<'a> {
    pub env: Env<'a>,
    /// Ready-made functions: the entry points.
    pub made: Vec<(FuncId, &'static str, ir::Function)>,
    pub entries: Entries,
}

/// Declares everything and defines the data.
pub fn declare<'a>(
    module: &mut dyn Module,
    program: &'a Program,
    extras: Extras,
) -> Result<Declared<'a>, CodegenError> {
    let config = module.target_config();
    let shapes = shapes(program);
    let mut ids = IndexVec::with_capacity(program.funcs.len());
    for (id, func) in program.funcs.iter_enumerated() {
        let name = format!("f{}.{}", id.index(), func.name);
        let signature = signature(func, shapes[id], config.default_call_conv);
        ids.push(module.declare_function(&name, Linkage::Local, &signature)?);
    }
    let mut rt = FxHashMap::default();
    for func in rt_functions(program) {
        let signature = rt_signature(func, module.isa(), config.default_call_conv);
        rt.insert(func.symbol, (module.declare_function(func.symbol, Linkage::Import, &signature)?, signature));
    }
    for func in text_functions(program) {
        let signature = text_signature(func, module.isa(), config.default_call_conv);
        rt.insert(func.symbol, (module.declare_function(func.symbol, Linkage::Import, &signature)?, signature));
    }
    let vectors = matches!(module.isa().name(), "x64" | "aarch64");
    let env = Env { program, config, shapes, ids, vectors, rt };
    let (made, entries) = entry::declare(module, &env, extras)?;
    Ok(Declared { env, made, entries })
}

impl Declared<'_> {
    /// What is to be compiled: the functions of the program, then the entry points.
    pub fn jobs(&self) -> Vec<Job<'_>> {
        let funcs = self.env.program.funcs.iter_enumerated().map(|(id, func)| Job {
            id: self.env.ids[id],
            name: func.name.clone(),
            build: Box::new(move |context| translate(&self.env, id, context)),
        });
        let made = self.made.iter().map(|(id, name, func)| Job {
            id: *id,
            name: (*name).to_string(),
            build: Box::new(move |_| func.clone()),
        });
        funcs.chain(made).collect()
    }
}

/// Compiles a program into a module.
pub fn define(module: &mut dyn Module, program: &Program, extras: Extras) -> Result<Entries, CodegenError> {
    let declared = declare(module, program, extras)?;
    let compiled = compile_all(module.isa(), &declared.jobs(), false)?;
    for func in &compiled {
        module.define_function_bytes(func.id, func.alignment, &func.code, &func.relocs)?;
    }
    Ok(declared.entries)
}

/// The bodies of the standard library that a program calls, in order of their symbols.
pub fn rt_functions(program: &Program) -> Vec<&'static RtFn> {
    let mut found: BTreeMap<&str, &'static RtFn> = BTreeMap::new();
    for inst in program.funcs.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.insts) {
        if let Inst::CallRt { func, .. } = inst {
            found.insert(func.symbol, func);
        }
    }
    found.into_values().collect()
}

/// The same for bodies that work on strings.
pub fn text_functions(program: &Program) -> Vec<&'static TextFn> {
    let mut found: BTreeMap<&str, &'static TextFn> = BTreeMap::new();
    for inst in program.funcs.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.insts) {
        if let Inst::CallText { func, .. } = inst {
            found.insert(func.symbol, func);
        }
    }
    found.into_values().collect()
}

/// A function of the module in the making.
pub fn function(module: &dyn Module, id: FuncId) -> ir::Function {
    let signature = module.declarations().get_function_decl(id).signature.clone();
    Context::for_function(ir::Function::with_name_signature(ir::UserFuncName::user(0, id.as_u32()), signature)).func
}
