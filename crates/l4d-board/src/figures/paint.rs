//! Drawings become SVG and PNG. The only module that knows plotters.
//!
//! plotters works in whole pixels, so both media are painted on a grid of [`GRID`] units to a print pixel: the SVG
//! says so in its viewBox, the PNG is averaged down to twice the print size, which also smooths its edges.

use std::fmt::Display;
use std::sync::OnceLock;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder as _};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::drawing::{Anchor, Colour, Drawing, Lettering, PAPER, Shape, WIDTH};
use super::lettering::{self, Weight};
use crate::error::BoardError;

/// Units of the grid in a print pixel.
const GRID: u32 = 4;
/// Pixels of a PNG in a print pixel.
pub(crate) const PNG_SCALE: u32 = 2;
/// SVG readers choose the font; the PNG has the embedded one under the same name.
const FAMILY: FontFamily<'static> = FontFamily::SansSerif;

/// The drawing as an SVG document whose text is text, with a title and a description for those who don't see it.
pub(crate) fn svg(figure: &str, drawing: &Drawing) -> Result<String, BoardError> {
    let (width, height) = print_size(drawing);
    let (grid_width, grid_height) = (width * GRID, height * GRID);
    let mut document = String::new();
    let area = SVGBackend::with_string(&mut document, (grid_width, grid_height)).into_drawing_area();
    Painter { area: &area, medium: Medium::Svg }.paint(drawing).map_err(|error| failed(figure, error))?;
    drop(area);
    let on_grid = format!("<svg width=\"{grid_width}\" height=\"{grid_height}\"");
    let in_print = format!("<svg role=\"img\" width=\"{width}\" height=\"{height}\"");
    let document = document.replacen(&on_grid, &in_print, 1);
    let (root, shapes) = document.split_once('\n').ok_or_else(|| failed(figure, "the SVG has no root"))?;
    let (title, about) = (escaped(&drawing.title), escaped(&drawing.about));
    Ok(format!("{root}\n<title>{title}</title>\n<desc>{about}</desc>\n{shapes}"))
}

/// The drawing as a PNG of twice the print size.
pub(crate) fn png(figure: &str, drawing: &Drawing) -> Result<Vec<u8>, BoardError> {
    let (width, height) = print_size(drawing);
    let (grid_width, grid_height) = (width * GRID, height * GRID);
    let mut fine = vec![0; (grid_width * grid_height * 3) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut fine, (grid_width, grid_height)).into_drawing_area();
        Painter { area: &area, medium: Medium::Bitmap }
            .paint(drawing)
            .map_err(|error| failed(figure, error))?;
    }
    let (width, height) = (width * PNG_SCALE, height * PNG_SCALE);
    let coarse = average_down(&fine, width as usize, height as usize);
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&coarse, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| failed(figure, error))?;
    Ok(bytes)
}

fn print_size(drawing: &Drawing) -> (u32, u32) {
    (WIDTH as u32, drawing.height.ceil() as u32)
}

fn failed(figure: &str, error: impl Display) -> BoardError {
    BoardError::Figure { figure: figure.to_owned(), message: error.to_string() }
}

/// Means of squares of pixels, RGB.
fn average_down(fine: &[u8], width: usize, height: usize) -> Vec<u8> {
    let factor = (GRID / PNG_SCALE) as usize;
    let row_bytes = width * factor * 3;
    let mut coarse = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let mut sum = 0;
                for dy in 0..factor {
                    for dx in 0..factor {
                        sum += usize::from(
                            fine[(y * factor + dy) * row_bytes + (x * factor + dx) * 3 + channel],
                        );
                    }
                }
                coarse.push(((sum + factor * factor / 2) / (factor * factor)) as u8);
            }
        }
    }
    coarse
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Medium {
    Svg,
    Bitmap,
}

impl Medium {
    /// plotters' font size for an em of one unit: SVG divides it by 1.24, the bitmap fits ascent plus descent.
    fn size_of_em(self) -> f64 {
        match self {
            Self::Svg => 1.24,
            Self::Bitmap => 1.21,
        }
    }

    /// How far below the position that plotters is given the baseline of text anchored at its top lies, in em.
    fn baseline_below_top(self) -> f64 {
        match self {
            Self::Svg => 0.76,
            Self::Bitmap => 1.21 / 2.0,
        }
    }
}

struct Painter<'a, DB: DrawingBackend> {
    area: &'a DrawingArea<DB, Shift>,
    medium: Medium,
}

type Painted<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

