use super::*;
use crate::fixture::{self, event, moving, pair, query, standing, tracks};

/// Sentence, referent, clause.
type Asked = (&'static str, &'static str, &'static str);

/// Three grey cups: `a` is pushed far, `b` is big and at the hand, `c` stands still.
fn set(queries: &[Asked]) -> SceneSet {
    let path: Vec<[f64; 3]> = (0..97).map(|frame| [f64::from(frame) / 10.0, 5.0, 0.0]).collect();
    let nudge: Vec<[f64; 3]> = (0..97).map(|frame| [1.0 + f64::from(frame) / 1000.0, 0.0, 0.0]).collect();
    let instances = [
        moving(1, "a", "cup", &path, [0.1; 3]),
        moving(2, "b", "cup", &nudge, [0.2; 3]),
        standing(3, "c", "cup", [3., 0., 0.], [0.1; 3]),
        standing(1001, "hand", "hand", [1.3, 0., 0.], [0.1; 3]),
        standing(1002, "box", "box", [3., 0.3, 0.], [0.1; 3]),
    ];
    let events = [event("hand", "push", Some("a"), [40, 60]), event("hand", "poke", Some("b"), [0, 20])];
    let tracks = tracks(&instances, &events.join(","), &pair("b", "hand", &[0.01]));
    let query = |(index, (text, referent, clause)): (usize, &Asked)| Query {
        id: format!("s/{:03}", index + 1).parse().unwrap(),
        ..query(text, &[referent], clause)
    };
    fixture::set(tracks, queries.iter().enumerate().map(query).collect())
}

fn accuracy(set: &SceneSet, name: &str) -> f64 {
    let probes = measure(std::slice::from_ref(set));
    probes.iter().find(|probe| probe.name == name).unwrap().accuracy
}

const PUSHED: Asked = ("the pushed cup", "a", r#"{"undergoes":{"verb":"push","by":{"category":"hand"}}}"#);
const AT_BOX: Asked = ("the cup at the box", "c", r#"{"relation":{"kind":"beside","of":[{"name":"box"}]}}"#);
const POKED: Asked = ("the poked cup", "b", r#"{"undergoes":{"verb":"poke","by":{"category":"hand"}}}"#);

#[test]
fn each_shortcut_finds_what_it_looks_for() {
    let one = |query, name: &str| accuracy(&set(&[query]), name);
    assert_eq!(one(PUSHED, "most moving"), 100.0);
    assert_eq!(one(AT_BOX, "least moving"), 100.0);
    assert_eq!(one(AT_BOX, "nearest landmark"), 100.0);
    assert_eq!(one(POKED, "nearest landmark"), 100.0);
    assert_eq!(one(PUSHED, "nearest landmark"), 0.0);
    assert_eq!(one(POKED, "largest box"), 100.0);
    assert_eq!(one(PUSHED, "busy at half-time"), 100.0);
    assert_eq!(one(POKED, "busy at half-time"), 0.0);
    assert_eq!(one(PUSHED, "reads one frame"), 100.0);
    // Nothing is poked in the middle frame: no information is chance.
    assert_eq!(one(POKED, "reads one frame"), 33.3);
    let first = r#"{"first":{"undergoes":{"verb":"push","by":{"category":"hand"}}}}"#;
    let ends = r#"{"at_end":{"relation":{"kind":"beside","of":[{"name":"hand"}]}}}"#;
    assert_eq!(one(("the first", "a", first), "reads one frame"), 100.0);
    assert_eq!(one(("the one that ends", "b", ends), "reads one frame"), 100.0);
    // All cups are grey: the colour tells nothing, whether it is said or not.
    let grey = ("the grey cup at the box", AT_BOX.1, AT_BOX.2);
    assert_eq!((one(AT_BOX, "colour only"), one(grey, "colour only")), (33.3, 33.3));
}

#[test]
fn a_balanced_set_holds_every_bound_and_a_lopsided_one_does_not() {
    let beyond = |queries: &[_]| -> Vec<&str> {
        let probes = measure(&[set(queries)]);
        probes.iter().filter(|probe| probe.is_beyond()).map(|probe| probe.name).collect()
    };
    assert_eq!(beyond(&[PUSHED, POKED, AT_BOX]), ["nearest landmark"]);
    assert_eq!(beyond(&[PUSHED]), ["most moving", "busy at half-time"]);
}

#[test]
fn attribute_queries_are_not_tried_and_missing_pictures_cannot_be() {
    let grey = ("the grey cup", "a", r#"{"attribute":{"key":"colour","value":"grey"}}"#);
    let probes = measure(&[set(&[grey, PUSHED])]);
    let queries = |name: &str| probes.iter().find(|probe| probe.name == name).unwrap().queries;
    assert_eq!(queries("most moving"), 1);
    assert_eq!(queries("most pixels"), 0);
}
