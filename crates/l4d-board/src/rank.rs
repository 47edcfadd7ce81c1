//! Who is ranked, who is only shown, and who belongs to another board.
//!
//! Ranks are given within a track: who learned from rendered depth is not ranked with who did not. They are shared by
//! methods whose headline is equal in the digits that the tables print: a rank never claims a difference that the reader
//! cannot see.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::Profile;
use l4d_data::results::Track;
use l4d_score::summary::PARTIAL;

use crate::error::BoardError;
use crate::row::{BoardRow, Heading, Metric};

/// A method that competes.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// From 1 in each track; equal headlines share it, and the next rank counts them all ("1 1 3").
    pub rank: usize,
    /// The method.
    pub row: BoardRow,
}

/// A method that is shown for scale but does not compete.
#[derive(Debug, Clone, PartialEq)]
pub struct Unranked {
    /// Why, at least one.
    pub reasons: Vec<&'static str>,
    /// The method.
    pub row: BoardRow,
}

impl Unranked {
    /// The reasons as one phrase.
    pub fn reason(&self) -> String {
        self.reasons.join(", ")
    }
}

/// Methods that were scored on something else; they share no table with this board's.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherBoard {
    /// Their profile.
    pub profile: Profile,
    /// Their protocol.
    pub protocol: String,
    /// Their benchmark version.
    pub benchmark_version: String,
    /// Their truth.
    pub truth_digest: String,
    /// The methods, best first.
    pub rows: Vec<BoardRow>,
}

impl OtherBoard {
    /// `benchmark 0.9.0 · protocol l4d · profile tiny · truth 3f2a91c0`.
    pub fn line(&self) -> String {
        let Self { profile, protocol, benchmark_version, truth_digest, .. } = self;
        let truth: String = truth_digest.chars().take(8).collect();
        format!("benchmark {benchmark_version} · protocol {protocol} · profile {profile} · truth {truth}")
    }
}

/// A leaderboard.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// What it is a board of.
    pub heading: Heading,
    /// By track, the headline track first; within a track best first, equal ranks by name.
    pub ranked: Vec<Ranked>,
    /// Best first, then by name.
    pub unranked: Vec<Unranked>,
    /// Sorted by profile, protocol, version.
    pub others: Vec<OtherBoard>,
}

impl Board {
    /// Sorts methods into a board.
    pub fn new(heading: Heading, mut rows: Vec<BoardRow>) -> Result<Self, BoardError> {
        if rows.is_empty() {
            return Err(BoardError::NoMethods);
        }
        let mut names = BTreeSet::new();
        for row in &rows {
            row.check()?;
            if !names.insert(row.name.clone()) {
                return Err(BoardError::Twice(row.name.to_string()));
            }
        }
        rows.sort_by(|a, b| headline(b).cmp(&headline(a)).then_with(|| a.name.cmp(&b.name)));

        let (mine, foreign): (Vec<BoardRow>, Vec<BoardRow>) =
            rows.into_iter().partition(|row| belongs(row, &heading));
        if mine.is_empty() {
            let found: Vec<String> = other_boards(foreign).iter().map(OtherBoard::line).collect();
            return Err(BoardError::NoneHere { wanted: heading.line(), found: found.join("; ") });
        }
        let (mut competing, mut unranked) = (Vec::new(), Vec::new());
        for row in mine {
            let reasons = reasons_against(&row, &heading);
            if reasons.is_empty() {
                competing.push(row);
            } else {
                unranked.push(Unranked { reasons, row });
            }
        }
        // Sorting is stable: the best of a track stay first.
        competing.sort_by_key(|row| row.track);
        let ranked = competing.chunk_by(|a, b| a.track == b.track).flat_map(ranked_in_order).collect();
        Ok(Self { heading, ranked, unranked, others: other_boards(foreign) })
    }

    /// The ranked methods of each track that has any.
    pub fn tracks(&self) -> impl Iterator<Item = (Track, &[Ranked])> {
        let alike = |a: &Ranked, b: &Ranked| a.row.track == b.row.track;
        self.ranked.chunk_by(alike).map(|group| (group[0].row.track, group))
    }

    /// The methods of this board: the ranked, then the others; with their rank.
    pub fn rows(&self) -> impl Iterator<Item = (Option<usize>, &BoardRow)> {
        let ranked = self.ranked.iter().map(|entry| (Some(entry.rank), &entry.row));
        ranked.chain(self.unranked.iter().map(|entry| (None, &entry.row)))
    }

    /// Why a method of this board is not ranked; nothing for those that are.
    pub(crate) fn why_unranked(&self, row: &BoardRow) -> String {
        let entry = self.unranked.iter().find(|entry| entry.row.name == row.name);
        entry.map(Unranked::reason).unwrap_or_default()
    }

