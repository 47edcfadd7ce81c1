//! `l4d release`: a version of the benchmark, frozen as a folder that stands alone; or the check of such a folder.

pub(super) mod votes;

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::Result;
use indicatif::ProgressBar;
use l4d_data::{Benchmark, Report, Status};
use l4d_release::contents::Publication;
use l4d_release::{Day, Order, Plan, freeze, inspect, plan};
use serde_json::json;

use super::build_scenes::data_folder;
use crate::cli::publishing::ReleaseArgs;
use crate::out::{ExitStatus, Printer, refusal};

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
    let votes = votes::of_people(&args.rounds, &bench)?;
    let data = args.profile.map(|profile| data_folder(args.data.as_deref(), profile, bench.manifest.draw()));
    let order = Order {
        bench: &bench,
        votes: &votes,
        renders: data.as_deref().zip(args.profile),
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
    let released = freeze(&plan, &|bytes| meter.add(bytes))?;
    meter.finish();
    if args.json {
        out.json(&json!({
            "release": plan.folder,
            "version": plan.contents.version,
            "was_there": plan.is_there,
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

/// What nobody can read from the data.
pub(super) fn publication(date: &Day, url: &str, creators: &[String]) -> Result<Publication> {
    if !url.starts_with("https://") && !url.starts_with("http://") {
        return Err(refusal(format!("`{url}` is no page"), "give --url as https://..."));
    }
    Ok(Publication { date: date.clone(), url: url.to_owned(), creators: creators.to_vec() })
}

/// What of it a person should know.
fn tell(plan: &Plan, files: usize, args: &ReleaseArgs, out: &Printer) {
    let [judged, verified, rejected] = counts(plan);
    let pictures = match &plan.contents.renders {
        Some(renders) => format!("renders of profile {}", renders.profile),
        None => "no renders (--profile adds them)".to_owned(),
    };
    out.note(format!(
        "{files} files: {} scenes, {judged} scored queries, {pictures}",
        plan.contents.scenes.len()
    ));
    out.note(format!(
        "{verified} of {judged} scored queries are verified by people, {rejected} were rejected"
    ));
    if args.since.is_some() {
        out.note(format!("{} since the earlier release", how_many(plan.changes.len())));
        plan.changes
            .iter()
            .take(20)
            .for_each(|change| out.note(format!("  {}: {}", change.step, change.what)));
    }
    if plan.is_there {
        out.note("it stood there already, made of the same files: nothing was written");
    }
}

fn how_many(changes: usize) -> String {
    match changes {
        0 => "no change".to_owned(),
        1 => "1 change".to_owned(),
        more => format!("{more} changes"),
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
    let meter = Meter::new(out, bytes_below(release), "checking");
    let contents = inspect(release, &|bytes| meter.add(bytes), &mut report);
    meter.finish();
    if let Some(contents) = contents.filter(|_| report.is_empty()) {
        out.note(format!("{} {} is whole", contents.name, contents.version));
    }
    out.findings(report, args.json)
}

/// What a check will read, for its progress bar alone.
fn bytes_below(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let size = |entry: std::fs::DirEntry| match entry.file_type() {
        Ok(kind) if kind.is_dir() => bytes_below(&entry.path()),
        Ok(kind) if kind.is_file() => entry.metadata().map_or(0, |metadata| metadata.len()),
        _ => 0,
    };
    entries.map(size).sum()
}

/// A progress bar in megabytes, fed with bytes from many threads.
struct Meter {
    bar: ProgressBar,
    bytes: AtomicU64,
}

impl Meter {
    fn new(out: &Printer, bytes: u64, what: &'static str) -> Self {
        let bar = out.bar(bytes / 1_000_000, what);
        bar.set_message("MB");
        Self { bar, bytes: AtomicU64::new(0) }
    }

    fn add(&self, bytes: u64) {
        let so_far = self.bytes.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.bar.set_position(so_far / 1_000_000);
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
