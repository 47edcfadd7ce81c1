//! `l4d verify-prompts`: an annotator reads prompts and finds what they mean, in a terminal.

use anyhow::Result;
use l4d_annotate::{AnnotateError, Options, Outcome, annotate, scene};
use l4d_data::{Name, StageError, Workspace};
use l4d_votes::{Ballot, Round, RoundDir};

use crate::cli::annotation::{PictureArg, VerifyPromptsArgs};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &VerifyPromptsArgs, out: &Printer) -> Result<ExitStatus> {
    let annotator = Name::new(args.annotator.as_str())?;
    let name = Name::new(args.round.as_str())?;
    let dir = RoundDir::new(args.rounds.join(name.as_str()));
    let round = Round::open(&dir)?;
    round.require_annotator(&annotator)?;
    let space = Workspace::new(round.profile).with_data(args.data.as_deref()).with_work(&args.work);
    let data = space.data().to_owned();
    let scenes = scene::load(&data, &round, &annotator)?;
    let (ballot, notices) = Ballot::open(&dir, &round, &annotator)?;
    for notice in notices {
        out.warn(format!("{}: {}: {}", notice.path, notice.location, notice.message));
    }
    if ballot.is_sealed() {
        out.note(format!("the ballot of {annotator} in round {name} is sealed: there is nothing left to do"));
        return Ok(ExitStatus::Success);
    }
    let exports = space.shared().overlays(&name, &annotator);
    let options = Options { data, exports, characters: args.picture == PictureArg::Halfblocks };
    let outcome = annotate(&round, ballot, &annotator, scenes, &options).map_err(explained)?;
    out.note(farewell(outcome));
    Ok(ExitStatus::Success)
}

fn explained(error: AnnotateError) -> anyhow::Error {
    StageError::of(&error, error.hint()).into()
}

fn farewell(Outcome { items, answered, skipped, sealed }: Outcome) -> String {
    if sealed {
        return format!("sealed: {answered} of {items} items answered, {skipped} skipped");
    }
    let open = items - answered - skipped;
    let next = if open == 0 {
        "S in the application seals the ballot"
    } else {
        "the same command goes on from here"
    };
    format!("{answered} of {items} items answered, {skipped} skipped, {open} open; {next}")
}
