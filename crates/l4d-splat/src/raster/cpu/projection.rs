//! Projection of Gaussians in f64, and what the picture then needs of each of them.

use std::f64::consts::{LN_2, LOG2_E};

use crate::raster::{RasterSettings, TILE, sh};
use crate::splats::Splats;
use crate::view::View;

/// A visible Gaussian on the picture plane.
#[derive(Debug, Clone)]
pub(super) struct Splat2d {
    /// Centre in pixels, whole numbers being the centres of pixels.
    pub(super) mean: [f64; 2],
    /// Upper triangle (xx, xy, yy) of the matrix that maps an offset from the centre to (u, v), such that the
    /// Gaussian falls off as 2^-(u^2 + v^2).
    pub(super) conic_factor: [f64; 3],
    /// Base 2.
    pub(super) log_opacity: f32,
    pub(super) colour: [f32; 3],
    /// Along the optical axis, metres.
    pub(super) depth: f32,
    /// Which Gaussian.
    pub(super) index: u32,
    /// Half side of the square in which it is drawn, whole pixels.
    pub(super) radius: f32,
    /// Tiles that the square touches: first column, end, first row, end.
    pub(super) tiles: [u16; 4],
}

/// Variance along an axis to its squared conic factor: (1/2) log2 e.
pub(super) const HALF_LOG2_E: f64 = 0.5 * LOG2_E;

/// Width over height, squared, from which on a Gaussian lies along the rows.
const ROW_ALIGNED: f64 = 1e4;

/// A conic factor, and the order of the picture's axes to which it applies.
pub(super) struct Axes {
    /// As [`Splat2d::conic_factor`], of the first and the second axis.
    pub(super) conic_factor: [f64; 3],
    /// Whether y is the first axis and x the second.
    swapped: bool,
}

impl Axes {
    /// From the order of the picture (x, y) to this one, and back.
    pub(super) fn order<T>(&self, [x, y]: [T; 2]) -> [T; 2] {
        if self.swapped { [y, x] } else { [x, y] }
    }
}

impl Splat2d {
    /// Whether the Gaussian is so much wider than high that v is all but u, and f32 has no digits for the difference,
    /// which is the place along the Gaussian.
    pub(super) fn is_row_aligned(&self) -> bool {
        let [xx, xy, yy] = self.conic_factor;
        yy * yy + xy * xy > ROW_ALIGNED * xx * xx
    }

    /// The axes in which backward sums: those of [`Splat2d::conic_factor`], but swapped if the Gaussian lies.
    pub(super) fn axes(&self) -> Axes {
        if !self.is_row_aligned() {
            return Axes { conic_factor: self.conic_factor, swapped: false };
        }
        let [xx, xy, yy] = self.conic_factor;
        // Variances and covariance over HALF_LOG2_E.
        let width = (yy * yy + xy * xy) / (xx * yy * xx * yy);
        let covariance = -xy / (xx * yy * yy);
        let second = 1.0 / width.sqrt();
        // The determinant of the matrix stays.
        let first = xx * yy / second;
        Axes { conic_factor: [first, -covariance / width * first, second], swapped: true }
    }
}

/// A view with the constants of projection.
#[derive(Debug, Clone)]
pub(super) struct Projection {
    pub(super) rotation: [[f64; 3]; 3],
    pub(super) centre: [f64; 3],
    pub(super) focal: [f64; 2],
    pub(super) principal: [f64; 2],
    /// Slopes x/z and y/z beyond which the affine approximation is not taken: least, largest.
    pub(super) slopes: [[f64; 2]; 2],
    /// Tiles in a row and in a column.
    pub(super) tiles: [usize; 2],
    pub(super) size: [f64; 2],
    pub(super) near: f64,
    pub(super) blur: f64,
    pub(super) sigmas: f64,
    pub(super) alpha_min: f32,
}

/// One Gaussian as backward needs it.
pub(super) struct Linearization {
    /// From the camera, world axes, metres.
    pub(super) offset: [f64; 3],
    /// In camera axes, metres.
    pub(super) point: [f64; 3],
    /// Slopes x/z and y/z where the affine approximation is taken.
    pub(super) slope: [f64; 2],
    /// World axes to the picture: two rows, pixels per metre.
    pub(super) picture_from_world: [[f64; 3]; 2],
    /// Own to world axes.
    pub(super) rotation: [[f64; 3]; 3],
    /// Own axes, scaled, to the picture: two rows, pixels.
    pub(super) jacobian_times_rotation: [[f64; 3]; 2],
}

impl Projection {
    pub(super) fn new(view: &View, settings: &RasterSettings) -> Self {
        let pixels = [view.width(), view.height()];
        let size = pixels.map(f64::from);
        let (focal, principal) = (view.focal(), view.principal());
        let slopes = [0, 1].map(|axis| {
            let beyond = (f64::from(settings.frustum_margin) - 1.0) * size[axis] / (2.0 * focal[axis]);
            [-principal[axis] / focal[axis] - beyond, (size[axis] - principal[axis]) / focal[axis] + beyond]
        });
        Self {
            rotation: view.rotation(),
            centre: view.centre(),
            focal,
            principal,
            slopes,
            tiles: pixels.map(|side| (side as usize).div_ceil(TILE)),
            size,
            near: settings.near_m.into(),
            blur: settings.blur_px2.into(),
            sigmas: settings.coverage_sigmas.into(),
            alpha_min: settings.alpha_min,
        }
    }

