//! What a scene calls its things: which nouns, verbs and properties it has, and by which words its landmarks are known.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::{Name, Role, Temporal};
use l4d_query::eval::{answer_times, answer_whole, members};
use l4d_query::{Clause, Party, Predicate, World};

use crate::lexicon::lexicon;

/// Most properties that tell a landmark from its like.
const MOST_PROPERTIES: usize = 2;
/// Keys that tell landmarks apart best.
const FIRST_KEYS: [&str; 3] = ["colour", "material", "size"];

/// What a scene calls its things: nouns of objects, phrases of landmarks ("the lamp", "the book that is green").
#[derive(Debug, Clone)]
pub struct Words<'a> {
    world: Option<World<'a>>,
    known: Option<&'a Vocabulary>,
}

/// What may be spoken of where no tracks say what there is: the words that a network knows.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Vocabulary {
    /// Categories, and whether such things are objects or landmarks.
    pub nouns: BTreeMap<String, Role>,
    /// Values of each property.
    pub attributes: BTreeMap<String, BTreeSet<String>>,
    pub verbs: BTreeSet<String>,
}

impl<'a> Words<'a> {
    /// The words of a scene.
    pub fn of(tracks: &'a Tracks) -> Self {
        Self { world: Some(World::new(tracks)), known: None }
    }

    /// The words of a network, for a scene that no one has annotated: nothing has a name.
    pub fn of_vocabulary(known: &'a Vocabulary) -> Self {
        Self { world: None, known: Some(known) }
    }

    /// All words that there are, for a reader who knows nothing of the scene: nothing has a name, so "the lamp" is
    /// described and not named.
    pub fn all() -> Self {
        Self { world: None, known: None }
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
        match (&self.world, self.known) {
            (Some(_), _) => self.count(category) > 0,
            (None, Some(known)) => known.nouns.contains_key(category),
            (None, None) => lexicon().noun(category).is_some(),
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
        let Some(world) = &self.world else {
            return if self.known.is_none_or(|known| known.verbs.contains(verb)) { 0 } else { 2 };
        };
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

    /// Whether queries may ask for such things.
    pub(crate) fn is_object(&self, category: &str) -> bool {
        match (&self.world, self.known) {
            (Some(_), _) => {
                self.instances().any(|found| found.category == category && found.role == Role::Object)
            }
            (None, Some(known)) => known.nouns.get(category) == Some(&Role::Object),
            (None, None) => true,
        }
    }

    /// All categories that there are.
    pub(crate) fn categories(&self) -> BTreeSet<String> {
        match (&self.world, self.known) {
            (Some(_), _) => self.instances().map(|found| found.category.clone()).collect(),
            (None, Some(known)) => known.nouns.keys().cloned().collect(),
            (None, None) => lexicon().nouns().map(|(category, _)| category.to_owned()).collect(),
        }
    }

    /// Properties and values of such things; of a network, all that it knows.
    pub(crate) fn properties(&self, category: &str) -> BTreeSet<(String, String)> {
        if let Some(known) = self.known.filter(|_| self.world.is_none()) {
            let pairs = known.attributes.iter();
            return pairs
                .flat_map(|(key, values)| values.iter().map(move |value| (key.clone(), value.clone())))
                .collect();
        }
        let alike = self.instances().filter(|instance| instance.category == category);
        alike.flat_map(|instance| instance.attributes.clone()).collect()
    }

    /// Verbs that are done.
    pub(crate) fn verbs(&self) -> BTreeSet<String> {
        match (&self.world, self.known) {
            (Some(world), _) => world.events().map(|event| event.verb.clone()).collect(),
            (None, Some(known)) => known.verbs.clone(),
            (None, None) => lexicon().verbs().map(|(verb, _)| verb.to_owned()).collect(),
        }
    }

    /// How far it is from what happens that such a thing does this, to such an other; 0 is what happens.
    pub(crate) fn misfit(&self, verb: &str, subject: Option<&str>, object: Option<&str>) -> u32 {
        let Some(world) = &self.world else {
            let is_known = self.known.is_none_or(|known| known.verbs.contains(verb));
            return if is_known { 0 } else { 40 };
        };
        let is_a = |name: &Name, category: Option<&str>| {
            category.is_none_or(|wanted| world.instance(name).is_some_and(|found| found.category == wanted))
        };
        let mut least = 40;
        for event in world.events().filter(|event| event.verb == verb) {
            let same_subject = is_a(&event.subject, subject);
            let cost = match (&event.object, object) {
                (Some(own), Some(_)) if is_a(own, object) => 0,
                (None, None) => 0,
                (Some(_), None) => 4,
                (Some(_), Some(_)) => 8,
                (None, Some(_)) => 14,
            };
            least = least.min(cost + if same_subject { 0 } else { 8 });
        }
        least
    }

    /// The category of those who do this to such things, if anything does.
    pub(crate) fn usual_agent(&self, verb: &str, object: &str) -> Option<String> {
        let world = self.world.as_ref()?;
        let category = |name: &Name| world.instance(name).map(|found| found.category.clone());
        let done = world.events().filter(|event| event.verb == verb);
        let to_such =
            done.filter(|event| event.object.as_ref().and_then(category).is_some_and(|own| own == object));
        to_such.filter_map(|event| category(&event.subject)).next().or_else(|| self.agent(verb))
    }

    /// Whether the scene has every kind of thing and every property that this speaks of.
    pub(crate) fn has_all_of(&self, predicate: &Predicate) -> bool {
        if !self.is_of_a_scene() && self.known.is_none() {
            return true;
        }
        let noun = predicate.noun();
        let own = self.properties(noun);
        let has = |clause: &Clause| match clause {
            Clause::Attribute { key, value } => own.contains(&(key.clone(), value.clone())),
            Clause::Does { verb, .. } | Clause::Undergoes { verb, .. } => self.verb_rank(verb, true) < 2,
            _ => true,
        };
        let clauses = predicate.0.iter().flat_map(|clause| self.own_clauses(clause));
        let of_others = predicate.parties().into_iter().all(|party| match party {
            Party::Such(described) => self.has_all_of(described),
            Party::Category(category) => self.has_category(category),
            Party::Name(_) => true,
        });
        self.has_category(noun) && of_others && clauses.into_iter().all(has)
    }

    /// A clause and those inside it, without those of others.
    fn own_clauses<'c>(&self, clause: &'c Clause) -> Vec<&'c Clause> {
        let inner = clause.inner().iter().flat_map(|inner| self.own_clauses(inner));
        std::iter::once(clause).chain(inner).collect()
    }

    /// Whether exactly one object of the scene is described; never where there is no scene to look at.
    pub(crate) fn has_one_answer(&self, predicate: &Predicate, temporal: Temporal) -> bool {
        self.world.as_ref().is_some_and(|world| match temporal {
            Temporal::Whole => answer_whole(world, predicate).len() == 1,
            Temporal::While => answer_times(world, predicate).len() == 1,
        })
    }

    fn instances(&self) -> impl Iterator<Item = &'a TrackedInstance> {
        self.world.iter().flat_map(World::instances)
    }
}
