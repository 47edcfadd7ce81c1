//! A scene with all that is needed to answer about it and to judge the answer in one process, for measurements that
//! leave no answers on disk.
//!
//! The judge is that of `l4d score`. The solver never sees the truth that lies beside it here.

use std::collections::BTreeMap;

use l4d_data::{Query, Status, Workspace};
use l4d_masks::Mask;
use l4d_score::counts::FrameCount;
use l4d_score::eval_set::EvalScene;
use l4d_score::judge::{Answer, QueryJudge};
use l4d_score::metrics::{QueryFacts, QueryTally};
use l4d_score::truth::SceneTruth;
use l4d_score::{EvalSet, Options};
use l4d_solve::clips::{PictureIndex, Plan};
use l4d_solve::scene::{ClipSettings, Places, SolveScene};
use l4d_splat::raster::Rasterizer;
use l4d_splat::source::ReaderOptions;
use serde_json::Value;

use crate::Result;

/// A scene between solver and judge.
pub(crate) struct JudgedScene<'a> {
    pub(crate) places: Places,
    pub(crate) scene: SolveScene,
    pub(crate) truth: SceneTruth,
    /// From where and when the judge wants masks.
    pub(crate) plan: Plan,
    eval_scene: &'a EvalScene,
}

impl<'a> JudgedScene<'a> {
    pub(crate) fn open(
        eval_scene: &EvalSet,
        asked: &'a EvalScene,
        space: &Workspace,
        clips: &ClipSettings,
        draws: (&dyn Rasterizer, Option<Value>),
    ) -> Result<Self> {
        let (name, profile) = (&asked.name, eval_scene.profile);
        let (data, work) = (space.scene(name), space.work(name));
        let places = Places { data, work, model: None, reader_options: ReaderOptions::default() };
        let scene = SolveScene::open(name, profile, &places, clips, draws, &|| {})?;
        Ok(Self {
            plan: scene.judged(&places)?,
            truth: eval_scene.truth(asked),
            places,
            scene,
            eval_scene: asked,
        })
    }

    /// The queries that are judged.
    pub(crate) fn queries(&self) -> impl Iterator<Item = &'a Query> + use<'a> {
        self.eval_scene.queries.iter().filter(|query| query.status != Status::Rejected)
    }

    /// What masks of the held-out view are worth.
    pub(crate) fn tally(&self, query: &Query, masks: &BTreeMap<PictureIndex, Mask>) -> Result<QueryTally> {
        let counts = self.counts(query, masks)?;
        Ok(QueryTally::of(QueryFacts::of(query, self.truth.scale), &counts, &Options::default()))
    }

    fn counts(&self, query: &Query, masks: &BTreeMap<PictureIndex, Mask>) -> Result<Vec<FrameCount>> {
        let frames: Vec<u32> = self.plan.instants.iter().filter_map(|instant| instant.frame).collect();
        let answer = |instant: usize| match masks.get(&PictureIndex { view: 0, instant }) {
            Some(mask) if !mask.is_empty() => Answer::Pixels(mask.clone()),
            Some(_) => Answer::Absent,
            None => Answer::Missing,
        };
        let answers: Vec<Answer> = (0..frames.len()).map(answer).collect();
        Ok(QueryJudge::new(&self.truth, query, &self.referents(query)?).clip(&frames, &answers))
    }

    /// Positions of the referents of a query among the instances of the truth.
    pub(crate) fn referents(&self, query: &Query) -> Result<Vec<usize>> {
        Ok(self.truth.referents(query, &self.eval_scene.queries_path)?)
    }
}
