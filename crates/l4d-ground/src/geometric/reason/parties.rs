//! The others that a clause speaks of.

use super::super::settings::MOST_MEMBERS;
use l4d_query::{Clause, Party, Predicate};

use super::{Reasoner, noun_of};

/// A track that a party may mean, and how surely: the surest 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Member {
    pub(super) track: usize,
    pub(super) weight: f64,
}

impl Reasoner<'_> {
    /// The tracks that a party may mean, the surest first, no two of the same thing.
    pub(super) fn members(&self, party: &Party) -> Vec<Member> {
        let scores: Vec<(usize, f64)> = match party {
            Party::Such(predicate) if predicate.0.len() > 1 => self.described(predicate),
            _ => self
                .candidates(noun_of(party))
                .iter()
                .map(|candidate| (candidate.track, candidate.prior))
                .collect(),
        };
        let best = scores.first().map_or(0.0, |(_, score)| *score);
        let mut members: Vec<Member> = Vec::new();
        for (track, score) in scores {
            if members.len() == MOST_MEMBERS || score < 0.1 * best {
                break;
            }
            if members.iter().all(|member| !self.is_same(member.track, track)) {
                members.push(Member { track, weight: score / best });
            }
        }
        members
    }

    fn described(&self, predicate: &Predicate) -> Vec<(usize, f64)> {
        // A description within a description is judged without the others that it mentions in turn.
        let plain =
            |clause: &&Clause| !clause.own_parties().iter().any(|party| matches!(party, Party::Such(_)));
        let predicate = Predicate(predicate.0.iter().filter(plain).cloned().collect());
        self.ranked(&predicate, false).iter().map(|scored| (scored.candidate.track, scored.score)).collect()
    }
}
