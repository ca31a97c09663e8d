//! A picture as SVG. Colours follow the reader's light or dark scheme.

use super::layout::{DOUBLE, FONT};
use super::picture::{Picture, Rect, Shape, Symbol};
use std::fmt::Write;

/// Classes with their colours: first the light ones, then those for readers that prefer dark. No CSS variables: not every
/// viewer of SVG knows them.
const STYLE: &str = "\
.sfc text { font: 13px ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace; fill: #1f2933; }
.sfc .paper { fill: #ffffff; }
.sfc .box { fill: #f4f6f8; stroke: #1f2933; stroke-width: 2; }
.sfc .cell { fill: none; stroke: #1f2933; stroke-width: 1; }
.sfc .live { fill: #ffe08a; }
.sfc .dot { fill: #b45309; }
.sfc .line { stroke: #1f2933; stroke-width: 2; stroke-linecap: square; }
.sfc .bar { stroke: #1f2933; stroke-width: 4; }
.sfc .way { stroke: #1d4ed8; stroke-width: 2; }
.sfc .arrow, .sfc .to { fill: #1d4ed8; }
.sfc .name { font-weight: 600; }
.sfc .head { fill: #5b6876; }
.sfc .title { font-size: 15px; font-weight: 600; }
@media (prefers-color-scheme: dark) {
.sfc text { fill: #e2e8f0; }
.sfc .paper { fill: #14181d; }
.sfc .box { fill: #1f262e; stroke: #e2e8f0; }
.sfc .cell { stroke: #e2e8f0; }
.sfc .live { fill: #7a5200; }
.sfc .dot { fill: #fbbf24; }
.sfc .line, .sfc .bar { stroke: #e2e8f0; }
.sfc .way { stroke: #93c5fd; }
.sfc .arrow, .sfc .to { fill: #93c5fd; }
.sfc .head { fill: #9aa7b5; }
}
";

/// The same for the parts of networks; a drawing without networks does not hold it.
const NETWORK_STYLE: &str = "\
.sfc .net { fill: none; stroke: #1f2933; stroke-width: 1.5; }
.sfc .variable { fill: #ffffff; stroke: #9aa7b5; stroke-width: 1; }
.sfc .soft { fill: #eef2f6; stroke: #9aa7b5; stroke-width: 1; }
.sfc .pin { fill: #ffffff; stroke: #1f2933; stroke-width: 1.5; }
.sfc .small { font-size: 11px; fill: #5b6876; }
.sfc .joint { fill: #1f2933; }
@media (prefers-color-scheme: dark) {
.sfc .net, .sfc .pin { stroke: #e2e8f0; }
.sfc .variable, .sfc .pin { fill: #14181d; }
.sfc .soft { fill: #1b2129; stroke: #5b6876; }
.sfc .small { fill: #9aa7b5; }
.sfc .joint { fill: #e2e8f0; }
}
";

/// The picture as a document.
pub fn write(picture: &Picture) -> String {
    let (width, height) = (picture.width.max(1), picture.height.max(1));
    let mut out = Svg::default();
    let _ = writeln!(
        out.0,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"sfc\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">"
    );
    let network =
        |s: &Shape| matches!(s, Shape::Wire { .. } | Shape::Symbol { .. } | Shape::Block { .. } | Shape::Remark { .. });
    let more = if picture.shapes.iter().any(network) { NETWORK_STYLE } else { "" };
    let _ = write!(out.0, "<style>\n{STYLE}{more}</style>\n");
    out.rect("paper", Rect { left: 0, top: 0, right: width, bottom: height });
    // Lines first, boxes over their ends.
    let line = |s: &&Shape| matches!(s, Shape::Line { .. } | Shape::Wire { .. });
    for shape in picture.shapes.iter().filter(line) {
        out.shape(shape);
    }
    for shape in picture.shapes.iter().filter(|s| !line(s)) {
        out.shape(shape);
    }
    out.0.push_str("</svg>\n");
    out.0
}

#[derive(Default)]
struct Svg(String);

impl Svg {
    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Step { rect, name, initial, active } => self.step(*rect, name, *initial, *active),
            Shape::Action { rect, cells, active } => {
                self.rect(if *active { "cell live" } else { "cell" }, *rect);
                let mut left = rect.left;
                for (index, (right, text)) in cells.iter().enumerate() {
                    if index > 0 {
                        self.line("cell", left, rect.top, left, rect.bottom);
                    }
                    let middle = (left + right) / 2;
                    match index {
                        0 => self.text("", "middle", middle, baseline(*rect), text),
                        _ => self.text("", "start", left + 7, baseline(*rect), text),
                    }
                    left = *right;
                }
            }
            Shape::Transition { x, y, head, lines, .. } => {
                self.line("bar", x - 14, *y, x + 14, *y);
                let mut left = x + 22;
                let first = y - (lines.len() as i32 - 1) * 17 / 2 + 4;
                if !head.is_empty() {
                    self.text("head", "start", left, first, head);
                    left += super::layout::width(head) + 10;
                }
                for (index, line) in lines.iter().enumerate() {
                    self.text("", "start", left, first + index as i32 * 17, line);
                }
            }
            Shape::Jump { rect, x, to } => {
                let tip = rect.bottom - 21;
                self.line("way", *x, rect.top, *x, tip - 8);
                self.arrow(*x, tip);
                self.text("to", "middle", *x, rect.bottom - 5, to);
            }
            Shape::Arrival { rect, x, from } => {
                self.text("to", "middle", *x, rect.top + FONT, from);
                self.line("way", *x, rect.top + 18, *x, rect.bottom - 8);
                self.arrow(*x, rect.bottom);
            }
            Shape::Line { rect, double: false } => self.line("line", rect.left, rect.top, rect.right, rect.bottom),
            Shape::Line { rect, double: true } => {
                self.line("line", rect.left, rect.top, rect.right, rect.top);
                self.line("line", rect.left, rect.top + DOUBLE, rect.right, rect.top + DOUBLE);
            }
            Shape::Wire { points } => {
                let corners: Vec<String> = points.iter().map(|(x, y)| format!("{x},{y}")).collect();
                let _ = writeln!(self.0, "<polyline class=\"net\" points=\"{}\"/>", corners.join(" "));
            }
            Shape::Dot { x, y } => {
                let _ = writeln!(self.0, "<circle class=\"joint\" cx=\"{x}\" cy=\"{y}\" r=\"3\"/>");
            }
            Shape::Symbol { rect, symbol, text, mark } => self.symbol(*rect, *symbol, text, mark),
            Shape::Block { rect, ty, instance, ins, outs, order } => {
                self.rect("box", *rect);
                let middle = (rect.left + rect.right) / 2;
                self.text("name", "middle", middle, rect.top + FONT + 4, ty);
                self.text("", "middle", middle, rect.top - 5, instance);
                self.text("small", "end", rect.right, rect.bottom + FONT, order);
                for (y, name, mark) in ins {
                    self.text("", "start", rect.left + 8, y + 4, name);
                    self.pin(rect.left, *y, mark, true);
                }
                for (y, name, mark) in outs {
                    self.text("", "end", rect.right - 8, y + 4, name);
                    self.pin(rect.right, *y, mark, false);
                }
            }
            Shape::Remark { rect, lines } => {
                self.rect("soft", *rect);
                for (n, line) in lines.iter().enumerate() {
                    self.text("head", "start", rect.left + 6, rect.top + FONT + 3 + n as i32 * (FONT + 4), line);
                }
            }
            Shape::Title { rect, text } => self.text("title", "start", rect.left, rect.bottom - 5, text),
        }
    }

    fn step(&mut self, rect: Rect, name: &str, initial: bool, active: bool) {
        self.rect(if active { "box live" } else { "box" }, rect);
        if initial {
            let inner = Rect { left: rect.left + 4, top: rect.top + 4, right: rect.right - 4, bottom: rect.bottom - 4 };
            self.rect("cell", inner);
        }
        let middle = (rect.left + rect.right) / 2;
        self.text("name", "middle", middle, baseline(rect), name);
        if active {
            let _ = writeln!(self.0, "<circle class=\"dot\" cx=\"{middle}\" cy=\"{}\" r=\"3.5\"/>", rect.bottom - 8);
        }
    }

    /// An element of a network: its variable above or inside, what changes its value as a letter.
    fn symbol(&mut self, rect: Rect, symbol: Symbol, text: &str, mark: &str) {
        let (middle, level) = ((rect.left + rect.right) / 2, (rect.top + rect.bottom) / 2);
        match symbol {
            Symbol::Rail => self.rect("joint", rect),
            Symbol::Contact | Symbol::Coil => {
                // The line goes through the paper behind it.
                let gap = Rect { left: middle - 8, right: middle + 8, top: level - 9, bottom: level + 9 };
                self.line("net", rect.left, level, gap.left, level);
                self.line("net", gap.right, level, rect.right, level);
                self.rect("paper", gap);
                if symbol == Symbol::Contact {
                    self.line("line", gap.left, gap.top, gap.left, gap.bottom);
                    self.line("line", gap.right, gap.top, gap.right, gap.bottom);
                } else {
                    for (x, bow) in [(gap.left, -5), (gap.right, 5)] {
                        let _ = writeln!(
                            self.0,
                            "<path class=\"net\" d=\"M{x} {}Q{} {level} {x} {}\"/>",
                            gap.top,
                            x + bow,
                            gap.bottom
                        );
                    }
                }
                self.text("", "middle", middle, level + 4, mark);
                self.text("", "middle", middle, rect.top - 4, text);
            }
            Symbol::Read | Symbol::Written => {
                self.rect("variable", rect);
                self.text("", "middle", middle, baseline(rect), text);
                match symbol {
                    Symbol::Read => self.pin(rect.right, level, mark, false),
                    _ => self.pin(rect.left, level, mark, true),
                }
            }
            Symbol::Link => {
                self.rect("soft", rect);
                self.text("", "middle", middle, baseline(rect), text);
            }
            Symbol::Label => self.text("name", "start", rect.left, baseline(rect), text),
        }
    }

    /// A pin of a block that is negated (a ring) or takes an edge.
    fn pin(&mut self, x: i32, y: i32, mark: &str, input: bool) {
        if mark.contains('/') {
            let x = if input { x - 5 } else { x + 5 };
            let _ = writeln!(self.0, "<circle class=\"pin\" cx=\"{x}\" cy=\"{y}\" r=\"4\"/>");
        }
        let letters: String = mark.chars().filter(|c| *c != '/').collect();
        self.text("small", if input { "end" } else { "start" }, if input { x - 4 } else { x + 4 }, y - 4, &letters);
    }

    fn rect(&mut self, class: &str, rect: Rect) {
        let (width, height) = (rect.right - rect.left, rect.bottom - rect.top);
        let _ = writeln!(
            self.0,
            "<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\"/>",
            rect.left, rect.top
        );
    }

    fn line(&mut self, class: &str, x1: i32, y1: i32, x2: i32, y2: i32) {
        let _ = writeln!(self.0, "<line class=\"{class}\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>");
    }

    /// An arrowhead with its tip down here.
    fn arrow(&mut self, x: i32, y: i32) {
        let (left, right, top) = (x - 4, x + 4, y - 8);
        let _ = writeln!(self.0, "<path class=\"arrow\" d=\"M{left} {top}H{right}L{x} {y}Z\"/>");
    }

    fn text(&mut self, class: &str, anchor: &str, x: i32, y: i32, text: &str) {
        if text.is_empty() {
            return;
        }
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        let anchor = if anchor == "start" { String::new() } else { format!(" text-anchor=\"{anchor}\"") };
        let _ = writeln!(self.0, "<text{class}{anchor} x=\"{x}\" y=\"{y}\">{}</text>", escaped(text));
    }
}

/// Where text stands that is in the middle of a box.
fn baseline(rect: Rect) -> i32 {
    (rect.top + rect.bottom) / 2 + 4
}

/// Text without what XML would read as a sign of its own, or must not contain.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c < ' ' || ('\u{7f}'..='\u{9f}').contains(&c) || matches!(c, '\u{fffe}' | '\u{ffff}') => {
                out.push('\u{fffd}')
            }
            c => out.push(c),
        }
    }
    out
}
