//! Groups of views that agree among themselves and contradict each other.
//!
//! Greedy correlation clustering: the two groups between which agreement outweighs contradiction by most become one,
//! until none are left. A view that marks two things at once agrees with the groups of both; it joins one of them, and
//! they stay two.

use std::collections::BTreeMap;

use super::record::{PairRecord, PairVerdict};

/// Who agrees with whom.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Relations(BTreeMap<(usize, usize), i64>);

/// How a group fares against the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GroupVerdict {
    /// No group that remains contradicts it.
    Remains,
    /// A larger one does.
    Outvoted,
    /// One of the same size does.
    Tied,
}

impl Relations {
    /// From what each says about the other: a vote agrees, a vote that was withheld contradicts if the judge could
    /// see enough to know.
    pub(super) fn of(pairs: &[PairRecord]) -> Self {
        let mut sums = BTreeMap::new();
        for pair in pairs {
            let says = match pair.verdict {
                PairVerdict::Vote => 1,
                PairVerdict::NoVote if pair.seen >= pair.needed => -1,
                PairVerdict::NoVote | PairVerdict::CannotSee => 0,
            };
            *sums.entry((pair.of.min(pair.judge), pair.of.max(pair.judge))).or_insert(0_i64) += says;
        }
        Self(sums.into_iter().map(|(pair, sum)| (pair, sum.signum())).collect())
    }

    /// Agreements less contradictions between the views of two groups.
    fn balance(&self, ours: &[usize], theirs: &[usize]) -> i64 {
        let between = ours.iter().flat_map(|&a| theirs.iter().map(move |&b| (a.min(b), a.max(b))));
        between.filter_map(|pair| self.0.get(&pair)).sum()
    }

    /// Whether two groups contradict each other more than they agree.
    pub(super) fn contradict(&self, ours: &[usize], theirs: &[usize]) -> bool {
        self.balance(ours, theirs) < 0
    }

    /// The views in groups: the largest first, then by their first view; each ascending.
    pub(super) fn groups(&self, views: &[usize]) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = views.iter().map(|&view| vec![view]).collect();
        while let Some((first, second)) = self.closest(&groups) {
            let mut absorbed = groups.remove(second);
            if let Some(group) = groups.get_mut(first) {
                group.append(&mut absorbed);
                group.sort_unstable();
            }
        }
        groups.sort_by_key(|group| (std::cmp::Reverse(group.len()), group.first().copied()));
        groups
    }

    /// The two groups with the largest balance above 0; the first of them, where several have it.
    fn closest(&self, groups: &[Vec<usize>]) -> Option<(usize, usize)> {
        let mut best = None;
        for (second, theirs) in groups.iter().enumerate() {
            for (first, ours) in groups.iter().enumerate().take(second) {
                let balance = self.balance(ours, theirs);
                if balance > best.map_or(0, |(balance, _)| balance) {
                    best = Some((balance, (first, second)));
                }
            }
        }
        best.map(|(_, pair)| pair)
    }

    /// The verdict of each group; `groups` has the largest first. Views without company neither outvote each other nor
    /// tie: they are for the votes to settle.
    pub(super) fn verdicts(&self, groups: &[Vec<usize>]) -> Vec<GroupVerdict> {
        let mut verdicts: Vec<GroupVerdict> = Vec::with_capacity(groups.len());
        for peers in groups.chunk_by(|a, b| a.len() == b.len()) {
            // There is a verdict for each larger group by now, and for no other.
            let larger =
                std::iter::zip(groups, &verdicts).filter(|(_, verdict)| **verdict == GroupVerdict::Remains);
            let winners: Vec<&Vec<usize>> = larger.map(|(group, _)| group).collect();
            let is_outvoted = |group: &[usize]| winners.iter().any(|winner| self.contradict(group, winner));
            let is_tied = |group: &Vec<usize>| {
                let rivals = peers.iter().filter(|peer| *peer != group && !is_outvoted(peer));
                group.len() > 1 && rivals.into_iter().any(|rival| self.contradict(group, rival))
            };
            let verdict_of = |group: &Vec<usize>| match (is_outvoted(group), is_tied(group)) {
                (true, _) => GroupVerdict::Outvoted,
                (false, true) => GroupVerdict::Tied,
                (false, false) => GroupVerdict::Remains,
            };
            verdicts.extend(peers.iter().map(verdict_of));
        }
        verdicts
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn between(ours: &[usize], theirs: &[usize]) -> Vec<(usize, usize)> {
        let pairs = ours.iter().flat_map(|&a| theirs.iter().map(move |&b| (a.min(b), a.max(b))));
        pairs.filter(|(a, b)| a != b).collect()
    }

    /// Groups and their verdicts, of views of which these agree with each other, and these sides contradict each other.
    fn judged(agree: &[&[usize]], contradict: &[[&[usize]; 2]]) -> Vec<(Vec<usize>, GroupVerdict)> {
        let agree = agree.iter().flat_map(|views| between(views, views)).map(|pair| (pair, 1));
        let contradict = contradict.iter().flat_map(|[a, b]| between(a, b)).map(|pair| (pair, -1));
        let relations = Relations(agree.chain(contradict).collect());
        let views: BTreeSet<usize> = relations.0.keys().flat_map(|&(a, b)| [a, b]).collect();
        let groups = relations.groups(&views.into_iter().collect::<Vec<_>>());
        let verdicts = relations.verdicts(&groups);
        groups.into_iter().zip(verdicts).collect()
    }

    #[test]
    fn larger_groups_outvote_and_equal_ones_tie() {
        use GroupVerdict::{Outvoted, Remains, Tied};
        // View 3 agrees with 0, 1, 2 and with 4, 5, which contradict them: that does not make them one.
        let both = judged(&[&[0, 1, 2, 3], &[4, 5], &[3, 4], &[3, 5]], &[[&[0, 1, 2], &[4, 5]]]);
        assert_eq!(both, [(vec![0, 1, 2, 3], Remains), (vec![4, 5], Outvoted)]);
        // Unrelated groups remain.
        let tied = judged(&[&[0, 1], &[2, 3], &[4, 5]], &[[&[0, 1], &[2, 3]]]);
        assert_eq!(tied, [(vec![0, 1], Tied), (vec![2, 3], Tied), (vec![4, 5], Remains)]);
        // An outvoted group outvotes and ties with none.
        let chain = judged(&[&[0, 1, 2], &[3, 4], &[5, 6]], &[[&[0, 1, 2], &[3, 4]], [&[3, 4], &[5, 6]]]);
        assert_eq!(chain, [(vec![0, 1, 2], Remains), (vec![3, 4], Outvoted), (vec![5, 6], Remains)]);
        // Single views are left to the votes.
        let single = judged(&[], &[[&[0], &[1, 2]]]);
        assert_eq!(single, [0, 1, 2].map(|view| (vec![view], Remains)));
    }
}
