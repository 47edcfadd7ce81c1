//! Codabench: a competition bundle.
//!
//! <https://docs.codabench.org/latest/Organizers/Benchmark_Creation/Yaml-Structure/>

use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::list_folder;

use super::{Competition, Files, Hosted, LOGO, below, read, zip};
use crate::documents::render;

/// Name in the bundle, template.
const TEMPLATES: [(&str, &str); 6] = [
    ("competition.yaml", include_str!("../../templates/codabench/competition.yaml")),
    ("pages/overview.md", include_str!("../../templates/codabench/overview.md")),
    ("pages/evaluation.md", include_str!("../../templates/codabench/evaluation.md")),
    ("pages/data.md", include_str!("../../templates/codabench/data.md")),
    ("pages/terms.md", include_str!("../../templates/codabench/terms.md")),
    ("scoring_program/metadata.yaml", include_str!("../../templates/codabench/metadata.yaml")),
];

/// The bundle as files, and `bundle.zip`, which is what the platform takes. `wheel` is the Python package l4d, which
/// the scoring program installs: a wheel of this version, or a folder with one.
///
/// # Errors
/// If there is no such wheel, or a file of the benchmark cannot be read.
pub fn codabench(hosted: &Hosted<'_>, competition: &Competition, wheel: &Path) -> Result<Files, DataError> {
    let values = hosted.values_of(competition);
    let mut files = Files::new();
    for (name, template) in TEMPLATES {
        files.insert(name.to_owned(), render(name, template, &values)?.into_bytes());
    }
    files.insert("logo.png".to_owned(), LOGO.to_owned());
    files.insert("scoring_program/score.py".to_owned(), include_bytes!("../../host/score.py").to_vec());
    let (name, bytes) = read_wheel(wheel)?;
    files.insert(format!("scoring_program/{name}"), bytes);
    files.extend(below("reference_data", hosted.reference(competition.track)?));
    files.insert(
        "starting_kit/submission.zip".to_owned(),
        zip::pack("submission.zip", &hosted.example(competition.track)?)?,
    );
    let bundle = zip::pack("bundle.zip", &files)?;
    files.insert("bundle.zip".to_owned(), bundle);
    Ok(files)
}

/// Name and bytes of the wheel of this version.
fn read_wheel(path: &Path) -> Result<(String, Vec<u8>), DataError> {
    let prefix = concat!("l4d-", env!("CARGO_PKG_VERSION"), "-");
    let is_wheel = |name: &str| name.starts_with(prefix) && name.ends_with(".whl");
    let (folder, names) = match path.file_name().and_then(|name| name.to_str()) {
        Some(name) if path.is_file() => (path.parent().unwrap_or(path), vec![name.to_owned()]),
        _ if path.is_dir() => (path, list_folder(path)?),
        _ => (path, Vec::new()),
    };
    let wheels: Vec<&String> = names.iter().filter(|name| is_wheel(name)).collect();
    match wheels.as_slice() {
        [name] => Ok(((*name).clone(), read(&folder.join(name))?)),
        found => Err(DataError::invalid(
            path,
            "--wheel",
            format!("gives {} wheels {prefix}*.whl, but the scoring program needs one", found.len()),
            "run `maturin build --release --manifest-path crates/l4d-py/Cargo.toml` on a machine like the platform's, \
             and name the wheel that it writes",
        )),
    }
}
