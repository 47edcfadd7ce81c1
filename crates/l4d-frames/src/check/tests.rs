//! A scene that agrees in everything passes; each kind of damage gives its finding and no other.

use std::fs;

use glam::UVec2;
use l4d_data::query::{Query, Status};
use l4d_data::truth::Truth;
use l4d_data::{Finding, Profile, json};
use l4d_testing::{Dataset, query};

use super::*;
use crate::exr::{read_frame, write_frame};

const SIZE: UVec2 = UVec2::new(128, 96);

fn check(fake: &Dataset) -> (Option<SceneStats>, Vec<Finding>) {
    let bench = fake.bench();
    let request =
        Request { data: &fake.data(), bench: &bench, profile: Profile::Tiny, scene: &fake.scene.name };
    let (stats, report) = check_scene(request, &|| {});
    (stats, report.into_sorted())
}

/// The codes that are found, without repetition.
fn codes(fake: &Dataset) -> Vec<&'static str> {
    let (_, findings) = check(fake);
    let mut codes: Vec<&str> = findings.iter().map(|finding| finding.code).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

/// Without the cards of the workers, scene.json alone says where the cameras stood.
fn remove_cards(fake: &Dataset) {
    for camera in &fake.scene.cameras {
        fs::remove_file(fake.dir().view_card(&camera.name)).unwrap();
    }
}

#[test]
fn a_scene_that_agrees_has_no_finding() {
    let (stats, findings) = check(&Dataset::new());
    assert_eq!(findings, []);
    let stats = stats.unwrap();
    assert!(stats.good);
    assert_eq!((stats.views, stats.frames, stats.pictures, stats.instances), (5, 9, 45, 3));
    let cross = stats.cross_view.unwrap();
    assert!(cross.compared > 500_000, "{cross:?}");
    assert!(cross.occluded > 0.001, "the ball hides behind the box: {cross:?}");
    assert!(cross.residual_mm.median < 0.01, "{cross:?}");
    assert_eq!((cross.beyond, cross.id_agreement), (0.0, 1.0));
}

#[test]
fn scene_json_missing_or_of_another_profile() {
    let mut fake = Dataset::new();
    fake.scene.profile = Profile::Small;
    fake.save();
    assert_eq!(codes(&fake), ["L4D101"]);
    fs::remove_file(fake.dir().scene()).unwrap();
    let (stats, findings) = check(&fake);
    assert!(stats.is_none());
    assert_eq!(findings[0].code, "L4D101");
    assert!(findings[0].path.ends_with("yard"), "{}", findings[0].path);
    assert!(findings[0].message.contains("the render was interrupted"), "{}", findings[0].message);
}

#[test]
fn a_view_card_that_says_something_else() {
    let fake = Dataset::new();
    let path = fake.dir().view_card("cam01");
    let sound: serde_json::Value = json::read(&path).unwrap();
    for (field, value) in [("schema", "l4d/view/0".into()), ("width", "128".into()), ("height", 95.into())] {
        let mut card = sound.clone();
        card[field] = value;
        json::write(&path, &card).unwrap();
        let (_, findings) = check(&fake);
        let found: Vec<&str> = findings.iter().map(|finding| finding.code).collect();
        assert_eq!(found, ["L4D102"], "{field}");
        assert!(findings[0].path.ends_with("view.json"), "{findings:?}");
    }
}

#[test]
fn missing_and_extra_frames_and_views() {
    let fake = Dataset::new();
    fs::remove_file(fake.dir().frame("cam01", 36)).unwrap();
    fs::write(fake.dir().view("cam03").join("0013.exr"), "x").unwrap();
    fs::create_dir(fake.dir().view("cam17")).unwrap();
    fs::write(fake.dir().view("cam03").join(".l4d-77-0.tmp"), "a worker's temporary is no finding").unwrap();
    let (_, findings) = check(&fake);
    let found: Vec<(&str, &str, &str)> =
        findings.iter().map(|f| (f.code, f.location.as_str(), f.message.as_str())).collect();
    assert_eq!(
        found,
        [
            ("L4D103", "cam17", "does not belong to the scene"),
            ("L4D103", "0036.exr", "is missing"),
            ("L4D103", "0013.exr", "does not belong to the scene"),
        ]
    );
}

#[test]
fn a_truncated_picture() {
    let fake = Dataset::new();
    let path = fake.dir().frame("cam01", 36);
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(codes(&fake), ["L4D104", "L4D110"]);
}

#[test]
fn a_flipped_id_that_digests_were_made_for() {
    let mut fake = Dataset::new();
    fake.change_frame("cam01", 48, |surfaces| {
        for id in &mut surfaces.id {
            *id = match *id {
                Dataset::BALL => Dataset::BOX,
                Dataset::BOX => Dataset::BALL,
                other => other,
            };
        }
    });
    // Pixels of the box lie in the box of the ball; neighbours disagree about ids, far from any contact.
    assert_eq!(codes(&fake), ["L4D111", "L4D113", "L4D118"]);
}

