//! The body of a PLY file, row by row.

use super::header::{Element, Encoding, Header, Scalar};
use crate::fault::{Fault, quoted};

const REMEDY: &str =
    "copy or export the file again: it was cut, or something was appended or converted on the way";

/// Where a wanted property is in a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Column {
    pub(super) name: String,
    /// Bytes before it in a binary row.
    pub(super) offset: usize,
    /// Numbers before it in an ascii row.
    pub(super) word: usize,
    pub(super) scalar: Scalar,
}

/// Holds the claimed rows against the length of the file; only then may room be made for them.
pub(super) fn check_size(header: &Header, bytes: &[u8]) -> Result<(), Fault> {
    let body = bytes.len() - header.body_at;
    // A number in ascii is at least a digit and the blank or line end after it.
    let least_row = |element: &Element| match header.encoding {
        Encoding::Ascii => 2 * element.properties.len(),
        Encoding::LittleEndian | Encoding::BigEndian => element.stride(),
    };
    let claimed = header.elements.iter().try_fold(0_usize, |total, element| {
        total.checked_add(element.count.checked_mul(least_row(element))?)
    });
    // The last line of an ascii file may lack its end.
    let fits = claimed.is_some_and(|claimed| match header.encoding {
        Encoding::Ascii => claimed <= body + 1,
        Encoding::LittleEndian | Encoding::BigEndian => claimed == body,
    });
    if fits {
        return Ok(());
    }
    let rows: Vec<String> = header
        .elements
        .iter()
        .map(|element| format!("{} rows of {}", element.count, quoted(&element.name)))
        .collect();
    let needed = claimed.map_or("more bytes than any file".to_owned(), |claimed| format!("{claimed} bytes"));
    let least = if header.encoding == Encoding::Ascii { "at least " } else { "" };
    Err(Fault::new(
        "size",
        format!("the header claims {}, which need {least}{needed}, but {body} follow it", rows.join(" and ")),
        REMEDY,
    ))
}

/// Passes each row of an element to `each`, the columns in their order.
pub(super) fn read(
    header: &Header,
    bytes: &[u8],
    wanted: &str,
    columns: &[Column],
    each: impl FnMut(usize, &[f32]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let body = &bytes[header.body_at..];
    match header.encoding {
        Encoding::Ascii => read_ascii(header, body, wanted, columns, each),
        Encoding::LittleEndian | Encoding::BigEndian => read_binary(header, body, wanted, columns, each),
    }
}

fn read_binary(
    header: &Header,
    body: &[u8],
    wanted: &str,
    columns: &[Column],
    mut each: impl FnMut(usize, &[f32]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let big_endian = header.encoding == Encoding::BigEndian;
    let mut row = vec![0.0; columns.len()];
    let mut body = body;
    for element in &header.elements {
        let (records, after) = body.split_at(element.count * element.stride());
        body = after;
        if element.name != wanted {
            continue;
        }
        for (index, record) in records.chunks_exact(element.stride()).enumerate() {
            for (value, column) in row.iter_mut().zip(columns) {
                *value = number(&record[column.offset..], column.scalar, big_endian);
            }
            each(index, &row)?;
        }
    }
    Ok(())
}

/// The number at the start of `bytes`; only floats become columns.
fn number(bytes: &[u8], scalar: Scalar, big_endian: bool) -> f32 {
    match (scalar, bytes) {
        (Scalar::F64, &[a, b, c, d, e, f, g, h, ..]) => {
            let word = [a, b, c, d, e, f, g, h];
            (if big_endian { f64::from_be_bytes(word) } else { f64::from_le_bytes(word) }) as f32
        }
        (_, &[a, b, c, d, ..]) => {
            let word = [a, b, c, d];
            if big_endian { f32::from_be_bytes(word) } else { f32::from_le_bytes(word) }
        }
        // Sizes were checked; a hole must not pass for a number.
        _ => f32::NAN,
    }
}

fn read_ascii(
    header: &Header,
    body: &[u8],
    wanted: &str,
    columns: &[Column],
    mut each: impl FnMut(usize, &[f32]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let text = std::str::from_utf8(body).map_err(|error| {
        Fault::new(
            format!("byte {}", header.body_at + error.valid_up_to()),
            "is no text, but the header says ascii",
            REMEDY,
        )
    })?;
    let numbered = text.lines().enumerate().map(|(index, line)| (header.lines + 1 + index, line));
    let mut lines = numbered.filter(|(_, line)| !line.trim_ascii().is_empty());
    let mut row = vec![0.0; columns.len()];
    let mut words: Vec<&str> = Vec::new();
    for element in &header.elements {
        for index in 0..element.count {
            let (line, text) = lines.next().ok_or_else(|| {
                Fault::new(
                    "end of file",
                    format!("{} of {} rows of {} are there", index, element.count, quoted(&element.name)),
                    REMEDY,
                )
            })?;
            let place = || format!("line {line}");
            words.clear();
            words.extend(text.split_ascii_whitespace().take(element.properties.len() + 1));
            if words.len() != element.properties.len() {
                let more = if words.len() > element.properties.len() { "more than " } else { "" };
                let found = words.len().min(element.properties.len());
                return Err(Fault::new(
                    place(),
                    format!(
                        "has {more}{found} numbers, but the header names {} properties",
                        element.properties.len()
                    ),
                    REMEDY,
                ));
            }
            if element.name != wanted {
                continue;
            }
            for (value, column) in row.iter_mut().zip(columns) {
                let word = words[column.word];
                *value = parse(word, column.scalar).ok_or_else(|| {
                    Fault::new(
                        place(),
                        format!("property `{}` is {}, which is no number", column.name, quoted(word)),
                        REMEDY,
                    )
                })?;
            }
            each(index, &row)?;
        }
    }
    match lines.next() {
        Some((line, _)) => {
            Err(Fault::new(format!("line {line}"), "follows the last row that the header claims", REMEDY))
        }
        None => Ok(()),
    }
}

/// Decimal text straight to its own type: rounding once.
fn parse(word: &str, scalar: Scalar) -> Option<f32> {
    match scalar {
        Scalar::F64 => word.parse::<f64>().ok().map(|value| value as f32),
        _ => word.parse().ok(),
    }
}
