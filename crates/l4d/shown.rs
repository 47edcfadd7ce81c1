//! The page of a scene, for `view` that writes it and `serve` that sends it.

use std::path::Path;

use anyhow::Result;
use l4d_data::layout::{BenchDir, ResultsDir, SceneDir};
use l4d_data::name::choose_among;
use l4d_data::query::read_queries;
use l4d_data::store::list_folder;
use l4d_data::tracks::Tracks;
use l4d_data::truth::Truth;
use l4d_data::{DataError, Name, Profile, Rig, Scene, counted};
use l4d_splat::source::{ReaderOptions, Source};
use l4d_view::{MOST_METHODS, Request, Written};

use crate::cli::splats::ShownArgs;
use crate::out::{Printer, refusal};

/// What is on a page.
pub(crate) fn summary(page: &Written) -> String {
    format!(
        "{} at {}, {}, {}: {:.1} MB",
        counted(page.gaussians, "Gaussian"),
        counted(page.times, "moment"),
        counted(page.pictures, "picture"),
        counted(page.sentences, "sentence"),
        page.html.len() as f64 / 1e6
    )
}

/// The page of a scene; `asks` names who answers its questions, if anybody does.
pub(crate) fn page_of(args: &ShownArgs, asks: Option<String>, out: &Printer) -> Result<Written> {
    let name = Name::new(&args.scene)?;
    let space = args.work.space(args.profile);
    let dir = space.scene(&name);
    let splats = args.splats.clone().unwrap_or_else(|| space.work(&name).splats());
    let methods = methods(args)?;
    let rig = space.rig(&name)?;
    let source = open_splats(&splats, args.reader.options(), (&rig, args.profile), out)?;

    let bench = BenchDir::new(&args.bench);
    let tracks = if_there(&bench.tracks(&name), Tracks::read)?;
    let truth = if_there(&bench.truth(args.profile, &name), Truth::read)?;
    let queries = if_there(&bench.queries(&name), |path| read_queries(path, &name))?.unwrap_or_default();
    let scene = match args.no_pictures || !args.profile.is_rendered() {
        true => None,
        false => rendered(&dir, &rig, out)?,
    };
    let request = Request {
        scene: &name,
        profile: args.profile,
        rig: &rig,
        model: &source.model,
        background: source.background.unwrap_or_default(),
        near_m: source.near_m,
        tracks: tracks.as_ref(),
        rendered: scene.as_ref().map(|scene| (scene, &dir)),
        truth: truth.as_ref(),
        queries: &queries,
        methods: &methods,
        asks,
    };
    Ok(l4d_view::page(&request, out)?)
}

/// A model as it lies in the clip of a scene; what was ignored or assumed is said.
pub(crate) fn open_splats(
    path: &Path,
    reader: ReaderOptions,
    (rig, profile): (&Rig, Profile),
    out: &Printer,
) -> Result<Source> {
    let source = Source::open(path, reader)?.on(path, rig.timeline(), &rig.clip(profile))?;
    source.notes.iter().for_each(|note| out.note(format!("{}: {note}", path.display())));
    Ok(source)
}

/// The folders of the methods that are named.
fn methods(args: &ShownArgs) -> Result<Vec<(String, ResultsDir)>> {
    if args.methods.len() > MOST_METHODS {
        let message = format!("{} methods, but a page shows {MOST_METHODS}", args.methods.len());
        return Err(refusal(message, format!("name at most {MOST_METHODS} with --methods")));
    }
    let folder = |name: &String| {
        let folder = ResultsDir::new(args.results.join(Name::new(name)?.as_str()));
        if folder.card().is_file() {
            return Ok((name.clone(), folder));
        }
        let message = format!("{}: there are no results of a method", folder.root().display());
        let there = list_folder(&args.results).unwrap_or_default();
        let is_method = |name: &&String| ResultsDir::new(args.results.join(name)).card().is_file();
        let there: Vec<&str> = there.iter().filter(is_method).map(String::as_str).collect();
        Err(refusal(
            message,
            match there.is_empty() {
                true => "name folders of --results that have a method.json".to_owned(),
                false => choose_among(name, &there),
            },
        ))
    };
    args.methods.iter().map(folder).collect()
}

/// What is read from a file, or nothing where there is no file.
fn if_there<T>(path: &Path, read: impl FnOnce(&Path) -> Result<T, DataError>) -> Result<Option<T>> {
    Ok(if path.exists() { Some(read(path)?) } else { None })
}

/// The scene if its frames are there; the cameras may be all that is.
fn rendered(dir: &SceneDir, rig: &Rig, out: &Printer) -> Result<Option<Scene>> {
    let is_there = rig.cameras.iter().all(|camera| dir.view(&camera.name).is_dir());
    if !is_there {
        out.note(format!("no frames in {}, so no pictures, depth and ids", dir.root().display()));
        return Ok(None);
    }
    Ok(Some(Scene::read(&dir.scene())?))
}
