//! Reads noun phrases: "the red cup on the tray that a hand lifts". Every function gives all readings that start at a
//! word, each with the word after its end; which of them is meant is decided elsewhere.

use std::rc::Rc;

use l4d_query::{Clause, Party, Predicate};

use super::{Reader, Readings, distinct};
use crate::lexicon::{Form, Way, Wording, lexicon};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Article {
    The,
    A,
    No,
}

/// A noun phrase: a noun and the clauses that its modifiers mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Phrase {
    pub(super) article: Article,
    pub(super) noun: String,
    pub(super) clauses: Vec<Clause>,
    /// Whether one of the clauses comes from a relative clause.
    pub(super) has_relative: bool,
}

/// A modifier before the noun: what an adjective means depends on the noun.
#[derive(Debug, Clone, PartialEq)]
enum Premodifier {
    Property(Vec<&'static Wording>),
    Clause(Clause),
}

/// "First" or "last" before the noun: order in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    First,
    Last,
}

impl Order {
    pub(super) fn of(self, clause: Clause) -> Clause {
        match self {
            Self::First => Clause::First(Box::new(clause)),
            Self::Last => Clause::Last(Box::new(clause)),
        }
    }
}

impl Phrase {
    pub(super) fn predicate(&self) -> Predicate {
        let mut clauses = vec![Clause::Category(self.noun.clone())];
        clauses.extend(self.clauses.iter().cloned());
        Predicate(clauses)
    }
}

impl Reader<'_, '_> {
    /// The other participants of a clause: "the lamp", "a hand", "another cup", "the red one".
    pub(super) fn parties(&self, at: usize) -> Readings<Party> {
        let phrases = self.phrases_at(at);
        let meant = phrases.iter().filter(|(phrase, _)| phrase.article != Article::No);
        distinct(meant.map(|(phrase, end)| (self.party(phrase), *end)).collect())
    }

    pub(super) fn party(&self, phrase: &Phrase) -> Party {
        if phrase.article != Article::The {
            return match phrase.clauses.is_empty() {
                true => Party::Category(phrase.noun.clone()),
                false => Party::Such(phrase.predicate()),
            };
        }
        // "The lamp" is a name where there is one lamp; "the green book" describes a book; "the book that is green"
        // names a landmark that has no shorter name.
        let is_name = phrase.clauses.is_empty()
            || phrase.has_relative
                && phrase.clauses.iter().all(|clause| matches!(clause, Clause::Attribute { .. }));
        match self.words.named(&phrase.noun, &phrase.clauses).filter(|_| is_name) {
            Some(name) => Party::Name(name),
            // "The hand" where there are several is any of them.
            _ if phrase.clauses.is_empty() && self.words.count(&phrase.noun) > 1 => {
                Party::Category(phrase.noun.clone())
            }
            _ => Party::Such(phrase.predicate()),
        }
    }

    /// All readings of a noun phrase that starts at word `at`, the likeliest first.
    pub(super) fn phrases_at(&self, at: usize) -> Rc<Readings<Phrase>> {
        if let Some(found) = self.phrases.borrow().get(&at) {
            return Rc::clone(found);
        }
        let mut found = self.noun_phrases(at);
        let is_name = |phrase: &Phrase| matches!(self.party(phrase), Party::Name(_));
        // A name is complete without modifiers. Otherwise the longest reading is the likeliest: a modifier mostly
        // belongs to the noun right before it.
        found.sort_by_key(|(phrase, end)| (!is_name(phrase), std::cmp::Reverse(*end)));
        let found = Rc::new(distinct(found));
        self.phrases.borrow_mut().insert(at, Rc::clone(&found));
        found
    }

    fn noun_phrases(&self, at: usize) -> Readings<Phrase> {
        if let Some(another) = self.any_of(at, "another") {
            return self.after_another(another);
        }
        let (article, next) = if let Some(next) = self.any_of(at, "the") {
            (Article::The, self.skip(next, "only|one and only|same"))
        } else if let Some(next) = self.any_of(at, "a an any some each every") {
            (Article::A, next)
        } else if let Some(next) = self.any_of(at, "no") {
            (Article::No, next)
        } else {
            return self.bare_nominals(at);
        };
        self.nominals(next, article)
    }

    /// Bare noun phrases, of nouns that need no article: "water", "books".
    fn bare_nominals(&self, at: usize) -> Readings<Phrase> {
        let can_be_bare = |noun: &str| lexicon().noun(noun).is_some_and(|noun| !noun.counts());
        let mut found = self.nominals(at, Article::A);
        found.retain(|(phrase, _)| can_be_bare(&phrase.noun));
        found
    }

