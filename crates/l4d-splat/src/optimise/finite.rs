//! The search for numbers that would spoil a sum.

use rayon::prelude::*;

use super::error::OptimiseError;

const CHUNK: usize = 1 << 14;

/// Every number of `list` is finite and so is its square.
///
/// Loops that may stop early are not turned into vector code, so whole chunks are tested first and the culprit is
/// looked for only in a chunk that has one.
pub(super) fn check(list: &[f32], name: impl FnOnce() -> String) -> Result<(), OptimiseError> {
    let is_bad = |value: f32| !(value * value).is_finite();
    let has_bad = |chunk: &[f32]| chunk.iter().fold(false, |any, &value| any | is_bad(value));
    let Some(chunk) = list.par_chunks(CHUNK).position_first(has_bad) else { return Ok(()) };
    let inside = list[chunk * CHUNK..].iter().position(|&value| is_bad(value)).unwrap_or_default();
    let index = chunk * CHUNK + inside;
    Err(OptimiseError(format!(
        "{}: value {index} is {}: training has diverged; go back to an earlier checkpoint",
        name(),
        list[index]
    )))
}

/// `list` has the length of what it belongs to.
pub(super) fn check_length(list: &str, found: usize, expected: usize) -> Result<(), OptimiseError> {
    if found == expected {
        return Ok(());
    }
    Err(length_error(list, found, expected))
}

pub(super) fn length_error(list: &str, found: usize, expected: usize) -> OptimiseError {
    OptimiseError(format!("{list} has {found} values, but {expected} belong here"))
}

/// A weight or a knee is a number that can be multiplied with.
pub(super) fn check_weight(setting: &'static str, value: f32) -> Result<(), OptimiseError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(OptimiseError::setting(setting, value.into(), "finite"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_culprit_is_named_wherever_it_stands() {
        let mut list = vec![1.0; 3 * CHUNK + 7];
        assert_eq!(check(&list, String::new), Ok(()));
        assert_eq!(check(&[], String::new), Ok(()));
        for (index, value) in [(3 * CHUNK + 6, f32::NAN), (CHUNK + 1, f32::NEG_INFINITY), (0, 1.0e20)] {
            list[index] = value;
            let message = check(&list, || "planes".to_owned()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("planes: value {index} is {value}")), "{message}");
        }
    }
}
