//! Sentences that say when: "the cup while a hand lifts it", "the dog while running".

use l4d_query::{Clause, Party, Predicate};

use super::finite::{Person, in_form};
use super::{Said, Speaker, changes, cheapest, products, said};
use crate::lexicon::{Form, lexicon};

/// Wordings of one clause that are tried.
const MOST_GATES: usize = 12;
/// Ways to name the thing that are tried.
const MOST_NAMES: usize = 8;

/// What may follow "while".
#[derive(Debug, Clone)]
enum Gate {
    /// After the pronoun: "rolls".
    Finite(String),
    /// On its own: "rolling", "on the tray".
    Bare(String),
    /// With its own subject: "a hand lifts it".
    Own(String),
}

impl Speaker<'_, '_> {
    /// All sentences that count while something holds.
    pub(super) fn gated_sentences(&self, predicate: &Predicate) -> Vec<Said> {
        let category = predicate.noun();
        let (constant, changing): (Vec<&Clause>, Vec<&Clause>) =
            predicate.discriminating().partition(|clause| !changes(clause));
        let mut found = Vec::new();
        // One of several may be said of the thing instead of the time: "the cup on the tray while it is lifted".
        let mut splits = vec![(constant.clone(), changing.clone())];
        if changing.len() > 1 {
            for (at, clause) in changing.iter().enumerate() {
                if matches!(clause, Clause::Relation { .. }) {
                    let mut rest = changing.clone();
                    rest.remove(at);
                    splits.push(([&constant[..], &[*clause]].concat(), rest));
                }
            }
        }
        for (of_thing, of_time) in splits {
            let names = self.names(category, &of_thing);
            for gate in self.gates(category, &of_time) {
                for name in &names {
                    found.push(said(format!("{} {}", name.text, gate.text), name.cost + gate.cost));
                }
            }
        }
        found
    }

    fn names(&self, category: &str, clauses: &[&Clause]) -> Vec<Said> {
        let names = self.parts(category, clauses, true).into_iter();
        let sentences = names.flat_map(|parts| self.sentences(category, &parts));
        let plain =
            sentences.filter(|name| name.text.starts_with("the ") && !name.text.starts_with("the only "));
        cheapest(plain.collect(), MOST_NAMES)
    }

    /// "while it rolls", "as a hand lifts it".
    fn gates(&self, category: &str, clauses: &[&Clause]) -> Vec<Said> {
        let Some(noun) = lexicon().noun(category) else { return Vec::new() };
        let pronoun = noun.person.as_deref().unwrap_or("it");
        let person = if pronoun == "they" { Person::They } else { Person::Third };
        let choices: Vec<Vec<(Gate, f64)>> = clauses
            .iter()
            .map(|clause| {
                let mut gates = self.gate(category, clause, pronoun, person);
                gates.sort_by(|a, b| a.1.total_cmp(&b.1));
                gates.truncate(MOST_GATES);
                gates
            })
            .collect();
        let is_happening = clauses.iter().all(|clause| self.happens(clause));
        let mut found = Vec::new();
        for chosen in products(&choices, 200) {
            let cost: f64 = chosen.iter().map(|(_, cost)| cost).sum();
            let Some((text, is_bare)) = joined(&chosen, pronoun) else { continue };
            found.push(said(format!("while {text}"), cost));
            found.push(said(format!("when {text}"), cost + if is_bare { 0.4 } else { 0.25 }));
            if is_happening && !is_bare {
                found.push(said(format!("as {text}"), cost + 0.1));
            }
        }
        found
    }

