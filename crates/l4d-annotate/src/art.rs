//! Pictures out of characters, two colours to a cell: quarter blocks, dots where there are no colours, and plain
//! ASCII where nothing else is understood.

use l4d_data::scene::OBJECT_IDS;
use l4d_frames::closeup::{Closeup, Stroke};

use crate::look::{Colours, Look};
use crate::picture::ArtCell;

/// How many pixels a cell shows, columns and rows.
pub(crate) fn grain(look: &Look) -> (u32, u32) {
    match (look.unicode, look.quarters, look.colours) {
        (false, _, _) => (1, 1),
        (true, false, Colours::None) => (1, 1),
        (true, true, Colours::None) => (2, 4),
        (true, false, _) => (1, 2),
        (true, true, _) => (2, 2),
    }
}

/// The cells of a closeup that has [`grain`] pixels for each, row by row.
pub(crate) fn cells(closeup: &Closeup, look: &Look) -> Vec<ArtCell> {
    match (grain(look), look.colours) {
        ((2, 4), _) => dots(closeup),
        ((2, 2), _) => each(closeup, (2, 2), quarters),
        ((1, 2), _) => each(closeup, (1, 2), halves),
        (_, Colours::None) => each(closeup, (1, 1), shade),
        _ => each(closeup, (1, 1), plain),
    }
}

fn each(
    closeup: &Closeup,
    (wide, high): (u32, u32),
    cell: fn(&Closeup, u32, u32) -> ArtCell,
) -> Vec<ArtCell> {
    let size = closeup.size();
    let rows = (0..size.y / high).flat_map(|row| (0..size.x / wide).map(move |column| (column, row)));
    rows.map(|(column, row)| cell(closeup, column * wide, row * high)).collect()
}

/// Quarter blocks by which of top right, bottom left, bottom right have the ink's colour; top left never has.
const QUARTERS: [char; 8] = [' ', '▝', '▖', '▞', '▗', '▐', '▄', '▟'];

/// The split of four pixels into two colours that changes them least.
fn quarters(closeup: &Closeup, left: u32, top: u32) -> ArtCell {
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
    ArtCell { symbol: QUARTERS[split], ink: (split > 0).then(|| byte(ink)), paper: Some(byte(paper)) }
}

fn halves(closeup: &Closeup, column: u32, row: u32) -> ArtCell {
    let [paper, ink] = [row, row + 1].map(|row| closeup.picture().get_pixel(column, row).0);
    ArtCell { symbol: '▄', ink: Some(ink), paper: Some(paper) }
}

fn plain(closeup: &Closeup, column: u32, row: u32) -> ArtCell {
    ArtCell { symbol: ' ', ink: None, paper: Some(closeup.picture().get_pixel(column, row).0) }
}

/// Characters from dark to bright; `#` is left for outlines.
const SHADES: [char; 7] = [' ', '.', ':', '-', '=', '+', '*'];

fn shade(closeup: &Closeup, column: u32, row: u32) -> ArtCell {
    let bright = luminance(closeup, column, row);
    let symbol = match closeup.stroke(column, row) {
        Stroke::Light => '#',
        Stroke::Dark => ' ',
        Stroke::None => SHADES[(bright * SHADES.len() as f32) as usize % SHADES.len()],
    };
    ArtCell { symbol, ink: None, paper: None }
}

/// Brightness in [0, 1).
fn luminance(closeup: &Closeup, column: u32, row: u32) -> f32 {
    let [red, green, blue] = closeup.picture().get_pixel(column, row).0.map(f32::from);
    (0.299 * red + 0.587 * green + 0.114 * blue) / 256.0
}

