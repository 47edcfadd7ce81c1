//! Every problem of a results folder at once, without a score.

use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::{DataError, Query, Report, Status};
use rayon::prelude::*;

use crate::answers::{Reader, report_missing};
use crate::exam::{Exam, SceneExam};
use crate::results::{admit, find_methods, read_card, scan_scene};

/// Checks one method or a folder of them; gives the number of methods.
pub fn check_results(root: &Path, exam: &Exam, report: &mut Report) -> Result<usize, DataError> {
    let methods = find_methods(root, report)?;
    for dir in &methods {
        // Masks are worth reading even when the card is wrong: all problems shall be known at once.
        read_card(dir, exam, false, report);
        if admit(dir, exam, false, report) {
            exam.scenes.iter().for_each(|scene| check_scene(dir, scene, report));
        }
    }
    Ok(methods.len())
}

fn check_scene(dir: &ResultsDir, scene: &SceneExam, report: &mut Report) {
    let forms = scan_scene(dir, scene, report);
    let reader = Reader { dir, clip: &scene.clip, size: scene.size, resize: false };
    let check = |query: &Query| {
        let mut found = Report::default();
        let forms = forms.get(query.id.number.as_str()).copied().unwrap_or_default();
        let answers = reader.read(&query.id, forms, &mut found);
        let is_asked = query.status != Status::Rejected;
        // What could not be read has been reported and would only be repeated as missing.
        if is_asked && found.is_empty() {
            report_missing(dir, &query.id, scene, &answers, &mut found);
        }
        found
    };
    let found: Vec<Report> = scene.queries.par_iter().map(check).collect();
    found.into_iter().for_each(|found| report.extend(found));
}
