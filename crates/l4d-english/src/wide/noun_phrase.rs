//! Noun phrases, with or without their articles: "furthest cup from the candle", "the black one of the ducks".

use std::rc::Rc;

use l4d_query::{Clause, Party, Predicate, Relation, Superlative};

use super::data::data;
use super::guess::{Guess, Guesses, cheapest};
use super::property::Item;
use super::{Order, Wide};
use crate::lexicon::Form;
use crate::read::SUPERLATIVES;

/// States of what goes before a noun that are followed.
const MOST_STATES: usize = 60;
const ARTICLES: &str = "the a an that this these those its his her their my your our some any each every another other others no both two three four \
    five only single sole same which whichever what whatever all various particular @some more";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Article {
    The,
    A,
    No,
}

/// A noun with what is said of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Described {
    pub(super) article: Article,
    pub(super) noun: String,
    pub(super) clauses: Vec<Clause>,
    pub(super) is_plural: bool,
}

impl Described {
    pub(super) fn predicate(&self) -> Predicate {
        let clauses =
            std::iter::once(Clause::Category(self.noun.clone())).chain(self.clauses.iter().cloned());
        Predicate(clauses.collect())
    }
}

/// What goes before a noun: what it means depends on the noun.
#[derive(Debug, Clone, PartialEq, Default)]
struct Before {
    items: Vec<Item>,
    clauses: Vec<Clause>,
    order: Option<Order>,
    nearness: Option<Relation>,
}

impl Before {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl Wide<'_, '_> {
    /// Others that are mentioned.
    pub(super) fn parties(&self, at: usize) -> Guesses<(Party, String)> {
        let mut found: Guesses<(Party, String)> = Vec::new();
        if let (Some(end), Some(before)) = (self.any_of(at, "it him her them"), &self.before) {
            found.push(Guess::new((self.party(before), before.noun.clone()), end, 0));
        }
        for guess in self.described(at, false).iter() {
            if guess.value.article != Article::No {
                found.push(
                    guess
                        .clone()
                        .plus(self.vagueness(&guess.value))
                        .map(|such| (self.party(&such), such.noun)),
                );
            }
        }
        cheapest(found)
    }

    /// What it costs to believe that "the ball" says all there is, where there are several; and that what is one of a
    /// kind needs more words.
    fn vagueness(&self, such: &Described) -> u32 {
        let is_definite = such.article == Article::The && !such.is_plural;
        match (is_definite, such.clauses.is_empty(), self.words.count(&such.noun)) {
            (true, true, 2..) if !self.is_before(such) => 6,
            (true, false, 1) => 2,
            _ => 0,
        }
    }

    /// Whether it is what an earlier sentence spoke of.
    fn is_before(&self, such: &Described) -> bool {
        let is_bare = such.article == Article::The && such.clauses.is_empty();
        self.before.as_ref().is_some_and(|before| is_bare && before.noun == such.noun)
    }

    pub(super) fn party(&self, such: &Described) -> Party {
        if let Some(before) = self.before.as_ref().filter(|_| self.is_before(such)) {
            return Party::Such(before.predicate());
        }
        if such.clauses.is_empty() || self.is_enough(such) {
            if such.article == Article::The && !such.is_plural {
                if let Some(name) = self.words.named(&such.noun, &[]) {
                    return Party::Name(name);
                }
                if self.words.count(&such.noun) <= 1 {
                    return Party::Such(Predicate(vec![Clause::Category(such.noun.clone())]));
                }
            }
            return Party::Category(such.noun.clone());
        }
        Party::Such(such.predicate())
    }

    /// Whether the noun alone tells it, and the rest is a remark that no property here is about: "the big bowl", of one bowl.
    fn is_enough(&self, such: &Described) -> bool {
        let own = self.words.properties(&such.noun);
        let is_remark = |clause: &Clause| match clause {
            Clause::Attribute { key, .. } => !own.iter().any(|(other, _)| other == key),
            Clause::Superlative(_) => true,
            _ => false,
        };
        such.article == Article::The
            && self.words.count(&such.noun) == 1
            && such.clauses.iter().all(is_remark)
    }

