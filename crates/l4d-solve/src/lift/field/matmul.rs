//! The three matrix products of a linear layer, on row-major slices, on the calling thread alone.

use ndarray::linalg::general_mat_mul;
use ndarray::{ArrayView2, ArrayViewMut2};

/// `output` \[rows\]\[outputs\] = `input` \[rows\]\[inputs\] times the transpose of `weight` \[outputs\]\[inputs\].
pub(super) fn forward(input: &[f32], weight: &[f32], output: &mut [f32], outputs: usize) {
    let (rows, inputs) = (output.len() / outputs, weight.len() / outputs);
    let weight = matrix(weight, outputs, inputs);
    general_mat_mul(
        1.0,
        &matrix(input, rows, inputs),
        &weight.t(),
        0.0,
        &mut matrix_mut(output, rows, outputs),
    );
}

/// `input` \[rows\]\[inputs\] = `output` \[rows\]\[outputs\] times `weight` \[outputs\]\[inputs\].
pub(super) fn backward_input(output: &[f32], weight: &[f32], input: &mut [f32], outputs: usize) {
    let (rows, inputs) = (output.len() / outputs, weight.len() / outputs);
    let output = matrix(output, rows, outputs);
    general_mat_mul(
        1.0,
        &output,
        &matrix(weight, outputs, inputs),
        0.0,
        &mut matrix_mut(input, rows, inputs),
    );
}

/// Adds to `weight` \[outputs\]\[inputs\] the transpose of `output` \[rows\]\[outputs\] times `input` \[rows\]\[inputs\].
pub(super) fn backward_weight(output: &[f32], input: &[f32], weight: &mut [f32], outputs: usize) {
    let (rows, inputs) = (output.len() / outputs, weight.len() / outputs);
    let output = matrix(output, rows, outputs);
    general_mat_mul(
        1.0,
        &output.t(),
        &matrix(input, rows, inputs),
        1.0,
        &mut matrix_mut(weight, outputs, inputs),
    );
}

const SIZED: &str = "layers and blocks are made with matching sizes";

fn matrix(numbers: &[f32], rows: usize, columns: usize) -> ArrayView2<'_, f32> {
    ArrayView2::from_shape((rows, columns), numbers).expect(SIZED)
}

fn matrix_mut(numbers: &mut [f32], rows: usize, columns: usize) -> ArrayViewMut2<'_, f32> {
    ArrayViewMut2::from_shape((rows, columns), numbers).expect(SIZED)
}
