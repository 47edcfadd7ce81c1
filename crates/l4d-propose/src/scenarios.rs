//! Scenarios: what a model is asked for, which specs it may give, and what becomes of each.
//!
//! A spec is an idea with a structure, no scene: a person turns it into a recipe under `blender_scripts/scenes`.

mod brief;
mod rules;
mod run;
mod spec;

pub use brief::question;
pub use rules::{Known, problems};
pub use run::{ScaleOutcome, ScenarioProposer};
pub use spec::{Draft, SCHEMA, Scenario};
