//! `l4d check-results` and `l4d score` on results that are wrong in every way we could think of.

use std::os::unix::fs::symlink;

use serde_json::Value;

use crate::support::{Dir, Run};

const MASK: &str = "results/oracle/masks/room_discs/001.json";
const CARD: &str = "results/oracle/method.json";

fn oracle() -> Dir {
    let dir = Dir::with_benchmark();
    dir.succeed(&["baseline", "oracle", "--profile", "tiny"]);
    dir
}

/// Checks and scores; both must tell the same code, and only that one, and nothing may be scored.
fn expect_code(dir: &Dir, code: &str, words: &[&str]) {
    let check = dir.run(&["check-results", "--profile", "tiny", "--json"]);
    assert_eq!(check.code, 1, "{}\n{}", check.stdout, check.stderr);
    let found: Value = serde_json::from_str(&check.stdout).unwrap();
    let findings = found["findings"].as_array().unwrap();
    let codes: Vec<&str> = findings.iter().map(|finding| finding["code"].as_str().unwrap()).collect();
    assert!(!codes.is_empty() && codes.iter().all(|found| *found == code), "{codes:?} is not {code}");
    let text = findings[0].to_string();
    for word in words {
        assert!(text.contains(word), "`{word}` is not in {text}");
    }
    assert!(!findings[0]["hint"].as_str().unwrap().is_empty(), "{text}");

    let Run { code: exit, stdout, stderr } = dir.run(&["score", "--profile", "tiny"]);
    assert_eq!(exit, 1, "{stdout}\n{stderr}");
    assert!(stdout.contains(code), "{stdout}");
    assert!(!dir.path("scores/oracle/counts.csv").exists(), "bad results were scored");
}

/// A wrong entry of a JSON mask file in place of its first frame.
fn expect_frame(entry: &str, code: &str, words: &[&str]) {
    let dir = oracle();
    let mut file: Value = serde_json::from_str(&dir.read(MASK)).unwrap();
    file["frames"].as_object_mut().unwrap().remove("0000");
    let text = file.to_string().replacen("\"frames\":{", &format!("\"frames\":{{{entry},"), 1);
    dir.write(MASK, text);
    expect_code(&dir, code, words);
}

fn expect_png(bytes: &[u8], code: &str, words: &[&str]) {
    let dir = oracle();
    std::fs::remove_file(dir.path(MASK)).unwrap();
    dir.write("results/oracle/masks/room_discs/001/0000.png", bytes);
    expect_code(&dir, code, words);
}

fn small_png(colour: u8, depth: u8, width: u32, height: u32) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR".to_vec();
    bytes.extend(width.to_be_bytes());
    bytes.extend(height.to_be_bytes());
    bytes.extend([depth, colour, 0, 0, 0]);
    bytes
}

#[test]
fn sound_results_have_no_finding() {
    let dir = oracle();
    let run = dir.succeed(&["check-results", "--profile", "tiny"]);
    assert_eq!(run.stdout, "");
    assert!(run.stderr.contains("0 findings"), "{}", run.stderr);
}

#[test]
fn an_empty_or_missing_folder_is_told() {
    let dir = oracle();
    std::fs::create_dir(dir.path("nothing")).unwrap();
    let empty = dir.run(&["check-results", "nothing", "--profile", "tiny"]);
    assert_eq!(empty.code, 1);
    assert!(empty.stdout.contains("L4D301") && empty.stdout.contains("l4d baseline"), "{}", empty.stdout);
    let missing = dir.run(&["score", "nowhere", "--profile", "tiny"]);
    assert_eq!(missing.code, 2);
    assert!(missing.stderr.contains("nowhere") && missing.stderr.contains("hint:"), "{}", missing.stderr);
}

#[test]
fn cards_are_read_strictly() {
    let dir = oracle();
    std::fs::remove_file(dir.path(CARD)).unwrap();
    expect_code(&dir, "L4D302", &["method.json", "missing"]);
    for (from, to, word) in [
        ("{", "[", "method.json"),
        ("\"name\": \"oracle\"", "\"name\": \"../oracle\"", "name"),
        ("\"name\": \"oracle\"", "\"name\": \"other\"", "folder"),
        ("\"seconds\": null", "\"seconds\": -1", "seconds"),
        ("\"seconds\": null", "\"secs\": null", "secs"),
        ("\"width\": 128", "\"width\": -1", "width"),
    ] {
        let dir = oracle();
        dir.edit(CARD, from, to);
        expect_code(&dir, "L4D302", &[word]);
    }
}

