//! Annotations of other tools: what is understood, what is left out and said, and what is refused.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::path::PathBuf;

use l4d_data::DataError;
use l4d_import::annotations::coco::{self, Reading};
use l4d_import::annotations::fill::Rule;
use l4d_import::annotations::{Annotations, four_d_langsplat};
use serde_json::json;

/// Writes a file that lives as long as the folder.
fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = l4d_testing::folder();
    let path = folder.path().join("annotation");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn refusal(read: Result<Annotations, DataError>) -> String {
    read.unwrap_err().to_string()
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
