use std::fs;
use std::path::Path;

use l4d_data::digest::sha256_hex;
use l4d_data::{Name, Profile};
use l4d_splat::checkpoint::foreign;
use l4d_splat::checkpoint::own::{self, Checkpoint, Training};
use l4d_splat::{Model, Tensor};
use serde_json::{Value, json};

use super::fixture;

fn checkpoint() -> Checkpoint {
    let model = foreign::read(&fixture("model"), foreign::ReaderOptions::default()).unwrap();
    let moments = Tensor { shape: vec![5, 3], data: (0..15).map(|place| 0.1 * place as f32).collect() };
    let Value::Object(values) = json!({"seed": 7, "stage": "fine"}) else { unreachable!() };
    Checkpoint {
        model: Model {
            gaussians: model.gaussians,
            dynamic: vec![0, 2, 3],
            field: Some(model.field),
            ..Model::default()
        },
        iteration: 1200,
        scene: Some(Name::new("room_living_cats").unwrap()),
        profile: Some(Profile::Small),
        sampling: Some(own::Sampling { shrink: 4, every: 2 }),
        saw_depth: Some(true),
        inputs: [("scene.json".to_owned(), sha256_hex(b"scene"))].into(),
        training: Training { tensors: [("adam/means/first".to_owned(), moments)].into(), values },
    }
}

fn names(folder: &Path) -> Vec<String> {
    l4d_data::store::list_folder(folder).unwrap()
}

#[test]
fn a_checkpoint_comes_back_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut written = checkpoint();
    written.model.gaussians.sh[3] = [-0.0, 1e-45, f32::MAX];
    own::write(folder.path(), &written).unwrap();
    let read = own::read(folder.path()).unwrap();
    assert_eq!(read, written);
    assert_eq!(read.model.gaussians.sh[3].map(f32::to_bits), written.model.gaussians.sh[3].map(f32::to_bits));

    let card: Value = l4d_data::json::read(&folder.path().join("checkpoint.json")).unwrap();
    assert_eq!(card["schema"], "l4d/splats/1");
    assert_eq!((&card["gaussians"], &card["dynamic"], &card["sh_degree"]), (&json!(5), &json!(3), &json!(3)));
    assert_eq!(card["deformation"]["multires"], json!([1, 2]));
    assert_eq!(card["training"], json!({"seed": 7, "stage": "fine"}));
    let file = card["tensors"]["file"].as_str().unwrap();
    assert_eq!(names(folder.path()), ["checkpoint.json", file]);
    assert_eq!(card["tensors"]["sha256"], sha256_hex(&fs::read(folder.path().join(file)).unwrap()));
}

#[test]
fn the_same_checkpoint_gives_the_same_bytes() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    own::write(one.path(), &checkpoint()).unwrap();
    own::write(two.path(), &checkpoint()).unwrap();
    assert_eq!(names(one.path()), names(two.path()));
    for name in names(one.path()) {
        assert!(
            fs::read(one.path().join(&name)).unwrap() == fs::read(two.path().join(&name)).unwrap(),
            "{name}"
        );
    }
}

#[test]
fn a_still_scene_needs_no_field_and_an_empty_one_no_gaussians() {
    let folder = tempfile::tempdir().unwrap();
    let mut still = checkpoint();
    (still.model.field, still.model.dynamic) = (None, vec![]);
    own::write(folder.path(), &still).unwrap();
    assert_eq!(own::read(folder.path()).unwrap(), still);
    let empty = Checkpoint::default();
    own::write(folder.path(), &empty).unwrap();
    assert_eq!(own::read(folder.path()).unwrap(), empty);
}

