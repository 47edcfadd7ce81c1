//! Backward over Gaussians: from sums over pixels to the gradient of the splats, in f64.

use rayon::prelude::*;

use super::ProjectedScene;
use super::backward::{GRADIENT_SUMS, GradientSums};
use super::projection::{
    HALF_LOG2_E, Linearization, PER_EXPONENT, Projection, Splat2d, direction, dot, sh_colour,
};
use crate::raster::sh;
use crate::splats::{SplatGradients, Splats};

/// Gaussians handled by one task.
const CHUNK: usize = 256;
/// Place of a Gaussian that isn't visible.
const HIDDEN: u32 = u32::MAX;

/// The gradient of all splats, given the sums of the visible ones.
pub(super) fn splat_gradients(scene: &ProjectedScene<'_>, sums: &[GradientSums]) -> SplatGradients {
    let splats = scene.splats;
    let mut places = vec![HIDDEN; splats.len()];
    for (place, splat2d) in scene.splats2d.iter().enumerate() {
        places[splat2d.index as usize] = place as u32;
    }
    let mut gradients = SplatGradients::zeros(splats);
    (
        &mut gradients.by.means,
        &mut gradients.by.scales,
        &mut gradients.by.rotations,
        &mut gradients.by.opacities,
        gradients.by.sh.par_chunks_mut(splats.sh_degree().coefficients()),
        &mut gradients.means_ndc,
        &mut gradients.visible,
        &places,
    )
        .into_par_iter()
        .with_min_len(CHUNK)
        .for_each(|(mean, scale, rotation, opacity, sh, mean_ndc, visible, &place)| {
            if place == HIDDEN {
                return;
            }
            *visible = true;
            // Hidden behind others.
            if sums[place as usize] == [0.0; GRADIENT_SUMS] {
                return;
            }
            let splat2d = &scene.splats2d[place as usize];
            let linear = scene.projection.linearize(splats, splat2d.index as usize);
            let geometry = through_projection_and_covariance(
                &scene.projection,
                splats,
                splat2d,
                &linear,
                &sums[place as usize],
            );
            let by_direction = through_colour(splats, splat2d, &linear, &sums[place as usize], sh);
            *mean = std::array::from_fn(|axis| (geometry.mean[axis] + by_direction[axis]) as f32);
            *scale = geometry.scale.map(|value| value as f32);
            *rotation = geometry.rotation.map(|value| value as f32);
            *opacity = geometry.opacity as f32;
            *mean_ndc = geometry.mean_ndc.map(|value| value as f32);
        });
    gradients
}

struct GeometryGradient {
    mean: [f64; 3],
    scale: [f64; 3],
    rotation: [f64; 4],
    opacity: f64,
    mean_ndc: [f64; 2],
}

fn through_projection_and_covariance(
    projection: &Projection,
    splats: &Splats,
    splat2d: &Splat2d,
    linear: &Linearization,
    sums: &GradientSums,
) -> GeometryGradient {
    let &[_, _, _, by_depth, by_log_alpha, along, across, uu, uv, vv] = sums;
    let axes = splat2d.axes();
    let [xx, xy, yy] = axes.conic_factor;
    let index = splat2d.index as usize;

    // The exponent -(u^2 + v^2) by the centre, (u, v) being the whitened offset of the pixel from it.
    let by_mean =
        axes.order([2.0 * PER_EXPONENT * xx * along, 2.0 * PER_EXPONENT * (xy * along + yy * across)]);
    // S = P P^T + blur, P = T R diag(s), T from world axes to the picture. With S^-1 = L^T L / HALF_LOG2_E the exponent
    // changes with P by 2 / HALF_LOG2_E L^T p p^T L P, p = (u, v), summed over pixels.
    let [whitened_u, whitened_v] = projection.whitened(&axes, linear);
    let factor = 2.0 * PER_EXPONENT / HALF_LOG2_E;
    let mut by_picture = [[0.0; 3]; 2];
    for k in 0..3 {
        let by_u = factor * (uu * whitened_u[k] + uv * whitened_v[k]);
        let by_v = factor * (uv * whitened_u[k] + vv * whitened_v[k]);
        by_picture[0][k] = xx * by_u;
        by_picture[1][k] = xy * by_u + yy * by_v;
    }
    let by_picture = axes.order(by_picture);
    let scales = splats.scales()[index].map(f64::from);
    let (world, turned) = (&linear.picture_from_world, &linear.rotation);
    let mut by_rotation = [[0.0; 3]; 3];
    let mut scale = [0.0; 3];
    for k in 0..3 {
        for axis in 0..3 {
            let by_own = world[0][axis] * by_picture[0][k] + world[1][axis] * by_picture[1][k];
            scale[k] += turned[axis][k] * by_own;
            by_rotation[axis][k] = by_own * scales[k];
        }
    }
    let by_world: [[f64; 3]; 2] = by_picture.map(|row| {
        let scaled: [f64; 3] = std::array::from_fn(|k| row[k] * scales[k]);
        turned.map(|axis| dot(axis, scaled))
    });

    let by_point = through_projection(projection, linear, by_mean, by_world, by_depth);
    GeometryGradient {
        mean: std::array::from_fn(|axis| {
            dot(
                [projection.rotation[0][axis], projection.rotation[1][axis], projection.rotation[2][axis]],
                by_point,
            )
        }),
        scale,
        rotation: by_quaternion(splats.rotations()[index].map(f64::from), by_rotation),
        opacity: by_log_alpha / f64::from(splats.opacities()[index]),
        mean_ndc: std::array::from_fn(|axis| 0.5 * projection.size[axis] * by_mean[axis]),
    }
}