    /// A visible Gaussian in camera axes.
    pub(super) fn linearize(&self, splats: &Splats, index: usize) -> Linearization {
        let mean = splats.means()[index];
        // In f64, so that a scene far from the origin keeps the digits that its f32 coordinates have.
        let offset: [f64; 3] = std::array::from_fn(|axis| f64::from(mean[axis]) - self.centre[axis]);
        let [across, down, ahead] = self.rotation;
        let z = dot(ahead, offset);
        let point = [dot(across, offset), dot(down, offset), z];
        let per_z = 1.0 / z;
        let slope =
            [0, 1].map(|axis| (point[axis] * per_z).clamp(self.slopes[axis][0], self.slopes[axis][1]));
        let picture_from_world: [[f64; 3]; 2] = std::array::from_fn(|axis| {
            let scale = self.focal[axis] * per_z;
            std::array::from_fn(|k| scale * (self.rotation[axis][k] - slope[axis] * ahead[k]))
        });
        let rotation = rotation(splats.rotations()[index].map(f64::from));
        let scales = splats.scales()[index].map(f64::from);
        let jacobian_times_rotation = picture_from_world.map(|row| {
            std::array::from_fn(|k| {
                (row[0] * rotation[0][k] + row[1] * rotation[1][k] + row[2] * rotation[2][k]) * scales[k]
            })
        });
        Linearization { offset, point, slope, picture_from_world, rotation, jacobian_times_rotation }
    }

    /// Whether the affine approximation was held back along an axis.
    pub(super) fn is_clamped(&self, linear: &Linearization, axis: usize) -> bool {
        let slope = linear.point[axis] / linear.point[2];
        slope < self.slopes[axis][0] || slope > self.slopes[axis][1]
    }

    /// Own axes, scaled, to (u, v).
    pub(super) fn whitened(&self, axes: &Axes, linear: &Linearization) -> [[f64; 3]; 2] {
        let [first, second] = axes.order(linear.jacobian_times_rotation);
        let [xx, xy, yy] = axes.conic_factor;
        let variance = dot(second, second) + self.blur;
        let area = cross(first, second);
        let apart = cross(second, area);
        // u is xx (first - <first, second> / variance second). For rows that are long and almost parallel the
        // difference has no digits left, but equals (blur first + second x (first x second)) / variance. That in
        // turn is worse for an axis that is very much shorter than the others.
        let spoiled = (dot(second, second) * dot(area, area)).sqrt() / variance;
        let u = std::array::from_fn(|k| {
            if spoiled < first[k].abs() {
                xx * (self.blur * first[k] + apart[k]) / variance
            } else {
                xx * first[k] + xy * second[k]
            }
        });
        [u, second.map(|value| yy * value)]
    }
}

/// Derivative by the opacity of alpha is alpha over opacity; by the exponent in base 2, alpha times this.
pub(super) const PER_EXPONENT: f64 = LN_2;

#[inline]
pub(super) fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = a[0] * b[0];
    for k in 1..N {
        sum += a[k] * b[k];
    }
    sum
}

#[inline]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
fn rotation([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let (xy, xz, yz) = (x * y, x * z, y * z);
    let (wx, wy, wz) = (w * x, w * y, w * z);
    [
        [1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)],
        [2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx)],
        [2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy)],
    ]
}

/// Direction and distance from the camera.
#[inline]
pub(super) fn direction(offset: [f64; 3]) -> ([f32; 3], f64) {
    let length = dot(offset, offset).sqrt();
    (offset.map(|value| (value / length) as f32), length)
}

/// Colour in the direction from the camera, before it is clamped below at 0.
#[inline]
pub(super) fn sh_colour(splats: &Splats, index: usize, offset: [f64; 3]) -> [f32; 3] {
    let coefficients = splats.sh_of(index);
    let degree = splats.sh_degree();
    // Degree 0 doesn't ask for a direction.
    let towards = if degree.get() == 0 { [0.0; 3] } else { direction(offset).0 };
    let values = sh::basis(degree, towards);
    let mut sum = [0.5; 3];
    for (coefficient, value) in coefficients.iter().zip(values) {
        for (sum, coefficient) in sum.iter_mut().zip(coefficient) {
            *sum += coefficient * value;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lying_gaussian_falls_off_the_same_in_its_own_axes() {
        for (conic_factor, lies) in
            [([0.8, -0.3, 0.5], false), ([0.5, 0.1, 1e-5], false), ([1e-4, 0.3, 0.9], true)]
        {
            let splat2d = Splat2d {
                mean: [0.0; 2],
                conic_factor,
                log_opacity: 0.0,
                colour: [0.0; 3],
                depth: 1.0,
                index: 0,
                radius: 1.0,
                tiles: [0; 4],
            };
            let axes = splat2d.axes();
            assert_eq!((splat2d.is_row_aligned(), axes.swapped), (lies, lies));
            for offset in [[3.0, -2.0], [1e3, 0.5], [0.0, 1.0]] {
                let fall = |[xx, xy, yy]: [f64; 3], [first, second]: [f64; 2]| {
                    (xx * first + xy * second).powi(2) + (yy * second).powi(2)
                };
                let ratio = fall(axes.conic_factor, axes.order(offset)) / fall(conic_factor, offset);
                assert!((ratio - 1.0).abs() < 1e-9, "{conic_factor:?} {offset:?}: {ratio}");
            }
        }
    }
}
