//! The answers of one scene as they come together: each query and frame once, at the size of the profile.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::{DataError, Query, QueryId, Report, Severity};
use l4d_masks::{Mask, Rle};

use super::super::codec::{Piece, Place};
use super::super::codes;
use super::super::prompts::{NoQuery, Prompts};
use super::super::relevancy::Found;
use super::super::shift::{Answers, Summits};
use super::super::template::Hit;
use super::Request;
use super::pictures::Pictures;
use super::soft;

/// Findings of one code that a scene lists one by one.
const LISTED: usize = 12;

/// An answer with its place, ready to be collected.
#[derive(Debug)]
pub(super) struct Answer {
    query: QueryId,
    frame: u32,
    /// Run lengths; none where the method says that nothing is there.
    mask: Option<Rle>,
    /// Relevancy as PNG, where it is kept.
    soft: Option<Vec<u8>>,
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
    pub(super) fn query(&self, hit: &Hit, name: Option<&str>, report: &mut Report) -> Option<&'a Query> {
        let found = match (hit.text("query"), hit.text("text"), name) {
            (Some(number), _, _) => self.prompts.by_number(number).ok_or(NoQuery::Unknown { nearest: None }),
            (None, Some(text), _) => self.prompts.by_text(text),
            (None, None, Some(name)) => self.prompts.find(name),
            (None, None, None) => {
                let hint = "write {text} or {query} into the template";
                report.error(
                    codes::UNKNOWN_PROMPT,
                    &hit.path,
                    "path",
                    "does not say which sentence it answers",
                    hint,
                );
                return None;
            }
        };
        let shown =
            l4d_data::error::inert(hit.text("query").or(hit.text("text")).or(name).unwrap_or_default());
        match found {
            Ok(query) => Some(query),
            Err(NoQuery::Unknown { nearest }) => {
                let hint = match nearest {
                    Some(nearest) => format!(
                        "the nearest sentence is `{nearest}`; rename the file, or leave it out with --ignore"
                    ),
                    None => "use the numbers of the benchmark's queries".to_owned(),
                };
                report.error(
                    codes::UNKNOWN_PROMPT,
                    &hit.path,
                    "name",
                    format!("`{shown}` is no query of the scene"),
                    hint,
                );
                None
            }
            Err(NoQuery::Several(ids)) => {
                let message = format!("`{shown}` may mean each of {}", ids.join(", "));
                let hint = "name files by the numbers of queries: {query} instead of {text}";
                report.error(codes::COLLISION, &hit.path, "name", message, hint);
                None
            }
        }
    }

    /// The frame that a file or one of its pieces answers for; none where it is not asked for, or reported.
    pub(super) fn frame(&self, hit: &Hit, place: Option<Place>, report: &mut Report) -> Option<u32> {
        let position = |position: u64| usize::try_from(position).ok().map(Place::Position);
        let of_path = match (hit.number("frame"), hit.number("position"), hit.number("image")) {
            (Some(frame), _, _) => u32::try_from(frame).ok().map(Place::Frame),
            (None, Some(number), _) => position(number),
            (None, None, Some(image)) => {
                let Some(images) = &self.request.images else {
                    let hint = "give --images <_annotations.coco.json>";
                    report.error(
                        codes::FRAME_RULE,
                        &hit.path,
                        "path",
                        "is named by the id of an image, not by a frame",
                        hint,
                    );
                    return None;
                };
                let Some(position) = images.position(image) else {
                    let message = format!("is named by the image {image}, which --images does not list");
                    report.error(
                        codes::FRAME_RULE,
                        &hit.path,
                        "path",
                        message,
                        "give the annotations that the run used",
                    );
                    return None;
                };
                Some(Place::Position(position))
            }
            (None, None, None) => None,
        };
        let Some(place) = of_path.or(place) else {
            let hint = "write {frame} or {position} into the template";
            report.error(
                codes::FRAME_RULE,
                &hit.path,
                "path",
                "does not say which frame it answers for",
                hint,
            );
            return None;
        };
        let wrong = |message: String, report: &mut Report| {
            let hint = "check how files are numbered: {frame} is a number of the benchmark, {position} counts pictures from 0; --frames lists them";
            report.error(codes::FRAME_RULE, &hit.path, "path", message, hint);
            None
        };
        let frame = match place {
            Place::Frame(frame) if self.pictures.clip.contains(&frame) => Some(frame),
            Place::Frame(frame) => wrong(format!("{frame} is {}", self.pictures.frames_in_words()), report),
            Place::Position(position) => match self.request.order.frame(position, &self.pictures.clip) {
                Ok(frame) => frame,
                Err(count) => wrong(format!("is picture {position}, but there are {count} (from 0)"), report),
            },
        };
        frame.filter(|frame| self.pictures.is_asked(*frame))
    }

    /// A piece with its query and frame, at the size of the profile.
    pub(super) fn place(&self, hit: &Hit, piece: Piece, report: &mut Report) -> Option<Answer> {
        let query = self.query(hit, piece.name.as_deref(), report)?;
        let frame = self.frame(hit, piece.place, report)?;
        match piece.mask {
            None => Some(Answer { query: query.id.clone(), frame, mask: None, soft: None }),
            Some(mask) => self.answer(&hit.path, query, frame, mask, piece.soft.as_deref(), report),
        }
    }

    /// A mask, and the relevancy that it was cut from where that is kept, at the size of the profile.
    fn answer(
        &self,
        path: &Path,
        query: &Query,
        frame: u32,
        mask: Mask,
        soft: Option<&[u8]>,
        report: &mut Report,
    ) -> Option<Answer> {
        let size = mask.size();
        let mask = self.sized(path, mask, report)?.to_rle();
        let kept = soft.filter(|_| self.request.soft.is_some());
        let soft = kept.map(|soft| soft::picture(soft, size, self.pictures.size));
        Some(Answer { query: query.id.clone(), frame, mask: Some(mask), soft })
    }

    fn sized(&self, path: &Path, mask: Mask, report: &mut Report) -> Option<Mask> {
        let wanted = self.pictures.size;
        match self.fits(path, mask.size(), report) {
            true if mask.size() == wanted => Some(mask),
            true => Some(mask.resized_nearest(wanted.0, wanted.1)),
            false => None,
        }
    }

    /// Whether pictures of a size can answer, as they are or resized; reported where not.
    pub(super) fn fits(&self, path: &Path, (width, height): (u32, u32), report: &mut Report) -> bool {
        let wanted = self.pictures.size;
        let ratio = f64::from(width) * f64::from(wanted.1) / (f64::from(height) * f64::from(wanted.0));
        if (width, height) == wanted || (self.request.resize && (ratio - 1.0).abs() <= 0.01) {
            return true;
        }
        let message =
            format!("is {width}x{height}, but {} is {}x{}", self.pictures.owner(), wanted.0, wanted.1);
        let hint = if (ratio - 1.0).abs() <= 0.01 {
            "render at that size, or pass --resize (nearest)"
        } else {
            "render at that size: other proportions show another picture"
        };
        report.error(codes::WRONG_SIZE, path, "size", message, hint);
        false
    }

    /// Takes an answer, unless there is one already.
    pub(super) fn take(&mut self, path: &Path, answer: Answer) -> Result<(), DataError> {
        let key = (answer.query.clone(), answer.frame);
        if let Some(other) = self.from.get(&key) {
            let message =
                format!("answers query {} in frame {} again, after {}", key.0, key.1, other.display());
            let hint =
                "keep one of them: sentences of one category, or of one file name, overwrite each other";
            self.findings.error(codes::COLLISION, path, "answer", message, hint);
            return Ok(());
        }
        if let (Some(stage), Some(soft)) = (&self.request.soft, &answer.soft) {
            stage.keep(&answer.query, answer.frame, soft)?;
        }
        self.from.insert(key, path.to_owned());
        self.answers.entry(answer.query).or_default().insert(answer.frame, answer.mask);
        Ok(())
    }

    /// Takes what was found of a query in a frame.
    pub(super) fn take_found(
        &mut self,
        path: &Path,
        query: &Query,
        frame: u32,
        found: Found,
    ) -> Result<(), DataError> {
        let mut report = Report::default();
        let answer = self.answer(path, query, frame, found.mask, Some(&found.soft), &mut report);
        self.findings.extend(report);
        answer.map_or(Ok(()), |answer| self.take(path, answer))
    }

    /// Takes where the relevancy of a query is highest in a frame.
    pub(super) fn take_summit(&mut self, query: &Query, frame: u32, at: [f64; 2]) {
        self.summits.insert((query.id.clone(), frame), at);
    }

    /// Says of frames that nothing is there, whatever was answered.
    pub(super) fn empty(
        &mut self,
        query: &QueryId,
        frames: impl Iterator<Item = u32>,
    ) -> Result<(), DataError> {
        let Some(answers) = self.answers.get_mut(query) else { return Ok(()) };
        for frame in frames {
            let Some(mask) = answers.get_mut(&frame) else { continue };
            *mask = None;
            if let Some(stage) = &self.request.soft {
                stage.keep(query, frame, &soft::picture(&[0], (1, 1), self.pictures.size))?;
            }
        }
        Ok(())
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
            report.error(
                code,
                &self.request.root,
                "folder",
                message,
                "mend the first, and most of the others follow",
            );
        }
        (self.answers, self.summits)
    }
}
