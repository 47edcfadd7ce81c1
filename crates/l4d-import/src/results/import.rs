//! From a folder of a method to results of the benchmark: which file answers which query in which frame.
//!
//! Nothing is guessed. What a path or file does not say has to be given, a name that fits no query is an error with
//! the nearest sentence, and two files for one answer are a collision. Everything that was assumed, and the digest of
//! everything that was read, goes into `method.json`, so that two people get the same numbers.

mod answers;
mod card;
mod frames;
mod latents;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;
use l4d_data::error::inert;
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, DataError, Name, Profile, Query, QueryId, Report, Role};

use super::claims::{self, Claims};
use super::codec::Reading;
use super::codes;
use super::inside::Inside;
use super::preset::Preset;
use super::prompts::Prompts;
use super::relevancy::TextEmbeddingsFile;
use super::shift::{Answers, Summits, check_cover, check_frames};
use super::template::{Captures, Hit, Template};

pub use card::{Identity, write};
pub use frames::{FrameOrder, Images};

use answers::Collector;
use frames::Pictures;

/// What is imported, and what the user says about it.
#[derive(Debug)]
pub struct Request<'a> {
    /// The benchmark whose queries are answered.
    pub bench: &'a Benchmark,
    /// The profile of the masks.
    pub profile: Profile,
    /// Scenes that are meant.
    pub scenes: Vec<Name>,
    /// What is known of the files.
    pub preset: Preset,
    /// Where they are.
    pub root: PathBuf,
    /// Fields of the template that the user fixed.
    pub choices: BTreeMap<String, String>,
    /// How files are read; its codec is that of the preset.
    pub reading: Reading,
    /// Which frame a position is.
    pub order: FrameOrder,
    /// Which position a COCO image is.
    pub images: Option<Images>,
    /// Whether masks of another size are brought to ours.
    pub resize: bool,
    /// What latents need beside themselves.
    pub encoders: Encoders,
    /// Logs and tables with claimed numbers, beside those that the preset finds.
    pub claims: Vec<PathBuf>,
}

/// Weights and embeddings for latents.
#[derive(Debug, Default)]
pub struct Encoders {
    /// Template of the weights of the autoencoder, from the working folder.
    pub decoder: Option<String>,
    /// Sentences as vectors.
    pub texts: Option<(PathBuf, TextEmbeddingsFile)>,
    /// Template of the weights of the autoencoder of time.
    pub time_decoder: Option<String>,
    /// Sentences about a time as vectors.
    pub time_texts: Option<(PathBuf, TextEmbeddingsFile)>,
}

/// What came in.
#[derive(Debug, Default)]
pub struct Imported {
    /// Masks by query and frame.
    pub answers: BTreeMap<QueryId, Answers>,
    /// What was assumed, a sentence by topic.
    pub assumptions: BTreeMap<String, String>,
    /// SHA-256 of what was read: single files by name, the files of a scene by one digest of all.
    pub inputs: BTreeMap<String, String>,
    /// Numbers that the method claims.
    pub claimed: BTreeMap<String, f64>,
    /// Mask size of each scene, pixels.
    pub sizes: BTreeMap<Name, (u32, u32)>,
    /// Where relevancy is highest, if latents were read: what localisation is measured by.
    pub summits: Summits,
}

/// A scene that is asked about, with all sentences that may be answered.
struct SceneQueries {
    name: Name,
    /// All sentences: queries, composites, absent ones.
    all: Vec<Query>,
    /// How many of them count; they come first.
    asked: usize,
}

impl SceneQueries {
    fn read(bench: &Benchmark, scene: &Name) -> Result<Self, DataError> {
        let mut all = bench.queries(scene)?;
        let asked = all.len();
        all.extend(bench.composites(scene)?);
        all.extend(bench.absents(scene)?);
        Ok(Self { name: scene.clone(), all, asked })
    }

    fn asked(&self) -> &[Query] {
        &self.all[..self.asked]
    }
}

