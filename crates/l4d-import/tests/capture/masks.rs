//! Object masks on the pictures of a capture.

use l4d_formats::npy;
use l4d_import::capture::masks::{MaskFormat, MaskSet, MaskedInstance, read};
use l4d_import::capture::{Capture, Source};
use l4d_masks::{Mask, ids};
use serde_json::json;

use crate::{Bench, llff_row, png, pose};

/// Two cameras, three moments, 64x48; the first is held out.
fn captured() -> (Bench, Capture) {
    let bench = Bench::new();
    let rows: Vec<f64> = (0..2).flat_map(|number| llff_row(pose(number), 140.0)).collect();
    for (number, moment) in (0..2).flat_map(|number| (0..3).map(move |moment| (number, moment))) {
        bench.put(&format!("cam{number:02}/images/{moment:04}.png"), png(64, 48, moment));
    }
    bench.put("poses_bounds.npy", npy::encode_f64(&[2, 17], &rows));
    let capture = bench.read(Source::Neu3d).unwrap();
    (bench, capture)
}

fn set(bench: &Bench, capture: &Capture, format: MaskFormat, path: &str) -> Result<MaskSet, String> {
    read(capture, &bench.input().join(path), format).map_err(|error| error.to_string())
}

/// A mask of an instance; none where it was not annotated or is not visible.
fn mask_at(set: &MaskSet, instance: &MaskedInstance, view: &str, frame: u32) -> Option<Mask> {
    instance.mask(view, frame).map(|mask| Mask::from_rle(mask, set.width, set.height))
}

/// A palette picture whose number 3 fills a square of 64 pixels.
fn drawn(width: u32) -> Vec<u8> {
    let inside = |at: u32| (2..10).contains(&(at % width)) && (2..10).contains(&(at / width));
    ids::encode_palette(
        width,
        48,
        &(0..width * 48).map(|at| if inside(at) { 3 } else { 0 }).collect::<Vec<_>>(),
    )
}

/// COCO with the square of 2 to 10 under a label, a picture each.
fn coco(drawn: &[(&str, &str)]) -> String {
    let (mut images, mut categories, mut annotations) = (Vec::new(), Vec::new(), Vec::new());
    for (id, (file, label)) in drawn.iter().enumerate() {
        images.push(json!({"id": id, "file_name": file, "width": 64, "height": 48}));
        categories.push(json!({"id": id, "name": label}));
        annotations.push(json!({"id": id, "image_id": id, "category_id": id,
                                "segmentation": [[2, 2, 10, 2, 10, 10, 2, 10]]}));
    }
    json!({"images": images, "categories": categories, "annotations": annotations}).to_string()
}

#[test]
fn pictures_find_view_and_frame_by_their_names() {
    let (bench, capture) = captured();
    // Without a view: the one that is held out.
    bench.put("drawn.json", coco(&[("cam01/0002.png", "red cup"), ("0001.png", "cat")]));
    let set = set(&bench, &capture, MaskFormat::Coco, "drawn.json").unwrap();
    let names: Vec<(&str, &str, u32)> =
        set.instances.iter().map(|one| (one.name.as_str(), one.label.as_str(), one.id)).collect();
    assert_eq!(names, [("cat", "cat", 1), ("red_cup", "red cup", 2)]);
    assert_eq!(mask_at(&set, &set.instances[1], "cam01", 2).unwrap().area(), 64);
    assert_eq!(mask_at(&set, &set.instances[0], "cam00", 1).unwrap().area(), 64);
    // Annotated without it: absent. Not annotated: unknown.
    assert_eq!(set.instances[0].masks["cam01"]["0002"], None);
    assert!(!set.instances[0].masks["cam01"].contains_key("0001"));
    let path = set.write(&bench.out(), false).unwrap();
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

    bench.put("data/annotations/train/_annotations.coco.json", coco(&[("0002_png.rf.0af3.jpg", "plate")]));
    let theirs = set(&bench, &capture, MaskFormat::FourDLangSplat, "data").unwrap();
    assert_eq!(mask_at(&theirs, &theirs.instances[0], "cam00", 2).unwrap(), expected);
    // HyperNeRF counts from one.
    let hypernerf = Capture { source: "hypernerf".to_owned(), ..capture.clone() };
    bench.put("data/annotations/video_annotations.json", r#"{"plate": {"the plate that falls": [[3, 6]]}}"#);
    let theirs = set(&bench, &hypernerf, MaskFormat::FourDLangSplat, "data").unwrap();
    assert_eq!(mask_at(&theirs, &theirs.instances[0], "cam00", 1).unwrap(), expected);
    assert!(theirs.notes[0].contains("times of sentences"), "{:?}", theirs.notes);
    bench.put("coco.json", coco(&[("cam01/0000.png", "plate")]));
    let theirs = set(&bench, &capture, MaskFormat::Coco, "coco.json").unwrap();
    // By centres the border at the far side is outside.
    assert_eq!(mask_at(&theirs, &theirs.instances[0], "cam01", 0).unwrap().area(), 64);
}

#[test]
fn annotations_of_other_pictures_are_refused() {
    let (bench, capture) = captured();
    for (files, said) in [
        (&[("a/cam00/0009.png", drawn(64))][..], "frame 9 is not in the capture"),
        (&[("b/cam00/last.png", drawn(64))], "does not end in the number"),
        (&[("c/cam00/0001.png", drawn(32))], "was drawn on 32x48"),
        (&[("e/cam00/0001.png", drawn(64)), ("e/cam00_0001.png", drawn(64))], "annotated twice"),
        (&[("f/cam00/0001.png", ids::encode_palette(64, 48, &[0; 64 * 48]))], "nothing is drawn"),
    ] {
        files.iter().for_each(|(path, bytes)| bench.put(path, bytes));
        let error = set(&bench, &capture, MaskFormat::Png, &files[0].0[..1]).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    bench.put("d.json", coco(&[("cam00/0001.png", "")]));
    let error = set(&bench, &capture, MaskFormat::Coco, "d.json").unwrap_err();
    assert!(error.contains("not a name"), "{error}");
}
