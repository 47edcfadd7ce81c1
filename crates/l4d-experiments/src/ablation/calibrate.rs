//! How often views must be swapped until lifting without consensus is as bad as in the paper's table.
//!
//! For each correlation and category the share of swapped views is searched by bisection, so that the mean mIoU of the
//! row without consensus comes as close to the paper's as it can. Draws are those that the run will meet, so what is
//! found here is what the row will show. Answers are lifted and judged in memory, each set of masks once.

mod search;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use l4d_data::digest::sha256_hex;
use l4d_data::published::{self, Published};
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{At as _, Category, Name, Progress, Query, json};
use l4d_frames::drawn::DepthMap;
use l4d_ground::oracle::{IdSource, NoisePreset, Oracle, Target, open_ids};
use l4d_ground::{Grounder as _, Grounding, Outcome, Question};
use l4d_masks::Mask;
use l4d_solve::lift::{Evidence, lift};
use l4d_solve::method::MethodChoice;
use l4d_solve::scene::SolveScene;
use l4d_solve::solve::SolveSettings;
use l4d_splat::raster::Rasterizer;
use serde::Serialize;
use serde_json::{Value, json};

use self::search::{HALVINGS, Search};
use super::Ablation;
use super::grid::WITHOUT;
use crate::csv_file::csv_of;
use crate::judged_scene::JudgedScene;
use crate::{Result, plain};

/// First words of a file that was found here.
const HEADING: &str =
    "# Swaps at which the row without consensus comes closest to the paper's mIoU. Made from ";

/// Where the noise with a correlation stands.
fn noise_path(folder: &Path, correlation: f64) -> PathBuf {
    folder.join("noise").join(format!("rho-{correlation}.toml"))
}

fn with_correlation(preset: &NoisePreset, correlation: f64) -> NoisePreset {
    let mut preset = preset.clone();
    preset.noise.swap.correlation = correlation;
    preset
}

/// Writes the given noise with each correlation.
pub(super) fn noises_as_given(
    preset: &NoisePreset,
    correlations: &[f64],
    folder: &Path,
) -> Result<Vec<NoisePreset>> {
    let one = |&correlation: &f64| {
        let preset = with_correlation(preset, correlation);
        let text = toml::to_string(&preset).map_err(plain)?;
        write_atomic(&noise_path(folder, correlation), text.as_bytes())?;
        Ok(preset)
    };
    correlations.iter().map(one).collect()
}

/// Finds the noise for each correlation, unless it was found before, and writes it. `calibration.csv` holds all that was
/// tried.
pub(super) fn noises_as_in_paper(
    order: &Ablation<'_>,
    preset: &NoisePreset,
    correlations: &[f64],
    published: &Published,
    progress: &dyn Progress,
) -> Result<Vec<NoisePreset>> {
    let Ablation { eval_set, folder, .. } = order;
    let method = MethodChoice { consensus: false, ..order.method.clone() };
    let (settings, clips) = (method.solve_settings(), method.clip_settings(None));
    let scenes = eval_set.scenes.iter().map(|scene| {
        let draws = (order.rasterizer, order.adapter.clone());
        let judged = JudgedScene::open(eval_set, scene, order.space, &clips, draws);
        Subject::new(judged.at(&scene.name)?)
    });
    let subjects: Vec<Subject<'_>> = scenes.collect::<Result<_>>()?;
    let targets = targets(published);
    let made_from = made_from(&subjects, preset, &settings, correlations, &targets, &eval_set.truth_digest);
    let paths: Vec<PathBuf> = correlations.iter().map(|&rho| noise_path(folder, rho)).collect();
    let read = || paths.iter().map(|path| Ok(NoisePreset::read(path)?)).collect();
    if paths.iter().all(|path| was_made_from(path, &made_from)) {
        progress.note(&format_args!("the noise in {} was found before", folder.join("noise").display()));
        return read();
    }

    let queries: usize = subjects.iter().map(|subject| subject.judged.queries().count()).sum();
    progress.start("calibrating", (queries * correlations.len() * (HALVINGS + 1)) as u64);
    let mut trials =
        Trials { rasterizer: order.rasterizer, settings: &settings, known: BTreeMap::new(), progress };
    let mut rows = Vec::new();
    for (&correlation, path) in correlations.iter().zip(&paths) {
        progress.item(&format_args!("rho {correlation}"));
        let mut searches: BTreeMap<Category, Search> =
            targets.iter().map(|(&category, &target)| (category, Search::new(target))).collect();
        let swapping =
            |swap_probability| NoisePreset { swap_probability, ..with_correlation(preset, correlation) };
        for _ in 0..=HALVINGS {
            let tried =
                swapping(searches.iter().map(|(&category, search)| (category, search.next)).collect());
            let reached = trials.miou_by_category(&subjects, &tried)?;
            for (category, search) in &mut searches {
                if let Some(&miou) = reached.get(category).filter(|_| !search.is_settled()) {
                    rows.push(Tried {
                        correlation,
                        category: *category,
                        swap: search.next,
                        miou,
                        paper: search.target,
                    });
                    search.hear(miou);
                }
            }
        }
        let found = searches.iter().filter_map(|(&category, search)| Some((category, search.closest()?.0)));
        let found = toml::to_string(&swapping(found.collect())).map_err(plain)?;
        write_atomic(path, format!("{HEADING}{made_from}\n{found}").as_bytes())?;
        progress.note(&format_args!("rho {correlation}: {}", said(&searches)));
    }
    progress.finish();
    write_atomic(&folder.join("calibration.csv"), &csv_of(&rows)?)?;
    read()
}