    /// After "another": the noun, "one", or nothing.
    fn after_another(&self, at: usize) -> Readings<Phrase> {
        let mut found = self.nominals(at, Article::A);
        if let Some(noun) = self.head.borrow().clone() {
            found.push((Phrase { article: Article::A, noun, clauses: Vec::new(), has_relative: false }, at));
        }
        found
    }

    /// A noun phrase without its article: ordinal, premodifiers, noun, postmodifiers.
    fn nominals(&self, at: usize, article: Article) -> Readings<Phrase> {
        let order = match self.word(at) {
            "first" => Some(Order::First),
            "last" => Some(Order::Last),
            _ => None,
        };
        let start = if order.is_some() { self.reached(at + 1) } else { at };
        let mut found = Readings::new();
        for (before, noun_at) in self.premodifiers(start) {
            let is_extreme = matches!(before.last(), Some(Premodifier::Clause(Clause::Superlative(_))));
            let mut nouns = self.nouns(noun_at);
            if order.is_some() || is_extreme {
                nouns.extend(self.partitive(noun_at).into_iter().map(|(noun, end)| (noun, None, end)));
            }
            for (noun, extra, after) in nouns {
                for mut clauses in self.resolved(&before, &noun) {
                    clauses.extend(extra.clone());
                    for (ordered, next) in self.ordered(after, order, &noun) {
                        for ((more, has_relative), end) in self.after_noun(next, &noun) {
                            let all = clauses.iter().chain(&ordered).cloned().chain(more);
                            let clauses = all.collect();
                            let noun = noun.clone();
                            found.push((Phrase { article, noun, clauses, has_relative }, end));
                        }
                    }
                }
            }
        }
        found
    }

    /// A partitive after "the first" or "the tallest": "of the cups".
    fn partitive(&self, at: usize) -> Readings<String> {
        let starts =
            self.phrases(at, "of the|of all the|of all|of the two|of the three|of the four|of the five");
        starts.into_iter().flat_map(|next| self.categories(next, true)).collect()
    }

