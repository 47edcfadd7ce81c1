//! Estimated tracks as the tracks of `l4d-query`, so that relations mean here what they mean there.

use std::f64::consts::PI;

use glam::{DMat3, DVec2, DVec3};
use l4d_data::timeline::{FRAME_COUNT, LAST_FRAME};
use l4d_data::tracks::{Pair, SCHEMA, Track as TrackedBoxes, TrackedInstance, Tracks};
use l4d_data::{Name, Role, Timeline};

use super::motion::{Kinematics, gap_m};
use super::perceive::{Glimpse, Perceived, Track};

/// Slower than this, lengths per second, something keeps the front that it had.
const HEADING_SPEED: f64 = 0.3;

/// Name of a track on the stage.
pub(super) fn name_of(track: usize) -> Option<Name> {
    Name::new(format!("t{track}")).ok()
}

/// Estimated tracks as those of a scene, with the distances of `subjects` to `others`. What has no front of its own is
/// taken to face the camera: "in front of the tree" is between tree and camera.
pub(super) fn stage(
    seen: &Perceived,
    moves: &[Kinematics],
    subjects: &[usize],
    others: &[usize],
) -> Option<Tracks> {
    let canonical: Vec<u32> = seen.frames.iter().map(|&frame| seen.timeline.canonical(frame)).collect();
    let index_of: Vec<usize> = (0..FRAME_COUNT).map(|frame| nearest_index(&canonical, frame)).collect();
    let mut all: Vec<usize> = subjects.iter().chain(others).copied().collect();
    all.sort_unstable();
    all.dedup();
    let instances = all.iter().filter_map(|&track| {
        Some(TrackedInstance {
            id: track as u32 + 1,
            name: name_of(track)?,
            role: Role::Object,
            category: "thing".to_owned(),
            attributes: Default::default(),
            front: Some("-y".to_owned()),
            track: boxes(seen.tracks.get(track)?, moves.get(track)?, &index_of, seen.eye)?,
        })
    });
    let instances = instances.collect();
    let mut pairs = Vec::new();
    for &subject in subjects {
        for &other in others.iter().filter(|&&other| other != subject) {
            if others.contains(&subject) && subjects.contains(&other) && other < subject {
                continue;
            }
            let (a, b) = (seen.tracks.get(subject)?, seen.tracks.get(other)?);
            pairs.push(Pair {
                a: name_of(subject)?,
                b: name_of(other)?,
                distance_m: distances(a, b, &index_of, seen.spacing_m),
                contact: Vec::new(),
            });
        }
    }
    Some(Tracks {
        schema: SCHEMA.to_owned(),
        scene: Name::new("clip").ok()?,
        scale: seen.scale,
        variant: 0,
        seed: 0,
        fps: canonical_fps(seen.timeline),
        frame_count: FRAME_COUNT,
        exposure: 1.0,
        description: String::new(),
        instances,
        events: Vec::new(),
        pair_reach_m: 0.0,
        pairs,
        cameras: Vec::new(),
    })
}

/// Canonical frames per second, if the clip had as many of them as any other.
fn canonical_fps(timeline: Timeline) -> f64 {
    let duration_s = timeline.duration_s();
    if duration_s > 0.0 { f64::from(LAST_FRAME) / duration_s } else { timeline.frames_per_second() }
}

/// Index of the frame of the clip that is nearest to a canonical one.
fn nearest_index(frames: &[u32], frame: u32) -> usize {
    let distance = |index: &usize| frames[*index].abs_diff(frame);
    (0..frames.len()).min_by_key(distance).unwrap_or(0)
}

fn boxes(track: &Track, moves: &Kinematics, index_of: &[usize], eye: DVec3) -> Option<TrackedBoxes> {
    let mut front = None;
    let fronts: Vec<Option<DVec2>> = moves
        .velocity
        .iter()
        .map(|velocity| {
            if velocity.truncate().length() > HEADING_SPEED * moves.size_m {
                front = velocity.truncate().try_normalize();
            }
            front
        })
        .collect();
    let first = fronts.iter().flatten().next().copied();
    let mut boxes = TrackedBoxes { centre: Vec::new(), axes: Vec::new(), extents: Vec::new() };
    for &index in index_of {
        let glimpse = track.nearest(index)?;
        let to_eye = (eye - glimpse.centre).truncate().normalize_or(DVec2::NEG_Y);
        let front = fronts.get(index).copied().flatten().or(first).unwrap_or(to_eye);
        let (world_from_box, centre, extents) = boxed(glimpse, front);
        boxes.centre.push(centre.to_array());
        boxes.axes.push(world_from_box.transpose().to_cols_array());
        boxes.extents.push(extents.to_array());
    }
    Some(boxes)
}

/// A box around a glimpse whose -y axis points to the front.
fn boxed(glimpse: &Glimpse, front: DVec2) -> (DMat3, DVec3, DVec3) {
    let turn = front.y.atan2(front.x) + PI / 2.0;
    let world_from_box = DMat3::from_rotation_z(turn);
    let local = |point: &DVec3| world_from_box.transpose() * (*point - glimpse.centre);
    let low = glimpse.points.iter().map(local).fold(DVec3::INFINITY, DVec3::min);
    let high = glimpse.points.iter().map(local).fold(DVec3::NEG_INFINITY, DVec3::max);
    let (mut low, mut high) = if low.is_finite() { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) };
    low.z = glimpse.low.z - glimpse.centre.z;
    high.z = glimpse.high.z - glimpse.centre.z;
    let centre = glimpse.centre + world_from_box * ((low + high) * 0.5);
    (world_from_box, centre, (high - low).max(DVec3::splat(1e-4)))
}

/// Distances at canonical frames; what is nearer than pixels can tell counts as touching.
fn distances(a: &Track, b: &Track, index_of: &[usize], spacing_m: f64) -> Vec<f64> {
    let mut last = None;
    let distance = |&index: &usize| {
        if let Some((at, distance)) = last
            && at == index
        {
            return distance;
        }
        let gap = a.nearest(index).zip(b.nearest(index)).map_or(f64::MAX, |(a, b)| gap_m(a, b));
        // Points are samples: neighbours in contact are some pixels apart.
        let size_m =
            a.nearest(index).zip(b.nearest(index)).map_or(0.0, |(a, b)| a.longest_m().min(b.longest_m()));
        let distance = (gap - 2.0 * spacing_m - 0.2 * size_m).max(0.0);
        last = Some((index, distance));
        distance
    };
    index_of.iter().map(distance).collect()
}
