//! `l4d quickstart`: the whole flow on one tiny scene, by calling the verbs that a user would call.

mod endings;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use l4d_data::benchmark::Manifest;
use l4d_data::error::inert;
use l4d_data::layout::{BenchDir, WorkDir};
use l4d_data::store::{Claim, list_folder, read_bounded, write_atomic};
use l4d_data::{Benchmark, DataError, Name, Profile, Report};
use l4d_score::{EvalSet, QuerySet};

use self::endings::{Ending, Why, endings};
use crate::cli::{Cli, Command, QuickstartArgs};
use crate::out::{ExitStatus, Printer, refusal};

/// The method that is ranked; what `solve` calls its results by default.
const METHOD: &str = "panopticquery-panoptic";
/// Sentences that the last lines propose to ask.
const PROPOSED: usize = 2;

pub(crate) fn run(
    args: &QuickstartArgs,
    run_verb: &dyn Fn(&Command) -> Result<ExitStatus>,
    out: &Printer,
) -> Result<ExitStatus> {
    let started = Instant::now();
    let source = Benchmark::open(&args.bench)?;
    let scene = source.scene(&args.scene)?.clone();
    let folder = args.out.as_path();
    let _claim = claim(folder, &scene)?;
    copy_queries(&source, &scene, &BenchDir::new(folder.join("benchmark")))?;
    for (what, verb) in steps(args, &scene, folder) {
        let line: Vec<String> = std::iter::once("l4d".to_owned()).chain(verb).collect();
        out.note(format!("\n# {what}\n$ {}", line.join(" ")));
        let (cli, _) = Cli::read(&line).context("a step of the quickstart does not parse")?;
        if run_verb(&cli.command)? == ExitStatus::Findings {
            out.note("the step above reported findings; the quickstart stops here");
            return Ok(ExitStatus::Findings);
        }
    }
    let mut report = Report::default();
    let bench = Benchmark::open(folder.join("benchmark"))?;
    let eval_set = EvalSet::open(bench, Profile::Tiny, QuerySet::default(), &[], &mut report)?;
    let work = WorkDir::new(&folder.join("work"), Profile::Tiny, &scene);
    let endings = endings(&eval_set, &scene, &Name::new(METHOD)?, &work, &folder.join("scores"))?;
    tell_endings(&endings, out);
    tell_what_is_next(&endings, &scene, folder, started.elapsed().as_secs_f64(), out);
    Ok(ExitStatus::Success)
}

/// Takes possession of a folder that is empty or of an earlier quickstart.
fn claim(folder: &Path, scene: &Name) -> Result<Claim> {
    let bench = BenchDir::new("benchmark");
    let [manifest, queries] = [bench.manifest(), bench.queries(scene)].map(|path| text(&path));
    if let Some(entry) = entries(folder)?.first()
        && !Claim::lists(folder, &manifest)
    {
        return Err(refusal(
            format!("{}: is not of a quickstart: `{}` is there", folder.display(), inert(entry)),
            "name an empty folder or one that is not there yet with --out",
        ));
    }
    let refuse =
        |error: DataError| refusal(error.to_string(), "move it away, or name another folder with --out");
    Claim::take(folder, vec![manifest, queries], None, false).map_err(refuse)
}

/// What is in the folder, if it is there.
fn entries(folder: &Path) -> Result<Vec<String>> {
    Ok(if folder.exists() { list_folder(folder)? } else { Vec::new() })
}

