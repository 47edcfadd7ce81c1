//! How much of a set of sentences the geometric grounder reads as their authors meant them.
//!
//! The lexicon and the grammar were written beside the sentences of the dev split; those of the benchmark were never
//! looked at, and are counted (`--ignored`) to say what the reading is worth.

use std::path::{Path, PathBuf};

use l4d_data::query::{Query, read_queries};
use l4d_query::{Clause, Party, Predicate};

use super::super::lexicon::Lexicon;
use super::super::parse::{ANY_PERSON, parse};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[derive(Default, Debug)]
struct Count {
    queries: usize,
    read: usize,
    same: usize,
    alike: usize,
    clauses: usize,
    clauses_same: usize,
    clauses_alike: usize,
}

/// The clause without what the author alone can know: keys of properties, names of people.
fn outline(clause: &Clause) -> Clause {
    let party = |party: &Party| match party {
        Party::Such(predicate) => Party::Such(Predicate(predicate.0.iter().map(outline).collect())),
        Party::Name(_) | Party::Category(_) => Party::Category(ANY_PERSON.to_owned()),
    };
    match clause {
        Clause::Category(noun) => Clause::Category(noun.clone()),
        Clause::Attribute { value, .. } => Clause::Attribute { key: String::new(), value: value.clone() },
        Clause::Does { verb, to } => Clause::Does { verb: verb.clone(), to: to.as_ref().map(party) },
        Clause::Undergoes { verb, by } => Clause::Undergoes { verb: verb.clone(), by: party(by) },
        Clause::Relation { kind, of } => Clause::Relation { kind: *kind, of: of.iter().map(party).collect() },
        Clause::Superlative(extreme) => Clause::Superlative(*extreme),
        Clause::Not(inner) => Clause::Not(Box::new(outline(inner))),
        Clause::AtStart(inner) => Clause::AtStart(Box::new(outline(inner))),
        Clause::AtEnd(inner) => Clause::AtEnd(Box::new(outline(inner))),
        Clause::First(inner) => Clause::First(Box::new(outline(inner))),
        Clause::Last(inner) => Clause::Last(Box::new(outline(inner))),
        Clause::Then(steps) => Clause::Then(Box::new([outline(&steps[0]), outline(&steps[1])])),
    }
}

fn count(bench: &Path) -> Count {
    let lexicon = Lexicon::shipped().unwrap();
    let mut count = Count::default();
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(bench.join("queries")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for path in files {
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if stem.contains('.') {
            continue;
        }
        for query in read_queries(&path, &stem).unwrap() {
            add(&mut count, lexicon, &query);
        }
    }
    count
}

fn add(count: &mut Count, lexicon: &Lexicon, query: &Query) {
    let meant = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
    count.queries += 1;
    count.clauses += meant.0.len();
    let parsed = match parse(lexicon, &query.text) {
        Ok(parsed) => parsed,
        Err(words) => {
            println!("UNREAD  {} | {words:?}", query.text);
            return;
        }
    };
    count.read += 1;
    let found = |clause: &Clause| parsed.predicate.0.contains(clause);
    let outlines: Vec<Clause> = parsed.predicate.0.iter().map(outline).collect();
    count.clauses_same += meant.0.iter().filter(|clause| found(clause)).count();
    count.clauses_alike += meant.0.iter().filter(|clause| outlines.contains(&outline(clause))).count();
    let is_timed = parsed.temporal == query.temporal;
    let is_same = is_timed && parsed.predicate == meant;
    let is_alike = is_timed && outlines == meant.0.iter().map(outline).collect::<Vec<_>>();
    count.same += usize::from(is_same);
    count.alike += usize::from(is_alike);
    if !is_alike {
        println!("OTHER   {} | {} | meant {meant}", query.text, parsed.predicate);
    }
}

#[test]
#[ignore = "a measurement: prints how much of the benchmark is read, and nothing may be tuned on that"]
fn the_benchmark_is_counted() {
    println!("{:?}", count(&repository().join("benchmark")));
}
