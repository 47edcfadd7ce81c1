//! `.pth` files as `torch.save` writes them: the same opcodes in the same order, so that any torch reads them, also
//! with `weights_only=True`.

use std::collections::BTreeMap;
use std::io::Write as _;

use rawzip::extra_fields::ExtraFieldId;
use rawzip::{Header, ZipArchiveWriter};

use super::REMEDY;
use crate::checkpoint::fault::Fault;
use crate::tensor::{Tensor, element_count};

/// The numbers of a tensor, in the type that they get in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Numbers<'a> {
    /// `torch.float32`.
    F32(&'a [f32]),
    /// `torch.bool`.
    Bool(&'a [bool]),
}

impl Numbers<'_> {
    fn len(self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::Bool(values) => values.len(),
        }
    }

    fn storage(self) -> &'static str {
        match self {
            Self::F32(_) => "torch\nFloatStorage",
            Self::Bool(_) => "torch\nBoolStorage",
        }
    }

    fn bytes(self) -> Vec<u8> {
        match self {
            Self::F32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Bool(values) => values.iter().map(|&value| value.into()).collect(),
        }
    }
}

/// A state dict as the bytes of a file: an `OrderedDict` of `torch.float32` tensors, in the order of the names.
///
/// `name` is that of the file without its ending, which torch gives to the folder inside.
pub fn encode_state_dict(name: &str, tensors: &BTreeMap<String, Tensor>) -> Result<Vec<u8>, Fault> {
    let mut pickler = Pickler::new();
    pickler.ordered_dict();
    let entries: Vec<(&String, &Tensor)> = tensors.iter().collect();
    for batch in entries.chunks(BATCH) {
        if batch.len() > 1 {
            pickler.bytes.push(b'(');
        }
        for (key, tensor) in batch {
            pickler.text(key);
            pickler.put();
            pickler.tensor(key, &tensor.shape, Numbers::F32(&tensor.data))?;
        }
        pickler.bytes.push(if batch.len() > 1 { b'u' } else { b's' });
    }
    pickler.finish(name)
}

/// A single tensor as the bytes of a file.
pub fn encode_tensor(name: &str, shape: &[usize], numbers: Numbers<'_>) -> Result<Vec<u8>, Fault> {
    let mut pickler = Pickler::new();
    pickler.tensor("tensor", shape, numbers)?;
    pickler.finish(name)
}

/// Entries that Python sets at once.
const BATCH: usize = 1000;

/// Storages start at multiples of this, so that a program can map them.
const ALIGNMENT: u64 = 64;

/// The extra field that torch pads with.
const PADDING: ExtraFieldId = ExtraFieldId::new(u16::from_le_bytes(*b"FB"));

struct Pickler<'a> {
    bytes: Vec<u8>,
    /// Where the values that come again stand in the memo.
    known: BTreeMap<&'static str, u32>,
    /// Values in the memo.
    memoised: u32,
    storages: Vec<Numbers<'a>>,
}

impl<'a> Pickler<'a> {
    fn new() -> Self {
        Self { bytes: vec![0x80, 2], known: BTreeMap::new(), memoised: 0, storages: Vec::new() }
    }

    fn tensor(&mut self, name: &str, shape: &[usize], numbers: Numbers<'a>) -> Result<(), Fault> {
        if element_count(shape) != Some(numbers.len()) {
            let message = format!("has {} numbers for the shape {shape:?}", numbers.len());
            return Err(Fault::new(name, message, "give as many numbers as the shape holds"));
        }
        self.global("torch._utils\n_rebuild_tensor_v2");
        self.bytes.extend(b"((");
        self.shared_text("storage");
        self.global(numbers.storage());
        self.text(&self.storages.len().to_string());
        self.put();
        self.shared_text("cpu");
        self.int(numbers.len());
        self.tuple();
        self.bytes.push(b'Q');
        self.int(0);
        self.ints(shape);
        self.ints(&contiguous(shape));
        self.bytes.push(0x89);
        self.ordered_dict();
        self.tuple();
        self.bytes.push(b'R');
        self.put();
        self.storages.push(numbers);
        Ok(())
    }

    fn ordered_dict(&mut self) {
        self.global("collections\nOrderedDict");
        self.bytes.extend(b")R");
        self.put();
    }

    /// Closes the tuple that the last mark opened.
    fn tuple(&mut self) {
        self.bytes.push(b't');
        self.put();
    }

