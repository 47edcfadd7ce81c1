//! Consensus on worlds that are known exactly.

use l4d_ground::{Grounding, ViewClip};

use crate::consensus::{Consensus, ConsensusSettings, Proposal, consensus};

mod records;
mod reprojection;
mod stability;
mod votes;
mod world;

/// Consensus of these views.
fn decide(clips: &[ViewClip], groundings: &[Grounding], settings: &ConsensusSettings) -> Consensus {
    consensus(&Proposal::of(clips, groundings), settings)
}

/// Whether groups of views contradict each other.
fn has_conflict(consensus: &Consensus) -> bool {
    consensus.groups.iter().any(|group| !group.against.is_empty())
}
