//! Ladder Diagram and Function Block Diagram as they were drawn: elements where the file has them, lines between their pins.
//!
//! Coordinates are those of the file, stretched where texts would not fit. A network without positions is put into columns
//! along its data flow.

use super::layout::{FONT, width};
use super::picture::{Picture, Rect, Shape, Symbol};
use plcc_syntax::ast::*;
use std::collections::HashMap;

/// Between the drawing and its edges.
const MARGIN: i32 = 24;
/// Between pins of a block.
const PIN: i32 = 20;
/// From a pin to where its line may bend.
const STUB: i32 = 12;

/// The drawing of a network.
pub fn place(network: &Network) -> Picture {
    let elements = &network.elements;
    let (across, down) = stretch(elements);
    let mut boxes: Vec<Placed> = match has_positions(elements) {
        true => elements.iter().map(|e| Placed::new(e, across, down)).collect(),
        false => columns(elements),
    };
    let left = boxes.iter().map(|b| b.around().left).min().unwrap_or(0);
    let top = boxes.iter().map(|b| b.around().top).min().unwrap_or(0);
    boxes.iter_mut().for_each(|b| b.shift(MARGIN - left, MARGIN - top));
    lengthen_rails(elements, &mut boxes);
    let mut shapes = Vec::new();
    let offset = (MARGIN - left, MARGIN - top);
    lines(elements, &boxes, (across, down), offset, &mut shapes);
    for (element, place) in elements.iter().zip(&boxes) {
        shapes_of(element, place, &mut shapes);
    }
    let mut picture = Picture { width: 0, height: 0, shapes };
    let ends = |r: Rect| (r.right + MARGIN, r.bottom + MARGIN);
    for (right, bottom) in picture.shapes.iter().map(|s| ends(s.rect())).chain(boxes.iter().map(|b| ends(b.around()))) {
        picture.width = picture.width.max(right);
        picture.height = picture.height.max(bottom);
    }
    picture
}

/// An element on the paper.
struct Placed {
    rect: Rect,
    /// Where lines end, and where they begin.
    ins: Vec<(i32, i32)>,
    outs: Vec<(i32, i32)>,
    /// Room above for a name.
    above: i32,
    /// Room on the left and on the right for what stands at pins.
    beside: (i32, i32),
}

/// The text in or at an element.
fn text(element: &Element) -> String {
    match &element.kind {
        ElementKind::Contact { variable: e, .. }
        | ElementKind::Coil { variable: e, .. }
        | ElementKind::In { value: e, .. }
        | ElementKind::Out { target: e, .. }
        | ElementKind::InOut { variable: e, .. } => source::expression(e),
        ElementKind::Block { ty, .. } => ty.text.to_string(),
        ElementKind::Connector(name) | ElementKind::Continuation(name) => name.text.to_string(),
        ElementKind::Label(name) => format!("{}:", name.text),
        ElementKind::Jump(name) => name.text.to_string(),
        ElementKind::Return => "RETURN".into(),
        ElementKind::Condition => "condition".into(),
        ElementKind::Comment(text) => text.clone(),
        ElementKind::LeftRail | ElementKind::RightRail => String::new(),
    }
}

/// The size that an element needs.
fn needs(element: &Element) -> (i32, i32) {
    let text = width(&text(element));
    match &element.kind {
        ElementKind::Block { .. } => {
            let names = |pins: &[Pin]| pins.iter().map(|p| width(&p.name)).max().unwrap_or(0);
            let inside = names(&element.inputs) + names(&element.outputs) + 30;
            let rows = element.inputs.len().max(element.outputs.len()).max(1) as i32;
            (inside.max(text + 20), 24 + rows * PIN)
        }
        ElementKind::Contact { .. } | ElementKind::Coil { .. } => (28, 24),
        ElementKind::LeftRail | ElementKind::RightRail => (4, 30),
        ElementKind::Comment(_) => (40, FONT + 8),
        ElementKind::Connector(_) | ElementKind::Continuation(_) | ElementKind::Jump(_) => (text + 28, 22),
        _ => (text + 14, 22),
    }
}

