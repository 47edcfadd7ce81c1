//! What consensus decided and from what: counts first, then what follows from them.
//!
//! Complete: every share, vote and decision can be derived again from the counts. Views are named by their index in
//! the list of proposals.

use l4d_data::Name;
use serde::{Deserialize, Serialize};

use super::settings::{ConsensusSettings, Preset};

/// Consensus over the views of a clip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consensus {
    /// The preset whose rules and constants these are; none if they are of no preset.
    pub preset: Option<Preset>,
    /// The rules and constants.
    pub settings: ConsensusSettings,
    /// What goes on, and why.
    pub decision: Decision,
    /// Indices of the views whose masks go on, ascending.
    pub evidence: Vec<usize>,
    /// One for each proposal, in order.
    pub views: Vec<ViewRecord>,
    /// Groups of two and more views that agree among themselves; the largest first.
    #[serde(rename = "camps")]
    pub groups: Vec<ViewGroup>,
    /// Every ordered pair of a view that found something and another one that answered.
    pub pairs: Vec<PairRecord>,
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

impl Decision {
    /// As files write it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Bypassed => "bypassed",
            Self::Reliable => "reliable",
            Self::BestView => "best_view",
            Self::NoneReliable => "none_reliable",
            Self::NoneReliableAll => "none_reliable_all",
            Self::Tied => "tied",
            Self::TiedAll => "tied_all",
            Self::Absent => "absent",
            Self::NoAnswer => "no_answer",
        }
    }
}

/// A view and what became of its proposal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewRecord {
    /// Name of the view.
    pub view: Name,
    /// What came of the question, one word.
    pub outcome: String,
    /// Frames in which it marks something.
    pub marked_frames: u32,
    /// Views that vote for it.
    pub votes: u32,
    /// Views by which the votes are divided.
    pub judges: u32,
    /// Where it stands.
    pub standing: ViewVerdict,
    /// Why its clip or masks cannot be used, if they cannot.
    pub problem: Option<String>,
    /// What it marks.
    pub frames: Vec<MarkedFrame>,
}

/// A frame of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "(u32, u64)", into = "(u32, u64)")]
pub struct MarkedFrame {
    /// Canonical frame.
    pub frame: u32,
    /// Pixels that the view marks.
    pub pixels: u64,
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
    /// Its clip or masks contradict themselves: no vote by it, none on it.
    Unusable,
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
pub struct ViewGroup {
    /// Who, ascending.
    pub views: Vec<usize>,
    /// Indices of the groups that contradict it, ascending.
    pub against: Vec<usize>,
}

/// What view `judge` says about the proposal of view `of`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairRecord {
    /// Whose proposal is judged (the paper's i).
    pub of: usize,
    /// Who judges (the paper's j).
    pub judge: usize,
    /// What follows from the frames.
    pub verdict: PairVerdict,
    /// Frames that agree.
    pub agreeing: u32,
    /// Frames that agree or disagree.
    pub counted: u32,
    /// Frames in which the judge can see what is marked.
    pub seen: u32,
    /// Frames in which it would have to, to be a judge.
    pub needed: u32,
    /// Every frame that both clips have.
    pub frames: Vec<FrameRecord>,
}

/// What a view says about another's proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairVerdict {
    /// It votes for it.
    Vote,
    /// It does not, and could.
    NoVote,
    /// It sees too little of it to say.
    CannotSee,
}

/// A pair of views at a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "FrameRow", into = "FrameRow")]
pub struct FrameRecord {
    /// Canonical frame.
    pub frame: u32,
    /// What was counted.
    pub counts: FrameCounts,
    /// What it comes to.
    pub verdict: FrameVerdict,
    /// Why.
    pub reason: Reason,
}

/// A row of `consensus.json`: frame, the counts in their order, verdict, reason.
type FrameRow = (u32, [u64; 7], FrameVerdict, Reason);

/// Pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameCounts {
    /// Marked by the view that is judged (m_i).
    pub marked: u64,
    /// Of them, those that have a depth.
    pub projected: u64,
    /// Of them, those that land within the judge's picture.
    pub in_frame: u64,
    /// Of them, those that nothing hides there.
    pub passing: u64,
    /// Of the judge's picture, those that the projected mask covers.
    pub covered: u64,
    /// Marked by the judge (m_j).
    pub target: u64,
    /// Covered and marked by the judge.
    pub shared: u64,
}

/// Whether a frame speaks for a proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrameVerdict {
    /// It does.
    Agrees,
    /// It speaks against it.
    Disagrees,
    /// It says nothing.
    Neutral,
}

/// Why a frame speaks as it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
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
    pub fn iou(&self) -> Option<f64> {
        share(self.shared, self.covered + self.target - self.shared)
    }

    /// Share of the projected pixels that the judge can see.
    pub fn seen_share(&self) -> Option<f64> {
        share(self.passing, self.projected)
    }

    /// Share of the projected mask that the judge marks as well.
    pub fn shared_share(&self) -> Option<f64> {
        share(self.shared, self.covered)
    }
}

/// A ratio of counts. One rounding: it equals a threshold that was written as the same ratio.
pub(super) fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

impl ViewRecord {
    /// Votes over judges; none without judges.
    pub fn score(&self) -> Option<f64> {
        share(self.votes.into(), self.judges.into())
    }
}

impl Consensus {
    /// What one view says about another's proposal.
    pub fn pair(&self, of: usize, judge: usize) -> Option<&PairRecord> {
        self.pairs.iter().find(|pair| (pair.of, pair.judge) == (of, judge))
    }

    /// The group of a view.
    pub fn group_of(&self, view: usize) -> Option<usize> {
        self.groups.iter().position(|group| group.views.contains(&view))
    }

    /// Whether groups contradict each other.
    pub fn has_conflict(&self) -> bool {
        self.groups.iter().any(|group| !group.against.is_empty())
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

impl From<(u32, u64)> for MarkedFrame {
    fn from((frame, pixels): (u32, u64)) -> Self {
        Self { frame, pixels }
    }
}

impl From<MarkedFrame> for (u32, u64) {
    fn from(marked: MarkedFrame) -> Self {
        (marked.frame, marked.pixels)
    }
}
