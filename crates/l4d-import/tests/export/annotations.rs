//! COCO's and DAVIS' annotations, read as their tools do.

use l4d_data::truth::frame_key;
use l4d_import::export::{Format, HeldOut};
use l4d_masks::{Mask, ids};

use crate::support::{BALL, LATE_BALL, SLAB, TEST_VIEW, World};
use crate::{exported, json, png, shown};

#[test]
fn coco_has_a_mask_for_every_visible_instance_of_every_training_picture() {
    let world = World::new();
    let out = world.out("coco");
    exported(&world, Format::Coco, HeldOut::Pose, &out);
    let document = json(&out.join("instances_train.json"));
    let names: Vec<&str> = document["categories"]
        .as_array()
        .unwrap()
        .iter()
        .map(|category| category["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["ball", "slab"]);
    let annotations = document["annotations"].as_array().unwrap();
    let mut found = 0;
    for image in document["images"].as_array().unwrap() {
        let (view, frame) = (image["view"].as_str().unwrap(), image["frame"].as_u64().unwrap() as u32);
        assert_ne!(view, TEST_VIEW);
        let file = image["file_name"].as_str().unwrap();
        assert_eq!(file, format!("images/{view}/{}.png", frame_key(frame)));
        assert_eq!(png(&out.join(file), 128, 96), shown(&world, view, frame));
        let surfaces = world.frame(view, frame).surfaces;
        for (id, visible) in surfaces.visible() {
            let annotation = annotations
                .iter()
                .find(|annotation| annotation["image_id"] == image["id"] && annotation["instance_id"] == id)
                .unwrap_or_else(|| panic!("{id} is missing in {file}"));
            let counts = annotation["segmentation"]["counts"].as_str().unwrap();
            assert_eq!(annotation["segmentation"]["size"], serde_json::json!([96, 128]));
            let mask = Mask::decode(counts, 128, 96).unwrap();
            assert_eq!(mask, Mask::from_ids(128, 96, &surfaces.id, id).unwrap());
            assert_eq!(annotation["area"], visible);
            let bounds = mask.bounding_box().unwrap();
            let [x, y, width, height] =
                [0, 1, 2, 3].map(|index| annotation["bbox"][index].as_u64().unwrap() as u32);
            assert_eq!((x, y), (bounds.first_col, bounds.first_row));
            assert_eq!((x + width - 1, y + height - 1), (bounds.last_col, bounds.last_row));
            let category = annotation["category_id"].as_u64().unwrap();
            assert_eq!(category, if id == SLAB { 2 } else { 1 });
            found += 1;
        }
    }
    assert_eq!(found, annotations.len(), "nothing else is annotated");
    assert!(found > 80);
    assert!(!out.join("instances_test.json").exists());
}

#[test]
fn davis_numbers_objects_and_says_which_its_evaluator_forgets() {
    let world = World::new();
    let out = world.out("davis");
    let manifest = exported(&world, Format::Davis, HeldOut::Pose, &out).manifest;
    let sequences = std::fs::read_to_string(out.join("ImageSets/2017/train.txt")).unwrap();
    assert_eq!(sequences.lines().count(), 4);
    assert!(!sequences.contains(TEST_VIEW));
    assert_eq!(std::fs::read_to_string(out.join("ImageSets/2017/val.txt")).unwrap(), "");
    for sequence in sequences.lines() {
        let view = sequence.strip_prefix("closed_form_").unwrap();
        for (moment, frame) in world.frames().into_iter().enumerate() {
            let path = out.join(format!("Annotations/480p/{sequence}/{moment:05}.png"));
            let picture = ids::decode(&std::fs::read(path).unwrap()).unwrap();
            let truth = world.frame(view, frame).surfaces.id;
            let expected = |id: u32| match id {
                BALL => 1,
                LATE_BALL => 2,
                _ => 0,
            };
            assert_eq!(picture.ids, truth.into_iter().map(expected).collect::<Vec<u32>>());
            assert!(out.join(format!("JPEGImages/480p/{sequence}/{moment:05}.jpg")).is_file());
        }
    }
    let numbers: Vec<(&str, &str)> =
        manifest.instances.iter().map(|called| (called.name.as_str(), called.called.as_str())).collect();
    assert_eq!(numbers, [("ball_red", "1"), ("ball_late", "2")]);
    let late =
        manifest.notes.iter().filter(|note| note.contains("first moment") && note.contains("ball_late"));
    assert_eq!(late.count(), 4);
}
