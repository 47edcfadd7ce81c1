//! Opening a round: draws the items, their ids, the control items and the repeats.
//!
//! Ids are dealt after a shuffle of everything that is asked, so that they say nothing about kind, scene or query.
//! Control items only come from scenes that are asked about anyway.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::store::{list_folder, write_atomic};
use l4d_data::{Benchmark, DataError, Name, Profile, Query, QueryId, Status, json};
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

use crate::cast::Cast;
use crate::item::{Item, ItemId};
use crate::key::{Behind, Key, KeyLine, Meaning};
use crate::order::random_of;
use crate::round::{Gold, Round, RoundDir, SCHEMA, Settings, items_problem, settings_problem};
use crate::rule::{FrameRule, Rule};

/// What a round shall be.
#[derive(Debug, Clone)]
pub struct RoundPlan {
    /// Name of its folder.
    pub name: Name,
    /// One line for people.
    pub title: String,
    /// Which rendering is looked at.
    pub profile: Profile,
    /// Seed of everything drawn.
    pub seed: u64,
    /// Who votes.
    pub annotators: Vec<Name>,
    /// How many have to be right.
    pub rule: Rule,
    /// How well the frames have to fit.
    pub frames: FrameRule,
    /// Whether the annotators are programs.
    pub simulated: bool,
    /// How many views annotators may look at.
    pub views: usize,
    /// How many prompts are asked twice, at most.
    pub repeats: usize,
    /// Control items, at most.
    pub gold: Gold,
    /// Scenes to ask about.
    pub scenes: Vec<Name>,
    /// Whether queries of two categories are asked too.
    pub composites: bool,
    /// Exactly these queries, of one or two categories; `None`: all candidates.
    pub only: Option<BTreeSet<QueryId>>,
}

/// Something to ask.
#[derive(Debug, Clone)]
struct Prompt {
    scene: Name,
    text: String,
    digest: String,
    what: What,
}

#[derive(Debug, Clone)]
enum What {
    Behind(Behind),
    /// Asks the prompt of this index again.
    Again(usize),
}

impl Prompt {
    fn new(scene: &Name, text: String, meaning: &Meaning, behind: Behind) -> Self {
        Self { scene: scene.clone(), digest: meaning.digest(&text), text, what: What::Behind(behind) }
    }
}

/// Draws a round from the benchmark.
pub fn make_round(plan: &RoundPlan, bench: &Benchmark) -> Result<(Round, Key), DataError> {
    let scenes: Vec<SceneNow> =
        plan.scenes.iter().map(|scene| SceneNow::read(plan, bench, scene)).collect::<Result<_, _>>()?;
    require_all(plan, bench, &scenes)?;
    let mut random = random_of(&["l4d/round/1", &plan.seed.to_string(), &plan.name]);

    let mut prompts: Vec<Prompt> = scenes.iter().flat_map(|scene| scene.queries.clone()).collect();
    let queries = prompts.len();
    let asked: Vec<&SceneNow> = scenes.iter().filter(|scene| !scene.queries.is_empty()).collect();
    let absent: Vec<Prompt> = asked.iter().flat_map(|scene| scene.absent.clone()).collect();
    let vague: Vec<Prompt> = asked.iter().flat_map(|scene| scene.vague.clone()).collect();
    prompts.extend(sample(&mut random, absent, plan.gold.absent));
    prompts.extend(sample(&mut random, vague, plan.gold.vague));
    for index in sample(&mut random, (0..queries).collect(), plan.repeats) {
        let again = Prompt { what: What::Again(index), ..prompts[index].clone() };
        prompts.push(again);
    }
    let ids = deal_ids(&mut random, &prompts);
    assemble(plan, prompts, &ids)
}

/// Writes `key.jsonl`, `items.jsonl` and `round.toml`; refuses to replace a round.
pub fn write_round(dir: &RoundDir, round: &Round, key: &Key) -> Result<(), DataError> {
    let path = dir.settings();
    let has_votes = dir.votes().exists() && !list_folder(&dir.votes())?.is_empty();
    if path.exists() || has_votes {
        return Err(DataError::invalid(
            dir.root(),
            "folder",
            "there is such a round already: votes are bound to it",
            "give the new round another name",
        ));
    }
    let settings = toml::to_string(&round.settings()).map_err(|error| DataError::Format {
        path: path.clone(),
        location: "settings".to_owned(),
        message: error.to_string(),
    })?;
    let entry = |(item, behind): (&ItemId, &Behind)| KeyLine { item: item.clone(), behind: behind.clone() };
    json::write_lines(&dir.key(), &key.entries().iter().map(entry).collect::<Vec<_>>())?;
    json::write_lines(&dir.items(), &round.items)?;
    // Last: a folder with a round.toml is a whole round.
    let heading = "# A round of annotation. Votes are bound to its name, items and seed: open another one to change them.";
    write_atomic(&path, format!("{heading}\n{settings}").as_bytes())
}

/// What can be asked about a scene.
struct SceneNow {
    ids: BTreeSet<QueryId>,
    queries: Vec<Prompt>,
    absent: Vec<Prompt>,
    vague: Vec<Prompt>,
}

