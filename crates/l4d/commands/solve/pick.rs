//! Which queries are answered.

use anyhow::Result;
use l4d_data::{Benchmark, Name, Query, QueryId, Status};

use crate::cli::solver::{QuerySetArg, SolveArgs};
use crate::out::refusal;

/// Some queries of a scene, in the order of the benchmark.
pub(super) struct SceneQueries {
    pub(super) name: Name,
    pub(super) queries: Vec<Query>,
}

/// The scenes that have any of the queries that were asked for.
pub(super) fn pick(args: &SolveArgs, bench: &Benchmark) -> Result<Vec<SceneQueries>> {
    let ids = args.queries.iter().map(|id| Ok(id.parse()?)).collect::<Result<Vec<QueryId>>>()?;
    let mut scenes = Vec::new();
    let mut known = 0;
    for name in bench.select(&args.bench.scenes)? {
        let mut queries = match args.set {
            QuerySetArg::Queries => bench.queries(&name)?,
            QuerySetArg::Composites => bench.composites(&name)?,
            QuerySetArg::Absents => bench.absents(&name)?,
        };
        queries.retain(|query| query.status != Status::Rejected);
        if !ids.is_empty() {
            queries.retain(|query| ids.contains(&query.id));
        }
        known += queries.len();
        scenes.push(SceneQueries { name, queries });
    }
    if known < ids.len() {
        let has =
            |id: &&QueryId| scenes.iter().any(|scene| scene.queries.iter().any(|query| query.id == **id));
        let missing: Vec<String> = ids.iter().filter(|id| !has(id)).map(ToString::to_string).collect();
        return Err(refusal(
            format!("the benchmark has no query {}", missing.join(", ")),
            "check the numbers, --set and --scenes; rejected queries are not answered",
        ));
    }
    if let Some(shard) = args.shard {
        // Counted over all scenes.
        let mut places = 0..;
        let mut is_ours = |_: &Query| places.next().is_some_and(|place| shard.has(place));
        scenes.iter_mut().for_each(|scene| scene.queries.retain(&mut is_ours));
    }
    scenes.retain(|scene| !scene.queries.is_empty());
    Ok(scenes)
}
