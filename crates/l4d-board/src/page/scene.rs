//! What the page unpacks when a scene is opened: each method's numbers on each query, its masks, and the truth.

use l4d_data::layout::ResultsDir;
use l4d_data::{DataError, Name, Query, Report, Role};
use l4d_score::counts::State;
use l4d_score::metrics::Ratios;
use l4d_score::reading::{Holes, SceneReader};
use l4d_score::{Metric, Protocol};
use serde_json::{Map, Value, json};

use super::Media;
use super::embed::base64;
use super::masks::{NOTHING, Pool, answer_places, shown_frames, shown_size, target_places};
use super::overview::hundredths;
use crate::board::{Answer, Board, BoardScene, Method};
use crate::protocols::{ProtocolRow, ProtocolTable};

/// What the held-out camera saw at a frame, as JPEG of any size; none where there is no picture.
pub type Backdrop<'a> = dyn Fn(&Name, u32) -> Option<Vec<u8>> + Sync + 'a;

/// The scene at a place of the board.
pub(crate) fn scene(board: &Board, place: usize, media: &Media) -> Result<Value, DataError> {
    let (asked, exam) = (&board.scenes[place], media.exam);
    let scene = &exam.scenes[place];
    let truth = exam.truth(scene);
    let shown = shown_frames(asked);
    let mut pool = Pool::new(shown_size((asked.width, asked.height)));
    let is_asked = |query: &&Query| asked.queries.iter().any(|one| one.id == query.id);
    let queries: Vec<&Query> = scene.queries.iter().filter(is_asked).collect();
    let mut targets = Vec::new();
    for query in &queries {
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
    let first: usize = board.scenes[..place].iter().map(|scene| scene.queries.len()).sum();
    let mut answers = Map::new();
    let detailed = |method: &&Method| !method.answers.is_empty();
    for (index, method) in board.methods.iter().take_while(detailed).enumerate() {
        let found = &method.answers[first..first + asked.queries.len()];
        let dir = media.results.map(|results| ResultsDir::new(results.join(method.name.as_str())));
        let reader = dir.as_ref().map(|dir| {
            let found = &mut Report::default();
            SceneReader::open(dir, scene, method.resize, Holes::Counted, found).of_frames(&shown)
        });
        let masks = queries.iter().zip(found).map(|(query, counted)| {
            answer_places(&mut pool, reader.as_ref()?, query, (asked, &shown), counted)
        });
        let masks: Vec<Option<Vec<i64>>> = masks.collect();
        let entry = json!({
            "ratios": found.iter().map(|answer| ratios(&answer.ratios)).collect::<Value>(),
            "taken": found.iter().map(|answer| answer.taken.as_ref()).collect::<Vec<_>>(),
            "frames": found.iter().map(|answer| codes(asked, answer)).collect::<Value>(),
            "masks": masks,
        });
        answers.insert(index.to_string(), entry);
    }
    let backdrops: Vec<Option<String>> =
        shown.iter().map(|&frame| (media.backdrop)(&asked.name, frame).map(|jpeg| base64(&jpeg))).collect();
    Ok(json!({
        "targets": targets,
        "things": things,
        "answers": answers,
        "pool": pool.into_texts(),
        "backdrops": backdrops,
        "protocols": protocols(&board.protocols, asked),
    }))
}

/// Percent, in the order of all metrics.
fn ratios(ratios: &Ratios) -> Value {
    Metric::ALL.into_iter().map(|metric| ratios.get(metric).map(|ratio| hundredths(100.0 * ratio))).collect()
}

/// By frame: IoU in thousandths where there is something to find and it was hit, else what happened.
fn codes(scene: &BoardScene, answer: &Answer) -> Value {
    let code = |position: usize| match answer.state(scene, position) {
        State::Hit => (answer.iou(position).unwrap_or(0.0) * 1000.0).round() as i64,
        State::Miss => -1,
        State::FalseAlarm => -2,
        State::TrueAbsent => -3,
        State::Missing => -4,
        State::NotAnnotated => -5,
    };
    (0..answer.union.len()).map(code).collect()
}

/// Protocol -> method -> the values of each query of the scene.
fn protocols(tables: &[ProtocolTable], asked: &BoardScene) -> Value {
    let of_row = |row: &ProtocolRow| {
        let values = asked.queries.iter().map(|query| {
            let values = row.values.get(&query.id)?;
            Some(values.iter().map(|value| value.map(hundredths)).collect::<Vec<_>>())
        });
        (row.name.to_string(), json!(values.collect::<Vec<_>>()))
    };
    let of_table = |table: &ProtocolTable| {
        let detailed = table.rows.iter().filter(|row| !row.values.is_empty());
        (Protocol::to_string(&table.protocol), Value::Object(detailed.map(of_row).collect()))
    };
    Value::Object(tables.iter().map(of_table).collect())
}
