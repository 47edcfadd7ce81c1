//! Visibility gates: what a query asks for must be there to be found, and seen by enough training views.

use l4d_data::query::{Query, read_queries};
use l4d_data::scene::Scene;
use l4d_data::truth::Truth;
use l4d_data::{Name, Report, Split, Status};

use super::Request;

/// Pixels that a referent must show at 256x192; other sizes scale by area.
const PIXELS_AT_SMALL: f64 = 150.0;
const SMALL_AREA: f64 = 256.0 * 192.0;
/// Share of the query's frames in which it must.
const SHARE_OF_FRAMES: f64 = 0.8;
/// Training views that must see it as well in these frames.
const TRAINING_VIEWS: usize = 6;

pub(super) fn check(truth: &Truth, scene: &Scene, request: Request, report: &mut Report) {
    let path = request.bench.queries(request.scene);
    if !path.exists() {
        let hint = "write queries for the scene, then check again";
        return report.warning(
            "L4D119",
            &path,
            "file",
            "is missing, so no visibility gate was checked",
            hint,
        );
    }
    let queries = match read_queries(&path, request.scene) {
        Ok(queries) => queries,
        Err(error) => return report.data_error("L4D119", &error),
    };
    let gate = Gate::new(truth, scene);
    for query in queries.iter().filter(|query| query.status != Status::Rejected) {
        for referent in &query.referents {
            if let Some((code, message)) = gate.problem(query, referent) {
                let hint = "move the cameras or the thing, widen the interval, or drop the query";
                report.error(code, &path, format!("query {}, referent {referent}", query.id), message, hint);
            }
        }
    }
}

/// Why the gates refuse a referent of a query, as finding code and message. They hold for `small` and `full`.
pub fn visibility_problem(
    truth: &Truth,
    scene: &Scene,
    query: &Query,
    referent: &Name,
) -> Option<(&'static str, String)> {
    Gate::new(truth, scene).problem(query, referent)
}

struct Gate<'a> {
    truth: &'a Truth,
    training: Vec<&'a Name>,
    least_pixels: u32,
}

impl<'a> Gate<'a> {
    fn new(truth: &'a Truth, scene: &'a Scene) -> Self {
        let area = f64::from(truth.width) * f64::from(truth.height);
        let training = scene.cameras.iter().filter(|camera| camera.split == Split::Train);
        Self {
            truth,
            training: training.map(|camera| &camera.name).collect(),
            least_pixels: (PIXELS_AT_SMALL * area / SMALL_AREA).ceil() as u32,
        }
    }

    fn problem(&self, query: &Query, referent: &Name) -> Option<(&'static str, String)> {
        if self.truth.instance(referent).is_none() {
            return Some(("L4D119", "is no instance of the scene".to_owned()));
        }
        let held: Vec<usize> = self
            .truth
            .frames
            .iter()
            .enumerate()
            .filter(|(_, frame)| query.holds_at(**frame))
            .map(|(position, _)| position)
            .collect();
        let needed = (SHARE_OF_FRAMES * held.len() as f64).ceil() as usize;
        let seen =
            held.iter().filter(|&&position| self.is_seen(&self.truth.test_view, referent, position)).count();
        if seen < needed || held.is_empty() {
            let message = format!(
                "the held-out view shows at least {} pixels of it in {seen} of {} frames in which the query holds, \
                 but {needed} are needed",
                self.least_pixels,
                held.len()
            );
            return Some(("L4D115", message));
        }
        let views_at = |position: usize| {
            self.training.iter().filter(|view| self.is_seen(view, referent, position)).count()
        };
        let seen = held.iter().filter(|&&position| views_at(position) >= TRAINING_VIEWS).count();
        (seen < needed).then(|| {
            let message = format!(
                "{TRAINING_VIEWS} training views show at least {} pixels of it in {seen} of {} frames in which the \
                 query holds, but {needed} are needed",
                self.least_pixels,
                held.len()
            );
            ("L4D116", message)
        })
    }

    fn is_seen(&self, view: &Name, referent: &Name, position: usize) -> bool {
        let counts = self.truth.visible.get(view).and_then(|counts| counts.get(referent));
        counts.and_then(|counts| counts.get(position)).is_some_and(|&count| count >= self.least_pixels)
    }
}
