//! What a set of queries shares with another: sentences, predicates, places, and what a memory of the other one finds.
//!
//! The memory has seen where everything went in the other set. Asked a sentence, it remembers the most similar one
//! with the same noun, and picks what is nearest to where that one's referent was. On scenes that are new it does no
//! better than chance.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use l4d_data::benchmark::SetSplit;
use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::{TrackedInstance, at_frame};
use l4d_data::{Benchmark, Category, Name, Profile, Query, QuerySet, Report};
use serde::Serialize;

use crate::ast::Predicate;
use crate::prove::{SceneSet, predicate_of, words};

/// Most sentences that a set that claims to be disjoint may share with another, percent.
pub const MOST_SHARED_PERCENT: f64 = 5.0;
/// How far above chance the memory may be, percentage points.
pub const MOST_MEMORY_POINTS: f64 = 5.0;
/// Fewer queries than this say nothing about the memory.
const FEWEST_QUERIES: usize = 50;

/// What a set shares with another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overlap {
    /// The other set.
    pub against: String,
    /// Sentences and predicates that the other set has, too: queries, composites, absents.
    pub shared: BTreeMap<&'static str, Shared>,
    /// What a memory of the other set finds.
    pub memory: Memory,
    /// Objects that have the name of one there.
    pub places: Places,
}

/// How many of so many queries the other set has, too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Shared {
    /// Of this set.
    pub queries: usize,
    /// Word for word, in any of its files.
    pub sentences: usize,
    /// With the same text form, in any of its files.
    pub predicates: usize,
}

/// What a memory of the other set finds.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Memory {
    /// Whose noun the other set has, too.
    pub all: Recall,
    /// The same for each category.
    pub categories: BTreeMap<&'static str, Recall>,
}

/// How often a memory is right.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Recall {
    /// Queries that it was tried on.
    pub queries: usize,
    /// Of which it picks the referent; where several memories are as similar, each counts its share.
    pub right: f64,
    /// How many a random pick among the look-alikes would find.
    pub by_chance: f64,
}

impl Recall {
    /// How much more often it is right than chance, percentage points.
    pub fn points(&self) -> f64 {
        if self.queries == 0 { 0.0 } else { 100.0 * (self.right - self.by_chance) / self.queries as f64 }
    }

    fn add(&mut self, right: f64, chance: f64) {
        self.queries += 1;
        self.right += right;
        self.by_chance += chance;
    }
}

/// Objects that have the name of one of the other set: in the scene of the same name if it has one, else in any.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Places {
    pub objects: usize,
    /// How far they are from it on average over the clip, metres.
    pub mean_distance_m: f64,
}

/// Compares the scenes of a set with all of another; a set that claims to be disjoint and is not is a finding.
pub fn check_against(
    bench: &Benchmark,
    profile: Profile,
    scenes: &[Name],
    other: &Benchmark,
    report: &mut Report,
) -> Overlap {
    let mut read = |bench: &Benchmark, scenes: &[Name]| -> Vec<SceneSet> {
        scenes.iter().filter_map(|scene| SceneSet::read(bench, profile, scene, report)).collect()
    };
    let these = read(bench, scenes);
    let those = read(other, &other.manifest.scenes);
    let overlap = measure(other.root().display().to_string(), &these, &those);
    if bench.manifest.split != SetSplit::Test
        && let Some(message) = overlap.problem()
    {
        let place = format!("against {}", overlap.against);
        let hint = "compose new scenes, or give `l4d compose` the sentences to avoid";
        report.error("L4D231", &bench.dir.manifest(), place, message, hint);
    }
    overlap
}

impl Overlap {
    /// Why the sets are not disjoint.
    fn problem(&self) -> Option<String> {
        let total: usize = self.shared.values().map(|shared| shared.queries).sum();
        let same: usize = self.shared.values().map(|shared| shared.sentences).sum();
        let percent = 100.0 * same as f64 / total.max(1) as f64;
        let recall = &self.memory.all;
        let mut problems = Vec::new();
        if percent > MOST_SHARED_PERCENT {
            problems.push(format!(
                "{same} of {total} sentences are those of the other set, more than {MOST_SHARED_PERCENT} %"
            ));
        }
        if recall.queries >= FEWEST_QUERIES && recall.points() > MOST_MEMORY_POINTS {
            problems.push(format!(
                "a memory of the other set finds {:.1} of {} referents, {:.1} by chance: more than \
                 {MOST_MEMORY_POINTS} points above it",
                recall.right, recall.queries, recall.by_chance
            ));
        }
        (!problems.is_empty()).then(|| problems.join("; "))
    }
}

