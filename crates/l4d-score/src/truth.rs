//! The truth of one scene in memory: which pixels of the held-out view show which instance, at every frame.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::OnceLock;

use l4d_data::scene::Role;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Benchmark, DataError, Name, Profile, Query, Scale, Temporal};
use l4d_masks::{Mask, Runs, rle};
use rayon::prelude::*;

use crate::labels::Labels;

/// A mask of the truth with what is asked of it again and again. It is drawn when somebody asks for its pixels: answers
/// that are run lengths are compared without.
#[derive(Debug, Clone)]
pub struct TruthMask {
    runs: OnceLock<Runs>,
    drawn: OnceLock<Drawn>,
    area: u64,
}

/// The pixels, and the rows that they are in.
#[derive(Debug, Clone)]
struct Drawn {
    mask: Mask,
    rows: Range<u32>,
}

impl Drawn {
    fn new(mask: Mask) -> Self {
        let rows = mask.bounding_box().map_or(0..0, |bounds| bounds.first_row..bounds.last_row + 1);
        Self { mask, rows }
    }
}

impl TruthMask {
    /// None if the mask has no pixel.
    pub fn new(mask: Mask) -> Option<Self> {
        let area = mask.area();
        (area > 0).then(|| Self { runs: OnceLock::new(), drawn: OnceLock::from(Drawn::new(mask)), area })
    }

    /// None if there is no pixel.
    pub fn of_runs(mut runs: Runs) -> Option<Self> {
        let area = runs.area();
        runs.shrink_to_fit();
        (area > 0).then(|| Self { runs: OnceLock::from(runs), drawn: OnceLock::new(), area })
    }

    /// The pixels.
    pub fn mask(&self) -> &Mask {
        &self.drawn().mask
    }

    /// The pixels as runs.
    pub fn runs(&self) -> &Runs {
        self.runs.get_or_init(|| Runs::of(self.mask()))
    }

    /// Number of pixels.
    pub fn area(&self) -> u64 {
        self.area
    }

    /// Pixels shared with a prediction of the same size.
    pub fn overlap(&self, predicted: &Mask) -> u64 {
        let Drawn { mask, rows } = self.drawn();
        mask.and_count_in_rows(predicted, rows.clone())
    }

    fn drawn(&self) -> &Drawn {
        // One of the two is always there.
        self.drawn
            .get_or_init(|| Drawn::new(self.runs.get().map_or_else(|| Mask::empty(0, 0), Runs::to_mask)))
    }
}

/// One instance in the held-out view.
#[derive(Debug, Clone)]
pub struct TruthInstance {
    /// Instance name.
    pub name: Name,
    /// Value of the `id` channel.
    pub id: u32,
    /// Object or landmark.
    pub role: Role,
    /// Common noun.
    pub category: String,
    /// One entry per annotated frame; none where no pixel is visible.
    pub masks: Vec<Option<TruthMask>>,
}

/// The truth of one scene.
#[derive(Debug, Clone)]
pub struct SceneTruth {
    /// Scene name.
    pub scene: Name,
    /// Spatial scale.
    pub scale: Scale,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Annotated frames, ascending.
    pub frames: Vec<u32>,
    /// Instances, ascending by id.
    pub instances: Vec<TruthInstance>,
    /// Who shows at each annotated frame, made when first asked for.
    labels: Vec<OnceLock<Option<Labels>>>,
}

impl SceneTruth {
    /// The truth of a scene of some size, with instances ascending by id that have one entry per frame.
    pub fn new(
        (scene, scale): (Name, Scale),
        (width, height): (u32, u32),
        frames: Vec<u32>,
        instances: Vec<TruthInstance>,
    ) -> Self {
        let labels = frames.iter().map(|_| OnceLock::new()).collect();
        Self { scene, scale, width, height, frames, instances, labels }
    }

    /// Reads and decodes the truth of a scene.
    pub fn load(bench: &Benchmark, profile: Profile, scene: &Name) -> Result<Self, DataError> {
        Self::decode(&bench.truth(profile, scene)?, &bench.dir.truth(profile, scene))
    }

    /// Decodes what was read. `path` is the file to blame.
    pub fn decode(file: &Truth, path: &Path) -> Result<Self, DataError> {
        let (width, height) = (file.width, file.height);
        let keys: Vec<String> = file.frames.iter().map(|&frame| frame_key(frame)).collect();
        let decode = |key: &String, name: &Name, counts: Option<&String>| {
            let runs = counts.map(|counts| rle::decode_runs(counts, width, height)).transpose().map_err(
                |error| {
                    let place = format!("instance {name}, frame {key}");
                    DataError::invalid(path, place, error.to_string(), "restore the file from the release")
                },
            )?;
            Ok(runs.and_then(TruthMask::of_runs))
        };
        let instances = file.instances.par_iter().map(|instance| {
            let masks = keys
                .iter()
                .map(|key| decode(key, &instance.name, instance.masks.get(key)))
                .collect::<Result<Vec<_>, DataError>>()?;
            Ok(TruthInstance {
                name: instance.name.clone(),
                id: instance.id,
                role: instance.role,
                category: instance.category.clone(),
                masks,
            })
        });
        let mut instances = instances.collect::<Result<Vec<_>, DataError>>()?;
        instances.sort_by_key(|instance| instance.id);
        Ok(Self::new((file.scene.clone(), file.scale), (width, height), file.frames.clone(), instances))
    }

    /// Who shows where at an annotated frame; none if instances overlap there, as hand-drawn ones may.
    pub fn labels(&self, position: usize) -> Option<&Labels> {
        let masks = || self.instances.iter().map(|instance| instance.masks[position].as_ref());
        self.labels[position].get_or_init(|| Labels::new((self.width, self.height), masks())).as_ref()
    }

    /// Positions of the referents of a query among the instances. `queries` is the file to blame.
    pub fn referents(&self, query: &Query, queries: &Path) -> Result<Vec<usize>, DataError> {
        let position = |name: &Name| {
            self.instances.iter().position(|instance| instance.name == *name).ok_or_else(|| {
                DataError::invalid(
                    queries,
                    format!("query {}, field `referents`", query.id),
                    format!("names `{name}`, which is no instance of the truth of scene {}", self.scene),
                    "mend the name, or build the scene again",
                )
            })
        };
        query.referents.iter().map(position).collect()
    }

    /// Position of a frame among the annotated ones; none if the truth says nothing about it.
    pub fn position(&self, frame: u32) -> Option<usize> {
        self.frames.binary_search(&frame).ok()
    }

    /// What a query asks to find at an annotated frame: the union of its referents, or nothing.
    pub fn target(&self, query: &Query, referents: &[usize], position: usize) -> Option<Cow<'_, TruthMask>> {
        if query.temporal == Temporal::While && !query.holds_at(self.frames[position]) {
            return None;
        }
        self.union(referents, position)
    }

    /// Union of instances at an annotated frame; none if no pixel of them is visible.
    pub fn union(&self, instances: &[usize], position: usize) -> Option<Cow<'_, TruthMask>> {
        let mut visible =
            instances.iter().filter_map(|&index| self.instances[index].masks[position].as_ref());
        let first = visible.next()?;
        let mut rest = visible.peekable();
        if rest.peek().is_none() {
            return Some(Cow::Borrowed(first));
        }
        let mut union = first.mask().clone();
        rest.for_each(|other| union.union_with(other.mask()));
        TruthMask::new(union).map(Cow::Owned)
    }
}
