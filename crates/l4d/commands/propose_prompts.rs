//! `l4d propose-prompts`: a vision model looks at clips and proposes queries; what is proved becomes a candidate.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

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
use crate::cli::{AskArgs, ProposePromptsArgs, ServerArgs, Shard};
use crate::out::{ExitStatus, Printer, refusal};

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
    let (outcomes, report) = propose_all(&asking, &scenes, &client, args.jobs as usize, out);
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
    Ok(client.with_cache(&args.cache, cache)?.with_budget(budget)?)
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
    let chosen = of_shard(bench.select(&args.bench.scenes)?, args.shard);
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

/// Shard i of n has every n-th scene.
fn of_shard(scenes: Vec<Name>, shard: Option<Shard>) -> Vec<Name> {
    let Some(Shard { index, count }) = shard else { return scenes };
    scenes.into_iter().skip(index - 1).step_by(count).collect()
}

/// Asks about all scenes, `jobs` at once; the order of the outcomes is that of the scenes.
fn propose_all(
    asking: &Asking<'_>,
    scenes: &[Name],
    client: &Client,
    jobs: usize,
    out: &Printer,
) -> (Vec<SceneOutcome>, Report) {
    let bar = out.bar(scenes.len() as u64, "asking");
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let work = || {
        while let Some(scene) = scenes.get(next.fetch_add(1, Ordering::Relaxed)) {
            let mut report = Report::default();
            let outcome = asking.propose(scene, client, &mut report);
            done.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((outcome, report));
            bar.inc(1);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..jobs.min(scenes.len()) {
            scope.spawn(work);
        }
    });
    bar.finish_and_clear();
    let mut done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let place = |outcome: &SceneOutcome| scenes.iter().position(|scene| *scene == outcome.scene);
    done.sort_by_key(|(outcome, _)| place(outcome));
    let mut all = Report::default();
    let outcomes = done.into_iter().map(|(outcome, report)| {
        all.extend(report);
        outcome
    });
    (outcomes.collect(), all)
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
    print_plan("scene", &plans, client, args.json, report, out)
}

/// Prints a plan, one row a question.
pub(super) fn print_plan(
    what: &'static str,
    plans: &[(String, Plan)],
    client: &Client,
    as_json: bool,
    report: Report,
    out: &Printer,
) -> Result<ExitStatus> {
    let mut total = Plan::default();
    for (_, plan) in plans {
        total.questions += plan.questions;
        total.kept += plan.kept;
        total.images += plan.images;
        total.bytes += plan.bytes;
        total.tokens.prompt += plan.tokens.prompt;
        total.tokens.completion += plan.tokens.completion;
        total.cost = plan.cost.map(|cost| total.cost.unwrap_or(0.0) + cost);
    }
    if as_json {
        let failed = report.has_errors();
        let rows: Vec<_> = plans.iter().map(|(name, plan)| json!({ what: name, "plan": plan })).collect();
        out.json(&json!({
            "dry_run": true,
            "endpoint": about(client.endpoint()),
            "plans": rows,
            "total": total,
            "findings": report.into_sorted(),
        }))?;
        return Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success });
    }
    let width = plans.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max(what.len());
    out.data(format!(
        "{what:width$}{:>10}{:>10}{:>12}{:>16}{:>16}{:>12}",
        "kept", "pictures", "bytes", "question tokens", "answer tokens", "cost up to"
    ))?;
    let row = |name: &str, plan: &Plan| {
        let cost = plan.cost.map_or_else(|| "?".to_owned(), |cost| format!("{cost:.4}"));
        let Plan { kept, images, bytes, tokens, .. } = plan;
        let (prompt, completion) = (tokens.prompt, tokens.completion);
        out.data(format!(
            "{name:width$}{kept:>10}{images:>10}{bytes:>12}{prompt:>16}{completion:>16}{cost:>12}"
        ))
    };
    plans.iter().try_for_each(|(name, plan)| row(name, plan))?;
    row("all", &total)?;
    out.note("nothing was sent; tokens are estimates, those of answers the most that they may have");
    match report.is_empty() {
        true => Ok(ExitStatus::Success),
        false => out.findings(report, false),
    }
}
