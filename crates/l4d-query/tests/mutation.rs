//! Mutation test of the proof: lies about real queries, told one at a time, are caught or prove to be no lies.
//!
//! Named operators change the referent, the interval, a clause, a relation or a category of the shipped queries. A
//! mutant is caught if the check reports it. What is not caught must be equivalent: it means the same objects at the
//! same times as the query that it was made from. Equivalence is decided here frame by frame, not by the check.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use l4d_data::query::text_digest;
use l4d_data::timeline::FRAME_COUNT;
use l4d_data::{Benchmark, Category, Interval, Name, Profile, Query, Report, Temporal};
use l4d_query::eval::{answer_at, answer_whole};
use l4d_query::prove::{Kind, Prover, SceneSet};
use l4d_query::{Clause, Predicate, Relation, Superlative, World};
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

/// Queries that mutants are made of.
const SAMPLE: usize = 200;

/// A lie about a query.
struct Mutant {
    operator: &'static str,
    change: String,
    query: Query,
}

#[test]
fn every_mutant_is_caught_or_equivalent() {
    let sets = sets();
    let mut queries: Vec<(&SceneSet, &Query)> =
        sets.iter().flat_map(|set| set.queries.iter().map(move |query| (set, query))).collect();
    queries.shuffle(&mut ChaCha8Rng::seed_from_u64(0));
    queries.truncate(SAMPLE);
    assert!(queries.len() >= 50, "the benchmark has {} queries", queries.len());

    let mut tally: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    let mut equivalents = Vec::new();
    let mut survivors = Vec::new();
    for (set, query) in queries {
        let prover = Prover::new(&set.tracks, None, None);
        assert_eq!(codes(&prover, query), BTreeSet::new(), "{} is no sound query", query.id);
        for mutant in mutants(prover.world(), query) {
            let counts = tally.entry(mutant.operator).or_default();
            let line = format!("{}: {} {}", query.id, mutant.operator, mutant.change);
            if !codes(&prover, &mutant.query).is_empty() {
                counts[0] += 1;
            } else if is_equivalent(prover.world(), query, &mutant.query) {
                counts[1] += 1;
                equivalents.push(line);
            } else {
                counts[2] += 1;
                survivors.push(line);
            }
        }
    }
    println!("{:<12}{:>8}{:>12}{:>10}", "operator", "caught", "equivalent", "survived");
    for (operator, [caught, equivalent, survived]) in &tally {
        println!("{operator:<12}{caught:>8}{equivalent:>12}{survived:>10}");
    }
    println!("equivalent:\n  {}", equivalents.join("\n  "));
    assert!(survivors.is_empty(), "survived:\n  {}", survivors.join("\n  "));
    let operators: Vec<&str> = tally.keys().copied().collect();
    assert_eq!(operators, ["category", "clause", "interval", "referent", "relation"]);
    assert!(tally.values().all(|[caught, ..]| *caught > 0), "{tally:?}");
    // No operator but a change of predicate can leave the meaning as it was.
    for operator in ["category", "interval", "referent"] {
        assert_eq!(tally[operator][1], 0, "{operator}");
    }
}

fn sets() -> Vec<SceneSet> {
    let bench = Benchmark::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark")).unwrap();
    let mut report = Report::default();
    let scenes = bench.select(&[]).unwrap();
    let read = |scene| SceneSet::read(&bench, Profile::Small, scene, &mut report);
    let sets: Vec<SceneSet> = scenes.iter().filter_map(read).collect();
    assert!(report.is_empty(), "{:?}", report.into_sorted());
    sets
}

