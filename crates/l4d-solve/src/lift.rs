//! 4D lifting (paper, section 4, "4D Grounding Lifting"): masks of a few views in, an answer in four dimensions out.
//!
//! Owns evidence, everything that turns it into an answer ([`closed`], [`field`]), and what can be done with one:
//! masks from any camera at any time, a folder on disk. Refuses to know how masks were found, which
//! views were trusted, and where cameras and models come from.

mod answer;
mod closed;
mod error;
mod evidence;
mod field;
mod labels;
mod rendered_model;
#[cfg(test)]
mod tests;

pub use answer::{Answer, Layer};
pub use closed::ClosedSettings;
pub use error::LiftError;
pub use evidence::{Evidence, EvidenceFrame, EvidenceView};
pub use field::{FieldSettings, Network};
pub use labels::Labels;
pub use rendered_model::{ModelStates, RenderedModel};

use serde::{Deserialize, Serialize};

/// Which lift, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum LiftSettings {
    /// Labels from sums.
    Closed(ClosedSettings),
    /// The identity field of the paper.
    Field(FieldSettings),
}

/// Lifts evidence onto a model. None without a picture that could be lifted.
///
/// # Errors
/// Evidence that contradicts itself, settings outside their ranges, a model that cannot be drawn.
pub fn lift(
    rendered: &RenderedModel<'_>,
    evidence: &Evidence,
    settings: &LiftSettings,
) -> Result<Option<Answer>, LiftError> {
    if evidence.views.iter().all(|view| view.frames.is_empty()) {
        return Ok(None);
    }
    let answer = match settings {
        LiftSettings::Closed(settings) => Answer::Labels(closed::labels(rendered, evidence, settings)?),
        LiftSettings::Field(settings) => Answer::Field(Box::new(field::learn(rendered, evidence, settings)?)),
    };
    Ok(Some(answer))
}
