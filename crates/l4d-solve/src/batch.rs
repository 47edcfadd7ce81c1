//! The stage `solve`: queries of many scenes, answered into a folder of results. What was answered before stays.

mod card;
mod control;
mod ledger;
mod pick;

use std::collections::BTreeMap;
use std::path::PathBuf;

use l4d_data::digest::sha256_hex;
use l4d_data::layout::{AnswerDir, ResultsDir, WorkDir};
use l4d_data::parallel::in_parallel;
use l4d_data::results::MaskFile;
use l4d_data::truth::frame_key;
use l4d_data::{At as _, Benchmark, Name, Progress, Query, StageError, Workspace, json};
use l4d_endpoint::Plan as Requests;
use l4d_ground::Question;
use l4d_ground::vlm::Vlm;
use l4d_masks::Mask;
use l4d_splat::raster::Rasterizer;
use l4d_splat::source::ReaderOptions;
use serde_json::Value;

use self::card::Card;
pub use self::control::Control;
pub use self::ledger::Ledger;
pub use self::pick::{Picked, pick};
use crate::account::{Account, Stage};
use crate::clips::{PictureIndex, Plan};
use crate::grounders::Grounders;
use crate::scene::{ClipSettings, Places, SolveScene};
use crate::solve::{Method, Record, SolveSettings, claim};

/// A method and where its answers go.
pub struct Batch<'a> {
    /// Of the method.
    pub name: Name,
    /// Profile and folders.
    pub space: Workspace,
    /// Receives one folder per method.
    pub results: PathBuf,
    /// Receives how each answer came about, `<scene>/<nnn>`; none for the folders of the work.
    pub answers: Option<PathBuf>,
    /// What finds things.
    pub grounders: &'a Grounders,
    /// Consensus and lifting.
    pub settings: SolveSettings,
    /// Which clips are looked at.
    pub clips: ClipSettings,
    pub rasterizer: &'a dyn Rasterizer,
    /// What it draws on, for manifests; none for the processor.
    pub adapter: Option<Value>,
    /// What is taken away, if this is a control run.
    pub control: Option<Control>,
    /// Queries at once.
    pub jobs: usize,
    /// Answer again what was answered by another version or with other settings.
    pub overwrite: bool,
    /// The models or masks learned from rendered depth, whatever models say.
    pub used_depth: bool,
    /// What is said of models of others.
    pub reader_options: ReaderOptions,
}

