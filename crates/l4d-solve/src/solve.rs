//! One question, from the sentence to an answer in four dimensions: grounding, consensus, lifting, masks.
//!
//! Owns the order of the stages and what of each is kept on disk. Refuses to know how any of them works.

use std::collections::BTreeMap;

use l4d_data::digest::sha256_hex;
use l4d_data::layout::AnswerDir;
use l4d_data::store::{Claim, Earlier};
use l4d_data::{DataError, StageError, json};
use l4d_ground::{Grounder, Grounding, Question, ViewClip};
use l4d_masks::Mask;
use l4d_splat::raster::Rasterizer;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::account::{Account, Stage};
use crate::clips::{DepthKind, PictureIndex, Plan};
use crate::consensus::{Consensus, ConsensusSettings, Decision, Preset, Proposal, consensus};
use crate::grounded::{ground_all, unanswered};
use crate::lift::{Answer, ClosedSettings, Evidence, FieldSettings, LiftError, LiftSettings, lift};
use crate::scene::{ClipSettings, SolveScene};

const SCHEMA: &str = "l4d/answer/1";

/// Everything about a method but its grounder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolveSettings {
    /// Which views are believed.
    pub consensus: ConsensusSettings,
    /// How masks become an answer.
    pub lift: LiftSettings,
}

/// A method: what finds, what draws, and how.
#[derive(Clone, Copy)]
pub struct Method<'a> {
    /// What finds in one view what a sentence means.
    pub grounder: &'a dyn Grounder,
    pub rasterizer: &'a dyn Rasterizer,
    pub settings: &'a SolveSettings,
}

/// An answer, with all that led to it.
#[derive(Debug)]
pub struct Solved {
    /// What each view says, in the order of the clips.
    pub groundings: Vec<Grounding>,
    /// Which of them are believed.
    pub consensus: Consensus,
    /// The answer as a part of the scene; none where there is no evidence.
    pub lifted: Option<Answer>,
    /// What it took so far.
    pub(crate) account: Account,
}

/// `manifest.json` of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    schema: String,
    /// What was asked.
    pub question: Question,
    /// SHA-256 of everything that the answer depends on.
    pub made_from: String,
    /// Model, clips, grounder and settings, for people.
    inputs: Value,
    /// What consensus decided.
    pub decision: Decision,
    /// View -> outcome, one word.
    pub outcomes: BTreeMap<String, String>,
    /// Whether asking again would change nothing; if not, the next run asks the views again that did not answer.
    pub is_complete: bool,
    /// What its stages took.
    pub(crate) account: Account,
}

impl Preset {
    /// All settings of the preset.
    pub fn solve_settings(self) -> SolveSettings {
        let lift = match self {
            Self::Paper => LiftSettings::Field(FieldSettings::paper()),
            Self::Robust | Self::Off => LiftSettings::Closed(ClosedSettings::robust()),
        };
        SolveSettings { consensus: self.settings(), lift }
    }

    /// The clips of the preset: `views` at most.
    pub fn clip_settings(self, views: usize, seed: u64) -> ClipSettings {
        let depth = match self {
            Self::Paper => DepthKind::Sum,
            Self::Robust | Self::Off => DepthKind::Median,
        };
        ClipSettings { views, seed, depth, range: None, size: None, every: None }
    }
}

