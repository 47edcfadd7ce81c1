//! `l4d init-results`: the folder of a method, before it has answers.

use std::path::Path;

use anyhow::Result;
use l4d_data::json::indented;
use l4d_data::layout::ResultsDir;
use l4d_data::results::{MethodCard, Used};
use l4d_data::store::{make_folder, write_unless_held};
use l4d_data::{Benchmark, Name};

use crate::cli::judging::InitResultsArgs;
use crate::out::{ExitStatus, Printer};
use crate::{readmes, shipped};

pub(crate) fn run(args: &InitResultsArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(&args.name)?;
    let bench = Benchmark::open(&args.bench)?;
    let profile = args.profile;
    let truth_digest = bench.truth_digest(profile)?;
    let version = &bench.manifest.version;
    let card = MethodCard {
        link: args.link.clone(),
        used: Used {
            ground_truth: args.used_truth,
            test_view: args.used_test_view,
            depth: args.used_depth,
            ..Used::default()
        },
        seconds: args.seconds,
        ..MethodCard::new(name, &args.method_version, version, truth_digest, profile)
    };
    let dir = ResultsDir::new(args.results.join(&args.name));
    let bytes = indented(&dir.card(), &card)?;
    write_unless_held(&dir.card(), &bytes, args.force, "pass --force to replace it, or choose another name")?;
    make_folder(&dir.masks())?;
    out.data(dir.root().display())?;
    out.note(format!(
        "write {}/<scene>/<number>.json, or a folder of PNG pictures of that name, for each line of {}/<scene>.jsonl (docs/formats.md)",
        dir.masks().display(),
        args.bench.join("queries").display()
    ));
    let bench = if args.bench == Path::new(shipped::benchmark()) {
        String::new()
    } else {
        format!(" --bench {}", args.bench.display())
    };
    readmes::leave(&args.results, readmes::RESULTS)?;
    out.note(format!("then run `l4d check-results {} --profile {profile}{bench}`", dir.root().display()));
    Ok(ExitStatus::Success)
}
