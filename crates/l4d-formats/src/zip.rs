//! Zip archives: entries by name, each a slice of the file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};

use flate2::read::DeflateDecoder;
use rawzip::path::EntryPath;
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveWriter};

use crate::fault::{Fault, quoted};

/// Entries of an archive.
const MOST_ENTRIES: usize = 1 << 16;
/// Bytes that a deflated entry may grow to: 97 masks of the full profile take 30 MB.
const LARGEST_INFLATED: u64 = 256 << 20;
/// What to do about a damaged archive.
const HINT: &str = "copy or write the file again (numpy.savez, torch.save)";

#[derive(Debug, Clone, Copy)]
struct Entry<'a> {
    bytes: &'a [u8],
    is_deflated: bool,
    /// Bytes after inflation.
    length: u64,
    crc: u32,
}

/// An opened archive; nothing is inflated before it is read.
#[derive(Debug)]
pub(crate) struct Archive<'a>(BTreeMap<String, Entry<'a>>);

impl<'a> Archive<'a> {
    /// Lists the entries: inside the file, none over another, stored or deflated.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let broken = |error: rawzip::Error| Fault::new("archive", format!("is no whole zip: {error}"), HINT);
        let archive = ZipArchive::from_slice(bytes).map_err(broken)?;
        let (mut entries, mut ranges) = (BTreeMap::new(), Vec::new());
        let mut directory = archive.entries();
        while let Some(record) = directory.next_entry().map_err(broken)? {
            let name = String::from_utf8_lossy(record.file_path().as_bytes()).into_owned();
            let fault = |message: &str| Fault::new(format!("entry {}", quoted(&name)), message, HINT);
            if leaves_its_folder(&name) {
                return Err(fault("has a name that leaves its folder or is no text"));
            }
            if record.flags().is_encrypted() {
                return Err(fault("is encrypted"));
            }
            let length = record.uncompressed_size_hint();
            let is_deflated = match record.compression_method() {
                CompressionMethod::STORE if length == record.compressed_size_hint() => false,
                CompressionMethod::DEFLATE if length <= LARGEST_INFLATED => true,
                CompressionMethod::DEFLATE => return Err(fault("would grow beyond 256 MiB")),
                _ => return Err(fault("is neither stored nor deflated")),
            };
            let outside = || fault("does not lie inside the file");
            let found = archive.get_entry(record.wayfinder()).map_err(|_error| outside())?;
            let (start, end) = found.compressed_data_range();
            let data = bytes.get(start as usize..end as usize).ok_or_else(outside)?;
            ranges.push((start, end));
            if entries.len() == MOST_ENTRIES {
                return Err(Fault::new("archive", format!("has more than {MOST_ENTRIES} entries"), HINT));
            }
            let entry = Entry { bytes: data, is_deflated, length, crc: record.crc32() };
            if entries.insert(name.clone(), entry).is_some() {
                return Err(fault("is in the archive twice"));
            }
        }
        if entries.len() as u64 != archive.entries_hint() {
            let message = format!("has {} entries, but claims {}", entries.len(), archive.entries_hint());
            return Err(Fault::new("archive", message, HINT));
        }
        ranges.sort_unstable();
        if ranges.windows(2).any(|pair| pair[0].1 > pair[1].0) {
            return Err(Fault::new("archive", "has entries that overlap", HINT));
        }
        Ok(Self(entries))
    }

    /// Names of the entries, sorted.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// The bytes of an entry, inflated, their checksum checked.
    pub(crate) fn read(&self, name: &str) -> Result<Cow<'a, [u8]>, Fault> {
        let entry = self.entry(name)?;
        let fault = |message: &str| Fault::new(format!("entry {}", quoted(name)), message, HINT);
        let bytes = match entry.is_deflated {
            true => Cow::Owned(inflate(&entry).map_err(fault)?),
            false => Cow::Borrowed(entry.bytes),
        };
        if rawzip::crc32(&bytes) != entry.crc {
            return Err(fault("is damaged: its checksum does not match"));
        }
        Ok(bytes)
    }

    /// The bytes of an entry that is not compressed; their checksum is checked if `is_new`.
    pub(crate) fn stored(&self, name: &str, is_new: bool) -> Result<&'a [u8], Fault> {
        let entry = self.entry(name)?;
        if entry.is_deflated {
            let place = format!("entry {}", quoted(name));
            return Err(Fault::new(place, "is compressed, but torch stores as it is", HINT));
        }
        if is_new {
            self.read(name)?;
        }
        Ok(entry.bytes)
    }

    fn entry(&self, name: &str) -> Result<Entry<'a>, Fault> {
        let missing = || Fault::new(format!("entry {}", quoted(name)), "is missing from the archive", HINT);
        self.0.get(name).copied().ok_or_else(missing)
    }
}

/// As many bytes as the directory claims, and not one more: memory grows with what really comes out.
fn inflate(entry: &Entry<'_>) -> Result<Vec<u8>, &'static str> {
    let mut bytes = Vec::new();
    let mut decoder = DeflateDecoder::new(entry.bytes).take(entry.length + 1);
    decoder.read_to_end(&mut bytes).map_err(|_stream| "is damaged: it does not inflate")?;
    if bytes.len() as u64 != entry.length {
        return Err("does not inflate to the size that it claims");
    }
    Ok(bytes)
}

/// Entries are looked up, never unpacked; such a name still shows that neither numpy nor torch wrote it.
fn leaves_its_folder(name: &str) -> bool {
    name.contains(['\\', '\0', '\u{fffd}'])
        || name.starts_with('/')
        || name.split('/').any(|part| part == "..")
}

/// An archive of stored entries, named as given.
///
/// # Errors
/// More bytes than a zip holds.
pub fn encode<'a>(
    entries: impl IntoIterator<Item = (impl AsRef<str>, &'a [u8])>,
) -> Result<Vec<u8>, rawzip::Error> {
    let mut zip = ZipArchiveWriter::new(Vec::new());
    for (name, bytes) in entries {
        let (mut entry, config) = zip.new_file(EntryPath::verbatim(name.as_ref().as_bytes())).start()?;
        let mut writer = config.wrap(&mut entry);
        writer.write_all(bytes)?;
        let (_, descriptor) = writer.finish()?;
        entry.finish(descriptor)?;
    }
    zip.finish()
}
