//! Latents of a scene: all levels of a frame, decoded and cut, one frame after the other.
//!
//! Memory holds the latents of one frame and the maps of one level. Each frame's problems are reported and the next
//! is read.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;
use l4d_data::{DataError, Name, Query, Report, Temporal};

use super::super::codes;
use super::super::latents::{Level, check};
use super::super::preset::LatentsPreset;
use super::super::prompts::spelling;
use super::super::relevancy::gate::{gate, similarities};
use super::super::relevancy::{Chosen, Decoder, Engine, Latents, TextEmbeddings, TextEmbeddingsFile, answer};
use super::super::template::{Captures, Hit, Template};
use super::answers::Collector;
use super::{Imported, Request, SceneQueries};

/// Digests of single files by what they are.
type Inputs = BTreeMap<String, String>;

pub(super) fn read(
    request: &Request<'_>,
    preset: &LatentsPreset,
    hits: &[Hit],
    queries: &SceneQueries,
    collector: &mut Collector<'_>,
    imported: &mut Imported,
) -> Result<(), DataError> {
    let Some((texts_path, texts)) = &request.encoders.texts else {
        let hint = "export the sentences once with docs/import/export_text_embeddings.py, and give --texts <file.npz>";
        let message = "holds latents, which mean nothing without embeddings of the sentences";
        collector.findings().error(codes::EMBEDDINGS, &request.root, "option --texts", message, hint);
        return Ok(());
    };
    if texts.texts.phrases().len() == 0 {
        let message = "has no `negatives`: relevancy compares each sentence with phrases that mean anything";
        let hint = "export with --model clip: object, things, stuff, texture";
        collector.findings().error(codes::EMBEDDINGS, texts_path, "array `negatives`", message, hint);
        return Ok(());
    }
    let asked = matched(&queries.all, texts);
    report_unembedded(queries.asked(), &asked, texts_path, collector.findings());
    let chosen: Vec<usize> = asked.iter().map(|(_, index)| *index).collect();
    let chosen = texts.texts.select(&chosen);
    let mut engines = Engines::new(request.encoders.decoder.as_ref(), &preset.decoder, &request.root)?;
    let mut time = Time::open(request, preset, &asked, hits, &queries.name, collector, imported)?;
    let inputs = &mut imported.inputs;
    inputs.insert("text embeddings".to_owned(), sha256_file(texts_path)?);
    let frames = by_frame(request, preset, hits, collector)?;
    for (frame, levels) in frames {
        let mut report = Report::default();
        let engine = engines.get(&levels[0].captures, &chosen, inputs, &mut report)?;
        if let Some(engine) = engine {
            let read: Option<Vec<(u64, Level)>> = levels
                .iter()
                .map(|hit| {
                    Some((hit.number("level").unwrap_or_default(), Level::read(&hit.path, &mut report)?))
                })
                .collect();
            let sound = read.filter(|levels| {
                let Latents { width, height, .. } = levels[0].1.latents();
                check(levels, engine.channels(), preset.rules.stretch_positive, &mut report)
                    && collector
                        .fits((width, height))
                        .map_err(|problem| problem.report(&levels[0].1.path, &mut report))
                        .is_ok()
            });
            if let Some(levels) = sound {
                let latents: Vec<Latents<'_>> = levels.iter().map(|(_, level)| level.latents()).collect();
                let answers = answer(engine, &latents, &preset.rules);
                let path = &levels[0].1.path;
                for ((query, _), chosen) in asked.iter().zip(&answers) {
                    report_blank(query, chosen, &levels, &mut report);
                }
                time.look(frame, &asked, &answers, inputs, &mut report)?;
                for ((query, _), chosen) in asked.iter().zip(answers) {
                    collector.take_summit(query, frame, chosen.summit.at);
                    collector.take_found(path, query, frame, chosen.found);
                }
            }
        }
        collector.findings().extend(report);
    }
    time.close(&asked, collector);
    Ok(())
}

/// Queries with the number of their sentence among the embeddings.
fn matched<'a>(queries: &'a [Query], texts: &TextEmbeddingsFile) -> Vec<(&'a Query, usize)> {
    let known: BTreeMap<String, usize> =
        texts.queries.iter().enumerate().rev().map(|(index, text)| (spelling(text), index)).collect();
    queries.iter().filter_map(|query| Some((query, *known.get(&spelling(&query.text))?))).collect()
}

