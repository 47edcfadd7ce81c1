//! One Gaussian from three dimensions to two, and its gradient back.

use std::ops::Range;

use super::matrix::{
    Mat2x3, Mat3, apply, cross, dot, rotation, rotation_gradient, scaled, times, transpose, transposed_times,
};
use crate::gaussians::BadValue;
use crate::raster::{LARGEST, RasterSettings, TILE, sh};
use crate::real::Real;
use crate::splats::{SplatGradients, Splats};
use crate::view::View;

/// A view and the constants of projection at one width.
#[derive(Debug, Clone)]
pub(super) struct Projection<F> {
    rotation: Mat3<F>,
    centre: [F; 3],
    focal: [F; 2],
    principal: [F; 2],
    /// Slopes x/z and y/z beyond which the affine approximation is not taken.
    slopes: [[F; 2]; 2],
    size: [F; 2],
    near: F,
    blur: F,
    sigmas: F,
    alpha_min: F,
}

/// A Gaussian on the picture plane.
#[derive(Debug, Clone)]
pub(super) struct ProjectedGaussian<F> {
    /// Which Gaussian.
    pub(super) index: usize,
    /// Distance along the optical axis, metres.
    pub(super) depth: F,
    /// Centre in pixels, whole numbers being the centres of pixels.
    pub(super) mean: [F; 2],
    /// Covariance xx, xy, yy, blur included, square pixels.
    pub(super) covariance: [F; 3],
    /// Determinant of the covariance.
    pub(super) determinant: F,
    pub(super) opacity: F,
    pub(super) colour: [F; 3],
    /// Half side of the square that decides on tiles, whole pixels.
    pub(super) radius: F,
    pub(super) tiles: Tiles,
    /// Which clamps were active: for those who need to know where the derivative jumps.
    pub(super) clamped: [bool; 5],
}

/// A rectangle of tiles.
#[derive(Debug, Clone)]
pub(super) struct Tiles {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

/// Derivatives of a loss by a [`ProjectedGaussian`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ProjectedGradient<F> {
    pub(super) depth: F,
    pub(super) mean: [F; 2],
    /// By the logarithm of alpha, weighted with the squares (first, mixed, second) of the pull (see
    /// [`super::blend`]), summed over pixels.
    pub(super) pulls: [F; 3],
    pub(super) opacity: F,
    pub(super) colour: [F; 3],
}

/// What both directions need of one Gaussian in camera axes.
struct CameraSpace<F> {
    /// From the camera's centre, world axes.
    offset: [F; 3],
    /// Camera axes.
    point: [F; 3],
    /// Slopes x/z and y/z as the affine approximation takes them, and whether they were held back.
    slope: [F; 2],
    held: [bool; 2],
    /// Derivative of the projection.
    jacobian: Mat2x3<F>,
    rotation: Mat3<F>,
    /// Own axes, scaled, to camera axes.
    camera_from_own: Mat3<F>,
    /// Own axes, scaled, to the picture.
    picture_from_own: Mat2x3<F>,
}

impl<F: Real> Projection<F> {
    pub(super) fn new(view: &View, settings: &RasterSettings) -> Self {
        let size = [view.width(), view.height()].map(f64::from);
        let (focal, principal) = (view.focal(), view.principal());
        let slopes = [0, 1].map(|axis| {
            let beyond = (f64::from(settings.frustum_margin) - 1.0) * size[axis] / (2.0 * focal[axis]);
            [-principal[axis] / focal[axis] - beyond, (size[axis] - principal[axis]) / focal[axis] + beyond]
                .map(F::of)
        });
        Self {
            rotation: view.rotation().map(|row| row.map(F::of)),
            centre: view.centre().map(F::of),
            focal: focal.map(F::of),
            principal: principal.map(F::of),
            slopes,
            size: size.map(F::of),
            near: F::of(settings.near_m.into()),
            blur: F::of(settings.blur_px2.into()),
            sigmas: F::of(settings.coverage_sigmas.into()),
            alpha_min: F::of(settings.alpha_min.into()),
        }
    }

    fn to_camera(&self, splats: &Splats<F>, index: usize) -> Option<CameraSpace<F>> {
        let mean = splats.means()[index];
        let offset = std::array::from_fn(|axis| mean[axis] - self.centre[axis]);
        let point = apply(self.rotation, offset);
        let z = point[2];
        if z <= self.near {
            return None;
        }
        let slope: [F; 2] =
            std::array::from_fn(|axis| (point[axis] / z).max(self.slopes[axis][0]).min(self.slopes[axis][1]));
        let held = [0, 1].map(|axis| slope[axis] != point[axis] / z);
        let per_z = self.focal.map(|focal| focal / z);
        let jacobian =
            [[per_z[0], F::zero(), -per_z[0] * slope[0]], [F::zero(), per_z[1], -per_z[1] * slope[1]]];
        let rotation = rotation(splats.rotations()[index]);
        let camera_from_own = times(self.rotation, scaled(rotation, splats.scales()[index]));
        let picture_from_own = times(jacobian, camera_from_own);
        Some(CameraSpace {
            offset,
            point,
            slope,
            held,
            jacobian,
            rotation,
            camera_from_own,
            picture_from_own,
        })
    }

