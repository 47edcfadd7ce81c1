//! One Gaussian from three dimensions to two, and its gradient back.

use std::ops::Range;

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::gaussians::BadValue;
use crate::raster::{LARGEST, RasterSettings, TILE, sh};
use crate::splats::{SplatGradients, Splats};
use crate::view::View;

/// A view and the constants of projection.
#[derive(Debug, Clone)]
pub(super) struct Projection {
    camera_from_world: DMat3,
    centre: DVec3,
    focal: DVec2,
    principal: DVec2,
    /// Slopes x/z and y/z beyond which the affine approximation is not taken: least, largest.
    slopes: [DVec2; 2],
    size: DVec2,
    near: f64,
    blur: f64,
    sigmas: f64,
    alpha_min: f64,
}

/// A Gaussian on the picture plane.
#[derive(Debug, Clone)]
pub(super) struct ProjectedGaussian {
    /// Index among the splats.
    pub(super) index: usize,
    /// Distance along the optical axis, metres.
    pub(super) depth: f64,
    /// Centre in pixels, whole numbers being the centres of pixels.
    pub(super) mean: DVec2,
    /// Covariance xx, xy, yy, blur included, square pixels.
    pub(super) covariance: [f64; 3],
    pub(super) determinant: f64,
    pub(super) opacity: f64,
    pub(super) colour: DVec3,
    /// Columns and rows of tiles.
    pub(super) tiles: [Range<usize>; 2],
    /// Colour channels clamped at 0, then slopes clamped: where the derivative jumps.
    pub(super) clamped: [bool; 5],
}

/// Derivatives of a loss by a [`ProjectedGaussian`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ProjectedGradient {
    pub(super) depth: f64,
    pub(super) mean: DVec2,
    /// By the logarithm of alpha, weighted with the squares (first, mixed, second) of the scaled offset of
    /// [`super::blend`], summed over pixels.
    pub(super) offset_squares: [f64; 3],
    pub(super) opacity: f64,
    pub(super) colour: DVec3,
}

/// What both directions need of one Gaussian in camera axes.
struct CameraSpace {
    /// From the camera's centre, world axes.
    offset: DVec3,
    /// Camera axes.
    point: DVec3,
    /// Slopes x/z and y/z as the affine approximation takes them, and whether they were clamped.
    slope: DVec2,
    clamped: [bool; 2],
    /// Rows of the derivative of the projection.
    jacobian: [DVec3; 2],
    rotation: DMat3,
    /// Own axes, scaled, to camera axes.
    camera_from_own: DMat3,
    /// Rows of the map from own, scaled axes to the picture.
    jacobian_times_rotation: [DVec3; 2],
}

impl Projection {
    pub(super) fn new(view: &View, settings: &RasterSettings) -> Self {
        let size = DVec2::new(view.width().into(), view.height().into());
        let (focal, principal) = (DVec2::from(view.focal()), DVec2::from(view.principal()));
        let beyond = (f64::from(settings.frustum_margin) - 1.0) * size / (2.0 * focal);
        Self {
            camera_from_world: DMat3::from_cols_array_2d(&view.rotation()).transpose(),
            centre: view.centre().into(),
            focal,
            principal,
            slopes: [-principal / focal - beyond, (size - principal) / focal + beyond],
            size,
            near: settings.near_m.into(),
            blur: settings.blur_px2.into(),
            sigmas: settings.coverage_sigmas.into(),
            alpha_min: settings.alpha_min.into(),
        }
    }

