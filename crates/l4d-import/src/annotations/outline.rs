//! Masks as polygons that give back every pixel under [`Rule::Cv2`](super::fill::Rule::Cv2).
//!
//! A polygon has no holes and is one piece, so a mask is cut into pieces that are. Readers unite the pieces of a label.

use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;

/// One piece of a mask.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    /// Its border: pixel after pixel, straight runs shortened to their ends; at least three corners.
    pub(super) corners: Vec<[u32; 2]>,
    /// Its pixels.
    pub(super) area: u64,
    /// The box of the connected thing that it was cut from.
    pub(super) whole: PixelBox,
}

/// Neighbours, clockwise from the right.
const AROUND: [[i64; 2]; 8] = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];

/// Cuts a mask into pieces without holes.
pub(super) fn pieces(mask: &Mask) -> Vec<Piece> {
    let mut found = Vec::new();
    for thing in components(mask) {
        let Some(whole) = thing.bounding_box() else { continue };
        let mut waiting = vec![thing];
        while let Some(part) = waiting.pop() {
            match row_of_hole(&part) {
                None => found.push(Piece { corners: border(&part), area: part.area(), whole }),
                Some(row) => {
                    // A cut through a hole opens it on both sides.
                    let half = |is_kept: fn(u32, u32) -> bool| {
                        Mask::from_fn(part.width(), part.height(), |col, at| {
                            is_kept(at, row) && part.get(col, at)
                        })
                    };
                    waiting.extend(components(&half(|at, row| at > row)).into_iter().rev());
                    waiting.extend(components(&half(|at, row| at <= row)).into_iter().rev());
                }
            }
        }
    }
    found
}

/// Things that hang together by sides or corners, by their first pixel.
fn components(mask: &Mask) -> Vec<Mask> {
    let mut left = mask.clone();
    let mut found = Vec::new();
    loop {
        // Bound first: an iterator that lives in the condition would hold the mask.
        let start = left.pixels().next();
        let Some(start) = start else { break };
        let mut component = Mask::empty(mask.width(), mask.height());
        let mut waiting = vec![start];
        left.set(start.0, start.1, false);
        while let Some((column, row)) = waiting.pop() {
            component.set(column, row, true);
            for [right, down] in AROUND {
                let (x, y) = (i64::from(column) + right, i64::from(row) + down);
                let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { continue };
                if left.get(x, y) {
                    left.set(x, y, false);
                    waiting.push((x, y));
                }
            }
        }
        found.push(component);
    }
    found
}

/// A row in which the mask encloses pixels that are not its own.
fn row_of_hole(mask: &Mask) -> Option<u32> {
    let bounds = mask.bounding_box()?;
    // One pixel of margin on each side, from which everything outside can be reached.
    let (width, height) = (bounds.last_col - bounds.first_col + 3, bounds.last_row - bounds.first_row + 3);
    let is_inside = |column: u32, row: u32| {
        column > 0
            && row > 0
            && mask.get(bounds.first_col + column - 1, bounds.first_row + row - 1)
            && column <= width
    };
    let mut outside = Mask::empty(width, height);
    outside.set(0, 0, true);
    let mut waiting = vec![(0, 0)];
    while let Some((column, row)) = waiting.pop() {
        for [right, down] in [[1_i64, 0], [0, 1], [-1, 0], [0, -1]] {
            let (x, y) = (i64::from(column) + right, i64::from(row) + down);
            let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { continue };
            if x < width && y < height && !outside.get(x, y) && !is_inside(x, y) {
                outside.set(x, y, true);
                waiting.push((x, y));
            }
        }
    }
    let enclosed =
        Mask::from_fn(width, height, |column, row| !outside.get(column, row) && !is_inside(column, row));
    enclosed.pixels().next().map(|(_, row)| bounds.first_row + row - 1)
}

