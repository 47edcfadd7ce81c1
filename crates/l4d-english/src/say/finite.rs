//! Clauses as finite verb phrases: "rolls", "is never lifted by a hand", "starts out on the tray".

use l4d_query::{Clause, Relation, Superlative};

use super::clause::{is_among_its_like, superlative_words};
use super::{Said, Speaker, changes, property, said};
use crate::lexicon::{Form, Pattern, lexicon};

/// Particles that keep a verb's passive natural: "put down by".
const PARTICLES: [&str; 5] = ["up", "down", "over", "away", "open"];

/// Who the subject is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Person {
    /// "that", "it", "she".
    Third,
    They,
}

impl Person {
    fn form(self) -> Form {
        match self {
            Self::Third => Form::Third,
            Self::They => Form::Base,
        }
    }

    pub(super) fn is(self) -> &'static str {
        match self {
            Self::Third => "is",
            Self::They => "are",
        }
    }

    fn does(self) -> &'static str {
        match self {
            Self::Third => "does",
            Self::They => "do",
        }
    }
}

impl Speaker<'_, '_> {
    /// What the thing is or does, after its pronoun; `now` if it is said of a time ("while it rolls") rather than of
    /// the clip ("that rolls").
    pub(super) fn finite(&self, category: &str, clause: &Clause, person: Person, now: bool) -> Vec<Said> {
        let is = person.is();
        let be = |states: Vec<Said>, more: f64| {
            states.into_iter().map(move |state| said(format!("{is} {}", state.text), state.cost + more))
        };
        match clause {
            Clause::Attribute { .. } => property::after_is(category, clause),
            Clause::Superlative(extreme) => be(self.extremes(category, *extreme), 0.0).collect(),
            Clause::Relation { kind, .. } if is_among_its_like(*kind) => {
                be(self.comparatives(category, clause), 0.0).collect()
            }
            Clause::Relation { kind, .. } => {
                let mut found: Vec<Said> = be(self.relation(clause), 0.05).collect();
                found.extend(self.relation_verbs(clause, *kind, person));
                found
            }
            Clause::Does { verb, .. } => {
                let is_state = lexicon().verb(verb).is_some_and(|verb| verb.is_state);
                let (simple, progressive) = match (now, is_state) {
                    (true, true) => (0.15, 0.0),
                    (true, false) => (0.0, 0.1),
                    (false, true) => (0.0, 0.25),
                    (false, false) => (-0.1, 0.8),
                };
                let mut found = raised(self.active(clause, person.form()), simple);
                found.extend(be(self.active(clause, Form::Ing), progressive));
                found
            }
            Clause::Undergoes { verb, .. } => {
                let is_state = lexicon().verb(verb).is_some_and(|verb| verb.is_state);
                let mut found: Vec<Said> =
                    be(self.passive(clause), if now && !is_state { 0.1 } else { 0.05 }).collect();
                if now {
                    let being = self.passive(clause).into_iter();
                    found.extend(being.map(|s| said(format!("{is} being {}", s.text), s.cost + 0.1)));
                }
                found
            }
            Clause::Not(inner) => self.denied(category, inner, person, now),
            Clause::AtStart(inner) | Clause::AtEnd(inner) => self.timed(category, clause, inner, person),
            Clause::First(inner) | Clause::Last(inner) => self.ordered(category, clause, inner, person),
            Clause::Then(steps) => self.steps(steps, person),
            Clause::Category(_) => Vec::new(),
        }
    }

