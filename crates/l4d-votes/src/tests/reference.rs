//! Whatever annotators, editors and power cuts do in whatever order, the verdict is that of a slow, obvious
//! reference without files, stacks and digests.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::time::Duration;

use l4d_data::{Interval, Temporal};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::fixture::{folder, interval, meaning, name, objects, open, round_and_key, save, whole};
use crate::key::{Change, Key};
use crate::responses::read_responses;
use crate::verdict::{Outcome, judge, require_sealed};
use crate::{Answer, Ballot, Choice, Event, ItemId, Round, RoundDir, ShownFrames};

const ANNOTATORS: [&str; 3] = ["ada", "ben", "cho"];
const ITEMS: usize = 2;

#[derive(Debug, Clone, PartialEq, Eq)]
enum Act {
    /// One of the answers of [`answer`].
    Choose(usize),
    Skip,
    Comment(u8),
    Undo,
}

/// Annotators and items by their numbers.
#[derive(Debug, Clone)]
enum Step {
    Do(usize, usize, Act),
    /// Skips what is open and seals.
    Finish(usize),
    Seal(usize),
    /// The query gets this wording in the benchmark.
    Edit(usize, usize),
    /// The round is written again with the benchmark's wording of today.
    Reissue,
    /// The process is killed after so many bytes of a line.
    Kill(usize, usize),
    Look,
}

fn answer(which: usize) -> Answer {
    match which {
        0 => Answer { frames: interval(0, 12), ..whole(objects(&["a"])) },
        1 => whole(objects(&["b"])),
        2 => whole(objects(&["a", "b"])),
        3 => whole(Choice::None),
        5.. => whole(objects(&["a"])),
        4 => whole(Choice::Ambiguous { reason: "two of them".to_owned() }),
    }
}

/// What [`answer`] is to item 0, which always means `a`, and to item 1, which means `a` at frames 40 to 60.
fn letter(which: usize, item: usize) -> char {
    match which {
        0 => ['+', 't'][item],
        1 | 2 => 'x',
        3 => '0',
        4 => '?',
        _ => '+',
    }
}

/// The round that asks the items in these wordings.
fn asked(versions: &[usize; ITEMS]) -> (Round, Key) {
    let always = meaning(&["a"], Temporal::Whole, Interval::WHOLE);
    let while_ = meaning(&["a"], Temporal::While, interval(40, 60));
    let item = |(index, meaning): (usize, _)| {
        ("room".to_owned(), format!("The cat {index} in words {}", versions[index]), meaning)
    };
    round_and_key(&ANNOTATORS, [always, while_].into_iter().enumerate().map(item).collect())
}

/// What was acknowledged, in order, and nothing else.
#[derive(Debug, Default)]
struct Reference {
    acts: Vec<(usize, usize, usize, Act)>,
    sealed: [bool; ANNOTATORS.len()],
    /// Wording in the benchmark.
    bench: [usize; ITEMS],
    /// Wording in the round.
    round: [usize; ITEMS],
}

impl Reference {
    /// What of an annotator's acts on a wording was not taken back, by going through all of them.
    fn left(&self, who: usize, item: usize, version: usize) -> Vec<(usize, Act)> {
        let mut left = Vec::new();
        for (time, (by, on, words, act)) in self.acts.iter().enumerate() {
            if (*by, *on, *words) == (who, item, version) {
                if *act == Act::Undo {
                    left.remove(left.len() - 1);
                } else {
                    left.push((time, act.clone()));
                }
            }
        }
        left
    }

    fn last_decision(&self, who: usize, item: usize, version: usize) -> Option<(usize, Act)> {
        let mut left = self.left(who, item, version);
        left.retain(|(_, act)| !matches!(act, Act::Comment(_)));
        left.pop()
    }

    fn comments(&self, who: usize, item: usize) -> Vec<String> {
        let left = self.left(who, item, self.round[item]).into_iter();
        left.filter_map(|(_, act)| match act {
            Act::Comment(number) => Some(format!("remark {number}")),
            _ => None,
        })
        .collect()
    }

    fn is_allowed(&self, who: usize, item: usize, act: &Act) -> bool {
        let has_some = !self.left(who, item, self.round[item]).is_empty();
        !self.sealed[who] && (*act != Act::Undo || has_some)
    }

