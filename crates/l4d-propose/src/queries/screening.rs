//! The check of a proposal: everything that can be checked without a person, and nothing that a model says of itself.
//!
//! Numbers, wording, look-alikes, intervals and visibility are checked of every proposal; one with a predicate is
//! also proved, by the very proof that `check-queries` runs.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::query::{Provenance, QueryId, text_digest};
use l4d_data::scene::Scene;
use l4d_data::{Category, Finding, Interval, Name, Profile, Query, Report, Role, Severity, Status, Temporal};
use l4d_frames::check::visibility_problem;
use l4d_query::eval::answer_times;
use l4d_query::prove::{
    Kind, Prover, SceneSet, Vocabulary, form_problem, meaning, plain_events, says_when, words,
};
use l4d_query::{Predicate, Times};

use super::Proposal;
use crate::answer::Reason;

const FEWEST_WORDS: usize = 3;
const MOST_WORDS: usize = 20;
const MOST_LETTERS: usize = 120;
/// A model sees one frame in many: its interval and the proved one share at least this part of their union.
const SHARED_TIME: f64 = 0.3;

/// What became of a proposal.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// Proved: a line for the benchmark, once people have looked at it.
    Candidate(Query),
    /// Sound as far as it can be seen without a predicate, which a person adds; with what is known about why.
    NeedsPredicate(Query, Vec<Reason>),
    Failed(Vec<Reason>),
}

/// Examines the proposals of one scene; what was taken counts against those that follow.
#[derive(Debug)]
pub(super) struct Screening<'a> {
    prover: Prover<'a>,
    set: &'a SceneSet,
    scene: &'a Scene,
    vocabulary: Option<&'a Vocabulary>,
    sentences: BTreeMap<String, QueryId>,
    predicates: BTreeMap<String, QueryId>,
    events: BTreeMap<(String, Name), (QueryId, Vec<Category>)>,
    numbers: BTreeSet<u32>,
}

impl<'a> Screening<'a> {
    /// A check against the queries that the scene has.
    pub(super) fn new(set: &'a SceneSet, scene: &'a Scene, vocabulary: Option<&'a Vocabulary>) -> Self {
        let prover = Prover::new(&set.tracks, set.truth.as_ref(), vocabulary);
        let mut screening = Self {
            prover,
            set,
            scene,
            vocabulary,
            sentences: BTreeMap::new(),
            predicates: BTreeMap::new(),
            events: BTreeMap::new(),
            numbers: BTreeSet::new(),
        };
        for query in [&set.queries, &set.composites, &set.absents].into_iter().flatten() {
            screening.take(query);
        }
        screening
    }

    /// Examines one proposal.
    pub(super) fn judge(&mut self, proposal: &Proposal, provenance: Provenance) -> Outcome {
        let mut reasons = self.wording_problems(proposal);
        let (referents, unknown) = self.referents(proposal);
        reasons.extend(unknown);
        if referents.is_empty() {
            return Outcome::Failed(reasons);
        }
        reasons.extend(self.look_alike_problem(&referents));
        let (predicate, unreadable) = readable_predicate(proposal);
        let query = self.query(proposal, referents, predicate.as_ref(), provenance);
        reasons.extend(self.proof_problems(&query));
        reasons.extend(self.time_problem(proposal, &query));
        reasons.extend(self.gate_problem(&query, &reasons));
        reasons.extend(predicate.as_ref().and_then(|predicate| self.repeats(&query, predicate)));
        if !reasons.is_empty() {
            reasons.extend(unreadable);
            return Outcome::Failed(reasons);
        }
        self.take(&query);
        match query.predicate {
            Some(_) => Outcome::Candidate(query),
            None => Outcome::NeedsPredicate(query, unreadable.into_iter().collect()),
        }
    }

