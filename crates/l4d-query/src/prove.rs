//! The proof that each query has exactly one answer, and the count of the set.
//!
//! Everything is decided from the tracks; whether a referent can be seen comes from the truth file, where there is
//! one. Findings L4D2xx are listed in `docs/findings.md`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use l4d_data::timeline::{FRAME_COUNT, Interval, LAST_FRAME, MIN_INTERVAL};
use l4d_data::tracks::Tracks;
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, Category, Name, Profile, Query, Report, Role, Scale, Status, Temporal};
use serde::Serialize;

use crate::ast::{Clause, Predicate, Relation};
use crate::eval::{Answer, answer_at, answer_whole};
use crate::world::World;

/// What the set holds, in the shape of `check-queries --json`.
#[derive(Debug, Default, Serialize)]
pub struct SetSummary {
    /// Scenes checked.
    pub scenes: usize,
    /// Scenes per scale.
    pub scales: BTreeMap<&'static str, usize>,
    /// Objects that queries may refer to.
    pub instances: usize,
    /// Scored queries per category.
    pub queries: BTreeMap<&'static str, usize>,
    /// Queries that people have verified.
    pub verified: usize,
    /// Queries that people have rejected; they are in no other count.
    pub rejected: usize,
}

impl SetSummary {
    /// Scored queries of all categories.
    pub fn total(&self) -> usize {
        self.queries.values().sum()
    }
}

/// Checks the queries of the scenes and counts the set.
pub fn check_set(bench: &Benchmark, profile: Profile, scenes: &[Name], report: &mut Report) -> SetSummary {
    let mut summary = SetSummary::default();
    for scale in Scale::ALL {
        summary.scales.insert(scale.as_str(), 0);
    }
    for category in Category::ALL {
        summary.queries.insert(category.as_str(), 0);
    }
    for scene in scenes {
        match (bench.tracks(scene), bench.queries(scene)) {
            (Ok(tracks), Ok(queries)) => {
                count(&mut summary, &tracks, &queries);
                let truth =
                    bench.dir.truth(profile, scene).exists().then(|| bench.truth(profile, scene)).transpose();
                let truth = truth.unwrap_or_else(|error| {
                    report.data_error("L4D201", &error);
                    None
                });
                check_scene(&bench.dir.queries(scene), &tracks, truth.as_ref(), &queries, report);
            }
            (tracks, queries) => {
                for error in [tracks.err(), queries.err()].into_iter().flatten() {
                    report.data_error("L4D201", &error);
                }
            }
        }
    }
    summary
}

fn count(summary: &mut SetSummary, tracks: &Tracks, queries: &[Query]) {
    summary.scenes += 1;
    *summary.scales.entry(tracks.scale.as_str()).or_default() += 1;
    summary.instances += tracks.instances.iter().filter(|instance| instance.role == Role::Object).count();
    for query in queries {
        match query.status {
            Status::Rejected => summary.rejected += 1,
            Status::Verified => summary.verified += 1,
            Status::Candidate => {}
        }
        if let ([category], true) = (query.categories.as_slice(), query.status != Status::Rejected) {
            *summary.queries.entry(category.as_str()).or_default() += 1;
        }
    }
}

/// Checks the queries of one scene; `path` is their file.
pub fn check_scene(
    path: &Path,
    tracks: &Tracks,
    truth: Option<&Truth>,
    queries: &[Query],
    report: &mut Report,
) {
    let world = World::new(tracks);
    let mut asked: BTreeSet<&Name> = BTreeSet::new();
    for query in queries.iter().filter(|query| query.status != Status::Rejected) {
        asked.extend(&query.referents);
        let mut problems = Problems { path, query, report };
        problems.check(&world, truth);
    }
    for object in world.objects().filter(|object| !asked.contains(&object.name)) {
        report.warning(
            "L4D209",
            path,
            format!("instance {}", object.name),
            "no query refers to this object",
            "write a query for it, or make it scenery",
        );
    }
}

/// Collects what is wrong with one query.
struct Problems<'a> {
    path: &'a Path,
    query: &'a Query,
    report: &'a mut Report,
}

