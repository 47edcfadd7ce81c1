//! What stands after a sequence of events.
//!
//! Each item has one stack of events for each digest under which it was asked. Choosing, skipping and commenting
//! push; an undo pops. So an undo takes back the latest event on *its* item, under *its* digest, that was not
//! taken back yet; what was pushed before shows again, and there is no redo. The newest choice or skip on the
//! stack is what the annotator says; comments below or above it stand beside it.

use std::collections::BTreeMap;

use crate::event::{Answer, Event};
use crate::item::ItemId;

/// A pushed event with its place in the log.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Pushed {
    seq: u64,
    what: What,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum What {
    Choice(Answer),
    Skip,
    Comment(String),
}

/// An undo that finds nothing to take back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NothingToUndo;

/// All stacks of a log.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Ledger {
    stacks: BTreeMap<ItemId, BTreeMap<String, Vec<Pushed>>>,
}

impl Ledger {
    /// Takes over one event.
    pub(crate) fn apply(
        &mut self,
        seq: u64,
        item: &ItemId,
        digest: &str,
        event: Event,
    ) -> Result<(), NothingToUndo> {
        let what = match event {
            Event::Undo => {
                let stack = self.stacks.get_mut(item).and_then(|stacks| stacks.get_mut(digest));
                return stack.and_then(Vec::pop).map(|_| ()).ok_or(NothingToUndo);
            }
            Event::Choose(answer) => What::Choice(answer),
            Event::Skip => What::Skip,
            Event::Comment(text) => What::Comment(text),
        };
        let stacks = self.stacks.entry(item.clone()).or_default();
        stacks.entry(digest.to_owned()).or_default().push(Pushed { seq, what });
        Ok(())
    }

    /// The items that have ever been touched.
    pub(crate) fn items(&self) -> impl Iterator<Item = &ItemId> {
        self.stacks.keys()
    }

    /// The standing answer.
    pub(crate) fn answer(&self, item: &ItemId, digest: &str) -> Option<&Answer> {
        match decision(self.stack(item, digest))? {
            Pushed { what: What::Choice(answer), .. } => Some(answer),
            _ => None,
        }
    }

    /// Whether the item stands as skipped.
    pub(crate) fn is_skipped(&self, item: &ItemId, digest: &str) -> bool {
        decision(self.stack(item, digest)).is_some_and(|pushed| pushed.what == What::Skip)
    }

    /// Standing comments, oldest first.
    pub(crate) fn comments<'a>(&'a self, item: &ItemId, digest: &str) -> Vec<&'a str> {
        let comment = |pushed: &'a Pushed| match &pushed.what {
            What::Comment(text) => Some(text.as_str()),
            What::Choice(_) | What::Skip => None,
        };
        self.stack(item, digest).iter().filter_map(comment).collect()
    }

    /// The latest standing answer under any other digest.
    pub(crate) fn stale_answer(&self, item: &ItemId, digest: &str) -> Option<&Answer> {
        let others = self.stacks.get(item)?.iter().filter(|(other, _)| other.as_str() != digest);
        let newest = others.filter_map(|(_, stack)| decision(stack)).max_by_key(|pushed| pushed.seq)?;
        match &newest.what {
            What::Choice(answer) => Some(answer),
            What::Skip | What::Comment(_) => None,
        }
    }

    /// When the event that an undo of this item would take back was recorded.
    pub(crate) fn undoable(&self, item: &ItemId, digest: &str) -> Option<u64> {
        self.stack(item, digest).last().map(|pushed| pushed.seq)
    }

    fn stack(&self, item: &ItemId, digest: &str) -> &[Pushed] {
        let stack = self.stacks.get(item).and_then(|stacks| stacks.get(digest));
        stack.map_or(&[], Vec::as_slice)
    }
}

/// The newest choice or skip.
fn decision(stack: &[Pushed]) -> Option<&Pushed> {
    stack.iter().rev().find(|pushed| !matches!(pushed.what, What::Comment(_)))
}

#[cfg(test)]
mod tests {
    use l4d_data::Interval;

    use super::*;
    use crate::event::Choice;

    fn id(text: &str) -> ItemId {
        text.parse().unwrap()
    }

    fn choose(first: u32) -> Event {
        Event::Choose(Answer { choice: Choice::None, frames: Interval::new(first, 96).unwrap() })
    }

    fn first_frame(ledger: &Ledger, item: &str, digest: &str) -> Option<u32> {
        ledger.answer(&id(item), digest).map(|answer| answer.frames.first())
    }

    fn ledger(events: &[(&str, &str, Event)]) -> Ledger {
        let mut ledger = Ledger::default();
        for (seq, (item, digest, event)) in events.iter().enumerate() {
            ledger.apply(seq as u64, &id(item), digest, event.clone()).unwrap();
        }
        ledger
    }

    #[test]
    fn an_undo_shows_what_was_there_before() {
        let mut ledger =
            ledger(&[("q0001", "d", choose(1)), ("q0001", "d", choose(2)), ("q0001", "d", Event::Skip)]);
        let undo = |ledger: &mut Ledger| ledger.apply(9, &id("q0001"), "d", Event::Undo);
        assert!(ledger.is_skipped(&id("q0001"), "d"));
        assert_eq!(first_frame(&ledger, "q0001", "d"), None);
        for left in [Some(2), Some(1), None] {
            undo(&mut ledger).unwrap();
            assert_eq!(first_frame(&ledger, "q0001", "d"), left);
            assert!(!ledger.is_skipped(&id("q0001"), "d"));
        }
        assert_eq!(undo(&mut ledger), Err(NothingToUndo));
    }

    #[test]
    fn an_undo_reaches_neither_other_items_nor_other_wordings() {
        let mut ledger =
            ledger(&[("q0001", "d", choose(1)), ("q0002", "d", choose(2)), ("q0002", "e", choose(3))]);
        ledger.apply(3, &id("q0002"), "e", Event::Undo).unwrap();
        assert_eq!(first_frame(&ledger, "q0001", "d"), Some(1));
        assert_eq!(first_frame(&ledger, "q0002", "d"), Some(2));
        assert_eq!(first_frame(&ledger, "q0002", "e"), None);
        assert_eq!(ledger.apply(4, &id("q0002"), "e", Event::Undo), Err(NothingToUndo));
    }

    #[test]
    fn comments_stand_beside_the_answer_and_are_undone_like_it() {
        let mut ledger = ledger(&[
            ("q0001", "d", Event::Comment("dark".to_owned())),
            ("q0001", "d", choose(1)),
            ("q0001", "d", Event::Comment("small".to_owned())),
        ]);
        assert_eq!(ledger.comments(&id("q0001"), "d"), ["dark", "small"]);
        assert_eq!(first_frame(&ledger, "q0001", "d"), Some(1));
        ledger.apply(3, &id("q0001"), "d", Event::Undo).unwrap();
        assert_eq!(ledger.comments(&id("q0001"), "d"), ["dark"]);
        assert_eq!(first_frame(&ledger, "q0001", "d"), Some(1));
    }

    #[test]
    fn the_newest_answer_to_another_wording_is_the_stale_one() {
        let ledger =
            ledger(&[("q0001", "z", choose(1)), ("q0001", "a", choose(2)), ("q0001", "b", choose(3))]);
        assert_eq!(ledger.stale_answer(&id("q0001"), "b").map(|answer| answer.frames.first()), Some(2));
        assert_eq!(ledger.stale_answer(&id("q0001"), "new").map(|answer| answer.frames.first()), Some(3));
        assert_eq!(ledger.stale_answer(&id("q0002"), "new"), None);
    }
}