    fn ints(&mut self, values: &[usize]) {
        match values.len() {
            0 => self.bytes.push(b')'),
            count @ 1..=3 => {
                values.iter().for_each(|&value| self.int(value));
                self.bytes.push(0x84 + count as u8);
                self.put();
            }
            _ => {
                self.bytes.push(b'(');
                values.iter().for_each(|&value| self.int(value));
                self.tuple();
            }
        }
    }

    fn int(&mut self, value: usize) {
        if let Ok(byte) = u8::try_from(value) {
            self.bytes.extend([b'K', byte]);
        } else if let Ok(word) = u16::try_from(value) {
            self.bytes.push(b'M');
            self.bytes.extend(word.to_le_bytes());
        } else if let Ok(word) = i32::try_from(value) {
            self.bytes.push(b'J');
            self.bytes.extend(word.to_le_bytes());
        } else {
            // As few bytes as two's complement needs.
            let word = (value as u64).to_le_bytes();
            let used = 8 - value.leading_zeros() as usize / 8;
            let sign = usize::from(word[used - 1] >= 0x80);
            self.bytes.extend([0x8a, (used + sign) as u8]);
            self.bytes.extend(&word[..used]);
            self.bytes.extend(&[0][..sign]);
        }
    }

    fn text(&mut self, text: &str) {
        self.bytes.push(b'X');
        self.bytes.extend((text.len() as u32).to_le_bytes());
        self.bytes.extend(text.as_bytes());
    }

    fn shared_text(&mut self, text: &'static str) {
        if !self.recall(text) {
            self.text(text);
            self.remember(text);
        }
    }

    /// `module\nname`
    fn global(&mut self, names: &'static str) {
        if !self.recall(names) {
            self.bytes.push(b'c');
            self.bytes.extend(names.as_bytes());
            self.bytes.push(b'\n');
            self.remember(names);
        }
    }

    fn recall(&mut self, what: &'static str) -> bool {
        let slot = self.known.get(what).copied();
        if let Some(slot) = slot {
            self.slot(b'h', b'j', slot);
        }
        slot.is_some()
    }

    fn remember(&mut self, what: &'static str) {
        self.known.insert(what, self.memoised);
        self.put();
    }

    /// Puts the last value into the memo, as Python does with nearly every value.
    fn put(&mut self) {
        self.slot(b'q', b'r', self.memoised);
        self.memoised += 1;
    }

    fn slot(&mut self, short: u8, long: u8, slot: u32) {
        match u8::try_from(slot) {
            Ok(byte) => self.bytes.extend([short, byte]),
            Err(_) => {
                self.bytes.push(long);
                self.bytes.extend(slot.to_le_bytes());
            }
        }
    }

    fn finish(mut self, name: &str) -> Result<Vec<u8>, Fault> {
        self.bytes.push(b'.');
        let numbers: usize = self.storages.iter().map(|storage| storage.len()).sum();
        let mut zip =
            ZipArchiveWriter::new(Vec::with_capacity(4 * numbers + 1024 * (self.storages.len() + 4)));
        let mut add = |entry: &str, bytes: &[u8]| add_entry(&mut zip, &format!("{name}/{entry}"), bytes);
        let written = add("data.pkl", &self.bytes)
            .and_then(|()| add("byteorder", b"little"))
            .and_then(|()| {
                self.storages
                    .iter()
                    .enumerate()
                    .try_for_each(|(key, storage)| add(&format!("data/{key}"), &storage.bytes()))
            })
            .and_then(|()| add("version", b"3\n"))
            .and_then(|()| zip.finish());
        written.map_err(|error| Fault::new("archive", format!("cannot be written: {error}"), REMEDY))
    }
}

fn add_entry(zip: &mut ZipArchiveWriter<Vec<u8>>, name: &str, bytes: &[u8]) -> Result<(), rawzip::Error> {
    // A local header has 30 bytes, the head of an extra field 4.
    let unpadded = zip.stream_offset() + 30 + name.len() as u64 + 4;
    let padding = vec![b'Z'; (unpadded.next_multiple_of(ALIGNMENT) - unpadded) as usize];
    let (mut entry, config) = zip.new_file(name).extra_field(PADDING, &padding, Header::LOCAL)?.start()?;
    let mut writer = config.wrap(&mut entry);
    writer.write_all(bytes)?;
    let (_, descriptor) = writer.finish()?;
    entry.finish(descriptor)?;
    Ok(())
}

/// Strides of a tensor whose last axis is fastest; torch counts an empty axis as one.
fn contiguous(shape: &[usize]) -> Vec<usize> {
    let mut strides = vec![1; shape.len()];
    for axis in (1..shape.len()).rev() {
        strides[axis - 1] = strides[axis] * shape[axis].max(1);
    }
    strides
}
