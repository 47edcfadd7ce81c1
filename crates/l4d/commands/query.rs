//! `l4d query`: one sentence about one scene, now.

use anyhow::Result;
use l4d_data::Name;
use l4d_solve::ask::{Ask, Asked, Stages, ask};
use l4d_solve::grounders::Grounders;

use crate::cli::solver::QueryArgs;
use crate::out::{ExitStatus, Printer};
use crate::{rasterizer, solver};

pub(crate) fn run(args: &QueryArgs, out: &Printer) -> Result<ExitStatus> {
    let space = args.work.space(args.profile);
    let grounders = solver::open_grounders(&args.method, &space.shared(), out)?;
    if args.words {
        return words(&grounders, out);
    }
    let opened = rasterizer::open(&args.method.adapter.adapter)?;
    let order = Ask {
        scene: Name::new(&args.scene)?,
        text: args.text.as_deref().unwrap_or_default(),
        span: [args.from, args.to],
        space: &space,
        bench: &args.bench,
        splats: args.splats.clone(),
        reader_options: args.reader.options(),
        grounder: args.method.grounder.as_str(),
        grounders: &grounders,
        method: &args.method.choice(),
        rasterizer: opened.rasterizer.as_ref(),
        adapter: opened.adapter,
        cameras: &args.views,
        camera_file: args.cameras.as_deref(),
        times: &args.times,
        size: args.size.map(|size| size.0),
        out: args.out.as_deref(),
        force: args.force,
    };
    let asked = ask(&order, out)?;
    match args.json {
        true => out.json(&asked.to_json())?,
        false => print(&asked, args.explain, out)?,
    }
    Ok(if asked.answer.is_there() { ExitStatus::Success } else { ExitStatus::Findings })
}

/// What a sentence may say to a grounder that knows a list of words.
fn words(grounders: &Grounders, out: &Printer) -> Result<ExitStatus> {
    let rows = grounders.of_any_scene().map(|grounder| grounder.words()).unwrap_or_default();
    rows.iter().try_for_each(|(what, words)| out.data(format!("{what}: {words}")))?;
    Ok(ExitStatus::Success)
}

fn print(Asked { answer, stages, .. }: &Asked, explains: bool, out: &Printer) -> Result<()> {
    if let Some(stages) = stages {
        stages.lines(explains).iter().try_for_each(|line| out.data(line))?;
        if let Stages { moving: Some(moving), .. } = stages {
            out.note(format!("{:.1} s from the sentence to the masks", stages.seconds()));
            stages.masks_and_sheet().iter().chain([moving]).try_for_each(|path| out.data(path.display()))?;
        }
    }
    Ok(out.data(&answer.message)?)
}
