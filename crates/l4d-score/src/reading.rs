//! What a method answers to the queries of one scene, from either form; everything that is no answer is reported, and so
//! are holes: query by query where some are answered, once where none is.
//!
//! A mask's size is checked before it is decoded; frames are compared with those that are asked for.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::truth::frame_key;
use l4d_data::{Query, QueryId, Report, Status, json};
use l4d_masks::png::{self, PngError};
use l4d_masks::{Mask, Rle};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::codes;
use crate::eval_set::EvalScene;
use crate::folder::{Kind, entries, read_sized, report_link, sound_bytes};
use crate::judge::Answer;
use crate::results::report_unknown;

/// Room for what a file holds beside pixels: names, headers, remarks.
const BESIDES_BYTES: u64 = 64 << 10;
/// Frames have four digits.
const MAX_FRAMES: usize = 10_000;

/// The forms in which the answers to one query are there.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Forms {
    /// `<nnn>.json`.
    json: bool,
    /// `<nnn>/`.
    folder: bool,
}

/// What frames without an answer are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holes {
    /// Errors of queries that are asked.
    Reported,
    /// For the judge to count.
    Counted,
}

impl Holes {
    pub(crate) fn reported_if(is_refused: bool) -> Self {
        if is_refused { Self::Reported } else { Self::Counted }
    }
}

/// Reads the answers of one method to one scene.
#[derive(Debug)]
pub struct SceneReader<'a> {
    dir: &'a ResultsDir,
    scene: &'a EvalScene,
    /// Frames that are asked for, ascending.
    clip: &'a [u32],
    /// Whether masks of another size are resized to that of the scene.
    resize: bool,
    /// By the numbers of the queries.
    forms: BTreeMap<String, Forms>,
    holes: Holes,
}

impl<'a> SceneReader<'a> {
    /// Looks through the folder of the scene and reports what is out of place.
    pub fn open(
        dir: &'a ResultsDir,
        scene: &'a EvalScene,
        resize: bool,
        holes: Holes,
        report: &mut Report,
    ) -> Self {
        let forms = scan(dir, scene, report);
        let is_skipped = forms.is_empty() && holes == Holes::Reported;
        if is_skipped {
            report_skipped(dir, scene, report);
        }
        let holes = if is_skipped { Holes::Counted } else { holes };
        Self { dir, scene, clip: &scene.clip, resize, forms, holes }
    }

    /// The same of some frames alone, ascending; holes are not reported.
    pub fn of_frames(self, clip: &'a [u32]) -> Self {
        Self { clip, holes: Holes::Counted, ..self }
    }

    /// Whether a query is answered in any form.
    pub fn has(&self, id: &QueryId) -> bool {
        self.forms.contains_key(id.number.as_str())
    }

    /// One answer per frame of the clip. What is wrong with them is reported, and what cannot be read counts as missing.
    pub fn read(&self, query: &Query, report: &mut Report) -> Vec<Answer> {
        let mut answers = vec![Answer::Missing; self.clip.len()];
        self.read_each(query, report, |position, answer| answers[position] = answer.clone());
        answers
    }

    /// Tells the answers one after another, each with its position in the clip. What is wrong with them is reported and
    /// not told.
    pub(crate) fn read_each(&self, query: &Query, report: &mut Report, mut tell: impl FnMut(usize, &Answer)) {
        let id = &query.id;
        let mut found = Report::default();
        let mut is_answered = vec![false; self.clip.len()];
        let tell = |position: usize, answer: &Answer| {
            is_answered[position] = true;
            tell(position, answer);
        };
        match self.forms.get(id.number.as_str()).copied().unwrap_or_default() {
            Forms { json: true, folder: true } => {
                let message = format!("{} and the folder {} answer the same query", id.number, id.number);
                let hint = "keep either the JSON file or the PNG folder";
                found.error(codes::DUPLICATE, &self.dir.mask_file(id), "file", message, hint);
            }
            Forms { json: true, folder: false } => self.read_json(id, &mut found, tell),
            Forms { json: false, folder: true } => self.read_pngs(id, &mut found, tell),
            Forms { json: false, folder: false } => {}
        }
        // What could not be read has been reported and would only be repeated as missing.
        if self.holes == Holes::Reported && is_asked(query) && found.is_empty() {
            self.report_missing(id, &is_answered, &mut found);
        }
        report.extend(found);
    }

