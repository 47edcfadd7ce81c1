//! What only captures have: moments that a view did not see, pictures that no one drew on, points of a reconstruction.

use std::path::Path;

use glam::DVec3;
use l4d_data::capture::{CAPTURE, Capture};
use l4d_data::{DataError, Name, Profile, Split, json as files_of_json};
use l4d_formats::colmap::Model;
use l4d_import::annotations::{QueriesWithTruth, four_d_langsplat};
use l4d_import::export::{ExportRequest, Exported, Format, HeldOut, Origin, export};
use l4d_masks::{Mask, ids};

use crate::support::{BALL, LATE_BALL, TEST_VIEW, World};
use crate::{Kind, exported_as, json, png, shown};

/// A capture of the world after a change.
fn recorded(change: impl FnOnce(&mut Capture)) -> World {
    let world = World::new();
    let mut capture = Capture::read(world.capture_dir().root()).unwrap();
    change(&mut capture);
    files_of_json::write(&world.capture_dir().root().join(CAPTURE), &capture).unwrap();
    world
}

fn try_captured(world: &World, format: Format, held_out: HeldOut, out: &Path) -> Result<Exported, DataError> {
    let capture = world.capture_dir();
    let origin = Origin::Captured(&capture);
    export(ExportRequest { held_out, points: 2000, ..ExportRequest::new(origin, format, out) }, &|| {})
}

fn name(text: &str) -> Name {
    Name::new(text).unwrap()
}

#[test]
fn a_moment_that_a_view_did_not_see_is_left_out_of_it_alone() {
    let world = recorded(|capture| drop(capture.unseen.insert(name("cam04"), vec![24])));
    std::fs::remove_file(world.capture_dir().picture("cam04", 24)).unwrap();
    let of = |format: Format| {
        let out = world.out(&format.to_string());
        exported_as(Kind::Captured, &world, format, HeldOut::Pose, &out);
        out
    };
    let meta = json(&of(Format::FourDGaussians).join("train_meta.json"));
    let counts: Vec<usize> = (0..9).map(|moment| meta["fn"][moment].as_array().unwrap().len()).collect();
    assert_eq!(counts, [4, 4, 3, 4, 4, 4, 4, 4, 4]);
    assert_eq!(
        (&meta["cam_id"][2], &meta["cam_id"][3]),
        (&serde_json::json!([0, 1, 2]), &serde_json::json!([0, 1, 2, 3]))
    );
    let colmap = of(Format::Colmap);
    for (frame, count) in [(12, 4), (24, 3)] {
        let folder = colmap.join(format!("frame_{frame:04}"));
        assert_eq!(std::fs::read_dir(folder.join("images")).unwrap().count(), count);
        assert_eq!(Model::read(&folder.join("sparse/0")).unwrap().images.len(), count);
    }
    let transforms = json(&of(Format::Nerfstudio).join("frame_0024/transforms.json"));
    assert_eq!(transforms["train_filenames"].as_array().unwrap().len(), 3);
    let error = try_captured(&world, Format::Dynerf, HeldOut::Pose, &world.out("no")).unwrap_err();
    assert!(error.to_string().contains("cam04 did not see 24"), "{error}");
}

#[test]
fn points_are_those_of_the_reconstruction_but_for_what_took_the_held_out_view() {
    let world = World::new();
    let out = world.out("points");
    let exported = exported_as(Kind::Captured, &world, Format::Colmap, HeldOut::Pose, &out);
    assert!(
        exported.manifest.notes.iter().any(|note| note.contains("but for 40")),
        "{:?}",
        exported.manifest.notes
    );
    let model = Model::read(&out.join("frame_0048/sparse/0")).unwrap();
    assert_eq!(model.points.len(), 360);
    for point in &model.points {
        assert_eq!((point.track.len(), point.position.z), (4, 0.0));
    }
    let grid = DVec3::new(-0.9, -1.0, 0.0);
    assert!(
        model.points.iter().any(|point| point.position.distance(grid) < 1e-9 && point.rgb == [1, 40, 90])
    );
    assert!(!model.points.iter().any(|point| point.position.distance(DVec3::new(-1.0, -1.0, 0.0)) < 1e-9));
}

