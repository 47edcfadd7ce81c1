//! Archives of arrays: a zip of `.npy` entries, stored or deflated.

use std::collections::BTreeMap;
use std::io::Read as _;

use flate2::read::DeflateDecoder;
use l4d_splat::checkpoint::Fault;
use l4d_splat::checkpoint::fault::quoted;
use rawzip::{CompressionMethod, ZipArchive};

use super::{Contents, npy};

/// Arrays in an archive.
const MOST_ENTRIES: usize = 1 << 16;
/// Bytes that a deflated entry may grow to: 97 masks of the full profile take 30 MB.
const LARGEST_INFLATED: u64 = 256 << 20;
/// What to do about an archive that this module refuses.
const REMEDY: &str = "write it again with numpy.savez(path, name=array)";

#[derive(Debug, Clone, Copy)]
struct Entry<'a> {
    bytes: &'a [u8],
    is_deflated: bool,
    length: u64,
    crc: u32,
}

/// An opened archive; nothing is inflated before somebody asks for it.
#[derive(Debug)]
pub(super) struct Archive<'a>(BTreeMap<String, Entry<'a>>);

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let broken =
            |error: rawzip::Error| Fault::new("archive", format!("is no whole zip: {error}"), REMEDY);
        let archive = ZipArchive::from_slice(bytes).map_err(broken)?;
        let mut entries = BTreeMap::new();
        let mut directory = archive.entries();
        while let Some(record) = directory.next_entry().map_err(broken)? {
            let path = record.file_path();
            let name = String::from_utf8_lossy(path.as_bytes()).into_owned();
            let fault =
                |message: &str| Fault::new(format!("entry {}", quoted(&name)), message.to_owned(), REMEDY);
            check_name(&name).map_err(fault)?;
            if record.flags().is_encrypted() {
                return Err(fault("is encrypted"));
            }
            let is_deflated = match record.compression_method() {
                CompressionMethod::STORE => false,
                CompressionMethod::DEFLATE => true,
                _ => return Err(fault("is compressed in a way that numpy does not write")),
            };
            let length = record.uncompressed_size_hint();
            if is_deflated && length > LARGEST_INFLATED {
                return Err(fault("would grow beyond what any mask needs"));
            }
            let found =
                archive.get_entry(record.wayfinder()).map_err(|_outside| fault("lies outside the file"))?;
            let (start, end) = found.compressed_data_range();
            let data =
                bytes.get(start as usize..end as usize).ok_or_else(|| fault("lies outside the file"))?;
            if entries.len() == MOST_ENTRIES {
                return Err(Fault::new("archive", format!("has more than {MOST_ENTRIES} entries"), REMEDY));
            }
            let entry = Entry { bytes: data, is_deflated, length, crc: record.crc32() };
            let key = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
            if entries.insert(key, entry).is_some() {
                return Err(fault("stands twice in the archive"));
            }
        }
        Ok(Self(entries))
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    pub(super) fn read(&self, name: &str) -> Result<Contents, Fault> {
        let place = || format!("array {}", quoted(name));
        let entry = self.0.get(name).ok_or_else(|| Fault::new(place(), "is missing", REMEDY))?;
        let inflated;
        let bytes = if entry.is_deflated {
            inflated = inflate(entry).map_err(|message| Fault::new(place(), message, REMEDY))?;
            &inflated
        } else {
            entry.bytes
        };
        if rawzip::crc32(bytes) != entry.crc {
            return Err(Fault::new(
                place(),
                "is damaged: its checksum does not match",
                "copy the file again",
            ));
        }
        npy::decode(bytes).map_err(|fault| Fault { place: format!("{}, {}", place(), fault.place), ..fault })
    }
}

/// As many bytes as the directory claims, and not one more: room grows with what really comes out.
fn inflate(entry: &Entry<'_>) -> Result<Vec<u8>, &'static str> {
    let mut bytes = Vec::new();
    let decoder = DeflateDecoder::new(entry.bytes);
    decoder
        .take(entry.length + 1)
        .read_to_end(&mut bytes)
        .map_err(|_stream| "is damaged: it does not inflate")?;
    if bytes.len() as u64 != entry.length {
        return Err("does not inflate to the size that it claims");
    }
    Ok(bytes)
}

/// Entries are looked up, never unpacked; a name that would leave its folder still says that numpy did not write it.
fn check_name(name: &str) -> Result<(), &'static str> {
    if name.contains(['\\', '\0', '\u{fffd}'])
        || name.starts_with('/')
        || name.split('/').any(|part| part == "..")
    {
        return Err("has a name that leaves its folder or is no text");
    }
    Ok(())
}
