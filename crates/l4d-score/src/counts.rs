//! `counts.csv`: one row per query and frame, from which every score is derived.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::{Path, PathBuf};

use l4d_data::store::open_bounded;
use l4d_data::{DataError, Name, QueryId};
use serde::{Deserialize, Serialize};

/// What happened in one frame of one query.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum State {
    /// Something was to be found, and the prediction shares at least one pixel with it.
    Hit,
    /// Something was to be found, and the prediction shares no pixel with it: it is empty or lies elsewhere.
    Miss,
    /// Nothing was to be found, and the prediction has at least one pixel.
    FalseAlarm,
    /// Nothing was to be found, and the prediction has no pixel.
    TrueAbsent,
    /// The results hold no answer for the frame.
    Missing,
    /// The truth does not say what is to be found in the frame.
    NotAnnotated,
}

impl State {
    /// All states in the order of the documentation.
    pub const ALL: [Self; 6] =
        [Self::Hit, Self::Miss, Self::FalseAlarm, Self::TrueAbsent, Self::Missing, Self::NotAnnotated];

    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}

/// Counts of one query in one frame, pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameCount {
    pub query: QueryId,
    /// Canonical frame.
    pub frame: u32,
    pub state: State,
    /// Pixels in both.
    pub intersection: u64,
    /// Pixels in at least one.
    pub union: u64,
    /// Pixels of the prediction.
    pub predicted: u64,
    /// Pixels of the truth.
    pub truth: u64,
    /// The object or landmark that the prediction overlaps most; none if it overlaps nothing. Among equals an
    /// instance that is not meant comes before one that is, then the lower id.
    pub instance: Option<Name>,
    /// Pixels of that overlap.
    pub instance_overlap: u64,
}

/// No file of counts is larger.
const MAX_BYTES: u64 = 1 << 30;

const HEADER: &str = "scene,query,frame,state,intersection,union,predicted,truth,instance,instance_overlap";

/// A row of the file.
type Row = (Name, Name, u32, State, u64, u64, u64, u64, Option<Name>, u64);

impl FrameCount {
    fn of(row: Row) -> Result<Self, String> {
        let (scene, number, frame, state, intersection, union, predicted, truth, instance, instance_overlap) =
            row;
        let query = format!("{scene}/{number}").parse().map_err(|error| format!("{error}"))?;
        // Sums in u64, so that no value can overflow them: pixel counts stay far below 2^40.
        if [intersection, union, predicted, truth, instance_overlap].iter().any(|&pixels| pixels > 1 << 40) {
            return Err("has a pixel count that no picture has".to_owned());
        }
        if intersection > predicted.min(truth) || union + intersection != predicted + truth {
            return Err("the counts contradict each other".to_owned());
        }
        Ok(Self { query, frame, state, intersection, union, predicted, truth, instance, instance_overlap })
    }
}

/// The rows as CSV.
pub fn to_csv(counts: &[FrameCount], with_header: bool) -> Vec<u8> {
    let start = if with_header { format!("{HEADER}\n").into_bytes() } else { Vec::new() };
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(start);
    for count in counts {
        let QueryId { scene, number } = &count.query;
        let FrameCount { frame, state, intersection, union, predicted, truth, .. } = count;
        let pixels = (intersection, union, predicted, truth);
        let row = (scene, number, frame, state, pixels, &count.instance, count.instance_overlap);
        writer.serialize(row).expect("rows of one shape always serialise to memory");
    }
    writer.into_inner().expect("memory takes all bytes")
}

/// The rows of a `counts.csv`, one after another, so that a file of any length takes no more memory than a row.
pub struct Rows {
    path: PathBuf,
    rows: csv::DeserializeRecordsIntoIter<File, Row>,
    line: usize,
    /// Names come again and again: rows share them.
    names: BTreeSet<Name>,
}

impl Rows {
    /// Opens a file and checks its header.
    ///
    /// # Errors
    /// A file that cannot be read, or has another header.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        let mut reader = csv::Reader::from_reader(open_bounded(path, MAX_BYTES)?);
        let header = reader.headers().map_err(|error| invalid(path, 1, error.to_string()))?;
        if header.iter().ne(HEADER.split(',')) {
            return Err(invalid(path, 1, format!("is not `{HEADER}`")));
        }
        Ok(Self { path: path.to_owned(), rows: reader.into_deserialize(), line: 1, names: BTreeSet::new() })
    }

    fn parsed(&mut self, row: csv::Result<Row>) -> Result<FrameCount, DataError> {
        let row = row.map_err(|error| invalid(&self.path, self.line, error.to_string()))?;
        let mut count = FrameCount::of(row).map_err(|message| invalid(&self.path, self.line, message))?;
        let QueryId { scene, number } = &mut count.query;
        for name in [scene, number].into_iter().chain(&mut count.instance) {
            match self.names.get(name.as_str()) {
                Some(known) => name.clone_from(known),
                None => drop(self.names.insert(name.clone())),
            }
        }
        Ok(count)
    }
}

