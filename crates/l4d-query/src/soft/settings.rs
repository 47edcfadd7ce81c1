//! Every number of the soft reading: set by reasoning, but for what clauses leave of a thing, which was chosen on
//! `benchmark/dev`. No other scenes may tune them.

use l4d_data::{Category, Scale};

use crate::ast::Clause;

/// An event holds at some time as far as it does in its best frames, this many.
pub(super) const BEST_FRAMES: usize = 6;
/// A state holds all the time as far as it does in its worst frames, this many.
pub(super) const WORST_FRAMES: usize = 12;
/// Frames at either end of the clip that count as its start and end.
pub(super) const END_FRAMES: usize = 4;
/// A party means those that fit at least this share of what fits best.
pub(super) const PARTY_SHARE: f64 = 0.25;
/// Things are compared with what is of their noun at least this much.
pub(super) const RIVAL_SHARE: f64 = 0.05;
/// Somebody who fits worse than this is not presumed to be meant just because nobody fits better.
pub(super) const LEAST_PRESUMED: f64 = 0.1;
/// A clause that holds of nothing better than this is not presumed to hold of what fits best.
pub(super) const LEAST_STRETCH: f64 = 0.2;
/// Probability that a thing of an unknown kind is of the noun.
pub(super) const UNHEARD_OF: f64 = 0.05;
/// Share of a wider noun that counts where nobody perceives the narrower one.
pub(super) const WIDER_SHARE: f64 = 0.5;
/// How much speaks for nothing being meant, as a score.
pub(super) const ABSENT_SCORE: f64 = 0.05;

/// How much is left of a thing of which a clause does not hold: what is perceived may be wrong, and what happens more
/// often than what something looks like. Chosen on dev (docs/constants.md).
fn floor(category: Option<Category>) -> f64 {
    match category {
        None => 0.0,
        Some(Category::Attribute) => 0.05,
        Some(Category::Action | Category::Interaction) => 0.3,
        Some(Category::Spatial) => 0.05,
    }
}

/// How much a clause that holds to a degree leaves of a thing.
pub(super) fn weighed(clause: &Clause, degree: f64) -> f64 {
    let floor = floor(clause.category());
    floor + (1.0 - floor) * degree
}

/// How well boxes and times are known: standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of a place, metres.
    pub position_m: f64,
    /// Of a length, as a share of it.
    pub size: f64,
    /// Of a direction, degrees.
    pub angle_deg: f64,
    /// Of the frame at which something begins or ends.
    pub frames: f64,
}

impl Noise {
    /// Everything is known.
    pub const NONE: Self = Self { position_m: 0.0, size: 0.0, angle_deg: 0.0, frames: 0.0 };

    /// What a perceiver of a scene of this scale may be trusted with, if nothing better is known of it.
    pub const fn perceived(scale: Scale) -> Self {
        let position_m = match scale {
            Scale::Outdoor => 0.15,
            Scale::Room => 0.08,
            Scale::Tabletop => 0.02,
        };
        Self { position_m, size: 0.1, angle_deg: 15.0, frames: 3.0 }
    }
}
