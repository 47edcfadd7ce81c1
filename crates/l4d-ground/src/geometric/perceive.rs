//! What is seen over a clip from one camera: things, where they are, how they look.

use glam::DVec3;
use l4d_data::{Scale, Timeline};
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;

/// What is seen over a clip.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Perceived {
    /// Frames of the clip, ascending.
    pub(crate) frames: Vec<u32>,
    /// When they were.
    pub(crate) timeline: Timeline,
    /// Things, in an order that depends on the clip alone. Several may be readings of the same pixels: a whole and
    /// its parts.
    pub(crate) tracks: Vec<Track>,
    /// Size of the scene, as far as one camera can tell.
    pub(crate) scale: Scale,
    /// Distance between the points of neighbouring pixels, metres; median over what is seen. Nothing is known finer.
    pub(crate) spacing_m: f64,
    /// Where the camera is in the middle of the clip, metres, world.
    pub(crate) eye: DVec3,
    /// Where most of what moves is, metres, world, and how far around it things move: what the clip is about. None
    /// if nothing moves.
    pub(crate) focus: Option<(DVec3, f64)>,
    /// Heights of level surfaces that things stand on, metres, world.
    pub(crate) levels_m: Vec<f64>,
}

/// A thing over time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Track {
    /// What is seen of it, one for each frame of the clip; none where it isn't seen.
    pub(crate) glimpses: Vec<Option<Glimpse>>,
}

/// A thing at a moment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Glimpse {
    /// Which of the things of its picture it is; 0 where that is not told.
    pub(crate) number: usize,
    /// Its pixels.
    pub(crate) mask: Mask,
    /// Number of its pixels.
    pub(crate) area_px: u64,
    /// The smallest box around its pixels.
    pub(crate) bounds: PixelBox,
    /// Mean of its colours, CIE L*a*b*.
    pub(crate) colour: [f32; 3],
    /// Middle of its visible surface, metres, world.
    pub(crate) centre: DVec3,
    /// Lowest corner of the box around its visible surface, metres, world axes.
    pub(crate) low: DVec3,
    /// Highest corner.
    pub(crate) high: DVec3,
    /// Some points of its surface, metres, world.
    pub(crate) points: Vec<DVec3>,
    /// Colours of some of its pixels, CIE L*a*b*.
    pub(crate) colours: Vec<[f32; 3]>,
    /// Whether the border of the picture cuts it.
    pub(crate) is_cut: bool,
    /// Share of its outline at which its surface ends: 1 for a thing that stands free, less for a piece of one.
    pub(crate) closed: f64,
}

impl Track {
    /// Frames (indices) in which it is seen.
    pub(crate) fn seen(&self) -> impl Iterator<Item = (usize, &Glimpse)> {
        self.glimpses.iter().enumerate().filter_map(|(index, glimpse)| Some((index, glimpse.as_ref()?)))
    }

    /// Median over the frames in which it is seen whole, or seen at all.
    pub(crate) fn median(&self, measure: impl Fn(&Glimpse) -> f64) -> f64 {
        let whole: Vec<f64> =
            self.seen().filter(|(_, seen)| !seen.is_cut).map(|(_, seen)| measure(seen)).collect();
        let values =
            if whole.is_empty() { self.seen().map(|(_, seen)| measure(seen)).collect() } else { whole };
        median(values)
    }

    /// Where it is at a frame, or where it was seen last before or first after.
    pub(crate) fn nearest(&self, index: usize) -> Option<&Glimpse> {
        let before = self.glimpses.iter().take(index + 1).rev().flatten().next();
        before.or_else(|| self.glimpses.iter().skip(index).flatten().next())
    }
}

impl Glimpse {
    /// Pixels that it shares with another of the same picture.
    pub(crate) fn shared_px(&self, other: &Self) -> u64 {
        let (a, b) = (&self.bounds, &other.bounds);
        let rows = a.first_row.max(b.first_row)..a.last_row.min(b.last_row) + 1;
        let is_apart = rows.is_empty() || a.first_col > b.last_col || b.first_col > a.last_col;
        if is_apart { 0 } else { self.mask.and_count_in_rows(&other.mask, rows) }
    }

    /// Longest side of its box, metres.
    pub(crate) fn longest_m(&self) -> f64 {
        (self.high - self.low).max_element()
    }
}

/// The middle value; 0 of none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