    fn wording_problems(&self, proposal: &Proposal) -> Vec<Reason> {
        let text = &proposal.text;
        let spoken = words(text);
        let mut reasons = Vec::new();
        if !(FEWEST_WORDS..=MOST_WORDS).contains(&spoken.len()) || text.chars().count() > MOST_LETTERS {
            let message = format!("has {} words and {} letters", spoken.len(), text.chars().count());
            let hint = format!("{FEWEST_WORDS} to {MOST_WORDS} words, at most {MOST_LETTERS} letters");
            reasons.push(Reason::new("L4D565", "text", message, hint));
        }
        let unknown = self.vocabulary.map(|vocabulary| vocabulary.unknown(text)).unwrap_or_default();
        if !unknown.is_empty() {
            let message = format!("unknown: {}", unknown.join(", "));
            let hint = "add the words to benchmark/vocabulary.txt if they are right, and run again: answers are kept";
            reasons.push(Reason::new("L4D214", "text", message, hint));
        }
        if let Some(message) = form_problem(text) {
            let hint = "speak of landmarks and objects";
            reasons.push(Reason::new("L4D216", "text", message, hint));
        }
        if proposal.temporal == Temporal::While && !says_when(text) {
            let message = "temporal is `while`, but the sentence doesn't say when";
            reasons.push(Reason::new("L4D215", "text", message, "say when, or call it `whole`"));
        }
        if let Some(other) = self.sentences.get(&spoken.join(" ")) {
            let message = format!("{other} has the same sentence");
            reasons.push(Reason::new("L4D213", "text", message, "say it differently, or drop it"));
        }
        reasons
    }

    /// The objects that the numbers mean, and what is wrong with the numbers.
    fn referents(&self, proposal: &Proposal) -> (Vec<Name>, Vec<Reason>) {
        let instances = &self.set.tracks.instances;
        let hint = "refer to an object by the number on its outline";
        let (mut names, mut reasons) = (Vec::new(), Vec::new());
        for number in &proposal.referents {
            let found = (*number as usize).checked_sub(1).and_then(|index| instances.get(index));
            let message = match found {
                Some(instance) if instance.role == Role::Object => {
                    names.push(instance.name.clone());
                    continue;
                }
                Some(instance) => format!("number {number} is the landmark {}", instance.name),
                None => format!("there is no number {number}: they go from 1 to {}", instances.len()),
            };
            reasons.push(Reason::new("L4D563", "referents", message, hint));
        }
        if proposal.referents.is_empty() {
            reasons.push(Reason::new("L4D563", "referents", "names no object", hint));
        }
        (names, reasons)
    }

    fn look_alike_problem(&self, referents: &[Name]) -> Vec<Reason> {
        let tracks = &self.set.tracks;
        let is_alone = |name: &&Name| {
            let category = tracks.instance(name).map(|object| &object.category);
            !tracks.instances.iter().any(|other| {
                other.role == Role::Object
                    && Some(&other.category) == category
                    && !referents.contains(&other.name)
            })
        };
        let alone = |name: &Name| {
            let message = format!("{name} is the only one of its category");
            let hint = "a query needs a look-alike that only its discriminating clause excludes";
            Reason::new("L4D564", "referents", message, hint)
        };
        referents.iter().filter(is_alone).map(alone).collect()
    }

    fn query(
        &self,
        proposal: &Proposal,
        referents: Vec<Name>,
        predicate: Option<&Predicate>,
        provenance: Provenance,
    ) -> Query {
        let frames = match proposal.temporal {
            Temporal::Whole => vec![Interval::WHOLE],
            Temporal::While => {
                self.proved_frames(&referents, predicate).unwrap_or_else(|| proposal.frames.clone())
            }
        };
        let predicate = predicate.and(proposal.predicate.clone()).and_then(Result::ok);
        Query {
            id: self.free_id(),
            text_digest: text_digest(&proposal.text, predicate.as_ref()),
            text: proposal.text.clone(),
            categories: vec![proposal.category],
            referents,
            temporal: proposal.temporal,
            frames,
            predicate,
            provenance,
            status: Status::Candidate,
        }
    }

    /// When the predicate holds of the referent; a model that sees a few frames cannot know the edges.
    fn proved_frames(&self, referents: &[Name], predicate: Option<&Predicate>) -> Option<Vec<Interval>> {
        let [referent] = referents else { return None };
        let times = answer_times(self.prover.world(), predicate?);
        times.get(referent).map(|times| times.intervals())
    }

    fn proof_problems(&self, query: &Query) -> Vec<Reason> {
        let mut report = Report::default();
        self.prover.check(Kind::Single, &self.set.paths[1], query, &mut report);
        // Wording has been looked at already, and a missing predicate is no failure here.
        let is_known = |code: &str| match code {
            "L4D214" => true,
            "L4D216" => form_problem(&query.text).is_some(),
            "L4D215" => !says_when(&query.text) && query.temporal == Temporal::While,
            "L4D203" => query.predicate.is_none(),
            _ => false,
        };
        let is_news = |finding: &Finding| finding.severity == Severity::Error && !is_known(finding.code);
        let news = report.into_sorted().into_iter().filter(is_news);
        news.map(|Finding { code, message, hint, .. }| Reason::new(code, field_of(code), message, hint))
            .collect()
    }

