//! Tables of papers, as `benchmark/published/<table>.csv` holds them: a number a row, with the row and column of the
//! printed table that it is in.
//!
//! They belong to other data sets than this one. The module reads and looks up; it refuses to compare.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Deserialize;

use crate::error::DataError;
use crate::store::read_bounded;

/// What a number measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Metric {
    /// Share of frames that are hit, percent.
    Macc,
    /// Mean intersection over union, percent.
    Miou,
}

/// One number of a table.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// The table: name of the file.
    pub table: String,
    /// The printed row: a method, a model, a number of views.
    pub setting: String,
    /// The printed column: a category, or two with `+` between.
    pub column: String,
    /// What it measures.
    pub metric: Metric,
    /// Percent, 0 to 100.
    pub value: f64,
}

/// A table of a paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Published {
    figures: Vec<Figure>,
}

impl Published {
    /// Reads and checks `<table>.csv`.
    ///
    /// # Errors
    /// A file that cannot be read, or a row that is no record.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let bytes = read_bounded(path, 1 << 20)?;
        let table = path.file_stem().unwrap_or_default().to_string_lossy();
        let mut places = BTreeSet::new();
        let mut figures = Vec::new();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        for (index, figure) in reader.deserialize::<Figure>().enumerate() {
            let place = format!("number {}", index + 1);
            let figure = figure.map_err(|error| DataError::format(path, &place, error))?;
            let refuse = |message: String, hint: &str| DataError::invalid(path, place, message, hint);
            if figure.table != table {
                let message = format!("belongs to table `{}`", figure.table);
                return Err(refuse(message, "give each table a file of its name"));
            }
            if !(0.0..=100.0).contains(&figure.value) {
                let message = format!("is {}, but percent lie between 0 and 100", figure.value);
                return Err(refuse(message, "copy the number again"));
            }
            if !places.insert((figure.setting.clone(), figure.column.clone(), figure.metric)) {
                let message = format!("is another one for `{}`, `{}`", figure.setting, figure.column);
                return Err(refuse(message, "keep one of them"));
            }
            figures.push(figure);
        }
        if figures.is_empty() {
            return Err(DataError::invalid(path, "file", "holds no number", "copy the table again"));
        }
        Ok(Self { figures })
    }

    /// All numbers, in the order of the file.
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }

    /// The printed rows, in the order of the table.
    pub fn settings(&self) -> Vec<&str> {
        distinct(self.figures.iter().map(|figure| figure.setting.as_str()))
    }

    /// The printed columns, in the order of the table.
    pub fn columns(&self) -> Vec<&str> {
        distinct(self.figures.iter().map(|figure| figure.column.as_str()))
    }

    /// A number, percent; none where the table has no such cell.
    pub fn value(&self, setting: &str, column: &str, metric: Metric) -> Option<f64> {
        let is_it = |figure: &&Figure| {
            figure.setting == setting && figure.column == column && figure.metric == metric
        };
        self.figures.iter().find(is_it).map(|figure| figure.value)
    }
}

/// Each once, in the order in which they come.
fn distinct<'a>(words: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    words.filter(|word| seen.insert(*word)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::BenchDir;
    use crate::query::Category;

    /// Table and its number of rows and columns.
    const SHIPPED: [(&str, usize, usize); 7] = [
        ("panoptic_l4d", 3, 4),
        ("neu3d", 3, 4),
        ("composites", 2, 5),
        ("mvsc", 2, 4),
        ("views", 6, 4),
        ("vlm", 5, 4),
        ("scales", 3, 4),
    ];

    fn shipped(table: &str) -> Published {
        let bench = BenchDir::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark"));
        Published::read(&bench.published(table)).unwrap()
    }

    #[test]
    fn every_table_is_whole() {
        for (table, settings, columns) in SHIPPED {
            let published = shipped(table);
            let size = (published.settings().len(), published.columns().len());
            assert_eq!(size, (settings, columns), "{table}");
            assert_eq!(published.figures().len(), settings * columns * 2, "{table}");
        }
        let pairs = ["attribute+action", "attribute+interaction", "attribute+spatial", "spatial+action"];
        assert_eq!(shipped("composites").columns()[..4], pairs);
        assert_eq!(shipped("views").settings(), ["1", "4", "6", "8", "10", "12"]);
        assert_eq!(shipped("mvsc").value("w/o MVSC", "spatial", Metric::Miou), Some(64.29));
        assert_eq!(shipped("mvsc").value("w/o MVSC", "colour", Metric::Miou), None);
    }

    #[test]
    fn what_the_paper_prints_four_times_is_the_same() {
        let places = [
            ("panoptic_l4d", "PanopticQuery"),
            ("mvsc", "with MVSC"),
            ("views", "8"),
            ("vlm", "Qwen3-VL (8B)"),
        ];
        for column in Category::ALL.map(Category::as_str) {
            for metric in [Metric::Macc, Metric::Miou] {
                let values = places.map(|(table, setting)| shipped(table).value(setting, column, metric));
                assert!(values[0].is_some() && values.iter().all(|value| *value == values[0]), "{values:?}");
            }
        }
    }

    #[test]
    fn numbers_that_cannot_be_are_refused_with_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mvsc.csv");
        let read = |rows: &str| {
            std::fs::write(&path, format!("table,setting,column,metric,value\n{rows}")).unwrap();
            Published::read(&path)
        };
        let good = "mvsc,a,action,macc,1.5\n";
        assert_eq!(read(good).unwrap().value("a", "action", Metric::Macc), Some(1.5));
        for (rows, words) in [
            ("mvsc,a,action,macc,100.1", "is 100.1"),
            ("mvsc,a,action,macc,-0.1", "is -0.1"),
            ("mvsc,a,action,macc,NaN", "is NaN"),
            ("mvsc,a,action,macc,inf", "is inf"),
            ("mvsc,a,action,macc,", "number 2"),
            ("mvsc,a,action,iou,1", "iou"),
            ("mvsc,a,action,macc", "number 2"),
            ("views,a,action,miou,1", "table `views`"),
            ("mvsc,a,action,macc,2", "another one for `a`, `action`"),
        ] {
            let error = read(&format!("{good}{rows}\n")).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("number 2"), "{rows}: {error}");
        }
        assert!(read("").unwrap_err().to_string().contains("no number"));
        std::fs::write(&path, "table,setting,column,metric,value,note\nmvsc,a,action,macc,1,x\n").unwrap();
        assert!(Published::read(&path).is_err());
    }
}
