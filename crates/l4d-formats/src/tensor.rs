//! Numbers with a shape: how files, networks and optimisers hand parameters to each other.

use crate::fault::Fault;

/// What to do about parameters that are not finite.
pub const HINT_NOT_FINITE: &str = "take an earlier checkpoint: training diverged before this one was written";

/// A dense block of numbers, the last axis fastest.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tensor<T = f32> {
    /// Length along each axis; none for a single number.
    pub shape: Vec<usize>,
    /// The numbers, as many as the product of `shape`.
    pub data: Vec<T>,
}

impl Tensor {
    /// Where the first number that is not finite is, and what it is.
    pub fn bad_value(&self) -> Option<(usize, f32)> {
        self.data.iter().copied().enumerate().find(|(_, value)| !value.is_finite())
    }

    /// Refuses numbers that are not finite, naming the first.
    ///
    /// # Errors
    /// The first of them.
    pub fn check_finite(&self, name: &str) -> Result<(), Fault> {
        self.bad_value().map_or(Ok(()), |(index, value)| {
            let message = format!("is {value}, but parameters are finite");
            Err(Fault::new(format!("{name}, number {index}"), message, HINT_NOT_FINITE))
        })
    }
}

/// Numbers in a tensor of this shape; none if no machine could hold them.
pub fn element_count(shape: &[usize]) -> Option<usize> {
    // A zero anywhere makes the tensor empty, however large the other axes are.
    if shape.contains(&0) {
        return Some(0);
    }
    shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_holds_the_product_of_its_axes() {
        assert_eq!(element_count(&[]), Some(1));
        assert_eq!(element_count(&[2, 3, 4]), Some(24));
        assert_eq!(element_count(&[usize::MAX, 2, 0]), Some(0));
        assert_eq!(element_count(&[usize::MAX, 2]), None);
    }
}
