//! Where the person looks: frame, view, zoom, playing.

use std::time::Duration;

use glam::DVec2;

use crate::message::Effect;
use crate::model::{Mode, Model};
use crate::picture::ExportRequest;
use crate::viewport::Viewport;

/// How far a pan key moves, as a share of what is shown.
const PAN_STEP: f64 = 0.125;

pub(super) fn step_frame(model: &mut Model, step: i64) {
    model.playing = None;
    let last = model.scene().frames.len() as i64 - 1;
    model.frame = (model.frame as i64).saturating_add(step).clamp(0, last) as usize;
}

pub(super) fn step_view(model: &mut Model, step: i64) {
    let count = model.scene().views.len() as i64;
    model.view = (model.view as i64 + step).rem_euclid(count) as usize;
}

pub(super) fn play(model: &mut Model, now: Duration) {
    model.playing = match model.playing {
        Some(_) => None,
        None => Some(now + model.frame_time()),
    };
}

/// Shows the next frame if it is due and the one before is on the screen.
pub(super) fn tick(model: &mut Model, now: Duration) {
    let Some(due) = model.playing else { return };
    if now < due || model.is_loading() {
        return;
    }
    let (first, last) = played_frames(model);
    model.frame = if (first..last).contains(&model.frame) { model.frame + 1 } else { first };
    // Being late once must not make the rest of the clip run.
    model.playing = Some((due + model.frame_time()).max(now));
}

/// The whole clip; while the time is asked for, the part that the answer names.
fn played_frames(model: &Model) -> (usize, usize) {
    let frames = &model.scene().frames;
    let named = |frame: &u32| model.mode != Mode::When || model.holds().contains(*frame);
    let first = frames.iter().position(named);
    let last = frames.iter().rposition(named);
    (first.unwrap_or(0), last.unwrap_or(frames.len() - 1))
}

pub(super) fn zoom(model: &mut Model, steps: i32) {
    model.viewport = model.viewport.zoomed(steps);
}

/// Zooms to the chosen objects, to all of them if none is chosen, and back.
pub(super) fn zoom_to_chosen(model: &mut Model) {
    if !model.viewport.is_whole() {
        model.viewport = Viewport::WHOLE;
        return;
    }
    let chosen = model.chosen_ids();
    let ids = if chosen.is_empty() {
        model.scene().objects.iter().map(|object| object.id).collect()
    } else {
        chosen
    };
    match model.box_around(&ids) {
        Some(found) => model.viewport = Viewport::onto(found, model.scene().size),
        None => model.say("None of the chosen objects is in this picture"),
    }
}

pub(super) fn pan(model: &mut Model, right: i32, down: i32) {
    let by = DVec2::new(f64::from(right), f64::from(down)) * PAN_STEP;
    model.viewport = model.viewport.panned(by);
}

pub(super) fn export(model: &mut Model, effects: &mut Vec<Effect>) {
    let question = model.question();
    let view = &model.scene().views[model.view];
    let frame = model.frame_number();
    effects.push(Effect::Export(ExportRequest {
        scene: question.scene.clone(),
        view: view.clone(),
        frame,
        chosen: model.chosen_ids(),
        // Neither scene nor view: the name of the file says no more than the screen does.
        file_name: format!("{}-view{}-frame{frame:04}.png", question.id, model.view + 1),
    }));
    model.say("Writing the picture ...");
}
