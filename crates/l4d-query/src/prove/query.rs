//! One query: exactly one answer, real distractors, and no answer that hangs on a threshold.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::timeline::{Interval, MIN_INTERVAL};
use l4d_data::tracks::Tracks;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Category, Finding, Name, Query, Report, Role, Temporal};

use super::{Vocabulary, wording};
use crate::ast::{Clause, Party, Predicate, Relation};
use crate::eval::{Answer, answer_times, answer_whole, members};
use crate::thresholds::{EDGE_FRAMES, SLACK, Slack};
use crate::times::{Times, any_of};
use crate::world::World;

/// The five pairs of categories that composites ask for, in the paper's order.
pub const COMPOSITES: [(&str, [Category; 2]); 5] = [
    ("attribute+action", [Category::Attribute, Category::Action]),
    ("attribute+interaction", [Category::Attribute, Category::Interaction]),
    ("attribute+spatial", [Category::Attribute, Category::Spatial]),
    ("spatial+action", [Category::Action, Category::Spatial]),
    ("spatial+interaction", [Category::Spatial, Category::Interaction]),
];

/// What a query is expected to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// One category, one referent.
    Single,
    /// Two categories, each ambiguous alone.
    Composite,
    /// Nothing satisfies it.
    Absent,
}

impl Kind {
    /// In the order of their files.
    pub(super) const ALL: [Self; 3] = [Self::Single, Self::Composite, Self::Absent];
}

/// Proves the queries of one scene.
#[derive(Debug)]
pub struct Prover<'a> {
    world: World<'a>,
    others: [(Slack, World<'a>); 2],
    truth: Option<&'a Truth>,
    vocabulary: Option<&'a Vocabulary>,
}

impl<'a> Prover<'a> {
    /// A prover for the scene of these tracks.
    pub fn new(tracks: &'a Tracks, truth: Option<&'a Truth>, vocabulary: Option<&'a Vocabulary>) -> Self {
        let world = World::new(tracks);
        let others = [Slack::Tight, Slack::Loose].map(|slack| (slack, world.with_slack(slack)));
        Self { world, others, truth, vocabulary }
    }

    /// The scene with thresholds as stated.
    pub fn world(&self) -> &World<'a> {
        &self.world
    }

    /// The scene with thresholds as stated, harder and easier to satisfy.
    pub fn worlds(&self) -> [&World<'a>; 3] {
        let [(_, tight), (_, loose)] = &self.others;
        [&self.world, tight, loose]
    }

    /// Reports everything that is wrong with a query; `path` is its file.
    pub fn check(&self, kind: Kind, path: &Path, query: &Query, report: &mut Report) {
        let mut check = QueryCheck { prover: self, kind, path, query, report, is_said: true };
        check.run();
    }

    /// What is wrong with a query whatever its sentence will be, first the finding that comes first; each description
    /// must mean one instance, as if the sentence said "the".
    pub fn objection(&self, kind: Kind, query: &Query) -> Option<Finding> {
        let mut report = Report::default();
        let path = Path::new("");
        let mut check = QueryCheck { prover: self, kind, path, query, report: &mut report, is_said: false };
        check.run();
        report.into_sorted().into_iter().next()
    }
}

/// One query being examined.
struct QueryCheck<'e, 'a> {
    prover: &'e Prover<'a>,
    kind: Kind,
    path: &'e Path,
    query: &'e Query,
    report: &'e mut Report,
    /// Whether there is a sentence yet.
    is_said: bool,
}

impl QueryCheck<'_, '_> {
    fn add(&mut self, code: &'static str, message: impl Into<String>, hint: &str) {
        let place = format!("query {} (\"{}\")", self.query.id, self.query.text);
        self.report.error(code, self.path, place, message, hint);
    }

    fn run(&mut self) {
        if !self.referents_fit() || !self.frames_fit() {
            return;
        }
        self.check_visibility();
        let Some(value) = &self.query.predicate else {
            return self.add("L4D203", "has no predicate", "only queries of real scenes may go without one");
        };
        let predicate = match Predicate::from_json(value) {
            Ok(predicate) => predicate,
            Err(message) => {
                return self.add("L4D203", format!("predicate: {message}"), "see docs/queries.md");
            }
        };
        if self.is_said {
            self.check_wording(&predicate);
        }
        if self.vocabulary_is_known(&predicate) && self.descriptions_fit(&predicate) {
            self.check_category(&predicate);
            match self.kind {
                Kind::Absent => self.check_nothing_satisfies(&predicate),
                Kind::Single | Kind::Composite => {
                    self.check_answer(&predicate);
                    self.check_ambiguity(&predicate);
                }
            }
        }
    }

