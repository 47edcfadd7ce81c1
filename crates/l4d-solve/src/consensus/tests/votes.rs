//! Frames, votes and reliability by hand-computed fractions; every threshold from both sides.

use half::f16;
use l4d_ground::{Grounding, Outcome};

use super::world::Wall;
use super::{decide, has_conflict};
use crate::consensus::record::{FrameVerdict, PairVerdict, Reason};
use crate::consensus::settings::Undecided;
use crate::consensus::{Consensus, ConsensusSettings, Decision, Preset, ViewVerdict};

fn of_wall(wall: &Wall, settings: ConsensusSettings) -> Consensus {
    decide(&wall.clips, &wall.groundings, &settings)
}

fn reason(consensus: &Consensus, of: usize, judge: usize, frame: usize) -> (FrameVerdict, Reason) {
    let record = consensus.pair(of, judge).expect("they are a pair").frames[frame];
    (record.verdict, record.reason)
}

#[test]
fn a_frame_agrees_above_delta_and_not_at_it() {
    // 5 and 8 columns, 3 of them shared: 3 / 10. With 4 shared 4 / 9.
    let robust = ConsensusSettings::robust();
    let at = of_wall(&Wall::still(3, &[0..5, 2..10]), robust);
    assert_eq!(at.pair(0, 1).unwrap().frames[0].counts.iou(), Some(0.3));
    assert_eq!(reason(&at, 0, 1, 0), (FrameVerdict::Disagrees, Reason::Apart));
    let above = of_wall(&Wall::still(3, &[0..5, 1..9]), robust);
    assert_eq!(reason(&above, 0, 1, 0), (FrameVerdict::Agrees, Reason::Overlap));
}

#[test]
fn a_view_votes_above_epsilon_and_not_at_it() {
    let robust = ConsensusSettings::robust();
    let with_agreeing = |agreeing: usize, frames: usize| {
        let second = (0..frames).map(|frame| vec![if frame < agreeing { 0..10 } else { 30..40 }]).collect();
        of_wall(&Wall::new(&[vec![vec![0..10]; frames], second]), robust)
    };
    let half = with_agreeing(2, 4);
    let pair = half.pair(0, 1).unwrap();
    assert_eq!((pair.agreeing, pair.counted, pair.verdict), (2, 4, PairVerdict::NoVote));
    let more = with_agreeing(3, 5);
    let pair = more.pair(0, 1).unwrap();
    assert_eq!((pair.agreeing, pair.counted, pair.verdict), (3, 5, PairVerdict::Vote));
}

/// `agreeing` views that mark one place, and others each at its own, 11 in all.
fn eleven(agreeing: usize) -> Wall {
    let columns: Vec<_> = (0..11_u32)
        .map(|view| if (view as usize) < agreeing { 0..4 } else { 5 * view - 1..5 * view + 3 })
        .collect();
    Wall::still(3, &columns)
}

#[test]
fn a_view_is_reliable_above_tau_and_not_at_it() {
    for settings in [ConsensusSettings::paper(), ConsensusSettings::robust()] {
        // Four agree: three votes of ten, 0.3. Five agree: four of ten.
        let at = of_wall(&eleven(4), settings);
        assert_eq!((at.views[0].votes, at.views[0].judges), (3, 10));
        assert_eq!(at.views[0].score(), Some(0.3));
        let above = of_wall(&eleven(5), settings);
        assert_eq!(above.decision, Decision::Reliable);
        assert_eq!(above.evidence, [0, 1, 2, 3, 4]);
        match settings.preset().unwrap() {
            Preset::Paper => {
                assert_eq!(
                    (at.decision, at.views[0].standing),
                    (Decision::NoneReliable, ViewVerdict::LowScore)
                );
                assert!(at.evidence.is_empty());
                assert_eq!(above.views[7].standing, ViewVerdict::FewVotes);
            }
            _ => {
                // All four are equally good: the first goes on.
                assert_eq!((at.decision, at.views[0].standing), (Decision::BestView, ViewVerdict::Best));
                assert_eq!(at.evidence, [0]);
                assert_eq!(above.views[7].standing, ViewVerdict::Outvoted);
            }
        }
    }
}

