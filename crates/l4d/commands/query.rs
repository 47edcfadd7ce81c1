//! `l4d query`: one sentence about one scene, now.

mod answer;
mod known;
mod overlay;
mod written;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_data::digest::sha256_hex;
use l4d_data::layout::{AnswerDir, SceneDir, WorkDir};
use l4d_data::store::write_atomic;
use l4d_data::workspace::SharedWork;
use l4d_data::{Camera, Draw, Interval, Name, Rig, Timeline, Workspace};
use l4d_frames::Mask;
use l4d_frames::drawn::encode_colour;
use l4d_ground::{Question, Unread};
use l4d_solve::account::{Account, Stage};
use l4d_solve::clips::{self, Plan, Shot};
use l4d_solve::consensus::{Proposal, picture};
use l4d_solve::scene::{Places, SolveScene};
use l4d_solve::solve::{Method, Solved};
use serde_json::json;

use self::answer::Answer;
use self::known::Known;
use self::overlay::Overlay;
use self::written::sights;
use crate::cli::solver::QueryArgs;
use crate::moving_picture::{self, Clip};
use crate::out::{ExitStatus, Printer, refusal};
use crate::rasterizer;
use crate::solver::{self, Grounders};

/// Frames of a view that the picture of consensus shows.
const CONSENSUS_COLUMNS: usize = 6;
/// The answer at some moments.
const SHEET: &str = "sheet.png";

pub(crate) fn run(args: &QueryArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(&args.scene)?;
    let text = sentence(args)?;
    let data =
        Workspace::new(args.profile, Draw::default()).with_data(args.work.data.as_deref()).data().to_owned();
    let work = WorkDir::new(&args.work.work, args.profile, &name);
    let places = Places { data: SceneDir::new(&data, &name), work, model: args.splats.clone() };
    let known = Known::read(&args.bench, &name);
    let range = range(args, timeline_of(args, &places))?;
    let question = Question { scene: name, number: known.number_of(&text), text, range };
    let grounders = Grounders::open(&args.method, &SharedWork::new(&args.work.work), out)?;
    if question.number.is_none() && grounders.answer_known_queries_alone() {
        return Err(known.refusal(args.method.grounder.as_str(), &question.text));
    }
    // Nothing is drawn for a sentence that cannot be read.
    if let Some(grounder) = grounders.of_any_scene()
        && let Err(unread) = grounder.reads(&question.text)
    {
        let answer = Answer::unread(&unread, &question.text, &known, grounder);
        return tell_unasked(args, &question, &answer, out);
    }
    ask(args, &question, &grounders, &known, &places, out)
}

fn tell_unasked(args: &QueryArgs, question: &Question, answer: &Answer, out: &Printer) -> Result<ExitStatus> {
    match args.json {
        true => out.json(&json!({
            "question": question,
            "answer": answer,
            "decision": null,
            "evidence": [],
            "frames": {},
            "stages": [],
            "folder": null,
        }))?,
        false => out.data(&answer.message)?,
    }
    Ok(answer.exit_status())
}