    fn to_camera(&self, splats: &Splats<f64>, index: usize) -> Option<CameraSpace> {
        let offset = DVec3::from(splats.means()[index]) - self.centre;
        let point = self.camera_from_world * offset;
        if point.z <= self.near {
            return None;
        }
        let ratio = point.truncate() / point.z;
        let slope = ratio.max(self.slopes[0]).min(self.slopes[1]);
        let scale = self.focal / point.z;
        let jacobian =
            [DVec3::new(scale.x, 0.0, -scale.x * slope.x), DVec3::new(0.0, scale.y, -scale.y * slope.y)];
        let [w, x, y, z] = splats.rotations()[index];
        let rotation = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w));
        let scaled = rotation * DMat3::from_diagonal(splats.scales()[index].into());
        let camera_from_own = self.camera_from_world * scaled;
        let jacobian_times_rotation = jacobian.map(|row| camera_from_own.transpose() * row);
        let clamped = [slope.x != ratio.x, slope.y != ratio.y];
        Some(CameraSpace {
            offset,
            point,
            slope,
            clamped,
            jacobian,
            rotation,
            camera_from_own,
            jacobian_times_rotation,
        })
    }

    /// The Gaussian on the picture plane; none if it isn't visible.
    pub(super) fn project(
        &self,
        splats: &Splats<f64>,
        index: usize,
    ) -> Result<Option<ProjectedGaussian>, BadValue> {
        let opacity = splats.opacities()[index];
        if opacity < self.alpha_min {
            return Ok(None);
        }
        let Some(camera) = self.to_camera(splats, index) else { return Ok(None) };
        let z = camera.point.z;
        let mean = self.focal * camera.point.truncate() / z + self.principal - 0.5;
        let [first, second] = camera.jacobian_times_rotation;
        let [xx, xy, yy] = [first.dot(first), first.dot(second), second.dot(second)];
        let covariance = [xx + self.blur, xy, yy + self.blur];
        // Lagrange's identity: xx yy - xy^2 is the square of the cross product.
        let determinant =
            first.cross(second).length_squared() + self.blur * (xx + yy) + self.blur * self.blur;
        let overflow = |field, value: f64| BadValue { field, index, value: value as f32 };
        if z > LARGEST.into() || !mean.is_finite() {
            return Err(overflow("means", largest(splats.means()[index])));
        }
        if !determinant.is_finite() || !xy.is_finite() {
            return Err(overflow("scales", largest(splats.scales()[index])));
        }
        let radius = self.radius(covariance);
        let tiles = self.tiles(mean, radius);
        if tiles.iter().any(Range::is_empty) {
            return Ok(None);
        }
        let raw = sh_colour(splats, index, camera.offset);
        if let Some(value) =
            raw.to_array().into_iter().find(|value| value.is_nan() || value.abs() > LARGEST.into())
        {
            return Err(overflow("sh", value));
        }
        let dark = raw.cmplt(DVec3::ZERO);
        Ok(Some(ProjectedGaussian {
            index,
            depth: z,
            mean,
            covariance,
            determinant,
            opacity,
            colour: raw.max(DVec3::ZERO),
            tiles,
            clamped: [dark.test(0), dark.test(1), dark.test(2), camera.clamped[0], camera.clamped[1]],
        }))
    }

    /// Row `first` less what it shares with row `second`: first - xy / yy second, yy including the blur. Written with
    /// the vector triple product, since the difference has no digits left if the rows are long and almost parallel.
    fn sheared(&self, first: DVec3, second: DVec3, yy: f64) -> DVec3 {
        (self.blur * first + second.cross(first.cross(second))) / yy
    }

    fn radius(&self, [xx, xy, yy]: [f64; 3]) -> f64 {
        let (middle, difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = (difference * difference + xy * xy).max(0.1).sqrt();
        (self.sigmas * (middle + spread).sqrt()).ceil()
    }

    fn tiles(&self, mean: DVec2, radius: f64) -> [Range<usize>; 2] {
        let side = TILE as f64;
        [0, 1].map(|axis| {
            let count = (self.size[axis] / side).ceil();
            let tile = |edge: f64| (edge / side).floor().max(0.0).min(count) as usize;
            tile(mean[axis] - radius)..tile(mean[axis] + radius + side - 1.0)
        })
    }

    /// From the derivatives by a projected Gaussian to those by its splat.
    pub(super) fn backward(
        &self,
        splats: &Splats<f64>,
        gaussian: &ProjectedGaussian,
        gradient: &ProjectedGradient,
        gradients: &mut SplatGradients<f64>,
    ) {
        let index = gaussian.index;
        let Some(camera) = self.to_camera(splats, index) else { return };
        // Covariance S = P P^T + blur, P = J V, V = W R diag(s). The exponent -1/2 d^T S^-1 d changes with P by
        // q q^T P, where q = S^-1 d = (p0, p1 - shear p0) is made of the two scaled offsets p.
        let [first, second] = camera.jacobian_times_rotation;
        let [_, xy, yy] = gaussian.covariance;
        let sheared = self.sheared(first, second, yy);
        let [square, mixed, other] = gradient.offset_squares;
        let by_first = square * sheared + mixed * second;
        let by_second = mixed * sheared + other * second - xy / yy * by_first;
        let by_jacobian = [by_first, by_second].map(|row| camera.camera_from_own * row);
        let world_from_camera = self.camera_from_world.transpose();
        let [across, down] = camera.jacobian;
        let by_own = [0, 1, 2].map(|k| world_from_camera * (across * by_first[k] + down * by_second[k]));
        let scales = splats.scales()[index];
        gradients.by.scales[index] = [0, 1, 2].map(|k| camera.rotation.col(k).dot(by_own[k]));
        let by_rotation = [0, 1, 2].map(|k| by_own[k] * scales[k]);
        gradients.by.rotations[index] = rotation_gradient(splats.rotations()[index], by_rotation);

        let mut by_point = self.through_jacobian(&camera, by_jacobian);
        let scale = self.focal / camera.point.z;
        by_point += (scale * gradient.mean).extend(gradient.depth);
        by_point.z -= (scale * gradient.mean).dot(camera.point.truncate() / camera.point.z);
        let by_direction = through_shade(splats, gaussian, camera.offset, gradient.colour, gradients);
        gradients.by.means[index] = (world_from_camera * by_point + by_direction).to_array();
        gradients.by.opacities[index] = gradient.opacity;
        gradients.means_ndc[index] = (0.5 * gradient.mean * self.size).to_array();
        gradients.visible[index] = true;
    }

    /// The Jacobian holds f/z and -f s/z, s being the slope x/z or what clamps it.
    fn through_jacobian(&self, camera: &CameraSpace, by_jacobian: [DVec3; 2]) -> DVec3 {
        let mut by_point = DVec3::ZERO;
        for axis in 0..2 {
            let per_zz = self.focal[axis] / (camera.point.z * camera.point.z);
            let (straight, oblique) = (by_jacobian[axis][axis], by_jacobian[axis].z);
            let times = if camera.clamped[axis] { 1.0 } else { 2.0 };
            by_point.z += times * per_zz * camera.slope[axis] * oblique - per_zz * straight;
            if !camera.clamped[axis] {
                by_point[axis] -= per_zz * oblique;
            }
        }
        by_point
    }
}