    /// Bytes of the masks that would be read.
    pub(crate) fn bytes(&self) -> u64 {
        self.scene.queries.iter().map(|query| self.bytes_of(&query.id)).sum()
    }

    fn bytes_of(&self, id: &QueryId) -> u64 {
        match self.forms.get(id.number.as_str()) {
            Some(Forms { json: true, folder: false }) => {
                sound_bytes(&self.dir.mask_file(id), self.largest_json())
            }
            Some(Forms { json: false, folder: true }) => {
                let folder = self.dir.mask_folder(id);
                let is_mask =
                    |name: &str| name.strip_suffix(".png").and_then(|key| self.position(key)).is_some();
                let found = entries(&folder, &mut Report::default());
                let masks = found.iter().filter(|(name, _)| is_mask(name));
                masks.map(|(name, _)| sound_bytes(&folder.join(name), self.largest_png())).sum()
            }
            _ => 0,
        }
    }

    fn read_json(&self, id: &QueryId, report: &mut Report, mut tell: impl FnMut(usize, &Answer)) {
        let path = self.dir.mask_file(id);
        let Some(bytes) = read_sized(&path, self.largest_json(), report) else { return };
        let file: AnswerFile = match json::parse(&path, None, &bytes) {
            Ok(file) => file,
            Err(error) => {
                report.data_error(codes::UNREADABLE, &error);
                return;
            }
        };
        let [height, width] = file.size;
        if let Err(message) = self.check_size((width, height)) {
            let hint = match (height, width) == self.scene.size && !self.resize {
                true => format!(
                    "it is [width, height]: write [height, width], which is [{}, {}]",
                    self.scene.size.1, self.scene.size.0
                ),
                false => "write [height, width] of the held-out pictures, or pass --resize".to_owned(),
            };
            report.error(codes::WRONG_SIZE, &path, "field `size`", message, hint);
            return;
        }
        let mut is_seen = vec![false; self.clip.len()];
        let mut answer = Answer::Missing;
        for (key, counts) in &file.frames.0 {
            let place = || format!("frame `{}`", printable(key));
            let Some(position) = self.position(key) else {
                let hint = format!("use the frames {}", frame_list(self.clip));
                report.error(codes::UNKNOWN_ENTRY, &path, place(), "is no frame of the clip", hint);
                continue;
            };
            if std::mem::replace(&mut is_seen[position], true) {
                report.error(codes::DUPLICATE, &path, place(), "occurs twice", "keep one of them");
                continue;
            }
            let Some(counts) = counts else {
                tell(position, &Answer::Absent);
                continue;
            };
            // One buffer for all masks of the file.
            let mut rle = match std::mem::replace(&mut answer, Answer::Missing) {
                Answer::Runs(rle) => rle,
                _ => Rle::default(),
            };
            if let Err(error) = rle.decode_into(counts, width, height) {
                report.error(codes::BAD_RLE, &path, place(), error.to_string(), error.hint());
                continue;
            }
            answer = match (width, height) == self.scene.size {
                true => Answer::Runs(rle),
                false => Answer::Pixels(self.resized(Mask::from_rle(&rle, width, height))),
            };
            tell(position, &answer);
        }
    }

    fn read_pngs(&self, id: &QueryId, report: &mut Report, mut tell: impl FnMut(usize, &Answer)) {
        let folder = self.dir.mask_folder(id);
        for (name, kind) in entries(&folder, report) {
            let path = folder.join(&name);
            let position = name.strip_suffix(".png").and_then(|key| self.position(key));
            match (kind, position) {
                (Kind::File, Some(position)) => {
                    if let Some(mask) = self.read_png(&path, report) {
                        tell(position, &Answer::Pixels(mask));
                    }
                }
                (Kind::Link | Kind::Other, _) => report_link(&path, report),
                (Kind::File | Kind::Folder, _) => {
                    let hint = format!("name masks <frame>.png with the frames {}", frame_list(self.clip));
                    let message = "is no mask of a frame of the clip";
                    report.error(codes::UNKNOWN_ENTRY, &path, "name", message, hint);
                }
            }
        }
    }

