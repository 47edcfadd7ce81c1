//! `l4d bench`: speed against error, in one table and one figure a topic.

mod lift;
mod splats;

use std::path::Path;

use anyhow::Result;
use l4d_data::store::Claim;

use crate::cli::splats::BenchCommand;
use crate::out::{ExitStatus, Printer};

/// The right to write a table and its figure.
fn claim(folder: &Path, stem: &str, force: bool) -> Result<Claim> {
    let names = ["csv", "svg", "png"].map(|ending| format!("{stem}.{ending}")).to_vec();
    Ok(Claim::take(folder, names, None, force)?)
}

pub(crate) fn run(command: &BenchCommand, out: &Printer) -> Result<ExitStatus> {
    match command {
        BenchCommand::Splats(args) => splats::run(args, out),
        BenchCommand::Lift(args) => lift::run(args, out),
    }
}
