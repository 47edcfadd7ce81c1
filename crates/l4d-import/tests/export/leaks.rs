//! The held-out camera never leaks: an export that must not show its pictures does not even read them.

use l4d_import::export::{Format, HeldOut};

use strum::IntoEnumIterator as _;

use crate::support::{TEST_VIEW, World, files};
use crate::{Kind, export_frames, exported_as, shown};

/// Every kind of scene in every layout.
fn all() -> impl Iterator<Item = (Kind, Format)> {
    Kind::ALL.into_iter().flat_map(|kind| Format::iter().map(move |format| (kind, format)))
}

#[test]
fn without_the_held_out_pictures_on_disk_every_export_is_the_same() {
    for (kind, format) in all() {
        for held_out in [HeldOut::Nothing, HeldOut::Pose] {
            let whole = World::new();
            export_frames(kind, &whole, format, held_out, &whole.out("out"), &[0, 96]).unwrap();
            let blind = World::new();
            std::fs::remove_dir_all(blind.capture_dir().root().join("frames").join(TEST_VIEW)).unwrap();
            std::fs::remove_dir_all(blind.dir().view(TEST_VIEW)).unwrap();
            export_frames(kind, &blind, format, held_out, &blind.out("out"), &[0, 96]).unwrap();
            assert!(
                files(&whole.out("out")) == files(&blind.out("out")),
                "{format} looked at {TEST_VIEW}, {kind:?}"
            );
        }
    }
}

#[test]
fn nothing_says_not_even_where_it_stands() {
    let world = World::new();
    let pose = world.scene.test_camera().unwrap();
    // Its place, as any of the formats would write it: in the world, or as the world seen from there.
    let from_world = pose.camera_from_world(0);
    let numbers = [pose.world_from_camera(0).w_axis.x, from_world.w_axis.x, from_world.w_axis.y];
    let holds = |kind: Kind, format: Format, held_out: HeldOut| {
        let out = world.out(&format!("{kind:?}-{held_out:?}-{format}"));
        export_frames(kind, &world, format, held_out, &out, &[0]).unwrap();
        let digits = numbers.map(|number| format!("{:.15}", number.abs())[..11].to_owned());
        let bits = numbers.map(f64::to_le_bytes);
        files(&out).into_iter().any(|(_, bytes)| {
            let text = String::from_utf8_lossy(&bytes);
            digits.iter().any(|digits| text.contains(digits.as_str()))
                || bytes.windows(8).any(|window| bits.iter().any(|bits| window == bits))
        })
    };
    for (kind, format) in all() {
        assert!(!holds(kind, format, HeldOut::Nothing), "{format} says where {TEST_VIEW} stands");
        let is_annotation = matches!(format, Format::Coco | Format::Davis) || format.needs_truth();
        assert_eq!(holds(kind, format, HeldOut::Pose), !is_annotation, "{format}: the search itself");
    }
}

#[test]
fn pictures_are_shown_only_in_test_splits() {
    let world = World::new();
    let first = l4d_frames::drawn::encode_colour(&shown(&world, TEST_VIEW, 0));
    let formats = [Format::FourDGaussians, Format::Dynerf, Format::Colmap];
    for (kind, format) in all().filter(|(_, format)| formats.contains(format)) {
        let out = world.out(&format!("{kind:?}-{format}"));
        exported_as(kind, &world, format, HeldOut::Pictures, &out);
        let holders: Vec<String> =
            files(&out).into_iter().filter(|(_, bytes)| *bytes == first).map(|(name, _)| name).collect();
        let expected: &[&str] = match format {
            Format::FourDGaussians => &["ims/4/000000.png"],
            Format::Dynerf => &["cam00/images/0000.png"],
            _ => &["frame_0000/held_out/cam02.png"],
        };
        assert_eq!(holders, expected, "{format}");
    }
}
