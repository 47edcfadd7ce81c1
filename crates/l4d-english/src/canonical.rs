//! The order of clauses, which means nothing: one order, so that equal meanings are equal values.

use l4d_query::{Clause, Party, Predicate};

/// The same predicate with its clauses in the order that [`crate::read`] gives: the noun, properties, extremes,
/// relations, what it does, what is done to it, then what speaks of the clip as a whole.
pub fn canonical(predicate: &Predicate) -> Predicate {
    let mut clauses: Vec<Clause> = predicate.0.iter().map(clause).collect();
    clauses.sort_by_cached_key(|clause| (rank(clause), clause.to_string()));
    Predicate(clauses)
}

fn rank(clause: &Clause) -> usize {
    match clause {
        Clause::Category(_) => 0,
        Clause::Attribute { .. } => 1,
        Clause::Superlative(_) => 2,
        Clause::Relation { .. } => 3,
        Clause::Does { .. } => 4,
        Clause::Undergoes { .. } => 5,
        Clause::Not(_) => 6,
        Clause::AtStart(_) => 7,
        Clause::AtEnd(_) => 8,
        Clause::First(_) => 9,
        Clause::Last(_) => 10,
        Clause::Then(_) => 11,
    }
}

fn clause(this: &Clause) -> Clause {
    let inner = |clause_: &Clause| Box::new(clause(clause_));
    match this {
        Clause::Does { verb, to } => Clause::Does { verb: verb.clone(), to: to.as_ref().map(party) },
        Clause::Undergoes { verb, by } => Clause::Undergoes { verb: verb.clone(), by: party(by) },
        Clause::Relation { kind, of } => Clause::Relation { kind: *kind, of: of.iter().map(party).collect() },
        Clause::Not(of) => Clause::Not(inner(of)),
        Clause::AtStart(of) => Clause::AtStart(inner(of)),
        Clause::AtEnd(of) => Clause::AtEnd(inner(of)),
        Clause::First(of) => Clause::First(inner(of)),
        Clause::Last(of) => Clause::Last(inner(of)),
        Clause::Then(steps) => Clause::Then(Box::new([clause(&steps[0]), clause(&steps[1])])),
        Clause::Category(_) | Clause::Attribute { .. } | Clause::Superlative(_) => this.clone(),
    }
}

fn party(this: &Party) -> Party {
    match this {
        Party::Such(description) => Party::Such(canonical(description)),
        Party::Name(_) | Party::Category(_) => this.clone(),
    }
}
