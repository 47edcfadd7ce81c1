//! `l4d completions`: verbs and options for a shell.

use anyhow::Result;

use crate::cli::{Command, CompletionsArgs};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &CompletionsArgs, out: &Printer) -> Result<ExitStatus> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Command::grammar(), "l4d", &mut script);
    out.data(String::from_utf8_lossy(&script).trim_end())?;
    Ok(ExitStatus::Success)
}
