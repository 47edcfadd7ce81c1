//! `l4d solve`: PanopticQuery over queries and scenes, into a folder of results.

mod card;
mod ledger;
mod pick;
mod plan;

use anyhow::{Context as _, Result};
use l4d_data::Progress as _;
use l4d_data::layout::{AnswerDir, ResultsDir, SceneDir, WorkDir};
use l4d_data::workspace::SharedWork;
use l4d_data::{Benchmark, Name, Query, Workspace};
use l4d_ground::Question;
use l4d_solve::account::{Account, Stage};
use l4d_solve::results::{mask_file, write_masks};
use l4d_solve::scene::{Places, SolveScene};
use l4d_solve::solve::{Method, Record, SolveSettings};
use l4d_splat::raster::Rasterizer;
use serde_json::Value;

use self::card::Card;
use self::ledger::Ledger;
use self::pick::{SceneQueries, pick};
use crate::cli::solver::SolveArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::rasterizer;
use crate::solver::{self, Grounders};

pub(crate) fn run(args: &SolveArgs, out: &Printer) -> Result<ExitStatus> {
    if args.dry_run {
        let bench = Benchmark::open(&args.bench.bench)?;
        return Run::new(args, &bench, out)?.estimate(&pick(args, &bench)?, out);
    }
    let (run, ledger) = answer(args, out)?;
    ledger.print(&run.name, args.json, out)?;
    ledger.talk(out);
    out.note(format!("results stand in {}", run.results.root().display()));
    Ok(ExitStatus::Success)
}

/// Answers as `run` does, and prints no data: for verbs that go on with the results.
pub(super) fn answer_quietly(args: &SolveArgs, out: &Printer) -> Result<()> {
    answer(args, out).map(|(_, ledger)| ledger.talk(out))
}

fn answer<'a>(args: &'a SolveArgs, out: &Printer) -> Result<(Run<'a>, Ledger)> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let picked = pick(args, &bench)?;
    let run = Run::new(args, &bench, out)?;
    let card = Card::claim(&run, &bench, out)?;
    let total = picked.iter().map(|scene| scene.queries.len()).sum::<usize>();
    out.start("solving", total as u64);
    let mut ledger = Ledger::default();
    for scene in &picked {
        out.item(&scene.name);
        run.solve_scene(scene, &mut ledger, out).with_context(|| scene.name.to_string())?;
    }
    out.finish();
    card.write(&run, &ledger)?;
    Ok((run, ledger))
}

/// Everything that all scenes share.
struct Run<'a> {
    args: &'a SolveArgs,
    name: Name,
    results: ResultsDir,
    data: std::path::PathBuf,
    grounders: Grounders,
    settings: SolveSettings,
    opened: rasterizer::Opened,
}

impl<'a> Run<'a> {
    fn new(args: &'a SolveArgs, bench: &Benchmark, out: &Printer) -> Result<Self> {
        let name = args.name.clone().unwrap_or_else(|| solver::default_name(&args.method, args.set));
        let name = Name::new(name)?;
        Ok(Self {
            args,
            results: ResultsDir::new(args.results.join(name.as_str())),
            data: Workspace::new(args.bench.profile, bench.manifest.draw())
                .with_data(args.work.data.as_deref())
                .data()
                .to_owned(),
            grounders: Grounders::open(&args.method, &SharedWork::new(&args.work.work), out)?,
            settings: solver::settings(&args.method),
            opened: rasterizer::open(&args.method.adapter.adapter)?,
            name,
        })
    }

    fn solve_scene(&self, wanted: &SceneQueries, ledger: &mut Ledger, out: &Printer) -> Result<()> {
        let places = self.places(&wanted.name);
        let mut account = Account::default();
        let scene = account.of(Stage::Clips, || self.open(&wanted.name, &places))?;
        scene.source.notes.iter().for_each(|note| out.note(format!("{}: {note}", wanted.name)));
        ledger.add_scene(account);
        let grounder = self.grounders.of_scene(&scene, &places.data, &wanted.queries)?;
        let judged = scene.judged(&places)?;
        let method = Method {
            grounder: grounder.as_ref(),
            rasterizer: self.opened.rasterizer.as_ref(),
            settings: &self.settings,
        };
        let one = |query: &Query| -> Result<Record> {
            let question = question_of(query);
            let dir = self.answer_dir(&places.work, query);
            let made_from = method.made_from(&scene, &question);
            if let Some(record) = self.finished(query, &dir, &made_from) {
                return Ok(record);
            }
            self.refuse_other(&dir, &made_from)?;
            let mut solved = method.solve(&scene, &question, &dir, &|| {})?;
            let (lifted, account) = (solved.lifted.take(), &mut solved.account);
            let masks = account.of(Stage::Masks, || method.masks(&scene, lifted.as_ref(), &judged))?;
            write_masks(&self.results, &query.id, &mask_file(&judged, &masks))?;
            Ok(method.record(&scene, &question, &solved, &dir)?)
        };
        let records = l4d_data::parallel::in_parallel(&wanted.queries, self.args.jobs as usize, |query| {
            let record = one(query).with_context(|| query.id.to_string());
            out.advance(1);
            record
        })?;
        for (query, record) in wanted.queries.iter().zip(records) {
            ledger.add(query, record);
        }
        Ok(())
    }

    fn places(&self, scene: &Name) -> Places {
        let work = WorkDir::new(&self.args.work.work, self.args.bench.profile, scene);
        Places { data: SceneDir::new(&self.data, scene), work, model: None }
    }

    /// The record of a query whose answer and masks stand there.
    fn finished(&self, query: &Query, dir: &AnswerDir, made_from: &str) -> Option<Record> {
        let stands = self.results.mask_file(&query.id).is_file();
        Record::of_finished(dir, made_from).filter(|_| stands)
    }

    /// Where it stands how the answer came about.
    fn answer_dir(&self, work: &WorkDir, query: &Query) -> AnswerDir {
        let number = &query.id.number;
        match &self.args.answers {
            Some(root) => AnswerDir::new(root.join(query.id.scene.as_str()).join(number.as_str())),
            None => work.answer(&self.name, number),
        }
    }

    fn open(&self, name: &Name, places: &Places) -> Result<SolveScene> {
        let settings = solver::clip_settings(&self.args.method, None);
        let adapter = self.opened.adapter.as_ref().map(serde_json::to_value).transpose()?;
        let draws: (&dyn Rasterizer, Option<Value>) = (self.opened.rasterizer.as_ref(), adapter);
        Ok(SolveScene::open(name, self.args.bench.profile, places, &settings, draws, &|| {})?)
    }

    /// Answers of another version or with other settings are not mixed in under one name.
    fn refuse_other(&self, dir: &AnswerDir, made_from: &str) -> Result<()> {
        match Record::read(dir) {
            Some(record) if record.made_from != made_from && !self.args.overwrite => Err(refusal(
                format!("{}: was answered from other clips or with other settings", dir.root().display()),
                "give the method another --name, or replace its answers with --overwrite",
            )),
            _ => Ok(()),
        }
    }
}

/// A query as a question to a grounder.
pub(super) fn question_of(query: &Query) -> Question {
    Question {
        scene: query.id.scene.clone(),
        number: Some(query.id.number.clone()),
        text: query.text.clone(),
        range: None,
    }
}
