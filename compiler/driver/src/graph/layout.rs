//! Places the parts of a chart as the standard draws them: sequences downwards, alternatives between single lines,
//! simultaneous branches between double lines, everything else a jump with the name of its target.
//!
//! In: a [`Chart`]. Out: a [`Picture`]. Branches are set side by side as close as their outlines allow. Where a line to
//! the place at which branches meet would cross another part, the link becomes a jump and the chart is placed anew.

use super::chart::{Chart, Step, Transition};
use super::picture::{Picture, Rect, Shape};
use super::tree::{Node, Tree};
use std::collections::HashSet;

/// The size of text: all of it has one width per character, so that boxes fit without measuring.
pub const FONT: i32 = 13;
const CHAR: f32 = 7.85;
const LINE: i32 = 17;
const STEP_HEIGHT: i32 = 36;
const STEP_WIDTH: i32 = 84;
const ROW: i32 = 24;
const BAR: i32 = 14;
const STUB: i32 = 14;
const GAP: i32 = 26;
/// Between the two lines of a double line.
pub const DOUBLE: i32 = 4;
/// How far a double line stands out beyond its outer branches.
const OVERHANG: i32 = 24;
/// Characters of a condition in one line.
const WRAP: usize = 44;

/// Places a chart.
pub fn place(chart: &Chart) -> Picture {
    let tree = Tree::new(chart);
    let mut forced = HashSet::new();
    // Each round turns at least one more link into a jump.
    loop {
        let mut layout = Layout { chart, tree: &tree, forced: forced.clone(), placed: HashSet::new() };
        let mut blocks = Vec::new();
        for &root in &tree.roots {
            blocks.push(layout.column(root));
        }
        if layout.forced.len() == forced.len() {
            return side_by_side(blocks);
        }
        forced = layout.forced;
    }
}

/// The width of a text.
pub fn width(text: &str) -> i32 {
    (text.chars().count() as f32 * CHAR).ceil() as i32
}

/// A way that goes on below the block, to where branches meet.
#[derive(Debug, Clone, Copy)]
struct Exit {
    x: i32,
    y: i32,
    from: Node,
    to: Node,
}

/// Parts that are placed relative to each other.
#[derive(Debug, Default)]
struct Block {
    shapes: Vec<Shape>,
    exits: Vec<Exit>,
    /// Where the line enters at the top.
    spine: i32,
    /// Where the next part is put below.
    bottom: i32,
}

const FAR: i32 = 1 << 28;

impl Block {
    fn shift(&mut self, dx: i32, dy: i32) {
        self.shapes.iter_mut().for_each(|s| s.shift(dx, dy));
        for exit in &mut self.exits {
            exit.x += dx;
            exit.y += dy;
        }
        self.spine += dx;
        self.bottom += dy;
    }

    /// What it takes, with the ways that still go on.
    fn outline(&self) -> impl Iterator<Item = Rect> + '_ {
        let ways = self.exits.iter().map(|e| Rect { left: e.x - 1, top: e.y, right: e.x + 1, bottom: FAR });
        self.shapes.iter().map(Shape::rect).chain(ways)
    }

    fn take(&mut self, other: Block) {
        self.shapes.extend(other.shapes);
        self.exits.extend(other.exits);
    }

    /// Puts a block below, its spine in line.
    fn below(&mut self, mut other: Block) {
        let (x, y) = (self.spine - other.spine, self.bottom);
        other.shift(x, y);
        self.bottom = other.bottom;
        self.take(other);
    }

    fn line(&mut self, left: i32, top: i32, right: i32, bottom: i32) {
        self.shapes.push(Shape::Line { rect: Rect { left, top, right, bottom }, double: false });
    }

    fn down(&mut self, x: i32, top: i32, bottom: i32) {
        if bottom > top {
            self.line(x, top, x, bottom);
        }
    }

    /// A line straight down at the spine.
    fn stub(&mut self, length: i32) {
        self.down(self.spine, self.bottom, self.bottom + length);
        self.bottom += length;
    }

    fn double(&mut self, left: i32, right: i32) {
        let rect = Rect { left, top: self.bottom, right, bottom: self.bottom + DOUBLE };
        self.shapes.push(Shape::Line { rect, double: true });
        self.bottom += DOUBLE;
    }
}