/// Compares two sets.
pub fn measure(against: String, these: &[SceneSet], those: &[SceneSet]) -> Overlap {
    let all = |(_, files): (QuerySet, Files)| those.iter().flat_map(files);
    let others: Vec<&Query> = SETS.into_iter().flat_map(all).collect();
    let sentences: BTreeSet<String> = others.iter().map(|query| normal(&query.text)).collect();
    let predicates: BTreeSet<String> = others.iter().filter_map(|query| text_form(query)).collect();
    let shared = SETS.map(|(set, files)| {
        let mut shared = Shared::default();
        for query in these.iter().flat_map(files) {
            shared.queries += 1;
            shared.sentences += usize::from(sentences.contains(&normal(&query.text)));
            shared.predicates += usize::from(text_form(query).is_some_and(|form| predicates.contains(&form)));
        }
        (set.as_str(), shared)
    });
    Overlap { against, shared: shared.into(), memory: memory(these, those), places: places(these, those) }
}

type Files = fn(&SceneSet) -> &Vec<Query>;

const SETS: [(QuerySet, Files); 3] = [
    (QuerySet::Queries, |scene| &scene.queries),
    (QuerySet::Composites, |scene| &scene.composites),
    (QuerySet::Absents, |scene| &scene.absents),
];

fn normal(text: &str) -> String {
    words(text).join(" ")
}

fn text_form(query: &Query) -> Option<String> {
    predicate_of(query).map(|predicate| predicate.to_string())
}

/// A sentence of the other set with who it meant.
struct Memorised<'m> {
    scene: &'m Name,
    noun: String,
    form: String,
    text: String,
    words: BTreeSet<String>,
    referent: &'m TrackedInstance,
}

fn memory(these: &[SceneSet], those: &[SceneSet]) -> Memory {
    let memories: Vec<Memorised<'_>> = those.iter().flat_map(memorised).collect();
    let mut found = Memory {
        all: Recall::default(),
        categories: Category::ALL.map(|category| (category.as_str(), Recall::default())).into(),
    };
    for scene in these {
        for (query, predicate) in scene.scored() {
            let Some(predicate) = predicate else { continue };
            let candidates: Vec<&TrackedInstance> =
                scene.objects().filter(|object| object.category == predicate.noun()).collect();
            let similar = most_similar(&memories, &scene.scene, query, &predicate);
            if similar.is_empty() || candidates.is_empty() {
                continue;
            }
            let is_right = |memory: &&&Memorised<'_>| {
                let picked = nearest(&candidates, memory.referent);
                picked.is_some_and(|picked| query.referents.contains(&picked.name))
            };
            let right = similar.iter().filter(is_right).count() as f64 / similar.len() as f64;
            let chance = 1.0 / candidates.len() as f64;
            found.all.add(right, chance);
            for category in &query.categories {
                found.categories.entry(category.as_str()).or_default().add(right, chance);
            }
        }
    }
    found
}

fn memorised(scene: &SceneSet) -> impl Iterator<Item = Memorised<'_>> {
    let queries = scene.queries.iter().chain(&scene.composites);
    queries.filter_map(|query| {
        let predicate = predicate_of(query)?;
        Some(Memorised {
            scene: &scene.scene,
            noun: predicate.noun().to_owned(),
            form: predicate.to_string(),
            text: normal(&query.text),
            words: words(&query.text).into_iter().collect(),
            referent: scene.tracks.instance(query.referents.first()?)?,
        })
    })
}

/// The sentences with the same noun that come nearest: the same one, else the same predicate, else the most words in
/// common; of those, the ones of the scene of that name.
fn most_similar<'m>(
    memories: &'m [Memorised<'m>],
    scene: &Name,
    query: &Query,
    predicate: &Predicate,
) -> Vec<&'m Memorised<'m>> {
    let (text, form) = (normal(&query.text), predicate.to_string());
    let own: BTreeSet<String> = words(&query.text).into_iter().collect();
    let likeness = |memory: &Memorised<'_>| {
        let shared = memory.words.intersection(&own).count();
        (memory.text == text, memory.form == form, shared, memory.scene == scene)
    };
    let same_noun: Vec<_> = memories
        .iter()
        .filter(|memory| memory.noun == predicate.noun())
        .map(|memory| (likeness(memory), memory))
        .collect();
    let Some(best) = same_noun.iter().map(|(likeness, _)| *likeness).max() else { return Vec::new() };
    same_noun.into_iter().filter(|(likeness, _)| *likeness == best).map(|(_, memory)| memory).collect()
}

