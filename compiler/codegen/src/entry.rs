//! The entry points of a compiled program (cli.md, "Embedding"), and `main` of an executable.
//!
//! The runtime drives linked programs, plcc the code in memory, and a C host an embedded object, all through these.

use crate::CodegenError;
use crate::func::Env;
use crate::module::{Entries, Extras, function};
use crate::object::Var;
use crate::place::memory;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{self, AbiParam, InstBuilder, Type, Value, types};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext, Switch};
use cranelift_module::{DataDescription, DataId, FuncId, Linkage, Module};
use plcc_mir::interp::{InitStep, init_steps};
use plcc_stdlib::region::{CLOCK_NS, FAULT_CODE};

type Made = Vec<(FuncId, &'static str, ir::Function)>;

/// Source of an initialisation step that clears.
const ZEROS: u32 = u32::MAX;
/// Bytes of a row of the initialisation table: offset, length, source.
const INIT_ROW: i64 = 12;
/// Bytes of a `struct plc_var`.
pub const VAR_BYTES: usize = 24;
/// Where its `path` lies.
pub const VAR_PATH: usize = 16;

/// Declares the entry points and builds them.
pub fn declare(module: &mut dyn Module, env: &Env, extras: Extras) -> Result<(Made, Entries), CodegenError> {
    let mut maker = Maker { module, made: Vec::new(), context: FunctionBuilderContext::new() };
    let bytes = i64::from(env.program.region_bytes);
    maker.export("plc_app_size", &[], Some(types::I64), |_, b, _| Some(b.ins().iconst(types::I64, bytes)))?;
    let tasks = env.program.tasks.len() as i64;
    maker.export("plc_app_task_count", &[], Some(types::I32), |_, b, _| Some(b.ins().iconst(types::I32, tasks)))?;
    let init = maker.init(env)?;
    let scan = maker.scan(env)?;
    if let Some(vars) = extras.vars {
        maker.var(vars)?;
    }
    if let Some(image) = extras.image {
        maker.main(image, init, scan)?;
    }
    Ok((maker.made, Entries { init, scan }))
}

struct Maker<'m> {
    module: &'m mut dyn Module,
    made: Made,
    context: FunctionBuilderContext,
}

