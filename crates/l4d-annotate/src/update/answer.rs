//! What the person says: choosing, saving, skipping, taking back, sealing.

use std::time::Duration;

use l4d_data::Interval;
use l4d_votes::{Choice, Event, Response, ShownFrames};

use crate::draft::{Digit, Draft, DraftChoice};
use crate::field::Field;
use crate::message::{Effect, Recorded};
use crate::model::{Mode, Model};
use crate::viewport::Viewport;

pub(super) fn digit(model: &mut Model, digit: char) {
    let count = model.scene().objects.len();
    model.mode = Mode::Choose;
    if model.draft.digit(digit, count) == Digit::Unknown {
        model.complain(format!("There is no such object: the numbers go from 1 to {count}"));
    }
}

pub(super) fn none(model: &mut Model) {
    model.mode = Mode::Choose;
    let is_none = model.draft.choice == DraftChoice::None;
    let choice = if is_none { Draft::default().choice } else { DraftChoice::None };
    model.draft = Draft { choice, ..Draft::default() };
}

pub(super) fn ambiguous(model: &mut Model) {
    let reason = match &model.draft.choice {
        DraftChoice::Ambiguous(reason) => Field::new(reason),
        DraftChoice::Objects(_) | DraftChoice::None => Field::default(),
    };
    model.mode = Mode::Reason(reason);
}

pub(super) fn back(model: &mut Model) {
    match model.mode {
        Mode::When => model.mode = Mode::Choose,
        _ if model.playing.is_some() => model.playing = None,
        _ if !model.viewport.is_whole() => model.viewport = Viewport::WHOLE,
        _ => {}
    }
}

pub(super) fn clear(model: &mut Model) {
    model.mode = Mode::Choose;
    model.draft = Draft::default();
}

pub(super) fn holds_from(model: &mut Model) {
    let first = model.frame_number();
    let last = model.holds().last();
    hold(model, first, if last < first { model.scene().whole().last() } else { last });
}

pub(super) fn holds_until(model: &mut Model) {
    let last = model.frame_number();
    let first = model.holds().first();
    hold(model, if first > last { model.scene().whole().first() } else { first }, last);
}

pub(super) fn holds_always(model: &mut Model) {
    model.draft.frames = None;
}

fn hold(model: &mut Model, first: u32, last: u32) {
    if let Ok(frames) = Interval::new(first, last) {
        model.draft.frames = Some(frames).filter(|frames| *frames != model.scene().whole());
    }
}

/// Enter: objects lead to the question when, everything else is saved.
pub(super) fn accept(model: &mut Model, now: Duration, effects: &mut Vec<Effect>) {
    model.draft.finish_number();
    match (&model.mode, &model.draft.choice) {
        (_, DraftChoice::Objects(numbers)) if numbers.is_empty() => {
            model.complain("Choose objects by their numbers, or n for none, or a for ambiguous");
        }
        (Mode::Choose, DraftChoice::Objects(_)) => model.mode = Mode::When,
        _ => save(model, now, effects),
    }
}

fn save(model: &mut Model, now: Duration, effects: &mut Vec<Effect>) {
    let Some(mut answer) = model.draft.answer(model.scene()) else { return };
    if !matches!(answer.choice, Choice::Objects(_)) {
        // There is nothing that could hold at a time.
        answer.frames = model.scene().whole();
    }
    if model.question().response.answer.as_ref() == Some(&answer) {
        model.say("This is the saved answer already");
        return go_on(model, now);
    }
    record(model, Event::Choose(answer), now, effects);
}

pub(super) fn skip(model: &mut Model, now: Duration, effects: &mut Vec<Effect>) {
    if model.question().response.skipped {
        return go_on(model, now);
    }
    record(model, Event::Skip, now, effects);
}

pub(super) fn finish_text(model: &mut Model, now: Duration, effects: &mut Vec<Effect>) {
    match &model.mode {
        Mode::Reason(field) if field.text().is_empty() => {
            model.complain("Say what makes it ambiguous, or press Esc");
        }
        Mode::Comment(field) if field.text().is_empty() => model.mode = Mode::Choose,
        Mode::Reason(field) => {
            model.draft = Draft { choice: DraftChoice::Ambiguous(field.text()), ..Draft::default() };
            save(model, now, effects);
        }
        Mode::Comment(field) => {
            let text = field.text();
            record(model, Event::Comment { text }, now, effects);
        }
        _ => {}
    }
}

/// Takes back, in this order: what was not saved, the latest act on this item, the latest act at all.
pub(super) fn undo(model: &mut Model, now: Duration, effects: &mut Vec<Effect>) {
    let on_item = !matches!(model.mode, Mode::Summary { .. });
    if on_item && model.is_unsaved() {
        model.mode = Mode::Choose;
        model.recall_draft();
        return model.say("Took back what was not saved");
    }
    if !on_item || model.question().response == Response::default() {
        let place = model.undoable.as_ref().and_then(|item| place_of(model, item));
        match place {
            Some(place) => open(model, place, now),
            None => return model.say("There is nothing to take back"),
        }
    }
    record(model, Event::Undo, now, effects);
}