/// What is done, in order: a sentence and the command line.
fn steps(args: &QuickstartArgs, scene: &Name, folder: &Path) -> Vec<(&'static str, Vec<String>)> {
    let [bench, data, work, results, scores, board] =
        ["benchmark", "data", "work", "results", "scores", "leaderboard"]
            .map(|name| text(&folder.join(name)));
    let common = |verb: &str, extra: &[&str]| -> Vec<String> {
        let head = [verb].into_iter().chain(extra.iter().copied()).map(str::to_owned);
        let tail = ["--bench", &bench, "--profile", "tiny"].map(str::to_owned);
        head.chain(tail).collect()
    };
    let [scripts, blender] = [&args.python.blender_scripts, &args.python.work].map(|path| text(path));
    let mut build = common(
        "build-scenes",
        &["--scenes", scene, "--data", &data, "--blender-scripts", &scripts, "--work", &blender],
    );
    // The folder is the quickstart's own, so what an older version left there may go.
    build.extend(["--force".to_owned(), "--update-benchmark".to_owned()]);
    if let Some(python) = &args.python.python {
        build.extend(["--python".to_owned(), text(python)]);
    }
    let solve = |grounder: &str| {
        let folders = ["--data", &data, "--work", &work, "--results", &results];
        common("solve", &[&["--grounder", grounder][..], &folders, &["--force"]].concat())
    };
    vec![
        ("Blender renders RGB, depth and instance ids from five cameras; one is held out", build),
        ("Cameras, depth and ids agree across views", common("check-scenes", &["--data", &data])),
        ("Each query has exactly one referent among look-alikes", common("check-queries", &[])),
        ("A picture of it all", common("sheet", &[scene, "--data", &data])),
        (
            "Pictures of the training cameras become 4D Gaussians; rendered depth is not looked at",
            common("train-splats", &[scene, "--data", &data, "--work", &work]),
        ),
        (
            "PanopticQuery answers every sentence, without a downloaded model and without instance ids",
            solve("panoptic"),
        ),
        (
            "The same from the true masks of the training cameras: what a perfect grounder would reach",
            solve("oracle"),
        ),
        ("Baselines that bracket the scale", common("baseline", &["--results", &results, "--force"])),
        ("Counts, then ratios", common("score", &[&results, "--scores", &scores])),
        (
            "Tables, figures and a page",
            common(
                "leaderboard",
                &[&scores, "--out", &board, "--html", "--results", &results, "--data", &data],
            ),
        ),
    ]
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// Why each query ended as it did, a line each.
fn tell_endings(endings: &[Ending<'_>], out: &Printer) {
    out.note(format!("\n# How the {} queries ended for {METHOD}", endings.len()));
    for Ending { query, why, miou } in endings {
        let why = inert(&why.to_string());
        out.note(format!("  {:>5.1} IoU  {}: {why}", 100.0 * miou, query.text));
    }
    let right = endings.iter().filter(|ending| ending.why == Why::Right).count();
    out.note(format!(
        "  {right} of {} right; this grounder has a small network, which learned from composed scenes of the same assets",
        endings.len()
    ));
}

fn tell_what_is_next(endings: &[Ending<'_>], scene: &Name, folder: &Path, seconds: f64, out: &Printer) {
    let program = std::env::args().next().unwrap_or_else(|| "l4d".to_owned());
    out.note(format!("\ndone in {seconds:.0} s. Where to look:"));
    let places = [
        (
            folder.join("leaderboard/index.html"),
            "the page: ranking, queries, every mask; open it in a browser",
        ),
        (
            folder.join("data").join(scene.as_str()).join("sheet.png"),
            "what the cameras saw, with outlines and queries",
        ),
        (folder.join("work/tiny").join(scene.as_str()), "the model, its clips, and what led to each answer"),
    ];
    for (path, what) in places {
        out.note(format!("  {:<44} {what}", path.display()));
    }
    let proposed = proposals(endings);
    if !proposed.is_empty() {
        out.note("\nAsk it yourself; these are answered rightly:");
    }
    let [bench, data, work] = ["benchmark", "data", "work"].map(|name| text(&folder.join(name)));
    for query in proposed {
        out.note(format!(
            "  {program} query {scene} \"{}\" --profile tiny --bench {bench} --data {data} --work {work}",
            query.text
        ));
    }
    out.note("\nWhat to do next:");
    out.note(format!(
        "  score a method of your own       {program} init-results METHOD, then as in README.md; needs no render"
    ));
    out.note(format!(
        "  the scenes at 256x192            {program} build-scenes --profile small --scenes {scene}"
    ));
    out.note(format!("  what this machine has and lacks  {program} doctor"));
}

/// Queries that were answered rightly, the best masks first, each of another referent as long as there is one.
fn proposals<'a>(endings: &[Ending<'a>]) -> Vec<&'a l4d_data::Query> {
    let mut right: Vec<&Ending<'a>> = endings.iter().filter(|ending| ending.why == Why::Right).collect();
    right.sort_by(|a, b| b.miou.total_cmp(&a.miou));
    let mut proposed: Vec<&l4d_data::Query> = Vec::new();
    for is_repeat in [false, true] {
        for ending in &right {
            let repeats = proposed.iter().any(|query| query.referents == ending.query.referents);
            let is_known = proposed.iter().any(|query| query.id == ending.query.id);
            if proposed.len() < PROPOSED && !is_known && repeats == is_repeat {
                proposed.push(ending.query);
            }
        }
    }
    proposed
}

/// A benchmark of one scene: the shipped queries; tracks and truth come from what is about to be rendered.
fn copy_queries(source: &Benchmark, scene: &Name, target: &BenchDir) -> Result<()> {
    let manifest = Manifest { scenes: vec![scene.clone()], ..source.manifest.clone() };
    write_atomic(&target.manifest(), toml::to_string(&manifest)?.as_bytes())?;
    let queries = read_bounded(&source.dir.queries(scene), l4d_data::json::MAX_BYTES)?;
    write_atomic(&target.queries(scene), &queries)?;
    Ok(())
}