    /// The Gaussian on the picture plane; none if it isn't visible.
    pub(super) fn project(
        &self,
        splats: &Splats<F>,
        index: usize,
    ) -> Result<Option<ProjectedGaussian<F>>, BadValue> {
        let opacity = splats.opacities()[index];
        if opacity < self.alpha_min {
            return Ok(None);
        }
        let Some(seen) = self.to_camera(splats, index) else { return Ok(None) };
        let [x, y, z] = seen.point;
        let half = F::of(0.5);
        let mean = [
            self.focal[0] * x / z + self.principal[0] - half,
            self.focal[1] * y / z + self.principal[1] - half,
        ];
        let [first, second] = seen.picture_from_own;
        let [xx, xy, yy] = [dot(first, first), dot(first, second), dot(second, second)];
        let covariance = [xx + self.blur, xy, yy + self.blur];
        // Lagrange's identity: xx yy - xy^2 is the square of the cross product.
        let determinant =
            dot(cross(first, second), cross(first, second)) + self.blur * (xx + yy) + self.blur * self.blur;
        let overflows = |field, value: F| BadValue { field, index, value: value.narrow() };
        if z > F::of(LARGEST.into()) || !mean.iter().all(|value| value.is_finite()) {
            return Err(overflows("means", largest(splats.means()[index])));
        }
        if !determinant.is_finite() || !xy.is_finite() {
            return Err(overflows("scales", largest(splats.scales()[index])));
        }
        let radius = self.radius(covariance);
        let tiles = self.tiles(mean, radius);
        if tiles.columns.is_empty() || tiles.rows.is_empty() {
            return Ok(None);
        }
        let shade = shade(splats, index, seen.offset);
        if let Some(&value) = shade.iter().find(|value| value.is_nan() || value.abs() > F::of(LARGEST.into()))
        {
            return Err(overflows("sh", value));
        }
        let dark = shade.map(|value| value < F::zero());
        Ok(Some(ProjectedGaussian {
            index,
            depth: z,
            mean,
            covariance,
            determinant,
            opacity,
            colour: shade.map(|value| value.max(F::zero())),
            radius,
            tiles,
            clamped: [dark[0], dark[1], dark[2], seen.held[0], seen.held[1]],
        }))
    }

    /// Row `first` less what it shares with row `second`: first - xy / yy second, yy including the blur. Written with
    /// the vector triple product, since the difference has no digits left if the rows are long and almost parallel.
    fn sheared(&self, first: [F; 3], second: [F; 3], yy: F) -> [F; 3] {
        let apart = cross(second, cross(first, second));
        std::array::from_fn(|k| (self.blur * first[k] + apart[k]) / yy)
    }

    fn radius(&self, [xx, xy, yy]: [F; 3]) -> F {
        let half = F::of(0.5);
        let (middle, difference) = (half * (xx + yy), half * (xx - yy));
        let spread = (difference * difference + xy * xy).max(F::of(0.1)).sqrt();
        (self.sigmas * (middle + spread).sqrt()).ceil()
    }

    fn tiles(&self, mean: [F; 2], radius: F) -> Tiles {
        let side = F::of(TILE as f64);
        let [columns, rows] = [0, 1].map(|axis| {
            let count = (self.size[axis] / side).ceil();
            let tile = |edge: F| (edge / side).floor().max(F::zero()).min(count).wide() as usize;
            tile(mean[axis] - radius)..tile(mean[axis] + radius + side - F::one())
        });
        Tiles { columns, rows }
    }