impl Batch<'_> {
    /// Answers queries of scenes. `selected` are the scenes that were asked for, of which `picked` may be a shard.
    ///
    /// # Errors
    /// Results of another profile, version or benchmark under this name; whatever answering meets.
    pub fn run(
        &self,
        bench: &Benchmark,
        selected: &[Name],
        picked: &[Picked],
        progress: &dyn Progress,
    ) -> Result<Ledger, StageError> {
        let card = Card::claim(self, bench, selected, progress)?;
        progress.start("solving", picked.iter().map(|scene| scene.queries.len() as u64).sum());
        let mut ledger = Ledger::default();
        for scene in picked {
            progress.item(&scene.name);
            self.solve_scene(scene, &mut ledger, progress).at(&scene.name)?;
        }
        progress.finish();
        card.write(self, &ledger)?;
        Ok(ledger)
    }

    /// What a model server would be asked about the queries that are not answered yet. Nothing is sent; clips are drawn
    /// where they are missing, since what is asked depends on them.
    ///
    /// # Errors
    /// A scene that cannot be opened, a question that cannot be estimated.
    pub fn plan(&self, picked: &Picked, vlm: &Vlm) -> Result<Requests, StageError> {
        let places = self.places(&picked.name);
        let scene = self.open(&picked.name, &places)?;
        let method = Method { grounder: vlm, rasterizer: self.rasterizer, settings: &self.settings };
        let mut total = Requests::default();
        for query in &picked.queries {
            let (question, dir) = (Question::from(query), self.answer_dir(&places.work, query));
            if self.finished(query, &dir, &method.made_from(&scene, &question)).is_none() {
                let views = method.unanswered(&scene, &question, &dir);
                let plan = vlm.estimate(views.into_iter().map(|clip| (clip, &question)));
                total += plan.map_err(|error| StageError::of(&error, error.hint())).at(&query.id)?;
            }
        }
        Ok(total)
    }

    /// The folder of the method.
    pub fn results_dir(&self) -> ResultsDir {
        ResultsDir::new(self.results.join(self.name.as_str()))
    }

    fn solve_scene(
        &self,
        picked: &Picked,
        ledger: &mut Ledger,
        progress: &dyn Progress,
    ) -> Result<(), StageError> {
        let places = self.places(&picked.name);
        let mut account = Account::default();
        let scene = account.of(Stage::Clips, || self.open(&picked.name, &places))?;
        scene.source.notes.iter().for_each(|note| progress.note(&format_args!("{}: {note}", picked.name)));
        ledger.add_scene(account);
        let grounder = self.grounders.of_scene(&scene, self.rasterizer, &places.data, &picked.known)?;
        let judged = scene.judged(&places)?;
        let method =
            Method { grounder: grounder.as_ref(), rasterizer: self.rasterizer, settings: &self.settings };
        let one = |query: &Query| -> Result<Record, StageError> {
            let mut question = Question::from(query);
            if let Some(control) = self.control {
                control.on_question(&mut question, query, &picked.known);
            }
            let dir = self.answer_dir(&places.work, query);
            let made_from = method.made_from(&scene, &question);
            if let Some(record) = self.finished(query, &dir, &made_from) {
                return Ok(record);
            }
            self.refuse_other(query, &dir, &made_from)?;
            let _claim = claim(&dir, Vec::new(), self.overwrite)?;
            let mut solved = method.solve(&scene, &question, &dir, &|| {})?;
            let (lifted, account) = (solved.lifted.take(), &mut solved.account);
            let masks =
                account.of(Stage::Masks, || scene.masks(self.rasterizer, lifted.as_ref(), &judged))?;
            json::write_compact(&self.results_dir().mask_file(&query.id), &mask_file(&judged, &masks))?;
            method.record(&scene, &question, &solved, &dir)
        };
        let records = in_parallel(&picked.queries, self.jobs, |query| {
            let record = one(query).at(&query.id);
            progress.advance(1);
            record
        })?;
        picked.queries.iter().zip(records).for_each(|(query, record)| ledger.add(query, record));
        Ok(())
    }

    fn places(&self, scene: &Name) -> Places {
        Places {
            data: self.space.scene(scene),
            work: self.space.work(scene),
            model: None,
            reader_options: self.reader_options,
        }
    }

    fn open(&self, name: &Name, places: &Places) -> Result<SolveScene, StageError> {
        let draws = (self.rasterizer, self.adapter.clone());
        let mut scene = SolveScene::open(name, self.space.profile(), places, &self.clips, draws, &|| {})?;
        if let Some(control) = self.control {
            scene.clips.iter_mut().for_each(|clip| control.on_clip(clip));
            let shown = |digest: &String| sha256_hex(format!("{digest} {}", control.as_str()).as_bytes());
            scene.clip_digests = scene.clip_digests.iter().map(shown).collect();
        }
        Ok(scene)
    }

    /// The record of a query whose answer and masks are there.
    fn finished(&self, query: &Query, dir: &AnswerDir, made_from: &str) -> Option<Record> {
        let has_masks = self.results_dir().mask_file(&query.id).is_file();
        Record::of_finished(dir, made_from).filter(|_| has_masks)
    }

    fn answer_dir(&self, work: &WorkDir, query: &Query) -> AnswerDir {
        let number = &query.id.number;
        match &self.answers {
            Some(root) => AnswerDir::new(root.join(query.id.scene.as_str()).join(number.as_str())),
            None => work.answer(&self.name, number),
        }
    }

    /// Answers of another version or with other settings are not mixed in under one name.
    fn refuse_other(&self, query: &Query, dir: &AnswerDir, made_from: &str) -> Result<(), StageError> {
        let masks = self.results_dir().mask_file(&query.id);
        if masks.exists() && !self.overwrite {
            // Somebody's own file is no such document.
            json::read::<MaskFile>(&masks)?;
        }
        match Record::read(dir) {
            Some(record) if record.made_from != made_from && !self.overwrite => Err(StageError::new(
                format!("{}: was answered from other clips or with other settings", dir.root().display()),
                "give the method another --name, or replace its answers with --force",
            )),
            _ => Ok(()),
        }
    }
}

/// What the judge reads of a query: masks of the held-out view. Frames without a pixel of the answer say absent.
fn mask_file(plan: &Plan, masks: &BTreeMap<PictureIndex, Mask>) -> MaskFile {
    let [width, height] = plan.size;
    let frames = plan.instants.iter().enumerate().filter_map(|(instant, at)| {
        let mask = masks.get(&PictureIndex { view: 0, instant }).filter(|mask| !mask.is_empty());
        Some((frame_key(at.frame?), mask.map(Mask::to_rle)))
    });
    MaskFile { size: [height, width], frames: frames.collect() }
}

#[cfg(test)]
mod tests {
    use l4d_data::Timeline;

    use super::*;
    use crate::testing::camera;

    #[test]
    fn frames_without_a_pixel_say_absent() {
        let plan = Plan::of_frames(vec![camera("test", 0.0)], [4, 2], [0, 48], Timeline::CANONICAL);
        let mask = |columns: u32| Mask::from_fn(4, 2, |column, _| column < columns);
        let masks = plan.pictures().zip([mask(0), mask(1)]).collect();
        let file = mask_file(&plan, &masks);
        assert_eq!(file.size, [2, 4]);
        assert_eq!(file.frames["0000"], None);
        assert_eq!(file.frames["0048"].as_ref().unwrap().counts(), "026");
    }
}
