//! Flags that lie side by side: several are looked at at once, and one by one only if any of them is TRUE.
//!
//! Of the steps of a chart few are active, of its transitions few fire. What is done for each of them by itself would test
//! every flag in every call; here eight, then four of them are skipped with one test.

use super::emit::*;
use crate::body::{Expr, Place, Step, Stmt};
use crate::shape::FLAGS_AT_ONCE;
use crate::types::Types;
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;

/// Statements, and the flag that must be TRUE for them, if any.
pub(super) struct Item {
    pub flag: Option<(usize, Span)>,
    pub stmts: Vec<Stmt>,
    /// The same without a condition: statements that change nothing while the flag is FALSE.
    pub quiet: Vec<Stmt>,
}

/// BOOLs in their order in memory, a byte each.
#[derive(Default)]
pub(super) struct Flags {
    flags: Vec<Place>,
    /// How many bytes from the first one on may be read; those behind the flags are 0.
    bytes: usize,
}

/// Words of flags, and how many each holds.
const WORDS: [(Elem, usize); 2] = [(Elem::Lword, FLAGS_AT_ONCE as usize), (Elem::Dword, 4)];
/// With fewer statements the test of a word saves nothing.
const WORTH: usize = 3;

impl Flags {
    pub fn new(flags: Vec<Place>, bytes: usize) -> Self {
        Self { flags, bytes }
    }

    /// How many bytes flags of their own take, so that each lies in a word.
    pub fn room(count: usize) -> usize {
        count.next_multiple_of(WORDS[1].1)
    }

    pub fn place(&self, number: usize) -> &Place {
        &self.flags[number]
    }

    /// Writes the statements; neighbours whose flags lie in one word stand in an IF over that word. No statement changes a
    /// flag of others.
    pub fn skip(&self, items: Vec<Item>, out: &mut Vec<Stmt>) {
        self.words(items, &WORDS, None, out);
    }

    /// `known`: the word in which all of them lie.
    fn words(&self, items: Vec<Item>, words: &[(Elem, usize)], known: Option<(Elem, usize)>, out: &mut Vec<Stmt>) {
        let Some((&(word, count), smaller)) = words.split_first() else {
            return items.into_iter().for_each(|item| self.item(item, known, out));
        };
        let mut rest = items.into_iter().peekable();
        while let Some(first) = rest.next() {
            let number = |item: &Item| item.flag.map(|(flag, _)| flag / count);
            let (of_run, span) = (number(&first), first.flag.map(|f| f.1));
            let mut run = vec![first];
            while let Some(item) = rest.next_if(|item| number(item) == of_run) {
                run.push(item);
            }
            match (of_run, span) {
                (Some(n), Some(span)) if (n + 1) * count <= self.bytes && run.len() >= WORTH => {
                    let mut inner = Vec::new();
                    self.words(run, smaller, Some((word, n * count)), &mut inner);
                    out.push(when(not_zero(word, self.word(word, n * count, span)), inner, span));
                }
                _ => self.words(run, smaller, known, out),
            }
        }
    }

    /// One item under its own flag, which is a byte of the known word.
    fn item(&self, mut item: Item, known: Option<(Elem, usize)>, out: &mut Vec<Stmt>) {
        let Some((flag, span)) = item.flag else { return out.append(&mut item.stmts) };
        if known.is_some_and(|(word, _)| word == Elem::Dword) && !item.quiet.is_empty() {
            return out.append(&mut item.quiet);
        }
        let condition = match known {
            Some((word, first)) if word == Elem::Dword => {
                let mask = constant(0xFF << (8 * (flag - first)), word, span);
                not_zero(word, operation(Op::And, word, vec![self.word(word, first, span), mask], span))
            }
            _ => read(self.flags[flag].clone()),
        };
        out.push(when(condition, item.stmts, span));
    }

    /// The flags from one on.
    fn word(&self, word: Elem, first: usize, span: Span) -> Expr {
        let mut place = self.flags[first].clone();
        place.steps.push(Step::Flags(word));
        place.ty = Types::elem(word);
        place.span = span;
        read(place)
    }
}

fn not_zero(word: Elem, value: Expr) -> Expr {
    let span = value.span;
    not(equal(word, value, constant(0, word, span)))
}
