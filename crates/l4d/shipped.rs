//! Where the folders are that come with the program: in the working folder, as in a checkout, or in `share/l4d` of the
//! place where it was installed (`<place>/bin/l4d`). What was installed is read, and never written.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::Result;

use crate::out::refusal;

/// `<place>/share/l4d` of a program that was installed as `<place>/bin/l4d`; none in a checkout.
static SHARE: LazyLock<Option<PathBuf>> = LazyLock::new(|| {
    // Tools that install programs put links to them on the path.
    let program = std::env::current_exe().and_then(std::fs::canonicalize).ok()?;
    let share = program.parent()?.parent()?.join("share").join("l4d");
    share.is_dir().then_some(share)
});

static BENCHMARK: LazyLock<PathBuf> = LazyLock::new(|| find("benchmark", "benchmark"));
static BLENDER_SCRIPTS: LazyLock<PathBuf> = LazyLock::new(|| find("blender_scripts", "blender_scripts"));
static WORKERS: LazyLock<PathBuf> = LazyLock::new(|| find("crates/l4d-ground/workers", "workers"));

/// The folder of the benchmark where none is named.
pub(crate) fn benchmark() -> &'static OsStr {
    BENCHMARK.as_os_str()
}

/// The folder of the Blender scripts where none is named.
pub(crate) fn blender_scripts() -> &'static OsStr {
    BLENDER_SCRIPTS.as_os_str()
}

/// The folder of the segmenter workers where none is named.
pub(crate) fn workers() -> &'static Path {
    &WORKERS
}

/// Refuses a benchmark folder that was installed with the program, for what would write into it.
pub(crate) fn require_own(bench: &Path) -> Result<()> {
    if !is_installed(bench) {
        return Ok(());
    }
    Err(refusal(
        format!("{}: was installed with l4d and is not written to", bench.display()),
        format!(
            "copy it (`cp -r {} benchmark`); in that folder l4d uses the copy, elsewhere name it with --bench",
            bench.display()
        ),
    ))
}

/// Whether a benchmark folder was installed with the program.
pub(crate) fn is_installed(bench: &Path) -> bool {
    let (Some(share), Ok(bench)) = (SHARE.as_deref(), std::fs::canonicalize(bench)) else { return false };
    bench.starts_with(share)
}

fn find(here: &str, installed: &str) -> PathBuf {
    let here = PathBuf::from(here);
    let installed = || SHARE.as_ref().map(|share| share.join(installed)).filter(|folder| folder.is_dir());
    if here.exists() { here } else { installed().unwrap_or(here) }
}
