//! Masks grown and shrunk, and the edges that they leave.
//!
//! The disc of a radius holds every pixel whose centre lies no farther than that from the centre of its own. For it,
//! pixels outside of the picture are neither inside a mask nor outside: a thing that the border cuts off neither grows
//! from there nor shrinks. The square of a radius, which some measures of boundaries use, sees nothing out there.

use crate::mask::Mask;

/// All pixels within `radius_px` pixels of a pixel of the mask.
pub fn dilated(mask: &Mask, radius_px: u32) -> Mask {
    let (width, height) = mask.size();
    // A wider disc reaches no more pixels.
    let radius_px = radius_px.min(width.max(height).saturating_mul(2));
    let square = |side: u32| u64::from(side).pow(2);
    let half_widths = (0..=radius_px).map(|rows_away| (square(radius_px) - square(rows_away)).isqrt() as u32);
    grown(mask, &half_widths.collect::<Vec<_>>())
}

/// All pixels of the mask with no pixel of the picture outside of it within `radius_px` pixels.
pub fn eroded(mask: &Mask, radius_px: u32) -> Mask {
    complement(&dilated(&complement(mask), radius_px))
}

/// All pixels of the mask whose whole square of side `2 * radius_px + 1` lies inside, and within the picture.
pub fn eroded_square(mask: &Mask, radius_px: u32) -> Mask {
    let (width, height) = mask.size();
    if u64::from(radius_px) * 2 + 1 > u64::from(width.min(height)) {
        return Mask::empty(width, height);
    }
    // Two sides of the square, one after the other.
    let tall = grown(&grown(&complement(mask), &[radius_px]), &vec![0; radius_px as usize + 1]);
    let mut shrunk = Mask::empty(width, height);
    let kept = complement(&tall);
    for row in radius_px..height - radius_px {
        for run in kept.runs_of_row(row) {
            shrunk.fill_row(row, run.start.max(radius_px)..run.end.min(width - radius_px));
        }
    }
    shrunk
}

/// Every pixel becomes rows that reach `half_widths[rows_away]` columns to either side.
fn grown(mask: &Mask, half_widths: &[u32]) -> Mask {
    let (width, height) = mask.size();
    let mut grown = Mask::empty(width, height);
    for row in 0..height {
        for run in mask.runs_of_row(row) {
            for (rows_away, half_width) in (0..).zip(half_widths) {
                let columns = run.start.saturating_sub(*half_width)..run.end.saturating_add(*half_width);
                let above = row.checked_sub(rows_away);
                let below = row.checked_add(rows_away).filter(|below| *below < height);
                for target in [above, below].into_iter().flatten() {
                    grown.fill_row(target, columns.clone());
                }
            }
        }
    }
    grown
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

/// Pixels that differ from their right, lower or lower right neighbour: where inside and outside meet. Neighbours
/// outside of the picture do not count.
pub fn edges(mask: &Mask) -> Mask {
    let (width, height) = mask.size();
    Mask::from_fn(width, height, |col, row| {
        let here = mask.get(col, row);
        let (right, below) = ((col + 1).min(width - 1), (row + 1).min(height - 1));
        mask.get(right, row) != here || mask.get(col, below) != here || mask.get(right, below) != here
    })
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
