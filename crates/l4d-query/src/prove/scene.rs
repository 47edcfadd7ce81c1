//! One scene: its files, its queries one by one, and what only shows when they are seen together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::truth::Truth;
use l4d_data::{
    Benchmark, Category, DataError, Name, Profile, Query, Report, Role, Scale, Split, Status, json,
};

use super::query::{Kind, Prover};
use super::{Vocabulary, agree, words};
use crate::ast::{Clause, Predicate};

/// What the benchmark says of one scene.
#[derive(Debug)]
pub struct SceneSet {
    pub scene: Name,
    /// Where everything is.
    pub tracks: Tracks,
    /// What the held-out view sees, if the profile has it.
    pub truth: Option<Truth>,
    /// Queries of one category.
    pub queries: Vec<Query>,
    /// Queries of two categories.
    pub composites: Vec<Query>,
    /// Sentences that nothing satisfies.
    pub absents: Vec<Query>,
    /// Files: tracks, queries, composites, absents.
    pub paths: [PathBuf; 4],
}

impl SceneSet {
    /// Reads the files of a scene; what cannot be read is a finding.
    pub fn read(bench: &Benchmark, profile: Profile, scene: &Name, report: &mut Report) -> Option<Self> {
        fn kept<T>(read: Result<T, DataError>, report: &mut Report) -> Option<T> {
            read.map_err(|error| report.data_error("L4D201", &error)).ok()
        }
        let tracks = kept(bench.tracks(scene), report);
        let queries = kept(bench.queries(scene), report);
        let composites = kept(bench.composites(scene), report);
        let absents = kept(bench.absents(scene), report);
        let has_truth = bench.dir.truth(profile, scene).exists();
        let truth = has_truth.then(|| bench.truth(profile, scene)).and_then(|read| kept(read, report));
        if let (Some(tracks), Some(truth)) = (&tracks, &truth)
            && let Some(message) = truth_problem(tracks, truth)
        {
            let hint = "build tracks and truth from the same recipe: `l4d build-scenes --update-benchmark`";
            report.error("L4D201", &bench.dir.truth(profile, scene), "file", message, hint);
        }
        Some(Self {
            scene: scene.clone(),
            tracks: tracks?,
            truth,
            queries: queries?,
            composites: composites?,
            absents: absents?,
            paths: [
                bench.dir.tracks(scene),
                bench.dir.queries(scene),
                bench.dir.composites(scene),
                bench.dir.absents(scene),
            ],
        })
    }

    /// Queries of one category that people have not rejected, with their predicates where they have one.
    pub fn scored(&self) -> impl Iterator<Item = (&Query, Option<Predicate>)> {
        let scored = self.queries.iter().filter(|query| query.status != Status::Rejected);
        scored.map(|query| (query, predicate_of(query)))
    }

    /// Possible referents.
    pub(crate) fn objects(&self) -> impl Iterator<Item = &TrackedInstance> {
        self.tracks.instances.iter().filter(|instance| instance.role == Role::Object)
    }

    /// What is counted of the scene.
    pub(crate) fn counted(&self) -> (Scale, usize, [&[Query]; 3]) {
        (self.tracks.scale, self.objects().count(), [&self.queries, &self.composites, &self.absents])
    }

    fn all(&self) -> impl Iterator<Item = Asked<'_>> {
        let [_, queries, composites, absents] = &self.paths;
        not_rejected([queries, composites, absents], self.counted().2)
    }
}

/// How a truth is not that of a scene.
fn truth_problem(tracks: &Tracks, truth: &Truth) -> Option<String> {
    let is_listed = |name: &Name| tracks.cameras.iter().any(|camera| camera.name == *name);
    let held_out = tracks.cameras.iter().find(|camera| camera.split == Split::Test)?;
    let described = tracks.instances.iter().map(|one| (one.id, &one.name, one.role, &one.category));
    if tracks.scene != truth.scene {
        Some(format!("is of scene {}", truth.scene))
    } else if held_out.name != truth.test_view {
        Some(format!("holds out {}, but the tracks hold out {}", truth.test_view, held_out.name))
    } else if let Some(view) = truth.visible.keys().find(|view| !is_listed(view)) {
        Some(format!("has counts of {view}, which is no view of the scene"))
    } else {
        let seen = truth.instances.iter().map(|one| (one.id, &one.name, one.role, &one.category));
        described.ne(seen).then(|| "has other instances than the tracks".to_owned())
    }
}

/// A query with what it is expected to be, and its file.
pub(super) type Asked<'a> = (Kind, &'a PathBuf, &'a Query);

