//! Queries: what a model is shown and asked about a scene, what it may answer, and what becomes of each answer.

mod brief;
mod exam;
mod proposal;
mod record;
mod run;

pub use brief::{ClipPicture, PictureChoice, clip_pictures, question};
pub use exam::{Exam, Outcome};
pub use proposal::Proposal;
pub use record::{Failed, Records, Sorted, Unproved, sort};
pub use run::{Prepared, QueryProposer, SceneOutcome};
