//! How far away what the pictures of a moment show is: as it was measured, or found by comparing pictures.

use glam::DVec3;

use super::stereo::{StereoImage, depths};
use super::views::TrainingViews;

/// A camera that is alone at a moment is compared with itself at so many others,
const OTHERS: usize = 4;
/// at which it is elsewhere: at least this share of the extent of all cameras away.
const ELSEWHERE: f64 = 0.05;

/// Planar depth, metres, by camera, row-major; NaN where it is unknown, and +inf where nothing is hit or what is seen
/// is too far to tell. Empty for cameras that did not see the moment. What is not `wanted` may be unknown.
pub(super) fn depths_at(
    views: &TrainingViews,
    moment: usize,
    wanted: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<f32>> {
    let cameras = views.cameras();
    if views.has_depth() {
        let measured = |camera: &super::views::TrainingCamera| {
            camera.picture(moment).depth_m.iter().map(|depth_m| depth_m.to_f32()).collect()
        };
        return cameras.iter().map(measured).collect();
    }
    let present: Vec<usize> = views.cameras_at(moment).collect();
    let image = |camera: usize, moment: usize| StereoImage {
        view: cameras[camera].view(moment),
        colour: &cameras[camera].picture(moment).colour,
    };
    let mut images: Vec<StereoImage<'_>> = present.iter().map(|&camera| image(camera, moment)).collect();
    if let [alone] = present[..] {
        images.extend(elsewhere(views, alone, moment).into_iter().map(|other| image(alone, other)));
    }
    let wanted: Vec<Vec<bool>> = present
        .iter()
        .map(|&camera| (0..views.pixel_count()).map(|pixel| wanted(camera, pixel)).collect())
        .collect();
    let mut by_camera = vec![Vec::new(); cameras.len()];
    for (camera, found) in present.into_iter().zip(depths(&images, &wanted)) {
        by_camera[camera] = found;
    }
    by_camera
}

/// Moments nearest in time at which a camera was elsewhere.
fn elsewhere(views: &TrainingViews, camera: usize, moment: usize) -> Vec<usize> {
    let away = ELSEWHERE * views.extent_m();
    let camera = &views.cameras()[camera];
    let here = DVec3::from(camera.view(moment).centre());
    let is_away = |other: &usize| {
        let there = DVec3::from(camera.view(*other).centre());
        camera.has_picture(*other) && there.distance_squared(here) >= away * away
    };
    let mut others: Vec<usize> = (0..views.moments()).filter(is_away).collect();
    others.sort_by_key(|&other| (other.abs_diff(moment), other));
    others.truncate(OTHERS);
    others
}

#[cfg(test)]
mod tests {
    use l4d_data::Timeline;

    use super::super::test_world::{SIZE, World, camera};
    use super::*;

    #[test]
    fn a_camera_that_moves_alone_is_compared_with_itself() {
        let world = World::EMPTY;
        let still = world.views_without_depth(1);
        let mut camera = camera(0, 0.0);
        let pose = camera.world_from_camera[0];
        // Numbers of a timeline are places in the list of poses.
        camera.world_from_camera = (0..=96)
            .map(|frame| {
                let mut pose = pose;
                pose[3] = f64::from(frame) / 96.0 - 0.5;
                pose
            })
            .collect();
        let mut views = TrainingViews::new(SIZE, vec![0, 48, 96], Timeline::CANONICAL).unwrap();
        let pictures = still.cameras().iter().map(|camera| camera.picture(0).clone()).collect();
        views.add(&camera, SIZE, pictures).unwrap();
        let found = depths_at(&views, 1, |_, _| true);
        let right = found[0].iter().filter(|depth_m| (**depth_m - 4.0).abs() < 0.3).count();
        assert!(right > views.pixel_count() / 2, "{right}");
    }
}
