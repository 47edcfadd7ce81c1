//! Global reliability (paper, section 4): from votes to the views that go on.

use super::candidate::{Part, Proposal};
use super::groups::{GroupVerdict, Relations};
use super::record::{Consensus, Decision, PairRecord, PairVerdict, ViewGroup, ViewRecord, ViewVerdict};
use super::settings::{ConsensusSettings, GroupRule, Judges, NoneReliable, Undecided};

/// What follows from the pairs.
pub(super) fn decide(
    proposals: &[Proposal<'_>],
    parts: &[Part],
    pairs: Vec<PairRecord>,
    settings: &ConsensusSettings,
) -> Consensus {
    let found: Vec<usize> = (0..parts.len()).filter(|&view| parts[view] == Part::Found).collect();
    let answers = parts.iter().filter(|part| matches!(part, Part::Found | Part::Absent)).count();
    let relations = Relations::of(&pairs);
    let groups = relations.groups(&found);
    let verdicts = relations.verdicts(&groups);
    let verdict_of = |view: usize| {
        let own = std::iter::zip(&groups, &verdicts).find(|(group, _)| group.contains(&view));
        own.map_or(GroupVerdict::Remains, |(_, verdict)| *verdict)
    };

    let mut views: Vec<ViewRecord> = std::iter::zip(proposals, parts)
        .enumerate()
        .map(|(view, (proposal, part))| view_record(view, proposal, *part, &pairs, settings))
        .collect();
    let is_vote = settings.is_on && answers > 1;
    for (view, record) in views.iter_mut().enumerate() {
        if parts[view] == Part::Found {
            record.standing =
                if is_vote { standing(record, verdict_of(view), settings) } else { ViewVerdict::Reliable };
        }
    }

    let mut decision = if answers == 0 {
        Decision::NoAnswer
    } else if found.is_empty() {
        Decision::Absent
    } else if !settings.is_on {
        Decision::Off
    } else if answers == 1 {
        Decision::Bypassed
    } else if views.iter().any(|view| view.standing == ViewVerdict::Reliable) {
        Decision::Reliable
    } else if views.iter().any(|view| view.standing == ViewVerdict::Tied) {
        Decision::Tied
    } else {
        Decision::NoneReliable
    };
    if decision == Decision::NoneReliable
        && settings.none_reliable == NoneReliable::BestView
        && let Some(record) = best(&mut views, &pairs)
    {
        record.standing = ViewVerdict::Best;
        decision = Decision::BestView;
    }

    if settings.undecided == Undecided::AllCandidates {
        decision = match decision {
            Decision::Tied => Decision::TiedAll,
            Decision::NoneReliable => Decision::NoneReliableAll,
            decided => decided,
        };
    }

    let evidence = match decision {
        Decision::TiedAll | Decision::NoneReliableAll => found,
        _ => {
            let goes_on =
                |record: &ViewRecord| matches!(record.standing, ViewVerdict::Reliable | ViewVerdict::Best);
            (0..views.len()).filter(|&view| goes_on(&views[view])).collect()
        }
    };
    Consensus {
        preset: settings.preset(),
        settings: *settings,
        decision,
        evidence,
        groups: view_groups(&relations, groups),
        views,
        pairs,
    }
}

fn view_record(
    view: usize,
    proposal: &Proposal<'_>,
    part: Part,
    pairs: &[PairRecord],
    settings: &ConsensusSettings,
) -> ViewRecord {
    let standing = match part {
        // Not the last word on what was found: that takes the votes.
        Part::Found => ViewVerdict::NoJudge,
        Part::Absent => ViewVerdict::Absent,
        Part::NoAnswer => ViewVerdict::NoAnswer,
    };
    let frames = if part == Part::NoAnswer { Vec::new() } else { proposal.marked() };
    let about = || pairs.iter().filter(|pair| pair.of == view);
    let is_judge = |pair: &&PairRecord| match settings.judges {
        Judges::AllOthers => true,
        Judges::CouldSee => pair.verdict != PairVerdict::CannotSee,
    };
    ViewRecord {
        view: proposal.clip.camera.name.clone(),
        outcome: proposal.grounding.outcome.word().to_owned(),
        marked_frames: frames.iter().filter(|&&(_, pixels)| pixels > 0).count() as u32,
        votes: about().filter(|pair| pair.verdict == PairVerdict::Vote).count() as u32,
        judges: about().filter(is_judge).count() as u32,
        standing,
        frames,
    }
}

fn standing(record: &ViewRecord, verdict: GroupVerdict, settings: &ConsensusSettings) -> ViewVerdict {
    let Some(score) = record.score() else { return ViewVerdict::NoJudge };
    match (settings.group_rule, verdict) {
        (GroupRule::LargestWins, GroupVerdict::Outvoted) => return ViewVerdict::Outvoted,
        (GroupRule::LargestWins, GroupVerdict::Tied) => return ViewVerdict::Tied,
        (GroupRule::LargestWins, GroupVerdict::Remains) | (GroupRule::Shown, _) => {}
    }
    if record.votes < settings.min_votes {
        ViewVerdict::FewVotes
    } else if score > settings.tau {
        ViewVerdict::Reliable
    } else {
        ViewVerdict::LowScore
    }
}

/// The view with the largest share of votes, then the most votes, then the most frames that agree, then the first; of
/// those that have a vote and that no group has put out.
fn best<'a>(views: &'a mut [ViewRecord], pairs: &[PairRecord]) -> Option<&'a mut ViewRecord> {
    let agreeing = |view: usize| -> u64 {
        pairs.iter().filter(|pair| pair.of == view).map(|pair| u64::from(pair.agreeing)).sum()
    };
    let may = |record: &ViewRecord| {
        record.votes > 0 && matches!(record.standing, ViewVerdict::FewVotes | ViewVerdict::LowScore)
    };
    let candidates = views.iter_mut().enumerate().filter(|(_, record)| may(record));
    let rank = |view: usize, record: &ViewRecord| {
        let score = record.score().unwrap_or(0.0);
        (score, record.votes, agreeing(view))
    };
    candidates
        .map(|(view, record)| (rank(view, record), record))
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, record)| record)
}

/// Groups of two and more, and which of them contradict each other.
fn view_groups(relations: &Relations, groups: Vec<Vec<usize>>) -> Vec<ViewGroup> {
    let groups: Vec<Vec<usize>> = groups.into_iter().filter(|group| group.len() > 1).collect();
    let against = |group: &[usize]| {
        let others = groups.iter().enumerate();
        others.filter(|(_, other)| relations.contradict(group, other)).map(|(place, _)| place).collect()
    };
    groups.iter().map(|group| ViewGroup { views: group.clone(), against: against(group) }).collect()
}
