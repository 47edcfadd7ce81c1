//! What the evaluations of others would say of the masks that came in: the judge's protocols, called on masks in memory.

use std::collections::BTreeMap;

use anyhow::Result;
use l4d_data::{Name, Query};
use l4d_import::results::import::{Imported, Request};
use l4d_score::Protocol;
use l4d_score::judge::Answer;
use l4d_score::protocols::{Sheet, judge_answers};
use l4d_score::truth::SceneTruth;
use serde_json::{Map, Value, json};

/// Sheets of every protocol by scene. Only queries with an answer are asked: what is missing is a finding already.
pub(super) struct Recounted(BTreeMap<Name, Vec<Sheet>>);

/// Counts again under every protocol, in scenes that have truth.
pub(super) fn recount(imported: &Imported, request: &Request<'_>, method: &Name) -> Result<Recounted> {
    let mut scenes = BTreeMap::new();
    for scene in imported.sizes.keys() {
        if !request.bench.dir.truth(request.profile, scene).exists() {
            continue;
        }
        let truth = SceneTruth::load(request.bench, request.profile, scene)?;
        let queries = request.bench.queries(scene)?;
        let asked: Vec<&Query> =
            queries.iter().filter(|query| imported.answers.contains_key(&query.id)).collect();
        let mut answers = BTreeMap::new();
        for query in &asked {
            let frames = Answer::of_frames(&imported.answers[&query.id], &truth.frames);
            answers.insert(query.id.clone(), frames);
        }
        let path = request.bench.dir.queries(scene);
        let sheets =
            judge_answers(&Protocol::ALL, method, &truth, &asked, &path, &answers, &imported.summits)?;
        scenes.insert(scene.clone(), sheets);
    }
    Ok(Recounted(scenes))
}

impl Recounted {
    /// `scene: protocol: measure: 0.1234`, in the unit of the logs that claim such numbers.
    pub(super) fn lines(&self) -> Vec<String> {
        let sheets = self.0.iter().flat_map(|(scene, sheets)| sheets.iter().map(move |sheet| (scene, sheet)));
        let line = |(scene, sheet)| {
            numbers(sheet)
                .into_iter()
                .map(move |(key, value)| format!("{scene}: {}: {key}: {value:.4}", sheet.protocol))
        };
        sheets.flat_map(line).collect()
    }

    /// By scene and protocol: the numbers, 0 to 1, and what the source leaves out.
    pub(super) fn to_json(&self) -> Value {
        let of_scene = |sheets: &Vec<Sheet>| -> Map<String, Value> {
            let document = |sheet: &Sheet| {
                let numbers: Map<String, Value> =
                    numbers(sheet).into_iter().map(|(key, value)| (key.to_owned(), json!(value))).collect();
                json!({"measures": numbers, "left_out": sheet.left_out})
            };
            sheets.iter().map(|sheet| (sheet.protocol.to_string(), document(sheet))).collect()
        };
        let scenes = self.0.iter().map(|(scene, sheets)| (scene.to_string(), Value::from(of_scene(sheets))));
        Value::Object(scenes.collect())
    }
}

fn numbers(sheet: &Sheet) -> Vec<(&'static str, f64)> {
    let measures = sheet.protocol.rules().measures.iter().enumerate();
    measures.filter_map(|(index, measure)| Some((measure.key, sheet.number(index)?))).collect()
}
