//! LangSplat: pairs of frame and sentence that were annotated.
//!
//! `eval/evaluate_iou_loc.py` lines 141 to 152 and 275 (IoU of the chosen level, mean over all pairs of a scene) and 162
//! to 217 (localisation). Frames that do not show the object have no annotation, so nothing that is said there counts.

use super::clip::{Clip, QueryScores, Seen, Value};
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "LangSplat, eval/evaluate_iou_loc.py",
    measures: &[Measure { key: "miou", title: "mIoU" }, Measure { key: "localisation", title: "loc. acc." }],
    on_missing: OnMissing::Stops,
    resizes: false,
    averaging: Averaging::PairsThenScenes,
    remark: "The source cuts relevancy at 0.7 of its own range and looks at frames that show the object; \
             here masks are as they were given. Localization accuracy needs relevancy: `l4d import langsplat`.",
    judge,
};

/// Why frames are left out where only present targets are annotated.
pub(super) const NOT_SHOWN: &str = "do not show what is asked for: no one annotates them";
/// The same frames, where a method says something.
pub(super) const UNSEEN_ALARM: &str = "are false alarms among them, which go unnoticed";

fn judge(clip: &Clip<'_>) -> QueryScores {
    let iou = Value::mean(clip.present().filter_map(Seen::iou));
    let localisation = Value::share(clip.present().filter_map(is_located));
    leaving_out_absent(QueryScores::new([iou, localisation]), clip)
}

/// Notes the frames that have no annotation, and what is answered in them.
pub(super) fn leaving_out_absent(judged: QueryScores, clip: &Clip<'_>) -> QueryScores {
    let absent = || clip.seen.iter().filter(|seen| !seen.is_present());
    judged
        .leaving_out(NOT_SHOWN, absent().count())
        .leaving_out(UNSEEN_ALARM, absent().filter(|seen| seen.answered > 0).count())
}

/// Whether the summit of relevancy lies in the box around a referent, borders included; none without relevancy.
fn is_located(seen: &Seen<'_>) -> Option<bool> {
    let [across, down] = seen.summit?;
    let (width, height) = seen.referents.first()?.mask().size();
    let col = (across * f64::from(width)).floor() as u32;
    let row = (down * f64::from(height)).floor() as u32;
    let boxes = seen.referents.iter().filter_map(|referent| referent.mask().bounding_box());
    let mut is_inside = boxes.map(|area| {
        (area.first_col..=area.last_col).contains(&col) && (area.first_row..=area.last_row).contains(&row)
    });
    Some(is_inside.any(|is_inside| is_inside))
}
