//! What the page is made from: masks of methods, pictures of the held-out view.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use anyhow::Result;
use l4d_board::{LONGEST_SIDE_PX, Media};
use l4d_data::{Name, Report};
use l4d_frames::backdrop::Backdrop;
use l4d_score::EvalSet;

use crate::cli::judging::LeaderboardArgs;
use crate::out::Printer;

pub(super) fn with_media<T>(
    args: &LeaderboardArgs,
    eval_set: &EvalSet,
    out: &Printer,
    publish: impl FnOnce(&Media<'_>) -> Result<T>,
) -> Result<T> {
    let results = args.results.is_dir().then_some(args.results.as_path());
    if results.is_none() {
        out.warn(format!(
            "{}: there is no such folder, so the page shows no masks of methods; name it with --results",
            args.results.display()
        ));
    }
    let backdrops = backdrops(args, eval_set, out)?;
    let jpeg = |scene: &Name, frame: u32| {
        let found = backdrops.get(scene)?.jpeg(frame);
        found.inspect_err(|error| tracing::warn!("no picture under the masks: {error}")).ok()
    };
    let found = Mutex::new(Report::default());
    let published = publish(&Media { eval_set, results, backdrop: &jpeg, found: &found })?;
    out.warnings(found.into_inner().unwrap_or_else(PoisonError::into_inner));
    Ok(published)
}

/// The held-out views of the scenes that are rendered.
fn backdrops(args: &LeaderboardArgs, eval_set: &EvalSet, out: &Printer) -> Result<BTreeMap<Name, Backdrop>> {
    let mut backdrops = BTreeMap::new();
    let Some(data) = &args.data else { return Ok(backdrops) };
    for scene in &eval_set.scenes {
        let found =
            Backdrop::open(data, &scene.name, eval_set.profile, scene.truth.variant, LONGEST_SIDE_PX)?;
        backdrops.extend(found.map(|backdrop| (scene.name.clone(), backdrop)));
    }
    if backdrops.len() < eval_set.scenes.len() {
        let (there, all) = (backdrops.len(), eval_set.scenes.len());
        out.warn(format!("{}: holds {there} of {all} scenes; the others have no pictures", data.display()));
    }
    Ok(backdrops)
}