    fn read_png(&self, path: &Path, report: &mut Report) -> Option<Mask> {
        let bytes = read_sized(path, self.largest_png(), report)?;
        let (width, height) = self.scene.size;
        let decoded = match self.resize {
            true => png::size(&bytes).and_then(|size| match self.check_size(size) {
                Ok(()) => png::decode_any(&bytes).map(Some),
                Err(message) => {
                    let hint = "keep the proportions of the profile";
                    report.error(codes::WRONG_SIZE, path, "header", message, hint);
                    Ok(None)
                }
            }),
            false => png::decode(&bytes, width, height).map(Some),
        };
        match decoded {
            Ok(mask) => mask.map(|mask| self.resized(mask)),
            Err(error) => {
                let (code, place) = match error {
                    PngError::Size { .. } | PngError::AbsurdSize { .. } => (codes::WRONG_SIZE, "header"),
                    PngError::Kind { .. } => (codes::BAD_PNG, "header"),
                    PngError::NotPng | PngError::Value { .. } | PngError::Damaged(_) => {
                        (codes::BAD_PNG, "file")
                    }
                };
                report.error(code, path, place, error.to_string(), error.hint());
                None
            }
        }
    }

    /// Bytes of the largest sound JSON: run lengths of pure noise take one character a pixel, and all else takes less.
    fn largest_json(&self) -> u64 {
        self.clip.len() as u64 * (self.largest_pixels() + 16) + BESIDES_BYTES
    }

    /// Bytes of the largest sound PNG: without compression, a byte a pixel.
    fn largest_png(&self) -> u64 {
        self.largest_pixels() + self.largest_pixels() / 64 + BESIDES_BYTES
    }

    /// Pixels of the largest mask that is taken.
    fn largest_pixels(&self) -> u64 {
        /// Sides of a mask that is made smaller are at most so many times longer.
        const LARGER: u64 = 4;
        let pixels = u64::from(self.scene.size.0) * u64::from(self.scene.size.1);
        if self.resize { pixels * LARGER * LARGER } else { pixels }
    }

    fn check_size(&self, found: (u32, u32)) -> Result<(), String> {
        let (width, height) = self.scene.size;
        if found == self.scene.size {
            return Ok(());
        }
        if !self.resize {
            return Err(format!("is {}x{}, but masks are {width}x{height} here", found.0, found.1));
        }
        if !Mask::is_sane_size(found.0, found.1) {
            return Err(format!("{}x{} cannot be resized", found.0, found.1));
        }
        let ours = u64::from(width) * u64::from(found.1);
        let theirs = u64::from(height) * u64::from(found.0);
        if ours.abs_diff(theirs) * 100 > ours {
            let shape = format!("{}x{}", found.0, found.1);
            return Err(format!(
                "{shape} has other proportions than {width}x{height}, so it shows another picture"
            ));
        }
        Ok(())
    }

    fn resized(&self, mask: Mask) -> Mask {
        let (width, height) = self.scene.size;
        if mask.size() == self.scene.size { mask } else { mask.resized_nearest(width, height) }
    }

    fn position(&self, key: &str) -> Option<usize> {
        let is_plain = key.len() == 4 && key.bytes().all(|byte| byte.is_ascii_digit());
        let frame = if is_plain { key.parse().ok()? } else { return None };
        self.clip.binary_search(&frame).ok()
    }

