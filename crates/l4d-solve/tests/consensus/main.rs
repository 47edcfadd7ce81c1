//! Consensus on worlds that are known exactly.

use l4d_ground::{Grounding, ViewClip};
use l4d_solve::consensus::{Consensus, ConsensusSettings, Proposal, consensus};

mod records;
mod reprojection;
mod stability;
mod votes;
mod world;

/// Consensus of these views.
fn decide(clips: &[ViewClip], groundings: &[Grounding], settings: &ConsensusSettings) -> Consensus {
    consensus(&proposals(clips, groundings), settings)
}

fn proposals<'a>(clips: &'a [ViewClip], groundings: &'a [Grounding]) -> Vec<Proposal<'a>> {
    clips.iter().zip(groundings).map(|(clip, grounding)| Proposal { clip, grounding }).collect()
}
