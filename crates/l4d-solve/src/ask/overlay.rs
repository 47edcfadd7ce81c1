//! What an answer looks like: a sheet of some moments, and pages of a moving picture.

use std::collections::BTreeMap;

use l4d_data::StageError;
use l4d_frames::drawn::{RgbImage, picture_of};
use l4d_frames::moving_picture::Pages;
use l4d_masks::Mask;

use crate::clips::{Plan, Shot};
use crate::lift::{LiftError, Lifted};
use crate::scene::SolveScene;
use crate::show;
use crate::solve::{Method, SolveError};

/// Moments on the sheet.
const COLUMNS: usize = 5;

/// The first camera at some moments: those in which the answer is seen, if there are any.
pub(super) fn sheet(
    method: &Method<'_>,
    scene: &SolveScene,
    lifted: Option<&Lifted>,
    plan: &Plan,
    masks: &BTreeMap<Shot, Mask>,
    title: &str,
) -> Result<RgbImage, SolveError> {
    let all: Vec<Shot> = (0..plan.instants.len()).map(|instant| Shot { view: 0, instant }).collect();
    let seen = |shot: &&Shot| masks.get(*shot).is_some_and(|mask| !mask.is_empty());
    let seen: Vec<Shot> = all.iter().filter(seen).copied().collect();
    let from = if seen.is_empty() { &all } else { &seen };
    let count = COLUMNS.min(from.len());
    let place = |column: usize| if count < 2 { 0 } else { column * (from.len() - 1) / (count - 1) };
    let moments = (0..count)
        .map(|column| {
            let shot = from[place(column)];
            let caption = caption(plan, shot);
            Ok((caption, method.show(scene, lifted, plan, shot)?))
        })
        .collect::<Result<Vec<_>, SolveError>>()?;
    Ok(show::sheet(title, &moments))
}

fn caption(plan: &Plan, shot: Shot) -> String {
    let instant = &plan.instants[shot.instant];
    match instant.frame {
        Some(frame) => format!("{}, frame {frame}", plan.cameras[shot.view].name),
        None => format!("{}, time {}", plan.cameras[shot.view].name, instant.time),
    }
}

/// The first camera over the whole clip.
#[derive(Clone, Copy)]
pub(super) struct Overlay<'a> {
    pub(super) method: &'a Method<'a>,
    pub(super) scene: &'a SolveScene,
    pub(super) plan: &'a Plan,
    pub(super) masks: &'a BTreeMap<Shot, Mask>,
}

/// [`Overlay`], enlarged by a whole number.
pub(super) struct OverlayPages<'a> {
    overlay: Overlay<'a>,
    factor: u32,
}

impl<'a> Overlay<'a> {
    pub(super) fn pages(&self, widest_px: u32) -> Result<OverlayPages<'a>, StageError> {
        let factor = (widest_px / self.plan.size[0].max(1)).clamp(1, 4);
        Ok(OverlayPages { overlay: *self, factor })
    }
}

impl Pages for OverlayPages<'_> {
    fn size_px(&self) -> (u32, u32) {
        let [width, height] = self.overlay.plan.size;
        (width * self.factor, height * self.factor)
    }

    fn page(&self, index: usize) -> Result<RgbImage, StageError> {
        let Overlay { method, scene, plan, masks } = self.overlay;
        let shot = Shot { view: 0, instant: index };
        let time = plan.instants[index].time;
        let splats = scene.source.model.at(time).map_err(|source| LiftError::Model { time, source })?;
        let view = plan.view(shot)?;
        let drawing = method.rasterizer.prepare(&splats, &view, &scene.raster).and_then(|drawn| drawn.draw());
        let drawing = drawing.map_err(LiftError::from)?;
        let picture = picture_of(drawing.width, drawing.height, &drawing.colour);
        let empty = Mask::empty(drawing.width, drawing.height);
        Ok(show::outlined(&picture, masks.get(&shot).unwrap_or(&empty), self.factor))
    }
}
