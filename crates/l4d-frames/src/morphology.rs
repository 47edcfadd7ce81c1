//! Masks grown and shrunk by a disc.
//!
//! The disc of a radius holds every pixel whose centre lies no farther than that from the centre of its own. Pixels
//! outside of the picture are neither inside a mask nor outside: a thing that the border cuts off neither grows from
//! there nor shrinks.

use crate::mask::Mask;

/// All pixels within `radius_px` pixels of a pixel of the mask.
pub fn dilated(mask: &Mask, radius_px: u32) -> Mask {
    let (width, height) = mask.size();
    // A wider disc reaches no more pixels, and its square might overflow.
    let radius_px = radius_px.min(width.max(height).saturating_mul(2));
    let mut grown = Mask::empty(width, height);
    for rows_away in 0..=radius_px.min(height) {
        let reach = half_width(radius_px, rows_away);
        for row in 0..height {
            if mask.row_words(row).iter().all(|&word| word == 0) {
                continue;
            }
            let wide = widened(mask.row_words(row), reach);
            for target in [row.checked_sub(rows_away), row.checked_add(rows_away)].into_iter().flatten() {
                if target < height {
                    for (ours, theirs) in grown.row_words_mut(target).iter_mut().zip(&wide) {
                        *ours |= theirs;
                    }
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

/// A row grown by `reach` pixels to both sides: shifts by growing steps, each no wider than what is covered already.
fn widened(row: &[u64], reach: u32) -> Vec<u64> {
    let mut wide = row.to_vec();
    let mut covered = 0;
    while covered < reach {
        let step = (covered + 1).min(reach - covered);
        let (up, down) = (shifted_up(&wide, step), shifted_down(&wide, step));
        for ((word, up), down) in wide.iter_mut().zip(up).zip(down) {
            *word |= up | down;
        }
        covered += step;
    }
    wide
}

/// The row moved by `by` pixels towards higher columns.
fn shifted_up(row: &[u64], by: u32) -> Vec<u64> {
    let (words, bits) = ((by / 64) as usize, by % 64);
    let word = |index: usize| index.checked_sub(words).and_then(|from| row.get(from)).copied().unwrap_or(0);
    let carried = |index: usize| index.checked_sub(1).map_or(0, |before| carry_up(word(before), bits));
    (0..row.len()).map(|index| word(index) << bits | carried(index)).collect()
}

/// The row moved by `by` pixels towards lower columns.
fn shifted_down(row: &[u64], by: u32) -> Vec<u64> {
    let (words, bits) = ((by / 64) as usize, by % 64);
    let word = |index: usize| row.get(index + words).copied().unwrap_or(0);
    (0..row.len()).map(|index| word(index) >> bits | carry_down(word(index + 1), bits)).collect()
}

/// What a word hands to the next one; a shift by all 64 bits would be no shift at all.
fn carry_up(word: u64, bits: u32) -> u64 {
    if bits == 0 { 0 } else { word >> (64 - bits) }
}

fn carry_down(word: u64, bits: u32) -> u64 {
    if bits == 0 { 0 } else { word << (64 - bits) }
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