/// Braille: eight dots a cell, dithered by error diffusion. Outlines are solid quarter blocks, which no dots can be
/// taken for, and have a dark seam around them.
fn dots(closeup: &Closeup) -> Vec<ArtCell> {
    let lit = diffused(closeup);
    let width = closeup.size().x;
    let is_light = |column: u32, row: u32| closeup.stroke(column, row) == Stroke::Light;
    let cell = |left: u32, top: u32| {
        let quarter = |right: u32, down: u32| (0..2).any(|row| is_light(left + right, top + 2 * down + row));
        let quarters = [quarter(0, 0), quarter(1, 0), quarter(0, 1), quarter(1, 1)];
        let symbol = if quarters.contains(&true) {
            let bits = quarters.iter().rev().fold(0, |bits, &light| bits << 1 | usize::from(light));
            SOLID[bits]
        } else {
            let dot = |right: u32, down: u32| lit[((top + down) * width + left + right) as usize];
            braille(dot)
        };
        ArtCell { symbol, ink: None, paper: None }
    };
    let (columns, rows) = (width / 2, closeup.size().y / 4);
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .map(|(c, r)| cell(2 * c, 4 * r))
        .collect()
}

/// Quarter blocks by which of top left, top right, bottom left, bottom right are solid.
const SOLID: [char; 16] = [' ', '▘', '▝', '▀', '▖', '▌', '▞', '▛', '▗', '▚', '▐', '▜', '▄', '▙', '▟', '█'];

fn braille(dot: impl Fn(u32, u32) -> bool) -> char {
    // Bits of U+2800, by column and row of the dot.
    const BITS: [[u32; 4]; 2] = [[0, 1, 2, 6], [3, 4, 5, 7]];
    let mut bits = 0;
    for (right, column) in (0..).zip(BITS) {
        for (down, bit) in (0..).zip(column) {
            bits |= u32::from(dot(right, down)) << bit;
        }
    }
    char::from_u32(0x2800 + bits).unwrap_or(' ')
}

/// What lies around objects is darkened more than they are: they are what is looked for.
const OBJECT_STRENGTH: f32 = 0.8;
const GROUND_STRENGTH: f32 = 0.45;

/// Floyd and Steinberg's dithering of the stretched brightness.
fn diffused(closeup: &Closeup) -> Vec<bool> {
    let size = closeup.size();
    let (width, height) = (size.x as usize, size.y as usize);
    let mut bright: Vec<f32> = (0..size.y)
        .flat_map(|y| (0..size.x).map(move |x| (x, y)))
        .map(|(x, y)| luminance(closeup, x, y))
        .collect();
    let mut sorted = bright.clone();
    sorted.sort_by(f32::total_cmp);
    let share = |share: usize| sorted[(sorted.len() - 1) * share / 100];
    let (dark, light) = (share(3), share(97).max(share(3) + 0.05));
    for (index, value) in bright.iter_mut().enumerate() {
        let is_object = OBJECT_IDS.contains(&closeup.id(index as u32 % size.x, index as u32 / size.x));
        let strength = if is_object { OBJECT_STRENGTH } else { GROUND_STRENGTH };
        *value = ((*value - dark) / (light - dark)).clamp(0.0, 1.0) * strength;
    }
    let mut lit = vec![false; bright.len()];
    for index in 0..bright.len() {
        let (x, y) = (index % width, index / width);
        match closeup.stroke(x as u32, y as u32) {
            Stroke::Light => lit[index] = true,
            Stroke::Dark => {}
            Stroke::None => {
                lit[index] = bright[index] > 0.5;
                let error = bright[index] - f32::from(u8::from(lit[index]));
                let mut give = |inside: bool, target: usize, share: f32| {
                    if inside {
                        bright[target] += error * share / 16.0;
                    }
                };
                let (right, below) = (x + 1 < width, y + 1 < height);
                give(right, index + 1, 7.0);
                give(below && x > 0, (index + width).saturating_sub(1), 3.0);
                give(below, index + width, 5.0);
                give(below && right, index + width + 1, 1.0);
            }
        }
    }
    lit
}