#[test]
fn without_points_a_layout_says_so_and_takes_those_of_a_model_in_the_same_world() {
    let world = recorded(|capture| capture.points = 0);
    let out = world.out("none");
    let exported = exported_as(Kind::Captured, &world, Format::FourDGaussians, HeldOut::Pose, &out);
    assert!(!out.join("init_pt_cld.npz").exists());
    assert!(exported.manifest.notes.iter().any(|note| note.contains("--points-from")));
    let out = world.out("empty");
    exported_as(Kind::Captured, &world, Format::Colmap, HeldOut::Pose, &out);
    assert_eq!(Model::read(&out.join("frame_0000/sparse/0")).unwrap().points.len(), 0);

    // The cameras of that export, triangulated.
    let model = world.out("triangulated");
    world.reconstruct(&model);
    let (capture, scene) = (world.capture_dir(), world.dir());
    let with = |origin: Origin<'_>, model: &Path, out: &Path| {
        let request = ExportRequest {
            frames: &[0, 48],
            points: 2000,
            points_from: Some(model),
            ..ExportRequest::new(origin, Format::FourDGaussians, out)
        };
        export(request, &|| {})
    };
    for (number, origin) in [Origin::Captured(&capture), Origin::Rendered(&scene)].into_iter().enumerate() {
        let out = world.out(&format!("given-{number}"));
        with(origin, &model, &out).unwrap();
        assert!(out.join("init_pt_cld.npz").is_file());
    }

    // A mapper makes a world of its own.
    let mut turned = Model::read(&model).unwrap();
    turned.images[1].translation.x += 0.5;
    turned.write(&world.out("turned")).unwrap();
    let error = with(Origin::Captured(&capture), &world.out("turned"), &world.out("no")).unwrap_err();
    assert!(error.to_string().contains("a world of its own"), "{error}");
    assert!(error.hint().contains("point_triangulator"));
    for image in &mut turned.images {
        image.name.insert_str(0, "other");
    }
    turned.write(&world.out("other")).unwrap();
    let error = with(Origin::Captured(&capture), &world.out("other"), &world.out("no")).unwrap_err();
    assert!(error.to_string().contains("called like a view"), "{error}");
}

