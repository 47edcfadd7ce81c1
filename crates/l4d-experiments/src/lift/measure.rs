//! Lifts the evidence of a query, and judges what the held-out view then shows.

use std::time::Instant;

use l4d_data::Query;
use l4d_ground::{Grounder, Grounding, Question};
use l4d_masks::Mask;
use l4d_solve::consensus::{Preset, Proposal, consensus};
use l4d_solve::lift::{Evidence, LiftSettings, RenderedModel, lift};
use l4d_splat::raster::Rasterizer;

use super::flicker::flicker;
use crate::Result;
use crate::judged_scene::JudgedScene;

/// What a query gives to lift, and what should come of it.
pub(super) struct Subject<'a> {
    judged: &'a JudgedScene<'a>,
    query: &'a Query,
    evidence: Evidence,
    truth: Vec<Mask>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) lift_seconds: f64,
    pub(super) mask_seconds: f64,
    /// 0 to 1.
    pub(super) miou: f64,
    pub(super) tube_iou: f64,
    /// Percent.
    pub(super) flicker: Option<f64>,
}

impl<'a> Subject<'a> {
    /// Evidence is what solve would lift.
    pub(super) fn new(
        judged: &'a JudgedScene<'a>,
        query: &'a Query,
        grounder: &dyn Grounder,
    ) -> Result<Self> {
        let (clips, question) = (&judged.scene.clips, Question::from(query));
        let groundings: Vec<Grounding> = clips.iter().map(|clip| grounder.ground(clip, &question)).collect();
        let agreed = consensus(&Proposal::of(clips, &groundings), &Preset::Robust.settings());
        let evidence = Evidence::of(clips, &groundings, &agreed.evidence)?;
        Ok(Self { judged, query, evidence, truth: truth(judged, query)? })
    }

    /// None if the target is never present.
    pub(super) fn measure(
        &self,
        lift_settings: &LiftSettings,
        rasterizer: &dyn Rasterizer,
    ) -> Result<Option<Sample>> {
        let Self { judged, query, evidence, .. } = self;
        // No lift profits from what the one before it has worked out.
        let rendered = RenderedModel { states: None, ..judged.scene.rendered(rasterizer) };
        let begin = Instant::now();
        let lifted = lift(&rendered, evidence, lift_settings)?;
        let lift_seconds = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let masks = judged.scene.masks(rasterizer, lifted.as_ref(), &judged.plan)?;
        let mask_seconds = begin.elapsed().as_secs_f64();
        let ratios = judged.tally(query, &masks)?.ratios();
        let flicker = flicker(&masks.into_values().collect::<Vec<_>>(), &self.truth);
        let sample = |(miou, tube_iou)| Sample { lift_seconds, mask_seconds, miou, tube_iou, flicker };
        Ok(ratios.miou.zip(ratios.tube_iou).map(sample))
    }
}

/// What is asked for in the held-out view, by time.
fn truth(judged: &JudgedScene<'_>, query: &Query) -> Result<Vec<Mask>> {
    let (truth, referents) = (&judged.truth, judged.referents(query)?);
    let at = |frame: u32| {
        let position = truth.position(frame);
        let target = position.and_then(|position| truth.target(query, &referents, position));
        target.map_or_else(|| Mask::empty(truth.width, truth.height), |target| target.mask().clone())
    };
    Ok(judged.plan.instants.iter().filter_map(|instant| instant.frame).map(at).collect())
}
