//! `l4d check-scenes`: is every picture there, whole, and in agreement with all the others?

use std::path::Path;

use anyhow::Result;
use l4d_data::layout::SceneDir;
use l4d_data::{Benchmark, Name, Report};
use l4d_frames::check::{Request, SceneStats, check_scene};
use serde_json::json;

use super::build_scenes::data_folder;
use crate::cli::BenchArgs;
use crate::cli::scenes::CheckScenesArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &CheckScenesArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let draw = bench.manifest.draw();
    let data = data_folder(args.data.as_deref(), args.bench.profile, draw);
    let scenes = scenes_to_check(&args.bench, &bench, &data, out)?;
    let frames_a_scene = args.bench.profile.frames().count();
    let bar = out.bar((scenes.len() * frames_a_scene) as u64, "checking");
    let mut report = Report::default();
    let mut stats = Vec::new();
    for scene in &scenes {
        bar.set_message(scene.to_string());
        let request = Request { data: &data, bench: &bench.dir, draw, profile: args.bench.profile, scene };
        let (found, problems) = check_scene(request, &|| bar.inc(1));
        stats.extend(found);
        report.extend(problems);
    }
    bar.finish_and_clear();
    if args.json {
        let status = if report.has_errors() { ExitStatus::Findings } else { ExitStatus::Success };
        out.json(&json!({ "scenes": stats, "findings": report.into_sorted() }))?;
        return Ok(status);
    }
    print_table(&stats, out)?;
    out.findings(report, false)
}

/// The scenes asked for, or all that stand in the data folder, the benchmark's first.
fn scenes_to_check(args: &BenchArgs, bench: &Benchmark, data: &Path, out: &Printer) -> Result<Vec<Name>> {
    let stands = |scene: &Name| SceneDir::new(data, scene).root().is_dir();
    if !args.scenes.is_empty() {
        return args.scenes.iter().map(|scene| known_scene(scene, bench, &stands)).collect();
    }
    let (built, absent): (Vec<Name>, Vec<Name>) = bench.manifest.scenes.iter().cloned().partition(stands);
    let mut scenes = built;
    for entry in l4d_data::store::list_folder(data).unwrap_or_default() {
        if let Ok(name) = Name::new(entry)
            && !scenes.contains(&name)
            && SceneDir::new(data, &name).scene().is_file()
        {
            scenes.push(name);
        }
    }
    if scenes.is_empty() {
        return Err(refusal(
            format!("no scene stands in {}", data.display()),
            format!("run `l4d build-scenes --profile {}` first, or choose another --data", args.profile),
        ));
    }
    if !absent.is_empty() {
        out.note(format!(
            "not built, so not checked: {} of {} scenes",
            absent.len(),
            bench.manifest.scenes.len()
        ));
    }
    Ok(scenes)
}

fn known_scene(scene: &str, bench: &Benchmark, stands: &impl Fn(&Name) -> bool) -> Result<Name> {
    match Name::new(scene) {
        Ok(name) if stands(&name) => Ok(name),
        _ => Ok(bench.scene(scene)?.clone()),
    }
}

fn print_table(stats: &[SceneStats], out: &Printer) -> Result<()> {
    let width = stats.iter().map(|stats| stats.scene.len()).max().unwrap_or(0).max("scene".len());
    out.data(format!(
        "{:width$}  views  frames  compared px  |z - z'| median    p95    p99      max mm  beyond 1 mm + 1e-4 z  ids agree",
        "scene"
    ))?;
    for stats in stats {
        let start = format!("{:width$}  {:5}  {:6}", stats.scene, stats.views, stats.frames);
        let line = match &stats.cross_view {
            None => format!("{start}  no two views could be compared"),
            Some(cross) => {
                let spread = &cross.residual_mm;
                format!(
                    "{start}  {:11}  {:15.3}  {:5.2}  {:5.2}  {:10.1}  {:19.3} %  {:7.3} %",
                    cross.compared,
                    spread.median,
                    spread.p95,
                    spread.p99,
                    spread.max,
                    cross.beyond * 100.0,
                    cross.id_agreement * 100.0
                )
            }
        };
        out.data(line)?;
    }
    Ok(())
}