    /// All noun phrases at a place; with `is_top` a finite verb may follow the noun ("which dog runs").
    pub(super) fn described(&self, at: usize, is_top: bool) -> Rc<Guesses<Described>> {
        if let Some(found) = self.phrases.borrow().get(&(at, is_top)) {
            return Rc::clone(found);
        }
        self.phrases.borrow_mut().insert((at, is_top), Rc::default());
        let found =
            Rc::new(if self.may_go_on() { cheapest(self.noun_phrases(at, is_top)) } else { Vec::new() });
        self.phrases.borrow_mut().insert((at, is_top), Rc::clone(&found));
        found
    }

    fn noun_phrases(&self, at: usize, is_top: bool) -> Guesses<Described> {
        let (article, has_article, start) = self.determiner(at);
        let mut found = Vec::new();
        for before in self.before_noun(start) {
            for head in self.heads(before.end, &before.value, has_article) {
                let (noun, is_plural) = head.value.clone();
                let Some((mut clauses, misfit)) = self.resolved(&noun, &before.value.items, false) else {
                    continue;
                };
                clauses.extend(before.value.clauses.iter().cloned());
                let article = match article {
                    Some(article) => article,
                    // "A ball", where it says "balls".
                    None if is_plural => Article::A,
                    None => Article::The,
                };
                let named = before.then(head, |_, _| ()).plus(misfit);
                for near in self.near(named.end, before.value.nearness) {
                    for rest in self.after(near.end, &noun, is_top).iter() {
                        let order = before.value.order;
                        let more: Vec<Clause> = near.value.iter().chain(&rest.value).cloned().collect();
                        let Some((more, price)) = ordered(more, order) else { continue };
                        let clauses: Vec<Clause> = clauses.iter().cloned().chain(more).collect();
                        let such = Described { article, noun: noun.clone(), clauses, is_plural };
                        let whole = named.then(near.clone(), |_, _| ()).then(rest.clone(), |_, _| such);
                        found.push(whole.plus(price));
                    }
                }
            }
        }
        found
    }

    /// Articles and the like: which, whether there is one, and the place after.
    fn determiner(&self, mut at: usize) -> (Option<Article>, bool, usize) {
        let mut article = None;
        let start = at;
        if let Some(next) = self.phrase(at, "one of the|one of these|one of those|any of the|any of these|any of those|some of the|either of the|each of the|any one of the") {
            article = Some(Article::A);
            at = next;
        }
        if let Some(next) = self.phrase(at, "none of the|neither of the|none of these") {
            article = Some(Article::No);
            at = next;
        }
        while let Some(next) = self.any_of(at, ARTICLES) {
            let word = self.word(at);
            article = match word {
                "no" => Some(Article::No),
                "a" | "an" | "any" | "another" | "each" | "every" | "some" | "@some" | "other" | "others"
                    if article != Some(Article::No) =>
                {
                    Some(if article == Some(Article::The) && word == "other" {
                        Article::The
                    } else {
                        Article::A
                    })
                }
                "two" | "three" | "four" | "five" | "only" | "single" | "same" | "all" | "more" => article,
                _ => article.or(Some(Article::The)),
            };
            at = next;
        }
        (article, at > start, at)
    }

