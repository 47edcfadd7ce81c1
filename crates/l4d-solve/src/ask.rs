//! The stage `query`: one sentence about one scene, from the clips to masks and pictures.

mod answer;
mod known;
mod span;
mod sureness;
mod views;

use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_hex;
use l4d_data::layout::{AnswerDir, WorkDir};
use l4d_data::store::write_atomic;
use l4d_data::{Name, Progress, Rig, StageError, Timeline, Workspace};
use l4d_frames::drawn::encode_colour;
use l4d_frames::moving_picture::{self, Pace};
use l4d_ground::{Question, Unreadable};
use l4d_splat::raster::Rasterizer;
use l4d_splat::source::ReaderOptions;
use serde_json::{Value, json};

pub use self::answer::{Answer, Status};
use self::known::Known;
pub use self::span::ClipTime;
pub use self::views::SeenMasks;
use self::views::{CameraView, camera_views, mask_name, pixels, wanted, write_masks};
use crate::account::{Account, Stage, word};
use crate::grounders::Grounders;
use crate::method::MethodChoice;
use crate::scene::{Places, SolveScene};
use crate::show::Shown;
use crate::solve::{Method, Solved, claim};

/// The answer at some moments.
const SHEET: &str = "sheet.png";

/// What is asked, of which scene, and from where it is looked at.
pub struct Ask<'a> {
    pub scene: Name,
    pub text: &'a str,
    /// First and last moment that are asked about; none for those of the clip.
    pub span: [Option<ClipTime>; 2],
    /// Profile and folders.
    pub space: &'a Workspace,
    /// Folder of the benchmark, whose sentences are known.
    pub bench: &'a Path,
    /// The model, if not the one among the work.
    pub splats: Option<PathBuf>,
    /// What is said of a model of others.
    pub reader_options: ReaderOptions,
    /// Name of the grounder, for messages.
    pub grounder: &'a str,
    /// What finds things.
    pub grounders: &'a Grounders,
    /// The rest of the method.
    pub method: &'a MethodChoice,
    pub rasterizer: &'a dyn Rasterizer,
    /// What it draws on, for manifests; none for the processor.
    pub adapter: Option<Value>,
    /// Names of the cameras that masks are drawn from; empty for the held-out one.
    pub cameras: &'a [String],
    /// A file of other cameras.
    pub camera_file: Option<&'a Path>,
    /// Times of the masks, 0 to 1; empty for those of the clips.
    pub times: &'a [f32],
    /// Width and height of the masks, pixels.
    pub size: Option<[u32; 2]>,
    /// Receives masks and pictures; none for a folder of the work.
    pub out: Option<&'a Path>,
    /// Whether files of others in it are replaced.
    pub force: bool,
}

/// What came of it.
#[derive(Debug)]
pub struct Asked {
    /// What was asked.
    pub question: Question,
    /// The last word.
    pub answer: Answer,
    /// What each stage decided; none for a sentence that cannot be read.
    pub stages: Option<Stages>,
}

/// What the stages of a question decided, and what they wrote.
#[derive(Debug)]
pub struct Stages {
    scene: SolveScene,
    solved: Solved,
    views: Vec<CameraView>,
    /// Camera -> frame or time -> pixels of the answer.
    pixels: Value,
    /// Its masks from the first camera; none where nothing is to be shown.
    first_view: Option<SeenMasks>,
    /// Everything on disk.
    pub folder: PathBuf,
    /// The moving picture; none where there is nothing to show.
    pub moving: Option<PathBuf>,
}

