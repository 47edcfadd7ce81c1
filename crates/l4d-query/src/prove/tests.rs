use std::path::Path;

use l4d_data::tracks::Tracks;
use l4d_data::{Interval, Query, Report, Severity, Status, Temporal};

use super::{Kind, Prover, SceneSet, check_each_is_asked, check_scene};
use crate::fixture::{event, moving, query, set, standing, tracks};

/// Three cups and a pen. The left hand lifts a, then b; the right one lifts c. The cups a and b are red, c is blue.
/// The cup b drifts away from the box: 9.5 cm from it until frame 48, then 1 m.
fn scene() -> Tracks {
    let red = |text: String| text.replace("grey", "red");
    let path: Vec<[f64; 3]> =
        (0..97).map(|frame| [0.0, if frame <= 48 { 0.195 } else { 1.1 }, 0.0]).collect();
    let instances = [
        red(standing(1, "a", "cup", [0., -0.15, 0.], [0.1; 3])),
        red(moving(2, "b", "cup", &path, [0.1; 3])),
        standing(3, "c", "cup", [2., 0., 0.], [0.1; 3]).replace("grey", "blue"),
        standing(4, "pen", "pen", [3., 0., 0.], [0.1; 3]),
        standing(1001, "left", "hand", [5., 0., 0.], [0.1; 3]),
        standing(1002, "right", "hand", [6., 0., 0.], [0.1; 3]),
        standing(1003, "box", "box", [0., 0., 0.], [0.1; 3]),
    ];
    let events = [
        event("left", "lift", Some("a"), [10, 30]),
        event("left", "lift", Some("b"), [50, 70]),
        event("right", "lift", Some("c"), [50, 70]),
        event("right", "wave", None, [50, 70]),
        event("a", "shake", None, [10, 30]),
        event("c", "shake", None, [50, 70]),
    ];
    tracks(&instances, &events.join(","), "")
}

fn codes(kind: Kind, query: &Query) -> Vec<&'static str> {
    let tracks = scene();
    let mut report = Report::default();
    Prover::new(&tracks, None, None).check(kind, Path::new("s.jsonl"), query, &mut report);
    report.into_sorted().into_iter().map(|finding| finding.code).collect()
}

const RED: &str = r#"{"attribute":{"key":"colour","value":"red"}}"#;
const BLUE: &str = r#"{"attribute":{"key":"colour","value":"blue"}}"#;
const SHAKES: &str = r#"{"does":{"verb":"shake"}}"#;
const BY_LEFT: &str = r#"{"undergoes":{"verb":"lift","by":{"name":"left"}}}"#;