    fn referents_fit(&mut self) -> bool {
        let world = &self.prover.world;
        let is_object = |name: &Name| world.instance(name).is_some_and(|found| found.role == Role::Object);
        let unknown: Vec<&Name> = self.query.referents.iter().filter(|name| !is_object(name)).collect();
        for name in &unknown {
            let message = format!("referent `{name}` is no object of the scene");
            self.add("L4D202", message, "name an instance with role object");
        }
        let wanted = if self.kind == Kind::Absent { 0 } else { 1 };
        let count = self.query.referents.len();
        if count != wanted {
            self.add(
                "L4D202",
                format!("has {count} referents, not {wanted}"),
                "a query means exactly one object",
            );
        }
        unknown.is_empty() && count == wanted
    }

    fn frames_fit(&mut self) -> bool {
        let is_short = |interval: &Interval| interval.frame_count() < MIN_INTERVAL;
        let problem = frames_problem(self.query, Interval::WHOLE).or_else(|| {
            let message =
                format!("an interval is shorter than {MIN_INTERVAL} frames, so a profile could miss it");
            self.query.frames.iter().any(is_short).then_some(message)
        });
        let fits = problem.is_none();
        if let Some(message) = problem {
            self.add("L4D206", message, "write the interval in which the predicate holds");
        }
        fits
    }

    fn check_visibility(&mut self) {
        let Some(truth) = self.prover.truth else { return };
        for name in self.query.referents.iter().filter(|name| is_never_seen(truth, self.query, name)) {
            let message = format!("`{name}` is never visible in the held-out view while the query holds");
            self.add("L4D210", message, "move the cameras or the object, or drop the query");
        }
    }

    fn check_wording(&mut self, predicate: &Predicate) {
        let text = &self.query.text;
        if let Some(message) = wording::temporal_problem(text, self.query.temporal, predicate) {
            self.add(
                "L4D215",
                message,
                "`whole` names an identity (\"that walks\"), `while` a time (\"while it walks\")",
            );
        }
        if let Some(message) = wording::place_problem(text, predicate) {
            self.add("L4D216", message, "speak of landmarks and objects, and of the front of what has one");
        }
        let unknown = self.prover.vocabulary.map(|vocabulary| vocabulary.unknown(text)).unwrap_or_default();
        if !unknown.is_empty() {
            let message = format!("unknown: {}", unknown.join(", "));
            self.add("L4D214", message, "mend the spelling, or add the word to benchmark/vocabulary.txt");
        }
    }

    /// Whether every noun, verb, property and name of the predicate is one of the scene.
    fn vocabulary_is_known(&mut self, predicate: &Predicate) -> bool {
        let world = &self.prover.world;
        let mut unknown: Vec<String> = Vec::new();
        if !world.objects().any(|object| object.category == predicate.noun()) {
            unknown.push(format!("the scene has no object of category `{}`", predicate.noun()));
        }
        for party in predicate.parties() {
            unknown.extend(unknown_party(world, party));
        }
        for clause in predicate.clauses() {
            unknown.extend(unknown_word(world, predicate.noun(), clause, self.kind == Kind::Absent));
        }
        for message in &unknown {
            self.add("L4D203", format!("predicate: {message}"), "use what benchmark/scenes declares");
        }
        unknown.is_empty()
    }

    /// Whether each description means an instance, and exactly one where the sentence speaks of "the" one.
    fn descriptions_fit(&mut self, predicate: &Predicate) -> bool {
        let mut fits = true;
        for party in predicate.parties() {
            if !matches!(party, Party::Such(_)) {
                continue;
            }
            let found = members(&self.prover.world, party);
            let names: Vec<&str> = found.iter().map(|instance| instance.name.as_str()).collect();
            let message = match names.len() {
                0 if self.kind == Kind::Absent => continue,
                0 => format!("no one is {party}"),
                1 => continue,
                _ if self.is_said && wording::is_indefinite(&self.query.text) => continue,
                _ => format!("{party} is not one but several: {}", names.join(", ")),
            };
            self.add("L4D208", message, "describe it so that it is one, or write \"a\" for any");
            fits = false;
        }
        fits
    }