impl<DB: DrawingBackend> Painter<'_, DB> {
    fn paint(&self, drawing: &Drawing) -> Painted<DB> {
        register_fonts();
        self.area.fill(&colour(PAPER))?;
        for shape in &drawing.shapes {
            match shape {
                Shape::Bar { x, y, width, height, fill } => {
                    let corners = [grid(*x, *y), grid(x + width, y + height)];
                    self.area.draw(&Rectangle::new(corners, colour(*fill).filled()))?;
                }
                Shape::Line { points, width, colour: stroke } => {
                    let points: Vec<(i32, i32)> = points.iter().map(|&(x, y)| grid(x, y)).collect();
                    let width = (width * f64::from(GRID)).round().max(1.0) as u32;
                    match self.medium {
                        Medium::Svg => {
                            self.area.draw(&PathElement::new(points, colour(*stroke).stroke_width(width)))?;
                        }
                        Medium::Bitmap => self.stroke(&points, width as i32, colour(*stroke))?,
                    }
                }
                Shape::Dot { x, y, radius, fill } => {
                    let radius = (radius * f64::from(GRID)).round() as i32;
                    self.area.draw(&Circle::new(grid(*x, *y), radius, colour(*fill).filled()))?;
                }
                Shape::Polygon { points, fill } => {
                    let points: Vec<(i32, i32)> = points.iter().map(|&(x, y)| grid(x, y)).collect();
                    self.area.draw(&Polygon::new(points, colour(*fill).filled()))?;
                }
                Shape::Text { x, baseline, text, lettering } => self.text(*x, *baseline, text, *lettering)?,
            }
        }
        self.area.present()
    }

    /// A line of straight pieces with round joints. plotters bends the ends of thick bitmap paths.
    fn stroke(&self, points: &[(i32, i32)], width: i32, ink: RGBColor) -> Painted<DB> {
        let (before, after) = (width / 2, width - width / 2);
        for pair in points.windows(2) {
            let ((x1, y1), (x2, y2)) = (pair[0], pair[1]);
            if y1 == y2 {
                let corners = [(x1.min(x2), y1 - before), (x1.max(x2), y1 + after)];
                self.area.draw(&Rectangle::new(corners, ink.filled()))?;
            } else if x1 == x2 {
                let corners = [(x1 - before, y1.min(y2)), (x1 + after, y1.max(y2))];
                self.area.draw(&Rectangle::new(corners, ink.filled()))?;
            } else {
                self.area.draw(&Polygon::new(around_segment(pair[0], pair[1], f64::from(width)), ink))?;
            }
        }
        if width > 3 {
            for &joint in points.get(1..points.len().saturating_sub(1)).unwrap_or_default() {
                self.area.draw(&Circle::new(joint, before, ink.filled()))?;
            }
        }
        Ok(())
    }

    fn text(&self, x: f64, baseline: f64, text: &str, lettering: Lettering) -> Painted<DB> {
        let Lettering { size, weight, colour: ink, anchor } = lettering;
        let style = match weight {
            Weight::Regular => FontStyle::Normal,
            Weight::Bold => FontStyle::Bold,
        };
        let horizontal = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let em = size * f64::from(GRID);
        let ink = colour(ink);
        let style = TextStyle::from((FAMILY, em * self.medium.size_of_em(), style))
            .color(&ink)
            .pos(Pos::new(horizontal, VPos::Top));
        let position = grid(x, baseline - self.medium.baseline_below_top() * size);
        self.area.draw(&Text::new(printable(text), position, style))
    }
}

/// XML has no control characters and no noncharacters, and a picture has no use for them.
fn printable(text: &str) -> String {
    let is_allowed = |letter: char| !letter.is_control() && !matches!(letter, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|letter| if is_allowed(letter) { letter } else { ' ' }).collect()
}

fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The corners of a segment that is `width` thick.
fn around_segment((x1, y1): (i32, i32), (x2, y2): (i32, i32), width: f64) -> [(i32, i32); 4] {
    let (along_x, along_y) = (f64::from(x2 - x1), f64::from(y2 - y1));
    let half = width / 2.0 / along_x.hypot(along_y);
    let aside = |x: i32, y: i32, side: f64| {
        let (x, y) = (f64::from(x) - side * along_y * half, f64::from(y) + side * along_x * half);
        (x.round() as i32, y.round() as i32)
    };
    [aside(x1, y1, 1.0), aside(x2, y2, 1.0), aside(x2, y2, -1.0), aside(x1, y1, -1.0)]
}

fn register_fonts() {
    static ONCE: OnceLock<()> = OnceLock::new();
    ONCE.get_or_init(|| {
        for (style, bytes) in [(FontStyle::Normal, lettering::REGULAR), (FontStyle::Bold, lettering::BOLD)] {
            // A font that does not parse shows as plotters' own error at the first text.
            register_font(FAMILY.as_str(), style, bytes).ok();
        }
    });
}

fn grid(x: f64, y: f64) -> (i32, i32) {
    ((x * f64::from(GRID)).round() as i32, (y * f64::from(GRID)).round() as i32)
}

fn colour((red, green, blue): Colour) -> RGBColor {
    RGBColor(red, green, blue)
}
