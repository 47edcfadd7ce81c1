//! What is in `scores-<protocol>/<method>/`: a sheet with everything that its numbers depend on.
//!
//! The rows of the CSV file are the base: numbers that are read back are derived from them anew.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use l4d_data::results::{MethodCard, Used};
use l4d_data::store::{Claim, Earlier, read_bounded, write_atomic};
use l4d_data::{DataError, Name, Profile, QueryId, QuerySet, json as file};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::Protocol;
use super::clip::{LeftOut, QueryScores, Value};
use super::sheet::{Row, Sheet, file_stem};
use crate::eval_set::EvalSet;
use crate::metrics::Options;
use crate::summary::{PARTIAL, handicaps};

const SCHEMA: &str = "l4d/protocol/1";
/// No sound file is larger: some thousand queries of a line each.
const MAX_BYTES: u64 = 256 << 20;
/// Rounding of a percentage that was written and read.
const TOLERANCE: f64 = 1e-6;

/// Whose masks were judged, and against what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Version of the method.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// What the method looked at.
    pub used: Used,
    /// The card says that it is a baseline.
    #[serde(default)]
    pub baseline: bool,
    /// Profile of truth and masks.
    pub profile: Profile,
    /// Version of the benchmark.
    pub benchmark_version: String,
    /// [`l4d_data::Benchmark::truth_digest`].
    pub truth_digest: String,
    /// Which sentences were asked.
    pub set: QuerySet,
    /// Choices that change numbers.
    pub options: Options,
}

impl Origin {
    /// Of the method with this card.
    pub fn new(card: MethodCard, eval_set: &EvalSet, options: &Options) -> Self {
        Self {
            version: card.version,
            link: card.link,
            used: card.used,
            baseline: card.baseline,
            profile: eval_set.profile,
            benchmark_version: card.benchmark_version,
            truth_digest: card.truth_digest,
            set: eval_set.set,
            options: *options,
        }
    }

    /// Whether the masks were judged against the truth and sentences of this evaluation set.
    pub fn is_of(&self, eval_set: &EvalSet) -> bool {
        self.set == eval_set.set
            && self.profile == eval_set.profile
            && self.benchmark_version == eval_set.bench.manifest.version
            && self.truth_digest == eval_set.truth_digest
    }
}

/// A sheet and what it is of.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// What it is of.
    pub origin: Origin,
    pub sheet: Sheet,
}

#[derive(Deserialize)]
struct File {
    schema: String,
    name: Name,
    protocol: Protocol,
    #[serde(flatten)]
    origin: Origin,
    left_out: Vec<LeftOut>,
    partial: bool,
}

impl Record {
    /// Writes `<scores>/<method>/protocol-<name>.{csv,json}`.
    ///
    /// # Errors
    /// Files of others of these names, unless `force`, and what the disk refuses.
    pub fn write(&self, scores: &Path, force: bool) -> Result<(), DataError> {
        let Self { origin, sheet } = self;
        let path = |ending| path(scores, &sheet.method, sheet.protocol, ending);
        let [csv, json] = ["csv", "json"].map(|ending| file_name(sheet.protocol, ending));
        let earlier = Earlier { file: &json, says: SCHEMA };
        let folder = scores.join(sheet.method.as_str());
        let _claim = Claim::take(&folder, vec![csv, json.clone()], Some(earlier), force)?;
        write_atomic(&path("csv"), sheet.to_csv().as_bytes())?;
        let origin = serde_json::to_value(origin).expect("names, flags and numbers serialise");
        let mut document = sheet.to_json();
        document["schema"] = SCHEMA.into();
        if let (Json::Object(document), Json::Object(origin)) = (&mut document, origin) {
            document.extend(origin);
        }
        file::write(&path("json"), &document)
    }

