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
    use super::*;

    fn relations(agree: &[(usize, usize)], contradict: &[(usize, usize)]) -> Relations {
        let all = agree.iter().map(|&pair| (pair, 1)).chain(contradict.iter().map(|&pair| (pair, -1)));
        Relations(all.collect())
    }

    fn within(views: &[usize]) -> Vec<(usize, usize)> {
        let pairs = views.iter().flat_map(|&a| views.iter().map(move |&b| (a, b)));
        pairs.filter(|(a, b)| a < b).collect()
    }

    fn between(ours: &[usize], theirs: &[usize]) -> Vec<(usize, usize)> {
        ours.iter().flat_map(|&a| theirs.iter().map(move |&b| (a.min(b), a.max(b)))).collect()
    }

    #[test]
    fn a_view_that_agrees_with_two_groups_does_not_make_them_one() {
        // 0, 1, 2 against 4, 5; view 3 agrees with all of them.
        let agree = [within(&[0, 1, 2, 3]), within(&[4, 5]), between(&[3], &[4, 5])].concat();
        let relations = relations(&agree, &between(&[0, 1, 2], &[4, 5]));
        let groups = relations.groups(&[0, 1, 2, 3, 4, 5]);
        assert_eq!(groups, [vec![0, 1, 2, 3], vec![4, 5]]);
        // 6 contradictions, 2 agreements between them.
        assert!(relations.contradict(&groups[0], &groups[1]));
        assert_eq!(relations.verdicts(&groups), [GroupVerdict::Remains, GroupVerdict::Outvoted]);
    }

    #[test]
    fn groups_of_one_size_tie_and_unrelated_ones_remain() {
        let agree = [within(&[0, 1]), within(&[2, 3]), within(&[4, 5])].concat();
        let relations = relations(&agree, &between(&[0, 1], &[2, 3]));
        let groups = relations.groups(&[0, 1, 2, 3, 4, 5]);
        assert_eq!(groups, [vec![0, 1], vec![2, 3], vec![4, 5]]);
        assert_eq!(
            relations.verdicts(&groups),
            [GroupVerdict::Tied, GroupVerdict::Tied, GroupVerdict::Remains]
        );
    }

    #[test]
    fn an_outvoted_group_outvotes_and_ties_with_none() {
        // 0, 1, 2 outvote 3, 4, which would tie with 5, 6.
        let agree = [within(&[0, 1, 2]), within(&[3, 4]), within(&[5, 6])].concat();
        let against = [between(&[0, 1, 2], &[3, 4]), between(&[3, 4], &[5, 6])].concat();
        let relations = relations(&agree, &against);
        let groups = relations.groups(&[0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(
            relations.verdicts(&groups),
            [GroupVerdict::Remains, GroupVerdict::Outvoted, GroupVerdict::Remains]
        );
    }

    #[test]
    fn single_views_are_left_to_the_votes() {
        let relations = relations(&[], &between(&[0], &[1, 2]));
        let groups = relations.groups(&[0, 1, 2]);
        assert_eq!(groups.len(), 3);
        assert_eq!(relations.verdicts(&groups), [GroupVerdict::Remains; 3]);
    }
}
