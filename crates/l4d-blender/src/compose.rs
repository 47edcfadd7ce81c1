//! Composed scenes: one worker draws from a seed until a draw becomes a scene, and says why it threw others away.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::composition::Composition;
use l4d_data::layout::BenchDir;
use l4d_data::tracks::Tracks;
use l4d_data::workspace::SharedWork;
use l4d_data::{At as _, StageError, json};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::env::BlenderEnv;
use crate::worker::{self, WorkerEnd, WorkerEvent};

/// A draw that became a scene.
#[derive(Debug)]
pub struct Composed {
    /// What it is made from, with theme and place pinned.
    pub composition: Composition,
    /// Where everything is at each canonical frame.
    pub tracks: Tracks,
}

/// A draw that was thrown away.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rejection {
    /// Which of its seed.
    pub draw: u32,
    /// In a few words.
    pub reason: String,
}

/// What composed scenes of a scale can be about.
#[derive(Debug, Clone, Serialize)]
pub struct Theme {
    /// Outdoor, room or tabletop.
    pub scale: String,
    /// What it is called.
    pub name: String,
    /// Where it can happen.
    pub places: Vec<String>,
    /// Nouns of its objects.
    pub categories: Vec<String>,
    /// What can happen.
    pub verbs: Vec<String>,
}

/// Tries `draws` draws from `wish.draw` on, in a folder that holds the files of this scene alone; none if all of them
/// were thrown away.
///
/// # Errors
/// A wish that no draw can fulfil, or a worker that dies.
pub fn compose(
    env: &BlenderEnv,
    wish: &Composition,
    draws: u32,
    folder: &Path,
    work: &SharedWork,
    rejected: &mut Vec<Rejection>,
) -> Result<Option<Composed>> {
    let scene = &wish.scene;
    let mut command = env.command();
    command.args(["compose", "--scene", scene, "--scale", wish.scale.as_str()]);
    command.args(["--seed", &wish.seed.to_string(), "--first-draw", &wish.draw.to_string()]);
    command.args(["--draws", &draws.to_string()]);
    let wanted: [(&str, &[String]); 4] = [
        ("--place", wish.place.as_slice()),
        ("--theme", wish.theme.as_slice()),
        ("--category", &wish.categories),
        ("--verb", &wish.verbs),
    ];
    for (option, words) in wanted {
        for word in words {
            command.args([option, word]);
        }
    }
    let files = BenchDir::new(folder);
    command.arg("--recipes").arg(files.recipes()).arg("--out").arg(folder);
    let mut is_composed = false;
    let end = worker::run(command, &work.log("compose", scene), &mut |event| {
        match event {
            WorkerEvent::Rejected { draw, reason } => {
                rejected.push(Rejection { draw: *draw, reason: reason.clone() });
            }
            WorkerEvent::Composed { .. } => is_composed = true,
            _ => {}
        }
        true
    })?;
    match end {
        WorkerEnd::Done if is_composed => Ok(Some(Composed {
            composition: json::read_document(&files.composition(scene))?,
            tracks: Tracks::read(&folder.join("tracks.json"))?,
        })),
        WorkerEnd::Done | WorkerEnd::Stopped => Ok(None),
        WorkerEnd::Refused(error) | WorkerEnd::Died(error) => {
            Err(error).at(format_args!("cannot compose {scene}"))
        }
    }
}

/// The themes that compositions draw from, with their places.
///
/// # Errors
/// A worker that dies.
pub fn themes(env: &BlenderEnv, work: &SharedWork) -> Result<Vec<Theme>> {
    let mut command = env.command();
    command.arg("compositions");
    let mut themes = Vec::new();
    let end = worker::run(command, &work.log("compose", "themes"), &mut |event| {
        if let WorkerEvent::Theme { scale, name, places, categories, verbs } = event.clone() {
            themes.push(Theme { scale, name, places, categories, verbs });
        }
        true
    })?;
    match end {
        WorkerEnd::Done | WorkerEnd::Stopped => Ok(themes),
        WorkerEnd::Refused(error) | WorkerEnd::Died(error) => Err(error),
    }
}

/// Reasons of rejections without what differs from draw to draw, and how often each was given.
pub fn reasons<'r>(rejected: impl IntoIterator<Item = &'r Rejection>) -> Vec<(String, usize)> {
    let mut counts = BTreeMap::<String, usize>::new();
    for rejection in rejected {
        *counts.entry(kind_of(&rejection.reason)).or_default() += 1;
    }
    let mut counts: Vec<(String, usize)> = counts.into_iter().collect();
    counts.sort_by(|a, b| (b.1, &a.0).cmp(&(a.1, &b.0)));
    counts
}

/// A reason without numbers: "cup_1 and lamp are 3.9 cm in each other" becomes "cup and lamp are # cm in each other".
fn kind_of(reason: &str) -> String {
    let word = |word: &str| {
        let stem = word.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_');
        match word.parse::<f64>() {
            Ok(_) => "#".to_owned(),
            Err(_) if stem.is_empty() => "#".to_owned(),
            Err(_) => stem.to_owned(),
        }
    };
    reason.split_whitespace().map(word).collect::<Vec<_>>().join(" ")
}

/// What to say where no draw of a seed was good enough for what is asked of a scene.
pub fn exhausted(wish: &Composition, last: &str) -> StageError {
    StageError::new(
        format!("no draw of seed {} became {}; the last: {last}", wish.seed, wish.scene),
        "take another seed, or demand less",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_counted_without_their_numbers() {
        let rejected =
            ["cup_1 and lamp are 3.9 cm in each other", "no room", "cup_2 and lamp are 1 cm in each other"]
                .map(|reason| Rejection { draw: 0, reason: reason.to_owned() });
        let counted = reasons(&rejected);
        assert_eq!(counted[0], ("cup and lamp are # cm in each other".to_owned(), 2));
        assert_eq!(counted[1], ("no room".to_owned(), 1));
    }
}
