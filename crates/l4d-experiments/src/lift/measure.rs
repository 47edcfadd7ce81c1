//! Lifts the evidence of queries in every way, one after another, and judges what the held-out view then shows.

use std::cell::LazyCell;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use l4d_data::{At as _, Query};
use l4d_ground::{Grounder, Grounding, Question};
use l4d_masks::Mask;
use l4d_solve::clips::Shot;
use l4d_solve::consensus::{Preset, Proposal, consensus};
use l4d_solve::grounders::Grounders;
use l4d_solve::lift::{Answer, Canvas, Evidence, EvidenceView, Lifted, lift};
use l4d_solve::solve::Method;
use l4d_splat::raster::Rasterizer;

use super::flicker::flicker;
use super::samples::{Sample, Samples};
use super::variants::Variant;
use crate::Result;
use crate::judged_scene::JudgedScene;

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

impl Sums {
    fn add(&mut self, sample: &Sample) {
        let (Some(miou), Some(tube_iou)) = (sample.miou, sample.tube_iou) else { return };
        self.queries += 1;
        self.lift_seconds += sample.lift_seconds;
        self.mask_seconds += sample.mask_seconds;
        self.miou += miou;
        self.tube_iou += tube_iou;
        if let Some(flicker) = sample.flicker {
            self.flicker += flicker;
            self.flicker_queries += 1;
        }
    }
}

/// What is measured in every scene.
pub(super) struct Measurement<'a> {
    pub(super) grounders: &'a Grounders,
    pub(super) rasterizer: &'a dyn Rasterizer,
    pub(super) variants: &'a [Variant],
    /// Queries of a scene.
    pub(super) queries: usize,
    /// Folder of what a run that was killed has measured.
    pub(super) samples: &'a Path,
}

impl Measurement<'_> {
    /// Adds some queries of a scene to the sums, which belong to the rows of all variants in their order.
    pub(super) fn add_scene(
        &self,
        judged: &JudgedScene<'_>,
        sums: &mut [Sums],
        progress: &(dyn Fn() + Sync),
    ) -> Result<()> {
        let all: Vec<Query> = judged.queries().cloned().collect();
        let grounder = self.grounders.of_scene(&judged.scene, &judged.places.data, &all)?;
        let kept = Samples::of_scene(self.samples, judged, grounder.as_ref(), self.rasterizer);
        let bench = Bench { judged, rasterizer: self.rasterizer, grounder: grounder.as_ref(), kept };
        for query in evenly(&all, self.queries) {
            bench.add_query(query, self.variants, sums, progress).at(&query.id)?;
        }
        Ok(())
    }
}

struct Bench<'a> {
    judged: &'a JudgedScene<'a>,
    rasterizer: &'a dyn Rasterizer,
    grounder: &'a dyn Grounder,
    kept: Samples,
}

/// What a query gives to lift, and what should come of it.
struct Task<'a> {
    query: &'a Query,
    evidence: Evidence,
    truth: Vec<Mask>,
}

impl Bench<'_> {
    fn add_query(
        &self,
        query: &Query,
        variants: &[Variant],
        sums: &mut [Sums],
        progress: &(dyn Fn() + Sync),
    ) -> Result<()> {
        let task = LazyCell::new(|| self.task(query));
        let mut rows = sums.iter_mut();
        for variant in variants {
            let samples = match self.kept.read(query, variant)? {
                Some(samples) => samples,
                None => {
                    let task = task.as_ref().map_err(Clone::clone)?;
                    let samples = self.measure(task, variant)?;
                    self.kept.write(query, variant, &samples)?;
                    samples
                }
            };
            samples.iter().zip(&mut rows).for_each(|(sample, row)| row.add(sample));
            progress();
        }
        Ok(())
    }

    fn task<'q>(&self, query: &'q Query) -> Result<Task<'q>> {
        Ok(Task { query, evidence: self.evidence(query)?, truth: self.truth(query)? })
    }

    fn measure(&self, task: &Task<'_>, variant: &Variant) -> Result<Vec<Sample>> {
        // No lift profits from what the one before it has worked out.
        let canvas = Canvas { states: None, ..self.judged.scene.canvas(self.rasterizer) };
        let begin = Instant::now();
        let lifted = match task.evidence.views.is_empty() {
            true => None,
            false => Some(lift(&canvas, &task.evidence, &variant.lift, &mut |_| ControlFlow::Continue(()))?),
        };
        let lift_seconds = begin.elapsed().as_secs_f64();
        let read_outs = read_outs(variant, lifted);
        read_outs.iter().map(|read| self.judge(task, read.as_ref(), lift_seconds)).collect()
    }

    /// What solve would lift.
    fn evidence(&self, query: &Query) -> Result<Evidence> {
        let (clips, question) = (&self.judged.scene.clips, Question::from(query));
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
        let (truth, referents) = (&self.judged.truth, self.judged.referents(query)?);
        let at = |frame: u32| {
            let position = truth.position(frame);
            let target = position.and_then(|position| truth.target(query, &referents, position));
            target.map_or_else(|| Mask::empty(truth.width, truth.height), |target| target.mask().clone())
        };
        Ok(self.judged.plan.instants.iter().filter_map(|instant| instant.frame).map(at).collect())
    }

    fn judge(&self, task: &Task<'_>, lifted: Option<&Lifted>, lift_seconds: f64) -> Result<Sample> {
        let settings = Preset::Robust.solve_settings();
        let method = Method { grounder: self.grounder, rasterizer: self.rasterizer, settings: &settings };
        let begin = Instant::now();
        let masks: BTreeMap<Shot, Mask> = method.masks(&self.judged.scene, lifted, &self.judged.plan)?;
        let mask_seconds = begin.elapsed().as_secs_f64();
        let ratios = self.judged.tally(task.query, &masks)?.ratios();
        let answer: Vec<Mask> = masks.into_values().collect();
        Ok(Sample {
            lift_seconds,
            mask_seconds,
            miou: ratios.miou,
            tube_iou: ratios.tube_iou,
            flicker: flicker(&answer, &task.truth),
        })
    }
}

/// The answer, read in each of its ways.
fn read_outs(variant: &Variant, lifted: Option<Lifted>) -> Vec<Option<Lifted>> {
    if variant.read_outs.is_empty() {
        return vec![lifted];
    }
    let read = |&read_out| {
        let mut lifted = lifted.clone();
        if let Some(Lifted { answer: Answer::Field(field), .. }) = &mut lifted {
            field.read_out = read_out;
        }
        lifted
    };
    variant.read_outs.iter().map(read).collect()
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