    /// Best and second-best printed value among the ranked methods of a track. One scene says nothing of others, so
    /// that no method of it is called best.
    pub(crate) fn podium(
        &self,
        track: Track,
        metric: Metric,
        value: impl Fn(&BoardRow) -> Option<f64>,
    ) -> Podium {
        if self.is_of_one_scene() {
            return Podium::default();
        }
        let rivals = self.ranked.iter().map(|entry| &entry.row).filter(|row| row.track == track);
        Podium::of(rivals.filter_map(value), metric)
    }

    /// Whether nothing on it says how much scenes differ: then it has no intervals and no tests.
    pub(crate) fn is_of_one_scene(&self) -> bool {
        self.heading.scenes < 2
    }

    /// Whether some track has rivals, so that a method can be called best.
    pub(crate) fn has_rivals(&self) -> bool {
        !self.is_of_one_scene() && self.tracks().any(|(_, group)| group.len() > 1)
    }
}

/// A percentage in the digits that tables print: hundredths.
pub(crate) fn printed(value: f64) -> i64 {
    (value * 100.0).round() as i64
}

/// The two best printed values of a column; neither where there are no two values to compare.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Podium {
    best: Option<i64>,
    second: Option<i64>,
}

impl Podium {
    pub(crate) fn of(values: impl Iterator<Item = f64>, metric: Metric) -> Self {
        let values: Vec<i64> = values.map(printed).collect();
        if values.len() < 2 {
            return Self::default();
        }
        let distinct: BTreeSet<i64> = values.into_iter().collect();
        let mut best_first: Vec<i64> = distinct.into_iter().collect();
        if metric.higher_is_better() {
            best_first.reverse();
        }
        Self { best: best_first.first().copied(), second: best_first.get(1).copied() }
    }

    pub(crate) fn is_best(self, value: f64) -> bool {
        self.best == Some(printed(value))
    }

    pub(crate) fn is_second(self, value: f64) -> bool {
        self.second == Some(printed(value))
    }
}

fn headline(row: &BoardRow) -> Option<i64> {
    Metric::ALL[0].of(&row.scores.headline).map(printed)
}

/// The ranks of rows of one track that are sorted.
fn ranked_in_order(rows: &[BoardRow]) -> Vec<Ranked> {
    let mut ranked: Vec<Ranked> = Vec::new();
    for row in rows {
        let tied = ranked.last().filter(|last| headline(&last.row) == headline(row)).map(|last| last.rank);
        let rank = tied.unwrap_or(ranked.len() + 1);
        ranked.push(Ranked { rank, row: row.clone() });
    }
    ranked
}

fn belongs(row: &BoardRow, heading: &Heading) -> bool {
    row.profile == heading.profile
        && row.protocol == heading.protocol
        && row.benchmark_version == heading.version
        && row.truth_digest == heading.truth_digest
}

fn reasons_against(row: &BoardRow, heading: &Heading) -> Vec<&'static str> {
    let mut reasons = row.unranked_because.clone();
    if row.asked < heading.queries && !reasons.contains(&PARTIAL) {
        reasons.push(PARTIAL);
    }
    if row.asked > heading.queries {
        reasons.push("scored on more queries");
    }
    reasons
}

