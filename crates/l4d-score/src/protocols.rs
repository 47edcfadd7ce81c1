//! The same masks under the rules of other evaluations.
//!
//! A number of a paper can only be set beside ours if it was counted alike. Each [`Protocol`] does the sums of its
//! source again, edges included, on masks that were made for this benchmark, and says what the source would have left
//! out on the way. `docs/protocols.md` explains the differences. Nothing here is a headline: none of it can be ranked,
//! and every table, file and document bears the name of the protocol.
//!
//! A protocol sees masks and truth. Where masks come from, and how relevancy was cut into them, is not its business;
//! what can only be told from relevancy is told where [`Summits`] are given.

mod boundary;
mod davis;
mod four_d_langsplat;
mod gaussian_grouping;
mod hc_stvg;
mod judged;
mod langsplat;
mod mevis;
mod opengaussian;
mod record;
mod region;
mod run;
mod seen;
mod sheet;

use std::fmt;
use std::str::FromStr;

pub use judged::{Judged, LeftOut, Value};
pub use record::{Origin, Record};
pub use run::{Protocolled, judge_answers, judge_results};
pub use seen::{Clip, Seen, Summits};
pub use sheet::{Row, Sheet, file_stem, render};

/// Whose evaluation is done again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Protocol {
    /// LangSplat, `eval/evaluate_iou_loc.py`.
    LangSplat,
    /// LangSplatV2, `eval_lerf.py`.
    LangSplatV2,
    /// 4D LangSplat, `eval/eval.py`.
    FourDLangSplat,
    /// DAVIS 2017, semi-supervised.
    Davis,
    /// MeViS, `tools/eval_mevis.py`.
    Mevis,
    /// Gaussian Grouping, `script/eval_lerf_mask.py`.
    GaussianGrouping,
    /// OpenGaussian, `scripts/compute_lerf_iou.py`.
    OpenGaussian,
    /// HC-STVG, `eval_hcvg.py`.
    HcStvg,
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

impl Protocol {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 8] = [
        Self::LangSplat,
        Self::LangSplatV2,
        Self::FourDLangSplat,
        Self::Davis,
        Self::Mevis,
        Self::GaussianGrouping,
        Self::OpenGaussian,
        Self::HcStvg,
    ];

    /// Name in options, files and tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::LangSplat => "langsplat",
            Self::LangSplatV2 => "langsplat-v2",
            Self::FourDLangSplat => "4d-langsplat",
            Self::Davis => "davis",
            Self::Mevis => "mevis",
            Self::GaussianGrouping => "gaussian-grouping",
            Self::OpenGaussian => "opengaussian",
            Self::HcStvg => "hc-stvg",
        }
    }

    /// The evaluation that is done again.
    pub fn source(self) -> &'static str {
        match self {
            Self::LangSplat => "LangSplat, eval/evaluate_iou_loc.py",
            Self::LangSplatV2 => "LangSplatV2, eval_lerf.py",
            Self::FourDLangSplat => "4D LangSplat, eval/eval.py",
            Self::Davis => "DAVIS 2017, semi-supervised",
            Self::Mevis => "MeViS, tools/eval_mevis.py",
            Self::GaussianGrouping => "Gaussian Grouping, script/eval_lerf_mask.py",
            Self::OpenGaussian => "OpenGaussian, scripts/compute_lerf_iou.py",
            Self::HcStvg => "HC-STVG, eval_hcvg.py, on the boxes around the masks",
        }
    }

    /// What the source reports, in the order of its [`Judged::values`].
    pub fn measures(self) -> &'static [Measure] {
        match self {
            Self::LangSplat | Self::LangSplatV2 => langsplat::MEASURES,
            Self::FourDLangSplat => four_d_langsplat::MEASURES,
            Self::Davis => davis::MEASURES,
            Self::Mevis => mevis::MEASURES,
            Self::GaussianGrouping => gaussian_grouping::MEASURES,
            Self::OpenGaussian => opengaussian::MEASURES,
            Self::HcStvg => hc_stvg::MEASURES,
        }
    }

    /// What a frame without an answer does to the source.
    pub fn on_missing(self) -> OnMissing {
        match self {
            Self::LangSplat | Self::LangSplatV2 | Self::FourDLangSplat | Self::Davis => OnMissing::Stops,
            Self::Mevis | Self::GaussianGrouping | Self::OpenGaussian | Self::HcStvg => OnMissing::OwnRule,
        }
    }

    /// Whether the source brings predictions of another size to that of the truth.
    pub fn resizes(self) -> bool {
        self == Self::GaussianGrouping
    }

    /// How values become one number.
    pub fn averaging(self) -> Averaging {
        match self {
            Self::LangSplat | Self::LangSplatV2 | Self::OpenGaussian => Averaging::PairsThenScenes,
            Self::FourDLangSplat | Self::GaussianGrouping => Averaging::QueriesThenScenes,
            Self::Davis | Self::Mevis | Self::HcStvg => Averaging::Queries,
        }
    }

    /// What one has to know before setting these numbers beside those of a paper.
    pub fn remark(self) -> &'static str {
        match self {
            Self::LangSplat => {
                "The source cuts relevancy at 0.7 of its own range and looks at frames that show the object; \
                 here masks are as they were given. Localization accuracy needs relevancy: `l4d import langsplat`."
            }
            Self::LangSplatV2 => {
                "On the same masks the sums are LangSplat's; the source differs before them (pool of 29, majority to \
                 the border), which only latents show: `l4d import langsplat`."
            }
            Self::FourDLangSplat => {
                "An answer of at least one pixel says that the sentence holds; the source says so where the \
                 features of time are closer to it than on average."
            }
            Self::Davis => "A query is an object. There are no void pixels.",
            Self::Mevis => "A query is an expression, a scene a video.",
            Self::GaussianGrouping => "The source writes masks above 128; here they are as they were given.",
            Self::OpenGaussian => {
                "The source cuts its silhouettes above 10 of 255; here masks are as they were given."
            }
            Self::HcStvg => {
                "The source is given boxes; here they are those around the masks, and time is counted in frames \
                 of the profile."
            }
        }
    }

    /// Judges the answers to one query.
    pub fn judge(self, clip: &Clip<'_>) -> Judged {
        match self {
            Self::LangSplat | Self::LangSplatV2 => langsplat::judge(clip),
            Self::FourDLangSplat => four_d_langsplat::judge(clip),
            Self::Davis => davis::judge(clip),
            Self::Mevis => mevis::judge(clip),
            Self::GaussianGrouping => gaussian_grouping::judge(clip),
            Self::OpenGaussian => opengaussian::judge(clip),
            Self::HcStvg => hc_stvg::judge(clip),
        }
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

impl FromStr for Protocol {
    type Err = UnknownProtocol;

    fn from_str(name: &str) -> Result<Self, UnknownProtocol> {
        Self::ALL.into_iter().find(|protocol| protocol.as_str() == name).ok_or(UnknownProtocol)
    }
}
