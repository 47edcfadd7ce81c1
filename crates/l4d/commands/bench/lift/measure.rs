//! Lifts the evidence of queries in every way, one after another, and judges what the held-out view then shows.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::{Context as _, Result};
use l4d_data::Query;
use l4d_frames::Mask;
use l4d_ground::{Grounder, Grounding};
use l4d_solve::clips::Shot;
use l4d_solve::consensus::{Preset, Proposal, consensus};
use l4d_solve::lift::{Answer, Canvas, Evidence, EvidenceView, Lifted, lift};
use l4d_solve::solve::Method;

use super::flicker::flicker;
use super::ways::Way;
use crate::commands::solve::question_of;
use crate::rasterizer;
use crate::solver::{Grounders, Stage};

/// What is added up over queries for one row.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sums {
    pub(super) queries: usize,
    pub(super) lift_seconds: f64,
    pub(super) mask_seconds: f64,
    /// 0 to 1.
    pub(super) miou: f64,
    pub(super) tube_iou: f64,
    /// Percent, over the queries that have it.
    pub(super) flicker: f64,
    pub(super) flicker_queries: usize,
}

/// Adds some queries of a scene to the sums, which belong to the rows of all ways in their order.
pub(super) fn measure_scene(
    stage: &Stage<'_>,
    grounders: &Grounders,
    opened: &rasterizer::Opened,
    ways: &[Way],
    count: usize,
    sums: &mut [Sums],
    progress: &dyn Fn(),
) -> Result<()> {
    let all: Vec<Query> = stage.queries().cloned().collect();
    let grounder = grounders.of_scene(&stage.scene.name, &stage.places.data, &all)?;
    let bench = Bench { stage, opened, grounder: grounder.as_ref() };
    for query in evenly(&all, count) {
        bench.measure_query(query, ways, sums, progress).with_context(|| query.id.to_string())?;
    }
    Ok(())
}

struct Bench<'a> {
    stage: &'a Stage<'a>,
    opened: &'a rasterizer::Opened,
    grounder: &'a dyn Grounder,
}

impl Bench<'_> {
    fn measure_query(
        &self,
        query: &Query,
        ways: &[Way],
        sums: &mut [Sums],
        progress: &dyn Fn(),
    ) -> Result<()> {
        let evidence = self.evidence(query)?;
        let truth = self.truth(query)?;
        // No lift profits from what the one before it has worked out.
        let canvas = Canvas { moments: None, ..self.stage.scene.canvas(self.opened.rasterizer.as_ref()) };
        let mut rows = sums.iter_mut();
        for way in ways {
            let begin = Instant::now();
            let lifted = match evidence.views.is_empty() {
                true => None,
                false => Some(lift(&canvas, &evidence, &way.lift, &mut |_| ControlFlow::Continue(()))?),
            };
            let lift_seconds = begin.elapsed().as_secs_f64();
            for (read, row) in read_outs(way, lifted).into_iter().zip(&mut rows) {
                self.judge(query, read.as_ref(), &truth, lift_seconds, row)?;
            }
            progress();
        }
        Ok(())
    }

    /// What solve would lift.
    fn evidence(&self, query: &Query) -> Result<Evidence> {
        let (clips, question) = (&self.stage.scene.clips, question_of(query));
        let groundings: Vec<Grounding> =
            clips.iter().map(|clip| self.grounder.ground(clip, &question)).collect();
        let pairs = || clips.iter().zip(&groundings);
        let proposals: Vec<Proposal<'_>> =
            pairs().map(|(clip, grounding)| Proposal { clip, grounding }).collect();
        let agreed = consensus(&proposals, &Preset::Robust.settings());
        let believed = pairs().enumerate().filter(|(view, _)| agreed.evidence.contains(view));
        let views = believed.map(|(_, (clip, grounding))| EvidenceView::of_clip(clip, &grounding.masks));
        Ok(Evidence { views: views.collect::<Result<_, _>>()? })
    }

    /// What is asked for in the held-out view, by time.
    fn truth(&self, query: &Query) -> Result<Vec<Mask>> {
        let (truth, referents) = (&self.stage.truth, self.stage.referents(query)?);
        let at = |frame: u32| {
            let position = truth.position(frame);
            let target = position.and_then(|position| truth.target(query, &referents, position));
            target.map_or_else(|| Mask::empty(truth.width, truth.height), |target| target.mask().clone())
        };
        Ok(self.stage.judged.instants.iter().filter_map(|instant| instant.frame).map(at).collect())
    }

    fn judge(
        &self,
        query: &Query,
        lifted: Option<&Lifted>,
        truth: &[Mask],
        lift_seconds: f64,
        row: &mut Sums,
    ) -> Result<()> {
        let settings = Preset::Robust.solve_settings();
        let method = Method {
            grounder: self.grounder,
            rasterizer: self.opened.rasterizer.as_ref(),
            settings: &settings,
        };
        let begin = Instant::now();
        let masks: BTreeMap<Shot, Mask> = method.masks(&self.stage.scene, lifted, &self.stage.judged)?;
        let mask_seconds = begin.elapsed().as_secs_f64();
        let ratios = self.stage.tally(query, &masks)?.ratios();
        let (Some(miou), Some(tube_iou)) = (ratios.miou, ratios.tube_iou) else { return Ok(()) };
        row.queries += 1;
        row.lift_seconds += lift_seconds;
        row.mask_seconds += mask_seconds;
        row.miou += miou;
        row.tube_iou += tube_iou;
        let answer: Vec<Mask> = masks.into_values().collect();
        if let Some(flicker) = flicker(&answer, truth) {
            row.flicker += flicker;
            row.flicker_queries += 1;
        }
        Ok(())
    }
}

/// The answer, read in each of the ways.
fn read_outs(way: &Way, lifted: Option<Lifted>) -> Vec<Option<Lifted>> {
    if way.read_outs.is_empty() {
        return vec![lifted];
    }
    let read = |&read_out| {
        let mut lifted = lifted.clone();
        if let Some(Lifted { answer: Answer::Field(field), .. }) = &mut lifted {
            field.read_out = read_out;
        }
        lifted
    };
    way.read_outs.iter().map(read).collect()
}

/// So many of a list, from the middles of as many equal parts.
fn evenly<T>(list: &[T], count: usize) -> Vec<&T> {
    let count = count.min(list.len());
    (0..count).filter_map(|part| list.get((2 * part + 1) * list.len() / (2 * count))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_list_comes_from_all_over_it() {
        assert_eq!(evenly(&[0, 1, 2, 3, 4, 5, 6, 7], 2), [&2, &6]);
        assert_eq!(evenly(&[0, 1, 2], 5), [&0, &1, &2]);
        assert_eq!(evenly(&[0, 1, 2], 1), [&1]);
        assert!(evenly::<u8>(&[], 3).is_empty());
    }
}