#[test]
fn the_paper_s_visibility_is_what_is_shared_with_the_other_proposal() {
    let paper = ConsensusSettings::paper();
    // Six of ten columns shared, then seven of ten; the other proposal is as small as the share.
    let at = of_wall(&Wall::still(2, &[0..10, 0..6]), paper);
    assert_eq!(at.pair(0, 1).unwrap().frames[0].counts.shared_share(), Some(0.6));
    assert_eq!(reason(&at, 0, 1, 0), (FrameVerdict::Disagrees, Reason::Unseen));
    let above = of_wall(&Wall::still(2, &[0..10, 0..7]), paper);
    assert_eq!(reason(&above, 0, 1, 0), (FrameVerdict::Agrees, Reason::Overlap));
    // The other way round the whole small mask lies in the large one, and 6 / 10 is above delta.
    assert_eq!(reason(&at, 1, 0, 0), (FrameVerdict::Agrees, Reason::Overlap));
}

#[test]
fn the_robust_visibility_is_what_is_not_hidden_whatever_is_marked() {
    // The second view has something at half a metre in front of the first columns.
    let hidden = |columns: usize| {
        let mut wall = Wall::still(3, &[0..10, 40..50]);
        for frame in &mut wall.clips[1].frames {
            frame.depth.depth_m[..columns].fill(0.5);
            frame.depth.near_m[..columns].fill(f16::from_f32(0.5));
            frame.depth.far_m[..columns].fill(f16::from_f32(0.5));
        }
        of_wall(&wall, ConsensusSettings::robust())
    };
    let at = hidden(4);
    let counts = at.pair(0, 1).unwrap().frames[0].counts;
    assert_eq!((counts.projected, counts.in_frame, counts.passing), (10, 10, 6));
    assert_eq!(reason(&at, 0, 1, 0), (FrameVerdict::Disagrees, Reason::Apart));
    assert_eq!(at.pair(0, 1).unwrap().verdict, PairVerdict::NoVote);
    let below = hidden(5);
    assert_eq!(reason(&below, 0, 1, 0), (FrameVerdict::Neutral, Reason::Unseen));
    assert_eq!(below.pair(0, 1).unwrap().verdict, PairVerdict::CannotSee);
    assert_eq!(below.views[0].standing, ViewVerdict::NoJudge);
}

#[test]
fn frames_without_marks_count_as_each_preset_says() {
    // The first view marks in frames 0 to 2, the second in 0 to 5; neither in 6 and 7.
    let until = |last: usize| (0..8).map(|frame| Vec::from_iter((frame < last).then_some(0..10))).collect();
    let wall = Wall::new(&[until(3), until(6)]);
    let robust = of_wall(&wall, ConsensusSettings::robust());
    assert_eq!(reason(&robust, 0, 1, 4), (FrameVerdict::Disagrees, Reason::Unclaimed));
    assert_eq!(reason(&robust, 1, 0, 4), (FrameVerdict::Disagrees, Reason::Denied));
    assert_eq!(reason(&robust, 0, 1, 7), (FrameVerdict::Neutral, Reason::BothEmpty));
    // 3 of 6 either way.
    assert_eq!(robust.pair(0, 1).unwrap().verdict, PairVerdict::NoVote);
    assert_eq!(robust.pair(1, 0).unwrap().verdict, PairVerdict::NoVote);
    let paper = of_wall(&wall, ConsensusSettings::paper());
    assert_eq!(reason(&paper, 0, 1, 4), (FrameVerdict::Neutral, Reason::Unmarked));
    assert_eq!(reason(&paper, 1, 0, 4), (FrameVerdict::Disagrees, Reason::Unseen));
    // 3 of the 3 frames that the first marks; 3 of the 6 that the second does.
    assert_eq!(paper.pair(0, 1).unwrap().verdict, PairVerdict::Vote);
    assert_eq!(paper.pair(1, 0).unwrap().verdict, PairVerdict::NoVote);
}

