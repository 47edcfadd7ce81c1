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
