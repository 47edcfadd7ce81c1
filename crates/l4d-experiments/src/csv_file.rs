//! Rows as CSV.

use serde::Serialize;

use crate::{Result, plain};

pub(crate) fn csv_of<T: Serialize>(rows: impl IntoIterator<Item = T>) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.into_iter().try_for_each(|row| writer.serialize(row)).map_err(plain)?;
    writer.into_inner().map_err(|error| plain(error.into_error()))
}

/// Ten-thousandths: finer digits mean nothing.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