/// Imports what the request describes. Problems of single files are reported, and the others are still read.
///
/// # Errors
/// What keeps anything from being read: templates, folders, the benchmark itself.
pub fn import(
    request: &Request<'_>,
    progress: impl Fn(&str),
    report: &mut Report,
) -> Result<Imported, DataError> {
    let known = request.scenes.iter().map(Name::to_string);
    let template = parse(&request.preset.template, &request.root)?.of_scenes(known);
    let mut hits = template.find(&request.root, &request.choices, report)?;
    hits.retain(|hit| !is_ignored(&hit.path, &request.preset.ignore));
    if let Some(latents) = &request.preset.latents {
        // Other levels are beside them: that of time, and the default one that no evaluation reads.
        hits.retain(|hit| hit.number("level").is_none_or(|level| latents.levels.contains(&level)));
    }
    if hits.is_empty() {
        let message = format!("holds no file at `{template}`");
        let hint = "give the folder that the template starts from, or another --template: docs/import/presets.md shows where the original writes";
        report.error(codes::NOTHING_FOUND, &request.root, "folder", message, hint);
        return Ok(Imported::default());
    }
    let mut imported = Imported { assumptions: card::assumptions(request), ..Imported::default() };
    read_claims(request, &mut imported, report)?;
    for (scene, mut hits) in by_scene(request, &template, hits, report) {
        progress(scene.as_str());
        let queries = SceneQueries::read(request.bench, &scene)?;
        let mut assume = |topic: &str, text: String| {
            imported.assumptions.insert(format!("{scene}: {topic}"), text);
        };
        if template.fields().contains(&"view")
            && let Some(truth) = truth(request, &scene)?
        {
            hits.retain(|hit| hit.text("view").is_none_or(|view| truth.test_view.as_str() == view));
        }
        prefer(request, &mut hits, &mut assume);
        if has_choices_left(request, &template, &hits, report) {
            continue;
        }
        report_trained_on(request, &hits, report);
        let prompts = Prompts::new(&queries.all);
        let is_base = |hit: &Hit| hit.text("text").is_some_and(|text| prompts.is_base_object(text));
        let bases: BTreeSet<&str> =
            hits.iter().filter(|hit| is_base(hit)).filter_map(|hit| hit.text("text")).collect();
        if !bases.is_empty() {
            let bases = Vec::from_iter(bases).join(", ");
            assume("base objects", format!("left out, since no query is one: {}", inert(&bases)));
        }
        hits.retain(|hit| !is_base(hit));
        let pictures = Pictures::read(request, &scene)?;
        if let Some(padding) = pictures.leave_out_padding(request, &mut hits) {
            assume("pictures", padding);
        }
        if let Some(images) = pictures.images.as_ref().filter(|_| template.fields().contains(&"image")) {
            let digest = sha256_file(images.path())?;
            imported.inputs.insert(format!("images {}", images.path().display()), digest);
        }
        imported.sizes.insert(scene.clone(), pictures.size);
        let mut collector = Collector::new(request, &prompts, &pictures);
        match &request.preset.latents {
            None => {
                let reading = reading(request, &scene, &queries, &mut assume)?;
                answers::read(&reading, &hits, &mut collector);
            }
            Some(preset) => {
                latents::read(request, preset, &hits, &queries, &mut collector, &mut imported)?;
            }
        }
        let (found, summits) = collector.finish(report);
        imported.inputs.insert(format!("{scene}: {} files", hits.len()), card::digest(request, &hits)?);
        check_cover(&request.root, pictures.size, &found, report);
        check_fit(request, &queries, &found, report)?;
        report_missing(request, &queries, &pictures, &found, report);
        imported.answers.extend(found);
        imported.summits.extend(summits);
    }
    Ok(imported)
}

fn parse(template: &str, root: &Path) -> Result<Template, DataError> {
    Template::parse(template)
        .map_err(|error| DataError::invalid(root, "template", error, "see docs/import/presets.md"))
}

/// The truth of a scene, where it is there.
fn truth(request: &Request<'_>, scene: &Name) -> Result<Option<Truth>, DataError> {
    let is_there = request.bench.dir.truth(request.profile, scene.as_str()).exists();
    is_there.then(|| request.bench.truth(request.profile, scene)).transpose()
}

/// How files are read. Where nothing says which ids mean which sentence, they are those of `l4d export --format davis`.
fn reading<'a>(
    request: &'a Request<'_>,
    scene: &Name,
    queries: &SceneQueries,
    assume: &mut impl FnMut(&str, String),
) -> Result<Cow<'a, Reading>, DataError> {
    let reading = &request.reading;
    if reading.inside != Inside::Selected || !reading.selections.is_empty() {
        return Ok(Cow::Borrowed(reading));
    }
    let Some(truth) = truth(request, scene)? else { return Ok(Cow::Borrowed(reading)) };
    let objects = truth.instances.iter().filter(|instance| instance.role == Role::Object);
    let ids: BTreeMap<&Name, u32> = objects.map(|instance| &instance.name).zip(1..).collect();
    let ids_of = |query: &Query| query.referents.iter().filter_map(|name| ids.get(name).copied()).collect();
    let selections = queries.all.iter().map(|query| (query.id.number.to_string(), ids_of(query))).collect();
    assume("selections", "ids are the numbers that `l4d export --format davis` gives objects".to_owned());
    Ok(Cow::Owned(Reading { selections, ..reading.clone() }))
}

