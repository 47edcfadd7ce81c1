//! The Hugging Face Hub: the benchmark's tasks, a leaderboard as a data set, results for the card of each method.
//!
//! <https://huggingface.co/docs/hub/eval-results>, <https://github.com/huggingface/hub-docs/blob/main/modelcard.md>

use std::collections::BTreeMap;

use l4d_data::DataError;
use l4d_data::results::Track;
use serde::Serialize;
use serde_json::{Value, json};

use super::{COLUMNS, Files, Hosted, unwritable};
use crate::contents::slug;
use crate::documents::render;

/// A scored method, as its scores say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Name of the method.
    pub name: String,
    /// Version of the method.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// Column -> percent; null where there is none.
    pub scores: BTreeMap<String, Option<f64>>,
    /// Queries that the scores rest on.
    pub queries: usize,
    /// Wall seconds for all queries.
    pub seconds: Option<f64>,
    /// With whom it is ranked.
    pub track: Track,
    /// Why it has no place in a ranking; none: it has one.
    pub unranked_because: Option<String>,
}

/// Files for the repository of the data set (`dataset/`) and of each ranked method (`methods/<method>/`). `dataset` is
/// the name of the data set on the Hub.
///
/// # Errors
/// If a template cannot be filled.
pub fn huggingface(hosted: &Hosted<'_>, dataset: &str, entries: &[Entry]) -> Result<Files, DataError> {
    let colour = format!("{}-{}", slug(&hosted.gathered.manifest.name), hosted.profile);
    // The Hub ranks all results of a task with each other.
    let task = |track: Track| match track {
        Track::Colour => colour.clone(),
        Track::ColourDepth => format!("{colour}-depth"),
    };
    let mut entries = entries.to_vec();
    for entry in &mut entries {
        for column in COLUMNS {
            entry.scores.entry(column.key.to_owned()).or_default();
        }
    }
    entries.sort_by(|a, b| {
        let miou = |entry: &Entry| entry.scores["miou"].unwrap_or(-1.0);
        group(a).cmp(&group(b)).then_with(|| miou(b).total_cmp(&miou(a))).then_with(|| a.name.cmp(&b.name))
    });
    let (mut rows, mut tables) = (Vec::new(), Vec::new());
    for members in entries.chunk_by(|a, b| group(a) == group(b)) {
        let title = match group(&members[0]).1 {
            Some(track) => format!("Track: {}", track.title()),
            None => "Not ranked".to_owned(),
        };
        let (first, mut rank) = (rows.len(), 0);
        for (place, entry) in members.iter().enumerate() {
            if place == 0 || printed(entry) != printed(&members[place - 1]) {
                rank = place + 1;
            }
            rows.push(row(entry.unranked_because.is_none().then_some(rank), entry));
        }
        tables.push(json!({ "title": title, "entries": rows[first..] }));
    }
    let mut values = hosted.values();
    values["dataset"] = dataset.into();
    values["task"] = task(Track::Colour).into();
    values["depth_task"] = task(Track::ColourDepth).into();
    values["tables"] = tables.into();
    let mut files = Files::new();
    let mut add = |name: String, template: &str, values: &Value| {
        let text = render(&name, template, values)?;
        files.insert(name, text.into_bytes());
        Ok::<_, DataError>(())
    };
    add("dataset/eval.yaml".to_owned(), include_str!("../../templates/huggingface/eval.yaml"), &values)?;
    let leaderboard = include_str!("../../templates/huggingface/leaderboard.md");
    add("leaderboard/README.md".to_owned(), leaderboard, &values)?;
    for entry in entries.iter().filter(|entry| entry.unranked_because.is_none()) {
        let of = |file: &str| format!("methods/{}/{file}", entry.name);
        let task = task(entry.track);
        values["entry"] = json!(entry);
        values["task"] = task.as_str().into();
        values["track_title"] = entry.track.title().into();
        let results = include_str!("../../templates/huggingface/eval_results.yaml");
        add(of(&format!(".eval_results/{task}.yaml")), results, &values)?;
        add(of("README.md"), include_str!("../../templates/huggingface/method.md"), &values)?;
    }
    files.insert("leaderboard/leaderboard.jsonl".to_owned(), lines(&rows));
    files.insert("leaderboard/leaderboard.csv".to_owned(), table(&rows)?);
    Ok(files)
}

/// What an entry is ranked in, in the order of the leaderboard: a track, or last of all nothing.
fn group(entry: &Entry) -> (bool, Option<Track>) {
    let is_apart = entry.unranked_because.is_some();
    (is_apart, (!is_apart).then_some(entry.track))
}

/// The headline in the digits that tables print: entries with equal ones share a rank.
fn printed(entry: &Entry) -> Option<i64> {
    let miou = entry.scores.get("miou").copied().flatten();
    miou.map(|percent| (100.0 * percent).round() as i64)
}

/// A row of the leaderboard; every row has the same columns.
fn row(rank: Option<usize>, entry: &Entry) -> Value {
    let mut row = json!({
        "rank": rank,
        "track": entry.track,
        "method": entry.name,
        "version": entry.version,
        "link": entry.link,
    });
    for column in COLUMNS {
        row[column.key] = json!(entry.scores.get(column.key).copied().flatten());
    }
    row["queries"] = entry.queries.into();
    row["seconds"] = json!(entry.seconds);
    row["unranked_because"] = entry.unranked_because.clone().unwrap_or_default().into();
    row
}

fn lines(rows: &[Value]) -> Vec<u8> {
    rows.iter().flat_map(|row| format!("{row}\n").into_bytes()).collect()
}

/// The rows as CSV.
fn table(rows: &[Value]) -> Result<Vec<u8>, DataError> {
    let cell = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let mut table = csv::Writer::from_writer(Vec::new());
    let mut write = || {
        let mut rows = rows.iter().filter_map(Value::as_object).peekable();
        rows.peek().map_or(Ok(()), |row| table.write_record(row.keys()))?;
        rows.try_for_each(|row| table.write_record(row.values().map(cell)))
    };
    write().map_err(|error| unwritable("leaderboard.csv", &error))?;
    table.into_inner().map_err(|error| unwritable("leaderboard.csv", &error))
}
