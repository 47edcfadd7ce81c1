//! `l4d man`: a manual page of each verb.

use anyhow::{Context as _, Result};
use clap_mangen::Man;
use l4d_data::store::{Claim, write_atomic};

use crate::cli::{Command, ManArgs};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &ManArgs, out: &Printer) -> Result<ExitStatus> {
    let mut root = Command::grammar().disable_help_subcommand(true);
    root.build();
    let mut pages = Vec::new();
    gather(&root, &mut pages)?;
    let names = pages.iter().map(|(name, _)| name.clone()).collect();
    let _claim = Claim::take(&args.out, names, None, args.force)?;
    for (name, page) in &pages {
        write_atomic(&args.out.join(name), page)?;
    }
    out.note(format!("{} pages; `man -l {}` shows the first", pages.len(), args.out.join("l4d.1").display()));
    out.data(args.out.display())?;
    Ok(ExitStatus::Success)
}

/// The pages of a verb and of those below it.
fn gather(verb: &clap::Command, pages: &mut Vec<(String, Vec<u8>)>) -> Result<()> {
    let name = verb.get_display_name().unwrap_or_else(|| verb.get_name()).to_owned();
    let mut page = Vec::new();
    Man::new(verb.clone()).render(&mut page).context("cannot write a manual page")?;
    pages.push((format!("{name}.1"), page));
    verb.get_subcommands().try_for_each(|below| gather(below, pages))
}
