//! Numbers in a folder: a file of safetensors, and the entry by which a JSON card names it.
//!
//! The card is written last, so that a kill at any moment leaves a folder whose card and tensors belong together.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::store::{list_folder, open_bounded, read_bounded, write_atomic};
use l4d_data::{DataError, json};
use safetensors::tensor::{Dtype, SafeTensors, TensorView, View};
use serde::{Deserialize, Serialize};

use crate::fault::{Fault, quoted};
use crate::tensor::Tensor;

/// A kind of folder: what its files are called, and how long they get.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TensorFileKind {
    /// Name of the card.
    pub card: &'static str,
    /// `<stem>-<digest>.safetensors`.
    pub stem: &'static str,
    /// What the tensors are parts of, for messages.
    pub whole: &'static str,
    /// No header is longer, bytes.
    pub longest_header: usize,
    /// No file is longer, bytes.
    pub longest_file: u64,
    /// What to do about a damaged one.
    pub hint: &'static str,
}

/// The entry of a card.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TensorFile {
    /// Name within the folder.
    pub file: String,
    pub bytes: u64,
    /// Digest of all bytes.
    pub sha256: String,
}

/// Numbers with a shape.
pub enum Column<'a> {
    F32(Vec<usize>, Cow<'a, [f32]>),
    U32(Vec<usize>, Cow<'a, [u32]>),
}

impl View for Column<'_> {
    fn dtype(&self) -> Dtype {
        match self {
            Self::F32(..) => Dtype::F32,
            Self::U32(..) => Dtype::U32,
        }
    }

    fn shape(&self) -> &[usize] {
        match self {
            Self::F32(shape, _) | Self::U32(shape, _) => shape,
        }
    }

    fn data(&self) -> Cow<'_, [u8]> {
        match self {
            Self::F32(_, values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::U32(_, values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }

    fn data_len(&self) -> usize {
        match self {
            Self::F32(_, values) => size_of_val(values.as_ref()),
            Self::U32(_, values) => size_of_val(values.as_ref()),
        }
    }
}

impl TensorFileKind {
    /// Writes tensors and the card that names them, in place of those that are there.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write<C: Serialize>(
        &self,
        folder: &Path,
        columns: Vec<(String, Column<'_>)>,
        card: impl FnOnce(TensorFile) -> C,
    ) -> Result<(), DataError> {
        let card_path = folder.join(self.card);
        let bytes = safetensors::serialize(columns, None).map_err(|error| {
            Fault::new("tensors", format!("cannot be written: {error}"), self.hint).at(&card_path)
        })?;
        let sha256 = sha256_hex(&bytes);
        let file = format!("{}-{}.safetensors", self.stem, sha256.get(..16).unwrap_or(&sha256));
        write_atomic(&folder.join(&file), &bytes)?;
        json::write(&card_path, &card(TensorFile { file: file.clone(), bytes: bytes.len() as u64, sha256 }))?;
        for name in list_folder(folder)? {
            if self.is_name(&name) && name != file {
                // A leftover costs room and nothing else.
                fs::remove_file(folder.join(name)).ok();
            }
        }
        Ok(())
    }

    /// Refuses entries that name anything but a file of this kind in the folder of the card.
    ///
    /// # Errors
    /// Another name.
    pub fn check(&self, entry: &TensorFile) -> Result<(), Fault> {
        if self.is_name(&entry.file) {
            return Ok(());
        }
        let expected = format!("`{}-<digest>.safetensors`", self.stem);
        let message = format!("is {}, but {expected} belongs there", quoted(&entry.file));
        Err(Fault::new("field `tensors.file`", message, self.hint))
    }

    /// The bytes of a file whose entry was checked, and where it is.
    ///
    /// # Errors
    /// A file that is missing, too long, or not the one that the card was written with.
    pub fn read(&self, folder: &Path, entry: &TensorFile) -> Result<(PathBuf, Vec<u8>), DataError> {
        let path = folder.join(&entry.file);
        // Before room is made for it.
        let length = open_bounded(&path, self.longest_file)?.metadata();
        let length = length.map_err(|source| DataError::io(&path, "read", source))?.len();
        if length != entry.bytes || sha256_file(&path)? != entry.sha256 {
            let message = format!("is not the file that {} was written with", self.card);
            return Err(DataError::invalid(&path, "digest", message, self.hint));
        }
        let bytes = read_bounded(&path, self.longest_file)?;
        Ok((path, bytes))
    }

    /// The tensors in these bytes.
    ///
    /// # Errors
    /// No safetensors.
    pub fn found<'a>(&self, bytes: &'a [u8]) -> Result<Found<'a>, Fault> {
        self.check_header(bytes)?;
        let tensors = SafeTensors::deserialize(bytes).map_err(|error| {
            let message = format!("is no safetensors header: {error}");
            Fault::new("header", message, self.hint)
        })?;
        Ok(Found { kind: *self, untaken: tensors.tensors().into_iter().collect() })
    }

    /// Holds sizes against the file first: the library adds up what a header claims, which can go over the largest
    /// integer.
    fn check_header(&self, bytes: &[u8]) -> Result<(), Fault> {
        let fault = |message: String| Fault::new("header", message, self.hint);
        let (length, rest) = bytes.split_first_chunk().ok_or_else(|| fault("is cut".to_owned()))?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        if length > self.longest_header {
            let most = self.longest_header;
            return Err(fault(format!("claims {length} bytes, but {most} hold that of {}", self.whole)));
        }
        let (header, data) = rest
            .split_at_checked(length)
            .ok_or_else(|| fault(format!("claims {length} bytes and is cut")))?;
        let entries: serde_json::Map<String, serde_json::Value> =
            serde_json::from_slice(header).map_err(|error| fault(format!("is no JSON: {error}")))?;
        for (name, entry) in entries {
            let end = entry.pointer("/data_offsets/1").and_then(serde_json::Value::as_u64);
            if name != "__metadata__" && end.is_none_or(|end| end > data.len() as u64) {
                let place = format!("tensor {}", quoted(&name));
                return Err(Fault::new(place, "does not lie inside the file", self.hint));
            }
        }
        Ok(())
    }

    /// `<stem>-<16 hex digits>.safetensors`
    fn is_name(&self, name: &str) -> bool {
        let rest = name.strip_prefix(self.stem).and_then(|rest| rest.strip_prefix('-'));
        rest.and_then(|rest| rest.strip_suffix(".safetensors")).is_some_and(|digest| {
            digest.len() == 16 && digest.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
        })
    }
}