impl Problems<'_> {
    fn add(&mut self, code: &'static str, message: String, hint: &str) {
        let place = format!("query {} (\"{}\")", self.query.id, self.query.text);
        self.report.error(code, self.path, place, message, hint);
    }

    fn check(&mut self, world: &World<'_>, truth: Option<&Truth>) {
        if !self.names_are_known(world) || !self.frames_fit() {
            return;
        }
        if let Some(truth) = truth {
            self.check_visibility(truth);
        }
        let Some(value) = &self.query.predicate else {
            return self.add(
                "L4D203",
                "has no predicate".into(),
                "only queries of real scenes may go without one",
            );
        };
        let predicate = match Predicate::from_json(value) {
            Ok(predicate) => predicate,
            Err(message) => {
                return self.add(
                    "L4D203",
                    format!("predicate: {message}"),
                    "see docs/formats.md, Predicates",
                );
            }
        };
        if self.vocabulary_is_known(world, &predicate) {
            self.check_category(&predicate);
            self.check_answer(world, &predicate);
            self.check_ambiguity(world, &predicate);
        }
    }

    fn names_are_known(&mut self, world: &World<'_>) -> bool {
        let is_object =
            |name: &&Name| world.instance(name).is_some_and(|instance| instance.role == Role::Object);
        let unknown: Vec<&Name> = self.query.referents.iter().filter(|name| !is_object(name)).collect();
        for name in &unknown {
            self.add(
                "L4D202",
                format!("referent `{name}` is no object of the scene"),
                "name an instance with role object",
            );
        }
        unknown.is_empty()
    }

    fn frames_fit(&mut self) -> bool {
        let frames = &self.query.frames;
        let whole = *frames == [Interval::WHOLE];
        let message = match self.query.temporal {
            Temporal::Whole if !whole => {
                Some(format!("temporal is `whole`, but frames are not [[0, {LAST_FRAME}]]"))
            }
            Temporal::While if frames.iter().any(|interval| interval.last() > LAST_FRAME) => {
                Some(format!("frames go beyond {LAST_FRAME}"))
            }
            Temporal::While if frames.iter().any(|interval| interval.frame_count() < MIN_INTERVAL) => {
                Some(format!("an interval is shorter than {MIN_INTERVAL} frames, so a profile could miss it"))
            }
            _ => None,
        };
        if let Some(message) = &message {
            self.add("L4D206", message.clone(), "write the interval in which the predicate holds");
        }
        message.is_none()
    }

    fn vocabulary_is_known(&mut self, world: &World<'_>, predicate: &Predicate) -> bool {
        let mut unknown: Vec<String> = predicate
            .mentions()
            .into_iter()
            .filter(|name| world.instance(name).is_none())
            .map(|name| format!("`{name}` is no instance of the scene"))
            .collect();
        unknown.extend(predicate.0.iter().filter_map(|clause| unknown_word(world, clause)));
        for message in &unknown {
            self.add("L4D203", format!("predicate: {message}"), "use what benchmark/scenes declares");
        }
        unknown.is_empty()
    }

    fn check_category(&mut self, predicate: &Predicate) {
        let follows = predicate.categories();
        if follows != self.query.categories {
            let message =
                format!("categories are {:?}, but the predicate gives {follows:?}", self.query.categories);
            self.add("L4D207", message, "the category is that of the discriminating clause");
        }
    }

    fn check_answer(&mut self, world: &World<'_>, predicate: &Predicate) {
        let claimed: Answer = self.query.referents.iter().cloned().collect();
        match self.query.temporal {
            Temporal::Whole => {
                let answer = answer_whole(world, predicate);
                if answer != claimed {
                    let message = format!("means {}, but refers to {}", list(&answer), list(&claimed));
                    self.add(
                        "L4D204",
                        message,
                        "sharpen the sentence and its predicate, or correct the referents",
                    );
                }
            }
            Temporal::While => {
                let wrong = (0..FRAME_COUNT).find_map(|frame| {
                    let answer = answer_at(world, predicate, frame);
                    let expected = if self.query.holds_at(frame) { claimed.clone() } else { Answer::new() };
                    (answer != expected).then_some((frame, answer, expected))
                });
                if let Some((frame, answer, expected)) = wrong {
                    let message =
                        format!("at frame {frame} means {}, but claims {}", list(&answer), list(&expected));
                    self.add("L4D206", message, "write the interval in which the predicate holds");
                }
            }
        }
    }

    /// There are look-alikes, and the discriminating clauses are what tells them apart.
    fn check_ambiguity(&mut self, world: &World<'_>, predicate: &Predicate) {
        let referents = self.query.referents.len();
        for category in predicate.categories() {
            let without = predicate.without(category);
            let left = answer_whole(world, &without).len();
            if left <= referents {
                let message =
                    format!("without its {} clause ({without}) it means the same", category.as_str());
                self.add("L4D205", message, "a query needs a distractor that only this clause excludes");
            }
        }
    }

    fn check_visibility(&mut self, truth: &Truth) {
        for name in &self.query.referents {
            let seen = truth.instance(name).is_some_and(|instance| {
                truth.frames.iter().any(|&frame| {
                    self.query.holds_at(frame)
                        && instance.masks.contains_key(&l4d_data::truth::frame_key(frame))
                })
            });
            if !seen {
                let message = format!("`{name}` is never visible in the held-out view while the query holds");
                self.add("L4D210", message, "move the cameras or the object, or drop the query");
            }
        }
    }
}