/// The nearest of the 256 colours of xterm, without the first 16, which users change.
pub(crate) fn palette_index([red, green, blue]: [u8; 3]) -> u8 {
    const STEPS: [i32; 6] = [0, 95, 135, 175, 215, 255];
    let nearest = |value: u8| (0..6).min_by_key(|&step| (STEPS[step] - i32::from(value)).abs()).unwrap_or(0);
    let distance = |other: [i32; 3]| {
        let own = [red, green, blue].map(i32::from);
        (0..3).map(|channel| (own[channel] - other[channel]).pow(2)).sum::<i32>()
    };
    let cube = [red, green, blue].map(nearest);
    let mean = (i32::from(red) + i32::from(green) + i32::from(blue)) / 3;
    let grey = ((mean - 8 + 5) / 10).clamp(0, 23);
    if distance([8 + 10 * grey; 3]) < distance(cube.map(|step| STEPS[step])) {
        232 + grey as u8
    } else {
        (16 + 36 * cube[0] + 6 * cube[1] + cube[2]) as u8
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use l4d_frames::closeup::RgbImage;
    use l4d_masks::mask::PixelBox;

    use super::*;
    use crate::look::{Environment, Medium};

    fn look(unicode: bool, colours: Colours) -> Look {
        let environment = Environment { term: "xterm".to_owned(), ..Environment::default() };
        Look { unicode, colours, medium: Medium::Characters, ..environment.look().unwrap() }
    }

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
        let look = look(true, Colours::Full);
        let cell = |pixels: [[u8; 3]; 4]| cells(&closeup(2, &pixels), &look)[0];
        assert_eq!(cell([dark; 4]), ArtCell { symbol: ' ', ink: None, paper: Some(dark) });
        let expected = ArtCell { symbol: '▐', ink: Some(red), paper: Some(dark) };
        assert_eq!(cell([dark, red, dark, red]), expected);
        let expected = ArtCell { symbol: '▟', ink: Some(dark), paper: Some(red) };
        assert_eq!(cell([red, dark, dark, dark]), expected);
    }

    #[test]
    fn half_blocks_show_two_pixels() {
        let (dark, red) = ([10; 3], [200, 0, 0]);
        let look = Look { quarters: false, ..look(true, Colours::Full) };
        let expected = ArtCell { symbol: '▄', ink: Some(red), paper: Some(dark) };
        assert_eq!((grain(&look), cells(&closeup(1, &[dark, red]), &look)), ((1, 2), vec![expected]));
    }

    #[test]
    fn dots_are_lit_where_it_is_bright() {
        let (black, white) = ([0; 3], [255; 3]);
        let pixels: Vec<[u8; 3]> = (0..16).map(|index| if index % 4 < 2 { white } else { black }).collect();
        let symbols: Vec<char> =
            cells(&closeup(4, &pixels), &look(true, Colours::None)).iter().map(|cell| cell.symbol).collect();
        let dots = |symbol: char| (symbol as u32 - 0x2800).count_ones();
        assert!(dots(symbols[0]) >= 5 && dots(symbols[1]) == 0, "{symbols:?}");
    }

    #[test]
    fn without_unicode_every_symbol_is_ascii() {
        let pixels: Vec<[u8; 3]> = (0..=255).map(|value| [value; 3]).collect();
        for colours in [Colours::None, Colours::Palette, Colours::Full] {
            assert!(
                cells(&closeup(16, &pixels), &look(false, colours)).iter().all(|cell| cell.symbol.is_ascii())
            );
        }
        let shades = cells(&closeup(16, &pixels), &look(false, Colours::None));
        assert_eq!((shades[0].symbol, shades[255].symbol), (' ', '*'));
    }

    #[test]
    fn palette_indices_are_those_of_xterm() {
        assert_eq!(palette_index([0, 0, 0]), 16);
        assert_eq!(palette_index([255, 255, 255]), 231);
        assert_eq!(palette_index([128, 128, 128]), 244);
        assert_eq!(palette_index([255, 0, 0]), 196);
        assert_eq!(palette_index([0, 95, 135]), 24);
    }
}