/// The candidate that is nearest to where the other one was, on average over the clip.
fn nearest<'c>(
    candidates: &[&'c TrackedInstance],
    remembered: &TrackedInstance,
) -> Option<&'c TrackedInstance> {
    let scored = candidates.iter().map(|candidate| (apart_m(candidate, remembered), *candidate));
    scored.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, candidate)| candidate)
}

/// Mean distance of two box centres over the clip, metres.
fn apart_m(one: &TrackedInstance, other: &TrackedInstance) -> f64 {
    let centre =
        |instance: &TrackedInstance, frame| DVec3::from_array(*at_frame(&instance.track.centre, frame));
    let sum: f64 = (0..FRAME_COUNT).map(|frame| centre(one, frame).distance(centre(other, frame))).sum();
    sum / f64::from(FRAME_COUNT)
}

fn places(these: &[SceneSet], those: &[SceneSet]) -> Places {
    let mut distances = Vec::new();
    for scene in these {
        let same = those.iter().filter(|other| other.scene == scene.scene).collect::<Vec<_>>();
        let others = if same.is_empty() { those.iter().collect() } else { same };
        for object in scene.objects() {
            let namesakes =
                others.iter().flat_map(|other| other.objects()).filter(|other| other.name == object.name);
            let apart: Vec<f64> = namesakes.map(|other| apart_m(object, other)).collect();
            if !apart.is_empty() {
                distances.push(apart.iter().sum::<f64>() / apart.len() as f64);
            }
        }
    }
    let objects = distances.len();
    // The sum of nothing is -0.
    let sum = distances.iter().fold(0.0, |sum, distance| sum + distance);
    Places { objects, mean_distance_m: sum / objects.max(1) as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{query, set, standing, tracks};

    const AT_BOX: &str = r#"{"relation":{"kind":"beside","of":[{"name":"box"}]}}"#;
    const RED: &str = r#"{"attribute":{"key":"colour","value":"red"}}"#;

    /// Two cups on either side, the box beside the first or the second.
    fn scene(box_at: f64, text: &str, referent: &str, clause: &str) -> SceneSet {
        let instances = [
            standing(1, "a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(2, "b", "cup", [1., 0., 0.], [0.1; 3]),
            standing(1001, "box", "box", [box_at, 0.15, 0.], [0.1; 3]),
        ];
        set(tracks(&instances, "", ""), vec![query(text, &[referent], clause)])
    }

    #[test]
    fn a_memory_finds_what_has_stayed_and_no_more() {
        let old = [scene(0.0, "The cup at the box", "a", AT_BOX)];
        let same = measure("old".into(), &old, &old);
        assert_eq!(same.shared["queries"], Shared { queries: 1, sentences: 1, predicates: 1 });
        assert_eq!((same.memory.all.right, same.memory.all.by_chance), (1.0, 0.5));
        assert_eq!(same.memory.categories["spatial"].points(), 50.0);
        assert_eq!((same.places.objects, same.places.mean_distance_m), (2, 0.0));
        // The box has moved to the other cup: the sentence is the same, the memory is wrong.
        let moved = [scene(1.0, "the cup, at the BOX", "b", AT_BOX)];
        let overlap = measure("old".into(), &moved, &old);
        assert_eq!((overlap.shared["queries"].sentences, overlap.memory.all.right), (1, 0.0));
        // Said otherwise, it is the predicate that is remembered; what shares neither has the noun alone.
        let otherwise = measure("old".into(), &[scene(0.0, "A mug", "a", AT_BOX)], &old);
        assert_eq!(otherwise.shared["queries"], Shared { queries: 1, sentences: 0, predicates: 1 });
        let new = measure("old".into(), &[scene(0.0, "The red one", "b", RED)], &old);
        assert_eq!(new.shared["queries"], Shared { queries: 1, sentences: 0, predicates: 0 });
        assert_eq!((new.memory.all.queries, new.memory.all.right), (1, 0.0));
    }

    #[test]
    fn only_what_a_disjoint_set_may_not_share_is_a_problem() {
        let old = [scene(0.0, "The cup at the box", "a", AT_BOX)];
        let problem = measure("old".into(), &old, &old).problem().unwrap();
        assert!(problem.starts_with("1 of 1 sentences") && !problem.contains("memory"), "{problem}");
        assert_eq!(measure("old".into(), &[scene(1.0, "A mug", "b", AT_BOX)], &old).problem(), None);
        let many: Vec<SceneSet> = (0..50).map(|_| scene(0.0, "A mug", "a", AT_BOX)).collect();
        let problem = measure("old".into(), &many, &old).problem().unwrap();
        assert!(problem.contains("50.0 of 50 referents, 25.0 by chance"), "{problem}");
    }
}
