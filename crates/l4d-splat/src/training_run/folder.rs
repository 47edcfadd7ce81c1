//! The folder of a model: a checkpoint while training is under way, then the model and what it came from.

use std::path::PathBuf;

use l4d_data::results::Track;
use l4d_data::store::{self, Earlier};
use l4d_data::{DataError, Name, Profile, StageError, json};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::input::Digests;
use super::report::{Effort, Report};
use super::{Result, plain};
use crate::checkpoint::own::{self, Checkpoint, Sampling};
use crate::train::Trainer;

/// Schema tag of `manifest.json`.
const SCHEMA: &str = "l4d/train-splats/1";
const MANIFEST: &str = "manifest.json";
const SPENT: &str = "spent";

/// Everything that a model follows from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Origin {
    pub(super) scene: Name,
    pub(super) profile: Profile,
    pub(super) settings: Value,
    /// Where the first Gaussians came from.
    pub(super) init: String,
    /// Whether rendered depth was evaluated at, which decides with whom methods are ranked that use the model.
    pub(super) saw_depth: bool,
    pub(super) track: Track,
    /// Which pictures of a capture were trained on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sampling: Option<Sampling>,
    pub(super) rasterizer: String,
    pub(super) adapter: Option<Value>,
    /// Files that were trained on.
    pub(super) trained_on: Digests,
    /// Files that were only compared with.
    pub(super) compared_with: Digests,
}

#[derive(Serialize)]
struct Manifest<'a> {
    schema: &'static str,
    #[serde(flatten)]
    origin: &'a Origin,
    report: &'a Report,
}

/// What a folder holds for a training.
pub(super) enum Claim {
    Begin,
    /// A part of this training.
    Resume(Box<Checkpoint>),
    /// Its end: the manifest.
    Done(Value),
}

/// What training took until a checkpoint, in all runs.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Spent {
    pub(super) seconds: f64,
    /// Of the iterations on the whole clip.
    pub(super) fine: Effort,
}

impl Spent {
    /// What a checkpoint says of it.
    pub(super) fn of(checkpoint: &Checkpoint) -> Self {
        let spent = checkpoint.training.values.get(SPENT).cloned().unwrap_or_default();
        serde_json::from_value(spent).unwrap_or_default()
    }
}

/// `<work>/<profile>/<scene>/splats`.
pub(super) struct SplatsFolder(pub(super) PathBuf);

impl SplatsFolder {
    /// The right to write into it. Its card is not replaced unless it is read first, and the numbers are in files that are
    /// called by their digest.
    pub(super) fn take(&self, overwrite: bool) -> Result<store::Claim> {
        let earlier = Earlier { file: own::CARD, says: own::SCHEMA };
        Ok(store::Claim::take(&self.0, vec![MANIFEST.to_owned()], Some(earlier), overwrite)?)
    }

    /// Looks whether this training has been here. What belongs to another one is refused, unless it may go.
    pub(super) fn claim(&self, origin: &Origin, overwrite: bool) -> Result<Claim> {
        let manifest = self.0.join(MANIFEST);
        if overwrite || !self.0.join(own::CARD).exists() {
            return match std::fs::remove_file(&manifest) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    Err(DataError::io(&manifest, "remove", source).into())
                }
                _ => Ok(Claim::Begin),
            };
        }
        let checkpoint = own::read(&self.0)?;
        let before = checkpoint.training.values.get("origin").cloned().unwrap_or_default();
        let saw_other = checkpoint.saw_depth.filter(|saw_depth| *saw_depth != origin.saw_depth);
        let difference = match saw_other {
            Some(true) => Some("it was shown depth".to_owned()),
            Some(false) => Some("it was not shown depth".to_owned()),
            None => difference(&before, &checkpoint.inputs, origin)?,
        };
        if let Some(difference) = difference {
            return Err(StageError::new(
                format!("{}: holds another model: {difference}", self.0.display()),
                "say --force to replace it, or choose another --out",
            ));
        }
        let is_done = checkpoint.training.values.get("done") == Some(&Value::Bool(true));
        Ok(match is_done {
            true if manifest.exists() => Claim::Done(json::read(&manifest)?),
            // Killed between the two: the last steps are gone, but nothing else is.
            true => Claim::Begin,
            false => Claim::Resume(Box::new(checkpoint)),
        })
    }

    /// Writes what training needs to go on.
    pub(super) fn save(&self, trainer: &Trainer<'_>, origin: &Origin, spent: Spent) -> Result<()> {
        let mut checkpoint = trainer.checkpoint();
        name(&mut checkpoint, origin, false)?;
        checkpoint.training.values.insert(SPENT.to_owned(), json!(spent));
        Ok(own::write(&self.0, &checkpoint)?)
    }

    /// Writes the finished model and its manifest, which is returned.
    pub(super) fn settle(&self, trainer: &Trainer<'_>, origin: &Origin, report: &Report) -> Result<Value> {
        let manifest = Manifest { schema: SCHEMA, origin, report };
        json::write(&self.0.join(MANIFEST), &manifest)?;
        let (model, iteration) = (trainer.model().clone(), trainer.iteration());
        let mut checkpoint = Checkpoint { model, iteration, ..Checkpoint::default() };
        name(&mut checkpoint, origin, true)?;
        own::write(&self.0, &checkpoint)?;
        serde_json::to_value(manifest).map_err(plain)
    }
}

fn name(checkpoint: &mut Checkpoint, origin: &Origin, done: bool) -> Result<()> {
    checkpoint.scene = Some(origin.scene.clone());
    checkpoint.profile = Some(origin.profile);
    checkpoint.sampling = origin.sampling;
    checkpoint.saw_depth = Some(origin.saw_depth);
    checkpoint.inputs.clone_from(&origin.trained_on);
    let values = &mut checkpoint.training.values;
    values.insert("origin".to_owned(), short(origin)?);
    values.insert("done".to_owned(), done.into());
    Ok(())
}

/// The origin without what a checkpoint says elsewhere.
fn short(origin: &Origin) -> Result<Value> {
    let mut value = serde_json::to_value(origin).map_err(plain)?;
    if let Some(fields) = value.as_object_mut() {
        for elsewhere in ["trained_on", "compared_with", "saw_depth", "track"] {
            fields.remove(elsewhere);
        }
    }
    Ok(value)
}

/// In what a checkpoint's origin is another one, in words.
fn difference(before: &Value, inputs: &Digests, origin: &Origin) -> Result<Option<String>> {
    let now = short(origin)?;
    // Settings one by one, beside everything else.
    let flat = |value: &Value| {
        let mut fields = value.as_object().cloned().unwrap_or_default();
        let settings = fields.remove("settings").unwrap_or_default();
        fields.extend(settings.as_object().cloned().unwrap_or_default());
        fields
    };
    let before = flat(before);
    for (key, value) in flat(&now) {
        if before.get(&key) != Some(&value) {
            let was = before.get(&key).map_or_else(|| "unknown".to_owned(), Value::to_string);
            return Ok(Some(format!("`{key}` was {was} and is {value} now")));
        }
    }
    let changed = origin.trained_on.iter().find(|(path, digest)| inputs.get(*path) != Some(*digest));
    Ok(changed
        .map(|(path, _)| format!("{path} has changed since"))
        .or_else(|| (inputs.len() != origin.trained_on.len()).then(|| "it had other pictures".to_owned())))
}
