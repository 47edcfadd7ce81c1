//! `l4d host`: the benchmark in the form of a platform that runs leaderboards.

use std::collections::BTreeMap;

use anyhow::Result;
use l4d_data::store::list_folder;
use l4d_data::workspace::default_hosting;
use l4d_data::{Benchmark, Category, DataError, Report, counted};
use l4d_release::host::{Competition, Entry, Files, Hosted, codabench, huggingface, write};
use l4d_score::{QuerySet, Summary};
use serde_json::json;

use crate::cli::publishing::{CompetitionArgs, HostArgs, HostCommand};
use crate::out::{ExitStatus, Printer, refusal};
use crate::published_votes::{publication, votes_of_people};

pub(crate) fn run(command: &HostCommand, out: &Printer) -> Result<ExitStatus> {
    match command {
        HostCommand::Codabench(args) => {
            let competition = competition(args)?;
            make(&args.host, "codabench", out, |hosted| Ok(codabench(hosted, &competition, &args.wheel)?))
        }
        HostCommand::Huggingface(args) => {
            require_hub_name(&args.dataset)?;
            make(&args.host, "huggingface", out, |hosted| {
                Ok(huggingface(hosted, &args.dataset, &entries(&args.scores, hosted)?)?)
            })
        }
    }
}

fn competition(args: &CompetitionArgs) -> Result<Competition> {
    let publication = publication(&args.date, &args.url, &args.creators)?;
    if let Some(until) = args.until.as_ref().filter(|until| **until < args.date) {
        return Err(refusal(format!("{until} comes before {}", args.date), "mend --date or --until"));
    }
    Ok(Competition { publication, until: args.until.clone(), track: args.track })
}

fn require_hub_name(text: &str) -> Result<()> {
    let is_plain = |part: &str| {
        !part.is_empty()
            && part.chars().all(|letter| letter.is_ascii_alphanumeric() || "-_.".contains(letter))
    };
    match text.split_once('/') {
        Some((organisation, name)) if is_plain(organisation) && is_plain(name) => Ok(()),
        _ => {
            let message = format!("`{}` is no data set of the Hub", text.escape_debug());
            Err(refusal(message, "write --dataset ORGANISATION/NAME"))
        }
    }
}

fn make(
    args: &HostArgs,
    platform: &str,
    out: &Printer,
    form: impl FnOnce(&Hosted<'_>) -> Result<Files>,
) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench)?;
    let votes = votes_of_people(&args.rounds, &bench)?;
    let mut report = Report::default();
    let gathered = l4d_release::examine(&bench, &votes, &mut report)?;
    if report.has_errors() {
        return out.findings(report, args.json);
    }
    let truth_digest = bench.truth_digest(args.profile)?;
    let hosted = Hosted { gathered: &gathered, profile: args.profile, truth_digest: &truth_digest };
    let files = form(&hosted)?;
    let folder = args.out.clone().unwrap_or_else(|| default_hosting(platform));
    write(&folder, &files, args.force)?;
    if args.json {
        let sizes: BTreeMap<&String, usize> = files.iter().map(|(name, bytes)| (name, bytes.len())).collect();
        out.json(&json!({ "folder": folder, "platform": platform, "files": sizes, "findings": [] }))?;
    } else {
        out.data(folder.display())?;
        out.note(format!("{}; docs/release.md says what to do with them", counted(files.len(), "file")));
    }
    Ok(ExitStatus::Success)
}

/// The scored methods of a folder that belong to this benchmark and profile.
fn entries(scores: &std::path::Path, hosted: &Hosted<'_>) -> Result<Vec<Entry>> {
    let mut entries = Vec::new();
    for name in list_folder(scores)? {
        let path = scores.join(&name).join("summary.json");
        if !path.is_file() {
            continue;
        }
        let summary = Summary::read(&path)?;
        let fits = summary.profile == hosted.profile
            && summary.truth_digest == hosted.truth_digest
            && summary.benchmark_version == hosted.gathered.manifest.version
            && summary.set == QuerySet::Queries;
        if !fits {
            let message = "belongs to another profile, version, truth or set of queries";
            let hint = "choose its --profile and --bench, or move it out of the folder";
            return Err(DataError::invalid(&path, "summary", message, hint).into());
        }
        entries.push(entry(summary));
    }
    if entries.is_empty() {
        let message = format!("{}: holds no scored method", scores.display());
        return Err(refusal(message, "run `l4d score` first, or name the folder of scores"));
    }
    Ok(entries)
}

fn entry(summary: Summary) -> Entry {
    let all = summary.scores.headline;
    let mut scores = BTreeMap::from(
        [
            ("miou", all.percent.miou),
            ("macc", all.percent.macc),
            ("acc25", all.percent.acc25),
            ("acc50", all.percent.acc50),
            ("tube_iou", all.percent.tube_iou),
            ("select", all.percent.select),
            ("fpr", all.percent.false_positive_rate),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    );
    for category in Category::ALL {
        let miou = summary.scores.categories.get(&category).and_then(|metrics| metrics.percent.miou);
        scores.insert(format!("miou_{}", category.as_str()), miou);
    }
    let because = summary.unranked_because();
    Entry {
        name: summary.name.to_string(),
        version: summary.version,
        link: summary.link,
        scores,
        queries: all.queries,
        seconds: summary.seconds,
        track: summary.used.track(),
        unranked_because: (!because.is_empty()).then(|| because.join(", ")),
    }
}