fn has_positions(elements: &[Element]) -> bool {
    elements.len() < 2 || elements.iter().any(|e| e.position != elements[0].position)
}

/// How much wider and higher the drawing must be than the file has it.
fn stretch(elements: &[Element]) -> (f64, f64) {
    let (mut across, mut down) = (1.0f64, 1.0f64);
    for element in elements {
        // Comments are wrapped, rails have no text, names of contacts stand above.
        if matches!(element.kind, ElementKind::Comment(_) | ElementKind::LeftRail | ElementKind::RightRail) {
            continue;
        }
        let (wide, high) = needs(element);
        if element.size.x >= 1.0 {
            across = across.max(f64::from(wide) / element.size.x);
        }
        if element.size.y >= 1.0 {
            down = down.max(f64::from(high) / element.size.y);
        }
    }
    (across.min(4.0), down.min(4.0))
}

impl Placed {
    fn new(element: &Element, across: f64, down: f64) -> Self {
        let at = |v: f64, by: f64| (v * by).clamp(-1e6, 1e6).round() as i32;
        let (wide, high) = needs(element);
        let (left, top) = (at(element.position.x, across), at(element.position.y, down));
        let comment = matches!(element.kind, ElementKind::Comment(_));
        let size = |drawn: f64, by: f64, needed: i32| match drawn >= 1.0 {
            true => at(drawn, by).max(if comment { 0 } else { needed }),
            false => needed,
        };
        let rail = matches!(element.kind, ElementKind::LeftRail | ElementKind::RightRail);
        let across_size = if rail { 4 } else { size(element.size.x, across, wide) };
        let rect = Rect { left, top, right: left + across_size, bottom: top + size(element.size.y, down, high) };
        let mut place =
            Placed { rect, ins: Vec::new(), outs: Vec::new(), above: above(element), beside: beside(element) };
        place.pins(element, |pin| (pin.at.y > 0.0).then(|| top + at(pin.at.y, down)));
        // Contacts and coils have one line through them.
        if matches!(element.kind, ElementKind::Contact { .. } | ElementKind::Coil { .. }) {
            let level = place.ins[0].1;
            place.outs[0].1 = level;
            (place.rect.top, place.rect.bottom) = (level - 12, level + 12);
        }
        place
    }

    /// Pins, where the file says how far down, else evenly.
    fn pins(&mut self, element: &Element, given: impl Fn(&Pin) -> Option<i32>) {
        let rect = self.rect;
        let block = matches!(element.kind, ElementKind::Block { .. });
        let middle = (rect.top + rect.bottom) / 2;
        let spread = |pins: &[Pin]| -> Vec<i32> {
            let all: Vec<Option<i32>> = pins.iter().map(&given).collect();
            let known = all.iter().all(Option::is_some);
            let even = |n: usize| match block {
                true => rect.top + 24 + PIN / 2 + n as i32 * PIN,
                false => middle,
            };
            all.iter()
                .enumerate()
                .map(|(n, y)| match y {
                    Some(y) if known => (*y).clamp(rect.top + 2, rect.bottom - 2),
                    _ => even(n),
                })
                .collect()
        };
        self.ins = spread(&element.inputs).into_iter().map(|y| (rect.left, y)).collect();
        self.outs = spread(&element.outputs).into_iter().map(|y| (rect.right, y)).collect();
        if self.ins.is_empty() {
            self.ins.push((rect.left, middle));
        }
        if self.outs.is_empty() {
            self.outs.push((rect.right, middle));
        }
    }

    /// With what stands above.
    fn around(&self) -> Rect {
        let (left, right) = self.beside;
        let rect = self.rect;
        Rect { left: rect.left - left, right: rect.right + right, top: rect.top - self.above, ..rect }
    }

    fn shift(&mut self, x: i32, y: i32) {
        self.rect = self.rect.moved(x, y);
        for point in self.ins.iter_mut().chain(&mut self.outs) {
            *point = (point.0 + x, point.1 + y);
        }
    }
}

fn above(element: &Element) -> i32 {
    match &element.kind {
        ElementKind::Contact { .. } | ElementKind::Coil { .. } | ElementKind::Block { instance: Some(_), .. } => 18,
        _ => 0,
    }
}

