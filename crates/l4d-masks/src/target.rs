//! What a query asks to find in the held-out view: the union of its referents, at the frames of which it speaks.

use l4d_data::rle::Rle;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Name, Query};

use crate::mask::Mask;

/// The pixels of any of some instances at a frame; none if no pixel of them is visible.
pub fn union(truth: &Truth, instances: &[Name], frame: u32) -> Option<Mask> {
    let key = frame_key(frame);
    let mask = |name: &Name| {
        let rle = truth.instance(name)?.masks.get(&key).filter(|rle: &&Rle| !rle.is_empty())?;
        Some(Mask::from_rle(rle, truth.width, truth.height))
    };
    instances.iter().filter_map(mask).reduce(|mut union, other| {
        union.union_with(&other);
        union
    })
}

/// What a query asks to find at a frame: the union of its referents; none where they are not visible, or where a
/// `while` query does not hold.
pub fn target(truth: &Truth, query: &Query, frame: u32) -> Option<Mask> {
    query.asks_at(frame).then(|| union(truth, &query.referents, frame)).flatten()
}
