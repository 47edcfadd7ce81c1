//! What both encodings of a model are made of: entries, numbers, names and lists.

use std::path::Path;
use std::str::FromStr;

use l4d_data::DataError;

use super::{CameraModel, HINT};

/// A file of entries, read field by field.
pub(super) trait Fields: Sized {
    /// Goes to the next entry; false at the end of the file.
    fn next_entry(&mut self) -> Result<bool, DataError>;

    fn number<T: Number>(&mut self, field: &str) -> Result<T, DataError>;

    fn model(&mut self) -> Result<CameraModel, DataError>;

    /// The name of an image, the last of its fields before what it shows.
    fn name(&mut self) -> Result<String, DataError>;

    /// A list that ends an entry; items have at least so many bytes in the binary encoding.
    fn list<T>(
        &mut self,
        least_bytes: usize,
        item: impl FnMut(&mut Self) -> Result<T, DataError>,
    ) -> Result<Vec<T>, DataError>;

    /// All entries of the file.
    fn entries<T: Entry>(mut self) -> Result<Vec<T>, DataError> {
        let mut entries = Vec::new();
        while self.next_entry()? {
            entries.push(T::read(&mut self)?);
        }
        Ok(entries)
    }
}

/// What a file has many of.
pub(super) trait Entry: Sized {
    fn read(fields: &mut impl Fields) -> Result<Self, DataError>;
}

/// A number in either encoding.
pub(super) trait Number: FromStr {
    /// From the first bytes, little-endian, and how many they are.
    fn read(bytes: &[u8]) -> Option<(Self, usize)>;
}

macro_rules! number {
    ($($kind:ty),*) => {
        $(impl Number for $kind {
            fn read(bytes: &[u8]) -> Option<(Self, usize)> {
                Some((Self::from_le_bytes(*bytes.first_chunk()?), size_of::<Self>()))
            }
        })*
    };
}

number!(u8, i32, u32, i64, u64, f64);

/// The binary encoding: counts before lists.
pub(super) struct Binary<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    offset: usize,
    /// Entries that are still to come, once their number is known.
    left: Option<u64>,
}

impl<'a> Binary<'a> {
    pub(super) fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, bytes, offset: 0, left: None }
    }

    fn wrong(&self, message: String, hint: &str) -> DataError {
        DataError::invalid(self.path, format!("byte {}", self.offset), message, hint)
    }
}

impl Fields for Binary<'_> {
    fn next_entry(&mut self) -> Result<bool, DataError> {
        let left = if let Some(left) = self.left { left } else { self.number("count")? };
        self.left = left.checked_sub(1);
        let rest = self.bytes.len() - self.offset;
        match (self.left, rest) {
            (None, 1..) => Err(self.wrong(format!("{rest} bytes are left over"), HINT)),
            (left, _) => Ok(left.is_some()),
        }
    }

    fn number<T: Number>(&mut self, field: &str) -> Result<T, DataError> {
        let read = T::read(&self.bytes[self.offset..]);
        let (number, length) =
            read.ok_or_else(|| self.wrong(format!("ends within the field `{field}`"), HINT))?;
        self.offset += length;
        Ok(number)
    }

    fn model(&mut self) -> Result<CameraModel, DataError> {
        let number = self.number("model")?;
        CameraModel::from_repr(number).ok_or_else(|| {
            let message = format!("camera model {number} is not understood");
            self.wrong(message, "undistort the images first (`colmap image_undistorter`)")
        })
    }

    fn name(&mut self) -> Result<String, DataError> {
        let rest = &self.bytes[self.offset..];
        let length = rest.iter().position(|&byte| byte == 0);
        let length = length.ok_or_else(|| self.wrong("a name has no end".to_owned(), HINT))?;
        let name = std::str::from_utf8(&rest[..length])
            .map_err(|error| self.wrong(format!("a name is no UTF-8: {error}"), HINT))?;
        self.offset += length + 1;
        Ok(name.to_owned())
    }

    fn list<T>(
        &mut self,
        least_bytes: usize,
        mut item: impl FnMut(&mut Self) -> Result<T, DataError>,
    ) -> Result<Vec<T>, DataError> {
        let count: u64 = self.number("count")?;
        let room = ((self.bytes.len() - self.offset) / least_bytes) as u64;
        if count > room {
            let message = format!("promises {count} entries, but has room for {room}");
            return Err(self.wrong(message, HINT));
        }
        (0..count).map(|_| item(self)).collect()
    }
}

/// The text encoding: a line an entry, two for images, `#` begins a comment.
pub(super) struct Text<'a> {
    path: &'a Path,
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// Number of the line, from 0, and what was not read of it.
    number: usize,
    rest: &'a str,
}

impl<'a> Text<'a> {
    pub(super) fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self, DataError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            DataError::invalid(path, format!("byte {}", error.valid_up_to()), "is no UTF-8", HINT)
        })?;
        Ok(Self { path, lines: text.lines().enumerate(), number: 0, rest: "" })
    }

    /// Goes to the next line that is no comment; at the end of the file the rest is empty.
    fn next_line(&mut self) -> bool {
        let line = self.lines.find(|(_, line)| !line.trim_start().starts_with('#'));
        (self.number, self.rest) = line.unwrap_or((self.number, ""));
        line.is_some()
    }

    fn is_through(&self) -> bool {
        self.rest.trim().is_empty()
    }

    fn word(&mut self, field: &str) -> Result<&'a str, DataError> {
        let rest = self.rest.trim_start();
        let (word, rest) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        if word.is_empty() {
            return Err(self.wrong(field, "is missing".to_owned(), HINT));
        }
        self.rest = rest;
        Ok(word)
    }

    fn wrong(&self, field: &str, message: String, hint: &str) -> DataError {
        DataError::invalid(self.path, format!("line {}, field `{field}`", self.number + 1), message, hint)
    }
}

impl Fields for Text<'_> {
    fn next_entry(&mut self) -> Result<bool, DataError> {
        if !self.is_through() {
            return Err(self.wrong("end", format!("`{}` is left over", self.rest.trim()), HINT));
        }
        while self.next_line() {
            if !self.is_through() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn number<T: Number>(&mut self, field: &str) -> Result<T, DataError> {
        let word = self.word(field)?;
        let number = word.parse().ok();
        number.ok_or_else(|| self.wrong(field, format!("`{word}` is no such number"), HINT))
    }

    fn model(&mut self) -> Result<CameraModel, DataError> {
        let name = self.word("model")?;
        name.parse().ok().ok_or_else(|| {
            let message = format!("camera model `{name}` is not understood");
            self.wrong("model", message, "undistort the images first (`colmap image_undistorter`)")
        })
    }

    /// All that is left of the line, since names may hold blanks; what the image shows is in the next one, which may be
    /// empty, and missing at the end of the file.
    fn name(&mut self) -> Result<String, DataError> {
        let name = self.rest.trim();
        if name.is_empty() {
            return Err(self.wrong("name", "is missing".to_owned(), HINT));
        }
        self.next_line();
        Ok(name.to_owned())
    }

    fn list<T>(
        &mut self,
        _least_bytes: usize,
        mut item: impl FnMut(&mut Self) -> Result<T, DataError>,
    ) -> Result<Vec<T>, DataError> {
        let mut items = Vec::new();
        while !self.is_through() {
            items.push(item(self)?);
        }
        Ok(items)
    }
}