/// Asks a sentence.
///
/// # Errors
/// An empty sentence, frames or cameras that are not there, a sentence that the grounder cannot know, and whatever the
/// stages meet.
pub fn ask(order: &Ask<'_>, progress: &dyn Progress) -> Result<Asked, StageError> {
    let text = order.text.trim();
    if text.is_empty() {
        let hint = "say what is meant, for example \"the cat that jumps\"";
        return Err(StageError::new("the sentence is empty", hint));
    }
    let places = Places {
        data: order.space.scene(&order.scene),
        work: order.space.work(&order.scene),
        model: order.splats.clone(),
        reader_options: order.reader_options,
    };
    let known = Known::read(order.bench, &order.scene);
    // A scene that is not there is an error later, with what makes it.
    let rig = Rig::read(&places.data.rig(order.space.profile()));
    let timeline = rig.map_or(Timeline::CANONICAL, |rig| rig.timeline());
    // A sentence of the benchmark is asked as it stands.
    let spoken = match known.number_of(text) {
        Some(_) => None,
        None => span::in_sentence(text),
    };
    let (text, spoken) = match &spoken {
        Some((rest, span)) => (rest.as_str(), Some(*span)),
        None => (text, None),
    };
    if spoken.is_some() && order.span != [None, None] {
        let hint = "leave out --from and --to, or what the sentence says of seconds";
        return Err(StageError::new("the sentence says when, and so do --from and --to", hint));
    }
    let range = span::interval(spoken.unwrap_or(order.span), timeline)?;
    let number = known.number_of(text);
    let question = Question { scene: order.scene.clone(), number, text: text.to_owned(), range };
    if question.number.is_none() && order.grounders.knows_queries_alone() {
        return Err(known.refusal(order.grounder, text));
    }
    // Nothing is drawn for a sentence that cannot be read.
    if let Some(grounder) = order.grounders.of_any_scene()
        && let Err(unread) = grounder.reads(text)
    {
        let answer = Answer::unread(&unread, text, &known, grounder);
        return Ok(Asked { question, answer, stages: None });
    }
    answer(order, question, &known, &places, progress)
}

/// From clips to masks.
fn answer(
    order: &Ask<'_>,
    question: Question,
    known: &Known,
    places: &Places,
    progress: &dyn Progress,
) -> Result<Asked, StageError> {
    let settings = order.method.solve_settings();
    let clip_settings = order.method.clip_settings(question.range);
    let mut account = Account::default();
    progress.start("drawing", 0);
    let scene = account.of(Stage::Clips, || {
        let draws = (order.rasterizer, order.adapter.clone());
        let drawn = || progress.advance(1);
        SolveScene::open(&question.scene, order.space.profile(), places, &clip_settings, draws, &drawn)
    })?;
    progress.finish();
    let grounder = order.grounders.of_scene(&scene, order.rasterizer, &places.data, &known.queries)?;
    let method = Method { grounder: grounder.as_ref(), rasterizer: order.rasterizer, settings: &settings };
    let plan = wanted(order, question.range, &scene, places)?;
    let folder = folder(order, &places.work, &method.made_from(&scene, &question));
    let dir = AnswerDir::new(&folder);
    let masks = plan.pictures().map(|index| mask_name(&plan, index));
    let pictures = [SHEET, "overlay.mp4", "overlay.png"].map(str::to_owned);
    let _claim = claim(&dir, masks.chain(pictures).collect(), order.force)?;
    progress.start("grounding", scene.clips.len() as u64);
    let mut solved = method.solve(&scene, &question, &dir, &|| progress.advance(1))?;
    progress.finish();

    let unread = |unread: &Unreadable| Answer::unread(unread, &question.text, known, grounder.as_ref());
    let missing = Answer::missing(&solved, unread);
    let is_shown = missing.as_ref().is_none_or(Answer::has_masks);
    // Taken out of what is kept: it may be large.
    let lifted = solved.lifted.take().filter(|_| is_shown);
    let (mut masks, mut moving) = (Default::default(), None);
    if is_shown {
        masks = solved.account.of(Stage::Masks, || scene.masks(order.rasterizer, lifted.as_ref(), &plan))?;
        write_masks(&folder, &plan, &masks)?;
        let rasterizer = order.rasterizer;
        let shown = Shown { rasterizer, scene: &scene, plan: &plan, masks: &masks };
        write_atomic(&folder.join(SHEET), &encode_colour(&shown.sheet(&question.text)?))?;
        let times = plan.instants.first().zip(plan.instants.last());
        let share = times.map_or(0.0, |(first, last)| f64::from(last.time - first.time));
        let pace = Pace::over(plan.instants.len(), share * scene.timeline.duration_s());
        let lay_out = |widest_px| Ok(shown.pages(widest_px));
        moving = Some(moving_picture::write(&folder, "overlay", pace, lay_out, progress)?);
    }
    solved.account.0.splice(0..0, account.0);
    method.record(&scene, &question, &solved, &dir)?;
    let views = if is_shown { camera_views(&plan, &masks) } else { Vec::new() };
    let answer = missing.unwrap_or_else(|| Answer::seen(&views, &solved, &folder.join(SHEET)));
    let pixels = pixels(&plan, &masks);
    let first_view = is_shown.then(|| SeenMasks::of(&plan, &masks)).flatten();
    let stages = Stages { scene, solved, views, pixels, first_view, folder, moving };
    Ok(Asked { question, answer, stages: Some(stages) })
}