#[test]
fn masks_of_another_benchmark_are_refused_with_the_field() {
    for (from, to, words) in [
        ("\"protocol\": \"l4d\"", "\"protocol\": \"davis\"", ["protocol", "davis"]),
        (
            "\"benchmark_version\": \"0.1.0\"",
            "\"benchmark_version\": \"0.2.0\"",
            ["benchmark_version", "0.2.0"],
        ),
        ("\"truth_digest\": \"", "\"truth_digest\": \"0", ["truth_digest", "--bench"]),
        ("\"profile\": \"tiny\"", "\"profile\": \"full\"", ["profile", "--profile full"]),
        ("\"width\": 128", "\"width\": 256", ["width", "256x96"]),
        ("    12,\n", "", ["frames", "0000, 0012"]),
    ] {
        let dir = oracle();
        dir.edit(CARD, from, to);
        expect_code(&dir, "L4D303", &words);
    }
}

#[test]
fn unknown_scenes_queries_and_files_are_refused() {
    let dir = oracle();
    dir.write("results/oracle/masks/moon/001.json", "{}");
    expect_code(&dir, "L4D304", &["moon", "room_discs"]);
    let dir = oracle();
    dir.write("results/oracle/masks/room_discs/099.json", "{}");
    expect_code(&dir, "L4D305", &["099"]);
    for extra in ["masks/room_discs/readme.txt", "masks/notes.md", "masks/room_discs/001.png"] {
        let dir = oracle();
        dir.write(&format!("results/oracle/{extra}"), "");
        expect_code(&dir, "L4D306", &[extra]);
    }
    let dir = oracle();
    std::fs::remove_file(dir.path(MASK)).unwrap();
    dir.write("results/oracle/masks/room_discs/001/0001.png", "");
    expect_code(&dir, "L4D306", &["0001.png", "0012"]);
}

