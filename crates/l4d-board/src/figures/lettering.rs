//! How wide text is and where it breaks.
//!
//! Widths are those of the embedded font plus an allowance: an SVG is shown in whatever sans-serif the reader
//! has, and the widest usual one (DejaVu Sans) is at most a tenth wider.

use std::sync::OnceLock;

use ab_glyph::{Font as _, FontRef};

pub(crate) const REGULAR: &[u8] = include_bytes!("../../assets/inter-regular.otf");
pub(crate) const BOLD: &[u8] = include_bytes!("../../assets/inter-bold.otf");

const ALLOWANCE: f64 = 1.1;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    Bold,
}

/// Width of a line of text at a font size, with the allowance for other fonts.
pub(crate) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let font = face(weight);
    let units = text.chars().map(|letter| font.h_advance_unscaled(font.glyph_id(letter))).sum::<f32>();
    f64::from(units) / f64::from(font.units_per_em().unwrap_or(1000.0)) * size * ALLOWANCE
}

/// Breaks text so that each line fits, after one of the `seams` where there is one in the later half of a line,
/// else between any two letters. No letter is lost but the spaces at breaks.
pub(crate) fn wrap(text: &str, fits: impl Fn(&str) -> bool, seams: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut rest = text;
    while !fits(rest) {
        let mut ends: Vec<usize> = rest.char_indices().map(|(index, _)| index).skip(1).collect();
        ends.retain(|&end| fits(rest[..end].trim_end()));
        let Some(&longest) = ends.last() else { break };
        let seam =
            ends.iter().rev().find(|&&end| end * 3 > longest && rest[..end].ends_with(|c| seams.contains(c)));
        let (line, tail) = rest.split_at(*seam.unwrap_or(&longest));
        lines.push(line.trim_end().to_owned());
        rest = tail.trim_start();
    }
    lines.push(rest.to_owned());
    lines
}

/// Breaks a method's name at `_`, `-` or `.`.
pub(crate) fn wrap_name(name: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    wrap(name, fits, "_-.")
}

fn face(weight: Weight) -> &'static FontRef<'static> {
    static FACES: OnceLock<[FontRef<'static>; 2]> = OnceLock::new();
    let load = |bytes| FontRef::try_from_slice(bytes).expect("the embedded font is a font");
    let [regular, bold] = FACES.get_or_init(|| [load(REGULAR), load(BOLD)]);
    match weight {
        Weight::Regular => regular,
        Weight::Bold => bold,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_follow_the_font() {
        let digit = width("0", 100.0, Weight::Regular);
        assert!((50.0..75.0).contains(&digit), "{digit}");
        assert!((width("00", 10.0, Weight::Regular) - digit / 5.0).abs() < 1e-4);
        assert!(width("method", 10.0, Weight::Bold) > width("method", 10.0, Weight::Regular));
    }

    #[test]
    fn names_break_at_seams_and_lose_nothing() {
        let lines = wrap_name("panopticquery-robust_no.consensus", |line| line.len() <= 14);
        assert_eq!(lines, ["panopticquery-", "robust_no.", "consensus"]);
        assert_eq!(wrap_name(&"x".repeat(80), |line| line.len() <= 30).concat(), "x".repeat(80));
        assert_eq!(wrap("one two three", |line| line.len() <= 7, " "), ["one two", "three"]);
        assert_eq!(wrap("never", |_| false, " "), ["never"]);
    }
}
