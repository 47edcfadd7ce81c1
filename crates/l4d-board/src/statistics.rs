//! What lies behind the means of a board: how far they may be off, for which groups of queries they hold, and which
//! methods can be told apart.
//!
//! Everything follows from `counts.csv`. Rows are read again for the foremost methods alone, so that a board of thousands
//! of them stays in bounds.

use std::path::Path;

use l4d_data::results::Track;
use l4d_data::{DataError, Name};
use l4d_score::compare::Pair;
use l4d_score::metrics::{QueryTally, Ratios};
use l4d_score::score::{counts_path, summary_path, tallies_of_counts};
use l4d_score::{Exam, Group, Summary, all_pairs, counts, groups};
use rayon::prelude::*;

use crate::rank::Board;
use crate::row::Metric;

/// Groups and comparisons are made of no more methods than this; those that come first on the board.
pub const MOST_METHODS: usize = 50;
/// Metrics by which methods are compared; each is a table of its own for the correction of p values.
pub const COMPARED: [Metric; 3] = [Metric::Miou, Metric::TubeIou, Metric::Select];

/// Groups and comparisons of the foremost methods of a board.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statistics {
    /// In the order of the board.
    pub methods: Vec<MethodGroups>,
    /// One entry for each of [`COMPARED`].
    pub comparisons: Vec<Comparisons>,
    /// Methods of the board that were left out because they are too many.
    pub left_out: usize,
}

/// The groups of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodGroups {
    /// The method.
    pub name: Name,
    /// By kind, then in the order of tables.
    pub groups: Vec<Group>,
}

/// All pairs of complete methods of a track by one metric; p values are corrected for those of the track.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparisons {
    /// By what.
    pub metric: Metric,
    /// By track. `first` and `second` index [`Statistics::methods`]. Partial methods are in none: they rest on other
    /// frames.
    pub pairs: Vec<Pair>,
}

impl Statistics {
    /// Derives them for the methods of `board` whose counts stand in `scores`.
    pub fn of(board: &Board, scores: &Path, exam: &Exam, seed: u64) -> Result<Self, DataError> {
        let rows: Vec<_> = board.rows().map(|(_, row)| row).collect();
        let (shown, left_out) = rows.split_at(rows.len().min(MOST_METHODS));
        let read = |name: &Name| tallies(scores, name, exam);
        let tallies: Vec<Vec<QueryTally>> =
            shown.par_iter().map(|row| read(&row.name)).collect::<Result<_, DataError>>()?;
        let of_method = |(row, tallies): (&&crate::BoardRow, &Vec<QueryTally>)| MethodGroups {
            name: row.name.clone(),
            groups: groups(tallies, exam, seed),
        };
        let complete_of = |track| -> Vec<usize> {
            let is_rival =
                |&index: &usize| shown[index].track == track && shown[index].is_complete(&board.heading);
            (0..shown.len()).filter(is_rival).collect()
        };
        let comparisons = COMPARED.map(|metric| {
            let of_track =
                |track| pairs_among(&complete_of(track), &tallies, |ratios| metric.of_ratios(ratios), seed);
            Comparisons { metric, pairs: Track::ALL.into_iter().flat_map(of_track).collect() }
        });
        Ok(Self {
            methods: shown.par_iter().zip(&tallies).map(of_method).collect(),
            comparisons: comparisons.into(),
            left_out: left_out.len(),
        })
    }

    /// The pairs by which the board is ranked.
    pub fn headline(&self) -> &[Pair] {
        self.comparisons.iter().find(|found| found.metric == Metric::ALL[0]).map_or(&[], |found| &found.pairs)
    }

    /// Of the pairs by which the board is ranked, those of methods that follow each other: ranked ones among themselves,
    /// and those that are only shown.
    pub fn neighbours(&self, board: &Board) -> Vec<&Pair> {
        let is_ranked = |index: usize| index < board.ranked.len();
        let alike = self.headline().iter().filter(|pair| is_ranked(pair.first) == is_ranked(pair.second));
        let mut previous: Option<usize> = None;
        alike.filter(|pair| previous.replace(pair.first) != Some(pair.first)).collect()
    }

    /// A group of a method.
    pub fn group(&self, method: &Name, kind: l4d_score::groups::Kind, name: &str) -> Option<&Group> {
        let found = self.methods.iter().find(|found| found.name == *method)?;
        found.groups.iter().find(|group| group.kind == kind && group.name == name)
    }
}

/// Compares some of the methods with each other.
fn pairs_among(
    members: &[usize],
    tallies: &[Vec<QueryTally>],
    ratio: impl Fn(&Ratios) -> Option<f64> + Sync,
    seed: u64,
) -> Vec<Pair> {
    let compared: Vec<&[QueryTally]> = members.iter().map(|&index| tallies[index].as_slice()).collect();
    let mut pairs = all_pairs(&compared, ratio, seed);
    for pair in &mut pairs {
        (pair.first, pair.second) = (members[pair.first], members[pair.second]);
    }
    pairs
}

fn tallies(scores: &Path, name: &Name, exam: &Exam) -> Result<Vec<QueryTally>, DataError> {
    let summary = Summary::read(&summary_path(scores, name))?;
    let rows = counts::read(&counts_path(scores, name))?;
    Ok(tallies_of_counts(&rows, exam, &summary.options))
}

/// A p value with as many digits as say something.
pub(crate) fn p_text(p: f64) -> String {
    if p < 0.001 { format!("{p:.1e}") } else { format!("{p:.4}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_keep_their_digits() {
        assert_eq!([1.0, 0.04994, 0.001, 0.000_954].map(p_text), ["1.0000", "0.0499", "0.0010", "9.5e-4"]);
    }
}
