//! Masks grown and shrunk, and the edges that they leave.
//!
//! The disc of a radius holds every pixel whose centre lies no farther than that from the centre of its own. For it,
//! pixels outside of the picture are neither inside a mask nor outside: a thing that the border cuts off neither grows
//! from there nor shrinks. The square of a radius, which some measures of boundaries use, sees nothing out there.

use std::ops::Range;

use crate::mask::{Mask, words_per_row};

/// All pixels within `radius_px` pixels of a pixel of the mask.
pub fn dilated(mask: &Mask, radius_px: u32) -> Mask {
    let (width, height) = mask.size();
    // A wider disc reaches no more pixels, and its square might overflow.
    let radius_px = radius_px.min(width.max(height).saturating_mul(2));
    let mut grown = Mask::empty(width, height);
    let mut wide = vec![0; words_per_row(width)];
    let mut before = wide.clone();
    for row in 0..height {
        let Some(words) = touched_words(mask.row_words(row), radius_px) else { continue };
        let (wide, before) = (&mut wide[words.clone()], &mut before[words.clone()]);
        wide.copy_from_slice(&mask.row_words(row)[words.clone()]);
        // Rows far away see the narrow end of the disc, nearer ones widen it further.
        let mut covered = 0;
        for rows_away in (0..=radius_px).rev() {
            widen(wide, before, &mut covered, half_width(radius_px, rows_away));
            for target in [row.checked_sub(rows_away), row.checked_add(rows_away)].into_iter().flatten() {
                if target < height {
                    let grown = &mut grown.row_words_mut(target)[words.clone()];
                    grown.iter_mut().zip(wide.iter()).for_each(|(ours, theirs)| *ours |= theirs);
                }
            }
        }
    }
    grown.clear_padding();
    grown
}

/// All pixels of the mask with no pixel of the picture outside of it within `radius_px` pixels.
pub fn eroded(mask: &Mask, radius_px: u32) -> Mask {
    complement(&dilated(&complement(mask), radius_px))
}

/// The other pixels of the picture.
fn complement(mask: &Mask) -> Mask {
    let mut others = mask.clone();
    for row in 0..mask.height() {
        for word in others.row_words_mut(row) {
            *word = !*word;
        }
    }
    others.clear_padding();
    others
}

/// Columns that the disc reaches to either side, so many rows from its centre.
fn half_width(radius_px: u32, rows_away: u32) -> u32 {
    let square = u64::from(radius_px).pow(2) - u64::from(rows_away).pow(2);
    square.isqrt() as u32
}

/// The words of a row that a disc around its pixels can reach; none if it has no pixel.
fn touched_words(row: &[u64], radius_px: u32) -> Option<Range<usize>> {
    let first = row.iter().position(|&word| word != 0)?;
    let last = row.iter().rposition(|&word| word != 0)?;
    let reach = radius_px.div_ceil(64) as usize;
    Some(first.saturating_sub(reach)..last.saturating_add(reach + 1).min(row.len()))
}

/// Widens a row that covers `covered` pixels to both sides until it covers `reach`, by growing steps: each may jump
/// over what is covered already.
fn widen(row: &mut [u64], before: &mut [u64], covered: &mut u32, reach: u32) {
    while *covered < reach {
        let step = (2 * *covered + 1).min(reach - *covered);
        before.copy_from_slice(row);
        for (index, word) in row.iter_mut().enumerate() {
            *word |= up(before, index, step) | down(before, index, step);
        }
        *covered += step;
    }
}

/// What a word holds after its row moved by `by` pixels towards higher columns.
fn up(row: &[u64], index: usize, by: u32) -> u64 {
    let (words, bits) = ((by / 64) as usize, by % 64);
    let word = |index: Option<usize>| index.and_then(|index| row.get(index)).copied().unwrap_or(0);
    let here = word(index.checked_sub(words)) << bits;
    // A shift by all 64 bits would be no shift at all.
    if bits == 0 { here } else { here | word(index.checked_sub(words + 1)) >> (64 - bits) }
}

