//! Random networks against a model: gates and bistables of FBD in any drawing, with loops where execution orders are given, and rungs
//! of LD. The model computes what semantics.md [X1] says, without order, temporaries or statements.
//!
//! `NETWORKS=5000 cargo test -p plcc-tests --test networks` is a longer run; a failure names its seed and prints the drawing.

use fastrand::Rng;
use plcc_tests::command;
use std::fmt::Write;
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");
const INPUTS: [&str; 4] = ["a", "b", "c", "d"];
const CYCLES: usize = 12;

#[derive(Clone, Copy, PartialEq)]
enum Gate {
    And,
    Or,
    Xor,
    Not,
    /// `Q1 := S1 OR NOT R AND Q1`.
    Sr,
}

/// Where a value comes from.
#[derive(Clone, Copy)]
enum From {
    Input(usize),
    Gate(usize),
}

/// A value on its way into a pin, with the memory of its edge.
#[derive(Clone)]
struct Pin {
    from: Vec<From>,
    negated: bool,
    /// Rising or falling.
    edge: Option<bool>,
    memory: bool,
    /// Drawn by way of a connector.
    linked: bool,
}

impl Pin {
    fn random(rng: &mut Rng, from: Vec<From>) -> Self {
        let edge = (rng.u8(..6) == 0).then(|| rng.bool());
        Pin { from, negated: rng.u8(..4) == 0, edge, memory: false, linked: rng.u8(..5) == 0 }
    }

    /// R_TRIG and F_TRIG as the standard prints them [B2].
    fn read(&mut self, value: bool) -> bool {
        let value = value != self.negated;
        match self.edge {
            None => value,
            Some(rising) => {
                let level = value == rising;
                let pulse = level && !self.memory;
                self.memory = level;
                pulse
            }
        }
    }

    fn attributes(&self) -> String {
        let edge = match self.edge {
            None => "",
            Some(true) => " edge=\"rising\"",
            Some(false) => " edge=\"falling\"",
        };
        format!("{}{edge}", if self.negated { " negated=\"true\"" } else { "" })
    }
}

struct Block {
    gate: Gate,
    pins: Vec<Pin>,
    /// Of its output.
    negated: bool,
    /// Its value, before the output's negation; of SR the variable.
    value: bool,
}

/// A network of FBD: blocks, and one variable for each of some of them.
struct Network {
    blocks: Vec<Block>,
    outs: Vec<Pin>,
    /// executionOrderIds of blocks, then of outs.
    order: Option<Vec<usize>>,
}

impl Network {
    fn random(rng: &mut Rng) -> Self {
        let count = rng.usize(1..14);
        let numbered = rng.bool();
        let source = |rng: &mut Rng, own: usize| {
            let reach = if numbered { count } else { own };
            match rng.usize(..INPUTS.len() + reach) {
                n if n < INPUTS.len() => From::Input(n),
                n => From::Gate(n - INPUTS.len()),
            }
        };
        let mut blocks = Vec::new();
        for own in 0..count {
            let gate = [Gate::And, Gate::Or, Gate::Xor, Gate::Not, Gate::Sr][rng.usize(..5)];
            let pins = match gate {
                Gate::Not => 1,
                Gate::Sr => 2,
                _ => rng.usize(2..5),
            };
            let pins = (0..pins)
                .map(|_| {
                    let from = source(rng, own);
                    Pin::random(rng, vec![from])
                })
                .collect();
            blocks.push(Block { gate, pins, negated: rng.u8(..5) == 0, value: false });
        }
        let outs = (0..rng.usize(1..5))
            .map(|_| {
                let from = source(rng, count);
                Pin::random(rng, vec![from])
            })
            .collect::<Vec<_>>();
        let mut ids: Vec<usize> = (1..=blocks.len() + outs.len()).collect();
        rng.shuffle(&mut ids);
        Network { blocks, outs, order: numbered.then_some(ids) }
    }