/// Room for the operands at the pins of a block.
fn beside(element: &Element) -> (i32, i32) {
    let room = |pins: &[Pin]| {
        let widths = pins.iter().filter_map(|p| p.operand.as_ref()).map(|e| operand_width(e) + STUB);
        widths.max().unwrap_or(0)
    };
    (room(&element.inputs), room(&element.outputs))
}

fn operand_width(operand: &Expr) -> i32 {
    width(&source::expression(operand)) + 14
}

/// Columns along the data flow, for elements without positions.
fn columns(elements: &[Element]) -> Vec<Placed> {
    let by_id: HashMap<u64, usize> = elements.iter().enumerate().map(|(n, e)| (e.id, n)).collect();
    let sources = |n: usize| {
        let connections = elements[n].inputs.iter().flat_map(|p| &p.connections);
        connections.filter_map(|c| by_id.get(&c.from).copied()).collect::<Vec<_>>()
    };
    let mut column = vec![0usize; elements.len()];
    // A loop ends when everything has been looked at often enough.
    for _ in 0..elements.len().min(64) {
        let mut changed = false;
        for n in 0..elements.len() {
            let after = sources(n).iter().map(|s| column[*s] + 1).max().unwrap_or(0).min(64);
            changed |= after > column[n];
            column[n] = column[n].max(after);
        }
        if !changed {
            break;
        }
    }
    let last = column.iter().copied().max().unwrap_or(0);
    let mut x = 0;
    let mut boxes: Vec<Option<Placed>> = elements.iter().map(|_| None).collect();
    for number in 0..=last {
        let mut y = 0;
        let mut right = x;
        for (n, element) in elements.iter().enumerate().filter(|(n, _)| column[*n] == number) {
            let (wide, high) = needs(element);
            y += above(element);
            let rect = Rect { left: x, top: y, right: x + wide, bottom: y + high };
            let mut place =
                Placed { rect, ins: Vec::new(), outs: Vec::new(), above: above(element), beside: beside(element) };
            place.pins(element, |_| None);
            right = right.max(rect.right);
            y += high + 24;
            boxes[n] = Some(place);
        }
        x = right + 60;
    }
    boxes.into_iter().flatten().collect()
}

/// Rails reach from the first to the last rung that is connected to them.
fn lengthen_rails(elements: &[Element], boxes: &mut [Placed]) {
    let rail = |e: &Element| matches!(e.kind, ElementKind::LeftRail | ElementKind::RightRail);
    let by_id: HashMap<u64, usize> = elements.iter().enumerate().map(|(n, e)| (e.id, n)).collect();
    let mut rungs: Vec<(usize, i32)> = Vec::new();
    for (n, element) in elements.iter().enumerate() {
        for (pin, connection) in
            element.inputs.iter().enumerate().flat_map(|(p, i)| i.connections.iter().map(move |c| (p, c)))
        {
            let Some(&source) = by_id.get(&connection.from) else { continue };
            if rail(&elements[source]) {
                rungs.push((source, boxes[n].ins[pin.min(boxes[n].ins.len() - 1)].1));
            }
            if rail(element) {
                rungs.push((n, boxes[source].outs[0].1));
            }
        }
    }
    for (n, y) in rungs {
        let rect = &mut boxes[n].rect;
        rect.top = rect.top.min(y - STUB);
        rect.bottom = rect.bottom.max(y + STUB);
    }
}

