//! `l4d propose-prompts`: a vision model looks at clips and proposes queries; what is proved becomes a candidate.

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::layout::SceneDir;
use l4d_data::{Benchmark, Name, Report};
use l4d_endpoint::{Budget, CacheUse, Client, Endpoint, Plan, Spent};
use l4d_propose::Manner;
use l4d_propose::printable;
use l4d_propose::queries::{Asking, SceneOutcome};
use l4d_query::prove::Vocabulary;
use serde_json::json;

use super::build_scenes::data_folder;
use super::estimate;
use crate::cli::models::{AskArgs, ProposePromptsArgs, ServerArgs};
use crate::out::{ExitStatus, Printer, refusal};
use crate::side_by_side::side_by_side;

pub(crate) fn run(args: &ProposePromptsArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let profile = args.bench.profile;
    let data = data_folder(args.data.as_deref(), profile, bench.manifest.draw());
    let scenes = chosen_scenes(args, &bench, &data, out)?;
    let vocabulary = Vocabulary::read(&bench.dir.vocabulary())?;
    let client = open_client(&args.ask.server)?;
    let folder: PathBuf =
        args.out.clone().unwrap_or_else(|| Path::new("work").join(profile.as_str()).join("proposals"));
    let asking = Asking {
        bench: &bench,
        profile,
        data: &data,
        out: &folder,
        vocabulary: vocabulary.as_ref(),
        per_category: args.per_category,
        frames: args.frames as usize,
        training_views: args.training_views as usize,
        width_px: args.width,
        manner: manner(&args.ask),
        force: args.force,
    };
    if args.ask.dry_run {
        return plan(&asking, &scenes, &client, args, out);
    }
    let (outcomes, report) = propose_all(&asking, &scenes, &client, args.jobs as usize, out)?;
    if args.json {
        let failed = report.has_errors();
        out.json(&json!({
            "profile": profile,
            "out": folder,
            "endpoint": about(client.endpoint()),
            "scenes": outcomes,
            "spent": client.spent(),
            "findings": report.into_sorted(),
        }))?;
        return Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success });
    }
    print(&outcomes, out)?;
    for outcome in &outcomes {
        for note in &outcome.notes {
            out.warn(format!("{}: {}", outcome.scene, printable(note)));
        }
    }
    note_spent(&client.spent(), out);
    if outcomes.iter().any(|outcome| outcome.answer.is_some()) {
        out.note(format!("proposals stand in {}; none of them is part of the benchmark", folder.display()));
    }
    match report.is_empty() {
        true => Ok(ExitStatus::Success),
        false => out.findings(report, false),
    }
}

/// A client for the endpoint, with cache and budget as asked for.
pub(crate) fn open_client(args: &ServerArgs) -> Result<Client> {
    let endpoint = args.endpoint.resolve()?;
    let cache = if args.refresh { CacheUse::Refresh } else { CacheUse::Take };
    let budget = Budget { max_tokens_total: args.max_tokens_total, max_cost: args.max_cost };
    let client = Client::open(endpoint, &args.endpoint.link)?;
    Ok(client.with_cache(&args.cache, cache).with_budget(budget)?)
}

/// How questions are asked.
pub(super) fn manner(args: &AskArgs) -> Manner {
    Manner { repeat: args.repeat, answer_tokens: args.answer_tokens }
}

/// Whom it was about, without anything secret.
pub(super) fn about(endpoint: &Endpoint) -> serde_json::Value {
    json!({ "model": endpoint.model, "base_url": endpoint.base_url.as_str() })
}

/// What was spent, in one line of talk.
pub(super) fn note_spent(spent: &Spent, out: &Printer) {
    let cost = spent.cost.map_or_else(String::new, |cost| format!(", cost {cost:.4}"));
    let Spent { answers, kept, tokens, .. } = spent;
    out.note(format!(
        "{answers} answers of the server, {kept} kept ones; {} + {} tokens{cost}",
        tokens.prompt, tokens.completion
    ));
}

