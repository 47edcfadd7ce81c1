//! The `l4d` binary: parse, run, exit code. Each verb is one file under `commands/`.

mod cli;
mod commands;
mod figures;
mod models;
mod out;
mod published_votes;
mod rasterizer;
mod readmes;
mod shipped;
mod shown;
mod solver;
mod stopping;

use std::process::ExitCode;
use std::sync::Arc;

use crate::cli::given::Given;
use crate::cli::{Cli, Command};
use crate::out::Printer;

fn main() -> ExitCode {
    let (cli, given) = match Cli::read(std::env::args_os()) {
        Ok(read) => read,
        Err(error) => return unread(&error),
    };
    let out = Arc::new(Printer::new(cli.global.quiet, given));
    out::init_logging(cli.global.verbose);
    let waiting = match (&cli.command, cli.command.how_to_go_on()) {
        (Command::TrainSplats(_), _) => stopping::save_when_stopped(Arc::clone(&out)),
        (_, Some(how_to_go_on)) => stopping::say_when_stopped(how_to_go_on, Arc::clone(&out)),
        (_, None) => Ok(()),
    };
    if let Err(error) = waiting {
        tracing::debug!(%error, "signals are not waited for");
    }
    match commands::run(&cli.command, &out) {
        Ok(status) => status.into(),
        Err(error) if out::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            out.failure(&error);
            stopping::end_as_asked();
            ExitCode::from(2)
        }
    }
}

/// How a command line ends that cannot be run, or that asks for help.
fn unread(error: &anyhow::Error) -> ExitCode {
    if let Some(error) = error.downcast_ref::<clap::Error>() {
        error.exit();
    }
    Printer::new(false, Given::default()).failure(error);
    ExitCode::from(2)
}
