//! Runs decoded functions.

use super::op::{
    AddressSite, CheckSite, Code, FIRST_FREE, FRAME, FuncCode, INSTANCE, MAX_TEXTS, Op, REGION, Reg, specialised,
};
use crate::ir::FuncId;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr, eval};
use plcc_stdlib::region::{DEADLINE_FLAG, FAULT_CODE, FAULT_INSTANCE, FAULT_OPERANDS, FAULT_SOURCE};
use plcc_stdlib::rt::strings::Text;
use std::sync::atomic::{AtomicU32, Ordering};

/// A caller that waits for its callee.
#[derive(Debug, Clone, Copy)]
pub struct Activation {
    func: FuncId,
    /// The operation behind the call.
    next: u32,
    /// Number of the call site in `func`.
    site: u32,
    /// Its first register in the array of all.
    base: u32,
}

/// How many arguments a body of the standard library may have.
const MAX_RT_ARGS: usize = 16;

/// Runs `entry` to its end or to an uncaught fault, whose number it returns. With `COUNT` it counts the operations; without,
/// that costs nothing.
pub fn run<const COUNT: bool>(
    code: &Code,
    registers: &mut [u64],
    calls: &mut Vec<Activation>,
    mem: &mut [u8],
    entry: FuncId,
    frame: u32,
    operations: &mut u64,
) -> u32 {
    calls.clear();
    let mut func_id = entry;
    let mut func: &FuncCode = &code[func_id];
    let mut base = 0usize;
    // The registers of the running function, and behind them those of its callee.
    let mut regs: &mut [u64] = &mut registers[..];
    enter(func, regs, 0, u64::from(frame));
    let mut pc = 0usize;

    macro_rules! get {
        ($reg:expr) => {
            regs[$reg as usize]
        };
    }
    macro_rules! fault {
        ($site:expr, $operands:expr) => {{
            let site: &CheckSite = &func.checks[$site as usize];
            let own = || if func.has_instance { get!(INSTANCE) as u32 } else { 0 };
            let mut instance = site.instance.as_ref().map_or_else(own, |place| place_address(place, regs) as u32);
            pay(site, regs, mem);
            record(mem, site, instance, $operands);
            // Leaves one caller after the other until one catches the fault.
            loop {
                let Some(caller) = calls.pop() else { return site.fault.number() };
                func_id = caller.func;
                func = &code[func_id];
                base = caller.base as usize;
                regs = &mut registers[base..];
                let call = &func.calls[caller.site as usize];
                if let Some(status) = call.status
                    && site.fault != Fault::Deadline
                {
                    get!(status) = u64::from(site.fault.number());
                    if let Some(dst) = call.dst {
                        get!(dst) = 0;
                    }
                    mem[FAULT_CODE as usize..][..4].fill(0);
                    pc = caller.next as usize;
                    break;
                }
                // A function without an instance faults on behalf of the one that called it.
                if instance == 0 {
                    let own = || if func.has_instance { get!(INSTANCE) as u32 } else { 0 };
                    instance = call.fault_instance.as_ref().map_or_else(own, |place| place_address(place, regs) as u32);
                    mem[FAULT_INSTANCE as usize..][..4].copy_from_slice(&instance.to_le_bytes());
                }
            }
        }};
    }
    macro_rules! return_with {
        ($value:expr) => {{
            let value: Option<u64> = $value;
            let Some(caller) = calls.pop() else { return 0 };
            func_id = caller.func;
            func = &code[func_id];
            base = caller.base as usize;
            regs = &mut registers[base..];
            pc = caller.next as usize;
            let call = &func.calls[caller.site as usize];
            if let (Some(dst), Some(value)) = (call.dst, value) {
                get!(dst) = value;
            }
            if let Some(status) = call.status {
                get!(status) = 0;
            }
        }};
    }
    macro_rules! dispatch {
        (
            binary { $($b:ident $bop:ident $brepr:ident,)* }
            compare { $($c:ident $br:ident $cop:ident $crepr:ident,)* }
            unary { $($u:ident $uop:ident $(($uto:ident))? $urepr:ident,)* }
        ) => {
            match func.ops[pc] {
                $(Op::$b(dst, a, b) => get!(dst) = eval(PrimOp::$bop, Repr::$brepr, &[get!(a), get!(b)]),)*
                $(Op::$c(dst, a, b) => get!(dst) = eval(PrimOp::$cop, Repr::$crepr, &[get!(a), get!(b)]),)*
                $(Op::$br(a, b, then, otherwise) => {
                    let truth = eval(PrimOp::$cop, Repr::$crepr, &[get!(a), get!(b)]);
                    pc = if truth != 0 { then } else { otherwise } as usize;
                    continue;
                })*
                $(Op::$u(dst, a) => get!(dst) = eval(PrimOp::$uop $((Repr::$uto))?, Repr::$urepr, &[get!(a)]),)*
                Op::Select(dst, c, a, b) => {
                    debug_assert!(get!(c) <= 1, "a truth value is 0 or 1");
                    get!(dst) = if get!(c) != 0 { get!(a) } else { get!(b) };
                }
                Op::Prim(site) => {
                    let site = &func.prims[site as usize];
                    let args = site.args.map(|arg| get!(arg));
                    get!(site.dst) = eval(site.op, site.repr, &args[..site.count as usize]);
                }
                Op::Move(dst, src) => get!(dst) = get!(src),
                Op::Truth(dst, src) => get!(dst) = u64::from(get!(src) != 0),
                Op::Load8(dst, at, offset) => {
                    get!(dst) = u64::from(u8::from_le_bytes(*bytes(mem, get!(at), offset)));
                }
                Op::Load16(dst, at, offset) => {
                    get!(dst) = u64::from(u16::from_le_bytes(*bytes(mem, get!(at), offset)));
                }
                Op::Load32(dst, at, offset) => {
                    get!(dst) = u64::from(u32::from_le_bytes(*bytes(mem, get!(at), offset)));
                }
                Op::Load64(dst, at, offset) => get!(dst) = u64::from_le_bytes(*bytes(mem, get!(at), offset)),
                Op::LoadBit(dst, at, offset, bit) => {
                    get!(dst) = u64::from(bytes::<1>(mem, get!(at), offset)[0] >> bit & 1);
                }
                Op::Store8(src, at, offset) => *bytes(mem, get!(at), offset) = (get!(src) as u8).to_le_bytes(),
                Op::Store16(src, at, offset) => *bytes(mem, get!(at), offset) = (get!(src) as u16).to_le_bytes(),
                Op::Store32(src, at, offset) => *bytes(mem, get!(at), offset) = (get!(src) as u32).to_le_bytes(),
                Op::Store64(src, at, offset) => *bytes(mem, get!(at), offset) = get!(src).to_le_bytes(),
                Op::StoreBit(src, at, offset, bit) => {
                    let byte = &mut bytes::<1>(mem, get!(at), offset)[0];
                    *byte = *byte & !(1 << bit) | (get!(src) as u8 & 1) << bit;
                }
                Op::Index(dst, from, value, stride) => {
                    get!(dst) = get!(from).wrapping_add(get!(value).wrapping_mul(u64::from(stride)));
                }
                Op::Offset(dst, from, low, high) => {
                    get!(dst) = get!(from).wrapping_add(u64::from(high) << 32 | u64::from(low));
                }
                Op::Address(dst, from, offset) => get!(dst) = u64::from(address(get!(from), offset) as u32),
                Op::Copy(site) => {
                    let site = func.blocks[site as usize];
                    let count = u64::from(site.bytes);
                    let src = range(mem, address(get!(site.src.0), site.src.1), count);
                    let dst = range(mem, address(get!(site.dst.0), site.dst.1), count);
                    mem.copy_within(src, dst.start);
                }
                Op::Zero(site) => {
                    let site = func.blocks[site as usize];
                    let dst = range(mem, address(get!(site.dst.0), site.dst.1), u64::from(site.bytes));
                    mem[dst].fill(0);
                }
                Op::Call(site) => {
                    let call = &func.calls[site as usize];
                    let callee = &code[call.callee];
                    let size = func.registers as usize;
                    let frame = get!(FRAME) + u64::from(func.frame_bytes);
                    let instance = call.instance.map_or(0, |(at, offset)| address(get!(at), offset));
                    for (here, there) in &call.args {
                        regs[size + *there as usize] = get!(*here);
                    }
                    calls.push(Activation { func: func_id, next: pc as u32 + 1, site, base: base as u32 });
                    func_id = call.callee;
                    func = callee;
                    base += size;
                    regs = &mut registers[base..];
                    enter(func, regs, instance, frame);
                    pc = 0;
                    continue;
                }
                Op::CallRt(site) => {
                    let call = &func.rt_calls[site as usize];
                    let mut args = [0u64; MAX_RT_ARGS];
                    for (to, from) in args.iter_mut().zip(&call.args) {
                        *to = get!(*from);
                    }
                    get!(call.dst) = (call.func.eval)(&args[..call.args.len()]);
                }
                Op::CallText(site) => {
                    let call = &func.text_calls[site as usize];
                    let mut texts = [Text { at: 0, capacity: 0 }; MAX_TEXTS];
                    for (to, (base, offset, capacity)) in texts.iter_mut().zip(&call.texts) {
                        let at = address(get!(*base), *offset);
                        *to = Text { at: at as u32, capacity: get!(*capacity) as u32 };
                    }
                    let mut args = [0u64; MAX_RT_ARGS];
                    for (to, from) in args.iter_mut().zip(&call.args) {
                        *to = get!(*from);
                    }
                    let (texts, args) = (&texts[..call.texts.len()], &args[..call.args.len()]);
                    get!(call.dst) = (call.func.eval)(mem, texts, args);
                }
                Op::CheckTrue(value, site) => {
                    if get!(value) == 0 {
                        let operands = from_registers(regs, &func.checks[site as usize].operands);
                        fault!(site, operands);
                        continue;
                    }
                }
                Op::CheckWithin(value, site) => {
                    let (value, check) = (get!(value) as i64, &func.checks[site as usize]);
                    if !(check.low..=check.high).contains(&value) {
                        fault!(site, [value, check.low, check.high]);
                        continue;
                    }
                }
                Op::Poll(site) => {
                    if deadline_expired(mem) {
                        fault!(site, [0; 3]);
                        continue;
                    }
                }
                Op::Jump(to) => {
                    pc = to as usize;
                    continue;
                }
                Op::Branch(cond, then, otherwise) => {
                    pc = if get!(cond) != 0 { then } else { otherwise } as usize;
                    continue;
                }
                Op::Switch(value, site) => {
                    let site = &func.switches[site as usize];
                    pc = match site.labels.binary_search(&get!(value)) {
                        Ok(n) => site.targets[n],
                        Err(_) => site.default,
                    } as usize;
                    continue;
                }
                Op::Return => {
                    return_with!(None);
                    continue;
                }
                Op::ReturnValue(value) => {
                    return_with!(Some(get!(value)));
                    continue;
                }
            }
        };
    }

    loop {
        if COUNT {
            *operations += 1;
        }
        specialised!(dispatch);
        pc += 1;
    }
}

