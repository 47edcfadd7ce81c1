//! The mean absolute difference of two pictures.

use super::error::OptimiseError;
use super::finite::{check, check_length, check_weight};

/// Mean of |prediction - target| over all values (any channels, any order), 0 if there are none.
///
/// Adds `weight` times its gradient to `gradient`; where both are equal it is 0.
///
/// # Errors
/// Lists of different lengths, and a value that is not finite.
pub fn l1(
    prediction: &[f32],
    target: &[f32],
    weight: f32,
    gradient: &mut [f32],
) -> Result<f64, OptimiseError> {
    check_length("target", target.len(), prediction.len())?;
    check_length("gradient", gradient.len(), prediction.len())?;
    check_weight("weight of L1", weight)?;
    check(prediction, || "prediction".to_owned())?;
    check(target, || "target".to_owned())?;
    let count = prediction.len().max(1) as f64;
    let step = (f64::from(weight) / count) as f32;
    let mut sum = 0.0;
    for ((prediction, target), gradient) in prediction.iter().zip(target).zip(gradient) {
        let difference = prediction - target;
        sum += f64::from(difference.abs());
        // `signum` of zero is one.
        *gradient += if difference == 0.0 { 0.0 } else { step * difference.signum() };
    }
    Ok(sum / count)
}
