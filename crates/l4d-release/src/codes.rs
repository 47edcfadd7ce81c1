//! Codes of findings; `docs/findings.md` lists them.

/// A file of the benchmark is missing or cannot be read.
pub const BENCHMARK: &str = "L4D601";
/// A status that the votes of people do not give.
pub const STATUS: &str = "L4D602";
/// A version that is no semantic version, or too low for what changed.
pub const VERSION: &str = "L4D603";
/// Renders of a scene are missing or incomplete, or belong to something else.
pub const RENDERS: &str = "L4D604";
/// The version was released before, with other contents.
pub const FROZEN: &str = "L4D605";
/// A private test without what participants get: renders of all its scenes.
pub const PRIVATE: &str = "L4D606";
/// `SHA256SUMS` or `release.json` of a release is missing or malformed.
pub const LIST: &str = "L4D611";
/// A listed file is missing.
pub const MISSING: &str = "L4D612";
/// A file that is not listed.
pub const EXTRA: &str = "L4D613";
/// A file with other bytes than its digest.
pub const ALTERED: &str = "L4D614";
