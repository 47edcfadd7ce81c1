//! `benchmark/truth/<profile>/<scene>.json`: what the held-out view sees, and how much every view sees.
//!
//! Scoring needs only this file and the queries: no render.

use std::collections::{BTreeMap, BTreeSet};
use std::iter::zip;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::DataError;
use crate::json::{self, Document};
use crate::name::Name;
use crate::rle::{self, Rle};
use crate::scene::{Instance, Role, Scale, instance_problem};
use crate::timeline::{Interval, Profile};

/// Schema tag of a truth file.
pub const SCHEMA: &str = "l4d/truth/1";
/// Pixels of an instance in a picture that may be others when another machine renders it: where two surfaces are equally
/// far to the last bit, processors choose differently. One is what was seen.
pub const TOLERANCE_PX: u32 = 4;
/// Frames have four digits in files.
const MAX_FRAME: u32 = 9_999;

/// One instance in the held-out view.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstanceTruth {
    pub name: Name,
    /// Value of the `id` channel.
    pub id: u32,
    /// Object or landmark.
    pub role: Role,
    /// Common noun, so that look-alikes are known without the tracks.
    pub category: String,
    /// Four-digit frame -> mask; frames without a visible pixel are absent.
    pub masks: BTreeMap<String, Rle>,
}

impl InstanceTruth {
    /// The first frame whose mask differs from that of `other` by more than [`TOLERANCE_PX`].
    pub fn first_unlike<'a>(&'a self, other: &'a Self) -> Option<&'a str> {
        let frames: BTreeSet<&String> = self.masks.keys().chain(other.masks.keys()).collect();
        let differs = |frame: &&String| {
            let pixels = match (self.masks.get(*frame), other.masks.get(*frame)) {
                (Some(mask), Some(other)) => mask.difference(other),
                (Some(mask), None) | (None, Some(mask)) => mask.area(),
                (None, None) => 0,
            };
            pixels > u64::from(TOLERANCE_PX)
        };
        frames.into_iter().find(differs).map(String::as_str)
    }

    fn instance(&self) -> Instance {
        Instance {
            id: self.id,
            name: self.name.clone(),
            role: self.role,
            category: self.category.clone(),
            attributes: BTreeMap::new(),
            front: None,
        }
    }
}

/// A truth file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// [`SCHEMA`].
    pub schema: String,
    pub scene: Name,
    /// Spatial scale, so that scores by scale need no tracks.
    pub scale: Scale,
    /// Always 0.
    pub variant: u32,
    /// Profile that was rendered.
    pub profile: Profile,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The held-out view.
    pub test_view: Name,
    /// Annotated frames, ascending: those of the profile, or those of a real scene that people annotated.
    pub frames: Vec<u32>,
    /// Frames of a real scene that no one annotated, ascending: methods may answer them, and the answers are not judged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unannotated: Vec<u32>,
    /// Instances sorted by id.
    pub instances: Vec<InstanceTruth>,
    /// View -> instance -> visible pixels at each of `frames`.
    pub visible: BTreeMap<Name, BTreeMap<Name, Vec<u32>>>,
}

impl Truth {
    /// Reads and checks a truth file.
    ///
    /// # Errors
    /// A file that cannot be read, or whose size, frames or masks contradict each other.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        json::read_document(path)
    }

    /// The instance of that name.
    pub fn instance(&self, name: &str) -> Option<&InstanceTruth> {
        self.instances.iter().find(|instance| instance.name.as_str() == name)
    }

    /// Whether both may be of one scene, rendered by two machines: no instance has more than [`TOLERANCE_PX`] other
    /// pixels in a mask, or more or fewer in a view.
    pub fn agrees_with(&self, other: &Self) -> bool {
        let rest = |truth: &Self| {
            let mut rest = truth.clone();
            rest.instances.iter_mut().for_each(|instance| instance.masks.clear());
            rest.visible.values_mut().flat_map(BTreeMap::values_mut).for_each(Vec::clear);
            rest
        };
        let mut counts = zip(self.visible.values(), other.visible.values())
            .flat_map(|(one, other)| zip(one.values(), other.values()));
        rest(self) == rest(other)
            && zip(&self.instances, &other.instances).all(|(one, other)| one.first_unlike(other).is_none())
            && counts.all(|(counts, others)| first_unlike_count(counts, others).is_none())
    }

    /// All frames of the clip, annotated or not, ascending.
    pub fn clip(&self) -> Vec<u32> {
        let mut clip: Vec<u32> = self.frames.iter().chain(&self.unannotated).copied().collect();
        clip.sort_unstable();
        clip
    }

    /// From the first frame of the clip to its last: what a sentence that names an identity covers.
    pub fn whole(&self) -> Interval {
        let clip = self.clip();
        match (clip.first(), clip.last()) {
            (Some(&first), Some(&last)) if !self.profile.is_rendered() => {
                Interval::new(first, last).unwrap_or(Interval::WHOLE)
            }
            _ => Interval::WHOLE,
        }
    }

    /// What cannot be in the counts of pixels.
    fn count_problem(&self) -> Option<(String, String)> {
        if !self.visible.is_empty() && !self.visible.contains_key(&self.test_view) {
            let message = format!("is {}, of which `visible` says nothing", self.test_view);
            return Some(("field `test_view`".into(), message));
        }
        let most = self.width * self.height;
        let lists = self.visible.iter().flat_map(|(view, lists)| lists.iter().map(move |list| (view, list)));
        lists.map(|(view, (name, counts))| (view, name, counts)).find_map(|(view, name, counts)| {
            let message = if self.instance(name).is_none() {
                "is no instance of the scene".to_owned()
            } else if counts.len() != self.frames.len() {
                format!("has {} counts, but there are {} frames", counts.len(), self.frames.len())
            } else {
                let count = counts.iter().find(|count| **count > most)?;
                format!("has {count} pixels, but pictures have {most}")
            };
            Some((format!("field `visible.{view}.{name}`"), message))
        })
    }

    /// How a rendering differs from its profile.
    fn misfit(&self) -> Option<(String, String)> {
        if (self.width, self.height) != (self.profile.width(), self.profile.height()) {
            let message =
                format!("{}x{} is not the size of profile {}", self.width, self.height, self.profile);
            return Some(("fields `width`, `height`".into(), message));
        }
        let is_clip = self.unannotated.is_empty() && self.frames.iter().copied().eq(self.profile.frames());
        (!is_clip)
            .then(|| ("field `frames`".into(), format!("are not the frames of profile {}", self.profile)))
    }

    fn real_problem(&self) -> Option<(String, String)> {
        if !rle::is_sane_size(self.width, self.height) {
            let message =
                format!("{}x{}: each side has 1 to {} pixels", self.width, self.height, rle::MAX_SIDE);
            return Some(("fields `width`, `height`".into(), message));
        }
        let clip = self.clip();
        let is_sound = !self.frames.is_empty()
            && [&self.frames, &self.unannotated, &clip].iter().all(|list| list.is_sorted_by(|a, b| a < b))
            && clip.last().is_some_and(|last| *last <= MAX_FRAME);
        (!is_sound).then(|| {
            let message =
                format!("must be ascending, none in both, none above {MAX_FRAME}, at least one annotated");
            ("fields `frames`, `unannotated`".into(), message)
        })
    }
}

