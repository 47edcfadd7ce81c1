//! 4D lifting (paper, section 4, "4D Grounding Lifting"): masks of a few views in, an answer in four dimensions out.
//!
//! Owns evidence, everything that turns it into an answer ([`closed`], [`field`]), and what can be done with one:
//! masks from any camera at any time, edited scenes, a folder on disk. Refuses to know how masks were found, which
//! views were trusted, and where cameras and models come from.

mod canvas;
mod closed;
mod digest;
mod disk;
pub mod edit;
mod error;
mod evidence;
pub mod field;
mod labels;
mod layer;
mod lifted;
mod model_states;
mod progress;
mod tree;

pub use canvas::Canvas;
pub use closed::ClosedSettings;
pub use digest::ModelDigest;
pub use error::LiftError;
pub use evidence::{Evidence, EvidenceFrame, EvidenceView};
pub use field::{DistilSettings, Field, FieldSettings, Normalisation, ReadOut};
pub use labels::{Cut, Labels};
pub use layer::{Layer, masks};
pub use lifted::{Answer, Lifted};
pub use model_states::ModelStates;
pub use progress::{Listener, Phase, Progress};

use progress::Reporter;
use serde::{Deserialize, Serialize};

/// Which lift, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum LiftSettings {
    /// Labels from sums.
    Closed(ClosedSettings),
    /// The identity field of the paper.
    Field(FieldSettings),
    /// Labels from sums, learned by a field.
    Distil(DistilSettings),
}

impl LiftSettings {
    /// The field, as the paper has it.
    pub fn paper() -> Self {
        Self::Field(FieldSettings::paper())
    }

    /// The default for users.
    pub fn robust() -> Self {
        Self::Closed(ClosedSettings::robust())
    }
}

/// Lifts evidence onto a model. `listener` is called before every step and may end it.
///
/// # Errors
/// No evidence or evidence that contradicts itself, settings outside their ranges, a model that cannot be drawn,
/// [`LiftError::Cancelled`].
pub fn lift(
    canvas: &Canvas<'_>,
    evidence: &Evidence,
    settings: &LiftSettings,
    listener: &mut Listener<'_>,
) -> Result<Lifted, LiftError> {
    let mut report = Reporter::new(listener);
    let answer = match settings {
        LiftSettings::Closed(settings) => {
            Answer::Labels(closed::labels(canvas, evidence, settings, &mut report)?)
        }
        LiftSettings::Field(settings) => {
            Answer::Field(Box::new(field::learn(canvas, evidence, settings, &mut report)?))
        }
        LiftSettings::Distil(settings) => {
            let labels = closed::labels(canvas, evidence, &settings.labels, &mut report)?;
            Answer::Field(Box::new(field::distil(canvas, &labels, settings, &mut report)?))
        }
    };
    Ok(Lifted { model: ModelDigest::of(canvas.model), answer })
}
