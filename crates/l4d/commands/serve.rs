//! `l4d serve`: a scene in a browser, and answers to the sentences that are asked there.

use anyhow::Result;
use l4d_data::{Name, Progress, StageError, Workspace};
use l4d_solve::ask::{Ask, ask};
use l4d_solve::grounders::Grounders;
use l4d_solve::method::MethodChoice;
use serde_json::{Value, json};

use crate::cli::splats::ServeArgs;
use crate::out::{ExitStatus, Printer};
use crate::rasterizer::{self, Opened};
use crate::shown::{page_of, summary};
use crate::solver;

pub(crate) fn run(args: &ServeArgs, out: &Printer) -> Result<ExitStatus> {
    let shown = &args.shown;
    let space = shown.work.space(shown.profile);
    let asker = Asker {
        scene: Name::new(&shown.scene)?,
        grounders: solver::open_grounders(&args.method, &space.shared(), out)?,
        opened: rasterizer::open(&args.method.adapter.adapter)?,
        method: args.method.choice(),
        space,
        args: args.clone(),
    };
    let page = page_of(shown, Some(args.method.grounder.as_str().to_owned()), out)?;
    out.note(summary(&page));
    let answerer = Box::new(move |text: &str, progress: &dyn Progress| asker.answer(text, progress));
    l4d_serve::serve(page.html, answerer, args.port, |address| {
        out.note("Ctrl-C ends it; no other machine can reach this page");
        // A line for people and scripts; where it is not read, there is a page all the same.
        let _unread = out.data(format!("http://{address}/"));
    })?;
    Ok(ExitStatus::Success)
}

/// What stays open from one question to the next.
struct Asker {
    args: ServeArgs,
    scene: Name,
    space: Workspace,
    grounders: Grounders,
    opened: Opened,
    method: MethodChoice,
}

impl Asker {
    /// What the page needs to know of an answer.
    fn answer(&self, text: &str, progress: &dyn Progress) -> Result<Value, StageError> {
        let shown = &self.args.shown;
        let order = Ask {
            scene: self.scene.clone(),
            text,
            span: [None, None],
            space: &self.space,
            bench: &shown.bench,
            splats: shown.splats.clone(),
            reader_options: shown.reader.options(),
            grounder: self.args.method.grounder.as_str(),
            grounders: &self.grounders,
            method: &self.method,
            rasterizer: self.opened.rasterizer.as_ref(),
            adapter: self.opened.adapter.clone(),
            cameras: &[],
            camera_file: None,
            times: &[],
            size: None,
            out: None,
            force: false,
        };
        let asked = ask(&order, progress)?;
        let stages = asked.stages.as_ref();
        let seen = stages.and_then(|stages| stages.first_view());
        Ok(json!({
            "message": asked.answer.message,
            "answer": asked.answer,
            "read": stages.map(|stages| stages.reading()).unwrap_or_default(),
            "seconds": stages.map(|stages| stages.seconds()),
            "camera": seen.as_ref().map(|seen| &seen.camera),
            "size": seen.as_ref().map(|seen| seen.size),
            "masks": seen.as_ref().map(|seen| &seen.masks),
        }))
    }
}