    /// Carries derivatives by a projected Gaussian back to the splat that it came from.
    pub(super) fn backward(
        &self,
        splats: &Splats<F>,
        gaussian: &ProjectedGaussian<F>,
        gradient: &ProjectedGradient<F>,
        gradients: &mut SplatGradients<F>,
    ) {
        let index = gaussian.index;
        let Some(seen) = self.to_camera(splats, index) else { return };
        // Covariance S = P P^T + blur, P = J V, V = W R diag(s). The exponent -1/2 d^T S^-1 d changes with P by
        // q q^T P, where q = S^-1 d = (p0, p1 - shear p0) is made of the two pulls p.
        let [first, second] = seen.picture_from_own;
        let [_, xy, yy] = gaussian.covariance;
        let sheared = self.sheared(first, second, yy);
        let [square, mixed, other] = gradient.pulls;
        let by_first = std::array::from_fn(|k| square * sheared[k] + mixed * second[k]);
        let by_second =
            std::array::from_fn(|k| mixed * sheared[k] + other * second[k] - xy / yy * by_first[k]);
        let by_picture: Mat2x3<F> = [by_first, by_second];
        let by_jacobian = times(by_picture, transpose(seen.camera_from_own));
        let by_camera = transposed_times(seen.jacobian, by_picture);
        let by_own = times(transpose(self.rotation), by_camera);
        let scales = splats.scales()[index];
        gradients.scales[index] = std::array::from_fn(|k| {
            (0..3).fold(F::zero(), |sum, i| sum + seen.rotation[i][k] * by_own[i][k])
        });
        gradients.rotations[index] = rotation_gradient(splats.rotations()[index], scaled(by_own, scales));

        let mut by_point = self.through_jacobian(&seen, by_jacobian);
        let [x, y, z] = seen.point;
        for (axis, position) in [x, y].into_iter().enumerate() {
            let slope = self.focal[axis] / z;
            by_point[axis] = by_point[axis] + slope * gradient.mean[axis];
            by_point[2] = by_point[2] - slope * position / z * gradient.mean[axis];
        }
        by_point[2] = by_point[2] + gradient.depth;
        let by_mean = apply(transpose(self.rotation), by_point);
        let by_direction = self.through_shade(splats, gaussian, seen.offset, gradient.colour, gradients);
        gradients.means[index] = std::array::from_fn(|axis| by_mean[axis] + by_direction[axis]);

        gradients.opacities[index] = gradient.opacity;
        gradients.means_ndc[index] =
            std::array::from_fn(|axis| gradient.mean[axis] * self.size[axis] * F::of(0.5));
        gradients.visible[index] = true;
    }

    /// The Jacobian holds f/z and -f s/z, s being the slope x/z or what holds it back.
    fn through_jacobian(&self, seen: &CameraSpace<F>, by_jacobian: Mat2x3<F>) -> [F; 3] {
        let z = seen.point[2];
        let mut by_point = [F::zero(); 3];
        for axis in 0..2 {
            let per_zz = self.focal[axis] / (z * z);
            let (straight, oblique) = (by_jacobian[axis][axis], by_jacobian[axis][2]);
            let times = if seen.held[axis] { F::one() } else { F::of(2.0) };
            by_point[2] = by_point[2] - per_zz * straight + times * per_zz * seen.slope[axis] * oblique;
            if !seen.held[axis] {
                by_point[axis] = by_point[axis] - per_zz * oblique;
            }
        }
        by_point
    }

    /// Gradient by the spherical harmonics, stored, and by the offset from the camera, returned.
    fn through_shade(
        &self,
        splats: &Splats<F>,
        gaussian: &ProjectedGaussian<F>,
        offset: [F; 3],
        by_colour: [F; 3],
        gradients: &mut SplatGradients<F>,
    ) -> [F; 3] {
        let open =
            std::array::from_fn(
                |channel| if gaussian.clamped[channel] { F::zero() } else { by_colour[channel] },
            );
        let degree = splats.sh_degree();
        let (direction, length) = direction(offset);
        let values = sh::basis(degree, direction);
        let slopes = sh::basis_gradient(degree, direction);
        let count = degree.coefficients();
        let mut by_direction = [F::zero(); 3];
        for (k, coefficient) in splats.sh_of(gaussian.index).iter().enumerate() {
            gradients.sh[gaussian.index * count + k] = open.map(|g| g * values[k]);
            let along = dot(open, *coefficient);
            by_direction = std::array::from_fn(|axis| by_direction[axis] + slopes[k][axis] * along);
        }
        let radial = dot(by_direction, direction);
        std::array::from_fn(|axis| (by_direction[axis] - direction[axis] * radial) / length)
    }
}

/// The coordinate that is farthest from 0.
fn largest<F: Real>(row: [F; 3]) -> F {
    row.into_iter().fold(F::zero(), |most, value| if value.abs() > most.abs() { value } else { most })
}

/// Colour of a Gaussian in the direction from the camera, before it is clamped below at 0.
fn shade<F: Real>(splats: &Splats<F>, index: usize, offset: [F; 3]) -> [F; 3] {
    let values = sh::basis(splats.sh_degree(), direction(offset).0);
    let mut sum = [F::of(0.5); 3];
    for (coefficient, value) in splats.sh_of(index).iter().zip(values) {
        sum = std::array::from_fn(|channel| sum[channel] + coefficient[channel] * value);
    }
    sum
}

fn direction<F: Real>(offset: [F; 3]) -> ([F; 3], F) {
    let length = dot(offset, offset).sqrt();
    (offset.map(|value| value / length), length)
}