#[test]
fn one_frame_alone_is_chance_unless_there_is_no_other() {
    let robust = ConsensusSettings::robust();
    let marks = |count: usize| (0..6).map(|frame| Vec::from_iter((frame < count).then_some(0..10))).collect();
    let all = of_wall(&Wall::new(&[marks(2), marks(2)]), robust);
    let pair = all.pair(0, 1).unwrap();
    assert_eq!((pair.seen, pair.needed, pair.verdict), (2, 2, PairVerdict::Vote));
    // Five frames marked, and the judge sees two of them.
    let mut wall = Wall::new(&[marks(5), marks(5)]);
    for frame in &mut wall.clips[1].frames[2..] {
        frame.depth.depth_m.fill(0.5);
    }
    let two = of_wall(&wall, robust);
    let pair = two.pair(0, 1).unwrap();
    assert_eq!((pair.seen, pair.needed, pair.verdict), (2, 3, PairVerdict::CannotSee));
}

#[test]
fn a_view_that_says_absent_speaks_against_what_it_could_see() {
    // Two agree; three say that there is nothing.
    let wall = Wall::still(3, &[0..10, 0..10, 0..0, 0..0, 0..0]);
    assert_eq!(wall.groundings[2].outcome, Outcome::Absent);
    for settings in [ConsensusSettings::paper(), ConsensusSettings::robust()] {
        let consensus = of_wall(&wall, settings);
        assert_eq!((consensus.views[0].votes, consensus.views[0].judges), (1, 4));
        assert_eq!(consensus.views[2].standing, ViewVerdict::Absent);
        assert!(consensus.pair(2, 0).is_none(), "nothing is asked about what says nothing");
    }
    assert_eq!(reason(&of_wall(&wall, ConsensusSettings::robust()), 0, 2, 0).1, Reason::Denied);
    // Who could not have seen it says nothing against it.
    let mut hidden = Wall::still(3, &[0..10, 0..10, 0..0, 0..0, 0..0]);
    for clip in &mut hidden.clips[2..] {
        for frame in &mut clip.frames {
            frame.depth.depth_m.fill(0.5);
        }
    }
    assert_eq!(of_wall(&hidden, ConsensusSettings::robust()).views[0].judges, 1);
    assert_eq!(of_wall(&hidden, ConsensusSettings::paper()).views[0].judges, 4);
    // Two frames empty on both sides change nothing.
    let empty = Wall::still(3, &[0..0, 0..0]);
    let consensus = of_wall(&empty, ConsensusSettings::robust());
    assert_eq!((consensus.decision, consensus.evidence.len()), (Decision::Absent, 0));
}

#[test]
fn what_is_no_answer_takes_no_part() {
    let mut wall = Wall::still(3, &[0..10, 0..10, 0..10, 0..10]);
    wall.groundings[1] = Grounding::without_answer(Outcome::Truncated);
    for settings in [ConsensusSettings::paper(), ConsensusSettings::robust()] {
        let consensus = of_wall(&wall, settings);
        assert_eq!(consensus.evidence, [0, 2, 3]);
        assert_eq!((consensus.views[0].votes, consensus.views[0].judges), (2, 2));
        assert_eq!(consensus.views[1].standing, ViewVerdict::NoAnswer);
        assert!(consensus.pairs.iter().all(|pair| pair.of != 1 && pair.judge != 1));
    }
    for outcome in
        [Outcome::Refused("no".into()), Outcome::Error("gone".into()), Outcome::Unparsed("?".into())]
    {
        wall.groundings.fill(Grounding::without_answer(outcome));
        let consensus = of_wall(&wall, ConsensusSettings::robust());
        assert_eq!((consensus.decision, consensus.evidence.len()), (Decision::NoAnswer, 0));
    }
}

