//! What the set is like: one row per scene, per query and per word, and the table that compares datasets.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::{Benchmark, Category, DataError, Name, Profile, Query, Report, Role, Status, Temporal};
use serde::{Deserialize, Serialize};

use crate::ast::Predicate;
use crate::obb::Obb;
use crate::prove::{SceneSet, Vocabulary, path_length_m, words};
use crate::world::World;

/// A dataset among others, as papers compare them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetRow {
    pub dataset: String,
    /// Synthetic or real.
    #[serde(rename = "type")]
    pub kind: String,
    pub scale: String,
    pub scenes: usize,
    /// How it was taken.
    pub setup: String,
    /// Sentences with answers; none where the dataset has no sentences.
    pub prompts: Option<usize>,
    /// Objects with answers.
    pub objects: Option<usize>,
    /// Whether sentences need more than a property to be told apart.
    pub ambiguous: String,
}

/// A scene in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneRow {
    pub scene: String,
    pub scale: &'static str,
    /// Possible referents.
    pub objects: usize,
    /// What relations may name.
    pub landmarks: usize,
    pub events: usize,
    /// Queries per category, in table order.
    pub attribute: usize,
    /// See `attribute`.
    pub action: usize,
    /// See `attribute`.
    pub spatial: usize,
    /// See `attribute`.
    pub interaction: usize,
    /// Queries of two categories.
    pub composites: usize,
    /// Sentences that nothing satisfies.
    pub absent: usize,
}

/// A query in numbers; sizes and motion are those of its referent while it holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QueryRow {
    /// `<scene>/<nnn>`.
    pub id: String,
    pub scale: &'static str,
    /// Kind of reasoning.
    pub category: &'static str,
    /// `whole` or `while`.
    pub temporal: &'static str,
    /// Words of the sentence.
    pub words: usize,
    /// Objects of the referent's category, itself included.
    pub candidates: usize,
    /// Canonical frames in which it holds.
    pub frames: u32,
    /// Diagonal of the referent's box, median over the clip, metres.
    pub size_m: f64,
    /// Path of the box centre, metres.
    pub path_m: f64,
    /// Mean pixels in the held-out view where it is visible; none without pictures.
    pub pixels: Option<f64>,
    /// Share of the frames in which the held-out view shows it, percent; none without pictures.
    pub visible_percent: Option<f64>,
}

/// A word of the sentences.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WordRow {
    pub word: String,
    /// As `vocabulary.txt` says: noun, verb, preposition, adjective, adverb or other.
    pub kind: String,
    /// Occurrences in queries of one and of two categories.
    pub count: usize,
    /// Scenes in whose sentences it occurs.
    pub scenes: usize,
}

/// Everything that `l4d stats` shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetStats {
    /// Other datasets, then this one.
    pub datasets: Vec<DatasetRow>,
    /// Scenes in table order.
    pub scenes: Vec<SceneRow>,
    /// Scored queries in table order.
    pub queries: Vec<QueryRow>,
    /// Words by frequency.
    pub words: Vec<WordRow>,
    /// Lengths of all declared events, canonical frames, ascending.
    pub event_frames: Vec<u32>,
}

/// Measures the set.
///
/// # Errors
/// Tracks, truth or queries that cannot be read.
pub fn measure(
    bench: &Benchmark,
    profile: Profile,
    scenes: &[Name],
    report: &mut Report,
) -> Result<SetStats, DataError> {
    let sets: Vec<SceneSet> =
        scenes.iter().filter_map(|scene| SceneSet::read(bench, profile, scene, report)).collect();
    let vocabulary = Vocabulary::read(&bench.dir.vocabulary())?.unwrap_or_default();
    let rows: Vec<SceneRow> = sets.iter().map(scene_row).collect();
    let queries: Vec<QueryRow> = sets.iter().flat_map(query_rows).collect();
    let mut datasets = published(&bench.dir.published("datasets"))?;
    datasets.push(own_row(bench, &rows));
    let events = sets.iter().flat_map(|set| &set.tracks.events);
    let mut event_frames: Vec<u32> = events.map(|event| event.frames.frame_count()).collect();
    event_frames.sort_unstable();
    Ok(SetStats { datasets, scenes: rows, queries, words: word_rows(&sets, &vocabulary), event_frames })
}

/// A table as CSV.
///
/// # Errors
/// Rows that no table can hold.
pub fn csv_of<T: Serialize>(rows: &[T]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    writer.into_inner().map_err(|error| error.into_error().into())
}

fn published(path: &Path) -> Result<Vec<DatasetRow>, DataError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let bytes = l4d_data::store::read_bounded(path, 1 << 20)?;
    let rows: Result<Vec<DatasetRow>, csv::Error> =
        csv::Reader::from_reader(bytes.as_slice()).deserialize().collect();
    rows.map_err(|error| {
        let line = error.position().map_or(0, csv::Position::line);
        DataError::invalid(
            path,
            format!("line {line}"),
            error.to_string(),
            "keep the columns of the first line",
        )
    })
}

