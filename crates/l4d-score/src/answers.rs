//! Reads what a method answers to a query, from either form, and reports everything that is no answer.
//!
//! A mask's size is checked before it is decoded; frames are compared with those that are asked for.

use std::fmt;
use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::truth::frame_key;
use l4d_data::{QueryId, Report, json};
use l4d_masks::png::{self, PngError};
use l4d_masks::{Mask, Rle};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::codes;
use crate::exam::SceneExam;
use crate::folder::{Kind, entries, read_sized, report_link, sound_bytes};
use crate::judge::Answer;

/// Room for what a file holds beside pixels: names, headers, remarks.
const BESIDES_BYTES: u64 = 64 << 10;
/// Frames have four digits.
const MAX_FRAMES: usize = 10_000;

/// The forms in which the answers to one query are there.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Forms {
    /// `<nnn>.json`.
    pub json: bool,
    /// `<nnn>/`.
    pub folder: bool,
}

/// Reads the answers of one method to one query after another.
#[derive(Debug, Clone, Copy)]
pub struct Reader<'a> {
    /// The results.
    pub dir: &'a ResultsDir,
    /// Frames that are asked for, ascending.
    pub clip: &'a [u32],
    /// Width and height that masks must have, pixels.
    pub size: (u32, u32),
    /// Whether masks of another size are resized to it.
    pub resize: bool,
}

impl Reader<'_> {
    /// One answer per frame of the clip. What cannot be read is reported and counts as missing.
    pub fn read(&self, id: &QueryId, forms: Forms, report: &mut Report) -> Vec<Answer> {
        let mut answers = vec![Answer::Missing; self.clip.len()];
        self.read_each(id, forms, report, |position, answer| answers[position] = answer.clone());
        answers
    }

    /// Tells the answers one after another, each with its position in the clip. What cannot be read is reported and not
    /// told. Gives which frames were answered.
    pub fn read_each(
        &self,
        id: &QueryId,
        forms: Forms,
        report: &mut Report,
        mut tell: impl FnMut(usize, &Answer),
    ) -> Vec<bool> {
        let mut is_answered = vec![false; self.clip.len()];
        let tell = |position: usize, answer: &Answer| {
            is_answered[position] = true;
            tell(position, answer);
        };
        match forms {
            Forms { json: true, folder: true } => {
                let message = format!("{} and the folder {} answer the same query", id.number, id.number);
                let hint = "keep either the JSON file or the PNG folder";
                report.error(codes::DUPLICATE, &self.dir.mask_file(id), "file", message, hint);
            }
            Forms { json: true, folder: false } => self.read_json(id, report, tell),
            Forms { json: false, folder: true } => self.read_pngs(id, report, tell),
            Forms { json: false, folder: false } => {}
        }
        is_answered
    }

    /// Bytes that [`Self::read`] would read.
    pub(crate) fn bytes(&self, id: &QueryId, forms: Forms) -> u64 {
        match forms {
            Forms { json: true, folder: false } => sound_bytes(&self.dir.mask_file(id), self.largest_json()),
            Forms { json: false, folder: true } => {
                let folder = self.dir.mask_folder(id);
                let is_mask =
                    |name: &str| name.strip_suffix(".png").and_then(|key| self.position(key)).is_some();
                let found = entries(&folder, &mut Report::default());
                let masks = found.iter().filter(|(name, _)| is_mask(name));
                masks.map(|(name, _)| sound_bytes(&folder.join(name), self.largest_png())).sum()
            }
            Forms { json: true, folder: true } | Forms { json: false, folder: false } => 0,
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
            let hint = "write [height, width] of the held-out pictures, or pass --resize";
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
                report.error(codes::BAD_RLE, &path, place(), error.to_string(), error.remedy());
                continue;
            }
            answer = match (width, height) == self.size {
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
                    report.error(
                        codes::UNKNOWN_ENTRY,
                        &path,
                        "name",
                        "is no mask of a frame of the clip",
                        hint,
                    );
                }
            }
        }
    }

    fn read_png(&self, path: &Path, report: &mut Report) -> Option<Mask> {
        let bytes = read_sized(path, self.largest_png(), report)?;
        let (width, height) = self.size;
        let decoded = if self.resize {
            let checked = png::size(&bytes).map(|size| self.check_size(size));
            match checked {
                Ok(Err(message)) => {
                    report.error(
                        codes::WRONG_SIZE,
                        path,
                        "header",
                        message,
                        "keep the proportions of the profile",
                    );
                    return None;
                }
                Ok(Ok(())) => png::decode_any(&bytes),
                Err(error) => Err(error),
            }
        } else {
            png::decode(&bytes, width, height)
        };
        match decoded {
            Ok(mask) => Some(self.resized(mask)),
            Err(error) => {
                let (code, place) = match error {
                    PngError::Size { .. } | PngError::AbsurdSize { .. } => (codes::WRONG_SIZE, "header"),
                    PngError::Kind { .. } => (codes::BAD_PNG, "header"),
                    PngError::NotPng | PngError::Value { .. } | PngError::Damaged(_) => {
                        (codes::BAD_PNG, "file")
                    }
                };
                report.error(code, path, place, error.to_string(), error.remedy());
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
        let pixels = u64::from(self.size.0) * u64::from(self.size.1);
        if self.resize { pixels * LARGER * LARGER } else { pixels }
    }

    fn check_size(&self, found: (u32, u32)) -> Result<(), String> {
        let (width, height) = self.size;
        if found == self.size {
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
        let (width, height) = self.size;
        if mask.size() == self.size { mask } else { mask.resized_nearest(width, height) }
    }

    fn position(&self, key: &str) -> Option<usize> {
        let is_plain = key.len() == 4 && key.bytes().all(|byte| byte.is_ascii_digit());
        let frame = if is_plain { key.parse().ok()? } else { return None };
        self.clip.binary_search(&frame).ok()
    }
}

/// Reports the frames that are asked for and have no answer; `is_answered` holds one entry per frame of the clip.
pub fn report_missing(
    dir: &ResultsDir,
    id: &QueryId,
    scene: &SceneExam,
    is_answered: &[bool],
    report: &mut Report,
) {
    let asked: Vec<u32> = scene.asked().collect();
    let missing: Vec<u32> = scene
        .clip
        .iter()
        .zip(is_answered)
        .filter(|(frame, is_answered)| !**is_answered && asked.binary_search(frame).is_ok())
        .map(|(frame, _)| *frame)
        .collect();
    if missing.is_empty() {
        return;
    }
    let message =
        format!("{} of {} frames have no answer: {}", missing.len(), asked.len(), frame_list(&missing));
    let hint =
        "answer them (null says that nothing is to be seen), or pass --missing zero or skip to `l4d score`";
    let path = if dir.mask_folder(id).is_dir() { dir.mask_folder(id) } else { dir.mask_file(id) };
    report.error(codes::MISSING, &path, format!("query {id}"), message, hint);
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
