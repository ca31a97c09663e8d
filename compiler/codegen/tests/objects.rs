//! Objects: linked with a C program and run, the same for the same input, and for every target.

mod support;

use plcc_codegen::object::{self, ObjectOptions, Var};
use plcc_codegen::{header, text};
use plcc_mir::build::Builder;
use plcc_mir::ir::{Base, FuncId, Place, Program};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use std::path::PathBuf;
use std::process::Command;
use support::{check, global, program, segment, task};

/// A function with a check, an instance and a frame, called by two tasks; retained counter at 64.
fn sample() -> Program {
    let mut b = Builder::new("Count", &[Repr::I64], Some(Repr::I64), true);
    let limit = b.params()[0];
    let n = b.load(Repr::I64, Place::new(Base::Instance, 0), false);
    let one = b.number(Repr::I64, 1);
    let n = b.op(PrimOp::Add, Repr::I64, &[n, one]);
    b.store(Place::new(Base::Frame, 8), n);
    let ok = b.op(PrimOp::LeS, Repr::I64, &[n, limit]);
    b.check_true(ok, Fault::SubrangeViolation, &[n, one, limit]);
    b.store(Place::new(Base::Instance, 0), n);
    b.poll();
    let root = b.op(PrimOp::SToF(Repr::F64), Repr::I64, &[n]);
    let root = b.op(PrimOp::FSqrt, Repr::F64, &[root]);
    let up = b.op(PrimOp::FCeil, Repr::F64, &[root]);
    b.store(global(64), up);
    b.copy(global(200), global(300), 100);
    b.ret(Some(n));
    let count = b.finish(32);
    let mut tasks = Vec::new();
    for (at, limit) in [(0, 1000u64), (0, 3)] {
        let mut b = task("task");
        let limit = b.number(Repr::I64, limit);
        let n = b.call(FuncId::from_raw(0), Some(global(at)), &[limit], Some(Repr::I64)).expect("a result");
        b.store(global(16), n);
        b.ret(None);
        tasks.push(b.finish(0));
    }
    let second = tasks.pop().expect("two tasks");
    let first = tasks.pop().expect("two tasks");
    let mut program = program(vec![count, first, second], 2);
    program.initial = vec![segment(64, &5u64.to_le_bytes()), segment(96, b"plc")];
    program.retain = vec![(64, 8)];
    check(&program);
    program
}