    /// The values of the variables after a cycle.
    fn cycle(&mut self, inputs: [bool; 4], held: &mut [bool]) {
        let places = match &self.order {
            Some(ids) => {
                let mut places: Vec<usize> = (0..ids.len()).collect();
                places.sort_by_key(|n| ids[*n]);
                places
            }
            None => (0..self.blocks.len() + self.outs.len()).collect(),
        };
        for place in places {
            let out = place.checked_sub(self.blocks.len());
            let values: Vec<bool> = self.blocks.iter().map(|b| b.value != b.negated).collect();
            // What no evaluation has given yet is FALSE where it is kept, also of an inverted output of a function.
            let read = |pin: &mut Pin, first: &[Option<bool>]| {
                let value = match pin.from[0] {
                    From::Input(n) => inputs[n],
                    From::Gate(n) => first[n].unwrap_or(values[n]),
                };
                pin.read(value)
            };
            let none: Vec<Option<bool>> = vec![None; values.len()];
            match out {
                Some(out) => held[out] = read(&mut self.outs[out], &none),
                None => {
                    let mut pins = std::mem::take(&mut self.blocks[place].pins);
                    let bits: Vec<bool> = pins.iter_mut().map(|p| read(p, &none)).collect();
                    let block = &mut self.blocks[place];
                    block.pins = pins;
                    block.value = match block.gate {
                        Gate::And => bits.iter().all(|b| *b),
                        Gate::Or => bits.iter().any(|b| *b),
                        Gate::Xor => bits.iter().fold(false, |x, b| x != *b),
                        Gate::Not => !bits[0],
                        Gate::Sr => bits[0] || (!bits[1] && block.value),
                    };
                }
            }
        }
    }

    /// The initial value of a function's output in a loop is FALSE as it is kept; of a bistable it is read through the ring.
    fn start(&mut self) {
        for block in &mut self.blocks {
            block.value = match block.gate {
                Gate::Sr => false,
                _ => block.negated,
            };
        }
    }

    fn xml(&self, rng: &mut Rng) -> String {
        let mut elements: Vec<String> = Vec::new();
        let mut place = || format!("<position x=\"{}\" y=\"{}\"/>", rng.u16(0..2000), rng.u16(0..2000));
        let mut next = 1000;
        let mut extra: Vec<String> = Vec::new();
        let mut point = |pin: &Pin, place: &mut dyn FnMut() -> String| {
            let (mut id, mut name) = match pin.from[0] {
                From::Input(n) => (500 + n, String::new()),
                From::Gate(n) => {
                    let name = if self.blocks[n].gate == Gate::Sr { "Q1" } else { "OUT" };
                    (n + 1, format!(" formalParameter=\"{name}\""))
                }
            };
            if pin.linked {
                next += 2;
                extra.push(format!(
                    "<connector localId=\"{next}\" name=\"c{next}\">{}<connectionPointIn><connection refLocalId=\"{id}\"{name}/></connectionPointIn></connector>",
                    place()
                ));
                extra.push(format!(
                    "<continuation localId=\"{}\" name=\"C{next}\">{}<connectionPointOut/></continuation>",
                    next + 1,
                    place()
                ));
                (id, name) = (next + 1, String::new());
            }
            format!("<connectionPointIn><connection refLocalId=\"{id}\"{name}/></connectionPointIn>")
        };
        let order =
            |n: usize| self.order.as_ref().map_or(String::new(), |ids| format!(" executionOrderId=\"{}\"", ids[n]));
        for (n, name) in INPUTS.iter().enumerate() {
            elements.push(format!(
                "<inVariable localId=\"{}\">{}<connectionPointOut/><expression>{name}</expression></inVariable>",
                500 + n,
                place()
            ));
        }
        for (n, block) in self.blocks.iter().enumerate() {
            let (ty, instance, out) = match block.gate {
                Gate::And => ("AND", String::new(), "OUT"),
                Gate::Or => ("OR", String::new(), "OUT"),
                Gate::Xor => ("XOR", String::new(), "OUT"),
                Gate::Not => ("NOT", String::new(), "OUT"),
                Gate::Sr => ("SR", format!(" instanceName=\"s{n}\""), "Q1"),
            };
            let mut pins = String::new();
            for (p, pin) in block.pins.iter().enumerate() {
                let name = match (block.gate, p) {
                    (Gate::Sr, 0) => "S1".into(),
                    (Gate::Sr, _) => "R".into(),
                    (Gate::Not, _) => "IN".into(),
                    _ => format!("IN{}", p + 1),
                };
                let point = point(pin, &mut place);
                write!(pins, "<variable formalParameter=\"{name}\"{}>{point}</variable>", pin.attributes())
                    .expect("text");
            }
            let ring = if block.negated { " negated=\"true\"" } else { "" };
            elements.push(format!(
                "<block localId=\"{}\" typeName=\"{ty}\"{instance}{}>{}<inputVariables>{pins}</inputVariables><outputVariables>\
                 <variable formalParameter=\"{out}\"{ring}><connectionPointOut/></variable></outputVariables></block>",
                n + 1,
                order(n),
                place()
            ));
        }
        for (n, pin) in self.outs.iter().enumerate() {
            let point = point(pin, &mut place);
            elements.push(format!(
                "<outVariable localId=\"{}\"{}{}>{}{point}<expression>q{n}</expression></outVariable>",
                700 + n,
                order(self.blocks.len() + n),
                pin.attributes(),
                place()
            ));
        }
        elements.append(&mut extra);
        rng.shuffle(&mut elements);
        let instances = self.blocks.iter().enumerate().filter(|(_, b)| b.gate == Gate::Sr);
        let instances =
            instances.map(|(n, _)| format!("<variable name=\"s{n}\"><type><derived name=\"SR\"/></type></variable>"));
        project(&instances.collect::<String>(), self.outs.len(), &format!("<FBD>\n{}\n</FBD>", elements.join("\n")))
    }
}