struct Layout<'a> {
    chart: &'a Chart,
    tree: &'a Tree,
    /// Links that are jumps because a line cannot be drawn.
    forced: HashSet<(Node, Node)>,
    placed: HashSet<Node>,
}

enum Way {
    Goes(Node),
    Meets(Node),
    Jumps(Node),
}

impl Layout<'_> {
    /// A node and everything behind it.
    fn column(&mut self, start: Node) -> Block {
        let mut block = Block::default();
        let mut at = start;
        loop {
            self.placed.insert(at);
            block.below(self.glyph(at));
            let ways: Vec<Way> = self.tree.succ(at).iter().map(|&next| self.way(at, next)).collect();
            let joins: Vec<Node> = self.tree.joins(at);
            match ways.as_slice() {
                [] => {}
                [Way::Goes(next)] => {
                    at = *next;
                    continue;
                }
                [Way::Meets(to)] => block.exits.push(Exit { x: block.spine, y: block.bottom, from: at, to: *to }),
                [Way::Jumps(to)] => block.below(self.jump(*to)),
                _ => self.branches(&mut block, at, ways),
            }
            for join in joins {
                self.join(&mut block, join);
            }
            return block;
        }
    }

    fn way(&self, from: Node, to: Node) -> Way {
        if self.tree.continues(from, to) && !self.placed.contains(&to) {
            return Way::Goes(to);
        }
        let open = !self.placed.contains(&to) && self.tree.forward(from, to);
        match open && !self.forced.contains(&(from, to)) {
            true => Way::Meets(to),
            false => Way::Jumps(to),
        }
    }

    // ---- branches ----

    fn branches(&mut self, block: &mut Block, at: Node, ways: Vec<Way>) {
        let simultaneous = self.tree.step(at).is_none();
        let mut all = Block::default();
        let mut spines = Vec::new();
        for way in ways {
            let mut column = Block::default();
            match way {
                Way::Goes(next) => {
                    if simultaneous {
                        column.stub(STUB);
                    }
                    column.below(self.column(next));
                }
                Way::Meets(to) => column.exits.push(Exit { x: 0, y: 0, from: at, to }),
                Way::Jumps(to) => column.below(self.jump(to)),
            }
            let shift = beside(&all, &column);
            column.shift(shift, 0);
            spines.push(column.spine);
            all.take(column);
        }
        let (first, last) = (spines[0], spines[spines.len() - 1]);
        all.spine = if simultaneous { (first + last) / 2 } else { first };
        let x = block.spine - all.spine;
        if simultaneous {
            block.double(first + x - OVERHANG, last + x + OVERHANG);
        } else {
            block.stub(STUB);
            block.line(first + x, block.bottom, last + x, block.bottom);
        }
        all.bottom = 0;
        block.below(all);
    }

    /// Where branches meet again.
    fn join(&mut self, block: &mut Block, node: Node) {
        if self.placed.contains(&node) {
            return;
        }
        let (mine, rest): (Vec<Exit>, Vec<Exit>) = block.exits.drain(..).partition(|e| e.to == node);
        block.exits = rest;
        let simultaneous = self.tree.step(node).is_none();
        let left = mine.iter().map(|e| e.x).min();
        let right = mine.iter().map(|e| e.x).max();
        let mut sub = self.meeting(node, &mine);
        let spine = match (left, right) {
            (Some(left), Some(right)) if simultaneous => (left + right) / 2,
            (Some(left), Some(right)) if (left..=right).contains(&block.spine) => block.spine,
            (Some(left), _) => left,
            _ => block.spine,
        };
        sub.shift(spine - sub.spine, 0);
        // Below everything that stands over it or over the line that collects the branches.
        let (left, right) = (left.unwrap_or(spine), right.unwrap_or(spine));
        let reach = |low: fn(Rect) -> i32, pick: fn(i32, i32) -> i32, start| {
            sub.shapes.iter().map(|s| low(s.rect())).fold(start, pick)
        };
        let span = Rect {
            left: reach(|r| r.left, i32::min, left),
            top: -FAR,
            right: reach(|r| r.right, i32::max, right),
            bottom: FAR,
        };
        let span = span.wider(GAP / 2);
        let above = block.shapes.iter().map(Shape::rect).filter(|r| r.wider(1).overlaps(span)).map(|r| r.bottom);
        let top = above.chain(mine.iter().map(|e| e.y)).max().unwrap_or(block.bottom);
        let top = if mine.len() > 1 || mine.is_empty() { top + STUB } else { top };
        for exit in &mine {
            block.down(exit.x, exit.y, top);
        }
        if mine.len() > 1 && !simultaneous {
            block.line(left, top, right, top);
        }
        sub.shift(0, top);
        // A way past this place must not cross it.
        for exit in &block.exits {
            let way = Rect { left: exit.x - 1, top: exit.y, right: exit.x + 1, bottom: FAR };
            let crosses = (left..=right).contains(&exit.x) && mine.len() > 1 && exit.y <= top;
            if crosses || sub.outline().any(|r| r.wider(6).overlaps(way)) {
                self.forced.insert((exit.from, exit.to));
            }
        }
        block.take(sub);
    }

    /// The head of a place where branches meet, and what is behind it.
    fn meeting(&mut self, node: Node, mine: &[Exit]) -> Block {
        let mut block = Block::default();
        if self.tree.step(node).is_some() {
            if mine.len() > 1 {
                block.stub(STUB);
            }
            block.below(self.column(node));
            return block;
        }
        let xs = || mine.iter().map(|e| e.x);
        let half = (xs().max().unwrap_or(0) - xs().min().unwrap_or(0)) / 2;
        let far: Vec<Node> =
            self.tree.pred(node).iter().copied().filter(|p| !mine.iter().any(|e| e.from == *p)).collect();
        if mine.len() + far.len() < 2 {
            block.below(self.column(node));
            return block;
        }
        // Steps from which no line leads here arrive by name.
        let mut edge = half;
        let height = if far.is_empty() { 0 } else { LINE + STUB + 8 };
        for step in far {
            let from = self.tree.step(step).map_or(String::new(), |s| self.chart.steps[s].name.clone());
            let wide = width(&from).max(16);
            let x = edge + GAP + wide / 2;
            let rect = Rect { left: x - wide / 2, top: 0, right: x + wide / 2, bottom: height };
            block.shapes.push(Shape::Arrival { rect, x, from });
            edge = x + wide / 2;
        }
        for x in xs() {
            let middle = (xs().max().unwrap_or(0) + xs().min().unwrap_or(0)) / 2;
            block.down(x - middle, 0, height);
        }
        block.bottom = height;
        block.double(-half - OVERHANG, edge.max(half) + OVERHANG);
        block.below(self.column(node));
        block
    }

    // ---- single parts ----

    fn glyph(&self, node: Node) -> Block {
        match self.tree.step(node) {
            Some(step) => step_glyph(&self.chart.steps[step]),
            None => transition_glyph(&self.chart.transitions[self.tree.transition(node)]),
        }
    }

    fn jump(&self, to: Node) -> Block {
        let name = match self.tree.step(to) {
            Some(step) => self.chart.steps[step].name.clone(),
            None => {
                let number = self.tree.transition(to);
                self.chart.transitions[number].label(number)
            }
        };
        let wide = width(&name).max(16);
        let rect = Rect { left: -wide / 2, top: 0, right: wide - wide / 2, bottom: STUB + 8 + LINE + 4 };
        Block { bottom: rect.bottom, shapes: vec![Shape::Jump { rect, x: 0, to: name }], ..Block::default() }
    }
}

