//! `l4d arrange`.

use anyhow::Result;
use l4d_blender::arrange::{ArrangeOptions, arrange};
use l4d_blender::env::BlenderEnv;
use l4d_compose::wish::FIRST_TRAINING_SEED;
use serde_json::json;

use crate::cli::scenes::ArrangeArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &ArrangeArgs, out: &Printer) -> Result<ExitStatus> {
    if args.seed < FIRST_TRAINING_SEED {
        return Err(refusal(
            format!("--seed {} is below {FIRST_TRAINING_SEED}, where training seeds begin", args.seed),
            "arrangements are for learning: take a higher seed",
        ));
    }
    let choice = args.python.choice();
    let env = BlenderEnv::find_or_make(&choice, out)?;
    let options = ArrangeOptions {
        first: args.seed,
        count: args.count,
        views: args.view_count,
        samples: args.samples,
        out: &args.out,
        work: &choice.work,
        jobs: args.jobs,
    };
    let arranged = arrange(&env, &options, out)?;
    if args.json {
        out.json(&json!({ "out": args.out, "made": arranged.made, "kept": arranged.kept }))?;
    } else {
        let (made, kept) = (arranged.made, arranged.kept);
        out.data(format!("{made} seeds arranged, {kept} were there, in {}", args.out.display()))?;
    }
    Ok(ExitStatus::Success)
}