/// The scenes of the selection and shard that have been rendered.
fn chosen_scenes(
    args: &ProposePromptsArgs,
    bench: &Benchmark,
    data: &Path,
    out: &Printer,
) -> Result<Vec<Name>> {
    let mut chosen = bench.select(&args.bench.scenes)?;
    if let Some(shard) = args.shard {
        shard.keep(&mut chosen);
    }
    let is_rendered = |name: &Name| SceneDir::new(data, name).scene().is_file();
    let (rendered, missing): (Vec<Name>, Vec<Name>) = chosen.into_iter().partition(is_rendered);
    let hint =
        || format!("run `l4d build-scenes --profile {}` first, or choose another --data", args.bench.profile);
    match missing.first() {
        Some(scene) if !args.bench.scenes.is_empty() => {
            Err(refusal(format!("{scene} is not rendered in {}", data.display()), hint()))
        }
        Some(scene) if rendered.is_empty() => {
            let message = format!("no scene is rendered in {}, {scene} for one", data.display());
            Err(refusal(message, hint()))
        }
        Some(_) => {
            out.note(format!("not rendered, so not asked about: {} scenes", missing.len()));
            Ok(rendered)
        }
        None => Ok(rendered),
    }
}

/// Asks about all scenes, `jobs` at once; the order of the outcomes is that of the scenes.
fn propose_all(
    asking: &Asking<'_>,
    scenes: &[Name],
    client: &Client,
    jobs: usize,
    out: &Printer,
) -> Result<(Vec<SceneOutcome>, Report)> {
    let bar = out.bar(scenes.len() as u64, "asking");
    let done = side_by_side(scenes, jobs, |scene| {
        let mut report = Report::default();
        let outcome = asking.propose(scene, client, &mut report);
        bar.inc(1);
        Ok((outcome, report))
    });
    bar.finish_and_clear();
    let mut all = Report::default();
    let outcomes = done?.into_iter().map(|(outcome, report)| {
        all.extend(report);
        outcome
    });
    Ok((outcomes.collect(), all))
}

fn print(outcomes: &[SceneOutcome], out: &Printer) -> Result<()> {
    let width = outcomes.iter().map(|outcome| outcome.scene.len()).max().unwrap_or(0).max("scene".len());
    let columns = ["proposed", "candidates", "unproved", "failed"];
    let header: String = columns.iter().map(|column| format!("{column:>12}")).collect();
    out.data(format!("{:width$}  {:<10}{header}  why", "scene", "answer"))?;
    let row = |name: &str, answer: &str, counts: [usize; 4], why: String| {
        let counts: String = counts.iter().map(|count| format!("{count:>12}")).collect();
        out.data(format!("{name:width$}  {answer:<10}{counts}  {why}").trim_end())
    };
    for outcome in outcomes {
        let why: Vec<String> =
            outcome.reasons.iter().map(|(code, count)| format!("{code} x{count}")).collect();
        row(&outcome.scene, outcome.answer.unwrap_or("none"), counts(outcome), why.join(" "))?;
    }
    if outcomes.len() > 1 {
        let total = outcomes.iter().map(counts).fold([0; 4], |sum, counts| {
            let mut sum = sum;
            sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
            sum
        });
        row("all", "", total, String::new())?;
    }
    Ok(())
}

fn counts(outcome: &SceneOutcome) -> [usize; 4] {
    [outcome.proposed, outcome.candidates, outcome.unproved, outcome.failed]
}

/// What would be asked and what it may cost; nothing is sent.
fn plan(
    asking: &Asking<'_>,
    scenes: &[Name],
    client: &Client,
    args: &ProposePromptsArgs,
    out: &Printer,
) -> Result<ExitStatus> {
    let mut report = Report::default();
    let plans: Vec<(String, Plan)> = scenes
        .iter()
        .filter_map(|scene| Some((scene.to_string(), asking.plan(scene, client, &mut report)?)))
        .collect();
    estimate::print("scene", &plans, client.endpoint(), args.json, report, out)
}
