//! A scene with all that is needed to answer about it and to judge the answer in one process, for measurements that
//! leave no answers on disk.
//!
//! The judge is that of `l4d score`. What answers never sees the truth that stands beside it here.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use l4d_data::layout::{SceneDir, WorkDir};
use l4d_data::{Query, Status};
use l4d_frames::Mask;
use l4d_score::counts::FrameCount;
use l4d_score::exam::SceneExam;
use l4d_score::judge::{Answer, judge_query};
use l4d_score::metrics::{QueryFacts, QueryTally};
use l4d_score::truth::SceneTruth;
use l4d_score::{Exam, Options};
use l4d_solve::clips::{Plan, Shot};
use l4d_solve::scene::{ClipSettings, Places, SolveScene};

use crate::rasterizer;

/// A scene between solver and judge.
pub(crate) struct Stage<'a> {
    pub(crate) places: Places,
    pub(crate) scene: SolveScene,
    pub(crate) truth: SceneTruth,
    /// From where and when the judge wants masks.
    pub(crate) judged: Plan,
    exam: &'a SceneExam,
}

impl<'a> Stage<'a> {
    pub(crate) fn open(
        exam: &Exam,
        asked: &'a SceneExam,
        data: &Path,
        work: &Path,
        clips: &ClipSettings,
        opened: &rasterizer::Opened,
    ) -> Result<Self> {
        let (name, profile) = (&asked.name, exam.profile);
        let places =
            Places { data: SceneDir::new(data, name), work: WorkDir::new(work, profile, name), model: None };
        let adapter = opened.adapter.as_ref().map(serde_json::to_value).transpose()?;
        let draws = (opened.rasterizer.as_ref(), adapter);
        let scene = SolveScene::open(name, profile, &places, clips, draws, &|| {})?;
        Ok(Self { judged: scene.judged(&places)?, truth: exam.truth(asked)?, places, scene, exam: asked })
    }

    /// The queries that are judged.
    pub(crate) fn queries(&self) -> impl Iterator<Item = &'a Query> + use<'a> {
        self.exam.queries.iter().filter(|query| query.status != Status::Rejected)
    }

    /// What masks of the held-out view are worth.
    pub(crate) fn tally(&self, query: &Query, masks: &BTreeMap<Shot, Mask>) -> Result<QueryTally> {
        let counts = self.counts(query, masks)?;
        Ok(QueryTally::of(QueryFacts::of(query, self.truth.scale), &counts, &Options::default()))
    }

    fn counts(&self, query: &Query, masks: &BTreeMap<Shot, Mask>) -> Result<Vec<FrameCount>> {
        let frames: Vec<u32> = self.judged.instants.iter().filter_map(|instant| instant.frame).collect();
        let answer = |instant: usize| match masks.get(&Shot { view: 0, instant }) {
            Some(mask) if !mask.is_empty() => Answer::Pixels(mask.clone()),
            Some(_) => Answer::Absent,
            None => Answer::Missing,
        };
        let answers: Vec<Answer> = (0..frames.len()).map(answer).collect();
        Ok(judge_query(&self.truth, query, &self.referents(query)?, &frames, &answers))
    }

    /// Positions of the referents of a query among the instances of the truth.
    pub(crate) fn referents(&self, query: &Query) -> Result<Vec<usize>> {
        Ok(self.truth.referents(query, &self.exam.queries_path)?)
    }
}
