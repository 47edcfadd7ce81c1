//! All that a scene may be asked about: proved, with look-alikes and margins.
//!
//! Combinations are sifted by what the evaluator said of their clauses, and the prover judges what is left: nothing
//! comes out that it objects to.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::timeline::MIN_INTERVAL;
use l4d_data::{Category, Interval, Name, QueryId, Temporal};
use l4d_query::prove::{COMPOSITES, Kind, Prover, meaning};
use l4d_query::{Clause, Predicate};

use crate::atoms::{Atom, atoms, strange};
use crate::candidate::Candidate;
use crate::facts::{Facts, Group, Members};
use crate::parties::{Somebody, everybody};

/// Most candidates of one kind that mean the same object and have the same form.
const MOST_ALIKE: usize = 3;
/// Most absent ones that ask for the same kinds of reasoning: a scene needs two at all.
const MOST_ABSENT: usize = 15;
/// Longest clauses that are joined with another, by price.
const MOST_OF_A_PAIR: f64 = 2.2;
/// The plainest two-clause sentence is longer than a plain one by this.
const AND: f64 = 0.4;
/// What "while" adds: nothing else asks for time as plainly.
const WHILE: f64 = -0.2;

/// Every candidate of the scene, the cheapest of those that are alike, in an order that depends on the tracks alone.
pub fn enumerate(prover: &Prover<'_>) -> Vec<Candidate> {
    let everybody = everybody(prover);
    let mut found = Vec::new();
    for group in Group::all(prover.world()) {
        let known = Known::of(prover, &group, &everybody);
        let mut drafts = known.singles();
        drafts.extend(known.gated());
        drafts.extend(known.pairs());
        let strange = with_facts(prover, &group, strange(prover.world(), &group, &everybody));
        drafts.extend(known.absents(&strange));
        found.extend(known.proved(prover, drafts));
    }
    found
}

/// A group with its clauses and what is known of them.
struct Known<'g, 'a> {
    group: &'g Group<'a>,
    atoms: Vec<(Atom, Facts)>,
}

fn with_facts(prover: &Prover<'_>, group: &Group<'_>, atoms: Vec<Atom>) -> Vec<(Atom, Facts)> {
    let asked = atoms.into_iter().map(|atom| {
        let facts = Facts::of(prover, group, &atom.clause);
        (atom, facts)
    });
    asked.collect()
}

/// A combination of clauses that passed the sieve.
struct Draft<'k> {
    kind: Kind,
    clauses: Vec<&'k Atom>,
    referent: Option<Name>,
    temporal: Temporal,
    frames: Vec<Interval>,
    price: f64,
}

impl<'g, 'a> Known<'g, 'a> {
    fn of(prover: &Prover<'_>, group: &'g Group<'a>, everybody: &[Somebody]) -> Self {
        Self { group, atoms: with_facts(prover, group, atoms(prover, group, everybody)) }
    }

