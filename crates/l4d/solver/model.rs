//! `--grounder model`: a segmenter in a process of its own, and a vision-language model that tells it what to look for.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use l4d_data::DataError;
use l4d_data::store::read_bounded;
use l4d_data::workspace::SharedWork;
use l4d_endpoint::Calibrations;
use l4d_ground::vlm::{Coupling, Settings, Vlm};
use l4d_ground::worker::{FrameStore, Patience, Segmenter, TextGrounder, Worker, WorkerError};
use l4d_solve::grounders::Grounders;
use serde::Deserialize;

use super::segmenter::SegmenterEntry;
use crate::cli::models::ServerArgs;
use crate::models::open_client;
use crate::out::{Printer, refusal};

/// What `coupling` says where no model is asked.
const NO_VLM: &str = "no-vlm";

/// `--grounder-file`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    coupling: String,
    segmenter: SegmenterEntry,
    #[serde(default)]
    model: Settings,
}

/// Starts the segmenter, which gets the sentence itself, or what a model server makes of it.
pub(super) fn open(path: &Path, server: &ServerArgs, work: &SharedWork, out: &Printer) -> Result<Grounders> {
    let file = read(path)?;
    let threshold = file.segmenter.threshold;
    let launch = file.segmenter.launch(path, work, out)?;
    let worker = Worker::start(launch, Patience::default()).map_err(of_worker)?;
    let segmenter = Arc::new(Segmenter::new(worker, FrameStore::new(work.segmenter_frames()), threshold));
    if file.coupling == NO_VLM {
        return Ok(Grounders::Shared(Arc::new(TextGrounder::new(segmenter).map_err(of_worker)?)));
    }
    let coupling = Coupling::ALL.into_iter().find(|coupling| coupling.as_str() == file.coupling);
    let coupling = coupling.ok_or_else(|| unknown_coupling(path, &file.coupling))?;
    let client = open_client(server)?;
    let calibrations = Calibrations::read(&work.endpoints())?;
    let vlm = Vlm::new(client, &calibrations, segmenter, coupling, file.model).map_err(|error| {
        let hint = error.hint();
        refusal(format!("{}: {error}", path.display()), hint)
    })?;
    Ok(Grounders::Vlm(Arc::new(vlm)))
}

fn read(path: &Path) -> Result<File> {
    let bytes = read_bounded(path, 1 << 20)?;
    let format = |message: String| DataError::Format {
        path: path.to_owned(),
        location: "grounder".to_owned(),
        message,
    };
    let text = std::str::from_utf8(&bytes).map_err(|error| format(error.to_string()))?;
    toml::from_str(text).map_err(|error| format(error.to_string())).context("--grounder-file")
}

fn unknown_coupling(path: &Path, found: &str) -> anyhow::Error {
    let known: Vec<&str> = Coupling::ALL.iter().map(|coupling| coupling.as_str()).chain([NO_VLM]).collect();
    DataError::invalid(
        path,
        "field `coupling`",
        format!("is `{}`", found.escape_debug()),
        format!("choose among {}", known.join(", ")),
    )
    .into()
}

fn of_worker(error: WorkerError) -> anyhow::Error {
    let hint = error.hint();
    refusal(format!("segmenter: {error}"), hint)
}