#[test]
fn masks_are_those_that_people_drew_and_pictures_that_nobody_drew_on_have_none() {
    let world = recorded(|_| {});
    world.draw(&["cam00", "cam03", TEST_VIEW], &[12, 48]);
    let out = world.out("coco");
    exported_as(Kind::Captured, &world, Format::Coco, HeldOut::Pose, &out);
    let document = json(&out.join("instances_train.json"));
    let images = document["images"].as_array().unwrap();
    let shots: Vec<(&str, u64)> = images
        .iter()
        .map(|image| (image["view"].as_str().unwrap(), image["frame"].as_u64().unwrap()))
        .collect();
    assert_eq!(shots, [("cam00", 12), ("cam00", 48), ("cam03", 12), ("cam03", 48)]);
    assert_eq!(document["categories"].as_array().unwrap().len(), 1, "both are balls");
    for annotation in document["annotations"].as_array().unwrap() {
        let (view, frame) = shots[annotation["image_id"].as_u64().unwrap() as usize - 1];
        let counts = annotation["segmentation"]["counts"].as_str().unwrap();
        let drawn = if annotation["instance_id"] == 1 { LATE_BALL } else { BALL };
        let truth = Mask::from_ids(128, 96, &world.frame(view, frame as u32).surfaces.id, drawn).unwrap();
        assert_eq!(Mask::decode(counts, 128, 96).unwrap(), truth, "{view} at {frame}");
    }
    assert_eq!(png(&out.join("images/cam03/0048.png"), 128, 96), shown(&world, "cam03", 48));

    let out = world.out("davis");
    let manifest = exported_as(Kind::Captured, &world, Format::Davis, HeldOut::Pose, &out).manifest;
    let sequences = std::fs::read_to_string(out.join("ImageSets/2017/train.txt")).unwrap();
    assert_eq!(sequences.lines().collect::<Vec<_>>(), ["closed_form_cam00", "closed_form_cam03"]);
    let stems = |folder: &str| {
        let mut names: Vec<String> = std::fs::read_dir(out.join(folder).join("closed_form_cam00"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(stems("Annotations/480p"), ["00001.png", "00004.png"]);
    assert_eq!(stems("JPEGImages/480p").len(), 9);
    let path = out.join("Annotations/480p/closed_form_cam00/00004.png");
    let numbers = ids::decode(&std::fs::read(path).unwrap()).unwrap().ids;
    let expected = world.frame("cam00", 48).surfaces.id.into_iter().map(|id| match id {
        LATE_BALL => 1,
        BALL => 2,
        _ => 0,
    });
    assert_eq!(numbers, expected.collect::<Vec<u32>>());
    assert!(manifest.notes.iter().any(|note| note.contains("7 pictures without an annotation")));
}

#[test]
fn masks_of_the_held_out_view_alone_are_the_truth_and_no_training_data() {
    let world = recorded(|_| {});
    world.draw(&[TEST_VIEW], &[12, 48]);
    for format in [Format::Coco, Format::Davis] {
        let error = try_captured(&world, format, HeldOut::Pose, &world.out("no")).unwrap_err();
        assert!(error.to_string().contains("they are the truth"), "{error}");
        let out = world.out(&format!("shown-{format}"));
        try_captured(&world, format, HeldOut::Pictures, &out).unwrap();
    }
    std::fs::remove_file(world.capture_dir().root().join("masks.json")).unwrap();
    let error = try_captured(&world, Format::Davis, HeldOut::Pose, &world.out("no")).unwrap_err();
    assert!(error.hint().contains("l4d import-scene --masks"), "{error}");
}

#[test]
fn evaluators_count_the_moments_that_nobody_drew_on() {
    let world = recorded(|_| {});
    let mut truth = world.truth.clone();
    truth.profile = Profile::Real;
    (truth.frames, truth.unannotated) =
        world.frames().into_iter().partition(|frame| [12, 48].contains(frame));
    for instance in &mut truth.instances {
        instance.masks.retain(|key, _| ["0012", "0048"].contains(&key.as_str()));
    }
    let queries = world.queries();
    let judged = QueriesWithTruth::new(Path::new("truth.json"), &truth, &queries).unwrap();
    let (capture, out) = (world.capture_dir(), world.out("annotations"));
    let request = ExportRequest {
        judged: Some(&judged),
        ..ExportRequest::new(Origin::Captured(&capture), Format::FourDLangSplatAnnotations, &out)
    };
    let manifest = export(request, &|| {}).unwrap().manifest;
    assert_eq!(manifest.frames, world.frames(), "a moment is a place in the clip");
    let (annotations, moments) = four_d_langsplat::read(&out, 0).unwrap();
    assert_eq!(moments, [1, 4]);
    let counts = truth.instance("ball_red").unwrap().masks["0048"].clone();
    let truth = Mask::from_rle(&counts, 128, 96).resized_nearest(1352, 1014);
    assert_eq!(annotations.pictures[1].union_of("the ball that rolls"), truth);
    // Frames 36 to 72 are the moments 3 to 6, drawn on or not.
    let intervals = json(&out.join("annotations/video_annotations.json"));
    assert_eq!(intervals, serde_json::json!({"ball late": {"the ball while it rises": [[3, 6]]}}));
}

#[test]
fn captures_that_cannot_be_are_refused_with_the_field() {
    type Change = fn(&mut Capture);
    let changes: [(&str, Change); 5] = [
        ("cam00: has 4 poses, but the last frame is 96", |capture| {
            let pose = capture.cameras[0].world_from_camera[0];
            capture.cameras[0].world_from_camera = vec![pose; 4];
        }),
        ("occurs twice", |capture| capture.cameras[0].name = name("cam01")),
        ("must be ascending", |capture| capture.frames.reverse()),
        ("there is none to train on", |capture| {
            capture.cameras.iter_mut().for_each(|camera| camera.split = Split::Test);
        }),
        ("but the capture is 128x95", |capture| capture.height = 95),
    ];
    for (said, change) in changes {
        let world = recorded(change);
        std::fs::remove_file(world.capture_dir().root().join("masks.json")).unwrap();
        let error =
            try_captured(&world, Format::FourDGaussians, HeldOut::Pose, &world.out("no")).unwrap_err();
        assert!(error.to_string().contains(said), "`{said}` is not in: {error}");
    }
}

#[test]
fn several_held_out_views_are_all_kept_apart() {
    let world = recorded(|capture| capture.cameras[4].split = Split::Test);
    let out = world.out("panoptic");
    exported_as(Kind::Captured, &world, Format::FourDGaussians, HeldOut::Pose, &out);
    let (train, test) = (json(&out.join("train_meta.json")), json(&out.join("test_meta.json")));
    assert_eq!(
        (&train["cam_id"][0], &test["cam_id"][0]),
        (&serde_json::json!([0, 1, 2]), &serde_json::json!([3, 4]))
    );
    for number in [3, 4] {
        let picture = png(&out.join(format!("ims/{number}/000000.png")), 128, 96);
        assert!(picture.pixels().all(|pixel| pixel.0 == [128; 3]));
    }
    let out = world.out("dynerf");
    let manifest = exported_as(Kind::Captured, &world, Format::Dynerf, HeldOut::Pose, &out).manifest;
    assert!(manifest.notes.iter().any(|note| note.contains("cam04 is left out")), "{:?}", manifest.notes);
    assert_eq!(manifest.cameras.len(), 4);
}