/// The paper's mIoU without consensus, percent.
fn targets(published: &Published) -> BTreeMap<Category, f64> {
    let value = |category: Category| {
        let value = published.value(WITHOUT, category.as_str(), published::Metric::Miou)?;
        Some((category, value))
    };
    Category::ALL.into_iter().filter_map(value).collect()
}

fn made_from(
    subjects: &[Subject<'_>],
    preset: &NoisePreset,
    settings: &SolveSettings,
    correlations: &[f64],
    targets: &BTreeMap<Category, f64>,
    truth_digest: &str,
) -> String {
    let scene = |subject: &Subject<'_>| {
        let queries: Vec<Value> =
            subject.judged.queries().map(|query| json!([query.id, query.text_digest])).collect();
        json!([subject.judged.scene.digest(), subject.ids.identity(), queries])
    };
    let decides = json!([
        "l4d/calibration/1",
        truth_digest,
        subjects.iter().map(scene).collect::<Vec<_>>(),
        preset,
        settings,
        correlations,
        targets,
        HALVINGS,
    ]);
    sha256_hex(json::canonical(&decides).as_bytes())
}

fn was_made_from(path: &Path, made_from: &str) -> bool {
    let heading = format!("{HEADING}{made_from}\n");
    let is_same = read_bounded(path, 1 << 20).is_ok_and(|bytes| bytes.starts_with(heading.as_bytes()));
    is_same && NoisePreset::read(path).is_ok()
}

/// A line of `calibration.csv`.
#[derive(Debug, Serialize)]
struct Tried {
    correlation: f64,
    category: Category,
    /// Share of swapped views.
    swap: f64,
    /// Without consensus, percent.
    miou: f64,
    paper: f64,
}

fn said(searches: &BTreeMap<Category, Search>) -> String {
    let one = |(category, search): (&Category, &Search)| {
        let (swap, miou) = search.closest()?;
        Some(format!("{} {swap} ({miou:.2}, paper {:.2})", category.as_str(), search.target))
    };
    let parts: Vec<String> = searches.iter().filter_map(one).collect();
    parts.join(", ")
}

/// A scene with what the oracle knows of it. Many oracles share its ids, so that pictures are read once.
struct Subject<'a> {
    judged: JudgedScene<'a>,
    ids: Arc<dyn IdSource>,
    targets: BTreeMap<Name, Target>,
}

