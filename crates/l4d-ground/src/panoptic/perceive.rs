//! What is seen over a clip from one camera: things, where they are, how they look.

use glam::DVec3;
use l4d_data::{Scale, Timeline};
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;

/// What is seen over a clip.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Perceived {
    /// Frames of the clip, ascending.
    pub(super) frames: Vec<u32>,
    /// When they were.
    pub(super) timeline: Timeline,
    /// Things, in an order that depends on the clip alone.
    pub(super) tracks: Vec<Track>,
    /// Size of the scene, as far as one camera can tell.
    pub(super) scale: Scale,
    /// Distance between the points of neighbouring pixels, metres; median over what is seen. Nothing is known finer.
    pub(super) spacing_m: f64,
    /// Where the camera is in the middle of the clip, metres, world.
    pub(super) eye: DVec3,
}

/// A thing over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track {
    /// What is seen of it, one for each frame of the clip; none where it isn't seen.
    pub(super) glimpses: Vec<Option<Glimpse>>,
}

/// A thing at a moment.
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
    /// Middle of its visible surface, metres, world.
    pub(super) centre: DVec3,
    /// Lowest corner of the box around its visible surface, metres, world axes.
    pub(super) low: DVec3,
    /// Highest corner.
    pub(super) high: DVec3,
    /// Some points of its surface, metres, world.
    pub(super) points: Vec<DVec3>,
    /// Whether the border of the picture cuts it.
    pub(super) is_cut: bool,
}

impl Track {
    /// Frames (indices) in which it is seen.
    pub(super) fn seen(&self) -> impl Iterator<Item = (usize, &Glimpse)> {
        self.glimpses.iter().enumerate().filter_map(|(index, glimpse)| Some((index, glimpse.as_ref()?)))
    }

    /// Median over the frames in which it is seen whole, or seen at all.
    pub(super) fn median(&self, measure: impl Fn(&Glimpse) -> f64) -> f64 {
        let whole: Vec<f64> =
            self.seen().filter(|(_, seen)| !seen.is_cut).map(|(_, seen)| measure(seen)).collect();
        let values =
            if whole.is_empty() { self.seen().map(|(_, seen)| measure(seen)).collect() } else { whole };
        median(values)
    }

    /// Where it is at a frame, or where it was seen last before or first after.
    pub(super) fn nearest(&self, index: usize) -> Option<&Glimpse> {
        let before = self.glimpses.iter().take(index + 1).rev().flatten().next();
        before.or_else(|| self.glimpses.iter().skip(index).flatten().next())
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

    /// Longest side of its box, metres.
    pub(super) fn longest_m(&self) -> f64 {
        (self.high - self.low).max_element()
    }
}

/// The middle value; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
