//! Structural similarity of two pictures (Wang et al. 2004), as scikit-image computes it with their settings: a
//! Gaussian window of 11 x 11 pixels, where it lies within the picture.

/// Half of the window, and the width of its Gaussian, pixels.
const HALF: usize = 5;
const SIGMA: f64 = 1.5;
/// What keeps the ratios finite where a picture has one colour; colours are from 0 to 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Mean over channels and windows, from -1 to 1; none where no window fits into a picture so wide.
pub(super) fn ssim(a: &[[f32; 3]], b: &[[f32; 3]], width: usize) -> Option<f64> {
    let height = a.len().checked_div(width)?;
    if width <= 2 * HALF || height <= 2 * HALF {
        return None;
    }
    let channel = |channel: usize| {
        let of = |picture: &[[f32; 3]]| -> Vec<f64> {
            picture.iter().map(|colour| f64::from(colour[channel])).collect()
        };
        let (a, b) = (of(a), of(b));
        let times =
            |a: &[f64], b: &[f64]| blur(&std::iter::zip(a, b).map(|(a, b)| a * b).collect::<Vec<_>>(), width);
        let (squares, products) = ([times(&a, &a), times(&b, &b)], times(&a, &b));
        let means = [blur(&a, width), blur(&b, width)];
        let at = |place: usize| {
            let [a, b] = [means[0][place], means[1][place]];
            let [var_a, var_b] = [squares[0][place] - a * a, squares[1][place] - b * b];
            let covariance = products[place] - a * b;
            (2.0 * a * b + C1) * (2.0 * covariance + C2) / ((a * a + b * b + C1) * (var_a + var_b + C2))
        };
        (0..products.len()).map(at).sum::<f64>() / products.len() as f64
    };
    Some((0..3).map(channel).sum::<f64>() / 3.0)
}

/// Weighted means of all windows that lie within the picture.
fn blur(values: &[f64], width: usize) -> Vec<f64> {
    let weights: Vec<f64> =
        (0..=2 * HALF).map(|k| (-0.5 * ((k as f64 - HALF as f64) / SIGMA).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let within = width - 2 * HALF;
    let mut along = vec![0.0; values.len() / width * within];
    for (sums, row) in along.chunks_exact_mut(within).zip(values.chunks_exact(width)) {
        for (k, weight) in weights.iter().enumerate() {
            add(sums, &row[k..], weight / total);
        }
    }
    let mut means = vec![0.0; along.len() - 2 * HALF * within];
    for (k, weight) in weights.iter().enumerate() {
        add(&mut means, &along[k * within..], weight / total);
    }
    means
}

/// Adds values, each times the weight.
fn add(sums: &mut [f64], values: &[f64], weight: f64) {
    for (sum, value) in std::iter::zip(sums, values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waves(size: [usize; 2]) -> [Vec<[f32; 3]>; 2] {
        let each = |colour: &dyn Fn(f64, f64, f64) -> f64| -> Vec<[f32; 3]> {
            let pixel = |k: usize| ((k % size[0]) as f64, (k / size[0]) as f64);
            (0..size[0] * size[1])
                .map(|k| [0.0, 1.0, 2.0].map(|channel| colour(pixel(k).0, pixel(k).1, channel) as f32))
                .collect()
        };
        let first = |x: f64, y: f64, c: f64| 0.5 + 0.4 * (0.7 * x + 0.3 * y + c).sin();
        let second = |x: f64, y: f64, c: f64| {
            (first(x, y, c) + 0.2 * (1.1 * x - 0.5 * y + 2.0 * c).cos()).clamp(0.0, 1.0)
        };
        [each(&first), each(&second)]
    }

    /// `skimage.metrics.structural_similarity(a, b, channel_axis=2, gaussian_weights=True, sigma=1.5,
    /// use_sample_covariance=False, data_range=1)` of scikit-image 0.25, of the same two pictures.
    #[test]
    fn two_pictures_are_as_alike_as_scikit_image_says() {
        let [a, b] = waves([16, 13]);
        assert!((ssim(&a, &b, 16).unwrap() - 0.869_212_397_7).abs() < 1e-6);
        assert!((ssim(&a, &a, 16).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn no_window_fits_into_a_small_picture() {
        let [a, b] = waves([10, 40]);
        assert_eq!(ssim(&a, &b, 10), None);
        assert_eq!(ssim(&[], &[], 0), None);
    }
}
