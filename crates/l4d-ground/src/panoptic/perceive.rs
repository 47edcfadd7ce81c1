//! Things over a clip: where they are, and what pictures show of them.

use glam::DVec3;
use l4d_data::{Scale, Timeline};
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;

/// Things over a clip: what may be told of where they are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Perceived {
    /// Frames of the clip, ascending.
    pub(super) frames: Vec<u32>,
    /// When they were.
    pub(super) timeline: Timeline,
    /// Things, in an order that depends on the clip alone.
    pub(super) tracks: Vec<Track>,
    /// Size of the scene, as far as cameras can tell.
    pub(super) scale: Scale,
    /// Distance between the points of neighbouring pixels, metres; median over what is seen. Nothing is known finer.
    pub(super) spacing_m: f64,
    /// Where the camera is in the middle of the clip, metres, world.
    pub(super) eye: DVec3,
}

impl Perceived {
    /// The tracks of what is placed anywhere, with their numbers.
    pub(super) fn placed(&self) -> impl Iterator<Item = (usize, &Track)> + Clone {
        self.tracks.iter().enumerate().filter(|(_, track)| track.bodies.iter().any(Option::is_some))
    }
}

/// A thing over time: where it is in each frame of the clip; none where it isn't seen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track {
    pub(super) bodies: Vec<Option<Body>>,
}

/// Where a thing is at a moment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    /// Middle of what is known of its surface, metres, world.
    pub(super) centre: DVec3,
    /// Lowest corner of the box around it, metres, world axes.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// Some points of its surface, metres, world.
    pub(super) points: Vec<DVec3>,
    /// Whether no border of a picture cuts it.
    pub(super) is_whole: bool,
}

/// What one picture shows of a thing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Glimpse {
    /// Which of the things of its picture it is.
    pub(super) number: usize,
    /// Its pixels.
    pub(super) mask: Mask,
    /// Number of its pixels.
    pub(super) area_px: u64,
    /// The smallest box around its pixels.
    pub(super) bounds: PixelBox,
    /// Mean of its colours, CIE L*a*b*.
    pub(super) colour: [f32; 3],
    /// Where it is, as far as its visible surface tells.
    pub(super) body: Body,
}

impl Track {
    /// Longest side, metres: median over the frames in which it is seen whole, or seen at all.
    pub(super) fn longest_m(&self) -> f64 {
        let seen = || self.bodies.iter().flatten();
        let whole: Vec<f64> = seen().filter(|body| body.is_whole).map(Body::longest_m).collect();
        median(if whole.is_empty() { seen().map(Body::longest_m).collect() } else { whole })
    }

    /// Where it is at a frame, or where it was seen last before or first after.
    pub(super) fn nearest(&self, index: usize) -> Option<&Body> {
        let before = self.bodies.iter().take(index + 1).rev().flatten().next();
        before.or_else(|| self.bodies.iter().skip(index).flatten().next())
    }
}

impl Body {
    /// Share of the points at either end of an axis that may be wrong.
    const OUTLIERS: f64 = 0.02;
    /// Most points that are kept.
    const SAMPLES: usize = 40;

    /// What these points are of; none of none.
    pub(super) fn of(points: &[DVec3], is_whole: bool) -> Option<Self> {
        let last = points.len().checked_sub(1)?;
        let mut axes = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
        let mut at = |share: f64| {
            let rank = ((last as f64) * share).round() as usize;
            let mut coordinates = [0.0; 3];
            for (coordinate, values) in coordinates.iter_mut().zip(&mut axes) {
                *coordinate = *values.select_nth_unstable_by(rank.min(last), f64::total_cmp).1;
            }
            DVec3::from_array(coordinates)
        };
        let (low, middle, high) = (at(Self::OUTLIERS), at(0.5), at(1.0 - Self::OUTLIERS));
        let step = points.len().div_ceil(Self::SAMPLES).max(1);
        Some(Self {
            centre: (middle + (low + high) * 0.5) * 0.5,
            low,
            high,
            points: points.iter().skip(step / 2).step_by(step).copied().collect(),
            is_whole,
        })
    }

    /// The same somewhere else.
    pub(super) fn shifted(&self, by: DVec3) -> Self {
        Self {
            centre: self.centre + by,
            low: self.low + by,
            high: self.high + by,
            points: self.points.iter().map(|point| *point + by).collect(),
            is_whole: self.is_whole,
        }
    }

    /// Longest side of its box, metres.
    pub(super) fn longest_m(&self) -> f64 {
        (self.high - self.low).max_element()
    }
}

impl Glimpse {
    /// Pixels that it shares with another of the same picture.
    pub(super) fn shared_px(&self, other: &Self) -> u64 {
        let (a, b) = (&self.bounds, &other.bounds);
        let rows = a.first_row.max(b.first_row)..a.last_row.min(b.last_row) + 1;
        let is_apart = rows.is_empty() || a.first_col > b.last_col || b.first_col > a.last_col;
        if is_apart { 0 } else { self.mask.and_count_in_rows(&other.mask, rows) }
    }
}

/// The middle value; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
