//! Edits of a program: whatever is added, removed, renamed, reordered or retyped, no value comes to a wrong variable.

use crate::Plant;
use std::collections::BTreeMap;

/// A retained variable: its type, and the value that the first version of a program gives it.
#[derive(Clone, PartialEq, Debug)]
struct Variable {
    ty: usize,
    value: u32,
}

/// The text of a value, as a literal and in traces.
type Text = fn(u32) -> String;

/// Types with a value for each number.
const TYPES: [(&str, Text); 8] = [
    ("BOOL", |n| if n % 2 == 1 { "TRUE".into() } else { "FALSE".into() }),
    ("SINT", |n| format!("{}", n % 120 + 1)),
    ("INT", |n| format!("{}", n % 30_000 + 1)),
    ("UDINT", |n| format!("{}", n + 1)),
    ("LREAL", |n| format!("{}.5", n + 1)),
    ("STRING[6]", |n| format!("'s{}'", n % 90_000)),
    ("Color", |n| ["Red", "Green", "Blue"][n as usize % 3].to_string()),
    ("TIME", |n| format!("T#{}ms", n % 900 + 1)),
];

type Program = BTreeMap<String, Variable>;

/// The order of declaration is a permutation, with gaps between; some variables lie in a block, some are global. Where one
/// lives is the first letter of its name.
fn source(program: &Program, random: &mut fastrand::Rng) -> String {
    let mut names: Vec<&String> = program.keys().collect();
    random.shuffle(&mut names);
    let (mut own, mut global, mut block) = (String::new(), String::new(), String::new());
    for name in names {
        let section = match name.as_bytes()[0] {
            b'g' => &mut global,
            b'b' => &mut block,
            _ => &mut own,
        };
        section.push_str(&format!("  {name} : {};\n", TYPES[program[name].ty].0));
        if random.u8(0..3) == 0 {
            section.push_str(&format!("  pad{} : ARRAY [1..{}] OF BYTE;\n", random.u32(0..1 << 30), random.u8(1..9)));
        }
    }
    let colors = ["Red", "Green", "Blue", "White"];
    let mut order: Vec<&str> = colors[..3 + random.usize(0..2)].to_vec();
    random.shuffle(&mut order);
    format!(
        "TYPE Color : ({}); END_TYPE\nVAR_GLOBAL RETAIN\n{global}  gx : INT;\nEND_VAR\n\
         FUNCTION_BLOCK Block\nVAR\n{block}  bx : INT;\nEND_VAR\nEND_FUNCTION_BLOCK\n\
         PROGRAM Main\nVAR RETAIN\n{own}  b : Block;\n  x : INT;\nEND_VAR\nEND_PROGRAM\n",
        order.join(", ")
    )
}

/// Its name for flags.
fn path_of(name: &str) -> String {
    match name.as_bytes()[0] {
        b'g' => name.to_string(),
        b'b' => format!("Main.b.{name}"),
        _ => format!("Main.{name}"),
    }
}

fn edit(program: &Program, random: &mut fastrand::Rng) -> Program {
    let mut edited = Program::new();
    for (name, variable) in program {
        let mut variable = variable.clone();
        let mut name = name.clone();
        match random.u8(0..10) {
            0 => continue,
            1 => name = format!("{}{}", &name[..1], random.u32(0..1_000_000)),
            2 => variable.ty = random.usize(0..TYPES.len()),
            // Another place, so another name.
            3 => name = format!("{}{}", ["g", "b", "m"][random.usize(0..3)], &name[1..]),
            _ => {}
        }
        edited.insert(name, variable);
    }
    for _ in 0..random.usize(0..4) {
        edited.insert(new_name(random), Variable { ty: random.usize(0..TYPES.len()), value: random.u32(0..1 << 20) });
    }
    edited
}

fn new_name(random: &mut fastrand::Rng) -> String {
    format!("{}{}", ["g", "b", "m"][random.usize(0..3)], random.u32(0..1_000_000))
}

/// The value of a variable that nothing has set.
fn initial(ty: usize, first_color: &str) -> String {
    match TYPES[ty].0 {
        "BOOL" => "FALSE".into(),
        "LREAL" => "0.0".into(),
        "STRING[6]" => "''".into(),
        "Color" => first_color.into(),
        "TIME" => "T#0s".into(),
        _ => "0".into(),
    }
}

#[test]
fn no_value_comes_to_a_wrong_variable() {
    let edits: u64 = std::env::var("EDITS").ok().and_then(|n| n.parse().ok()).unwrap_or(25);
    let plant = Plant::new(&[]);
    for seed in 0..edits {
        let mut random = fastrand::Rng::with_seed(seed);
        let program: Program = (0..random.usize(1..12))
            .map(|_| {
                (new_name(&mut random), Variable { ty: random.usize(0..TYPES.len()), value: random.u32(0..1 << 20) })
            })
            .collect();
        let edited = edit(&program, &mut random);
        let _ = std::fs::remove_file(plant.path("r"));
        // All values come from outside, so that every variable can have one.
        plant.write("a.st", &source(&program, &mut random));
        let forces: Vec<String> =
            program.iter().map(|(name, v)| format!("{}={}", path_of(name), TYPES[v.ty].1(v.value))).collect();
        let run = |file: &str, more: &[&str]| {
            let args = ["run", file, "--engine", "interp", "--virtual-time", "--cycles", "1", "--retain", "r"];
            let done = plant.plcc(&[&args[..], more].concat());
            assert_eq!(done.code, 0, "seed {seed}: {}\n{}", done.stderr, plant.read(file));
            done
        };
        run("a.st", &["--force", &forces.join(",")]);
        let text = source(&edited, &mut random);
        plant.write("b.st", &text);
        let diff = plant.plcc(&["retain", "diff", "r", "b.st"]);
        assert_eq!(diff.code, 0, "seed {seed}: {}", diff.stderr);
        let names: Vec<String> = edited.keys().map(|name| path_of(name)).collect();
        if names.is_empty() {
            continue;
        }
        let done = run("b.st", &["--watch", &names.join(",")]);
        let row = done.stdout.lines().nth(1).unwrap_or_default();
        let values: Vec<&str> = row.split(',').skip(1).collect();
        let first_color = text.split(['(', ',']).nth(1).unwrap_or_default().trim();
        for ((name, variable), value) in edited.iter().zip(values) {
            let kept = program.get(name).filter(|before| before.ty == variable.ty);
            let expected = match kept {
                Some(before) => TYPES[before.ty].1(before.value),
                None => initial(variable.ty, first_color),
            };
            assert_eq!(value, expected, "seed {seed}: {name}\n{}\n{text}", plant.read("a.st"));
        }
        // What was lost is told.
        let lost = program.iter().filter(|(name, v)| edited.get(*name).is_none_or(|e| e.ty != v.ty));
        for (name, _) in lost {
            let told = diff.stdout.contains(&format!("dropped  {} :", path_of(name)));
            assert!(told, "seed {seed}: {name}\n{}", diff.stdout);
        }
    }
}
