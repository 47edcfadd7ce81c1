//! What the page unpacks when a scene is opened: each method's numbers on each query, its masks, and the truth.

use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::{DataError, Name, Role};
use l4d_score::Exam;
use l4d_score::counts::State;
use l4d_score::metrics::QueryTally;
use serde_json::{Map, Value, json};

use super::embed::base64;
use super::masks::{Answers, NOTHING, Pool, shown_frames, shown_size, target_places};
use super::overview::hundredths;
use crate::detail::{AskedScene, Detail, FrameDetail};
use crate::row::Metric;

/// What the held-out camera saw at a frame, as JPEG of any size; none where there is no picture.
pub type Backdrop<'a> = dyn Fn(&Name, u32) -> Option<Vec<u8>> + Sync + 'a;

/// One scene: `first` is the place of its first query among those of `details`.
pub(crate) fn scene(
    exam: &Exam,
    asked: &AskedScene,
    first: usize,
    methods: &[(&Name, &Detail)],
    results: Option<&Path>,
    backdrop: &Backdrop,
) -> Result<Value, DataError> {
    let scene = asked.scene;
    let truth = exam.truth(scene);
    let shown = shown_frames(scene);
    let mut pool = Pool::new(shown_size(scene.size));
    let mut targets = Vec::new();
    for query in &asked.queries {
        let referents = truth.referents(query, &scene.queries_path)?;
        targets.push(target_places(&mut pool, &truth, query, &referents, &shown));
    }
    let things = truth.instances.iter().map(|instance| {
        let places = shown.iter().map(|&frame| {
            let mask = truth.position(frame).and_then(|position| instance.masks[position].as_ref());
            mask.map_or(NOTHING, |mask| pool.place(mask.mask()))
        });
        json!({ "isObject": instance.role == Role::Object, "places": places.collect::<Vec<_>>() })
    });
    let things: Vec<Value> = things.collect();
    let mut answers = Map::new();
    for (index, (name, detail)) in methods.iter().enumerate() {
        let range = first..first + asked.queries.len();
        let (tallies, queries) = (&detail.tallies[range.clone()], &detail.queries[range]);
        let dir = results.map(|results| ResultsDir::new(results.join(name.as_str())));
        let opened = dir.as_ref().map(|dir| Answers::open(dir, scene, &shown, detail.options.resize));
        let masks = asked.queries.iter().zip(queries).map(|(query, counted)| {
            opened.as_ref().and_then(|answers| answers.places(&mut pool, &query.id, &counted.frames))
        });
        let masks: Vec<Option<Vec<i64>>> = masks.collect();
        let entry = json!({
            "ratios": tallies.iter().map(ratios).collect::<Value>(),
            "taken": queries.iter().map(|query| query.taken.as_ref()).collect::<Vec<_>>(),
            "frames": queries.iter().map(|query| query.frames.iter().map(code).collect()).collect::<Vec<Value>>(),
            "masks": masks,
        });
        answers.insert(index.to_string(), entry);
    }
    let backdrops: Vec<Option<String>> =
        shown.iter().map(|&frame| backdrop(&scene.name, frame).map(|jpeg| base64(&jpeg))).collect();
    Ok(json!({
        "targets": targets,
        "things": things,
        "answers": answers,
        "pool": pool.into_texts(),
        "backdrops": backdrops,
    }))
}

/// Percent, in the order of all metrics.
fn ratios(tally: &QueryTally) -> Value {
    let ratios = tally.ratios();
    Metric::ALL
        .map(|metric| metric.of_ratios(&ratios).map(|ratio| hundredths(100.0 * ratio)))
        .as_slice()
        .into()
}

/// IoU in thousandths where there is something to find and it was hit, else what happened.
fn code(frame: &FrameDetail) -> Value {
    match frame.state {
        State::Hit => (frame.iou().unwrap_or(0.0) * 1000.0).round() as i64,
        State::Miss => -1,
        State::FalseAlarm => -2,
        State::TrueAbsent => -3,
        State::Missing => -4,
        State::NotAnnotated => -5,
    }
    .into()
}
