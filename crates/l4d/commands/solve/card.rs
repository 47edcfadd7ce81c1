//! `method.json` of the solver's results.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};
use l4d_data::results::{MethodCard, Used};
use l4d_data::{Benchmark, Name, json};
use l4d_splat::source::Source;

use super::Run;
use super::ledger::Ledger;
use crate::cli::solver::GrounderArg;
use crate::out::{Printer, refusal};

/// Where the method comes from.
const LINK: &str = "https://arxiv.org/abs/2604.05638";
/// Protocol that the masks are made for.
const PROTOCOL: &str = "l4d";

/// A card that may stand in the folder.
pub(super) struct Card(MethodCard);

impl Card {
    /// Takes the folder for results of this method.
    pub(super) fn claim(run: &Run<'_>, bench: &Benchmark, out: &Printer) -> Result<Self> {
        let profile = run.args.bench.profile;
        // Where there is no truth, a run with the truth at hand says later which one it is.
        let truth_digest = bench.truth_digest_if_any(profile)?;
        let mut card = MethodCard {
            name: run.name.clone(),
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
                ground_truth: run.args.method.grounder == GrounderArg::Oracle,
                test_view: false,
                depth: saw_depth(run, bench, out)?,
                endpoints: run.grounders.endpoints(),
            },
            baseline: false,
            seconds: None,
            reported: BTreeMap::new(),
            import: None,
        };
        let path = run.results.card();
        if path.exists() && !run.args.overwrite {
            let mut before = MethodCard { seconds: None, ..MethodCard::read(&path)? };
            // What somebody wrote beside what a run knows stays.
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
                return Err(refusal(
                    format!("{}: holds results of another profile, version or benchmark", path.display()),
                    "give the method another --name or --results, or replace its answers with --overwrite",
                ));
            }
        }
        Ok(Self(card))
    }

    /// Writes it, with what the queries took that this run answered or found answered.
    pub(super) fn write(self, run: &Run<'_>, ledger: &Ledger) -> Result<()> {
        let card = MethodCard { seconds: Some(ledger.seconds()), ..self.0 };
        Ok(json::write(&run.results.card(), &card)?)
    }
}

/// Whether the method learned from rendered depth: its clips are drawn from models, so that it did if any of them did.
/// All scenes that were asked for count, whichever of them a shard answers: shards write one card.
fn saw_depth(run: &Run<'_>, bench: &Benchmark, out: &Printer) -> Result<bool> {
    if run.args.used_depth {
        return Ok(true);
    }
    let mut unknown: Vec<Name> = Vec::new();
    for scene in bench.select(&run.args.bench.scenes)? {
        let path = run.places(&scene).splats();
        // What is missing is refused when its scene is opened.
        if !path.exists() {
            continue;
        }
        match Source::saw_depth_of(&path).with_context(|| scene.to_string())? {
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
        out.note(format!(
            "it is not known whether the splats of {first}{more} saw rendered depth: method.json says that `used.depth` is \
             false; say --used-depth if they did"
        ));
    }
    Ok(false)
}
