//! Whose folder it is, what is left when an export is cut off, and which orders are refused.

use l4d_data::reader::EXPORT_CARD;
use l4d_import::export::{ExportRequest, Format, HeldOut, Manifest, Origin, export};

use strum::IntoEnumIterator as _;

use crate::support::{World, files};
use crate::{exported, json, try_export};

#[test]
fn an_export_that_was_cut_off_ends_with_the_same_bytes() {
    let world = World::new();
    let (whole, cut) = (world.out("whole"), world.out("cut"));
    exported(&world, Format::Colmap, HeldOut::Pose, &whole);
    exported(&world, Format::Colmap, HeldOut::Pose, &cut);
    // As a kill leaves it: some files missing, one of another content, the manifest unfinished.
    std::fs::remove_dir_all(cut.join("frame_0048")).unwrap();
    std::fs::write(cut.join("frame_0000/sparse/0/images.bin"), b"cut").unwrap();
    let path = cut.join(EXPORT_CARD);
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("\"complete\": true", "\"complete\": false")).unwrap();
    exported(&world, Format::Colmap, HeldOut::Pose, &cut);
    assert!(files(&whole) == files(&cut));
}

#[test]
fn folders_of_others_are_left_alone() {
    let world = World::new();
    let out = world.out("mine");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("thesis.tex"), b"years").unwrap();
    let error = try_export(&world, Format::FourDGaussians, HeldOut::Pose, &out).unwrap_err();
    assert!(error.to_string().contains("is not empty: `thesis.tex`"), "{error}");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1);

    let out = world.out("ours");
    exported(&world, Format::FourDGaussians, HeldOut::Pose, &out);
    let error = try_export(&world, Format::Coco, HeldOut::Pose, &out).unwrap_err();
    assert!(error.to_string().contains("holds closed_form as 4dgaussians"), "{error}");
    let error = try_export(&world, Format::FourDGaussians, HeldOut::Pictures, &out).unwrap_err();
    assert!(error.to_string().contains("another split"), "{error}");
}

#[test]
fn the_manifest_says_what_is_what() {
    let world = World::new();
    let out = world.out("manifest");
    exported(&world, Format::Dynerf, HeldOut::Pose, &out);
    let manifest: Manifest = serde_json::from_value(json(&out.join(EXPORT_CARD))).unwrap();
    assert!(manifest.complete);
    assert_eq!((manifest.scene.as_str(), manifest.format.as_str()), ("closed_form", "4dgaussians-dynerf"));
    assert_eq!(manifest.frames, world.frames());
    assert_eq!((manifest.cameras[0].called.as_str(), manifest.cameras[0].held_out), ("cam00", true));
    assert_eq!((manifest.cameras[1].name.as_str(), manifest.cameras[1].called.as_str()), ("cam00", "cam01"));
    assert!(manifest.notes.iter().any(|note| note.contains("grey pictures")));
    // What a model of it shows: the reader counts moments by 300 and draws as the run says.
    let trained = manifest.trained.unwrap();
    let times: Vec<f32> = (0..world.frames().len()).map(|moment| (moment as f64 / 300.0) as f32).collect();
    assert_eq!((trained.times, trained.sh_degree, trained.background), (times, None, None));

    let out = world.out("panoptic");
    exported(&world, Format::FourDGaussians, HeldOut::Pose, &out);
    let trained = &json(&out.join(EXPORT_CARD))["trained"];
    assert_eq!((&trained["reader"], &trained["sh_degree"]), (&"panoptic".into(), &0.into()));
    assert_eq!(trained["background"], serde_json::json!([0.0, 0.0, 0.0]));
    let count = world.frames().len() as f64;
    assert_eq!(trained["times"][1].as_f64().map(|time| time as f32), Some((1.0 / count) as f32));
}

#[test]
fn what_comes_from_rendered_depth_is_said() {
    let world = World::new();
    for format in Format::iter().filter(|format| !format.needs_truth()) {
        let out = world.out(&format.to_string());
        let Ok(exported) = try_export(&world, format, HeldOut::Pose, &out) else { continue };
        let is_bare = matches!(format, Format::Coco | Format::Davis);
        let says =
            exported.manifest.notes.iter().any(|note| note.contains("rendered depth: a method that learns"));
        assert_eq!((exported.manifest.depth, says), (!is_bare, !is_bare), "{format}");
        let written: Manifest = serde_json::from_value(json(&out.join(EXPORT_CARD))).unwrap();
        assert_eq!(written.depth, !is_bare, "{format}");
    }
    // Points of a reconstruction are what a method could know itself; files of depth are not.
    for (format, depth) in [(Format::Colmap, false), (Format::Nerfstudio, true)] {
        let (scene, out) = (world.dir(), world.out(&format!("{format}-given")));
        let points = world.out("colmap").join("frame_0000/sparse/0");
        let request = ExportRequest {
            frames: &[0],
            points: 100,
            points_from: Some(&points),
            ..ExportRequest::new(Origin::Rendered(&scene), format, &out)
        };
        assert_eq!(export(request, &|| {}).unwrap().manifest.depth, depth, "{format}");
    }
}

#[test]
fn truth_has_to_be_brought_along() {
    let world = World::new();
    let (scene, out) = (world.dir(), world.out("none"));
    let request = ExportRequest::new(Origin::Rendered(&scene), Format::LerfOvs, &out);
    assert!(export(request, &|| {}).unwrap_err().to_string().contains("truth were not given"));
}

#[test]
fn frames_can_be_chosen_among_the_rendered_ones() {
    let world = World::new();
    let scene = world.dir();
    let out = world.out("two");
    let request = ExportRequest {
        frames: &[96, 12],
        ..ExportRequest::new(Origin::Rendered(&scene), Format::FourDGaussians, &out)
    };
    assert_eq!(export(request, &|| {}).unwrap().manifest.frames, [12, 96]);
    assert_eq!(std::fs::read_dir(out.join("ims/0")).unwrap().count(), 2);
    let elsewhere = world.out("elsewhere");
    let error = export(ExportRequest { frames: &[13], out: &elsewhere, ..request }, &|| {}).unwrap_err();
    assert!(error.to_string().contains("frame 13 is not rendered"), "{error}");
    assert!(!elsewhere.exists());
}
