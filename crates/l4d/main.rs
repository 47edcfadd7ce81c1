//! The `l4d` binary: parse, run, exit code. Each verb is one file under `commands/`.

mod cli;
mod commands;
mod figures;
mod models;
mod out;
mod published_votes;
mod rasterizer;
mod solver;

use std::process::ExitCode;

use clap::Parser as _;

use crate::cli::Cli;
use crate::out::Printer;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let out = Printer::new(cli.global.quiet);
    out::init_logging(cli.global.verbose);
    match commands::run(&cli.command, &out) {
        Ok(status) => status.into(),
        Err(error) if out::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            out.failure(&error);
            ExitCode::from(2)
        }
    }
}