fn unknown_word(world: &World<'_>, clause: &Clause) -> Option<String> {
    match clause {
        Clause::Does { verb, .. } | Clause::Undergoes { verb, .. } => {
            (!world.has_verb(verb)).then(|| format!("nobody does `{verb}` in this scene"))
        }
        Clause::Relation { kind, of } => {
            let wanted = if *kind == Relation::Between { 2 } else { 1 };
            (of.len() != wanted).then(|| format!("`{kind}` takes {wanted} instance(s), not {}", of.len()))
        }
        Clause::Not(inner) => unknown_word(world, inner),
        Clause::Category(_) | Clause::Attribute { .. } => None,
    }
}

fn list(answer: &Answer) -> String {
    if answer.is_empty() {
        return "nothing".to_owned();
    }
    answer.iter().map(Name::as_str).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::tests::{standing, tracks};
    use l4d_data::query::text_digest;

    fn scene() -> Tracks {
        let instances = [
            standing(1, "cup_a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(2, "cup_b", "cup", [1., 0., 0.], [0.1; 3]),
            standing(3, "pen_a", "pen", [0.5, 0., 0.], [0.1; 3]),
            standing(1001, "hand", "hand", [0., 0.5, 0.], [0.1; 3]),
        ];
        tracks(&instances, r#"{"subject":"hand","verb":"lift","object":"cup_a","frames":[10,30]}"#, "")
    }

    fn query(category: &str, referent: &str, temporal: &str, frames: &str, predicate: &str) -> Query {
        let value: serde_json::Value = serde_json::from_str(predicate).unwrap();
        let digest = text_digest("text", Some(&value));
        let line = format!(
            r#"{{"id":"s/001","text":"text","categories":["{category}"],"referents":["{referent}"],"temporal":"{temporal}","frames":{frames},"predicate":{predicate},"text_digest":"{digest}","provenance":{{"source":"author"}},"status":"candidate"}}"#
        );
        serde_json::from_str(&line).unwrap()
    }

    fn codes(query: Query) -> Vec<&'static str> {
        let mut report = Report::default();
        check_scene(Path::new("s.jsonl"), &scene(), None, &[query], &mut report);
        report
            .into_sorted()
            .into_iter()
            .filter(|finding| finding.code != "L4D209")
            .map(|finding| finding.code)
            .collect()
    }

    const LIFTED: &str = r#"[{"category":"cup"},{"undergoes":{"verb":"lift","by":{"category":"hand"}}}]"#;

    #[test]
    fn true_queries_have_no_finding() {
        assert!(codes(query("interaction", "cup_a", "whole", "[[0,96]]", LIFTED)).is_empty());
        assert!(codes(query("interaction", "cup_a", "while", "[[10,30]]", LIFTED)).is_empty());
    }

    #[test]
    fn each_lie_has_its_code() {
        let pen = r#"[{"category":"pen"},{"attribute":{"key":"colour","value":"grey"}}]"#;
        let grey = r#"[{"category":"cup"},{"attribute":{"key":"colour","value":"grey"}}]"#;
        let cases = [
            ("L4D202", query("interaction", "hand", "whole", "[[0,96]]", LIFTED)),
            ("L4D203", query("interaction", "cup_a", "whole", "[[0,96]]", &LIFTED.replace("lift", "throw"))),
            (
                "L4D203",
                query(
                    "spatial",
                    "cup_a",
                    "whole",
                    "[[0,96]]",
                    r#"[{"category":"cup"},{"relation":{"kind":"on","of":["shelf"]}}]"#,
                ),
            ),
            ("L4D204", query("interaction", "cup_b", "whole", "[[0,96]]", LIFTED)),
            ("L4D206", query("interaction", "cup_a", "while", "[[10,31]]", LIFTED)),
            ("L4D206", query("interaction", "cup_a", "while", "[[10,12]]", LIFTED)),
            ("L4D206", query("interaction", "cup_a", "whole", "[[10,30]]", LIFTED)),
            ("L4D207", query("action", "cup_a", "whole", "[[0,96]]", LIFTED)),
            ("L4D205", query("attribute", "pen_a", "whole", "[[0,96]]", pen)),
            ("L4D204", query("attribute", "cup_a", "whole", "[[0,96]]", grey)),
        ];
        for (code, query) in cases {
            assert_eq!(codes(query.clone()).first(), Some(&code), "{query:?}");
        }
    }

    #[test]
    fn an_object_without_a_query_is_a_warning() {
        let mut report = Report::default();
        check_scene(Path::new("s.jsonl"), &scene(), None, &[], &mut report);
        assert!(!report.has_errors() && report.len() == 3);
    }
}
