//! Latents of a scene: all levels of a frame, decoded and cut, one frame after the other.
//!
//! Memory holds the latents of one frame and the maps of one level. Each frame's problems are reported and the next
//! is read.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;
use l4d_data::{DataError, Query, Report, Temporal};

use super::super::codes;
use super::super::latents::{Level, check};
use super::super::preset::LatentsPreset;
use super::super::prompts::spelling;
use super::super::relevancy::gate::{gate, similarities};
use super::super::relevancy::{Chosen, Decoder, Engine, Latents, Texts, TextsFile, answer};
use super::super::template::{Captures, Hit, Template};
use super::Request;
use super::answers::Collector;

/// Digests of single files by what they are.
type Inputs = BTreeMap<String, String>;

pub(super) fn read(
    request: &Request<'_>,
    preset: &LatentsPreset,
    hits: &[Hit],
    queries: &[Query],
    collector: &mut Collector<'_>,
    inputs: &mut Inputs,
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
    inputs.insert("text embeddings".to_owned(), sha256_file(texts_path)?);
    let asked = matched(queries, texts);
    report_unembedded(queries, &asked, texts_path, collector.findings());
    let chosen: Vec<usize> = asked.iter().map(|(_, index)| *index).collect();
    let chosen = texts.texts.select(&chosen);
    let mut engines =
        Engines::new(request.encoders.decoder.as_ref(), preset.decoder.as_ref(), &request.root)?;
    let mut time = Time::open(request, preset, &asked, hits, &collector.pictures().clip, inputs)?;
    let frames = by_frame(preset, hits, collector);
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
                check(levels, engine.channels(), &mut report)
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
fn matched<'a>(queries: &'a [Query], texts: &TextsFile) -> Vec<(&'a Query, usize)> {
    let known: BTreeMap<String, usize> =
        texts.queries.iter().enumerate().rev().map(|(index, text)| (spelling(text), index)).collect();
    queries.iter().filter_map(|query| Some((query, *known.get(&spelling(&query.text))?))).collect()
}

fn report_unembedded(queries: &[Query], asked: &[(&Query, usize)], path: &Path, report: &mut Report) {
    let lacking: Vec<&Query> =
        queries.iter().filter(|query| asked.iter().all(|(known, _)| known.id != query.id)).collect();
    if let Some(first) = lacking.first() {
        let message = format!(
            "{} of {} sentences have no vector, the first is `{}`",
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
    preset: &LatentsPreset,
    hits: &'h [Hit],
    collector: &mut Collector<'_>,
) -> BTreeMap<u32, Vec<&'h Hit>> {
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
        if levels.len() == preset.levels.len() {
            whole.insert(frame, levels.into_values().collect());
        } else if let Some(hit) = levels.values().next() {
            let message =
                format!("{} of {} levels of frame {frame} are there", levels.len(), preset.levels.len());
            let hint = "render every level (--feature_level 1, 2, 3) with the same list of cameras";
            report.error(codes::MISSING, &hit.path, "levels", message, hint);
        }
    }
    let asked = collector.pictures().asked().count();
    if let Some(levels) = whole.values().next().filter(|_| whole.len() != asked) {
        let levels: &Vec<&Hit> = levels;
        let message = format!("{} frames are there, but the clip has {asked}", whole.len());
        let hint = "positions are only right if every camera of the split was rendered; --frames lists which frame each picture shows";
        report.warning(codes::FRAME_RULE, &levels[0].path, "folder", message, hint);
    }
    collector.findings().extend(report);
    whole
}

/// Decoders by path: one for all frames, or one a frame.
struct Engines {
    template: Option<(Template, PathBuf)>,
    current: Option<(PathBuf, Option<Engine>)>,
}

impl Engines {
    fn new(given: Option<&String>, preset: Option<&String>, root: &Path) -> Result<Self, DataError> {
        // What the user gives is below the working folder or anywhere; a preset's is below the root.
        let template = match (given, preset) {
            (Some(given), _) => {
                let (base, below) = match given.strip_prefix('/') {
                    Some(below) => (PathBuf::from("/"), below),
                    None => (PathBuf::from("."), given.strip_prefix("./").unwrap_or(given)),
                };
                Some((super::parse(below, root)?, base))
            }
            (None, Some(preset)) => Some((super::parse(preset, root)?, root.to_owned())),
            (None, None) => None,
        };
        Ok(Self { template, current: None })
    }

    fn get(
        &mut self,
        captures: &Captures,
        texts: &Texts,
        inputs: &mut Inputs,
        report: &mut Report,
    ) -> Result<Option<&Engine>, DataError> {
        let path = self.template.as_ref().and_then(|(template, base)| template.fill(base, captures));
        let path = path.unwrap_or_default();
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
    texts: &Texts,
    inputs: &mut Inputs,
    report: &mut Report,
) -> Result<Option<Engine>, DataError> {
    if !path.is_file() {
        let message = "is not there: latents mean nothing without the decoder of their autoencoder";
        let hint = "give --decoder <best_ckpt.pth>; training leaves it in autoencoder/ckpt/<scene>/, the evaluation looks in <scene>/ae_ckpt/";
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
    texts: Option<&'a (PathBuf, TextsFile)>,
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
        clip: &[u32],
        inputs: &mut Inputs,
    ) -> Result<Self, DataError> {
        let texts = request.encoders.time_texts.as_ref();
        let (given, preset_decoder) = (request.encoders.time_decoder.as_ref(), preset.time_decoder.as_ref());
        let mut time = Self {
            engines: Engines::new(given, preset_decoder, &request.root)?,
            hits: BTreeMap::new(),
            texts,
            gated: Vec::new(),
            similarities: BTreeMap::new(),
        };
        let (Some((path, texts)), Some(template)) = (texts, &preset.time_template) else { return Ok(time) };
        inputs.insert("text embeddings of time".to_owned(), sha256_file(path)?);
        let queries: Vec<Query> = asked.iter().map(|(query, _)| (*query).clone()).collect();
        for (query, index) in
            matched(&queries, texts).into_iter().filter(|(query, _)| query.temporal == Temporal::While)
        {
            let place = asked.iter().position(|(known, _)| known.id == query.id).unwrap_or_default();
            time.gated.push((place, index));
        }
        let scene = hits.first().and_then(|hit| hit.text("scene")).map(str::to_owned);
        let mut bound = request.choices.clone();
        bound.extend(scene.map(|scene| ("scene".to_owned(), scene)));
        let found =
            super::parse(template, &request.root)?.find(&request.root, &bound, &mut Report::default())?;
        for hit in found {
            let position = hit.number("position").and_then(|position| usize::try_from(position).ok());
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
        let Some((texts_path, texts)) = self.texts.filter(|_| !self.gated.is_empty()) else { return Ok(()) };
        let Some(hit) = self.hits.get(&frame) else {
            let message = format!("nothing is there for frame {frame}");
            let hint = "render the level of time with the same list of cameras, or leave --time-texts out";
            report.error(codes::MISSING, texts_path, "latents of time", message, hint);
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
