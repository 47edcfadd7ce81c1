//! From values of queries to the numbers of a protocol, and their forms as text, CSV and JSON.

use std::collections::BTreeMap;

use l4d_data::{Name, QueryId};
use serde_json::{Map, Value as Json, json};

use super::clip::{LeftOut, QueryScores, Value};
use super::{Averaging, Measure, Protocol, saco};
use crate::metrics::mean;
use crate::table::{NAME_WIDTH, line, percent, wrapped};

/// What a protocol says of one query.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub id: QueryId,
    pub judged: QueryScores,
}

/// What a protocol says of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    pub protocol: Protocol,
    pub method: Name,
    /// One row a query, in the order of scenes and queries.
    pub rows: Vec<Row>,
    /// What was left out, summed over all queries, in the order of the protocol.
    pub left_out: Vec<LeftOut>,
    /// Whether frames without an answer were left out by request, so that the numbers rest on other frames than those
    /// of other methods.
    pub is_partial: bool,
}

impl Sheet {
    /// Sums up queries.
    pub fn new(protocol: Protocol, method: Name, rows: Vec<Row>, is_partial: bool) -> Self {
        let left_out = sum(rows.iter().flat_map(|row| &row.judged.left_out));
        Self { protocol, method, rows, left_out, is_partial }
    }

    /// The same of some of its queries alone.
    pub fn of(&self, is_wanted: impl Fn(&QueryId) -> bool) -> Self {
        let rows = self.rows.iter().filter(|row| is_wanted(&row.id)).cloned().collect();
        Self::new(self.protocol, self.method.clone(), rows, self.is_partial)
    }

    /// The number of a measure, 0 to 1; none where nothing is to be averaged.
    pub fn number(&self, measure: usize) -> Option<f64> {
        let scenes = self.scenes();
        match self.protocol.rules().averaging {
            Averaging::Counts => self.of_scene(&self.rows.iter().collect::<Vec<_>>(), measure),
            Averaging::Queries => mean_of_queries(self.rows.iter(), measure),
            Averaging::PairsThenScenes | Averaging::QueriesThenScenes => {
                mean(scenes.values().filter_map(|rows| self.of_scene(rows, measure)))
            }
        }
    }

    /// The number of the measure of that key.
    pub fn get(&self, key: &str) -> Option<f64> {
        let measure = self.protocol.rules().measures.iter().position(|measure| measure.key == key)?;
        self.number(measure)
    }

    /// Queries that enter at least one number.
    pub fn queries(&self) -> usize {
        self.rows.iter().filter(|row| row.judged.values.iter().any(Option::is_some)).count()
    }

    /// One row a query: each value, percent, with the frames that it rests on.
    pub fn to_csv(&self) -> String {
        let mut text = columns(self.protocol).join(",");
        text.push('\n');
        for Row { id, judged } in &self.rows {
            text.push_str(&format!("{},{},{}", self.protocol, id.scene, id.number));
            for value in &judged.values {
                match value {
                    Some(Value { mean, frames }) => text.push_str(&format!(",{},{frames}", 100.0 * mean)),
                    None => text.push_str(",,0"),
                }
            }
            text.push('\n');
        }
        text
    }

    /// Everything as JSON, percent.
    pub fn to_json(&self) -> Json {
        let scenes: Map<String, Json> = self
            .scenes()
            .into_iter()
            .map(|(scene, rows)| (scene.to_string(), self.numbers(|measure| self.of_scene(&rows, measure))))
            .collect();
        json!({
            "name": self.method,
            "protocol": self.protocol.as_str(),
            "measures": self.numbers(|measure| self.number(measure)),
            "scenes": scenes,
            "queries": self.queries(),
            "asked_queries": self.rows.len(),
            "left_out": self.left_out,
            "partial": self.is_partial,
        })
    }

    fn numbers(&self, number: impl Fn(usize) -> Option<f64>) -> Json {
        let measures = self.protocol.rules().measures.iter().enumerate();
        let percent = |measure| number(measure).map(|ratio| 100.0 * ratio);
        measures
            .map(|(index, measure)| (measure.key.to_owned(), json!(percent(index))))
            .collect::<Map<_, _>>()
            .into()
    }

