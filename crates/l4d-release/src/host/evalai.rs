//! EvalAI: a challenge configuration.
//!
//! <https://evalai.readthedocs.io/en/latest/configuration.html>

use l4d_data::DataError;

use super::{Files, LOGO, SCORER, Season, Setting, zip};
use crate::documents::render;

/// Name in the configuration, template.
const TEMPLATES: [(&str, &str); 6] = [
    ("challenge_config.yaml", include_str!("../../templates/evalai/challenge_config.yaml")),
    ("templates/description.html", include_str!("../../templates/evalai/description.html")),
    ("templates/evaluation_details.html", include_str!("../../templates/evalai/evaluation_details.html")),
    ("templates/phase_description.html", include_str!("../../templates/evalai/phase_description.html")),
    (
        "templates/submission_guidelines.html",
        include_str!("../../templates/evalai/submission_guidelines.html"),
    ),
    ("templates/terms_and_conditions.html", include_str!("../../templates/evalai/terms_and_conditions.html")),
];

/// The configuration as files, and `challenge.zip`, which is what the platform takes.
pub fn evalai(setting: &Setting<'_>, season: &Season) -> Result<Files, DataError> {
    let values = setting.values_of(season);
    let mut files = Files::new();
    for (name, template) in TEMPLATES {
        files.insert(name.to_owned(), render(name, template, &values)?.into_bytes());
    }
    let program = Files::from([
        ("__init__.py".to_owned(), b"from .main import evaluate\n".to_vec()),
        ("main.py".to_owned(), include_bytes!("../../host/evalai.py").to_vec()),
        ("l4d_scorer.py".to_owned(), SCORER.into()),
    ]);
    files.insert("logo.png".to_owned(), LOGO.to_owned());
    files.insert("evaluation_script.zip".to_owned(), zip::pack("evaluation_script.zip", &program)?);
    files.insert(
        "annotations/reference.zip".to_owned(),
        zip::pack("reference.zip", &setting.reference(season.track)?)?,
    );
    let challenge = zip::pack("challenge.zip", &files)?;
    files.insert("challenge.zip".to_owned(), challenge);
    files.insert(
        "example/submission.zip".to_owned(),
        zip::pack("submission.zip", &setting.example(season.track)?)?,
    );
    Ok(files)
}
