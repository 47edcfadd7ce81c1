//! Letters on pictures: two weights of Open Sans, embedded as subsets (Latin-1 and a little punctuation).

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, Glyph, PxScale, ScaleFont as _, point};
use image::{Rgb, RgbImage};

/// Thickness of the letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    Regular,
    /// Headings and labels.
    Semibold,
}

/// How text looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    pub weight: Weight,
    /// Distance between lines, pixels; letters are smaller.
    pub size_px: f32,
    pub colour: Rgb<u8>,
}

static REGULAR: LazyLock<FontRef<'static>> =
    LazyLock::new(|| embedded(include_bytes!("../fonts/OpenSans-Regular.ttf")));
static SEMIBOLD: LazyLock<FontRef<'static>> =
    LazyLock::new(|| embedded(include_bytes!("../fonts/OpenSans-Semibold.ttf")));

fn embedded(bytes: &'static [u8]) -> FontRef<'static> {
    FontRef::try_from_slice(bytes).expect("the embedded font is a valid font")
}

impl Style {
    /// Advance width of a line, pixels.
    pub fn width_px(&self, text: &str) -> f32 {
        self.glyphs(text).1
    }

    /// Writes a line whose top left corner is at (`x`, `y`); gives the x where it ends.
    pub fn write(&self, picture: &mut RgbImage, x: f32, y: f32, text: &str) -> f32 {
        let (glyphs, width) = self.glyphs(text);
        let baseline = y + self.font().as_scaled(PxScale::from(self.size_px)).ascent();
        for glyph in glyphs {
            let Some(outline) = self.font().outline_glyph(glyph) else { continue };
            let bounds = outline.px_bounds();
            outline.draw(|column, row, coverage| {
                let place = (x + bounds.min.x + column as f32, baseline + bounds.min.y + row as f32);
                blend(picture, place, self.colour, coverage);
            });
        }
        x + width
    }

    /// Breaks text between words so that no line is wider than `limit_px`, unless a single word is.
    pub fn wrap(&self, text: &str, limit_px: f32) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width_px(&format!("{line} {word}")) <= limit_px => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.to_owned()),
            }
        }
        lines
    }

    fn font(&self) -> &'static FontRef<'static> {
        match self.weight {
            Weight::Regular => &REGULAR,
            Weight::Semibold => &SEMIBOLD,
        }
    }

    fn glyphs(&self, text: &str) -> (Vec<Glyph>, f32) {
        let font = self.font().as_scaled(PxScale::from(self.size_px));
        let mut x = 0.0;
        let mut previous = None;
        let mut glyphs = Vec::new();
        for letter in text.chars() {
            let id = font.glyph_id(letter);
            x += previous.map_or(0.0, |previous| font.kern(previous, id));
            glyphs.push(id.with_scale_and_position(PxScale::from(self.size_px), point(x, 0.0)));
            x += font.h_advance(id);
            previous = Some(id);
        }
        (glyphs, x)
    }
}

/// Mixes a colour into a pixel; places outside the picture are ignored.
pub fn blend(picture: &mut RgbImage, (x, y): (f32, f32), colour: Rgb<u8>, coverage: f32) {
    let inside = x >= 0.0 && y >= 0.0 && x < picture.width() as f32 && y < picture.height() as f32;
    if !inside {
        return;
    }
    let pixel = picture.get_pixel_mut(x as u32, y as u32);
    for (under, over) in pixel.0.iter_mut().zip(colour.0) {
        let mixed = f32::from(*under) + (f32::from(over) - f32::from(*under)) * coverage.clamp(0.0, 1.0);
        *under = mixed.round() as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STYLE: Style = Style { weight: Weight::Regular, size_px: 20.0, colour: Rgb([0, 0, 0]) };

    #[test]
    fn text_leaves_ink_where_it_says() {
        let mut picture = RgbImage::from_pixel(100, 30, Rgb([255; 3]));
        let end = STYLE.write(&mut picture, 5.0, 2.0, "Hi");
        let inked = |range: std::ops::Range<u32>| {
            range.clone().any(|column| (0..30).any(|row| picture.get_pixel(column, row).0[0] < 100))
        };
        assert!(inked(5..end as u32) && !inked(0..5) && !inked(end.ceil() as u32 + 1..100));
    }

    #[test]
    fn wrapping_keeps_words_and_the_limit() {
        let text = "the woman who lifts the red bucket while the goat watches";
        let lines = STYLE.wrap(text, 150.0);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| STYLE.width_px(line) <= 150.0));
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn writing_beyond_the_edge_is_cut_off() {
        let mut picture = RgbImage::new(10, 10);
        STYLE.write(&mut picture, -8.0, -8.0, "WWWW");
        blend(&mut picture, (f32::NAN, 0.0), Rgb([9; 3]), 1.0);
        assert_eq!(picture.dimensions(), (10, 10));
    }
}