impl SceneNow {
    fn read(plan: &RoundPlan, bench: &Benchmark, scene: &Name) -> Result<Self, DataError> {
        bench.scene(scene)?;
        let cast = Cast::read(bench, plan.profile, scene)?;
        let digest = &cast.digest;
        let mut all = bench.queries(scene)?;
        if plan.composites || plan.only.is_some() {
            all.extend(bench.composites(scene)?);
        }
        let is_asked = |query: &&Query| match &plan.only {
            Some(only) => only.contains(&query.id),
            None => query.status == Status::Candidate,
        };
        let queries: Vec<Prompt> = all
            .iter()
            .filter(is_asked)
            .map(|query| {
                let meaning = Meaning::of_query(query, digest);
                let (id, categories) = (query.id.clone(), query.categories.clone());
                let behind = Behind::Query { query: id, categories, meaning: meaning.clone() };
                Prompt::new(scene, query.text.clone(), &meaning, behind)
            })
            .collect();
        // A control item with the words of a query would pass for its repeat.
        let mut texts: BTreeSet<String> = all.iter().map(|query| query.text.clone()).collect();
        let absents = bench.absents(scene)?.into_iter().filter(|query| texts.insert(query.text.clone()));
        let absent = absents
            .map(|query| {
                let meaning = Meaning::of_query(&query, digest);
                let behind = Behind::Absent { query: query.id, meaning: meaning.clone() };
                Prompt::new(scene, query.text, &meaning, behind)
            })
            .collect();
        let vague = cast
            .look_alikes()
            .into_iter()
            .map(|category| {
                let meaning = Meaning::of_category(&category, &cast);
                let text = format!("The {}", category.replace('_', " "));
                let behind = Behind::Vague { category, meaning: meaning.clone() };
                Prompt::new(scene, text, &meaning, behind)
            })
            .filter(|prompt| texts.insert(prompt.text.clone()))
            .collect();
        let ids = all.into_iter().map(|query| query.id).collect();
        Ok(Self { ids, queries, absent, vague })
    }
}

fn require_all(plan: &RoundPlan, bench: &Benchmark, scenes: &[SceneNow]) -> Result<(), DataError> {
    let refuse = |message: String, remedy: &str| {
        Err(DataError::invalid(&bench.root().join("queries"), "queries", message, remedy))
    };
    let is_known = |id: &&QueryId| scenes.iter().any(|scene| scene.ids.contains(*id));
    if let Some(unknown) = plan.only.iter().flatten().find(|id| !is_known(id)) {
        return refuse(
            format!("there is no `{unknown}` in the chosen scenes"),
            "choose its scene too, or leave the query out",
        );
    }
    if scenes.iter().all(|scene| scene.queries.is_empty()) {
        return refuse("nothing is left to ask".to_owned(), "choose other scenes or queries");
    }
    Ok(())
}

fn sample<T>(random: &mut ChaCha8Rng, mut pool: Vec<T>, count: usize) -> Vec<T> {
    pool.shuffle(random);
    pool.truncate(count);
    pool
}

/// An id for each prompt; a repeat has a larger one than its original.
fn deal_ids(random: &mut ChaCha8Rng, prompts: &[Prompt]) -> Vec<ItemId> {
    let mut numbers: Vec<usize> = (1..=prompts.len()).collect();
    numbers.shuffle(random);
    for (index, prompt) in prompts.iter().enumerate() {
        if let What::Again(original) = prompt.what
            && numbers[index] < numbers[original]
        {
            numbers.swap(index, original);
        }
    }
    numbers.into_iter().map(|number| ItemId::numbered(number, prompts.len())).collect()
}

fn assemble(plan: &RoundPlan, prompts: Vec<Prompt>, ids: &[ItemId]) -> Result<(Round, Key), DataError> {
    let mut items = Vec::new();
    let mut entries = BTreeMap::new();
    for (prompt, id) in prompts.into_iter().zip(ids) {
        let Prompt { scene, text, digest, what } = prompt;
        let behind = match what {
            What::Behind(behind) => behind,
            What::Again(original) => Behind::Repeat { of: ids[original].clone() },
        };
        entries.insert(id.clone(), behind);
        items.push(Item { id: id.clone(), scene, text, digest });
    }
    items.sort_by(|a, b| a.id.cmp(&b.id));
    let settings = Settings {
        schema: SCHEMA.to_owned(),
        name: plan.name.clone(),
        title: plan.title.clone(),
        profile: plan.profile,
        seed: plan.seed,
        annotators: plan.annotators.clone(),
        rule: plan.rule,
        frames: plan.frames,
        simulated: plan.simulated,
        views: plan.views,
        repeats: plan.repeats,
        gold: plan.gold,
    };
    let dir = RoundDir::new(plan.name.as_str());
    if let Some((field, message, remedy)) = settings_problem(&settings) {
        return Err(DataError::invalid(&dir.settings(), format!("field `{field}`"), message, remedy));
    }
    if let Some((place, message)) = items_problem(&items) {
        return Err(DataError::invalid(&dir.items(), place, message, "mend the benchmark"));
    }
    Ok((Round::new(&dir, settings, items), Key::new(entries)))
}

#[cfg(test)]
mod tests;
