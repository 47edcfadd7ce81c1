//! What the held-out view sees, as far as boxes tell: no occlusion, no shape. For shortcuts that count pixels, before
//! there are pictures.

use std::collections::BTreeMap;

use glam::{DMat3, DVec2, DVec3};
use l4d_data::scene::Role;
use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::{Track, TrackedInstance, Tracks, at_frame};
use l4d_data::truth::{SCHEMA, Truth};
use l4d_data::{Camera, Name, Profile, Split};

/// The profile whose pixels are counted.
const PROFILE: Profile = Profile::Small;
/// Every fourth frame tells as much.
const STRIDE: usize = 4;

/// Counts of pixels in the held-out view, without masks; none of tracks without such a view.
pub(crate) fn seen(tracks: &Tracks) -> Option<Truth> {
    let size = [PROFILE.width(), PROFILE.height()];
    let camera = tracks.cameras.iter().find(|camera| camera.split == Split::Test)?.camera(size);
    let frames: Vec<u32> = (0..FRAME_COUNT).step_by(STRIDE).collect();
    let objects = tracks.instances.iter().filter(|instance| instance.role == Role::Object);
    let count = |object: &TrackedInstance| -> (Name, Vec<u32>) {
        let counts = frames.iter().map(|&frame| pixels(&camera, &object.track, frame, size));
        (object.name.clone(), counts.collect())
    };
    let counts: BTreeMap<Name, Vec<u32>> = objects.map(count).collect();
    Some(Truth {
        schema: SCHEMA.to_owned(),
        scene: tracks.scene.clone(),
        scale: tracks.scale,
        variant: tracks.variant,
        profile: PROFILE,
        width: size[0],
        height: size[1],
        test_view: camera.name.clone(),
        frames,
        unannotated: Vec::new(),
        instances: Vec::new(),
        visible: BTreeMap::from([(camera.name, counts)]),
    })
}

/// Whether the held-out view has the object in the picture at any time.
pub(crate) fn shows(seen: &Truth, object: &Name) -> bool {
    let counts = seen.visible.get(&seen.test_view).and_then(|counts| counts.get(object));
    counts.is_some_and(|counts| counts.iter().any(|&count| count > 0))
}

/// Pixels of the rectangle around the corners of the box, inside the picture.
fn pixels(camera: &Camera, track: &Track, frame: u32, size: [u32; 2]) -> u32 {
    let corners = corners(track, frame).map(|corner| camera.project(frame, corner));
    let ahead: Vec<DVec2> = corners.into_iter().filter(|(_, depth)| *depth > 0.0).map(|(at, _)| at).collect();
    let Some(&first) = ahead.first() else { return 0 };
    let (low, high) = ahead.iter().fold((first, first), |(low, high), at| (low.min(*at), high.max(*at)));
    let whole = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    let side = high.clamp(DVec2::ZERO, whole) - low.clamp(DVec2::ZERO, whole);
    (side.x * side.y).round() as u32
}

fn corners(track: &Track, frame: u32) -> [DVec3; 8] {
    let centre = DVec3::from_array(*at_frame(&track.centre, frame));
    let world_from_box = DMat3::from_cols_array(at_frame(&track.axes, frame)).transpose();
    let half = DVec3::from_array(*at_frame(&track.extents, frame)) / 2.0;
    std::array::from_fn(|corner| {
        let sign = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        centre + world_from_box * (half * DVec3::new(sign(0), sign(1), sign(2)))
    })
}
