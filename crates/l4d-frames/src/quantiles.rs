//! Quantiles of any number of non-negative values in constant memory.
//!
//! A value falls into the bin of its exponent and leading six mantissa bits, so a quantile is true to 1.6 %
//! of itself; the largest value is kept exactly. Merging adds counts, so the order of merging changes nothing.

const DROPPED_BITS: u32 = f32::MANTISSA_DIGITS - 1 - 6;
const BIN_COUNT: usize = (f32::INFINITY.to_bits() >> DROPPED_BITS) as usize + 1;

/// A histogram over logarithmic bins.
#[derive(Debug, Clone)]
pub(crate) struct Quantiles {
    bins: Vec<u64>,
    count: u64,
    largest: f32,
}

impl Default for Quantiles {
    fn default() -> Self {
        Self { bins: vec![0; BIN_COUNT], count: 0, largest: 0.0 }
    }
}

impl Quantiles {
    /// Counts a value; negative ones and NaN count as infinite, so that they cannot hide.
    pub(crate) fn add(&mut self, value: f32) {
        let value = if value >= 0.0 { value } else { f32::INFINITY };
        self.bins[(value.abs().to_bits() >> DROPPED_BITS) as usize] += 1;
        self.count += 1;
        self.largest = self.largest.max(value);
    }

    /// Adds the values of another histogram.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (bin, more) in self.bins.iter_mut().zip(&other.bins) {
            *bin += more;
        }
        self.count += other.count;
        self.largest = self.largest.max(other.largest);
    }

    /// Number of values.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// The largest value; 0 if there is none.
    pub(crate) fn largest(&self) -> f32 {
        self.largest
    }

    /// The upper edge of the bin that holds the value of rank `share * count`, never above the largest value.
    pub(crate) fn quantile(&self, share: f64) -> f32 {
        let rank = (share * self.count as f64).ceil().max(1.0) as u64;
        let mut below = 0;
        for (bin, count) in self.bins.iter().enumerate() {
            below += count;
            if below >= rank {
                let upper_edge = f32::from_bits((bin as u32 + 1) << DROPPED_BITS);
                return upper_edge.min(self.largest);
            }
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_within_two_percent() {
        let mut quantiles = Quantiles::default();
        for value in 1..=1000 {
            quantiles.add(value as f32 * 1e-3);
        }
        for (share, expected) in [(0.5, 0.5), (0.95, 0.95), (0.99, 0.99)] {
            let found = quantiles.quantile(share);
            assert!(found >= expected && found <= expected * 1.017, "{share}: {found}");
        }
        assert_eq!(quantiles.quantile(1.0), 1.0);
    }

    #[test]
    fn nothing_zero_and_not_a_number() {
        let mut quantiles = Quantiles::default();
        assert_eq!((quantiles.quantile(0.5), quantiles.largest()), (0.0, 0.0));
        quantiles.add(0.0);
        assert_eq!(quantiles.quantile(0.5), 0.0);
        quantiles.add(f32::NAN);
        quantiles.add(-1.0);
        assert_eq!(quantiles.quantile(0.5), f32::INFINITY);
    }

    #[test]
    fn merging_is_adding() {
        let (mut left, mut right, mut both) =
            (Quantiles::default(), Quantiles::default(), Quantiles::default());
        for value in [0.1, 3.0, 0.007] {
            left.add(value);
            both.add(value);
        }
        right.add(9.0);
        both.add(9.0);
        left.merge(&right);
        assert_eq!((left.bins, left.count, left.largest), (both.bins, both.count, both.largest));
    }
}