/// The lines between elements.
fn lines(
    elements: &[Element],
    boxes: &[Placed],
    (across, down): (f64, f64),
    offset: (i32, i32),
    shapes: &mut Vec<Shape>,
) {
    let mut by_id: HashMap<u64, usize> = HashMap::new();
    for (n, element) in elements.iter().enumerate() {
        by_id.entry(element.id).or_insert(n);
    }
    let mut consumers: HashMap<(usize, usize), usize> = HashMap::new();
    let output = |source: usize, connection: &Connection| {
        let outputs = &elements[source].outputs;
        let named = |name: &str| outputs.iter().position(|p| p.name.eq_ignore_ascii_case(name));
        connection.pin.as_deref().and_then(named).unwrap_or(0).min(boxes[source].outs.len() - 1)
    };
    let all = || {
        elements.iter().enumerate().flat_map(|(n, e)| {
            e.inputs.iter().enumerate().flat_map(move |(p, pin)| pin.connections.iter().map(move |c| (n, p, pin, c)))
        })
    };
    for (_, _, _, connection) in all() {
        if let Some(&source) = by_id.get(&connection.from) {
            *consumers.entry((source, output(source, connection))).or_default() += 1;
        }
    }
    for (n, p, pin, connection) in all() {
        let Some(&source) = by_id.get(&connection.from) else { continue };
        let from_pin = output(source, connection);
        let mut to = boxes[n].ins[p.min(boxes[n].ins.len() - 1)];
        let mut from = boxes[source].outs[from_pin];
        // Rungs leave the rails at their own height.
        let rail = |k: usize| matches!(elements[k].kind, ElementKind::LeftRail | ElementKind::RightRail);
        if rail(source) {
            from.1 = to.1;
        }
        if rail(n) {
            to.1 = from.1;
        }
        let at = |v: f64, by: f64, o: i32| (v * by).clamp(-1e6, 1e6).round() as i32 + o;
        let corners: Vec<(i32, i32)> = connection
            .path
            .iter()
            .rev()
            .map(|point| (at(point.x, across, offset.0), at(point.y, down, offset.1)))
            .collect();
        let branches = consumers.get(&(source, from_pin)).copied().unwrap_or(1) > 1;
        let meets = pin.connections.len() > 1;
        let points = match corners.len() > 2 && !rail(source) && !rail(n) {
            true => snapped(from, corners, to),
            false => route(from, to, branches, meets, boxes[source].rect.bottom.max(boxes[n].rect.bottom)),
        };
        if from.1 != to.1 && points.len() >= 4 {
            if branches && !rail(source) {
                shapes.push(Shape::Dot { x: points[1].0, y: points[1].1 });
            }
            if meets {
                let end = points[points.len() - 2];
                shapes.push(Shape::Dot { x: end.0, y: end.1 });
            }
        }
        shapes.push(Shape::Wire { points });
    }
}

/// A line with the corners of the file, its ends at the pins.
fn snapped(from: (i32, i32), corners: Vec<(i32, i32)>, to: (i32, i32)) -> Vec<(i32, i32)> {
    let mut points = corners;
    let last = points.len() - 1;
    let (first, second) = (points[0], points[1]);
    let (before, end) = (points[last - 1], points[last]);
    points[0] = from;
    points[last] = to;
    // The neighbours of the ends keep their lines level.
    if first.1 == second.1 {
        points[1].1 = from.1;
    } else if first.0 == second.0 {
        points[1].0 = from.0;
    }
    if before.1 == end.1 {
        points[last - 1].1 = to.1;
    } else if before.0 == end.0 {
        points[last - 1].0 = to.0;
    }
    points
}

/// A line of level and upright parts.
fn route(from: (i32, i32), to: (i32, i32), branches: bool, meets: bool, bottom: i32) -> Vec<(i32, i32)> {
    if from.1 == to.1 && from.0 <= to.0 {
        return vec![from, to];
    }
    if to.0 - from.0 < 2 * STUB {
        // Back: around below both.
        let (out, back, below) = (from.0 + STUB, to.0 - STUB, bottom + 16);
        return vec![from, (out, from.1), (out, below), (back, below), (back, to.1), to];
    }
    let bend = match (meets, branches) {
        (true, _) => to.0 - STUB,
        (false, true) => from.0 + STUB,
        (false, false) => (from.0 + to.0) / 2,
    };
    vec![from, (bend, from.1), (bend, to.1), to]
}

