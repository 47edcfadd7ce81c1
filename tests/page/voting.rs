//! A whole ballot in a browser, and how it enters its round.

use l4d_data::Name;
use l4d_votes::Ballot;
use serde_json::{Value, json};

use super::browser::Browser;
use crate::annotation_tui::{data, right_keys, round_of};
use crate::support::Dir;

const PAGE: &str = "ada.html";
const IMPORT: &str = "import-ballot ballot.jsonl";

/// A folder with pictures, the open round `r1`, and the page of `ada`.
fn packed() -> Dir {
    let dir = data::dir();
    let shares = "--sample 12 --gold 0.2 --repeats 0.1 --view-count 3 --simulated";
    dir.succeed(format!("open-round r1 --profile tiny --annotators ada,ben,cyd,dee,eve {shares}"));
    dir.succeed(format!("open-round r1 --pack ada --out {PAGE}"));
    dir
}

fn open(dir: &Dir) -> Browser {
    let mut browser = Browser::start(1280, 900);
    browser.open_file(&dir.path(PAGE));
    browser
}

fn press(browser: &mut Browser, keys: &[&str]) -> Value {
    for key in keys {
        browser.evaluate(&format!("vote.press({key:?})"));
    }
    browser.evaluate("vote.state()")
}

/// Answers every item by keys, with a detour on the first.
fn vote(dir: &Dir, browser: &mut Browser) {
    let right = right_keys(dir, "ada");
    press(browser, &["s", "<", "u", "c", "a comment", "Enter", "u"]);
    for turn in 0..=right.len() {
        let state = browser.evaluate("vote.state()");
        if state["mode"] == "summary" {
            return;
        }
        assert!(turn < right.len(), "there is no end of items: {state}");
        match right[&state["item"].as_str().unwrap().parse().unwrap()].as_str() {
            "n" => drop(press(browser, &["n", "Enter"])),
            "a" => drop(press(browser, &["a", "one cannot tell which", "Enter"])),
            keys => {
                let keys: Vec<String> = keys.chars().map(String::from).collect();
                press(browser, &keys.iter().map(String::as_str).collect::<Vec<_>>());
                press(browser, &["Right", "Enter", "Enter"]);
            }
        }
    }
}

#[test]
fn a_ballot_of_the_browser_enters_its_round_as_one_of_the_terminal_does() {
    let dir = packed();
    let html = dir.read(PAGE);
    for scene in data::SCENES {
        let truth: Value = dir.value(&format!("benchmark/truth/tiny/{scene}.json"));
        for instance in truth["instances"].as_array().unwrap() {
            let name = instance["name"].as_str().unwrap();
            assert!(!html.contains(&format!("\"{name}\"")), "the page names {name}");
        }
    }
    let mut browser = open(&dir);
    vote(&dir, &mut browser);
    dir.write("ballot.jsonl", browser.text("vote.ballot()"));
    dir.refuses(IMPORT, &["is not sealed"]);
    browser.evaluate("document.querySelector('#seal').click()");
    browser.until("vote.state().mode === 'sure'");
    browser.evaluate("document.querySelector('#yes').click()");
    browser.until("vote.state().sealed");
    let ballot = browser.text("vote.ballot()");
    dir.write("ballot.jsonl", &ballot);

    dir.run(IMPORT).says(0, &["ada in round r1: imported", "sealed"]);
    let log = dir.read("annotation/rounds/r1/votes/ada.jsonl");
    dir.run(IMPORT).says(0, &["was here already"]);
    assert_eq!(dir.read("annotation/rounds/r1/votes/ada.jsonl"), log);
    assert!(log.lines().all(|line| line.contains("browser")), "the log says where its acts come from");

    let (folder, round) = round_of(&dir);
    let (read, notices) = Ballot::open(&folder, &round, &Name::new("ada").unwrap()).unwrap();
    assert!(notices.is_empty() && read.is_sealed() && read.open_count() == 0, "{notices:?}");
    let shown: Value = dir.json("verdict r1 --unsealed");
    let voted = &shown["agreement"]["annotators"][0];
    assert_eq!(voted["sealed"], true, "{shown}");
    for control in ["gold", "repeats"] {
        assert!(voted[control]["asked"].as_u64() > Some(0), "{control}: {voted}");
        assert_eq!(voted[control]["kept"], voted[control]["asked"], "{control}: {voted}");
    }
    drop(read);

    // The log of an import that was killed holds a beginning, if anything.
    let beginning: String = log.lines().take(5).map(|line| format!("{line}\n")).collect();
    dir.write("annotation/rounds/r1/votes/ada.jsonl", beginning);
    dir.run(IMPORT).says(0, &["imported"]);
    assert_eq!(dir.read("annotation/rounds/r1/votes/ada.jsonl"), log);
}

/// The file with its digests made right again, as somebody might who edits its head; the chain is left broken if wanted.
fn chained(text: &str, broken: bool) -> String {
    let mut before: Option<String> = None;
    let line = |line: &str| {
        let line = match &before {
            Some(before) if !broken => {
                let (head, _) = line.split_once("\"prev\":\"").unwrap();
                format!("{head}\"prev\":\"{}\"}}", l4d_data::digest::sha256_hex(before.as_bytes()))
            }
            _ => line.to_owned(),
        };
        before = Some(line.clone());
        line + "\n"
    };
    text.lines().map(line).collect()
}

#[test]
fn what_is_no_ballot_of_the_round_is_refused_and_changes_nothing() {
    let dir = packed();
    let mut browser = open(&dir);
    vote(&dir, &mut browser);
    let open = browser.text("vote.ballot()");
    // Sealed by hand, as anybody could.
    let last = open.trim_end().lines().last().unwrap();
    let seal = json!({
        "at": "2026-01-01T00:00:00.000Z",
        "event": "seal",
        "acts": open.trim_end().lines().count() - 1,
        "prev": l4d_data::digest::sha256_hex(last.as_bytes()),
    });
    let sealed = format!("{}\n{seal}\n", open.trim_end());
    let cases: [(&str, &str, &str); 6] = [
        ("\"event\":\"choose\"", "\"event\":\"skip\"", "does not follow the line before it"),
        ("\"acts\":", "\"acts\":9", "counts other acts"),
        ("\"round\":\"r1\"", "\"round\":\"r2\"", "no such round"),
        ("\"annotator\":\"ada\"", "\"annotator\":\"zoe\"", "zoe"),
        ("l4d/offline-ballot/1", "l4d/offline-ballot/9", "field `schema`"),
        ("\"round_sha256\":\"", "\"round_sha256\":\"0", "of another round"),
    ];
    for (from, to, says) in cases {
        assert!(sealed.contains(from), "{from}");
        dir.write("ballot.jsonl", chained(&sealed.replacen(from, to, 1), from.contains("event")));
        dir.refuses(IMPORT, &[says]);
    }
    for garbage in ["", "{}", "\u{0}\u{1}\n{}", "[1,2"] {
        dir.write("ballot.jsonl", garbage);
        dir.refuses(IMPORT, &["ballot.jsonl"]);
    }
    assert!(!dir.path("annotation/rounds/r1/votes/ada.jsonl").exists(), "nothing was written");
    dir.write("ballot.jsonl", &sealed);
    dir.run(IMPORT).says(0, &["imported"]);
    // Votes of the terminal stay.
    dir.write("annotation/rounds/r1/votes/ada.jsonl", "");
    dir.run(IMPORT).says(0, &["imported"]);
}
