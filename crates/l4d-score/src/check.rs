//! Every problem of a results folder at once, without a score.

use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::{DataError, Query, Report};
use rayon::prelude::*;

use crate::exam::{Exam, SceneExam};
use crate::reading::{Holes, SceneReader};
use crate::results::{admit, find_methods, read_card};

/// Checks one method or a folder of them; gives the number of methods.
///
/// # Errors
/// A folder that cannot be listed, and truth that is damaged.
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
    let reader = SceneReader::open(dir, scene, false, Holes::Reported, report);
    let check = |query: &Query| {
        let mut found = Report::default();
        reader.read_each(query, &mut found, |_, _| {});
        found
    };
    let found: Vec<Report> = scene.queries.par_iter().map(check).collect();
    found.into_iter().for_each(|found| report.extend(found));
}
