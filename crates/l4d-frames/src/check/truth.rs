//! Whether the committed truth is what the pictures say.

use l4d_data::Report;
use l4d_data::truth::{Truth, first_unlike_count, frame_key};

use super::Request;

const HINT: &str =
    "restore the truth of the release, or accept the new pictures with `l4d build-scenes --update-benchmark`";

pub(super) fn compare_with_committed(seen: &Truth, request: Request, report: &mut Report) {
    let path = request.bench.truth(request.profile, request.scene);
    let committed = match Truth::read(&path) {
        Ok(committed) => committed,
        Err(error) => return report.data_error("L4D111", &error),
    };
    if committed.agrees_with(seen) {
        return;
    }
    let before = report.len();
    let mut differs = |place: String, message: String| report.error("L4D111", &path, place, message, HINT);
    if committed.test_view != seen.test_view {
        let message = format!("is {}, but scene.json holds out {}", committed.test_view, seen.test_view);
        differs("field `test_view`".into(), message);
    }
    for instance in &seen.instances {
        let place = format!("instance {}", instance.name);
        let Some(stated) = committed.instance(&instance.name) else {
            differs(place, "is not in the truth".into());
            continue;
        };
        if let Some(first) = stated.first_unlike(instance) {
            differs(format!("{place}, masks"), format!("differ from the pictures, first at frame {first}"));
        }
    }
    for (view, counts) in &seen.visible {
        let stated = committed.visible.get(view);
        for (name, counts) in counts {
            let stated = stated.and_then(|stated| stated.get(name));
            let first = stated.and_then(|stated| first_unlike_count(stated, counts));
            if stated.is_some() && first.is_none() {
                continue;
            }
            let frame = first
                .and_then(|position| seen.frames.get(position))
                .map_or_else(String::new, |frame| format!(", first at frame {}", frame_key(*frame)));
            differs(format!("visible.{view}.{name}"), format!("differs from the pictures{frame}"));
        }
    }
    if report.len() == before {
        report.error("L4D111", &path, "file", "lists something that the pictures do not have", HINT);
    }
}