/// The outer border of one thing, clockwise from its first pixel.
fn border(mask: &Mask) -> Vec<[u32; 2]> {
    let Some((column, row)) = mask.pixels().next() else { return Vec::new() };
    let start = [i64::from(column), i64::from(row)];
    let is_inside = |[x, y]: [i64; 2]| match (u32::try_from(x), u32::try_from(y)) {
        (Ok(x), Ok(y)) => mask.get(x, y),
        _ => false,
    };
    let step = |from: [i64; 2], towards: usize| [from[0] + AROUND[towards][0], from[1] + AROUND[towards][1]];
    // The first pixel has nothing above it nor to its left: the search begins to the left, clockwise.
    let next = |from: [i64; 2], after: usize| {
        (1..=8).map(|turn| (after + turn) % 8).find(|&towards| is_inside(step(from, towards)))
    };
    let mut path = vec![start];
    let (mut at, mut came_from) = (start, 4);
    let first_move = next(start, came_from);
    while let Some(towards) = next(at, came_from) {
        if path.len() > 1 && at == start && Some(towards) == first_move {
            path.pop();
            break;
        }
        at = step(at, towards);
        came_from = (towards + 4) % 8;
        path.push(at);
    }
    shortened(&path)
}

/// Leaves out pixels in the middle of straight runs.
fn shortened(path: &[[i64; 2]]) -> Vec<[u32; 2]> {
    let count = path.len();
    let between = |a: [i64; 2], b: [i64; 2]| [b[0] - a[0], b[1] - a[1]];
    let is_corner = |index: usize| {
        let (before, at, after) = (path[(index + count - 1) % count], path[index], path[(index + 1) % count]);
        between(before, at) != between(at, after)
    };
    let mut corners: Vec<[u32; 2]> = (0..count)
        .filter(|&index| count == 1 || is_corner(index))
        .map(|index| path[index].map(|value| value as u32))
        .collect();
    // Tools refuse polygons of fewer than three corners, even of a line or a pixel.
    while corners.len() < 3 {
        corners.push(corners[corners.len() - 1]);
    }
    corners
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::fill::{Rule, fill};
    use super::*;

    fn filled(pieces: &[Piece], width: u32, height: u32) -> Mask {
        let mut union = Mask::empty(width, height);
        for piece in pieces {
            let corners: Vec<[f64; 2]> = piece.corners.iter().map(|corner| corner.map(f64::from)).collect();
            union.union_with(&fill(Rule::Cv2, &corners, width, height));
        }
        union
    }

    proptest! {
        #[test]
        fn every_mask_comes_back_pixel_by_pixel(
            width in 1..30_u32,
            height in 1..20_u32,
            seed in proptest::collection::vec(0..100_u8, 600),
            density in 5..95_u8,
        ) {
            let mask = Mask::from_fn(width, height, |col, row| seed[(row * 30 + col) as usize] < density);
            let pieces = pieces(&mask);
            prop_assert_eq!(filled(&pieces, width, height), mask.clone());
            prop_assert_eq!(pieces.iter().map(|piece| piece.area).sum::<u64>(), mask.area());
            prop_assert!(pieces.iter().all(|piece| piece.corners.len() >= 3));
        }
    }

    #[test]
    fn a_ring_is_cut_and_remembers_its_box() {
        let ring = Mask::from_fn(12, 12, |col, row| {
            let from_centre = (i64::from(col) - 5).pow(2) + (i64::from(row) - 5).pow(2);
            (6..=20).contains(&from_centre)
        });
        let pieces = pieces(&ring);
        assert!(pieces.len() > 1);
        assert_eq!(filled(&pieces, 12, 12), ring);
        assert!(pieces.iter().all(|piece| Some(piece.whole) == ring.bounding_box()));
    }

    #[test]
    fn straight_borders_have_few_corners() {
        let block = Mask::from_fn(40, 30, |col, row| (5..35).contains(&col) && (3..20).contains(&row));
        assert_eq!(pieces(&block)[0].corners, [[5, 3], [34, 3], [34, 19], [5, 19]]);
        assert_eq!(pieces(&Mask::from_fn(3, 3, |col, row| (col, row) == (1, 1)))[0].corners, [[1, 1]; 3]);
    }
}
