//! Opening a round: draws the items, their ids, the control items and the repeats.
//!
//! Ids are dealt after a shuffle of everything that is asked, so that they say nothing about kind, scene or query.
//! Control items only come from scenes that are asked about anyway.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Benchmark, DataError, Name, Query, QueryId};
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

use crate::item::{Item, ItemId};
use crate::key::{ItemSource, Key, Meaning};
use crate::order::random_of;
use crate::round::{Round, RoundSettings};
use crate::round_dir::RoundDir;
use crate::scene::SceneNow;

#[derive(Debug, Clone)]
struct Prompt {
    scene: Name,
    text: String,
    digest: String,
    drawn: Drawn,
}

#[derive(Debug, Clone)]
enum Drawn {
    From(ItemSource),
    /// Asks the prompt of this index again.
    Again(usize),
}

impl Prompt {
    fn new(scene: &Name, text: String, meaning: &Meaning, source: ItemSource) -> Self {
        Self { scene: scene.clone(), digest: meaning.digest(&text), text, drawn: Drawn::From(source) }
    }
}

/// Draws a round that asks exactly these queries, of one or two categories, of these scenes.
///
/// # Errors
/// A scene cannot be read, a query is in none of the scenes, none is left to ask, or the settings cannot be.
pub fn draw_round(
    settings: RoundSettings,
    scenes: &[Name],
    asked: &BTreeSet<QueryId>,
    bench: &Benchmark,
) -> Result<(Round, Key), DataError> {
    let mut unknown: BTreeSet<&QueryId> = asked.iter().collect();
    let (mut prompts, mut absent, mut vague) = (Vec::new(), Vec::new(), Vec::new());
    for scene in scenes {
        let now = SceneNow::read(bench, settings.profile, scene)?;
        unknown.retain(|id| now.queries.iter().all(|query| query.id != **id));
        let queries: Vec<Prompt> = now
            .queries
            .iter()
            .filter(|query| asked.contains(&query.id))
            .map(|query| ask(scene, &now, query))
            .collect();
        if !queries.is_empty() {
            controls(scene, &now, &mut absent, &mut vague);
        }
        prompts.extend(queries);
    }
    let refuse = |message: String, hint: &str| {
        Err(DataError::invalid(&bench.root().join("queries"), "queries", message, hint))
    };
    if let Some(unknown) = unknown.first() {
        let hint = "choose its scene too, or leave the query out";
        return refuse(format!("there is no `{unknown}` in the chosen scenes"), hint);
    }
    if prompts.is_empty() {
        return refuse("nothing is left to ask".to_owned(), "choose other scenes or queries");
    }

    let mut random = random_of(&["l4d/round/1", &settings.seed.to_string(), &settings.name]);
    let queries = prompts.len();
    prompts.extend(sample(&mut random, absent, settings.gold.absent));
    prompts.extend(sample(&mut random, vague, settings.gold.vague));
    for index in sample(&mut random, (0..queries).collect(), settings.repeats) {
        let again = Prompt { drawn: Drawn::Again(index), ..prompts[index].clone() };
        prompts.push(again);
    }
    let ids = deal_ids(&mut random, &prompts);
    assemble(settings, prompts, &ids)
}

fn ask(scene: &Name, now: &SceneNow, query: &Query) -> Prompt {
    let meaning = now.meaning(query);
    let (id, categories) = (query.id.clone(), query.categories.clone());
    let source = ItemSource::Query { query: id, categories, meaning: meaning.clone() };
    Prompt::new(scene, query.text.clone(), &meaning, source)
}

/// Adds the control items of a scene. One with the words of a query would pass for its repeat, so there is none.
fn controls(scene: &Name, now: &SceneNow, absent: &mut Vec<Prompt>, vague: &mut Vec<Prompt>) {
    let mut texts: BTreeSet<String> = now.queries.iter().map(|query| query.text.clone()).collect();
    for query in now.absents.iter().filter(|query| texts.insert(query.text.clone())) {
        let meaning = now.meaning(query);
        let source = ItemSource::Absent { query: query.id.clone(), meaning: meaning.clone() };
        absent.push(Prompt::new(scene, query.text.clone(), &meaning, source));
    }
    for category in now.look_alikes() {
        let text = format!("The {}", category.replace('_', " "));
        if texts.insert(text.clone()) {
            let meaning = now.meaning_of_category(&category);
            let source = ItemSource::Vague { category, meaning: meaning.clone() };
            vague.push(Prompt::new(scene, text, &meaning, source));
        }
    }
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
        if let Drawn::Again(original) = prompt.drawn
            && numbers[index] < numbers[original]
        {
            numbers.swap(index, original);
        }
    }
    numbers.into_iter().map(|number| ItemId::numbered(number, prompts.len())).collect()
}

fn assemble(
    settings: RoundSettings,
    prompts: Vec<Prompt>,
    ids: &[ItemId],
) -> Result<(Round, Key), DataError> {
    let mut items = Vec::new();
    let mut entries = BTreeMap::new();
    for (Prompt { scene, text, digest, drawn }, id) in prompts.into_iter().zip(ids) {
        let source = match drawn {
            Drawn::From(source) => source,
            Drawn::Again(original) => ItemSource::Repeat { of: ids[original].clone() },
        };
        entries.insert(id.clone(), source);
        items.push(Item { id: id.clone(), scene, text, digest });
    }
    items.sort_by(|a, b| a.id.cmp(&b.id));
    let dir = RoundDir::new(settings.name.as_str());
    Ok((Round::new(&dir, settings, items, "mend the benchmark")?, Key::new(entries)))
}

#[cfg(test)]
mod tests;
