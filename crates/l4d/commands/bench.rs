//! `l4d bench`: speed against error, in one table and one figure a topic.

mod lift;
mod splats;

use anyhow::Result;

use crate::cli::splats::BenchCommand;
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(command: &BenchCommand, out: &Printer) -> Result<ExitStatus> {
    match command {
        BenchCommand::Splats(args) => splats::run(args, out),
        BenchCommand::Lift(args) => lift::run(args, out),
    }
}