    fn gate(&self, category: &str, clause: &Clause, pronoun: &str, person: Person) -> Vec<(Gate, f64)> {
        let mut found = Vec::new();
        for finite in self.finite(category, clause, person, true) {
            found.push((Gate::Finite(finite.text), finite.cost));
        }
        let own = |s: Said| (Gate::Own(s.text), s.cost);
        let bare = |s: Said, more: f64| (Gate::Bare(s.text), s.cost + more);
        match clause {
            Clause::Does { .. } => {
                let doing = self.active(clause, Form::Ing).into_iter();
                found.extend(doing.map(|s| bare(s, 0.05)));
            }
            Clause::Relation { .. } => found.extend(self.relation(clause).into_iter().map(|s| bare(s, 0.05))),
            Clause::Undergoes { verb, .. } => {
                let is_state = lexicon().verb(verb).is_some_and(|verb| verb.is_state);
                let being = if is_state { "" } else { "being " };
                let passives = self.passive(clause).into_iter();
                found.extend(passives.map(|s| bare(said(format!("{being}{}", s.text), s.cost), 0.2)));
                found.extend(self.active_on(clause, pronoun).into_iter().map(own));
            }
            Clause::Not(inner) => match &**inner {
                Clause::Does { .. } => {
                    let doing = self.active(inner, Form::Ing).into_iter();
                    found.extend(doing.map(|s| bare(said(format!("not {}", s.text), s.cost), 0.15)));
                }
                Clause::Relation { .. } => {
                    let places = self.relation(inner).into_iter();
                    found.extend(places.map(|s| bare(said(format!("not {}", s.text), s.cost), 0.15)));
                }
                Clause::Undergoes { verb, by: Party::Category(agent) }
                    if self.head.as_ref() != Some(agent) =>
                {
                    found.extend(self.done_by_none(verb, agent, pronoun).into_iter().map(own));
                }
                _ => {}
            },
            _ => {}
        }
        found
    }

    /// "a hand lifts it", "a hand is lifting it".
    fn active_on(&self, clause: &Clause, pronoun: &str) -> Vec<Said> {
        let Clause::Undergoes { verb, by } = clause else { return Vec::new() };
        let Some(known) = lexicon().verb(verb) else { return Vec::new() };
        let object = object_of(pronoun);
        let (simple, progressive) = if known.is_state { (0.0, 0.15) } else { (0.0, 0.05) };
        let mut found = Vec::new();
        for agent in self.mentions(by) {
            for (index, pattern) in known.said(true).enumerate() {
                let price = agent.cost + 0.12 * index as f64;
                let verb = around(pattern, Form::Third, object);
                found.push(said(format!("{} {verb}", agent.text), price + simple));
                let verb = around(pattern, Form::Ing, object);
                found.push(said(format!("{} is {verb}", agent.text), price + progressive));
            }
        }
        found
    }

    fn done_by_none(&self, verb: &str, agent: &str, pronoun: &str) -> Vec<Said> {
        let (Some(known), Some(noun)) = (lexicon().verb(verb), lexicon().noun(agent)) else {
            return Vec::new();
        };
        let object = object_of(pronoun);
        let patterns = known.said(true).enumerate();
        let none = |(index, pattern)| {
            let text = format!("no {} is {}", noun.singular, around(pattern, Form::Ing, object));
            said(text, 0.12 * index as f64)
        };
        patterns.map(none).collect()
    }

    /// Whether it is something that happens, so that something else may happen "as" it does.
    fn happens(&self, clause: &Clause) -> bool {
        match clause {
            Clause::Does { verb, .. } | Clause::Undergoes { verb, .. } => {
                lexicon().verb(verb).is_some_and(|verb| !verb.is_state)
            }
            _ => false,
        }
    }
}

/// "it is on the tray and rolls"; whether it has no subject.
fn joined(chosen: &[(Gate, f64)], pronoun: &str) -> Option<(String, bool)> {
    let mut text = String::new();
    let mut subject_is_said = false;
    for (at, (gate, _)) in chosen.iter().enumerate() {
        if at > 0 {
            text += " and ";
        }
        match gate {
            Gate::Finite(verb) if subject_is_said => text += verb,
            Gate::Finite(verb) => {
                text += &format!("{pronoun} {verb}");
                subject_is_said = true;
            }
            Gate::Bare(state) if chosen.len() == 1 => return Some((state.clone(), true)),
            Gate::Bare(_) => return None,
            Gate::Own(clause) => {
                text += clause;
                subject_is_said = false;
            }
        }
    }
    Some((text, false))
}

/// "puts it down": a pronoun goes before the particle.
fn around(pattern: &crate::lexicon::Pattern, form: Form, object: &str) -> String {
    let is_particle = |word: &String| ["up", "down", "over", "away", "open"].contains(&word.as_str());
    if pattern.before.len() == 1 && pattern.before.iter().all(is_particle) && pattern.head != "roll" {
        let verb = lexicon().inflected(&pattern.head, form);
        return format!("{verb} {object} {}", pattern.before[0]);
    }
    in_form(pattern, form, object)
}

fn object_of(pronoun: &str) -> &'static str {
    match pronoun {
        "he" => "him",
        "she" => "her",
        "they" => "them",
        _ => "it",
    }
}
