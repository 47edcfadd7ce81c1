//! Which queries are answered.

use l4d_data::{Benchmark, Name, Query, QueryId, QuerySet, Shard, StageError, Status};

/// Some queries of a scene, in the order of the benchmark.
#[derive(Debug)]
pub struct Picked {
    /// Of the scene.
    pub name: Name,
    /// That are answered.
    pub queries: Vec<Query>,
    /// All of the scene, whichever are answered: what an answer depends on must not depend on the shard.
    pub known: Vec<Query>,
}

/// The scenes that have any of the queries that were asked for, all of the set if `ids` is empty.
///
/// # Errors
/// Queries that cannot be read, numbers that are not among them.
pub fn pick(
    bench: &Benchmark,
    set: QuerySet,
    selected: &[Name],
    ids: &[QueryId],
    shard: Option<Shard>,
) -> Result<Vec<Picked>, StageError> {
    let mut scenes = Vec::new();
    let mut known = 0;
    for name in selected {
        let mut queries = bench.asked(set, name)?;
        queries.retain(|query| query.status != Status::Rejected);
        let all = queries.clone();
        if !ids.is_empty() {
            queries.retain(|query| ids.contains(&query.id));
        }
        known += queries.len();
        scenes.push(Picked { name: name.clone(), queries, known: all });
    }
    if known < ids.len() {
        let has =
            |id: &&QueryId| scenes.iter().any(|scene| scene.queries.iter().any(|query| query.id == **id));
        let missing: Vec<String> = ids.iter().filter(|id| !has(id)).map(ToString::to_string).collect();
        return Err(StageError::new(
            format!("the benchmark has no query {}", missing.join(", ")),
            "check the numbers, --set and --scenes; rejected queries are not answered",
        ));
    }
    if let Some(shard) = shard {
        // Counted over all scenes.
        let mut places = 0..;
        let mut is_ours = |_: &Query| places.next().is_some_and(|place| shard.has(place));
        scenes.iter_mut().for_each(|scene| scene.queries.retain(&mut is_ours));
    }
    scenes.retain(|scene| !scene.queries.is_empty());
    Ok(scenes)
}