impl<'a> Subject<'a> {
    fn new(mut judged: JudgedScene<'a>) -> Result<Self> {
        // The oracle looks at no pixel, and clips of many scenes at once would fill the memory.
        for frame in judged.scene.clips.iter_mut().flat_map(|clip| &mut clip.frames) {
            frame.colour = Default::default();
            frame.depth = DepthMap::empty(0, 0);
        }
        let SolveScene { profile, plan, .. } = &judged.scene;
        let ids = open_ids(judged.places.data.clone(), *profile, plan.size, plan.camera_size)?;
        let instances = ids.instances();
        let target =
            |query: &Query| Ok((query.id.number.clone(), Target::of(instances, query).map_err(plain)?));
        let targets = judged.queries().map(target).collect::<Result<_>>()?;
        Ok(Self { targets, ids, judged })
    }

    fn oracle(&self, preset: &NoisePreset) -> Oracle {
        let scene = self.judged.scene.name.clone();
        Oracle::new(scene, Arc::clone(&self.ids), self.targets.clone(), preset.clone())
    }
}

/// Answers without consensus, each set of masks lifted once.
struct Trials<'a> {
    rasterizer: &'a dyn Rasterizer,
    settings: &'a SolveSettings,
    /// Digest of query and masks -> mIoU, 0 to 1; none where the target is never present.
    known: BTreeMap<String, Option<f64>>,
    progress: &'a dyn Progress,
}

impl Trials<'_> {
    /// Mean over queries, percent.
    fn miou_by_category(
        &mut self,
        subjects: &[Subject<'_>],
        preset: &NoisePreset,
    ) -> Result<BTreeMap<Category, f64>> {
        let mut sums: BTreeMap<Category, (f64, usize)> = BTreeMap::new();
        for subject in subjects {
            let oracle = subject.oracle(preset);
            for query in subject.judged.queries() {
                let miou = self.miou(subject, &oracle, query).at(&query.id)?;
                self.progress.advance(1);
                for &category in miou.iter().flat_map(|_| &query.categories) {
                    let (sum, count) = sums.entry(category).or_default();
                    *sum += 100.0 * miou.unwrap_or_default();
                    *count += 1;
                }
            }
        }
        Ok(sums.into_iter().map(|(category, (sum, count))| (category, sum / count as f64)).collect())
    }

    fn miou(&mut self, subject: &Subject<'_>, oracle: &Oracle, query: &Query) -> Result<Option<f64>> {
        let question = Question::from(query);
        let clips = &subject.judged.scene.clips;
        let groundings: Vec<Grounding> = clips.iter().map(|clip| oracle.ground(clip, &question)).collect();
        let key = digest(query, &groundings);
        if let Some(&miou) = self.known.get(&key) {
            return Ok(miou);
        }
        let found = |view: &usize| groundings[*view].outcome == Outcome::Found;
        let believed: Vec<usize> = (0..clips.len()).filter(found).collect();
        let scene = &subject.judged.scene;
        let evidence = Evidence::of(clips, &groundings, &believed)?;
        let lifted = lift(&scene.rendered(self.rasterizer), &evidence, &self.settings.lift)?;
        let masks = scene.masks(self.rasterizer, lifted.as_ref(), &subject.judged.plan)?;
        let miou = subject.judged.tally(query, &masks)?.ratios().miou;
        self.known.insert(key, miou);
        Ok(miou)
    }
}

fn digest(query: &Query, groundings: &[Grounding]) -> String {
    let view = |grounding: &Grounding| {
        json!([grounding.outcome, grounding.masks.values().map(Mask::to_rle).collect::<Vec<_>>()])
    };
    let views: Vec<Value> = groundings.iter().map(view).collect();
    sha256_hex(json::canonical(&json!([query.id, views])).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_keeps_all_but_its_correlation() {
        let folder = tempfile::tempdir().unwrap();
        let mut preset = NoisePreset { seed: 3, ..NoisePreset::none() };
        preset.noise.flicker = 0.2;
        let noises = noises_as_given(&preset, &[0.0, 0.6], folder.path()).unwrap();
        let read: Vec<NoisePreset> =
            [0.0, 0.6].map(|rho| NoisePreset::read(&noise_path(folder.path(), rho)).unwrap()).to_vec();
        assert_eq!(read[0], with_correlation(&preset, 0.0));
        assert_eq!((read[1].seed, read[1].noise.flicker, read[1].noise.swap.correlation), (3, 0.2, 0.6));
        assert_eq!(noises, read);
        assert!(!was_made_from(&noise_path(folder.path(), 0.0), "abc"));
    }
}
