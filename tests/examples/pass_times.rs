//! How long each pass of the optimiser takes on programs of growing size: `cargo run --release -p plcc-tests --example
//! pass_times`. A pass that is near-linear takes about twice as long in each next column.

use plcc_hir::Profile;
use plcc_mir::opt::passes;
use plcc_tests::compile::compile;
use std::fmt::Write;
use std::time::Instant;

type Shape = (&'static str, fn(usize) -> String);

const SHAPES: [Shape; 5] = [
    ("assignments", |n| format!("d := d + a[{}] * {n}; ", n % 10)),
    ("ifs", |n| format!("IF d > {n} THEN a[i MOD 10] := d; ELSE d := d + i; END_IF; ")),
    ("loops", |n| format!("FOR i := 0 TO 9 DO a[i] := a[i] + {n}; END_FOR; ")),
    ("nests", |n| {
        let n = n % 7;
        format!(
            "FOR i := 0 TO 3 DO WHILE j < 9 DO j := j + 1; FOR k := i TO 9 DO d := d + a[k] / (i + {n}); END_FOR; END_WHILE; END_FOR; "
        )
    }),
    ("cases", |n| format!("CASE i OF 1: d := {n}; 2..5: a[i] := d; 7: i := 2; ELSE i := i + 1; END_CASE; ")),
];

fn main() {
    for (name, shape) in SHAPES {
        let mut table: Vec<(&str, Vec<f64>)> = Vec::new();
        let mut head = String::new();
        for count in [250, 500, 1000, 2000] {
            let body: String = (0..count).map(shape).collect();
            let text = format!(
                "PROGRAM Main VAR a : ARRAY [0..9] OF DINT; d : DINT; i, j, k : INT; END_VAR\n{body}\nEND_PROGRAM\n"
            );
            let mut program = compile(&text, Profile::Strict).expect("it compiles");
            let insts = program.funcs.iter().flat_map(|f| &f.blocks).map(|b| b.insts.len()).sum::<usize>();
            let _ = write!(head, "{insts:>9}");
            for pass in passes() {
                let start = Instant::now();
                (pass.run)(&mut program);
                let ms = start.elapsed().as_secs_f64() * 1e3;
                match table.iter_mut().find(|(name, _)| *name == pass.name) {
                    Some((_, times)) if times.len() == head.len() / 9 => *times.last_mut().expect("one") += ms,
                    Some((_, times)) => times.push(ms),
                    None => table.push((pass.name, vec![ms])),
                }
            }
        }
        println!("{name:<14}{head} instructions");
        for (name, times) in table {
            let times: String = times.iter().map(|t| format!("{t:>9.1}")).collect();
            println!("  {name:<12}{times} ms");
        }
    }
}
