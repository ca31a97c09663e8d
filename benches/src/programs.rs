//! The programs: their texts, and how their inputs move.

use crate::stimulus::Signal::{self, Flips, Jumps, Noise, Pulses, Texts, Walk};

/// A program with a C reference.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// Its name: that of `programs/<name>.c`, too.
    pub name: &'static str,
    /// What it does.
    pub what: &'static str,
    /// Sources, name and text.
    pub sources: &'static [(&'static str, &'static str)],
    /// Its inputs.
    pub signals: &'static [(&'static str, Signal)],
}

macro_rules! source {
    ($name:literal) => {
        (concat!($name, ".st"), include_str!(concat!("../programs/", $name, ".st")))
    };
}

macro_rules! example {
    ($name:literal) => {
        (concat!($name, ".st"), include_str!(concat!("../../examples/mixer/src/", $name, ".st")))
    };
}

/// All of them.
pub const PROGRAMS: &[Program] = &[
    Program {
        name: "logic",
        what: "200 rungs on 64 inputs",
        sources: &[source!("logic")],
        signals: &[("x", Flips(0.03))],
    },
    Program {
        name: "timers",
        what: "64 x TON, TOF, CTU in a loop",
        sources: &[source!("timers")],
        signals: &[("run", Flips(0.05))],
    },
    Program {
        name: "drives",
        what: "16 drives with 7 named blocks each",
        sources: &[source!("drives")],
        signals: &[
            ("enable", Flips(0.01)),
            ("stop", Pulses(0.003)),
            ("reset", Pulses(0.002)),
            ("press", Flips(0.1)),
            ("tripped", Pulses(0.0005)),
            ("feedback", Pulses(0.15)),
        ],
    },
    Program {
        name: "pid",
        what: "16 PID controllers in a loop",
        sources: &[source!("pid")],
        signals: &[("pv", Walk(0.0, 100.0, 1.5)), ("sp", Jumps(10.0, 90.0, 0.01)), ("manual", Flips(0.005))],
    },
    Program {
        name: "cascade",
        what: "12 PID loops, each a named instance",
        sources: &[source!("cascade")],
        signals: &[("pv", Walk(0.0, 100.0, 1.0)), ("sp", Jumps(10.0, 90.0, 0.01))],
    },
    Program {
        name: "states",
        what: "50 state machines (CASE)",
        sources: &[source!("states")],
        signals: &[
            ("part", Flips(0.1)),
            ("clamped", Flips(0.2)),
            ("flow", Walk(20.0, 90.0, 5.0)),
            ("ready", Flips(0.01)),
            ("acknowledge", Pulses(0.05)),
        ],
    },
    Program {
        name: "fir",
        what: "4 x FIR with 64 taps",
        sources: &[source!("fir")],
        signals: &[("x", Walk(-10.0, 10.0, 1.0))],
    },
    Program {
        name: "matrix",
        what: "16 x 16 matrices of LREAL",
        sources: &[source!("matrix")],
        signals: &[("u", Walk(-1.0, 1.0, 0.1))],
    },
    Program {
        name: "sort",
        what: "insertion sort of 64 INT, median of 9",
        sources: &[source!("sort")],
        signals: &[("reading", Noise(-20000.0, 20000.0))],
    },
    Program {
        name: "crc",
        what: "CRC-16 by table, CRC-32 bit by bit",
        sources: &[source!("crc")],
        signals: &[("frame", Noise(0.0, 256.0))],
    },
    Program {
        name: "strings",
        what: "telegrams taken apart and put together",
        sources: &[source!("strings")],
        signals: &[
            (
                "telegram",
                Texts(
                    &[
                        "WEIGH;AX-4711-B;1250;ok",
                        "WEIGH;BR-0815;98;ok",
                        "STATUS;;;",
                        "WEIGH;AX-0042-C;-17;tare",
                        "RESET",
                        "WEIGH;article with a long name;123456;ok",
                    ],
                    0.4,
                ),
            ),
            ("shift", Jumps(1.0, 400.0, 0.05)),
        ],
    },
    Program {
        name: "plant",
        what: "4 tanks: scaling, alarms, pumps, recipes, PI",
        sources: &[source!("plant")],
        signals: &[
            ("level", Walk(0.0, 27648.0, 900.0)),
            ("temperature", Walk(0.0, 20000.0, 500.0)),
            ("flow", Walk(0.0, 27648.0, 700.0)),
            ("start", Flips(0.05)),
            ("tripped", Pulses(0.005)),
            ("release", Flips(0.003)),
            ("acknowledge", Pulses(0.02)),
            ("number", Jumps(0.0, 3.0, 0.005)),
        ],
    },
    Program {
        name: "sfc",
        what: "4 mixers as charts of 20 steps, with vessels",
        sources: &[source!("sfc"), example!("recipes"), example!("control"), example!("main")],
        signals: &[("start", Flips(0.05)), ("number", Jumps(1.0, 4.0, 0.02))],
    },
    Program {
        name: "il",
        what: "8 axes in Instruction List",
        sources: &[source!("il")],
        signals: &[
            ("raw", Walk(0.0, 27648.0, 600.0)),
            ("forward", Flips(0.05)),
            ("backward", Flips(0.05)),
            ("ends", Pulses(0.05)),
            ("stop", Pulses(0.03)),
        ],
    },
    Program {
        name: "signals",
        what: "library: interpolation, averages, ramps, totals, 8 channels",
        sources: &[source!("signals")],
        signals: &[("raw", Walk(-5.0, 105.0, 3.0)), ("reset", Pulses(0.002))],
    },
    Program {
        name: "calendar",
        what: "library: dates, weeks, Easter, time switches, sun",
        sources: &[source!("calendar")],
        signals: &[("clocks", Noise(0.0, 4.0e9))],
    },
];
