//! Numbers under the rules of other evaluations: a table each, apart from the board and from each other, never ranked.
//!
//! Owns where they stand, whose they are, and their tables. Every number follows from the values of queries that
//! `l4d score --protocol` wrote, by the averages of `l4d-score`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::store::list_folder;
use l4d_data::{DataError, Name, Report};
use l4d_score::protocols::{LeftOut, Measure, Origin, Record, Sheet};
use l4d_score::{Exam, Protocol};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::codes;
use crate::detail::MOST_DETAILED;
use crate::markdown::{Table, escape, linked};
use crate::rank::Board;

/// What one protocol says of methods.
#[derive(Debug, Clone, PartialEq)]
pub struct ProtocolTable {
    /// Whose evaluation.
    pub protocol: Protocol,
    /// In the order of the board, then those that are not on it, by name.
    pub rows: Vec<ProtocolRow>,
}

/// One method under a protocol.
#[derive(Debug, Clone, PartialEq)]
pub struct ProtocolRow {
    /// Method.
    pub name: Name,
    /// Its version.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// What keeps it from being compared with others as an equal: `baseline`, `partial`, ...
    pub remarks: Vec<&'static str>,
    /// Percent, in the order of the protocol's measures.
    pub numbers: Vec<Option<f64>>,
    /// The same of each scene.
    pub scenes: BTreeMap<Name, Vec<Option<f64>>>,
    /// Queries that enter at least one number.
    pub queries: usize,
    /// What the source leaves out or counts without an answer.
    pub left_out: Vec<LeftOut>,
    /// Values of queries; of the first methods alone, so that thousands of them stay in bounds.
    pub sheet: Option<Sheet>,
}

