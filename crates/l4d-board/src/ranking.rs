//! Which methods are ranked, which are only shown, and which belong to another board.
//!
//! Ranks are given within a track. Methods whose headlines are equal in the printed digits share a rank: a rank never
//! claims a difference that the reader cannot see.

use std::collections::BTreeSet;

use l4d_data::results::Track;
use l4d_score::Metric;
use l4d_score::summary::PARTIAL;

use crate::board::{Board, Heading, Method};
use crate::error::BoardError;

/// Sorts methods and gives ranks; gives those that were scored on something else apart.
pub(crate) fn arrange(
    heading: &Heading,
    mut methods: Vec<Method>,
) -> Result<(Vec<Method>, Vec<Method>), BoardError> {
    if methods.is_empty() {
        return Err(BoardError::NoMethods);
    }
    methods.sort_by(|a, b| headline(b).cmp(&headline(a)).then_with(|| a.name.cmp(&b.name)));
    let (mut mine, foreign): (Vec<Method>, Vec<Method>) =
        methods.into_iter().partition(|method| method.on == heading.on);
    if mine.is_empty() {
        let found: BTreeSet<String> = foreign.iter().map(|method| method.on.line()).collect();
        let found: Vec<String> = found.into_iter().collect();
        return Err(BoardError::NoneHere { wanted: heading.line(), found: found.join("; ") });
    }
    for method in &mut mine {
        if method.asked < heading.queries && !method.unranked_because.iter().any(|reason| reason == PARTIAL) {
            method.unranked_because.push(PARTIAL.to_owned());
        }
        if method.asked > heading.queries {
            method.unranked_because.push("scored on more queries".to_owned());
        }
    }
    // Sorting is stable: the best of a track stay first.
    mine.sort_by_key(|method| match method.unranked_because.is_empty() {
        true => (false, method.track),
        false => (true, Track::default()),
    });
    let mut previous: Option<(Track, Option<i64>, usize)> = None;
    let mut place = 0;
    for method in mine.iter_mut().take_while(|method| method.unranked_because.is_empty()) {
        let printed = headline(method);
        let same_track = previous.filter(|(track, ..)| *track == method.track);
        place = if same_track.is_some() { place + 1 } else { 1 };
        let rank = same_track.filter(|(_, value, _)| *value == printed).map_or(place, |(.., rank)| rank);
        method.rank = Some(rank);
        previous = Some((method.track, printed, rank));
    }
    Ok((mine, foreign))
}

/// A percentage in the digits that tables print: hundredths.
pub(crate) fn printed(value: f64) -> i64 {
    (value * 100.0).round() as i64
}

fn headline(method: &Method) -> Option<i64> {
    method.headline(Metric::ALL[0]).map(printed)
}

/// How a value is set off from the others of its column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Emphasis {
    None,
    Best,
    Second,
}

/// The two best printed values of a column; neither where there are no two values to compare.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct BestTwo {
    best: Option<i64>,
    second: Option<i64>,
}

impl BestTwo {
    /// Of the values of a column.
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

    /// Of the ranked methods of a track. On a board of one scene no method is called best.
    pub(crate) fn of_track(
        board: &Board,
        track: Track,
        metric: Metric,
        value: impl Fn(&Method) -> Option<f64>,
    ) -> Self {
        if board.is_of_one_scene() {
            return Self::default();
        }
        let rivals = board.ranked().iter().filter(|method| method.track == track);
        Self::of(rivals.filter_map(value), metric)
    }

    pub(crate) fn emphasis(self, value: f64) -> Emphasis {
        match Some(printed(value)) {
            value if value == self.best => Emphasis::Best,
            value if value == self.second => Emphasis::Second,
            _ => Emphasis::None,
        }
    }
}

#[cfg(test)]
mod tests {
    use l4d_data::Profile;

    use super::*;
    use crate::board::ScoredOn;
    use crate::sample;

    fn ranks(board: &Board) -> Vec<(usize, &str)> {
        board.ranked().iter().map(|method| (method.rank.unwrap(), method.name.as_str())).collect()
    }

    #[test]
    fn equal_printed_headlines_share_a_rank_by_name() {
        let rows = [("d", 50.0), ("b", 62.501), ("a", 62.499), ("e", 50.006), ("c", 70.0)];
        let board = sample::board_of(4, rows.map(|(name, value)| sample::method(name, 4, value)).to_vec());
        assert_eq!(ranks(&board), [(1, "c"), (2, "a"), (2, "b"), (4, "e"), (5, "d")]);
    }

    #[test]
    fn ranks_begin_anew_in_each_track_which_has_its_own_best() {
        let board = sample::tracks();
        assert_eq!(ranks(&board), [(1, "bright"), (2, "dim"), (1, "deeper"), (2, "deep")]);
        let best = |track| {
            let best_two =
                BestTwo::of_track(&board, track, Metric::Miou, |method| method.headline(Metric::Miou));
            [30.0, 40.0, 90.0, 95.0].map(|value| best_two.emphasis(value) == Emphasis::Best)
        };
        assert_eq!(best(Track::Colour), [false, true, false, false]);
        assert_eq!(best(Track::ColourDepth), [false, false, false, true]);
        let alone = sample::board_of(4, vec![sample::method("a", 4, 50.0)]);
        let mut one_scene = sample::tracks();
        one_scene.heading.scenes = 1;
        assert!(sample::tracks().has_rivals() && !alone.has_rivals() && !one_scene.has_rivals());
    }

    #[test]
    fn methods_that_do_not_compete_are_shown_with_all_reasons() {
        let mut seer = sample::method("seer", 3, 50.0);
        seer.unranked_because = vec!["used ground truth".to_owned()];
        let more = sample::method("more", 5, 40.0);
        let board = sample::board_of(4, vec![sample::method("a", 4, 1.0), more, seer]);
        let found: Vec<_> =
            board.unranked().iter().map(|method| (method.name.as_str(), method.why_unranked())).collect();
        let expected = [
            ("seer", "used ground truth, partial".to_owned()),
            ("more", "scored on more queries".to_owned()),
        ];
        assert_eq!((ranks(&board), found), (vec![(1, "a")], expected.to_vec()));
    }

    #[test]
    fn another_truth_version_profile_or_protocol_is_another_board() {
        let changes: [fn(&mut ScoredOn); 4] = [
            |on| on.truth_digest = "0000".to_owned(),
            |on| on.benchmark_version = "0.9.0".to_owned(),
            |on| on.protocol = "davis".to_owned(),
            |on| on.profile = Profile::Full,
        ];
        for change in changes {
            let mut foreign = sample::method("foreign", 4, 99.0);
            change(&mut foreign.on);
            let board = sample::board_of(4, vec![foreign.clone(), sample::method("a", 4, 1.0)]);
            assert_eq!((ranks(&board), board.methods.len()), (vec![(1, "a")], 1));
            let error = arrange(&sample::heading(4, 0), vec![foreign]).unwrap_err().to_string();
            assert!(error.contains("no method was scored on Panoptic-L4D 1.0.0"), "{error}");
        }
        assert!(matches!(arrange(&sample::heading(4, 0), Vec::new()), Err(BoardError::NoMethods)));
    }
}