/// From clips to masks.
fn ask(
    args: &QueryArgs,
    question: &Question,
    grounders: &Grounders,
    known: &Known,
    places: &Places,
    out: &Printer,
) -> Result<ExitStatus> {
    let settings = solver::settings(&args.method);
    let opened = rasterizer::open(&args.method.adapter.adapter)?;
    let mut account = Account::default();
    let adapter = opened.adapter.as_ref().map(serde_json::to_value).transpose()?;
    let clip_settings = solver::clip_settings(&args.method, question.range);
    out.start("drawing", 0);
    let scene = account.of(Stage::Clips, || {
        let drawn = || out.advance(1);
        let draws = (opened.rasterizer.as_ref(), adapter);
        SolveScene::open(&question.scene, args.profile, places, &clip_settings, draws, &drawn)
    })?;
    out.finish();
    let grounder = grounders.of_scene(&scene, &places.data, &known.queries)?;
    let method =
        Method { grounder: grounder.as_ref(), rasterizer: opened.rasterizer.as_ref(), settings: &settings };
    let plan = wanted(args, question.range, &scene, places)?;
    let folder = out_folder(args, &places.work, &method.made_from(&scene, question));
    let dir = AnswerDir::new(&folder);
    out.start("grounding", scene.clips.len() as u64);
    let mut solved = method.solve(&scene, question, &dir, &|| out.advance(1))?;
    out.finish();

    let unread = |unread: &Unread| Answer::unread(unread, &question.text, known, grounder.as_ref());
    let missing = Answer::missing(&solved, unread);
    let shown = Shown { method: &method, scene: &scene, plan: &plan, folder: &folder };
    let pictures = match missing.as_ref().is_none_or(Answer::has_masks) {
        true => Some(shown.draw(question, &mut solved, out)?),
        false => None,
    };
    solved.account.0.splice(0..0, account.0);
    method.record(&scene, question, &solved, &dir)?;
    let nothing = BTreeMap::new();
    let masks = pictures.as_ref().map_or(&nothing, |pictures| &pictures.masks);
    let sights = if pictures.is_some() { sights(&plan, masks) } else { Vec::new() };
    let answer = missing.unwrap_or_else(|| Answer::seen(&sights, &solved, &folder.join(SHEET)));

    if args.json {
        let named = |&view: &usize| Some(&solved.consensus.views.get(view)?.view);
        out.json(&json!({
            "question": question,
            "answer": answer,
            "decision": solved.consensus.decision,
            "evidence": solved.consensus.evidence.iter().filter_map(named).collect::<Vec<_>>(),
            "frames": written::pixels(&plan, masks),
            "stages": solved.account,
            "folder": folder,
        }))?;
        return Ok(answer.exit_status());
    }
    written::tell(args, &scene, &solved, &sights, out)?;
    if let Some(pictures) = pictures {
        out.note(format!("{:.1} s from the sentence to the masks", solved.account.seconds()));
        out.data(folder.join("masks").display())?;
        out.data(folder.join(SHEET).display())?;
        out.data(pictures.moving.display())?;
    }
    out.data(&answer.message)?;
    Ok(answer.exit_status())
}

/// An answer on its way to the disk.
struct Shown<'a> {
    method: &'a Method<'a>,
    scene: &'a SolveScene,
    plan: &'a Plan,
    folder: &'a Path,
}

/// What was written.
struct Pictures {
    masks: BTreeMap<Shot, Mask>,
    moving: PathBuf,
}

impl Shown<'_> {
    /// Masks, sheet, consensus, moving picture. Takes the answer out of `solved`: it may be large.
    fn draw(&self, question: &Question, solved: &mut Solved, out: &Printer) -> Result<Pictures> {
        let Self { method, scene, plan, folder } = *self;
        let lifted = solved.lifted.take();
        let masks = solved.account.of(Stage::Masks, || method.masks(scene, lifted.as_ref(), plan))?;
        written::masks(folder, plan, &masks)?;
        draw_consensus(folder, scene, solved)?;
        let sheet = overlay::sheet(method, scene, lifted.as_ref(), plan, &masks, &question.text)?;
        write_atomic(&folder.join(SHEET), &encode_colour(&sheet))?;
        let drawn = Overlay { method, scene, plan, masks: &masks };
        let clip = Clip::of(&plan.instants, scene.timeline);
        let moving = moving_picture::write(folder, "overlay", clip, |widest_px| drawn.pages(widest_px), out)?;
        Ok(Pictures { masks, moving })
    }
}

fn sentence(args: &QueryArgs) -> Result<String> {
    let text = args.text.trim();
    if text.is_empty() {
        return Err(refusal(
            "the sentence is empty",
            "say what is meant, for example \"the cat that jumps\"",
        ));
    }
    Ok(text.to_owned())
}

/// When the frames of the scene were. A scene that is not there is told later, with what makes it.
fn timeline_of(args: &QueryArgs, places: &Places) -> Timeline {
    Rig::read(&places.data.rig(args.profile)).map_or(Timeline::CANONICAL, |rig| rig.timeline())
}