/// Of what a field is several times, keeps the thing that the preset prefers.
fn prefer(request: &Request<'_>, hits: &mut Vec<Hit>, assume: &mut impl FnMut(&str, String)) {
    for (field, order) in &request.preset.prefer {
        let there: BTreeSet<&str> = hits.iter().filter_map(|hit| hit.text(field)).collect();
        let best = order.iter().find(|value| there.contains(value.as_str()));
        let Some(best) = best.filter(|_| there.len() > 1) else { continue };
        assume(field, format!("{best}, of {}", inert(&Vec::from_iter(there).join(", "))));
        hits.retain(|hit| hit.text(field) == Some(best));
    }
}

fn is_ignored(path: &Path, beginnings: &[String]) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    beginnings.iter().any(|beginning| name.starts_with(beginning.as_str()))
}

/// Files by scene. A template without a scene belongs to the only one that is meant.
fn by_scene(
    request: &Request<'_>,
    template: &Template,
    hits: Vec<Hit>,
    report: &mut Report,
) -> BTreeMap<Name, Vec<Hit>> {
    let mut scenes: BTreeMap<Name, Vec<Hit>> = BTreeMap::new();
    if !template.fields().contains(&"scene") {
        if let [scene] = request.scenes.as_slice() {
            scenes.insert(scene.clone(), hits);
        } else {
            let message = format!(
                "`{template}` does not say which of {} scenes a file belongs to",
                request.scenes.len()
            );
            let hint = "choose one with --scenes, or write {scene} into the template";
            report.error(codes::UNKNOWN_PROMPT, &request.root, "template", message, hint);
        }
        return scenes;
    }
    let mut unknown = BTreeSet::new();
    for hit in hits {
        let name = hit.text("scene").unwrap_or_default().to_owned();
        let is_known = request.bench.manifest.scenes.iter().any(|scene| scene.as_str() == name);
        if let Some(scene) = request.scenes.iter().find(|scene| scene.as_str() == name) {
            scenes.entry(scene.clone()).or_default().push(hit);
        } else if !is_known && unknown.insert(name.clone()) {
            let known: Vec<&str> = request.scenes.iter().take(21).map(Name::as_str).collect();
            let message = format!("names the scene `{}`, which the benchmark does not have", inert(&name));
            let hint = format!(
                "rename the folder, or give its template and --scenes; the scenes are {}",
                known.join(", ")
            );
            report.warning(codes::UNKNOWN_PROMPT, &hit.path, "path", message, hint);
        }
    }
    if scenes.is_empty() {
        let hint = "rename the folders after scenes of the benchmark, or give --template and --scenes";
        let message = "holds nothing for any scene that is meant";
        report.error(codes::NOTHING_FOUND, &request.root, "folder", message, hint);
    }
    scenes
}

/// Reports fields without a meaning of their own that have several values: iterations, splits, stamps.
fn has_choices_left(request: &Request<'_>, template: &Template, hits: &[Hit], report: &mut Report) -> bool {
    const MEANT: [&str; 9] =
        ["scene", "query", "text", "prompt", "form", "frame", "position", "image", "level"];
    let mut is_ambiguous = false;
    for field in template.fields().into_iter().filter(|field| !MEANT.contains(field)) {
        let mut values: Vec<&str> = hits.iter().filter_map(|hit| hit.text(field)).collect();
        values.sort_unstable();
        values.dedup();
        if values.len() > 1 {
            let shown = inert(&values.iter().take(8).copied().collect::<Vec<_>>().join(", "));
            let message = format!("`{{{field}}}` of the template is {} things: {shown}", values.len());
            let hint = format!("say which is meant: --set {field}={}", inert(values[values.len() - 1]));
            report.error(codes::AMBIGUOUS_FIELD, &request.root, "template", message, hint);
            is_ambiguous = true;
        }
    }
    is_ambiguous
}

/// Reports renders of the split `train`: without `--eval` the originals train on every picture, annotated ones included.
fn report_trained_on(request: &Request<'_>, hits: &[Hit], report: &mut Report) {
    if let Some(hit) = hits.iter().find(|hit| hit.text("split") == Some("train")) {
        let message =
            "is a render of the split `train`: either of other cameras, or the held-out one was trained on";
        let hint =
            "train with --eval on an export of `l4d export`, and import the split `test` (--set split=test)";
        report.warning(codes::TRAINED_ON, &request.root, hit.path.display().to_string(), message, hint);
    }
}

