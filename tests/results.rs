//! `l4d check-results` and `l4d score` on results that are wrong in every way we could think of.

use std::io::Cursor;
use std::os::unix::fs::symlink;

use image::{DynamicImage, ImageFormat};
use l4d_masks::{Mask, ids, png};
use serde_json::{Value, json};

use crate::support::{Dir, codes};

const MASK: &str = "results/oracle/masks/room_discs/001.json";
const CARD: &str = "results/oracle/method.json";
/// A picture of a mask, where the results have a JSON file.
const PNG: &str = "results/oracle/masks/room_discs/001/0000.png";
const CHECK: &str = "check-results --profile tiny";
const SCORE: &str = "score --profile tiny";

/// Checks and scores; both must say the same code, and only that one, and nothing may be scored.
fn expect_code(dir: &Dir, code: &str, words: &[&str]) {
    let check = dir.run(format!("{CHECK} --json"));
    let found = check.value();
    let codes = codes(&found);
    assert!(!codes.is_empty() && codes.iter().all(|found| *found == code), "{codes:?} is not {code}");
    check.says(1, &[]);
    let finding = &found["findings"][0];
    let text = finding.to_string();
    for word in words {
        assert!(text.contains(word), "`{word}` is not in {text}");
    }
    assert!(!finding["hint"].as_str().unwrap().is_empty(), "{text}");
    dir.run(SCORE).says(1, &[code]);
    assert!(!dir.path("scores/oracle/counts.csv").exists(), "bad results were scored");
}

/// Demands a code for each of some changes to a file, one at a time: what is written, what instead.
fn expect_of_edits(file: &str, code: &str, cases: &[(&str, &str, &[&str])]) {
    let dir = Dir::with_oracle();
    let whole = dir.read(file);
    for (from, to, words) in cases {
        dir.edit(file, from, to);
        expect_code(&dir, code, words);
        dir.write(file, &whole);
    }
}

/// Demands a code for entries of a JSON mask file in place of its first frame.
fn expect_of_frames(cases: &[(&str, &str, &[&str])]) {
    let dir = Dir::with_oracle();
    dir.change(MASK, |file| drop(file["frames"].as_object_mut().unwrap().remove("0000")));
    let others = dir.read(MASK);
    for (entry, code, words) in cases {
        dir.write(MASK, others.replacen("\"frames\":{", &format!("\"frames\":{{{entry},"), 1));
        expect_code(&dir, code, words);
    }
}

#[test]
fn sound_results_have_no_finding() {
    let run = Dir::with_oracle().succeed(CHECK);
    assert!(run.stdout.is_empty() && run.stderr.contains("0 findings"), "{run}");
}

#[test]
fn results_begin_with_a_card_that_only_lacks_masks() {
    let dir = Dir::with_benchmark();
    let begin = "init-results mine --profile tiny --used-depth --seconds 12.5";
    let run = dir.succeed(begin);
    assert_eq!(run.stdout.trim(), "results/mine");
    let card: Value = serde_json::from_str(&dir.read("results/mine/method.json")).unwrap();
    assert_eq!(
        (&card["used"]["depth"], &card["seconds"], &card["width"]),
        (&json!(true), &json!(12.5), &json!(128))
    );
    let found = dir.run("check-results results/mine --profile tiny --json").value();
    assert!(codes(&found).iter().all(|code| *code == "L4D308"), "{found}");
    dir.succeed(begin);
    dir.refuses("init-results mine --profile tiny", &["results/mine/method.json", "--force"]);
    dir.succeed("init-results mine --profile tiny --force");
    dir.run("init-results ../mine --profile tiny").says(2, &["../mine"]);
    assert!(!dir.path("mine").exists());
}

#[test]
fn an_empty_or_missing_folder_is_reported() {
    let dir = Dir::with_oracle();
    std::fs::create_dir(dir.path("nothing")).unwrap();
    dir.run(format!("{CHECK} nothing")).says(1, &["L4D301", "l4d baseline"]);
    dir.refuses(format!("{SCORE} nowhere"), &["nowhere"]);
}