    fn may_seal(&self, who: usize) -> bool {
        let is_done = |item: usize| self.last_decision(who, item, self.round[item]).is_some();
        !self.sealed[who] && (0..ITEMS).all(is_done)
    }

    fn mark(&self, who: usize, item: usize) -> char {
        match self.last_decision(who, item, self.round[item]) {
            Some((_, Act::Choose(which))) => letter(which, item),
            Some(_) => 's',
            None => {
                let elsewhere = (0..9).filter(|version| *version != self.round[item]);
                let latest = elsewhere
                    .filter_map(|version| self.last_decision(who, item, version))
                    .max_by_key(|x| x.0);
                if matches!(latest, Some((_, Act::Choose(_)))) { '~' } else { '.' }
            }
        }
    }

    fn pattern(&self, item: usize) -> String {
        (0..ANNOTATORS.len()).map(|who| self.mark(who, item)).collect()
    }

    fn outcome(&self, item: usize) -> Outcome {
        let pattern = self.pattern(item);
        let count = |letters: &str| pattern.chars().filter(|letter| letters.contains(*letter)).count();
        if self.bench[item] != self.round[item] || count("~") > 0 {
            Outcome::Stale
        } else if count("s.") > 0 {
            Outcome::Incomplete
        } else if count("+") == ANNOTATORS.len() {
            Outcome::Valid
        } else {
            Outcome::Rejected
        }
    }
}

/// The real thing beside the reference.
struct World {
    _folder: tempfile::TempDir,
    dir: RoundDir,
    round: Round,
    ballots: Vec<Option<Ballot>>,
    reference: Reference,
}

fn id(item: usize) -> ItemId {
    format!("q{:04}", item + 1).parse().unwrap()
}

impl World {
    fn new() -> Self {
        let (folder, dir) = folder();
        let (round, key) = asked(&[0; ITEMS]);
        save(&dir, &round, &key);
        let ballots = ANNOTATORS.iter().map(|_| None).collect();
        Self { _folder: folder, dir, round, ballots, reference: Reference::default() }
    }

    fn ballot(&mut self, who: usize) -> &mut Ballot {
        let (dir, round) = (&self.dir, &self.round);
        self.ballots[who].get_or_insert_with(|| {
            let (ballot, notices) = Ballot::open(dir, round, &name(ANNOTATORS[who])).unwrap();
            assert!(notices.is_empty(), "{notices:?}");
            ballot
        })
    }

    fn step(&mut self, step: Step) {
        match step {
            Step::Do(who, item, act) => self.act(who, item, act),
            Step::Finish(who) => {
                for item in 0..ITEMS {
                    if self.ballot(who).response(&id(item)).unwrap().is_open() {
                        self.act(who, item, Act::Skip);
                    }
                }
                self.seal(who);
            }
            Step::Seal(who) => self.seal(who),
            Step::Edit(item, version) => self.reference.bench[item] = version,
            Step::Reissue => {
                self.reference.round = self.reference.bench;
                let (round, key) = asked(&self.reference.round);
                save(&self.dir, &round, &key);
                self.round = round;
                self.ballots.fill_with(|| None);
            }
            Step::Kill(who, bytes) => self.kill(who, bytes),
            Step::Look => self.look(),
        }
    }

    fn act(&mut self, who: usize, item: usize, act: Act) {
        let event = match act {
            Act::Choose(which) => Event::Choose(answer(which)),
            Act::Skip => Event::Skip,
            Act::Comment(number) => Event::Comment { text: format!("remark {number}") },
            Act::Undo => Event::Undo,
        };
        let result =
            self.ballot(who).record(&id(item), event, ShownFrames::default(), Duration::from_millis(5));
        assert_eq!(result.is_ok(), self.reference.is_allowed(who, item, &act), "{act:?}: {result:?}");
        if result.is_ok() {
            self.reference.acts.push((who, item, self.reference.round[item], act));
        }
    }

    fn seal(&mut self, who: usize) {
        let result = self.ballot(who).seal();
        assert_eq!(result.is_ok(), self.reference.may_seal(who), "{result:?}");
        self.reference.sealed[who] |= result.is_ok();
    }