fn report_unembedded(queries: &[Query], asked: &[(&Query, usize)], path: &Path, report: &mut Report) {
    let lacking: Vec<&Query> =
        queries.iter().filter(|query| asked.iter().all(|(known, _)| known.id != query.id)).collect();
    if let Some(first) = lacking.first() {
        let message = format!(
            "{} of {} queries have no vector, the first is `{}`",
            lacking.len(),
            queries.len(),
            first.text
        );
        let hint = "export all sentences of the benchmark: docs/import/export_text_embeddings.py --queries benchmark/queries";
        if asked.is_empty() {
            report.error(codes::EMBEDDINGS, path, "array `queries`", message, hint);
        } else {
            report.warning(codes::EMBEDDINGS, path, "array `queries`", message, hint);
        }
    }
}

fn report_blank(query: &Query, chosen: &Chosen, levels: &[(u64, Level)], report: &mut Report) {
    let found = &chosen.found;
    if found.peak > found.floor {
        return;
    }
    let path = &levels[chosen.level].1.path;
    let message = format!("relevancy of query {} is {} everywhere", query.id, found.peak);
    let hint = "the map is blank: check that the decoder belongs to these latents";
    report.error(codes::CONSTANT, path, "relevancy", message, hint);
}

/// Files by frame, each frame's levels in the order of the preset; gaps and unknown files are reported.
fn by_frame<'h>(
    request: &Request<'_>,
    preset: &LatentsPreset,
    hits: &'h [Hit],
    collector: &mut Collector<'_>,
) -> Result<BTreeMap<u32, Vec<&'h Hit>>, DataError> {
    let template = super::parse(&request.preset.template, &request.root)?;
    let mut frames: BTreeMap<u32, BTreeMap<usize, &Hit>> = BTreeMap::new();
    let mut report = Report::default();
    for hit in hits {
        let level = hit.number("level").unwrap_or_default();
        let Some(rank) = preset.levels.iter().position(|&known| known == level) else { continue };
        let frame = collector.frame(hit, None).map_err(|problem| problem.report(&hit.path, &mut report));
        let Ok(Some(frame)) = frame else { continue };
        if let Some(other) = frames.entry(frame).or_default().insert(rank, hit) {
            let message = format!("is level {level} of frame {frame}, as {} is", other.path.display());
            let hint = "give the folder of one run, or say which is meant with --set";
            report.error(codes::COLLISION, &hit.path, "path", message, hint);
        }
    }
    let mut whole = BTreeMap::new();
    for (frame, levels) in frames {
        let missing = (0..preset.levels.len()).find(|rank| !levels.contains_key(rank));
        let Some(missing) = missing.map(|rank| preset.levels[rank]) else {
            whole.insert(frame, levels.into_values().collect());
            continue;
        };
        let mut captures = levels.values().next().map(|hit| hit.captures.clone()).unwrap_or_default();
        captures.insert("level".to_owned(), missing.to_string());
        let path = template.fill(&request.root, &captures).unwrap_or_default();
        let message = format!("is missing: level {missing} of frame {frame}, of which there are others");
        let hint = "render every level (--feature_level 1, 2, 3) with the same list of cameras";
        report.error(codes::MISSING, &path, "file", message, hint);
    }
    let asked = collector.pictures().asked().count();
    if let Some(levels) = whole.values().next().filter(|_| whole.len() != asked) {
        let levels: &Vec<&Hit> = levels;
        let message = format!("{} frames are there, but the clip has {asked}", whole.len());
        let hint = "positions are only right if every camera of the split was rendered; --frames lists which frame each picture shows";
        report.warning(codes::FRAME_RULE, &levels[0].path, "folder", message, hint);
    }
    collector.findings().extend(report);
    Ok(whole)
}

/// Decoders by path: one for all frames, or one a frame.
struct Engines {
    /// Where they may be, with the folder that a template starts from.
    templates: Vec<(Template, PathBuf)>,
    current: Option<(PathBuf, Option<Engine>)>,
}

