//! Trained models of the scenes, as a release carries them: the folders that exist, as they are.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::layout::WorkDir;
use l4d_data::{DataError, Name, Profile, Report};

use crate::codes;
use crate::gather::Source;
use crate::inspect::files_below;

/// Scene -> the files of its model, sorted.
pub(crate) type Splats = BTreeMap<Name, Vec<Source>>;

/// Lists the models that there are below a work folder; a scene without one is no finding.
pub(crate) fn list<'a>(
    work: &Path,
    profile: Profile,
    scenes: impl Iterator<Item = &'a Name>,
    report: &mut Report,
) -> Splats {
    let mut found = Splats::new();
    for name in scenes {
        let folder = WorkDir::new(work, profile, name).splats();
        if !folder.is_dir() {
            continue;
        }
        match files(&folder, profile, name, report) {
            Ok(files) => drop(found.insert(name.clone(), files)),
            Err(error) => report.data_error(codes::RENDERS, &error),
        }
    }
    found
}

fn files(
    folder: &Path,
    profile: Profile,
    name: &Name,
    report: &mut Report,
) -> Result<Vec<Source>, DataError> {
    let source =
        |file: String| Source::read(format!("work/{profile}/{name}/splats/{file}"), folder.join(file));
    files_below(folder, report)?.into_iter().map(source).collect()
}
