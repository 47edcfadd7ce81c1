//! The stage `compose`: a benchmark folder of new scenes, each drawn until its queries are proved.
//!
//! A scene's queries are written last: a scene that has them is complete, and a run that was killed goes on with the
//! next. What was thrown away, and why, is in `rejected/<scene>.jsonl`.

use std::collections::{BTreeMap, BTreeSet};

use l4d_blender::compose::{Rejection, compose, exhausted};
use l4d_blender::env::BlenderEnv;
use l4d_data::benchmark::{Manifest, SetSplit};
use l4d_data::composition::Composition;
use l4d_data::digest::sha256_file;
use l4d_data::layout::BenchDir;
use l4d_data::parallel::in_parallel;
use l4d_data::store::{FolderLock, remove_folder, write_atomic};
use l4d_data::tracks::Tracks;
use l4d_data::workspace::SharedWork;
use l4d_data::{Benchmark, Name, Progress, StageError, json, sums};
use serde::Serialize;

use crate::{Composed, Refused, queries, write};

/// Draws that one call of a worker tries at most.
const DRAWS_AT_ONCE: u32 = 8;

/// What is composed.
#[derive(Debug)]
pub struct SetOrder<'o> {
    /// A composition for each scene; the draw is found.
    pub wishes: &'o [Composition],
    /// Receives the scenes; may hold others of the same kind.
    pub out: &'o BenchDir,
    /// What the set may be used for.
    pub split: SetSplit,
    /// Draws of a seed that are tried before it is given up.
    pub draws: u32,
    /// Sentences that are not used.
    pub avoid: &'o BTreeSet<String>,
    /// Logs.
    pub work: &'o SharedWork,
    /// Blender processes at once.
    pub jobs: usize,
}

/// What became of a wish.
#[derive(Debug, Clone, Serialize)]
pub struct Made {
    /// What the scene is made from.
    #[serde(flatten)]
    pub composition: Composition,
    /// Queries, composites and absent sentences.
    pub queries: [usize; 3],
    /// Draws that were thrown away before it.
    pub rejected: Vec<Rejection>,
}

