//! `l4d quickstart`: the whole flow on one tiny scene, by calling the verbs that a user would call.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use clap::Parser as _;
use l4d_data::benchmark::Manifest;
use l4d_data::layout::BenchDir;
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{Benchmark, Name};

use crate::cli::{Cli, QuickstartArgs};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &QuickstartArgs, out: &Printer) -> Result<ExitStatus> {
    let started = Instant::now();
    let source = Benchmark::open(&args.bench)?;
    let scene = source.scene(&args.scene)?.clone();
    let bench = args.out.join("benchmark");
    copy_queries(&source, &scene, &BenchDir::new(&bench))?;
    for (what, verb) in steps(args, &scene, &bench) {
        let line: Vec<String> = std::iter::once("l4d".to_owned()).chain(verb).collect();
        out.note(format!("\n# {what}\n$ {}", line.join(" ")));
        let cli = Cli::try_parse_from(&line).context("a step of the quickstart does not parse")?;
        if super::run(&cli.command, out)? == ExitStatus::Findings {
            out.note("the step above reported findings; the quickstart stops here");
            return Ok(ExitStatus::Findings);
        }
    }
    let out_dir = args.out.display();
    out.note(format!("\ndone in {:.0} s. Where to look:", started.elapsed().as_secs_f64()));
    out.note(format!(
        "  {out_dir}/data/{scene}/sheet.png       what the cameras saw, with outlines and queries"
    ));
    out.note(format!(
        "  {out_dir}/work/tiny/{scene}/           the model, its clips, and what led to each answer"
    ));
    out.note(format!(
        "  {out_dir}/leaderboard/                 tables (CSV, Markdown) and figures (SVG, PNG)"
    ));
    out.note(format!("  {out_dir}/scores/<method>/counts.csv   the counts behind every number"));
    Ok(ExitStatus::Success)
}

/// What is done, in order: a sentence and the command line.
fn steps(args: &QuickstartArgs, scene: &Name, bench: &Path) -> Vec<(&'static str, Vec<String>)> {
    let text = |path: &Path| path.display().to_string();
    let data = text(&args.out.join("data"));
    let results = text(&args.out.join("results"));
    let scores = text(&args.out.join("scores"));
    let board = text(&args.out.join("leaderboard"));
    let common = |verb: &str, extra: &[&str]| -> Vec<String> {
        let head = [verb].into_iter().chain(extra.iter().copied()).map(str::to_owned);
        let tail = ["--bench".to_owned(), text(bench), "--profile".to_owned(), "tiny".to_owned()];
        head.chain(tail).collect()
    };
    let out_work = text(&args.out.join("work"));
    let scripts = text(&args.python.blender_scripts);
    let work = text(&args.python.work);
    let mut build = common(
        "build-scenes",
        &["--scenes", scene, "--data", &data, "--blender-scripts", &scripts, "--work", &work],
    );
    // The folder is the quickstart's own, so what an older version left there may go.
    build.extend(["--overwrite".to_owned(), "--update-benchmark".to_owned()]);
    if let Some(python) = &args.python.python {
        build.extend(["--python".to_owned(), text(python)]);
    }
    let train = common("train-splats", &[scene, "--data", &data, "--work", &out_work]);
    let solve =
        common("solve", &["--data", &data, "--work", &out_work, "--results", &results, "--overwrite"]);
    vec![
        ("Blender renders RGB, depth and instance ids from five cameras; one is held out", build),
        ("Cameras, depth and ids agree across views", common("check-scenes", &["--data", &data])),
        ("Each query has exactly one referent among look-alikes", common("check-queries", &[])),
        ("A picture of it all", common("sheet", &[scene, "--data", &data])),
        ("The training cameras become 4D Gaussians", train),
        ("PanopticQuery answers every sentence, without a model and without the truth", solve),
        ("Baselines that bracket the scale", common("baseline", &["--results", &results, "--force"])),
        ("Counts, then ratios", common("score", &[&results, "--scores", &scores])),
        ("Tables and figures", common("leaderboard", &[&scores, "--output", &board])),
    ]
}

/// A benchmark of one scene: the shipped queries; tracks and truth come from what is about to be rendered.
fn copy_queries(source: &Benchmark, scene: &Name, target: &BenchDir) -> Result<()> {
    let manifest = Manifest { scenes: vec![scene.clone()], ..source.manifest.clone() };
    write_atomic(&target.manifest(), toml::to_string(&manifest)?.as_bytes())?;
    let queries = read_bounded(&source.dir.queries(scene), l4d_data::json::MAX_BYTES)?;
    write_atomic(&target.queries(scene), &queries)?;
    Ok(())
}