    /// Adjectives, extremes, orders and what something is doing.
    fn before_noun(&self, at: usize) -> Guesses<Before> {
        let mut found = vec![Guess::new(Before::default(), at, 0)];
        let mut next = 0;
        while let Some(state) = found.get(next).cloned() {
            next += 1;
            if found.len() > MOST_STATES || !self.may_go_on() {
                break;
            }
            let at = state.end;
            let mut push = |value: Before, end: usize, cost: u32| {
                found.push(Guess { value, end, cost: state.cost + cost, skipped: state.skipped });
            };
            if !state.value.is_empty()
                && matches!(self.word(at), "," | "and" | "the" | "one" | "very" | "but")
                && self.word(at) != "one"
            {
                push(state.value.clone(), at + 1, 0);
            }
            let mut with = |change: &dyn Fn(&mut Before), end: usize, cost: u32| {
                let mut value = state.value.clone();
                change(&mut value);
                push(value, end, cost);
            };
            for (item, end) in self.items(at) {
                with(&|before| before.items.push(item.clone()), end, 0);
            }
            for (extreme, end) in self.extreme_word(at) {
                with(&|before| before.clauses.push(Clause::Superlative(extreme)), end, 0);
            }
            if let Some(end) = self.any_of(at, "first") {
                with(&|before| before.order = Some(Order::First), end, 0);
            }
            // Of two, the second is the last.
            if let Some(end) = self.any_of(at, "second") {
                with(&|before| before.order = Some(Order::Last), end, 4);
            }
            if let Some(end) = self.any_of(at, "last") {
                with(&|before| before.order = Some(Order::Last), end, 0);
            }
            if let Some(end) = self.any_of(at, "closest closer") {
                with(&|before| before.nearness = Some(Relation::ClosestTo), end, 0);
            }
            if let Some(end) = self.any_of(at, "farthest farther") {
                with(&|before| before.nearness = Some(Relation::FarthestFrom), end, 0);
            }
            for event in self.event(at, &[Form::Ing], None, false) {
                if matches!(event.value, Clause::Does { to: None, .. }) {
                    with(&|before| before.clauses.push(event.value.clone()), event.end, event.cost + 1);
                }
            }
            let is_skippable =
                self.tokens.get(at).is_some_and(|word| !data().is_function(word) && word != ",");
            if is_skippable {
                let passed = self.pass(at);
                // "The little potted plant": what fits nowhere is no great loss before a noun.
                let is_remark = !self.items(at).is_empty() || !self.nouns(at).is_empty();
                let cost = if is_remark { 7 } else { passed.cost.min(10) };
                found.push(Guess {
                    value: state.value.clone(),
                    end: passed.end,
                    cost: state.cost + cost,
                    skipped: state.skipped | passed.skipped,
                });
            }
        }
        found
    }

    /// Superlatives and comparatives.
    pub(super) fn extreme_word(&self, at: usize) -> Vec<(Superlative, usize)> {
        let said = SUPERLATIVES.iter().filter_map(|(extreme, superlative, comparative)| {
            let end = self.any_of(at, superlative).or_else(|| self.any_of(at, comparative))?;
            Some((*extreme, end))
        });
        said.collect()
    }

    /// What the phrase is about: a noun, "one", or "of the cups".
    fn heads(&self, at: usize, before: &Before, has_article: bool) -> Guesses<(String, bool)> {
        let mut found = self.nouns(at);
        let is_one = self.any_of(at, "one ones");
        if let Some(end) = is_one {
            for several in self.of_several(end) {
                found.push(several.map(|noun| (noun, false)));
            }
            found.extend(
                self.mentioned(at).into_iter().map(|(noun, cost)| Guess::new((noun, false), end, cost + 1)),
            );
        }
        if has_article || !before.is_empty() {
            found.extend(self.of_several(at).into_iter().map(|guess| guess.map(|noun| (noun, false))));
        }
        // "Another": one of the same kind.
        if has_article
            && matches!(self.word(at.wrapping_sub(1)), "another" | "other" | "others")
            && is_one.is_none()
            && self.nouns(at).is_empty()
        {
            found.extend(
                self.mentioned(at).into_iter().map(|(noun, cost)| Guess::new((noun, false), at, cost + 2)),
            );
        }
        // "The tallest", "the last to leave".
        let can_stand_alone =
            before.order.is_some() || before.nearness.is_some() || !before.clauses.is_empty();
        if can_stand_alone && is_one.is_none() {
            found.extend(
                self.mentioned(at).into_iter().map(|(noun, cost)| Guess::new((noun, false), at, cost + 12)),
            );
        }
        cheapest(found)
    }

