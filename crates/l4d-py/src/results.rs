//! Writes the results of a method: its card, and a file of masks a query.
//!
//! The card comes first and says for what the masks are made: a run that was killed goes on in a folder whose card is
//! its own, and is refused in any other. Every file appears whole or not at all.

use std::collections::BTreeMap;
use std::path::PathBuf;

use l4d_data::layout::ResultsDir;
use l4d_data::results::{MaskFile, MethodCard, Used};
use l4d_data::store::remove_folder;
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name, QueryId, json};
use l4d_masks::Mask;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::arrays::{bools, mask_from, shape_of};
use crate::benchmark::{Asked, Benchmark};
use crate::error::{Failure, Result, name};
use crate::query::{Query, query_id};

const OTHER_FOLDER: &str = "choose another folder, or replace what is there with overwrite=True";

/// Writes results of a method, which the last part of `path` names: `method.json` and `masks/<scene>/<nnn>.json`.
///
/// A run that was killed is continued by the same call: `remaining()` leaves out what is there whole. `ground_truth`
/// says that the method saw any (such results are shown and never ranked), `test_view` that it saw pictures of the
/// held-out view, `depth` that it learned from rendered depth of the training views, itself or through a model (such results
/// are ranked in a track of their own), `endpoints` which model servers it asked. `overwrite` removes what is there.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct ResultsWriter {
    dir: ResultsDir,
    card: MethodCard,
    bench: Py<Benchmark>,
}

#[pymethods]
impl ResultsWriter {
    #[new]
    #[pyo3(signature = (path, benchmark, *, version, link = "", ground_truth = false, test_view = false, depth = false, endpoints = None, overwrite = false))]
    #[expect(clippy::too_many_arguments, reason = "a card has that many fields")]
    fn new(
        path: PathBuf,
        benchmark: Bound<'_, Benchmark>,
        version: String,
        link: &str,
        ground_truth: bool,
        test_view: bool,
        depth: bool,
        endpoints: Option<Vec<String>>,
        overwrite: bool,
    ) -> Result<Self> {
        let Benchmark { bench, profile } = benchmark.get();
        let folder = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let used = Used { ground_truth, test_view, depth, endpoints: endpoints.unwrap_or_default() };
        let digest = bench.truth_digest(*profile)?;
        let card = MethodCard {
            link: link.to_owned(),
            used,
            ..MethodCard::new(name("path", folder)?, version, &bench.manifest.version, digest, *profile)
        };
        let dir = ResultsDir::new(path);
        claim(&dir, &card, overwrite)?;
        Ok(Self { dir, card, bench: benchmark.unbind() })
    }

    /// Name of the method.
    #[getter]
    fn name(&self) -> &str {
        &self.card.name
    }

    /// The folder.
    #[getter]
    fn path(&self) -> PathBuf {
        self.dir.root().to_owned()
    }

    /// Sentences whose answer is not there whole yet; `set` as in `Benchmark.queries`.
    #[pyo3(signature = (scene = None, *, set = "queries"))]
    fn remaining(&self, py: Python<'_>, scene: Option<&str>, set: &str) -> Result<Vec<Query>> {
        let bench = self.bench.get();
        let mut queries = bench.queries_of(scene, set)?;
        py.detach(|| {
            let mut asked: BTreeMap<Name, Asked> = BTreeMap::new();
            for query in &queries {
                if !asked.contains_key(&query.id.scene) {
                    asked.insert(query.id.scene.clone(), bench.asked(&query.id.scene)?);
                }
            }
            queries.retain(|query| {
                !asked.get(&query.id.scene).is_some_and(|asked| self.is_whole(&query.id, asked))
            });
            Ok::<_, Failure>(())
        })?;
        Ok(queries.into_iter().map(Query::from).collect())
    }

    /// Writes the answer to a query (or to the query of that id).
    ///
    /// `masks` is bool (T, H, W) in the order of `Benchmark.clip(scene)`, or a dict from each of these frames to bool (H, W)
    /// or None. None, and a mask without a pixel, say that what is asked for cannot be seen. Frames of a capture that
    /// no one annotated may be left out.
    fn write(&self, py: Python<'_>, query: &Bound<'_, PyAny>, masks: &Bound<'_, PyAny>) -> Result<()> {
        let query = self.bench.get().query_of(&query_id(query)?)?;
        let asked = self.bench.get().asked(&query.id.scene)?;
        let masks = match masks.cast::<PyDict>() {
            Ok(masks) => masks_by_frame(masks, &asked)?,
            Err(_) => masks_of_clip(masks, &asked)?,
        };
        py.detach(|| {
            let answer = |(frame, mask): &(u32, Option<Mask>)| {
                let mask = mask.as_ref().filter(|mask| !mask.is_empty());
                (frame_key(*frame), mask.map(Mask::to_rle))
            };
            let [width, height] = asked.size;
            let file = MaskFile { size: [height, width], frames: masks.par_iter().map(answer).collect() };
            json::write_compact(&self.dir.mask_file(&query.id), &file)
        })?;
        Ok(())
    }

