//! When the agreement across views is not good enough.

use l4d_data::Report;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;

use super::pictures::Comparison;
use crate::geometry::{CrossView, Summary};

/// Share of co-visible interior pixels whose ids must agree.
const ID_AGREEMENT: f64 = 0.999;

pub(super) fn judge(
    comparisons: &[Comparison],
    scene: &Scene,
    dir: &SceneDir,
    report: &mut Report,
) -> Option<Summary> {
    let mut total = CrossView::default();
    for comparison in comparisons {
        total.merge(comparison.total.clone());
        judge_pair(comparison, scene, dir, report);
    }
    if comparisons.is_empty() || total.landed == 0 {
        return None;
    }
    let summary = total.summary();
    if summary.residual_over_allowed.median >= 1.0 {
        let message = format!(
            "the median residual across views is {:.2} mm, {:.2} times what is allowed",
            summary.residual_mm.median, summary.residual_over_allowed.median
        );
        report.error("L4D117", dir.root(), "depth across views", message, HINT);
    }
    if summary.id_agreement < ID_AGREEMENT {
        let message = format!(
            "ids of only {:.3} % of {} co-visible interior pixels agree, but {:.1} % must",
            summary.id_agreement * 100.0,
            summary.co_visible,
            ID_AGREEMENT * 100.0
        );
        report.error("L4D118", dir.root(), "ids across views", message, HINT);
    }
    for miss in summary.misses.iter().filter(|miss| miss.away_from_contact > 0) {
        let message = format!(
            "{} pixels are id {} here and id {} in {} (column {}, row {}), though nothing of the other id is near",
            miss.away_from_contact, miss.id_a, miss.id_b, miss.view_b, miss.pixel_b[0], miss.pixel_b[1]
        );
        let place = format!("column {}, row {}", miss.pixel_a[0], miss.pixel_a[1]);
        report.error("L4D118", &dir.frame(&miss.view_a, miss.frame), place, message, HINT);
    }
    Some(summary)
}

const HINT: &str = "cameras, depth and ids must come from the same render; build the scene again";

fn judge_pair(comparison: &Comparison, scene: &Scene, dir: &SceneDir, report: &mut Report) {
    let Some(&(frame, median)) = comparison.bad_frames.iter().max_by(|x, y| x.1.total_cmp(&y.1)) else {
        return;
    };
    let [a, b] = [comparison.a, comparison.b].map(|index| &scene.cameras[index].name);
    let message = format!(
        "seen from {a}, the depth of most pixels disagrees at {} of the compared frames; the median residual is up \
         to {median:.1} times what is allowed",
        comparison.bad_frames.len()
    );
    report.error("L4D117", &dir.frame(b, frame), "depth across views", message, HINT);
}
