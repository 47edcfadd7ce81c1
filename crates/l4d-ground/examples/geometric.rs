//! How good the geometric grounder is on rendered scenes: perception against ids, answers against referents.
//!
//! ```text
//! cargo run --example geometric -- DATA BENCH SCENE[,SCENE] [VIEWS] [--pictures FOLDER] [--queries] [--absents] [--kinds]
//!     [--perceive JSON] [--reason JSON]...
//! ```
//!
//! `--absents` asks for what is not there, and counts what is said. `--kinds` tells it what things are from the ids: what is left is what reasoning and segments get wrong.
//! It shows the grounder rendered colour and depth of training views, and compares with ids, which the grounder never
//! sees. A development tool: the scores of the benchmark are those of the held-out view.

#![expect(clippy::print_stdout, reason = "what it measures is what it prints")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use glam::UVec2;
use half::f16;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::query::{Query, read_queries};
use l4d_data::{Category, Scene, Split, Timeline};
use l4d_frames::Mask;
use l4d_frames::display::Display;
use l4d_frames::drawn::DepthMap;
use l4d_frames::exr::read_frame;
use l4d_ground::geometric::Geometric;
use l4d_ground::geometric::classical::Classical;
use l4d_ground::geometric::perceive::{Perception, Seen, Track};
use l4d_ground::{ClipFrame, Grounder, Outcome, Question, ViewClip};

/// A view of a scene, with the ids that the grounder never sees.
struct View {
    clip: ViewClip,
    ids: Vec<Vec<u32>>,
}

fn main() -> anyhow::Result<()> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut flag = |name: &str| {
        arguments.iter().position(|argument| argument == name).map(|at| arguments.remove(at)).is_some()
    };
    let (asks, asks_absents, is_taught) = (flag("--queries"), flag("--absents"), flag("--kinds"));
    let mut values = |name: &str| {
        let mut values = Vec::new();
        while let Some(at) = arguments.iter().position(|argument| argument == name) {
            arguments.remove(at);
            values.push(arguments.remove(at));
        }
        values
    };
    let pictures = values("--pictures").pop().map(PathBuf::from);
    let mut reasonings = values("--reason");
    if reasonings.is_empty() {
        reasonings.push("{}".to_owned());
    }
    let perception =
        Classical::new(serde_json::from_str(values("--perceive").last().map_or("{}", String::as_str))?);
    let [data, bench, scenes, rest @ ..] = &arguments[..] else { anyhow::bail!("DATA BENCH SCENES [VIEWS]") };
    let views = rest.first().map_or(Ok(4), |count| count.parse())?;
    let mut tables: Vec<Tables> = reasonings.iter().map(|_| Tables::default()).collect();
    for name in scenes.split(',') {
        let directory = SceneDir::new(Path::new(data), name);
        let scene = Scene::read(&directory.scene())?;
        let place = BenchDir::new(bench);
        let queries = if asks { read_queries(&place.queries(name), name)? } else { Vec::new() };
        let absents = if asks_absents { read_queries(&place.absents(name), name)? } else { Vec::new() };
        for camera in scene.cameras.iter().filter(|camera| camera.split == Split::Train).take(views) {
            let view = load(&scene, &directory, &camera.name)?;
            let mut seen = look(&scene, &view, &perception, pictures.as_deref(), &mut tables[0])?;
            if is_taught {
                teach(&mut seen, &scene, &view);
            }
            for (reasoning, table) in reasonings.iter().zip(&mut tables) {
                let grounder =
                    Geometric::with_settings(Known(seen.clone()), serde_json::from_str(reasoning)?);
                let is_talking = reasonings.len() == 1;
                ask(&scene, &view, &queries, &grounder, is_talking, table);
                for sentence in &absents {
                    let grounding = grounder.ground(&view.clip, &question(&scene, sentence));
                    *table.absents.entry(grounding.outcome.word()).or_default() += 1;
                }
            }
        }
    }
    for (reasoning, table) in reasonings.iter().zip(&tables) {
        println!("{reasoning}");
        table.print();
    }
    Ok(())
}

