//! Why an optimiser or a loss refuses its input.

/// What cannot be computed with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OptimiseError {
    /// A number that is not finite, or so large that its square is not.
    #[error("{list}: value {index} is {value}: training has diverged; go back to an earlier checkpoint")]
    Value {
        /// Which list, in words.
        list: String,
        /// Index in it.
        index: usize,
        /// What stands there.
        value: f32,
    },
    /// Lists that belong together have different lengths.
    #[error("{list} has {found} values, but {expected} belong here")]
    Length {
        /// Which list, in words.
        list: String,
        /// Its length.
        found: usize,
        /// The length that fits.
        expected: usize,
    },
    /// A depth that no camera measures.
    #[error("target depth: pixel {index} is {value} m: must be positive, or infinite where nothing is hit")]
    Depth {
        /// Index of the pixel.
        index: usize,
        /// What stands there.
        value: f32,
    },
    /// A setting outside its range.
    #[error("{setting} is {value}: must be {range}")]
    Setting {
        /// Which setting, in words.
        setting: &'static str,
        /// What stands there.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}
