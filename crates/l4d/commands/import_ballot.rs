//! `l4d import-ballot`: the ballot that an annotator sealed in a browser enters its round.

use anyhow::Result;
use l4d_annotate::offline::SavedBallot;
use l4d_annotate::scene;
use l4d_data::Workspace;
use l4d_votes::{Round, RoundDir};

use crate::cli::annotation::ImportBallotArgs;
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &ImportBallotArgs, out: &Printer) -> Result<ExitStatus> {
    let ballot = SavedBallot::read(&args.file)?;
    let (name, annotator) = (ballot.round(), ballot.annotator());
    let round = Round::open(&RoundDir::new(args.rounds.join(name.as_str())))?;
    round.require_annotator(annotator)?;
    let space = Workspace::new(round.profile).with_data(args.data.as_deref());
    let scenes = scene::load(space.data(), &round, annotator)?;
    let imported = ballot.import(&round, &scenes)?;
    let what = if imported.was_there { "was here already" } else { "imported" };
    out.note(format!("{annotator} in round {name}: {what}; {} acts, sealed", imported.acts));
    out.data(round.dir().ballot(annotator).display())?;
    Ok(ExitStatus::Success)
}
