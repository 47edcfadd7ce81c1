//! Python literals as `repr` prints them: `cfg_args` of 4DGaussians, and headers of `.npy` files.
//!
//! The programs that wrote such text read it back by evaluating it. Here it is parsed, and only literals are understood.

use std::fmt;

use crate::fault::{Fault, quoted};

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
    Text(String),
    /// `[...]`.
    List(Vec<Literal>),
    /// `(...)`.
    Tuple(Vec<Literal>),
    /// `{...: ...}`, in the order of the text.
    Dict(Vec<(Literal, Literal)>),
}

impl Literal {
    /// The value of a string key, if this is a dict.
    pub fn get(&self, key: &str) -> Option<&Literal> {
        let Self::Dict(entries) = self else { return None };
        let is_it = |known: &Self| matches!(known, Self::Text(known) if known == key);
        entries.iter().find(|(known, _)| is_it(known)).map(|(_, value)| value)
    }
}

/// As in messages: floats and strings in Rust's notation.
impl fmt::Display for Literal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joined = |items: &[Self]| items.iter().map(Self::to_string).collect::<Vec<_>>().join(", ");
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(true) => f.write_str("True"),
            Self::Bool(false) => f.write_str("False"),
            Self::Int(value) => write!(f, "{value}"),
            Self::Float(value) => write!(f, "{value:?}"),
            Self::Text(text) => write!(f, "'{text}'"),
            Self::List(list) => write!(f, "[{}]", joined(list)),
            Self::Tuple(tuple) => write!(f, "({})", joined(tuple)),
            Self::Dict(_) => f.write_str("{...}"),
        }
    }
}

/// The literal that is the whole text, blanks around it aside.
///
/// # Errors
/// Anything else.
pub fn literal(text: &str) -> Result<Literal, Fault> {
    let mut parser = Parser { text, at: 0, depth: 0 };
    let value = parser.literal()?;
    parser.end()?;
    Ok(value)
}

/// Brackets within brackets.
const DEEPEST: usize = 32;

const HINT: &str = "give the file that training wrote: `Namespace(...)` with numbers, strings, True, False, None, lists, tuples and dicts";

fn fault(at: usize, message: String) -> Fault {
    Fault::new(format!("byte {at}"), message, HINT)
}