#[test]
fn cards_are_read_strictly() {
    let dir = Dir::with_oracle();
    dir.remove(CARD);
    expect_code(&dir, "L4D302", &["method.json", "missing"]);
    expect_of_edits(
        CARD,
        "L4D302",
        &[
            ("{", "[", &["method.json"]),
            ("\"name\": \"oracle\"", "\"name\": \"../oracle\"", &["name"]),
            ("\"name\": \"oracle\"", "\"name\": \"other\"", &["folder"]),
            ("\"seconds\": null", "\"seconds\": -1", &["seconds"]),
            ("\"seconds\": null", "\"secs\": null", &["secs"]),
            ("\"width\": 128", "\"width\": -1", &["width"]),
        ],
    );
}

#[test]
fn masks_of_another_benchmark_are_refused_with_the_field() {
    let version = "\"benchmark_version\": \"0.";
    expect_of_edits(
        CARD,
        "L4D303",
        &[
            ("\"protocol\": \"l4d\"", "\"protocol\": \"davis\"", &["protocol", "davis"]),
            (&format!("{version}1"), &format!("{version}2"), &["benchmark_version", "0.2.0"]),
            ("\"truth_digest\": \"", "\"truth_digest\": \"0", &["truth_digest", "--bench"]),
            ("\"profile\": \"tiny\"", "\"profile\": \"full\"", &["profile", "--profile full"]),
            ("\"width\": 128", "\"width\": 256", &["width", "256x96"]),
            ("    12,\n", "", &["frames", "0000, 0012"]),
        ],
    );
}

#[test]
fn files_that_belong_to_nothing_or_are_doubled_are_refused() {
    let masks = "results/oracle/masks";
    for (file, text, code, words) in [
        ("moon/001.json", "{}", "L4D304", ["moon", "room_discs"]),
        ("room_discs/099.json", "{}", "L4D305", ["099", "room_discs"]),
        ("room_discs/readme.txt", "", "L4D306", ["readme.txt", "room_discs"]),
        ("notes.md", "", "L4D306", ["notes.md", "masks"]),
        ("room_discs/001.png", "", "L4D306", ["001.png", "room_discs"]),
        ("room_discs/001/0000.png", "", "L4D307", ["001", "PNG"]),
    ] {
        let dir = Dir::with_oracle();
        dir.write(&format!("{masks}/{file}"), text);
        expect_code(&dir, code, &words);
    }
    let dir = Dir::with_oracle();
    dir.remove(MASK);
    dir.write(&format!("{masks}/room_discs/001/0001.png"), "");
    expect_code(&dir, "L4D306", &["0001.png", "0012"]);
}

#[test]
fn a_query_or_a_scene_without_any_answer_is_reported_once() {
    let dir = Dir::with_oracle();
    dir.remove(MASK);
    std::fs::create_dir(dir.path("results/oracle/masks/room_discs/001")).unwrap();
    expect_code(&dir, "L4D308", &["room_discs/001", "9 of 9", "0000, 0012, 0024, 0036, ... 0096"]);
    dir.remove("results/oracle/masks/room_discs");
    for command in [CHECK, SCORE, "score --protocol davis --profile tiny"] {
        let run = dir.run(command);
        run.says(1, &["queries of scene room_discs", "--scenes"]);
        assert_eq!(run.stdout.matches("L4D308").count(), 1, "{command}: {run}");
    }
}