impl Maker<'_> {
    /// Declares a function that C code may call and builds it; `body` gives its result, or has returned by itself.
    fn export(
        &mut self,
        name: &'static str,
        params: &[Type],
        result: Option<Type>,
        body: impl FnOnce(&mut dyn Module, &mut FunctionBuilder, &[Value]) -> Option<Value>,
    ) -> Result<FuncId, CodegenError> {
        self.function(name, Linkage::Export, params, result, body)
    }

    fn function(
        &mut self,
        name: &'static str,
        linkage: Linkage,
        params: &[Type],
        result: Option<Type>,
        body: impl FnOnce(&mut dyn Module, &mut FunctionBuilder, &[Value]) -> Option<Value>,
    ) -> Result<FuncId, CodegenError> {
        let mut signature = self.module.make_signature();
        signature.params.extend(params.iter().map(|t| AbiParam::new(*t)));
        signature.returns.extend(result.map(AbiParam::new));
        let id = self.module.declare_function(name, linkage, &signature)?;
        let mut func = function(self.module, id);
        let mut b = FunctionBuilder::new(&mut func, &mut self.context);
        let start = b.create_block();
        b.append_block_params_for_function_params(start);
        b.switch_to_block(start);
        let args = b.block_params(start).to_vec();
        let value = body(self.module, &mut b, &args);
        if value.is_some() || result.is_none() {
            b.ins().return_(value.as_slice());
        }
        b.seal_all_blocks();
        b.finalize(self.module.target_config());
        self.made.push((id, name, func));
        Ok(id)
    }

    fn data(&mut self, name: &str, align: u64, bytes: Vec<u8>) -> Result<DataId, CodegenError> {
        let id = self.module.declare_data(name, Linkage::Local, false, false)?;
        let mut data = DataDescription::new();
        data.set_align(align);
        data.define(bytes.into_boxed_slice());
        self.module.define_data(id, &data)?;
        Ok(id)
    }

    /// `plc_app_init(mem, cold)`: walks one of two tables.
    fn init(&mut self, env: &Env) -> Result<FuncId, CodegenError> {
        let mut bytes = Vec::new();
        let (cold, warm) = (init_steps(env.program, true), init_steps(env.program, false));
        let cold_rows = init_rows(&cold, &mut bytes)?;
        let warm_rows = init_rows(&warm, &mut bytes)?;
        let bytes = self.data("plcc.init.bytes", 8, or_one_byte(bytes))?;
        let cold_table = self.data("plcc.init.cold", 4, or_one_byte(cold_rows))?;
        let warm_table = self.data("plcc.init.warm", 4, or_one_byte(warm_rows))?;
        let counts = [cold.len() as i64, warm.len() as i64];
        self.export("plc_app_init", &[types::I64, types::I32], None, |module, b, args| {
            let [mem, cold] = [args[0], args[1]];
            let config = module.target_config();
            let [cold_table, warm_table, bytes] = [cold_table, warm_table, bytes].map(|d| address(module, b, d));
            let table = b.ins().select(cold, cold_table, warm_table);
            let sizes = counts.map(|n| b.ins().iconst(types::I64, n * INIT_ROW));
            let size = b.ins().select(cold, sizes[0], sizes[1]);
            let end = b.ins().iadd(table, size);
            let [head, body, clear, copy, next, done] = [(); 6].map(|()| b.create_block());
            let row = b.append_block_param(head, types::I64);
            b.ins().jump(head, &[table.into()]);

            b.switch_to_block(head);
            let more = b.ins().icmp(IntCC::UnsignedLessThan, row, end);
            b.ins().brif(more, body, &[], done, &[]);

            b.switch_to_block(body);
            let [offset, length, source] = [0, 4, 8].map(|at| {
                let field = b.ins().load(types::I32, memory(), row, at);
                b.ins().uextend(types::I64, field)
            });
            let to = b.ins().iadd(mem, offset);
            let zeros = b.ins().icmp_imm_u(IntCC::Equal, source, i64::from(ZEROS));
            b.ins().brif(zeros, clear, &[], copy, &[]);

            b.switch_to_block(clear);
            let zero = b.ins().iconst(types::I8, 0);
            b.call_memset(config, to, zero, length);
            b.ins().jump(next, &[]);

            b.switch_to_block(copy);
            let from = b.ins().iadd(bytes, source);
            b.call_memcpy(config, to, from, length);
            b.ins().jump(next, &[]);

            b.switch_to_block(next);
            let following = b.ins().iadd_imm_u(row, INIT_ROW);
            b.ins().jump(head, &[following.into()]);

            b.switch_to_block(done);
            None
        })
    }

    /// `plc_app_scan(mem, task, now_ns)`.
    fn scan(&mut self, env: &Env) -> Result<FuncId, CodegenError> {
        self.export("plc_app_scan", &[types::I64, types::I32, types::I64], Some(types::I32), |module, b, args| {
            let [mem, task, now] = [args[0], args[1], args[2]];
            let (run, nothing) = (b.create_block(), b.create_block());
            let known = b.ins().icmp_imm_u(IntCC::UnsignedLessThan, task, env.program.tasks.len() as i64);
            b.ins().brif(known, run, &[], nothing, &[]);
            b.switch_to_block(run);
            let mut switch = Switch::new();
            let mut blocks = Vec::new();
            for (n, entry) in env.program.tasks.iter().enumerate() {
                let block = b.create_block();
                switch.set_entry(n as u128, block);
                blocks.push((block, *entry));
            }
            switch.emit(b, task, nothing);
            for (n, (block, entry)) in blocks.into_iter().enumerate() {
                b.switch_to_block(block);
                let part = env.program.part_of_task(n);
                let mem = if part.start == 0 { mem } else { b.ins().iadd_imm_u(mem, i64::from(part.start)) };
                b.ins().store(memory(), now, mem, CLOCK_NS as i32);
                let zero = b.ins().iconst(types::I32, 0);
                b.ins().store(memory(), zero, mem, FAULT_CODE as i32);
                let callee = module.declare_func_in_func(env.ids[entry], b.func);
                let mut args = vec![mem];
                if env.shapes[entry].frame {
                    args.push(b.ins().iadd_imm_u(mem, i64::from(part.frame_base)));
                }
                let call = b.ins().call(callee, &args);
                let status = b.inst_results(call).first().copied();
                let status = status.unwrap_or_else(|| b.ins().iconst(types::I32, 0));
                b.ins().return_(&[status]);
            }
            b.switch_to_block(nothing);
            Some(b.ins().iconst(types::I32, 0))
        })
    }

    /// `plc_app_var(path)`: searches a sorted table, ignoring case.
    fn var(&mut self, vars: &[Var]) -> Result<(), CodegenError> {
        let mut sorted: Vec<(Vec<u8>, &Var)> = vars.iter().map(|v| (v.path.to_ascii_lowercase().into(), v)).collect();
        sorted.sort_by(|a, b| a.0.cmp(&b.0));
        let mut paths = Vec::new();
        let mut starts = Vec::new();
        for (_, var) in &sorted {
            starts.push(paths.len() as i64);
            paths.extend(var.path.bytes().filter(|c| *c != 0));
            paths.push(0);
        }
        let paths = self.data("plcc.var.paths", 1, or_one_byte(paths))?;
        let table = self.module.declare_data("plcc.var.table", Linkage::Local, false, false)?;
        let mut data = DataDescription::new();
        data.set_align(8);
        let big = self.module.isa().endianness() == ir::Endianness::Big;
        let mut rows = Vec::with_capacity(sorted.len() * VAR_BYTES);
        for (_, var) in &sorted {
            put32(&mut rows, var.offset, big);
            put32(&mut rows, var.size, big);
            put16(&mut rows, var.ty, big);
            put16(&mut rows, var.flags, big);
            rows.extend([0; 12]); // padding, and the path, which is a relocation
        }
        data.define(or_one_byte(rows).into_boxed_slice());
        let paths = self.module.declare_data_in_data(paths, &mut data);
        for (n, start) in starts.iter().enumerate() {
            data.write_data_addr((n * VAR_BYTES + VAR_PATH) as u32, paths, *start);
        }
        self.module.define_data(table, &data)?;
        let count = sorted.len() as i64;
        self.export("plc_app_var", &[types::I64], Some(types::I64), |module, b, args| {
            let table = address(module, b, table);
            search(b, args[0], table, count);
            None
        })?;
        Ok(())
    }

    /// `main(argc, argv)`: hands everything to the runtime.
    fn main(&mut self, image: &[u8], init: FuncId, scan: FuncId) -> Result<(), CodegenError> {
        let length = image.len() as i64;
        let image = self.data("plcc.image", 64, or_one_byte(image.to_vec()))?;
        let mut signature = self.module.make_signature();
        let params = [types::I32, types::I64, types::I64, types::I64, types::I64, types::I64];
        signature.params.extend(params.map(AbiParam::new));
        signature.returns.push(AbiParam::new(types::I32));
        let runtime = self.module.declare_function("plcc_main", Linkage::Import, &signature)?;
        self.export("main", &[types::I32, types::I64], Some(types::I32), |module, b, args| {
            let runtime = module.declare_func_in_func(runtime, b.func);
            let [init, scan] = [init, scan].map(|id| {
                let reference = module.declare_func_in_func(id, b.func);
                b.ins().func_addr(types::I64, reference)
            });
            let image = address(module, b, image);
            let length = b.ins().iconst(types::I64, length);
            let call = b.ins().call(runtime, &[args[0], args[1], image, length, init, scan]);
            Some(b.inst_results(call)[0])
        })?;
        Ok(())
    }
}

