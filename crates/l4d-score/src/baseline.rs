//! Baselines that bracket the scale: made from the truth and a seed, to show what the metrics can and cannot tell
//! apart.

use std::fs;
use std::path::Path;

use l4d_data::digest::sha256;
use l4d_data::layout::ResultsDir;
use l4d_data::results::{MaskFile, MethodCard, Used};
use l4d_data::scene::Role;
use l4d_data::store::{holds, write_unless_held};
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name, Query, Temporal};
use l4d_masks::Mask;
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Deserialize;

use crate::eval_set::EvalSet;
use crate::truth::SceneTruth;

/// A way to answer every query without looking at a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Baseline {
    /// The truth itself.
    Oracle,
    None,
    /// Every pixel of every frame.
    All,
    /// The right instances in all frames: right about what, blind to when.
    TimeAgnostic,
    /// As many random objects of the referents' categories as are meant, while the query holds: right about when,
    /// guessing what.
    RandomLookAlike,
    /// All objects of the referents' categories, while the query holds.
    LookAlikeUnion,
}

impl Baseline {
    /// All baselines, best first.
    pub const ALL: [Self; 6] = [
        Self::Oracle,
        Self::TimeAgnostic,
        Self::LookAlikeUnion,
        Self::RandomLookAlike,
        Self::All,
        Self::None,
    ];

    /// Name of the baseline and of its folder.
    pub fn as_str(self) -> &'static str {
        self.into()
    }

    /// Whether a name is that of a baseline. No method may compete under it: cards of versions before the field
    /// `baseline` say by their name alone what they are.
    pub fn is_name_of_one(name: &Name) -> bool {
        Self::ALL.iter().any(|baseline| baseline.as_str() == name.as_str())
    }

    fn uses_truth(self) -> bool {
        !matches!(self, Self::None | Self::All)
    }
}

/// What [`write_baseline`] found and did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Written {
    pub new: usize,
    /// Files that stood there already with the same bytes.
    pub kept: usize,
}

/// Writes the results of a baseline to `<results>/<name>/`. Files with the right bytes are kept, so that a killed
/// run is finished by the next; other bytes are replaced only if `force` is set.
///
/// # Errors
/// Truth that is damaged, files of other content without `force`, and what the disk refuses.
pub fn write_baseline(
    baseline: Baseline,
    eval_set: &EvalSet,
    seed: u64,
    results: &Path,
    force: bool,
) -> Result<Written, DataError> {
    let dir = ResultsDir::new(results.join(baseline.as_str()));
    let card = card(baseline, eval_set);
    let card_bytes = line(serde_json::to_string_pretty(&card));
    let is_current = is_current(&dir.card(), &card_bytes, force)?;
    if !is_current && dir.card().exists() {
        // Until the last mask is written, the folder must not look like results of either kind.
        fs::remove_file(dir.card()).map_err(|source| DataError::io(&dir.card(), "replace", source))?;
    }
    let mut written = Written::default();
    for scene in &eval_set.scenes {
        let truth = eval_set.truth(scene);
        let write = |query: &Query| {
            let referents = truth.referents(query, &scene.queries_path)?;
            let file = answer(baseline, &truth, query, &referents, &scene.clip, seed);
            let path = dir.mask_file(&query.id);
            write_unless_current(&path, &line(serde_json::to_string(&file)), force)
        };
        let states = scene.queries.par_iter().map(write).collect::<Result<Vec<bool>, DataError>>()?;
        let new = states.iter().filter(|is_new| **is_new).count();
        written.new += new;
        written.kept += states.len() - new;
    }
    let is_new = write_unless_current(&dir.card(), &card_bytes, force)?;
    written.new += usize::from(is_new);
    written.kept += usize::from(!is_new);
    Ok(written)
}

fn card(baseline: Baseline, eval_set: &EvalSet) -> MethodCard {
    let name = Name::new(baseline.as_str()).expect("names of baselines are names");
    let (version, used) =
        (&eval_set.bench.manifest.version, Used { ground_truth: baseline.uses_truth(), ..Used::default() });
    let card =
        MethodCard::new(name, env!("CARGO_PKG_VERSION"), version, &eval_set.truth_digest, eval_set.profile);
    MethodCard { used, baseline: true, ..card }
}

fn answer(
    baseline: Baseline,
    truth: &SceneTruth,
    query: &Query,
    referents: &[usize],
    clip: &[u32],
    seed: u64,
) -> MaskFile {
    let (width, height) = (truth.width, truth.height);
    let chosen = match baseline {
        Baseline::Oracle | Baseline::TimeAgnostic => referents.to_vec(),
        Baseline::None | Baseline::All => Vec::new(),
        Baseline::LookAlikeUnion => look_alikes(truth, referents),
        Baseline::RandomLookAlike => {
            let mut alike = look_alikes(truth, referents);
            let wanted = referents.len().min(alike.len());
            alike.partial_shuffle(&mut random_of(seed, query), wanted).0.to_vec()
        }
    };
    let is_gated = baseline != Baseline::TimeAgnostic && query.temporal == Temporal::While;
    let encode = |frame: u32| match baseline {
        Baseline::None => None,
        Baseline::All => Some(Mask::full(width, height).to_rle()),
        _ if is_gated && !query.holds_at(frame) => None,
        _ => truth.union(&chosen, truth.position(frame)?).map(|union| union.rle().clone()),
    };
    let frames = clip.iter().map(|&frame| (frame_key(frame), encode(frame))).collect();
    MaskFile { size: [height, width], frames }
}

/// Objects of the categories that the referents have, the referents among them.
fn look_alikes(truth: &SceneTruth, referents: &[usize]) -> Vec<usize> {
    let is_alike = |index: &usize| {
        let instance = &truth.instances[*index];
        let alike = referents.iter().any(|&referent| truth.instances[referent].category == instance.category);
        alike && instance.role == Role::Object
    };
    (0..truth.instances.len()).filter(is_alike).collect()
}

/// A generator of the query's own, so that no choice depends on the order or number of the others.
fn random_of(seed: u64, query: &Query) -> ChaCha8Rng {
    ChaCha8Rng::from_seed(sha256(format!("{seed}/{}", query.id).as_bytes()))
}

fn line(text: serde_json::Result<String>) -> Vec<u8> {
    (text.expect("strings and numbers serialise") + "\n").into_bytes()
}

const HINT: &str =
    "it may be of another seed, profile or version: pass --force to replace it, or another --results";

/// Whether the file is there with these bytes; other bytes are an error unless they may be replaced.
fn is_current(path: &Path, bytes: &[u8], force: bool) -> Result<bool, DataError> {
    holds(path, bytes, force, HINT)
}

fn write_unless_current(path: &Path, bytes: &[u8], force: bool) -> Result<bool, DataError> {
    write_unless_held(path, bytes, force, HINT)
}