fn step_glyph(step: &Step) -> Block {
    let half = (width(&step.name) + 28).max(STEP_WIDTH) / 2;
    let rect = Rect { left: -half, top: 0, right: half, bottom: STEP_HEIGHT };
    let mut block = Block { bottom: STEP_HEIGHT, ..Block::default() };
    let active = step.active;
    block.shapes.push(Shape::Step { rect, name: step.name.clone(), initial: step.initial, active });
    if step.actions.is_empty() {
        return block;
    }
    let left = half + 18;
    let middle = STEP_HEIGHT / 2;
    block.line(half, middle, left, middle);
    // Cells as wide as their longest text; times and indicators only where there are any.
    let texts = |a: &super::chart::Action| [a.qualifier.clone(), a.name.clone(), a.time.clone(), a.indicator.clone()];
    let mut widths = [0; 4];
    for action in &step.actions {
        for (wide, text) in widths.iter_mut().zip(texts(action)) {
            *wide = (*wide).max(if text.is_empty() { 0 } else { width(&text) + 14 });
        }
    }
    widths[0] = widths[0].max(30);
    let mut top = (STEP_HEIGHT - ROW) / 2;
    for action in &step.actions {
        let mut right = left;
        let cells = texts(action).into_iter().zip(widths).filter(|(_, wide)| *wide > 0).map(|(text, wide)| {
            right += wide;
            (right, text)
        });
        let cells: Vec<(i32, String)> = cells.collect();
        let rect = Rect { left, top, right, bottom: top + ROW };
        block.shapes.push(Shape::Action { rect, cells, active });
        top += ROW;
    }
    if top + 4 > STEP_HEIGHT {
        block.stub(top + 4 - STEP_HEIGHT);
    }
    block
}

