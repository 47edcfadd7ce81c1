//! What thresholds do: curves over them, and the scores that the best of them would give.
//!
//! Two kinds of thresholds. That of a hit is part of the metric, and the curve over it needs masks alone. That of a mask
//! belongs to the method, and the curve over it needs its relevancy (`soft/`). A threshold that was chosen by looking at the
//! truth is an oracle: such numbers are in files of their own, are labelled, and are no scores. Nothing here is written
//! where a leaderboard would look.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{DataError, Name, Query, Report, json as file};
use l4d_masks::png;
use rayon::prelude::*;
use serde::Serialize;

use crate::codes;
use crate::exam::{Exam, SceneExam};
use crate::folder::{Kind, kind_of, report_link};
use crate::judge::judge_query;
use crate::metrics::{Options, mean};
use crate::reading::{Holes, SceneReader};
use crate::results::each_method;
use crate::truth::SceneTruth;

/// Relevancy is a byte: inside is what lies strictly above one of these.
const LEVELS: usize = 255;
/// Thresholds of a hit: multiples of a twentieth, from 0.
const HITS: usize = 20;
/// Written beside every such number.
pub const LABEL: &str =
    "sweep: thresholds chosen by looking at the truth are no scores, and nothing here is ranked";

/// Curves of one method, percent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// [`LABEL`].
    pub label: &'static str,
    /// The method.
    pub name: Name,
    /// Share of present frames with an IoU above a threshold, mean over queries.
    pub hits: Vec<Hit>,
    /// Mean of that share over all thresholds.
    pub hits_mean: Option<f64>,
    /// What thresholds of relevancy do; none for methods that give none.
    pub relevancy: Option<Relevancy>,
}

/// A point of the curve over thresholds of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Hit {
    /// IoU that a hit has to exceed.
    pub hit_iou: f64,
    /// Share of frames, percent.
    pub macc: Option<f64>,
}

/// What thresholds of relevancy do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Relevancy {
    /// Queries with relevancy.
    pub queries: usize,
    /// Every threshold.
    pub curve: Vec<Level>,
    /// mIoU with the best threshold for all queries together, and that threshold.
    pub oracle_for_all: Option<(u8, f64)>,
    /// mIoU with the best threshold for each scene.
    pub oracle_by_scene: Option<f64>,
    /// mIoU with the best threshold for each query.
    pub oracle_by_query: Option<f64>,
}

/// A point of the curve over thresholds of relevancy, percent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    /// Inside is what lies strictly above this, of 255.
    pub threshold: u8,
    /// As in a score.
    pub miou: Option<f64>,
    /// As in a score.
    pub tube_iou: Option<f64>,
    /// As in a score.
    pub false_positive_rate: Option<f64>,
}

/// One query at every threshold.
struct Swept {
    hits: Option<[f64; HITS]>,
    soft: Option<Soft>,
}

/// Sums over the frames of one query, by threshold.
struct Soft {
    iou: Vec<f64>,
    present: u64,
    intersection: Vec<u64>,
    union: Vec<u64>,
    alarms: Vec<u64>,
    absent: u64,
}

/// Sweeps one method or a folder of them and writes `<sweeps>/<method>/sweep.{json,csv}`. A method with an error finding
/// has no curves.
///
/// # Errors
/// A folder that cannot be listed, truth that is damaged, and what the disk refuses.
pub fn sweep_results(
    root: &Path,
    exam: &Exam,
    options: &Options,
    sweeps: &Path,
    report: &mut Report,
    progress: impl Fn(&str),
) -> Result<Vec<Sweep>, DataError> {
    each_method(root, exam, options.resize, report, progress, |dir, card, found| {
        let mut scenes = Vec::new();
        for scene in &exam.scenes {
            scenes.push(sweep_scene(dir, scene, exam, options, found)?);
        }
        if found.has_errors() {
            return Ok(None);
        }
        let sweep = summed(card.name, &scenes);
        let folder = sweeps.join(sweep.name.as_str());
        write_atomic(&folder.join("sweep.csv"), to_csv(&sweep).as_bytes())?;
        file::write(&folder.join("sweep.json"), &sweep)?;
        Ok(Some(sweep))
    })
}

fn sweep_scene(
    dir: &ResultsDir,
    scene: &SceneExam,
    exam: &Exam,
    options: &Options,
    report: &mut Report,
) -> Result<Vec<Swept>, DataError> {
    let truth = exam.truth(scene);
    let reader = SceneReader::open(dir, scene, options.resize, Holes::Reported, report);
    let sweep = |query: &&Query| {
        let mut found = Report::default();
        let answers = reader.read(query, &mut found);
        let referents = truth.referents(query, &scene.queries_path)?;
        let counts = judge_query(&truth, query, &referents, &scene.clip, &answers);
        let ious: Vec<f64> = counts
            .iter()
            .filter(|count| count.truth > 0)
            .map(|count| count.intersection as f64 / count.union as f64)
            .collect();
        let soft = soft(dir, query, &truth, &referents, &mut found);
        Ok((Swept { hits: shares(&ious), soft }, found))
    };
    let asked: Vec<&Query> = scene.queries.iter().filter(|query| options.takes(query)).collect();
    let swept = asked.par_iter().map(sweep).collect::<Result<Vec<_>, DataError>>()?;
    Ok(swept.into_iter().map(|(swept, found)| (report.extend(found), swept).1).collect())
}