/// Sets the fixed registers and the constants.
fn enter(func: &FuncCode, regs: &mut [u64], instance: u64, frame: u64) {
    regs[REGION as usize] = 0;
    regs[INSTANCE as usize] = instance;
    regs[FRAME as usize] = frame;
    regs[FIRST_FREE as usize..][..func.constants.len()].copy_from_slice(&func.constants);
}

fn address(base: u64, offset: i32) -> u64 {
    base.wrapping_add_signed(i64::from(offset))
}

fn bytes<const N: usize>(mem: &mut [u8], base: u64, offset: i32) -> &mut [u8; N] {
    let at = address(base, offset);
    let size = mem.len();
    match mem.get_mut(at as usize..).and_then(|tail| tail.first_chunk_mut()) {
        Some(chunk) => chunk,
        None => outside(at, N as u64, size),
    }
}

fn place_address(place: &AddressSite, regs: &[u64]) -> u64 {
    let start = regs[place.base as usize].wrapping_add_signed(place.offset);
    let step =
        |at: u64, (value, stride): &(Reg, u32)| at.wrapping_add(regs[*value as usize].wrapping_mul(u64::from(*stride)));
    place.terms.iter().fold(start, step)
}

/// Does the stores that a fault owes.
#[cold]
fn pay(site: &CheckSite, regs: &[u64], mem: &mut [u8]) {
    for (place, value, count, bit) in &site.owed {
        let (at, value) = (place_address(place, regs), regs[*value as usize]);
        let target = range(mem, at, u64::from(*count));
        match bit {
            Some(bit) => mem[target.start] = mem[target.start] & !(1 << bit) | (value as u8 & 1) << bit,
            None => mem[target].copy_from_slice(&value.to_le_bytes()[..*count as usize]),
        }
    }
}

