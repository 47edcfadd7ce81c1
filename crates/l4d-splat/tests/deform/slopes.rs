//! Gradients of losses and penalties against central differences of the same sums, written in f64 as on paper.

use l4d_splat::deform::{DeformConfig, FieldGradients};
use l4d_splat::optimise::{
    DepthGradient, PlaneWeights, RenderedDepth, SSIM_WINDOW, depth_l1, dssim, l1, plane_penalty,
};

use crate::fixtures::{relative_difference, small_config, small_field, wide};
use crate::reference::{Doubles, doubles};

/// Numbers from 0 to 1 that repeat nowhere near.
fn numbers(count: usize, seed: f32) -> Vec<f32> {
    (0..count).map(|place| 0.5 + 0.5 * (place as f32 * 1.7 + seed).sin()).collect()
}

/// Central differences of `value` by every number of `list`.
fn differences(list: &[f64], value: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let step = 1.0e-5;
    let slope = |place: usize| {
        let side = |step: f64| {
            let mut moved = list.to_vec();
            moved[place] += step;
            value(&moved)
        };
        (side(step) - side(-step)) / (2.0 * step)
    };
    (0..list.len()).map(slope).collect()
}

#[test]
fn l1_slopes_are_central_differences() {
    let (prediction, target) = (numbers(60, 0.0), numbers(60, 9.0));
    let mut gradient = vec![0.0; 60];
    l1(&prediction, &target, 0.8, &mut gradient).unwrap();
    let target = wide(&target);
    let expected = differences(&wide(&prediction), |prediction| {
        let differences = prediction.iter().zip(&target).map(|(a, b)| (a - b).abs());
        0.8 * differences.sum::<f64>() / 60.0
    });
    let difference = relative_difference(&gradient, &expected);
    assert!(difference < 1.0e-3, "{difference:e}");
}

/// One minus the mean similarity, window by window.
fn dissimilarity(prediction: &[f64], target: &[f64], width: usize, channels: usize) -> f64 {
    let height = prediction.len() / (width * channels);
    let reach = (SSIM_WINDOW / 2) as isize;
    let bell = |offset: isize| (-(offset * offset) as f64 / (2.0 * 1.5 * 1.5)).exp();
    let total: f64 = (-reach..=reach).map(bell).sum();
    let mut sum = 0.0;
    for (row, column, channel) in (0..height)
        .flat_map(|row| (0..width).flat_map(move |column| (0..channels).map(move |c| (row, column, c))))
    {
        // Means of x, y, x^2, y^2, x y; outside there is black.
        let mut means = [0.0; 5];
        for (down, right) in
            (-reach..=reach).flat_map(|down| (-reach..=reach).map(move |right| (down, right)))
        {
            let (at_row, at_column) = (row as isize + down, column as isize + right);
            if (0..height as isize).contains(&at_row) && (0..width as isize).contains(&at_column) {
                let place = (at_row as usize * width + at_column as usize) * channels + channel;
                let (x, y) = (prediction[place], target[place]);
                let weight = bell(down) * bell(right) / (total * total);
                for (mean, value) in means.iter_mut().zip([x, y, x * x, y * y, x * y]) {
                    *mean += weight * value;
                }
            }
        }
        let [x, y, xx, yy, xy] = means;
        let (c1, c2) = (0.01_f64.powi(2), 0.03_f64.powi(2));
        let luminance = (2.0 * x * y + c1) / (x * x + y * y + c1);
        let structure = (2.0 * (xy - x * y) + c2) / ((xx - x * x) + (yy - y * y) + c2);
        sum += luminance * structure;
    }
    1.0 - sum / prediction.len() as f64
}

#[test]
fn dissimilarity_slopes_are_central_differences() {
    // Wider and narrower than the window.
    for (width, height, channels) in [(13, 12, 1), (4, 5, 3), (1, 7, 2)] {
        let count = width * height * channels;
        let (prediction, target) = (numbers(count, 0.0), numbers(count, 2.0));
        let mut gradient = vec![0.0; count];
        let value = dssim(&prediction, &target, width, channels, 1.0, &mut gradient).unwrap();
        let (prediction, target) = (wide(&prediction), wide(&target));
        let loss = |prediction: &[f64]| dissimilarity(prediction, &target, width, channels);
        assert!((value - loss(&prediction)).abs() < 1.0e-5);
        let difference = relative_difference(&gradient, &differences(&prediction, loss));
        assert!(difference < 1.0e-3, "{width} wide: {difference:e}");
    }
}

