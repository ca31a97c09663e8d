//! Random Sequential Function Charts against an independent model of their semantics (`model.rs`): after every scan the flags
//! and times of all steps, the BOOL actions, the runs of all action bodies and their order are the same in the model, the
//! interpreter and native code (JIT), and the traces of linked programs are those of the interpreter.
//!
//! `RANDOM_CHARTS` (default 600) says how many, `RANDOM_CHARTS_LINKED` (default 60) how many of them are linked too,
//! `RANDOM_CHARTS_PASSES` (default 50) how many run before and after each pass of the optimiser, `RANDOM_SEED` where to start. A failure prints the seed and the chart that differs; `RANDOM_KEEP` names a file for its program.

mod generate;
mod model;
mod structure;

use generate::{Form, Stimulus};
use model::{ActionKind, Chart, Model, Time};
use plcc_hir::{Checked, Profile, Type};
use plcc_mir::interp::Interp;
use plcc_mir::layout::{Layout, Slot};
use plcc_tests::memory::{bytes_of, region};
use plcc_tests::passes::{Run, agree as passes_agree};
use plcc_tests::reduce::reduce;
use plcc_tests::{command, compile::compile, compile::compile_with_layout};
use std::path::Path;
use std::time::Duration;
use structure::Ruled;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");
const CYCLES: i64 = 60;
const TICK_NS: i64 = 10_000_000;
/// Charts in one program: most of the time goes into reading and compiling, and much of that is the same for all.
const BATCH: u64 = 25;

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// Charts that are fed by one stimulus.
struct Batch {
    seed: u32,
    charts: Vec<(Chart, Form)>,
    text: String,
    profile: Profile,
}

/// Charts for one program; those that are `built` by plcc are without errors in their structure.
fn batch(seed: u64, count: u64, built: bool) -> Batch {
    let mut random = fastrand::Rng::with_seed(seed);
    let profile = if random.u8(..3) == 0 { Profile::Codesys } else { Profile::Strict };
    let stimulus = random.u32(..);
    let mut text = generate::stimulus_text(stimulus);
    let mut instances = "  PROGRAM In WITH T : Stimulus;\n".to_string();
    let mut charts = Vec::new();
    for n in 0..count {
        let (mut chart, form) = generate::chart(&mut random);
        while built && !Ruled::new(&chart).compiles() {
            (chart, _) = generate::chart(&mut random);
        }
        chart.final_scan = profile == Profile::Codesys;
        text.push_str(&generate::text(&chart, form, &format!("P{n}_"), &mut random));
        instances.push_str(&format!("  PROGRAM I{n} WITH T : P{n}_Main;\n"));
        charts.push((chart, form));
    }
    text.push_str(&format!(
        "CONFIGURATION C\n RESOURCE R ON PLC\n  TASK T(INTERVAL := T#10ms, PRIORITY := 1);\n{instances} END_RESOURCE\n\
         END_CONFIGURATION\n"
    ));
    Batch { seed: stimulus, charts, text, profile }
}

/// Where the variables of a chart lie.
struct Places {
    /// Of each step `X` and `T`.
    steps: Vec<[u32; 2]>,
    actions: Vec<u32>,
    log: u32,
}

impl Places {
    fn find(checked: &Checked, layout: &Layout, n: usize, chart: &Chart, form: Form) -> Self {
        let defs = &checked.defs;
        let variable = |pou: &str, name: &str, instance: u32| -> u32 {
            let pou = defs.pous.iter().find(|p| p.name == pou).unwrap_or_else(|| panic!("no {pou}"));
            let var = pou.vars.iter().copied().find(|v| defs.vars[*v].name == name);
            let var = var.unwrap_or_else(|| panic!("no {name}"));
            match layout.slot(var) {
                Some(Slot::Instance(offset)) => instance + offset,
                Some(Slot::Region(offset, _)) => offset,
                slot => panic!("{name} lies at {slot:?}"),
            }
        };
        let mut pou = format!("P{n}_Main");
        // The stimulus is the first program.
        let mut instance = layout.program(n + 1);
        if form == Form::Block {
            instance = variable(&pou, "s", instance);
            pou = format!("P{n}_Seq");
        }
        let own = |name: String| variable(&pou, &name, instance);
        let step = |name: String| -> [u32; 2] {
            let def = defs.pous.iter().find(|p| p.name == pou);
            let var = def.and_then(|p| p.vars.iter().find(|v| defs.vars[**v].name == name));
            let Some(Type::Struct(id)) = var.map(|v| &defs.types[defs.vars[*v].ty]) else { panic!("no step {name}") };
            let field = |wanted: &str| {
                let index = defs.structs[*id].fields.iter().position(|f| f.name == wanted);
                layout.field(*id, index.unwrap_or_else(|| panic!("no {wanted}")) as u32)
            };
            let at = own(name);
            [at + field("X"), at + field("T")]
        };
        Places {
            steps: (0..chart.steps.len()).map(|s| step(format!("S{s}"))).collect(),
            actions: (0..chart.actions.len())
                .map(|a| match chart.actions[a] {
                    ActionKind::Block => own(format!("n{a}")),
                    ActionKind::Flag => own(format!("a{a}")),
                })
                .collect(),
            log: own("log".into()),
        }
    }

