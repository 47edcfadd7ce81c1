//! The folders of a release: one, or of a private test what the organiser keeps and what participants get.

use std::path::{Path, PathBuf};

/// Everything, the answers included: laid out as any other release.
pub(crate) const ORGANISER: &str = "organiser";
/// Pictures of the training views, cameras and sentences.
pub(crate) const PARTICIPANTS: &str = "participants";

/// The folder that holds archives, tables and `release.json`.
pub(crate) fn home(release: &Path) -> PathBuf {
    let organiser = release.join(ORGANISER);
    if organiser.is_dir() { organiser } else { release.to_owned() }
}

/// Folders of a release, relative to it, each with a `SHA256SUMS` of its own.
pub(crate) fn parts(release: &Path) -> &'static [&'static str] {
    if release.join(ORGANISER).is_dir() { &[ORGANISER, PARTICIPANTS] } else { &[""] }
}