#[test]
fn depth_slopes_are_central_differences() {
    let (sum_m, alpha) = (numbers(40, 0.0), numbers(40, 5.0));
    let mut target_m: Vec<f32> = numbers(40, 3.0).iter().map(|number| 0.5 + 2.0 * number).collect();
    target_m[7] = f32::INFINITY;
    for knee_m in [0.0, 0.4] {
        let (mut by_sum, mut by_alpha) = (vec![0.0; 40], vec![0.0; 40]);
        let rendered = RenderedDepth { sum_m: &sum_m, alpha: &alpha };
        let gradient = DepthGradient { sum: &mut by_sum, alpha: &mut by_alpha };
        let value = depth_l1(rendered, &target_m, knee_m, 0.5, gradient).unwrap();
        let loss = |sum_m: &[f64], alpha: &[f64]| {
            let pixel = |((sum_m, alpha), &target_m): ((&f64, &f64), &f32)| {
                if target_m.is_infinite() {
                    return 0.0;
                }
                let (size, knee_m) = ((sum_m - alpha * f64::from(target_m)).abs(), f64::from(knee_m));
                if size < knee_m { size * size / (2.0 * knee_m) } else { size - knee_m / 2.0 }
            };
            0.5 * sum_m.iter().zip(alpha).zip(&target_m).map(pixel).sum::<f64>() / 39.0
        };
        let (sums, alphas) = (wide(&sum_m), wide(&alpha));
        assert!((0.5 * value - loss(&sums, &alphas)).abs() < 1.0e-6);
        let expected = differences(&sums, |sums| loss(sums, &alphas));
        assert!(relative_difference(&by_sum, &expected) < 1.0e-3);
        let expected = differences(&alphas, |alphas| loss(&sums, alphas));
        assert!(relative_difference(&by_alpha, &expected) < 1.0e-3);
        assert_eq!([by_sum[7], by_alpha[7]], [0.0; 2]);
    }
}

/// The weighted penalty on planes as a checkpoint has them: `[1, channels, slower axis, faster axis]`.
fn penalty(config: &DeformConfig, tensors: &Doubles, weights: &PlaneWeights) -> f64 {
    let mut sum = 0.0;
    for level in 0..config.multires.len() {
        for pair in 0..6 {
            let (shape, plane) = &tensors[&format!("deformation_net.grid.grids.{level}.{pair}")];
            let (rows, columns) = (shape[2], shape[3]);
            let has_time = [2, 4, 5].contains(&pair);
            let bend = |channel: usize, row: usize, column: usize| {
                let at = |row: usize| plane[(channel * rows + row) * columns + column];
                (at(row) - 2.0 * at(row + 1) + at(row + 2)).powi(2)
            };
            let places = (0..shape[1])
                .flat_map(|c| (0..rows - 2).flat_map(move |row| (0..columns).map(move |at| (c, row, at))));
            let bends: Vec<f64> = places.map(|(c, row, column)| bend(c, row, column)).collect();
            let weight = if has_time { weights.time } else { weights.space };
            sum += f64::from(weight) * bends.iter().sum::<f64>() / bends.len() as f64;
            if has_time {
                let distance: f64 = plane.iter().map(|texel| (1.0 - texel).abs()).sum();
                sum += f64::from(weights.stillness) * distance / plane.len() as f64;
            }
        }
    }
    sum
}

#[test]
fn slopes_of_plane_penalties_are_central_differences() {
    let config = DeformConfig { channels: 2, multires: vec![1, 2], ..small_config() };
    let mut field = small_field(config.clone(), 3);
    for plane in field.parameters_mut().planes {
        for (texel, number) in plane.iter_mut().zip(numbers(1000, 1.0).into_iter().cycle()) {
            *texel = 0.4 + number;
        }
    }
    let weights = PlaneWeights { space: 0.3, time: 0.7, stillness: 0.2 };
    let mut gradients: FieldGradients = field.zero_gradients();
    let value = plane_penalty(&field, &weights, &mut gradients).unwrap().weighted(&weights);
    let mut tensors = doubles(&field.tensors());
    assert!((value - penalty(&config, &tensors, &weights)).abs() < 1.0e-6 * value);
    for (name, gradient) in gradients.tensors() {
        if !name.contains("grids") {
            assert!(gradient.data.iter().all(|slope| *slope == 0.0), "{name}");
            continue;
        }
        let places: Vec<usize> = (0..gradient.data.len()).step_by(5).collect();
        let found: Vec<f32> = places.iter().map(|&place| gradient.data[place]).collect();
        let expected: Vec<f64> = places
            .iter()
            .map(|&place| {
                let mut side = |step: f64| {
                    let texel = &mut tensors.get_mut(&name).unwrap().1[place];
                    let before = *texel;
                    *texel += step;
                    let value = penalty(&config, &tensors, &weights);
                    tensors.get_mut(&name).unwrap().1[place] = before;
                    value
                };
                (side(1.0e-5) - side(-1.0e-5)) / 2.0e-5
            })
            .collect();
        let difference = relative_difference(&found, &expected);
        assert!(difference < 1.0e-3, "`{name}`: {difference:e}");
    }
}
