//! Properties: "hair in a bun", "stripes on its fur", "green-headed". Which property words mean is what the scene has.

use l4d_query::{Clause, Superlative};

use super::data::data;
use super::guess::{Guess, Guesses, cheapest};
use super::{Wide, price};
use crate::lexicon::{Way, Wording, is_article, lexicon};

/// A piece of what is said of a thing.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Item {
    /// Values that the words may say, with how well.
    Value(Vec<(String, u32)>),
    /// Keys of the part that is named.
    Part(Vec<String>),
    /// Wordings of the lexicon that say all of it.
    Whole(Vec<&'static Wording>),
    No,
}

/// What it costs to take a colour for that of a part that nobody has named.
const FAR: u32 = 24;
/// Words within a description of parts that say nothing themselves.
const BETWEEN: &str = "and , on in of at all with its his her their the a an whole over round around that has having is are been it it's one two some \
    up made out from entire both big patch picture covered by to looking tone done ones painted printed drawn marked wearing worn tied pulled back into down that go goes reach reaches come comes running runs which kind sort you see can";
/// Words that may come before a property after the noun.
const INTRODUCTIONS: &str = "made of|made out of|made from|woven from|woven out of|full of|filled with|containing|contains|contain|that holds|filled up with|filled|containing|painted|\
    coloured|of|in|wearing|dressed in|clad in|sporting|with|having|that has|holding|marked with|decorated with|covered in|covered with|\
    bearing|carrying|stuffed with|loaded with|piled with|done in|built of|with its|with her|with his|showing|who has filled with";

/// All phrases of the grammar of properties, whose words are no misspellings.
pub(super) const PHRASES: &[&str] = &[BETWEEN, INTRODUCTIONS];

impl Wide<'_, '_> {
    /// Pieces at a place and where they end: the longest of each sort.
    pub(super) fn items(&self, at: usize) -> Vec<(Item, usize)> {
        let rest = self.rest(at);
        let mut found = Vec::new();
        let (values, length) = data().values.longest(rest);
        if length > 0 {
            found.push((Item::Value(values.into_iter().cloned().collect()), at + length));
        }
        let (parts, length) = data().parts.longest(rest);
        if length > 0 {
            found.push((Item::Part(parts.into_iter().flatten().cloned().collect()), at + length));
        }
        let mut wholes: Vec<(&'static Wording, usize)> = Vec::new();
        for way in [Way::Has, Way::Wears, Way::Is, Way::Before, Way::Lacks] {
            if !self.tokens.get(at).is_some_and(|word| is_article(word)) {
                wholes.extend(lexicon().properties_at(way, rest));
            }
        }
        let longest = wholes.iter().map(|(_, length)| *length).max().unwrap_or(0);
        if longest > 1 {
            let wordings =
                wholes.into_iter().filter(|(_, length)| *length == longest).map(|(wording, _)| wording);
            found.push((Item::Whole(wordings.collect()), at + longest));
        }
        found
    }

    /// What is said of a thing after it: "with stripes on its fur", "made of steel", "in blue trousers", "letter on it".
    pub(super) fn described_by(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let mut starts: Vec<(usize, u32, bool)> = vec![(at, 5, false)];
        for phrase in INTRODUCTIONS.split('|') {
            if let Some(next) = self.phrase(at, phrase) {
                let is_worn = phrase.contains("in") || phrase.contains("wear");
                starts.push((next, 0, is_worn));
            }
        }
        if let Some(next) = self.any_of(at, "without") {
            found.extend(self.lacking(next, noun));
        }
        for (start, cost, is_worn) in starts {
            if let Some(no) = self.any_of(start, "no not") {
                found.extend(self.lacking(no, noun));
            }
            found.extend(self.run(start, noun, is_worn).into_iter().map(|guess| guess.plus(cost)));
        }
        cheapest(found)
    }

    /// "a lid" after "without" or "no".
    pub(super) fn lacking(&self, at: usize, noun: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        // "No pattern, plain" denies the pattern alone.
        let is_one =
            |items: &[Item]| !items.windows(2).any(|pair| matches!(pair, [Item::Part(_), Item::Value(_)]));
        for guess in self.runs(at).into_iter().filter(|guess| is_one(&guess.value)) {
            let items: Vec<Item> = std::iter::once(Item::No).chain(guess.value.iter().cloned()).collect();
            if let Some((clauses, cost)) = self.resolved(noun, &items, false) {
                found.push(Guess { value: clauses, ..guess.clone().map(|_| Vec::new()) }.plus(cost));
            }
        }
        cheapest(found)
    }

    /// Pieces of a description in a row, resolved for this noun.
    pub(super) fn run(&self, at: usize, noun: &str, is_worn: bool) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        for guess in self.runs(at) {
            if let Some((clauses, cost)) = self.resolved(noun, &guess.value, is_worn) {
                found.push(Guess {
                    value: clauses,
                    end: guess.end,
                    cost: guess.cost + cost,
                    skipped: guess.skipped,
                });
            }
        }
        cheapest(found)
    }