#[test]
fn doubles_are_refused() {
    let dir = oracle();
    dir.write("results/oracle/masks/room_discs/001/0000.png", "");
    expect_code(&dir, "L4D307", &["001", "PNG"]);
    expect_frame(r#""0000":null,"0000":null"#, "L4D307", &["0000", "twice"]);
}

#[test]
fn missing_frames_are_counted_and_named() {
    let dir = oracle();
    dir.edit(MASK, "\"0000\":", "\"0000\":null,\"9999\":");
    expect_code(&dir, "L4D306", &["9999"]);
    let dir = oracle();
    std::fs::remove_file(dir.path(MASK)).unwrap();
    std::fs::create_dir(dir.path("results/oracle/masks/room_discs/001")).unwrap();
    expect_code(&dir, "L4D308", &["room_discs/001", "9 of 9", "0000, 0012, 0024, 0036, ... 0096"]);
}

#[test]
fn a_scene_without_any_answer_is_told_once() {
    let dir = oracle();
    std::fs::remove_dir_all(dir.path("results/oracle/masks/room_discs")).unwrap();
    for command in [&["check-results"][..], &["score"], &["score", "--protocol", "davis"]] {
        let run = dir.run(&[command, &["--profile", "tiny"]].concat());
        assert_eq!(run.code, 1);
        assert_eq!(run.stdout.matches("L4D308").count(), 1, "{command:?}: {}", run.stdout);
        assert!(run.stdout.contains("queries of scene room_discs") && run.stdout.contains("--scenes"));
    }
}

#[test]
fn bad_run_lengths_are_named() {
    // 128x96 has 12288 pixels, written `PP<`.
    for (counts, words) in [
        ("1", ["cover 1 pixels", "12288"]),
        ("PP<1", ["at least 12289", "12288"]),
        ("1O", ["run 1", "-1"]),
        ("ooooooooo", ["overflows", "0000"]),
        ("P", ["ends inside", "0000"]),
        ("1 2", ["byte 1", "pycocotools"]),
        ("é", ["byte 0", "pycocotools"]),
        ("", ["cover 0 pixels", "12288"]),
    ] {
        expect_frame(&format!(r#""0000":"{counts}""#), "L4D310", &words);
    }
    let dir = oracle();
    dir.edit(MASK, "[96,128]", "[128,96]");
    expect_code(&dir, "L4D309", &["96x128", "size"]);
    let dir = oracle();
    dir.edit(MASK, "[96,128]", "[100000,100000]");
    expect_code(&dir, "L4D309", &["100000x100000"]);
}

#[test]
fn bad_json_is_named_with_its_field() {
    expect_frame(r#""0000":[1,2,3]"#, "L4D312", &["frames", "001.json"]);
    expect_frame(r#""../../0000":null"#, "L4D306", &["../../0000"]);
    for (from, to) in [("{", ""), ("\"size\"", "\"shape\""), ("[96,128]", "[96]"), ("[96,128]", "[-96,128]")]
    {
        let dir = oracle();
        dir.edit(MASK, from, to);
        expect_code(&dir, "L4D312", &["001.json"]);
    }
    let dir = oracle();
    dir.write(MASK, &dir.read(MASK)[..100]);
    expect_code(&dir, "L4D312", &["001.json"]);
}

#[test]
fn bad_pngs_are_named_with_a_remedy() {
    expect_png(b"", "L4D311", &["no PNG"]);
    expect_png(b"GIF89a", "L4D311", &["no PNG"]);
    expect_png(&small_png(3, 8, 128, 96), "L4D311", &["palette", "Pillow"]);
    expect_png(&small_png(0, 16, 128, 96), "L4D311", &["16-bit"]);
    expect_png(&small_png(6, 8, 128, 96), "L4D311", &["RGBA"]);
    expect_png(&small_png(0, 8, 128, 96), "L4D311", &["damaged"]);
    expect_png(&small_png(0, 8, 96, 128), "L4D309", &["96x128"]);
    expect_png(&small_png(0, 1, 100_000, 100_000), "L4D309", &["100000x100000"]);
}

#[test]
fn links_are_refused_wherever_they_stand() {
    for relative in ["method.json", "masks", "masks/room_discs", "masks/room_discs/001.json"] {
        let dir = oracle();
        let path = dir.path("results/oracle").join(relative);
        let elsewhere = dir.path("elsewhere");
        std::fs::rename(&path, &elsewhere).unwrap();
        symlink(&elsewhere, &path).unwrap();
        let run = dir.run(&["check-results", "--profile", "tiny"]);
        assert_eq!(run.code, 1);
        assert!(run.stdout.contains("L4D313"), "{relative}: {}", run.stdout);
        let score = dir.run(&["score", "--profile", "tiny"]);
        assert!(score.code == 1 && score.stdout.contains("L4D313"), "{relative}: {}", score.stdout);
    }
    let dir = oracle();
    std::fs::rename(dir.path("results/oracle"), dir.path("oracle")).unwrap();
    symlink(dir.path("oracle"), dir.path("results/oracle")).unwrap();
    let run = dir.run(&["check-results", "--profile", "tiny"]);
    assert!(run.code == 1 && run.stdout.contains("L4D313"), "{}", run.stdout);
}

#[test]
fn the_folder_that_is_named_may_be_a_link() {
    let dir = oracle();
    std::fs::rename(dir.path("results"), dir.path("disk")).unwrap();
    symlink(dir.path("disk"), dir.path("results")).unwrap();
    dir.succeed(&["check-results", "--profile", "tiny"]);
    dir.succeed(&["check-results", "results/oracle", "--profile", "tiny"]);
    dir.succeed(&["score", "--profile", "tiny"]);
}

#[test]
fn oversized_files_are_refused_unread() {
    let dir = oracle();
    std::fs::remove_file(dir.path(MASK)).unwrap();
    let path = "results/oracle/masks/room_discs/001/0000.png";
    dir.write(path, "");
    std::fs::File::options().write(true).open(dir.path(path)).unwrap().set_len(1 << 33).unwrap();
    expect_code(&dir, "L4D314", &["0000.png"]);
}

#[test]
fn one_bad_method_does_not_stop_the_others_and_all_problems_are_told() {
    let dir = oracle();
    dir.succeed(&["baseline", "none", "--profile", "tiny"]);
    dir.edit(MASK, "\"0000\":\"", "\"0000\":\"~");
    dir.edit("results/oracle/masks/outdoor_discs/002.json", "[96,128]", "[96,129]");
    dir.write("results/oracle/masks/moon/001.json", "{}");
    let run = dir.run(&["score", "--profile", "tiny", "--json"]);
    assert_eq!(run.code, 1);
    let scores: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(scores["methods"].as_array().unwrap().len(), 1);
    let codes: Vec<&str> = scores["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|finding| finding["code"].as_str().unwrap())
        .collect();
    assert_eq!(codes, ["L4D304", "L4D309", "L4D310"]);
    assert!(dir.path("scores/none/counts.csv").exists() && !dir.path("scores/oracle/counts.csv").exists());
}

#[test]
fn an_unwritable_scores_folder_and_a_broken_benchmark_are_told() {
    let dir = oracle();
    dir.write("scores", "a file where the folder should be");
    let run = dir.run(&["score", "--profile", "tiny"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("scores"), "{}", run.stderr);

    let dir = oracle();
    let run = dir.run(&["score", "--profile", "small"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("small") && run.stderr.contains("hint:"), "{}", run.stderr);
    let run = dir.run(&["score", "--profile", "tiny", "--scenes", "moon"]);
    assert!(run.code == 2 && run.stderr.contains("moon"), "{}", run.stderr);
    let run = dir.run(&["score", "--profile", "tiny", "--hit-iou", "NaN"]);
    assert!(run.code == 2 && run.stderr.contains("--hit-iou"), "{}", run.stderr);
    dir.edit("benchmark/queries/room_discs.jsonl", "disc_b", "disc_z");
    let run = dir.run(&["score", "--profile", "tiny"]);
    assert!(run.code == 2 && run.stderr.contains("disc_z"), "{}", run.stderr);
}