/// Gradient by the spherical harmonics, stored, and by the offset from the camera, returned.
fn through_shade(
    splats: &Splats<f64>,
    gaussian: &ProjectedGaussian,
    offset: DVec3,
    by_colour: DVec3,
    gradients: &mut SplatGradients<f64>,
) -> DVec3 {
    let open: [f64; 3] =
        std::array::from_fn(|channel| if gaussian.clamped[channel] { 0.0 } else { by_colour[channel] });
    let degree = splats.sh_degree();
    let direction = offset.normalize();
    let values = sh::basis(degree, direction.to_array());
    let slopes = sh::basis_gradient(degree, direction.to_array());
    let count = degree.coefficients();
    let mut by_direction = DVec3::ZERO;
    for (k, &coefficient) in splats.sh_of(gaussian.index).iter().enumerate() {
        gradients.by.sh[gaussian.index * count + k] = open.map(|g| g * values[k]);
        by_direction += DVec3::from(slopes[k]) * DVec3::from(open).dot(coefficient.into());
    }
    (by_direction - direction * by_direction.dot(direction)) / offset.length()
}

/// Derivatives by the quaternion (w, x, y, z), given those by the columns of its rotation matrix.
fn rotation_gradient([w, x, y, z]: [f64; 4], g: [DVec3; 3]) -> [f64; 4] {
    let (xy, xz, yz) = (g[1].x + g[0].y, g[2].x + g[0].z, g[2].y + g[1].z);
    let turn = DVec3::new(g[1].z - g[2].y, g[2].x - g[0].z, g[0].y - g[1].x);
    [
        2.0 * DVec3::new(x, y, z).dot(turn),
        2.0 * (y * xy + z * xz + w * turn.x - 2.0 * x * (g[1].y + g[2].z)),
        2.0 * (x * xy + z * yz + w * turn.y - 2.0 * y * (g[0].x + g[2].z)),
        2.0 * (x * xz + y * yz + w * turn.z - 2.0 * z * (g[0].x + g[1].y)),
    ]
}

/// The coordinate that is farthest from 0.
fn largest(row: [f64; 3]) -> f64 {
    row.into_iter().fold(0.0, |most: f64, value| if value.abs() > most.abs() { value } else { most })
}

/// Colour of a Gaussian in the direction from the camera, before it is clamped below at 0.
fn sh_colour(splats: &Splats<f64>, index: usize, offset: DVec3) -> DVec3 {
    let values = sh::basis(splats.sh_degree(), offset.normalize().to_array());
    std::iter::zip(splats.sh_of(index), values)
        .fold(DVec3::splat(0.5), |sum, (&coefficient, value)| sum + DVec3::from(coefficient) * value)
}
