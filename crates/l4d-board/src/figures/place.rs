//! Where labels go so that they overlap neither each other nor the data.

use super::drawing::{Anchor, Extent, Lettering};

/// A label beside a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) x: f64,
    pub(crate) baseline: f64,
    pub(crate) anchor: Anchor,
    /// Where a thin line from the point to the label ends, for labels that stand away from it.
    pub(crate) leader_to: Option<(f64, f64)>,
}

// Distances from the point; labels beyond the first ring get a leader.
const RINGS: [f64; 9] = [8.0, 15.0, 24.0, 35.0, 48.0, 64.0, 82.0, 102.0, 124.0];
// Right, left, above, below, then slanted: how people put labels by hand.
const DIRECTIONS: [(f64, f64); 12] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (0.7, -0.7),
    (0.7, 0.7),
    (-0.7, -0.7),
    (-0.7, 0.7),
    (0.92, -0.38),
    (0.38, -0.92),
    (-0.92, -0.38),
    (-0.92, 0.38),
];
const DOT: f64 = 5.0;

/// What leaders keep clear of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Leaders {
    /// Other labels and dots.
    Avoid,
    /// Nothing: for crowds.
    Cross,
}

/// Places one label a point, in order, or nothing if some label finds no room in `bounds`.
pub(crate) fn beside_points(
    points: &[(f64, f64)],
    labels: &[String],
    lettering: Lettering,
    bounds: Extent,
    crossing: Leaders,
) -> Option<Vec<Place>> {
    let dots: Vec<Extent> = points.iter().map(|&(x, y)| around(x, y, DOT)).collect();
    let mut taken: Vec<Extent> = Vec::new();
    let mut leaders: Vec<Vec<Extent>> = Vec::new();
    let mut places = Vec::new();
    for (&point, label) in points.iter().zip(labels) {
        // A dot that touches this one cannot be kept clear of.
        let own = around(point.0, point.1, DOT);
        let foreign: Vec<Extent> = dots.iter().copied().filter(|dot| !dot.overlaps(own)).collect();
        let (place, extent) = candidates(point).find_map(|place| {
            let extent = Extent::of_text(place.x, place.baseline, label, lettering.anchored(place.anchor));
            let is_free = bounds.holds(extent)
                && !taken.iter().any(|other| other.overlaps(extent))
                && !dots.iter().any(|dot| dot.overlaps(extent));
            // The costly question comes last.
            let is_clear = || {
                let leader = place.leader_to.map(|end| beads(point, end)).unwrap_or_default();
                !leaders.iter().flatten().any(|bead| bead.overlaps(extent))
                    && !leader.iter().any(|bead| taken.iter().any(|other| other.overlaps(*bead)))
                    && !leader.iter().any(|bead| foreign.iter().any(|dot| dot.overlaps(*bead)))
            };
            (is_free && (crossing == Leaders::Cross || is_clear())).then_some((place, extent))
        })?;
        leaders.push(place.leader_to.map(|end| beads(point, end)).unwrap_or_default());
        taken.push(extent);
        places.push(place);
    }
    Some(places)
}

/// Shifts boxes of given heights, whose middles want to be at `wanted` (ascending), so that none overlaps and all
/// lie between `top` and `bottom` where there is room; gives their middles.
pub(crate) fn spread(wanted: &[f64], heights: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut middles: Vec<f64> = Vec::new();
    let mut free_from = top;
    for (&want, &height) in wanted.iter().zip(heights) {
        let middle = want.max(free_from + height / 2.0);
        free_from = middle + height / 2.0;
        middles.push(middle);
    }
    let mut free_to = bottom;
    for (middle, &height) in middles.iter_mut().zip(heights).rev() {
        *middle = middle.min(free_to - height / 2.0);
        free_to = *middle - height / 2.0;
    }
    middles
}

fn candidates((x, y): (f64, f64)) -> impl Iterator<Item = Place> {
    RINGS.into_iter().flat_map(move |ring| {
        DIRECTIONS.into_iter().map(move |(right, down)| {
            let anchor = match right {
                _ if right > 0.1 => Anchor::Start,
                _ if right < -0.1 => Anchor::End,
                _ => Anchor::Middle,
            };
            let (at_x, at_y) = (x + right * ring, y + down * ring);
            // The baseline that puts the middle, the bottom or the top of the letters there.
            let baseline = at_y + 3.5 + down * 4.5;
            Place { x: at_x, baseline, anchor, leader_to: (ring > RINGS[0]).then_some((at_x, at_y)) }
        })
    })
}

fn around(x: f64, y: f64, radius: f64) -> Extent {
    Extent { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
}

/// A line as a row of small boxes, without its last bit, which touches its label.
fn beads(from: (f64, f64), to: (f64, f64)) -> Vec<Extent> {
    let length = (to.0 - from.0).hypot(to.1 - from.1);
    let count = (length / 3.0) as usize;
    (0..count)
        .map(|index| {
            let share = index as f64 / count as f64;
            around(from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1), 1.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Extent = Extent { left: 0.0, top: 0.0, right: 300.0, bottom: 200.0 };

    #[test]
    fn labels_of_near_points_do_not_overlap() {
        let points = [(100.0, 100.0), (104.0, 102.0), (98.0, 96.0), (300.0, 0.0)];
        let labels: Vec<String> = ["oracle", "time-agnostic", "none", "corner"].map(str::to_owned).to_vec();
        let places = beside_points(&points, &labels, Lettering::NOTE, BOUNDS, Leaders::Avoid).unwrap();
        let extents: Vec<Extent> = places
            .iter()
            .zip(&labels)
            .map(|(place, label)| {
                Extent::of_text(place.x, place.baseline, label, Lettering::NOTE.anchored(place.anchor))
            })
            .collect();
        for (index, extent) in extents.iter().enumerate() {
            assert!(BOUNDS.holds(*extent));
            assert!(extents[..index].iter().all(|other| !other.overlaps(*extent)), "{extents:?}");
        }
    }

    #[test]
    fn without_room_there_is_no_place() {
        let label = ["a label that is much too long for such a narrow picture, by any measure".to_owned()];
        assert_eq!(beside_points(&[(50.0, 50.0)], &label, Lettering::NOTE, BOUNDS, Leaders::Avoid), None);
    }

    #[test]
    fn spread_boxes_keep_their_order_and_their_distance() {
        assert_eq!(spread(&[10.0, 11.0, 50.0], &[10.0; 3], 0.0, 100.0), [10.0, 20.0, 50.0]);
        assert_eq!(spread(&[99.0, 99.0], &[10.0; 2], 0.0, 100.0), [85.0, 95.0]);
    }
}
