//! `l4d open-round`: draws what annotators are asked, from the benchmark or from what an earlier round rejected.

mod again;
#[cfg(feature = "annotate")]
mod pack;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::digest::sha256_hex;
use l4d_data::store::{Earlier, list_folder};
use l4d_data::{Benchmark, Category, DataError, Name, Query, QueryId, Status, counted};
use l4d_votes::draw_round;
use l4d_votes::key::ItemSource;
use l4d_votes::{Gold, RoundSettings, SCHEMA};
use l4d_votes::{Key, Round, RoundDir};

use crate::cli::annotation::{AskedArg, OpenRoundArgs};
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &OpenRoundArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(args.name.as_str())?;
    let dir = RoundDir::new(args.rounds.join(name.as_str()));
    if let Some(annotator) = &args.pack {
        return pack(args, &dir, annotator, out);
    }
    refuse_to_replace(&dir, args.force)?;
    let bench = Benchmark::open(&args.bench.bench)?;
    let wanted = match &args.from {
        Some(earlier) => again::left_by(args, earlier, &bench, out)?,
        None => by_status(args, &bench)?,
    };
    let mut only = again::not_rejected_before(wanted, args, &bench, out)?;
    if let Some(count) = args.sample {
        only = sample(only, count, args.seed, &bench)?;
    }
    if only.is_empty() {
        let hint =
            "edit what `refine.jsonl` of an earlier round lists, choose other --scenes, or --queries all";
        return Err(refusal("there is no query to ask about", hint));
    }
    let settings = settings(args, name, only.len())?;
    let (round, key) = draw_round(settings, &bench.select(&args.bench.scenes)?, &only, &bench)?;
    let earlier = Earlier { file: "round.toml", says: SCHEMA };
    let claim = dir.claim(&files(&dir), earlier, args.force)?;
    // Another run may have opened it meanwhile.
    refuse_to_replace(&dir, args.force)?;
    clear(&dir)?;
    round.write(&dir, &key)?;
    drop(claim);
    out.data(dir.root().display())?;
    out.note(summary(&round, &key));
    if round.simulated {
        out.note("simulated: its votes never count as those of people");
    }
    let first = &round.annotators[0];
    let place = if args.rounds == Path::new("annotation/rounds") {
        String::new()
    } else {
        format!(" --rounds {}", args.rounds.display())
    };
    out.note(format!("next: `l4d verify-prompts {} --as {first}{place}` in a terminal, or", round.name));
    out.note(format!(
        "`l4d open-round {} --pack {first}{place}` for a page to vote with in a browser",
        round.name
    ));
    Ok(ExitStatus::Success)
}

#[cfg(feature = "annotate")]
use pack::run as pack;

#[cfg(not(feature = "annotate"))]
fn pack(_: &OpenRoundArgs, _: &RoundDir, _: &str, _: &Printer) -> Result<ExitStatus> {
    Err(crate::out::not_built_in("the page for voting in a browser", "annotate"))
}

/// The settings of a round that asks so many queries.
fn settings(args: &OpenRoundArgs, name: Name, queries: usize) -> Result<RoundSettings> {
    let annotators = args.annotators.iter().map(|name| Ok(Name::new(name.as_str())?));
    let annotators = annotators.collect::<Result<Vec<Name>>>()?;
    if annotators.len() != args.panel {
        let message = format!("--annotators names {}, but the panel has {}", annotators.len(), args.panel);
        return Err(refusal(message, "name as many annotators as --panel says, which is 5 unless given"));
    }
    // Half of the control items have no answer, half have too many.
    let control = share_of(queries, args.gold);
    let gold = Gold { absent: control.div_ceil(2), vague: control / 2 };
    Ok(RoundSettings {
        schema: SCHEMA.to_owned(),
        name,
        profile: args.bench.profile,
        seed: args.seed,
        annotators,
        simulated: args.simulated,
        views: args.view_count,
        repeats: share_of(queries, args.repeats),
        gold,
    })
}

/// A share of the queries, as a count.
fn share_of(queries: usize, share: f64) -> usize {
    (queries as f64 * share).round() as usize
}

