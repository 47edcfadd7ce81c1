//! Real spherical harmonics up to degree 3 in the order and with the signs of 3D Gaussian splatting.

use num_traits::{AsPrimitive, Float};

use crate::gaussians::ShDegree;

/// Coefficients of the largest degree.
pub(super) const MOST: usize = 16;

const C0: f64 = 0.28209479177387814;
const C1: f64 = 0.4886025119029199;
const C2: [f64; 5] =
    [1.0925484305920792, -1.0925484305920792, 0.31539156525252005, -1.0925484305920792, 0.5462742152960396];
const C3: [f64; 7] = [
    -0.5900435899266435,
    2.890611442640554,
    -0.4570457994644658,
    0.3731763325901154,
    -0.4570457994644658,
    1.445305721320277,
    -0.5900435899266435,
];

/// The basis functions up to `degree` in a unit direction; 0 beyond.
#[inline]
pub(super) fn basis<F: Float + 'static>(degree: ShDegree, [x, y, z]: [F; 3]) -> [F; MOST]
where
    f64: AsPrimitive<F>,
{
    let mut values = [F::zero(); MOST];
    values[0] = C0.as_();
    if degree.get() >= 1 {
        let c1: F = C1.as_();
        values[1] = -c1 * y;
        values[2] = c1 * z;
        values[3] = -c1 * x;
    }
    if degree.get() >= 2 {
        let c: [F; 5] = C2.map(AsPrimitive::as_);
        values[4] = c[0] * x * y;
        values[5] = c[1] * y * z;
        values[6] = c[2] * (2.0_f64.as_() * z * z - x * x - y * y);
        values[7] = c[3] * x * z;
        values[8] = c[4] * (x * x - y * y);
    }
    if degree.get() >= 3 {
        let c: [F; 7] = C3.map(AsPrimitive::as_);
        let (two, three, four): (F, F, F) = (2.0_f64.as_(), 3.0_f64.as_(), 4.0_f64.as_());
        let (xx, yy, zz) = (x * x, y * y, z * z);
        values[9] = c[0] * y * (three * xx - yy);
        values[10] = c[1] * x * y * z;
        values[11] = c[2] * y * (four * zz - xx - yy);
        values[12] = c[3] * z * (two * zz - three * xx - three * yy);
        values[13] = c[4] * x * (four * zz - xx - yy);
        values[14] = c[5] * z * (xx - yy);
        values[15] = c[6] * x * (xx - three * yy);
    }
    values
}

/// Derivatives of the basis functions by the components of the direction.
#[inline]
pub(super) fn basis_gradient<F: Float + 'static>(degree: ShDegree, [x, y, z]: [F; 3]) -> [[F; 3]; MOST]
where
    f64: AsPrimitive<F>,
{
    let o = F::zero();
    let mut rows = [[o; 3]; MOST];
    if degree.get() >= 1 {
        let c1: F = C1.as_();
        rows[1] = [o, -c1, o];
        rows[2] = [o, o, c1];
        rows[3] = [-c1, o, o];
    }
    if degree.get() >= 2 {
        let c: [F; 5] = C2.map(AsPrimitive::as_);
        let (two, four): (F, F) = (2.0_f64.as_(), 4.0_f64.as_());
        rows[4] = [c[0] * y, c[0] * x, o];
        rows[5] = [o, c[1] * z, c[1] * y];
        rows[6] = [-two * c[2] * x, -two * c[2] * y, four * c[2] * z];
        rows[7] = [c[3] * z, o, c[3] * x];
        rows[8] = [two * c[4] * x, -two * c[4] * y, o];
    }
    if degree.get() >= 3 {
        let c: [F; 7] = C3.map(AsPrimitive::as_);
        let [two, three, four, six, eight]: [F; 5] = [2.0, 3.0, 4.0, 6.0, 8.0_f64].map(AsPrimitive::as_);
        let (xx, yy, zz) = (x * x, y * y, z * z);
        rows[9] = [six * c[0] * x * y, three * c[0] * (xx - yy), o];
        rows[10] = [c[1] * y * z, c[1] * x * z, c[1] * x * y];
        rows[11] = [-two * c[2] * x * y, c[2] * (four * zz - xx - three * yy), eight * c[2] * y * z];
        rows[12] = [-six * c[3] * x * z, -six * c[3] * y * z, c[3] * (six * zz - three * xx - three * yy)];
        rows[13] = [c[4] * (four * zz - three * xx - yy), -two * c[4] * x * y, eight * c[4] * x * z];
        rows[14] = [two * c[5] * x * z, -two * c[5] * y * z, c[5] * (xx - yy)];
        rows[15] = [three * c[6] * (xx - yy), -six * c[6] * x * y, o];
    }
    rows
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_basis_is_orthonormal_on_the_sphere() {
        // Midpoint rule in z and longitude: exact enough for polynomials of degree 6.
        let (rows, columns) = (400, 24);
        let mut products = [[0.0; MOST]; MOST];
        for row in 0..rows {
            let z = (f64::from(row) + 0.5) / f64::from(rows) * 2.0 - 1.0;
            for column in 0..columns {
                let longitude = (f64::from(column) + 0.5) / f64::from(columns) * 2.0 * PI;
                let radius = (1.0 - z * z).sqrt();
                let values = basis(ShDegree::MAX, [radius * longitude.cos(), radius * longitude.sin(), z]);
                let area = 4.0 * PI / f64::from(rows * columns);
                for i in 0..MOST {
                    for j in 0..MOST {
                        products[i][j] += values[i] * values[j] * area;
                    }
                }
            }
        }
        for (i, row) in products.iter().enumerate() {
            for (j, product) in row.iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                assert!((product - expected).abs() < 1e-4, "{i} {j}: {product}");
            }
        }
    }

    #[test]
    fn signs_and_order_are_those_of_the_format() {
        let along = |direction| basis::<f64>(ShDegree::MAX, direction);
        assert_eq!(along([0.0, 1.0, 0.0])[1], -C1);
        assert_eq!(along([0.0, 0.0, 1.0])[2], C1);
        assert_eq!(along([1.0, 0.0, 0.0])[3], -C1);
        assert_eq!(along([0.0, 0.0, 1.0])[12], 2.0 * C3[3]);
        let low = basis::<f64>(ShDegree::new(1).unwrap(), [0.6, 0.0, 0.8]);
        assert!(low[4..].iter().all(|&value| value == 0.0) && low[3] != 0.0);
    }

    #[test]
    fn derivatives_are_central_differences() {
        for degree in (0..=3).map(|degree| ShDegree::new(degree).unwrap()) {
            let direction = [0.48, -0.64, 0.6];
            let rows = basis_gradient::<f64>(degree, direction);
            for axis in 0..3 {
                let at = |by: f64| {
                    let mut moved = direction;
                    moved[axis] += by;
                    basis(degree, moved)
                };
                let (ahead, behind) = (at(1e-6), at(-1e-6));
                for k in 0..MOST {
                    let difference = (ahead[k] - behind[k]) / 2e-6;
                    assert!((rows[k][axis] - difference).abs() < 1e-8, "{k} {axis}");
                }
            }
        }
    }
}