#[test]
fn a_kill_between_the_two_files_leaves_the_old_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let old = checkpoint();
    own::write(folder.path(), &old).unwrap();
    let card = fs::read(folder.path().join("checkpoint.json")).unwrap();
    let old_tensors = names(folder.path()).remove(1);
    let bytes = fs::read(folder.path().join(&old_tensors)).unwrap();

    let mut new = Checkpoint { iteration: 1300, ..old.clone() };
    new.model.dynamic = vec![1];
    own::write(folder.path(), &new).unwrap();
    assert_eq!(names(folder.path()).len(), 2, "the old tensors are gone");
    assert_eq!(own::read(folder.path()).unwrap(), new);
    // As if the JSON had not been reached: both files of numbers, the old JSON.
    fs::write(folder.path().join(&old_tensors), bytes).unwrap();
    fs::write(folder.path().join("checkpoint.json"), card).unwrap();
    fs::write(folder.path().join("splats-notes.safetensors"), "not ours to remove").unwrap();
    assert_eq!(own::read(folder.path()).unwrap(), old);
    own::write(folder.path(), &old).unwrap();
    assert_eq!(names(folder.path()), ["checkpoint.json", &old_tensors, "splats-notes.safetensors"]);
}

#[test]
fn checkpoints_that_cannot_be_are_not_written() {
    let moment = |broken: &mut Checkpoint, change: fn(&mut Tensor)| {
        change(broken.training.tensors.get_mut("adam/means/first").unwrap());
    };
    type Breaks<'a> = &'a dyn Fn(&mut Checkpoint);
    let cases: [(Breaks, &str); 7] = [
        (&|c| c.model.dynamic = vec![0, 5], "field `dynamic`: names Gaussian 5, but there are 5"),
        (&|c| c.model.dynamic = vec![2, 2], "has 2 before 2, but the list ascends"),
        (&|c| c.model.field = None, "there is no deformation field"),
        (&|c| c.model.gaussians.rotations[4][1] = f32::NAN, "Gaussian 4, field `rotations`: is NaN"),
        (&|c| c.model.gaussians.sh.truncate(9), "field `sh`: has 9 entries, but 5 Gaussians need 80"),
        (&|c| moment(c, |tensor| tensor.data[2] = f32::INFINITY), "adam/means/first"),
        (&|c| moment(c, |tensor| tensor.shape = vec![4]), "15 numbers for the shape [4]"),
    ];
    for (change, why) in cases {
        let mut broken = checkpoint();
        change(&mut broken);
        let folder = tempfile::tempdir().unwrap();
        let error = own::write(folder.path(), &broken).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

/// Writes the checkpoint, lets `change` at its JSON and folder, and says why it is refused.
fn refused_card(change: impl Fn(&mut Value, &Path)) -> String {
    let folder = tempfile::tempdir().unwrap();
    own::write(folder.path(), &checkpoint()).unwrap();
    let path = folder.path().join("checkpoint.json");
    let mut card: Value = l4d_data::json::read(&path).unwrap();
    change(&mut card, folder.path());
    l4d_data::json::write(&path, &card).unwrap();
    own::read(folder.path()).unwrap_err().to_string()
}

#[test]
fn json_that_does_not_fit_is_refused_by_field() {
    let file = "field `tensors.file`";
    for (pointer, value, why) in [
        ("/schema", json!("l4d/splats/2"), "field `schema`: is `l4d/splats/2`, but this l4d reads"),
        (
            "/gaussians",
            json!(6),
            "tensor `gaussians/means`: is F32 [5, 3], but checkpoint.json needs F32 [6, 3]",
        ),
        ("/gaussians", json!(u64::MAX), "tensor `gaussians/means`"),
        ("/gaussians", json!(-1), "field `gaussians`"),
        ("/dynamic", json!(2), "tensor `dynamic`"),
        ("/sh_degree", json!(4), "field `sh_degree`: is 4, but degrees end at 3"),
        ("/sh_degree", json!(2), "tensor `gaussians/sh`"),
        ("/surprise", json!(2), "surprise"),
        ("/deformation", Value::Null, "field `deformation`: is null"),
        ("/deformation/width", json!(5), "the configuration needs"),
        ("/deformation/width", json!(1_u64 << 60), "deformation field: deformation config: `width`"),
        ("/deformation/spatial_resolution", json!([60000, 1, 1]), "grid"),
        ("/tensors/bytes", json!(1), "digest: is not the file"),
        ("/tensors/file", json!("../../etc/passwd"), file),
        ("/tensors/file", json!("/etc/passwd"), file),
        ("/tensors/file", json!("splats-0123456789abcdeF.safetensors"), file),
        ("/tensors/file", json!("splats-0.safetensors"), file),
        ("/tensors/file", json!("splats-0123456789abcdef.safetensors"), "cannot open"),
    ] {
        let (parent, field) = pointer.rsplit_once('/').unwrap();
        let error = refused_card(|card, _| card.pointer_mut(parent).unwrap()[field] = value.clone());
        assert!(error.contains(why), "{pointer}: {error}");
    }
}

/// Puts other tensors under a checkpoint, with a JSON that vouches for them.
fn refused_tensors(bytes: &[u8]) -> String {
    refused_card(|card, folder| {
        card["tensors"]["bytes"] = json!(bytes.len());
        card["tensors"]["sha256"] = json!(sha256_hex(bytes));
        fs::write(folder.join(card["tensors"]["file"].as_str().unwrap()), bytes).unwrap();
    })
}

fn safetensors(header: &str, data: &[u8]) -> Vec<u8> {
    [&(header.len() as u64).to_le_bytes(), header.as_bytes(), data].concat()
}

#[test]
fn hostile_safetensors_are_refused() {
    let (outside, no_header) = ("tensor `w`: does not lie inside the file", "no safetensors header");
    let one = |dtype: &str, shape: &str, offsets: &str, data: &[u8]| {
        let header = format!(r#"{{"w":{{"dtype":"{dtype}","shape":{shape},"data_offsets":{offsets}}}}}"#);
        safetensors(&header, data)
    };
    let entry = r#"{"dtype":"F32","shape":[1],"data_offsets":[0,4]}"#;
    let four = [0; 4];
    for (bytes, why) in [
        (Vec::new(), "header: is cut"),
        (u64::MAX.to_le_bytes().to_vec(), "claims 18446744073709551615 bytes"),
        (100_u64.to_le_bytes().to_vec(), "claims 100 bytes and is cut"),
        (safetensors("{", &[]), "is no JSON"),
        (safetensors(&"[".repeat(100_000), &[]), "is no JSON"),
        // The sum of what this claims goes over the largest integer.
        (one("U8", "[18446744073709551615]", "[0,18446744073709551615]", &four), outside),
        (one("F32", "[2]", "[0,8]", &four), outside),
        (one("F32", "[1]", "[0]", &four), outside),
        (one("F32", "[1]", "[-4,4]", &four), no_header),
        (one("F32", "[2]", "[0,4]", &four), no_header),
        (one("F32", "[1]", "[0,4]", &[0; 8]), no_header),
        (one("F99", "[1]", "[0,4]", &four), no_header),
        (one("F32", "[4294967296,4294967296,4]", "[0,4]", &four), no_header),
        (one("F32", "[1]", "[0,4]", &four), "tensor `gaussians/means`: is missing"),
        (safetensors(&format!(r#"{{"a":{entry},"b":{entry}}}"#), &four), no_header),
    ] {
        let error = refused_tensors(&bytes);
        assert!(error.contains(why), "{error} instead of {why}");
    }
}

#[test]
fn tensors_of_the_wrong_type_or_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    own::write(folder.path(), &Checkpoint { training: Training::default(), ..checkpoint() }).unwrap();
    let good = fs::read(folder.path().join(&names(folder.path())[1])).unwrap();
    let swapped = |from: &str, to: &str| {
        let at = good.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let mut bytes = good.clone();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        refused_tensors(&bytes)
    };
    assert!(swapped("gaussians/sh", "gaussians/xx").contains("tensor `gaussians/sh`: is missing"));
    assert!(
        swapped("deformation/deformation_net.opacity_deform.1.bias", "deformatiom/")
            .contains("is no part of a checkpoint")
    );
    assert!(swapped("\"F32\"", "\"U32\"").contains("is not of type F32"));
    let mut nan = good.clone();
    let header = u64::from_le_bytes(*nan.first_chunk().unwrap()) as usize;
    nan[8 + header..12 + header].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = refused_tensors(&nan);
    assert!(error.contains("NaN"), "{error}");
}

#[test]
fn a_folder_without_a_checkpoint_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = own::read(folder.path()).unwrap_err();
    assert!(error.to_string().contains("checkpoint.json: cannot open"), "{error}");
}
