//! Codabench: a competition bundle.
//!
//! <https://docs.codabench.org/latest/Organizers/Benchmark_Creation/Yaml-Structure/>

use l4d_data::DataError;

use super::{Files, LOGO, SCORER, Season, Setting, below, zip};
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

/// The bundle as files, and `bundle.zip`, which is what the platform takes.
pub fn codabench(setting: &Setting<'_>, season: &Season) -> Result<Files, DataError> {
    let values = setting.values_of(season);
    let mut files = Files::new();
    for (name, template) in TEMPLATES {
        files.insert(name.to_owned(), render(name, template, &values)?.into_bytes());
    }
    files.insert("logo.png".to_owned(), LOGO.to_owned());
    files.insert("scoring_program/l4d_scorer.py".to_owned(), SCORER.into());
    files.extend(below("reference_data", setting.reference(season.track)?));
    files.insert(
        "starting_kit/submission.zip".to_owned(),
        zip::pack("submission.zip", &setting.example(season.track)?)?,
    );
    let bundle = zip::pack("bundle.zip", &files)?;
    files.insert("bundle.zip".to_owned(), bundle);
    Ok(files)
}
