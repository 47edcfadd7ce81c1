use super::*;
use crate::fixture::items;

const GOOD: &str = r#"
schema = "l4d/round/1"
name = "r1"
profile = "tiny"
seed = 7
annotators = ["ada", "ben"]
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
    assert!(error.to_string().contains(expected) && !error.to_string().contains('\u{1b}'), "{error:?}");
    assert!(!error.hint().is_empty(), "{error} has no hint");
}

#[test]
fn a_round_is_read_with_its_defaults() {
    let round = open(GOOD, &lines(&two_items())).unwrap();
    assert_eq!((round.simulated, round.repeats, round.gold), (false, 0, Gold::default()));
    assert_eq!(round.item(&round.items[1].id), Some(&round.items[1]));
    let full = format!("{GOOD}simulated = true\n[gold]\nabsent = 2\n");
    let round = open(&full, &lines(&two_items())).unwrap();
    assert_eq!((round.simulated, round.gold.absent), (true, 2));
}

#[test]
fn settings_that_cannot_be_are_refused_by_field() {
    for (from, to, expected) in [
        ("l4d/round/1", "l4d/round/2", "field `schema`"),
        ("\"r1\"", "\"r2\"", "field `name`"),
        ("\"r1\"", "\"../r1\"", "is not a name"),
        ("\"ben\"", "\"Ada\"", "names one annotator twice"),
        ("[\"ada\", \"ben\"]", "[]", "names no one"),
        ("views = 3", "views = 0", "field `views`"),
        ("views = 3", "views = 3\ncolour = 1", "colour"),
        ("views = 3", "views = \u{1b}[2J", "line "),
        ("seed = 7", "seed = -7", "seed"),
        ("profile = \"tiny\"", "profile = [", "line "),
    ] {
        assert!(GOOD.contains(from));
        refused(open(&GOOD.replace(from, to), &lines(&two_items())), expected);
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
    refused(open(GOOD, "{\"item\":\"\\u001b[2J\"}"), "line 1");
    refused(
        open(GOOD, &lines(&items("room", &["The cat"; 3]))),
        "item q0003: asks the same for the third time",
    );
}
