//! Results that somebody sends to do harm: `l4d check-results` and `l4d score` tell what is wrong, in bounded time and
//! memory, and touch nothing outside.

mod inputs;
mod mutations;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::File;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::support::{self, Dir, QUERIES, Run, SCENES};

const MASK: &str = "results/oracle/masks/room_discs/001.json";
const CARD: &str = "results/oracle/method.json";
/// Address space that is enough for whatever comes, KiB.
const MEMORY_KIB: u32 = 1_500_000;
const SECONDS: u32 = 60;

/// Runs the binary with little memory and time on the profile tiny.
fn bounded(dir: &Dir, arguments: &str) -> Run {
    bounded_line(dir, &format!("{arguments} --profile tiny"))
}

/// Runs the binary with little memory and time.
fn bounded_line(dir: &Dir, line: &str) -> Run {
    let binary = env!("CARGO_BIN_EXE_l4d");
    let script = format!("ulimit -v {MEMORY_KIB}; exec timeout {SECONDS} {binary} {line}");
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(dir.path(""))
        // Each thread reserves address space of its own.
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    output.into()
}

/// Both verbs must find exactly these codes, and nothing may be scored.
fn expect(dir: &Dir, what: &str, codes: &[&str]) -> Vec<Value> {
    let check = bounded(dir, "check-results --json");
    let document = check.value();
    let found: BTreeSet<&str> = support::codes(&document).into_iter().collect();
    assert!(check.code == 1 && found.iter().eq(codes), "{what}: {check}");
    let score = bounded(dir, "score --json");
    assert_eq!(score.code, 1, "{what}: {score}");
    assert!(!dir.path("scores/oracle/counts.csv").exists(), "{what} was scored");
    document["findings"].as_array().unwrap().clone()
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn files_of_ten_gigabytes() {
    let sparse = |path: &Path| File::create(path).unwrap().set_len(10 << 30).unwrap();
    for (path, code) in [(CARD, "L4D302"), (MASK, "L4D314")] {
        let dir = Dir::with_oracle();
        sparse(&dir.path(path));
        expect(&dir, path, &[code]);
    }
    let dir = Dir::with_oracle();
    dir.remove(MASK);
    dir.write("results/oracle/masks/room_discs/001/0000.png", "");
    sparse(&dir.path("results/oracle/masks/room_discs/001/0000.png"));
    expect(&dir, "a picture", &["L4D314"]);
}

#[test]
fn json_without_end() {
    let deep = "[".repeat(80_000);
    let card = format!("{{\"import\":{{\"assumptions\":{deep}");
    let frames = format!("{{\"size\":[96,128],\"frames\":{{\"0000\":{deep}");
    let keys = format!("{{\"size\":[96,128],\"frames\":{{{}\"0000\":null}}}}", "\"0\":null,".repeat(10_001));
    let runs = format!("{{\"size\":[96,128],\"frames\":{{\"0000\":\"{}\"}}}}", "0".repeat(170_000));
    for (path, text, code) in [
        (MASK, deep.as_str(), "L4D312"),
        (MASK, frames.as_str(), "L4D312"),
        (MASK, keys.as_str(), "L4D312"),
        (MASK, runs.as_str(), "L4D310"),
        (CARD, deep.as_str(), "L4D302"),
        (CARD, card.as_str(), "L4D302"),
    ] {
        let dir = Dir::with_oracle();
        dir.write(path, text);
        expect(&dir, &text[..40], &[code]);
    }
    // A billion runs are a file that is never read.
    let dir = Dir::with_oracle();
    dir.write(MASK, format!("{{\"size\":[96,128],\"frames\":{{\"0000\":\"{}\"}}}}", "0".repeat(1 << 20)));
    expect(&dir, "more run lengths than pixels", &["L4D314"]);
}

#[test]
fn links_out_of_the_folder() {
    for (at, to) in [
        ("results/oracle/masks/room_discs", "/etc"),
        (MASK, "/etc/passwd"),
        (MASK, "/dev/zero"),
        (CARD, "/dev/zero"),
        ("results/oracle/masks", "/"),
        ("results/oracle/masks/room_discs/001", "."),
        ("results/other", "/"),
    ] {
        let dir = Dir::with_oracle();
        if dir.path(at).exists() {
            dir.remove(at);
        }
        symlink(to, dir.path(at)).unwrap();
        let check = bounded(&dir, "check-results --json");
        check.says(1, &["L4D313"]);
        assert!(!check.stdout.contains("root:"), "{at} was followed");
        bounded(&dir, "score").says(1, &["L4D313"]);
    }
}

#[test]
fn pipes_without_a_writer() {
    for at in [CARD, MASK, "results/oracle/masks", "results/oracle/masks/room_discs", "results/oracle"] {
        let dir = Dir::with_oracle();
        dir.remove(at);
        pipe(&dir.path(at));
        bounded(&dir, "check-results --json").says(1, &["L4D313"]);
        bounded(&dir, "score").says(1, &["L4D313"]);
    }
    let dir = Dir::with_oracle();
    dir.remove(MASK);
    std::fs::create_dir(dir.path("results/oracle/masks/room_discs/001")).unwrap();
    pipe(&dir.path("results/oracle/masks/room_discs/001/0000.png"));
    expect(&dir, "a picture", &["L4D313"]);
}

#[test]
fn more_files_than_are_read() {
    refused_with_files(20_001);
}

#[test]
#[ignore = "slow: three million files"]
fn a_million_files() {
    refused_with_files(1_000_000);
}

fn refused_with_files(count: u32) {
    let folder = |at: &str| {
        let dir = Dir::with_oracle();
        std::fs::create_dir_all(dir.path(at)).unwrap();
        (0..count).for_each(|index| drop(File::create(dir.path(at).join(format!("{index}"))).unwrap()));
        dir
    };
    let dir = folder("results/oracle/masks/room_discs");
    let findings = expect(&dir, "a scene", &["L4D308", "L4D315"]);
    assert!(findings.iter().any(|finding| finding["message"].as_str().unwrap().contains("20000 entries")));
    // Beside the masks they do not matter.
    let beside = folder("results/oracle/more");
    assert_eq!(bounded(&beside, "check-results").code, 0);
    let methods = folder("results");
    bounded(&methods, "check-results").says(1, &["L4D315"]);
}

#[test]
fn more_bytes_than_are_taken_in() {
    let dir = Dir::with_oracle();
    // Each file is sound and padded: together they are between one and two megabytes.
    for (scene, _) in SCENES {
        for query in QUERIES {
            let mask = format!("results/oracle/masks/{scene}/{query}.json");
            if dir.path(&mask).exists() {
                let text = dir.read(&mask);
                dir.write(&mask, format!("{text}{}", " ".repeat(170_000 - text.len())));
            }
        }
    }
    for verb in ["check-results", "score", "score --protocol davis"] {
        let run = bounded(&dir, &format!("{verb} --json --max-megabytes 1"));
        run.says(1, &["2 MB"]);
        assert_eq!(support::codes(&run.value()), ["L4D316"], "{verb}");
        let written = || {
            let folders = ["scores", "scores-davis"];
            folders.into_iter().filter(|folder| dir.path(folder).exists()).collect::<Vec<_>>()
        };
        assert!(written().is_empty(), "{verb} wrote");
        bounded(&dir, &format!("{verb} --max-megabytes 2")).says(0, &[]);
        assert_eq!(written().len(), usize::from(verb != "check-results"), "{verb}");
        written().into_iter().for_each(|folder| dir.remove(folder));
    }
    // What is refused for its own size is not read, so it doesn't count.
    File::options().write(true).open(dir.path(MASK)).unwrap().set_len(10 << 40).unwrap();
    expect(&dir, "ten terabytes", &["L4D314"]);
}

#[test]
fn more_findings_than_are_listed() {
    let dir = Dir::with_oracle();
    for index in 0..12_000 {
        File::create(dir.path(format!("results/oracle/masks/room_discs/{index}.zip"))).unwrap();
    }
    let findings = expect(&dir, "archives", &["L4D001", "L4D306"]);
    assert_eq!(findings.len(), 10_001);
    assert!(findings[10_000]["message"].as_str().unwrap().starts_with("2000 more"), "{}", findings[10_000]);
}

#[test]
fn names_that_are_no_text_or_steer_terminals() {
    let dir = Dir::with_oracle();
    let scene = dir.path("results/oracle/masks/room_discs");
    for name in [&b"\xff\xfe.json"[..], b"001\xff", b"\x1b]0;gotcha\x07.json", b"00\n1.json", b"..json"] {
        File::create(scene.join(OsStr::from_bytes(name))).unwrap();
    }
    std::fs::create_dir(scene.join(OsStr::from_bytes(b"\x9b2J"))).unwrap();
    let findings = expect(&dir, "names", &["L4D305", "L4D306"]);
    assert_eq!(findings.len(), 5, "hidden names are not looked at");
    let check = bounded(&dir, "check-results");
    assert!(!check.stdout.contains(['\u{1b}', '\u{9b}']), "{}", check.stdout.escape_debug());
    // Nor may a name or a word pass for a line of its own.
    dir.edit(CARD, "\"protocol\": \"l4d\"", "\"protocol\": \"\\u001b[2J\\n0 findings\"");
    dir.edit(CARD, "\"truth_digest\": \"", "\"truth_digest\": \"\\u001b[2J\\n");
    dir.edit(MASK, "{", "{\"\\u001b[2J\\n0 findings\":1,");
    let check = bounded(&dir, "check-results");
    let is_ours =
        |line: &str| ["results/oracle/", "error[L4D", "    "].iter().any(|start| line.starts_with(start));
    assert!(check.stdout.lines().all(is_ours), "{}", check.stdout.escape_debug());
    assert!(!check.stdout.contains('\u{1b}'), "{}", check.stdout.escape_debug());
}
