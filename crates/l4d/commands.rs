//! One file per verb; each is a function from its arguments to an exit status.

mod ablate;
mod arrange;
mod baseline;
mod bench;
mod build_scenes;
mod check_queries;
mod check_results;
mod check_scenes;
mod cluster;
mod completions;
mod compose;
mod doctor;
mod download;
mod export;
mod host;
mod import;
#[cfg(feature = "annotate")]
mod import_ballot;
mod import_scene;
mod init_results;
#[cfg(feature = "board")]
mod leaderboard;
mod man;
mod open_round;
mod propose_prompts;
mod propose_scenes;
mod query;
mod quickstart;
mod release;
mod render_splats;
mod score;
mod serve;
mod sheet;
mod solve;
mod stats;
mod train_splats;
mod verdict;
#[cfg(feature = "annotate")]
mod verify_prompts;
mod view;

use anyhow::Result;

use crate::cli::Command;
#[cfg(not(all(feature = "board", feature = "annotate")))]
use crate::out::not_built_in;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(command: &Command, out: &Printer) -> Result<ExitStatus> {
    if command.needs_renderings().is_some_and(|bench| !bench.profile.is_rendered()) {
        return Err(refusal("real scenes are not rendered", "choose --profile tiny, small or full"));
    }
    match command {
        Command::Quickstart(args) => quickstart::run(args, &|command| run(command, out), out),
        Command::Doctor(args) => doctor::run(args, out),
        Command::BuildScenes(args) => build_scenes::run(args, out),
        Command::CheckScenes(args) => check_scenes::run(args, out),
        Command::Sheet(args) => sheet::run(args, out),
        Command::Compose(args) => compose::run(args, out),
        Command::Arrange(args) => arrange::run(args, out),
        Command::CheckQueries(args) => check_queries::run(args, out),
        Command::Stats(args) => stats::run(args, out),
        Command::ProposePrompts(args) => propose_prompts::run(args, out),
        Command::ProposeScenes(args) => propose_scenes::run(args, out),
        Command::OpenRound(args) => open_round::run(args, out),
        #[cfg(feature = "annotate")]
        Command::VerifyPrompts(args) => verify_prompts::run(args, out),
        #[cfg(not(feature = "annotate"))]
        Command::VerifyPrompts(_) => Err(not_built_in("the annotation screen", "annotate")),
        #[cfg(feature = "annotate")]
        Command::ImportBallot(args) => import_ballot::run(args, out),
        #[cfg(not(feature = "annotate"))]
        Command::ImportBallot(_) => Err(not_built_in("the import of ballots", "annotate")),
        Command::Verdict(args) => verdict::run(args, out),
        Command::TrainSplats(args) => train_splats::run(args, out),
        Command::RenderSplats(args) => render_splats::run(args, out),
        Command::View(args) => view::run(args, out),
        Command::Serve(args) => serve::run(args, out),
        Command::Query(args) => query::run(args, out),
        Command::Solve(args) => solve::run(args, out),
        Command::Ablate(args) => ablate::run(args, out),
        Command::Export(args) => export::run(args, out),
        Command::ImportScene(args) => import_scene::run(args, out),
        Command::Import(args) => import::run(args, out),
        Command::Baseline(args) => baseline::run(args, out),
        Command::InitResults(args) => init_results::run(args, out),
        Command::CheckResults(args) => check_results::run(args, out),
        Command::Score(args) => score::run(args, out),
        #[cfg(feature = "board")]
        Command::Leaderboard(args) => leaderboard::run(args, out),
        #[cfg(not(feature = "board"))]
        Command::Leaderboard(_) => Err(not_built_in("tables, figures and the page of scores", "board")),
        Command::Bench(command) => bench::run(command, out),
        Command::Release(args) => release::run(args, out),
        Command::Cluster(command) => cluster::run(command, out),
        Command::Download(args) => download::run(args, out),
        Command::Host(command) => host::run(command, out),
        Command::Completions(args) => completions::run(args, out),
        Command::Man(args) => man::run(args, out),
    }
}
