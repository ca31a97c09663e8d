//! Charts by size: what a scan costs with 10, 100 and 1000 steps of which one or ten are active.

use std::fmt::Write;

/// Name, what it is, source.
pub fn all() -> Vec<(String, String, String)> {
    let sizes = [10, 100, 1000];
    let rings = sizes.map(|n| (format!("ring{n}"), format!("{n} steps in a ring, one active"), ring(n)));
    let lanes = sizes.map(|n| (format!("lanes{n}"), format!("{n} steps in ten lanes, ten active"), lanes(n)));
    rings.into_iter().chain(lanes).collect()
}

/// A ring of steps, each 50 ms, each with an action of its own and an output with some qualifier.
pub fn ring(steps: usize) -> String {
    let mut t = declarations(steps);
    for n in 0..steps {
        step(&mut t, n, n == 0);
        let _ = writeln!(t, "TRANSITION FROM S{n} TO S{} := S{n}.T >= T#50ms; END_TRANSITION", (n + 1) % steps);
    }
    t + "END_PROGRAM\n"
}

/// Ten rings side by side, which one transition starts.
pub fn lanes(steps: usize) -> String {
    let mut t = declarations(steps);
    let each = steps / 10;
    t.push_str("INITIAL_STEP Start: END_STEP\n");
    let heads: Vec<String> = (0..10).map(|lane| format!("S{}", lane * each)).collect();
    let _ = writeln!(t, "TRANSITION FROM Start TO ({}) := TRUE; END_TRANSITION", heads.join(", "));
    for n in 0..steps {
        step(&mut t, n, false);
        let next = n / each * each + (n % each + 1) % each;
        let _ = writeln!(t, "TRANSITION FROM S{n} TO S{next} := S{n}.T >= T#50ms; END_TRANSITION");
    }
    t + "END_PROGRAM\n"
}

fn declarations(steps: usize) -> String {
    let mut t = "PROGRAM Main\nVAR\n  total : DINT;\n".to_string();
    for n in 0..steps {
        let _ = writeln!(t, "  v{n} : BOOL;");
    }
    t + "END_VAR\n"
}

fn step(t: &mut String, n: usize, initial: bool) {
    let qualifier = ["N", "L, T#30ms", "D, T#20ms", "P", "N"][n % 5];
    let word = if initial { "INITIAL_STEP" } else { "STEP" };
    let _ = writeln!(t, "{word} S{n}: A{n}; v{n}({qualifier}); END_STEP\nACTION A{n}: total := total + 1; END_ACTION");
}
