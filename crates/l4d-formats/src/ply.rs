//! PLY: tables of named columns, ascii or binary. `serde_ply` parses; this module holds what a header claims against the
//! file before any row is read, and picks columns by name, so that order, extra properties and number types may differ.

use std::collections::BTreeSet;
use std::fmt;
use std::io::{self, BufRead, Chain, Read as _, Seek, SeekFrom};

use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_ply::{DeserializeError, PlyFormat, PlyReader};
pub use serde_ply::{ElementDef, PropertyType, ScalarType};

use crate::fault::{Fault, quoted};

const HINT: &str =
    "copy or export the file again: it was cut, or something was appended or converted on the way";

/// Bytes of a header: one of Gaussians takes about 1500.
const LONGEST_HEADER: u64 = 1 << 20;
/// Bytes of a line of numbers.
const LONGEST_LINE: usize = 1 << 16;

/// A file whose size fits what its header claims. Its rows are read one by one.
pub struct Ply<R> {
    /// Ends in a line feed, which the last line of an ascii file may lack.
    reader: PlyReader<Chain<R, &'static [u8]>>,
}

impl<R: BufRead + Seek> Ply<R> {
    /// Parses the header of a file.
    ///
    /// # Errors
    /// Lists, names that come twice, lines that are none of a PLY header, and a body of another length.
    pub fn open(mut source: R) -> Result<Self, Fault> {
        let mut head = Vec::new();
        source.by_ref().take(LONGEST_HEADER).read_to_end(&mut head).map_err(unread)?;
        let end = head.windows(11).position(|window| window == b"\nend_header");
        let end =
            end.ok_or_else(|| Fault::new("header", "has no line `end_header`: is this a PLY file?", HINT))?;
        head.extend(b"\n");
        let line_end = head.iter().skip(end + 1).position(|&byte| byte == b'\n').unwrap_or_default();
        let body = (end + line_end + 2) as u64;
        let length = source.seek(SeekFrom::End(0)).map_err(unread)?.saturating_sub(body);
        let reader = PlyReader::from_reader(head.as_slice()).map_err(|error| broken("header", &error))?;
        let header = reader.header();
        check_names(&header.elem_defs)?;
        let is_ascii = header.format == PlyFormat::Ascii;
        source.seek(SeekFrom::Start(body)).map_err(unread)?;
        let found = if is_ascii { count_words(&mut source)? } else { length };
        check_size(&header.elem_defs, found, is_ascii)?;
        source.rewind().map_err(unread)?;
        let reader = PlyReader::from_reader(source.chain(b"\n".as_slice()));
        Ok(Self { reader: reader.map_err(|error| broken("header", &error))? })
    }

    /// The tables, in the order of the file.
    pub fn elements(&self) -> &[ElementDef] {
        &self.reader.header().elem_defs
    }

    /// Passes each row of an element to `each`: the numbers of these columns, in their order. `double` is rounded.
    ///
    /// # Errors
    /// Columns that are missing or neither `float` nor `double`, text that is no number, and what `each` refuses.
    pub fn rows(
        mut self,
        element: &str,
        columns: &[String],
        hint: &'static str,
        each: impl FnMut(usize, &[f32]) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let elements = self.elements();
        let place = elements.iter().position(|other| other.name == element);
        let place = place.ok_or_else(|| Fault::new("header", format!("has no element `{element}`"), hint))?;
        let wanted = places(&elements[place], columns, hint)?;
        let row = vec![0.0; columns.len()];
        let mut rows = Rows { wanted, row, each, refused: None };
        for _ in 0..place {
            let each: fn(usize, &[f32]) -> Result<(), Fault> = |_, _| Ok(());
            let mut skipped = Rows { wanted: Vec::new(), row: Vec::new(), each, refused: None };
            (&mut self.reader).next_value_seed(&mut skipped).map_err(|error| broken("rows", &error))?;
        }
        let read = (&mut self.reader).next_value_seed(&mut rows);
        match rows.refused {
            Some(fault) => Err(fault),
            None => read.map_err(|error| broken(&format!("rows of {}", quoted(element)), &error)),
        }
    }
}

fn check_names(elements: &[ElementDef]) -> Result<(), Fault> {
    let mut known = BTreeSet::new();
    for element in elements {
        if let Some(list) = element.properties.iter().find(|property| size(&property.property_type) == 0) {
            let message =
                format!("{} is a list, but points have none: this looks like a mesh", quoted(&list.name));
            return Err(Fault::new("header", message, "give a PLY of points or Gaussians"));
        }
        let names = element.properties.iter().map(|property| Some(&property.name));
        if let Some(name) =
            std::iter::once(None).chain(names).find(|name| !known.insert((&element.name, *name)))
        {
            let message = format!("repeats {}", quoted(name.unwrap_or(&element.name)));
            return Err(Fault::new("header", message, HINT));
        }
    }
    Ok(())
}

