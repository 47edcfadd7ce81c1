//! Sentences over a made-up scene, said and read, and the shipped set read.
#![expect(clippy::unwrap_used, reason = "a test that cannot make its scene has failed")]

#[path = "english/made_up.rs"]
mod made_up;
#[path = "english/predicates.rs"]
mod predicates;
#[path = "english/round_trip.rs"]
mod round_trip;
#[path = "english/sentences.rs"]
mod sentences;
#[path = "english/shipped.rs"]
mod shipped;
