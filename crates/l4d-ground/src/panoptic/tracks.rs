//! Estimated tracks as the tracks of `l4d-query`, so that relations mean here what they mean there.

use std::f64::consts::PI;

use glam::{DMat3, DVec2, DVec3};
use l4d_data::timeline::{FRAME_COUNT, LAST_FRAME};
use l4d_data::tracks::{Pair, SCHEMA, Track as TrackedBoxes, TrackedInstance, Tracks};
use l4d_data::{Name, Role, Timeline};

use super::motion::{Kinematics, gap_m};
use super::perceive::{Body, Perceived, Track};

/// Slower than this, lengths per second, something keeps the front that it had.
const HEADING_SPEED: f64 = 0.3;
/// Points are samples: neighbours in contact are this many times their spacing apart,
const TOUCH_SPACINGS: f64 = 2.0;
/// and this share of the smaller one's longest side.
const TOUCH_SHARE: f64 = 0.2;

/// Name of a track among those of a scene.
pub(super) fn name_of(track: usize) -> Option<Name> {
    Name::new(format!("t{track}")).ok()
}

/// Estimated tracks as those of a scene, with all distances. What has no front of its own is taken to face the camera:
/// "in front of the tree" is between tree and camera.
pub(super) fn tracks_of(seen: &Perceived) -> Option<Tracks> {
    let places = Place::of_all(seen);
    let instances = seen.placed().filter_map(|(number, track)| {
        Some(TrackedInstance {
            id: number as u32 + 1,
            name: name_of(number)?,
            role: Role::Object,
            category: "thing".to_owned(),
            attributes: Default::default(),
            front: Some("-y".to_owned()),
            track: boxes(track, &Kinematics::new(track, seen), &places, seen.eye)?,
        })
    });
    let instances = instances.collect();
    let mut pairs = Vec::new();
    for (first, a) in seen.placed() {
        for (second, b) in seen.placed().filter(|(second, _)| *second > first) {
            pairs.push(Pair {
                a: name_of(first)?,
                b: name_of(second)?,
                distance_m: distances(a, b, &places, seen.spacing_m),
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

/// Where a canonical frame lies among the frames of a clip.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Index of the last frame of the clip up to it.
    before: usize,
    /// Index of the next one.
    after: usize,
    /// How far it is from the former to the latter.
    share: f64,
}

impl Place {
    fn of_all(seen: &Perceived) -> Vec<Self> {
        let frames: Vec<u32> = seen.frames.iter().map(|&frame| seen.timeline.canonical(frame)).collect();
        let place = |frame: u32| {
            let after = frames.partition_point(|at| *at < frame).min(frames.len().saturating_sub(1));
            let before =
                if frames.get(after).is_some_and(|at| *at > frame) { after.saturating_sub(1) } else { after };
            let span = frames.get(after).zip(frames.get(before)).map_or(0, |(after, before)| after - before);
            let past = frames.get(before).map_or(0, |before| frame.saturating_sub(*before));
            Self { before, after, share: if span > 0 { f64::from(past) / f64::from(span) } else { 0.0 } }
        };
        (0..FRAME_COUNT).map(place).collect()
    }

    fn between<T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>(
        self,
        before: T,
        after: T,
    ) -> T {
        before * (1.0 - self.share) + after * self.share
    }
}

fn boxes(track: &Track, moves: &Kinematics, places: &[Place], eye: DVec3) -> Option<TrackedBoxes> {
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
    let boxed_at = |index: usize| {
        let body = track.nearest(index)?;
        let to_eye = (eye - body.centre).truncate().normalize_or(DVec2::NEG_Y);
        Some(boxed(body, fronts.get(index).copied().flatten().or(first).unwrap_or(to_eye)))
    };
    let at_frames: Vec<_> = (0..moves.velocity.len()).map(boxed_at).collect::<Option<_>>()?;
    let mut boxes = TrackedBoxes { centre: Vec::new(), axes: Vec::new(), extents: Vec::new() };
    for place in places {
        let [before, after] = [at_frames.get(place.before)?, at_frames.get(place.after)?];
        let nearest = if place.share < 0.5 { before } else { after };
        boxes.centre.push(place.between(before.1, after.1).to_array());
        boxes.axes.push(nearest.0.transpose().to_cols_array());
        boxes.extents.push(place.between(before.2, after.2).to_array());
    }
    Some(boxes)
}

/// A box around a thing whose -y axis points to the front: axes, centre, extents.
fn boxed(body: &Body, front: DVec2) -> (DMat3, DVec3, DVec3) {
    let turn = front.y.atan2(front.x) + PI / 2.0;
    let world_from_box = DMat3::from_rotation_z(turn);
    let local = |point: &DVec3| world_from_box.transpose() * (*point - body.centre);
    let low = body.points.iter().map(local).fold(DVec3::INFINITY, DVec3::min);
    let high = body.points.iter().map(local).fold(DVec3::NEG_INFINITY, DVec3::max);
    let (mut low, mut high) = if low.is_finite() { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) };
    low.z = body.low.z - body.centre.z;
    high.z = body.high.z - body.centre.z;
    let centre = body.centre + world_from_box * ((low + high) * 0.5);
    (world_from_box, centre, (high - low).max(DVec3::splat(1e-4)))
}

/// Distances at canonical frames; what is nearer than samples can tell counts as touching.
fn distances(a: &Track, b: &Track, places: &[Place], spacing_m: f64) -> Vec<f64> {
    let distance = |index: usize| {
        let (Some(a), Some(b)) = (a.nearest(index), b.nearest(index)) else { return f64::MAX };
        let size_m = a.longest_m().min(b.longest_m());
        (gap_m(a, b) - TOUCH_SPACINGS * spacing_m - TOUCH_SHARE * size_m).max(0.0)
    };
    let at_frames: Vec<f64> = (0..a.bodies.len()).map(distance).collect();
    let at = |index: usize| at_frames.get(index).copied().unwrap_or(f64::MAX);
    places.iter().map(|place| place.between(at(place.before), at(place.after))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_view_places_is_neither_an_instance_nor_of_a_pair() {
        let cube = |x: f64| {
            let corners =
                (0..8).map(|n| DVec3::new(x + f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2)));
            Track { bodies: vec![Body::of(&corners.collect::<Vec<_>>(), true); 2] }
        };
        let seen = Perceived {
            frames: vec![0, 96],
            timeline: Timeline::CANONICAL,
            tracks: vec![cube(0.0), Track { bodies: vec![None, None] }, cube(4.0)],
            scale: l4d_data::Scale::Room,
            spacing_m: 0.01,
            eye: DVec3::NEG_Y * 5.0,
        };
        let tracks = tracks_of(&seen).unwrap();
        let names: Vec<&str> = tracks.instances.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["t0", "t2"]);
        assert_eq!(tracks.pairs.len(), 1);
        assert_eq!((tracks.pairs[0].a.as_str(), tracks.pairs[0].b.as_str()), ("t0", "t2"));
    }
}