/// Composes what is missing of a set. Gives every scene in the order of the wishes.
///
/// # Errors
/// A folder that holds something else, a wish that no draw can fulfil, or a worker that dies.
pub fn compose_set(
    env: &BlenderEnv,
    order: &SetOrder<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Made>, StageError> {
    let known = claim(order)?;
    let _lock = FolderLock::take(order.out.root())?;
    progress.start("composing", order.wishes.len() as u64);
    let made = in_parallel(order.wishes, order.jobs, |wish| {
        let made = match read_made(order.out, wish)? {
            Some(made) => made,
            None => make(env, order, wish)?,
        };
        progress.item(&wish.scene);
        progress.advance(1);
        Ok::<_, StageError>(made)
    });
    progress.finish();
    remove_folder(&order.out.root().join(".drawing"))?;
    let made = made?;
    let mut scenes: Vec<Name> = known;
    scenes.extend(order.wishes.iter().map(|wish| wish.scene.clone()));
    publish(order, scenes)?;
    Ok(made)
}

/// The scenes that the folder has; refuses one that is no set of composed scenes of this split.
fn claim(order: &SetOrder<'_>) -> Result<Vec<Name>, StageError> {
    let root = order.out.root();
    if !order.out.manifest().exists() {
        return Ok(Vec::new());
    }
    let manifest = Benchmark::open(root)?.manifest;
    let refuse = |what: String| {
        StageError::new(format!("{} holds {what}", root.display()), "choose another --out".to_owned())
    };
    if let Some(scene) = manifest.scenes.iter().find(|scene| !order.out.composition(scene).exists()) {
        return Err(refuse(format!("`{scene}`, which is no composed scene")));
    }
    if manifest.split != order.split {
        return Err(refuse(format!("a set of split {:?}", manifest.split).to_lowercase()));
    }
    Ok(manifest.scenes)
}

/// A scene that an earlier run finished.
fn read_made(out: &BenchDir, wish: &Composition) -> Result<Option<Made>, StageError> {
    if !out.queries(&wish.scene).exists() {
        return Ok(None);
    }
    let path = out.composition(&wish.scene);
    let composition: Composition = json::read_document(&path)?;
    let pinned = |wanted: &Option<String>, has: &Option<String>| wanted.is_none() || wanted == has;
    let is_wanted = (composition.scale, composition.seed) == (wish.scale, wish.seed)
        && pinned(&wish.place, &composition.place)
        && pinned(&wish.theme, &composition.theme)
        && (&composition.categories, &composition.verbs) == (&wish.categories, &wish.verbs);
    if !is_wanted {
        return Err(StageError::new(
            format!("{} is another composition than the one that is asked for", path.display()),
            "choose another --out, or remove the scene from it",
        ));
    }
    let count = |path| json::read_lines::<serde_json::Value>(path).map(|lines| lines.len());
    let scene = &wish.scene;
    let queries = [count(&out.queries(scene))?, count(&out.composites(scene))?, count(&out.absents(scene))?];
    let log = out.rejected(scene);
    let rejected = match log.exists() {
        true => json::read_lines(&log)?.into_iter().map(|(_, rejection)| rejection).collect(),
        false => Vec::new(),
    };
    Ok(Some(Made { composition, queries, rejected }))
}

/// Draws a scene until one has queries.
fn make(env: &BlenderEnv, order: &SetOrder<'_>, wish: &Composition) -> Result<Made, StageError> {
    let (out, scene) = (order.out, &wish.scene);
    let folder = out.root().join(".drawing").join(scene.as_str());
    let mut rejected = Vec::new();
    let mut next = wish.clone();
    loop {
        let left = order.draws.saturating_sub(next.draw - wish.draw);
        if left == 0 {
            let last = rejected.last().map_or("no draw was tried", |rejection: &Rejection| &rejection.reason);
            return Err(exhausted(wish, last));
        }
        remove_folder(&folder)?;
        let drawn = compose(env, &next, left.min(DRAWS_AT_ONCE), &folder, order.work, &mut rejected)?;
        let Some(drawn) = drawn else {
            next.draw += left.min(DRAWS_AT_ONCE);
            continue;
        };
        let (composition, tracks) = (drawn.composition, drawn.tracks);
        match ask(&tracks, &composition, order.avoid) {
            Ok(asked) => {
                if !rejected.is_empty() {
                    json::write_lines(&out.rejected(scene), &rejected)?;
                }
                json::write(&out.composition(scene), &composition)?;
                json::write_compact(&out.tracks(scene), &tracks)?;
                write(out, scene, &asked)?;
                remove_folder(&folder)?;
                let queries = [asked.singles.len(), asked.composites.len(), asked.absents.len()];
                return Ok(Made { composition, queries, rejected });
            }
            Err(refused) => {
                rejected.push(Rejection { draw: composition.draw, reason: refused.to_string() });
                next.draw = composition.draw + 1;
            }
        }
    }
}

fn ask(tracks: &Tracks, composition: &Composition, avoid: &BTreeSet<String>) -> Result<Composed, Refused> {
    let words = l4d_english::Words::of(tracks);
    let say = |predicate: &_, temporal| l4d_english::forms(predicate, temporal, &words);
    queries(tracks, &crate::Order { seed: composition.seed, avoid, truth: None }, &say)
}

/// Writes manifest and checksums.
fn publish(order: &SetOrder<'_>, mut scenes: Vec<Name>) -> Result<(), StageError> {
    scenes.sort();
    scenes.dedup();
    let out = order.out;
    let mut digests = BTreeMap::new();
    for scene in &scenes {
        let files = [
            out.composition(scene),
            out.tracks(scene),
            out.queries(scene),
            out.composites(scene),
            out.absents(scene),
        ];
        for path in files {
            let name = path.strip_prefix(out.root()).unwrap_or(&path).display().to_string();
            digests.insert(name, sha256_file(&path)?);
        }
    }
    let manifest = Manifest {
        name: "Panoptic-L4D composed".to_owned(),
        version: "1.0.0".to_owned(),
        licence: "CC-BY-4.0".to_owned(),
        split: order.split,
        variant: 0,
        seed: 0,
        scenes,
    };
    let heading = "Composed by `l4d compose`; recipes/ says from which seeds.";
    write_atomic(&out.manifest(), manifest.to_toml(heading)?.as_bytes())?;
    Ok(write_atomic(&out.root().join("SHA256SUMS"), sums::to_text(&digests).as_bytes())?)
}
