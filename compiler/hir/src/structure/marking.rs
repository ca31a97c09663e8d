//! Sets of small numbers (steps, transitions), and the table that gives each marking a number.

use rustc_hash::FxHashMap;

/// A growing set of small numbers.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(super) struct Bits(Vec<u64>);

impl Bits {
    pub fn has(&self, item: usize) -> bool {
        self.0.get(item / 64).is_some_and(|word| word >> (item % 64) & 1 == 1)
    }

    pub fn add(&mut self, item: usize) {
        if self.0.len() <= item / 64 {
            self.0.resize(item / 64 + 1, 0);
        }
        self.0[item / 64] |= 1 << (item % 64);
    }

    pub fn remove(&mut self, item: usize) {
        if let Some(word) = self.0.get_mut(item / 64) {
            *word &= !(1 << (item % 64));
        }
    }

    pub fn add_all(&mut self, other: &Bits) {
        if self.0.len() < other.0.len() {
            self.0.resize(other.0.len(), 0);
        }
        for (word, more) in self.0.iter_mut().zip(&other.0) {
            *word |= more;
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        items(&self.0)
    }

    /// Whether this is the other set and more.
    pub fn strictly_covers(&self, other: &Bits) -> bool {
        let word = |set: &Bits, index: usize| set.0.get(index).copied().unwrap_or(0);
        let words = self.0.len().max(other.0.len());
        let covers = (0..words).all(|i| word(other, i) & !word(self, i) == 0);
        covers && (0..words).any(|i| word(self, i) != word(other, i))
    }
}

impl FromIterator<usize> for Bits {
    fn from_iter<I: IntoIterator<Item = usize>>(items: I) -> Self {
        let mut bits = Bits::default();
        items.into_iter().for_each(|item| bits.add(item));
        bits
    }
}

fn items(words: &[u64]) -> impl Iterator<Item = usize> + '_ {
    words.iter().enumerate().flat_map(|(index, &word)| {
        std::iter::successors((word != 0).then_some(word), |w| {
            let rest = w & (w - 1);
            (rest != 0).then_some(rest)
        })
        .map(move |w| index * 64 + w.trailing_zeros() as usize)
    })
}

/// A marking inside the table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Marking<'a>(&'a [u64]);

impl<'a> Marking<'a> {
    pub fn has(self, step: usize) -> bool {
        self.0[step / 64] >> (step % 64) & 1 == 1
    }

    pub fn has_all(self, steps: &[u32]) -> bool {
        steps.iter().all(|&s| self.has(s as usize))
    }

    pub fn iter(self) -> impl Iterator<Item = usize> + 'a {
        items(self.0)
    }
}

/// All markings seen, numbered in the order in which they were met.
#[derive(Debug, Default)]
pub(super) struct Markings {
    words_each: usize,
    words: Vec<u64>,
    numbers: FxHashMap<Box<[u64]>, u32>,
}

impl Markings {
    /// For steps below `steps`.
    pub fn new(steps: usize) -> Self {
        Self { words_each: steps.div_ceil(64).max(1), ..Self::default() }
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    pub fn get(&self, number: usize) -> Marking<'_> {
        Marking(&self.words[number * self.words_each..][..self.words_each])
    }

    /// A set as long as the table wants it.
    pub fn fit(&self, set: &Bits) -> Vec<u64> {
        let mut words = set.0.clone();
        words.resize(self.words_each, 0);
        words
    }

    /// The number of a marking, a new one if it was not met before.
    pub fn number(&mut self, marking: &[u64]) -> usize {
        if let Some(&number) = self.numbers.get(marking) {
            return number as usize;
        }
        let number = self.numbers.len();
        self.words.extend_from_slice(marking);
        self.numbers.insert(marking.into(), number as u32);
        number
    }
}
