//! Order statistics and means.

/// Sorted values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sorted(Vec<f64>);

impl Sorted {
    /// Sorts them.
    pub fn new(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// The value below which a share (0 to 1) of the others lies, by nearest rank; 0 without any value.
    pub fn at(&self, share: f64) -> f64 {
        let rank = (self.0.len() as f64 * share).ceil() as usize;
        self.0.get(rank.clamp(1, self.0.len().max(1)) - 1).copied().unwrap_or(0.0)
    }

    /// The greatest.
    pub fn worst(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }
}

/// The geometric mean; `None` without values, or if one is not positive.
pub fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0);
    for value in values {
        if value <= 0.0 || !value.is_finite() {
            return None;
        }
        sum += value.ln();
        count += 1;
    }
    (count > 0).then(|| (sum / f64::from(count)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_values_that_occurred() {
        let s = Sorted::new((1..=1000).rev().map(f64::from).collect());
        assert_eq!([s.at(0.0), s.at(0.5), s.at(0.99), s.at(0.999), s.at(1.0)], [1.0, 500.0, 990.0, 999.0, 1000.0]);
        assert_eq!(s.worst(), 1000.0);
        assert_eq!(Sorted::default().at(0.5), 0.0);
        assert_eq!(Sorted::new(vec![7.0]).at(0.999), 7.0);
    }

    #[test]
    fn the_geometric_mean_of_a_ratio_and_its_inverse_is_one() {
        assert!((geometric_mean([4.0, 0.25]).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(geometric_mean([]), None);
        assert_eq!(geometric_mean([1.0, 0.0]), None);
    }
}
