//! The last cycles of a resource's memory (`--history`), so that a fault can show how the variables of its statement came
//! to their values.
//!
//! Which statement will fail is not known before, so the whole part is copied at the end of each cycle, into room that was
//! made at the start.

use crate::image::Statement;
use crate::path::{Leaf, Resolver};

/// A ring of copies.
#[derive(Debug)]
pub struct History {
    copies: Vec<(u64, Vec<u8>)>,
    next: usize,
}

impl History {
    /// Room for so many cycles of so many bytes.
    pub fn new(cycles: usize, bytes: usize) -> Self {
        Self { copies: vec![(0, vec![0; bytes]); cycles.max(1)], next: 0 }
    }

    /// A cycle has ended.
    pub fn record(&mut self, cycle: u64, part: &[u8]) {
        let (number, copy) = &mut self.copies[self.next];
        *number = cycle;
        copy.copy_from_slice(part);
        self.next = (self.next + 1) % self.copies.len();
    }

    /// A table of the variables of a statement, the oldest cycle first; `now` is the memory in the cycle of the fault. The
    /// bytes are a resource's part, `instance` is the offset of the instance in it.
    pub fn table(
        &self,
        resolver: &Resolver,
        statement: &Statement,
        instance: u32,
        (cycle, now): (u64, &[u8]),
    ) -> String {
        if statement.vars.is_empty() {
            return "  no variable of this statement outlives its call\n".into();
        }
        let leaf = |n: usize| {
            let var = &statement.vars[n];
            let base = if var.in_instance { instance } else { 0 };
            Leaf { offset: base + var.offset, bit: var.bit, ty: var.ty, constant: false }
        };
        let mut rows: Vec<Vec<String>> = Vec::new();
        let names = statement.vars.iter().map(|v| v.name.clone());
        rows.push(std::iter::once("cycle".to_string()).chain(names).collect());
        let (newer, older) = self.copies.split_at(self.next);
        let kept = older.iter().chain(newer).filter(|(number, _)| *number > 0);
        for (number, memory) in kept.map(|(n, m)| (*n, m.as_slice())).chain([(cycle, now)]) {
            let values = (0..statement.vars.len()).map(|n| resolver.text(&leaf(n), memory));
            rows.push(std::iter::once(number.to_string()).chain(values).collect());
        }
        let widths: Vec<usize> =
            (0..rows[0].len()).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
        let mut out = String::new();
        for row in &rows {
            out.push_str("  ");
            for (cell, width) in row.iter().zip(&widths) {
                out.push_str(&format!("{cell:>width$}  "));
            }
            out.truncate(out.trim_end().len());
            out.push('\n');
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, StatementVar, TypeDesc};
    use plcc_stdlib::elem::Elem;

    #[test]
    fn the_last_cycles_and_the_moment_of_the_fault() {
        let image = Image { types: vec![TypeDesc::Elem(Elem::Int.code())], ..Image::default() };
        let var =
            |name: &str, in_instance, offset| StatementVar { name: name.into(), in_instance, offset, bit: None, ty: 0 };
        let statement = Statement { vars: vec![var("a", true, 2), var("limit", false, 0)] };
        let mut history = History::new(2, 8);
        for cycle in 1..=3u8 {
            history.record(u64::from(cycle), &[9, 0, 0, 0, 0, 0, cycle, 0]);
        }
        let table = history.table(&Resolver::new(&image), &statement, 4, (4, &[9, 0, 0, 0, 0, 0, 10, 0]));
        assert_eq!(table, "  cycle   a  limit\n      2   2      9\n      3   3      9\n      4  10      9\n");
    }
}