impl Engines {
    fn new(given: Option<&String>, preset: &[String], root: &Path) -> Result<Self, DataError> {
        // What the user gives is below the working folder or anywhere; a preset's is below the root.
        let below_root = |template: &String| Ok((super::parse(template, root)?, root.to_owned()));
        let templates = match given {
            Some(given) => {
                let (base, below) = match given.strip_prefix('/') {
                    Some(below) => (PathBuf::from("/"), below),
                    None => (PathBuf::from("."), given.strip_prefix("./").unwrap_or(given)),
                };
                vec![(super::parse(below, root)?, base)]
            }
            None => preset.iter().map(below_root).collect::<Result<_, DataError>>()?,
        };
        Ok(Self { templates, current: None })
    }

    fn get(
        &mut self,
        captures: &Captures,
        texts: &TextEmbeddings,
        inputs: &mut Inputs,
        report: &mut Report,
    ) -> Result<Option<&Engine>, DataError> {
        let filled = self.templates.iter().filter_map(|(template, base)| template.fill(base, captures));
        let filled: Vec<PathBuf> = filled.collect();
        let path = filled.iter().find(|path| path.is_file()).or(filled.first()).cloned().unwrap_or_default();
        let is_new = self.current.as_ref().is_none_or(|(known, _)| *known != path);
        if is_new {
            let engine = open(&path, texts, inputs, report)?;
            self.current = Some((path, engine));
        }
        Ok(self.current.as_ref().and_then(|(_, engine)| engine.as_ref()))
    }
}

fn open(
    path: &Path,
    texts: &TextEmbeddings,
    inputs: &mut Inputs,
    report: &mut Report,
) -> Result<Option<Engine>, DataError> {
    if !path.is_file() {
        let message = "is not there: latents mean nothing without the decoder of their autoencoder";
        let hint = "give --decoder <best_ckpt.pth>";
        report.error(codes::WIDTHS, path, "file", message, hint);
        return Ok(None);
    }
    let decoder = match Decoder::read(path) {
        Ok(decoder) => decoder,
        Err(error) => {
            report.data_error(codes::UNREADABLE, &error);
            return Ok(None);
        }
    };
    inputs.insert(format!("decoder {}", path.display()), sha256_file(path)?);
    let engine = Engine::new(&decoder, texts);
    if engine.is_none() {
        let (widths, width) = (decoder.widths(), texts.width());
        let message = format!("decodes {widths}, but the sentences have {width} numbers");
        let hint = "export the embeddings with the model that the autoencoder was trained for: CLIP has 512, E5 4096";
        report.error(codes::WIDTHS, path, "widths", message, hint);
    }
    Ok(engine)
}

/// The gate of 4D LangSplat: what is known of time, frame by frame.
struct Time<'a> {
    engines: Engines,
    /// Latents of time by frame.
    hits: BTreeMap<u32, Hit>,
    /// None where nothing is gated.
    texts: Option<&'a TextEmbeddingsFile>,
    /// Place in `asked` and number of the sentence among the embeddings.
    gated: Vec<(usize, usize)>,
    similarities: BTreeMap<usize, BTreeMap<u32, f64>>,
}