/// Names and values of `Namespace(name=literal, ...)`, as Python prints an `argparse.Namespace`.
///
/// # Errors
/// Anything else, and a name that comes twice.
pub fn namespace(text: &str) -> Result<Vec<(String, Literal)>, Fault> {
    let mut parser = Parser { text, at: 0, depth: 0 };
    parser.skip_blanks();
    if !parser.eat("Namespace(") {
        // Whatever it is instead may be no one's business: it is not quoted.
        return Err(fault(parser.at, "is not `Namespace(`, with which the text starts".to_owned()));
    }
    let mut options: Vec<(String, Literal)> = Vec::new();
    parser.until(')', |parser| {
        let at = parser.at;
        let name = parser.word();
        if name.is_empty() || name.starts_with(|first: char| first.is_ascii_digit()) {
            return Err(fault(at, format!("is {}, but the name of an option comes here", parser.sample())));
        }
        if options.iter().any(|(known, _)| known == name) {
            return Err(fault(at, format!("repeats option {}", quoted(name))));
        }
        parser.expect('=')?;
        let value = parser.literal()?;
        options.push((name.to_owned(), value));
        Ok(())
    })?;
    parser.end()?;
    Ok(options)
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    /// What is here, for a message.
    fn sample(&self) -> String {
        if self.rest().is_empty() {
            return "the end of the file".to_owned();
        }
        quoted(&self.rest().chars().take(24).collect::<String>())
    }

    fn skip_blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_ascii_start().len();
    }

    fn end(&mut self) -> Result<(), Fault> {
        self.skip_blanks();
        if self.at < self.text.len() {
            return Err(fault(self.at, format!("is {}, but nothing follows the value", self.sample())));
        }
        Ok(())
    }

    fn eat(&mut self, expected: &str) -> bool {
        let found = self.rest().starts_with(expected);
        if found {
            self.at += expected.len();
        }
        found
    }

    fn expect(&mut self, expected: char) -> Result<(), Fault> {
        self.skip_blanks();
        if self.eat(expected.encode_utf8(&mut [0; 4])) {
            return Ok(());
        }
        Err(fault(self.at, format!("is {}, but `{expected}` comes here", self.sample())))
    }

    /// Letters, digits and underscores, perhaps none.
    fn word(&mut self) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// Items with commas between them, up to and with `close`. Says whether a comma stood before it.
    fn until(
        &mut self,
        close: char,
        mut item: impl FnMut(&mut Self) -> Result<(), Fault>,
    ) -> Result<bool, Fault> {
        let close_text = close.to_string();
        let mut comma = false;
        loop {
            self.skip_blanks();
            if self.eat(&close_text) {
                return Ok(comma);
            }
            item(self)?;
            self.skip_blanks();
            comma = self.eat(",");
            if !comma {
                self.expect(close)?;
                return Ok(false);
            }
        }
    }

    fn literal(&mut self) -> Result<Literal, Fault> {
        self.skip_blanks();
        let start = self.at;
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(fault(start, format!("is nested more than {DEEPEST} deep")));
        }
        let value = match self.rest().bytes().next() {
            Some(b'\'' | b'"') => self.string().map(Literal::Text),
            Some(b'[') => self.items(']').map(|(items, _)| Literal::List(items)),
            Some(b'(') => self.tuple(),
            Some(b'{') => self.dict(),
            Some(b'+' | b'-' | b'.' | b'0'..=b'9') => self.number(),
            _ => self.constant(),
        };
        self.depth -= 1;
        value
    }

    /// Values up to and with `close`, and whether a comma stood before it.
    fn items(&mut self, close: char) -> Result<(Vec<Literal>, bool), Fault> {
        self.at += 1;
        let mut items = Vec::new();
        let comma = self.until(close, |parser| parser.literal().map(|item| items.push(item)))?;
        Ok((items, comma))
    }

    /// A tuple; brackets around one value without a comma are that value.
    fn tuple(&mut self) -> Result<Literal, Fault> {
        let (mut items, comma) = self.items(')')?;
        if items.len() == 1 && !comma {
            return Ok(items.remove(0));
        }
        Ok(Literal::Tuple(items))
    }

    fn dict(&mut self) -> Result<Literal, Fault> {
        self.at += 1;
        let mut items = Vec::new();
        self.until('}', |parser| {
            let key = parser.literal()?;
            parser.expect(':')?;
            items.push((key, parser.literal()?));
            Ok(())
        })?;
        Ok(Literal::Dict(items))
    }

    fn number(&mut self) -> Result<Literal, Fault> {
        let rest = self.rest();
        let belongs = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '+' | '-');
        let word = &rest[..rest.find(|c| !belongs(c)).unwrap_or(rest.len())];
        let digits = word.trim_start_matches(['+', '-']);
        // Rust would take words such as `infinity` too.
        let is_float = |byte| matches!(byte, b'0'..=b'9' | b'.' | b'e' | b'E' | b'+' | b'-');
        let value = if digits.bytes().all(|byte| byte.is_ascii_digit()) {
            word.parse().ok().map(Literal::Int)
        } else if digits == "inf" || digits == "nan" || digits.bytes().all(is_float) {
            word.parse().ok().map(Literal::Float)
        } else {
            None
        };
        let message = || format!("is {}, which is no number of 64 bits", quoted(word));
        let value = value.ok_or_else(|| fault(self.at, message()))?;
        self.at += word.len();
        Ok(value)
    }

    fn constant(&mut self) -> Result<Literal, Fault> {
        let start = self.at;
        match self.word() {
            "None" => Ok(Literal::None),
            "True" => Ok(Literal::Bool(true)),
            "False" => Ok(Literal::Bool(false)),
            "inf" => Ok(Literal::Float(f64::INFINITY)),
            "nan" => Ok(Literal::Float(f64::NAN)),
            _ => {
                self.at = start;
                let message = format!("is {}, which is no literal; nothing here is evaluated", self.sample());
                Err(fault(start, message))
            }
        }
    }

    fn string(&mut self) -> Result<String, Fault> {
        let start = self.at;
        let mut characters = self.rest().char_indices();
        let mark = characters.next().map(|(_, mark)| mark);
        let mut value = String::new();
        while let Some((index, character)) = characters.next() {
            match character {
                character if Some(character) == mark => {
                    self.at = start + index + character.len_utf8();
                    return Ok(value);
                }
                '\n' | '\r' => break,
                '\\' => {
                    let unescaped = unescape(&mut characters);
                    value.push(unescaped.ok_or_else(|| {
                        fault(start + index, "is an escape that strings here do not have".to_owned())
                    })?);
                }
                character => value.push(character),
            }
        }
        Err(fault(start, "is a string without an end".to_owned()))
    }
}

/// The escapes that `repr` writes.
fn unescape(characters: &mut std::str::CharIndices<'_>) -> Option<char> {
    match characters.next()?.1 {
        'x' => hexadecimal(characters, 2),
        'u' => hexadecimal(characters, 4),
        'U' => hexadecimal(characters, 8),
        'n' => Some('\n'),
        'r' => Some('\r'),
        't' => Some('\t'),
        same @ ('\\' | '\'' | '"') => Some(same),
        _ => None,
    }
}

fn hexadecimal(characters: &mut std::str::CharIndices<'_>, digits: usize) -> Option<char> {
    let word: String = characters.take(digits).map(|(_, digit)| digit).collect();
    if word.len() < digits || !word.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    char::from_u32(u32::from_str_radix(&word, 16).ok()?)
}
