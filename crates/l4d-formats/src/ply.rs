//! PLY: tables of named columns, ascii or binary.
//!
//! Columns are found by name, so that order, extra properties and number types may differ. The format is so small that
//! parsing it here costs less than steering a general crate: those hand over rows or maps by name where columns are
//! needed, and allocate as many rows as a header claims.

mod header;
mod rows;

use crate::fault::Fault;

use header::Header;
pub use header::{Element, Property, Scalar};
use rows::Column;

/// A file whose size fits what its header claims.
#[derive(Debug)]
pub struct Ply<'a> {
    header: Header,
    bytes: &'a [u8],
}

impl<'a> Ply<'a> {
    /// Parses the header in the bytes of a file.
    ///
    /// # Errors
    /// Lists, lines that are none of a PLY header, and a body of another length.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let header = Header::parse(bytes)?;
        rows::check_size(&header, bytes)?;
        Ok(Self { header, bytes })
    }

    /// The tables, in the order of the file.
    pub fn elements(&self) -> &[Element] {
        &self.header.elements
    }

    /// Passes each row of an element to `each`: the numbers of these columns, in their order. `double` is rounded.
    ///
    /// # Errors
    /// Columns that are missing or neither `float` nor `double`, text that is no number, and what `each` refuses.
    pub fn rows(
        &self,
        element: &Element,
        columns: &[String],
        remedy: &'static str,
        each: impl FnMut(usize, &[f32]) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let columns: Vec<Column> =
            columns.iter().map(|name| column(element, name, remedy)).collect::<Result<_, _>>()?;
        rows::read(&self.header, self.bytes, &element.name, &columns, each)
    }
}

fn column(element: &Element, name: &str, remedy: &'static str) -> Result<Column, Fault> {
    let fault = |message: String| Fault::new(format!("header, property `{name}`"), message, remedy);
    let mut offset = 0;
    for (word, property) in element.properties.iter().enumerate() {
        let scalar = property.scalar;
        if property.name == name {
            return match scalar {
                Scalar::F32 | Scalar::F64 => Ok(Column { name: name.to_owned(), offset, word, scalar }),
                _ => Err(fault(format!(
                    "is of type `{}`, but parameters are `float` or `double`",
                    scalar.name()
                ))),
            };
        }
        offset += scalar.size();
    }
    Err(fault("is missing".to_owned()))
}

/// The bytes of a little-endian file of vertices: `body` is its rows, whose columns are `properties`.
pub fn encode<'a>(
    count: usize,
    properties: impl IntoIterator<Item = (&'a str, Scalar)>,
    body: &[u8],
) -> Vec<u8> {
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n");
    for (name, scalar) in properties {
        header.push_str(&format!("property {} {name}\n", scalar.name()));
    }
    header.push_str("end_header\n");
    [header.as_bytes(), body].concat()
}
