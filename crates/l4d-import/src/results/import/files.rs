//! Files that hold masks or maps: decoded side by side, collected in the order of their paths.

use l4d_data::{DataError, Report};
use rayon::prelude::*;

use super::super::codec;
use super::super::template::Hit;
use super::Request;
use super::answers::{Answer, Collector};

/// Files that are decoded before their answers are collected.
const BATCH: usize = 256;

pub(super) fn read(
    request: &Request<'_>,
    hits: &[Hit],
    collector: &mut Collector<'_>,
) -> Result<(), DataError> {
    for batch in hits.chunks(BATCH) {
        let decode = |hit: &Hit| -> (Vec<Answer>, Report) {
            let mut report = Report::default();
            let answers = match codec::read(&hit.path, &request.reading) {
                Ok(pieces) => {
                    pieces.into_iter().filter_map(|piece| collector.place(hit, piece, &mut report)).collect()
                }
                Err(problem) => {
                    problem.report(&hit.path, &mut report);
                    Vec::new()
                }
            };
            (answers, report)
        };
        let decoded: Vec<(Vec<Answer>, Report)> = batch.par_iter().map(decode).collect();
        for (hit, (answers, report)) in batch.iter().zip(decoded) {
            collector.findings().extend(report);
            answers.into_iter().try_for_each(|answer| collector.take(&hit.path, answer))?;
        }
    }
    Ok(())
}
