//! Annotations of other tools: what is understood, what is left out and said, and what is refused.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::path::PathBuf;

use l4d_data::DataError;
use l4d_import::annotations::coco::{self, Reading};
use l4d_import::annotations::fill::Rule;
use l4d_import::annotations::isat::{self, Layers};
use l4d_import::annotations::{Annotations, cvat, four_d_langsplat, labelme};
use serde_json::json;

/// Writes a file that lives as long as the folder.
fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("annotation");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn refusal(read: Result<Annotations, DataError>) -> String {
    read.unwrap_err().to_string()
}

fn labelme(value: serde_json::Value) -> Result<Annotations, DataError> {
    let (_folder, path) = file(&value.to_string());
    labelme::read(&path)
}

#[test]
fn labelme_shapes_become_pixels_and_lines_are_said_to_be_none() {
    let square = json!([[2.0, 2.0], [6.0, 2.0], [6.0, 6.0], [2.0, 6.0]]);
    let read = labelme(json!({
        "version": "5.4.1", "imagePath": "000001.png", "imageWidth": 20, "imageHeight": 10, "imageData": null, "flags": {},
        "shapes": [
            {"label": "cup", "points": square, "shape_type": "polygon", "group_id": 3, "flags": {}},
            {"label": "cup", "points": [[8, 1], [10, 3]], "shape_type": "rectangle", "group_id": null},
            {"label": "plate", "points": [[14, 5], [17, 5]], "shape_type": "circle"},
            {"label": "edge", "points": [[0, 0], [9, 9]], "shape_type": "line"},
        ],
    }))
    .unwrap();
    let picture = &read.pictures[0];
    assert_eq!((picture.file_name.as_str(), picture.width, picture.height), ("000001.png", 20, 10));
    assert_eq!(picture.labels(), ["cup", "plate"]);
    assert_eq!(picture.union_of("cup").area(), 16 + 4);
    assert_eq!(picture.objects[0].group, Some(3));
    let circle = picture.union_of("plate").area();
    assert!((26..=32).contains(&circle), "a circle of radius 3 has {circle} pixels");
    assert_eq!(read.notes.len(), 1);
    assert!(read.notes[0].contains("`line`"), "{}", read.notes[0]);
}

#[test]
fn labelme_without_a_size_or_with_an_absurd_one_is_refused() {
    let error = labelme(json!({"imagePath": "a", "imageHeight": 3, "shapes": []}));
    assert!(refusal(error).contains("imageWidth"));
    let error =
        labelme(json!({"imagePath": "a", "imageWidth": 4_000_000_000_u32, "imageHeight": 3, "shapes": []}));
    assert!(refusal(error).contains("4000000000x3"));
}

#[test]
fn isat_layers_cover_each_other_unless_langsplat_reads_them() {
    let square = |first: i32, last: i32| json!([[first, first], [last, first], [last, last], [first, last]]);
    let document = json!({
        "info": {"description": "ISAT", "folder": "", "name": "frame_00041.jpg", "width": 12, "height": 12, "depth": 3, "note": ""},
        "objects": [
            {"category": "plate", "group": 1, "segmentation": square(0, 9), "area": 100.0, "layer": 1.0, "bbox": [0, 0, 9, 9], "iscrowd": false, "note": ""},
            {"category": "cookie", "group": 2, "segmentation": square(1, 3), "area": 9.0, "layer": 2.0, "bbox": [1, 1, 3, 3], "iscrowd": false, "note": ""},
            {"category": "__background__", "group": 3, "segmentation": square(5, 6), "area": 4.0, "layer": 3.0, "bbox": [5, 5, 6, 6], "iscrowd": false, "note": ""},
        ],
    });
    let (_folder, path) = file(&document.to_string());
    let drawn = isat::read(&path, Layers::Cover).unwrap();
    assert_eq!(drawn.pictures[0].labels(), ["cookie", "plate"]);
    assert_eq!(drawn.pictures[0].union_of("plate").area(), 100 - 9 - 4);
    let original = isat::read(&path, Layers::Ignore).unwrap();
    assert_eq!(original.pictures[0].union_of("plate").area(), 100);
    assert_eq!(original.pictures[0].labels().len(), 3);
}

