//! Numbers that methods report of themselves, beside the same of our counts. They are never ranked.

use l4d_data::Name;
use l4d_score::Metrics;

use crate::rank::Board;
use crate::row::{BoardRow, Metric};

/// One number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reported<'a> {
    pub(crate) method: &'a Name,
    /// As the method calls it.
    pub(crate) number: &'a str,
    /// What the method says.
    pub(crate) reported: f64,
    /// The same from `counts.csv`, percent; none for numbers that l4d does not know.
    pub(crate) recomputed: Option<f64>,
}

/// All numbers of the methods of a board, in its order, then by name.
pub(crate) fn rows(board: &Board) -> Vec<Reported<'_>> {
    let rows = board.rows().map(|(_, row)| row);
    rows.flat_map(|row| {
        row.reported.iter().map(|(number, &reported)| Reported {
            method: &row.name,
            number,
            reported,
            recomputed: recomputed(row, number),
        })
    })
    .collect()
}

/// `miou`, or a group and a metric: `action miou`, `room macc`, `room_gym tube_iou`.
fn recomputed(row: &BoardRow, number: &str) -> Option<f64> {
    let (group, metric) = number.split_once(' ').map_or(("", number), |(group, metric)| (group, metric));
    let metric = Metric::ALL.into_iter().find(|known| known.key() == metric)?;
    let scores = &row.scores;
    let named = |name: &str| name == group;
    let metrics: Metrics = match group {
        "" => scores.headline,
        _ => scores
            .categories
            .iter()
            .find(|(key, _)| named(key.as_str()))
            .map(|(_, found)| *found)
            .or_else(|| scores.scales.iter().find(|(key, _)| named(key.as_str())).map(|(_, found)| *found))
            .or_else(|| scores.scenes.get(group).copied())?,
    };
    metric.of(&metrics)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn numbers_of_ours_stand_beside_what_is_reported() {
        let mut row = sample::row("alpha", 4, 62.5);
        for name in
            ["miou", "action macc", "room tube_iou", "room_living_cats select", "iou chosen", "moon miou"]
        {
            row.reported.insert(name.to_owned(), 70.0);
        }
        let board = Board::new(sample::heading(4, 0), vec![row]).unwrap();
        let found: Vec<_> = rows(&board).iter().map(|row| (row.number, row.recomputed)).collect();
        let expected = [
            ("action macc", Some(62.5)),
            ("iou chosen", None),
            ("miou", Some(62.5)),
            ("moon miou", None),
            ("room tube_iou", Some(62.5)),
            ("room_living_cats select", Some(62.5)),
        ];
        assert_eq!(found, expected);
        assert!(rows(&board).iter().all(|row| row.reported == 70.0 && row.method.as_str() == "alpha"));
    }
}