fn hit_iou(step: usize) -> f64 {
    step as f64 / HITS as f64
}

fn shares(ious: &[f64]) -> Option<[f64; HITS]> {
    let share = |step| ious.iter().filter(|iou| **iou > hit_iou(step)).count() as f64 / ious.len() as f64;
    (!ious.is_empty()).then(|| std::array::from_fn(share))
}

/// The sums of a query with relevancy for every annotated frame; none where there is no folder.
fn soft(
    dir: &ResultsDir,
    query: &Query,
    truth: &SceneTruth,
    referents: &[usize],
    report: &mut Report,
) -> Option<Soft> {
    let folder = dir.soft_folder(&query.id);
    // Every step of the way is looked at: none may be a link.
    for folder in [folder.parent()?.parent()?, folder.parent()?, &folder] {
        match kind_of(folder) {
            Ok(Kind::Folder) => {}
            Ok(_) => {
                report_link(folder, report);
                return None;
            }
            Err(_) => return None,
        }
    }
    let mut sums = Soft::new();
    for (position, &frame) in truth.frames.iter().enumerate() {
        let path = dir.soft_png(&query.id, frame);
        let values = read_map(&path, (truth.width, truth.height), report)?;
        let target = truth.target(query, referents, position);
        let mut counts = [[0_u64; 256]; 2];
        values.iter().for_each(|&value| counts[0][usize::from(value)] += 1);
        if let Some(target) = &target {
            let at = |(col, row): (u32, u32)| row as usize * truth.width as usize + col as usize;
            target.mask().pixels().for_each(|pixel| counts[1][usize::from(values[at(pixel)])] += 1);
        }
        sums.add(target.map_or(0, |target| target.area()), &counts[0], &counts[1]);
    }
    Some(sums)
}

fn read_map(path: &Path, (width, height): (u32, u32), report: &mut Report) -> Option<Vec<u8>> {
    let hint =
        "write 8-bit grayscale of the size of the profile for every annotated frame, or remove the folder";
    match kind_of(path) {
        Ok(Kind::File) => {}
        Ok(_) => {
            report_link(path, report);
            return None;
        }
        Err(_) => {
            report.error(
                codes::MISSING,
                path,
                "file",
                "is missing: relevancy covers all frames or none",
                hint,
            );
            return None;
        }
    }
    // A byte a pixel, and some room.
    let limit = u64::from(width) * u64::from(height) * 65 / 64 + (64 << 10);
    let bytes = match read_bounded(path, limit) {
        Ok(bytes) => bytes,
        Err(error) => {
            report.data_error(codes::TOO_LARGE, &error);
            return None;
        }
    };
    match png::decode_grey(&bytes, width, height) {
        Ok(values) => Some(values),
        Err(error) => {
            report.error(codes::BAD_PNG, path, "file", error.to_string(), hint);
            None
        }
    }
}

impl Soft {
    fn new() -> Self {
        Self {
            iou: vec![0.0; LEVELS],
            present: 0,
            intersection: vec![0; LEVELS],
            union: vec![0; LEVELS],
            alarms: vec![0; LEVELS],
            absent: 0,
        }
    }

    /// Adds a frame by its histograms: of all pixels, and of those of the target.
    fn add(&mut self, target: u64, all: &[u64; 256], inside: &[u64; 256]) {
        let (mut predicted, mut intersection) = (0, 0);
        for threshold in (0..LEVELS).rev() {
            predicted += all[threshold + 1];
            intersection += inside[threshold + 1];
            let union = predicted + target - intersection;
            self.intersection[threshold] += intersection;
            self.union[threshold] += union;
            if target > 0 {
                self.iou[threshold] += intersection as f64 / union as f64;
            } else {
                self.alarms[threshold] += u64::from(predicted > 0);
            }
        }
        self.present += u64::from(target > 0);
        self.absent += u64::from(target == 0);
    }

    fn miou(&self, threshold: usize) -> Option<f64> {
        (self.present > 0).then(|| self.iou[threshold] / self.present as f64)
    }

    fn tube_iou(&self, threshold: usize) -> Option<f64> {
        (self.present > 0).then(|| self.intersection[threshold] as f64 / self.union[threshold] as f64)
    }

    fn false_positive_rate(&self, threshold: usize) -> Option<f64> {
        (self.absent > 0).then(|| self.alarms[threshold] as f64 / self.absent as f64)
    }
}

fn summed(name: Name, scenes: &[Vec<Swept>]) -> Sweep {
    let all = || scenes.iter().flatten();
    let share = |step: usize| mean(all().filter_map(|swept| swept.hits).map(|shares| shares[step]));
    let hits: Vec<Hit> =
        (0..HITS).map(|step| Hit { hit_iou: hit_iou(step), macc: share(step).map(percent) }).collect();
    let hits_mean = mean(hits.iter().filter_map(|hit| hit.macc));
    Sweep { label: LABEL, name, hits_mean, hits, relevancy: relevancy(scenes) }
}

