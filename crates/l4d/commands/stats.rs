//! `l4d stats`: what the set is like, as text, JSON, tables and figures.

use std::collections::BTreeMap;

use anyhow::Result;
use l4d_data::store::{Claim, write_atomic};
use l4d_data::{Benchmark, Report, counted};
use l4d_query::stats::{DatasetRow, SetStats, csv_of, measure};

use crate::cli::annotation::StatsArgs;
use crate::figures;
use crate::out::{ExitStatus, Printer, table};

/// Words of a kind that the terminal shows.
const MOST_WORDS: usize = 12;

pub(crate) fn run(args: &StatsArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let scenes = bench.select(&args.bench.scenes)?;
    let mut report = Report::default();
    let stats = measure(&bench, args.bench.profile, &scenes, &mut report)?;
    if let Some(folder) = &args.out {
        let tables = [
            ("datasets.csv", csv_of(&stats.datasets)?),
            ("scenes.csv", csv_of(&stats.scenes)?),
            ("queries.csv", csv_of(&stats.queries)?),
            ("words.csv", csv_of(&stats.words)?),
        ];
        let mut files = tables.map(|(name, bytes)| (name.to_owned(), bytes)).to_vec();
        let figures = figures::draw_stats(&stats, out)?;
        files.extend(figures.into_iter().map(|(name, bytes)| (format!("figures/{name}"), bytes)));
        let names = files.iter().map(|(name, _)| name.clone()).collect();
        let _claim = Claim::take(folder, names, None, args.force)?;
        for (name, bytes) in &files {
            write_atomic(&folder.join(name), bytes)?;
        }
        out.note(format!("{} in {}", counted(files.len(), "file"), folder.display()));
    }
    if args.json {
        out.json(&stats)?;
    } else {
        print(&stats, out)?;
    }
    Ok(out.warnings(report))
}

fn print(stats: &SetStats, out: &Printer) -> Result<()> {
    out.data(dataset_table(&stats.datasets))?;
    let columns = ["objects", "events", "attr", "action", "spatial", "inter", "two", "absent"];
    let columns = columns.map(|column| format!("{column:>9}")).concat();
    out.data(format!("\n{:<28}{:<10}{columns}", "scene", "scale"))?;
    for row in &stats.scenes {
        let counts = [row.objects, row.events, row.attribute, row.action, row.spatial, row.interaction];
        let counts = counts.into_iter().chain([row.composites, row.absent]);
        let counts: String = counts.map(|count| format!("{count:>9}")).collect();
        out.data(format!("{:<28}{:<10}{counts}", row.scene, row.scale))?;
    }
    let mut kinds: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for row in &stats.words {
        kinds.entry(&row.kind).or_default().push(format!("{} {}", row.word, row.count));
    }
    out.data(format!("\n{} different words", stats.words.len()))?;
    for (kind, words) in kinds {
        let shown: Vec<String> = words.iter().take(MOST_WORDS).cloned().collect();
        out.data(format!("  {kind:<12} {:>4}: {}", words.len(), shown.join(", ")))?;
    }
    out.data("\nof the referents           lowest   median  highest")?;
    let all = &stats.queries;
    spread(out, "box diagonal, m", all.iter().map(|row| row.size_m).collect())?;
    spread(out, "path while it holds, m", all.iter().map(|row| row.path_m).collect())?;
    spread(out, "pixels held out", all.iter().filter_map(|row| row.pixels).collect())?;
    spread(out, "frames visible, %", all.iter().filter_map(|row| row.visible_percent).collect())?;
    let gated = all.iter().filter(|row| row.temporal == "while");
    spread(out, "`while` frames", gated.map(|row| f64::from(row.frames)).collect())?;
    spread(out, "event frames", stats.event_frames.iter().map(|&frames| f64::from(frames)).collect())?;
    spread(out, "words a sentence", all.iter().map(|row| row.words as f64).collect())?;
    spread(out, "candidates", all.iter().map(|row| row.candidates as f64).collect())
}

fn spread(out: &Printer, what: &str, mut values: Vec<f64>) -> Result<()> {
    values.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (values.first(), values.last()) else {
        out.data(format!("  {what:<22}    no pictures of this profile"))?;
        return Ok(());
    };
    let numbers = [*low, values[values.len() / 2], *high].map(|value| format!("{value:>9.2}")).concat();
    out.data(format!("  {what:<22}{numbers}"))?;
    Ok(())
}

/// The comparison as the paper prints it.
fn dataset_table(rows: &[DatasetRow]) -> String {
    let count = |count: Option<usize>| count.map_or_else(|| "-".to_owned(), |count| count.to_string());
    let cells = |row: &DatasetRow| {
        let [scenes, prompts, objects] = [row.scenes.to_string(), count(row.prompts), count(row.objects)];
        [&row.dataset, &row.kind, &row.scale, &scenes, &row.setup, &prompts, &objects, &row.ambiguous]
            .map(String::to_owned)
            .to_vec()
    };
    let head = ["dataset", "type", "scale", "scenes", "setup", "prompts", "objects", "ambiguous"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    lines.extend(rows.iter().map(cells));
    table(&lines)
}
