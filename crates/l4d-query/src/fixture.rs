//! Small scenes and their queries, for tests.

use l4d_data::query::text_digest;
use l4d_data::tracks::Tracks;
use l4d_data::{Name, Query};

use crate::ast::Predicate;
use crate::prove::SceneSet;

/// A grey box of the given size standing on the floor at (x, y), raised by z.
pub(crate) fn standing(id: u32, name: &str, category: &str, at: [f64; 3], size: [f64; 3]) -> String {
    moving(id, name, category, &[at], size)
}

/// The same along a path of 1 or 97 places.
pub(crate) fn moving(id: u32, name: &str, category: &str, path: &[[f64; 3]], size: [f64; 3]) -> String {
    let role = if id > 1000 { "landmark" } else { "object" };
    let centres: Vec<[f64; 3]> = path.iter().map(|at| [at[0], at[1], at[2] + size[2] / 2.0]).collect();
    format!(
        r#"{{"id":{id},"name":"{name}","role":"{role}","category":"{category}","attributes":{{"colour":"grey"}},"front":"-y","track":{{"centre":{centres:?},"axes":[[1,0,0,0,1,0,0,0,1]],"extents":[{size:?}]}}}}"#
    )
}

pub(crate) fn pair(a: &str, b: &str, distance_m: &[f64]) -> String {
    format!(r#"{{"a":"{a}","b":"{b}","distance_m":{distance_m:?},"contact":[]}}"#)
}

pub(crate) fn event(subject: &str, verb: &str, object: Option<&str>, frames: [u32; 2]) -> String {
    let object = object.map_or("null".to_owned(), |name| format!("\"{name}\""));
    format!(r#"{{"subject":"{subject}","verb":"{verb}","object":{object},"frames":{frames:?}}}"#)
}

pub(crate) fn tracks(instances: &[String], events: &str, pairs: &str) -> Tracks {
    let text = format!(
        r#"{{"schema":"l4d/tracks/1","scene":"s","scale":"tabletop","variant":0,"seed":0,"fps":24,"frame_count":97,"exposure":1,"description":"","pair_reach_m":0.05,"instances":[{}],"events":[{events}],"pairs":[{pairs}],"cameras":[]}}"#,
        instances.join(",")
    );
    serde_json::from_str(&text).unwrap()
}

/// The predicate of a cup with these clauses.
pub(crate) fn cup(clauses: &str) -> Predicate {
    let text = format!(r#"[{{"category":"cup"}},{clauses}]"#);
    Predicate::from_json(&serde_json::from_str(&text).unwrap()).unwrap()
}

/// The query `s/001` about such a cup, which holds in the whole clip.
pub(crate) fn query(text: &str, referents: &[&str], clauses: &str) -> Query {
    let predicate = cup(clauses);
    let value = serde_json::to_value(&predicate).unwrap();
    let line = serde_json::json!({
        "id": "s/001",
        "text": text,
        "categories": predicate.categories(),
        "referents": referents,
        "temporal": "whole",
        "frames": [[0, 96]],
        "text_digest": text_digest(text, Some(&value)),
        "predicate": value,
        "provenance": { "source": "author" },
        "status": "candidate",
    });
    serde_json::from_value(line).unwrap()
}

/// A scene without files that asks these queries.
pub(crate) fn set(tracks: Tracks, queries: Vec<Query>) -> SceneSet {
    SceneSet {
        scene: Name::new("s").unwrap(),
        tracks,
        truth: None,
        queries,
        composites: Vec::new(),
        absents: Vec::new(),
        paths: Default::default(),
    }
}
