//! The zip around a pickle: entries that are stored as they are, each a slice of the file.

use std::collections::BTreeMap;

use rawzip::{CompressionMethod, ZipArchive};

use super::REMEDY;
use crate::checkpoint::fault::{Fault, quoted};

/// Entries of an archive: a model has about a hundred.
const MOST_ENTRIES: usize = 1 << 16;

/// Bytes of a pickle: names and shapes of a model's tensors take about 10 000.
const LONGEST_PICKLE: usize = 1 << 20;

/// First bytes of what torch wrote before version 1.6.
const OLD_TORCH: &[u8] = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19";

#[derive(Debug, Clone, Copy)]
struct Entry<'a> {
    bytes: &'a [u8],
    crc: u32,
}

/// An opened archive.
#[derive(Debug)]
pub(super) struct Archive<'a> {
    entries: BTreeMap<String, Entry<'a>>,
    /// Folder in which everything stands, with its slash.
    root: String,
    pickle: &'a [u8],
    /// Bytes of the whole file.
    length: usize,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        if bytes.starts_with(OLD_TORCH) {
            return Err(Fault::new("first bytes", "are those of a torch older than 1.6", REMEDY));
        }
        let entries = entries(bytes)?;
        let mut roots = entries.keys().filter_map(|name| name.strip_suffix("data.pkl"));
        let root = match (roots.next(), roots.next()) {
            (Some(root), None) => root.to_owned(),
            (None, _) => {
                return Err(Fault::new(
                    "archive",
                    "has no entry `data.pkl`, so torch did not write it",
                    REMEDY,
                ));
            }
            (Some(_), Some(_)) => {
                return Err(Fault::new("archive", "has more than one entry `data.pkl`", REMEDY));
            }
        };
        let mut archive = Self { entries, root, pickle: &[], length: bytes.len() };
        archive.pickle = archive.entry("data.pkl")?;
        if archive.pickle.len() > LONGEST_PICKLE {
            return Err(Fault::new(
                "entry `data.pkl`",
                format!(
                    "has {} bytes, but the names and shapes of tensors fit into {LONGEST_PICKLE}",
                    archive.pickle.len()
                ),
                REMEDY,
            ));
        }
        let order = archive.entries.get(&format!("{}byteorder", archive.root));
        if order.is_some_and(|order| order.bytes != b"little") {
            return Err(Fault::new(
                "entry `byteorder`",
                "is not `little`",
                "save the file on a little-endian machine",
            ));
        }
        Ok(archive)
    }

    pub(super) fn pickle(&self) -> &'a [u8] {
        self.pickle
    }

    /// Bytes of the whole file.
    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// The bytes of an entry below the root, after a look at their checksum.
    pub(super) fn entry(&self, name: &str) -> Result<&'a [u8], Fault> {
        let entry = self.find(name)?;
        if rawzip::crc32(entry.bytes) != entry.crc {
            let message = "is damaged: its checksum does not match";
            return Err(Fault::new(
                format!("entry {}", quoted(name)),
                message,
                "copy or save the file again",
            ));
        }
        Ok(entry.bytes)
    }

    /// The bytes of an entry whose checksum was looked at before.
    pub(super) fn unchecked(&self, name: &str) -> Result<&'a [u8], Fault> {
        self.find(name).map(|entry| entry.bytes)
    }

    fn find(&self, name: &str) -> Result<Entry<'a>, Fault> {
        let found = self.entries.get(&format!("{}{name}", self.root)).copied();
        found.ok_or_else(|| {
            Fault::new(format!("entry {}", quoted(name)), "is missing from the archive", REMEDY)
        })
    }
}

/// All entries by name: stored, inside the file, and none over another.
fn entries(bytes: &[u8]) -> Result<BTreeMap<String, Entry<'_>>, Fault> {
    let broken = |error: rawzip::Error| Fault::new("archive", format!("is no whole zip: {error}"), REMEDY);
    let archive = ZipArchive::from_slice(bytes).map_err(broken)?;
    let mut entries = BTreeMap::new();
    let mut ranges = Vec::new();
    let mut directory = archive.entries();
    while let Some(record) = directory.next_entry().map_err(broken)? {
        let path = record.file_path();
        let name = String::from_utf8_lossy(path.as_bytes()).into_owned();
        let fault = |message: String| Fault::new(format!("entry {}", quoted(&name)), message, REMEDY);
        check_name(&name).map_err(|message| fault(message.to_owned()))?;
        if name.contains("/code/") || name.ends_with("/constants.pkl") {
            return Err(Fault::new("archive", "is a TorchScript program, not a dict of tensors", REMEDY));
        }
        if record.flags().is_encrypted() {
            return Err(fault("is encrypted".to_owned()));
        }
        let sizes = (record.compressed_size_hint(), record.uncompressed_size_hint());
        if record.compression_method() != CompressionMethod::STORE || sizes.0 != sizes.1 {
            return Err(fault(format!(
                "is compressed ({} bytes from {}), but torch stores as it is",
                sizes.1, sizes.0
            )));
        }
        let outside =
            |error| fault(format!("does not lie inside the file with its {} bytes: {error}", sizes.0));
        let (start, end) = archive.get_entry(record.wayfinder()).map_err(outside)?.compressed_data_range();
        let Some(data) = bytes.get(start as usize..end as usize) else {
            return Err(fault("does not lie inside the file".to_owned()));
        };
        ranges.push((start, end));
        if entries.len() == MOST_ENTRIES {
            return Err(Fault::new("archive", format!("has more than {MOST_ENTRIES} entries"), REMEDY));
        }
        let found = Entry { bytes: data, crc: record.crc32() };
        if entries.insert(name.clone(), found).is_some() {
            return Err(fault("stands twice in the archive".to_owned()));
        }
    }
    if entries.len() as u64 != archive.entries_hint() {
        let message = format!("has {} entries, but claims {}", entries.len(), archive.entries_hint());
        return Err(Fault::new("archive", message, REMEDY));
    }
    ranges.sort_unstable();
    if ranges.windows(2).any(|pair| pair[0].1 > pair[1].0) {
        return Err(Fault::new("archive", "has entries that lie over each other", REMEDY));
    }
    Ok(entries)
}

/// Entries are looked up, never unpacked; a name that would leave its folder still says that torch did not write it.
fn check_name(name: &str) -> Result<(), &'static str> {
    if name.contains(['\\', '\0', '\u{fffd}'])
        || name.starts_with('/')
        || name.split('/').any(|part| part == "..")
    {
        return Err("has a name that leaves its folder or is no text");
    }
    Ok(())
}