/// The queries of one category, of two and of none that people have not rejected.
pub(super) fn not_rejected<'a>(
    paths: [&'a PathBuf; 3],
    files: [&'a [Query]; 3],
) -> impl Iterator<Item = Asked<'a>> {
    let files = Kind::ALL.into_iter().zip(paths).zip(files);
    let all = files.flat_map(|((kind, path), queries)| queries.iter().map(move |query| (kind, path, query)));
    all.filter(|(_, _, query)| query.status != Status::Rejected)
}

pub(crate) fn predicate_of(query: &Query) -> Option<Predicate> {
    Predicate::from_json(query.predicate.as_ref()?).ok()
}

/// Checks everything that the benchmark says of one scene.
pub fn check_scene(set: &SceneSet, vocabulary: Option<&Vocabulary>, report: &mut Report) {
    let prover = Prover::new(&set.tracks, set.truth.as_ref(), vocabulary);
    agree::check(prover.world(), &set.paths[0], report);
    for (kind, path, query) in set.all() {
        prover.check(kind, path, query, report);
    }
    check_each_asks_something_else(set.all(), report);
}

/// Each object of the scene is the referent of a query: what no query asks for is scenery.
pub(super) fn check_each_is_asked(set: &SceneSet, report: &mut Report) {
    let refers = |query: &&Query, name: &Name| query.referents.contains(name);
    let (rejected, asked): (Vec<&Query>, Vec<&Query>) =
        set.queries.iter().partition(|query| query.status == Status::Rejected);
    for object in set.objects().filter(|object| !asked.iter().any(|query| refers(query, &object.name))) {
        let place = format!("instance {}", object.name);
        if rejected.iter().any(|query| refers(query, &object.name)) {
            let message = "only queries that people rejected refer to this object";
            let hint = "edit one of them and ask again with `l4d open-round --from ROUND`";
            report.warning("L4D209", &set.paths[1], place, message, hint);
        } else {
            let hint = "write a query for it, or make it scenery";
            report.error("L4D209", &set.paths[1], place, "no query refers to this object", hint);
        }
    }
}

/// No predicate twice, no sentence twice, no event asked for once with and once without its second role.
pub(super) fn check_each_asks_something_else<'a>(all: impl Iterator<Item = Asked<'a>>, report: &mut Report) {
    let mut predicates: BTreeMap<String, String> = BTreeMap::new();
    let mut sentences: BTreeMap<String, String> = BTreeMap::new();
    let mut events: BTreeMap<(String, Name), (String, Vec<Category>)> = BTreeMap::new();
    let mut ids: BTreeSet<String> = BTreeSet::new();
    for (kind, path, query) in all {
        let place = format!("query {} (\"{}\")", query.id, query.text);
        let id = query.id.to_string();
        if !ids.insert(id.clone()) {
            let hint = "number composites from 501 and absent ones from 901";
            report.error("L4D213", path, place.clone(), "the id is in another file of the scene, too", hint);
        }
        if let Some(other) = sentences.insert(words(&query.text).join(" "), id.clone()) {
            let message = format!("{other} has the same sentence");
            report.error("L4D213", path, place.clone(), message, "say it differently, or drop one");
        }
        let Some(predicate) = predicate_of(query) else { continue };
        if let Some(other) = predicates.insert(meaning(&predicate), id.clone()) {
            let message = format!("{other} has the same predicate");
            report.error("L4D212", path, place.clone(), message, "ask something else, or drop one");
        }
        if let (Kind::Single, Some(verbs), [referent]) = (kind, verbs(&predicate), query.referents.as_slice())
        {
            let claim = (id, query.categories.clone());
            if let Some((other, categories)) = events.insert((verbs, referent.clone()), claim)
                && categories != query.categories
            {
                let message = format!("{other} asks for the same event under another category");
                report.error("L4D212", path, place, message, "ask something else, or drop one");
            }
        }
    }
}

/// The same for predicates that differ only in the order of their clauses.
pub fn meaning(predicate: &Predicate) -> String {
    let mut clauses: Vec<String> = predicate
        .0
        .iter()
        .filter_map(|clause| serde_json::to_value(clause).ok())
        .map(|value| json::canonical(&value))
        .collect();
    clauses.sort();
    clauses.join(",")
}

/// The verbs of a predicate that consists of plain events alone, whatever takes the second role.
pub fn verbs(predicate: &Predicate) -> Option<String> {
    let verb = |clause: &Clause| match clause {
        Clause::Does { verb, .. } | Clause::Undergoes { verb, .. } => Some(verb.clone()),
        _ => None,
    };
    let verbs: Option<Vec<String>> = predicate.discriminating().map(verb).collect();
    verbs.map(|verbs| format!("{}: {}", predicate.noun(), verbs.join(", ")))
}
