//! Carries sentences over to another draw of a scene: who do they mean there, and when?
//!
//! Sentence and predicate stay as they are; referents and frames follow from the tracks of the new draw. What people
//! verified on one draw they have not verified on another.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::timeline::MIN_INTERVAL;
use l4d_data::{Interval, Name, Query, Report, Severity, Status, Temporal};

use crate::ast::Predicate;
use crate::eval::{Answer, answer_times, answer_whole};
use crate::prove::{Kind, Prover};
use crate::times::{Times, any_of};
use crate::world::World;

/// The query with the referent and the frames that it has in the prover's scene and is proved to have, or why it has
/// none.
///
/// # Errors
/// A predicate that holds of nothing, or names what is not there.
pub fn reground(prover: &Prover<'_>, kind: Kind, query: &Query) -> Result<Query, String> {
    let world = prover.world();
    let value = query.predicate.as_ref().ok_or("has no predicate")?;
    let predicate = Predicate::from_json(value)?;
    let (referents, frames) = match query.temporal {
        Temporal::Whole => (answer_whole(world, &predicate), vec![Interval::WHOLE]),
        Temporal::While => while_it_holds(world, &predicate)?,
    };
    let referents = distinct(world, &predicate, query, referents)?;
    proved(prover, kind, Query { referents, frames, status: Status::Candidate, ..query.clone() })
}

/// Whether nothing satisfies an absent-referent sentence, at any time and with room to spare.
pub fn stays_absent(prover: &Prover<'_>, query: &Query) -> bool {
    proved(prover, Kind::Absent, query.clone()).is_ok()
}

fn proved(prover: &Prover<'_>, kind: Kind, query: Query) -> Result<Query, String> {
    let mut report = Report::default();
    prover.check(kind, Path::new(""), &query, &mut report);
    let errors = report.into_sorted().into_iter().filter(|finding| finding.severity == Severity::Error);
    errors.map(|finding| finding.message).next().map_or(Ok(query), Err)
}

fn while_it_holds(world: &World<'_>, predicate: &Predicate) -> Result<(Answer, Vec<Interval>), String> {
    let times = answer_times(world, predicate);
    let holds: Times = any_of(times.values().copied());
    let frames = holds.intervals();
    if let Some(short) = frames.iter().find(|interval| interval.frame_count() < MIN_INTERVAL) {
        return Err(format!("holds only in frames {}..{}", short.first(), short.last()));
    }
    if times.values().any(|own| *own != holds) {
        return Err(format!("means different things at different times: {}", join(times.keys())));
    }
    Ok((times.into_keys().collect(), frames))
}

/// As many referents as before, and look-alikes that are none of them.
fn distinct(
    world: &World<'_>,
    predicate: &Predicate,
    query: &Query,
    answer: Answer,
) -> Result<Vec<Name>, String> {
    if answer.is_empty() {
        return Err("means nothing".to_owned());
    }
    if answer.len() != query.referents.len() {
        return Err(format!("means {}", join(answer.iter())));
    }
    for category in predicate.categories() {
        let without: BTreeSet<Name> = answer_whole(world, &predicate.without(category));
        if without.len() <= answer.len() {
            return Err(format!("means the same without its {} clause", category.as_str()));
        }
    }
    Ok(answer.into_iter().collect())
}

fn join<'a>(names: impl Iterator<Item = &'a Name>) -> String {
    names.map(Name::as_str).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{event, query, standing, tracks};
    use l4d_data::tracks::Tracks;

    fn draw(events: &str) -> Tracks {
        let instances = [
            standing(1, "cup_a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(2, "cup_b", "cup", [1., 0., 0.], [0.1; 3]),
            standing(1001, "hand", "hand", [0., 0.5, 0.], [0.1; 3]),
        ];
        tracks(&instances, events, "")
    }

    fn lifted() -> Query {
        let clause = r#"{"undergoes":{"verb":"lift","by":{"category":"hand"}}}"#;
        query("The cup that a hand lifts", &["cup_a"], clause)
    }

    fn while_lifted() -> Query {
        let text = "The cup while a hand lifts it".to_owned();
        let frames = vec![Interval::new(10, 30).unwrap()];
        Query { text, temporal: Temporal::While, frames, ..lifted() }
    }

    fn absent() -> Query {
        Query { referents: Vec::new(), ..lifted() }
    }

    fn lift(cup: &str, frames: [u32; 2]) -> String {
        event("hand", "lift", Some(cup), frames)
    }

    #[test]
    fn another_draw_has_another_answer() {
        let tracks = draw(&lift("cup_b", [40, 60]));
        let prover = Prover::new(&tracks, None, None);
        let whole = reground(&prover, Kind::Single, &lifted()).unwrap();
        assert_eq!(whole.referents, [Name::new("cup_b").unwrap()]);
        assert_eq!(whole.frames, [Interval::WHOLE]);
        assert_eq!(whole.status, Status::Candidate);
        let gated = reground(&prover, Kind::Single, &while_lifted()).unwrap();
        assert_eq!(gated.referents, [Name::new("cup_b").unwrap()]);
        assert_eq!(gated.frames, [Interval::new(40, 60).unwrap()]);
        assert!(!stays_absent(&prover, &absent()));
    }

    #[test]
    fn what_means_nothing_or_two_things_is_left_out() {
        let both = draw(&format!("{},{}", lift("cup_a", [0, 20]), lift("cup_b", [40, 60])));
        let prover = Prover::new(&both, None, None);
        assert_eq!(reground(&prover, Kind::Single, &lifted()).unwrap_err(), "means cup_a, cup_b");
        let message = reground(&prover, Kind::Single, &while_lifted()).unwrap_err();
        assert!(message.contains("different times"), "{message}");
        let nothing = draw("");
        let prover = Prover::new(&nothing, None, None);
        assert_eq!(reground(&prover, Kind::Single, &lifted()).unwrap_err(), "means nothing");
        assert!(stays_absent(&prover, &absent()));
    }
}
