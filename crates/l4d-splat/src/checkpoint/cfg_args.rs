//! `cfg_args`: the options of a 4DGaussians run, the text that Python prints for an `argparse.Namespace`.
//!
//! The programs that wrote such files read them back by evaluating them. Here they are parsed: a call of `Namespace`
//! around literals, and nothing else is understood.

mod parse;

use std::fmt;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;

use crate::checkpoint::fault::Fault;

/// No such file is longer, bytes: real ones have about 3000.
pub const MAX_BYTES: u64 = 1 << 16;

/// A Python literal.
#[derive(Debug, Clone, PartialEq)]
pub enum Literal {
    /// `None`.
    None,
    /// `True` or `False`.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number with a point or an exponent, `inf` or `nan`.
    Float(f64),
    /// A string.
    Text(String),
    /// `[...]`.
    List(Vec<Literal>),
    /// `(...)`.
    Tuple(Vec<Literal>),
    /// `{...: ...}`, in the order of the text.
    Dict(Vec<(Literal, Literal)>),
}

/// Options by name, in the order of the text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CfgArgs(Vec<(String, Literal)>);

impl CfgArgs {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let bytes = read_bounded(path, MAX_BYTES)?;
        Self::decode(&bytes).map_err(|fault| fault.at(path))
    }

    /// Parses the bytes of a file.
    pub fn decode(bytes: &[u8]) -> Result<Self, Fault> {
        let text = std::str::from_utf8(bytes)
            .map_err(|error| parse::fault(error.valid_up_to(), "is no UTF-8 text".to_owned()))?;
        Self::parse(text)
    }

    /// Parses `Namespace(name=literal, ...)`.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        parse::namespace(text).map(Self)
    }

    /// The value of an option.
    pub fn get(&self, name: &str) -> Option<&Literal> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// Sets an option; a new one comes last.
    pub fn set(&mut self, name: &str, value: Literal) {
        match self.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, old)) => *old = value,
            None => self.0.push((name.to_owned(), value)),
        }
    }

    /// All options in their order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Literal)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value))
    }
}

/// The text that Python prints for the same namespace.
impl fmt::Display for CfgArgs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Namespace(")?;
        for (index, (name, value)) in self.iter().enumerate() {
            if index > 0 {
                f.write_str(", ")?;
            }
            write!(f, "{name}={value}")?;
        }
        f.write_str(")")
    }
}

/// The text that Python's `repr` gives.
impl fmt::Display for Literal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(true) => f.write_str("True"),
            Self::Bool(false) => f.write_str("False"),
            Self::Int(value) => write!(f, "{value}"),
            Self::Float(value) => write_float(f, *value),
            Self::Text(text) => write_text(f, text),
            Self::List(items) => write_items(f, "[", items, "]"),
            Self::Tuple(items) if items.len() == 1 => write_items(f, "(", items, ",)"),
            Self::Tuple(items) => write_items(f, "(", items, ")"),
            Self::Dict(items) => {
                f.write_str("{")?;
                for (index, (key, value)) in items.iter().enumerate() {
                    write!(f, "{}{key}: {value}", if index > 0 { ", " } else { "" })?;
                }
                f.write_str("}")
            }
        }
    }
}

fn write_items(f: &mut fmt::Formatter<'_>, open: &str, items: &[Literal], close: &str) -> fmt::Result {
    f.write_str(open)?;
    for (index, item) in items.iter().enumerate() {
        write!(f, "{}{item}", if index > 0 { ", " } else { "" })?;
    }
    f.write_str(close)
}

/// The shortest digits that give the number back, with an exponent below 1e-4 and from 1e16, as Python has it.
fn write_float(f: &mut fmt::Formatter<'_>, value: f64) -> fmt::Result {
    if value.is_nan() {
        return f.write_str("nan");
    }
    if value.is_infinite() {
        return f.write_str(if value > 0.0 { "inf" } else { "-inf" });
    }
    if value == 0.0 || (1e-4..1e16).contains(&value.abs()) {
        return write!(f, "{value:?}");
    }
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = exponent.strip_prefix('-').map_or(("+", exponent), |exponent| ("-", exponent));
    write!(f, "{digits}e{sign}{exponent:0>2}")
}

fn write_text(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    let mark = if text.contains('\'') && !text.contains('"') { '"' } else { '\'' };
    write!(f, "{mark}")?;
    for character in text.chars() {
        match character {
            '\\' => f.write_str("\\\\")?,
            '\n' => f.write_str("\\n")?,
            '\r' => f.write_str("\\r")?,
            '\t' => f.write_str("\\t")?,
            character if character == mark => write!(f, "\\{character}")?,
            character if character.is_control() => write!(f, "\\x{:02x}", u32::from(character))?,
            character => write!(f, "{character}")?,
        }
    }
    write!(f, "{mark}")
}
