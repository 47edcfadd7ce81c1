//! How far away what the pictures of a moment show is: as it was measured, or found by comparing pictures.

use super::footage::Footage;
use super::stereo::{Look, depths};

/// A camera that is alone at a moment is compared with itself at so many others,
const OTHERS: usize = 4;
/// at which it stands elsewhere: at least this share of the extent of all cameras away.
const ELSEWHERE: f64 = 0.05;

/// Planar depth, metres, by camera, row-major; NaN where it is unknown, and +inf where nothing is hit or what is seen
/// is too far to tell. Empty for cameras that did not see the moment. What is not `wanted` may be unknown.
pub(super) fn depths_at(
    footage: &Footage,
    moment: usize,
    wanted: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<f32>> {
    let shots = footage.shots();
    if footage.has_depth() {
        let measured = |shot: &super::Shot| {
            shot.picture(moment).depth_m.iter().map(|depth_m| depth_m.to_f32()).collect()
        };
        return shots.iter().map(measured).collect();
    }
    let seeing: Vec<usize> = footage.seeing(moment).collect();
    let look = |shot: usize, moment: usize| Look {
        view: shots[shot].view(moment),
        colour: &shots[shot].picture(moment).colour,
    };
    let mut looks: Vec<Look<'_>> = seeing.iter().map(|&shot| look(shot, moment)).collect();
    if let [alone] = seeing[..] {
        looks.extend(elsewhere(footage, alone, moment).into_iter().map(|other| look(alone, other)));
    }
    let wanted: Vec<Vec<bool>> = seeing
        .iter()
        .map(|&shot| (0..footage.pixel_count()).map(|pixel| wanted(shot, pixel)).collect())
        .collect();
    let mut by_shot = vec![Vec::new(); shots.len()];
    for (shot, found) in seeing.into_iter().zip(depths(&looks, &wanted)) {
        by_shot[shot] = found;
    }
    by_shot
}

/// Moments nearest in time at which a camera stood elsewhere.
fn elsewhere(footage: &Footage, shot: usize, moment: usize) -> Vec<usize> {
    let away = ELSEWHERE * footage.extent_m();
    let shot = &footage.shots()[shot];
    let here = shot.view(moment).centre();
    let is_away = |other: &usize| {
        let there = shot.view(*other).centre();
        shot.saw(*other) && (0..3).map(|axis| (there[axis] - here[axis]).powi(2)).sum::<f64>() >= away * away
    };
    let mut others: Vec<usize> = (0..footage.moments()).filter(is_away).collect();
    others.sort_by_key(|&other| (other.abs_diff(moment), other));
    others.truncate(OTHERS);
    others
}

#[cfg(test)]
mod tests {
    use l4d_data::Timeline;

    use super::super::fake::{SIZE, World};
    use super::*;

    #[test]
    fn a_camera_that_moves_alone_is_compared_with_itself() {
        let world = World::EMPTY;
        let still = world.bare_footage(1);
        let mut camera = world.camera(0, 0.0);
        let pose = camera.world_from_camera[0];
        // Numbers of a timeline are places in the list of poses.
        camera.world_from_camera = (0..=96)
            .map(|frame| {
                let mut pose = pose;
                pose[3] = f64::from(frame) / 96.0 - 0.5;
                pose
            })
            .collect();
        let mut footage = Footage::new(SIZE, vec![0, 48, 96], Timeline::CANONICAL).unwrap();
        let pictures = still.shots().iter().map(|shot| shot.picture(0).clone()).collect();
        footage.add(&camera, SIZE, pictures).unwrap();
        let found = depths_at(&footage, 1, |_, _| true);
        let right = found[0].iter().filter(|depth_m| (**depth_m - 4.0).abs() < 0.3).count();
        assert!(right > footage.pixel_count() / 2, "{right}");
    }
}
