//! The answers of one scene as they come together: each query and frame once, at the size of the profile.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::error::inert;
use l4d_data::{Query, QueryId, Report, Severity};
use l4d_masks::{Mask, Rle};
use rayon::prelude::*;

use super::super::codec::{self, Piece, Place, Problem, Reading};
use super::super::codes;
use super::super::prompts::{NoQuery, Prompts};
use super::super::relevancy::Found;
use super::super::shift::{Answers, Summits};
use super::super::template::Hit;
use super::Request;
use super::frames::Pictures;

/// Findings of one code that a scene lists one by one.
const LISTED: usize = 12;

/// Files that are decoded before their answers are collected.
const BATCH: usize = 256;

/// An answer with its place, ready to be collected.
#[derive(Debug)]
pub(super) struct Answer {
    query: QueryId,
    frame: u32,
    /// Run lengths; none where the method says that nothing is there.
    mask: Option<Rle>,
}

/// Reads files that hold masks or maps: decoded side by side, collected in the order of their paths.
pub(super) fn read(reading: &Reading, hits: &[Hit], collector: &mut Collector<'_>) {
    for batch in hits.chunks(BATCH) {
        let decode = |hit: &Hit| -> (Vec<Answer>, Report) {
            let mut report = Report::default();
            let pieces = codec::read(&hit.path, reading, collector.pictures.size);
            let pieces = pieces.map_err(|problem| problem.report(&hit.path, &mut report)).unwrap_or_default();
            let placed = pieces.into_iter().map(|piece| collector.place(hit, piece));
            let placed = placed.filter_map(|answer| {
                answer.unwrap_or_else(|problem| {
                    problem.report(&hit.path, &mut report);
                    None
                })
            });
            (placed.collect(), report)
        };
        let decoded: Vec<(Vec<Answer>, Report)> = batch.par_iter().map(decode).collect();
        for (hit, (answers, report)) in batch.iter().zip(decoded) {
            collector.findings().extend(report);
            answers.into_iter().for_each(|answer| collector.take(&hit.path, answer));
        }
    }
}

/// Collects the answers of a scene.
pub(super) struct Collector<'a> {
    request: &'a Request<'a>,
    prompts: &'a Prompts<'a>,
    pictures: &'a Pictures,
    answers: BTreeMap<QueryId, Answers>,
    from: BTreeMap<(QueryId, u32), PathBuf>,
    summits: Summits,
    findings: Report,
}

impl<'a> Collector<'a> {
    pub(super) fn new(request: &'a Request<'a>, prompts: &'a Prompts<'a>, pictures: &'a Pictures) -> Self {
        Self {
            request,
            prompts,
            pictures,
            answers: BTreeMap::new(),
            from: BTreeMap::new(),
            summits: Summits::new(),
            findings: Report::default(),
        }
    }