impl<'a> Time<'a> {
    fn open(
        request: &'a Request<'a>,
        preset: &LatentsPreset,
        asked: &[(&Query, usize)],
        hits: &[Hit],
        scene: &Name,
        collector: &mut Collector<'_>,
        imported: &mut Imported,
    ) -> Result<Self, DataError> {
        let encoders = &request.encoders;
        let mut time = Self {
            engines: Engines::new(encoders.time_decoder.as_ref(), &preset.time_decoder, &request.root)?,
            hits: BTreeMap::new(),
            texts: None,
            gated: Vec::new(),
            similarities: BTreeMap::new(),
        };
        let (Some((path, texts)), Some(template)) = (&encoders.time_texts, &preset.time_template) else {
            return Ok(time);
        };
        imported.inputs.insert("text embeddings of time".to_owned(), sha256_file(path)?);
        let queries: Vec<Query> = asked.iter().map(|(query, _)| (*query).clone()).collect();
        for (query, index) in
            matched(&queries, texts).into_iter().filter(|(query, _)| query.temporal == Temporal::While)
        {
            let place = asked.iter().position(|(known, _)| known.id == query.id).unwrap_or_default();
            time.gated.push((place, index));
        }
        // Of the same run as the other levels: what these have in common holds for time as well.
        let mut bound = hits.first().map(|hit| hit.captures.clone()).unwrap_or_default();
        bound.retain(|field, _| !matches!(field.as_str(), "position" | "level"));
        bound.extend(request.choices.clone());
        let template = super::parse(template, &request.root)?;
        let mut found = template.find(&request.root, &bound, &mut Report::default())?;
        let mut assume = |topic: &str, text: String| {
            imported.assumptions.insert(format!("{scene}: {topic}"), text);
        };
        super::prefer(request, &mut found, &mut assume);
        if found.is_empty() && !time.gated.is_empty() {
            let message = format!("holds no latents of time at `{template}`");
            let hint = "render level 0 with the same list of cameras, or leave --time-texts out";
            collector.findings().error(codes::MISSING, &request.root, "folder", message, hint);
        }
        if found.is_empty() || super::has_choices_left(request, &template, &found, collector.findings()) {
            return Ok(time);
        }
        time.texts = Some(texts);
        for hit in found {
            let position = hit.number("position").and_then(|position| usize::try_from(position).ok());
            let clip = &collector.pictures().clip;
            let frame = position.and_then(|position| request.order.frame(position, clip).ok().flatten());
            time.hits.extend(frame.map(|frame| (frame, hit)));
        }
        Ok(time)
    }

    /// Similarity of a frame with each gated sentence, over the pixels of its unsmoothed mask.
    fn look(
        &mut self,
        frame: u32,
        asked: &[(&Query, usize)],
        answers: &[Chosen],
        inputs: &mut Inputs,
        report: &mut Report,
    ) -> Result<(), DataError> {
        let Some(texts) = self.texts.filter(|_| !self.gated.is_empty()) else { return Ok(()) };
        let Some(hit) = self.hits.get(&frame) else {
            let folder = self.hits.values().next().and_then(|hit| hit.path.parent()).unwrap_or(Path::new(""));
            let message = format!("holds no latents of time for frame {frame}");
            let hint = "render level 0 with the same list of cameras, or leave --time-texts out";
            report.error(codes::MISSING, folder, "folder", message, hint);
            return Ok(());
        };
        let wanted: Vec<usize> = self.gated.iter().map(|(_, index)| *index).collect();
        let wanted = texts.texts.select(&wanted);
        let Some(engine) = self.engines.get(&hit.captures, &wanted, inputs, report)? else { return Ok(()) };
        let Some(level) = Level::read(&hit.path, report) else { return Ok(()) };
        let latents = level.latents();
        if latents.channels != engine.channels() {
            let message = format!(
                "has {} channels, but the decoder of time takes {}",
                latents.channels,
                engine.channels()
            );
            let hint = "give the autoencoder of the video features (video_best_ckpt.pth)";
            report.error(codes::WIDTHS, &hit.path, "shape", message, hint);
            return Ok(());
        }
        for (sentence, &(place, _)) in self.gated.iter().enumerate() {
            let mask = &answers[place].found.unsmoothed;
            if mask.size() != level.size() {
                let message = format!("is {:?}, but the other levels are {:?}", level.size(), mask.size());
                let hint = "render all levels at the same size";
                report.error(codes::WRONG_SIZE, &hit.path, "shape", message, hint);
                return Ok(());
            }
            let Some(values) = similarities(engine, latents, mask) else {
                let message = format!("query {} has no pixel to look at in frame {frame}", asked[place].0.id);
                let hint = "its map is blank; the original stops here";
                report.warning(codes::CONSTANT, &hit.path, "mask", message, hint);
                continue;
            };
            self.similarities.entry(place).or_default().insert(frame, values[sentence]);
        }
        Ok(())
    }

    /// Takes back the masks of frames whose gate is shut.
    fn close(self, asked: &[(&Query, usize)], collector: &mut Collector<'_>) {
        for (place, similarities) in self.similarities {
            let values: Vec<f64> = similarities.values().copied().collect();
            let open = gate(&values);
            let shut = similarities.keys().zip(open).filter(|(_, is_open)| !is_open).map(|(&frame, _)| frame);
            collector.empty(&asked[place].0.id, shut);
        }
    }
}
