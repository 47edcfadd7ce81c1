//! Object masks on the pictures of a capture.

use l4d_frames::{Mask, ids};
use l4d_import::capture::masks::{MaskFormat, MaskSet, mask_at, read};
use l4d_import::capture::{Capture, Source};
use l4d_import::npy;
use serde_json::json;

use crate::{Bench, png, pose};

/// Two cameras, three moments, 64x48; the first is held out.
fn captured() -> (Bench, Capture) {
    let bench = Bench::new();
    let mut rows = Vec::new();
    for number in 0..2 {
        let pose = pose(number);
        for axis in 0..3 {
            let hwf = [48.0, 64.0, 70.0][axis];
            rows.extend([pose.y_axis[axis], pose.x_axis[axis], -pose.z_axis[axis], pose.w_axis[axis], hwf]);
        }
        rows.extend([0.5, 20.0]);
        for moment in 0..3 {
            bench.put(&format!("cam{number:02}/images/{moment:04}.png"), png(64, 48, moment));
        }
    }
    bench.put("poses_bounds.npy", npy::encode_f64(&[2, 17], &rows));
    let capture = bench.read(Source::Neu3d).unwrap();
    (bench, capture)
}

fn set(bench: &Bench, capture: &Capture, format: MaskFormat, path: &str) -> Result<MaskSet, String> {
    read(capture, &bench.input().join(path), format).map_err(|error| error.to_string())
}

fn square(first: f64, last: f64) -> serde_json::Value {
    json!([[first, first], [last, first], [last, last], [first, last]])
}

fn labelme(label: &str, width: u32) -> String {
    json!({"imagePath": "x.png", "imageWidth": width, "imageHeight": 48,
           "shapes": [{"label": label, "points": square(2.0, 10.0), "shape_type": "polygon"}]})
    .to_string()
}

#[test]
fn files_a_picture_find_view_and_frame_by_their_names() {
    let (bench, capture) = captured();
    bench.put("drawn/cam01/0002.json", labelme("red cup", 64));
    // Without a view: the one that is held out.
    bench.put("drawn/0001.json", labelme("cat", 64));
    let set = set(&bench, &capture, MaskFormat::Labelme, "drawn").unwrap();
    let names: Vec<(&str, &str, u32)> =
        set.instances.iter().map(|one| (one.name.as_str(), one.label.as_str(), one.id)).collect();
    assert_eq!(names, [("cat", "cat", 1), ("red_cup", "red cup", 2)]);
    assert_eq!(mask_at(&set, &set.instances[1], "cam01", 2).unwrap().area(), 64);
    assert_eq!(mask_at(&set, &set.instances[0], "cam00", 1).unwrap().area(), 64);
    // Annotated without it: said to be absent. Not annotated: not said.
    assert_eq!(set.instances[0].masks["cam01"]["0002"], None);
    assert!(!set.instances[0].masks["cam01"].contains_key("0001"));
    let path = set.write(&bench.out()).unwrap();
    let again: MaskSet = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!(again, set);
}

#[test]
fn palettes_and_coco_and_4d_langsplat_give_the_same_pixels() {
    let (bench, capture) = captured();
    let expected = Mask::from_fn(64, 48, |col, row| (2..=10).contains(&col) && (2..=10).contains(&row));
    let numbers: Vec<u8> = expected.to_bools().into_iter().map(|inside| if inside { 4 } else { 0 }).collect();
    bench.put("ids/cam00_0002.png", ids::encode_palette(64, 48, &numbers));
    let palette = set(&bench, &capture, MaskFormat::Png, "ids").unwrap();
    assert_eq!(palette.instances[0].name.as_str(), "object_4");
    assert_eq!(mask_at(&palette, &palette.instances[0], "cam00", 2).unwrap(), expected);

    let flat = [2, 2, 10, 2, 10, 10, 2, 10];
    let document = |file: &str| {
        json!({"images": [{"id": 1, "file_name": file, "width": 64, "height": 48}], "categories": [{"id": 3, "name": "plate"}],
               "annotations": [{"id": 1, "image_id": 1, "category_id": 3, "segmentation": [flat], "bbox": [], "area": 1, "iscrowd": 0}]})
        .to_string()
    };
    bench.put("data/annotations/train/_annotations.coco.json", document("0002_png.rf.0af3.jpg"));
    let theirs = set(&bench, &capture, MaskFormat::FourDLangSplat, "data").unwrap();
    assert_eq!(mask_at(&theirs, &theirs.instances[0], "cam00", 2).unwrap(), expected);
    bench.put("coco.json", document("cam01/0000.png"));
    let coco = set(&bench, &capture, MaskFormat::Coco, "coco.json").unwrap();
    // By centres the border at the far side is outside.
    assert_eq!(mask_at(&coco, &coco.instances[0], "cam01", 0).unwrap().area(), 64);
}

#[test]
fn annotations_of_other_pictures_are_refused() {
    let (bench, capture) = captured();
    for (path, text, said) in [
        ("a/cam00/0009.json", labelme("x", 64), "frame 9 is not in the capture"),
        ("b/cam00/last.json", labelme("x", 64), "does not end in the number"),
        ("c/cam00/0001.json", labelme("x", 32), "was drawn on 32x48"),
        ("d/cam00/0001.json", labelme("", 64), "not a name"),
    ] {
        bench.put(path, text);
        let error = set(&bench, &capture, MaskFormat::Labelme, &path[..1]).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    bench.put("e/cam00/0001.json", labelme("x", 64));
    bench.put("e/cam00_0001.json", labelme("x", 64));
    let error = set(&bench, &capture, MaskFormat::Labelme, "e").unwrap_err();
    assert!(error.contains("annotated twice"), "{error}");
    bench.put(
        "f/cam00/0001.json",
        json!({"imagePath": "x", "imageWidth": 64, "imageHeight": 48, "shapes": []}).to_string(),
    );
    assert!(set(&bench, &capture, MaskFormat::Labelme, "f").unwrap_err().contains("nothing is drawn"));
}
