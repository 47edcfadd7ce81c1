//! Zip archives for platforms that take nothing else: sorted, no dates, not compressed, so always the same bytes.

use std::io::Write as _;

use l4d_data::DataError;
use rawzip::ZipArchiveWriter;

use super::Files;

/// The archive; `name` is what it will be called.
pub(super) fn pack(name: &str, files: &Files) -> Result<Vec<u8>, DataError> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    let written = files
        .iter()
        .try_for_each(|(name, bytes)| {
            let (mut entry, config) = archive.new_file(name.as_str()).unix_permissions(0o644).start()?;
            let mut writer = config.wrap(&mut entry);
            writer.write_all(bytes)?;
            let (_, descriptor) = writer.finish()?;
            entry.finish(descriptor)?;
            Ok::<_, rawzip::Error>(())
        })
        .and_then(|()| archive.finish());
    written.map_err(|error| super::unwritable(name, &error))
}
