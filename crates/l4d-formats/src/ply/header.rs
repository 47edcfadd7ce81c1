//! The header of a PLY file: strict about grammar, indifferent to order.

use crate::fault::{Fault, quoted};

/// No header is longer, bytes: a 3DGS header has 1500.
const LONGEST: usize = 1 << 16;

const REMEDY: &str = "write the file again; a header is ASCII lines from `ply` to `end_header`";

/// How the body spells numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    /// `char`.
    I8,
    /// `uchar`.
    U8,
    /// `short`.
    I16,
    /// `ushort`.
    U16,
    /// `int`.
    I32,
    /// `uint`.
    U32,
    /// `float`.
    F32,
    /// `double`.
    F64,
}

impl Scalar {
    /// Both spellings of each type, the older first.
    const NAMES: [(Self, [&str; 2]); 8] = [
        (Self::I8, ["char", "int8"]),
        (Self::U8, ["uchar", "uint8"]),
        (Self::I16, ["short", "int16"]),
        (Self::U16, ["ushort", "uint16"]),
        (Self::I32, ["int", "int32"]),
        (Self::U32, ["uint", "uint32"]),
        (Self::F32, ["float", "float32"]),
        (Self::F64, ["double", "float64"]),
    ];

    fn parse(word: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(_, names)| names.contains(&word)).map(|(scalar, _)| scalar)
    }

    /// The older spelling.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(scalar, _)| *scalar == self).map_or("?", |(_, names)| names[0])
    }

    /// Bytes of one number in a binary body.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A column of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Property {
    /// Its name.
    pub name: String,
    /// Type of its numbers.
    pub scalar: Scalar,
}

/// A table of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Its name.
    pub name: String,
    /// Rows.
    pub count: usize,
    /// Columns.
    pub properties: Vec<Property>,
}

impl Element {
    /// Bytes of one row in a binary body.
    pub(super) fn stride(&self) -> usize {
        self.properties.iter().map(|property| property.scalar.size()).sum()
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the body starts, bytes.
    pub(super) body_at: usize,
    /// Lines of the header.
    pub(super) lines: usize,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        if !bytes.starts_with(b"ply\n") && !bytes.starts_with(b"ply\r\n") {
            return Err(Fault::new("first line", "is not `ply`: this is no PLY file", REMEDY));
        }
        let mut lines = Lines { bytes, at: 0, number: 0 };
        lines.next_line()?;
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            let line = lines.next_line()?;
            let fault =
                |message: String| Fault::new(format!("header, line {}", lines.number), message, REMEDY);
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words.as_slice() {
                ["end_header"] => break,
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, version] => {
                    if encoding.is_some() {
                        return Err(fault("states the format twice".to_owned()));
                    }
                    if *version != "1.0" {
                        return Err(fault(format!("has version {}, but only 1.0 exists", quoted(version))));
                    }
                    encoding = Some(
                        parse_encoding(name)
                            .ok_or_else(|| fault(format!("has no such format as {}", quoted(name))))?,
                    );
                }
                ["element", name, count] => {
                    let count = parse_count(count).ok_or_else(|| {
                        fault(format!("has the count {}, which is no number of rows", quoted(count)))
                    })?;
                    if elements.iter().any(|element| element.name == *name) {
                        return Err(fault(format!("repeats element {}", quoted(name))));
                    }
                    elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
                }
                ["property", "list", ..] => {
                    return Err(Fault::new(
                        format!("header, line {}", lines.number),
                        "is a list property, but points have none: this looks like a mesh",
                        "give a PLY of points or Gaussians",
                    ));
                }
                ["property", kind, name] => {
                    let element =
                        elements.last_mut().ok_or_else(|| fault("precedes any element".to_owned()))?;
                    let scalar = Scalar::parse(kind)
                        .ok_or_else(|| fault(format!("has no such type as {}", quoted(kind))))?;
                    if element.properties.iter().any(|property| property.name == *name) {
                        return Err(fault(format!("repeats property {}", quoted(name))));
                    }
                    element.properties.push(Property { name: (*name).to_owned(), scalar });
                }
                _ => return Err(fault(format!("is {}, which is no line of a PLY header", quoted(line)))),
            }
        }
        let encoding = encoding.ok_or_else(|| Fault::new("header", "has no `format` line", REMEDY))?;
        if let Some(empty) = elements.iter().find(|element| element.properties.is_empty()) {
            return Err(Fault::new(
                "header",
                format!("element {} has no properties", quoted(&empty.name)),
                REMEDY,
            ));
        }
        Ok(Self { encoding, elements, body_at: lines.at, lines: lines.number })
    }
}

fn parse_encoding(word: &str) -> Option<Encoding> {
    match word {
        "ascii" => Some(Encoding::Ascii),
        "binary_little_endian" => Some(Encoding::LittleEndian),
        "binary_big_endian" => Some(Encoding::BigEndian),
        _ => None,
    }
}

/// Digits alone: `usize::from_str` would take a sign.
fn parse_count(word: &str) -> Option<usize> {
    word.bytes().all(|byte| byte.is_ascii_digit()).then(|| word.parse().ok()).flatten()
}

struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    /// The next line without its end, which is `\n` or `\r\n`.
    fn next_line(&mut self) -> Result<&'a str, Fault> {
        self.number += 1;
        let place = || format!("header, line {}", self.number);
        let window = &self.bytes[self.at..self.bytes.len().min(LONGEST)];
        let end = window.iter().position(|&byte| byte == b'\n').ok_or_else(|| {
            let message = if self.bytes.len() > LONGEST {
                format!("has not come to `end_header` after {LONGEST} bytes")
            } else {
                "is cut: the file ends before `end_header`".to_owned()
            };
            Fault::new(place(), message, REMEDY)
        })?;
        let line = &window[..end];
        self.at += end + 1;
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        std::str::from_utf8(line).map_err(|error| Fault::new(place(), format!("is no text: {error}"), REMEDY))
    }
}
