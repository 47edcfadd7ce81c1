//! `l4d score --sweep`: curves over thresholds, apart from scores.

use std::io::Cursor;
use std::os::unix::fs::symlink;

use image::{GrayImage, ImageFormat, Luma};
use l4d_masks::Mask;
use serde_json::{Value, json};

use crate::support::{Dir, QUERIES, SCENES, named};

/// A grey picture as relevancy is kept.
fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let picture = GrayImage::from_fn(width, height, |col, row| Luma([value(col, row)]));
    picture.write_to(&mut file, ImageFormat::Png).unwrap();
    file.into_inner()
}

/// Relevancy of every query and frame: 200 where the oracle's mask is, 100 in a row of the picture, 0 elsewhere.
fn with_relevancy() -> Dir {
    let dir = Dir::with_oracle();
    for (scene, _) in SCENES {
        for number in QUERIES {
            let file = dir.value(&format!("results/oracle/masks/{scene}/{number}.json"));
            for (frame, counts) in file["frames"].as_object().unwrap() {
                let mask = counts.as_str().map(|counts| Mask::decode(counts, 128, 96).unwrap());
                let is_inside = |col, row| mask.as_ref().is_some_and(|mask| mask.get(col, row));
                let value = |col, row| match (is_inside(col, row), row == 0) {
                    (true, _) => 200,
                    (_, true) => 100,
                    _ => 0,
                };
                dir.write(&format!("results/oracle/soft/{scene}/{number}/{frame}.png"), grey(128, 96, value));
            }
        }
    }
    dir
}

#[test]
fn curves_of_the_truth() {
    let dir = with_relevancy();
    let swept = dir.json("score --sweep --profile tiny");
    assert!(swept["sweep"].as_str().unwrap().contains("no scores"), "{swept}");
    assert_eq!(swept["is_headline"], false);
    let oracle = &swept["methods"][0];
    let hits = oracle["hits"].as_array().unwrap();
    assert!(hits.len() == 20 && hits.iter().all(|hit| hit["macc"] == 100.0), "{hits:?}");
    assert_eq!(oracle["hits_mean"], 100.0);
    let relevancy = &oracle["relevancy"];
    let level = |threshold: usize, column: &str| relevancy["curve"][threshold][column].as_f64().unwrap();
    assert_eq!((level(100, "miou"), level(199, "miou"), level(200, "miou")), (100.0, 100.0, 0.0));
    assert!(level(99, "miou") < 100.0 && level(99, "false_positive_rate") == 100.0);
    assert_eq!((level(100, "false_positive_rate"), level(100, "tube_iou")), (0.0, 100.0));
    assert_eq!(relevancy["oracle_for_all"], json!([100, 100.0]), "of equals the lowest");
    assert_eq!([&relevancy["oracle_by_scene"], &relevancy["oracle_by_query"]], [100.0; 2]);

    let run = dir.succeed("score --sweep --profile tiny");
    assert!(run.stdout.starts_with("sweep: ") && run.stdout.contains("oracle mIoU"), "{run}");
    assert!(!dir.path("scores").exists(), "a sweep wrote scores");
    let csv = dir.read("scores-sweep/oracle/sweep.csv");
    assert_eq!(csv.lines().count(), 1 + 20 + 255);
    assert!(csv.contains("\nrelevancy,100,,100,100,0\n"), "{csv}");
}

#[test]
fn masks_alone_have_a_curve_of_hits() {
    let dir = Dir::with_oracle();
    let swept = dir.json("score --sweep --profile tiny");
    assert_eq!(swept["methods"][0]["relevancy"], Value::Null);
    dir.run("score --sweep --profile tiny --hit-iou 0.5").says(2, &[]);
}

#[test]
fn imports_keep_the_relevancy_that_masks_are_cut_from() {
    let dir = with_relevancy();
    let import = "import generic results/oracle/soft --name maps --profile tiny --soft";
    dir.refuses(import, &["not cut from relevancy", "--inside"]);
    dir.succeed(format!("{import} --inside 'relative 0.2'"));
    let card = dir.value("results/maps/method.json");
    assert_eq!(card["import"]["assumptions"]["relevancy"], "over its own range, 0 to 255");
    let swept = dir.json("score --sweep --profile tiny");
    let curves = |name: &str| named(&swept["methods"], name)["relevancy"].clone();
    assert_eq!(curves("maps")["queries"], curves("oracle")["queries"]);
    // 0.6 of the range, where the masks were cut, and the half that is no mask.
    let miou = |threshold: usize| curves("maps")["curve"][threshold]["miou"].as_f64().unwrap();
    assert!(miou(153) == 100.0 && miou(127) < 100.0, "{} and {}", miou(153), miou(127));
}

#[test]
fn relevancy_that_is_none_is_reported() {
    let map = "results/oracle/soft/room_discs/001/0048.png";
    let expect = |dir: &Dir, code: &str| {
        dir.run("score --sweep --profile tiny").says(1, &[code, "0048.png"]);
        assert!(!dir.path("scores-sweep/oracle").exists());
    };
    let dir = with_relevancy();
    dir.remove(map);
    expect(&dir, "L4D308");
    symlink("/etc/passwd", dir.path(map)).unwrap();
    expect(&dir, "L4D313");
    dir.remove(map);
    dir.write(map, grey(96, 128, |_, _| 0));
    expect(&dir, "L4D311");
    dir.write(map, vec![0; 1 << 20]);
    expect(&dir, "L4D314");
}
