//! Structural similarity of two pictures (Wang et al. 2004) and its gradient.
//!
//! Means, variances and covariance are taken under an 11x11 Gaussian window of sigma 1.5, as 3DGS takes them: outside
//! the picture there is black. The window is a product of two lines, so that it costs 22 products a value instead
//! of 121; and it is symmetric, so that blurring is its own derivative's transpose.

use rayon::prelude::*;

use super::error::OptimiseError;
use super::finite::{check, check_length, check_weight, length_error};

/// Width and height of the window, pixels.
pub const SSIM_WINDOW: usize = 11;

const SIGMA_PX: f64 = 1.5;
/// Keep the ratios finite where a window is black or flat; for values from 0 to 1.
const OF_MEANS: f32 = 0.01 * 0.01;
const OF_VARIANCES: f32 = 0.03 * 0.03;

/// One minus the mean structural similarity over all pixels and channels: 0 for equal pictures, 0 if there are no
/// pixels.
///
/// Values are from 0 to 1, row after row, the `channels` of a pixel together, `width` pixels per row. Adds `weight`
/// times the gradient by `prediction` to `gradient`.
///
/// # Errors
/// Lists of different lengths or that are no whole rows, and a value that is not finite.
pub fn dssim(
    prediction: &[f32],
    target: &[f32],
    width: usize,
    channels: usize,
    weight: f32,
    gradient: &mut [f32],
) -> Result<f64, OptimiseError> {
    let row = width.saturating_mul(channels);
    check_length("target", target.len(), prediction.len())?;
    check_length("gradient", gradient.len(), prediction.len())?;
    if prediction.is_empty() {
        return Ok(0.0);
    }
    if row == 0 || !prediction.len().is_multiple_of(row) {
        let expected = prediction.len().next_multiple_of(row.max(1));
        return Err(length_error("prediction", prediction.len(), expected));
    }
    check_weight("weight of D-SSIM", weight)?;
    check(prediction, || "prediction".to_owned())?;
    check(target, || "target".to_owned())?;

    let window = Window::new(row, channels);
    let blurred = |value: fn(f32, f32) -> f32| {
        window.blur(&prediction.iter().zip(target).map(|(&x, &y)| value(x, y)).collect::<Vec<_>>())
    };
    let means = [blurred(|x, _| x), blurred(|_, y| y)];
    let products = [blurred(|x, _| x * x), blurred(|_, y| y * y), blurred(|x, y| x * y)];

    // By the blurred picture, its blurred square, and the blurred product with the target.
    let mut slopes: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; prediction.len()]);
    let mut sum = 0.0;
    let step = -(f64::from(weight) / prediction.len() as f64) as f32;
    let [by_mean, by_square, by_product] = &mut slopes;
    for index in 0..prediction.len() {
        let means = means.each_ref().map(|list| list[index]);
        let products = products.each_ref().map(|list| list[index]);
        let (similarity, slopes) = similarity(means, products);
        sum += f64::from(similarity);
        [by_mean[index], by_square[index], by_product[index]] = slopes.map(|slope| step * slope);
    }
    let [by_mean, by_square, by_product] = slopes.map(|slope| window.blur(&slope));
    for index in 0..prediction.len() {
        gradient[index] +=
            by_mean[index] + 2.0 * prediction[index] * by_square[index] + target[index] * by_product[index];
    }
    Ok(1.0 - sum / prediction.len() as f64)
}

/// Similarity under one window, and its slopes by the prediction's mean, its mean square and the mean product.
fn similarity([mean, target]: [f32; 2], [square, target_square, product]: [f32; 3]) -> (f32, [f32; 3]) {
    let covariance = product - mean * target;
    let variances = square - mean * mean + target_square - target * target;
    let (above, above_2) = (2.0 * mean * target + OF_MEANS, 2.0 * covariance + OF_VARIANCES);
    let (below, below_2) = (mean * mean + target * target + OF_MEANS, variances + OF_VARIANCES);
    let similarity = above * above_2 / (below * below_2);
    let by_above = above_2 / (below * below_2);
    let by_above_2 = above / (below * below_2);
    let by_below = -similarity / below;
    let by_below_2 = -similarity / below_2;
    let by_mean = 2.0 * (target * (by_above - by_above_2) + mean * (by_below - by_below_2));
    (similarity, [by_mean, by_below_2, 2.0 * by_above_2])
}

/// The Gaussian window over pictures with so many values per row.
struct Window {
    weights: [f32; SSIM_WINDOW],
    row: usize,
    channels: usize,
}

impl Window {
    fn new(row: usize, channels: usize) -> Self {
        let centre = (SSIM_WINDOW / 2) as f64;
        let bell = |index: usize| (-(index as f64 - centre).powi(2) / (2.0 * SIGMA_PX * SIGMA_PX)).exp();
        let sum: f64 = (0..SSIM_WINDOW).map(bell).sum();
        Self { weights: std::array::from_fn(|index| (bell(index) / sum) as f32), row, channels }
    }

    fn blur(&self, picture: &[f32]) -> Vec<f32> {
        let reach = SSIM_WINDOW / 2;
        let mut across = vec![0.0; picture.len()];
        across.par_chunks_mut(self.row).zip(picture.par_chunks(self.row)).for_each(|(blurred, row)| {
            for (index, &weight) in self.weights.iter().enumerate() {
                let shift = index.abs_diff(reach) * self.channels;
                let Some(overlap) = row.len().checked_sub(shift) else { continue };
                if index < reach {
                    add(&mut blurred[shift..], &row[..overlap], weight);
                } else {
                    add(&mut blurred[..overlap], &row[shift..], weight);
                }
            }
        });
        let mut both = vec![0.0; picture.len()];
        let rows = picture.len() / self.row;
        both.par_chunks_mut(self.row).enumerate().for_each(|(at, blurred)| {
            for (index, &weight) in self.weights.iter().enumerate() {
                let from = at + index;
                if (reach..rows + reach).contains(&from) {
                    add(blurred, &across[(from - reach) * self.row..][..self.row], weight);
                }
            }
        });
        both
    }
}

fn add(into: &mut [f32], values: &[f32], weight: f32) {
    for (into, value) in into.iter_mut().zip(values) {
        *into += weight * value;
    }
}