    /// Reads what [`Record::write`] wrote; none if that protocol did not judge the method.
    ///
    /// # Errors
    /// Files that are damaged, of another method or protocol, or that contradict each other.
    pub fn read(scores: &Path, method: &str, protocol: Protocol) -> Result<Option<Self>, DataError> {
        let json_path = path(scores, method, protocol, "json");
        if !json_path.exists() {
            return Ok(None);
        }
        let again = format!("run `l4d score --protocol {protocol}` again");
        let File { schema, name, protocol: of, origin, left_out, partial } = file::read(&json_path)?;
        for (field, found, wanted) in [
            ("schema", schema.as_str(), SCHEMA),
            ("name", name.as_str(), method),
            ("protocol", of.as_str(), protocol.as_str()),
        ] {
            if found != wanted {
                let message = format!("is `{found}` instead of `{wanted}`");
                return Err(DataError::invalid(&json_path, format!("field `{field}`"), message, again));
            }
        }
        let rows = read_rows(&path(scores, method, protocol, "csv"), protocol, &again)?;
        Ok(Some(Self {
            origin,
            sheet: Sheet { protocol, method: name, rows, left_out, is_partial: partial },
        }))
    }

    /// What keeps the method from being compared with others as an equal: `baseline`, `used ground truth`, ...
    pub fn remarks(&self, eval_set: &EvalSet) -> Vec<&'static str> {
        let Self { origin, sheet } = self;
        let queries = eval_set.scenes.iter().flat_map(|scene| &scene.queries);
        let asked = queries.filter(|query| origin.options.takes(query)).count();
        let found = [
            (origin.used.depth, "saw rendered depth"),
            (origin.options.verified_only, "verified queries only"),
            (sheet.is_partial || sheet.rows.len() != asked, PARTIAL),
        ];
        let mut remarks = handicaps(&sheet.method, origin.baseline, &origin.used);
        remarks.extend(found.into_iter().filter(|(holds, _)| *holds).map(|(_, remark)| remark));
        remarks
    }
}

fn path(scores: &Path, method: &str, protocol: Protocol, ending: &str) -> PathBuf {
    scores.join(method).join(file_name(protocol, ending))
}

fn file_name(protocol: Protocol, ending: &str) -> String {
    format!("{}.{ending}", file_stem(protocol))
}

