//! `l4d propose-prompts`: a vision model looks at clips and proposes queries; what is proved becomes a candidate.

use std::path::PathBuf;

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_data::parallel::in_parallel;
use l4d_data::{Benchmark, Name, Report, Workspace, counted};
use l4d_endpoint::{Client, Plan};
use l4d_propose::queries::{QueryProposer, SceneOutcome};
use l4d_query::prove::Vocabulary;
use serde_json::json;

use crate::cli::models::ProposePromptsArgs;
use crate::models::{about, manner, note_spent, open_client, print_estimate};
use crate::out::{ExitStatus, Printer, refusal, table};

pub(crate) fn run(args: &ProposePromptsArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let profile = args.bench.profile;
    let space = Workspace::new(profile).with_data(args.data.as_deref());
    let scenes = chosen_scenes(args, &bench, &space, out)?;
    let vocabulary = Vocabulary::read(&bench.dir.vocabulary())?;
    let client = open_client(&args.ask.server)?;
    let folder: PathBuf = args.out.clone().unwrap_or_else(|| space.proposals());
    let asking = QueryProposer {
        bench: &bench,
        profile,
        data: space.data(),
        out: &folder,
        vocabulary: vocabulary.as_ref(),
        per_category: args.per_category,
        frames: args.frames as usize,
        training_views: args.view_count as usize,
        width_px: args.width,
        manner: manner(&args.ask),
        force: args.force,
    };
    if args.ask.dry_run {
        return plan(&asking, &scenes, &client, args, out);
    }
    let (outcomes, report) = propose_all(&asking, &scenes, &client, args.jobs as usize, out)?;
    if args.json {
        let document = json!({
            "profile": profile,
            "out": folder,
            "endpoint": about(client.endpoint()),
            "scenes": outcomes,
            "spent": client.spent(),
        });
        return out.document(document, report);
    }
    print(&outcomes, out)?;
    for outcome in &outcomes {
        for note in &outcome.asked.notes {
            out.warn(format!("{}: {}", outcome.scene, note));
        }
    }
    note_spent(&client.spent(), out);
    if outcomes.iter().any(|outcome| outcome.asked.answer.is_some()) {
        out.note(format!("proposals are in {}; none of them is part of the benchmark", folder.display()));
    }
    out.any_findings(report)
}

/// The scenes of the selection and shard that have been rendered.
fn chosen_scenes(
    args: &ProposePromptsArgs,
    bench: &Benchmark,
    space: &Workspace,
    out: &Printer,
) -> Result<Vec<Name>> {
    let mut chosen = bench.select(&args.bench.scenes)?;
    if let Some(shard) = args.shard {
        shard.keep(&mut chosen);
    }
    let is_rendered = |name: &Name| space.scene(name).scene().is_file();
    let (rendered, missing): (Vec<Name>, Vec<Name>) = chosen.into_iter().partition(is_rendered);
    let data = space.data().display();
    match missing.first() {
        Some(scene) if rendered.is_empty() || !args.bench.scenes.is_empty() => {
            Err(refusal(format!("{scene} is not rendered in {data}"), args.bench.build_hint()))
        }
        Some(_) => {
            out.note(format!("not rendered, so not asked about: {}", counted(missing.len(), "scene")));
            Ok(rendered)
        }
        None => Ok(rendered),
    }
}

/// Asks about all scenes, `jobs` at once; the order of the outcomes is that of the scenes.
fn propose_all(
    asking: &QueryProposer<'_>,
    scenes: &[Name],
    client: &Client,
    jobs: usize,
    out: &Printer,
) -> Result<(Vec<SceneOutcome>, Report)> {
    out.start("asking", scenes.len() as u64);
    let done = in_parallel(scenes, jobs, |scene| {
        let mut report = Report::default();
        let outcome = asking.propose(scene, client, &mut report);
        out.advance(1);
        Ok::<_, anyhow::Error>((outcome, report))
    });
    out.finish();
    let mut all = Report::default();
    let outcomes = done?.into_iter().map(|(outcome, report)| {
        all.extend(report);
        outcome
    });
    Ok((outcomes.collect(), all))
}

fn print(outcomes: &[SceneOutcome], out: &Printer) -> Result<()> {
    let head = ["scene", "answer", "proposed", "candidates", "unproved", "failed", "why"];
    let row = |outcome: &SceneOutcome| {
        let SceneOutcome { scene, asked, candidates, unproved, .. } = outcome;
        let why: Vec<String> = asked.reasons.iter().map(|(code, count)| format!("{code} x{count}")).collect();
        let counts = [&asked.proposed, candidates, unproved, &asked.failed].map(|count| count.to_string());
        let start = [scene.to_string(), asked.answer.unwrap_or("none").to_owned()].into_iter();
        start.chain(counts).chain([why.join(" ")]).collect::<Vec<String>>()
    };
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(outcomes.iter().map(row));
    Ok(out.data(table(&rows))?)
}

/// What would be asked and what it may cost; nothing is sent.
fn plan(
    asking: &QueryProposer<'_>,
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
    print_estimate("scene", &plans, client.endpoint(), args.json, report, out)
}