#[test]
fn an_id_that_the_scene_does_not_have() {
    let mut fake = Dataset::new();
    fake.change_frame("cam01", 48, |surfaces| {
        let pixel = surfaces.id.iter().position(|&id| id == Dataset::TABLE).unwrap();
        surfaces.id[pixel] = 999;
    });
    assert_eq!(codes(&fake), ["L4D108"]);
}

#[test]
fn an_instance_that_is_not_rendered() {
    let mut fake = Dataset::new();
    fake.change_frame("cam03", 0, |surfaces| {
        surfaces.id.iter_mut().filter(|id| **id == Dataset::BOX).for_each(|id| *id = 0);
    });
    let (_, findings) = check(&fake);
    let unseen = findings.iter().find(|finding| finding.code == "L4D114").unwrap();
    assert_eq!(unseen.location, "instance box_blue");
    assert!(unseen.path.ends_with("cam03/0000.exr"));
}

#[test]
fn depth_that_is_shifted_by_two_centimetres_in_one_picture() {
    let mut fake = Dataset::new();
    fake.change_frame("cam03", 96, |surfaces| {
        surfaces.depth_m.iter_mut().for_each(|depth_m| *depth_m += 0.02);
    });
    let (_, findings) = check(&fake);
    assert!(findings.iter().all(|finding| ["L4D113", "L4D117"].contains(&finding.code)), "{findings:?}");
    let across = findings.iter().filter(|finding| finding.code == "L4D117");
    assert!(
        across.clone().count() >= 2 && across.clone().all(|f| f.message.contains("at 1 of")),
        "{findings:?}"
    );
}

#[test]
fn depth_that_cannot_be() {
    for bad in [f32::NAN, 0.0, -2.0] {
        let fake = Dataset::new();
        let path = fake.dir().frame("cam00", 12);
        let mut frame = read_frame(&path, SIZE).unwrap();
        frame.surfaces.depth_m[777] = bad;
        write_frame(&path, &frame).unwrap();
        fake.save();
        let (_, findings) = check(&fake);
        assert_eq!(findings.len(), 1, "{findings:?}");
        assert_eq!(
            (findings[0].code, findings[0].location.as_str()),
            ("L4D107", "channel `Z`, column 9, row 6")
        );
    }
}

#[test]
fn a_picture_that_is_not_the_one_of_the_digests() {
    let fake = Dataset::new();
    fs::copy(fake.dir().frame("cam00", 0), fake.dir().frame("cam00", 96)).unwrap();
    let codes = codes(&fake);
    assert!(codes.contains(&"L4D109") && codes.contains(&"L4D110"), "{codes:?}");
}

#[test]
fn two_cameras_that_changed_places() {
    let mut fake = Dataset::new();
    remove_cards(&fake);
    let poses = [0, 3].map(|index: usize| fake.scene.cameras[index].world_from_camera.clone());
    [fake.scene.cameras[3].world_from_camera, fake.scene.cameras[0].world_from_camera] = poses.clone();
    fake.save();
    assert_eq!(codes(&fake), ["L4D112", "L4D113", "L4D117"]);
    // The tracks make the same mistake: geometry still knows.
    [fake.tracks.cameras[3].world_from_camera, fake.tracks.cameras[0].world_from_camera] = poses;
    fake.save();
    assert_eq!(codes(&fake), ["L4D113", "L4D117"]);
}

#[test]
fn a_pose_that_is_off_by_a_centimetre() {
    let mut fake = Dataset::new();
    fake.scene.cameras[1].world_from_camera[0][11] += 0.01;
    fake.tracks.cameras[1].world_from_camera[0][11] += 0.01;
    fake.save();
    let found = codes(&fake);
    assert!(found.contains(&"L4D117") && found.contains(&"L4D102"), "{found:?}");
    remove_cards(&fake);
    assert!(!codes(&fake).contains(&"L4D102"));
}

#[test]
fn descriptions_that_differ_from_the_tracks() {
    let mut fake = Dataset::new();
    fake.scene.events.clear();
    fake.scene.cameras[4].fx += 0.01;
    fake.scene.instances[0].category = "globe".to_owned();
    remove_cards(&fake);
    fake.save();
    fake.save_truth();
    let (_, findings) = check(&fake);
    let places: Vec<(&str, &str)> = findings.iter().map(|f| (f.code, f.location.as_str())).collect();
    assert_eq!(
        places,
        [("L4D112", "camera cam04"), ("L4D112", "field `events`"), ("L4D112", "field `instances`")]
    );
}