    /// Writes into the card how many wall seconds the method took for all queries. A folder is whole without it.
    fn finish(&self, py: Python<'_>, seconds: f64) -> Result<()> {
        if !(seconds.is_finite() && seconds >= 0.0) {
            let message = format!("{seconds} is no time");
            return Err(Failure::argument("seconds", message, "give wall seconds"));
        }
        let card = MethodCard { seconds: Some(seconds), ..self.card.clone() };
        Ok(py.detach(|| json::write(&self.dir.card(), &card))?)
    }

    fn __repr__(&self) -> String {
        format!("ResultsWriter('{}', {})", self.card.name, self.card.profile)
    }
}

impl ResultsWriter {
    fn is_whole(&self, id: &QueryId, asked: &Asked) -> bool {
        let file = json::read::<MaskFile>(&self.dir.mask_file(id));
        file.is_ok_and(|file| {
            let needs_none = |frame: &u32| asked.unannotated.binary_search(frame).is_ok();
            let is_answered = |frame: &u32| file.frames.contains_key(&frame_key(*frame)) || needs_none(frame);
            file.size == [asked.size[1], asked.size[0]] && asked.clip.iter().all(is_answered)
        })
    }
}

/// Takes the folder for results of this card.
fn claim(dir: &ResultsDir, card: &MethodCard, overwrite: bool) -> Result<()> {
    let path = dir.card();
    if overwrite {
        remove_folder(&dir.masks())?;
        return Ok(json::write(&path, card)?);
    }
    if path.exists() {
        let before = MethodCard { seconds: None, reported: BTreeMap::new(), ..MethodCard::read(&path)? };
        return match difference(&before, card) {
            None => Ok(()),
            Some(field) => Err(DataError::invalid(
                &path,
                format!("field `{field}`"),
                "is another one: the folder holds results of another run",
                OTHER_FOLDER,
            )
            .into()),
        };
    }
    if dir.masks().exists() {
        return Err(Failure::file(dir.root(), "holds masks, and no method.json says of what", OTHER_FOLDER));
    }
    Ok(json::write(&path, card)?)
}

/// The first field in which two cards differ; the profile before all that follows from it.
fn difference(before: &MethodCard, now: &MethodCard) -> Option<String> {
    let [before, now] = [before, now].map(|card| serde_json::to_value(card).unwrap_or_default());
    let fields = [&before, &now].into_iter().filter_map(|card| card.as_object()).flat_map(|card| card.keys());
    let mut fields = std::iter::once("profile").chain(fields.map(String::as_str));
    fields.find(|field| before.get(field) != now.get(field)).map(str::to_owned)
}

/// One mask a frame, from an array over the whole clip.
fn masks_of_clip(masks: &Bound<'_, PyAny>, asked: &Asked) -> Result<Vec<(u32, Option<Mask>)>> {
    let [rows, columns] = shape_of(asked.size);
    let pixels = bools("masks", masks, &[asked.clip.len(), rows, columns])?;
    let (array, [width, height]) = (pixels.as_array(), asked.size);
    let mask = |at: usize| Mask::from_fn(width, height, |col, row| array[[at, row as usize, col as usize]]);
    Ok(asked.clip.iter().enumerate().map(|(at, &frame)| (frame, Some(mask(at)))).collect())
}

/// One mask a frame, from a dict that has all that are asked for.
fn masks_by_frame(masks: &Bound<'_, PyDict>, asked: &Asked) -> Result<Vec<(u32, Option<Mask>)>> {
    for key in masks.keys() {
        let is_known = key.extract::<u32>().is_ok_and(|frame| asked.clip.binary_search(&frame).is_ok());
        if !is_known {
            let message = format!("has the key {key}, which is no frame of the clip");
            return Err(Failure::argument("masks", message, "use the numbers of `Benchmark.clip` as keys"));
        }
    }
    let mut answers = Vec::with_capacity(asked.clip.len());
    for &frame in &asked.clip {
        match masks.get_item(frame)? {
            None if asked.unannotated.binary_search(&frame).is_ok() => {}
            None => {
                let message = format!("has no answer for frame {frame}");
                let hint = "answer every frame; None says that nothing is to be seen";
                return Err(Failure::argument("masks", message, hint));
            }
            Some(value) if value.is_none() => answers.push((frame, None)),
            Some(value) => {
                let field = format!("masks[{frame}]");
                answers.push((frame, Some(mask_from(&field, &value, asked.size)?)));
            }
        }
    }
    Ok(answers)
}
