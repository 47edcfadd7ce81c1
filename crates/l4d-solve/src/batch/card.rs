//! `method.json` of the solver's results.

use std::collections::BTreeMap;

use l4d_data::results::{MethodCard, Used};
use l4d_data::{At as _, Benchmark, DataError, Name, Progress, StageError, json};
use l4d_splat::source::Source;

use super::{Batch, Ledger};

/// Where the method comes from.
const LINK: &str = "https://arxiv.org/abs/2604.05638";
/// Protocol that the masks are made for.
const PROTOCOL: &str = "l4d";

/// A card that may be in the folder.
pub(super) struct Card(MethodCard);

impl Card {
    /// Takes the folder for results of this method.
    pub(super) fn claim(
        batch: &Batch<'_>,
        bench: &Benchmark,
        selected: &[Name],
        progress: &dyn Progress,
    ) -> Result<Self, StageError> {
        let profile = batch.space.profile();
        // Where there is no truth, a run with the truth at hand says later which one it is.
        let truth_digest = bench.truth_digest_if_any(profile)?;
        let mut card = MethodCard {
            name: batch.name.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            link: LINK.to_owned(),
            benchmark_version: bench.manifest.version.clone(),
            truth_digest: truth_digest.clone().unwrap_or_default(),
            profile,
            width: profile.width(),
            height: profile.height(),
            frames: profile.frames().collect(),
            protocol: PROTOCOL.to_owned(),
            used: Used {
                ground_truth: batch.grounders.sees_truth(),
                test_view: false,
                depth: saw_depth(batch, selected, progress)?,
                endpoints: batch.grounders.endpoints(),
            },
            baseline: batch.control.is_some(),
            seconds: None,
            reported: BTreeMap::new(),
            import: None,
        };
        let path = batch.results_dir().card();
        if path.exists() && !batch.overwrite {
            let mut before = MethodCard { seconds: None, ..MethodCard::read(&path)? };
            // What was written by hand stays.
            card.reported.clone_from(&before.reported);
            // So does what an earlier run found of other scenes: some of its answers are still there.
            card.used.depth |= before.used.depth;
            before.used.depth = card.used.depth;
            match truth_digest {
                None => card.truth_digest.clone_from(&before.truth_digest),
                Some(digest) if before.truth_digest.is_empty() => before.truth_digest = digest,
                Some(_) => {}
            }
            if before != card {
                return Err(StageError::new(
                    format!("{}: holds results of another profile, version or benchmark", path.display()),
                    "give the method another --name or --results, or replace its answers with --force",
                ));
            }
        }
        Ok(Self(card))
    }

    /// Writes it, with what the queries took that this run answered or found answered.
    pub(super) fn write(self, batch: &Batch<'_>, ledger: &Ledger) -> Result<(), DataError> {
        let card = MethodCard { seconds: Some(ledger.seconds()), ..self.0 };
        json::write(&batch.results_dir().card(), &card)
    }
}

/// Whether the method learned from rendered depth: its clips are drawn from models, so that it did if any of them did.
/// All scenes that were asked for count, whichever of them a shard answers: shards write one card.
fn saw_depth(batch: &Batch<'_>, selected: &[Name], progress: &dyn Progress) -> Result<bool, StageError> {
    if batch.used_depth {
        return Ok(true);
    }
    let mut unknown: Vec<&Name> = Vec::new();
    for scene in selected {
        let path = batch.places(scene).splats();
        // What is missing is refused when its scene is opened.
        if !path.exists() {
            continue;
        }
        match Source::saw_depth_of(&path).at(scene)? {
            Some(true) => return Ok(true),
            Some(false) => {}
            None => unknown.push(scene),
        }
    }
    if let Some(first) = unknown.first() {
        let more = match unknown.len() {
            1 => String::new(),
            count => format!(" and {} more scenes", count - 1),
        };
        progress.note(&format_args!(
            "it is not known whether the splats of {first}{more} saw rendered depth: method.json says that `used.depth` is \
             false; say --used-depth if they did"
        ));
    }
    Ok(false)
}
