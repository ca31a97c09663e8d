//! What a drawing consists of. Lengths are in pixels, y grows downwards.

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub struct Rect {
    pub left: i32,
    pub top: i32,
    pub right: i32,
    pub bottom: i32,
}

impl Rect {
    /// Moved.
    pub fn moved(self, x: i32, y: i32) -> Self {
        Self { left: self.left + x, top: self.top + y, right: self.right + x, bottom: self.bottom + y }
    }

    /// Larger by a margin on the left and right.
    pub fn wider(self, by: i32) -> Self {
        Self { left: self.left - by, right: self.right + by, ..self }
    }

    /// Whether both have a point in common that is not on the edge.
    pub fn overlaps(self, other: Rect) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }
}

/// A part of the drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Shape {
    /// A step.
    Step {
        /// Its box.
        rect: Rect,
        /// In the box.
        name: String,
        /// Double border.
        initial: bool,
        /// Filled, with a dot.
        active: bool,
    },
    /// An action block beside a step: cells side by side.
    Action {
        /// All cells.
        rect: Rect,
        /// Right end of each cell, and its text.
        cells: Vec<(i32, String)>,
        /// The step is active.
        active: bool,
    },
    /// The bar of a transition and its texts to the right.
    Transition {
        /// Bar and texts.
        rect: Rect,
        /// Middle of the bar.
        x: i32,
        /// The bar.
        y: i32,
        /// Name and priority, maybe empty.
        head: String,
        /// The condition.
        lines: Vec<String>,
    },
    /// An arrow down to a name: a jump.
    Jump {
        /// Arrow and name.
        rect: Rect,
        /// The arrow.
        x: i32,
        /// Where it goes.
        to: String,
    },
    /// An arrow down from a name: where a jump to a transition arrives.
    Arrival {
        /// Arrow and name.
        rect: Rect,
        /// The arrow.
        x: i32,
        /// Where it comes from.
        from: String,
    },
    /// A line, horizontal or vertical.
    Line {
        /// From left or top to right or bottom.
        rect: Rect,
        /// Double: simultaneous branches begin or end.
        double: bool,
    },
    /// A line between pins, with its corners.
    Wire {
        /// From the beginning to the end; at least two.
        points: Vec<(i32, i32)>,
    },
    /// Where lines meet.
    Dot {
        /// Its middle.
        x: i32,
        /// Its middle.
        y: i32,
    },
    /// An element of a network that is no block.
    Symbol {
        /// Around it, without the text above.
        rect: Rect,
        /// Which.
        symbol: Symbol,
        /// Its variable or name.
        text: String,
        /// `/` negated, `S` set, `R` reset, `P` and `N` edges.
        mark: String,
    },
    /// A block of a network.
    Block {
        /// The box.
        rect: Rect,
        /// The function or type.
        ty: String,
        /// Its instance, maybe empty.
        instance: String,
        /// Height, name and mark of the inputs.
        ins: Vec<(i32, String, String)>,
        /// Of the outputs.
        outs: Vec<(i32, String, String)>,
        /// The execution order, maybe empty.
        order: String,
    },
    /// A comment.
    Remark {
        /// Its box.
        rect: Rect,
        /// Its text.
        lines: Vec<String>,
    },
    /// A heading.
    Title {
        /// Around the text.
        rect: Rect,
        /// The text.
        text: String,
    },
}

/// Elements of networks that are no blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symbol {
    /// A power rail.
    Rail,
    /// A contact, its variable above.
    Contact,
    /// A coil, its variable above.
    Coil,
    /// A variable that is read, in a box; its value leaves on the right.
    Read,
    /// A variable that is written, in a box.
    Written,
    /// Where a line goes on elsewhere: connectors, jumps, returns.
    Link,
    /// A jump target.
    Label,
}

impl Shape {
    /// The space that it takes.
    pub fn rect(&self) -> Rect {
        match self {
            Shape::Step { rect, .. }
            | Shape::Action { rect, .. }
            | Shape::Transition { rect, .. }
            | Shape::Jump { rect, .. }
            | Shape::Arrival { rect, .. }
            | Shape::Line { rect, .. }
            | Shape::Title { rect, .. }
            | Shape::Block { rect, .. }
            | Shape::Remark { rect, .. } => *rect,
            Shape::Symbol { rect, symbol, text, .. } => match symbol {
                // The text above may be wider.
                Symbol::Contact | Symbol::Coil => {
                    let more = (super::layout::width(text) - (rect.right - rect.left)).max(0) / 2 + 1;
                    Rect { top: rect.top - 18, ..rect.wider(more) }
                }
                _ => *rect,
            },
            Shape::Dot { x, y } => Rect { left: x - 3, top: y - 3, right: x + 3, bottom: y + 3 },
            Shape::Wire { points } => {
                let xs = || points.iter().map(|p| p.0);
                let ys = || points.iter().map(|p| p.1);
                Rect {
                    left: xs().min().unwrap_or(0),
                    top: ys().min().unwrap_or(0),
                    right: xs().max().unwrap_or(0),
                    bottom: ys().max().unwrap_or(0),
                }
            }
        }
    }

    /// Moves it.
    pub fn shift(&mut self, dx: i32, dy: i32) {
        match self {
            Shape::Step { rect, .. }
            | Shape::Line { rect, .. }
            | Shape::Title { rect, .. }
            | Shape::Symbol { rect, .. }
            | Shape::Remark { rect, .. } => *rect = rect.moved(dx, dy),
            Shape::Block { rect, ins, outs, .. } => {
                *rect = rect.moved(dx, dy);
                ins.iter_mut().chain(outs).for_each(|(y, _, _)| *y += dy);
            }
            Shape::Wire { points } => {
                for point in points {
                    *point = (point.0 + dx, point.1 + dy);
                }
            }
            Shape::Dot { x, y } => {
                *x += dx;
                *y += dy;
            }
            Shape::Action { rect, cells, .. } => {
                *rect = rect.moved(dx, dy);
                cells.iter_mut().for_each(|(right, _)| *right += dx);
            }
            Shape::Transition { rect, x, y, .. } => {
                *rect = rect.moved(dx, dy);
                *x += dx;
                *y += dy;
            }
            Shape::Jump { rect, x, .. } | Shape::Arrival { rect, x, .. } => {
                *rect = rect.moved(dx, dy);
                *x += dx;
            }
        }
    }
}

/// A drawing with its left top at 0, 0.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Picture {
    /// Its width.
    pub width: i32,
    /// Its height.
    pub height: i32,
    /// Its parts, from behind to front.
    pub shapes: Vec<Shape>,
}
