//! What the votes of people say, and whether the statuses of the queries say the same.
//!
//! `l4d verdict` derives it from the ballots; a release takes it, and refuses to call verified what was not.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use l4d_data::store::list_folder;
use l4d_data::{Benchmark, DataError, QueryId, Report, Status};
use serde::{Deserialize, Serialize};

use crate::codes;
use crate::gather::{Gathered, Source};

/// Nothing else sets a status.
const HINT: &str =
    "name the folder of all rounds with --rounds, and run `l4d verdict ...`: nothing else sets a status";

/// What all sealed rounds of people say together.
#[derive(Debug, Clone, Default)]
pub struct Votes {
    /// The status that each query has by them; queries whose present wording no one judged are not in it.
    pub statuses: BTreeMap<QueryId, Status>,
    /// The rounds, by name.
    pub rounds: Vec<Round>,
    /// Guidelines, ballots and verdicts of these rounds, so that others can count again.
    pub files: Vec<Source>,
}

/// A sealed round of people.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Round {
    pub name: String,
    /// When a prompt counted as understood (`unanimous:5`).
    pub rule: String,
    /// How many people voted.
    pub annotators: usize,
    /// Prompts that were asked.
    pub prompts: usize,
    /// Of these: those that enough understood.
    pub valid: usize,
    /// Of these: those that too few understood.
    pub rejected: usize,
    /// Share of single answers that are right.
    pub ceiling: Option<f64>,
    /// Share of agreeing pairs of answers, coded right or wrong.
    pub raw: Option<f64>,
    /// Krippendorff's alpha of the same.
    pub alpha: Option<f64>,
    /// Gwet's AC1 of the same.
    pub ac1: Option<f64>,
}

/// Compares the status of each query with the votes.
pub(crate) fn check(bench: &Benchmark, gathered: &Gathered, votes: &Votes, report: &mut Report) {
    for scene in &gathered.scenes {
        let files = [
            (bench.dir.queries(&scene.name), &scene.queries),
            (bench.dir.composites(&scene.name), &scene.composites),
            (bench.dir.absents(&scene.name), &scene.absents),
        ];
        for (path, queries) in files {
            for query in queries {
                let by_votes = votes.statuses.get(&query.id).copied().unwrap_or(Status::Candidate);
                if query.status != by_votes {
                    let place = format!("query {}, field `status`", query.id);
                    let (says, should) = (query.status.as_str(), by_votes.as_str());
                    let message = format!("is {says}, but by the votes of people it is {should}");
                    report.error(codes::STATUS, &path, place, message, HINT);
                }
            }
        }
    }
}

impl Votes {
    /// Adds the files below a folder of annotation; hidden ones and pictures are left out.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn add_files(&mut self, prefix: &str, folder: &Path) -> Result<(), DataError> {
        for name in list_folder(folder)? {
            let path = folder.join(&name);
            let inside = format!("{prefix}/{name}");
            // Pictures can be drawn again, and a link could lead anywhere.
            let kind = fs::symlink_metadata(&path).map_err(|source| DataError::io(&path, "read", source))?;
            if kind.is_dir() {
                self.add_files(&inside, &path)?;
            } else if kind.is_file() && !name.ends_with(".png") {
                self.files.push(Source::read(inside, path)?);
            }
        }
        Ok(())
    }
}
