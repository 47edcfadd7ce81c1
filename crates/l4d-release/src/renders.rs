//! The pictures of a profile for a release: complete, or refused with all that is missing.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::truth::frame_key;
use l4d_data::{Benchmark, Camera, DataError, Draw, Name, Profile, Report, sums};

use crate::codes;
use crate::gather::Source;

/// The files of all rendered scenes.
#[derive(Debug, Clone)]
pub struct Renders {
    /// What was rendered.
    pub profile: Profile,
    pub scenes: BTreeMap<Name, Rendered>,
}

/// A rendered scene.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// What was rendered.
    pub scene: Scene,
    /// Its files, sorted.
    pub files: Vec<Source>,
}

impl Rendered {
    /// The file of a picture.
    pub(crate) fn picture(&self, camera: &Camera, frame: u32) -> Option<Source> {
        let name = format!("/frames/{}/{}.exr", camera.name, frame_key(frame));
        self.files.iter().find(|file| file.name.ends_with(&name)).cloned()
    }

    /// All files but pictures, and the list of what they were.
    pub(crate) fn others(&self) -> Vec<Source> {
        let is_other = |file: &&Source| !file.name.ends_with(".exr") && !file.name.ends_with("/SHA256SUMS");
        self.files.iter().filter(is_other).cloned().collect()
    }
}

/// How many missing files a finding names.
const NAMED: usize = 4;

/// Lists the files of rendered scenes; whatever is missing or does not belong becomes a finding.
pub fn list<'a>(
    data: &Path,
    profile: Profile,
    bench: &Benchmark,
    scenes: impl Iterator<Item = &'a Name>,
    report: &mut Report,
) -> Renders {
    let mut found = BTreeMap::new();
    for name in scenes {
        let files =
            bench.draw_of(name).and_then(|draw| scene(&SceneDir::new(data, name), profile, draw, report));
        match files {
            Ok(Some(rendered)) => drop(found.insert(name.clone(), rendered)),
            Ok(None) => {}
            Err(error) => report.data_error(codes::RENDERS, &error),
        }
    }
    Renders { profile, scenes: found }
}

fn scene(
    dir: &SceneDir,
    profile: Profile,
    draw: Draw,
    report: &mut Report,
) -> Result<Option<Rendered>, DataError> {
    let path = dir.scene();
    let hint = format!("run `l4d build-scenes --profile {profile}`, which goes on where it was");
    if !path.exists() {
        return Err(DataError::invalid(
            &path,
            "file",
            "is missing: the scene is not rendered to its end",
            hint,
        ));
    }
    let scene = Scene::read(&path)?;
    if scene.profile != profile || (Draw { variant: scene.variant, seed: scene.seed }) != draw {
        let message = format!(
            "is profile {}, variant {}, seed {}; wanted is profile {profile}, variant {}, seed {}",
            scene.profile, scene.variant, scene.seed, draw.variant, draw.seed
        );
        return Err(DataError::invalid(&path, "scene", message, "name the right folder with --data"));
    }
    let listed = sums::read(&dir.checksums())?;
    let pictures = scene.cameras.iter().flat_map(|camera| {
        profile.frames().map(move |frame| format!("frames/{}/{}.exr", camera.name, frame_key(frame)))
    });
    let wanted: Vec<String> =
        ["scene.json", "scene.usdc", "tracks.json"].map(str::to_owned).into_iter().chain(pictures).collect();
    let missing: Vec<&str> = wanted
        .iter()
        .filter(|file| !listed.contains_key(*file) || !dir.root().join(file).is_file())
        .map(String::as_str)
        .collect();
    if !missing.is_empty() {
        let more = if missing.len() > NAMED { ", ..." } else { "" };
        let named = missing[..missing.len().min(NAMED)].join(", ");
        let message =
            format!("lacks {} of {} files, or their digests: {named}{more}", missing.len(), wanted.len());
        report.error(codes::RENDERS, dir.root(), "files", message, hint);
        return Ok(None);
    }
    let views = scene.cameras.len();
    if views != profile.training_views() + 1 {
        let message =
            format!("{views} views are rendered, profile {profile} has {}", profile.training_views() + 1);
        report.error(codes::RENDERS, &path, "field `cameras`", message, hint);
    }
    let prefix = format!("data/{profile}/{}", scene.name);
    let source = |file: &String| {
        Source::with_digest(format!("{prefix}/{file}"), dir.root().join(file), listed[file].clone())
    };
    let mut files: Vec<Source> = wanted.iter().map(source).collect::<Result<_, _>>()?;
    // Written by the workers; no list names them, `check-scenes` reads them.
    for camera in &scene.cameras {
        let card = dir.view_card(&camera.name);
        files.push(Source::read(format!("{prefix}/frames/{}/view.json", camera.name), card)?);
    }
    files.push(Source::read(format!("{prefix}/SHA256SUMS"), dir.checksums())?);
    files.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(Some(Rendered { scene, files }))
}
