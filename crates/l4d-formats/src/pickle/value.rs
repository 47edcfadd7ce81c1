//! What a pickle describes, written out as a tree within stated bounds.

use std::collections::BTreeSet;

use super::REMEDY;
use super::node::{Id, Node, Pickle, Storage, View};
use super::storage::{self, Problem};
use crate::fault::{Fault, quoted};
use crate::tensor::{Tensor, element_count};
use crate::zip::Archive;

/// Containers within containers; a checkpoint of 4DGaussians has 5.
const DEEPEST: usize = 32;

/// Plain Python data with tensors in it. Numbers of tensors are `f32`, whatever their type in the file.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `None`.
    None,
    /// A truth value.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// A string.
    Text(String),
    /// A list.
    List(Vec<Value>),
    /// A tuple.
    Tuple(Vec<Value>),
    /// A dict, in the order of the file; a key that comes twice is twice.
    Dict(Vec<(Value, Value)>),
    /// A tensor or parameter.
    Tensor(Tensor),
}

impl Value {
    /// The Python type, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a bool",
            Self::Int(_) => "an int",
            Self::Float(_) => "a float",
            Self::Text(_) => "a string",
            Self::List(_) => "a list",
            Self::Tuple(_) => "a tuple",
            Self::Dict(_) => "a dict",
            Self::Tensor(_) => "a tensor",
        }
    }
}

/// Writes out the value of a pickle with the numbers of its tensors.
///
/// `root` is the folder of the storages in the archive, `length` the bytes of the whole file.
pub(super) fn expand(
    pickle: &Pickle,
    archive: &Archive<'_>,
    root: &str,
    length: usize,
) -> Result<Value, Fault> {
    let mut expander = Expander {
        pickle,
        archive,
        root,
        // A value takes at least a byte of the pickle, unless values are shared again and again.
        values_left: pickle.length,
        text_left: 16 * pickle.length,
        numbers_left: length,
        sound: BTreeSet::new(),
    };
    expander.value(pickle.root, 0)
}

struct Expander<'a> {
    pickle: &'a Pickle,
    archive: &'a Archive<'a>,
    root: &'a str,
    values_left: usize,
    text_left: usize,
    numbers_left: usize,
    /// Storages whose checksum was seen to match.
    sound: BTreeSet<&'a str>,
}

impl<'a> Expander<'a> {
    fn value(&mut self, id: Id, depth: usize) -> Result<Value, Fault> {
        if depth > DEEPEST {
            let message = format!("nests values more than {DEEPEST} deep, or within themselves");
            return Err(Fault::new("data.pkl", message, REMEDY));
        }
        self.values_left = spend(self.values_left, 1, "values")?;
        let pickle = self.pickle;
        match pickle.node(id) {
            Node::None => Ok(Value::None),
            Node::Bool(value) => Ok(Value::Bool(*value)),
            Node::Int(value) => Ok(Value::Int(*value)),
            Node::Float(value) => Ok(Value::Float(*value)),
            Node::Text(text) => {
                self.text_left = spend(self.text_left, text.len(), "text")?;
                Ok(Value::Text(text.clone().into_string()))
            }
            Node::List(items) => self.values(items, depth + 1).map(Value::List),
            Node::Tuple(items) => self.values(items, depth + 1).map(Value::Tuple),
            Node::Dict(items) => {
                let mut pairs = Vec::new();
                for &(key, value) in items {
                    pairs.push((self.value(key, depth + 1)?, self.value(value, depth + 1)?));
                }
                Ok(Value::Dict(pairs))
            }
            Node::Tensor(view) => self.tensor(view).map(Value::Tensor),
            other @ (Node::Global(_) | Node::Storage(_)) => {
                let message = format!("has {} where a value belongs", other.kind());
                Err(Fault::new("data.pkl", message, REMEDY))
            }
        }
    }

    fn values(&mut self, ids: &[Id], depth: usize) -> Result<Vec<Value>, Fault> {
        ids.iter().map(|&id| self.value(id, depth)).collect()
    }

    fn tensor(&mut self, view: &'a View) -> Result<Tensor, Fault> {
        let Node::Storage(storage) = self.pickle.node(view.storage) else {
            return Err(Fault::new("data.pkl", "has a tensor without a storage", REMEDY));
        };
        let fault =
            |message: String| Fault::new(format!("storage {}", quoted(&storage.key)), message, REMEDY);
        let count = element_count(&view.shape)
            .ok_or_else(|| fault(format!("is seen in the shape {:?}", view.shape)))?;
        self.numbers_left = spend(self.numbers_left, count, "numbers")?;
        let bytes = self.bytes(storage)?;
        let data = storage::read(bytes, storage, view, count).map_err(|problem| match problem {
            Problem::OutOfBounds => fault(format!(
                "has {} numbers, but a tensor starts at {} with shape {:?} and strides {:?}",
                storage.count, view.offset, view.shape, view.strides
            )),
            Problem::Inexact(index) => {
                fault(format!("has a number that no 32-bit float is like, at {index} of a tensor"))
            }
        })?;
        Ok(Tensor { shape: view.shape.clone(), data })
    }

    /// The bytes of a storage, as many as its numbers need, their checksum looked at once.
    fn bytes(&mut self, storage: &'a Storage) -> Result<&'a [u8], Fault> {
        let name = format!("{}data/{}", self.root, storage.key);
        let is_new = self.sound.insert(&storage.key);
        let bytes = self.archive.stored(&name, is_new)?;
        let needed = storage.count.checked_mul(storage.element.size());
        if needed != Some(bytes.len()) {
            return Err(Fault::new(
                format!("storage {}", quoted(&storage.key)),
                format!(
                    "has {} bytes, but the pickle claims {} numbers of {}",
                    bytes.len(),
                    storage.count,
                    storage.element.size()
                ),
                REMEDY,
            ));
        }
        Ok(bytes)
    }
}

fn spend(left: usize, amount: usize, what: &str) -> Result<usize, Fault> {
    left.checked_sub(amount).ok_or_else(|| {
        Fault::new(
            "data.pkl",
            format!("repeats itself into far more {what} than the file has room for"),
            REMEDY,
        )
    })
}