/// Tensors of a file that were not taken yet.
pub struct Found<'a> {
    kind: TensorFileKind,
    untaken: BTreeMap<String, TensorView<'a>>,
}

impl<'a> Found<'a> {
    /// Fractions of this name and shape, whatever their values.
    ///
    /// # Errors
    /// A tensor that is missing, or of another type or shape.
    pub fn f32(&mut self, name: &str, shape: &[usize]) -> Result<Vec<f32>, Fault> {
        let view = self.take(name, Dtype::F32, shape)?;
        self.numbers(name, view.data(), f32::from_le_bytes)
    }

    /// [`Self::f32`], all of them finite.
    ///
    /// # Errors
    /// As [`Self::f32`], and the first number that is not finite.
    pub fn finite(&mut self, name: &str, shape: &[usize]) -> Result<Vec<f32>, Fault> {
        let numbers = self.f32(name, shape)?;
        match numbers.iter().position(|number| !number.is_finite()) {
            Some(index) => Err(self.fault(name, format!("has {} as number {index}", numbers[index]))),
            None => Ok(numbers),
        }
    }

    /// Indices of this name and shape.
    ///
    /// # Errors
    /// As [`Self::f32`].
    pub fn u32(&mut self, name: &str, shape: &[usize]) -> Result<Vec<u32>, Fault> {
        let view = self.take(name, Dtype::U32, shape)?;
        self.numbers(name, view.data(), u32::from_le_bytes)
    }

    /// Everything whose name begins with `prefix`, without it: fractions of any shape.
    ///
    /// # Errors
    /// A tensor of another type.
    pub fn below(&mut self, prefix: &str) -> Result<BTreeMap<String, Tensor>, Fault> {
        let names: Vec<String> =
            self.untaken.keys().filter(|name| name.starts_with(prefix)).cloned().collect();
        let mut tensors = BTreeMap::new();
        for name in names {
            let Some(view) = self.untaken.remove(&name) else { continue };
            if view.dtype() != Dtype::F32 {
                return Err(self.fault(&name, "is not of type F32".to_owned()));
            }
            let data = self.numbers(&name, view.data(), f32::from_le_bytes)?;
            let tensor = Tensor { shape: view.shape().to_vec(), data };
            tensors.insert(name[prefix.len()..].to_owned(), tensor);
        }
        Ok(tensors)
    }

    /// Refuses tensors that were not taken.
    ///
    /// # Errors
    /// The first of it.
    pub fn finish(self) -> Result<(), Fault> {
        match self.untaken.keys().next() {
            Some(name) => Err(self.fault(name, format!("is no part of {}", self.kind.whole))),
            None => Ok(()),
        }
    }

    fn numbers<T>(&self, name: &str, bytes: &[u8], number: fn([u8; 4]) -> T) -> Result<Vec<T>, Fault> {
        let words = bytes.as_chunks().0;
        let mut numbers = Vec::new();
        let room = numbers.try_reserve_exact(words.len());
        room.map_err(|error| self.fault(name, format!("does not fit: {error}")))?;
        numbers.extend(words.iter().map(|&word| number(word)));
        Ok(numbers)
    }

    fn take(&mut self, name: &str, dtype: Dtype, shape: &[usize]) -> Result<TensorView<'a>, Fault> {
        let view = self.untaken.remove(name).ok_or_else(|| self.fault(name, "is missing".to_owned()))?;
        if view.dtype() != dtype || view.shape() != shape {
            let found = format!("{:?} {:?}", view.dtype(), view.shape());
            let message = format!("is {found}, but {} needs {dtype:?} {shape:?}", self.kind.card);
            return Err(self.fault(name, message));
        }
        Ok(view)
    }

    fn fault(&self, name: &str, message: String) -> Fault {
        Fault::new(format!("tensor {}", quoted(name)), message, self.kind.hint)
    }
}
