//! How far a rendered depth is from a measured one.

use super::error::OptimiseError;
use super::finite::{check, check_length, check_weight};

/// Depth as the blending of Gaussians gives it.
#[derive(Debug, Clone, Copy)]
pub struct RenderedDepth<'a> {
    /// Sum of depth times blend weight of every pixel, metres; not divided by `alpha`.
    pub sum_m: &'a [f32],
    /// Sum of the blend weights of every pixel, 0 to 1.
    pub alpha: &'a [f32],
}

/// Where gradients are added, laid out as [`RenderedDepth`].
#[derive(Debug)]
pub struct DepthGradient<'a> {
    /// By `sum_m`.
    pub sum: &'a mut [f32],
    /// By `alpha`.
    pub alpha: &'a mut [f32],
}

/// Mean over the pixels that hit something of |sum - alpha * target|, 0 if none does.
///
/// That is the error of the expected depth, sum / alpha, times the coverage: it needs no division, says nothing of
/// what is transparent, and leaves opacity to the colours. Below `knee_m` the absolute value is replaced by a
/// parabola with the same slope at the knee (Huber), so that sub-knee noise doesn't make the sign of the gradient
/// jump; a knee of 0 is plain L1. Outliers beyond it pull with a constant force.
///
/// `target_m` is planar depth, +inf where nothing is hit. Adds `weight` times its gradient to `gradient`.
///
/// # Errors
/// Lists of different lengths, a value that is not finite, and a target that is neither positive nor +inf.
pub fn depth_l1(
    rendered: RenderedDepth<'_>,
    target_m: &[f32],
    knee_m: f32,
    weight: f32,
    gradient: DepthGradient<'_>,
) -> Result<f64, OptimiseError> {
    let RenderedDepth { sum_m, alpha } = rendered;
    for (list, found) in [
        ("alpha", alpha.len()),
        ("target depth", target_m.len()),
        ("gradient of depth", gradient.sum.len()),
        ("gradient of alpha", gradient.alpha.len()),
    ] {
        check_length(list, found, sum_m.len())?;
    }
    check_weight("weight of depth", weight)?;
    if !knee_m.is_finite() || knee_m < 0.0 {
        return Err(OptimiseError::setting("knee of depth", knee_m.into(), "at least 0 m"));
    }
    check(sum_m, || "depth".to_owned())?;
    check(alpha, || "alpha".to_owned())?;
    let is_depth =
        |depth_m: f32| depth_m > 0.0 && (depth_m * depth_m).is_finite() || depth_m == f32::INFINITY;
    if let Some(index) = target_m.iter().position(|&depth_m| !is_depth(depth_m)) {
        return Err(OptimiseError(format!(
            "target depth: pixel {index} is {} m: must be positive, or infinite where nothing is hit",
            target_m[index]
        )));
    }

    let count = target_m.iter().filter(|depth_m| depth_m.is_finite()).count().max(1) as f64;
    let step = (f64::from(weight) / count) as f32;
    let mut total = 0.0;
    let pixels = sum_m.iter().zip(alpha).zip(target_m).zip(gradient.sum).zip(gradient.alpha);
    for ((((sum_m, alpha), target_m), by_sum), by_alpha) in pixels {
        if target_m.is_finite() {
            let (value, slope) = huber(sum_m - alpha * target_m, knee_m);
            total += f64::from(value);
            *by_sum += step * slope;
            *by_alpha -= step * slope * target_m;
        }
    }
    Ok(total / count)
}

/// The absolute value, rounded off below the knee, and its slope.
fn huber(residual: f32, knee: f32) -> (f32, f32) {
    let size = residual.abs();
    if size < knee {
        (0.5 * residual * residual / knee, residual / knee)
    } else {
        (size - 0.5 * knee, if size == 0.0 { 0.0 } else { residual.signum() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_knee_joins_parabola_and_line() {
        assert_eq!(huber(0.25, 0.5), (0.0625, 0.5));
        assert_eq!(huber(-0.5, 0.5), (0.25, -1.0));
        assert_eq!(huber(2.0, 0.5), (1.75, 1.0));
        assert_eq!(huber(-2.0, 0.0), (2.0, -1.0));
        assert_eq!(huber(0.0, 0.0), (0.0, 0.0));
    }
}