    /// The event that "first" or "last" orders: "to jump", "that jumps", "lifted by a hand".
    fn ordered(&self, at: usize, order: Option<Order>, noun: &str) -> Readings<Vec<Clause>> {
        let Some(order) = order else { return vec![(Vec::new(), at)] };
        let mut found: Readings<Clause> = Vec::new();
        if let Some(to) = self.any_of(at, "to") {
            found.extend(self.event(to, Form::Base));
            for be in self.phrases(to, "be|get") {
                found.extend(self.passive(be));
            }
        }
        for (clauses, end) in self.relative(at, noun) {
            if let [clause] = &clauses[..] {
                found.push((clause.clone(), end));
            }
        }
        found.extend(self.passive(at));
        found.extend(self.contact_relative(at));
        found.retain(|(clause, _)| matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. }));
        distinct(found.into_iter().map(|(clause, end)| (vec![order.of(clause)], end)).collect())
    }

    /// Sequences of premodifiers: adjectives, superlatives, participles ("the rolling ball"); also the empty one.
    fn premodifiers(&self, at: usize) -> Readings<Vec<Premodifier>> {
        let mut found = vec![(Vec::new(), at)];
        let mut next = 0;
        while let Some((before, at)) = found.get(next).cloned() {
            next += 1;
            let mut more: Readings<Premodifier> = Vec::new();
            for way in [Way::Adjective, Way::Before] {
                let wordings = self.wordings(at, way).into_iter();
                more.extend(wordings.map(|(wordings, end)| (Premodifier::Property(wordings), end)));
            }
            more.extend(
                self.superlative(at).into_iter().map(|(clause, end)| (Premodifier::Clause(clause), end)),
            );
            let doing = self.event(at, Form::Ing).into_iter();
            let doing = doing.filter(|(clause, _)| matches!(clause, Clause::Does { to: None, .. }));
            more.extend(doing.map(|(clause, end)| (Premodifier::Clause(clause), end)));
            for (item, end) in more {
                let mut longer = before.clone();
                longer.push(item);
                // "big and red", "big, red".
                found.push((longer, self.skip(end, "and")));
            }
        }
        found
    }

    /// The clauses that premodifiers mean before this noun, one list for each combination of their meanings.
    fn resolved(&self, before: &[Premodifier], noun: &str) -> Vec<Vec<Clause>> {
        let mut found = vec![Vec::new()];
        for item in before {
            let choices = match item {
                Premodifier::Property(wordings) => self.meant(noun, wordings),
                Premodifier::Clause(clause) => vec![clause.clone()],
            };
            found = found
                .into_iter()
                .flat_map(|clauses: Vec<Clause>| {
                    choices.iter().map(move |choice| [&clauses[..], std::slice::from_ref(choice)].concat())
                })
                .collect();
        }
        found
    }

    /// Categories that a noun at word `at` can mean, with the attribute that the noun itself implies, if any.
    pub(super) fn nouns(&self, at: usize) -> Vec<(String, Option<Clause>, usize)> {
        let mut found = Vec::new();
        for (category, end) in self.categories(at, false) {
            found.push((category, None, end));
        }
        for (wordings, end) in self.wordings(at, Way::Noun) {
            for wording in wordings {
                let Some(category) = &wording.category else { continue };
                if self.words.has_category(category) {
                    let clause = Clause::Attribute { key: wording.key.clone(), value: wording.value.clone() };
                    found.push((category.clone(), Some(clause), end));
                }
            }
        }
        if let (Some(end), Some(head)) = (self.any_of(at, "one"), self.head.borrow().clone()) {
            found.push((head, None, end));
        }
        found
    }

    /// Categories that are named at word `at`. Of those that as many words name, the ones of the scene are kept if
    /// there are any, then the ones whose own singular or plural these words are.
    pub(super) fn categories(&self, at: usize, plural: bool) -> Readings<String> {
        let rest = self.rest(at);
        let named = if plural { lexicon().plural_at(rest) } else { lexicon().singular_at(rest) };
        let mut found: Readings<String> = Vec::new();
        let mut lengths: Vec<usize> = named.iter().map(|(_, length)| *length).collect();
        lengths.sort_unstable_by(|a, b| b.cmp(a));
        lengths.dedup();
        for length in lengths {
            let same_words: Vec<&str> =
                named.iter().filter(|(_, other)| *other == length).map(|(category, _)| *category).collect();
            let words = rest[..length].join(" ");
            let is_exact = |category: &&str| {
                lexicon()
                    .noun(category)
                    .is_some_and(|noun| if plural { noun.plural == words } else { noun.singular == words })
            };
            let present: Vec<&str> =
                same_words.iter().filter(|category| self.words.has_category(category)).copied().collect();
            let pool = if present.is_empty() { same_words } else { present };
            let exact: Vec<&str> = pool.iter().filter(|category| is_exact(category)).copied().collect();
            let pool = if exact.is_empty() { pool } else { exact };
            let end = self.reached(at + length);
            found.extend(pool.into_iter().map(|category| (category.to_owned(), end)));
        }
        found
    }

    /// Sequences of postmodifiers of `noun`, and whether a relative clause is among them; also the empty one.
    pub(super) fn after_noun(&self, at: usize, noun: &str) -> Readings<(Vec<Clause>, bool)> {
        let mut found = vec![((Vec::new(), false), at)];
        for ((clauses, is_relative), next) in self.modifier(at, noun) {
            // "and" joins two relative clauses or two other modifiers, not one of each: "on the tray and beside the
            // lamp", "that rolls and that a hand lifts".
            let (next, is_joined) = match self.any_of(next, "and") {
                Some(after) if !self.is_end(after) => (after, true),
                _ => (next, false),
            };
            let starts_relative = self.any_of(next, "that which who whom whose").is_some();
            if is_joined && starts_relative != is_relative {
                continue;
            }
            for ((more, has_relative), end) in self.after_noun(next, noun) {
                if is_joined && more.is_empty() {
                    continue;
                }
                let all = [&clauses[..], &more[..]].concat();
                found.push(((all, is_relative || has_relative), end));
            }
        }
        distinct(found)
    }

    /// One postmodifier, and whether it is a relative clause.
    fn modifier(&self, at: usize, noun: &str) -> Readings<(Vec<Clause>, bool)> {
        let plain = self.state(at, noun).into_iter();
        let mut found: Readings<(Vec<Clause>, bool)> =
            plain.map(|(clause, end)| ((vec![clause], false), end)).collect();
        let relatives = self.relative(at, noun).into_iter();
        found.extend(relatives.map(|(clauses, end)| ((clauses, true), end)));
        found.extend(self.property_pairs(at, noun).into_iter().map(|(clauses, end)| ((clauses, false), end)));
        let contact = self.contact_relative(at).into_iter();
        found.extend(contact.map(|(clause, end)| ((vec![clause], true), end)));
        found
    }
}
