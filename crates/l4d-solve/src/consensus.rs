//! Multi-view semantic consensus (paper, section 4): which views' masks agree with the others' and go on as evidence.
//!
//! Every mask is carried into every other view by depth and compared with what that view marks. Frames agree or
//! disagree, pairs of views vote, votes make a view reliable. Both presets, `paper` and `robust`, and the ablation
//! without consensus are settings of this one mechanism.
//!
//! The module owns the votes and the record of them. It refuses to know how masks came about and what they are for.

mod candidate;
mod decide;
mod explain;
mod groups;
mod judge;
mod record;
mod reproject;
pub mod settings;
#[cfg(test)]
mod tests;
mod view_geometry;

pub use candidate::Proposal;
pub use record::{Consensus, Decision, ViewRecord, ViewVerdict};
pub use settings::{ConsensusSettings, Preset};

/// Decides which proposals go on. The same proposals give the same record, however many threads work.
///
/// Outcomes that are no answers take no part; the record names them.
pub fn consensus(proposals: &[Proposal<'_>], settings: &ConsensusSettings) -> Consensus {
    let parts: Vec<_> = proposals.iter().map(Proposal::part).collect();
    let pairs = if settings.is_on { judge::judge_all(proposals, &parts, settings) } else { Vec::new() };
    decide::decide(proposals, &parts, pairs, settings)
}