/// By the point in camera axes. Row a of T is f_a / z (w_a - s_a w_z): w the camera's axes, s_a the slope along a.
fn through_projection(
    projection: &Projection,
    linear: &Linearization,
    by_mean: [f64; 2],
    by_world: [[f64; 3]; 2],
    by_depth: f64,
) -> [f64; 3] {
    let z = linear.point[2];
    let ahead = projection.rotation[2];
    let mut by_point = [0.0, 0.0, by_depth];
    for axis in 0..2 {
        let scale = projection.focal[axis] / z;
        by_point[axis] += scale * by_mean[axis];
        by_point[2] -= scale * linear.point[axis] / z * by_mean[axis];
        by_point[2] -= dot(by_world[axis], linear.picture_from_world[axis]) / z;
        if !projection.is_clamped(linear, axis) {
            let by_slope = -scale * dot(by_world[axis], ahead);
            by_point[axis] += by_slope / z;
            by_point[2] -= by_slope * linear.slope[axis] / z;
        }
    }
    by_point
}

/// By the quaternion, given the derivatives by the entries of its rotation matrix.
fn by_quaternion([w, x, y, z]: [f64; 4], g: [[f64; 3]; 3]) -> [f64; 4] {
    [
        2.0 * (x * (g[2][1] - g[1][2]) + y * (g[0][2] - g[2][0]) + z * (g[1][0] - g[0][1])),
        2.0 * (w * (g[2][1] - g[1][2]) + y * (g[0][1] + g[1][0]) + z * (g[0][2] + g[2][0])
            - 2.0 * x * (g[1][1] + g[2][2])),
        2.0 * (w * (g[0][2] - g[2][0]) + x * (g[0][1] + g[1][0]) + z * (g[1][2] + g[2][1])
            - 2.0 * y * (g[0][0] + g[2][2])),
        2.0 * (w * (g[1][0] - g[0][1]) + x * (g[0][2] + g[2][0]) + y * (g[1][2] + g[2][1])
            - 2.0 * z * (g[0][0] + g[1][1])),
    ]
}

/// Writes the gradient of the spherical harmonics; returns that by the offset from the camera.
fn through_colour(
    splats: &Splats,
    splat2d: &Splat2d,
    linear: &Linearization,
    sums: &GradientSums,
    by_sh: &mut [[f32; 3]],
) -> [f64; 3] {
    let index = splat2d.index as usize;
    let raw = sh_colour(splats, index, linear.offset);
    let by_colour: [f32; 3] =
        std::array::from_fn(|channel| if raw[channel] < 0.0 { 0.0 } else { sums[channel] as f32 });
    let degree = splats.sh_degree();
    let (direction, length) = direction(linear.offset);
    let values = sh::basis(degree, direction);
    for (gradient, value) in by_sh.iter_mut().zip(values) {
        *gradient = by_colour.map(|by_colour| by_colour * value);
    }
    if degree.get() == 0 {
        return [0.0; 3];
    }
    let slopes = sh::basis_gradient(degree, direction);
    let mut by_direction = [0.0_f64; 3];
    for (coefficient, slope) in splats.sh_of(index).iter().zip(slopes) {
        let along: f64 =
            std::iter::zip(coefficient, by_colour).map(|(&a, b)| f64::from(a) * f64::from(b)).sum();
        for (sum, slope) in by_direction.iter_mut().zip(slope) {
            *sum += f64::from(slope) * along;
        }
    }
    let direction = direction.map(f64::from);
    let radial = dot(by_direction, direction);
    std::array::from_fn(|axis| (by_direction[axis] - direction[axis] * radial) / length)
}