/// The frames that are asked about; none for the whole clip.
fn range(args: &QueryArgs, timeline: Timeline) -> Result<Option<Interval>> {
    let whole = timeline.whole();
    let (from, to) = (args.from.unwrap_or(whole.first()), args.to.unwrap_or(whole.last()));
    if let Some((flag, frame)) =
        [("--from", from), ("--to", to)].into_iter().find(|(_, frame)| !whole.contains(*frame))
    {
        return Err(refusal(
            format!("{flag} {frame} is beyond the clip"),
            format!("frames are {} to {}", whole.first(), whole.last()),
        ));
    }
    let range = Interval::new(from, to).map_err(|error| {
        refusal(format!("--from, --to: {error}"), "give the first frame to --from, the last to --to")
    })?;
    Ok((range != whole).then_some(range))
}

/// From where and when masks are wanted.
fn wanted(args: &QueryArgs, range: Option<Interval>, scene: &SolveScene, places: &Places) -> Result<Plan> {
    let file = args.cameras.as_deref().map(Rig::read).transpose()?;
    let rig = file.as_ref().unwrap_or(&scene.rig);
    // Moments of the clips; `range` has been taken out of them already.
    let of_cameras = |cameras: Vec<Camera>| match (&file, &scene.plan) {
        // Of the scene's own cameras, pictures as large as the clips.
        (None, Plan { camera_size, size, instants, .. }) => {
            Plan { cameras, camera_size: *camera_size, size: *size, instants: instants.clone() }
        }
        (Some(file), Plan { instants, .. }) => {
            Plan { cameras, camera_size: file.size(), size: file.size(), instants: instants.clone() }
        }
    };
    let mut plan = match args.camera.is_empty() {
        true if file.is_some() => of_cameras(rig.cameras.clone()),
        true => of_cameras(scene.judged(places)?.cameras),
        false => {
            let camera = |name: &String| {
                rig.camera(name).cloned().ok_or_else(|| {
                    let known: Vec<&str> = rig.cameras.iter().map(|camera| camera.name.as_str()).collect();
                    refusal(
                        format!("there is no camera `{}`", name.escape_debug()),
                        format!("choose among {}", known.join(", ")),
                    )
                })
            };
            let cameras = args.camera.iter().map(camera).collect::<Result<Vec<_>>>()?;
            of_cameras(cameras)
        }
    };
    if !args.time.is_empty() {
        if let Some(time) = args.time.iter().find(|time| !(0.0..=1.0).contains(*time)) {
            return Err(refusal(format!("time {time} is outside the clip"), "times are 0 to 1"));
        }
        if let Some(camera) = plan.cameras.iter().find(|camera| camera.world_from_camera.len() > 1) {
            return Err(refusal(
                format!("camera {} moves, and is known at frames alone", camera.name),
                "leave out --time",
            ));
        }
        plan.instants = args.time.iter().copied().map(clips::Instant::at_time).collect();
        plan.instants.sort_by(|a, b| a.time.total_cmp(&b.time));
        plan.instants.dedup_by(|a, b| a.key == b.key);
    }
    if let Some(range) = range {
        let ends = [range.first(), range.last()].map(|frame| scene.timeline.time(frame));
        plan.instants.retain(|instant| (ends[0]..=ends[1]).contains(&instant.time));
        if plan.instants.is_empty() {
            return Err(refusal(
                format!("no moment of the masks lies between frames {} and {}", range.first(), range.last()),
                "widen --from and --to, or choose another --time; clips have some frames alone",
            ));
        }
    }
    if let Some(size) = args.size {
        plan.size = size.0;
    }
    Ok(plan)
}

fn out_folder(args: &QueryArgs, work: &WorkDir, made_from: &str) -> PathBuf {
    let digest = sha256_hex(made_from.as_bytes());
    let short: String = digest.chars().take(16).collect();
    args.out.clone().unwrap_or_else(|| work.answer("asked", &short).root().to_owned())
}

fn draw_consensus(folder: &Path, scene: &SolveScene, solved: &Solved) -> Result<()> {
    let pairs = scene.clips.iter().zip(&solved.groundings);
    let proposals: Vec<Proposal<'_>> = pairs.map(|(clip, grounding)| Proposal { clip, grounding }).collect();
    let page = picture(&proposals, &solved.consensus, CONSENSUS_COLUMNS);
    Ok(write_atomic(&folder.join("consensus.png"), &encode_colour(&page))?)
}
