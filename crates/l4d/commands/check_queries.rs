//! `l4d check-queries`: one referent each, real distractors, and the count of the set.

use std::path::Path;

use anyhow::Result;
use l4d_data::store::Claim;
use l4d_data::{Benchmark, Name, Query, Report, Status, json as json_file};
use l4d_query::check_set;
use l4d_query::overlap::{self, Overlap, Recall};
use l4d_query::probes::Probe;

use serde_json::json;

use crate::cli::annotation::CheckQueriesArgs;
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &CheckQueriesArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let scenes = bench.select(&args.bench.scenes)?;
    let mut report = Report::default();
    let summary = check_set(&bench, args.bench.profile, &scenes, &mut report);
    let overlap = match &args.against {
        Some(other) => {
            let other = Benchmark::open(other)?;
            Some(overlap::check_against(&bench, args.bench.profile, &scenes, &other, &mut report))
        }
        None => None,
    };
    if let Some(path) = &args.public {
        write_public(&bench, &scenes, path)?;
    }
    if args.json {
        let mut document = serde_json::to_value(&summary)?;
        if let Some(overlap) = &overlap {
            document["overlap"] = serde_json::to_value(overlap)?;
        }
        return out.document(document, report);
    }
    out.data(format!("{:<14}{:>8}", "scenes", summary.scenes))?;
    for (scale, count) in &summary.scales {
        out.data(format!("  {scale:<12}{count:>8}"))?;
    }
    out.data(format!("{:<14}{:>8}", "objects", summary.instances))?;
    out.data(format!("{:<14}{:>8}", "queries", summary.total()))?;
    for (category, count) in &summary.queries {
        out.data(format!("  {category:<12}{count:>8}"))?;
    }
    out.data(format!("{:<14}{:>8}", "composites", summary.composites.values().sum::<usize>()))?;
    for (pair, count) in &summary.composites {
        out.data(format!("  {pair:<22}{count:>6}"))?;
    }
    out.data(format!("{:<14}{:>8}", "absent", summary.absent))?;
    out.data(format!("{:<14}{:>8}", "verified", summary.verified))?;
    out.data(format!("{:<14}{:>8}", "rejected", summary.rejected))?;
    print_probes(&summary.probes, out)?;
    if let Some(overlap) = &overlap {
        print_overlap(overlap, out)?;
    }
    out.findings(report, false)
}

/// A line a query, in the order of the scenes.
fn write_public(bench: &Benchmark, scenes: &[Name], path: &Path) -> Result<()> {
    let mut lines = Vec::new();
    for scene in scenes {
        let counts = |query: &Query| query.status != Status::Rejected;
        let queries = bench.queries(scene)?.into_iter().chain(bench.composites(scene)?).filter(counts);
        let public =
            |query: Query| json!({ "id": query.id, "text": query.text, "categories": query.categories });
        lines.extend(queries.map(public));
    }
    let _claim = Claim::of_file(path, false)?;
    Ok(json_file::write_lines(path, &lines)?)
}

fn print_probes(probes: &[Probe], out: &Printer) -> Result<()> {
    if probes.is_empty() {
        return Ok(());
    }
    out.data("")?;
    let columns = ["right %", "chance %", "+ points", "action", "spatial", "interaction"];
    let columns = columns.map(|column| format!("{column:>12}")).concat();
    out.data(format!("{:<24}{columns}", "shortcut"))?;
    for probe in probes {
        if probe.queries == 0 {
            out.data(format!("  {:<22}{:>12}", probe.name, "no pictures"))?;
            continue;
        }
        let categories = ["action", "spatial", "interaction"];
        let categories =
            categories.map(|category| probe.categories.get(category).copied().unwrap_or_default());
        let numbers = [probe.accuracy, probe.chance].map(|number| format!("{number:>12.1}")).concat();
        let differences = [probe.difference].into_iter().chain(categories);
        let differences: String = differences.map(|points| format!("{points:>+12.1}")).collect();
        let mark = if probe.is_beyond() {
            "  beyond the bound"
        } else if probe.bounded {
            ""
        } else {
            "  (no bound)"
        };
        out.data(format!("  {:<22}{numbers}{differences}{mark}", probe.name))?;
    }
    Ok(())
}

fn print_overlap(overlap: &Overlap, out: &Printer) -> Result<()> {
    out.data("")?;
    out.data(format!(
        "{:<24}{:>12}{:>12}{:>12}",
        "shared with the other", "queries", "sentences", "predicates"
    ))?;
    for (set, shared) in &overlap.shared {
        let counts = [shared.queries, shared.sentences, shared.predicates];
        out.data(format!("  {set:<22}{}", counts.map(|count| format!("{count:>12}")).concat()))?;
    }
    out.data("")?;
    out.data(format!(
        "{:<24}{:>12}{:>12}{:>12}{:>12}",
        "memory of the other", "queries", "right", "chance", "+ points"
    ))?;
    let row = |name: &str, recall: &Recall| {
        let Recall { queries, right, by_chance } = recall;
        out.data(format!("  {name:<22}{queries:>12}{right:>12.1}{by_chance:>12.1}{:>+12.1}", recall.points()))
    };
    row("all", &overlap.memory.all)?;
    for (category, recall) in &overlap.memory.categories {
        row(category, recall)?;
    }
    out.data("")?;
    let places = &overlap.places;
    let distance = format!("{:.3} m from it on average", places.mean_distance_m);
    out.data(format!("{} objects have the name of one of the other, {distance}", places.objects))?;
    Ok(())
}