#[test]
fn single_queries() {
    let single = |query: Query| codes(Kind::Single, &query);
    assert_eq!(single(query("the blue cup", &["c"], BLUE)), [""; 0]);
    assert_eq!(single(query("the red cup", &["a"], RED)), ["L4D204"]);
    assert_eq!(single(query("the red cup", &["a", "b"], RED)), ["L4D202"]);
    let frames = vec![Interval::new(10, 30).unwrap()];
    let shaken = Query { temporal: Temporal::While, frames, ..query("the cup while shaken", &["a"], SHAKES) };
    assert_eq!(single(shaken), ["L4D206"]);
    let not_c = format!(r#"{SHAKES},{{"not":{BLUE}}}"#);
    // Two categories do not belong among the single ones, and a red cup that shakes is a composite.
    assert_eq!(single(query("the cup, not blue, that shakes", &["a"], &not_c)), ["L4D207"]);
    assert_eq!(codes(Kind::Composite, &query("the cup, not blue, that shakes", &["a"], &not_c)), [""; 0]);
}

#[test]
fn both_halves_of_a_composite_are_ambiguous() {
    let composite = |clauses: &str| codes(Kind::Composite, &query("the cup", &["a"], clauses));
    assert_eq!(composite(&format!("{RED},{SHAKES}")), [""; 0]);
    // "Lifted first" alone means a.
    let first = r#"{"first":{"undergoes":{"verb":"lift","by":{"category":"hand"}}}}"#;
    assert_eq!(composite(&format!("{RED},{first}")), ["L4D205"]);
    assert_eq!(composite(RED), ["L4D204", "L4D207"]);
    // Action with interaction is none of the five pairs.
    assert_eq!(composite(&format!("{SHAKES},{BY_LEFT}")), ["L4D207"]);
}

#[test]
fn nothing_satisfies_an_absent_sentence() {
    let absent = |clauses: &str| codes(Kind::Absent, &query("the cup", &[], clauses));
    assert_eq!(absent(r#"{"attribute":{"key":"colour","value":"green"}}"#), [""; 0]);
    assert_eq!(absent(r#"{"does":{"verb":"explode"}}"#), [""; 0]);
    assert_eq!(absent(BLUE), ["L4D217"]);
    assert_eq!(codes(Kind::Absent, &query("the cup", &["c"], BLUE)), ["L4D202"]);
}

#[test]
fn descriptions_mean_one_unless_the_sentence_says_a() {
    let lifted_by = |text: &str, hand: &str| {
        let clause =
            format!(r#"{{"undergoes":{{"verb":"lift","by":{{"such":[{{"category":"hand"}}{hand}]}}}}}}"#);
        codes(Kind::Single, &query(text, &["c"], &clause))
    };
    assert_eq!(lifted_by("the cup that the waving hand lifts", r#",{"does":{"verb":"wave"}}"#), [""; 0]);
    assert_eq!(lifted_by("the cup that the shaking hand lifts", r#",{"does":{"verb":"shake"}}"#), ["L4D208"]);
    assert_eq!(lifted_by("the cup that the hand lifts", ""), ["L4D208"]);
    // "A hand" may be any, but then it is any cup.
    assert_eq!(lifted_by("the cup that a hand lifts", ""), ["L4D204"]);
}

#[test]
fn no_answer_hangs_on_a_threshold() {
    let single = |query: &Query| codes(Kind::Single, query);
    let at =
        |wrap: &str| format!(r#"{{"{wrap}":{{"relation":{{"kind":"beside","of":[{{"name":"box"}}]}}}}}}"#);
    // Beside the box means 10 cm: a stands at 5 cm, b just within until frame 48.
    assert_eq!(single(&query("the cup beside the box at the end", &["a"], &at("at_end"))), [""; 0]);
    let start = query("the cup beside the box at the start", &["a"], &at("at_start"));
    assert_eq!(single(&start), ["L4D204"]);
    let tracks = {
        // Just outside: nominal means a alone, 10 % looser means b as well.
        let mut tracks = scene();
        tracks.instances[1].track.centre[0][1] += 0.01;
        tracks
    };
    let mut report = Report::default();
    Prover::new(&tracks, None, None).check(Kind::Single, Path::new("q"), &start, &mut report);
    let findings = report.into_sorted();
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert!(findings[0].code == "L4D211" && findings[0].message.contains("looser"), "{findings:?}");
}

#[test]
fn a_scene_asks_for_everything_once() {
    let mut set = set(scene(), vec![query("the blue cup", &["c"], BLUE)]);
    set.composites = vec![query("The blue cup", &["c"], BLUE)];
    let codes = |set: &SceneSet| -> Vec<&str> {
        let mut report = Report::default();
        check_scene(set, None, &mut report);
        check_each_is_asked(set, &mut report);
        let findings = report.into_sorted().into_iter();
        findings
            .map(|finding| finding.code)
            .filter(|code| !["L4D220", "L4D223", "L4D207"].contains(code))
            .collect()
    };
    // The same id, sentence and predicate in another file; a, b and pen are never asked for.
    let mut found = codes(&set);
    found.sort_unstable();
    assert_eq!(found, ["L4D209", "L4D209", "L4D209", "L4D212", "L4D213", "L4D213"]);
    set.composites.clear();
    assert_eq!(codes(&set), ["L4D209"; 3]);
    // What only a rejected query asks for is worth a look, not an error.
    set.queries[0].status = Status::Rejected;
    let mut report = Report::default();
    check_each_is_asked(&set, &mut report);
    let unasked = report.into_sorted().into_iter().filter(|finding| finding.code == "L4D209");
    let warned: Vec<String> =
        unasked.filter(|found| found.severity == Severity::Warning).map(|found| found.location).collect();
    assert_eq!(warned, ["instance c"]);
}
