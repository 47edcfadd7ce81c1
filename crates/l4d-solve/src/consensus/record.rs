//! What consensus decided and from what: counts first, then what follows from them.
//!
//! Complete: every share, vote and decision can be derived again from the counts. Views are named by their index in
//! the list of proposals.

use l4d_data::Name;
use l4d_masks::iou;
use serde::{Deserialize, Serialize};

use super::settings::{ConsensusSettings, Preset};

/// Consensus over the views of a clip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consensus {
    /// The preset whose rules and constants these are; none if they are of no preset.
    pub(crate) preset: Option<Preset>,
    /// The rules and constants.
    pub(crate) settings: ConsensusSettings,
    /// What goes on, and why.
    pub decision: Decision,
    /// Indices of the views whose masks go on, ascending.
    pub evidence: Vec<usize>,
    /// One for each proposal, in order.
    pub views: Vec<ViewRecord>,
    /// Groups of two and more views that agree among themselves; the largest first.
    #[serde(rename = "camps")]
    pub(crate) groups: Vec<ViewGroup>,
    /// Every ordered pair of a view that found something and another one that answered.
    pub(crate) pairs: Vec<PairRecord>,
}

/// Why the evidence is what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// There is no vote: all views that found something go on.
    Off,
    /// One view alone answered: no other can vote on it.
    Bypassed,
    /// The reliable views go on.
    Reliable,
    /// No view is reliable; the best one that has a vote goes on.
    BestView,
    /// No view is reliable, and nothing goes on.
    NoneReliable,
    /// No view is reliable; all that found something go on.
    NoneReliableAll,
    /// Groups of views of equal size contradict each other; nothing goes on.
    Tied,
    /// Groups of views of equal size contradict each other; all views that found something go on.
    TiedAll,
    /// All views that answered say that it is not there.
    Absent,
    /// No view answered.
    NoAnswer,
}

/// A view and what became of its proposal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewRecord {
    pub(crate) view: Name,
    /// What came of the question.
    pub(crate) outcome: String,
    /// Frames in which it marks something.
    pub(crate) marked_frames: u32,
    /// Views that vote for it.
    pub(crate) votes: u32,
    /// Views by which the votes are divided.
    pub(crate) judges: u32,
    /// Where it stands.
    pub standing: ViewVerdict,
    /// Canonical frames of its clip, with the pixels that it marks in each.
    pub(crate) frames: Vec<(u32, u64)>,
}

/// What became of a proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ViewVerdict {
    /// It goes on: others agree, or there were no others.
    Reliable,
    /// It goes on for want of a better one.
    Best,
    /// It says that there is nothing.
    Absent,
    /// It did not answer: no vote by it, none on it.
    NoAnswer,
    /// No other view could see what it marks.
    NoJudge,
    /// Fewer votes than the settings ask for.
    FewVotes,
    /// The share of votes is not above tau.
    LowScore,
    /// A larger group of views contradicts it.
    Outvoted,
    /// A group of the same size contradicts it.
    Tied,
}

/// Views that agree among themselves.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ViewGroup {
    /// Who, ascending.
    pub(crate) views: Vec<usize>,
    /// Indices of the groups that contradict it, ascending.
    pub(crate) against: Vec<usize>,
}

/// What view `judge` says about the proposal of view `of`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PairRecord {
    /// Whose proposal is judged (the paper's i).
    pub(crate) of: usize,
    /// Who judges (the paper's j).
    pub(crate) judge: usize,
    pub(crate) verdict: PairVerdict,
    /// Frames that agree.
    pub(crate) agreeing: u32,
    /// Frames that agree or disagree.
    pub(crate) counted: u32,
    /// Frames in which the judge can see what is marked.
    pub(crate) seen: u32,
    /// Frames in which it would have to, to be a judge.
    pub(crate) needed: u32,
    /// Every frame that both clips have.
    pub(crate) frames: Vec<FrameRecord>,
}

/// What a view says about another's proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PairVerdict {
    Vote,
    NoVote,
    /// It sees too little of it to say.
    CannotSee,
}

/// A pair of views at a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "FrameRow", into = "FrameRow")]
pub(crate) struct FrameRecord {
    /// Canonical frame.
    pub(crate) frame: u32,
    pub(crate) counts: FrameCounts,
    pub(crate) verdict: FrameVerdict,
    pub(crate) reason: Reason,
}

/// A row of `consensus.json`: frame, the counts in their order, verdict, reason.
type FrameRow = (u32, [u64; 7], FrameVerdict, Reason);

/// Pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct FrameCounts {
    /// Marked by the view that is judged (m_i).
    pub(crate) marked: u64,
    /// Of them, those that have a depth.
    pub(crate) projected: u64,
    /// Of them, those that land within the judge's picture.
    pub(crate) in_frame: u64,
    /// Of them, those that nothing hides there.
    pub(crate) passing: u64,
    /// Of the judge's picture, those that the projected mask covers.
    pub(crate) covered: u64,
    /// Marked by the judge (m_j).
    pub(crate) target: u64,
    /// Covered and marked by the judge.
    pub(crate) shared: u64,
}

/// Whether a frame speaks for a proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FrameVerdict {
    Agrees,
    Disagrees,
    Neutral,
}

/// Why a frame speaks as it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Reason {
    /// Intersection over union is above delta.
    Overlap,
    /// It is not.
    Apart,
    /// The judge marks nothing, and could see it.
    Denied,
    /// The judge marks something that the other view could see and does not mark.
    Unclaimed,
    /// The judge cannot see it.
    Unseen,
    /// What is marked has no depth.
    NoDepth,
    /// The view marks nothing, so that there is nothing to judge.
    Unmarked,
    /// Both mark nothing.
    BothEmpty,
}

impl FrameCounts {
    /// Intersection over union of the projected mask and the judge's; none if both are empty.
    pub(super) fn iou(&self) -> Option<f64> {
        iou(self.shared, self.covered + self.target - self.shared)
    }

    /// Share of the projected pixels that the judge can see.
    pub(super) fn seen_share(&self) -> Option<f64> {
        share(self.passing, self.projected)
    }

    /// Share of the projected mask that the judge marks as well.
    pub(super) fn shared_share(&self) -> Option<f64> {
        share(self.shared, self.covered)
    }
}

/// A ratio of counts. One rounding: it equals a threshold that was written as the same ratio.
pub(super) fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

impl ViewRecord {
    /// Votes over judges; none without judges.
    pub(super) fn score(&self) -> Option<f64> {
        share(self.votes.into(), self.judges.into())
    }
}

impl Consensus {
    pub(super) fn pair(&self, of: usize, judge: usize) -> Option<&PairRecord> {
        self.pairs.iter().find(|pair| (pair.of, pair.judge) == (of, judge))
    }

    pub(super) fn group_of(&self, view: usize) -> Option<usize> {
        self.groups.iter().position(|group| group.views.contains(&view))
    }
}

impl From<FrameRow> for FrameRecord {
    fn from((frame, counts, verdict, reason): FrameRow) -> Self {
        let [marked, projected, in_frame, passing, covered, target, shared] = counts;
        let counts = FrameCounts { marked, projected, in_frame, passing, covered, target, shared };
        Self { frame, counts, verdict, reason }
    }
}

impl From<FrameRecord> for FrameRow {
    fn from(record: FrameRecord) -> Self {
        let FrameCounts { marked, projected, in_frame, passing, covered, target, shared } = record.counts;
        let counts = [marked, projected, in_frame, passing, covered, target, shared];
        (record.frame, counts, record.verdict, record.reason)
    }
}