fn address(module: &dyn Module, b: &mut FunctionBuilder, data: DataId) -> Value {
    let global = module.declare_data_in_func(data, b.func);
    b.ins().symbol_value(types::I64, global)
}

/// Rows (offset, length, source), little-endian like the region; the bytes go behind those already there.
fn init_rows(steps: &[InitStep], bytes: &mut Vec<u8>) -> Result<Vec<u8>, CodegenError> {
    let mut rows = Vec::with_capacity(steps.len() * INIT_ROW as usize);
    for step in steps {
        let source = match &step.bytes {
            None => ZEROS,
            Some(data) => {
                let start = bytes.len();
                bytes.extend_from_slice(data);
                match u32::try_from(start) {
                    Ok(start) if start < ZEROS => start,
                    _ => return Err(CodegenError::Module("more than 4 GB of initial values".into())),
                }
            }
        };
        for field in [step.offset, step.length, source] {
            rows.extend(field.to_le_bytes());
        }
    }
    Ok(rows)
}

/// Objects may not be empty.
fn or_one_byte(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.is_empty() {
        bytes.push(0);
    }
    bytes
}

fn put32(to: &mut Vec<u8>, value: u32, big: bool) {
    to.extend(if big { value.to_be_bytes() } else { value.to_le_bytes() });
}