    /// Reports the frames that are asked for and have no answer.
    fn report_missing(&self, id: &QueryId, is_answered: &[bool], report: &mut Report) {
        let asked: Vec<u32> = self.scene.asked().collect();
        let missing: Vec<u32> = self
            .clip
            .iter()
            .zip(is_answered)
            .filter(|(frame, is_answered)| !**is_answered && asked.binary_search(frame).is_ok())
            .map(|(frame, _)| *frame)
            .collect();
        if missing.is_empty() {
            return;
        }
        let (count, all, list) = (missing.len(), asked.len(), frame_list(&missing));
        let message = format!("{count} of {all} frames have no answer: {list}");
        let hint = "answer them (null says that nothing is to be seen), or pass --missing zero or skip to `l4d score`";
        let folder = self.dir.mask_folder(id);
        let path = if folder.is_dir() { folder } else { self.dir.mask_file(id) };
        report.error(codes::MISSING, &path, format!("query {id}"), message, hint);
    }
}

fn is_asked(query: &Query) -> bool {
    query.status != Status::Rejected
}

fn report_skipped(dir: &ResultsDir, scene: &EvalScene, report: &mut Report) {
    let asked = scene.queries.iter().filter(|query| is_asked(query)).count();
    if asked == 0 {
        return;
    }
    let message = format!("answers none of the {asked} queries of scene {}", scene.name);
    let hint =
        "answer them, name the scenes that count (--scenes), or pass --missing zero or skip to `l4d score`";
    report.error(codes::MISSING, &dir.masks().join(scene.name.as_str()), "folder", message, hint);
}

/// Looks through the masks of a scene: which queries are answered in which form, and what is out of place.
fn scan(dir: &ResultsDir, scene: &EvalScene, report: &mut Report) -> BTreeMap<String, Forms> {
    let folder = dir.masks().join(scene.name.as_str());
    let mut found: BTreeMap<String, Forms> = BTreeMap::new();
    for (name, kind) in entries(&folder, report) {
        let path = folder.join(&name);
        let number = match kind {
            Kind::Folder => Some(name.as_str()),
            Kind::File => name.strip_suffix(".json"),
            Kind::Link | Kind::Other => {
                report_link(&path, report);
                continue;
            }
        };
        let Some(number) = number else {
            report_unknown(&path, report);
            continue;
        };
        if scene.not_asked.iter().any(|other| other.as_str() == number) {
            continue;
        }
        if !scene.queries.iter().any(|query| query.id.number.as_str() == number) {
            let hint = "rename or remove it; the queries are in the benchmark's folder `queries`";
            let message = format!("is no query of scene {}", scene.name);
            report.error(codes::UNKNOWN_QUERY, &path, "name", message, hint);
            continue;
        }
        let forms = found.entry(number.to_owned()).or_default();
        match kind {
            Kind::Folder => forms.folder = true,
            _ => forms.json = true,
        }
    }
    found
}

/// [`l4d_data::results::MaskFile`] as read from an untrusted file: keys in order, so that doubles are seen.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AnswerFile {
    size: [u32; 2],
    frames: Pairs,
}

/// Frames and their counts, null for absent.
#[derive(Debug)]
struct Pairs(Vec<(String, Option<String>)>);

impl<'de> Deserialize<'de> for Pairs {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;

        impl<'de> Visitor<'de> for Collect {
            type Value = Pairs;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("an object of frames")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Pairs, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    if pairs.len() == MAX_FRAMES {
                        return Err(A::Error::custom("more frames than four digits can name"));
                    }
                    pairs.push(pair);
                }
                Ok(Pairs(pairs))
            }
        }

        deserializer.deserialize_map(Collect)
    }
}

/// The first frames and the last.
pub(crate) fn frame_list(frames: &[u32]) -> String {
    const SHOWN: usize = 4;
    let shown: Vec<String> = frames.iter().take(SHOWN).map(|frame| frame_key(*frame)).collect();
    match frames {
        [.., last] if frames.len() > SHOWN => format!("{}, ... {}", shown.join(", "), frame_key(*last)),
        _ => shown.join(", "),
    }
}

/// Untrusted text, short and without effect.
pub(crate) fn printable(text: &str) -> String {
    text.chars().take(40).flat_map(char::escape_default).collect()
}