#[test]
fn one_answer_is_not_voted_on() {
    let mut wall = Wall::still(3, &[0..10, 20..30, 40..50]);
    for view in [0, 2] {
        wall.groundings[view] = Grounding::without_answer(Outcome::Error("no reply".into()));
    }
    for preset in [Preset::Paper, Preset::Robust] {
        let consensus = of_wall(&wall, preset.settings());
        assert_eq!((consensus.decision, consensus.evidence), (Decision::Bypassed, vec![1]));
        let none = decide(&[], &[], &preset.settings());
        assert_eq!((none.decision, none.evidence.len()), (Decision::NoAnswer, 0));
    }
}

#[test]
fn groups_are_shown_by_both_presets_and_decide_in_one() {
    let groups = |first: u32, second: u32| {
        let place = |view: u32| if view < first { 0..10 } else { 30..40 };
        Wall::still(3, &(0..first + second).map(place).collect::<Vec<_>>())
    };
    // 4 : 4, each view with 3 of 7 votes.
    let paper = of_wall(&groups(4, 4), ConsensusSettings::paper());
    assert_eq!(paper.evidence.len(), 8, "both are reliable, and contradict each other");
    assert!(has_conflict(&paper));
    let robust = of_wall(&groups(4, 4), ConsensusSettings::robust());
    assert_eq!((robust.decision, robust.evidence.len()), (Decision::TiedAll, 8));
    assert_eq!(robust.groups[0].views, [0, 1, 2, 3]);
    assert_eq!((&robust.groups[0].against[..], &robust.groups[1].against[..]), (&[1][..], &[0][..]));
    assert!(robust.views.iter().all(|view| view.standing == ViewVerdict::Tied));
    let abstaining = ConsensusSettings { undecided: Undecided::Abstain, ..ConsensusSettings::robust() };
    let tied = of_wall(&groups(4, 4), abstaining);
    assert_eq!((tied.decision, tied.evidence.len()), (Decision::Tied, 0));
    assert_eq!((tied.views, tied.pairs), (robust.views, robust.pairs), "the votes are the same");
    // 6 : 5: 5 of 10 votes and 4 of 10, both above tau.
    let paper = of_wall(&groups(6, 5), ConsensusSettings::paper());
    assert_eq!(paper.evidence.len(), 11);
    let robust = of_wall(&groups(6, 5), ConsensusSettings::robust());
    assert_eq!(robust.evidence, [0, 1, 2, 3, 4, 5]);
    assert_eq!(robust.views[6].standing, ViewVerdict::Outvoted);
    // 5 : 3: 2 of 7 votes are too few in either.
    let paper = of_wall(&groups(5, 3), ConsensusSettings::paper());
    assert_eq!(paper.evidence, [0, 1, 2, 3, 4]);
    assert!(has_conflict(&paper));
    assert_eq!(of_wall(&groups(5, 3), ConsensusSettings::robust()).evidence, [0, 1, 2, 3, 4]);
}

#[test]
fn two_votes_make_a_view_reliable_and_one_does_not() {
    let robust = ConsensusSettings::robust();
    let two = of_wall(&Wall::still(3, &[0..10, 0..10]), robust);
    assert_eq!(two.views[0].score(), Some(1.0));
    assert_eq!((two.decision, two.evidence), (Decision::BestView, vec![0]));
    let three = of_wall(&Wall::still(3, &[0..10, 0..10, 0..10]), robust);
    assert_eq!((three.decision, three.evidence), (Decision::Reliable, vec![0, 1, 2]));
    // To the letter of the paper one of one is above tau.
    let two = of_wall(&Wall::still(3, &[0..10, 0..10]), ConsensusSettings::paper());
    assert_eq!((two.decision, two.evidence), (Decision::Reliable, vec![0, 1]));
}

#[test]
fn off_lets_everything_on_that_was_found() {
    let mut wall = Wall::still(3, &[0..10, 20..30, 0..0, 40..50]);
    wall.groundings[3] = Grounding::without_answer(Outcome::Truncated);
    let consensus = of_wall(&wall, Preset::Off.settings());
    assert_eq!((consensus.decision, consensus.evidence), (Decision::Off, vec![0, 1]));
    assert!(consensus.pairs.is_empty());
}
