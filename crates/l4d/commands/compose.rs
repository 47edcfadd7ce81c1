//! `l4d compose`: new scenes with proved queries from seeds.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;
use l4d_blender::compose::{Rejection, Theme, reasons, themes};
use l4d_blender::env::BlenderEnv;
use l4d_compose::set::{Made, SetOrder, compose_set};
use l4d_compose::wish;
use l4d_data::benchmark::SetSplit;
use l4d_data::composition::Composition;
use l4d_data::layout::BenchDir;
use l4d_data::{Benchmark, Name, Scale};
use l4d_query::prove::words;
use serde_json::json;

use crate::cli::scenes::ComposeArgs;
use crate::out::{ExitStatus, Printer, refusal, table};

/// Seeds below are those of the development set.
const FIRST_TRAINING_SEED: u64 = 1000;

pub(crate) fn run(args: &ComposeArgs, out: &Printer) -> Result<ExitStatus> {
    let choice = args.python.choice();
    let Some(folder) = &args.out else {
        let env = BlenderEnv::find_or_make(&choice, out)?;
        return list(&themes(&env, &choice.work)?, args, out);
    };
    let wishes = wishes(args)?;
    let avoid = match &args.avoid {
        Some(bench) => sentences(bench)?,
        None => BTreeSet::new(),
    };
    let env = BlenderEnv::find_or_make(&choice, out)?;
    let order = SetOrder {
        wishes: &wishes,
        out: &BenchDir::new(folder),
        split: args.split,
        draws: args.draws,
        avoid: &avoid,
        work: &choice.work,
        jobs: args.jobs,
    };
    let made = compose_set(&env, &order, out)?;
    print(&made, args, out)
}

/// What is asked for: the seeds, or the files of `--spec`.
fn wishes(args: &ComposeArgs) -> Result<Vec<Composition>> {
    let secret = args.secret.as_deref().map(wish::read_secret).transpose()?;
    match (args.split, &secret) {
        (SetSplit::Private, None) => {
            return Err(refusal(
                "a private set needs a secret: its scenes are a function of it",
                "write 16 or more random bytes into a file (head -c 32 /dev/urandom > FILE) and name it with --secret",
            ));
        }
        (SetSplit::Train | SetSplit::Dev, Some(_)) => {
            return Err(refusal("--secret is for private sets", "add --split private"));
        }
        (SetSplit::Train, None) if args.seed < FIRST_TRAINING_SEED => {
            return Err(refusal(
                format!("seed {} belongs to the development set", args.seed),
                format!("training seeds begin with {FIRST_TRAINING_SEED}"),
            ));
        }
        (SetSplit::Dev, None) if args.seed + u64::from(args.count) > FIRST_TRAINING_SEED => {
            return Err(refusal(
                format!("seeds from {FIRST_TRAINING_SEED} on belong to training"),
                "a development set has lower ones",
            ));
        }
        _ => {}
    }
    let mut wishes = Vec::new();
    for path in &args.spec {
        wishes.push(wish::read(path, args.seed)?);
    }
    if args.spec.is_empty() {
        for place in args.seed..args.seed.saturating_add(args.count.into()) {
            let scale = args.scale.unwrap_or(Scale::ALL[(place % 3) as usize]);
            let (name, seed) = match &secret {
                Some(secret) => (format!("{}_p{place:04}", scale.as_str()), secret.seed(place)),
                None => (format!("{}_{place:04}", scale.as_str()), place),
            };
            wishes.push(Composition::of(Name::new(name)?, scale, seed));
        }
    }
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
    let reasons = reasons(rejected.iter().copied());
    if args.json {
        let reasons: Vec<_> =
            reasons.iter().map(|(reason, count)| json!({ "reason": reason, "draws": count })).collect();
        out.json(&json!({ "out": args.out, "scenes": made, "rejected": reasons }))?;
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
    let draws = made.len() + rejected.len();
    out.note(format!("{} of {draws} draws were thrown away", rejected.len()));
    for (reason, count) in reasons.iter().take(8) {
        out.note(format!("    {count:>4}  {reason}"));
    }
    Ok(ExitStatus::Success)
}
