//! What a method answers to the queries of one scene, and which holes are reported: query by query where some are
//! answered, once where none is.
//!
//! It knows folders and forms ([`crate::results`]) and how one query is read ([`crate::answers`]); it refuses to judge.

use std::collections::BTreeMap;

use l4d_data::layout::ResultsDir;
use l4d_data::{Query, Report, Status};

use crate::answers::{Forms, Reader, report_missing};
use crate::codes;
use crate::exam::SceneExam;
use crate::judge::Answer;
use crate::results::scan_scene;

/// What frames without an answer are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Holes {
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
pub(crate) struct SceneReader<'a> {
    dir: &'a ResultsDir,
    scene: &'a SceneExam,
    reader: Reader<'a>,
    forms: BTreeMap<String, Forms>,
    holes: Holes,
}

impl<'a> SceneReader<'a> {
    /// Looks through the folder of the scene and reports what is out of place.
    pub(crate) fn open(
        dir: &'a ResultsDir,
        scene: &'a SceneExam,
        resize: bool,
        holes: Holes,
        report: &mut Report,
    ) -> Self {
        let forms = scan_scene(dir, scene, report);
        let reader = Reader { dir, clip: &scene.clip, size: scene.size, resize };
        let is_skipped = forms.is_empty() && holes == Holes::Reported;
        if is_skipped {
            report_skipped(dir, scene, report);
        }
        let holes = if is_skipped { Holes::Counted } else { holes };
        Self { dir, scene, reader, forms, holes }
    }

    /// One answer per frame of the clip; what is wrong with them is reported.
    pub(crate) fn read(&self, query: &Query, report: &mut Report) -> Vec<Answer> {
        let mut answers = vec![Answer::Missing; self.scene.clip.len()];
        self.read_each(query, report, |position, answer| answers[position] = answer.clone());
        answers
    }

    /// Tells the answers one after another, each with its position in the clip; what is wrong with them is reported.
    pub(crate) fn read_each(&self, query: &Query, report: &mut Report, tell: impl FnMut(usize, &Answer)) {
        let forms = self.forms.get(query.id.number.as_str()).copied().unwrap_or_default();
        let mut found = Report::default();
        let is_answered = self.reader.read_each(&query.id, forms, &mut found, tell);
        // What could not be read has been reported and would only be repeated as missing.
        if self.holes == Holes::Reported && is_asked(query) && found.is_empty() {
            report_missing(self.dir, &query.id, self.scene, &is_answered, &mut found);
        }
        report.extend(found);
    }
}

fn is_asked(query: &Query) -> bool {
    query.status != Status::Rejected
}

fn report_skipped(dir: &ResultsDir, scene: &SceneExam, report: &mut Report) {
    let asked = scene.queries.iter().filter(|query| is_asked(query)).count();
    if asked == 0 {
        return;
    }
    let message = format!("answers none of the {asked} queries of scene {}", scene.name);
    let hint =
        "answer them, name the scenes that count (--scenes), or pass --missing zero or skip to `l4d score`";
    report.error(codes::MISSING, &dir.masks().join(scene.name.as_str()), "folder", message, hint);
}
