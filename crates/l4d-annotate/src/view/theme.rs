//! Styles and colours.

use ratatui::style::{Color, Modifier, Style};

use crate::art::palette_index;
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
