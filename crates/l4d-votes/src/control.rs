//! Control items: sentences whose right answer is known, and prompts that are asked twice.
//!
//! They say how far to trust an annotator, and only that: no vote is dropped because of them.

use l4d_data::{Name, Report};
use serde::Serialize;

use crate::codes;
use crate::item::ItemId;
use crate::key::{ItemSource, Key};
use crate::responses::Responses;
use crate::round::Round;

/// How one annotator did on one kind of control items.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Consistency {
    /// How many were asked.
    pub asked: usize,
    /// How many of them were answered (of repeats: both times).
    pub answered: usize,
    /// How many of those are right (of repeats: the same choice both times).
    pub kept: usize,
    /// The others.
    pub missed: Vec<ItemId>,
}

impl Consistency {
    /// The share of the answered ones; none without an answer.
    pub fn share(&self) -> Option<f64> {
        (self.answered > 0).then(|| self.kept as f64 / self.answered as f64)
    }

    fn count(&mut self, item: &ItemId, is_kept: Option<bool>) {
        self.asked += 1;
        match is_kept {
            Some(true) => self.kept += 1,
            Some(false) => self.missed.push(item.clone()),
            None => return,
        }
        self.answered += 1;
    }
}

/// Answers to the sentences whose right answer is known.
pub fn gold(key: &Key, given: &Responses) -> Consistency {
    let mut consistency = Consistency::default();
    for (item, source) in key.entries() {
        match source {
            ItemSource::Absent { .. } | ItemSource::Vague { .. } => {
                consistency.count(item, given.answer(item).and_then(|answer| source.gold(answer)));
            }
            ItemSource::Query { .. } | ItemSource::Repeat { .. } => {}
        }
    }
    consistency
}

/// Answers to the prompts that are asked twice. The same objects, or the same refusal, are the same choice; why
/// something is ambiguous may be worded anew, and frames may differ.
pub fn repeats(key: &Key, given: &Responses) -> Consistency {
    let mut consistency = Consistency::default();
    for (item, source) in key.entries() {
        if let ItemSource::Repeat { of } = source {
            let both = given.answer(of).zip(given.answer(item));
            consistency.count(item, both.map(|(first, again)| first.choice.label() == again.choice.label()));
        }
    }
    consistency
}

/// Reports who is wrong on more sentences than the round allows.
pub(crate) fn report_misses(
    round: &Round,
    key: &Key,
    responses: &[(&Name, Option<&Responses>)],
    report: &mut Report,
) {
    for (annotator, given) in responses {
        let Some(gold) = given.map(|given| gold(key, given)) else { continue };
        if gold.share().is_some_and(|share| share < round.gold.flag_below) {
            report.warning(
                codes::GOLD_MISSED,
                &round.dir().ballot(annotator),
                "control items",
                format!("right on {} of {}: the votes count all the same", gold.kept, gold.answered),
                "talk to the annotator before you trust the round",
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use l4d_data::{Interval, Temporal};

    use super::*;
    use crate::fixture::{items, meaning, name, objects, round_of, whole};
    use crate::vote::{Choice, Response};

    fn id(number: usize) -> ItemId {
        ItemId::numbered(number, 4)
    }

    /// Items 1 and 2 ask the bare category, 3 asks a query, 4 asks it again.
    fn key() -> Key {
        let meaning = || meaning(&["a", "b"], Temporal::Whole, Interval::WHOLE);
        let vague = || ItemSource::Vague { category: "cat".to_owned(), meaning: meaning() };
        let query = ItemSource::Query {
            query: "room/001".parse().unwrap(),
            categories: Vec::new(),
            meaning: meaning(),
        };
        Key::new(
            [vague(), vague(), query, ItemSource::Repeat { of: id(3) }]
                .into_iter()
                .zip(1..)
                .map(|(b, n)| (id(n), b))
                .collect(),
        )
    }

    fn sheet(answers: &[(usize, Choice)]) -> Responses {
        let response =
            |choice: &Choice| Response { answer: Some(whole(choice.clone())), ..Response::default() };
        let items = answers.iter().map(|(number, choice)| (id(*number), response(choice))).collect();
        Responses { annotator: name("ada"), sealed: true, items }
    }

    fn ambiguous(reason: &str) -> Choice {
        Choice::Ambiguous { reason: reason.to_owned() }
    }

    #[test]
    fn gold_counts_what_was_answered() {
        let half = gold(&key(), &sheet(&[(1, ambiguous("two")), (2, objects(&["a"]))]));
        assert_eq!((half.asked, half.answered, half.kept, half.missed.as_slice()), (2, 2, 1, &[id(2)][..]));
        assert_eq!(half.share(), Some(0.5));
        let none = gold(&key(), &sheet(&[(3, Choice::None)]));
        assert_eq!((none.asked, none.answered, none.share()), (2, 0, None));
    }

    #[test]
    fn a_repeat_is_the_same_choice_whatever_its_words() {
        let said = |first: Choice, again: Choice| repeats(&key(), &sheet(&[(3, first), (4, again)])).kept;
        assert_eq!(said(objects(&["a", "b"]), objects(&["b", "a"])), 1);
        assert_eq!(said(ambiguous("two"), ambiguous("which one?")), 1);
        assert_eq!(said(objects(&["a"]), objects(&["a", "b"])), 0);
        assert_eq!(said(Choice::None, ambiguous("two")), 0);
        let once = repeats(&key(), &sheet(&[(3, Choice::None)]));
        assert_eq!((once.asked, once.answered), (1, 0));
    }

    #[test]
    fn who_misses_too_much_is_reported_and_still_counted() {
        let round = round_of(&["ada"], items("room", &["The cat", "The dog", "The toy", "The cup"]));
        let found = |answers: &[(usize, Choice)]| {
            let (ada, sheet, mut report) = (name("ada"), sheet(answers), Report::default());
            report_misses(&round, &key(), &[(&ada, Some(&sheet))], &mut report);
            report.into_sorted()
        };
        assert_eq!(found(&[(1, ambiguous("two")), (2, objects(&["a", "b"]))]), []);
        assert_eq!(found(&[]), []);
        let missed = found(&[(1, ambiguous("two")), (2, Choice::None)]);
        assert_eq!((missed[0].code, missed.len()), (codes::GOLD_MISSED, 1));
        assert!(missed[0].message.contains("right on 1 of 2"), "{}", missed[0].message);
    }
}