    /// Pieces of a description in a row: as far as each of them goes.
    fn runs(&self, at: usize) -> Guesses<Vec<Item>> {
        let mut found: Guesses<Vec<Item>> = Vec::new();
        let mut next = at;
        let mut open: Guesses<Vec<Item>> = vec![Guess::new(Vec::new(), at, 0)];
        while let Some(state) = open.pop() {
            if found.len() > 40 {
                break;
            }
            next = next.max(state.end);
            let mut place = state.end;
            // Words in between say nothing, unless nothing follows.
            let mut steps = 0;
            while self.items(place).is_empty() && self.any_of(place, BETWEEN).is_some() && steps < 5 {
                place += 1;
                steps += 1;
            }
            if state.value.is_empty() && steps > 3 {
                continue;
            }
            let extra = (steps as u32).saturating_sub(2);
            for (item, end) in self.items(place) {
                let mut value = state.value.clone();
                value.push(item);
                if value.len() > 6 {
                    continue;
                }
                let longer = Guess { value, end, cost: state.cost + extra, skipped: state.skipped };
                found.push(longer.clone());
                // "On it", "in them", "of hers" belong to it.
                for tail in [
                    "on it",
                    "in it",
                    "on them",
                    "inside",
                    "inside it",
                    "on top",
                    "round its body",
                    "on its body",
                    "with it",
                    "on its side",
                    "on its sides",
                ] {
                    if let Some(end) = self.phrase(end, tail) {
                        found.push(longer.clone().ending(end));
                    }
                }
                open.push(longer);
            }
        }
        found
    }

    /// The clauses that these pieces say of such a thing, and how far-fetched that is; none if one says nothing.
    pub(super) fn resolved(&self, noun: &str, items: &[Item], is_worn: bool) -> Option<(Vec<Clause>, u32)> {
        let mut clauses: Vec<Clause> = Vec::new();
        let mut cost = 0;
        let mut pending: Vec<&Vec<(String, u32)>> = Vec::new();
        let mut part: Option<&Vec<String>> = None;
        let mut part_is_bare = false;
        let mut is_not = false;
        let mut add = |clause: Clause, is_not: bool| {
            let clause = if is_not { super::negated(clause) } else { clause };
            if !clauses.contains(&clause) {
                clauses.push(clause);
            }
        };
        for item in items {
            match item {
                Item::No => is_not = true,
                Item::Whole(wordings) => {
                    let (clause, misfit) = self.whole(noun, wordings)?;
                    add(clause, is_not);
                    cost += misfit;
                }
                Item::Value(values) => {
                    // "Hair in a bun": the part first.
                    if part_is_bare
                        && let Some((clause, misfit)) =
                            part.and_then(|keys| self.fitting(noun, values, Some(keys), is_worn))
                    {
                        add(clause, is_not);
                        cost += misfit;
                        part_is_bare = false;
                        continue;
                    }
                    pending.push(values);
                }
                // "Its roof is painted black": the roof.
                Item::Part(keys) if part_is_bare && keys.contains(&"colour".to_owned()) => {}
                Item::Part(keys) => {
                    part_is_bare = pending.is_empty();
                    for values in std::mem::take(&mut pending) {
                        let with_part = self.fitting(noun, values, Some(keys), is_worn);
                        let alone = || {
                            self.fitting(noun, values, None, is_worn)
                                .map(|(clause, misfit)| (clause, misfit + 6))
                        };
                        match with_part.or_else(alone) {
                            Some((clause, misfit)) => {
                                add(clause, is_not);
                                cost += misfit;
                            }
                            None => cost += price::CONTENT,
                        }
                    }
                    part = Some(keys);
                }
            }
        }
        for values in pending {
            let with_part = part
                .filter(|_| part_is_bare)
                .and_then(|keys| self.fitting(noun, values, Some(keys), is_worn));
            match with_part.or_else(|| self.fitting(noun, values, None, is_worn)) {
                Some((clause, misfit)) => {
                    add(clause, is_not);
                    cost += misfit;
                    part_is_bare = false;
                }
                None => cost += price::CONTENT,
            }
        }
        if part_is_bare && clauses.is_empty() {
            let (clause, misfit) = self.having(noun, part?)?;
            clauses.push(if is_not { super::negated(clause) } else { clause });
            cost += misfit;
        }
        (items.is_empty() || !clauses.is_empty()).then_some((clauses, cost))
    }