    fn of_scene(&self, rows: &[&Row], measure: usize) -> Option<f64> {
        match self.protocol.rules().averaging {
            Averaging::Counts => saco::number(rows, measure),
            Averaging::PairsThenScenes => {
                let values = || rows.iter().filter_map(|row| row.judged.values[measure]);
                let frames: u64 = values().map(|value| value.frames).sum();
                let sum: f64 = values().map(|value| value.mean * value.frames as f64).sum();
                (frames > 0).then(|| sum / frames as f64)
            }
            Averaging::QueriesThenScenes | Averaging::Queries => {
                mean_of_queries(rows.iter().copied(), measure)
            }
        }
    }

    /// Its rows by scene.
    pub fn scenes(&self) -> BTreeMap<&Name, Vec<&Row>> {
        let mut scenes: BTreeMap<&Name, Vec<&Row>> = BTreeMap::new();
        for row in &self.rows {
            scenes.entry(&row.id.scene).or_default().push(row);
        }
        scenes
    }
}

fn sum<'a>(parts: impl Iterator<Item = &'a LeftOut>) -> Vec<LeftOut> {
    let mut all: Vec<LeftOut> = Vec::new();
    for one in parts {
        match all.iter_mut().find(|other| other.what == one.what) {
            Some(other) => {
                other.queries += one.queries;
                other.frames += one.frames;
            }
            None => all.push(one.clone()),
        }
    }
    all
}

/// Columns of the CSV file.
pub(super) fn columns(protocol: Protocol) -> Vec<String> {
    let measures = protocol.rules().measures.iter();
    let pairs = measures.flat_map(|measure| [measure.key.to_owned(), format!("{}_frames", measure.key)]);
    ["protocol", "scene", "query"].map(str::to_owned).into_iter().chain(pairs).collect()
}

/// Stem of the files of a protocol, so that none can be taken for another.
pub(super) fn file_stem(protocol: Protocol) -> String {
    format!("protocol-{protocol}")
}

/// The numbers of methods under one protocol, percent, and what the source leaves out. Its name is above.
pub fn render(protocol: Protocol, sheets: &[Sheet]) -> String {
    let mut text = format!("protocol {protocol} ({}), never ranked\n", protocol.rules().source);
    let width = |measure: &Measure| 8.max(measure.title.len() + 1);
    let titles =
        protocol.rules().measures.iter().map(|measure| format!("{:>1$}", measure.title, width(measure)));
    line(&mut text, protocol.as_str(), titles.chain([format!("{:>9}", "queries")]));
    for sheet in sheets {
        let cell = |(index, measure): (usize, &Measure)| {
            format!("{:>1$}", percent(sheet.number(index).map(|ratio| 100.0 * ratio)), width(measure))
        };
        let cells = protocol.rules().measures.iter().enumerate().map(cell);
        let mark = if sheet.is_partial { " partial" } else { "" };
        let cells = cells.chain([format!("{:>9}{mark}", sheet.queries())]);
        if sheet.method.len() <= NAME_WIDTH {
            line(&mut text, &sheet.method, cells);
        } else {
            // Whole, so that no two methods look the same: above its numbers.
            text.push_str(&format!("{}\n", sheet.method));
            line(&mut text, "", cells);
        }
    }
    let left_out = sheets.iter().map(|sheet| (sheet.method.as_str(), sheet.left_out.as_slice()));
    for (who, LeftOut { what, queries, frames }) in shared(left_out) {
        text.push_str(&wrapped(&format!("{}: {frames} frames of {queries} queries {what}.", who.join(", "))));
    }
    text.push_str(&wrapped(protocol.rules().remark));
    text
}

/// What was left out of each method, once for all of which the same is true; of all of several it is true of "every
/// method".
pub fn shared<'a>(
    methods: impl Iterator<Item = (&'a str, &'a [LeftOut])>,
) -> Vec<(Vec<&'a str>, &'a LeftOut)> {
    let mut all: Vec<(Vec<&str>, &LeftOut)> = Vec::new();
    let mut count = 0;
    for (method, left_out) in methods {
        count += 1;
        for one in left_out {
            match all.iter_mut().find(|(_, other)| *other == one) {
                Some((methods, _)) => methods.push(method),
                None => all.push((vec![method], one)),
            }
        }
    }
    for (methods, _) in all.iter_mut().filter(|(methods, _)| methods.len() == count && count > 1) {
        *methods = vec!["every method"];
    }
    all
}

fn mean_of_queries<'a>(rows: impl Iterator<Item = &'a Row>, measure: usize) -> Option<f64> {
    mean(rows.filter_map(|row| row.judged.values[measure]).map(|value| value.mean))
}
