//! Where what is done stands best for the machine: one copy for neighbours, loads where they are needed, decisions first.

use super::{count, optimised_with};
use plcc_mir::ir::{Inst, Place, Program, Term};

const VALVE: &str = "
    TYPE Phase : (Shut, Opening, Wide, Closing, Stuck, Service, Blocked); END_TYPE
    FUNCTION_BLOCK Valve
    VAR_INPUT open, close, locked, reset : BOOL; travel : INT; limit : DINT; END_VAR
    VAR_OUTPUT phase : Phase; moved : DINT; faults : UINT; END_VAR
    VAR ticks : INT; END_VAR
    ticks := ticks + 1;
    CASE phase OF
      Shut: IF open AND NOT locked THEN phase := Opening; ticks := 0; END_IF;
      Opening: moved := moved + travel; IF moved >= limit THEN phase := Wide; ELSIF ticks > 50 THEN phase := Stuck; END_IF;
      Wide: IF close THEN phase := Closing; ticks := 0; END_IF;
      Closing: moved := moved - travel; IF moved <= 0 THEN phase := Shut; END_IF;
      Stuck: faults := faults + 1; IF reset THEN phase := Service; END_IF;
      Service: IF reset AND NOT locked THEN phase := Closing; END_IF;
      Blocked: IF NOT locked THEN phase := Shut; END_IF;
    END_CASE;
    END_FUNCTION_BLOCK\n";

const DECLARATIONS: &str = "valves : ARRAY [1..20] OF Valve; opens, closes : ARRAY [1..20] OF BOOL;
    travels : ARRAY [1..20] OF INT; a, b, c, d, e : BOOL; k, n : INT; sum : DINT; all : UINT; x : ARRAY [0..7] OF USINT;";

const LOOP: &str = "FOR k := 1 TO 20 DO
      valves[k](open := opens[k], close := closes[k], locked := a, reset := b, travel := travels[k], limit := 900);
      sum := sum + valves[k].moved; all := all + valves[k].faults;
      IF valves[k].phase = Wide THEN n := n + 1; END_IF;
    END_FOR;";

fn text(program: &Program) -> String {
    plcc_mir::print::program(program, None)
}

/// Bytes of all copies.
fn copied(program: &Program) -> Vec<u32> {
    let insts = program.funcs.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.insts);
    insts.filter_map(|inst| if let Inst::Copy { bytes, .. } = inst { Some(*bytes) } else { None }).collect()
}

#[test]
fn neighbours_are_copied_at_once() {
    const TWO: &str = "FUNCTION_BLOCK Two VAR_INPUT p, q, r, s : BOOL; m : INT; END_VAR VAR h : UINT; END_VAR
        h := h * 7 + BOOL_TO_UINT(p XOR q); END_FUNCTION_BLOCK\n";
    for (declarations, body, copies) in [
        ("t : Two; a, b, c, d : BOOL; m : INT;", "t(p := a, q := b, r := c, s := d, m := m);", &[4][..]),
        // Not side by side in the same order.
        ("t : Two; a, b, c, d : BOOL;", "t(r := d, s := c);", &[]),
        // What was just written byte by byte would have to be waited for.
        ("t : Two; a, b, c, d : BOOL;", "c := NOT c; d := c XOR d; t(r := c, s := d);", &[]),
        // Between the two stores something reads the first.
        ("t : Two; a, c, d : BOOL; r : REF_TO BOOL;", "r := REF(t.r); t.r := c; a := r^; t.s := d;", &[]),
    ] {
        let program = optimised_with(TWO, declarations, body);
        assert_eq!(copied(&program), copies, "{body}\n{}", text(&program));
    }
}

#[test]
fn a_crowded_loop_reads_its_inputs_where_it_needs_them() {
    let program = optimised_with(VALVE, DECLARATIONS, LOOP);
    let task = &program.funcs[program.tasks[0]];
    let fixed = |inst: &Inst, name: &str| match inst {
        Inst::Load { place: Place { index, offset, base, .. }, .. } if index.is_empty() => {
            task.names.iter().any(|(b, at, path)| b == base && i64::from(*at) == *offset && path.ends_with(name))
        }
        _ => false,
    };
    for name in [".a", ".b"] {
        let blocks = task.blocks.iter().filter(|b| b.insts.iter().any(|inst| fixed(inst, name))).count();
        assert!(blocks > 1, "{name} is loaded in {blocks} blocks\n{}", text(&program));
    }
    // What was written since it was loaded is not read again; `agree` in `optimised_with` would see it.
    let body = LOOP.replace("limit := 900", "limit := old").replace("locked := a", "locked := c");
    let changed = format!("old := limits; limits := limits + 7; c := a; a := NOT a; {body}");
    optimised_with(VALVE, &format!("{DECLARATIONS} old, limits : DINT;"), &changed);
    // A small loop holds what it needs.
    let small = optimised_with(VALVE, DECLARATIONS, "FOR k := 1 TO 20 DO opens[k] := closes[k] AND a; END_FOR;");
    assert_eq!(count(&small, |inst| fixed(inst, ".a")), 1, "{}", text(&small));
}

#[test]
fn what_decides_is_read_first() {
    let program = optimised_with(VALVE, DECLARATIONS, LOOP);
    let blocks = program.funcs.iter().flat_map(|f| &f.blocks);
    let mut switches = 0;
    for block in blocks {
        let Term::Switch { value, .. } = &block.term else { continue };
        switches += 1;
        let at = block.insts.iter().position(|inst| inst.results().0 == Some(*value));
        let store = block.insts.iter().position(|inst| matches!(inst, Inst::Store { .. } | Inst::Copy { .. }));
        assert!(at.is_some() && store.is_some() && at < store, "{}", text(&program));
    }
    assert_eq!(switches, 1);
    // A check stays in front of what it guards, and a store of what may be its place.
    let body =
        "x[n] := 1; IF x[k] > 2 THEN sum := 1; ELSE sum := sum * 3; all := 5; n := n + 1; c := d; e := c; END_IF;";
    let guarded = optimised_with(VALVE, DECLARATIONS, body);
    let first = guarded.funcs[guarded.tasks[0]].blocks.iter().flat_map(|b| &b.insts);
    let order: Vec<&str> = first
        .filter_map(|inst| match inst {
            Inst::Check { .. } => Some("check"),
            Inst::Store { place, .. } if !place.index.is_empty() => Some("store"),
            Inst::Load { place, .. } if !place.index.is_empty() => Some("load"),
            _ => None,
        })
        .collect();
    assert_eq!(order, ["check", "store", "check", "load"], "{}", text(&guarded));
}