/// Holds the claimed rows against what follows the header; only then may room be made for them.
fn check_size(elements: &[ElementDef], found: u64, is_ascii: bool) -> Result<(), Fault> {
    let claimed = elements.iter().try_fold(0_u64, |total, element| {
        let sizes = element
            .properties
            .iter()
            .map(|property| if is_ascii { 1 } else { size(&property.property_type) });
        // Rows of nothing would be read for ever.
        total.checked_add((element.count as u64).checked_mul(sizes.sum::<u64>().max(1))?)
    });
    if claimed == Some(found) {
        return Ok(());
    }
    let unit = if is_ascii { "numbers" } else { "bytes" };
    let rows = elements.iter().map(|element| format!("{} rows of {}", element.count, quoted(&element.name)));
    let rows = rows.collect::<Vec<_>>().join(" and ");
    let needed = claimed.map_or("more than any file holds".to_owned(), |claimed| format!("{claimed} {unit}"));
    let message = format!("the header claims {rows}, which need {needed}, but {found} follow it");
    Err(Fault::new("size", message, HINT))
}

/// Words of the rest of a text, whose lines are bounded: each will be read as one.
fn count_words(source: &mut impl BufRead) -> Result<u64, Fault> {
    let (mut words, mut line, mut is_blank) = (0, 0, true);
    loop {
        let bytes = source.fill_buf().map_err(unread)?;
        if bytes.is_empty() {
            return Ok(words);
        }
        for byte in bytes {
            words += u64::from(is_blank && !byte.is_ascii_whitespace());
            is_blank = byte.is_ascii_whitespace();
            line = if *byte == b'\n' { 0 } else { line + 1 };
            if line > LONGEST_LINE {
                return Err(Fault::new("rows", format!("one is longer than {LONGEST_LINE} bytes"), HINT));
            }
        }
        let count = bytes.len();
        source.consume(count);
    }
}

fn unread(error: io::Error) -> Fault {
    Fault::new("file", format!("cannot be read: {error}"), HINT)
}

fn broken(place: &str, error: &DeserializeError) -> Fault {
    Fault::new(place, quoted(&error.0.to_string()), HINT)
}

/// Bytes of one number in a binary body; 0 for lists.
fn size(kind: &PropertyType) -> u64 {
    match kind {
        PropertyType::List { .. } => 0,
        PropertyType::Scalar(ScalarType::I8 | ScalarType::U8) => 1,
        PropertyType::Scalar(ScalarType::I16 | ScalarType::U16) => 2,
        PropertyType::Scalar(ScalarType::I32 | ScalarType::U32 | ScalarType::F32) => 4,
        PropertyType::Scalar(ScalarType::F64) => 8,
    }
}

/// For each property of an element its place among the columns, if it is one.
fn places(element: &ElementDef, columns: &[String], hint: &'static str) -> Result<Vec<Option<usize>>, Fault> {
    for name in columns {
        let message = match element.get_property(name).map(|property| &property.property_type) {
            Some(PropertyType::Scalar(ScalarType::F32 | ScalarType::F64)) => continue,
            Some(PropertyType::Scalar(other)) => {
                format!("is of type `{other}`, but parameters are `float` or `double`")
            }
            _ => "is missing".to_owned(),
        };
        return Err(Fault::new(format!("header, property `{name}`"), message, hint));
    }
    let properties = element.properties.iter();
    Ok(properties.map(|property| columns.iter().position(|name| *name == property.name)).collect())
}

/// Takes the rows of an element as they come.
struct Rows<E> {
    /// For each property its place in `row`.
    wanted: Vec<Option<usize>>,
    row: Vec<f32>,
    each: E,
    refused: Option<Fault>,
}

impl<'de, E: FnMut(usize, &[f32]) -> Result<(), Fault>> DeserializeSeed<'de> for &mut Rows<E> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, E: FnMut(usize, &[f32]) -> Result<(), Fault>> Visitor<'de> for &mut Rows<E> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("rows of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<(), A::Error> {
        let mut index = 0;
        while let Some(()) = rows.next_element_seed(Row { wanted: &self.wanted, row: &mut self.row })? {
            if let Err(fault) = (self.each)(index, &self.row) {
                self.refused = Some(fault);
                return Ok(());
            }
            index += 1;
        }
        Ok(())
    }
}

/// Takes one row.
struct Row<'a> {
    wanted: &'a [Option<usize>],
    row: &'a mut [f32],
}

impl<'de> DeserializeSeed<'de> for Row<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Row<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a row of numbers")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<(), A::Error> {
        let mut wanted = self.wanted.iter();
        while let Some(IgnoredAny) = fields.next_key()? {
            match wanted.next() {
                Some(&Some(place)) => self.row[place] = fields.next_value()?,
                _ => drop(fields.next_value::<IgnoredAny>()?),
            }
        }
        Ok(())
    }
}

/// The bytes of a little-endian file of vertices: `body` is its rows, whose columns are `properties`.
pub fn encode<'a>(
    count: usize,
    properties: impl IntoIterator<Item = (&'a str, &'a str)>,
    body: &[u8],
) -> Vec<u8> {
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n");
    for (name, kind) in properties {
        header.push_str(&format!("property {kind} {name}\n"));
    }
    header.push_str("end_header\n");
    [header.as_bytes(), body].concat()
}