impl Method<'_> {
    /// SHA-256 of everything that an answer depends on.
    pub fn made_from(&self, scene: &SolveScene, question: &Question) -> String {
        sha256_hex(json::canonical(&self.inputs(scene, question)).as_bytes())
    }

    fn inputs(&self, scene: &SolveScene, question: &Question) -> Value {
        json!({
            "question": question,
            "scene": scene.digest(),
            "grounder": self.grounder.identity(),
            "settings": self.settings,
        })
    }

    /// Answers a question. Everything but masks goes to `dir`: what each view says, what consensus makes of it, the
    /// lifted answer. `heard` is called for each view that has answered.
    ///
    /// # Errors
    /// What lifting meets, and what the disk refuses. Whatever a grounder meets is an outcome.
    pub fn solve(
        &self,
        scene: &SolveScene,
        question: &Question,
        dir: &AnswerDir,
        heard: &(dyn Fn() + Sync),
    ) -> Result<Solved, StageError> {
        let mut account = Account::default();
        let groundings = account.of(Stage::Grounding, || {
            let (clips, digests) = (&scene.clips, &scene.clip_digests);
            ground_all(self.grounder, question, clips, digests, &dir.grounded(), heard)
        })?;
        let agreed = account.of(Stage::Consensus, || {
            consensus(&Proposal::of(&scene.clips, &groundings), &self.settings.consensus)
        });
        json::write(&dir.consensus(), &agreed)?;
        let lifted = account.of(Stage::Lifting, || -> Result<_, StageError> {
            let evidence = Evidence::of(&scene.clips, &groundings, &agreed.evidence)?;
            Ok(lift(&scene.rendered(self.rasterizer), &evidence, &self.settings.lift)?)
        })?;
        if let Some(lifted) = &lifted {
            lifted.write(&dir.lift(), &scene.source.model)?;
        }
        Ok(Solved { groundings, consensus: agreed, lifted, account })
    }

    /// The clips that [`Self::solve`] would ask the grounder about, since no final outcome of theirs is in `dir`.
    pub fn unanswered<'s>(
        &self,
        scene: &'s SolveScene,
        question: &Question,
        dir: &AnswerDir,
    ) -> Vec<&'s ViewClip> {
        unanswered(self.grounder, question, &scene.clips, &scene.clip_digests, &dir.grounded())
    }

    /// Notes beside an answer what it was made from and what it took: the last file of it.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn record(
        &self,
        scene: &SolveScene,
        question: &Question,
        solved: &Solved,
        dir: &AnswerDir,
    ) -> Result<Record, StageError> {
        let named = scene.clips.iter().zip(&solved.groundings);
        let record = Record {
            schema: SCHEMA.to_owned(),
            question: question.clone(),
            made_from: self.made_from(scene, question),
            inputs: self.inputs(scene, question),
            decision: solved.consensus.decision,
            outcomes: named
                .map(|(clip, grounding)| (clip.camera.name.to_string(), grounding.outcome.word().to_owned()))
                .collect(),
            is_complete: solved.groundings.iter().all(|grounding| grounding.outcome.is_final()),
            account: solved.account.clone(),
        };
        json::write(&dir.manifest(), &record)?;
        Ok(record)
    }
}

impl SolveScene {
    /// The pixels of an answer in every picture of a plan; all empty where nothing was lifted. The model is deformed
    /// once a time, for all cameras.
    ///
    /// # Errors
    /// A camera or a time that cannot be drawn.
    pub fn masks(
        &self,
        rasterizer: &dyn Rasterizer,
        lifted: Option<&Answer>,
        plan: &Plan,
    ) -> Result<BTreeMap<PictureIndex, Mask>, StageError> {
        let [width, height] = plan.size;
        let Some(lifted) = lifted else {
            return Ok(plan.pictures().map(|index| (index, Mask::empty(width, height))).collect());
        };
        let rendered = self.rendered(rasterizer);
        let at = |instant: usize| -> Result<Vec<(PictureIndex, Mask)>, StageError> {
            let time = plan.instants[instant].time;
            let layer = lifted.layer_at(rendered.model, time)?;
            let splats = rendered.shapes_at(time)?;
            let of_view = |view: usize| {
                let index = PictureIndex { view, instant };
                let from = plan.view(index)?;
                let projected =
                    rasterizer.prepare(&splats, &from, rendered.raster).map_err(LiftError::from)?;
                Ok((index, layer.mask(projected.as_ref(), &from)?))
            };
            (0..plan.cameras.len()).map(of_view).collect()
        };
        let by_time: Vec<Vec<_>> =
            (0..plan.instants.len()).into_par_iter().map(at).collect::<Result<_, _>>()?;
        Ok(by_time.into_iter().flatten().collect())
    }
}

/// The right to write an answer, and more files into its folder.
pub(crate) fn claim(dir: &AnswerDir, more: Vec<String>, force: bool) -> Result<Claim, DataError> {
    let own = ["grounded/", "consensus.json", "lift/", "manifest.json"].map(str::to_owned);
    let earlier = Earlier { file: "manifest.json", says: SCHEMA };
    Claim::take(dir.root(), own.into_iter().chain(more).collect(), Some(earlier), force)
}

impl Record {
    /// The record in a folder, of whatever it was made.
    pub fn read(dir: &AnswerDir) -> Option<Self> {
        let record: Self = json::read(&dir.manifest()).ok()?;
        (record.schema == SCHEMA).then_some(record)
    }

    /// The record of an answer that was made from just this, and to which no view has more to say; none where the question has to be
    /// asked (again).
    pub fn of_finished(dir: &AnswerDir, made_from: &str) -> Option<Self> {
        Self::read(dir).filter(|record| record.made_from == made_from && record.is_complete)
    }
}