impl Document for Truth {
    const SCHEMA: &'static str = SCHEMA;
    const HINT: &'static str = "restore the file from the release, or build the scene again";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        if let Some(problem) = if self.profile.is_rendered() { self.misfit() } else { self.real_problem() } {
            return Some(problem);
        }
        let described: Vec<Instance> = self.instances.iter().map(InstanceTruth::instance).collect();
        if let Some(problem) = instance_problem(&described).or_else(|| self.count_problem()) {
            return Some(problem);
        }
        let keys: BTreeSet<String> = self.frames.iter().map(|&frame| frame_key(frame)).collect();
        let mut masks = self.instances.iter().flat_map(|one| one.masks.iter().map(move |mask| (one, mask)));
        masks.find_map(|(instance, (frame, mask))| {
            let message = match keys.contains(frame) {
                true => mask.misfit(self.width, self.height)?.to_string(),
                false => "is no frame of the clip".to_owned(),
            };
            Some((format!("instance {}, mask at `{frame}`", instance.name), message))
        })
    }
}

/// The first position at which counts of an instance in a view are further apart than those of two machines may be.
pub fn first_unlike_count(counts: &[u32], others: &[u32]) -> Option<usize> {
    let unlike = zip(counts, others).position(|(count, other)| count.abs_diff(*other) > TOLERANCE_PX);
    unlike.or_else(|| (counts.len() != others.len()).then(|| counts.len().min(others.len())))
}

/// The four-digit form of a frame number used as JSON key and file stem.
pub fn frame_key(frame: u32) -> String {
    format!("{frame:04}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(profile: Profile, size: [u32; 2], frames: &[u32], unannotated: &[u32]) -> Truth {
        Truth {
            schema: SCHEMA.to_owned(),
            scene: Name::new("a").unwrap(),
            scale: Scale::Room,
            variant: 0,
            profile,
            width: size[0],
            height: size[1],
            test_view: Name::new("cam00").unwrap(),
            frames: frames.to_vec(),
            unannotated: unannotated.to_vec(),
            instances: Vec::new(),
            visible: BTreeMap::new(),
        }
    }

    #[test]
    fn real_scenes_have_a_size_and_a_timeline_of_their_own() {
        let real = truth(Profile::Real, [1352, 1014], &[160, 180], &[151, 170, 200]);
        assert_eq!(real.problem(), None);
        assert_eq!(real.clip(), [151, 160, 170, 180, 200]);
        assert_eq!(real.whole(), Interval::new(151, 200).unwrap());
        let tiny: Vec<u32> = Profile::Tiny.frames().collect();
        let rendered = truth(Profile::Tiny, [128, 96], &tiny, &[]);
        assert_eq!((rendered.problem(), rendered.whole()), (None, Interval::WHOLE));
    }

    #[test]
    fn frames_and_sizes_that_cannot_be_are_refused() {
        let tiny: Vec<u32> = Profile::Tiny.frames().collect();
        /// Profile, size, frames and unannotated frames.
        type Case<'a> = (Profile, [u32; 2], &'a [u32], &'a [u32]);
        let cases: [Case<'_>; 9] = [
            (Profile::Real, [0, 48], &[1], &[]),
            (Profile::Real, [64, 100_000], &[1], &[]),
            (Profile::Real, [64, 48], &[], &[1, 2]),
            (Profile::Real, [64, 48], &[2, 1], &[]),
            (Profile::Real, [64, 48], &[1, 2], &[2]),
            (Profile::Real, [64, 48], &[1, 10_000], &[]),
            (Profile::Tiny, [64, 48], &tiny, &[]),
            (Profile::Tiny, [128, 96], &tiny[1..], &[]),
            (Profile::Tiny, [128, 96], &tiny, &[1]),
        ];
        for (profile, size, frames, unannotated) in cases {
            let problem = truth(profile, size, frames, unannotated).problem();
            assert!(problem.is_some(), "{profile} {size:?} {frames:?} {unannotated:?}");
        }
    }
}