    fn kill(&mut self, who: usize, bytes: usize) {
        self.ballot(who);
        self.ballots[who] = None;
        let line = br#"{"v":1,"seq":0,"at":"2026-11-21T06:00:00.000Z","round":"r1","annotator":"ada","item":"q0001","order":1,"digest":""}"#;
        let torn = &line[..bytes.min(line.len())];
        let annotator = name(ANNOTATORS[who]);
        let path = self.dir.ballot(&annotator);
        OpenOptions::new().append(true).open(path).unwrap().write_all(torn).unwrap();
        self.look();
        let (ballot, notices) = Ballot::open(&self.dir, &self.round, &annotator).unwrap();
        assert_eq!(notices.len(), usize::from(!torn.is_empty()), "{notices:?}");
        self.ballots[who] = Some(ballot);
    }

    /// The verdict against the reference's.
    fn look(&self) {
        let (round, key) = open(&self.dir);
        let (responses, _) = read_responses(&self.dir, &round).unwrap();
        let Reference { bench, round: asked, .. } = &self.reference;
        let is_edited = (0..ITEMS).filter(|&item| bench[item] != asked[item]);
        let changes: BTreeMap<ItemId, Change> = is_edited.map(|item| (id(item), Change::Edited)).collect();
        let verdicts = judge(&round, &key, &responses, &changes);
        for (item, verdict) in verdicts.items.iter().enumerate() {
            assert_eq!(verdict.item, id(item));
            assert_eq!(verdict.pattern(), self.reference.pattern(item), "item {item}");
            assert_eq!(verdict.outcome, self.reference.outcome(item), "item {item}");
            for (who, vote) in verdict.votes.iter().enumerate() {
                assert_eq!(vote.comments, self.reference.comments(who, item));
            }
        }
        assert_eq!(verdicts.items.len(), ITEMS);
        let all_sealed = self.reference.sealed.iter().all(|sealed| *sealed);
        assert_eq!(verdicts.is_final, all_sealed);
        assert_eq!(require_sealed(&round, &responses).is_ok(), all_sealed);
    }
}

fn acts() -> impl Strategy<Value = Act> {
    prop_oneof![
        6 => (0..18_usize).prop_map(Act::Choose),
        1 => Just(Act::Skip),
        1 => (0..9_u8).prop_map(Act::Comment),
        3 => Just(Act::Undo),
    ]
}

fn steps() -> impl Strategy<Value = Step> {
    let who = 0..ANNOTATORS.len();
    prop_oneof![
        20 => (who.clone(), 0..ITEMS, acts()).prop_map(|(who, item, act)| Step::Do(who, item, act)),
        1 => who.clone().prop_map(Step::Finish),
        1 => who.clone().prop_map(Step::Seal),
        1 => (0..ITEMS, 0..3_usize).prop_map(|(item, version)| Step::Edit(item, version)),
        1 => Just(Step::Reissue),
        2 => (who, 0..200_usize).prop_map(|(who, bytes)| Step::Kill(who, bytes)),
        2 => Just(Step::Look),
    ]
}

/// The tally says that the walks get somewhere: otherwise the property would hold of nothing.
#[test]
fn any_interleaving_gives_the_verdict_of_the_reference() {
    let tally = RefCell::new((BTreeMap::new(), 0));
    let walks = proptest::collection::vec(steps(), 1..60);
    let config = ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() };
    let run = TestRunner::new(config).run(&walks, |steps| {
        let mut world = World::new();
        steps.into_iter().for_each(|step| world.step(step));
        world.look();
        let (outcomes, finals) = &mut *tally.borrow_mut();
        (0..ITEMS).for_each(|item| *outcomes.entry(world.reference.outcome(item)).or_insert(0) += 1);
        *finals += usize::from(world.reference.sealed == [true; ANNOTATORS.len()]);
        Ok(())
    });
    run.unwrap_or_else(|error| panic!("{error}"));
    let (outcomes, finals) = tally.into_inner();
    let is_reached = |outcome: &Outcome| outcomes.get(outcome).is_some_and(|&times: &usize| times >= 10);
    assert!(Outcome::ALL.iter().all(is_reached) && finals >= 3, "{outcomes:?}, {finals} ended sealed");
}