    /// That it has such a part at all.
    fn having(&self, noun: &str, keys: &[String]) -> Option<(Clause, u32)> {
        let own = self.words.properties(noun);
        for key in keys {
            let has = |value: &str| own.contains(&(key.clone(), value.to_owned()));
            let attribute = |value: &str| Clause::Attribute { key: key.clone(), value: value.to_owned() };
            if has("yes") {
                return Some((attribute("yes"), 0));
            }
            for none in ["none", "no", "plain", "bare"] {
                let is_such = !matches!(none, "plain" | "bare")
                    || keys.first() == Some(key) && key == "pattern" && keys.len() <= 2;
                if has(none) && is_such {
                    return Some((super::negated(attribute(none)), 0));
                }
            }
        }
        None
    }

    fn whole(&self, noun: &str, wordings: &[&'static Wording]) -> Option<(Clause, u32)> {
        let own = self.words.properties(noun);
        let is_own = |wording: &&&Wording| own.contains(&(wording.key.clone(), wording.value.clone()));
        let chosen = wordings.iter().find(is_own)?;
        Some((Clause::Attribute { key: chosen.key.clone(), value: chosen.value.clone() }, 0))
    }

    /// The property of such a thing that these values say best, of these parts or of the whole.
    fn fitting(
        &self,
        noun: &str,
        values: &[(String, u32)],
        keys: Option<&Vec<String>>,
        is_worn: bool,
    ) -> Option<(Clause, u32)> {
        let own = self.words.properties(noun);
        let person = lexicon().is_person(noun);
        let mut best: Option<(u32, Clause)> = None;
        let mut consider = |cost: u32, key: &str, value: &str| {
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, Clause::Attribute { key: key.to_owned(), value: value.to_owned() }));
            }
        };
        let key_cost = |key: &str| match keys {
            Some(keys) => keys.iter().position(|own| own == key).map(|at| at as u32),
            None if is_worn && person => {
                data().worn.iter().position(|own| own == key).map(|at| at as u32 / 4)
            }
            None if data().bare.iter().any(|own| own == key) => Some(0),
            None => Some(5),
        };
        // "The orange dog" is no dog with an orange collar.
        let is_colour = |value: &str| {
            let mut all = lexicon().all_wordings().iter();
            all.any(|wording| wording.key == "colour" && wording.value == value)
        };
        let is_bare = |key: &str| keys.is_some() || is_worn || data().bare.iter().any(|own| own == key);
        for (value, rank) in values {
            for (key, own_value) in &own {
                if own_value == value
                    && let Some(cost) = key_cost(key)
                {
                    let far = if !is_bare(key) && is_colour(value) { FAR } else { 0 };
                    consider(cost + (*rank).min(5) + far, key, value);
                }
            }
        }
        if let Some((cost, clause)) = best.take_if(|(cost, _)| *cost < FAR) {
            return Some((clause, cost));
        }
        if keys.is_none() && best.is_none() {
            let extreme = |name: &str| values.iter().any(|(value, _)| value == name);
            if extreme("small") {
                return Some((Clause::Superlative(Superlative::Smallest), 12));
            }
            if extreme("large") {
                return Some((Clause::Superlative(Superlative::Largest), 12));
            }
        }
        // What nothing here has: the lexicon's meaning, of the keys that such things have.
        for wording in lexicon().all_wordings() {
            let Some((_, rank)) = values.iter().find(|(value, _)| *value == wording.value) else { continue };
            let Some(cost) = key_cost(&wording.key) else { continue };
            if wording.people.is_some_and(|people| people != person) {
                continue;
            }
            let is_usual = own.iter().any(|(key, _)| *key == wording.key);
            let cost = cost + rank.min(&5) + if is_usual { 5 } else { 18 };
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((
                    cost,
                    Clause::Attribute { key: wording.key.clone(), value: wording.value.clone() },
                ));
            }
        }
        best.map(|(cost, clause)| (clause, cost))
    }
}