fn transition_glyph(transition: &Transition) -> Block {
    let mut head = transition.name.clone().unwrap_or_default();
    if let Some(priority) = &transition.priority {
        let space = if head.is_empty() { "" } else { " " };
        head = format!("{head}{space}({priority})");
    }
    let mut lines = wrapped(&transition.condition);
    if lines.is_empty() {
        lines.push(String::new());
    }
    let indent = if head.is_empty() { 0 } else { width(&head) + 10 };
    let widest = lines.iter().map(|l| width(l)).max().unwrap_or(0);
    let height = (lines.len() as i32 * LINE + 10).max(44);
    let y = height / 2;
    let rect = Rect { left: -BAR, top: 0, right: BAR + 8 + indent + widest, bottom: height };
    let mut block = Block::default();
    block.down(0, 0, height);
    block.shapes.push(Shape::Transition { rect, x: 0, y, head, lines });
    block.bottom = height;
    block
}

/// A condition in lines: as written, long ones broken at blanks.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    for written in text.lines() {
        let mut line = String::new();
        for word in written.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > WRAP {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

// ---- side by side ----

/// How far `next` must go to the right to stand beside what is there.
fn beside(there: &Block, next: &Block) -> i32 {
    let mut shift: Option<i32> = None;
    for a in there.outline() {
        for b in next.outline() {
            // Parts at the same height, with room for the lines between them.
            if a.top < b.bottom + 6 && b.top < a.bottom + 6 {
                let needed = a.right + GAP - b.left;
                shift = Some(shift.map_or(needed, |s| s.max(needed)));
            }
        }
    }
    shift.unwrap_or(0)
}

/// Networks from left to right, and the picture's origin at its left top.
fn side_by_side(blocks: Vec<Block>) -> Picture {
    const BETWEEN: i32 = 56;
    const MARGIN: i32 = 24;
    let mut picture = Picture::default();
    let mut x = MARGIN;
    for mut block in blocks {
        let rects = || block.shapes.iter().map(Shape::rect);
        let left = rects().map(|r| r.left).min().unwrap_or(0);
        let right = rects().map(|r| r.right).max().unwrap_or(0);
        block.shift(x - left, MARGIN);
        x += right - left + BETWEEN;
        picture.shapes.extend(block.shapes);
    }
    picture.width = x - BETWEEN + MARGIN;
    picture.height = picture.shapes.iter().map(|s| s.rect().bottom).max().unwrap_or(0) + MARGIN;
    picture
}
