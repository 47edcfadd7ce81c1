//! `.pth` files: what `torch.save` makes of a tensor or a dict of tensors.
//!
//! Such a file is a zip of a pickle, a program for a small stack machine that can call anything in Python, and of one
//! entry of raw numbers per storage. The machine here knows the 33 opcodes and the few globals that tensors and the
//! numbers beside them need. It calls nothing: each allowed global has one meaning that is
//! spelled out in this crate, and any other is refused by name, before anything that follows it is read.
//!
//! Memory stays in proportion to the file: storages are slices of it, values that the pickle shares stay shared, and
//! tensors together hold no more numbers than the file has bytes.
//! Existing readers (candle's, burn's) turn what they don't know into opaque values and allow tensors of any size that
//! strides of zero can claim; the container is left to a crate.

mod calls;
mod machine;
mod node;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::Read as _;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::{open_bounded, read_bounded};

use self::node::{Id, Node};
use crate::element::Problem;
use crate::fault::{Fault, quoted};
use crate::tensor::{Tensor, element_count};
use crate::zip::Archive;

/// No such file is larger, bytes: a thousand times what a model of this project needs.
const MAX_BYTES: u64 = 8 << 30;
/// Bytes of a pickle: names and shapes of a model's tensors take about 10 000.
const LONGEST_PICKLE: usize = 1 << 20;
/// First bytes of what torch wrote before version 1.6.
const OLD_TORCH: &[u8] = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19";

/// What to do about a file that this module refuses.
const HINT: &str = "save the parameters alone, with torch 1.6 or newer: torch.save(model.state_dict(), path)";

/// What a file holds. Numbers are `f32`, whatever their type in the file.
#[derive(Debug, Clone, PartialEq)]
pub enum Saved {
    /// A tensor or parameter.
    Tensor(Tensor),
    /// A dict by names, the last of equals; of what is no tensor the Python type.
    Dict(BTreeMap<String, Result<Tensor, &'static str>>),
}

/// Reads a state dict: finite tensors by name.
///
/// # Errors
/// As [`decode`], a file that cannot be read, other values, and numbers that are not finite.
pub fn read_state_dict(path: &Path) -> Result<BTreeMap<String, Tensor>, DataError> {
    read(path)?.into_state_dict().map_err(|fault| fault.at(path))
}

/// Reads a single finite tensor.
///
/// # Errors
/// As [`read_state_dict`].
pub fn read_tensor(path: &Path) -> Result<Tensor, DataError> {
    read(path)?.into_tensor().map_err(|fault| fault.at(path))
}

fn read(path: &Path) -> Result<Saved, DataError> {
    // The first bytes of what is no zip say so without the rest.
    let mut head = Vec::new();
    let read = open_bounded(path, MAX_BYTES)?.take(OLD_TORCH.len() as u64).read_to_end(&mut head);
    read.map_err(|source| DataError::io(path, "read", source))?;
    let bytes = if head.starts_with(b"PK") { read_bounded(path, MAX_BYTES)? } else { head };
    decode(&bytes).map_err(|fault| fault.at(path))
}

impl Saved {
    /// The finite tensors of a dict.
    ///
    /// # Errors
    /// Other values, and numbers that are not finite.
    pub fn into_state_dict(self) -> Result<BTreeMap<String, Tensor>, Fault> {
        let Self::Dict(entries) = self else {
            return Err(Fault::new("top level", "is a tensor, but a state dict is a dict", HINT));
        };
        let finite = |(name, value): (String, Result<Tensor, &str>)| {
            let place = quoted(&name);
            let tensor = value.map_err(|kind| {
                Fault::new(&place, format!("is {kind}, but a state dict holds tensors"), HINT)
            })?;
            tensor.check_finite(&place)?;
            Ok((name, tensor))
        };
        entries.into_iter().map(finite).collect()
    }

