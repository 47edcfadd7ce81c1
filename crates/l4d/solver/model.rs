//! `--grounder model`: a segmenter in a process of its own, and a vision-language model that tells it what to look for.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use l4d_blender::python::Environment;
use l4d_data::workspace::SharedWork;
use l4d_endpoint::Link;
use l4d_ground::GrounderFile;
use l4d_ground::vlm::Vlm;
use l4d_ground::worker::{FrameStore, Segmenter, TextGrounder, Worker, WorkerError, WorkerTimeouts};
use l4d_solve::grounders::Grounders;

use crate::cli::models::ServerArgs;
use crate::models::open_client;
use crate::out::{Printer, refusal};
use crate::shipped;

/// Starts the segmenter, which gets the sentence itself, or what a model server makes of it.
pub(super) fn open(path: &Path, server: &ServerArgs, work: &SharedWork, out: &Printer) -> Result<Grounders> {
    let file = GrounderFile::read(path).context("--grounder-file")?;
    let launch = file.launch(path, shipped::workers(), |package| {
        let environment = Environment {
            requirements: package.join("requirements.txt"),
            kind_folder: work.worker_environments(),
            name: "the environment of the segmenter workers",
            holds: "torch, transformers; about 6 GB",
        };
        environment.find_or_make(out)
    })?;
    let worker = Worker::start(launch, WorkerTimeouts::default()).map_err(of_worker)?;
    let frames = FrameStore::new(work.segmenter_frames());
    let segmenter = Arc::new(Segmenter::new(worker, frames, file.threshold()));
    let Some(coupling) = file.coupling() else {
        return Ok(Grounders::Shared(Arc::new(TextGrounder::new(segmenter).map_err(of_worker)?)));
    };
    let client = open_client(server)?;
    let vlm = Vlm::new(client, segmenter, coupling, file.model).map_err(|error| {
        let hint = error.hint();
        refusal(format!("{}: {error}", path.display()), hint)
    })?;
    Ok(Grounders::Vlm(Arc::new(vlm)))
}

fn of_worker(error: WorkerError) -> anyhow::Error {
    let hint = error.hint();
    refusal(format!("segmenter: {error}"), hint)
}

/// Refuses options of a model server with a file that asks none.
pub(super) fn require_use_of(server: &ServerArgs, path: &Path) -> Result<()> {
    let asks = GrounderFile::read(path).context("--grounder-file")?.coupling().is_some();
    match asked_for(server).filter(|_| !asks) {
        Some(flag) => Err(refusal(
            format!("{flag} does not apply to {}: its segmenter alone is asked", path.display()),
            format!("add `coupling` to the file (docs/workers.md), or leave out {flag}"),
        )),
        None => Ok(()),
    }
}

/// The first option that only a model server is asked with.
fn asked_for(server: &ServerArgs) -> Option<&'static str> {
    let ServerArgs { endpoint, cache: _, refresh, max_cost, max_tokens_total } = server;
    let given = [
        ("--endpoint", endpoint.endpoint.is_some()),
        ("--base-url", endpoint.base_url.is_some()),
        ("--vlm", endpoint.vlm.is_some()),
        ("--api-key-env", endpoint.api_key_env.is_some()),
        ("--server", endpoint.server.is_some()),
        ("--link", endpoint.link != Link::Live),
        ("--refresh", *refresh),
        ("--max-cost", max_cost.is_some()),
        ("--max-tokens-total", max_tokens_total.is_some()),
    ];
    given.into_iter().find(|(_, is_given)| *is_given).map(|(flag, _)| flag)
}
