//! The page with which an annotator of an open round votes in a browser.

use std::path::PathBuf;

use anyhow::Result;
use l4d_annotate::{offline, scene};
use l4d_data::store::{Claim, write_atomic};
use l4d_data::{Name, Workspace, counted};
use l4d_votes::{Round, RoundDir};

use crate::cli::annotation::OpenRoundArgs;
use crate::out::{ExitStatus, Printer};

pub(super) fn run(
    args: &OpenRoundArgs,
    dir: &RoundDir,
    annotator: &str,
    out: &Printer,
) -> Result<ExitStatus> {
    let annotator = Name::new(annotator)?;
    let round = Round::open(dir)?;
    round.require_annotator(&annotator)?;
    let space = Workspace::new(round.profile).with_data(args.data.as_deref());
    let scenes = scene::load(space.data(), &round, &annotator)?;
    let path = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-{annotator}.html", round.name)));
    let _claim = Claim::of_file(&path, args.force)?;
    let page = offline::page(&round, &annotator, &scenes, space.data(), out)?;
    write_atomic(&path, &page)?;
    let megabytes = page.len() as f64 / 1e6;
    out.note(format!(
        "{} over {} in {megabytes:.1} MB, for {annotator} alone",
        counted(round.items.len(), "item"),
        counted(scenes.len(), "scene")
    ));
    out.note(format!(
        "next: send it to {annotator}; what comes back enters the round by `l4d import-ballot FILE`"
    ));
    out.data(path.display())?;
    Ok(ExitStatus::Success)
}