fn vars() -> Vec<Var> {
    let var = |path: &str, offset, size, ty| Var { path: path.into(), offset, size, ty, flags: 1 };
    vec![
        var("Main.count", 64, 8, 4),
        var("Main.a[1]", 80, 2, 2),
        var("main.Result", 80, 8, 4),
        var("Main.a[10]", 90, 2, 2),
        var("_x", 96, 1, 0),
    ]
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("plcc-codegen-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder for temporary files");
        Folder(path)
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.0.join(name), bytes).expect("written");
    }

    /// Runs a command here; `None` if there is no such tool.
    fn run(&self, command: &str, args: &[&str]) -> Option<std::process::Output> {
        match Command::new(command).args(args).current_dir(&self.0).output() {
            Ok(output) => Some(output),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => None,
            Err(e) => panic!("{command}: {e}"),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const HOST: &str = r#"
#include "app.h"
#include <stdio.h>
#include <string.h>
#include <stdlib.h>
#define CHECK(x) do { if (!(x)) { printf("line %d: %s\n", __LINE__, #x); exit(1); } } while (0)

static long long i64(unsigned char *m, int at) { long long v; memcpy(&v, m + at, 8); return v; }
static unsigned u32(unsigned char *m, int at) { unsigned v; memcpy(&v, m + at, 4); return v; }

int main(void) {
    static _Alignas(64) unsigned char mem[PLC_APP_SIZE];
    CHECK(sizeof(struct plc_var) == 24);
    CHECK(plc_app_size() == PLC_APP_SIZE && plc_app_task_count() == PLC_APP_TASK_COUNT && PLC_APP_TASK_COUNT == 2);
    memset(mem, 0x77, sizeof mem);
    plc_app_init(mem, 1);
    CHECK(i64(mem, 64) == 5 && !memcmp(mem + 96, "plc", 4) && mem[sizeof mem - 1] == 0);
    for (int n = 0; n < 4; n++) CHECK(plc_app_scan(mem, 0, 10 + n) == 0);
    CHECK(i64(mem, 64) == 9 && i64(mem, 80) == 9 && i64(mem, 8) == 13);
    double up; memcpy(&up, mem + 128, 8); CHECK(up == 3.0);
    CHECK(plc_app_scan(mem, 1, 50) == 3 && u32(mem, 4) == 3 && u32(mem, 20) == 64);
    CHECK(i64(mem, 24) == 10 && i64(mem, 32) == 1 && i64(mem, 40) == 3);
    mem[96] = 'x';
    plc_app_init(mem, 0);
    CHECK(i64(mem, 64) == 9 && mem[96] == 'p' && u32(mem, 4) == 0);
    *(unsigned *)mem = 1;
    CHECK(plc_app_scan(mem, 0, 0) == 8);
    CHECK(plc_app_scan(mem, 2, 0) == 0);
    const struct plc_var *v = plc_app_var("MAIN.RESULT");
    CHECK(v && v->offset == 80 && v->size == 8 && v->type == 4 && v->flags == 1 && !strcmp(v->path, "main.Result"));
    const char *there[] = {"Main.count", "main.a[1]", "main.A[10]", "_X"};
    const char *missing[] = {"", "Main", "Main.count2", "Main.a[1", "Main.a[2]", "zzz", "_y", "^x", "@"};
    for (int n = 0; n < 4; n++) CHECK(plc_app_var(there[n]));
    for (int n = 0; n < 9; n++) CHECK(!plc_app_var(missing[n]));
    puts("ok");
    return 0;
}
"#;

#[test]
fn embedded_in_a_c_program() {
    let (program, vars) = (sample(), vars());
    let bytes =
        object::compile(&program, ObjectOptions { vars: Some(&vars), ..Default::default() }).expect("an object");
    let folder = Folder::new("embed");
    folder.write("app.o", &bytes);
    folder.write(
        "app.h",
        header::header("my app", program.region_bytes, &["fast", "slow"], &program.retain, &[]).as_bytes(),
    );
    folder.write("host.c", HOST.as_bytes());
    let flags = ["-std=c11", "-Wall", "-Wextra", "-pedantic", "-Werror", "host.c", "app.o", "-o", "host", "-lm"];
    let Some(built) = folder.run("cc", &flags) else { return eprintln!("no C compiler: skipped") };
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let ran = folder.run("./host", &[]).expect("the program");
    assert_eq!(String::from_utf8_lossy(&ran.stdout), "ok\n", "{}", String::from_utf8_lossy(&ran.stderr));

    // Nothing undefined but the families of libm and memcpy.
    if let Some(names) = folder.run("nm", &["-u", "app.o"]) {
        let allowed = ["memcpy", "memset", "memmove", "ceil", "floor", "trunc", "nearbyint", "_GLOBAL_OFFSET_TABLE_"];
        for line in String::from_utf8_lossy(&names.stdout).lines() {
            let name = line.trim().trim_start_matches("U ");
            assert!(allowed.contains(&name), "{name} is undefined");
        }
    }
}

const RUNTIME: &str = r#"
#include <stdint.h>
#include <stdio.h>
#include <string.h>
int plcc_main(int argc, char **argv, const unsigned char *image, size_t length,
              void (*init)(void *, int), uint32_t (*scan)(void *, uint32_t, int64_t)) {
    static _Alignas(64) unsigned char mem[4096];
    init(mem, 1);
    uint32_t status = scan(mem, 0, 7);
    printf("%d %s %.*s %u %d\n", argc, argv[1], (int)length, (const char *)image, status, mem[64]);
    return 5;
}
"#;

#[test]
fn executable() {
    let image = Some(&b"the image"[..]);
    let bytes = object::compile(&sample(), ObjectOptions { image, ..Default::default() }).expect("an object");
    let folder = Folder::new("main");
    folder.write("app.o", &bytes);
    folder.write("runtime.c", RUNTIME.as_bytes());
    let Some(built) = folder.run("cc", &["runtime.c", "app.o", "-o", "app", "-lm"]) else {
        return eprintln!("no C compiler: skipped");
    };
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let ran = folder.run("./app", &["--flag"]).expect("the program");
    assert_eq!(String::from_utf8_lossy(&ran.stdout), "2 --flag the image 0 6\n");
    assert_eq!(ran.status.code(), Some(5));
}

#[test]
fn the_same_bytes_again_for_every_target() {
    // Many functions, so that they are compiled side by side.
    let mut program = sample();
    let count = program.funcs[0].clone();
    for _ in 0..40 {
        program.funcs.push(count.clone());
    }
    let vars = vars();
    for triple in ["x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu", "riscv64gc-unknown-linux-gnu"] {
        let options = ObjectOptions { triple: Some(triple), image: Some(b"image"), vars: Some(&vars) };
        let first = object::compile(&program, options).expect(triple);
        for _ in 0..3 {
            assert!(object::compile(&program, options).expect(triple) == first, "{triple}");
        }
        let asm = text::emit_asm(&program, Some(triple)).expect(triple);
        assert!(asm.contains("Count"), "{asm}");
    }
    let clif = text::emit_clif(&program, None).expect("CLIF");
    assert!(clif.contains("load.i64") && clif.contains("; u0:0 Count"), "{clif}");
}

#[test]
fn unknown_targets_are_refused() {
    for triple in ["nonsense", "", "sparc64-unknown-linux-gnu", "i686-unknown-linux-gnu", "wasm32-unknown-unknown"] {
        let error = object::compile(&sample(), ObjectOptions { triple: Some(triple), ..Default::default() });
        assert!(matches!(error, Err(plcc_codegen::CodegenError::Target(_))), "{triple}");
    }
}