    fn check_category(&mut self, predicate: &Predicate) {
        let follows = predicate.categories();
        if follows != self.query.categories {
            let message =
                format!("categories are {:?}, but the predicate gives {follows:?}", self.query.categories);
            return self.add("L4D207", message, "the category is that of the discriminating clauses");
        }
        if let Some((message, hint)) = category_problem(self.kind, &follows) {
            self.add("L4D207", message, hint);
        }
    }

    fn check_answer(&mut self, predicate: &Predicate) {
        let claimed: Answer = self.query.referents.iter().cloned().collect();
        match self.query.temporal {
            Temporal::Whole => {
                let answer = answer_whole(&self.prover.world, predicate);
                if answer != claimed {
                    let message = format!("means {}, but refers to {}", list(&answer), list(&claimed));
                    let hint = "sharpen the sentence and its predicate, or correct the referents";
                    return self.add("L4D204", message, hint);
                }
                for (slack, other) in &self.prover.others {
                    let moved = answer_whole(other, predicate);
                    if moved != answer {
                        self.hangs(*slack, predicate, format!("means {}", list(&moved)));
                    }
                }
            }
            Temporal::While => {
                let claim = any_of(self.query.frames.iter().map(|&interval| Times::of(interval)));
                let expected: BTreeMap<Name, Times> = claimed.into_iter().map(|name| (name, claim)).collect();
                let times = answer_times(&self.prover.world, predicate);
                if times != expected {
                    let message = format!("holds for {}, but claims {}", when(&times), when(&expected));
                    return self.add("L4D206", message, "write the interval in which the predicate holds");
                }
                let free = claim.near_edges(EDGE_FRAMES).complement();
                let settled = |times: BTreeMap<Name, Times>| -> BTreeMap<Name, Times> {
                    let masked = times.into_iter().map(|(name, times)| (name, times & free));
                    masked.filter(|(_, times)| times.any()).collect()
                };
                let expected = settled(expected);
                for (slack, other) in &self.prover.others {
                    let moved = answer_times(other, predicate);
                    let is_referent = |name: &Name| self.query.referents.contains(name);
                    let is_new = moved.keys().any(|name| !is_referent(name));
                    if is_new || settled(moved.clone()) != expected {
                        self.hangs(*slack, predicate, format!("holds for {}", when(&moved)));
                    }
                }
            }
        }
    }

    /// Nothing satisfies it: not over the clip, and never all of it at once.
    fn check_nothing_satisfies(&mut self, predicate: &Predicate) {
        let worlds = [(Slack::Nominal, &self.prover.world)].into_iter();
        let others = self.prover.others.iter().map(|(slack, world)| (*slack, world));
        for (slack, world) in worlds.chain(others) {
            let mut found = answer_whole(world, predicate);
            found.extend(answer_times(world, predicate).into_keys());
            match slack {
                _ if found.is_empty() => {}
                Slack::Nominal => {
                    let message = format!("should mean nothing, but means {}", list(&found));
                    return self.add("L4D217", message, "write a sentence that nothing satisfies");
                }
                _ => self.hangs(slack, predicate, format!("means {}", list(&found))),
            }
        }
    }

    fn hangs(&mut self, slack: Slack, predicate: &Predicate, consequence: String) {
        let change = if slack == Slack::Tight { "tighter" } else { "looser" };
        let percent = SLACK * 100.0;
        let culprits: Vec<String> = self.moved_clauses(slack, predicate);
        let message = format!(
            "hangs on a threshold: with thresholds {percent} % {change} it {consequence} (see {})",
            culprits.join("; ")
        );
        self.add("L4D211", message, "move things apart, so that no relation is close to its threshold");
    }

    /// The clauses whose truth for any instance changes with the slack.
    fn moved_clauses(&self, slack: Slack, predicate: &Predicate) -> Vec<String> {
        let noun = Clause::Category(predicate.noun().to_owned());
        let moved = |clause: &&Clause| {
            let alone = Predicate(vec![noun.clone(), (*clause).clone()]);
            let other = self.prover.world.with_slack(slack);
            answer_times(&self.prover.world, &alone) != answer_times(&other, &alone)
        };
        predicate.discriminating().filter(moved).map(Clause::to_string).collect()
    }