fn put16(to: &mut Vec<u8>, value: u16, big: bool) {
    to.extend(if big { value.to_be_bytes() } else { value.to_le_bytes() });
}

/// Binary search for a path in the table; leaves with the row or NULL.
fn search(b: &mut FunctionBuilder, path: Value, table: Value, count: i64) {
    let flags = ir::MemFlagsData::trusted();
    let [head, probe, compare, differ, equal, lower, upper, found, next, none] = [(); 10].map(|()| b.create_block());
    let (low, high) = (b.append_block_param(head, types::I64), b.append_block_param(head, types::I64));
    let at = b.append_block_param(compare, types::I64);
    let zero = b.ins().iconst(types::I64, 0);
    let all = b.ins().iconst(types::I64, count);
    b.ins().jump(head, &[zero.into(), all.into()]);

    b.switch_to_block(head);
    let more = b.ins().icmp(IntCC::UnsignedLessThan, low, high);
    b.ins().brif(more, probe, &[], none, &[]);

    b.switch_to_block(probe);
    let sum = b.ins().iadd(low, high);
    let middle = b.ins().ushr_imm_u(sum, 1);
    let distance = b.ins().imul_imm_u(middle, VAR_BYTES as i64);
    let row = b.ins().iadd(table, distance);
    let name = b.ins().load(types::I64, flags, row, VAR_PATH as i32);
    let start = b.ins().iconst(types::I64, 0);
    b.ins().jump(compare, &[start.into()]);

    b.switch_to_block(compare);
    let [mine, theirs] = [path, name].map(|text| {
        let place = b.ins().iadd(text, at);
        let c = b.ins().load(types::I8, flags, place, 0);
        let letter = b.ins().iadd_imm_s(c, -i64::from(b'A'));
        let upper_case = b.ins().icmp_imm_u(IntCC::UnsignedLessThan, letter, 26);
        let folded = b.ins().bor_imm_u(c, 0x20);
        b.ins().select(upper_case, folded, c)
    });
    let same = b.ins().icmp(IntCC::Equal, mine, theirs);
    b.ins().brif(same, equal, &[], differ, &[]);

    b.switch_to_block(equal);
    b.ins().brif(mine, next, &[], found, &[]);

    b.switch_to_block(next);
    let following = b.ins().iadd_imm_u(at, 1);
    b.ins().jump(compare, &[following.into()]);

    b.switch_to_block(differ);
    let before = b.ins().icmp(IntCC::UnsignedLessThan, mine, theirs);
    b.ins().brif(before, lower, &[], upper, &[]);

    b.switch_to_block(lower);
    b.ins().jump(head, &[low.into(), middle.into()]);

    b.switch_to_block(upper);
    let above = b.ins().iadd_imm_u(middle, 1);
    b.ins().jump(head, &[above.into(), high.into()]);

    b.switch_to_block(found);
    b.ins().return_(&[row]);

    b.switch_to_block(none);
    let null = b.ins().iconst(types::I64, 0);
    b.ins().return_(&[null]);
}