    fn denied(&self, category: &str, inner: &Clause, person: Person, now: bool) -> Vec<Said> {
        let (is, does) = (person.is(), person.does());
        let not = |states: Vec<Said>, more: f64| {
            states.into_iter().map(move |state| said(format!("{is} not {}", state.text), state.cost + more))
        };
        let never = |states: Vec<Said>, more: f64| {
            let states = if now { Vec::new() } else { states };
            states.into_iter().map(move |state| said(format!("{is} never {}", state.text), state.cost + more))
        };
        let mut found = Vec::new();
        match inner {
            Clause::Superlative(extreme) => found.extend(not(self.extremes(category, *extreme), 0.0)),
            Clause::Relation { kind, .. } if is_among_its_like(*kind) => {
                found.extend(not(self.comparatives(category, inner), 0.3));
                let the = self.relation(inner).into_iter();
                found.extend(the.map(|s| said(format!("{is} not the one {}", s.text), s.cost)));
            }
            Clause::Relation { .. } => {
                found.extend(not(self.relation(inner), 0.05));
                found.extend(never(self.relation(inner), 0.0));
            }
            Clause::Does { .. } if now => {
                found.extend(not(self.active(inner, Form::Ing), 0.0));
                let base = self.active(inner, Form::Base).into_iter();
                found.extend(base.map(|s| said(format!("{does} not {}", s.text), s.cost + 0.2)));
            }
            Clause::Does { .. } => {
                let third = self.active(inner, person.form()).into_iter();
                found.extend(third.map(|s| said(format!("never {}", s.text), s.cost)));
                let base = self.active(inner, Form::Base).into_iter();
                found.extend(base.map(|s| said(format!("{does} not {}", s.text), s.cost + 0.15)));
            }
            Clause::Undergoes { .. } => {
                found.extend(never(self.passive(inner), 0.05));
                found.extend(not(self.passive(inner), 0.15));
                if now {
                    let being = self.passive(inner).into_iter();
                    found.extend(being.map(|s| said(format!("{is} not being {}", s.text), s.cost + 0.1)));
                }
            }
            Clause::AtStart(state) | Clause::AtEnd(state) => {
                let verb = if matches!(inner, Clause::AtStart(_)) { "start out" } else { "end up" };
                let states = self.states(category, state).into_iter();
                found.extend(states.map(|s| said(format!("{does} not {verb} {}", s.text), s.cost)));
            }
            Clause::First(event) | Clause::Last(event) => {
                let which = if matches!(inner, Clause::First(_)) { "first" } else { "last" };
                let to = self.infinitives(event).into_iter();
                found.extend(to.map(|s| said(format!("{is} not the {which} {}", s.text), s.cost)));
            }
            _ => {}
        }
        found
    }

    fn timed(&self, category: &str, clause: &Clause, inner: &Clause, person: Person) -> Vec<Said> {
        let is = person.is();
        let is_start = matches!(clause, Clause::AtStart(_));
        let times: &[(&str, f64)] = match is_start {
            true => &[("at the start", 0.1), ("at the beginning", 0.2), ("when the clip starts", 0.35)],
            false => &[("at the end", 0.1), ("when the clip ends", 0.3)],
        };
        let verbs: &[(&str, f64)] = match (is_start, inner) {
            (_, Clause::Not(_)) => &[],
            (true, Clause::Does { .. } | Clause::Undergoes { .. }) => &[("starts out", 0.2)],
            (true, _) => &[("starts out", 0.0), ("starts", 0.25)],
            (false, Clause::Does { .. } | Clause::Undergoes { .. }) => &[],
            (false, _) => &[("ends up", 0.0), ("finishes", 0.25)],
        };
        let mut found = Vec::new();
        for state in self.states(category, inner) {
            for (verb, cost) in verbs {
                found.push(said(format!("{verb} {}", state.text), state.cost + cost));
            }
            for (time, cost) in times {
                found.push(said(format!("{is} {} {time}", state.text), state.cost + cost));
            }
        }
        found
    }

    /// After "is", "starts out" or "ends up": a state at a moment.
    fn states(&self, category: &str, clause: &Clause) -> Vec<Said> {
        match clause {
            _ if !changes(clause) => Vec::new(),
            Clause::Superlative(extreme) => {
                let (words, _) = superlative_words(*extreme);
                let plain = words.iter().map(|word| said((*word).to_owned(), 0.0));
                plain.chain(self.extremes(category, *extreme)).collect()
            }
            Clause::Relation { kind, .. } if is_among_its_like(*kind) => {
                let mut found = self.relation(clause);
                found.extend(raised(self.comparatives(category, clause), 0.2));
                found
            }
            Clause::Relation { .. } => self.relation(clause),
            Clause::Does { .. } => self.active(clause, Form::Ing),
            Clause::Undergoes { verb, .. } => {
                let is_state = lexicon().verb(verb).is_some_and(|verb| verb.is_state);
                let mut found = if is_state { self.passive(clause) } else { Vec::new() };
                let being = self.passive(clause).into_iter();
                found.extend(being.map(|s| said(format!("being {}", s.text), s.cost + 0.05)));
                found
            }
            Clause::Not(inner) => {
                let states = self.states(category, inner).into_iter();
                states.map(|s| said(format!("not {}", s.text), s.cost)).collect()
            }
            _ => Vec::new(),
        }
    }

