//! When each clause holds of each member of a group, asked of the evaluator once, so that combinations cost nothing.

use l4d_data::Role;
use l4d_data::tracks::TrackedInstance;
use l4d_query::eval::{clause_times, holds_over_clip};
use l4d_query::prove::Prover;
use l4d_query::times::Times;
use l4d_query::{Clause, World};

/// The objects of one noun: each other's look-alikes.
#[derive(Debug)]
pub(crate) struct Group<'a> {
    pub(crate) noun: &'a str,
    pub(crate) members: Vec<&'a TrackedInstance>,
}

impl<'a> Group<'a> {
    /// The groups of a scene that have look-alikes, by noun.
    pub(crate) fn all(world: &World<'a>) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for object in world.objects().filter(|object| object.role == Role::Object) {
            match groups.iter_mut().find(|group| group.noun == object.category) {
                Some(group) => group.members.push(object),
                None => groups.push(Self { noun: &object.category, members: vec![object] }),
            }
        }
        groups.retain(|group| (2..=MOST_MEMBERS).contains(&group.members.len()));
        groups.sort_by_key(|group| group.noun);
        groups
    }
}

/// Members of a group are bits of a word.
const MOST_MEMBERS: usize = 32;

/// Members of a group, one bit each.
pub(crate) type Members = u32;

/// When one clause holds.
#[derive(Debug, Clone)]
pub(crate) struct Facts {
    /// Of whom it holds over the whole clip, with thresholds as stated, tighter, looser.
    whole: [Members; 3],
    /// When it holds of each member, for the same three.
    times: [Vec<Times>; 3],
}

impl Facts {
    /// Asks the evaluator.
    pub(crate) fn of(prover: &Prover<'_>, group: &Group<'_>, clause: &Clause) -> Self {
        let worlds = prover.worlds();
        let whole = worlds.map(|world| {
            let holds = group.members.iter().map(|member| holds_over_clip(world, clause, member));
            holds.enumerate().fold(0, |bits, (place, holds)| bits | Members::from(holds) << place)
        });
        let times = worlds
            .map(|world| group.members.iter().map(|member| clause_times(world, clause, member)).collect());
        Self { whole, times }
    }

    /// Of whom it holds over the whole clip; none if that hangs on a threshold.
    pub(crate) fn settled(&self) -> Option<Members> {
        let [stated, tight, loose] = self.whole;
        (stated == tight && stated == loose).then_some(stated)
    }

    /// When it holds of each member.
    pub(crate) fn times(&self) -> &[Times] {
        &self.times[0]
    }

    /// Whether it and another ever hold of the same member, over the clip or at a moment, however thresholds are meant.
    pub(crate) fn ever_meets(&self, other: &Self) -> bool {
        (0..3).any(|slack| {
            let pairs = self.times[slack].iter().zip(&other.times[slack]);
            self.whole[slack] & other.whole[slack] != 0 || pairs.into_iter().any(|(a, b)| (*a & *b).any())
        })
    }

    /// Whether it never holds of any member, however thresholds are meant.
    pub(crate) fn is_never(&self) -> bool {
        !self.ever_meets(self)
    }
}