    /// The pictures that are answered.
    pub(super) fn pictures(&self) -> &'a Pictures {
        self.pictures
    }

    /// Where problems of single files go: many of one kind are reported as a few and their number.
    pub(super) fn findings(&mut self) -> &mut Report {
        &mut self.findings
    }

    /// The query that a file or one of its pieces answers.
    fn query(&self, hit: &Hit, name: Option<&str>) -> Result<&'a Query, Problem> {
        let unknown = |place: &str, message: String, hint: String| {
            Problem::new(codes::UNKNOWN_PROMPT, place, message, hint)
        };
        let (shown, found) = match (hit.text("query"), hit.text("text"), name) {
            (Some(number), _, _) => {
                (number, self.prompts.by_number(number).ok_or(NoQuery::Unknown { nearest: None }))
            }
            (None, Some(text), _) => (text, self.prompts.by_text(text)),
            (None, None, Some(name)) => (name, self.prompts.find(name)),
            (None, None, None) => {
                let message = "does not say which sentence it answers".to_owned();
                return Err(unknown("path", message, "write {text} or {query} into the template".to_owned()));
            }
        };
        let shown = inert(shown);
        found.map_err(|problem| match problem {
            NoQuery::Unknown { nearest } => {
                let hint = match nearest {
                    Some(nearest) => format!(
                        "the nearest sentence is `{nearest}`; rename the file, or leave it out with --ignore"
                    ),
                    None => "use the numbers of the benchmark's queries".to_owned(),
                };
                unknown("name", format!("`{shown}` is no query of the scene"), hint)
            }
            NoQuery::Several(ids) => {
                let message = format!("`{shown}` may mean each of {}", ids.join(", "));
                let hint = "name files by the numbers of queries: {query} instead of {text}";
                Problem::new(codes::COLLISION, "name", message, hint)
            }
        })
    }

    /// The frame that a file or one of its pieces answers for; none where it is not asked for.
    pub(super) fn frame(&self, hit: &Hit, place: Option<Place>) -> Result<Option<u32>, Problem> {
        let wrong =
            |message: String, hint: &'static str| Problem::new(codes::FRAME_RULE, "path", message, hint);
        let position = |position: u64| usize::try_from(position).ok().map(Place::Position);
        let of_path = match (hit.number("frame"), hit.number("position"), hit.number("image")) {
            (Some(frame), _, _) => u32::try_from(frame).ok().map(Place::Frame),
            (None, Some(number), _) => position(number),
            (None, None, Some(image)) => {
                let images = self.pictures.images.as_ref().ok_or_else(|| {
                    let message = "is named by the id of an image, not by a frame";
                    wrong(message.to_owned(), "give --images <_annotations.coco.json>")
                })?;
                let position = images.position(image).ok_or_else(|| {
                    let message = format!("is named by the image {image}, which --images does not list");
                    wrong(message, "give the annotations that the run used")
                })?;
                Some(Place::Position(position))
            }
            (None, None, None) => None,
        };
        let place = of_path.or(place).ok_or_else(|| {
            let message = "does not say which frame it answers for";
            wrong(message.to_owned(), "write {frame} or {position} into the template")
        })?;
        let hint = "check how files are numbered: {frame} is a number of the benchmark, {position} counts pictures from 0; --frames lists them";
        let frame = match place {
            Place::Frame(frame) if self.pictures.clip.contains(&frame) => Some(frame),
            Place::Frame(frame) => {
                return Err(wrong(format!("{frame} is {}", self.pictures.frames_in_words()), hint));
            }
            Place::Position(position) => {
                let frame = self.request.order.frame(position, &self.pictures.clip);
                frame.map_err(|count| {
                    wrong(format!("is picture {position}, but there are {count} (from 0)"), hint)
                })?
            }
        };
        Ok(frame.filter(|frame| self.pictures.is_asked(*frame)))
    }

    /// A piece with its query and frame, at the size of the profile.
    fn place(&self, hit: &Hit, piece: Piece) -> Result<Option<Answer>, Problem> {
        let query = self.query(hit, piece.name.as_deref())?;
        let Some(frame) = self.frame(hit, piece.place)? else { return Ok(None) };
        let answer = match piece.mask {
            None => Answer { query: query.id.clone(), frame, mask: None },
            Some(mask) => self.answer(query, frame, mask)?,
        };
        Ok(Some(answer))
    }

    /// A mask at the size of the profile.
    fn answer(&self, query: &Query, frame: u32, mask: Mask) -> Result<Answer, Problem> {
        let (size, wanted) = (mask.size(), self.pictures.size);
        self.fits(size)?;
        let mask = if size == wanted { mask } else { mask.resized_nearest(wanted.0, wanted.1) };
        Ok(Answer { query: query.id.clone(), frame, mask: Some(mask.to_rle()) })
    }

    /// Refuses a size of pictures that can answer neither as they are nor resized.
    pub(super) fn fits(&self, (width, height): (u32, u32)) -> Result<(), Problem> {
        let wanted = self.pictures.size;
        let ratio = f64::from(width) * f64::from(wanted.1) / (f64::from(height) * f64::from(wanted.0));
        let is_similar = (ratio - 1.0).abs() <= 0.01;
        if (width, height) == wanted || (self.request.resize && is_similar) {
            return Ok(());
        }
        let owner = self.pictures.owner();
        let message = format!("is {width}x{height}, but {owner} is {}x{}", wanted.0, wanted.1);
        let hint = match is_similar {
            true => "render at that size, or pass --resize (nearest)",
            false => "render at that size: other proportions show another picture",
        };
        Err(Problem::new(codes::WRONG_SIZE, "size", message, hint))
    }

    /// Takes an answer, unless there is one already.
    pub(super) fn take(&mut self, path: &Path, answer: Answer) {
        let key = (answer.query.clone(), answer.frame);
        if let Some(other) = self.from.get(&key) {
            let message =
                format!("answers query {} in frame {} again, after {}", key.0, key.1, other.display());
            let hint =
                "keep one of them: sentences of one category, or of one file name, overwrite each other";
            self.findings.error(codes::COLLISION, path, "answer", message, hint);
            return;
        }
        self.from.insert(key, path.to_owned());
        self.answers.entry(answer.query).or_default().insert(answer.frame, answer.mask);
    }

    /// Takes what was found of a query in a frame.
    pub(super) fn take_found(&mut self, path: &Path, query: &Query, frame: u32, found: Found) {
        match self.answer(query, frame, found.mask) {
            Ok(answer) => self.take(path, answer),
            Err(problem) => problem.report(path, &mut self.findings),
        }
    }

    /// Takes where the relevancy of a query is highest in a frame.
    pub(super) fn take_summit(&mut self, query: &Query, frame: u32, at: [f64; 2]) {
        self.summits.insert((query.id.clone(), frame), at);
    }

    /// Says of frames that nothing is there, whatever was answered.
    pub(super) fn empty(&mut self, query: &QueryId, frames: impl Iterator<Item = u32>) {
        let Some(answers) = self.answers.get_mut(query) else { return };
        for frame in frames {
            if let Some(mask) = answers.get_mut(&frame) {
                *mask = None;
            }
        }
    }

    /// The answers, and where relevancy is highest; what was found wrong goes to the report, at most a dozen of a kind.
    pub(super) fn finish(self, report: &mut Report) -> (BTreeMap<QueryId, Answers>, Summits) {
        let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
        for finding in self.findings.into_sorted() {
            let count = counts.entry(finding.code).or_default();
            *count += 1;
            if *count <= LISTED || finding.severity == Severity::Warning {
                report.add(finding);
            }
        }
        for (code, count) in counts.into_iter().filter(|(_, count)| *count > LISTED) {
            let message = format!("{} more files have the same problem", count - LISTED);
            let hint = "correct the first, and most of the others follow";
            report.error(code, &self.request.root, "folder", message, hint);
        }
        (self.answers, self.summits)
    }
}
