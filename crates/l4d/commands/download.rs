//! `l4d download`: what a release holds, brought to where the verbs look for it.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;
use l4d_data::workspace::SharedWork;
use l4d_data::{DataError, Report, counted};
use l4d_endpoint::{BaseUrl, Files};
use l4d_frames::exr::encode_frame;
use l4d_frames::sample::{self, Light};
use l4d_release::download::{self, Base, FolderBase, Missing, Wanted};
use serde_json::json;

use crate::cli::publishing::DownloadArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &DownloadArgs, out: &Printer) -> Result<ExitStatus> {
    let base = base(&args.base)?;
    let cache = SharedWork::new(&args.work).downloads();
    let wanted = Wanted {
        scenes: &args.scenes,
        splits: &args.splits,
        parts: &args.parts,
        data: args.data.as_deref(),
        work: &args.work,
        bench: &args.bench,
        cache: &cache,
    };
    if args.verify_only {
        let mut report = Report::default();
        let files = download::verify(base.as_ref(), &wanted, &mut report)?;
        if !args.json && !report.has_errors() {
            out.note(format!("{files} files are what was downloaded"));
        }
        return out.findings(report, args.json);
    }
    let frames = Frames::default();
    let done =
        download::download(base.as_ref(), &wanted, &|path, members| frames.decode(path, members), out)?;
    if args.json {
        out.json(&json!(done))?;
        return Ok(ExitStatus::Success);
    }
    out.note(format!(
        "{}: {}; {} of the release fetched, {} here already",
        done.release,
        counted(done.scenes.len(), "scene"),
        counted(done.fetched.len(), "file"),
        done.kept.len()
    ));
    if let Some(tables) = &done.tables {
        out.note(format!("tables are in {}", tables.display()));
    }
    Ok(ExitStatus::Success)
}

/// A folder, or an address.
fn base(text: &str) -> Result<Box<dyn Base>> {
    if text.contains("://") {
        let hint = "give a folder, or an address such as https://example.org/release/panoptic-l4d-0.2.0";
        let url: BaseUrl = text.parse().map_err(|why: &str| refusal(format!("{text}: {why}"), hint))?;
        return Ok(Box::new(Remote(Files::below(&url))));
    }
    let folder = Path::new(text);
    if !folder.is_dir() {
        let hint = "name the folder of one release, or its http(s) address";
        return Err(refusal(format!("{text}: there is no such folder"), hint));
    }
    Ok(Box::new(FolderBase::new(folder)))
}

/// A release behind an address.
struct Remote(Files);

impl Base for Remote {
    fn read(&self, file: &str, from: u64) -> Result<(u64, Box<dyn Read>), Missing> {
        match self.0.read(file, from) {
            Ok(arriving) => Ok((arriving.first, arriving.reader)),
            Err(error) => Err(Missing { message: error.message().to_owned(), is_passing: error.is_passing }),
        }
    }

    fn name(&self, file: &str) -> String {
        self.0.url(file)
    }
}

/// Makes frames; keeps the light of the exposure that it saw last.
#[derive(Default)]
struct Frames(Mutex<Option<(f64, Arc<Light>)>>);

impl Frames {
    fn decode(&self, path: &Path, members: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>, DataError> {
        let bytes = members.get(sample::CARD).map(Vec::as_slice).unwrap_or_default();
        let card = sample::card(path, bytes)?;
        let light = self.light(card.exposure);
        let frame = sample::frame_of(path, &card, &light, |suffix| members.get(suffix).map(Vec::as_slice))?;
        encode_frame(path, &frame)
    }

    fn light(&self, exposure: f64) -> Arc<Light> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match kept.as_ref() {
            Some((of, light)) if *of == exposure => Arc::clone(light),
            _ => {
                let light = Arc::new(Light::new(exposure));
                *kept = Some((exposure, Arc::clone(&light)));
                light
            }
        }
    }
}