    /// The finite tensor that is the whole value.
    ///
    /// # Errors
    /// A dict, and numbers that are not finite.
    pub fn into_tensor(self) -> Result<Tensor, Fault> {
        let Self::Tensor(tensor) = self else {
            return Err(Fault::new("top level", "is a dict, but a tensor belongs here", HINT));
        };
        tensor.check_finite("tensor")?;
        Ok(tensor)
    }
}

/// The value in the bytes of a file.
///
/// # Errors
/// Anything but a tensor or a dict with names as keys, and a file that claims more than it holds.
pub fn decode(bytes: &[u8]) -> Result<Saved, Fault> {
    open(bytes)?.saved(&[])
}

/// A step from a value to what is in it.
#[derive(Debug, Clone, Copy)]
pub enum Step<'a> {
    /// Of a tuple.
    Item(usize),
    /// Of a dict.
    Entry(&'a str),
}

impl fmt::Display for Step<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Item(index) => write!(f, "[{index}]"),
            Self::Entry(name) => write!(f, "[{}]", quoted(name)),
        }
    }
}

/// A file whose values are described, and not yet read.
pub struct Contents<'a> {
    nodes: Vec<Node>,
    value: Id,
    archive: Archive<'a>,
    /// Folder of the storages in the archive.
    root: String,
    /// Strides of zero and names of the same tensor could make more of a file than it has bytes.
    most_numbers: usize,
}

