//! Where plotters draws: a title, notes and one plot, as SVG and as PNG.
//!
//! plotters works in whole pixels, so both are drawn on a grid of [`UNIT`] units per print pixel: the SVG says so in its
//! viewBox, the PNG has twice the print size.

use std::sync::OnceLock;

use image::{ExtendedColorType, ImageEncoder as _};
use l4d_score::table::wrap;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::BoardError;

/// Width of every figure, print pixels (96 to the inch): two columns of a paper.
pub(crate) const WIDTH: u32 = 720;
/// Grid units per print pixel.
const UNIT: i32 = 2;
/// Free space at the edges, print pixels.
const MARGIN: i32 = 14;
/// Letters of a note in a line, at most.
const NOTE_LETTERS: usize = 118;

pub(crate) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
pub(crate) const QUIET: RGBColor = RGBColor(0x66, 0x66, 0x66);
pub(crate) const AXIS: RGBColor = RGBColor(0x99, 0x99, 0x99);
pub(crate) const GRID: RGBColor = RGBColor(0xE4, 0xE4, 0xE4);
pub(crate) const SHADE: RGBColor = RGBColor(0xB4, 0xB4, 0xB4);
// Okabe and Ito's palette without yellow and black, which thin lines on white do not carry.
pub(crate) const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xB2);
pub(crate) const VERMILLION: RGBColor = RGBColor(0xD5, 0x5E, 0x00);
pub(crate) const GREEN: RGBColor = RGBColor(0x00, 0x9E, 0x73);
pub(crate) const PURPLE: RGBColor = RGBColor(0xCC, 0x79, 0xA7);
pub(crate) const ORANGE: RGBColor = RGBColor(0xE6, 0x9F, 0x00);
pub(crate) const SKY: RGBColor = RGBColor(0x56, 0xB4, 0xE9);

pub(crate) type Area<DB> = DrawingArea<DB, Shift>;
pub(crate) type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub(crate) type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Something that can be drawn below a title and notes.
pub(crate) trait Plot {
    /// Print pixels.
    fn height(&self) -> i32;

    /// `area` is as high as it said.
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB>;
}

/// Grid units of print pixels.
pub(crate) const fn px(print: i32) -> i32 {
    print * UNIT
}

/// Letters of so many print pixels.
pub(crate) fn font(size: i32, colour: RGBColor) -> TextStyle<'static> {
    let mut style = TextStyle::from(("sans-serif", px(size)).into_font());
    style.color = colour.to_backend_color();
    style
}

pub(crate) fn bold(size: i32) -> TextStyle<'static> {
    let mut style = TextStyle::from(("sans-serif", px(size), FontStyle::Bold).into_font());
    style.color = INK.to_backend_color();
    style
}

/// Beside a point: vertically in its middle, ending, starting or centred there.
pub(crate) fn beside(style: TextStyle<'_>, horizontal: HPos) -> TextStyle<'_> {
    style.pos(Pos::new(horizontal, VPos::Center))
}

/// A name of at most so many letters: its start and its end.
pub(crate) fn shortened(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= most {
        return name.to_owned();
    }
    let tail = most / 3;
    let head = letters[..most - tail - 1].iter();
    head.chain(['…'].iter()).chain(&letters[letters.len() - tail..]).collect()
}

/// Axes in percent from 0 to 100 along x, rows along y.
pub(crate) fn percent_rows<DB: DrawingBackend>(
    area: &Area<DB>,
    rows: usize,
) -> Result<Chart<'_, DB>, DrawingAreaErrorKind<DB::ErrorType>> {
    let mut chart = ChartBuilder::on(area)
        .x_label_area_size(px(20))
        .build_cartesian_2d(0.0..100.0, 0.0..rows.max(1) as f64)?;
    let mut mesh = chart.configure_mesh();
    mesh.disable_y_mesh().disable_y_axis().x_labels(5).x_max_light_lines(0);
    mesh.bold_line_style(GRID.stroke_width(1)).axis_style(AXIS.stroke_width(2));
    mesh.label_style(font(10, QUIET)).x_label_formatter(&|value| format!("{value:.0}")).draw()?;
    Ok(chart)
}

/// Swatches and what they mean, from left to right at the top of an area.
pub(crate) fn legend<DB: DrawingBackend>(area: &Area<DB>, entries: &[(RGBColor, &str)]) -> Drawn<DB> {
    let style = beside(font(10, QUIET), HPos::Left);
    let mut x = 0;
    for (colour, text) in entries {
        area.draw(&Rectangle::new([(x, px(1)), (x + px(10), px(11))], colour.filled()))?;
        area.draw(&Rectangle::new([(x, px(1)), (x + px(10), px(11))], AXIS.stroke_width(1)))?;
        area.draw(&Text::new((*text).to_owned(), (x + px(14), px(7)), style.clone()))?;
        x += px(14 + 14) + area.estimate_text_size(text, &style)?.0 as i32;
    }
    Ok(())
}