/// The same towards lower columns.
fn down(row: &[u64], index: usize, by: u32) -> u64 {
    let (words, bits) = ((by / 64) as usize, by % 64);
    let word = |index: usize| row.get(index).copied().unwrap_or(0);
    let here = word(index + words) >> bits;
    if bits == 0 { here } else { here | word(index + words + 1) << (64 - bits) }
}

/// All pixels of the mask whose whole square of side `2 * radius_px + 1` lies inside, and within the picture.
pub fn eroded_square(mask: &Mask, radius_px: u32) -> Mask {
    let (width, height) = mask.size();
    let side = u64::from(radius_px) * 2 + 1;
    if side > u64::from(width.min(height)) {
        return Mask::empty(width, height);
    }
    let mut shrunk = mask.clone();
    let mut before = vec![0; words_per_row(width)];
    for row in 0..height {
        let words = shrunk.row_words_mut(row);
        let mut covered = 0;
        while covered < radius_px && words.iter().any(|&word| word != 0) {
            let step = (2 * covered + 1).min(radius_px - covered);
            before.copy_from_slice(words);
            for (index, word) in words.iter_mut().enumerate() {
                *word &= up(&before, index, step) & down(&before, index, step);
            }
            covered += step;
        }
    }
    // Each row becomes what it has in common with ever more rows below it, then two such bundles make a window.
    let mut bundle = 1;
    while u64::from(2 * bundle) <= side {
        for row in 0..height {
            keep_common(&mut shrunk, row, row.checked_add(bundle).filter(|&below| below < height));
        }
        bundle *= 2;
    }
    let mut window = Mask::empty(width, height);
    for row in radius_px..height - radius_px {
        let (top, bottom) = (row - radius_px, row + radius_px + 1 - bundle);
        let common = shrunk.row_words(top).iter().zip(shrunk.row_words(bottom));
        for (word, (top, bottom)) in window.row_words_mut(row).iter_mut().zip(common) {
            *word = top & bottom;
        }
    }
    window
}

fn keep_common(mask: &mut Mask, row: u32, with: Option<u32>) {
    let Some(with) = with else { return mask.row_words_mut(row).fill(0) };
    let others = mask.row_words(with).to_vec();
    mask.row_words_mut(row).iter_mut().zip(others).for_each(|(ours, theirs)| *ours &= theirs);
}

