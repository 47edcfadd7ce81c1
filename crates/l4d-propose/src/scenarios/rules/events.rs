//! What happens: known verbs, known parties, times that every profile can see, nothing that contradicts itself.

use std::collections::BTreeSet;

use l4d_data::Interval;
use l4d_data::timeline::{LAST_FRAME, MIN_INTERVAL};
use l4d_query::verbs::{is_moving, is_state};

use super::super::Draft;
use super::super::spec::DraftEvent;
use super::Known;
use crate::listing::excerpt;
use crate::reason::Reason;

const CODE: &str = "L4D574";
const FEWEST: usize = 3;
const MOST: usize = 60;
/// Events that last for only a part of the clip.
const FEWEST_IN_TIME: usize = 2;
/// No declared motion repeats faster: 24 frames a second could not show it.
const FASTEST_LOOP_HZ: f64 = 3.0;

pub(super) fn problems(draft: &Draft, known: &Known) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let events = &draft.events;
    let refuse = |message: String, hint: &str| Reason::new(CODE, "events", message, hint);
    if !(FEWEST..=MOST).contains(&events.len()) {
        let message = format!("there are {}", events.len());
        reasons.push(refuse(message, "a scene has 3 to 60 events"));
    }
    let passing = events.iter().filter(|event| event.frames != Interval::WHOLE).count();
    if passing < FEWEST_IN_TIME {
        let message = format!("{passing} of them last for only a part of the clip");
        reasons.push(refuse(message, "let at least two begin or end inside the clip"));
    }
    let objects = draft.objects().map(|(_, member)| member.name.as_str());
    let things: BTreeSet<&str> =
        objects.chain(draft.landmarks.iter().map(|landmark| landmark.name.as_str())).collect();
    for (index, event) in events.iter().take(MOST).enumerate() {
        let before = &events[..index];
        let own = event_problems(event, &things, known).into_iter().chain(contradiction(event, before));
        reasons.extend(own.map(|(message, hint)| Reason::new(CODE, place(event), message, hint)));
    }
    reasons
}

fn event_problems(event: &DraftEvent, things: &BTreeSet<&str>, known: &Known) -> Vec<(String, &'static str)> {
    let mut found = Vec::new();
    for name in std::iter::once(&event.subject).chain(&event.object) {
        if !things.contains(name.as_str()) {
            found.push((format!("`{}` is no object or landmark", excerpt(name)), "name what the scene has"));
        }
    }
    if event.object.as_ref() == Some(&event.subject) {
        found.push(("is done by something to itself".to_owned(), "leave the object empty"));
    }
    if !known.verbs.contains(&event.verb) {
        let message = format!("`{}` is not in the lexicon", excerpt(&event.verb));
        found.push((
            message,
            "use a known verb, or add it to crates/l4d-query/src/verbs.rs if it means something for geometry",
        ));
    }
    let (first, last) = (event.frames.first(), event.frames.last());
    if last > LAST_FRAME || event.frames.frame_count() < MIN_INTERVAL {
        let message = format!(
            "[{first}, {last}] must lie in 0 to {LAST_FRAME} and be at least {MIN_INTERVAL} frames long"
        );
        found.push((message, "every profile must sample it"));
    }
    if !(0.0..=FASTEST_LOOP_HZ).contains(&event.loop_hz) {
        let message = format!("repeats {} times a second", event.loop_hz);
        found.push((message, "nothing repeats faster than 3 times a second; 0 is for what happens once"));
    }
    found
}

/// What cannot be true together with an earlier event.
fn contradiction(event: &DraftEvent, before: &[DraftEvent]) -> Option<(String, &'static str)> {
    let meets = |other: &&DraftEvent| {
        other.subject == event.subject
            && other.frames.first() <= event.frames.last()
            && event.frames.first() <= other.frames.last()
    };
    let moves = |event: &DraftEvent| is_moving(&event.verb);
    let rests = |event: &DraftEvent| is_state(&event.verb);
    before.iter().filter(meets).find_map(|other| {
        if other.verb == event.verb && other.object == event.object {
            return Some(("occurs twice at the same time".to_owned(), "make one event of both"));
        }
        let at_odds = (moves(event) && rests(other)) || (rests(event) && moves(other));
        at_odds.then(|| {
            let message =
                format!("cannot {} and {} at the same time", excerpt(&event.verb), excerpt(&other.verb));
            (message, "let the one begin when the other ends")
        })
    })
}

fn place(event: &DraftEvent) -> String {
    let object = event.object.as_ref().map_or_else(String::new, |object| format!(" {object}"));
    excerpt(&format!("event {} {}{object}", event.subject, event.verb))
}