/// What was seen already.
struct Known(Seen);

impl Perception for Known {
    fn identity(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn perceive(&self, _: &ViewClip) -> Seen {
        self.0.clone()
    }
}

fn load(scene: &Scene, directory: &SceneDir, name: &str) -> anyhow::Result<View> {
    let camera = scene.camera(name).context("no such camera")?.clone();
    let size = UVec2::new(scene.width, scene.height);
    let display = Display::new(scene.exposure);
    let (mut frames, mut ids) = (Vec::new(), Vec::new());
    for number in scene.profile.frames() {
        let frame = read_frame(&directory.frame(&camera.name, number), size)?;
        let colour = display.picture(&frame);
        let near = frame.surfaces.depth_m.iter().map(|&depth_m| f16::from_f32(depth_m)).collect::<Vec<_>>();
        let alpha = frame
            .surfaces
            .depth_m
            .iter()
            .map(|depth_m| if depth_m.is_finite() { f16::ONE } else { f16::ZERO });
        let depth = DepthMap {
            width: size.x,
            height: size.y,
            alpha: alpha.collect(),
            depth_m: frame.surfaces.depth_m,
            near_m: near.clone(),
            far_m: near,
        };
        frames.push(ClipFrame { frame: number, colour, depth });
        ids.push(frame.surfaces.id);
    }
    Ok(View {
        clip: ViewClip { camera, width: size.x, height: size.y, timeline: Timeline::CANONICAL, frames },
        ids,
    })
}

/// Sums by name.
#[derive(Default)]
struct Tables {
    perception: Vec<(String, f64)>,
    seconds: Vec<f64>,
    answers: Vec<Answer>,
    /// What is said of sentences that nothing satisfies.
    absents: BTreeMap<&'static str, usize>,
}

struct Answer {
    category: Category,
    answered: bool,
    iou: f64,
    chance: f64,
    union: f64,
    selected: bool,
}

fn look(
    scene: &Scene,
    view: &View,
    perception: &Classical,
    pictures: Option<&Path>,
    tables: &mut Tables,
) -> anyhow::Result<Seen> {
    let start = Instant::now();
    let seen = perception.perceive(&view.clip);
    tables.seconds.push(start.elapsed().as_secs_f64());
    let mut line = Vec::new();
    for instance in scene.instances.iter().filter(|instance| instance.id < 1000) {
        let truth = masks_of(view, instance.id);
        if truth.iter().map(Mask::area).sum::<u64>() < 30 {
            continue;
        }
        let best = seen.tracks.iter().map(|track| tube(track, &truth)).fold(0.0, f64::max);
        line.push(format!("{} {:.2}", instance.name, best));
        tables.perception.push((scene.name.to_string(), best));
    }
    println!(
        "{} {} {:?} tracks {} {:.2}s: {}",
        scene.name,
        view.clip.camera.name,
        seen.scale,
        seen.tracks.len(),
        tables.seconds.last().unwrap_or(&0.0),
        line.join(", ")
    );
    if let Some(folder) = pictures {
        std::fs::create_dir_all(folder)?;
        draw(&seen, view).save(folder.join(format!("{}_{}.png", scene.name, view.clip.camera.name)))?;
    }
    Ok(seen)
}

fn masks_of(view: &View, id: u32) -> Vec<Mask> {
    let (width, height) = (view.clip.width, view.clip.height);
    view.ids
        .iter()
        .map(|ids| Mask::from_ids(width, height, ids, id).unwrap_or_else(|_| Mask::empty(width, height)))
        .collect()
}

fn tube(track: &Track, truth: &[Mask]) -> f64 {
    let (mut shared, mut all) = (0, 0);
    for (glimpse, truth) in track.glimpses.iter().zip(truth) {
        match glimpse {
            Some(glimpse) => {
                shared += glimpse.mask.and_count(truth);
                all += glimpse.mask.or_count(truth);
            }
            None => all += truth.area(),
        }
    }
    shared as f64 / (all.max(1)) as f64
}

/// First, middle and last frame with the tracks painted over, small ones last.
fn draw(seen: &Seen, view: &View) -> l4d_frames::drawn::RgbImage {
    let (width, height) = (view.clip.width, view.clip.height);
    let count = view.clip.frames.len();
    let mut sheet = l4d_frames::drawn::RgbImage::new(width * 3, height * 2);
    for (slot, index) in [0, count / 2, count - 1].into_iter().enumerate() {
        let picture = &view.clip.frames[index].colour;
        for (column, row, pixel) in picture.enumerate_pixels() {
            sheet.put_pixel(slot as u32 * width + column, row, *pixel);
        }
        for (number, track) in seen.tracks.iter().enumerate() {
            let Some(glimpse) = &track.glimpses[index] else { continue };
            let hue = [number * 97 % 256, number * 57 % 256, number * 23 % 256].map(|value| value as u8 | 32);
            for (column, row) in glimpse.mask.pixels() {
                sheet.put_pixel(slot as u32 * width + column, height + row, l4d_frames::drawn::Rgb(hue));
            }
        }
    }
    sheet
}

/// Tells kinds from ids: what reasoning would do with a perfect sense of kinds.
fn teach(seen: &mut Seen, scene: &Scene, view: &View) {
    for track in &mut seen.tracks {
        track.kinds.insert("thing".to_owned(), 0.5);
    }
    for instance in &scene.instances {
        let truth = masks_of(view, instance.id);
        for track in &mut seen.tracks {
            let iou = tube(track, &truth);
            for noun in [instance.category.as_str(), instance.name.as_str()] {
                let sure = track.kinds.entry(noun.to_owned()).or_insert(0.0);
                *sure = sure.max(if iou > 0.2 { iou } else { 0.0 });
            }
        }
    }
}

fn question(scene: &Scene, query: &Query) -> Question {
    Question { scene: scene.name.clone(), number: None, text: query.text.clone(), range: None }
}

fn ask(
    scene: &Scene,
    view: &View,
    queries: &[Query],
    grounder: &Geometric<Known>,
    is_talking: bool,
    tables: &mut Tables,
) {
    let (width, height) = (view.clip.width, view.clip.height);
    for query in queries {
        let id_of = |name: &str| scene.instance(name).map_or(0, |instance| instance.id);
        let held = |mut masks: Vec<Mask>| {
            for (mask, frame) in masks.iter_mut().zip(view.clip.frame_numbers()) {
                if !query.holds_at(frame) {
                    *mask = Mask::empty(width, height);
                }
            }
            masks
        };
        let mut truth = vec![Mask::empty(width, height); view.clip.frames.len()];
        for name in &query.referents {
            truth
                .iter_mut()
                .zip(held(masks_of(view, id_of(name))))
                .for_each(|(all, one)| all.union_with(&one));
        }
        if truth.iter().all(Mask::is_empty) {
            continue;
        }
        let noun = query
            .referents
            .first()
            .and_then(|name| scene.instance(name))
            .map_or("", |instance| &instance.category);
        let alike: Vec<Vec<Mask>> = scene
            .instances
            .iter()
            .filter(|instance| instance.id < 1000 && instance.category == noun)
            .map(|instance| held(masks_of(view, instance.id)))
            .collect();
        let chance = alike.iter().map(|masks| mean_iou(masks, &truth)).sum::<f64>() / alike.len() as f64;
        let mut union = vec![Mask::empty(width, height); truth.len()];
        alike.iter().for_each(|masks| union.iter_mut().zip(masks).for_each(|(all, one)| all.union_with(one)));
        let question = question(scene, query);
        let start = Instant::now();
        let grounding = grounder.ground(&view.clip, &question);
        let seconds = start.elapsed().as_secs_f64();
        let masks: Vec<Mask> = view
            .clip
            .frame_numbers()
            .map(|frame| grounding.masks.get(&frame).cloned().unwrap_or_else(|| Mask::empty(width, height)))
            .collect();
        let iou = mean_iou(&masks, &truth);
        let overlap =
            |id: u32| masks_of(view, id).iter().zip(&masks).map(|(a, b)| a.and_count(b)).sum::<u64>();
        let most = scene
            .instances
            .iter()
            .max_by_key(|instance| overlap(instance.id))
            .filter(|instance| overlap(instance.id) > 0);
        let selected = most.is_some_and(|instance| query.referents.contains(&instance.name));
        let seen = grounder.prepare(&view.clip);
        let label = |note: &String| -> Option<String> {
            let number: usize = note.strip_prefix("thing ")?.split(' ').next()?.parse().ok()?;
            let track = seen.tracks.get(number)?;
            let best = scene
                .instances
                .iter()
                .map(|instance| (tube(track, &masks_of(view, instance.id)), instance.name.as_str()));
            let (iou, name) = best.max_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(format!("[{name} {iou:.2}: {}]", note.split("): ").nth(1).unwrap_or_default()))
        };
        let last = grounding.notes.iter().filter_map(label).collect::<Vec<String>>().join(" ");
        if is_talking {
            println!(
                "  {} {:.2} (chance {:.2}) {:.2}s {} -> {} {}| {last}",
                query.id,
                iou,
                chance,
                seconds,
                query.text,
                most.map_or("-", |instance| instance.name.as_str()),
                if selected { "OK " } else { "" }
            );
        }
        tables.answers.push(Answer {
            category: query.categories[0],
            answered: matches!(grounding.outcome, Outcome::Found | Outcome::Absent),
            iou,
            chance,
            union: mean_iou(&union, &truth),
            selected,
        });
    }
}

/// Over the frames in which the truth has pixels.
fn mean_iou(masks: &[Mask], truth: &[Mask]) -> f64 {
    let present = masks.iter().zip(truth).filter(|(_, truth)| !truth.is_empty());
    let ious: Vec<f64> = present
        .map(|(mask, truth)| mask.and_count(truth) as f64 / mask.or_count(truth).max(1) as f64)
        .collect();
    ious.iter().sum::<f64>() / ious.len().max(1) as f64
}

impl Tables {
    fn print(&self) {
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let values: Vec<f64> = values.collect();
            100.0 * values.iter().sum::<f64>() / values.len().max(1) as f64
        };
        let mut scenes: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        self.perception.iter().for_each(|(scene, iou)| scenes.entry(scene).or_default().push(*iou));
        for (scene, ious) in scenes {
            println!("best track of an object, {scene}: {:.1}", mean(&mut ious.into_iter()));
        }
        if !self.absents.is_empty() {
            println!("views x sentences that nothing satisfies: {:?}", self.absents);
        }
        println!(
            "best track of an object: {:.1}; perception {:.2} s a view",
            mean(&mut self.perception.iter().map(|entry| entry.1)),
            mean(&mut self.seconds.iter().copied()) / 100.0
        );
        for category in Category::ALL.into_iter().map(Some).chain([None]) {
            let of = || {
                self.answers
                    .iter()
                    .filter(move |answer| category.is_none_or(|category| category == answer.category))
            };
            if of().count() > 0 {
                println!(
                    "{:12} views x queries {:4}  answered {:5.1}  IoU {:5.1}  select {:5.1}  random object {:5.1}  union {:5.1}",
                    category.map_or("all", Category::as_str),
                    of().count(),
                    mean(&mut of().map(|answer| f64::from(u8::from(answer.answered)))),
                    mean(&mut of().map(|answer| answer.iou)),
                    mean(&mut of().map(|answer| f64::from(u8::from(answer.selected)))),
                    mean(&mut of().map(|answer| answer.chance)),
                    mean(&mut of().map(|answer| answer.union))
                );
            }
        }
    }
}
