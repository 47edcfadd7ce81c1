//! `l4d check-scenes`: is every picture there, whole, and in agreement with all the others?

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_data::{Benchmark, Name, Report, Workspace};
use l4d_frames::check::{Request, SceneStats, check_scene};
use serde_json::json;

use crate::cli::BenchArgs;
use crate::cli::scenes::CheckScenesArgs;
use crate::out::{ExitStatus, Printer, refusal, table};

pub(crate) fn run(args: &CheckScenesArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let space = Workspace::new(args.bench.profile).with_data(args.data.as_deref());
    let scenes = scenes_to_check(&args.bench, &bench, &space, out)?;
    let frames_a_scene = args.bench.profile.frames().count();
    out.start("checking", (scenes.len() * frames_a_scene) as u64);
    let mut report = Report::default();
    let mut stats = Vec::new();
    for scene in &scenes {
        out.item(&scene);
        let request = Request { data: space.data(), bench: &bench.dir, profile: args.bench.profile, scene };
        let (found, problems) = check_scene(request, &|| out.advance(1));
        stats.extend(found);
        report.extend(problems);
    }
    out.finish();
    if args.json {
        return out.document(json!({ "scenes": stats }), report);
    }
    print_table(&stats, out)?;
    out.findings(report, false)
}

/// The scenes asked for, or all that are in the data folder, the benchmark's first.
fn scenes_to_check(
    args: &BenchArgs,
    bench: &Benchmark,
    space: &Workspace,
    out: &Printer,
) -> Result<Vec<Name>> {
    let stands = |scene: &Name| space.scene(scene).root().is_dir();
    if !args.scenes.is_empty() {
        return args.scenes.iter().map(|scene| known_scene(scene, bench, &stands)).collect();
    }
    let (built, absent): (Vec<Name>, Vec<Name>) = bench.manifest.scenes.iter().cloned().partition(stands);
    let mut scenes = built;
    for entry in l4d_data::store::list_folder(space.data()).unwrap_or_default() {
        if let Ok(name) = Name::new(entry)
            && !scenes.contains(&name)
            && space.scene(&name).scene().is_file()
        {
            scenes.push(name);
        }
    }
    if scenes.is_empty() {
        return Err(refusal(format!("no scene is in {}", space.data().display()), args.build_hint()));
    }
    if !absent.is_empty() {
        let all = bench.manifest.scenes.len();
        out.note(format!("not built, so not checked: {} of {all} scenes", absent.len()));
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
    let head = [
        "scene",
        "views",
        "frames",
        "compared px",
        "|z - z'| median",
        "p95",
        "p99",
        "max mm",
        "% beyond 1 mm + 1e-4 z",
        "% ids agree",
    ];
    let row = |stats: &SceneStats| {
        let mut row = vec![stats.scene.to_string(), stats.views.to_string(), stats.frames.to_string()];
        match &stats.cross_view {
            // No two views could be compared.
            None => row.resize(head.len(), "-".to_owned()),
            Some(cross) => {
                let spread = &cross.residual_mm;
                row.push(cross.compared.to_string());
                row.extend([spread.median, spread.p95, spread.p99].map(|mm| format!("{mm:.3}")));
                row.push(format!("{:.1}", spread.max));
                row.extend([cross.beyond, cross.id_agreement].map(|share| format!("{:.3}", 100.0 * share)));
            }
        }
        row
    };
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(stats.iter().map(row));
    Ok(out.data(table(&rows))?)
}