    fn ordered(&self, category: &str, clause: &Clause, inner: &Clause, person: Person) -> Vec<Said> {
        let is = person.is();
        let is_first = matches!(clause, Clause::First(_));
        let which = if is_first { "first" } else { "last" };
        let Some(noun) = lexicon().noun(category) else { return Vec::new() };
        let mut found = Vec::new();
        for to in self.infinitives(inner) {
            found.push(said(format!("{is} the {which} {} {}", noun.singular, to.text), to.cost + 0.1));
            found.push(said(format!("{is} the {which} of the {} {}", noun.plural, to.text), to.cost + 0.2));
        }
        let link = if is_first { "before" } else { "after" };
        for event in self.events(inner, person) {
            found.push(said(format!("{} {which}", event.text), event.cost + 0.3));
            found.push(said(format!("{} {link} any other {}", event.text, noun.singular), event.cost + 0.35));
            found.push(said(format!("{} {link} all the others", event.text), event.cost + 0.4));
        }
        found
    }

    /// "to roll", "to be lifted by a hand".
    fn infinitives(&self, event: &Clause) -> Vec<Said> {
        match event {
            Clause::Does { .. } => {
                let base = self.active(event, Form::Base).into_iter();
                base.map(|s| said(format!("to {}", s.text), s.cost)).collect()
            }
            _ => self.passive(event).into_iter().map(|s| said(format!("to be {}", s.text), s.cost)).collect(),
        }
    }

    /// "rolls", "is lifted by a hand".
    fn events(&self, event: &Clause, person: Person) -> Vec<Said> {
        match event {
            Clause::Does { .. } => self.active(event, person.form()),
            _ => {
                let passives = self.passive(event).into_iter();
                passives.map(|s| said(format!("{} {}", person.is(), s.text), s.cost)).collect()
            }
        }
    }

    /// "sits and then walks", "walks after sitting".
    fn steps(&self, steps: &[Clause; 2], person: Person) -> Vec<Said> {
        let [one, two] = steps;
        let gerunds = |event: &Clause| match event {
            Clause::Does { .. } => self.active(event, Form::Ing),
            _ => self.passive(event).into_iter().map(|s| said(format!("being {}", s.text), s.cost)).collect(),
        };
        let both_passive = matches!(steps, [Clause::Undergoes { .. }, Clause::Undergoes { .. }]);
        let mut found = Vec::new();
        for a in self.events(one, person) {
            let seconds = if both_passive { self.passive(two) } else { self.events(two, person) };
            for b in seconds {
                let cost = a.cost + b.cost;
                found.push(said(format!("{} and then {}", a.text, b.text), cost));
                let is = person.is();
                // "is first lifted" rather than "first is lifted".
                let first = match a.text.strip_prefix(is).filter(|_| matches!(one, Clause::Undergoes { .. }))
                {
                    Some(state) => format!("{is} first{state}"),
                    None => format!("first {}", a.text),
                };
                found.push(said(format!("{first} and then {}", b.text), cost + 0.2));
            }
            for b in self.events(two, person) {
                found
                    .push(said(format!("{} first and {} afterwards", a.text, b.text), a.cost + b.cost + 0.3));
            }
            for b in gerunds(two) {
                found.push(said(format!("{} before {}", a.text, b.text), a.cost + b.cost + 0.15));
            }
        }
        for b in self.events(two, person) {
            for a in gerunds(one) {
                found.push(said(format!("{} after {}", b.text, a.text), a.cost + b.cost + 0.15));
            }
        }
        found
    }

    /// "lifts a cup", "rolling": its verb in this form.
    pub(super) fn active(&self, clause: &Clause, form: Form) -> Vec<Said> {
        let Clause::Does { verb, to } = clause else { return Vec::new() };
        let Some(known) = lexicon().verb(verb) else { return Vec::new() };
        let objects = match to {
            Some(party) => self.mentions(party),
            None => vec![said("something", 0.0)],
        };
        let takes_object = to.is_some() || known.said(false).next().is_none();
        let mut found = Vec::new();
        for (index, pattern) in known.said(takes_object).enumerate() {
            let price = 0.12 * index as f64;
            if !takes_object {
                found.push(said(in_form(pattern, form, ""), price));
                continue;
            }
            found.extend(objects.iter().map(|o| said(in_form(pattern, form, &o.text), price + o.cost)));
        }
        found
    }