/// Rows that are none or contradict themselves are errors, by line.
impl Iterator for Rows {
    type Item = Result<FrameCount, DataError>;

    fn next(&mut self) -> Option<Self::Item> {
        let row = self.rows.next()?;
        self.line += 1;
        Some(self.parsed(row))
    }
}

fn invalid(path: &Path, line: usize, message: String) -> DataError {
    DataError::invalid(path, format!("line {line}"), message, "run `l4d score` again")
}

/// Rows that follow each other and are of one query, together.
pub fn by_query<E>(
    rows: impl Iterator<Item = Result<FrameCount, E>>,
) -> impl Iterator<Item = Result<Vec<FrameCount>, E>> {
    let mut rows = rows.peekable();
    std::iter::from_fn(move || {
        let mut block = match rows.next()? {
            Ok(first) => vec![first],
            Err(error) => return Some(Err(error)),
        };
        let is_of =
            |row: &Result<FrameCount, E>, query: &QueryId| row.as_ref().is_ok_and(|row| row.query == *query);
        while let Some(row) = rows.next_if(|row| is_of(row, &block[0].query)) {
            block.extend(row);
        }
        Some(Ok(block))
    })
}

/// Reads a `counts.csv`.
///
/// # Errors
/// A file that cannot be read, and rows that are none or contradict themselves, by line.
pub fn read(path: &Path) -> Result<Vec<FrameCount>, DataError> {
    Rows::open(path)?.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(frame: u32, state: State, instance: Option<&str>) -> FrameCount {
        FrameCount {
            query: "farm/003".parse().unwrap(),
            frame,
            state,
            intersection: 2,
            union: 5,
            predicted: 3,
            truth: 4,
            instance: instance.map(|name| Name::new(name).unwrap()),
            instance_overlap: 2,
        }
    }

    #[test]
    fn rows_round_trip_and_look_as_documented() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("counts.csv");
        let rows = [row(0, State::Hit, Some("bucket_red")), row(12, State::FalseAlarm, None)];
        let parts = [to_csv(&[], true), to_csv(&rows[..1], false), to_csv(&rows[1..], false)];
        let text = String::from_utf8(parts.concat()).unwrap();
        std::fs::write(&path, &text).unwrap();
        let expected = "scene,query,frame,state,intersection,union,predicted,truth,instance,instance_overlap\n\
                        farm,003,0,hit,2,5,3,4,bucket_red,2\n\
                        farm,003,12,false_alarm,2,5,3,4,,2\n";
        assert_eq!(text, expected);
        assert_eq!(read(&path).unwrap(), rows);
    }

    #[test]
    fn rows_come_query_by_query_and_an_error_ends_them() {
        let of = |number: &str, frame: u32| {
            let query = format!("farm/{number}").parse().unwrap();
            Ok(FrameCount { query, ..row(frame, State::Hit, None) })
        };
        let rows = [of("001", 0), of("001", 12), of("002", 0), Err("torn"), of("002", 12), of("001", 24)];
        let blocks: Vec<Result<Vec<u32>, &str>> = by_query(rows.into_iter())
            .map(|block| Ok(block?.into_iter().map(|row| row.frame).collect()))
            .collect();
        assert_eq!(blocks, [Ok(vec![0, 12]), Ok(vec![0]), Err("torn"), Ok(vec![12]), Ok(vec![24])]);
    }

    #[test]
    fn damage_names_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("counts.csv");
        let good = String::from_utf8(to_csv(&[row(0, State::Hit, None)], true)).unwrap();
        for (from, to) in
            [("hit", "bull"), (",2,5,", ",4,5,"), ("farm", "../x"), ("003", "x"), (",2,5,", ",-1,5,")]
        {
            std::fs::write(&path, good.replace(from, to)).unwrap();
            let error = read(&path).unwrap_err().to_string();
            assert!(error.contains("counts.csv: line 2: "), "{error}");
        }
    }
}
