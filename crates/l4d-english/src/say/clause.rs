//! Where each clause may go around a noun, and for how much.

use l4d_query::{Clause, Party, Relation, Superlative};

use super::finite::Person;
use super::{Said, Speaker, property, said};
use crate::lexicon::{Form, lexicon};

/// A place around a noun, with what goes there.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Slot {
    /// Before the noun, in this order.
    Before(u8, String),
    /// Instead of the noun.
    Noun(String),
    /// After the noun, in this order.
    After(u8, String),
    /// After "that", whose subject the noun is.
    Relative(String),
    /// After "that", whose object the noun is.
    Gap(String),
    /// "first" before the noun, and "to jump" after it.
    Ordered(&'static str, String),
}

/// Words of relations that are said, with their prices.
fn relation_words(kind: Relation) -> &'static [(&'static str, f64)] {
    match kind {
        Relation::On => &[("on", 0.0), ("on top of", 0.25)],
        Relation::In => &[("in", 0.0), ("inside", 0.1)],
        Relation::Under => &[("under", 0.0), ("underneath", 0.1)],
        Relation::Beside => &[("next to", 0.0), ("beside", 0.05)],
        Relation::Touching => &[("touching", 0.0), ("in contact with", 0.3)],
        Relation::Between => &[("between", 0.0)],
        Relation::ClosestTo => &[("closest to", 0.0), ("nearest to", 0.05)],
        Relation::FarthestFrom => &[("farthest from", 0.0), ("farthest away from", 0.15)],
        Relation::InFrontOf => &[("in front of", 0.0)],
        Relation::Behind => &[("behind", 0.0)],
        Relation::Facing => &[("facing", 0.0)],
    }
}

/// Words of extremes, and of their comparatives.
pub(super) fn superlative_words(extreme: Superlative) -> (&'static [&'static str], &'static str) {
    match extreme {
        Superlative::Largest => (&["largest", "biggest"], "larger"),
        Superlative::Smallest => (&["smallest"], "smaller"),
        Superlative::Tallest => (&["tallest"], "taller"),
        Superlative::Highest => (&["highest"], "higher"),
        Superlative::Lowest => (&["lowest"], "lower"),
    }
}

impl Speaker<'_, '_> {
    /// The places that a clause may have around its noun; `is_alone` if no other clause is around it.
    pub(super) fn slots(&self, category: &str, clause: &Clause, is_alone: bool) -> Vec<(Slot, f64)> {
        let mut found = match clause {
            Clause::Attribute { key, value } => return property::slots(category, key, value),
            Clause::Not(inner) => match &**inner {
                Clause::Attribute { key, value } => return property::denied(category, key, value),
                inner => self.denied_slots(inner),
            },
            Clause::Category(_) => Vec::new(),
            Clause::Superlative(extreme) if is_alone => self.superlative_slots(category, *extreme),
            Clause::Relation { kind, .. } if is_alone || !is_among_its_like(*kind) => {
                let states = self.relation(clause).into_iter();
                states.map(|state| (Slot::After(3, state.text), state.cost)).collect()
            }
            Clause::Superlative(_) | Clause::Relation { .. } => Vec::new(),
            Clause::Does { verb, .. } => self.doing_slots(clause, verb),
            Clause::Undergoes { .. } => self.undergoing_slots(clause),
            Clause::AtStart(inner) | Clause::AtEnd(inner) => self.timed_slots(clause, inner),
            Clause::First(inner) | Clause::Last(inner) => self.ordered_slots(clause, inner, is_alone),
            Clause::Then(steps) => self.shared_agent(steps),
        };
        let finite = self.finite(category, clause, Person::Third, false).into_iter();
        found.extend(finite.map(|said| (Slot::Relative(said.text), said.cost + 0.1)));
        found
    }

    fn superlative_slots(&self, category: &str, extreme: Superlative) -> Vec<(Slot, f64)> {
        let (words, comparative) = superlative_words(extreme);
        let pairs = words.iter().enumerate();
        let mut found: Vec<(Slot, f64)> =
            pairs.map(|(index, word)| (Slot::Before(0, (*word).to_owned()), 0.1 * index as f64)).collect();
        if self.words.count(category) == 2 {
            found.push((Slot::Before(0, comparative.to_owned()), 0.1));
        }
        found
    }

    fn denied_slots(&self, inner: &Clause) -> Vec<(Slot, f64)> {
        let mut found = Vec::new();
        match inner {
            Clause::Relation { kind, .. } if !is_among_its_like(*kind) => {
                let states = self.relation(inner).into_iter();
                found.extend(
                    states.map(|state| (Slot::After(3, format!("not {}", state.text)), state.cost + 0.4)),
                );
            }
            Clause::Undergoes { verb, by } => {
                found.extend(self.agents_of_none(verb, by).into_iter().map(|s| (Slot::Gap(s.text), s.cost)));
                let passives = self.passive(inner).into_iter();
                found.extend(passives.map(|s| (Slot::After(4, format!("never {}", s.text)), s.cost + 0.3)));
            }
            _ => {}
        }
        found
    }

    /// "no hand lifts", "the woman never lifts".
    fn agents_of_none(&self, verb: &str, by: &Party) -> Vec<Said> {
        let mut found = Vec::new();
        if let Party::Category(category) = by {
            if let Some(noun) = lexicon().noun(category).filter(|noun| noun.counts()) {
                let other = if self.head.as_ref() == Some(category) { "other " } else { "" };
                if other.is_empty() {
                    let verbs = self.gap_verbs(verb, Form::Third).into_iter();
                    found.extend(verbs.map(|v| said(format!("no {} {}", noun.singular, v.text), v.cost)));
                }
            }
        } else {
            for agent in self.mentions(by) {
                let verbs = self.gap_verbs(verb, Form::Third).into_iter();
                found.extend(
                    verbs.map(|v| said(format!("{} never {}", agent.text, v.text), agent.cost + v.cost)),
                );
            }
        }
        found
    }

