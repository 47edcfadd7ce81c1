//! Pictures out of characters: quarter blocks in two colours, coloured cells where only ASCII is understood, and shades
//! of ASCII where there are no colours.

use l4d_frames::closeup::{Closeup, Stroke};
use ratatui::buffer::Cell;
use ratatui::style::Color;

use crate::look::{Colours, Look};

/// How many pixels a cell shows, columns and rows.
pub(crate) fn grain(look: &Look) -> (u32, u32) {
    if look.unicode && look.colours != Colours::None { (2, 2) } else { (1, 1) }
}

/// The cells of a closeup that has [`grain`] pixels for each, row by row.
pub(crate) fn cells(closeup: &Closeup, look: &Look) -> Vec<Cell> {
    let (wide, high) = grain(look);
    let cell = match (wide, look.colours) {
        (2, _) => quarters,
        (_, Colours::None) => shade,
        _ => plain,
    };
    let size = closeup.size();
    let places = (0..size.y / high).flat_map(|row| (0..size.x / wide).map(move |column| (column, row)));
    places.map(|(column, row)| cell(closeup, column * wide, row * high)).collect()
}

/// A symbol and the colour behind it; none leaves the terminal's own.
fn art_cell(symbol: char, ink: Option<[u8; 3]>, paper: Option<[u8; 3]>) -> Cell {
    let colour =
        |rgb: Option<[u8; 3]>| rgb.map_or(Color::Reset, |[red, green, blue]| Color::Rgb(red, green, blue));
    let mut cell = Cell::default();
    cell.set_char(symbol).set_fg(colour(ink)).set_bg(colour(paper));
    cell
}

/// Quarter blocks by which of top right, bottom left, bottom right have the ink's colour; top left never has.
const QUARTERS: [char; 8] = [' ', '▝', '▖', '▞', '▗', '▐', '▄', '▟'];

/// The split of four pixels into two colours that changes them least.
fn quarters(closeup: &Closeup, left: u32, top: u32) -> Cell {
    let pixels = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| {
        let (column, row) = (left + right, top + down);
        let weight = if closeup.stroke(column, row) == Stroke::Light { 4.0 } else { 1.0 };
        (closeup.picture().get_pixel(column, row).0.map(f32::from), weight)
    });
    let is_ink = |split: usize, pixel: usize| pixel > 0 && split >> (pixel - 1) & 1 == 1;
    let mut best = (f32::INFINITY, 0, [[0.0; 3]; 2]);
    for split in 0..QUARTERS.len() {
        let mut sums = [([0.0; 3], 0.0); 2];
        for (pixel, (colour, weight)) in pixels.iter().enumerate() {
            let (sum, total) = &mut sums[usize::from(is_ink(split, pixel))];
            (0..3).for_each(|channel| sum[channel] += colour[channel] * weight);
            *total += weight;
        }
        let means =
            sums.map(|(sum, total)| sum.map(|channel| if total > 0.0 { channel / total } else { 0.0 }));
        let error = pixels.iter().enumerate().map(|(pixel, (colour, weight))| {
            let mean = means[usize::from(is_ink(split, pixel))];
            (0..3).map(|channel| (colour[channel] - mean[channel]).powi(2)).sum::<f32>() * weight
        });
        let error: f32 = error.sum();
        // The first of equals: one colour rather than two that are the same.
        if error < best.0 {
            best = (error, split, means);
        }
    }
    let (_, split, [paper, ink]) = best;
    let byte = |colour: [f32; 3]| colour.map(|channel| channel.round() as u8);
    art_cell(QUARTERS[split], (split > 0).then(|| byte(ink)), Some(byte(paper)))
}

fn plain(closeup: &Closeup, column: u32, row: u32) -> Cell {
    art_cell(' ', None, Some(closeup.picture().get_pixel(column, row).0))
}

/// Characters from dark to bright; `#` is left for outlines.
const SHADES: [char; 7] = [' ', '.', ':', '-', '=', '+', '*'];

fn shade(closeup: &Closeup, column: u32, row: u32) -> Cell {
    let [red, green, blue] = closeup.picture().get_pixel(column, row).0.map(f32::from);
    // In [0, 1).
    let bright = (0.299 * red + 0.587 * green + 0.114 * blue) / 256.0;
    let symbol = match closeup.stroke(column, row) {
        Stroke::Light => '#',
        Stroke::Dark => ' ',
        Stroke::None => SHADES[(bright * SHADES.len() as f32) as usize % SHADES.len()],
    };
    art_cell(symbol, None, None)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use l4d_frames::closeup::RgbImage;
    use l4d_masks::mask::PixelBox;

    use super::*;
    use crate::testing::look;

    /// A closeup of exactly these pixels, all of one object.
    fn closeup(width: u32, pixels: &[[u8; 3]]) -> Closeup {
        let size = UVec2::new(width, pixels.len() as u32 / width);
        let picture = RgbImage::from_raw(size.x, size.y, pixels.concat()).unwrap();
        let whole = PixelBox { first_col: 0, first_row: 0, last_col: size.x - 1, last_row: size.y - 1 };
        Closeup::cut(&picture, &vec![1; pixels.len()], whole, size)
    }

    #[test]
    fn quarter_blocks_split_four_pixels_into_two_colours() {
        let (dark, red) = ([10; 3], [200, 0, 0]);
        let cell = |pixels: [[u8; 3]; 4]| cells(&closeup(2, &pixels), &look(true, Colours::Full)).remove(0);
        assert_eq!(cell([dark; 4]), art_cell(' ', None, Some(dark)));
        let expected = art_cell('▐', Some(red), Some(dark));
        assert_eq!(cell([dark, red, dark, red]), expected);
        let expected = art_cell('▟', Some(dark), Some(red));
        assert_eq!(cell([red, dark, dark, dark]), expected);
    }

    #[test]
    fn without_colours_brightness_is_a_character() {
        let greys: Vec<[u8; 3]> = (0..=255).map(|value| [value; 3]).collect();
        for unicode in [false, true] {
            let shades = cells(&closeup(16, &greys), &look(unicode, Colours::None));
            assert_eq!((shades[0].symbol(), shades[255].symbol()), (" ", "*"));
        }
    }
}
