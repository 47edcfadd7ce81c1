//! The constants and rules of consensus, where they come from, and the presets that they make up.
//!
//! The paper leaves much unsaid. Each such place is an enum here, with every reading that we know as a variant.

use serde::{Deserialize, Serialize};

/// Rules that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// As the paper writes it.
    Paper,
    /// What holds up where the paper is silent; the default for users.
    Robust,
    /// No consensus: every view that found something goes on (the paper's ablation).
    Off,
}

/// All of it. Equality edges follow the words of the source: "over", "exceeds" and "surpasses" are strict, "at least"
/// is not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConsensusSettings {
    /// Whether views vote at all.
    pub is_on: bool,
    /// How a mask gets from one view to another.
    pub reprojection: ReprojectionSettings,
    /// When view j can judge view i at a frame.
    pub visibility: Visibility,
    /// Share that visibility asks for: 0.6 (paper, section 4, "over 60 %").
    pub visibility_share: f64,
    /// What a frame counts that j cannot judge.
    pub unseen: Against,
    /// What a frame counts in which i marks nothing, and j something that i could see.
    pub unclaimed: Against,
    /// The paper's delta: a frame agrees if the intersection over union is above it. 0.3 (paper, section 5).
    pub delta: f64,
    /// The paper's epsilon: j votes for i if the share of agreeing frames is above it. 0.5 (paper, section 5).
    pub epsilon: f64,
    /// Frames in which j has to see what i marks before it may vote; all of them, where i marks in fewer. `paper` 0:
    /// nothing is said. `robust` 3: one frame can agree by chance.
    pub min_frames: u32,
    /// By whom votes are divided.
    pub judges: Judges,
    /// The paper's tau: a view is reliable if its votes over its judges are above it. 0.3 (paper, section 5).
    pub tau: f64,
    /// Votes that a reliable view has at least. `paper` 1: what is above tau has one. `robust` 2: where few can judge,
    /// a single vote would be above tau.
    pub min_votes: u32,
    /// What becomes of groups of views that contradict each other.
    #[serde(rename = "camps")]
    pub group_rule: GroupRule,
    /// What goes on if no view is reliable.
    pub none_reliable: NoneReliable,
    /// What goes on if the votes decide nothing: groups of views tie, or no view is reliable and there is no best one. `paper`
    /// abstains: its words end at "pruned". `robust` keeps all candidates: an empty answer is never better than they
    /// are (docs/notes/panopticquery.md, "Consensus against none").
    pub undecided: Undecided,
}

/// How masks are carried from view to view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReprojectionSettings {
    /// A pixel that is filled less than this has no depth. `paper` 0: its depth is taken as it is. `robust` 0.5, where
    /// the median depth begins to exist.
    pub min_alpha: f64,
    /// Depths that differ by this share of themselves are the same surface. `paper` 0.05, our rule: the paper has no
    /// test. `robust` 0.02, to which the spread is added (docs/constants.md says on what it was chosen).
    pub tolerance: f64,
    /// Whether half of the distance from `near_m` to `far_m`, in either pixel, is added to the tolerance.
    pub with_spread: bool,
    /// What the spreads add at most, as a share of the depth: beyond, a pixel shows several things. 0.05.
    pub most_spread: f64,
}

/// The paper: "Visibility is confirmed if the projected mask shares over 60 % pixel overlap with m_j".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Visibility {
    /// To the letter: more than that share of the projected mask lies within m_j. A view that marks something else
    /// "cannot see" it.
    SharedWithProposal,
    /// In spirit: at least that share of the projected pixels lands within the picture and is not hidden there,
    /// whatever m_j says; and some pixel of j shows it.
    Seen,
}

/// Whether a frame that says little counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    Disagrees,
    /// It is left out.
    LeftOut,
}

/// The paper: "normalized vote count".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Judges {
    /// All other views that answered.
    AllOthers,
    /// Those of them that could see what the view marks, in enough frames.
    CouldSee,
}

/// What groups of views decide that agree among themselves and contradict each other. The paper knows none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GroupRule {
    /// They are shown, and decide nothing: two of them can be reliable at once.
    Shown,
    /// The largest wins; a tie decides nothing.
    LargestWins,
}

/// The paper does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoneReliable {
    Abstain,
    /// The best view that has a vote.
    BestView,
}

/// The paper does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Undecided {
    /// Nothing: the answer is empty.
    Abstain,
    /// Every view that found something, as without consensus.
    AllCandidates,
}

impl Preset {
    /// Its rules and constants.
    pub fn settings(self) -> ConsensusSettings {
        match self {
            Self::Paper => ConsensusSettings::paper(),
            Self::Robust => ConsensusSettings::robust(),
            Self::Off => ConsensusSettings { is_on: false, ..ConsensusSettings::robust() },
        }
    }

    pub fn word(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Robust => "robust",
            Self::Off => "off",
        }
    }
}

impl ConsensusSettings {
    /// As the paper writes it; the reading that is nearest to its words where it is silent.
    pub fn paper() -> Self {
        Self {
            is_on: true,
            reprojection: ReprojectionSettings {
                min_alpha: 0.0,
                tolerance: 0.05,
                with_spread: false,
                most_spread: 0.05,
            },
            visibility: Visibility::SharedWithProposal,
            visibility_share: 0.6,
            unseen: Against::Disagrees,
            unclaimed: Against::LeftOut,
            delta: 0.3,
            epsilon: 0.5,
            min_frames: 0,
            judges: Judges::AllOthers,
            tau: 0.3,
            min_votes: 1,
            group_rule: GroupRule::Shown,
            none_reliable: NoneReliable::Abstain,
            undecided: Undecided::Abstain,
        }
    }

    /// The default for users.
    pub fn robust() -> Self {
        Self {
            reprojection: ReprojectionSettings {
                min_alpha: 0.5,
                tolerance: 0.02,
                with_spread: true,
                ..Self::paper().reprojection
            },
            visibility: Visibility::Seen,
            unseen: Against::LeftOut,
            unclaimed: Against::Disagrees,
            min_frames: 3,
            judges: Judges::CouldSee,
            min_votes: 2,
            group_rule: GroupRule::LargestWins,
            none_reliable: NoneReliable::BestView,
            undecided: Undecided::AllCandidates,
            ..Self::paper()
        }
    }

    /// The preset that these are, if no rule and no constant differs from it.
    pub fn preset(&self) -> Option<Preset> {
        [Preset::Paper, Preset::Robust, Preset::Off].into_iter().find(|preset| preset.settings() == *self)
    }
}

impl Default for ConsensusSettings {
    fn default() -> Self {
        Self::robust()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_told_by_their_rules_and_mixtures_are_none_of_them() {
        for preset in [Preset::Paper, Preset::Robust, Preset::Off] {
            assert_eq!(preset.settings().preset(), Some(preset));
        }
        let mixed = ConsensusSettings { judges: Judges::CouldSee, ..ConsensusSettings::paper() };
        assert_eq!(mixed.preset(), None);
    }

    #[test]
    fn the_paper_s_constants_are_the_paper_s() {
        let paper = ConsensusSettings::paper();
        assert_eq!([paper.delta, paper.epsilon, paper.tau, paper.visibility_share], [0.3, 0.5, 0.3, 0.6]);
    }
}
