//! Exports in the hands of pycolmap, pycocotools, OpenCV, Pillow, plyfile and NumPy.

use std::process::Command;

use l4d_data::capture::{CAPTURE, Capture};
use l4d_import::export::{Format, HeldOut};

use crate::support::World;
use crate::{Kind, exported, exported_as, probes};

#[test]
#[ignore = "needs L4D_READERS_PYTHON, a Python with the packages that readers.py names"]
fn public_readers_see_what_we_wrote() {
    let python =
        std::env::var("L4D_READERS_PYTHON").expect("set L4D_READERS_PYTHON to a Python with the readers");
    let world = World::new();
    for format in [
        Format::Colmap,
        Format::Davis,
        Format::FourDGaussians,
        Format::Dynerf,
        Format::FourDLangSplatAnnotations,
    ] {
        exported(&world, format, HeldOut::Pose, &world.out(&format.to_string()));
    }
    exported(&world, Format::Coco, HeldOut::Pictures, &world.out("coco"));
    exported_as(Kind::Captured, &world, Format::Colmap, HeldOut::Pose, &world.out("captured/colmap"));
    let folder = world.capture_dir();
    let capture = Capture { points: 0, ..Capture::read(folder.root()).unwrap() };
    l4d_data::json::write(&folder.root().join(CAPTURE), &capture).unwrap();
    exported_as(Kind::Captured, &world, Format::Colmap, HeldOut::Pose, &world.out("captured/without"));
    write_probes(&world);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/readers.py");
    let said = said(Command::new(python).arg(script).arg(world.out("")));
    let last = said.lines().last().unwrap_or_default();
    let counts: Vec<u64> = last.split(' ').map(|count| count.parse().unwrap()).collect();
    assert!(counts.iter().all(|&count| count > 50), "readers saw {counts:?}");
}

/// Points of the world, and where each training camera sees them.
fn write_probes(world: &World) {
    let seen: serde_json::Map<String, serde_json::Value> = world
        .training()
        .into_iter()
        .map(|camera| {
            let pairs: Vec<_> =
                probes(camera, 48).into_iter().map(|(point, at)| (point.to_array(), at.to_array())).collect();
            (camera.name.to_string(), serde_json::to_value(pairs).unwrap())
        })
        .collect();
    std::fs::write(world.out("probes.json"), serde_json::Value::Object(seen).to_string()).unwrap();
}

fn said(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    said
}

#[test]
#[ignore = "needs checkouts of 4DGaussians, 4DLangSplat and nerfstudio, and Python with PyTorch (docs/import/verified.md)"]
fn the_originals_readers_see_what_we_wrote() {
    let [checkouts, python] =
        ["L4D_ORIGINALS", "L4D_ORIGINALS_PYTHON"].map(|name| std::env::var(name).expect(name));
    let checkouts = std::fs::canonicalize(checkouts).unwrap();
    let world = World::new();
    for format in
        [Format::FourDGaussians, Format::Dynerf, Format::FourDLangSplat, Format::Colmap, Format::Nerfstudio]
    {
        exported(&world, format, HeldOut::Pose, &world.out(&format.to_string()));
    }
    write_probes(&world);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/original_readers.py");
    let said = said(Command::new(python).arg(script).arg(checkouts).arg(world.out("")));
    let said: serde_json::Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    assert_eq!(said.as_object().unwrap().len(), 5, "{said}");
    for (format, seen) in said.as_object().unwrap() {
        println!("{format}: {seen}");
        assert!(seen["cameras"].as_u64().unwrap() >= 4, "{format}: {seen}");
    }
}
