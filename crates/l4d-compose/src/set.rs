//! The stage `compose`: a benchmark folder of new scenes, each drawn until its queries are proved.
//!
//! A run that was killed goes on with the scenes that are not complete; the set is one from its first scene on. What was
//! thrown away, and why, is in `rejected/<scene>.jsonl`.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use l4d_blender::compose::{Rejection, compose, exhausted};
use l4d_blender::env::BlenderEnv;
use l4d_data::benchmark::SetSplit;
use l4d_data::composition::Composition;
use l4d_data::layout::BenchDir;
use l4d_data::parallel::in_parallel;
use l4d_data::store::{FolderLock, remove_folder};
use l4d_data::tracks::Tracks;
use l4d_data::workspace::SharedWork;
use l4d_data::{Progress, StageError, json};
use serde::Serialize;

use crate::ledger::Ledger;
use crate::{Composed, Refused, queries};

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
    /// What a private set keeps of its secret.
    pub secret_digest: Option<&'o str>,
    /// Compose again what was changed since it was composed.
    pub force: bool,
    /// Draws of a seed that are tried before it is given up.
    pub draws: u32,
    /// Sentences that are not used.
    pub avoid: &'o BTreeSet<String>,
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
    /// Whether this run composed it.
    #[serde(skip)]
    pub is_new: bool,
}

/// Composes what is missing of a set; where nothing is, `find` is not asked for Blender. Gives every scene in the order
/// of the wishes.
///
/// # Errors
/// A folder that holds something else, files that were changed, a wish that no draw can fulfil, or a worker that dies.
pub fn compose_set(
    order: &SetOrder<'_>,
    find: impl FnOnce() -> Result<BlenderEnv, StageError>,
    progress: &dyn Progress,
) -> Result<Vec<Made>, StageError> {
    let _lock = FolderLock::take(order.out.root())?;
    let mut ledger = Ledger::open(order.out, order.split, order.secret_digest)?;
    let missing = ledger.missing(order.wishes, order.force, progress)?;
    let (wanted, complete): (Vec<&Composition>, Vec<&Composition>) =
        order.wishes.iter().partition(|wish| missing.contains(&wish.scene));
    let mut all: Vec<Made> =
        complete.into_iter().map(|wish| read_made(order.out, wish)).collect::<Result<_, _>>()?;
    all.iter().try_for_each(|made| ledger.list(&made.composition.scene))?;
    if !wanted.is_empty() {
        let maker = Maker { env: &find()?, order, ledger: Mutex::new(ledger), progress };
        progress.start("composing", wanted.len() as u64);
        let made = in_parallel(&wanted, order.jobs, |wish| {
            let made = maker.make(wish)?;
            progress.item(&wish.scene);
            progress.advance(1);
            Ok::<_, StageError>(made)
        });
        progress.finish();
        remove_folder(&order.out.root().join(".drawing"))?;
        all.extend(made?);
    }
    let place = |made: &Made| order.wishes.iter().position(|wish| wish.scene == made.composition.scene);
    all.sort_by_key(place);
    Ok(all)
}

/// A scene that an earlier run finished.
fn read_made(out: &BenchDir, wish: &Composition) -> Result<Made, StageError> {
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
    Ok(Made { composition, queries, rejected, is_new: false })
}

/// What scenes are made with.
struct Maker<'m> {
    env: &'m BlenderEnv,
    order: &'m SetOrder<'m>,
    ledger: Mutex<Ledger<'m>>,
    progress: &'m dyn Progress,
}

impl Maker<'_> {
    /// Draws a scene until one has queries.
    fn make(&self, wish: &Composition) -> Result<Made, StageError> {
        let (order, scene) = (self.order, &wish.scene);
        let folder = order.out.root().join(".drawing").join(scene.as_str());
        let mut rejected = Vec::new();
        let mut next = wish.clone();
        loop {
            let left = order.draws.saturating_sub(next.draw - wish.draw);
            if left == 0 {
                let last =
                    rejected.last().map_or("no draw was tried", |rejection: &Rejection| &rejection.reason);
                return Err(exhausted(wish, last));
            }
            remove_folder(&folder)?;
            let tried = left.min(DRAWS_AT_ONCE);
            let drawn = compose(self.env, &next, tried, &folder, order.work, &mut rejected)?;
            let Some(drawn) = drawn else {
                next.draw += tried;
                continue;
            };
            let (composition, tracks) = (drawn.composition, drawn.tracks);
            match ask(&tracks, &composition, order.avoid) {
                Ok(asked) => {
                    if !rejected.is_empty() {
                        json::write_lines(&order.out.rejected(scene), &rejected)?;
                    }
                    let drafts = BenchDir::new(folder.join("drafts"));
                    let mut ledger = self.ledger.lock().unwrap_or_else(PoisonError::into_inner);
                    ledger.add(&composition, &tracks, &asked, &drafts, self.progress)?;
                    drop(ledger);
                    remove_folder(&folder)?;
                    let queries = [asked.singles.len(), asked.composites.len(), asked.absents.len()];
                    return Ok(Made { composition, queries, rejected, is_new: true });
                }
                Err(refused) => {
                    rejected.push(Rejection { draw: composition.draw, reason: refused.to_string() });
                    next.draw = composition.draw + 1;
                }
            }
        }
    }
}

fn ask(tracks: &Tracks, composition: &Composition, avoid: &BTreeSet<String>) -> Result<Composed, Refused> {
    let words = l4d_english::Words::of(tracks);
    let say = |predicate: &_, temporal| l4d_english::forms(predicate, temporal, &words);
    queries(tracks, &crate::QueriesRequest { seed: composition.seed, avoid, truth: None }, &say)
}
