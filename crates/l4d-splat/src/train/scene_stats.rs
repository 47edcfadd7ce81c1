//! Facts about views and Gaussians that training is planned by.

use glam::DVec3;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::deform::Bounds;
use crate::gaussians::Gaussians;

use super::TrainError;
use super::motion::Motion;
use super::views::TrainingViews;

/// The moment at which most pixels show something that moves; the nearest to the middle of equals.
pub(super) fn busiest(views: &TrainingViews, motion: &Motion) -> usize {
    let moments = views.moments();
    let busy = |moment: usize| -> usize {
        views
            .cameras_at(moment)
            .map(|camera| {
                (0..views.pixel_count()).filter(|&pixel| motion.moves(views, camera, moment, pixel)).count()
            })
            .sum()
    };
    let middle = moments / 2;
    (0..moments)
        .max_by_key(|&moment| (busy(moment), usize::MAX - moment.abs_diff(middle)))
        .unwrap_or_default()
}

/// Median depth of the pictures of the middle moment, metres.
pub(super) fn typical_depth_m(views: &TrainingViews) -> f32 {
    let moment = views.moments() / 2;
    let mut depths: Vec<f32> = views
        .cameras()
        .iter()
        .flat_map(|camera| camera.picture(moment).depth_m.iter().step_by(7).map(|depth_m| depth_m.to_f32()))
        .filter(|depth_m| depth_m.is_finite())
        .collect();
    let middle = depths.len() / 2;
    if depths.is_empty() { 1.0 } else { *depths.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

/// A box around almost all of the Gaussians that move: a few far ones would take its resolution away.
pub(super) fn bounds(gaussians: &Gaussians, dynamic: &[u32]) -> Result<Bounds, TrainError> {
    let sides: [[f32; 2]; 3] = std::array::from_fn(|axis| {
        let mut along: Vec<f32> = dynamic.iter().map(|&row| gaussians.means[row as usize][axis]).collect();
        along.sort_by(f32::total_cmp);
        let last = along.len().saturating_sub(1);
        let (low, high) = (along[last / 200], along[last - last / 200]);
        let margin = (0.1 * (high - low)).max(0.05);
        [high + margin, low - margin]
    });
    let corners = [0, 1].map(|corner| sides.map(|side| side[corner]));
    Ok(Bounds::new(corners)?)
}

/// So many of `from`, or all, in random order.
pub(super) fn sample(from: &[usize], count: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let mut left = from.to_vec();
    (0..count.min(from.len())).map(|_| left.swap_remove(random.random_range(0..left.len()))).collect()
}

pub(super) fn nearest_m(mean: &[f32; 3], cameras: &[[f64; 3]]) -> f32 {
    cameras
        .iter()
        .map(|&centre| DVec3::from(mean.map(f64::from)).distance_squared(centre.into()))
        .fold(f64::INFINITY, f64::min)
        .sqrt() as f32
}