/// Pixels that differ from their right, lower or lower right neighbour: where inside and outside meet. Neighbours
/// outside of the picture do not count.
pub fn edges(mask: &Mask) -> Mask {
    let (width, height) = mask.size();
    let mut edges = Mask::empty(width, height);
    // The last column has nobody to its right.
    let keep = |index: usize| {
        let is_last = index + 1 == words_per_row(width);
        if is_last { !(1 << ((width - 1) % 64)) } else { u64::MAX }
    };
    for row in 0..height {
        let words = mask.row_words(row);
        let below = (row + 1 < height).then(|| mask.row_words(row + 1));
        for (index, edge) in edges.row_words_mut(row).iter_mut().enumerate() {
            let here = words[index];
            *edge = (here ^ down(words, index, 1)) & keep(index);
            if let Some(below) = below {
                *edge |= (here ^ below[index]) | ((here ^ down(below, index, 1)) & keep(index));
            }
        }
    }
    edges.clear_padding();
    edges
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Rows of `.` and `#`.
    fn drawn(rows: &[&str]) -> Mask {
        let is_inside = |col: u32, row: u32| rows[row as usize].as_bytes()[col as usize] == b'#';
        Mask::from_fn(rows[0].len() as u32, rows.len() as u32, is_inside)
    }

    #[test]
    fn a_pixel_grows_into_the_disc() {
        let pixel = drawn(&[".......", ".......", ".......", "...#...", ".......", ".......", "......."]);
        assert_eq!(dilated(&pixel, 0), pixel);
        let cross = drawn(&[".......", ".......", "...#...", "..###..", "...#...", ".......", "......."]);
        assert_eq!(dilated(&pixel, 1), cross);
        let disc = drawn(&[".......", "...#...", "..###..", ".#####.", "..###..", "...#...", "......."]);
        assert_eq!(dilated(&pixel, 2), disc);
        // Radius 3: (2, 2) is 2.83 away, (3, 0) exactly 3.
        let disc = drawn(&["...#...", ".#####.", ".#####.", "#######", ".#####.", ".#####.", "...#..."]);
        assert_eq!(dilated(&pixel, 3), disc);
    }

    #[test]
    fn shrinking_undoes_growing_of_a_disc_and_ends_thin_things() {
        let disc = drawn(&[".......", "...#...", "..###..", ".#####.", "..###..", "...#...", "......."]);
        let pixel = drawn(&[".......", ".......", ".......", "...#...", ".......", ".......", "......."]);
        assert_eq!(eroded(&disc, 2), pixel);
        let line = drawn(&["....", "####", "...."]);
        assert!(eroded(&line, 1).is_empty());
    }

    #[test]
    fn the_border_of_the_picture_cuts_nothing() {
        let half = drawn(&["###...", "###...", "###...", "###..."]);
        assert_eq!(eroded(&half, 1), drawn(&["##....", "##....", "##....", "##...."]));
        let full = Mask::full(70, 3);
        assert_eq!(eroded(&full, 5), full);
        assert!(eroded(&Mask::empty(70, 3), 1).is_empty());
    }

    #[test]
    fn a_disc_wider_than_the_picture_reaches_everything() {
        let corner = Mask::from_fn(70, 9, |col, row| (col, row) == (0, 0));
        assert_eq!(dilated(&corner, u32::MAX), Mask::full(70, 9));
        assert!(dilated(&Mask::empty(70, 9), u32::MAX).is_empty());
        assert_eq!(dilated(&Mask::empty(0, 0), 3).area(), 0);
    }

    fn by_definition(mask: &Mask, radius_px: u32) -> Mask {
        let pixels: Vec<(u32, u32)> = mask.pixels().collect();
        let is_near = |col: u32, row: u32| {
            let distance = |&(x, y): &(u32, u32)| x.abs_diff(col).pow(2) + y.abs_diff(row).pow(2);
            pixels.iter().any(|pixel| distance(pixel) <= radius_px * radius_px)
        };
        Mask::from_fn(mask.width(), mask.height(), is_near)
    }

    proptest! {
        #[test]
        fn edges_and_squares_are_what_the_definition_says(
            width in 1..150_u32, height in 1..20_u32, radius_px in 0..8_u32,
            holes in proptest::collection::vec((0..150_u32, 0..20_u32), 0..6), cut in 0..150_u32,
        ) {
            let mask = Mask::from_fn(width, height, |col, row| col >= cut % width && !holes.contains(&(col, row)));
            let is_inside = |col: i64, row: i64| {
                let pixel = u32::try_from(col).ok().zip(u32::try_from(row).ok());
                pixel.is_some_and(|(col, row)| mask.get(col, row))
            };
            let square = Mask::from_fn(width, height, |col, row| {
                let (col, row, radius) = (i64::from(col), i64::from(row), i64::from(radius_px));
                (-radius..=radius).all(|down| (-radius..=radius).all(|right| is_inside(col + right, row + down)))
            });
            prop_assert_eq!(eroded_square(&mask, radius_px), square);
            let outline = Mask::from_fn(width, height, |col, row| {
                let neighbours = [(col + 1, row), (col, row + 1), (col + 1, row + 1)];
                neighbours.into_iter().filter(|&(col, row)| col < width && row < height).any(|(x, y)| {
                    mask.get(x, y) != mask.get(col, row)
                })
            });
            prop_assert_eq!(edges(&mask), outline);
        }

        #[test]
        fn growing_is_what_the_definition_says(
            width in 1..200_u32, height in 1..12_u32, radius_px in 0..90_u32,
            places in proptest::collection::vec((0..200_u32, 0..12_u32), 0..4),
        ) {
            let mask = Mask::from_fn(width, height, |col, row| places.contains(&(col, row)));
            let grown = dilated(&mask, radius_px);
            prop_assert_eq!(&grown, &by_definition(&mask, radius_px));
            prop_assert_eq!(Mask::from_bools(width, height, &grown.to_bools()).unwrap(), grown);
        }
    }
}
