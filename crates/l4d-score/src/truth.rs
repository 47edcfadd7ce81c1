//! The truth of one scene in memory: which pixels of the held-out view show which instance, at every frame.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::OnceLock;

use l4d_data::scene::Role;
use l4d_data::truth::{InstanceTruth, Truth, frame_key};
use l4d_data::{Benchmark, DataError, Name, Profile, Query, Scale};
use l4d_masks::{Mask, Rle};

use crate::labels::Labels;

/// A mask of the truth. It is drawn when its pixels are asked for: answers that are run lengths are compared without.
#[derive(Debug, Clone)]
pub struct TruthMask {
    rle: Rle,
    size: (u32, u32),
    drawn: OnceLock<Drawn>,
    area: u64,
}

/// The pixels, and the rows that they are in.
#[derive(Debug, Clone)]
struct Drawn {
    mask: Mask,
    rows: Range<u32>,
}

impl TruthMask {
    /// None if there is no pixel.
    pub fn new(rle: Rle, size: (u32, u32)) -> Option<Self> {
        let area = rle.area();
        (area > 0).then(|| Self { rle, size, drawn: OnceLock::new(), area })
    }

    /// The same of drawn pixels.
    pub fn of(mask: &Mask) -> Option<Self> {
        Self::new(mask.to_rle(), mask.size())
    }

    /// The pixels.
    pub fn mask(&self) -> &Mask {
        &self.drawn().mask
    }

    /// The pixels as runs.
    pub fn rle(&self) -> &Rle {
        &self.rle
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
        self.drawn.get_or_init(|| {
            let mask = Mask::from_rle(&self.rle, self.size.0, self.size.1);
            let rows = mask.bounding_box().map_or(0..0, |bounds| bounds.first_row..bounds.last_row + 1);
            Drawn { mask, rows }
        })
    }
}

/// One instance in the held-out view.
#[derive(Debug, Clone)]
pub struct TruthInstance {
    pub name: Name,
    /// Value of the `id` channel.
    pub id: u32,
    /// Object or landmark.
    pub role: Role,
    pub category: String,
    /// One entry per annotated frame; none where no pixel is visible.
    pub masks: Vec<Option<TruthMask>>,
}

/// The truth of one scene.
#[derive(Debug, Clone)]
pub struct SceneTruth {
    pub scene: Name,
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

    /// Reads the truth of a scene.
    ///
    /// # Errors
    /// A truth file that is missing or damaged.
    pub fn load(bench: &Benchmark, profile: Profile, scene: &Name) -> Result<Self, DataError> {
        Ok(Self::of(&bench.truth(profile, scene)?))
    }

    /// The truth of a file.
    pub fn of(file: &Truth) -> Self {
        let size = (file.width, file.height);
        let keys: Vec<String> = file.frames.iter().map(|&frame| frame_key(frame)).collect();
        let instance = |instance: &InstanceTruth| TruthInstance {
            name: instance.name.clone(),
            id: instance.id,
            role: instance.role,
            category: instance.category.clone(),
            masks: keys.iter().map(|key| TruthMask::new(instance.masks.get(key)?.clone(), size)).collect(),
        };
        let mut instances: Vec<TruthInstance> = file.instances.iter().map(instance).collect();
        instances.sort_by_key(|instance| instance.id);
        Self::new((file.scene.clone(), file.scale), size, file.frames.clone(), instances)
    }

    /// Who shows where at an annotated frame; none if instances overlap there, as hand-drawn ones may.
    pub fn labels(&self, position: usize) -> Option<&Labels> {
        let masks = || self.instances.iter().map(|instance| instance.masks[position].as_ref());
        self.labels[position].get_or_init(|| Labels::new((self.width, self.height), masks())).as_ref()
    }

    /// Positions of the referents of a query among the instances. `queries` is the file to blame.
    ///
    /// # Errors
    /// A query that names no instance of the truth.
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
        query.asks_at(self.frames[position]).then(|| self.union(referents, position)).flatten()
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
        TruthMask::of(&union).map(Cow::Owned)
    }
}
