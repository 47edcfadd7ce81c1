use super::*;
use crate::fixture::items;

const GOOD: &str = r#"
schema = "l4d/round/1"
name = "r1"
title = "A test"
profile = "tiny"
seed = 7
annotators = ["ada", "ben"]
rule = "unanimous:2"
views = 3
"#;

fn open(settings: &str, items: &str) -> Result<Round, DataError> {
    let folder = tempfile::tempdir().unwrap();
    let dir = RoundDir::new(folder.path().join("r1"));
    std::fs::create_dir(dir.root()).unwrap();
    std::fs::write(dir.settings(), settings).unwrap();
    std::fs::write(dir.items(), items).unwrap();
    Round::open(&dir)
}

fn lines(items: &[Item]) -> String {
    items.iter().map(|item| serde_json::to_string(item).unwrap() + "\n").collect()
}

fn two_items() -> Vec<Item> {
    items("room", &["The cat", "The dog"])
}

#[track_caller]
fn refused(result: Result<Round, DataError>, expected: &str) {
    let error = result.unwrap_err();
    assert!(error.to_string().contains(expected), "{error}");
    assert!(error.hint().is_some_and(|hint| !hint.is_empty()), "{error} has no remedy");
}

#[test]
fn a_round_is_read_with_its_defaults() {
    let round = open(GOOD, &lines(&two_items())).unwrap();
    assert_eq!((round.frames, round.simulated, round.repeats), (FrameRule::Any, false, 0));
    assert_eq!(round.gold, Gold { absent: 0, vague: 0, flag_below: 0.75 });
    assert_eq!(round.item(&round.items[1].id), Some(&round.items[1]));
    let full = format!("{GOOD}frames = \"iou:0.3\"\nsimulated = true\n[gold]\nabsent = 2\n");
    let round = open(&full, &lines(&two_items())).unwrap();
    assert_eq!((round.frames, round.simulated, round.gold.absent), (FrameRule::Iou(0.3), true, 2));
}

#[test]
fn settings_that_cannot_be_are_refused_by_field() {
    for (from, to, expected) in [
        ("l4d/round/1", "l4d/round/2", "field `schema`"),
        ("\"r1\"", "\"r2\"", "field `name`"),
        ("\"r1\"", "\"../r1\"", "is not a name"),
        ("A test", "A\\u001b[2J", "field `title`"),
        ("\"ben\"", "\"Ada\"", "names one annotator twice"),
        ("unanimous:2", "unanimous:5", "are 2, but the rule `unanimous:5` is about 5"),
        ("unanimous:2", "most", "is not a rule"),
        ("views = 3", "views = 0", "field `views`"),
        ("views = 3", "views = 3\ncolour = 1", "colour"),
        ("seed = 7", "seed = -7", "seed"),
        ("views = 3", "views = 3\n[gold]\nflag_below = 2.0", "gold.flag_below"),
        ("profile = \"tiny\"", "profile = [", "settings"),
    ] {
        assert!(GOOD.contains(from));
        refused(open(&GOOD.replace(from, to), &lines(&two_items())), expected);
    }
}

#[test]
fn what_a_file_holds_does_not_reach_the_terminal() {
    let settings = open(&GOOD.replace("views = 3", "views = \u{1b}[2J"), &lines(&two_items())).unwrap_err();
    let items = open(GOOD, "{\"item\":\"\\u001b[2J\"}").unwrap_err();
    for error in [settings, items] {
        assert!(!error.to_string().contains('\u{1b}'), "{error:?}");
    }
}

#[test]
fn items_that_cannot_be_are_refused_by_name() {
    let good = lines(&two_items());
    for (from, to, expected) in [
        ("q0002", "q0001", "item q0001: is listed twice"),
        ("q0002", "r0002", "is not an item"),
        ("The dog", " ", "field `text`"),
        ("The dog", "\\u001b]0;x", "field `text`"),
        ("room", "../room", "line 1, field"),
        ("\"digest\":\"0", "\"digest\":\"x", "field `digest`"),
        ("\"text\"", "\"kind\":\"gold\",\"text\"", "kind"),
    ] {
        assert!(good.contains(from));
        refused(open(GOOD, &good.replacen(from, to, if from == "room" { 1 } else { 9 })), expected);
    }
    refused(open(GOOD, ""), "asks nothing");
    refused(open(GOOD, "{\"item\":"), "line 1");
    refused(
        open(GOOD, &lines(&items("room", &["The cat"; 3]))),
        "item q0003: asks the same for the third time",
    );
}

#[test]
fn an_unknown_round_is_told_from_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("r1")).unwrap();
    std::fs::write(folder.path().join("r1/round.toml"), GOOD).unwrap();
    let error = Round::open(&RoundDir::new(folder.path().join("r2"))).unwrap_err();
    assert!(error.to_string().contains("no such round"), "{error}");
    assert_eq!(error.hint().as_deref(), Some("choose among r1"));
}