fn other_boards(rows: Vec<BoardRow>) -> Vec<OtherBoard> {
    let mut boards: BTreeMap<_, Vec<BoardRow>> = BTreeMap::new();
    for row in rows {
        let key =
            (row.profile, row.protocol.clone(), row.benchmark_version.clone(), row.truth_digest.clone());
        boards.entry(key).or_default().push(row);
    }
    let board = |((profile, protocol, benchmark_version, truth_digest), rows)| OtherBoard {
        profile,
        protocol,
        benchmark_version,
        truth_digest,
        rows,
    };
    boards.into_iter().map(board).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn ranks(board: &Board) -> Vec<(usize, &str)> {
        board.ranked.iter().map(|entry| (entry.rank, entry.row.name.as_str())).collect()
    }

    #[test]
    fn equal_printed_headlines_share_a_rank_and_stand_by_name() {
        let rows = [("d", 50.0), ("b", 62.501), ("a", 62.499), ("e", 50.006), ("c", 70.0)];
        let rows = rows.map(|(name, value)| sample::row(name, 4, value)).to_vec();
        let board = Board::new(sample::heading(4, 0), rows).unwrap();
        assert_eq!(ranks(&board), [(1, "c"), (2, "a"), (2, "b"), (4, "e"), (5, "d")]);
    }

    #[test]
    fn who_learned_from_depth_is_ranked_apart_however_good() {
        let board = sample::tracks();
        assert_eq!(ranks(&board), [(1, "bright"), (2, "dim"), (1, "deeper"), (2, "deep")]);
        let groups: Vec<_> = board.tracks().map(|(track, group)| (track.as_str(), group.len())).collect();
        assert_eq!(groups, [("colour", 2), ("colour+depth", 2)]);
        let best = |track| {
            let podium = board.podium(track, Metric::Miou, |row| row.scores.headline.miou);
            [30.0, 40.0, 90.0, 95.0].map(|value| podium.is_best(value))
        };
        assert_eq!(best(Track::Colour), [false, true, false, false]);
        assert_eq!(best(Track::ColourDepth), [false, false, false, true]);
        assert_eq!(sample::board(14).tracks().count(), 1, "a track without a method is no group");
    }

    #[test]
    fn no_method_is_best_alone_or_of_one_scene() {
        let alone = Board::new(sample::heading(4, 0), vec![sample::row("a", 4, 50.0)]).unwrap();
        let mut one_scene = sample::tracks();
        one_scene.heading.scenes = 1;
        for board in [alone, one_scene] {
            let podium = board.podium(Track::Colour, Metric::Miou, |row| row.scores.headline.miou);
            assert!(podium == Podium::default() && !podium.is_best(50.0) && !board.has_rivals());
        }
        assert!(sample::tracks().has_rivals());
        assert_eq!(Podium::of([50.0].into_iter(), Metric::Miou), Podium::default());
    }

    #[test]
    fn who_does_not_compete_is_shown_with_the_reason() {
        let board = sample::hand_made();
        assert_eq!(ranks(&board), [(1, "alpha"), (1, "beta"), (3, "gamma")]);
        let unranked: Vec<_> =
            board.unranked.iter().map(|entry| (entry.row.name.as_str(), entry.reason())).collect();
        assert_eq!(
            unranked,
            [("oracle", "baseline, used ground truth".to_owned()), ("half", "partial".to_owned())]
        );
        assert_eq!(board.others.len(), 1);
        assert_eq!(board.others[0].rows[0].name.as_str(), "elsewhere");
    }

    #[test]
    fn several_reasons_are_all_named() {
        let mut row = sample::row("seer", 3, 50.0);
        row.unranked_because = vec!["used ground truth", "saw the held-out view"];
        let mut empty = sample::row("empty", 4, 1.0);
        empty.scores.headline.miou = None;
        empty.unranked_because = vec!["no query with a target"];
        let board = Board::new(sample::heading(4, 0), vec![row, empty]).unwrap();
        assert_eq!(board.unranked[0].reason(), "used ground truth, saw the held-out view, partial");
        assert_eq!(board.unranked[1].reason(), "no query with a target");
    }

    #[test]
    fn another_truth_version_or_protocol_is_another_board() {
        let changes: [fn(&mut BoardRow); 4] = [
            |row| row.truth_digest = "0000".to_owned(),
            |row| row.benchmark_version = "0.9.0".to_owned(),
            |row| row.protocol = "davis".to_owned(),
            |row| row.profile = Profile::Full,
        ];
        for change in changes {
            let mut foreign = sample::row("foreign", 4, 99.0);
            change(&mut foreign);
            let board =
                Board::new(sample::heading(4, 0), vec![foreign.clone(), sample::row("a", 4, 1.0)]).unwrap();
            assert_eq!((ranks(&board), board.others.len()), (vec![(1, "a")], 1));
            let error = Board::new(sample::heading(4, 0), vec![foreign]).unwrap_err().to_string();
            assert!(error.contains("no method was scored on Panoptic-L4D 1.0.0"), "{error}");
        }
    }

    #[test]
    fn values_that_cannot_be_are_refused_with_their_place() {
        for (value, told) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-0.5, "-0.5"), (100.1, "100.1")] {
            let mut row = sample::row("a", 4, 50.0);
            row.scores.categories.get_mut(&l4d_data::Category::Action).unwrap().tube_iou = Some(value);
            let error = Board::new(sample::heading(4, 0), vec![row]).unwrap_err().to_string();
            assert_eq!(
                error,
                format!("method `a`: tube_iou of category action is {told}, but must be from 0 to 100")
            );
        }
        let twice = vec![sample::row("a", 4, 1.0), sample::row("a", 4, 2.0)];
        assert!(matches!(Board::new(sample::heading(4, 0), twice), Err(BoardError::Twice(_))));
        assert!(matches!(Board::new(sample::heading(4, 0), Vec::new()), Err(BoardError::NoMethods)));
    }
}