fn range(mem: &[u8], at: u64, count: u64) -> std::ops::Range<usize> {
    match at.checked_add(count) {
        Some(end) if end <= mem.len() as u64 => at as usize..end as usize,
        _ => outside(at, count, mem.len()),
    }
}

#[cold]
fn outside(at: u64, count: u64, size: usize) -> ! {
    plcc_diag::bug!("{count} bytes at {} are outside the region of {size}", at as i64)
}

fn from_registers(regs: &[u64], operands: &[Reg]) -> [i64; 3] {
    let mut values = [0; 3];
    for (to, from) in values.iter_mut().zip(operands) {
        *to = regs[*from as usize] as i64;
    }
    values
}

/// Another thread sets the flag while the scan runs.
fn deadline_expired(mem: &mut [u8]) -> bool {
    let flag = mem[DEADLINE_FLAG as usize..][..4].as_mut_ptr().cast::<u32>();
    assert!(flag.is_aligned(), "the region is not aligned");
    // SAFETY: four bytes of the region, aligned, valid while `mem` is borrowed.
    let flag = unsafe { AtomicU32::from_ptr(flag) };
    flag.load(Ordering::Relaxed) != 0
}

/// Writes the fault record; operands that a fault does not have are 0.
#[cold]
fn record(mem: &mut [u8], site: &CheckSite, instance: u32, operands: [i64; 3]) {
    let mut write = |at: u32, bytes: &[u8]| mem[at as usize..][..bytes.len()].copy_from_slice(bytes);
    write(FAULT_CODE, &site.fault.number().to_le_bytes());
    write(FAULT_SOURCE, &site.source.to_le_bytes());
    write(FAULT_INSTANCE, &instance.to_le_bytes());
    for (n, operand) in operands.iter().enumerate() {
        write(FAULT_OPERANDS + 8 * n as u32, &operand.to_le_bytes());
    }
}