    /// "lifted by a hand".
    pub(super) fn passive(&self, clause: &Clause) -> Vec<Said> {
        let Clause::Undergoes { verb, by } = clause else { return Vec::new() };
        let Some(known) = lexicon().verb(verb).filter(|verb| verb.has_passive) else { return Vec::new() };
        let mut found = Vec::new();
        for (index, pattern) in known.said(true).enumerate() {
            let is_plain = pattern.before.iter().all(|word| PARTICLES.contains(&word.as_str()));
            let price = 0.12 * index as f64 + if is_plain { 0.0 } else { 0.5 };
            for agent in self.mentions(by) {
                let verb = in_form(pattern, Form::Participle, "");
                found.push(said(format!("{verb} by {}", agent.text), price + agent.cost));
            }
        }
        found
    }

    /// "a hand lifts": somebody does it to the thing, which is named before.
    pub(super) fn gaps(&self, clause: &Clause, form: Form) -> Vec<Said> {
        let Clause::Undergoes { verb, by } = clause else { return Vec::new() };
        let mut found = Vec::new();
        let is = if form == Form::Ing { "is " } else { "" };
        for agent in self.mentions(by) {
            for verb in self.gap_verbs(verb, form) {
                found.push(said(format!("{} {is}{}", agent.text, verb.text), agent.cost + verb.cost));
            }
        }
        found
    }

    /// "lifts", "puts down": without the object.
    pub(super) fn gap_verbs(&self, verb: &str, form: Form) -> Vec<Said> {
        let Some(known) = lexicon().verb(verb) else { return Vec::new() };
        let patterns = known.said(true).enumerate();
        patterns.map(|(index, pattern)| said(in_form(pattern, form, ""), 0.12 * index as f64)).collect()
    }

    /// "the tallest of the women", "taller than any other woman".
    fn extremes(&self, category: &str, extreme: Superlative) -> Vec<Said> {
        let Some(noun) = lexicon().noun(category) else { return Vec::new() };
        let (words, comparative) = superlative_words(extreme);
        let mut found = Vec::new();
        for (index, word) in words.iter().enumerate() {
            found.push(said(format!("the {word} of the {}", noun.plural), 0.1 * index as f64));
        }
        let other = if self.words.count(category) == 2 { "the other" } else { "any other" };
        found.push(said(format!("{comparative} than {other} {}", noun.singular), 0.1));
        found
    }

    /// "closer to the lamp than any other cup".
    fn comparatives(&self, category: &str, clause: &Clause) -> Vec<Said> {
        let Clause::Relation { kind, of } = clause else { return Vec::new() };
        let (Some(noun), [party]) = (lexicon().noun(category), &of[..]) else { return Vec::new() };
        let words = if *kind == Relation::ClosestTo { "closer to" } else { "farther from" };
        let other = if self.words.count(category) == 2 { "the other" } else { "any other" };
        let place =
            |place: Said| said(format!("{words} {} than {other} {}", place.text, noun.singular), place.cost);
        self.mentions(party).into_iter().map(place).collect()
    }

    /// "faces the window", "touches the wall".
    fn relation_verbs(&self, clause: &Clause, kind: Relation, person: Person) -> Vec<Said> {
        let Clause::Relation { of, .. } = clause else { return Vec::new() };
        let verb = match kind {
            Relation::Facing => "face",
            Relation::Touching => "touch",
            _ => return Vec::new(),
        };
        let verb = lexicon().inflected(verb, person.form());
        let others = of.first().map(|party| self.mentions(party)).unwrap_or_default();
        others.into_iter().map(|other| said(format!("{verb} {}", other.text), other.cost)).collect()
    }
}

/// The pattern with this object; none leaves a gap.
pub(super) fn in_form(pattern: &Pattern, form: Form, object: &str) -> String {
    let mut words = vec![lexicon().inflected(&pattern.head, form)];
    words.extend(pattern.before.iter().cloned());
    if !object.is_empty() {
        words.push(object.to_owned());
    }
    words.extend(pattern.after.iter().cloned());
    words.join(" ")
}

fn raised(found: Vec<Said>, more: f64) -> Vec<Said> {
    found.into_iter().map(|one| said(one.text, one.cost + more)).collect()
}
