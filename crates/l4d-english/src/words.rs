//! What a scene calls its things: which nouns, verbs and properties it has, and by which words its landmarks are known.

use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::{Name, Role};
use l4d_query::eval::members;
use l4d_query::{Clause, Party, World};

use crate::lexicon::lexicon;

/// Most properties that tell a landmark from its like.
const MOST_PROPERTIES: usize = 2;
/// Keys that tell landmarks apart best.
const FIRST_KEYS: [&str; 3] = ["colour", "material", "size"];

/// What a scene calls its things: nouns of objects, phrases of landmarks ("the lamp", "the book that is green").
#[derive(Debug, Clone)]
pub struct Words<'a> {
    world: Option<World<'a>>,
}

impl<'a> Words<'a> {
    /// The words of a scene.
    pub fn of(tracks: &'a Tracks) -> Self {
        Self { world: Some(World::new(tracks)) }
    }

    /// All words that there are, for a reader who knows nothing of the scene: nothing has a name, so "the lamp" is
    /// described and not named.
    pub fn all() -> Self {
        Self { world: None }
    }

    /// How a landmark is called, with its article; none if no words tell it from its like.
    pub fn landmark(&self, name: &Name) -> Option<String> {
        crate::say::landmark(self, name)
    }

    /// The properties that tell this landmark from everything of its category.
    pub(crate) fn telling(&self, name: &Name) -> Option<(&'a str, Vec<Clause>)> {
        let landmark = self.world.as_ref()?.instance(name).filter(|found| found.role == Role::Landmark)?;
        lexicon().noun(&landmark.category)?;
        let mut properties: Vec<(&String, &String)> = landmark.attributes.iter().collect();
        properties.retain(|(key, value)| !lexicon().wordings(&landmark.category, key, value).is_empty());
        properties.retain(|(key, value)| !lexicon().is_unsaid(key, value));
        properties
            .sort_by_key(|(key, _)| FIRST_KEYS.iter().position(|first| first == key).unwrap_or(usize::MAX));
        let clauses: Vec<Clause> = properties
            .into_iter()
            .map(|(key, value)| Clause::Attribute { key: key.clone(), value: value.clone() })
            .collect();
        let is_enough = |chosen: &Vec<Clause>| self.only(&landmark.category, chosen) == Some(landmark);
        let pairs = (0..clauses.len()).flat_map(|a| (a + 1..clauses.len()).map(move |b| vec![a, b]));
        let sets = std::iter::once(Vec::new()).chain((0..clauses.len()).map(|at| vec![at])).chain(pairs);
        let mut choices = sets
            .filter(|set| set.len() <= MOST_PROPERTIES)
            .map(|set| set.into_iter().map(|at| clauses[at].clone()).collect::<Vec<_>>());
        Some((landmark.category.as_str(), choices.find(is_enough)?))
    }

    /// The landmark that is the only thing of its category with these properties.
    pub(crate) fn named(&self, category: &str, clauses: &[Clause]) -> Option<Name> {
        let found = self.only(category, clauses)?;
        (found.role == Role::Landmark).then(|| found.name.clone())
    }

    fn only(&self, category: &str, clauses: &[Clause]) -> Option<&'a TrackedInstance> {
        let has = |instance: &TrackedInstance, clause: &Clause| match clause {
            Clause::Attribute { key, value } => instance.attributes.get(key) == Some(value),
            _ => false,
        };
        let mut found = self.instances().filter(|instance| instance.category == category);
        let mut found = found.by_ref().filter(|instance| clauses.iter().all(|clause| has(instance, clause)));
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }

    /// Whether exactly one instance is meant.
    pub(crate) fn is_one(&self, party: &Party) -> bool {
        self.world.as_ref().is_none_or(|world| members(world, party).len() == 1)
    }

    /// How many the scene has.
    pub(crate) fn count(&self, category: &str) -> usize {
        self.instances().filter(|instance| instance.category == category).count()
    }

    /// Whether the scene has such things; without a scene, whether there is such a word.
    pub(crate) fn has_category(&self, category: &str) -> bool {
        match self.world {
            Some(_) => self.count(category) > 0,
            None => lexicon().noun(category).is_some(),
        }
    }

    /// How well a property fits such a thing: 0 if one of the category has it, then if it has such a property at all,
    /// then if anything in the scene has it.
    pub(crate) fn property_rank(&self, category: &str, key: &str, value: &str) -> usize {
        let has = |instance: &TrackedInstance| instance.attributes.get(key).is_some_and(|own| own == value);
        let alike = || self.instances().filter(|instance| instance.category == category);
        if alike().any(has) {
            0
        } else if alike().any(|instance| instance.attributes.contains_key(key)) {
            1
        } else if self.instances().any(has) {
            2
        } else {
            3
        }
    }

    /// Whether there is a scene, rather than words alone.
    pub(crate) fn is_of_a_scene(&self) -> bool {
        self.world.is_some()
    }

    /// How well a verb fits the scene: 0 if it is done in this way, then if it is done at all.
    pub(crate) fn verb_rank(&self, verb: &str, has_object: bool) -> usize {
        let Some(world) = &self.world else { return 0 };
        let mut done = world.events().filter(|event| event.verb == verb);
        match world.has_verb(verb) {
            false => 2,
            true if done.any(|event| event.object.is_some() == has_object) => 0,
            true => 1,
        }
    }

    /// Whether anything of this category does this; without a scene, whether it might.
    pub(crate) fn is_done_by(&self, verb: &str, category: &str) -> bool {
        let Some(world) = &self.world else {
            return lexicon().noun(category).is_some_and(|noun| noun.is_alive);
        };
        let is_such = |name: &Name| world.instance(name).is_some_and(|found| found.category == category);
        world.events().any(|event| event.verb == verb && is_such(&event.subject))
    }

    /// The category of all who do this to something, if there is one.
    pub(crate) fn agent(&self, verb: &str) -> Option<String> {
        let world = self.world.as_ref()?;
        let events = world.events().filter(|event| event.verb == verb && event.object.is_some());
        let mut agents = events.filter_map(|event| Some(&world.instance(&event.subject)?.category));
        let first = agents.next()?;
        agents.all(|other| other == first).then(|| first.clone())
    }

    fn instances(&self) -> impl Iterator<Item = &'a TrackedInstance> {
        self.world.iter().flat_map(World::instances)
    }
}