fn relevancy(scenes: &[Vec<Swept>]) -> Option<Relevancy> {
    let scenes: Vec<Vec<&Soft>> = scenes
        .iter()
        .map(|queries| queries.iter().filter_map(|swept| swept.soft.as_ref()).collect())
        .collect();
    let all: Vec<&Soft> = scenes.iter().flatten().copied().collect();
    let over = |queries: &[&Soft], value: &dyn Fn(&Soft) -> Option<f64>| {
        mean(queries.iter().filter_map(|soft| value(soft))).map(percent)
    };
    let miou = |queries: &[&Soft], threshold| over(queries, &|soft| soft.miou(threshold));
    let level = |threshold: usize| Level {
        threshold: threshold as u8,
        miou: miou(&all, threshold),
        tube_iou: over(&all, &|soft| soft.tube_iou(threshold)),
        false_positive_rate: over(&all, &|soft| soft.false_positive_rate(threshold)),
    };
    // Of equally good thresholds the lowest.
    let best = |queries: &[&Soft]| {
        let values = (0..LEVELS).filter_map(|threshold| Some((threshold, miou(queries, threshold)?)));
        values.fold(None, |best: Option<(usize, f64)>, next| match best {
            Some(best) if best.1 >= next.1 => Some(best),
            _ => Some(next),
        })
    };
    let counted = |queries: &&Vec<&Soft>| queries.iter().any(|soft| soft.present > 0);
    let weighed = |queries: &Vec<&Soft>| {
        let count = queries.iter().filter(|soft| soft.present > 0).count();
        best(queries).map(|(_, miou)| (miou * count as f64, count))
    };
    let (sum, count) = scenes
        .iter()
        .filter(counted)
        .filter_map(weighed)
        .fold((0.0, 0), |(sum, count), (more, queries)| (sum + more, count + queries));
    (!all.is_empty()).then(|| Relevancy {
        queries: all.len(),
        curve: (0..LEVELS).map(level).collect(),
        oracle_for_all: best(&all).map(|(threshold, miou)| (threshold as u8, miou)),
        oracle_by_scene: (count > 0).then(|| sum / count as f64),
        oracle_by_query: mean(all.iter().filter_map(|soft| best(&[*soft])).map(|(_, miou)| miou)),
    })
}

fn percent(ratio: f64) -> f64 {
    100.0 * ratio
}

fn to_csv(sweep: &Sweep) -> String {
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let mut text = String::from("sweep,threshold,macc,miou,tube_iou,false_positive_rate\n");
    for Hit { hit_iou, macc } in &sweep.hits {
        text.push_str(&format!("hit_iou,{hit_iou},{},,,\n", cell(*macc)));
    }
    for Level { threshold, miou, tube_iou, false_positive_rate } in
        sweep.relevancy.iter().flat_map(|relevancy| &relevancy.curve)
    {
        let cells = [miou, tube_iou, false_positive_rate].map(|value| cell(*value)).join(",");
        text.push_str(&format!("relevancy,{threshold},,{cells}\n"));
    }
    text
}

/// The curves in short, under their label.
pub fn render(sweeps: &[Sweep]) -> String {
    let percent = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
    let mut text = format!("{LABEL}\n\n{:<24}", "share of frames, IoU >");
    let shown = [0, 5, 10, 15, 18];
    shown.iter().for_each(|&step| text.push_str(&format!("{:>8.2}", hit_iou(step))));
    text.push_str("    mean\n");
    for Sweep { name, hits, hits_mean, .. } in sweeps {
        text.push_str(&format!("{:<24}", name.as_str().chars().take(24).collect::<String>()));
        shown.iter().for_each(|&step| text.push_str(&format!("{:>8}", percent(hits[step].macc))));
        text.push_str(&format!("{:>8}\n", percent(*hits_mean)));
    }
    let with_relevancy: BTreeMap<&Name, &Relevancy> =
        sweeps.iter().filter_map(|sweep| Some((&sweep.name, sweep.relevancy.as_ref()?))).collect();
    if !with_relevancy.is_empty() {
        text.push_str(&format!("\n{:<24}", "oracle mIoU, threshold"));
        text.push_str("  for all (which)  by scene  by query  queries\n");
    }
    for (name, relevancy) in with_relevancy {
        let (which, miou) = relevancy.oracle_for_all.unzip();
        let which = which.map_or_else(|| "-".to_owned(), |threshold| threshold.to_string());
        text.push_str(&format!(
            "{:<24}{:>9} ({which:>5}){:>10}{:>10}{:>9}\n",
            name.as_str().chars().take(24).collect::<String>(),
            percent(miou),
            percent(relevancy.oracle_by_scene),
            percent(relevancy.oracle_by_query),
            relevancy.queries,
        ));
    }
    text
}
