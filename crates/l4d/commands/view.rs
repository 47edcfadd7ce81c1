//! `l4d view`: one page that shows a scene over time.

use std::time::Instant;

use anyhow::Result;
use l4d_data::Name;
use l4d_data::store::{Claim, write_atomic};

use crate::cli::splats::ViewArgs;
use crate::out::{ExitStatus, Printer};
use crate::shown::{page_of, summary};

pub(crate) fn run(args: &ViewArgs, out: &Printer) -> Result<ExitStatus> {
    let start = Instant::now();
    let name = Name::new(&args.shown.scene)?;
    let space = args.shown.work.space(args.shown.profile);
    let path = args.out.clone().unwrap_or_else(|| space.work(&name).splats().with_file_name("view.html"));
    let _claim = Claim::of_file(&path, args.force)?;
    let page = page_of(&args.shown, None, out)?;
    write_atomic(&path, &page.html)?;
    out.note(format!("{} in {:.1} s; open it in a browser", summary(&page), start.elapsed().as_secs_f64()));
    out.data(path.display())?;
    Ok(ExitStatus::Success)
}
