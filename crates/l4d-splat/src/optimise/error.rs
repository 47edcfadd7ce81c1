//! Why an optimiser or a loss refuses its input.

/// What cannot be computed with: list, index and value, or setting and range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OptimiseError(pub(super) String);

impl OptimiseError {
    /// A setting outside its range.
    pub(super) fn setting(setting: &str, value: f64, range: &str) -> Self {
        Self(format!("{setting} is {value}: must be {range}"))
    }
}
