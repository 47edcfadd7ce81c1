//! Control items: sentences whose right answer is known, and prompts that are asked twice.
//!
//! They say how far to trust an annotator, and only that: no vote is dropped because of them.

use l4d_data::Report;
use serde::Serialize;

use crate::item::ItemId;
use crate::key::{ItemSource, Key};
use crate::responses::Responses;
use crate::round::Round;

/// Who is right on a smaller share of the control items is reported.
const LEAST_GOLD: f64 = 0.75;

/// How one annotator did on one kind of control items.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Consistency {
    pub asked: usize,
    /// How many of them were answered (of repeats: both times).
    pub answered: usize,
    /// How many of those are right (of repeats: the same choice both times).
    pub kept: usize,
    pub missed: Vec<ItemId>,
}

impl Consistency {
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
pub(crate) fn gold(key: &Key, given: &Responses) -> Consistency {
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
pub(crate) fn repeats(key: &Key, given: &Responses) -> Consistency {
    let mut consistency = Consistency::default();
    for (item, source) in key.entries() {
        if let ItemSource::Repeat { of } = source {
            let both = given.answer(of).zip(given.answer(item));
            consistency.count(item, both.map(|(first, again)| first.choice.label() == again.choice.label()));
        }
    }
    consistency
}

/// Reports who is right on too few sentences.
pub(crate) fn report_misses(round: &Round, key: &Key, responses: &[Responses], report: &mut Report) {
    for given in responses {
        let gold = gold(key, given);
        if (gold.kept as f64) < LEAST_GOLD * gold.answered as f64 {
            report.warning(
                "L4D522",
                &round.dir().ballot(&given.annotator),
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
        let query = "room/001".parse().unwrap();
        let query = ItemSource::Query { query, categories: Vec::new(), meaning: meaning() };
        let sources = [vague(), vague(), query, ItemSource::Repeat { of: id(3) }];
        Key::new((1..).map(id).zip(sources).collect())
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
    fn gold_counts_what_was_answered_and_who_misses_too_much_is_reported() {
        let round = round_of(&["ada"], items("room", &["The cat", "The dog", "The toy", "The cup"]));
        let two = || ambiguous("two");
        for (answers, counts, is_reported) in [
            (vec![], (2, 0, 0), false),
            (vec![(3, Choice::None)], (2, 0, 0), false),
            (vec![(1, two()), (2, objects(&["a", "b"]))], (2, 2, 2), false),
            (vec![(1, two()), (2, objects(&["a"]))], (2, 2, 1), true),
        ] {
            let sheet = sheet(&answers);
            let gold = gold(&key(), &sheet);
            assert_eq!((gold.asked, gold.answered, gold.kept), counts);
            let mut report = Report::default();
            report_misses(&round, &key(), &[sheet], &mut report);
            let found: Vec<_> = report.into_sorted().into_iter().map(|one| (one.code, one.message)).collect();
            let expected = ("L4D522", "right on 1 of 2: the votes count all the same".to_owned());
            assert_eq!(found, if is_reported { vec![expected] } else { Vec::new() });
        }
        assert_eq!(gold(&key(), &sheet(&[(2, objects(&["a"]))])).missed, [id(2)]);
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
}