#[test]
fn bad_frames_are_named() {
    // 128x96 has 12288 pixels, written `PP<`.
    expect_of_frames(&[
        (r#""0000":"1""#, "L4D310", &["cover 1 pixels", "12288"]),
        (r#""0000":"PP<1""#, "L4D310", &["at least 12289", "12288"]),
        (r#""0000":"1O""#, "L4D310", &["run 1", "-1"]),
        (r#""0000":"ooooooooo""#, "L4D310", &["overflows", "0000"]),
        (r#""0000":"P""#, "L4D310", &["ends inside", "0000"]),
        (r#""0000":"1 2""#, "L4D310", &["byte 1", "pycocotools"]),
        (r#""0000":"é""#, "L4D310", &["byte 0", "pycocotools"]),
        (r#""0000":"""#, "L4D310", &["cover 0 pixels", "12288"]),
        (r#""0000":[1,2,3]"#, "L4D312", &["frames", "001.json"]),
        (r#""../../0000":null"#, "L4D306", &["../../0000"]),
        (r#""0000":null,"9999":null"#, "L4D306", &["9999"]),
        (r#""0000":null,"0000":null"#, "L4D307", &["0000", "twice"]),
    ]);
}

#[test]
fn bad_json_is_named_with_its_field() {
    expect_of_edits(
        MASK,
        "L4D309",
        &[("[96,128]", "[128,96]", &["96x128", "size"]), ("[96,128]", "[100000,100000]", &["100000x100000"])],
    );
    expect_of_edits(
        MASK,
        "L4D312",
        &[
            ("{", "", &["001.json"]),
            ("\"size\"", "\"shape\"", &["001.json"]),
            ("[96,128]", "[96]", &["001.json"]),
            ("[96,128]", "[-96,128]", &["001.json"]),
            ("]", "", &["001.json"]),
        ],
    );
}

fn png_of(picture: &DynamicImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn bad_pngs_are_named_with_a_hint() {
    let dir = Dir::with_oracle();
    dir.remove(MASK);
    let whole = png::encode(&Mask::full(128, 96));
    let mut huge = whole.clone();
    huge[16..24].copy_from_slice(&[100_000_u32.to_be_bytes(); 2].concat());
    for (bytes, code, words) in [
        (Vec::new(), "L4D311", &["no PNG"][..]),
        (b"GIF89a".to_vec(), "L4D311", &["no PNG"]),
        (ids::encode_palette(128, 96, &[0; 128 * 96]), "L4D311", &["palette", "Pillow"]),
        (png_of(&DynamicImage::new_luma16(128, 96)), "L4D311", &["16-bit"]),
        (png_of(&DynamicImage::new_rgba8(128, 96)), "L4D311", &["RGBA"]),
        (whole[..whole.len() / 2].to_vec(), "L4D311", &["damaged"]),
        (png::encode(&Mask::full(96, 128)), "L4D309", &["96x128"]),
        (huge, "L4D309", &["100000x100000"]),
    ] {
        dir.write(PNG, bytes);
        expect_code(&dir, code, words);
    }
    // An oversized file is refused unread.
    std::fs::File::options().write(true).open(dir.path(PNG)).unwrap().set_len(1 << 33).unwrap();
    expect_code(&dir, "L4D314", &["0000.png"]);
}

#[test]
fn links_are_refused_wherever_they_are_in_the_folder_that_is_named() {
    let places = ["method.json", "masks", "masks/room_discs", "masks/room_discs/001.json", ""];
    for place in places.map(|place| format!("results/oracle/{place}")) {
        let place = place.trim_end_matches('/');
        let dir = Dir::with_oracle();
        dir.rename(place, "elsewhere");
        symlink(dir.path("elsewhere"), dir.path(place)).unwrap();
        dir.run(CHECK).says(1, &["L4D313"]);
        dir.run(SCORE).says(1, &["L4D313"]);
    }
    let dir = Dir::with_oracle();
    dir.rename("results", "disk");
    symlink(dir.path("disk"), dir.path("results")).unwrap();
    for command in [CHECK, "check-results results/oracle --profile tiny", SCORE] {
        dir.succeed(command);
    }
}

#[test]
fn one_bad_method_does_not_stop_the_others_and_all_problems_are_reported() {
    let dir = Dir::with_oracle();
    dir.succeed("baseline none --profile tiny");
    dir.edit(MASK, "\"0000\":\"", "\"0000\":\"~");
    dir.edit("results/oracle/masks/outdoor_discs/002.json", "[96,128]", "[96,129]");
    dir.write("results/oracle/masks/moon/001.json", "{}");
    let run = dir.run(format!("{SCORE} --json"));
    assert_eq!(run.code, 1);
    let scores = run.value();
    assert_eq!(scores["methods"].as_array().unwrap().len(), 1);
    assert_eq!(codes(&scores), ["L4D304", "L4D309", "L4D310"]);
    assert!(dir.path("scores/none/counts.csv").exists() && !dir.path("scores/oracle/counts.csv").exists());
}

#[test]
fn an_unwritable_scores_folder_and_a_broken_benchmark_are_reported() {
    let dir = Dir::with_oracle();
    dir.write("scores", "a file where the folder should be");
    dir.run(SCORE).says(2, &["scores"]);
    dir.remove("scores");
    dir.refuses("score --profile small", &["small"]);
    dir.run(format!("{SCORE} --scenes moon")).says(2, &["moon"]);
    dir.run(format!("{SCORE} --hit-iou NaN")).says(2, &["--hit-iou"]);
    dir.edit("benchmark/queries/room_discs.jsonl", "disc_b", "disc_z");
    dir.run(SCORE).says(2, &["disc_z"]);
}
