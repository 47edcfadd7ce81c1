//! A picture as a list of shapes in print pixels (96 to the inch), y down. Knows nothing of files and backends.

use l4d_data::results::Track;

use super::lettering::{self, Weight};
use crate::rank::Board;

/// Width of every figure: two columns of a paper.
pub(crate) const WIDTH: f64 = 720.0;
/// Free space at the edges.
pub(crate) const MARGIN: f64 = 14.0;

/// sRGB.
pub(crate) type Colour = (u8, u8, u8);

pub(crate) const INK: Colour = (0x22, 0x22, 0x22);
pub(crate) const QUIET: Colour = (0x66, 0x66, 0x66);
pub(crate) const AXIS: Colour = (0x99, 0x99, 0x99);
pub(crate) const GRID: Colour = (0xE4, 0xE4, 0xE4);
pub(crate) const SHADE: Colour = (0xB4, 0xB4, 0xB4);
pub(crate) const PAPER: Colour = (0xFF, 0xFF, 0xFF);

// Okabe and Ito's palette without yellow and black, which thin lines on white do not carry.
pub(crate) const BLUE: Colour = (0x00, 0x72, 0xB2);
pub(crate) const VERMILLION: Colour = (0xD5, 0x5E, 0x00);
pub(crate) const GREEN: Colour = (0x00, 0x9E, 0x73);
pub(crate) const PURPLE: Colour = (0xCC, 0x79, 0xA7);
pub(crate) const ORANGE: Colour = (0xE6, 0x9F, 0x00);
pub(crate) const SKY: Colour = (0x56, 0xB4, 0xE9);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lettering {
    pub(crate) size: f64,
    pub(crate) weight: Weight,
    pub(crate) colour: Colour,
    pub(crate) anchor: Anchor,
}

impl Lettering {
    pub(crate) const TITLE: Self = Self::new(14.0, Weight::Bold, INK);
    pub(crate) const HEAD: Self = Self::new(11.0, Weight::Bold, INK);
    pub(crate) const LABEL: Self = Self::new(11.0, Weight::Regular, INK);
    pub(crate) const NOTE: Self = Self::new(10.0, Weight::Regular, QUIET);
    pub(crate) const NUMBER: Self = Self::new(10.0, Weight::Regular, INK);

    const fn new(size: f64, weight: Weight, colour: Colour) -> Self {
        Self { size, weight, colour, anchor: Anchor::Start }
    }

