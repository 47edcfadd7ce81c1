//! How the state changes: a message in, effects out. Nothing here reads a clock, a file or the terminal.

mod answer;
mod looking;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Duration;

use tui_input::InputRequest;

use crate::message::{Effect, Message};
use crate::model::{Mode, Model};
use crate::picture::Picture;

/// Applies a message; `now` is the time since the start of the session.
pub(crate) fn update(model: &mut Model, message: Message, now: Duration) -> Vec<Effect> {
    let showed_picture = model.requested.is_some();
    if is_deliberate(&message) {
        model.notice = None;
    }
    let mut effects = Vec::new();
    apply(model, message, now, &mut effects);
    request_picture(model, &mut effects);
    // Characters that are drawn over pixels do not remove them.
    if model.look.pixels && showed_picture != model.requested.is_some() {
        effects.push(Effect::Redraw);
    }
    effects
}

pub(crate) fn start(model: &mut Model) -> Vec<Effect> {
    let mut effects = Vec::new();
    request_picture(model, &mut effects);
    effects
}

fn apply(model: &mut Model, message: Message, now: Duration, effects: &mut Vec<Effect>) {
    match message {
        Message::Painted(picture) => return painted(model, picture),
        Message::NotPainted(request, why) => {
            if model.requested.as_ref() == Some(&request) {
                model.picture_error = Some(why);
            }
            return;
        }
        Message::Recorded(result) => return answer::recorded(model, result, now),
        Message::Sealed(result) => return answer::sealed(model, result),
        Message::Exported(Ok(text)) => return model.say(text),
        Message::Exported(Err(text)) => return model.complain(text),
        Message::Resize(size) => {
            model.size = size;
            return;
        }
        Message::Tick => return looking::tick(model, now),
        _ => {}
    }
    if model.help {
        return on_help_page(model, &message, effects);
    }
    match &model.mode {
        Mode::Choose | Mode::When => on_item(model, message, now, effects),
        Mode::Reason(_) | Mode::Comment(_) => in_text(model, message, now, effects),
        Mode::Summary { .. } => on_summary(model, &message, now, effects),
        Mode::Leave => on_leave(model, &message, effects),
    }
}

fn on_help_page(model: &mut Model, message: &Message, effects: &mut Vec<Effect>) {
    match message {
        Message::Quit => leave(model, effects),
        // Whatever key was pressed to see the scene again: it does that, and nothing else.
        _ => model.help = false,
    }
}

fn on_item(model: &mut Model, message: Message, now: Duration, effects: &mut Vec<Effect>) {
    match message {
        Message::Digit(digit) => answer::digit(model, digit),
        Message::None => answer::none(model),
        Message::Ambiguous => answer::ambiguous(model),
        Message::Accept => answer::accept(model, now, effects),
        Message::Back => answer::back(model),
        Message::Clear => answer::clear(model),
        Message::HoldsFrom => answer::holds_from(model),
        Message::HoldsUntil => answer::holds_until(model),
        Message::HoldsAlways => answer::holds_always(model),
        Message::Skip => answer::skip(model, now, effects),
        Message::Comment => model.mode = Mode::Comment(crate::field::Field::default()),
        Message::Undo => answer::undo(model, now, effects),
        Message::StepItem(step) => answer::step_item(model, step, now),
        Message::StepFrame(step) => looking::step_frame(model, step),
        Message::StepView(step) => looking::step_view(model, step),
        Message::Play => looking::play(model, now),
        Message::Zoom(steps) => looking::zoom(model, steps),
        Message::ZoomToChosen => looking::zoom_to_chosen(model),
        Message::Pan(right, down) => looking::pan(model, right, down),
        Message::Outlines => model.outlines = !model.outlines,
        Message::Export => looking::export(model, effects),
        Message::Summary => summarise(model),
        Message::Help => model.help = true,
        Message::Quit => leave(model, effects),
        _ => {}
    }
}

fn in_text(model: &mut Model, message: Message, now: Duration, effects: &mut Vec<Effect>) {
    let (Mode::Reason(field) | Mode::Comment(field)) = &mut model.mode else { return };
    match message {
        Message::Edit(edit) => field.edit(edit),
        Message::Paste(text) => field.paste(&text),
        Message::Digit(digit) => field.edit(InputRequest::InsertChar(digit)),
        Message::Accept => answer::finish_text(model, now, effects),
        Message::Back => model.mode = Mode::Choose,
        _ => {}
    }
}

fn on_summary(model: &mut Model, message: &Message, now: Duration, effects: &mut Vec<Effect>) {
    let count = model.unanswered().len();
    let Mode::Summary { selected, sealing } = &mut model.mode else { return };
    match message {
        Message::Accept if *sealing => effects.push(Effect::Seal),
        Message::Back | Message::Undo if *sealing => *sealing = false,
        _ if *sealing => {}
        Message::Quit => leave(model, effects),
        Message::Help => model.help = true,
        _ if model.sealed => {}
        Message::StepLine(step) => *selected = step_line(*selected, *step, count),
        Message::Accept => {
            let place = *selected;
            answer::open_unanswered(model, place, now);
        }
        Message::Back => model.mode = Mode::Choose,
        Message::Undo => answer::undo(model, now, effects),
        Message::StepItem(_) => model.mode = Mode::Choose,
        Message::Seal | Message::Summary => answer::ask_for_seal(model),
        _ => {}
    }
}

fn step_line(selected: usize, step: i64, count: usize) -> usize {
    (selected as i64).saturating_add(step).clamp(0, count.saturating_sub(1) as i64) as usize
}

fn on_leave(model: &mut Model, message: &Message, effects: &mut Vec<Effect>) {
    match message {
        Message::Quit | Message::Accept => effects.push(Effect::Quit),
        _ => model.mode = Mode::Choose,
    }
}

fn summarise(model: &mut Model) {
    model.playing = None;
    model.mode = Mode::Summary { selected: 0, sealing: false };
}

fn leave(model: &mut Model, effects: &mut Vec<Effect>) {
    model.help = false;
    if model.has_unsaved() {
        model.playing = None;
        model.mode = Mode::Leave;
    } else {
        effects.push(Effect::Quit);
    }
}

fn painted(model: &mut Model, picture: Arc<Picture>) {
    let request = &picture.request;
    // Answers to older requests are still better than what is on the screen, unless they show another scene.
    if request.scene != model.question().scene {
        return;
    }
    if model.requested.as_ref() == Some(request) {
        model.seen.views.insert(request.view.clone());
        model.seen.frames.insert(request.frame);
        model.picture_error = None;
    }
    model.picture = Some(picture);
}

fn request_picture(model: &mut Model, effects: &mut Vec<Effect>) {
    let wanted = model.wanted();
    if wanted == model.requested {
        return;
    }
    model.requested = wanted.clone();
    model.picture_error = None;
    let Some(request) = wanted else { return };
    if model.picture.as_deref().is_none_or(|picture| picture.request != request) {
        effects.push(Effect::Paint { request, ahead: model.frames_ahead() });
    }
}

/// Whether a message is something that the person did on purpose, after which an old notice is stale.
fn is_deliberate(message: &Message) -> bool {
    !matches!(
        message,
        Message::Painted(_)
            | Message::NotPainted(..)
            | Message::Recorded(_)
            | Message::Sealed(_)
            | Message::Exported(_)
            | Message::Resize(_)
            | Message::Tick
    )
}