/// The queries of the chosen scenes that have the wanted status.
fn by_status(args: &OpenRoundArgs, bench: &Benchmark) -> Result<BTreeSet<QueryId>> {
    let takes = |query: &Query| match args.queries {
        AskedArg::All => true,
        AskedArg::Candidate => query.status == Status::Candidate,
        AskedArg::Rejected => query.status == Status::Rejected,
    };
    let mut ids = BTreeSet::new();
    for scene in bench.select(&args.bench.scenes)? {
        let mut queries = bench.queries(&scene)?;
        if args.composites {
            queries.extend(bench.composites(&scene)?);
        }
        ids.extend(queries.into_iter().filter(takes).map(|query| query.id));
    }
    Ok(ids)
}

/// So many of the queries, drawn by lot: the categories in turn, while they last.
fn sample(ids: BTreeSet<QueryId>, count: usize, seed: u64, bench: &Benchmark) -> Result<BTreeSet<QueryId>> {
    let mut lots: BTreeMap<Vec<Category>, Vec<(String, QueryId)>> = BTreeMap::new();
    let scenes: BTreeSet<&Name> = ids.iter().map(|id| &id.scene).collect();
    for scene in scenes {
        let queries = bench.queries(scene)?.into_iter().chain(bench.composites(scene)?);
        for query in queries.filter(|query| ids.contains(&query.id)) {
            let lot = sha256_hex(format!("l4d/sample/{seed}/{}", query.id).as_bytes());
            lots.entry(query.categories).or_default().push((lot, query.id));
        }
    }
    lots.values_mut().for_each(|lots| lots.sort());
    let rounds = lots.values().map(Vec::len).max().unwrap_or(0);
    let in_turn = (0..rounds).flat_map(|round| lots.values().filter_map(move |lots| lots.get(round)));
    Ok(in_turn.take(count).map(|(_, id)| id.clone()).collect())
}

/// A round in which somebody voted is never replaced; one without votes only when asked.
fn refuse_to_replace(dir: &RoundDir, force: bool) -> Result<()> {
    if !dir.root().exists() {
        return Ok(());
    }
    if dir.votes().exists() && !list_folder(&dir.votes())?.is_empty() {
        return Err(refusal(
            format!("{}: people have voted in this round", dir.root().display()),
            "give the new round another name; votes are never thrown away",
        ));
    }
    // Its settings are written last: without them there is what a killed run left.
    if !force && dir.settings().exists() {
        return Err(refusal(
            format!("{}: there is such a round already, without votes", dir.root().display()),
            "give another name, or replace it with --force",
        ));
    }
    Ok(())
}

/// All files of a round but its votes.
fn files(dir: &RoundDir) -> [PathBuf; 6] {
    [dir.settings(), dir.items(), dir.key(), dir.verdicts(), dir.agreement(), dir.refine()]
}

/// Removes what a round without votes left, its settings first; everything else in the folder stays.
fn clear(dir: &RoundDir) -> Result<()> {
    for path in files(dir) {
        if path.exists() {
            std::fs::remove_file(&path).map_err(|error| DataError::io(&path, "replace", error))?;
        }
    }
    Ok(())
}

/// `28 items over 7 scenes: 24 queries (attribute 6, ...), control items 2, repeats 2; annotators 5`.
fn summary(round: &Round, key: &Key) -> String {
    let mut categories: BTreeMap<String, usize> = BTreeMap::new();
    let (mut controls, mut repeats) = (0, 0);
    for source in key.entries().values() {
        match source {
            ItemSource::Query { categories: of, .. } => {
                let names: Vec<&str> = of.iter().map(|category| category.as_str()).collect();
                *categories.entry(names.join("+")).or_default() += 1;
            }
            ItemSource::Absent { .. } | ItemSource::Vague { .. } => controls += 1,
            ItemSource::Repeat { .. } => repeats += 1,
        }
    }
    let queries: usize = categories.values().sum();
    let scenes: BTreeSet<&Name> = round.items.iter().map(|item| &item.scene).collect();
    let categories: Vec<String> = categories.iter().map(|(name, count)| format!("{name} {count}")).collect();
    format!(
        "{} over {}: {} ({}), control items {controls}, repeats {repeats}; annotators {}",
        counted(round.items.len(), "item"),
        counted(scenes.len(), "scene"),
        counted(queries, "query"),
        categories.join(", "),
        round.annotators.len()
    )
}
