//! What participants of a private test get: nothing from which an answer follows.
//!
//! Of a query that is its sentence and number, of a scene its cameras and the pictures of the training views. How
//! pictures are drawn is for the caller to say.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::benchmark::SetSplit;
use l4d_data::layout::SceneDir;
use l4d_data::results::MethodCard;
use l4d_data::store::write_atomic;
use l4d_data::{Benchmark, DataError, Name, Profile, Query, Report, Status, json, sums};
use serde_json::{Value, json};

use crate::codes;
use crate::contents::SUMS;
use crate::documents::{Documents, render};
use crate::gather::{Gathered, SceneFacts};
use crate::inspect::digest_all;

/// Writes what participants see of a rendered scene into a folder of scenes.
pub type Draw<'a> = &'a (dyn Fn(&SceneDir, &Path) -> Result<(), DataError> + Sync);

/// What participants get of a benchmark.
#[derive(Debug)]
pub(crate) struct Handout {
    profile: Profile,
    data: PathBuf,
    card: MethodCard,
}

impl Handout {
    /// Of a private test; none of other benchmarks. What is lacking becomes findings.
    pub(crate) fn of(
        bench: &Benchmark,
        gathered: &Gathered,
        renders: Option<(&Path, Profile)>,
        report: &mut Report,
    ) -> Result<Option<Self>, DataError> {
        if bench.manifest.split != SetSplit::Private {
            return Ok(None);
        }
        let manifest = bench.dir.manifest();
        let Some((data, profile)) = renders else {
            let message = "is `private`: participants get pictures, and nothing here says of which profile";
            let hint = "give --profile, and --data if the renders are elsewhere";
            report.error(codes::PRIVATE, &manifest, "field `split`", message, hint);
            return Ok(None);
        };
        for scene in gathered.scenes.iter().filter(|scene| scene.tracks.is_none()) {
            let message =
                format!("{} is a capture, and a private test consists of rendered scenes", scene.name);
            report.error(codes::PRIVATE, &manifest, "field `scenes`", message, "leave the scene out");
        }
        let Some(truth_digest) = bench.truth_digest_if_any(profile)? else {
            let message = format!("there is no truth of profile {profile}, so that nothing could be scored");
            let hint = format!("run `l4d build-scenes --profile {profile}`, or choose another --profile");
            report.error(codes::PRIVATE, &manifest, "field `split`", message, hint);
            return Ok(None);
        };
        let name = Name::new("my-method").map_err(|error| DataError::format(&manifest, "name", error))?;
        let card = MethodCard::new(name, "1", &bench.manifest.version, truth_digest, profile);
        Ok(Some(Self { profile, data: data.to_owned(), card }))
    }

    /// Writes the folder.
    pub(crate) fn write(
        &self,
        folder: &Path,
        (gathered, documents, licence): (&Gathered, &Documents, Option<&[u8]>),
        draw: Draw<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(), DataError> {
        for scene in &gathered.scenes {
            let path = folder.join("sentences").join(format!("{}.jsonl", scene.name));
            json::write_lines(&path, &sentences(scene))?;
            draw(&SceneDir::new(&self.data, &scene.name), &folder.join("data"))?;
        }
        json::write(&folder.join("method.json"), &self.card)?;
        let values = documents.with(json!({
            "profile": self.profile,
            "width": self.profile.width(),
            "height": self.profile.height(),
            "sentences": gathered.scenes.iter().map(|scene| sentences(scene).len()).sum::<usize>(),
        }));
        let card = render("README.md", include_str!("../templates/PARTICIPANTS.md"), &values)?;
        write_atomic(&folder.join("README.md"), card.as_bytes())?;
        if let Some(licence) = licence {
            write_atomic(&folder.join("LICENSE"), licence)?;
        }
        let mut files = digest_all(folder, progress)?;
        files.remove(SUMS);
        let listed: BTreeMap<String, String> =
            files.into_iter().map(|(file, (digest, _))| (file, digest)).collect();
        write_atomic(&folder.join(SUMS), sums::to_text(&listed).as_bytes())
    }
}

/// Number and words of everything that is scored.
fn sentences(scene: &SceneFacts) -> Vec<Value> {
    let judged = |query: &&Query| query.status != Status::Rejected;
    let all = scene.queries.iter().chain(&scene.composites).filter(judged);
    all.map(|query| json!({ "id": query.id, "text": query.text })).collect()
}