    pub(crate) const fn anchored(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(crate) const fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    pub(crate) const fn bold(self) -> Self {
        Self { weight: Weight::Bold, ..self }
    }

    pub(crate) fn width(self, text: &str) -> f64 {
        lettering::width(text, self.size, self.weight)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    Bar { x: f64, y: f64, width: f64, height: f64, fill: Colour },
    Line { points: Vec<(f64, f64)>, width: f64, colour: Colour },
    Dot { x: f64, y: f64, radius: f64, fill: Colour },
    Polygon { points: Vec<(f64, f64)>, fill: Colour },
    Text { x: f64, baseline: f64, text: String, lettering: Lettering },
}

/// Shapes of points: series stay apart without their colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Wedge,
}

impl Marker {
    /// In the order in which series take them.
    pub(crate) const ALL: [Self; 5] =
        [Self::Circle, Self::Square, Self::Triangle, Self::Diamond, Self::Wedge];
}

/// Which way the stripes of a bar run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hatch {
    Rising,
    Falling,
    Upright,
}

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Extent {
    pub(crate) fn overlaps(self, other: Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    pub(crate) fn holds(self, other: Self) -> bool {
        self.left <= other.left
            && self.top <= other.top
            && self.right >= other.right
            && self.bottom >= other.bottom
    }

    /// Where a line of text stands, with room for the widest usual sans-serif.
    pub(crate) fn of_text(x: f64, baseline: f64, text: &str, lettering: Lettering) -> Self {
        let width = lettering.width(text);
        let left = match lettering.anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        };
        let (top, bottom) = (baseline - 0.78 * lettering.size, baseline + 0.24 * lettering.size);
        Self { left, top, right: left + width, bottom }
    }
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawing {
    pub(crate) title: String,
    /// What it shows, in words.
    pub(crate) about: String,
    pub(crate) height: f64,
    pub(crate) shapes: Vec<Shape>,
}

impl Drawing {
    /// An empty picture with its title and what the board is of. Gives the first free baseline below.
    pub(crate) fn titled(title: &str, board: &Board, notes: &[String]) -> (Self, f64) {
        Self::headed(title, &[&[board.heading.line()], notes].concat())
    }

    /// An empty picture with its title and lines of notes. Gives the first free baseline below.
    pub(crate) fn headed(title: &str, notes: &[String]) -> (Self, f64) {
        let mut drawing =
            Self { title: title.to_owned(), about: notes.join(" "), height: 0.0, shapes: Vec::new() };
        let fits = |line: &str, lettering: Lettering| lettering.width(line) <= WIDTH - 2.0 * MARGIN;
        let titles = lettering::wrap(title, |line| fits(line, Lettering::TITLE), " _-.");
        drawing.lines(MARGIN, MARGIN + 12.0, &titles, Lettering::TITLE);
        let mut baseline = MARGIN + 12.0 + (titles.len() as f64 - 1.0) * leading(Lettering::TITLE);
        for note in notes {
            for line in lettering::wrap(note, |line| fits(line, Lettering::NOTE), " ") {
                baseline += 15.0;
                drawing.text(MARGIN, baseline, &line, Lettering::NOTE);
            }
        }
        (drawing, baseline)
    }

    pub(crate) fn text(&mut self, x: f64, baseline: f64, text: &str, lettering: Lettering) {
        self.shapes.push(Shape::Text { x, baseline, text: text.to_owned(), lettering });
    }

    /// Clears the grid behind a line of text.
    pub(crate) fn knock_out(&mut self, x: f64, baseline: f64, text: &str, lettering: Lettering) {
        let Extent { left, top, right, bottom } = Extent::of_text(x, baseline, text, lettering);
        self.bar(left, top, right - left, bottom - top, PAPER);
    }

    /// Lines of text, the first at `baseline`.
    pub(crate) fn lines(&mut self, x: f64, baseline: f64, lines: &[String], lettering: Lettering) {
        for (index, line) in lines.iter().enumerate() {
            self.text(x, baseline + index as f64 * leading(lettering), line, lettering);
        }
    }

    pub(crate) fn bar(&mut self, x: f64, y: f64, width: f64, height: f64, fill: Colour) {
        self.shapes.push(Shape::Bar { x, y, width, height, fill });
    }

    pub(crate) fn line(&mut self, points: impl IntoIterator<Item = (f64, f64)>, width: f64, colour: Colour) {
        self.shapes.push(Shape::Line { points: points.into_iter().collect(), width, colour });
    }

    /// A straight line in dashes.
    pub(crate) fn dashes(&mut self, from: (f64, f64), to: (f64, f64), width: f64, colour: Colour) {
        self.dash_by(4.0, from, to, width, colour);
    }

    fn dash_by(&mut self, dash: f64, from: (f64, f64), to: (f64, f64), width: f64, colour: Colour) {
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let at = |along: f64| {
            let share = (along / length).min(1.0);
            (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1))
        };
        let mut along = 0.0;
        while along < length {
            self.line([at(along), at(along + dash)], width, colour);
            along += 2.0 * dash;
        }
    }

    pub(crate) fn dot(&mut self, x: f64, y: f64, radius: f64, fill: Colour) {
        self.shapes.push(Shape::Dot { x, y, radius, fill });
    }

    pub(crate) fn polygon(&mut self, points: impl IntoIterator<Item = (f64, f64)>, fill: Colour) {
        self.shapes.push(Shape::Polygon { points: points.into_iter().collect(), fill });
    }

    /// A point of a series, about as large as a dot of this radius.
    pub(crate) fn marker(&mut self, marker: Marker, (x, y): (f64, f64), radius: f64, fill: Colour) {
        let r = radius;
        match marker {
            Marker::Circle => self.dot(x, y, r, fill),
            Marker::Square => self.bar(x - 0.88 * r, y - 0.88 * r, 1.76 * r, 1.76 * r, fill),
            Marker::Triangle => {
                self.polygon(
                    [(x, y - 1.2 * r), (x + 1.1 * r, y + 0.8 * r), (x - 1.1 * r, y + 0.8 * r)],
                    fill,
                );
            }
            Marker::Diamond => {
                self.polygon([(x, y - 1.3 * r), (x + 1.3 * r, y), (x, y + 1.3 * r), (x - 1.3 * r, y)], fill);
            }
            Marker::Wedge => {
                self.polygon(
                    [(x, y + 1.2 * r), (x - 1.1 * r, y - 0.8 * r), (x + 1.1 * r, y - 0.8 * r)],
                    fill,
                );
            }
        }
    }

    /// From `low` to `high` with ends across: an interval, lying or upright; in dashes where it is not to be trusted.
    pub(crate) fn whisker(&mut self, low: (f64, f64), high: (f64, f64), is_dashed: bool, colour: Colour) {
        const HALF: f64 = 2.5;
        match is_dashed {
            true => self.dash_by(2.0, low, high, 1.0, colour),
            false => self.line([low, high], 1.0, colour),
        }
        let is_lying = (low.1 - high.1).abs() < (low.0 - high.0).abs() || low == high;
        for (x, y) in [low, high] {
            let ends = if is_lying { [(x, y - HALF), (x, y + HALF)] } else { [(x - HALF, y), (x + HALF, y)] };
            self.line(ends, 1.0, colour);
        }
    }

    /// Stripes over a rectangle that was filled before.
    pub(crate) fn stripes(&mut self, extent: Extent, hatch: Hatch, colour: Colour) {
        const PITCH: f64 = 4.0;
        let Extent { left, top, right, bottom } = extent;
        let (width, height) = (right - left, bottom - top);
        let count = ((width + height) / PITCH) as usize;
        for index in 1..=count {
            let along = index as f64 * PITCH;
            // Where the diagonal that starts `along` the left and lower edges enters and leaves, from the lower left.
            let enter = (f64::max(along - height, 0.0), f64::min(along, height));
            let leave = (f64::min(along, width), f64::max(along - width, 0.0));
            match hatch {
                Hatch::Upright if along < width => {
                    self.line([(left + along, top), (left + along, bottom)], 0.75, colour);
                }
                Hatch::Upright => {}
                Hatch::Falling => {
                    let ends = [(left + enter.0, bottom - enter.1), (left + leave.0, bottom - leave.1)];
                    self.line(ends, 0.75, colour);
                }
                Hatch::Rising => {
                    let ends = [(left + enter.0, top + enter.1), (left + leave.0, top + leave.1)];
                    self.line(ends, 0.75, colour);
                }
            }
        }
    }

    /// The mark of a method in a scatter: full where it is ranked, of a shape for each track, and a ring where it is not.
    pub(crate) fn mark(&mut self, x: f64, y: f64, ranked_in: Option<Track>) {
        self.dot(x, y, 5.0, PAPER);
        match ranked_in {
            Some(Track::Colour) => self.dot(x, y, 4.0, BLUE),
            Some(Track::ColourDepth) => self.marker(Marker::Diamond, (x, y), 3.8, BLUE),
            None => {
                self.dot(x, y, 4.0, QUIET);
                self.dot(x, y, 2.6, PAPER);
            }
        }
    }
}

/// Distance of baselines.
pub(crate) fn leading(lettering: Lettering) -> f64 {
    (lettering.size * 1.22).round()
}