/// The element itself.
fn shapes_of(element: &Element, place: &Placed, shapes: &mut Vec<Shape>) {
    let rect = place.rect;
    let text = text(element);
    let letter = |m: &Modifier| {
        let storage = match m.storage {
            Some(Storage::Set) => "S",
            Some(Storage::Reset) => "R",
            None => "",
        };
        let edge = match m.edge {
            Some(Edge::Rising) => "P",
            Some(Edge::Falling) => "N",
            None => "",
        };
        format!("{}{storage}{edge}", if m.negated { "/" } else { "" })
    };
    match &element.kind {
        ElementKind::LeftRail | ElementKind::RightRail => {
            let rect = Rect { left: rect.left, right: rect.left + 4, ..rect };
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Rail, text, mark: String::new() });
        }
        ElementKind::Contact { modifier, .. } => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Contact, text, mark: letter(modifier) });
        }
        ElementKind::Coil { modifier, .. } => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Coil, text, mark: letter(modifier) });
        }
        ElementKind::Block { instance, .. } => {
            for (pin, (x, y)) in element.inputs.iter().zip(&place.ins) {
                let Some(operand) = &pin.operand else { continue };
                let right = x - STUB;
                let rect = Rect { left: right - operand_width(operand), right, top: y - 9, bottom: y + 9 };
                let text = source::expression(operand);
                shapes.push(Shape::Wire { points: vec![(right, *y), (*x, *y)] });
                shapes.push(Shape::Symbol { rect, symbol: Symbol::Read, text, mark: String::new() });
            }
            for (pin, (x, y)) in element.outputs.iter().zip(&place.outs) {
                let Some(operand) = &pin.operand else { continue };
                let left = x + STUB;
                let rect = Rect { left, right: left + operand_width(operand), top: y - 9, bottom: y + 9 };
                let text = source::expression(operand);
                shapes.push(Shape::Wire { points: vec![(*x, *y), (left, *y)] });
                shapes.push(Shape::Symbol { rect, symbol: Symbol::Written, text, mark: String::new() });
            }
            let instance = instance.as_ref().map(source::expression).unwrap_or_default();
            let pin = |(pin, (_, y)): (&Pin, &(i32, i32))| (*y, pin.name.to_string(), letter(&pin.modifier));
            shapes.push(Shape::Block {
                rect,
                ty: text,
                instance,
                ins: element.inputs.iter().zip(&place.ins).map(pin).collect(),
                outs: element.outputs.iter().zip(&place.outs).map(pin).collect(),
                order: element.order.map(|n| n.to_string()).unwrap_or_default(),
            });
        }
        ElementKind::In { modifier, .. } => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Read, text, mark: letter(modifier) });
        }
        ElementKind::Out { modifier, .. } => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Written, text, mark: letter(modifier) });
        }
        ElementKind::InOut { negated_in, negated_out, .. } => {
            let symbol = if *negated_out { Symbol::Read } else { Symbol::Written };
            let mark = if *negated_in || *negated_out { "/".to_string() } else { String::new() };
            shapes.push(Shape::Symbol { rect, symbol, text, mark });
        }
        ElementKind::Connector(_) => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Link, text: format!("> {text}"), mark: String::new() });
        }
        ElementKind::Continuation(_) => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Link, text: format!("{text} >"), mark: String::new() });
        }
        ElementKind::Jump(_) => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Link, text: format!(">> {text}"), mark: String::new() });
        }
        ElementKind::Return | ElementKind::Condition => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Link, text, mark: String::new() });
        }
        ElementKind::Label(_) => {
            shapes.push(Shape::Symbol { rect, symbol: Symbol::Label, text, mark: String::new() });
        }
        ElementKind::Comment(_) => {
            let lines = wrapped(&text, (rect.right - rect.left).max(120));
            let high = lines.len() as i32 * (FONT + 4) + 6;
            let rect = Rect {
                right: rect.left + (rect.right - rect.left).max(120),
                bottom: rect.bottom.max(rect.top + high),
                ..rect
            };
            shapes.push(Shape::Remark { rect, lines });
        }
    }
}

/// Lines that are no wider than `most`, where words allow it.
fn wrapped(text: &str, most: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for written in text.lines().take(100) {
        let mut line = String::new();
        for word in written.split_whitespace() {
            if !line.is_empty() && width(&line) + width(word) + 16 > most {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        lines.push(line);
    }
    lines
}