    /// What memory says about the chart, and what the model says.
    fn differences(&self, memory: &[u8], model: &Model, chart: &Chart) -> Vec<String> {
        let word = |at: u32| {
            let at = at as usize;
            u64::from_le_bytes(memory[at..at + 8].try_into().expect("eight bytes"))
        };
        let mut found = Vec::new();
        let mut compare = |name: String, got: u64, wanted: u64| {
            if got != wanted {
                found.push(format!("{name} is {got}, the model says {wanted}"));
            }
        };
        for (s, [x, t]) in self.steps.iter().enumerate() {
            compare(format!("S{s}.X"), u64::from(memory[*x as usize]), u64::from(model.x[s]));
            compare(format!("S{s}.T"), word(*t), model.t[s] as u64);
        }
        for (a, at) in self.actions.iter().enumerate() {
            match chart.actions[a] {
                ActionKind::Block => compare(format!("n{a}"), word(*at), model.runs[a]),
                ActionKind::Flag => {
                    compare(format!("a{a}"), u64::from(memory[*at as usize]), u64::from(model.flags[a]));
                }
            }
        }
        compare("log".into(), word(self.log), model.log);
        found
    }
}

/// What was seen in all runs, so that the generator does not become lazy unnoticed.
#[derive(Default)]
struct Seen {
    charts: u64,
    /// Scans in which the marking changed.
    moves: u64,
    /// Runs of action bodies.
    runs: u64,
    /// Charts whose structure was analysed to the end, and those without errors in it.
    proved: u64,
    sound: u64,
}

/// Runs a batch on the model, the interpreter and native code; `Err` has the number of the chart and what differs.
fn agree(batch: &Batch, seen: &mut Seen) -> Result<(), (usize, String)> {
    let all = |e: String| (usize::MAX, e);
    let (checked, program, layout) = compile_with_layout(&batch.text, batch.profile).map_err(all)?;
    let mut interp = Interp::new(&program);
    let code = plcc_codegen::jit::compile(&program).map_err(|e| all(format!("{e:?}")))?;
    let size = program.region_bytes as usize;
    let (mut a, mut b) = (region(size), region(size));
    let (a, b) = (&mut bytes_of(&mut a)[..size], &mut bytes_of(&mut b)[..size]);
    interp.init(a, true);
    code.init(b, true);
    let list = batch.charts.iter().enumerate();
    let places: Vec<Places> = list.map(|(n, (c, form))| Places::find(&checked, &layout, n, c, *form)).collect();
    let ruled: Vec<Ruled> = batch.charts.iter().map(|(c, _)| Ruled::new(c)).collect();
    let mut models: Vec<Model> = batch.charts.iter().map(|(c, _)| Model::new(c)).collect();
    let mut stimulus = Stimulus::new(batch.seed);
    for cycle in 1..=CYCLES {
        let now: Time = (cycle - 1) * TICK_NS;
        let (inputs, enabled) = stimulus.next(now);
        let (x, y) = (interp.scan(a, 0, now), code.scan(b, 0, now));
        if (x, y) != (0, 0) {
            return Err(all(format!("cycle {cycle}: interpreter {x}, native {y}")));
        }
        for (n, (chart, form)) in batch.charts.iter().enumerate() {
            let before = models[n].x.clone();
            if enabled || *form == Form::Program {
                models[n].call(&inputs);
            }
            seen.moves += u64::from(models[n].x != before);
            if let Some(what) = ruled[n].contradiction(chart, &models[n]) {
                return Err((n, format!("cycle {cycle}: the structure analysis is wrong: {what}")));
            }
            for (engine, memory) in [("interpreter", &*a), ("native code", &*b)] {
                let differences = places[n].differences(memory, &models[n], chart);
                if !differences.is_empty() {
                    return Err((n, format!("cycle {cycle}, {engine}:\n{}", differences.join("\n"))));
                }
            }
        }
    }
    seen.charts += models.len() as u64;
    seen.proved += ruled.iter().filter(|r| r.complete()).count() as u64;
    seen.sound += ruled.iter().filter(|r| r.compiles()).count() as u64;
    seen.runs += models.iter().flat_map(|m| &m.runs).sum::<u64>();
    Ok(())
}

fn fail(seed: u64, batch: &Batch, n: usize, what: &str) -> ! {
    let chart = match batch.charts.get(n) {
        Some((chart, form)) => format!("{form:?} {chart:#?}"),
        None => String::new(),
    };
    if let Some(path) = std::env::var_os("RANDOM_KEEP") {
        let _ = std::fs::write(path, &batch.text);
    }
    let start = batch.text.find(&format!(" P{n}_")).unwrap_or(0);
    let end =
        batch.text[start + 1..].find(&format!(" P{}_", n.wrapping_add(1))).map_or(batch.text.len(), |e| start + e);
    panic!("seed {seed}, chart {n}, {:?}: {what}\n{}\n{chart}", batch.profile, &batch.text[start..end]);
}

