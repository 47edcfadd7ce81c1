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
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/readers.py");
    let output = Command::new(python).arg(script).arg(world.out("")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    let last = said.lines().last().unwrap_or_default();
    let counts: Vec<u64> = last.split(' ').map(|count| count.parse().unwrap()).collect();
    assert!(counts.iter().all(|&count| count > 50), "readers saw {counts:?}");
}