fn own_row(bench: &Benchmark, scenes: &[SceneRow]) -> DatasetRow {
    let mut scales: Vec<&str> = ["tabletop", "room", "outdoor"].to_vec();
    scales.retain(|scale| scenes.iter().any(|row| row.scale == *scale));
    let prompts = scenes.iter().map(|row| row.attribute + row.action + row.spatial + row.interaction).sum();
    DatasetRow {
        dataset: format!("{} {}", bench.manifest.name, bench.manifest.version),
        kind: "synthetic".to_owned(),
        scale: scales.join(" / "),
        scenes: scenes.len(),
        setup: "multi-view".to_owned(),
        prompts: Some(prompts),
        objects: Some(scenes.iter().map(|row| row.objects).sum()),
        ambiguous: "yes".to_owned(),
    }
}

fn scene_row(set: &SceneSet) -> SceneRow {
    let instances = &set.tracks.instances;
    let of_role = |role: Role| instances.iter().filter(|instance| instance.role == role).count();
    let kept = |queries: &[Query]| queries.iter().filter(|query| query.status != Status::Rejected).count();
    let of = |category: Category| set.scored().filter(|(query, _)| query.categories == [category]).count();
    SceneRow {
        scene: set.scene.to_string(),
        scale: set.tracks.scale.as_str(),
        objects: of_role(Role::Object),
        landmarks: of_role(Role::Landmark),
        events: set.tracks.events.len(),
        attribute: of(Category::Attribute),
        action: of(Category::Action),
        spatial: of(Category::Spatial),
        interaction: of(Category::Interaction),
        composites: kept(&set.composites),
        absent: kept(&set.absents),
    }
}

fn query_rows(set: &SceneSet) -> Vec<QueryRow> {
    let world = World::new(&set.tracks);
    set.scored().filter_map(|(query, predicate)| query_row(set, &world, query, predicate.as_ref())).collect()
}

fn query_row(
    set: &SceneSet,
    world: &World<'_>,
    query: &Query,
    predicate: Option<&Predicate>,
) -> Option<QueryRow> {
    let referent = world.instance(query.referents.first()?)?;
    let noun = predicate.map_or(referent.category.as_str(), Predicate::noun);
    let frames: Vec<u32> =
        (0..l4d_data::timeline::FRAME_COUNT).filter(|&frame| query.holds_at(frame)).collect();
    let counts: Option<Vec<u32>> = set.truth.as_ref().and_then(|truth| {
        let counts = truth.visible.get(&truth.test_view)?.get(&referent.name)?;
        let asked = truth.frames.iter().zip(counts).filter(|(frame, _)| query.holds_at(**frame));
        Some(asked.map(|(_, count)| *count).collect())
    });
    let shown = |counts: &[u32]| counts.iter().filter(|count| **count > 0).count() as f64;
    let sum = |counts: &[u32]| counts.iter().map(|count| f64::from(*count)).sum::<f64>();
    Some(QueryRow {
        id: query.id.to_string(),
        scale: set.tracks.scale.as_str(),
        category: query.categories.first()?.as_str(),
        temporal: if query.temporal == Temporal::Whole { "whole" } else { "while" },
        words: words(&query.text).len(),
        candidates: world.objects().filter(|object| object.category == noun).count(),
        frames: frames.len() as u32,
        size_m: round(world.median(referent, Obb::diagonal), 1e3),
        path_m: round(path_length_m(world, referent, frames.iter().copied()), 1e3),
        pixels: counts
            .as_deref()
            .filter(|counts| shown(counts) > 0.0)
            .map(|counts| round(sum(counts) / shown(counts), 1e1)),
        visible_percent: counts
            .as_deref()
            .filter(|counts| !counts.is_empty())
            .map(|counts| round(100.0 * shown(counts) / counts.len() as f64, 1e1)),
    })
}

/// Words by falling frequency, then alphabet.
fn word_rows(sets: &[SceneSet], vocabulary: &Vocabulary) -> Vec<WordRow> {
    let mut counts: BTreeMap<String, (usize, Vec<usize>)> = BTreeMap::new();
    for (index, set) in sets.iter().enumerate() {
        let composites = set.composites.iter().filter(|query| query.status != Status::Rejected);
        let queries = set.scored().map(|(query, _)| query).chain(composites);
        for word in queries.flat_map(|query| words(&query.text)) {
            let (count, scenes) = counts.entry(word).or_default();
            *count += 1;
            if scenes.last() != Some(&index) {
                scenes.push(index);
            }
        }
    }
    let row = |(word, (count, scenes)): (String, (usize, Vec<usize>))| {
        let kind = vocabulary.kind(&word).to_owned();
        WordRow { word, kind, count, scenes: scenes.len() }
    };
    let mut rows: Vec<WordRow> = counts.into_iter().map(row).collect();
    rows.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.word.cmp(&b.word)));
    rows
}

fn round(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}