fn project(more: &str, outs: usize, body: &str) -> String {
    let var = |name: &str| format!("<variable name=\"{name}\"><type><BOOL/></type></variable>");
    let ins: String = INPUTS.iter().map(|n| var(n)).collect();
    let outs: String = (0..outs).map(|n| var(&format!("q{n}"))).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n<pou name=\"Main\" pouType=\"program\">\
         <interface><inputVars>{ins}</inputVars><outputVars>{outs}</outputVars><localVars>{more}</localVars></interface>\n<body>{body}</body></pou>\n\
         </pous></types></project>\n"
    )
}

/// Rungs of LD: contacts behind each other and side by side, coils of every kind.
struct Rungs {
    /// Sources are earlier contacts; none means the rail.
    contacts: Vec<(usize, Pin)>,
    /// The contact before it, negation and edge, set or reset.
    coils: Vec<(usize, Pin, Option<bool>)>,
}

impl Rungs {
    fn random(rng: &mut Rng) -> Self {
        let mut contacts = Vec::new();
        for own in 0..rng.usize(1..14) {
            let from = match own {
                0 => Vec::new(),
                _ => (0..rng.usize(0..4)).map(|_| From::Gate(rng.usize(..own))).collect(),
            };
            contacts.push((rng.usize(..INPUTS.len()), Pin::random(rng, from)));
        }
        let coils = (0..rng.usize(1..5))
            .map(|_| {
                let before = rng.usize(..contacts.len());
                (before, Pin::random(rng, Vec::new()), (rng.u8(..3) == 0).then(|| rng.bool()))
            })
            .collect();
        Rungs { contacts, coils }
    }

    fn cycle(&mut self, inputs: [bool; 4], held: &mut [bool]) {
        let mut power: Vec<bool> = Vec::new();
        for (variable, pin) in &mut self.contacts {
            let before = pin.from.is_empty()
                || pin.from.iter().any(|f| match f {
                    From::Gate(n) => power[*n],
                    From::Input(_) => false,
                });
            let state = pin.read(inputs[*variable]);
            power.push(before && state);
        }
        for (n, (before, pin, storage)) in self.coils.iter_mut().enumerate() {
            let value = pin.read(power[*before]);
            match storage {
                None => held[n] = value,
                Some(set) if value => held[n] = *set,
                Some(_) => {}
            }
        }
    }

