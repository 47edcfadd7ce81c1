//! What the page unpacks when a scene is opened: each method's numbers on each query, its masks, and the truth.

use std::collections::BTreeMap;
use std::sync::PoisonError;

use l4d_data::layout::ResultsDir;
use l4d_data::{DataError, Finding, Name, Query, Report, Role, Severity};
use l4d_score::counts::State;
use l4d_score::metrics::Ratios;
use l4d_score::reading::{Holes, SceneReader};
use l4d_score::{Metric, Protocol};
use serde::Serialize;
use serde_json::{Value, json};

use super::Media;
use super::embed::base64;
use super::masks::{NOTHING, Pool, answer_places, shown_frames, shown_size, target_places};
use super::overview::hundredths;
use crate::board::{Answer, Board, BoardScene, Method};
use crate::codes;
use crate::protocols::{ProtocolRow, ProtocolTable};

/// What the held-out camera saw at a frame, as JPEG of any size; none where there is no picture.
pub type Backdrop<'a> = dyn Fn(&Name, u32) -> Option<Vec<u8>> + Sync + 'a;

/// What is unpacked. Keys are those of the scripts.
#[derive(Serialize)]
pub(crate) struct ScenePage<'a> {
    targets: Vec<Vec<i64>>,
    things: Vec<ThingPage>,
    /// By the place of the method.
    answers: BTreeMap<usize, AnswersPage<'a>>,
    pool: Vec<String>,
    backdrops: Vec<Option<String>>,
    protocols: Value,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ThingPage {
    is_object: bool,
    places: Vec<i64>,
}

/// What lists of scenes show of one: the picture in the middle of its clip or, without it, what is there.
#[derive(Serialize)]
pub(crate) struct Thumbnail<'a> {
    picture: Option<&'a str>,
    /// Whether it is an object, and its mask.
    things: Vec<(bool, &'a str)>,
}

impl ScenePage<'_> {
    pub(crate) fn thumbnail(&self) -> Thumbnail<'_> {
        let middle = self.backdrops.len() / 2;
        let picture = self.backdrops.get(middle).and_then(Option::as_deref);
        let drawn = |thing: &ThingPage| {
            let place = usize::try_from(*thing.places.get(middle)?).ok()?;
            Some((thing.is_object, self.pool.get(place)?.as_str()))
        };
        let things = match picture {
            Some(_) => Vec::new(),
            None => self.things.iter().filter_map(drawn).collect(),
        };
        Thumbnail { picture, things }
    }
}

/// Of one method, query by query.
#[derive(Serialize)]
struct AnswersPage<'a> {
    ratios: Vec<Vec<Option<f64>>>,
    taken: Vec<Option<&'a Name>>,
    frames: Vec<Vec<i16>>,
    masks: Vec<Option<Vec<i64>>>,
}

/// The scene at a place of the board.
pub(crate) fn scene<'a>(board: &'a Board, place: usize, media: &Media) -> Result<ScenePage<'a>, DataError> {
    let (asked, eval_set) = (&board.scenes[place], media.eval_set);
    let scene = &eval_set.scenes[place];
    let truth = eval_set.truth(scene);
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
        ThingPage { is_object: instance.role == Role::Object, places: places.collect() }
    });
    let things = things.collect();
    let first: usize = board.scenes[..place].iter().map(|scene| scene.queries.len()).sum();
    let mut answers = BTreeMap::new();
    let detailed = |method: &&Method| !method.answers.is_empty();
    for (index, method) in board.methods.iter().take_while(detailed).enumerate() {
        let found = &method.answers[first..first + asked.queries.len()];
        let masks = match media.results {
            Some(results) => {
                let dir = ResultsDir::new(results.join(method.name.as_str()));
                let mut wrong = Report::default();
                let reader = SceneReader::open(&dir, scene, method.resize, Holes::Counted, &mut wrong);
                let reader = reader.of_frames(&shown);
                let masks = queries.iter().zip(found).map(|(query, counted)| {
                    answer_places(&mut pool, &reader, query, (asked, &shown), counted, &mut wrong)
                });
                let masks: Vec<Option<Vec<i64>>> = masks.collect();
                report(&masks, &queries, &reader, (&dir, wrong), media);
                masks
            }
            None => vec![None; queries.len()],
        };
        let page = AnswersPage {
            masks,
            ratios: found.iter().map(|answer| ratios(&answer.ratios)).collect(),
            taken: found.iter().map(|answer| answer.taken.as_ref()).collect(),
            frames: found.iter().map(|answer| codes(asked, answer)).collect(),
        };
        answers.insert(index, page);
    }
    let backdrops =
        shown.iter().map(|&frame| (media.backdrop)(&asked.name, frame).map(|jpeg| base64(&jpeg))).collect();
    let protocols = protocols(&board.protocols, asked);
    Ok(ScenePage { targets, things, answers, pool: pool.into_texts(), backdrops, protocols })
}

/// Tells which masks are there and not shown, and what is wrong with their files.
fn report(
    masks: &[Option<Vec<i64>>],
    queries: &[&Query],
    reader: &SceneReader<'_>,
    (dir, wrong): (&ResultsDir, Report),
    media: &Media,
) {
    let mut found = media.found.lock().unwrap_or_else(PoisonError::into_inner);
    let is_error = |finding: &Finding| finding.severity == Severity::Error;
    wrong.into_sorted().into_iter().filter(is_error).for_each(|finding| found.add(finding));
    let is_hidden =
        |(query, places): &(&&Query, &Option<Vec<i64>>)| places.is_none() && reader.has(&query.id);
    let hidden: Vec<&str> =
        queries.iter().zip(masks).filter(is_hidden).map(|(query, _)| query.id.number.as_str()).collect();
    let Some(first) = queries.first().filter(|_| !hidden.is_empty()) else { return };
    let message =
        format!("the masks of {} are not those that were scored, and are not shown", hidden.join(", "));
    let folder = dir.masks().join(first.id.scene.as_str());
    let hint = "run `l4d check-results`, mend what it finds, and score the method again";
    found.warning(codes::OTHER_MASKS, &folder, "", message, hint);
}

/// Percent, in the order of all metrics.
fn ratios(ratios: &Ratios) -> Vec<Option<f64>> {
    Metric::ALL.into_iter().map(|metric| ratios.get(metric).map(|ratio| hundredths(100.0 * ratio))).collect()
}

/// By frame: IoU in thousandths where there is something to find and it was hit, else what happened.
fn codes(scene: &BoardScene, answer: &Answer) -> Vec<i16> {
    let code = |position: usize| match answer.state(scene, position) {
        State::Hit => (answer.iou(position).unwrap_or(0.0) * 1000.0).round() as i16,
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
