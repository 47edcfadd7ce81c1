//! What the evaluators of LangSplat and 4D LangSplat make of our truth.

use std::collections::BTreeMap;

use l4d_import::annotations::fill::{Rule, fill};
use l4d_import::annotations::four_d_langsplat;
use l4d_import::export::{Format, HeldOut};
use l4d_masks::Mask;

use crate::support::World;
use crate::{exported, json};

/// Pixels of instances in the held-out view.
fn truth_of(world: &World, names: &[&str], frame: u32) -> Mask {
    let mut union = Mask::empty(128, 96);
    for name in names {
        if let Some(mask) = world.truth.instance(name).unwrap().masks.get(&format!("{frame:04}")) {
            union.union_with(&Mask::from_rle(mask, 128, 96));
        }
    }
    union
}

#[test]
fn the_evaluator_of_4d_langsplat_finds_every_pixel_and_every_interval() {
    let world = World::new();
    let out = world.out("annotations");
    exported(&world, Format::FourDLangSplatAnnotations, HeldOut::Pose, &out);

    // The evaluator: the first polygon of each annotation, united by category and picture.
    let document = json(&out.join("annotations/train/_annotations.coco.json"));
    let list = |field: &str| document[field].as_array().unwrap().clone();
    let categories: BTreeMap<u64, String> = list("categories")
        .iter()
        .map(|category| (category["id"].as_u64().unwrap(), category["name"].as_str().unwrap().to_owned()))
        .collect();
    for image in list("images") {
        let file = image["file_name"].as_str().unwrap();
        let moment: usize = file.split('_').next().unwrap().parse().unwrap();
        assert!(out.join("annotations/train").join(file).is_file());
        let mut found: BTreeMap<&str, Mask> = BTreeMap::new();
        for annotation in
            list("annotations").iter().filter(|annotation| annotation["image_id"] == image["id"])
        {
            let flat: Vec<f64> = serde_json::from_value(annotation["segmentation"][0].clone()).unwrap();
            let corners: Vec<[f64; 2]> = flat.chunks(2).map(|pair| [pair[0], pair[1]]).collect();
            let mask = fill(Rule::Cv2, &corners, 1352, 1014);
            let name = categories[&annotation["category_id"].as_u64().unwrap()].as_str();
            found.entry(name).or_insert_with(|| Mask::empty(1352, 1014)).union_with(&mask);
        }
        assert_eq!([&image["width"], &image["height"]], [1352, 1014]);
        let frame = world.frames()[moment];
        for (prompt, referents) in [
            ("the ball that rolls", &["ball_red"][..]),
            ("ball late", &["ball_late"]),
            ("the two balls", &["ball_red", "ball_late"]),
        ] {
            let truth = truth_of(&world, referents, frame).resized_nearest(1352, 1014);
            let seen = found.remove(prompt).unwrap_or_else(|| Mask::empty(1352, 1014));
            assert_eq!(seen, truth, "{prompt} at {frame}");
        }
        assert!(found.is_empty(), "{found:?}");
    }

    // Frames 36, 48, 60, 72 are the moments 3 to 6.
    let intervals = json(&out.join("annotations/video_annotations.json"));
    assert_eq!(intervals, serde_json::json!({"ball late": {"the ball while it rises": [[3, 6]]}}));
    let (annotations, moments) = four_d_langsplat::read(&out, 0).unwrap();
    assert_eq!(moments, (0..9).collect::<Vec<u32>>());
    assert_eq!(annotations.notes.len(), 1, "the intervals alone: {:?}", annotations.notes);
    let both = truth_of(&world, &["ball_red", "ball_late"], 48);
    assert_eq!(annotations.pictures[4].union_of("the two balls"), both.resized_nearest(1352, 1014));
}

#[test]
fn the_evaluator_of_langsplat_finds_every_pixel_of_what_holds_at_a_moment() {
    let world = World::new();
    let out = world.out("labels");
    exported(&world, Format::LerfOvs, HeldOut::Pose, &out);
    for frame in world.frames() {
        let folder = out.join(format!("label/closed_form_{frame:04}"));
        assert!(folder.join("frame_00001.jpg").is_file());
        // The evaluator: every polygon of a category, filled and united.
        let document = json(&folder.join("frame_00001.json"));
        assert_eq!(document["info"]["name"], "frame_00001.jpg");
        let objects = document["objects"].as_array().unwrap();
        let united = |category: &str| {
            let mut union = Mask::empty(128, 96);
            for object in objects.iter().filter(|object| object["category"] == category) {
                let corners: Vec<[f64; 2]> = serde_json::from_value(object["segmentation"].clone()).unwrap();
                union.union_with(&fill(Rule::Cv2, &corners, 128, 96));
            }
            union
        };
        assert_eq!(united("the ball that rolls"), truth_of(&world, &["ball_red"], frame));
        let gated = if (30..=80).contains(&frame) {
            truth_of(&world, &["ball_late"], frame)
        } else {
            Mask::empty(128, 96)
        };
        assert_eq!(united("the ball while it rises"), gated, "frame {frame}");
        for object in objects {
            let [x0, y0, x1, y1] = [0, 1, 2, 3].map(|index| object["bbox"][index].as_f64().unwrap());
            for corner in object["segmentation"].as_array().unwrap() {
                let (x, y) = (corner[0].as_f64().unwrap(), corner[1].as_f64().unwrap());
                assert!((x0..=x1).contains(&x) && (y0..=y1).contains(&y));
            }
        }
    }
}