    fn xml(&self, rng: &mut Rng) -> String {
        let mut place = || format!("<position x=\"{}\" y=\"{}\"/>", rng.u16(0..2000), rng.u16(0..2000));
        let mut elements =
            vec![format!("<leftPowerRail localId=\"900\">{}<connectionPointOut/></leftPowerRail>", place())];
        for (n, (variable, pin)) in self.contacts.iter().enumerate() {
            let mut from: String = pin
                .from
                .iter()
                .map(|f| match f {
                    From::Gate(n) | From::Input(n) => format!("<connection refLocalId=\"{}\"/>", n + 1),
                })
                .collect();
            if from.is_empty() {
                from = "<connection refLocalId=\"900\"/>".into();
            }
            elements.push(format!(
                "<contact localId=\"{}\"{}>{}<connectionPointIn>{from}</connectionPointIn><connectionPointOut/><variable>{}</variable></contact>",
                n + 1,
                pin.attributes(),
                place(),
                INPUTS[*variable]
            ));
        }
        for (n, (before, pin, storage)) in self.coils.iter().enumerate() {
            let storage = match storage {
                None => "",
                Some(true) => " storage=\"set\"",
                Some(false) => " storage=\"reset\"",
            };
            elements.push(format!(
                "<coil localId=\"{}\"{}{storage}>{}<connectionPointIn><connection refLocalId=\"{}\"/></connectionPointIn><connectionPointOut/><variable>q{n}</variable></coil>",
                700 + n,
                pin.attributes(),
                place(),
                before + 1
            ));
        }
        rng.shuffle(&mut elements);
        project("", self.coils.len(), &format!("<LD>\n{}\n</LD>", elements.join("\n")))
    }
}

/// Runs a drawing and compares each cycle with the model.
fn compare(seed: u64, xml: &str, outs: usize, inputs: &[[bool; 4]], mut model: impl FnMut([bool; 4], &mut [bool])) {
    let text = |b: bool| if b { "TRUE" } else { "FALSE" };
    let names: Vec<String> = (0..outs).map(|n| format!("Main.q{n}")).collect();
    let mut stimulus = format!("cycle,{}\n", INPUTS.map(|n| format!("Main.{n}")).join(","));
    let mut expected = format!("cycle,{}\n", names.join(","));
    let mut held = vec![false; outs];
    for (n, row) in inputs.iter().enumerate() {
        writeln!(stimulus, "{},{}", n + 1, row.map(text).join(",")).expect("text");
        model(*row, &mut held);
        let values: Vec<&str> = held.iter().map(|b| text(*b)).collect();
        writeln!(expected, "{},{}", n + 1, values.join(",")).expect("text");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    file("x.xml", xml);
    file("in.csv", &stimulus);
    let cycles = inputs.len().to_string();
    for engine in ["interp", "jit"] {
        let args = ["run", "x.xml", "--engine", engine, "--virtual-time", "--cycles", &cycles, "--stimulus", "in.csv"];
        let done = command(
            Path::new(PLCC),
            folder.path(),
            &[&args[..], &["--watch", &names.join(","), "--trace", "-"]].concat(),
        );
        assert_eq!(done.code, 0, "seed {seed}, {engine}: {}\n{xml}", done.stderr);
        assert_eq!(done.stdout, expected, "seed {seed}, {engine}:\n{stimulus}\n{xml}");
    }
}

#[test]
fn networks_do_what_the_model_does() {
    let count = std::env::var("NETWORKS").ok().and_then(|n| n.parse().ok()).unwrap_or(45);
    for seed in 0..count {
        let mut rng = Rng::with_seed(seed);
        let inputs: Vec<[bool; 4]> = (0..CYCLES).map(|_| std::array::from_fn(|_| rng.bool())).collect();
        if seed % 3 == 2 {
            let mut rungs = Rungs::random(&mut rng);
            let xml = rungs.xml(&mut rng);
            let outs = rungs.coils.len();
            compare(seed, &xml, outs, &inputs, |row, held| rungs.cycle(row, held));
        } else {
            let mut network = Network::random(&mut rng);
            let xml = network.xml(&mut rng);
            let outs = network.outs.len();
            network.start();
            compare(seed, &xml, outs, &inputs, |row, held| network.cycle(row, held));
        }
    }
}
