//! Noun phrases: what is said of a thing, each clause in one of the places that it can have.

use l4d_data::Name;
use l4d_query::{Clause, Party, Predicate};

use super::clause::{Slot, is_among_its_like};
use super::{Said, Speaker, cheapest, products, said};
use crate::lexicon::{lexicon, tokens};

/// Wordings of others that are tried.
const MOST_MENTIONS: usize = 4;
/// Ways to place the clauses of one noun that are tried.
const MOST_PHRASES: usize = 600;
/// Wordings of one clause that are tried where there are several.
const MOST_SLOTS: usize = 9;

/// What goes around a noun, without the article.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    before: Vec<(u8, String)>,
    noun: Option<String>,
    after: Vec<(u8, String)>,
    relatives: Vec<String>,
    gaps: Vec<String>,
    /// "first", and "to jump".
    ordered: Option<(&'static str, String)>,
    cost: f64,
}

impl Parts {
    fn of(chosen: &[(Slot, f64)]) -> Option<Self> {
        let mut parts = Self::default();
        for (slot, cost) in chosen {
            parts.cost += cost;
            match slot.clone() {
                Slot::Before(order, text) => parts.before.push((order, text)),
                Slot::Noun(text) if parts.noun.is_some() => drop(text),
                Slot::Noun(text) => parts.noun = Some(text),
                Slot::After(order, text) => parts.after.push((order, text)),
                Slot::Relative(text) => parts.relatives.push(text),
                Slot::Gap(text) => parts.gaps.push(text),
                Slot::Ordered(which, text) => parts.ordered = Some((which, text)),
            }
        }
        let clauses = parts.relatives.len() + parts.gaps.len();
        let fits = clauses <= 2 && parts.after.len() <= 3 && (parts.ordered.is_none() || chosen.len() == 1);
        // Two relative clauses are more than one.
        parts.cost += if clauses == 2 { 0.3 } else { 0.0 };
        parts.before.sort();
        parts.after.sort();
        (fits && parts.join_alike()).then_some(parts)
    }

    /// "in a red top and jeans" instead of "in a red top in jeans"; false if it would be "in" and "wearing".
    fn join_alike(&mut self) -> bool {
        let starts = |text: &str, word: &str| text.starts_with(word) && !text.starts_with("in front");
        let has = |word: &str| self.after.iter().any(|(order, text)| *order == 1 && starts(text, word));
        if has("in ") && has("wearing ") {
            return false;
        }
        let mut joined: Vec<(u8, String)> = Vec::new();
        for (order, text) in self.after.drain(..) {
            let words = ["in ", "wearing ", "with "];
            let alike = joined.last().and_then(|(other, last)| {
                let word = words.iter().find(|word| last.starts_with(**word) && text.starts_with(**word))?;
                (order <= 2 && *other == order).then(|| text[word.len()..].to_owned())
            });
            match (alike, joined.last_mut()) {
                (Some(more), Some((_, last))) => *last += &format!(" and {more}"),
                _ => joined.push((order, text)),
            }
        }
        self.after = joined;
        true
    }

    /// Whether anything but adjectives tells it from others.
    pub(super) fn has_clause(&self) -> bool {
        !self.relatives.is_empty() || !self.gaps.is_empty() || !self.after.is_empty()
    }

    /// "red cup on the tray that rolls", with this noun and this relative pronoun.
    fn text(&self, noun: &str, pronoun: &str) -> String {
        let noun = self.noun.as_deref().unwrap_or(noun);
        let mut words: Vec<&str> = Vec::new();
        words.extend(self.ordered.as_ref().map(|(which, _)| *which));
        words.extend(self.before.iter().map(|(_, text)| text.as_str()));
        words.push(noun);
        words.extend(self.after.iter().map(|(_, text)| text.as_str()));
        words.extend(self.ordered.as_ref().map(|(_, text)| text.as_str()));
        let mut text = words.join(" ");
        text += &self.relative_clauses(pronoun);
        text
    }

    fn relative_clauses(&self, pronoun: &str) -> String {
        let mut clauses = Vec::new();
        if !self.relatives.is_empty() {
            clauses.push(format!(" {pronoun} {}", self.relatives.join(" and ")));
        }
        let object_pronoun = if pronoun == "who" { "that" } else { pronoun };
        clauses.extend(self.gaps.iter().map(|gap| format!(" {object_pronoun} {gap}")));
        clauses.join(" and")
    }
}

impl Speaker<'_, '_> {
    /// All sentences that name an identity.
    pub(super) fn whole_sentences(&self, predicate: &Predicate) -> Vec<Said> {
        let mut found = Vec::new();
        let clauses: Vec<&Clause> = predicate.discriminating().collect();
        // What can only be true of one is never "the only" one.
        let is_extreme = clauses.iter().any(|clause| ranks(clause));
        for parts in self.parts(predicate.noun(), &clauses, true) {
            let mut sentences = self.sentences(predicate.noun(), &parts);
            sentences.retain(|sentence| !is_extreme || !sentence.text.starts_with("the only "));
            found.extend(sentences);
        }
        found
    }

