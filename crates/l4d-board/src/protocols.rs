//! Numbers under the protocols of other evaluations: a table each, apart from the board and from each other, never
//! ranked. Every number follows from the values of queries that `l4d score --protocol` wrote, by `l4d-score`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::store::list_folder;
use l4d_data::{Category, DataError, Name, QueryId, Report, Scale};
use l4d_score::protocols::{LeftOut, Measure, Record, Sheet, shared};
use l4d_score::{EvalSet, Protocol};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::board::{BoardScene, Heading, MOST_DETAILED, Method};
use crate::codes;
use crate::markdown::{Table, escape, hundredths, linked};

/// What one protocol says of methods.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProtocolTable {
    pub protocol: Protocol,
    /// In the order of the board, then those that are not on it, by name.
    pub rows: Vec<ProtocolRow>,
}

/// One method under a protocol. Numbers are percent, in the order of the protocol's measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProtocolRow {
    pub name: Name,
    /// Its version.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// What keeps it from being compared with others as an equal: `baseline`, `partial`, ...
    pub remarks: Vec<String>,
    /// Of all queries.
    pub numbers: Vec<Option<f64>>,
    /// Of each scene.
    pub scenes: BTreeMap<Name, Vec<Option<f64>>>,
    /// Queries that enter at least one number.
    pub queries: usize,
    /// What the source leaves out or counts without an answer.
    pub left_out: Vec<LeftOut>,
    /// Of each smaller group that the page filters by (`category|scale`) and that has queries; of the first methods alone.
    pub groups: BTreeMap<String, Vec<Option<f64>>>,
    /// Of each query; of the first methods alone.
    pub values: BTreeMap<QueryId, Vec<Option<f64>>>,
}

/// Reads what protocols say of methods: `<scores>-<protocol>/<method>/`, for every protocol that has such a folder. What
/// was judged against something else than `eval_set` is reported and left out.
pub(crate) fn gather_protocols(
    scores: &Path,
    methods: &[Method],
    scenes: &[BoardScene],
    eval_set: &EvalSet,
    report: &mut Report,
) -> Result<Vec<ProtocolTable>, DataError> {
    let place: BTreeMap<&str, usize> =
        methods.iter().enumerate().map(|(place, method)| (method.name.as_str(), place)).collect();
    let mut tables = Vec::new();
    for protocol in Protocol::ALL {
        let Some(folder) = folder(scores, protocol).filter(|folder| folder.is_dir()) else { continue };
        let mut names = list_folder(&folder)?;
        names.retain(|name| folder.join(name).is_dir());
        names.sort_by_key(|name| place.get(name.as_str()).copied().unwrap_or(usize::MAX));
        let read: Vec<Option<Record>> = names
            .par_iter()
            .map(|name| Record::read(&folder, name, protocol))
            .collect::<Result<_, DataError>>()?;
        let mut rows = Vec::new();
        for (place, (name, record)) in names.iter().zip(read).enumerate() {
            match record {
                Some(record) if record.origin.is_of(eval_set) => {
                    rows.push(ProtocolRow::of(record, eval_set, scenes, place < MOST_DETAILED));
                }
                other => report_left_out(&folder.join(name), protocol, other, report),
            }
        }
        if !rows.is_empty() {
            tables.push(ProtocolTable { protocol, rows });
        }
    }
    Ok(tables)
}

/// Where `l4d score --protocol` writes, beside the folder of scores.
fn folder(scores: &Path, protocol: Protocol) -> Option<PathBuf> {
    let whole = match scores.file_name() {
        Some(_) => scores.to_owned(),
        None => std::fs::canonicalize(scores).ok()?,
    };
    let mut name = whole.file_name()?.to_owned();
    name.push(format!("-{protocol}"));
    Some(whole.with_file_name(name))
}

fn report_left_out(folder: &Path, protocol: Protocol, record: Option<Record>, report: &mut Report) {
    let Some(Record { origin, .. }) = record else {
        let message = format!("holds nothing of the protocol {protocol}, so it is left out");
        let hint = format!("run `l4d score --protocol {protocol}`, or remove the folder");
        report.warning(codes::NOT_SCORED, folder, "", message, hint);
        return;
    };
    let message = format!(
        "was judged on benchmark {} · profile {} · {}, so it is left out",
        origin.benchmark_version,
        origin.profile,
        origin.set.as_str()
    );
    let hint = format!("run `l4d score --protocol {protocol}` again, or choose its --profile and --set");
    report.warning(codes::OTHER_BOARD, folder, "", message, hint);
}

/// The name of a group of queries: `category|scale`, each empty where all are meant.
pub(crate) fn group_key(category: Option<Category>, scale: Option<Scale>) -> String {
    format!("{}|{}", category.map_or("", Category::as_str), scale.map_or("", Scale::as_str))
}

/// Every group that the page filters by, all queries first.
pub(crate) fn group_filters() -> impl Iterator<Item = (Option<Category>, Option<Scale>)> {
    let categories = std::iter::once(None).chain(Category::ALL.map(Some));
    categories.flat_map(|category| {
        std::iter::once(None).chain(Scale::ALL.map(Some)).map(move |scale| (category, scale))
    })
}

