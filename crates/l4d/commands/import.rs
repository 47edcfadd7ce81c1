//! `l4d import`: results of other methods in.

mod recount;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::{Benchmark, DataError, Name, Report, json};
use l4d_import::results::codec::{Codec, Reading};
use l4d_import::results::import::{Encoders, FrameOrder, Identity, Images, Imported, Request, import, write};
use l4d_import::results::preset::Preset;
use l4d_import::results::relevancy::TextEmbeddingsFile;
use serde_json::{Value, json};

use self::recount::{Recounted, recount};
use crate::cli::interop::{ImportArgs, ImportEncodersArgs};
use crate::out::{ExitStatus, Printer, refusal};
use crate::readmes;

pub(crate) fn run(args: &ImportArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let request = request(args, &bench)?;
    let name = args.name.clone().map_or_else(|| Name::new(&request.preset.name), Ok)?;
    let identity = Identity {
        name,
        version: args.method_version.clone(),
        test_view: args.test_view,
        depth: args.used_depth,
    };
    let mut report = Report::default();
    let imported = import(&request, |scene| out.note(format!("reading {scene}")), &mut report)?;
    let is_written = !imported.answers.is_empty() && (args.partial || !report.has_errors());
    let folder =
        is_written.then(|| write(&args.results, &identity, &request, &imported, args.force)).transpose()?;
    readmes::leave(&args.results, readmes::RESULTS)?;
    let recounted = recount(&imported, &request, &identity.name)?;
    if args.json {
        return out.document(summary(&imported, &recounted, folder.as_deref()), report);
    }
    let status = out.any_findings(report)?;
    match folder {
        Some(folder) => {
            tell(&imported, &recounted, &request, out)?;
            out.data(folder.display())?;
        }
        None => out.note("nothing was written: mend what was found, or pass --partial"),
    }
    Ok(status)
}

fn request<'a>(args: &ImportArgs, bench: &'a Benchmark) -> Result<Request<'a>> {
    let files = &args.files;
    let mut preset = Preset::find(&args.format)?;
    preset.template = files.template.clone().unwrap_or(preset.template);
    preset.codec = files.codec.unwrap_or(preset.codec);
    preset.ignore.extend(files.ignore.iter().cloned());
    if (preset.codec == Codec::Latents) != preset.latents.is_some() {
        return Err(refusal(
            format!("--codec {} does not fit the preset {}", preset.codec, preset.name),
            "take langsplat or 4d-langsplat for latents, and generic for everything else",
        ));
    }
    let selections = match &files.selections {
        Some(path) => json::read::<BTreeMap<String, BTreeSet<u32>>>(path)?,
        None => BTreeMap::new(),
    };
    let reading = Reading {
        codec: preset.codec,
        inside: files.inside.unwrap_or(preset.inside),
        key: files.key.clone().or_else(|| preset.key.clone()),
        selections,
    };
    Ok(Request {
        bench,
        profile: args.bench.profile,
        scenes: bench.select(&args.bench.scenes)?,
        resize: files.resize || preset.resize,
        preset,
        root: args.source.clone(),
        choices: files.choices.iter().cloned().collect(),
        reading,
        order: files.frames.as_deref().map(FrameOrder::read).transpose()?.unwrap_or(FrameOrder::Clip),
        images: files.images.as_deref().map(|path| Images::read(path, files.images_first)).transpose()?,
        encoders: encoders(&args.encoders)?,
        claims: args.claims.clone(),
    })
}

fn encoders(args: &ImportEncodersArgs) -> Result<Encoders, DataError> {
    let read = |path: &PathBuf| -> Result<(PathBuf, TextEmbeddingsFile), DataError> {
        Ok((path.clone(), TextEmbeddingsFile::read(path)?))
    };
    Ok(Encoders {
        decoder: args.decoder.clone(),
        texts: args.texts.as_ref().map(read).transpose()?,
        time_decoder: args.time_decoder.clone(),
        time_texts: args.time_texts.as_ref().map(read).transpose()?,
    })
}

/// Claimed numbers, and what the evaluations of others would say of the masks that came in.
fn tell(imported: &Imported, recounted: &Recounted, request: &Request<'_>, out: &Printer) -> Result<()> {
    for (claim, value) in &imported.claimed {
        out.data(format!("claimed  {claim}: {value}"))?;
    }
    for line in recounted.lines() {
        out.data(format!("recount  {line}"))?;
    }
    request.preset.notes.iter().for_each(|note| out.note(note));
    Ok(())
}

fn summary(imported: &Imported, recounted: &Recounted, folder: Option<&Path>) -> Value {
    let answers: usize = imported.answers.values().map(BTreeMap::len).sum();
    json!({
        "results": folder.map(|folder| folder.display().to_string()),
        "queries": imported.answers.len(),
        "answers": answers,
        "assumptions": imported.assumptions,
        "inputs": imported.inputs,
        "claimed": imported.claimed,
        "recounted": recounted.to_json(),
    })
}
