//! `l4d compose`: new scenes with proved queries from seeds.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;
use l4d_blender::compose::{Rejection, Theme, reasons, themes};
use l4d_blender::env::BlenderEnv;
use l4d_compose::set::{Made, SetOrder, compose_set};
use l4d_compose::wish::{self, Ask, Secret};
use l4d_data::Benchmark;
use l4d_data::composition::Composition;
use l4d_data::layout::BenchDir;
use l4d_query::prove::words;
use serde_json::json;

use crate::cli::scenes::ComposeArgs;
use crate::out::{ExitStatus, Printer, table};
use crate::shipped;

pub(crate) fn run(args: &ComposeArgs, out: &Printer) -> Result<ExitStatus> {
    let choice = args.python.choice();
    let Some(folder) = &args.out else {
        let env = BlenderEnv::find_or_make(&choice, out)?;
        return list(&themes(&env, &choice.work)?, args, out);
    };
    shipped::require_own(folder)?;
    let secret = args.secret.as_deref().map(wish::read_secret).transpose()?;
    let wishes = wishes(args, secret.as_ref())?;
    let avoid = match &args.avoid {
        Some(bench) => sentences(bench)?,
        None => BTreeSet::new(),
    };
    let secret_digest = secret.as_ref().map(Secret::digest);
    let order = SetOrder {
        wishes: &wishes,
        out: &BenchDir::new(folder),
        split: args.split,
        secret_digest: secret_digest.as_deref(),
        force: args.force,
        draws: args.draws,
        avoid: &avoid,
        work: &choice.work,
        jobs: args.jobs,
    };
    let made = compose_set(&order, || BlenderEnv::find_or_make(&choice, out), out)?;
    print(&made, args, out)
}

/// What is asked for: the seeds, or the files of `--spec`, and on top what the options demand of every scene.
fn wishes(args: &ComposeArgs, secret: Option<&Secret>) -> Result<Vec<Composition>> {
    let ask = Ask {
        split: args.split,
        first: args.seed,
        count: args.count,
        scale: args.scale,
        specs: &args.spec,
        secret,
    };
    let mut wishes = ask.wishes()?;
    for wish in &mut wishes {
        wish.place = args.place.clone().or(wish.place.take());
        wish.theme = args.theme.clone().or(wish.theme.take());
        wish.categories.extend(args.categories.iter().cloned());
        wish.verbs.extend(args.verbs.iter().cloned());
    }
    Ok(wishes)
}

/// All sentences of a set, in the form that is compared.
fn sentences(bench: &Path) -> Result<BTreeSet<String>> {
    let bench = Benchmark::open(bench)?;
    let mut sentences = BTreeSet::new();
    for scene in &bench.manifest.scenes {
        for queries in [bench.queries(scene)?, bench.composites(scene)?, bench.absents(scene)?] {
            sentences.extend(queries.iter().map(|query| words(&query.text).join(" ")));
        }
    }
    Ok(sentences)
}

fn list(themes: &[Theme], args: &ComposeArgs, out: &Printer) -> Result<ExitStatus> {
    if args.json {
        out.json(&json!({ "themes": themes }))?;
        return Ok(ExitStatus::Success);
    }
    for theme in themes {
        out.data(format!("{} {}", theme.scale, theme.name))?;
        for (what, words) in
            [("places", &theme.places), ("categories", &theme.categories), ("verbs", &theme.verbs)]
        {
            out.data(format!("    {what}: {}", words.join(", ")))?;
        }
    }
    Ok(ExitStatus::Success)
}

fn print(made: &[Made], args: &ComposeArgs, out: &Printer) -> Result<ExitStatus> {
    let rejected: Vec<&Rejection> = made.iter().flat_map(|made| &made.rejected).collect();
    let composed = made.iter().filter(|made| made.is_new).count();
    let reasons = reasons(rejected.iter().copied());
    if args.json {
        let reasons: Vec<_> =
            reasons.iter().map(|(reason, count)| json!({ "reason": reason, "draws": count })).collect();
        out.json(&json!({ "out": args.out, "composed": composed, "scenes": made, "rejected": reasons }))?;
        return Ok(ExitStatus::Success);
    }
    let heading = ["scene", "theme", "place", "queries", "composites", "absent", "thrown away"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(made.iter().map(|made| {
        let Composition { scene, theme, place, .. } = made.composition.clone();
        let mut row = vec![scene.to_string(), theme.unwrap_or_default(), place.unwrap_or_default()];
        row.extend(made.queries.iter().map(usize::to_string));
        row.push(made.rejected.len().to_string());
        row
    }));
    out.data(table(&rows))?;
    if composed == 0 {
        out.note(format!("nothing was composed: all {} scenes were there", made.len()));
    }
    let draws = made.len() + rejected.len();
    out.note(format!("{} of {draws} draws were thrown away", rejected.len()));
    for (reason, count) in reasons.iter().take(8) {
        out.note(format!("    {count:>4}  {reason}"));
    }
    Ok(ExitStatus::Success)
}