impl ProtocolRow {
    fn of(record: Record, eval_set: &EvalSet, scenes: &[BoardScene], is_detailed: bool) -> Self {
        let remarks = record.remarks(eval_set).into_iter().map(str::to_owned).collect();
        let Record { origin, sheet } = record;
        let (mut groups, mut values) = (BTreeMap::new(), BTreeMap::new());
        if is_detailed {
            for (category, scale) in group_filters().skip(1) {
                let found = sheet.of(|id| is_in(id, scenes, category, scale));
                if !found.rows.is_empty() {
                    groups.insert(group_key(category, scale), numbers(&found));
                }
            }
            let percent = |row: &l4d_score::protocols::Row| {
                row.judged.values.iter().map(|value| value.map(|value| 100.0 * value.mean)).collect()
            };
            values = sheet.rows.iter().map(|row| (row.id.clone(), percent(row))).collect();
        }
        let of_scene = |scene: &Name| (scene.clone(), numbers(&sheet.of(|id| id.scene == *scene)));
        Self {
            version: origin.version,
            link: origin.link,
            remarks,
            numbers: numbers(&sheet),
            scenes: sheet.scenes().into_keys().map(of_scene).collect(),
            queries: sheet.queries(),
            groups,
            values,
            name: sheet.method,
            left_out: sheet.left_out,
        }
    }
}

fn is_in(id: &QueryId, scenes: &[BoardScene], category: Option<Category>, scale: Option<Scale>) -> bool {
    let Some(scene) = scenes.iter().find(|scene| scene.name == id.scene) else { return false };
    let Some(query) = scene.queries.iter().find(|query| query.id == *id) else { return false };
    category.is_none_or(|category| query.categories.contains(&category))
        && scale.is_none_or(|scale_of| scale_of == scene.scale)
}

/// Percent, in the order of the measures.
fn numbers(sheet: &Sheet) -> Vec<Option<f64>> {
    let measures = 0..sheet.protocol.rules().measures.len();
    measures.map(|measure| sheet.number(measure).map(|ratio| 100.0 * ratio)).collect()
}

impl ProtocolTable {
    /// `Panoptic-L4D 1.0.0 · protocol davis (DAVIS 2017, semi-supervised) · profile small · never ranked`.
    pub fn line(&self, heading: &Heading) -> String {
        format!(
            "{} {} · protocol {} ({}) · profile {} · never ranked",
            heading.benchmark,
            heading.on.benchmark_version,
            self.protocol,
            self.protocol.rules().source,
            heading.on.profile
        )
    }

    /// `protocols/<protocol>.md`.
    pub(crate) fn markdown(&self, heading: &Heading) -> String {
        let measures = self.protocol.rules().measures;
        let mut page = format!(
            "# Protocol {}\n\n{}.\n\nPercent. The masks of this benchmark under the sums of another evaluation: no headline, \
             and in no order of merit. `docs/protocols.md` of l4d says what is counted.\n\n{}\n\n",
            self.protocol,
            escape(&self.line(heading)),
            escape(self.protocol.rules().remark)
        );
        let mut table = Table::new(&["method", "version", "remarks"]);
        table.numbers(measures.iter().map(|measure| format!("{}: {}", self.protocol, measure.title)));
        table.numbers(["queries"]);
        for row in &self.rows {
            let mut cells = vec![linked(&row.name, &row.link), escape(&row.version), row.remarks.join(", ")];
            cells.extend(row.numbers.iter().map(|value| hundredths(*value)));
            cells.push(row.queries.to_string());
            table.row(cells);
        }
        page.push_str(&table.finish());
        let left_out = self.rows.iter().map(|row| (row.name.as_str(), row.left_out.as_slice()));
        let left_out = shared(left_out);
        if !left_out.is_empty() {
            page.push_str("## What the source leaves out\n\n");
        }
        for (who, LeftOut { what, queries, frames }) in left_out {
            let who = who.into_iter().map(escape).collect::<Vec<_>>().join(", ");
            page.push_str(&format!("- {who}: {frames} frames of {queries} queries {}.\n", escape(what)));
        }
        page
    }

    /// What `l4d leaderboard --json` prints of it, percent.
    pub fn to_json(&self) -> Value {
        let named = |numbers: &[Option<f64>]| -> Map<String, Value> {
            let pairs = self.protocol.rules().measures.iter().zip(numbers);
            pairs.map(|(Measure { key, .. }, number)| ((*key).to_owned(), json!(number))).collect()
        };
        let row = |row: &ProtocolRow| {
            let scenes: Map<String, Value> =
                row.scenes.iter().map(|(scene, found)| (scene.to_string(), named(found).into())).collect();
            json!({
                "name": row.name, "version": row.version, "remarks": row.remarks, "measures": named(&row.numbers),
                "scenes": scenes, "queries": row.queries, "left_out": row.left_out,
            })
        };
        json!({
            "protocol": self.protocol.as_str(), "source": self.protocol.rules().source, "is_headline": false,
            "remark": self.protocol.rules().remark, "methods": self.rows.iter().map(row).collect::<Value>(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_page_names_its_protocol_in_every_head_and_says_what_is_left_out() {
        insta::assert_snapshot!(sample::protocol().markdown(&sample::heading(4, 1)));
    }

    #[test]
    fn folders_of_protocols_are_beside_that_of_scores() {
        let found = |scores: &str| folder(Path::new(scores), Protocol::Davis);
        assert_eq!(found("scores"), Some("scores-davis".into()));
        assert_eq!(found("a/scores-composites/"), Some("a/scores-composites-davis".into()));
        assert_eq!(found("nowhere/.."), None);
    }
}