#[test]
fn engines_agree_with_the_model() {
    let (count, first) = (setting("RANDOM_CHARTS", 600), setting("RANDOM_SEED", 1));
    let batches = count.div_ceil(BATCH);
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get() as u64).min(batches.max(1));
    let totals: Vec<Seen> = std::thread::scope(|s| {
        let threads: Vec<_> = (0..workers)
            .map(|w| {
                let work = move || {
                    let mut seen = Seen::default();
                    for seed in (first + w..first + batches).step_by(workers as usize) {
                        let batch = batch(seed, BATCH, false);
                        if let Err((n, what)) = agree(&batch, &mut seen) {
                            fail(seed, &batch, n, &what);
                        }
                    }
                    seen
                };
                std::thread::Builder::new().stack_size(256 << 20).spawn_scoped(s, work).expect("a thread starts")
            })
            .collect();
        threads.into_iter().map(|t| t.join().unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
    });
    let charts: u64 = totals.iter().map(|s| s.charts).sum();
    let moves: u64 = totals.iter().map(|s| s.moves).sum();
    let runs: u64 = totals.iter().map(|s| s.runs).sum();
    let (proved, sound): (u64, u64) = totals.iter().fold((0, 0), |(p, s), t| (p + t.proved, s + t.sound));
    println!("{charts} charts of {CYCLES} scans; the marking changed {moves} times, bodies ran {runs} times");
    println!("structure: {proved} analysed to the end, {sound} without errors");
    assert!(proved * 10 > charts * 9 && sound * 5 > charts, "{proved} proved, {sound} sound of {charts}");
    assert!(charts >= count);
    assert!(moves > charts * 5 && runs > charts * 10, "{moves} moves, {runs} runs of {charts} charts");
}

#[test]
fn linked_programs_agree_with_the_interpreter() {
    let (count, first) = (setting("RANDOM_CHARTS_LINKED", 60), setting("RANDOM_SEED", 1) + 1_000_000);
    let size = count.clamp(1, 300);
    for seed in first..first + count.div_ceil(size) {
        linked(seed, &batch(seed, size, true));
    }
}

fn linked(seed: u64, batch: &Batch) {
    let folder = tempfile::tempdir().expect("a folder for the batch");
    let path = folder.path();
    std::fs::write(path.join("batch.st"), &batch.text).expect("the source is written");
    let profile = if batch.profile == Profile::Codesys { "codesys" } else { "strict" };
    let cycles = CYCLES.to_string();
    let flags = ["--virtual-time", "--cycles", &cycles, "--trace", "-"];
    let common = ["batch.st", "--profile", profile, "--message-format", "short"];
    let interp = command(Path::new(PLCC), path, &[&["run"], &common[..], &["--engine", "interp"], &flags[..]].concat());
    assert_eq!(interp.code, 0, "seed {seed}: {}", interp.stderr);
    let built = command(Path::new(PLCC), path, &[&["build"], &common[..], &["-o", "batch"]].concat());
    assert_eq!(built.code, 0, "seed {seed}: {}", built.stderr);
    let native = command(&path.join("batch"), path, &flags);
    assert_eq!(native.code, 0, "seed {seed}: {}", native.stderr);
    assert_eq!(interp.stdout.lines().count() as i64, CYCLES + 1);
    assert!(interp.stdout == native.stdout, "seed {seed}: the traces differ\n{}", batch.text);
}

/// The passes of the optimiser keep the meaning of charts.
#[test]
fn passes_keep_the_meaning_of_charts() {
    let (count, first) = (setting("RANDOM_CHARTS_PASSES", 50), setting("RANDOM_SEED", 1) + 2_000_000);
    let size = count.clamp(1, BATCH);
    for seed in first..first + count.div_ceil(size) {
        let batch = batch(seed, size, false);
        let run = |patience| Run { cycles: CYCLES as usize, inputs: &|_, _| {}, native: true, patience };
        let (long, short) = (Duration::from_secs(60), Duration::from_millis(500));
        let outcome = |text: &str, patience: Duration| -> Option<plcc_tests::passes::Disagreement> {
            let program = compile(text, batch.profile).ok()?;
            passes_agree(&program, plcc_mir::opt::passes(), &run(patience)).err()
        };
        let work = || {
            let Some(found) = outcome(&batch.text, long) else { return };
            let small = reduce(&batch.text, |text| outcome(text, short).is_some_and(|other| other.pass == found.pass));
            panic!("seed {seed}, {:?}: {found}\n{small}", batch.profile);
        };
        std::thread::scope(|s| {
            let thread = std::thread::Builder::new().stack_size(256 << 20).spawn_scoped(s, work);
            thread.expect("a thread starts").join().unwrap_or_else(|e| std::panic::resume_unwind(e));
        });
    }
}
