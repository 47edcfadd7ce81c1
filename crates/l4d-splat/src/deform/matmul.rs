//! The three matrix products of a linear layer, on row-major slices; mismatched sizes panic. Knows neither activations
//! nor the order of layers.
//!
//! The kernels are `matrixmultiply`'s, chosen at run time for the vector unit, on the calling thread alone.

use ndarray::linalg::general_mat_mul;
use ndarray::{ArrayView2, ArrayViewMut2};

/// `output` \[rows\]\[outputs\] = `input` \[rows\]\[inputs\] times the transpose of `weight` \[outputs\]\[inputs\].
pub fn forward(input: &[f32], weight: &[f32], output: &mut [f32], outputs: usize) {
    let rows = output.len() / outputs;
    let inputs = weight.len() / outputs;
    let weight = matrix(weight, outputs, inputs);
    general_mat_mul(
        1.0,
        &matrix(input, rows, inputs),
        &weight.t(),
        0.0,
        &mut matrix_mut(output, rows, outputs),
    );
}

/// `d_input` \[rows\]\[inputs\] = `d_output` \[rows\]\[outputs\] times `weight`, gradients of the loss; with `add`,
/// added to what `d_input` holds.
pub fn backward_input(d_output: &[f32], weight: &[f32], d_input: &mut [f32], outputs: usize, add: bool) {
    let rows = d_output.len() / outputs;
    let inputs = weight.len() / outputs;
    let beta = if add { 1.0 } else { 0.0 };
    general_mat_mul(
        1.0,
        &matrix(d_output, rows, outputs),
        &matrix(weight, outputs, inputs),
        beta,
        &mut matrix_mut(d_input, rows, inputs),
    );
}

/// Adds to the gradient `d_weight` \[outputs\]\[inputs\] the transpose of `d_output` \[rows\]\[outputs\] times `input`
/// \[rows\]\[inputs\].
pub fn backward_weight(d_output: &[f32], input: &[f32], d_weight: &mut [f32], outputs: usize) {
    let rows = d_output.len() / outputs;
    let inputs = d_weight.len() / outputs;
    let d_output = matrix(d_output, rows, outputs);
    general_mat_mul(
        1.0,
        &d_output.t(),
        &matrix(input, rows, inputs),
        1.0,
        &mut matrix_mut(d_weight, outputs, inputs),
    );
}

const SIZED: &str = "layers and blocks are made with matching sizes";

fn matrix(numbers: &[f32], rows: usize, columns: usize) -> ArrayView2<'_, f32> {
    ArrayView2::from_shape((rows, columns), numbers).expect(SIZED)
}

fn matrix_mut(numbers: &mut [f32], rows: usize, columns: usize) -> ArrayViewMut2<'_, f32> {
    ArrayViewMut2::from_shape((rows, columns), numbers).expect(SIZED)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Two rows, three inputs, two outputs.
    const INPUT: [f32; 6] = [1.0, 2.0, 3.0, -1.0, 0.0, 2.0];
    const WEIGHT: [f32; 6] = [1.0, 0.0, 2.0, -1.0, 3.0, 0.5];
    const OUTPUT: [f32; 4] = [1.0, -2.0, 0.5, 4.0];

    #[test]
    fn forward_multiplies_by_the_transpose() {
        let mut output = [f32::NAN; 4];
        forward(&INPUT, &WEIGHT, &mut output, 2);
        assert_eq!(output, [7.0, 6.5, 3.0, 2.0]);
    }

    #[test]
    fn backward_input_multiplies_by_the_weight_and_can_accumulate() {
        let mut input = [f32::NAN; 6];
        backward_input(&OUTPUT, &WEIGHT, &mut input, 2, false);
        assert_eq!(input, [3.0, -6.0, 1.0, -3.5, 12.0, 3.0]);
        backward_input(&OUTPUT, &WEIGHT, &mut input, 2, true);
        assert_eq!(input, [6.0, -12.0, 2.0, -7.0, 24.0, 6.0]);
    }

    #[test]
    fn weight_gradients_are_summed_over_rows() {
        let mut weight = [1.0; 6];
        backward_weight(&OUTPUT, &INPUT, &mut weight, 2);
        assert_eq!(weight, [1.5, 3.0, 5.0, -5.0, -3.0, 3.0]);
    }
}