fn codes(prover: &Prover<'_>, query: &Query) -> BTreeSet<&'static str> {
    let mut report = Report::default();
    prover.check(Kind::Single, Path::new("q"), query, &mut report);
    report.into_sorted().into_iter().map(|finding| finding.code).collect()
}

/// Whether both mean the same objects whenever they count.
fn is_equivalent(world: &World<'_>, query: &Query, mutant: &Query) -> bool {
    let [here, there] = [query, mutant].map(|query| {
        let predicate = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
        match query.temporal {
            Temporal::Whole => vec![answer_whole(world, &predicate); FRAME_COUNT as usize],
            Temporal::While => (0..FRAME_COUNT).map(|frame| answer_at(world, &predicate, frame)).collect(),
        }
    });
    here == there && query.referents == mutant.referents && query.frames == mutant.frames
}

fn mutants(world: &World<'_>, query: &Query) -> Vec<Mutant> {
    let predicate = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
    let mut mutants = Vec::new();
    let mut add = |operator, change: String, query: Query| mutants.push(Mutant { operator, change, query });
    for object in world.objects().filter(|object| !query.referents.contains(&object.name)) {
        let referents: Vec<Name> = vec![object.name.clone()];
        add("referent", format!("-> {}", object.name), Query { referents, ..query.clone() });
    }
    for (change, temporal, frames) in other_times(query) {
        add("interval", change, Query { temporal, frames, ..query.clone() });
    }
    for category in Category::ALL.into_iter().filter(|category| !query.categories.contains(category)) {
        let change = format!("-> {}", category.as_str());
        add("category", change, Query { categories: vec![category], ..query.clone() });
    }
    for (operator, change, other) in other_predicates(world, &predicate) {
        add(operator, change, with_predicate(query, &other));
    }
    mutants
}

/// With the digest and the category that belong to it: the check must see through the meaning alone.
fn with_predicate(query: &Query, predicate: &Predicate) -> Query {
    let value = serde_json::to_value(predicate).unwrap();
    Query {
        categories: predicate.categories(),
        text_digest: text_digest(&query.text, Some(&value)),
        predicate: Some(value),
        ..query.clone()
    }
}

fn other_times(query: &Query) -> Vec<(String, Temporal, Vec<Interval>)> {
    let interval = |first: u32, last: u32| Interval::new(first, last).unwrap();
    if query.temporal == Temporal::Whole {
        let half = vec![interval(24, 72)];
        return vec![
            ("-> while [24, 72]".to_owned(), Temporal::While, half.clone()),
            ("frames [24, 72]".to_owned(), Temporal::Whole, half),
        ];
    }
    let mut others = vec![("-> whole".to_owned(), Temporal::Whole, vec![Interval::WHOLE])];
    let (first, last) = (query.frames[0].first(), query.frames[0].last());
    let shifted = [(first.saturating_sub(6), last), (first + 6, last), (first, last + 6), (first, last - 6)];
    for (first, last) in shifted.into_iter().filter(|shift| *shift != (first, last)) {
        let frames: Vec<Interval> =
            std::iter::once(interval(first, last)).chain(query.frames.iter().skip(1).copied()).collect();
        others.push((format!("-> [{first}, {last}]"), Temporal::While, frames));
    }
    others
}

fn other_predicates(world: &World<'_>, predicate: &Predicate) -> Vec<(&'static str, String, Predicate)> {
    let mut others = Vec::new();
    let with = |index: usize, clause: Option<Clause>| {
        let mut clauses = predicate.0.clone();
        match clause {
            Some(clause) => clauses[index] = clause,
            None => drop(clauses.remove(index)),
        }
        Predicate(clauses)
    };
    let nouns: BTreeSet<&str> = world.objects().map(|object| object.category.as_str()).collect();
    for noun in nouns.into_iter().filter(|noun| *noun != predicate.noun()) {
        others.push(("category", format!("noun {noun}"), with(0, Some(Clause::Category(noun.to_owned())))));
    }
    for (index, clause) in predicate.0.iter().enumerate().skip(1) {
        if predicate.0.len() > 2 {
            others.push(("clause", format!("without {clause}"), with(index, None)));
        }
        let negated = match clause {
            Clause::Not(inner) => (**inner).clone(),
            clause => Clause::Not(Box::new(clause.clone())),
        };
        others.push(("clause", format!("negated {clause}"), with(index, Some(negated))));
        for other in other_relations(clause) {
            others.push(("relation", format!("{clause} -> {other}"), with(index, Some(other))));
        }
    }
    others
}

/// The clause with another relation or superlative, wherever it occurs in it.
fn other_relations(clause: &Clause) -> Vec<Clause> {
    let inside = |inner: &Clause, wrap: fn(Box<Clause>) -> Clause| {
        other_relations(inner).into_iter().map(|other| wrap(Box::new(other))).collect()
    };
    match clause {
        Clause::Relation { kind, of } => Relation::ALL
            .into_iter()
            .filter(|other| other != kind && other.arity() == kind.arity())
            .map(|kind| Clause::Relation { kind, of: of.clone() })
            .collect(),
        Clause::Superlative(extreme) => {
            use Superlative::{Highest, Largest, Lowest, Smallest, Tallest};
            let all = [Largest, Smallest, Tallest, Highest, Lowest];
            all.into_iter().filter(|other| other != extreme).map(Clause::Superlative).collect()
        }
        Clause::Not(inner) => inside(inner, Clause::Not),
        Clause::AtStart(inner) => inside(inner, Clause::AtStart),
        Clause::AtEnd(inner) => inside(inner, Clause::AtEnd),
        Clause::First(inner) => inside(inner, Clause::First),
        Clause::Last(inner) => inside(inner, Clause::Last),
        _ => Vec::new(),
    }
}
