//! What can be done with an answer.

use l4d_data::json;
use l4d_formats::tensor_file::{TensorFile, TensorFileKind};
use l4d_masks::Mask;
use l4d_splat::model::time_of_frame;
use serde_json::Value;

use super::fixture::{FRAMES, Scene, as_it_is, closed, empty, field};
use crate::lift::{LiftError, ModelStates, RenderedModel, lift};

#[test]
fn what_answers_share_changes_none_of_them() {
    let scene = Scene::new();
    let shared = ModelStates::at(FRAMES.map(time_of_frame));
    let together = RenderedModel { states: Some(&shared), ..scene.rendered() };
    let late = |_: usize, frame: u32, mask: Mask| if frame < 48 { empty() } else { mask };
    for evidence in [scene.evidence(8, as_it_is), scene.evidence(8, late), scene.evidence(5, as_it_is)] {
        let lifted = lift(&together, &evidence, &closed()).unwrap().unwrap();
        assert_eq!(lifted, scene.lift(&evidence, &closed()).unwrap());
    }
}

#[test]
fn an_answer_is_a_part_of_the_scene_at_its_times() {
    let scene = Scene::new();
    let lifted = scene.lift(&scene.evidence(8, as_it_is), &closed()).unwrap();
    let values = lifted.layer_at(&scene.model, 0.5).unwrap().values;
    assert_eq!(values.len(), 400);
    let count = values.iter().filter(|&&value| value > 0.5).count();
    assert!((20..60).contains(&count), "{count}");
    for time in [-0.1, 1.1, f32::NAN] {
        assert!(matches!(lifted.layer_at(&scene.model, time), Err(LiftError::Time { .. })));
    }
}

#[test]
fn answers_on_disk_replace_each_other_and_name_their_model() {
    let scene = Scene::new();
    let gated = |_: usize, frame: u32, mask: Mask| if frame > 48 { empty() } else { mask };
    let folder = tempfile::tempdir().unwrap();
    let kind = TensorFileKind {
        card: "lift.json",
        stem: "lift",
        whole: "an answer",
        longest_header: 1 << 16,
        longest_file: 1 << 30,
        hint: "-",
    };
    let answers = [
        (closed(), serde_json::json!({ "labels": { "times": 5, "states": 2 } }), "states", vec![2, 400]),
        (field(2), serde_json::json!({ "field": { "width": 16, "features": 32 } }), "phi.0.bias", vec![16]),
    ];
    for (settings, answer, tensor, shape) in answers {
        let lifted = scene.lift(&scene.evidence(2, gated), &settings).unwrap();
        lifted.write(folder.path(), &scene.model).unwrap();
        let card: Value = json::read(&folder.path().join("lift.json")).unwrap();
        assert_eq!((&card["answer"], &card["model"]["gaussians"]), (&answer, &Value::from(400)));
        assert_eq!(card["model"]["sha256"].as_str().unwrap().len(), 64);
        let entry: TensorFile = serde_json::from_value(card["tensors"].clone()).unwrap();
        let (_, bytes) = kind.read(folder.path(), &entry).unwrap();
        assert!(kind.found(&bytes).unwrap().finite(tensor, &shape).is_ok(), "{tensor}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "one card, one file of tensors");
    }
}