    fn whole<'k>(&self, kind: Kind, clauses: Vec<&'k Atom>, referent: Option<Name>) -> Draft<'k> {
        let price = clauses.iter().map(|atom| atom.price).sum::<f64>() + AND * (clauses.len() - 1) as f64;
        Draft { kind, clauses, referent, temporal: Temporal::Whole, frames: vec![Interval::WHOLE], price }
    }

    /// The one member of a set of one.
    fn only(&self, members: Members) -> Option<Name> {
        (members.count_ones() == 1)
            .then(|| self.group.members[members.trailing_zeros() as usize].name.clone())
    }

    /// Clauses that one member alone satisfies.
    fn singles(&self) -> Vec<Draft<'_>> {
        let mut found = Vec::new();
        for (atom, facts) in &self.atoms {
            if let Some(referent) = facts.settled().and_then(|members| self.only(members)) {
                found.push(self.whole(Kind::Single, vec![atom], Some(referent)));
            }
        }
        found
    }

    /// Clauses that one member alone ever satisfies, and not all the time.
    fn gated(&self) -> Vec<Draft<'_>> {
        let mut found = Vec::new();
        for (atom, facts) in &self.atoms {
            let is_plain = matches!(
                atom.clause,
                Clause::Does { .. } | Clause::Undergoes { .. } | Clause::Relation { .. }
            );
            let mut holding = facts.times().iter().enumerate().filter(|(_, times)| times.any());
            let (Some((place, times)), None) = (holding.next(), holding.next()) else { continue };
            let frames = times.intervals();
            let are_long = frames.iter().all(|interval| interval.frame_count() >= MIN_INTERVAL);
            if is_plain && !times.all() && are_long && frames.len() <= 2 {
                let referent = Some(self.group.members[place].name.clone());
                let price = atom.price + WHILE;
                let (kind, temporal, clauses) = (Kind::Single, Temporal::While, vec![atom]);
                found.push(Draft { kind, clauses, referent, temporal, frames, price });
            }
        }
        found
    }

    /// Two clauses, each of several members, together of one: of one category or of a pair that composites have.
    fn pairs(&self) -> Vec<Draft<'_>> {
        let size = self.group.members.len() as u32;
        let is_ambiguous = |members: &Members| (2..size).contains(&members.count_ones());
        let ambiguous: Vec<(&Atom, Members)> = self
            .atoms
            .iter()
            .filter(|(atom, _)| atom.price <= MOST_OF_A_PAIR)
            .filter_map(|(atom, facts)| facts.settled().filter(is_ambiguous).map(|members| (atom, members)))
            .collect();
        let mut found = Vec::new();
        for (place, (first, of_first)) in ambiguous.iter().enumerate() {
            for (second, of_second) in &ambiguous[place + 1..] {
                let Some(referent) = self.only(of_first & of_second) else { continue };
                let Some(kind) = kind_of(first.category, second.category) else { continue };
                if first.core != second.core {
                    found.push(self.whole(kind, vec![first, second], Some(referent)));
                }
            }
        }
        found
    }

    /// What nothing satisfies although the scene has every word of it: clauses that hold of different members, and
    /// strange ones.
    fn absents<'k>(&'k self, strange: &'k [(Atom, Facts)]) -> Vec<Draft<'k>> {
        let is_plain = |(atom, facts): &&(Atom, Facts)| {
            let holds = facts.settled().is_some_and(|members| members != 0);
            atom.price <= MOST_OF_A_PAIR && !atom.shape.contains("not") && holds
        };
        let plain: Vec<&(Atom, Facts)> = self.atoms.iter().filter(is_plain).collect();
        let mut found = Vec::new();
        for (place, (first, of_first)) in plain.iter().enumerate() {
            for (second, of_second) in &plain[place + 1..] {
                let is_new = first.category != second.category && first.core != second.core;
                if is_new && !of_first.ever_meets(of_second) {
                    found.push(self.whole(Kind::Absent, vec![first, second], None));
                }
            }
        }
        let never = strange.iter().filter(|(_, facts)| facts.is_never());
        found.extend(never.map(|(atom, _)| self.whole(Kind::Absent, vec![atom], None)));
        found
    }

    /// The cheapest of those that are alike and to which the prover has no objection.
    fn proved(&self, prover: &Prover<'_>, mut drafts: Vec<Draft<'_>>) -> Vec<Candidate> {
        drafts.sort_by(|a, b| a.price.total_cmp(&b.price));
        let mut alike: BTreeMap<String, usize> = BTreeMap::new();
        let mut seen = BTreeSet::new();
        let mut found = Vec::new();
        for draft in drafts {
            let count = alike.entry(draft.likeness()).or_default();
            if *count == if draft.kind == Kind::Absent { MOST_ABSENT } else { MOST_ALIKE } {
                continue;
            }
            let candidate = draft.candidate(self.group.noun);
            let key = (candidate.temporal, meaning(&candidate.predicate));
            if seen.insert(key) && is_proved(prover, &candidate) {
                *count += 1;
                found.push(candidate);
            }
        }
        found
    }
}

fn is_proved(prover: &Prover<'_>, candidate: &Candidate) -> bool {
    let scene = &prover.world().tracks().scene;
    let Ok(number) = Name::new("000") else { return false };
    let query = candidate.query(QueryId { scene: scene.clone(), number }, "");
    query.is_ok_and(|query| prover.objection(candidate.kind, &query).is_none())
}

/// What two clauses of these categories make; none if no file holds it.
fn kind_of(first: Category, second: Category) -> Option<Kind> {
    let pair = [first.min(second), first.max(second)];
    match first == second {
        true => Some(Kind::Single),
        false => COMPOSITES.iter().any(|(_, known)| *known == pair).then_some(Kind::Composite),
    }
}

impl Draft<'_> {
    /// The same for candidates of which a set needs only a few.
    fn likeness(&self) -> String {
        if self.kind == Kind::Absent {
            let mut categories: Vec<&str> = self.clauses.iter().map(|atom| atom.category.as_str()).collect();
            categories.sort_unstable();
            return format!("absent {}", categories.join(", "));
        }
        let mut shapes: Vec<&str> = self.clauses.iter().map(|atom| atom.shape.as_str()).collect();
        shapes.sort_unstable();
        format!("{:?} {:?} {:?} {}", self.kind, self.referent, self.temporal, shapes.join(", "))
    }

    fn candidate(self, noun: &str) -> Candidate {
        let mut clauses = self.clauses;
        // English puts properties first; the rest is a matter of the sentence.
        clauses.sort_by_key(|atom| atom.category != Category::Attribute);
        let gate = if self.temporal == Temporal::While { "while " } else { "" };
        let shapes = clauses.iter().map(|atom| format!("{gate}{}", atom.shape)).collect();
        let cores = clauses.iter().map(|atom| atom.core.clone()).collect();
        let noun = Clause::Category(noun.to_owned());
        let predicate =
            Predicate(std::iter::once(noun).chain(clauses.iter().map(|atom| atom.clause.clone())).collect());
        Candidate {
            kind: self.kind,
            predicate,
            referent: self.referent,
            temporal: self.temporal,
            frames: self.frames,
            shapes,
            cores,
            price: self.price,
        }
    }
}
