//! Every threshold of the geometric grounder, in one place. Tuned on another variant of six of the 21
//! scenes, whose 78 sentences are in the test set, and not chosen again since. Who changes one raises the version in the
//! grounder's identity.

// Perception.
/// Pixels filled less than this show nothing.
pub(crate) const LEAST_ALPHA: f32 = 0.5;
/// A surface goes on to the next pixel if their points are at most so many pixel footprints apart.
pub(crate) const GAP_FOOTPRINTS: f32 = 4.0;
/// How readily colours merge into one part (Felzenszwalb and Huttenlocher 2004, k, in units of L*a*b*).
pub(crate) const COLOUR_K: f32 = 60.0;
/// Least pixels of a thing, as a share of the picture.
pub(crate) const LEAST_SHARE: f64 = 0.0006;
/// Least pixels of a thing.
pub(crate) const LEAST_PX: usize = 10;
/// Most segments of a frame at a level, by pixels.
pub(crate) const MOST_SEGMENTS: usize = 70;
/// Most pixels of a thing, as a share of the picture: more is background.
pub(crate) const MOST_SHARE: f64 = 0.35;
/// A level surface is a support if it fills this share of the picture.
pub(crate) const SUPPORT_SHARE: f64 = 0.03;
/// Thickness of a support, as a share of the median depth.
pub(crate) const SUPPORT_THICKNESS: f64 = 0.012;
/// Something is in front of the background if it is nearer by this share of its depth.
pub(crate) const MOVING_SHARE: f32 = 0.015;
/// Least affinity with which a segment goes on with a track.
pub(crate) const LINK_AFFINITY: f64 = 0.2;
/// Speed with which things may move between frames, lengths per second.
pub(crate) const LINK_SPEED: f64 = 2.0;
/// Two tracks whose masks have this IoU are one.
pub(crate) const SAME_IOU: f64 = 0.8;
/// Most things of a clip, by pixels.
pub(crate) const MOST_TRACKS: usize = 140;
/// Median depth up to which a scene is a tabletop, and up to which it is a room; metres.
pub(crate) const SCALE_DEPTH_M: [f64; 2] = [1.7, 5.0];

// Reasoning.
/// How fast a size outside the usual range speaks against a kind: standard deviation of its logarithm.
pub(crate) const SIZE_DEVIATION: f64 = 0.3;
/// What something that never moves is worth as something alive.
pub(crate) const LIFELESS: f64 = 0.3;
/// What something that neither moves nor stands on anything level is worth.
pub(crate) const UNSUPPORTED: f64 = 0.5;
/// It stands if its bottom is off a level by this share of its height.
pub(crate) const STAND_SHARE: f64 = 0.3;
/// What is farther from where things happen than this many times their spread hardly counts.
pub(crate) const FOCUS_REACH: f64 = 3.0;
/// How sharply it counts less beyond.
pub(crate) const FOCUS_POWER: f64 = 4.0;
/// Least spread of where things happen, as a share of its distance from the camera.
pub(crate) const FOCUS_SHARE: f64 = 0.15;
/// How much a piece of a thing is worth less than the thing: power of the closed share of its outline.
pub(crate) const CLOSED_POWER: f64 = 2.0;
/// What being cut by the border of the picture all the time costs something lifeless.
pub(crate) const CUT_COST: f64 = 0.5;
/// How much something thin or ragged is worth less: power of the share of its bounding box that it fills.
pub(crate) const FILL_POWER: f64 = 0.5;
/// How much something without its like is worth less, as one of whom there are several.
pub(crate) const ALIKE_POWER: f64 = 0.3;
/// How much something that is rarely seen is worth less: power of the share of frames in which it is.
pub(crate) const SEEN_POWER: f64 = 0.3;
/// Things of a kind are those that fit it at least this well, as a share of the best fit.
pub(crate) const KIND_SHARE: f64 = 0.4;
/// Colour distance (CIE 1976) at which something is hardly of a colour any more.
pub(crate) const COLOUR_DEVIATION: f64 = 18.0;
/// Worth of a clause that fails altogether, so that one mistake of perception doesn't decide alone.
pub(crate) const FLOOR: f64 = 0.05;
/// Least score of an answer; below it the thing is absent.
pub(crate) const LEAST_SCORE: f64 = 0.02;
/// A plural takes what scores at least this share of the best.
pub(crate) const PLURAL_SHARE: f64 = 0.6;
/// A gate is open where the clause scores at least this share of its best.
pub(crate) const GATE_SHARE: f64 = 0.5;
/// Contact fades over so many footprints.
pub(crate) const CONTACT_FOOTPRINTS: f64 = 4.0;
/// Distances are taken to members of a party that are at least this sure, as a share of the surest.
pub(crate) const SURE_SHARE: f64 = 0.5;
/// Grades of what happens are stretched until the best is 1, at most by this factor.
pub(crate) const MOST_STRETCH: f64 = 3.0;
/// What the motion of one alone is worth as a sign that two act on each other.
pub(crate) const ALONE_SHARE: f64 = 0.4;
/// Most others that a party may mean.
pub(crate) const MOST_MEMBERS: usize = 8;
/// Speed of something that travels, lengths per second.
pub(crate) const TRAVEL_SPEED: f64 = 0.25;
/// Speed of something that runs, metres per second.
pub(crate) const DASH_SPEED_M: f64 = 1.2;
/// Share of the silhouette that changes from frame to frame of something that stirs.
pub(crate) const STIR_SHARE: f64 = 0.08;
