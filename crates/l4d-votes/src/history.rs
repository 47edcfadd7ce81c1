//! What is left of a sequence of events.
//!
//! Each item has one stack of events for each digest under which it was asked. Choosing, skipping and commenting
//! push; an undo pops. So an undo takes back the latest event on *its* item, under *its* digest, that was not taken
//! back yet; what was pushed before shows again, and there is no redo. The newest choice or skip on the stack is what
//! the annotator says; comments are kept beside it.

use std::collections::BTreeMap;

use crate::item::{Item, ItemId};
use crate::vote::{Answer, Event, Response};

/// An event with its place in the log.
type Numbered = (u64, Event);

/// The events of a log that were not taken back, by item and by the digest under which it was asked.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct History {
    stacks: BTreeMap<ItemId, BTreeMap<String, Vec<Numbered>>>,
}

impl History {
    /// Takes over one event; false for an undo that finds nothing to take back.
    pub(crate) fn apply(&mut self, seq: u64, item: &ItemId, digest: &str, event: Event) -> bool {
        let stack = self.stacks.entry(item.clone()).or_default().entry(digest.to_owned()).or_default();
        if event == Event::Undo {
            return stack.pop().is_some();
        }
        stack.push((seq, event));
        true
    }

    /// The items that have ever been touched.
    pub(crate) fn items(&self) -> impl Iterator<Item = &ItemId> {
        self.stacks.keys()
    }

    /// What the annotator says about an item as it is asked.
    pub(crate) fn response(&self, item: &Item) -> Response {
        let stack = self.stack(item);
        let comment = |(_, event): &Numbered| match event {
            Event::Comment { text } => Some(text.clone()),
            _ => None,
        };
        let comments = stack.iter().filter_map(comment).collect();
        match decision(stack) {
            Some((_, Event::Choose(answer))) => {
                Response { answer: Some(answer.clone()), comments, ..Response::default() }
            }
            Some(_) => Response { skipped: true, comments, ..Response::default() },
            None => Response { stale: self.stale(item), comments, ..Response::default() },
        }
    }

    /// When the event that an undo of this item would take back was recorded.
    pub(crate) fn undoable(&self, item: &Item) -> Option<u64> {
        self.stack(item).last().map(|(seq, _)| *seq)
    }

    /// The latest answer under any other digest.
    fn stale(&self, item: &Item) -> Option<Answer> {
        let others = self.stacks.get(&item.id)?.iter().filter(|(digest, _)| **digest != item.digest);
        match others.filter_map(|(_, stack)| decision(stack)).max_by_key(|(seq, _)| *seq)? {
            (_, Event::Choose(answer)) => Some(answer.clone()),
            _ => None,
        }
    }

    fn stack(&self, item: &Item) -> &[Numbered] {
        self.stacks.get(&item.id).and_then(|stacks| stacks.get(&item.digest)).map_or(&[], Vec::as_slice)
    }
}

/// The newest choice or skip.
fn decision(stack: &[Numbered]) -> Option<&Numbered> {
    stack.iter().rev().find(|(_, event)| !matches!(event, Event::Comment { .. }))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::fixture::{items, response};

    /// What was recorded and not taken back, oldest first, by going through all of it.
    fn left(events: &[(String, Event)], digest: &str) -> Vec<(usize, Event)> {
        let mut left: Vec<(usize, Event)> = Vec::new();
        for (at, (_, event)) in events.iter().enumerate().filter(|(_, (of, _))| of == digest) {
            match event {
                Event::Undo => drop(left.pop()),
                event => left.push((at, event.clone())),
            }
        }
        left
    }

    fn last_decision(events: &[(String, Event)], digest: &str) -> Option<(usize, Event)> {
        let mut left = left(events, digest);
        left.retain(|(_, event)| matches!(event, Event::Choose(_) | Event::Skip));
        left.pop()
    }

    fn answer(decision: Option<(usize, Event)>) -> Option<Answer> {
        decision.and_then(|(_, event)| if let Event::Choose(answer) = event { Some(answer) } else { None })
    }

    fn event() -> impl Strategy<Value = Event> {
        prop_oneof![
            4 => prop::sample::select(vec!['+', 'x', '0', '?'])
                .prop_map(|letter| Event::Choose(response(letter).answer.unwrap())),
            1 => Just(Event::Skip),
            1 => "[a-z]{3}".prop_map(|text| Event::Comment { text }),
            3 => Just(Event::Undo),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Three wordings of one item, of which the first is asked now.
        #[test]
        fn a_history_says_what_a_slow_one_says(
            events in prop::collection::vec((prop::sample::select(vec!["a", "b", "c"]), event()), 0..40),
        ) {
            let item = Item { digest: "a".to_owned(), ..items("room", &["The cat"]).remove(0) };
            let events: Vec<(String, Event)> =
                events.into_iter().map(|(digest, event)| (digest.to_owned(), event)).collect();
            let mut history = History::default();
            for (seq, (digest, event)) in events.iter().enumerate() {
                let has_some = !left(&events[..seq], digest).is_empty();
                let is_taken = history.apply(seq as u64, &item.id, digest, event.clone());
                prop_assert_eq!(is_taken, *event != Event::Undo || has_some);
            }
            let now = last_decision(&events, "a");
            let others = ["b", "c"].into_iter().filter_map(|digest| last_decision(&events, digest));
            let comment = |(_, event)| if let Event::Comment { text } = event { Some(text) } else { None };
            prop_assert_eq!(history.undoable(&item), left(&events, "a").last().map(|(at, _)| *at as u64));
            prop_assert_eq!(history.response(&item), Response {
                skipped: matches!(now, Some((_, Event::Skip))),
                stale: if now.is_none() { answer(others.max_by_key(|(at, _)| *at)) } else { None },
                answer: answer(now),
                comments: left(&events, "a").into_iter().filter_map(comment).collect(),
            });
        }
    }
}
