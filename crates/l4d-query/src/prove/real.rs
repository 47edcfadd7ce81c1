//! Queries of real scenes: where things are is unknown, so nothing is proved. What can be checked is whether a query
//! fits its scene: objects, frames, sentences, and whether there is anything to score.

use std::path::PathBuf;

use l4d_data::scene::Role;
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, DataError, Name, Profile, Query, Report, Scale};

use super::query::{Kind, category_problem, frames_problem, is_never_seen};
use super::scene::{Asked, check_each_asks_something_else, not_rejected};
use super::wording::form_problem;

/// What the benchmark says of one real scene.
pub(super) struct RealSet {
    truth: Truth,
    /// Queries, composites, absent sentences.
    paths: [PathBuf; 3],
    files: [Vec<Query>; 3],
}

impl RealSet {
    /// Reads the files of a scene; what cannot be read is a finding.
    pub(super) fn read(bench: &Benchmark, scene: &Name, report: &mut Report) -> Option<Self> {
        let read = || -> Result<Self, DataError> {
            Ok(Self {
                truth: bench.truth(Profile::Real, scene)?,
                paths: [bench.dir.queries(scene), bench.dir.composites(scene), bench.dir.absents(scene)],
                files: [bench.queries(scene)?, bench.composites(scene)?, bench.absents(scene)?],
            })
        };
        read().map_err(|error| report.data_error("L4D201", &error)).ok()
    }

    /// Reports everything that is wrong with the queries of the scene.
    pub(super) fn check(&self, report: &mut Report) {
        for (kind, path, query) in self.all() {
            let place = format!("query {} (\"{}\")", query.id, query.text);
            for (code, message, hint) in self.problems(kind, query) {
                report.error(code, path, place.clone(), message, hint);
            }
            if let Some(name) = query.referents.iter().find(|name| !self.has_look_alike(name)) {
                let message =
                    format!("nothing else of the category of `{name}` is drawn: any object of it is right");
                let hint =
                    "draw its look-alikes too, or give labels of one category (\"cup: red\", \"cup: blue\")";
                report.warning("L4D205", path, place, message, hint);
            }
        }
        check_each_asks_something_else(self.all(), report);
    }

    /// What is counted of the scene.
    pub(super) fn counted(&self) -> (Scale, usize, [&[Query]; 3]) {
        let objects = self.truth.instances.iter().filter(|instance| instance.role == Role::Object);
        (self.truth.scale, objects.count(), self.files.each_ref().map(Vec::as_slice))
    }

    fn all(&self) -> impl Iterator<Item = Asked<'_>> {
        not_rejected(self.paths.each_ref(), self.counted().2)
    }

    fn problems(&self, kind: Kind, query: &Query) -> Vec<(&'static str, String, &'static str)> {
        let mut found = Vec::new();
        for name in query.referents.iter().filter(|name| self.truth.instance(name).is_none()) {
            let message = format!("referent `{name}` is no object that was drawn");
            found.push(("L4D202", message, "name an instance of the truth of the scene"));
        }
        if query.predicate.is_some() {
            let message = "has a predicate, but a real scene has no tracks to prove it by".to_owned();
            found.push(("L4D203", message, "write null"));
        }
        found.extend(self.frames_problem(query).map(|message| {
            ("L4D206", message, "write the frames of the capture in which the sentence holds")
        }));
        found.extend(
            category_problem(kind, &query.categories).map(|(message, hint)| ("L4D207", message, hint)),
        );
        let is_known = |name: &&Name| self.truth.instance(name).is_some();
        let known = query.referents.iter().filter(is_known);
        for name in known.filter(|name| is_never_seen(&self.truth, query, name)) {
            let message = format!("`{name}` is drawn in no frame in which the query holds");
            found.push(("L4D210", message, "draw it, correct the frames, or drop the query"));
        }
        found.extend(
            form_problem(&query.text).map(|message| {
                ("L4D216", message, "write a noun phrase that means the same from every side")
            }),
        );
        found
    }

    fn frames_problem(&self, query: &Query) -> Option<String> {
        let is_drawn = self.truth.frames.iter().any(|frame| query.holds_at(*frame));
        let undrawn = (!is_drawn).then(|| "it holds in no frame on which somebody drew".to_owned());
        frames_problem(query, self.truth.whole()).or(undrawn)
    }

    fn has_look_alike(&self, name: &Name) -> bool {
        let Some(instance) = self.truth.instance(name) else { return true };
        let alike = |other: &&l4d_data::truth::InstanceTruth| other.category == instance.category;
        self.truth.instances.iter().filter(alike).count() > 1
    }
}
