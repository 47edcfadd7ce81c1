//! The same masks under the rules of other evaluations.
//!
//! A number of a paper can only be set beside ours if it was counted alike. Each [`Protocol`] does the sums of its
//! source again, edges included, on masks that were made for this benchmark, and says what the source would have left
//! out on the way. `docs/protocols.md` explains the differences. Nothing here is a headline: none of it can be ranked,
//! and every table, file and document bears the name of the protocol.
//!
//! A protocol sees masks and truth. Where masks come from, and how relevancy was cut into them, is not its business;
//! what needs relevancy has a value only where [`Summits`] are given.

mod boundary;
mod davis;
mod four_d_langsplat;
mod gaussian_grouping;
mod judged;
mod langsplat;
mod mevis;
mod record;
mod run;
mod seen;
mod sheet;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

pub use judged::{Judged, LeftOut, Value};
pub use record::{Origin, Record};
pub use run::{Protocolled, judge_answers, judge_results};
pub use seen::{Clip, Seen, Summits};
pub use sheet::{Row, Sheet, file_stem, render};

/// Whose evaluation is done again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Protocol {
    /// LangSplat, `eval/evaluate_iou_loc.py`.
    LangSplat,
    /// 4D LangSplat, `eval/eval.py`.
    FourDLangSplat,
    /// DAVIS 2017, semi-supervised.
    Davis,
    /// MeViS, `tools/eval_mevis.py`.
    Mevis,
    /// Gaussian Grouping, `script/eval_lerf_mask.py`.
    GaussianGrouping,
}

/// A number that a source reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measure {
    /// Name in files.
    pub key: &'static str,
    /// Name in tables.
    pub title: &'static str,
}

/// What happens to a frame without an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnMissing {
    /// The source stops, or takes another frame unnoticed: there is no number to reproduce.
    Stops,
    /// The protocol has a rule of its own.
    OwnRule,
}

/// How values of queries become a number of a scene, and numbers of scenes one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Averaging {
    /// Every pair of frame and sentence of a scene weighs the same; then every scene.
    PairsThenScenes,
    /// Every sentence of a scene weighs the same; then every scene.
    QueriesThenScenes,
    /// Every sentence weighs the same, wherever it was asked.
    Queries,
}

/// Everything that tells one protocol from another.
struct Rules {
    /// Name in options, files and tables.
    name: &'static str,
    /// The evaluation that is done again.
    source: &'static str,
    /// What the source reports, in the order of [`Judged::values`].
    measures: &'static [Measure],
    on_missing: OnMissing,
    averaging: Averaging,
    /// What one has to know before setting these numbers beside those of a paper.
    remark: &'static str,
    judge: fn(&Clip<'_>) -> Judged,
}

impl Protocol {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 5] =
        [Self::LangSplat, Self::FourDLangSplat, Self::Davis, Self::Mevis, Self::GaussianGrouping];

    fn rules(self) -> &'static Rules {
        match self {
            Self::LangSplat => &langsplat::RULES,
            Self::FourDLangSplat => &four_d_langsplat::RULES,
            Self::Davis => &davis::RULES,
            Self::Mevis => &mevis::RULES,
            Self::GaussianGrouping => &gaussian_grouping::RULES,
        }
    }

    /// Name in options, files and tables.
    pub fn as_str(self) -> &'static str {
        self.rules().name
    }

    /// The evaluation that is done again.
    pub fn source(self) -> &'static str {
        self.rules().source
    }

    /// What the source reports, in the order of [`Judged::values`].
    pub fn measures(self) -> &'static [Measure] {
        self.rules().measures
    }

    /// What a frame without an answer does to the source.
    pub fn on_missing(self) -> OnMissing {
        self.rules().on_missing
    }

    /// Whether the source brings predictions of another size to that of the truth.
    pub fn resizes(self) -> bool {
        self == Self::GaussianGrouping
    }

    /// How values of queries become one number.
    pub fn averaging(self) -> Averaging {
        self.rules().averaging
    }

    /// What one has to know before setting these numbers beside those of a paper.
    pub fn remark(self) -> &'static str {
        self.rules().remark
    }

    /// Judges the answers to one query.
    pub fn judge(self, clip: &Clip<'_>) -> Judged {
        (self.rules().judge)(clip)
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.as_str())
    }
}

/// A name that no protocol has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownProtocol;

impl fmt::Display for UnknownProtocol {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Protocol::ALL.map(Protocol::as_str).join(", ");
        write!(formatter, "is no protocol; there are {names}")
    }
}

impl std::error::Error for UnknownProtocol {}

impl From<Protocol> for &'static str {
    fn from(protocol: Protocol) -> Self {
        protocol.as_str()
    }
}

impl TryFrom<String> for Protocol {
    type Error = UnknownProtocol;

    fn try_from(name: String) -> Result<Self, UnknownProtocol> {
        name.parse()
    }
}

impl FromStr for Protocol {
    type Err = UnknownProtocol;

    fn from_str(name: &str) -> Result<Self, UnknownProtocol> {
        Self::ALL.into_iter().find(|protocol| protocol.as_str() == name).ok_or(UnknownProtocol)
    }
}