fn folder(order: &Ask<'_>, work: &WorkDir, made_from: &str) -> PathBuf {
    let digest = sha256_hex(made_from.as_bytes());
    let short: String = digest.chars().take(16).collect();
    order.out.map_or_else(|| work.answer("asked", &short).root().to_owned(), Path::to_owned)
}

impl Asked {
    /// What `l4d query --json` prints.
    pub fn to_json(&self) -> Value {
        let named = |stages: &Stages| -> Vec<Name> {
            let Stages { solved, .. } = stages;
            let view = |&view: &usize| Some(solved.consensus.views.get(view)?.view.clone());
            solved.consensus.evidence.iter().filter_map(view).collect()
        };
        json!({
            "question": self.question,
            "answer": self.answer,
            "decision": self.stages.as_ref().map(|stages| stages.solved.consensus.decision),
            "evidence": self.stages.as_ref().map(named).unwrap_or_default(),
            "frames": self.stages.as_ref().map_or_else(|| json!({}), |stages| stages.pixels.clone()),
            "stages": self.stages.as_ref().map(|stages| stages.solved.account.clone()).unwrap_or_default(),
            "folder": self.stages.as_ref().map(|stages| &stages.folder),
        })
    }
}

impl Stages {
    /// Seconds from the sentence to the masks.
    pub fn seconds(&self) -> f64 {
        self.solved.account.seconds()
    }

    /// The answer as the first camera sees it.
    pub fn first_view(&self) -> Option<&SeenMasks> {
        self.first_view.as_ref()
    }

    /// How the sentence was read, in the words of the first view that says so.
    pub fn reading(&self) -> Vec<String> {
        let notes = self.solved.groundings.iter().map(|grounding| &grounding.notes);
        let first = notes.into_iter().find(|notes| !notes.is_empty());
        let is_reading = |note: &&String| !note.starts_with("sees ");
        first.map(|notes| notes.iter().take_while(is_reading).cloned().collect()).unwrap_or_default()
    }

    /// The masks on disk, and the answer at some moments.
    pub fn masks_and_sheet(&self) -> [PathBuf; 2] {
        [self.folder.join("masks"), self.folder.join(SHEET)]
    }

    /// What each stage decided, line by line. With `explains`, what every view said of every other one, too.
    pub fn lines(&self, explains: bool) -> Vec<String> {
        let Self { scene, solved, views, .. } = self;
        let frames = scene.clips.first().map_or(0, |clip| clip.frames.len());
        let mut lines = vec![format!("clips      {} views x {frames} frames", scene.clips.len())];
        lines.push("\ngrounding".to_owned());
        for (clip, grounding) in scene.clips.iter().zip(&solved.groundings) {
            let marked = grounding.masks.values().filter(|mask| !mask.is_empty()).count();
            let (name, word) = (clip.camera.name.as_str(), grounding.outcome.word());
            lines.push(format!("  {name:<8} {word:<12} {marked:>3} frames marked"));
            let notes = grounding.notes.iter().filter(|_| explains);
            let why = grounding.outcome.why().into_iter().chain(notes.cloned());
            lines.extend(why.map(|why| format!("           {why}")));
        }
        lines.push("\nconsensus".to_owned());
        let table = if explains { solved.consensus.explain() } else { solved.consensus.summary() };
        lines.extend(table.lines().map(|line| format!("  {line}")));
        if !views.is_empty() {
            lines.push("\nmasks".to_owned());
        }
        for CameraView { camera, seen, frames, most_px, .. } in views {
            let name = camera.as_str();
            lines.push(format!("  {name:<8} seen in {seen} of {frames} frames, at most {most_px} pixels"));
        }
        lines.push("\nseconds".to_owned());
        for entry in &solved.account.0 {
            lines.push(format!("  {:<10} {:>7.2}", word(entry.stage), entry.seconds));
        }
        lines
    }
}