fn read_rows(path: &Path, protocol: Protocol, again: &str) -> Result<Vec<Row>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let mut lines = csv::Reader::from_reader(bytes.as_slice());
    let invalid =
        |line: usize, message: String| DataError::invalid(path, format!("line {line}"), message, again);
    let header = lines.headers().map_err(|error| invalid(1, error.to_string()))?;
    let wanted = super::sheet::columns(protocol);
    if header.iter().ne(wanted.iter().map(String::as_str)) {
        return Err(invalid(1, format!("is no header of this protocol, which is `{}`", wanted.join(","))));
    }
    let mut seen = BTreeSet::new();
    let mut rows = Vec::new();
    for (index, line) in lines.deserialize::<Line>().enumerate() {
        // The header is line 1.
        let number = index + 2;
        let line = line.map_err(|error| invalid(number, error.to_string()))?;
        let row = row(line, protocol).map_err(|message| invalid(number, message))?;
        if !seen.insert(row.id.clone()) {
            return Err(invalid(number, format!("names the query {} a second time", row.id)));
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Protocol, scene, number of the query, then percent and frames of each measure.
type Line = (Protocol, String, String, Vec<Option<f64>>);

fn row((name, scene, number, values): Line, protocol: Protocol) -> Result<Row, String> {
    if name != protocol {
        return Err(format!("is of the protocol `{name}`"));
    }
    let id: QueryId = format!("{scene}/{number}").parse().map_err(|error| format!("{error}"))?;
    let value = |pair: &[Option<f64>]| match *pair {
        [Some(percent), Some(frames)] => {
            let is_sound = (-100.0 - TOLERANCE..=100.0 + TOLERANCE).contains(&percent);
            let mean = percent / 100.0;
            is_sound
                .then_some(Some(Value { mean, frames: frames as u64 }))
                .ok_or(format!("`{percent}` is no percentage"))
        }
        [None, Some(_)] => Ok(None),
        _ => Err("has a value without frames".to_owned()),
    };
    let values = values.chunks(2).map(value).collect::<Result<Vec<_>, String>>()?;
    Ok(Row { id, judged: QueryScores::new(values) })
}

#[cfg(test)]
mod tests {
    use l4d_data::DataError;

    use super::*;

    fn record() -> Record {
        let row = |id: &str, mean: f64, left_out: usize| Row {
            id: id.parse().unwrap(),
            judged: QueryScores::new([Some(Value { mean, frames: 3 }), None])
                .leaving_out("are dropped", left_out),
        };
        let rows = vec![row("farm/001", 1.0 / 3.0, 2), row("farm/002", 0.7, 0), row("gym/001", 0.0, 5)];
        Record {
            origin: Origin {
                version: "1".to_owned(),
                link: String::new(),
                used: Used::default(),
                baseline: false,
                profile: Profile::Tiny,
                benchmark_version: "0.1.0".to_owned(),
                truth_digest: "ab".to_owned(),
                set: QuerySet::default(),
                options: Options::default(),
            },
            sheet: Sheet::new(Protocol::LangSplat, Name::new("mine").unwrap(), rows, false),
        }
    }

    #[test]
    fn what_was_written_is_read_and_the_numbers_are_derived_again() {
        let folder = tempfile::tempdir().unwrap();
        let written = record();
        written.write(folder.path(), false).unwrap();
        let read = Record::read(folder.path(), "mine", Protocol::LangSplat).unwrap().unwrap();
        assert_eq!((&read.origin, &read.sheet.left_out), (&written.origin, &written.sheet.left_out));
        assert_eq!(read.sheet.left_out[0].frames, 7);
        for measure in 0..2 {
            let numbers = [&written, &read].map(|record| record.sheet.number(measure));
            assert!(numbers[0].zip(numbers[1]).is_none_or(|(a, b)| (a - b).abs() < 1e-12), "{numbers:?}");
            assert_eq!(numbers[0].is_some(), numbers[1].is_some());
        }
        assert_eq!(Record::read(folder.path(), "mine", Protocol::Davis).unwrap(), None);
    }

    #[test]
    fn damage_names_its_file_and_place() {
        let folder = tempfile::tempdir().unwrap();
        record().write(folder.path(), false).unwrap();
        let path = |ending| path(folder.path(), "mine", Protocol::LangSplat, ending);
        let read = || -> DataError { Record::read(folder.path(), "mine", Protocol::LangSplat).unwrap_err() };
        for (ending, from, to, told) in [
            ("csv", ",70,", ",NaN,", "line 3: `NaN` is no percentage"),
            ("csv", ",70,", ",170,", "line 3: `170` is no percentage"),
            ("csv", "gym,001", "farm,001", "line 4: names the query farm/001 a second time"),
            ("csv", "gym,001", "../gym,001", "line 4: "),
            ("csv", "langsplat,gym", "davis,gym", "line 4: is of the protocol `davis`"),
            ("csv", "langsplat,gym", "bull,gym", "line 4: "),
            ("csv", "miou", "moiu", "line 1: is no header of this protocol"),
            ("csv", ",0,3,", ",0,", "line 4: "),
            ("json", "l4d/protocol/1", "l4d/protocol/0", "field `schema`"),
            ("json", "\"mine\"", "\"yours\"", "field `name`: is `yours` instead of `mine`"),
            ("json", "\"langsplat\"", "\"davis\"", "field `protocol`: is `davis` instead of `langsplat`"),
        ] {
            let good = std::fs::read_to_string(path(ending)).unwrap();
            assert!(good.contains(from), "{from} is not in\n{good}");
            std::fs::write(path(ending), good.replacen(from, to, 1)).unwrap();
            let error = read().to_string();
            assert!(error.contains(told), "{told} is not in {error}");
            std::fs::write(path(ending), good).unwrap();
        }
        std::fs::remove_file(path("csv")).unwrap();
        assert!(read().to_string().contains("protocol-langsplat.csv"));
    }
}