pub(super) fn step_item(model: &mut Model, step: i64, now: Duration) {
    let last = model.questions.len() as i64 - 1;
    let place = (model.at as i64 + step).clamp(0, last) as usize;
    if place == model.at {
        let which = if step < 0 { "first" } else { "last" };
        return model.say(format!("This is the {which} item; S shows what is left"));
    }
    open(model, place, now);
}

pub(super) fn open_unanswered(model: &mut Model, selected: usize, now: Duration) {
    match model.unanswered().get(selected) {
        Some(&place) => open(model, place, now),
        None => model.say("Everything is answered: S seals the ballot"),
    }
}

pub(super) fn ask_for_seal(model: &mut Model) {
    let open = model.questions.iter().filter(|question| question.response.is_open()).count();
    match &mut model.mode {
        _ if open > 0 => {
            let items = if open == 1 { "1 item is".to_owned() } else { format!("{open} items are") };
            model.complain(format!("{items} open: answer or skip before sealing"));
        }
        Mode::Summary { sealing, .. } => *sealing = true,
        _ => {}
    }
}

/// What the log said to an act. Only now does anything count as saved.
pub(super) fn recorded(model: &mut Model, result: Result<Recorded, String>, now: Duration) {
    let Recorded { item: id, event, response, undoable } = match result {
        Ok(recorded) => recorded,
        Err(why) => return model.complain(format!("NOT SAVED: {why}")),
    };
    let Some(place) = place_of(model, &id) else { return };
    let before = std::mem::replace(&mut model.questions[place].response, response);
    model.undoable = undoable;
    match event {
        Event::Choose(_) => {
            model.say(format!("Saved {id}"));
            go_on(model, now);
        }
        Event::Skip => {
            model.draft = Draft::default();
            model.say(format!("Skipped {id}; S lists what was skipped"));
            go_on(model, now);
        }
        Event::Comment { .. } => {
            model.mode = Mode::Choose;
            model.say("Saved the comment");
        }
        Event::Undo => taken_back(model, &before),
    }
}

fn taken_back(model: &mut Model, before: &Response) {
    let now = &model.question().response;
    let what = if now.comments.len() < before.comments.len() {
        "the comment"
    } else if before.skipped && !now.skipped {
        "the skip"
    } else {
        "the answer"
    };
    model.mode = Mode::Choose;
    // What was taken back is most often wanted again with one change.
    match (what, before.answer.clone()) {
        ("the answer", Some(answer)) => model.draft = model.draft_of(answer),
        _ => model.recall_draft(),
    }
    model.say(format!("Took back {what} of {}", model.question().id));
}

pub(super) fn sealed(model: &mut Model, result: Result<(), String>) {
    match result {
        Ok(()) => {
            model.sealed = true;
            model.mode = Mode::Summary { selected: 0, sealing: false };
        }
        Err(why) => {
            model.mode = Mode::Summary { selected: 0, sealing: false };
            model.complain(format!("NOT SEALED: {why}"));
        }
    }
}

/// To the next open item, from the beginning again if none follows, or to the summary.
fn go_on(model: &mut Model, now: Duration) {
    let count = model.questions.len();
    let places = (1..=count).map(|step| (model.at + step) % count);
    let next = places.into_iter().find(|&place| model.questions[place].response.is_open());
    let notice = model.notice.take();
    match next {
        Some(place) => open(model, place, now),
        None => {
            model.drafts.remove(&model.at);
            model.recall_draft();
            model.playing = None;
            model.mode = Mode::Summary { selected: 0, sealing: false };
        }
    }
    model.notice = notice;
}

/// Puts an item on the screen as if it were seen for the first time; what was entered there before is kept.
fn open(model: &mut Model, place: usize, now: Duration) {
    if place != model.at {
        keep_draft(model);
        model.at = place;
        model.picture = None;
        model.view = 0;
        model.frame = model.scene().opening;
        model.viewport = Viewport::WHOLE;
        model.outlines = true;
        model.playing = None;
        model.seen = ShownFrames::default();
        model.shown_at = now;
        match model.drafts.remove(&place) {
            Some(draft) => model.draft = draft,
            None => model.recall_draft(),
        }
    }
    model.mode = Mode::Choose;
}

fn keep_draft(model: &mut Model) {
    if model.is_unsaved() {
        model.drafts.insert(model.at, std::mem::take(&mut model.draft));
    }
}

fn record(model: &mut Model, event: Event, now: Duration, effects: &mut Vec<Effect>) {
    effects.push(Effect::Record {
        item: model.question().id.clone(),
        event,
        seen: model.seen.clone(),
        elapsed: now.saturating_sub(model.shown_at),
    });
}

fn place_of(model: &Model, item: &l4d_votes::ItemId) -> Option<usize> {
    model.questions.iter().position(|question| question.id == *item)
}