    /// Whether the model saw the thing happen at about the time at which it happens.
    fn time_problem(&self, proposal: &Proposal, query: &Query) -> Option<Reason> {
        if query.temporal == Temporal::Whole || query.predicate.is_none() {
            return None;
        }
        let times = |frames: &[Interval]| {
            l4d_query::times::any_of(frames.iter().map(|&interval| Times::of(interval)))
        };
        let (claimed, proved) = (times(&proposal.frames), times(&query.frames));
        let shared = f64::from((claimed & proved).count()) / f64::from((claimed | proved).count().max(1));
        (shared < SHARED_TIME).then(|| {
            let message =
                format!("says {}, but it is so in {}", spans(&proposal.frames), spans(&query.frames));
            let hint = "look whether the sentence means what the predicate says";
            Reason::new("L4D566", "frames", message, hint)
        })
    }

    fn gate_problem(&self, query: &Query, so_far: &[Reason]) -> Vec<Reason> {
        let Some(truth) = &self.set.truth else { return Vec::new() };
        if truth.profile == Profile::Tiny
            || so_far.iter().any(|reason| matches!(reason.code, "L4D206" | "L4D210"))
        {
            return Vec::new();
        }
        let problem = |name: &Name| {
            let (code, message) = visibility_problem(truth, self.scene, query, name)?;
            Some(Reason::new(code, "referents", format!("{name}: {message}"), "ask for another object"))
        };
        query.referents.iter().filter_map(problem).collect()
    }

    fn repeats(&self, query: &Query, predicate: &Predicate) -> Option<Reason> {
        let again = |message: String| {
            Some(Reason::new("L4D212", "predicate", message, "ask something else, or drop it"))
        };
        if let Some(other) = self.predicates.get(&meaning(predicate)) {
            return again(format!("{other} has the same predicate"));
        }
        let (other, categories) =
            self.events.get(&(plain_events(predicate)?, query.referents.first()?.clone()))?;
        if *categories == query.categories {
            return None;
        }
        again(format!("{other} asks for the same event under another category"))
    }

    /// Makes a query count against those that follow.
    fn take(&mut self, query: &Query) {
        self.numbers.extend(query.id.number.parse::<u32>());
        self.sentences.insert(words(&query.text).join(" "), query.id.clone());
        let predicate = query.predicate.as_ref().and_then(|value| Predicate::from_json(value).ok());
        let Some(predicate) = predicate else { return };
        self.predicates.insert(meaning(&predicate), query.id.clone());
        if let (Some(events), [referent]) = (plain_events(&predicate), query.referents.as_slice()) {
            self.events.insert((events, referent.clone()), (query.id.clone(), query.categories.clone()));
        }
    }

    /// The first number after those of the scene's single queries that no query has.
    fn free_id(&self) -> QueryId {
        let singles = self.set.queries.iter().filter_map(|query| query.id.number.parse::<u32>().ok());
        let mut number = singles.max().unwrap_or(0) + 1;
        while self.numbers.contains(&number) {
            number += 1;
        }
        let number = Name::new(format!("{number:03}")).expect("digits are a name");
        QueryId { scene: self.set.scene.clone(), number }
    }
}

/// The predicate, or why what the model gave is none.
fn readable_predicate(proposal: &Proposal) -> (Option<Predicate>, Option<Reason>) {
    let read = |value| match value {
        Ok(value) => Predicate::from_json(value),
        Err(_) => Err("is no list of clauses in JSON".to_owned()),
    };
    match proposal.predicate.as_ref().map(|value| read(value.as_ref())) {
        None => (None, None),
        Some(Ok(predicate)) => (Some(predicate), None),
        Some(Err(message)) => {
            let hint = "write the predicate by hand (docs/queries.md)";
            (None, Some(Reason::new("L4D567", "predicate", message, hint)))
        }
    }
}

/// The part of a query that a finding of `check-queries` speaks of.
fn field_of(code: &str) -> &'static str {
    match code {
        "L4D202" | "L4D210" => "referents",
        "L4D206" => "frames",
        "L4D207" => "category",
        "L4D213" | "L4D214" | "L4D215" | "L4D216" => "text",
        _ => "predicate",
    }
}

fn spans(frames: &[Interval]) -> String {
    let spans: Vec<String> =
        frames.iter().map(|interval| format!("[{}, {}]", interval.first(), interval.last())).collect();
    spans.join(", ")
}

#[cfg(test)]
pub(crate) mod tests;
