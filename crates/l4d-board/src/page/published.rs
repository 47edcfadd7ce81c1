//! Numbers that papers print, as the page shows them: apart, and never beside ours.

use l4d_data::Benchmark;
use l4d_data::DataError;
use l4d_data::published::{Metric, Published};
use serde_json::{Value, json};

/// Table of `published/` and what it is of.
const TABLES: [(&str, &str); 7] = [
    ("panoptic_l4d", "Query types on the authors' Panoptic-L4D"),
    ("neu3d", "Query types on Neu3D"),
    ("composites", "Queries of two categories"),
    ("scales", "Spatial scales, PanopticQuery"),
    ("mvsc", "Without and with multi-view semantic consensus"),
    ("views", "Number of cameras"),
    ("vlm", "Vision-language models"),
];

/// The tables that a benchmark ships; those that are not there are left out.
pub(crate) fn tables(bench: &Benchmark) -> Result<Value, DataError> {
    let mut tables = Vec::new();
    for (name, title) in TABLES {
        let path = bench.dir.published(name);
        if !path.exists() {
            continue;
        }
        let table = Published::read(&path)?;
        let columns = table.columns();
        let row = |setting: &&str| {
            let cells = columns.iter().flat_map(|column| {
                [Metric::Macc, Metric::Miou].map(|metric| table.value(setting, column, metric))
            });
            json!({ "setting": setting, "values": cells.collect::<Vec<_>>() })
        };
        tables.push(json!({
            "title": title,
            "columns": columns,
            "rows": table.settings().iter().map(row).collect::<Value>(),
        }));
    }
    Ok(Value::Array(tables))
}
