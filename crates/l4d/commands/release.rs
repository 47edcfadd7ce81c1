//! `l4d release`: a version of the benchmark, frozen as a self-contained folder; or the check of such a folder.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::Result;
use l4d_data::layout::SceneDir;
use l4d_data::{Benchmark, Progress as _, Report, Status, Workspace, counted};
use l4d_frames::sample;
use l4d_import::handout;
use l4d_release::{Pictures, Plan, ReleaseOptions, freeze, inspect, plan};
use serde_json::json;

use crate::cli::publishing::ReleaseArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::published_votes::{publication, votes_of_people};

pub(crate) fn run(args: &ReleaseArgs, out: &Printer) -> Result<ExitStatus> {
    match &args.check {
        Some(release) => check(release, args, out),
        None => make(args, out),
    }
}

fn make(args: &ReleaseArgs, out: &Printer) -> Result<ExitStatus> {
    let (Some(date), Some(url)) = (&args.date, &args.url) else {
        return Err(refusal("a release needs a day and a page", "give --date and --url"));
    };
    let publication = publication(date, url, &args.creators)?;
    let bench = Benchmark::open(&args.bench)?;
    let votes = votes_of_people(&args.rounds, &bench)?;
    let space = |profile| Workspace::new(profile).with_data(args.data.as_deref());
    let renders = args.profile.map(space);
    let order = ReleaseOptions {
        bench: &bench,
        votes: &votes,
        renders: renders.as_ref().map(|space| (space.data(), space.profile())),
        work: &args.work,
        since: args.since.as_deref(),
        out: &args.out,
        publication: &publication,
    };
    let mut report = Report::default();
    let plan = plan(&order, &mut report)?;
    if report.has_errors() {
        return out.findings(report, args.json);
    }
    let meter = Meter::new(out, plan.work_bytes(), "releasing");
    let source = format!("{} {}", plan.contents.name, plan.contents.version);
    let draw = |scene: &SceneDir, data: &Path| handout::write(scene, &source, data);
    let released =
        freeze(&plan, &Pictures { draw: &draw, encode: &sample::members }, &|bytes| meter.add(bytes))?;
    out.finish();
    if args.json {
        out.json(&json!({
            "release": plan.folder,
            "version": plan.contents.version,
            "was_there": plan.is_there,
            "participants": plan.participants(),
            "since": args.since,
            "changes": plan.changes,
            "queries": counts(&plan),
            "files": released.files,
            "bytes": released.files.values().sum::<u64>(),
            "findings": [],
        }))?;
    } else {
        out.data(plan.folder.display())?;
        tell(&plan, released.files.len(), args, out);
    }
    Ok(ExitStatus::Success)
}

/// What of it a person should know.
fn tell(plan: &Plan, files: usize, args: &ReleaseArgs, out: &Printer) {
    let [judged, verified, rejected] = counts(plan);
    let pictures = match &plan.contents.renders {
        Some(renders) => {
            let models = match renders.splats.len() {
                0 => String::new(),
                1 => ", 1 trained model".to_owned(),
                count => format!(", {count} trained models"),
            };
            format!("renders of profile {}{models}", renders.profile)
        }
        None => "no renders (--profile adds them)".to_owned(),
    };
    out.note(format!(
        "{}: {}, {}, {pictures}",
        counted(files, "file"),
        counted(plan.contents.scenes.len(), "scene"),
        counted(judged, "scored query")
    ));
    out.note(format!(
        "{verified} of {judged} scored queries are verified by people, {rejected} were rejected"
    ));
    if let Some(participants) = plan.participants() {
        out.note(format!(
            "a private test: {} is for participants, the rest for you alone",
            participants.display()
        ));
    }
    if args.since.is_some() {
        out.note(format!("changes since the earlier release: {}", plan.changes.len()));
        plan.changes
            .iter()
            .take(20)
            .for_each(|change| out.note(format!("  {}: {}", change.step, change.what)));
    }
    if plan.is_there {
        out.note("it was there already, made of the same files: nothing was written");
    }
}

/// Scored, verified and rejected single-category queries.
fn counts(plan: &Plan) -> [usize; 3] {
    let queries = || plan.contents.scenes.values().flat_map(|scene| scene.queries.values());
    let with = |status: Status| queries().filter(|query| query.status == status).count();
    let rejected = with(Status::Rejected);
    [queries().count() - rejected, with(Status::Verified), rejected]
}

fn check(release: &Path, args: &ReleaseArgs, out: &Printer) -> Result<ExitStatus> {
    if !release.is_dir() {
        let message = format!("{}: there is no such folder", release.display());
        return Err(refusal(
            message,
            "name the folder of one release, for example release/panoptic-l4d-0.2.0",
        ));
    }
    let mut report = Report::default();
    let meter = Meter::new(out, 0, "checking");
    let contents = inspect(release, &|bytes| meter.add(bytes), &mut report);
    out.finish();
    if let Some(contents) = contents.filter(|_| report.is_empty()) {
        out.note(format!("{} {} is whole", contents.name, contents.version));
    }
    out.findings(report, args.json)
}

/// Progress in megabytes, fed with bytes from many threads.
struct Meter<'a> {
    out: &'a Printer,
    bytes: AtomicU64,
}

impl<'a> Meter<'a> {
    fn new(out: &'a Printer, bytes: u64, what: &'static str) -> Self {
        out.start(what, bytes / 1_000_000);
        out.item(&"MB");
        Self { out, bytes: AtomicU64::new(0) }
    }

    fn add(&self, bytes: u64) {
        let before = self.bytes.fetch_add(bytes, Ordering::Relaxed);
        self.out.advance((before + bytes) / 1_000_000 - before / 1_000_000);
    }
}