#[test]
fn a_truth_that_was_edited() {
    let fake = Dataset::new();
    let path = fake.bench().truth(Profile::Tiny, &fake.scene.name);
    let mut truth = Truth::read(&path).unwrap();
    let count = |truth: &mut Truth, view: &str, by: i32| {
        let counts = truth.visible.get_mut(view).unwrap().get_mut("ball_red").unwrap();
        counts[2] = counts[2].wrapping_add_signed(by);
        json::write_compact(&path, truth).unwrap();
    };
    // As much as two machines may differ, in the held-out view too.
    truth.visible.get_mut("cam03").unwrap().get_mut("ball_red").unwrap()[0] += 1;
    count(&mut truth, "cam03", 4);
    count(&mut truth, "cam02", 4);
    assert!(codes(&fake).is_empty());
    count(&mut truth, "cam02", 1);
    assert_eq!(codes(&fake), ["L4D111"]);
    count(&mut truth, "cam02", -5);
    count(&mut truth, "cam03", 1);
    let removed = truth.instances[1].masks.remove("0048");
    assert!(removed.is_some());
    json::write_compact(&path, &truth).unwrap();
    let (_, findings) = check(&fake);
    let places: Vec<(&str, &str)> =
        findings.iter().map(|f| (f.location.as_str(), f.message.as_str())).collect();
    assert_eq!(
        places,
        [
            ("instance box_blue, masks", "differ from the pictures, first at frame 0048"),
            ("visible.cam03.ball_red", "differs from the pictures, first at frame 0024"),
        ]
    );
    fs::remove_file(&path).unwrap();
    assert_eq!(codes(&fake), ["L4D111"]);
}

#[test]
fn checksums_that_are_missing_foreign_or_wrong() {
    let fake = Dataset::new();
    let path = fake.dir().checksums();
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, format!("not a line\n{}", text.replace("frames/cam00/0000.exr", "../../outside")))
        .unwrap();
    let (_, findings) = check(&fake);
    let places: Vec<(&str, &str)> = findings.iter().map(|f| (f.code, f.location.as_str())).collect();
    assert_eq!(places, [("L4D110", "frames/cam00/0000.exr"), ("L4D110", "line 1"), ("L4D110", "line 2")]);
    fs::remove_file(&path).unwrap();
    assert_eq!(codes(&fake), ["L4D110"]);
}

#[test]
fn gates_ask_for_pixels_where_and_when_a_query_holds() {
    let fake = Dataset::new();
    let truth_path = fake.bench().truth(Profile::Tiny, &fake.scene.name);
    let mut truth = Truth::read(&truth_path).unwrap();
    // Tiny pictures hold a quarter of the pixels of small ones: 38 pixels are the gate, in 80 % of 9 frames.
    for counts in truth.visible.values_mut() {
        counts.insert("ball_red".parse().unwrap(), vec![37, 38, 38, 38, 38, 38, 38, 38, 38]);
        counts.insert("box_blue".parse().unwrap(), vec![37, 37, 38, 38, 38, 38, 38, 38, 38]);
    }
    let mut scene = fake.scene.clone();
    let mut queries = vec![
        query("yard/001", "the ball", &["ball_red"], [0, 96]),
        query("yard/002", "the box", &["box_blue"], [0, 96]),
        query("yard/003", "the late box", &["box_blue"], [24, 96]),
    ];
    let bench = fake.bench();
    let request =
        Request { data: &fake.data(), bench: &bench, profile: Profile::Tiny, scene: &fake.scene.name };
    let gate = |scene: &Scene, truth: &Truth, queries: &[Query]| {
        json::write_lines(&bench.queries("yard"), queries).unwrap();
        let mut report = Report::default();
        gates::check(truth, scene, request, &mut report);
        let place = |finding: Finding| (finding.code, finding.location);
        report.into_sorted().into_iter().map(place).collect::<Vec<_>>()
    };
    // Four training views can never be six.
    let found = gate(&scene, &truth, &queries);
    let expected = [
        ("L4D116", "query yard/001, referent ball_red"),
        ("L4D115", "query yard/002, referent box_blue"),
        ("L4D116", "query yard/003, referent box_blue"),
    ];
    assert_eq!(found, expected.map(|(code, place)| (code, place.to_owned())));
    // What people rejected is scored nowhere and needs no pixels.
    let mut rejected = queries.clone();
    rejected.iter_mut().for_each(|query| query.status = Status::Rejected);
    assert_eq!(gate(&scene, &truth, &rejected), []);
    // Two more of them are enough.
    for name in ["cam05", "cam06"] {
        let mut camera = scene.cameras[0].clone();
        camera.name = name.parse().unwrap();
        scene.cameras.push(camera);
        let counts = truth.visible["cam00"].clone();
        truth.visible.insert(name.parse().unwrap(), counts);
    }
    queries.remove(1);
    assert_eq!(gate(&scene, &truth, &queries), []);
}
