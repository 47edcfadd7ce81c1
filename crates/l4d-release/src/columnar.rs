//! A table as Apache Parquet, which viewers and loaders of data sets read without parsing text.

use std::path::Path;
use std::sync::Arc;

use l4d_data::DataError;
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use serde_json::Value;

use crate::tables::{Column, ColumnKind, Table};

/// The bytes of its file: one group of rows, no value is null, compressed with Snappy. The same table gives the same bytes.
pub(crate) fn bytes(table: &Table) -> Result<Vec<u8>, DataError> {
    encode(table).map_err(|error| {
        DataError::invalid(
            Path::new(&table.parquet_path()),
            table.name.as_str(),
            format!("the table does not become Parquet: {error}"),
            "this is an error in l4d: please report it",
        )
    })
}

fn encode(table: &Table) -> Result<Vec<u8>, ParquetError> {
    let fields: String = table.columns.iter().map(field).collect();
    let schema = parse_message_type(&format!("message {} {{ {fields} }}", table.name))?;
    let properties = WriterProperties::builder()
        .set_compression(parquet::basic::Compression::SNAPPY)
        .set_created_by("l4d".to_owned())
        .build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for column in table.columns {
        let mut values = Values::default();
        for row in &table.rows {
            values.push(&row[&column.name], 0, 0);
        }
        let Some(mut writer) = group.next_column()? else { break };
        values.write(writer.untyped())?;
        writer.close()?;
    }
    group.close()?;
    file.into_inner()
}

fn field(column: &Column) -> String {
    let list = |name: &str, element: &str| {
        format!("required group {name} (LIST) {{ repeated group list {{ {element} }} }} ")
    };
    match column.kind {
        ColumnKind::Text => format!("required binary {} (STRING); ", column.name),
        ColumnKind::Integer => format!("required int64 {}; ", column.name),
        ColumnKind::Float => format!("required double {}; ", column.name),
        ColumnKind::Texts => list(&column.name, "required binary element (STRING);"),
        ColumnKind::Intervals => list(&column.name, &list("element", "required int64 element;")),
    }
}

/// The leaves of a column with their levels, as Parquet flattens lists (Dremel): `repetition` says which list goes on
/// with a leaf, `definition` how many lists around it have an element.
#[derive(Debug, Default)]
struct Values {
    leaves: Vec<Value>,
    definition: Vec<i16>,
    repetition: Vec<i16>,
}

impl Values {
    fn push(&mut self, value: &Value, depth: i16, repetition: i16) {
        match value {
            Value::Array(elements) if !elements.is_empty() => {
                for (place, element) in elements.iter().enumerate() {
                    self.push(element, depth + 1, if place == 0 { repetition } else { depth + 1 });
                }
            }
            leaf => {
                if !leaf.is_array() {
                    self.leaves.push(leaf.clone());
                }
                self.definition.push(depth);
                self.repetition.push(repetition);
            }
        }
    }

    fn write(&self, writer: &mut ColumnWriter<'_>) -> Result<(), ParquetError> {
        let levels = (Some(self.definition.as_slice()), Some(self.repetition.as_slice()));
        match writer {
            ColumnWriter::ByteArrayColumnWriter(writer) => {
                let texts: Vec<ByteArray> =
                    self.leaves.iter().map(|leaf| leaf.as_str().unwrap_or_default().into()).collect();
                writer.write_batch(&texts, levels.0, levels.1)?;
            }
            ColumnWriter::Int64ColumnWriter(writer) => {
                let integers: Vec<i64> = self.leaves.iter().filter_map(Value::as_i64).collect();
                writer.write_batch(&integers, levels.0, levels.1)?;
            }
            ColumnWriter::DoubleColumnWriter(writer) => {
                let floats: Vec<f64> = self.leaves.iter().filter_map(Value::as_f64).collect();
                writer.write_batch(&floats, levels.0, levels.1)?;
            }
            _ => return Err(ParquetError::NYI("a column of another kind".to_owned())),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::Values;

    #[test]
    fn lists_are_flattened_to_levels() {
        let mut values = Values::default();
        for row in [json!([[0, 12], [48, 60]]), json!([]), json!([[24, 96]])] {
            values.push(&row, 0, 0);
        }
        assert_eq!(values.leaves, [0, 12, 48, 60, 24, 96]);
        assert_eq!(values.repetition, [0, 2, 1, 2, 0, 0, 2]);
        assert_eq!(values.definition, [2, 2, 2, 2, 0, 2, 2]);
    }
}
