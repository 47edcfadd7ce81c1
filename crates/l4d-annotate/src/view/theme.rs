//! Styles and colours.

use ratatui::style::{Color, Modifier, Style};

use crate::look::Colours;

/// What matters most.
pub(super) fn strong() -> Style {
    Style::new().add_modifier(Modifier::BOLD)
}

/// What matters less.
pub(super) fn dim() -> Style {
    Style::new().add_modifier(Modifier::DIM)
}

/// What is marked in a list or wants attention.
pub(super) fn marked() -> Style {
    Style::new().add_modifier(Modifier::REVERSED)
}

/// A number of an object, on a patch of its colour; white when it is chosen, as is its outline.
pub(super) fn number([red, green, blue]: [u8; 3], chosen: bool, colours: Colours) -> Style {
    if colours == Colours::None {
        return if chosen { strong().add_modifier(Modifier::REVERSED) } else { strong() };
    }
    let (black, white) = (Color::Rgb(0, 0, 0), Color::Rgb(255, 255, 255));
    if chosen {
        return strong().fg(black).bg(white);
    }
    let bright = 299 * u32::from(red) + 587 * u32::from(green) + 114 * u32::from(blue);
    strong().fg(if bright > 110_000 { black } else { white }).bg(Color::Rgb(red, green, blue))
}

/// A colour as the terminal takes it.
pub(super) fn shown(colour: Color, colours: Colours) -> Color {
    match (colour, colours) {
        (_, Colours::None) => Color::Reset,
        (Color::Rgb(red, green, blue), Colours::Palette) => Color::Indexed(palette_index([red, green, blue])),
        _ => colour,
    }
}

/// The nearest of the 256 colours of xterm, without the first 16, which users change: a cube of six steps, and greys.
fn palette_index(colour: [u8; 3]) -> u8 {
    const STEPS: [u8; 6] = [0, 95, 135, 175, 215, 255];
    let cube = (0..216).map(|index| {
        (16 + index, [index / 36, index / 6 % 6, index % 6].map(|step| STEPS[usize::from(step)]))
    });
    let greys = (0..24).map(|index| (232 + index, [8 + 10 * index; 3]));
    let distance = |other: [u8; 3]| {
        (0..3).map(|channel| u32::from(colour[channel].abs_diff(other[channel])).pow(2)).sum::<u32>()
    };
    cube.chain(greys).min_by_key(|(_, other)| distance(*other)).map_or(16, |(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::palette_index;

    #[test]
    fn palette_indices_are_those_of_xterm() {
        for (colour, index) in
            [([0; 3], 16), ([255; 3], 231), ([128; 3], 244), ([255, 0, 0], 196), ([0, 95, 135], 24)]
        {
            assert_eq!(palette_index(colour), index);
        }
    }
}
