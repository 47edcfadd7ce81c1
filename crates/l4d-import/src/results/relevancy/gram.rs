//! The length of a layer's output without the output.
//!
//! `|W h + b|^2` is a quadratic form of `(h, 1)` with the matrix `[W b]^T [W b]`. Its triangular factor has as many
//! rows as `h` has numbers, half of them zero: for 256 to 512 numbers a quarter of the layer's products. A factor
//! rather than the matrix itself, so that no rounding makes a square negative.

use ndarray::{Array2, linalg::general_mat_mul};

use super::decoder::Layer;

/// Upper triangular `R` with `R^T R = [W b]^T [W b]`, row by row, `inputs + 1` rows and columns.
pub(super) fn factor(layer: &Layer) -> Vec<f32> {
    let size = layer.inputs + 1;
    let affine = Array2::from_shape_fn((layer.outputs, size), |(row, col)| {
        f64::from(if col < layer.inputs { layer.weight[row * layer.inputs + col] } else { layer.bias[row] })
    });
    let mut gram = Array2::zeros((size, size));
    general_mat_mul(1.0, &affine.t(), &affine, 0.0, &mut gram);
    let mut gram = gram.into_raw_vec_and_offset().0;
    cholesky(&mut gram, size);
    gram.into_iter().map(|number| number as f32).collect()
}

/// Replaces a positive semidefinite matrix by its upper triangular factor.
///
/// Layers that narrow make it singular: a pivot that is nothing but rounding ends in a row of zeros.
fn cholesky(matrix: &mut [f64], size: usize) {
    let largest = (0..size).map(|index| matrix[index * size + index]).fold(0.0, f64::max);
    let least = largest * 1e-13 * size as f64;
    for pivot in 0..size {
        let (above, below) = matrix.split_at_mut((pivot + 1) * size);
        let row = &mut above[pivot * size..];
        let diagonal = row[pivot];
        row[..pivot].fill(0.0);
        if diagonal <= least {
            row.fill(0.0);
            continue;
        }
        let root = diagonal.sqrt();
        row[pivot..].iter_mut().for_each(|number| *number /= root);
        for (index, other) in below.chunks_exact_mut(size).enumerate() {
            let from = pivot + 1 + index;
            let scale = row[from];
            if scale != 0.0 {
                other[from..]
                    .iter_mut()
                    .zip(&row[from..])
                    .for_each(|(number, above)| *number -= scale * above);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `|W h + b|` both ways for a few `h`.
    fn check(inputs: usize, outputs: usize) {
        let number = |seed: usize| ((seed * 2_654_435_761) % 1000) as f32 / 500.0 - 1.0;
        let layer = Layer {
            inputs,
            outputs,
            weight: (0..inputs * outputs).map(number).collect(),
            bias: (0..outputs).map(|index| number(index + 7)).collect(),
        };
        let factor = factor(&layer);
        for seed in 0..5 {
            let hidden: Vec<f32> = (0..inputs).map(|index| number(31 * index + seed)).chain([1.0]).collect();
            let squared = |rows: usize, coefficient: &dyn Fn(usize, usize) -> f32| -> f32 {
                let row = |row| -> f32 { (0..=inputs).map(|col| coefficient(row, col) * hidden[col]).sum() };
                (0..rows).map(|index| row(index).powi(2)).sum()
            };
            let long = squared(outputs, &|row, col| {
                if col < inputs { layer.weight[row * inputs + col] } else { layer.bias[row] }
            });
            let short = squared(inputs + 1, &|row, col| factor[row * (inputs + 1) + col]);
            assert!((long - short).abs() <= 1e-5 * long, "{inputs} to {outputs}: {long} and {short}");
        }
        for row in 0..=inputs {
            assert!(factor[row * (inputs + 1)..][..row].iter().all(|&number| number == 0.0));
        }
    }

    #[test]
    fn lengths_are_those_of_the_layer() {
        check(20, 45);
        check(1, 1);
        // More numbers in than out: the form is singular.
        check(30, 12);
    }
}