/// Reads what protocols say of methods: `<scores>-<protocol>/<method>/`, for every protocol that there is such a folder
/// of. What was judged against something else than `exam` is reported and left out.
///
/// # Errors
/// Files that are damaged or contradict each other.
pub fn gather_protocols(
    scores: &Path,
    board: &Board,
    exam: &Exam,
    report: &mut Report,
) -> Result<Vec<ProtocolTable>, DataError> {
    let place: BTreeMap<&str, usize> =
        board.rows().enumerate().map(|(place, (_, row))| (row.name.as_str(), place)).collect();
    let mut tables = Vec::new();
    for protocol in Protocol::ALL {
        let Some(folder) = folder(scores, protocol).filter(|folder| folder.is_dir()) else { continue };
        let mut names = list_folder(&folder)?;
        names.retain(|name| folder.join(name).is_dir());
        names.sort_by_key(|name| place.get(name.as_str()).copied().unwrap_or(usize::MAX));
        let read = |(index, name): (usize, &String)| {
            let Some(record) = Record::read(&folder, name, protocol)? else { return Ok(Err(Odd::NotJudged)) };
            if !record.origin.is_of(exam) {
                return Ok(Err(Odd::Elsewhere(Box::new(record.origin))));
            }
            Ok(Ok(ProtocolRow::of(record, exam, index < MOST_DETAILED)))
        };
        let read: Vec<Result<ProtocolRow, Odd>> =
            names.par_iter().enumerate().map(read).collect::<Result<_, DataError>>()?;
        let mut rows = Vec::new();
        for (name, found) in names.iter().zip(read) {
            match found {
                Ok(row) => rows.push(row),
                Err(odd) => odd.report(&folder.join(name), protocol, report),
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

/// A folder that is left out.
enum Odd {
    NotJudged,
    Elsewhere(Box<Origin>),
}

impl Odd {
    fn report(self, folder: &Path, protocol: Protocol, report: &mut Report) {
        match self {
            Self::NotJudged => {
                let message = format!("holds nothing of the protocol {protocol}, so it is left out");
                let hint = format!("run `l4d score --protocol {protocol}`, or remove the folder");
                report.warning(codes::NOT_SCORED, folder, "", message, hint);
            }
            Self::Elsewhere(origin) => {
                let message = format!(
                    "was judged on benchmark {} · profile {} · {}, so it is left out",
                    origin.benchmark_version,
                    origin.profile,
                    origin.set.as_str()
                );
                let hint =
                    format!("run `l4d score --protocol {protocol}` again, or choose its --profile and --set");
                report.warning(codes::OTHER_BOARD, folder, "", message, hint);
            }
        }
    }
}

impl ProtocolRow {
    fn of(record: Record, exam: &Exam, is_detailed: bool) -> Self {
        let remarks = record.remarks(exam);
        let Record { origin, sheet } = record;
        Self {
            name: sheet.method.clone(),
            version: origin.version,
            link: origin.link,
            remarks,
            numbers: numbers(&sheet),
            scenes: by_scene(&sheet),
            queries: sheet.queries(),
            left_out: sheet.left_out.clone(),
            sheet: is_detailed.then_some(sheet),
        }
    }
}

/// Percent, in the order of the measures.
pub(crate) fn numbers(sheet: &Sheet) -> Vec<Option<f64>> {
    let measures = 0..sheet.protocol.measures().len();
    measures.map(|measure| sheet.number(measure).map(|ratio| 100.0 * ratio)).collect()
}

/// The same of each scene alone.
pub(crate) fn by_scene(sheet: &Sheet) -> BTreeMap<Name, Vec<Option<f64>>> {
    let of_scene = |scene: &Name| (scene.clone(), numbers(&sheet.of(|id| id.scene == *scene)));
    sheet.scenes().into_keys().map(of_scene).collect()
}

impl ProtocolTable {
    /// `Panoptic-L4D 1.0.0 · protocol davis (DAVIS 2017, semi-supervised) · profile small · never ranked`.
    pub fn line(&self, board: &Board) -> String {
        let heading = &board.heading;
        format!(
            "{} {} · protocol {} ({}) · profile {} · never ranked",
            heading.benchmark,
            heading.version,
            self.protocol,
            self.protocol.source(),
            heading.profile
        )
    }

    /// What was left out, with the methods of which the same is true.
    pub(crate) fn left_out(&self) -> Vec<(&LeftOut, Vec<&Name>)> {
        let mut all: Vec<(&LeftOut, Vec<&Name>)> = Vec::new();
        for row in &self.rows {
            for one in &row.left_out {
                match all.iter_mut().find(|(other, _)| *other == one) {
                    Some((_, methods)) => methods.push(&row.name),
                    None => all.push((one, vec![&row.name])),
                }
            }
        }
        all
    }

    /// `protocols/<protocol>.md`.
    pub(crate) fn markdown(&self, board: &Board) -> String {
        let measures = self.protocol.measures();
        let mut page = format!("# Protocol {}\n\n{}.\n\n", self.protocol, escape(&self.line(board)));
        page.push_str(
            "Percent. The masks of this benchmark under the sums of another evaluation: no headline, and in no order of \
             merit. `docs/protocols.md` of l4d says what is counted.\n\n",
        );
        page.push_str(&format!("{}\n\n", escape(self.protocol.remark())));
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
        let left_out = self.left_out();
        if !left_out.is_empty() {
            page.push_str("## What the source leaves out\n\n");
        }
        for (LeftOut { what, queries, frames }, methods) in left_out {
            let who = match methods.len() == self.rows.len() && methods.len() > 1 {
                true => "every method".to_owned(),
                false => methods.iter().map(|name| escape(name)).collect::<Vec<_>>().join(", "),
            };
            page.push_str(&format!("- {who}: {frames} frames of {queries} queries {}.\n", escape(what)));
        }
        page
    }

    /// What `l4d leaderboard --json` prints of it, percent.
    pub fn to_json(&self) -> Value {
        let named = |numbers: &[Option<f64>]| -> Map<String, Value> {
            let pairs = self.protocol.measures().iter().zip(numbers);
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
            "protocol": self.protocol.as_str(), "source": self.protocol.source(), "is_headline": false,
            "remark": self.protocol.remark(), "methods": self.rows.iter().map(row).collect::<Value>(),
        })
    }
}

fn hundredths(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_page_names_its_protocol_in_every_head_and_tells_what_is_left_out() {
        let board = sample::hand_made();
        let page = sample::protocol().markdown(&board);
        assert!(page.starts_with("# Protocol langsplat\n"), "{page}");
        assert!(
            page.contains(
                "| method | version | remarks | langsplat: mIoU | langsplat: loc. acc. | queries |"
            ),
            "{page}"
        );
        assert!(page.contains("| alpha | 1 |  | 50.00 | – | 2 |"), "{page}");
        assert!(page.contains("| b\\_b | 1 | baseline | 50.00 | – | 2 |"), "{page}");
        assert!(page.contains("- every method: 8 frames of 2 queries are dropped.\n"), "{page}");
        assert!(page.contains("never ranked") && !page.contains("**"), "{page}");
    }

    #[test]
    fn folders_of_protocols_stand_beside_that_of_scores() {
        let found = |scores: &str| folder(Path::new(scores), Protocol::Davis);
        assert_eq!(found("scores"), Some("scores-davis".into()));
        assert_eq!(found("a/scores-composites/"), Some("a/scores-composites-davis".into()));
        assert_eq!(found("nowhere/.."), None);
    }
}