/// Names in a column at `x`, each as high as its point or as near as there is room, with thin lines from the points.
/// Points are pixels of the area.
pub(crate) fn side_labels<DB: DrawingBackend>(
    area: &Area<DB>,
    mut labels: Vec<((i32, i32), String, RGBColor)>,
    x: i32,
    (top, bottom): (i32, i32),
) -> Drawn<DB> {
    let line = px(13);
    labels.sort_by_key(|((_, y), ..)| *y);
    let mut places: Vec<i32> = Vec::new();
    for ((_, y), ..) in &labels {
        places.push(places.last().map_or(*y, |above| (above + line).max(*y)).max(top));
    }
    let mut free_to = bottom;
    for place in places.iter_mut().rev() {
        *place = (*place).min(free_to);
        free_to = *place - line;
    }
    for ((point, name, colour), y) in labels.into_iter().zip(places) {
        let bend = vec![point, (x - px(8), y), (x - px(3), y)];
        area.draw(&PathElement::new(bend, SHADE.stroke_width(1)))?;
        area.draw(&Text::new(name, (x, y), beside(font(10, colour), HPos::Left)))?;
    }
    Ok(())
}

/// The files of a figure: names and bytes.
pub(crate) type Files = [(String, Vec<u8>); 2];

/// `<name>.svg` and `<name>.png`.
pub(crate) fn files(
    name: &str,
    title: &str,
    notes: &[String],
    plot: &impl Plot,
) -> Result<Files, BoardError> {
    register_fonts();
    let notes: Vec<String> = notes.iter().flat_map(|note| wrap(note, NOTE_LETTERS)).map(printable).collect();
    let titles: Vec<String> = wrap(title, 80).into_iter().map(printable).collect();
    let head = 20 * titles.len() as i32 + 15 * notes.len() as i32 + 12;
    let height = (head + plot.height() + 2 * MARGIN) as u32;
    let size = (WIDTH * UNIT as u32, height * UNIT as u32);
    let text = Heading { titles: &titles, notes: &notes, head };

    let mut document = String::new();
    draw(SVGBackend::with_string(&mut document, size), &text, plot)
        .map_err(|error| BoardError::render(name, error))?;
    let on_grid = format!("<svg width=\"{}\" height=\"{}\"", size.0, size.1);
    let in_print = format!("<svg role=\"img\" width=\"{WIDTH}\" height=\"{height}\"");
    let about = format!("<title>{}</title>\n<desc>{}</desc>\n", escaped(title), escaped(&notes.join(" ")));
    let svg = document.replacen(&on_grid, &in_print, 1).replacen('\n', &format!("\n{about}"), 1);

    let mut pixels = vec![0; (size.0 * size.1 * 3) as usize];
    draw(BitMapBackend::with_buffer(&mut pixels, size), &text, plot)
        .map_err(|error| BoardError::render(name, error))?;
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&pixels, size.0, size.1, ExtendedColorType::Rgb8)
        .map_err(|error| BoardError::render(name, error))?;
    Ok([(format!("{name}.svg"), svg.into_bytes()), (format!("{name}.png"), png)])
}

struct Heading<'a> {
    titles: &'a [String],
    notes: &'a [String],
    /// Print pixels that both take.
    head: i32,
}

fn draw<DB: DrawingBackend>(backend: DB, text: &Heading, plot: &impl Plot) -> Drawn<DB> {
    let area = backend.into_drawing_area();
    area.fill(&WHITE)?;
    let inner = area.margin(px(MARGIN), px(MARGIN), px(MARGIN), px(MARGIN));
    let mut y = 0;
    for title in text.titles {
        inner.draw(&Text::new(title.clone(), (0, y), bold(14)))?;
        y += px(20);
    }
    for note in text.notes {
        inner.draw(&Text::new(note.clone(), (0, y), font(10, QUIET)))?;
        y += px(15);
    }
    plot.draw(&inner.split_vertically(px(text.head)).1)?;
    area.present()
}

fn register_fonts() {
    static ONCE: OnceLock<()> = OnceLock::new();
    ONCE.get_or_init(|| {
        let fonts: [(FontStyle, &[u8]); 2] = [
            (FontStyle::Normal, include_bytes!("../../assets/inter-regular.otf")),
            (FontStyle::Bold, include_bytes!("../../assets/inter-bold.otf")),
        ];
        for (style, bytes) in fonts {
            // A font that does not parse shows as plotters' own error at the first text.
            register_font("sans-serif", style, bytes).ok();
        }
    });
}

/// XML has no control characters and no noncharacters, and a picture has no use for them.
pub(crate) fn printable(text: impl AsRef<str>) -> String {
    let is_allowed = |letter: char| !letter.is_control() && !matches!(letter, '\u{fffe}' | '\u{ffff}');
    text.as_ref().chars().map(|letter| if is_allowed(letter) { letter } else { ' ' }).collect()
}

fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