    /// There are look-alikes, and the discriminating clauses are what tells them apart.
    fn check_ambiguity(&mut self, predicate: &Predicate) {
        for category in predicate.categories() {
            let without = predicate.without(category);
            let left = answer_whole(&self.prover.world, &without).len();
            if left <= self.query.referents.len() {
                let clause = category.as_str();
                let message = format!("without its {clause} clause ({without}) it means no more than one");
                self.add("L4D205", message, "a query needs a distractor that only this clause excludes");
            }
        }
    }
}

/// What is wrong with the frames of a query in a clip.
pub(super) fn frames_problem(query: &Query, clip: Interval) -> Option<String> {
    let [first, last] = [clip.first(), clip.last()];
    match query.temporal {
        Temporal::Whole if query.frames != [clip] => {
            Some(format!("temporal is `whole`, but frames are not [[{first}, {last}]]"))
        }
        Temporal::While if query.frames.iter().any(|part| part.first() < first || part.last() > last) => {
            Some(format!("frames go beyond the clip, [{first}, {last}]"))
        }
        _ => None,
    }
}

/// Whether the held-out view shows an instance in no frame in which the query holds.
pub(super) fn is_never_seen(truth: &Truth, query: &Query, name: &Name) -> bool {
    let shows = |frame: u32| {
        truth.instance(name).is_some_and(|instance| instance.masks.contains_key(&frame_key(frame)))
    };
    !truth.frames.iter().any(|&frame| query.holds_at(frame) && shows(frame))
}

/// Why these categories are not what the file of this kind holds, and what to do.
pub(super) fn category_problem(kind: Kind, categories: &[Category]) -> Option<(String, &'static str)> {
    let is_pair = COMPOSITES.iter().any(|(_, pair)| categories == pair);
    let fits = match kind {
        Kind::Single => categories.len() == 1,
        Kind::Composite => is_pair,
        Kind::Absent => !categories.is_empty(),
    };
    let hint = "single categories are in <scene>.jsonl, pairs in <scene>.composite.jsonl";
    (!fits).then(|| (format!("{categories:?} is not what this file holds"), hint))
}

fn unknown_party(world: &World<'_>, party: &Party) -> Option<String> {
    match party {
        Party::Name(name) => match world.instance(name) {
            None => Some(format!("`{name}` is no instance of the scene")),
            Some(instance) if instance.role == Role::Object => {
                Some(format!("names the object `{name}`: describe it with `such`"))
            }
            Some(_) => None,
        },
        Party::Category(noun) => {
            let known = world.instances().any(|instance| instance.category == *noun);
            (!known).then(|| format!("the scene has nothing of category `{noun}`"))
        }
        Party::Such(_) => None,
    }
}

fn unknown_word(world: &World<'_>, noun: &str, clause: &Clause, may_be_new: bool) -> Option<String> {
    match clause {
        Clause::Does { verb, .. } | Clause::Undergoes { verb, .. } => {
            (!may_be_new && !world.has_verb(verb)).then(|| format!("no one does `{verb}` in this scene"))
        }
        Clause::Attribute { key, value } => {
            let known =
                world.instances().any(|instance| instance.attributes.get(key).is_some_and(|v| v == value));
            (!may_be_new && !known).then(|| format!("nothing in this scene has {key} `{value}`"))
        }
        Clause::Relation { kind: Relation::InFrontOf | Relation::Behind, of } => {
            let faceless =
                of.iter().flat_map(|party| members(world, party)).find(|other| other.front.is_none());
            faceless.map(|other| format!("`{}` has no front", other.name))
        }
        Clause::Relation { kind: Relation::Facing, .. } => {
            let faceless = world.objects().find(|object| object.category == noun && object.front.is_none());
            faceless.map(|object| format!("`{}` has no front", object.name))
        }
        _ => None,
    }
}

fn list(answer: &Answer) -> String {
    if answer.is_empty() {
        return "nothing".to_owned();
    }
    answer.iter().map(Name::as_str).collect::<Vec<_>>().join(", ")
}

fn when(times: &BTreeMap<Name, Times>) -> String {
    if times.is_empty() {
        return "nothing".to_owned();
    }
    let spans = |times: &Times| -> String {
        let spans = times.intervals();
        let spans: Vec<String> =
            spans.iter().map(|span| format!("[{},{}]", span.first(), span.last())).collect();
        spans.join(",")
    };
    times
        .iter()
        .map(|(name, times)| format!("{name} at [{}]", spans(times)))
        .collect::<Vec<_>>()
        .join(" and ")
}