fn read_claims(request: &Request<'_>, imported: &mut Imported, report: &mut Report) -> Result<(), DataError> {
    let mut paths: Vec<(String, PathBuf)> =
        request.claims.iter().map(|path| (String::new(), path.clone())).collect();
    if let Some(preset) = &request.preset.claims {
        let template = parse(&preset.template, &request.root)?;
        // Other runs of the evaluation may are beside each other: the latest by name counts.
        let mut latest: BTreeMap<String, PathBuf> = BTreeMap::new();
        for hit in template.find(&request.root, &Captures::new(), report)? {
            let scene = hit.text("scene").unwrap_or_default().to_owned();
            if request.scenes.iter().any(|known| known.as_str() == scene) {
                latest.insert(scene, hit.path);
            }
        }
        paths.extend(latest);
    }
    for (scene, path) in paths {
        match claims::read(&path) {
            Ok(mut claims) => {
                add_mean_of_queries(request, &scene, &mut claims)?;
                let name = |claim: String| if scene.is_empty() { claim } else { format!("{scene}: {claim}") };
                imported.claimed.extend(claims.into_iter().map(|(claim, value)| (name(claim), value)));
                let label = path.strip_prefix(&request.root).unwrap_or(&path).display().to_string();
                imported.inputs.insert(format!("claims {label}"), sha256_file(&path)?);
            }
            Err(error) => report.data_error(codes::CLAIM, &error),
        }
    }
    Ok(())
}

/// What 4D LangSplat's `Mean IoU` would be without base objects, which it averages like sentences and which no query is.
fn add_mean_of_queries(request: &Request<'_>, scene: &str, claims: &mut Claims) -> Result<(), DataError> {
    let Some(scene) = request.scenes.iter().find(|known| known.as_str() == scene) else { return Ok(()) };
    let queries = SceneQueries::read(request.bench, scene)?;
    let prompts = Prompts::new(&queries.all);
    let ious = || claims.iter().filter_map(|(name, value)| Some((name.strip_prefix(claims::IOU_OF)?, value)));
    let of_queries: Vec<f64> =
        ious().filter(|(prompt, _)| !prompts.is_base_object(prompt)).map(|(_, value)| *value).collect();
    if !of_queries.is_empty() && of_queries.len() < ious().count() {
        let mean = of_queries.iter().sum::<f64>() / of_queries.len() as f64;
        claims.insert("mean iou without base objects".to_owned(), mean);
    }
    Ok(())
}

/// Reports masks that fit the truth of another frame better, or hardly touch it.
fn check_fit(
    request: &Request<'_>,
    queries: &SceneQueries,
    found: &BTreeMap<QueryId, Answers>,
    report: &mut Report,
) -> Result<(), DataError> {
    let Some(truth) = truth(request, &queries.name)? else { return Ok(()) };
    let asked: Vec<(&Query, &Answers)> =
        queries.asked().iter().filter_map(|query| Some((query, found.get(&query.id)?))).collect();
    check_frames(&truth, &request.root.join(queries.name.as_str()), &asked, report);
    Ok(())
}

fn report_missing(
    request: &Request<'_>,
    queries: &SceneQueries,
    pictures: &Pictures,
    found: &BTreeMap<QueryId, Answers>,
    report: &mut Report,
) {
    let asked: Vec<u32> = pictures.asked().collect();
    let place = format!("scene {}", queries.name);
    let unanswered: Vec<&str> = queries
        .asked()
        .iter()
        .filter(|query| !found.contains_key(&query.id))
        .map(|query| query.id.number.as_str())
        .collect();
    if !unanswered.is_empty() {
        let message = format!(
            "{} of {} queries have no answer: {}",
            unanswered.len(),
            queries.asked,
            unanswered.join(", ")
        );
        let hint = "`l4d score` refuses results with holes, unless --missing says what they mean";
        report.warning(codes::MISSING, &request.root, &place, message, hint);
    }
    for (query, answers) in found {
        let missing = asked.iter().filter(|frame| !answers.contains_key(frame)).count();
        if missing > 0 {
            let message = format!("{missing} of {} frames have no answer", asked.len());
            let hint = "render the held-out camera at every frame of the clip";
            report.warning(codes::MISSING, &request.root, format!("query {query}"), message, hint);
        }
    }
}