impl Contents<'_> {
    /// What a tensor or a dict with names as keys holds.
    ///
    /// # Errors
    /// Anything else at this place, and a file that claims more than it holds.
    pub fn saved(&self, path: &[Step<'_>]) -> Result<Saved, Fault> {
        let place = match path {
            [] => "top level".to_owned(),
            path => path.iter().map(ToString::to_string).collect(),
        };
        let value = self.find(path).ok_or_else(|| Fault::new(&place, "is missing", HINT))?;
        let Self { nodes, archive, root, .. } = self;
        let numbers_left = self.most_numbers;
        Tensors { nodes, archive, root, numbers_left, sound: BTreeSet::new() }.saved(value, &place)
    }

    /// A whole number.
    pub fn number(&self, path: &[Step<'_>]) -> Option<i64> {
        match self.node(self.find(path)?) {
            Node::Int(value) => Some(*value),
            _ => None,
        }
    }

    /// Items of a tuple.
    pub fn items(&self, path: &[Step<'_>]) -> Option<usize> {
        match self.node(self.find(path)?) {
            Node::Tuple(items) => Some(items.len()),
            _ => None,
        }
    }

    /// Whether there is a dict.
    pub fn is_dict(&self, path: &[Step<'_>]) -> bool {
        self.find(path).is_some_and(|value| matches!(self.node(value), Node::Dict(_)))
    }

    fn find(&self, path: &[Step<'_>]) -> Option<Id> {
        path.iter().try_fold(self.value, |value, step| match (self.node(value), step) {
            (Node::Tuple(items), Step::Item(index)) => items.get(*index).copied(),
            (Node::Dict(pairs), Step::Entry(wanted)) => {
                let is_wanted = |key: Id| matches!(self.node(key), Node::Text(name) if **name == **wanted);
                pairs.iter().rev().find(|(key, _)| is_wanted(*key)).map(|(_, value)| *value)
            }
            _ => None,
        })
    }

    fn node(&self, id: Id) -> &Node {
        self.nodes.get(id as usize).unwrap_or(&Node::None)
    }
}

/// Describes what is in the bytes of a file.
///
/// # Errors
/// Another file, and a pickle that needs more than tensors, numbers and what holds them.
pub fn open(bytes: &[u8]) -> Result<Contents<'_>, Fault> {
    if bytes.starts_with(OLD_TORCH) {
        return Err(Fault::new("first bytes", "are those of a torch older than 1.6", HINT));
    }
    let archive = Archive::open(bytes)?;
    let refuse = |message: &str| Err(Fault::new("archive", message, HINT));
    if archive.names().any(|name| name.contains("/code/") || name.ends_with("/constants.pkl")) {
        return refuse("is a TorchScript program, not a dict of tensors");
    }
    let root = {
        let mut roots = archive.names().filter_map(|name| name.strip_suffix("data.pkl"));
        match (roots.next(), roots.next()) {
            (Some(root), None) => root.to_owned(),
            (None, _) => return refuse("has no entry `data.pkl`, so torch did not write it"),
            (Some(_), Some(_)) => return refuse("has more than one entry `data.pkl`"),
        }
    };
    let program = archive.stored(&format!("{root}data.pkl"), true)?;
    let length = program.len();
    if length > LONGEST_PICKLE {
        let message =
            format!("has {length} bytes, but the names and shapes of tensors fit into {LONGEST_PICKLE}");
        return Err(Fault::new("entry `data.pkl`", message, HINT));
    }
    let order = format!("{root}byteorder");
    if archive.names().any(|name| name == order) && archive.stored(&order, true)? != b"little" {
        let hint = "save the file on a little-endian machine";
        return Err(Fault::new("entry `byteorder`", "is not `little`", hint));
    }
    let (nodes, value) = machine::run(program)?;
    Ok(Contents { nodes, value, archive, root, most_numbers: bytes.len() })
}

/// Tensors of a file that has been described.
struct Tensors<'a> {
    nodes: &'a [Node],
    archive: &'a Archive<'a>,
    root: &'a str,
    numbers_left: usize,
    /// Storages whose checksum was seen to match.
    sound: BTreeSet<&'a str>,
}

impl<'a> Tensors<'a> {
    fn saved(&mut self, value: Id, place: &str) -> Result<Saved, Fault> {
        let top = |message: String| Fault::new(place, message, HINT);
        let pairs = match self.node(value) {
            Node::Dict(pairs) => pairs,
            Node::Tensor(..) => {
                return self.tensor(value)?.map(Saved::Tensor).map_err(|kind| top(kind.into()));
            }
            other => {
                return Err(top(format!(
                    "is {}, but a tensor or a dict of tensors belongs here",
                    other.kind()
                )));
            }
        };
        // Names are shared until each is known to come once.
        let mut entries = BTreeMap::new();
        for &(key, value) in pairs {
            match self.node(key) {
                Node::Text(name) => drop(entries.insert(&**name, value)),
                key => return Err(top(format!("has {} for a key, but names are strings", key.kind()))),
            }
        }
        let read = |(name, value): (&str, Id)| Ok((name.to_owned(), self.tensor(value)?));
        entries.into_iter().map(read).collect::<Result<_, Fault>>().map(Saved::Dict)
    }

    fn node(&self, id: Id) -> &'a Node {
        self.nodes.get(id as usize).unwrap_or(&Node::None)
    }

    /// A tensor, or the Python type of what is none.
    fn tensor(&mut self, value: Id) -> Result<Result<Tensor, &'static str>, Fault> {
        let Node::Tensor(storage, view) = self.node(value) else { return Ok(Err(self.node(value).kind())) };
        let Node::Storage(storage) = self.node(*storage) else {
            return Err(Fault::new("data.pkl", "has a tensor without a storage", HINT));
        };
        let fault = |message: String| Fault::new(format!("storage {}", quoted(&storage.key)), message, HINT);
        let left = element_count(&view.shape).and_then(|count| self.numbers_left.checked_sub(count));
        self.numbers_left = left.ok_or_else(|| {
            let message = "repeats itself into far more numbers than the file has room for";
            Fault::new("data.pkl", message, HINT)
        })?;
        let name = format!("{}data/{}", self.root, storage.key);
        let is_new = self.sound.insert(&storage.key);
        let bytes = self.archive.stored(&name, is_new)?;
        let (count, size) = (storage.count, storage.element.size());
        if count.checked_mul(size) != Some(bytes.len()) {
            let found = bytes.len();
            return Err(fault(format!("has {found} bytes, but the pickle claims {count} numbers of {size}")));
        }
        let data = storage.element.read(bytes, view).map_err(|problem| {
            fault(match problem {
                Problem::OutOfBounds => format!(
                    "has {count} numbers, but a tensor starts at {} with shape {:?} and strides {:?}",
                    view.offset, view.shape, view.strides
                ),
                Problem::TooLarge(index) => {
                    format!("has a number that no 32-bit float is like, at {index} of a tensor")
                }
                Problem::OutOfMemory => "does not fit into memory".to_owned(),
            })
        })?;
        Ok(Ok(Tensor { shape: view.shape.clone(), data }))
    }
}