    /// What "one" may repeat at a place: what the sentence is about, then what was named before.
    pub(super) fn mentioned(&self, at: usize) -> Vec<(String, u32)> {
        let mut found: Vec<(String, u32)> = Vec::new();
        let add = |noun: &str, cost: u32, found: &mut Vec<(String, u32)>| {
            if !found.iter().any(|(own, _)| own == noun) {
                found.push((noun.to_owned(), cost));
            }
        };
        let head = self.mentions.iter().find(|(_, noun)| self.words.is_object(noun));
        let later = head.is_some_and(|(place, _)| *place >= at);
        if let Some((_, noun)) = head {
            add(noun, if later { 1 } else { 0 }, &mut found);
        }
        if let Some(before) = &self.before {
            add(&before.noun, 1, &mut found);
        }
        for (_, noun) in self.mentions.iter().rev().filter(|(place, _)| *place < at) {
            add(noun, 2, &mut found);
        }
        if head.is_none() {
            let objects =
                self.words.categories().into_iter().filter(|category| self.words.is_object(category));
            objects.for_each(|category| add(&category, 8, &mut found));
        }
        found
    }

    /// "of the cups", "of all of these cups".
    fn of_several(&self, at: usize) -> Guesses<String> {
        let Some(mut next) = self.phrase(at, "of|from|out of|among") else { return Vec::new() };
        while let Some(after) =
            self.any_of(next, "the these those all both of two three four five other our @all their")
        {
            next = after;
        }
        self.nouns(next)
            .into_iter()
            .filter(|guess| guess.value.1)
            .map(|guess| guess.map(|(noun, _)| noun))
            .collect()
    }

    /// Nouns at a place, and whether they are in the plural.
    pub(super) fn nouns(&self, at: usize) -> Guesses<(String, bool)> {
        let mut found: Guesses<(String, bool)> = Vec::new();
        let rest = self.rest(at);
        for (naming, length) in data().nouns.at(rest) {
            let end = at + length;
            for (category, distance) in &naming.categories {
                let is_plural = naming.is_plural && !rest.is_empty();
                if self.words.has_category(category) {
                    let cost = distance * 2 + u32::from(!self.words.is_object(category));
                    found.push(Guess::new((category.clone(), is_plural), end, cost));
                    continue;
                }
                if *distance > 1 {
                    continue;
                }
                // What the scene has not: perhaps something like it is meant.
                for other in data().near.get(category).into_iter().flatten() {
                    if self.words.has_category(other) {
                        found.push(Guess::new((other.clone(), is_plural), end, 8 + distance));
                    }
                }
                found.push(Guess::new((category.clone(), is_plural), end, 16 + distance));
            }
        }
        // A longer name says more: "hay bale" is no bale of something else.
        if let Some(longest) = found.iter().map(|guess| guess.end).max() {
            found.iter_mut().for_each(|guess| guess.cost += 3 * (longest - guess.end) as u32);
        }
        cheapest(found)
    }

    /// "from the candle", after "farthest cup".
    fn near(&self, at: usize, nearness: Option<Relation>) -> Guesses<Vec<Clause>> {
        let Some(kind) = nearness else { return vec![Guess::new(Vec::new(), at, 0)] };
        let mut start = self.skip(at, "of all|@all|of them all");
        start = self.skip(start, "away|off|by");
        let Some(of) = self.any_of(start, "to from by") else { return Vec::new() };
        let parties = self.parties(of).into_iter();
        parties
            .map(|guess| guess.map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }]))
            .collect()
    }
}

/// "First" and "last" order the first event that is spoken of.
fn ordered(clauses: Vec<Clause>, order: Option<Order>) -> Option<(Vec<Clause>, u32)> {
    let Some(order) = order else { return Some((clauses, 0)) };
    match order.of(clauses.clone()) {
        Some(ordered) => Some((ordered, 0)),
        None => Some((clauses, 20)),
    }
}
