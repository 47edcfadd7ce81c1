//! `l4d draw-variant`: the same scenes drawn anew, with the sentences that still mean one thing in them.
//!
//! Makes a benchmark folder of its own: manifest, tracks and queries. `build-scenes --bench` on it adds the truth.

use std::path::Path;

use anyhow::Result;
use l4d_blender::env::BlenderEnv;
use l4d_blender::plan::{Recipe, plan};
use l4d_data::benchmark::{Manifest, SetSplit};
use l4d_data::layout::BenchDir;
use l4d_data::store::write_atomic;
use l4d_data::tracks::Tracks;
use l4d_data::{Benchmark, Draw, Name, Query, Workspace};
use l4d_query::prove::{Kind, Prover};
use l4d_query::reground::{reground, stays_absent};
use serde::Serialize;
use serde_json::json;

use crate::cli::scenes::DrawVariantArgs;
use crate::out::{ExitStatus, Printer, refusal, table};

/// What became of the sentences of a scene.
#[derive(Debug, Default, Serialize)]
struct Outcome {
    scene: String,
    asked: usize,
    grounded: usize,
    ungrounded: Vec<Ungrounded>,
}

#[derive(Debug, Serialize)]
struct Ungrounded {
    query: String,
    text: String,
    why: String,
}

pub(crate) fn run(args: &DrawVariantArgs, out: &Printer) -> Result<ExitStatus> {
    let source = Benchmark::open(&args.bench.bench)?;
    let scenes = source.select(&args.bench.scenes)?;
    let draw = Draw { variant: args.variant, seed: args.seed };
    if draw == source.manifest.draw() {
        return Err(refusal(
            format!("{} is this draw already", source.root().display()),
            "choose another variant or --seed".to_owned(),
        ));
    }
    let target = BenchDir::new(&args.out);
    claim(&target, &source, draw, args.force)?;
    let env = BlenderEnv::find_or_make(&args.python.choice(), out)?;
    let space = Workspace::new(args.bench.profile, draw).with_data(args.data.as_deref());
    let mut outcomes = Vec::new();
    for name in &scenes {
        out.note(format!("planning {name}, variant {}", draw.variant));
        let plan = plan(
            &env,
            &space.scene(name),
            &Recipe::of(&target, name, draw)?,
            &args.python.choice().work,
            out,
        )?;
        l4d_data::json::write_compact(&target.tracks(name), &plan.tracks)?;
        outcomes.push(carry_over(&source, &target, name, &plan.tracks)?);
    }
    let manifest = manifest(&source, args.split, draw, scenes);
    let heading = format!("Drawn from {} {} by `l4d draw-variant`.", manifest.name, manifest.version);
    write_atomic(&target.manifest(), manifest.to_toml(&heading)?.as_bytes())?;
    print(&outcomes, args, out)?;
    Ok(ExitStatus::Success)
}

/// Refuses to write into a folder that holds another set.
fn claim(target: &BenchDir, source: &Benchmark, draw: Draw, force: bool) -> Result<()> {
    let taken = |what: String| {
        refusal(
            format!("{} holds {what}", target.root().display()),
            "choose another --out, or replace it with --force".to_owned(),
        )
    };
    if target.root() == source.root() {
        return Err(taken("the benchmark that is drawn from".to_owned()));
    }
    match Benchmark::open(target.root()) {
        Ok(standing) if standing.manifest.draw() != draw && !force => {
            Err(taken(format!("variant {} (seed {})", standing.manifest.variant, standing.manifest.seed)))
        }
        _ => Ok(()),
    }
}

fn manifest(source: &Benchmark, split: SetSplit, draw: Draw, scenes: Vec<Name>) -> Manifest {
    Manifest { split, variant: draw.variant, seed: draw.seed, scenes, ..source.manifest.clone() }
}

/// Writes the queries of a scene that still mean one thing.
fn carry_over(source: &Benchmark, target: &BenchDir, scene: &Name, tracks: &Tracks) -> Result<Outcome> {
    let prover = Prover::new(tracks, None, None);
    let mut outcome = Outcome { scene: scene.to_string(), ..Outcome::default() };
    let mut ground = |kind: Kind, query: Query| {
        outcome.asked += 1;
        match reground(&prover, kind, &query) {
            Ok(query) => Some(query),
            Err(why) => {
                let Query { id, text, .. } = query;
                outcome.ungrounded.push(Ungrounded { query: id.to_string(), text, why });
                None
            }
        }
    };
    let mut all = |kind: Kind, queries: Vec<Query>| -> Vec<Query> {
        queries.into_iter().filter_map(|query| ground(kind, query)).collect()
    };
    let queries = all(Kind::Single, source.queries(scene)?);
    let composites = all(Kind::Composite, source.composites(scene)?);
    let absents = source.absents(scene)?.into_iter().filter(|query| stays_absent(&prover, query)).collect();
    outcome.grounded = queries.len() + composites.len();
    write_lines(&target.queries(scene), queries)?;
    write_lines(&target.composites(scene), composites)?;
    write_lines(&target.absents(scene), absents)?;
    Ok(outcome)
}

fn write_lines(path: &Path, queries: Vec<Query>) -> Result<()> {
    let lines: String = queries
        .iter()
        .map(|query| Ok(serde_json::to_string(query)? + "\n"))
        .collect::<Result<_, serde_json::Error>>()?;
    Ok(write_atomic(path, lines.as_bytes())?)
}

fn print(outcomes: &[Outcome], args: &DrawVariantArgs, out: &Printer) -> Result<()> {
    if args.json {
        return out.json(&json!({ "out": args.out, "variant": args.variant, "scenes": outcomes }));
    }
    let row = |outcome: &Outcome| {
        vec![outcome.scene.clone(), outcome.asked.to_string(), outcome.grounded.to_string()]
    };
    let mut rows = vec![["scene", "asked", "grounded"].map(str::to_owned).to_vec()];
    rows.extend(outcomes.iter().map(row));
    out.data(table(&rows))?;
    for Ungrounded { query, text, why } in outcomes.iter().flat_map(|outcome| &outcome.ungrounded) {
        out.data(format!("{query} \"{text}\" {why}"))?;
    }
    Ok(())
}
