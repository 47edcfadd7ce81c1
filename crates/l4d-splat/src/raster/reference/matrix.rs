//! The few products of small matrices that projection needs. Rows first.

use crate::real::Real;

pub(super) type Mat3<F> = [[F; 3]; 3];
pub(super) type Mat2x3<F> = [[F; 3]; 2];

pub(super) fn dot<F: Real, const N: usize>(a: [F; N], b: [F; N]) -> F {
    std::iter::zip(a, b).fold(F::zero(), |sum, (a, b)| sum + a * b)
}

pub(super) fn cross<F: Real>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Rows of `a` times the 3x3 matrix `b`.
pub(super) fn times<F: Real, const N: usize>(a: [[F; 3]; N], b: Mat3<F>) -> [[F; 3]; N] {
    let columns = transpose(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

pub(super) fn apply<F: Real>(a: Mat3<F>, vector: [F; 3]) -> [F; 3] {
    a.map(|row| dot(row, vector))
}

pub(super) fn transpose<F: Real>(a: Mat3<F>) -> Mat3<F> {
    std::array::from_fn(|row| std::array::from_fn(|column| a[column][row]))
}

/// `a` transposed times `b`.
pub(super) fn transposed_times<F: Real>(a: Mat2x3<F>, b: Mat2x3<F>) -> Mat3<F> {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| a[0][row] * b[0][column] + a[1][row] * b[1][column])
    })
}

/// `a` with its columns multiplied by `factors`.
pub(super) fn scaled<F: Real>(a: Mat3<F>, factors: [F; 3]) -> Mat3<F> {
    a.map(|row| std::array::from_fn(|column| row[column] * factors[column]))
}

/// The rotation of a unit quaternion (w, x, y, z); other lengths are not corrected.
pub(super) fn rotation<F: Real>([w, x, y, z]: [F; 4]) -> Mat3<F> {
    let (one, two) = (F::one(), F::of(2.0));
    [
        [one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)],
        [two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)],
        [two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)],
    ]
}

/// Derivatives by the quaternion, given those by the entries of its rotation matrix.
pub(super) fn rotation_gradient<F: Real>([w, x, y, z]: [F; 4], g: Mat3<F>) -> [F; 4] {
    let two = F::of(2.0);
    let (xy, xz, yz) = (g[0][1] + g[1][0], g[0][2] + g[2][0], g[1][2] + g[2][1]);
    let (turn_x, turn_y, turn_z) = (g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]);
    [
        two * (x * turn_x + y * turn_y + z * turn_z),
        two * (y * xy + z * xz + w * turn_x - two * x * (g[1][1] + g[2][2])),
        two * (x * xy + z * yz + w * turn_y - two * y * (g[0][0] + g[2][2])),
        two * (x * xz + y * yz + w * turn_z - two * z * (g[0][0] + g[1][1])),
    ]
}
