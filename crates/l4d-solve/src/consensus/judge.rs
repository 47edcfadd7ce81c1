//! View-pair voting (paper, section 4): what each view says about each other's proposal, frame by frame.

use std::collections::BTreeMap;

use l4d_masks::Mask;
use rayon::prelude::*;

use super::candidate::{Part, Proposal};
use super::record::{FrameCounts, FrameRecord, FrameVerdict, PairRecord, PairVerdict, Reason, share};
use super::reproject::reproject;
use super::settings::{Against, ConsensusSettings, Judges, Visibility};
use super::view_geometry::ViewGeometry;

/// Every view that found something, judged by every other that answered.
pub(super) fn judge_all(
    proposals: &[Proposal<'_>],
    parts: &[Part],
    settings: &ConsensusSettings,
) -> Vec<PairRecord> {
    let views = 0..proposals.len();
    let all = views.clone().flat_map(|of| views.clone().map(move |judge| (of, judge)));
    let is_pair = |&(of, judge): &(usize, usize)| {
        of != judge && parts[of] == Part::Found && matches!(parts[judge], Part::Found | Part::Absent)
    };
    let pairs: Vec<(usize, usize)> = all.filter(is_pair).collect();
    // Measured by pair, so that a frame can look up what was counted the other way round.
    let measured: BTreeMap<(usize, usize), BTreeMap<u32, FrameCounts>> = pairs
        .par_iter()
        .map(|&(of, judge)| ((of, judge), measure(&proposals[of], &proposals[judge], settings)))
        .collect();
    let judged = measured.iter().map(|(&(of, judge), forth)| {
        let back = measured.get(&(judge, of));
        let frames = forth.iter().map(|(&frame, &counts)| {
            let back = back.and_then(|back| back.get(&frame));
            let (verdict, reason) = judge_frame(&counts, back, settings);
            FrameRecord { frame, counts, verdict, reason }
        });
        judge_pair(of, judge, frames.collect(), settings)
    });
    judged.collect()
}

/// Every frame that both clips have.
fn measure(of: &Proposal, judge: &Proposal, settings: &ConsensusSettings) -> BTreeMap<u32, FrameCounts> {
    let frames = of.clip.frame_numbers().filter(|&frame| judge.clip.at(frame).is_some());
    frames.map(|frame| (frame, measure_frame(of, judge, frame, settings))).collect()
}

fn measure_frame(of: &Proposal, judge: &Proposal, frame: u32, settings: &ConsensusSettings) -> FrameCounts {
    let target = judge.mask(frame);
    let mut counts = FrameCounts { target: target.map_or(0, Mask::area), ..FrameCounts::default() };
    let Some(mask) = of.mask(frame) else { return counts };
    counts.marked = mask.area();
    let sight = |clip| ViewGeometry::of_clip(clip, frame, &settings.reprojection);
    let (Some(from), Some(to)) = (sight(of.clip), sight(judge.clip)) else { return counts };
    let there = reproject(&from, mask, &to, &settings.reprojection);
    counts.projected = there.projected;
    counts.in_frame = there.in_frame;
    counts.passing = there.passing;
    counts.covered = there.covered.area();
    counts.shared = target.map_or(0, |target| there.covered.and_count(target));
    counts
}

/// Frame-level consensus. `back` is what was counted when the judge's own mask was carried the other way.
fn judge_frame(
    counts: &FrameCounts,
    back: Option<&FrameCounts>,
    settings: &ConsensusSettings,
) -> (FrameVerdict, Reason) {
    let against = |rule: Against| match rule {
        Against::Disagrees => FrameVerdict::Disagrees,
        Against::LeftOut => FrameVerdict::Neutral,
    };
    if counts.marked == 0 && counts.target == 0 {
        return (FrameVerdict::Neutral, Reason::BothEmpty);
    }
    if counts.marked == 0 {
        let could_see = back.is_some_and(|back| can_see(back, settings));
        return match settings.unclaimed {
            Against::Disagrees if could_see => (FrameVerdict::Disagrees, Reason::Unclaimed),
            _ => (FrameVerdict::Neutral, Reason::Unmarked),
        };
    }
    if counts.projected == 0 {
        return (against(settings.unseen), Reason::NoDepth);
    }
    let is_visible = match settings.visibility {
        Visibility::Seen => can_see(counts, settings),
        Visibility::SharedWithProposal => {
            counts.shared_share().is_some_and(|shared| shared > settings.visibility_share)
        }
    };
    if !is_visible {
        return (against(settings.unseen), Reason::Unseen);
    }
    if counts.target == 0 {
        return (FrameVerdict::Disagrees, Reason::Denied);
    }
    match counts.iou() {
        Some(iou) if iou > settings.delta => (FrameVerdict::Agrees, Reason::Overlap),
        _ => (FrameVerdict::Disagrees, Reason::Apart),
    }
}

/// Whether the judge sees what is marked, whatever it says about it. Where its picture has no depth nothing is hidden,
/// and nothing is seen either.
fn can_see(counts: &FrameCounts, settings: &ConsensusSettings) -> bool {
    counts.covered > 0 && counts.seen_share().is_some_and(|seen| seen >= settings.visibility_share)
}

fn judge_pair(of: usize, judge: usize, frames: Vec<FrameRecord>, settings: &ConsensusSettings) -> PairRecord {
    let count =
        |test: &dyn Fn(&FrameRecord) -> bool| frames.iter().filter(|frame| test(frame)).count() as u32;
    let agreeing = count(&|frame| frame.verdict == FrameVerdict::Agrees);
    let counted = count(&|frame| frame.verdict != FrameVerdict::Neutral);
    let seen = count(&|frame| frame.counts.marked > 0 && can_see(&frame.counts, settings));
    let needed = settings.min_frames.min(count(&|frame| frame.counts.marked > 0)).max(1);
    let is_judge = match settings.judges {
        Judges::AllOthers => true,
        Judges::CouldSee => seen >= needed,
    };
    let is_above = share(agreeing.into(), counted.into()).is_some_and(|share| share > settings.epsilon);
    let verdict = match (is_judge, is_above) {
        (false, _) => PairVerdict::CannotSee,
        (true, true) => PairVerdict::Vote,
        (true, false) => PairVerdict::NoVote,
    };
    PairRecord { of, judge, verdict, agreeing, counted, seen, needed, frames }
}
