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
mod clip;
mod davis;
mod four_d_langsplat;
mod gaussian_grouping;
mod langsplat;
mod mevis;
mod r4d;
mod record;
mod run;
mod saco;
mod sheet;
mod votsr;

use l4d_data::QuerySet;
use serde::{Deserialize, Serialize};

use clip::{Clip, QueryScores};

pub use clip::{LeftOut, Summits};
pub use record::{Origin, Record};
pub use run::{Protocolled, judge_answers, judge_results};
pub use sheet::{Row, Sheet, render, shared};

/// Whose evaluation is done again.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    strum::Display,
    strum::IntoStaticStr,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Protocol {
    /// LangSplat, `eval/evaluate_iou_loc.py`.
    #[serde(rename = "langsplat")]
    #[strum(serialize = "langsplat")]
    LangSplat,
    /// 4D LangSplat, `eval/eval.py`.
    #[serde(rename = "4d-langsplat")]
    #[strum(serialize = "4d-langsplat")]
    FourDLangSplat,
    /// DAVIS 2017, semi-supervised.
    Davis,
    /// MeViS, `tools/eval_mevis.py`.
    Mevis,
    /// Gaussian Grouping, `script/eval_lerf_mask.py`.
    GaussianGrouping,
    /// R4D-Bench-QA, `scripts/evaluate_ours_benchmark.py`.
    R4d,
    /// VOTS 2026, the referral challenge, `vot/analysis/referral.py`.
    Votsr,
    /// SA-Co of SAM 3, `sam3/eval/demo_eval.py`.
    Saco,
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
enum Averaging {
    /// Every pair of frame and sentence of a scene weighs the same; then every scene.
    PairsThenScenes,
    /// Every sentence of a scene weighs the same; then every scene.
    QueriesThenScenes,
    /// Every sentence weighs the same, wherever it was asked.
    Queries,
    /// Ratios of counts over all sentences: [`saco::number`].
    Counts,
}

/// Everything that tells one protocol from another.
#[derive(Debug)]
pub struct Rules {
    /// The evaluation that is done again.
    pub source: &'static str,
    /// What the source reports.
    pub measures: &'static [Measure],
    /// What a frame without an answer does to the source.
    pub on_missing: OnMissing,
    /// Whether the source brings predictions of another size to that of the truth.
    resizes: bool,
    averaging: Averaging,
    /// What one has to know before setting these numbers beside those of a paper.
    pub remark: &'static str,
    /// The values of one query, in the order of the measures.
    judge: fn(&Clip<'_>) -> QueryScores,
}

impl Protocol {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 8] = [
        Self::LangSplat,
        Self::FourDLangSplat,
        Self::Davis,
        Self::Mevis,
        Self::GaussianGrouping,
        Self::R4d,
        Self::Votsr,
        Self::Saco,
    ];

    /// What tells it from the others.
    pub fn rules(self) -> &'static Rules {
        match self {
            Self::LangSplat => &langsplat::RULES,
            Self::FourDLangSplat => &four_d_langsplat::RULES,
            Self::Davis => &davis::RULES,
            Self::Mevis => &mevis::RULES,
            Self::GaussianGrouping => &gaussian_grouping::RULES,
            Self::R4d => &r4d::RULES,
            Self::Votsr => &votsr::RULES,
            Self::Saco => &saco::RULES,
        }
    }

    /// The sentences that are judged where the queries are asked for: those of SA-Co have to be told from sentences that
    /// nothing satisfies.
    pub fn set(self, wanted: QuerySet) -> QuerySet {
        let needs_absents = self == Self::Saco && wanted == QuerySet::Queries;
        if needs_absents { QuerySet::WithAbsents } else { wanted }
    }

    /// Name in options, files and tables.
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}