#[test]
fn cvat_knows_polygons_boxes_and_masks() {
    let xml = r#"<?xml version="1.0" encoding="utf-8"?>
        <annotations><version>1.1</version><meta><task><name>a &amp; b</name></task></meta>
        <image id="0" name="frames/0000.png" width="10" height="8">
            <polygon label="red cup" source="manual" occluded="0" points="1.0,1.0;4.0,1.0;4.0,3.0;1.0,3.0" z_order="0" group_id="2"></polygon>
            <box label="table &lt;left&gt;" xtl="5" ytl="0" xbr="7" ybr="2" z_order="0"/>
            <mask label="cat" rle="1, 2, 3" left="2" top="4" width="3" height="2" z_order="0"/>
            <polyline label="edge" points="0,0;1,1"/>
        </image>
        <image id="1" name="frames/0001.png" width="10" height="8"/></annotations>"#;
    let (_folder, path) = file(xml);
    let read = cvat::read(&path).unwrap();
    assert_eq!(read.pictures.len(), 2);
    let picture = &read.pictures[0];
    assert_eq!(picture.labels(), ["cat", "red cup", "table <left>"]);
    assert_eq!((picture.union_of("red cup").area(), picture.objects[0].group), (6, Some(2)));
    assert_eq!(picture.union_of("table <left>").area(), 4);
    assert_eq!(picture.union_of("cat").pixels().collect::<Vec<_>>(), [(3, 4), (4, 4)]);
    assert!(read.pictures[1].objects.is_empty());
    assert!(read.notes[0].contains("polyline"));
}

#[test]
fn cvat_files_that_lie_are_refused() {
    let image = |inside: &str| {
        format!(r#"<annotations><image name="a" width="10" height="8">{inside}</image></annotations>"#)
    };
    for (text, said) in [
        (
            image(r#"<mask label="a" rle="0,99" left="0" top="0" width="2" height="2"/>"#),
            "covers more than its box",
        ),
        (
            image(r#"<mask label="a" rle="0,1" left="9" top="0" width="4294967295" height="2"/>"#),
            "leaves the picture",
        ),
        (image(r#"<polygon label="a" points="1,2;x"/>"#), "`points`"),
        (image(r#"<polygon points="1,2;3,4;5,6"/>"#), "`label` is missing"),
        (r#"<annotations><track id="0"/></annotations>"#.to_owned(), "tracks of a video"),
        (r#"<annotations><polygon label="a" points="1,1"/></annotations>"#.to_owned(), "outside of an image"),
        ("<annotations>".to_owned(), "no `image`"),
        (r#"<annotations><image name="a" width="1" height="#.to_owned(), ""),
    ] {
        let (_folder, path) = file(&text);
        let error = refusal(cvat::read(&path));
        assert!(error.contains(said), "{error}");
    }
}

fn coco_of(segmentation: serde_json::Value) -> serde_json::Value {
    json!({
        "info": {}, "licenses": [],
        "images": [{"id": 5, "file_name": "000123_png.rf.ab12.jpg", "width": 8, "height": 6}],
        "categories": [{"id": 0, "name": "things"}, {"id": 1, "name": "glass cup"}],
        "annotations": [{"id": 9, "image_id": 5, "category_id": 1, "bbox": [0, 0, 1, 1], "area": 1, "segmentation": segmentation, "iscrowd": 0}],
    })
}

#[test]
fn coco_reads_polygons_and_both_run_lengths() {
    let everything = Reading { rule: Rule::Centres, first_polygon_only: false };
    let area = |segmentation: serde_json::Value, reading: Reading| {
        let (_folder, path) = file(&coco_of(segmentation).to_string());
        let read = coco::read(&path, reading).unwrap();
        (read.pictures[0].union_of("glass cup").area(), read.notes)
    };
    let two = json!([[0, 0, 2, 0, 2, 2, 0, 2], [4, 4, 6, 4, 6, 6, 4, 6]]);
    assert_eq!(area(two.clone(), everything), (8, Vec::new()));
    let (pixels, notes) = area(two, four_d_langsplat::READING);
    assert_eq!(pixels, 9, "the original fills the first polygon with its border");
    assert!(notes[0].contains("1 polygons beyond the first"), "{notes:?}");
    assert_eq!(area(json!({"size": [6, 8], "counts": [6, 3, 39]}), everything).0, 3);
    // pycocotools: mask.encode of the same three pixels.
    assert_eq!(area(json!({"size": [6, 8], "counts": "63W1"}), everything).0, 3);
}

#[test]
fn coco_that_names_what_is_not_there_is_refused() {
    let reading = Reading { rule: Rule::Centres, first_polygon_only: false };
    let refused = |document: serde_json::Value| {
        let (_folder, path) = file(&document.to_string());
        refusal(coco::read(&path, reading))
    };
    let mut document = coco_of(json!([]));
    document["annotations"][0]["image_id"] = json!(7);
    assert!(refused(document).contains("image 7 is missing"));
    let mut document = coco_of(json!([]));
    document["annotations"][0]["category_id"] = json!(7);
    assert!(refused(document).contains("category 7 is missing"));
    assert!(refused(coco_of(json!([[1, 2, 3]]))).contains("a column without a row"));
    assert!(refused(coco_of(json!({"size": [8, 6], "counts": "0"}))).contains("run lengths are for 6x8"));
    assert!(
        refused(coco_of(json!({"size": [6, 8], "counts": [1, 18446744073709551615_u64]})))
            .contains("do not cover")
    );
}
