//! `l4d score --sweep`: curves over thresholds, apart from scores.

use std::os::unix::fs::symlink;

use serde_json::Value;

use crate::support::{Dir, QUERIES, SCENES};

/// Rows of an 8-bit grayscale PNG whose stream is stored, not compressed.
fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let mut rows = Vec::new();
    for row in 0..height {
        rows.push(0);
        rows.extend((0..width).map(|col| value(col, row)));
    }
    let mut stream = vec![0x78, 0x01, 0x01];
    stream.extend((rows.len() as u16).to_le_bytes());
    stream.extend((!(rows.len() as u16)).to_le_bytes());
    stream.extend(&rows);
    let (mut low, mut high) = (1_u32, 0_u32);
    for &byte in &rows {
        low = (low + u32::from(byte)) % 65_521;
        high = (high + low) % 65_521;
    }
    stream.extend((high << 16 | low).to_be_bytes());
    let mut header = width.to_be_bytes().to_vec();
    header.extend(height.to_be_bytes());
    header.extend([8, 0, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (kind, data) in [(b"IHDR", header.as_slice()), (b"IDAT", &stream), (b"IEND", &[])] {
        file.extend((data.len() as u32).to_be_bytes());
        let chunk = [kind.as_slice(), data].concat();
        file.extend(&chunk);
        file.extend(checksum(&chunk).to_be_bytes());
    }
    file
}

/// CRC-32 as in PNG.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |sum: u32, byte: &u8| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 })
    };
    !bytes.iter().fold(u32::MAX, step)
}

fn oracle() -> Dir {
    let dir = Dir::with_benchmark();
    dir.succeed(&["baseline", "oracle", "--profile", "tiny"]);
    dir
}

/// Relevancy of every query and frame: 200 where the oracle's mask is, 100 in a row of the picture, 0 elsewhere.
fn with_relevancy() -> Dir {
    let dir = oracle();
    for (scene, _) in SCENES {
        for number in QUERIES {
            let text = dir.read(&format!("results/oracle/masks/{scene}/{number}.json"));
            let file: Value = serde_json::from_str(&text).unwrap();
            for (frame, counts) in file["frames"].as_object().unwrap() {
                let mask = counts.as_str().map(|counts| l4d_masks::Mask::decode(counts, 128, 96).unwrap());
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
    let swept = dir.json(&["score", "--sweep", "--profile", "tiny"]);
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
    assert_eq!(relevancy["oracle_for_all"], serde_json::json!([100, 100.0]), "of equals the lowest");
    assert_eq!(
        (&relevancy["oracle_by_scene"], &relevancy["oracle_by_query"]),
        (&100.0.into(), &100.0.into())
    );

    let run = dir.succeed(&["score", "--sweep", "--profile", "tiny"]);
    assert!(run.stdout.starts_with("sweep: ") && run.stdout.contains("oracle mIoU"), "{}", run.stdout);
    assert!(!dir.path("scores").exists(), "a sweep wrote scores");
    let csv = dir.read("scores-sweep/oracle/sweep.csv");
    assert_eq!(csv.lines().count(), 1 + 20 + 255);
    assert!(csv.contains("\nrelevancy,100,,100,100,0\n"), "{csv}");
}

#[test]
fn masks_alone_have_a_curve_of_hits() {
    let dir = oracle();
    let swept = dir.json(&["score", "--sweep", "--profile", "tiny"]);
    assert_eq!(swept["methods"][0]["relevancy"], Value::Null);
    let refused = dir.run(&["score", "--sweep", "--profile", "tiny", "--hit-iou", "0.5"]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
}

#[test]
fn imports_keep_the_relevancy_that_masks_are_cut_from() {
    let dir = with_relevancy();
    let import = ["import", "generic", "results/oracle/soft", "--name", "maps", "--profile", "tiny"];
    let refused = dir.run(&[&import[..], &["--soft"]].concat());
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("not cut from relevancy") && refused.stderr.contains("--inside"));
    dir.succeed(&[&import[..], &["--inside", "relative 0.2", "--soft"]].concat());
    let card: Value = serde_json::from_str(&dir.read("results/maps/method.json")).unwrap();
    assert_eq!(card["import"]["assumptions"]["relevancy"], "over its own range, 0 to 255");
    let swept = dir.json(&["score", "--sweep", "--profile", "tiny"]);
    let curves = |name: &str| {
        let methods = swept["methods"].as_array().unwrap();
        methods.iter().find(|method| method["name"] == name).unwrap()["relevancy"].clone()
    };
    assert_eq!(curves("maps")["queries"], curves("oracle")["queries"]);
    // 0.6 of the range, where the masks were cut, and the half that is no mask.
    let miou = |threshold: usize| curves("maps")["curve"][threshold]["miou"].as_f64().unwrap();
    assert!(miou(153) == 100.0 && miou(127) < 100.0, "{} and {}", miou(153), miou(127));
}

#[test]
fn relevancy_that_is_none_is_told() {
    let map = "results/oracle/soft/room_discs/001/0048.png";
    let expect = |dir: &Dir, code: &str| {
        let run = dir.run(&["score", "--sweep", "--profile", "tiny"]);
        assert!(
            run.code == 1 && run.stdout.contains(code) && run.stdout.contains("0048.png"),
            "{}",
            run.stdout
        );
        assert!(!dir.path("scores-sweep/oracle").exists());
    };
    let dir = with_relevancy();
    std::fs::remove_file(dir.path(map)).unwrap();
    expect(&dir, "L4D308");
    symlink("/etc/passwd", dir.path(map)).unwrap();
    expect(&dir, "L4D313");
    std::fs::remove_file(dir.path(map)).unwrap();
    dir.write(map, grey(96, 128, |_, _| 0));
    expect(&dir, "L4D311");
    dir.write(map, vec![0; 1 << 20]);
    expect(&dir, "L4D314");
}