    /// "rolling" before the noun, "typing on the laptop" after it.
    fn doing_slots(&self, clause: &Clause, verb: &str) -> Vec<(Slot, f64)> {
        let Some(known) = lexicon().verb(verb) else { return Vec::new() };
        let mut found = Vec::new();
        for state in self.active(clause, Form::Ing) {
            match state.text.contains(' ') {
                true => {
                    let more = if matches!(clause, Clause::Does { to: None, .. }) { 0.4 } else { 0.1 };
                    found.push((Slot::After(4, state.text), state.cost + more));
                }
                false if known.goes_before => found.push((Slot::Before(5, state.text), state.cost + 0.3)),
                false => {}
            }
        }
        found
    }

    fn undergoing_slots(&self, clause: &Clause) -> Vec<(Slot, f64)> {
        let passives = self.passive(clause).into_iter();
        let mut found: Vec<(Slot, f64)> = passives.map(|s| (Slot::After(4, s.text), s.cost + 0.05)).collect();
        found.extend(self.gaps(clause, Form::Third).into_iter().map(|s| (Slot::Gap(s.text), s.cost)));
        found
    }

    fn timed_slots(&self, clause: &Clause, inner: &Clause) -> Vec<(Slot, f64)> {
        let time = if matches!(clause, Clause::AtStart(_)) { "at the start" } else { "at the end" };
        let mut found = Vec::new();
        match inner {
            Clause::Relation { .. } => {
                let states = self.relation(inner).into_iter();
                found.extend(states.map(|s| (Slot::After(3, format!("{} {time}", s.text)), s.cost + 0.2)));
            }
            Clause::Undergoes { .. } => {
                for gap in self.gaps(inner, Form::Ing) {
                    found.push((Slot::Gap(format!("{} {time}", gap.text)), gap.cost + 0.1));
                }
            }
            _ => {}
        }
        found
    }

    fn ordered_slots(&self, clause: &Clause, inner: &Clause, is_alone: bool) -> Vec<(Slot, f64)> {
        let which = if matches!(clause, Clause::First(_)) { "first" } else { "last" };
        let mut found = Vec::new();
        if !is_alone {
            let gaps = self.gaps(inner, Form::Third).into_iter();
            return gaps.map(|gap| (Slot::Gap(format!("{} {which}", gap.text)), gap.cost + 0.2)).collect();
        }
        match inner {
            Clause::Does { .. } => {
                let does = self.active(inner, Form::Base).into_iter();
                found.extend(does.map(|s| (Slot::Ordered(which, format!("to {}", s.text)), s.cost)));
                let does = self.active(inner, Form::Third).into_iter();
                found.extend(does.map(|s| (Slot::Ordered(which, format!("that {}", s.text)), s.cost + 0.2)));
            }
            _ => {
                for gap in self.gaps(inner, Form::Third) {
                    found.push((Slot::Ordered(which, format!("that {}", gap.text)), gap.cost));
                    found.push((Slot::Gap(format!("{} {which}", gap.text)), gap.cost + 0.2));
                }
                for passive in self.passive(inner) {
                    found.push((Slot::Ordered(which, format!("to be {}", passive.text)), passive.cost));
                    found.push((Slot::Ordered(which, passive.text), passive.cost + 0.15));
                }
            }
        }
        found
    }

    /// "a hand lifts and then pushes".
    fn shared_agent(&self, steps: &[Clause; 2]) -> Vec<(Slot, f64)> {
        let [Clause::Undergoes { verb: one, by }, Clause::Undergoes { verb: two, by: other }] = steps else {
            return Vec::new();
        };
        if by != other {
            return Vec::new();
        }
        let mut found = Vec::new();
        for agent in self.mentions(by) {
            for (a, b) in self.gap_verbs(one, Form::Third).iter().zip(self.gap_verbs(two, Form::Third)) {
                let text = format!("{} {} and then {}", agent.text, a.text, b.text);
                found.push((Slot::Gap(text), agent.cost + a.cost + b.cost));
            }
        }
        found
    }

    /// "on the tray", "between the lamp and a cup".
    pub(super) fn relation(&self, clause: &Clause) -> Vec<Said> {
        let Clause::Relation { kind, of } = clause else { return Vec::new() };
        let mut places = Vec::new();
        match &of[..] {
            [Party::Category(a), Party::Category(b)] if a == b => {
                if let Some(noun) = lexicon().noun(a).filter(|noun| noun.counts()) {
                    let other = if self.head.as_ref() == Some(a) { "other " } else { "" };
                    places.push(said(format!("two {other}{}", noun.plural), 0.0));
                }
            }
            [one, two] => {
                for a in self.mentions(one) {
                    for b in self.mentions(two) {
                        places.push(said(format!("{} and {}", a.text, b.text), a.cost + b.cost));
                    }
                }
            }
            [one] => places = self.mentions(one),
            _ => {}
        }
        let mut found = Vec::new();
        for (words, cost) in relation_words(*kind) {
            found.extend(
                places.iter().map(|place| said(format!("{words} {}", place.text), place.cost + cost)),
            );
        }
        found
    }
}

/// Whether it compares with all others of the category: said beside another clause, it would seem to compare with those
/// that this clause leaves.
pub(super) fn is_among_its_like(kind: Relation) -> bool {
    matches!(kind, Relation::ClosestTo | Relation::FarthestFrom)
}