    /// The same phrase as different sentences.
    pub(super) fn sentences(&self, category: &str, parts: &Parts) -> Vec<Said> {
        let Some(noun) = lexicon().noun(category) else { return Vec::new() };
        let mut found = Vec::new();
        for (pronoun, cost) in pronouns(category, parts) {
            let text = parts.text(&noun.singular, pronoun);
            found.push(said(format!("the {text}"), parts.cost + cost));
            if parts.has_clause() && !parts.before.iter().any(|(order, _)| *order == 0) {
                found.push(said(format!("the only {text}"), parts.cost + cost + 0.35));
            }
        }
        if let (Some((which, ordered)), true) = (&parts.ordered, self.words.count(category) > 1) {
            found.push(said(format!("the {which} of the {} {ordered}", noun.plural), parts.cost + 0.25));
        }
        if let ([gap], []) = (&parts.gaps[..], &parts.relatives[..])
            && parts.after.is_empty()
            && !gap.starts_with("another ")
        {
            let text = Parts { gaps: Vec::new(), ..parts.clone() }.text(&noun.singular, "that");
            found.push(said(format!("the {text} {gap}"), parts.cost + 0.3));
        }
        if let ([(0, extreme)], [], None) = (&parts.before[..], &parts.after[..], &parts.noun)
            && !parts.has_clause()
        {
            let count = self.words.count(category);
            let of = if count == 2 { "of the two" } else { "of the" };
            // Of two, the larger; of more, the largest.
            if (count == 2) == extreme.ends_with('r') {
                found.push(said(format!("the {extreme} {of} {}", noun.plural), parts.cost + 0.15));
            }
        }
        let is_bare = parts.before.is_empty() && parts.after.is_empty() && parts.noun.is_none();
        if is_bare
            && parts.ordered.is_none()
            && parts.relatives.len() + parts.gaps.len() == 1
            && self.words.count(category) > 1
        {
            let clause = parts.relative_clauses(pronouns(category, parts)[0].0);
            let repeats = tokens(&clause).iter().any(|word| *word == noun.plural || *word == noun.singular);
            found.push(said(
                format!("of the {}, the one{clause}", noun.plural),
                parts.cost + if repeats { 2.0 } else { 0.25 },
            ));
        }
        found
    }

    /// All ways to place these clauses around the noun.
    pub(super) fn parts(&self, category: &str, clauses: &[&Clause], is_sentence: bool) -> Vec<Parts> {
        let is_alone = clauses.len() == 1;
        let mut choices = Vec::new();
        for clause in clauses {
            let mut slots = self.slots(category, clause, is_alone);
            slots.sort_by(|a, b| a.1.total_cmp(&b.1));
            slots.truncate(if is_alone && is_sentence { usize::MAX } else { MOST_SLOTS });
            choices.push(slots);
        }
        products(&choices, MOST_PHRASES).iter().filter_map(|chosen| Parts::of(chosen)).collect()
    }

    /// "the lamp", "a hand", "another one", "the red one", "the woman who waves".
    pub(super) fn mentions(&self, party: &Party) -> Vec<Said> {
        let found = match party {
            Party::Name(name) => self.named(name),
            Party::Category(category) => self.any(category),
            Party::Such(predicate) => self.described(predicate, self.words.is_one(party)),
        };
        cheapest(found, MOST_MENTIONS)
    }

    /// A landmark, by what tells it from its like.
    pub(super) fn named(&self, name: &Name) -> Vec<Said> {
        let Some((category, clauses)) = self.words.telling(name) else { return Vec::new() };
        let all: Vec<&Clause> = clauses.iter().collect();
        let mut found = self.noun_phrases(category, &all, "the");
        // Without a relative clause it would be described rather than named.
        found.retain(|phrase| {
            clauses.is_empty() || phrase.text.contains(" that ") || phrase.text.contains(" who ")
        });
        found
    }

    fn any(&self, category: &str) -> Vec<Said> {
        let Some(noun) = lexicon().noun(category) else { return Vec::new() };
        if !noun.counts() {
            return vec![said(noun.singular.clone(), 0.0)];
        }
        if self.head.as_deref() == Some(category) {
            return vec![said(format!("another {}", noun.singular), 0.0), said("another one", 0.05)];
        }
        vec![said(format!("a {}", noun.singular), 0.0)]
    }

    fn described(&self, predicate: &Predicate, is_one: bool) -> Vec<Said> {
        let clauses: Vec<&Clause> = predicate.discriminating().collect();
        self.noun_phrases(predicate.noun(), &clauses, if is_one { "the" } else { "a" })
    }

    fn noun_phrases(&self, category: &str, clauses: &[&Clause], article: &str) -> Vec<Said> {
        let Some(noun) = lexicon().noun(category) else { return Vec::new() };
        let is_like_head = self.head.as_deref() == Some(category) && !clauses.is_empty();
        let mut found = Vec::new();
        for parts in self.parts(category, clauses, false) {
            let pronoun = pronouns(category, &parts)[0].0;
            if is_like_head && parts.noun.is_none() {
                found.push(said(format!("{article} {}", parts.text("one", pronoun)), parts.cost));
            }
            let cost = parts.cost + if is_like_head { 0.2 } else { 0.0 };
            let is_countless = article == "a" && !noun.counts();
            let article = if is_countless { "" } else { article };
            found.push(said(format!("{article} {}", parts.text(&noun.singular, pronoun)), cost));
        }
        found
    }
}

/// Whether it compares with all others of the category.
fn ranks(clause: &Clause) -> bool {
    match clause {
        Clause::Superlative(_) | Clause::First(_) | Clause::Last(_) => true,
        Clause::Relation { kind, .. } => is_among_its_like(*kind),
        Clause::AtStart(inner) | Clause::AtEnd(inner) => ranks(inner),
        _ => false,
    }
}

/// Relative pronouns, the best first.
fn pronouns(category: &str, parts: &Parts) -> Vec<(&'static str, f64)> {
    if parts.relatives.is_empty() && parts.gaps.is_empty() {
        vec![("that", 0.0)]
    } else if lexicon().is_person(category) && !parts.relatives.is_empty() {
        vec![("who", 0.0), ("that", 0.35)]
    } else {
        vec![("that", 0.0), ("which", 0.15)]
    }
}
