//! The published document, `board.json`: everything that the tables, the figures and the page show.
//!
//! [`crate::gather`] makes it from the scores; every renderer is a pure function of it.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::results::Track;
use l4d_data::{
    Category, DataError, Interval, Name, Profile, Query, QueryId, Role, Scale, Status, Temporal, json,
};
use l4d_score::compare::Pair;
use l4d_score::counts::State;
use l4d_score::metrics::{QueryFacts, Ratios};
use l4d_score::{Breakdown, Estimate, Group, GroupKind, Metric};
use serde::{Deserialize, Serialize};

use crate::protocols::ProtocolTable;

/// Schema tag of the document.
pub const SCHEMA: &str = "l4d/board/2";
/// Methods that are compared pair by pair, and whose groups are in `groups.csv`: those that come first.
pub const MOST_COMPARED: usize = 50;
/// Methods whose answers are kept query by query: those that come first.
pub const MOST_DETAILED: usize = 200;
/// Metrics by which methods are compared; p values are corrected within each.
pub const COMPARED: [Metric; 3] = [Metric::Miou, Metric::TubeIou, Metric::Select];

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Board {
    /// [`SCHEMA`].
    pub schema: String,
    /// What it is a board of.
    pub heading: Heading,
    /// Ranked methods by track, the headline track first, best first; then the unranked ones, best first.
    pub methods: Vec<Method>,
    /// One entry per metric of [`COMPARED`].
    pub comparisons: Vec<Comparisons>,
    /// What is asked.
    pub scenes: Vec<BoardScene>,
    /// The same masks under the protocols of other evaluations; never ranked.
    pub protocols: Vec<ProtocolTable>,
    /// What papers report of their own data.
    pub published: Vec<PublishedTable>,
    /// The day of its newest numbers, for the page; no part of the document, which does not change with its files.
    #[serde(skip)]
    pub day: Option<String>,
}

/// What numbers must share to be comparable.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ScoredOn {
    /// Profile of truth and masks.
    pub profile: Profile,
    /// Scoring protocol with the options that change numbers.
    pub protocol: String,
    /// Version of the benchmark.
    pub benchmark_version: String,
    /// Digest of its truth.
    pub truth_digest: String,
}

impl ScoredOn {
    /// `benchmark 0.9.0 · protocol l4d · profile tiny · truth 3f2a91c0`.
    pub(crate) fn line(&self) -> String {
        let Self { profile, protocol, benchmark_version, truth_digest } = self;
        let truth: String = truth_digest.chars().take(8).collect();
        format!("benchmark {benchmark_version} · protocol {protocol} · profile {profile} · truth {truth}")
    }
}

/// What every table and figure says about itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Heading {
    /// Title of the benchmark.
    pub benchmark: String,
    /// Profile, protocol, version and truth.
    #[serde(flatten)]
    pub on: ScoredOn,
    /// Queries that a complete method answers.
    pub queries: usize,
    /// Scenes that they are of.
    pub scenes: usize,
    /// How many of the queries people have verified.
    pub verified: usize,
    /// Queries that are not asked, because people rejected them.
    pub rejected: usize,
}

impl Heading {
    /// `Panoptic-L4D 1.0.0 · protocol l4d · profile small · 281 queries, 281 verified by people, 8 rejected`.
    pub fn line(&self) -> String {
        let Self { benchmark, on, queries, verified, rejected, .. } = self;
        let ScoredOn { profile, protocol, benchmark_version, .. } = on;
        let noun = if *queries == 1 { "query" } else { "queries" };
        let left_out = if *rejected == 0 { String::new() } else { format!(", {rejected} rejected") };
        format!(
            "{benchmark} {benchmark_version} · protocol {protocol} · profile {profile} · {queries} {noun}, {verified} verified by people{left_out}"
        )
    }
}

/// One scored method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Method {
    pub name: Name,
    /// Its version.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// What it was scored on.
    pub on: ScoredOn,
    /// With which methods it is ranked, if at all.
    pub track: Track,
    /// From 1 in each track; equal headlines share it, and the next rank counts them all ("1 1 3").
    pub rank: Option<usize>,
    /// Why it has no rank; empty for ranked methods.
    pub unranked_because: Vec<String>,
    /// Some answers were missing and skipped.
    pub partial: bool,
    /// Wall seconds for all queries, as the method reports them.
    pub seconds: Option<f64>,
    /// Queries that it was asked.
    pub asked: usize,
    /// Whether masks of another size were resized.
    pub resize: bool,
    /// Its numbers, percent: headline, by group, other averages.
    pub scores: Breakdown,
    /// mIoU with its interval; none without a query that has one.
    pub miou: Option<Estimate>,
    /// Numbers that the method reports of itself, by name; never ranked.
    pub reported: BTreeMap<String, f64>,
    /// Numbers with intervals of groups of queries, single queries excepted. Of the first [`MOST_COMPARED`] methods all
    /// kinds, of the first [`MOST_DETAILED`] those that the page filters by.
    pub groups: Vec<Group>,
    /// Canonical frame -> mean IoU, percent, over the queries with a true or predicted pixel in that frame.
    pub iou_of_frames: BTreeMap<u32, f64>,
    /// One entry per query of [`Board::scenes`]; of the first [`MOST_DETAILED`] methods.
    pub answers: Vec<Answer>,
    /// Number of queries by what was taken for the referent.
    pub choices: BTreeMap<Choice, usize>,
}

impl Method {
    /// The headline number, percent.
    pub fn headline(&self, metric: Metric) -> Option<f64> {
        self.scores.headline.get(metric)
    }

    /// Whether it answered exactly what the board asks, so that it can be compared.
    pub fn is_complete(&self, heading: &Heading) -> bool {
        !self.partial && self.asked == heading.queries
    }

    /// Why it is not ranked, as one phrase.
    pub fn why_unranked(&self) -> String {
        self.unranked_because.join(", ")
    }

    /// The track in which it is ranked; none without a rank.
    pub(crate) fn ranked_in(&self) -> Option<Track> {
        self.rank.map(|_| self.track)
    }

    /// A group of queries.
    pub(crate) fn group(&self, kind: GroupKind, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.kind == kind && group.name == name)
    }
}

/// The answer of a method to one query.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// 0 to 1.
    pub ratios: Ratios,
    /// The instance that the prediction overlaps most over the clip: the choice that `select` judges.
    pub taken: Option<Name>,
    /// What that instance is to the query; none where the target is never visible.
    pub choice: Option<Choice>,
    /// Pixels that prediction and truth share, by frame of the clip. Empty, as the two below, where the scene was not
    /// scored.
    pub intersection: Vec<u64>,
    /// Pixels in either, by frame of the clip.
    pub union: Vec<u64>,
    /// Pixels of the prediction, by frame of the clip.
    pub predicted: Vec<u64>,
    /// Positions in the clip without an answer.
    pub missing: Vec<usize>,
}

impl Answer {
    /// What happened at a position of the clip.
    pub(crate) fn state(&self, scene: &BoardScene, position: usize) -> State {
        let [intersection, union, predicted] =
            [&self.intersection, &self.union, &self.predicted].map(|pixels| pixels[position]);
        match (union + intersection > predicted, intersection > 0) {
            _ if scene.unannotated.contains(&scene.clip[position]) => State::NotAnnotated,
            _ if self.missing.contains(&position) => State::Missing,
            (true, true) => State::Hit,
            (true, false) => State::Miss,
            (false, _) if predicted > 0 => State::FalseAlarm,
            (false, _) => State::TrueAbsent,
        }
    }

    /// 0 to 1; none where there is nothing to find and nothing was found.
    pub(crate) fn iou(&self, position: usize) -> Option<f64> {
        let union = self.union[position];
        (union > 0).then(|| self.intersection[position] as f64 / union as f64)
    }
}

/// What the instance that a prediction overlaps most is to the query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Choice {
    /// A referent, and nothing else is overlapped as much.
    Meant,
    /// A referent, and something else is overlapped as much.
    Tied,
    /// Another object of the category of a referent.
    LookAlike,
    /// An object of another category.
    OtherObject,
    /// A landmark, which is never a referent.
    Landmark,
    /// Nothing annotated is overlapped, or nothing was marked.
    Nothing,
}

impl Choice {
    /// In the order of bars and columns.
    pub const ALL: [Self; 6] =
        [Self::Meant, Self::Tied, Self::LookAlike, Self::OtherObject, Self::Landmark, Self::Nothing];

    /// Name in files.
    pub fn key(self) -> &'static str {
        match self {
            Self::Meant => "meant",
            Self::Tied => "tied",
            Self::LookAlike => "look_alike",
            Self::OtherObject => "other_object",
            Self::Landmark => "landmark",
            Self::Nothing => "nothing",
        }
    }
}

/// An instance of a scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thing {
    pub category: String,
    pub name: Name,
    /// Object or landmark.
    pub role: Role,
}

/// The queries of a scene that are scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoardScene {
    pub name: Name,
    /// Its spatial scale.
    pub scale: Scale,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Canonical frames, ascending.
    pub clip: Vec<u32>,
    /// Those of them without truth.
    pub unannotated: Vec<u32>,
    /// In the order of the benchmark.
    pub queries: Vec<BoardQuery>,
    pub things: Vec<Thing>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoardQuery {
    pub id: QueryId,
    pub text: String,
    /// One category, or two.
    pub categories: Vec<Category>,
    /// The instances meant.
    pub referents: Vec<Name>,
    /// How the sentence binds time.
    pub temporal: Temporal,
    /// When it holds.
    pub frames: Vec<Interval>,
    /// Whether people verified it.
    pub verified: bool,
}

impl From<&Query> for BoardQuery {
    fn from(query: &Query) -> Self {
        Self {
            id: query.id.clone(),
            text: query.text.clone(),
            categories: query.categories.clone(),
            referents: query.referents.clone(),
            temporal: query.temporal,
            frames: query.frames.clone(),
            verified: query.status == Status::Verified,
        }
    }
}

impl BoardQuery {
    /// What the metrics must know of it, in a scene of some scale.
    pub(crate) fn facts(&self, scale: Scale) -> QueryFacts {
        QueryFacts {
            id: self.id.clone(),
            categories: self.categories.clone(),
            scale,
            referents: self.referents.clone(),
            verified: self.verified,
        }
    }
}

/// All pairs of complete methods of a track by one metric; p values are corrected for those of the track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparisons {
    pub metric: Metric,
    /// By track. `first` and `second` index [`Board::methods`].
    pub pairs: Vec<Pair>,
}

/// A table that a paper prints, of its own data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PublishedTable {
    /// File stem in `benchmark/published`.
    pub name: String,
    /// Kinds of queries.
    pub columns: Vec<String>,
    /// The printed rows.
    pub rows: Vec<PublishedRow>,
}

/// A printed row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PublishedRow {
    /// A method, a model, a number of views.
    pub setting: String,
    /// mAcc and mIoU of each column, percent.
    pub values: Vec<[Option<f64>; 2]>,
}

impl Board {
    /// Reads a document.
    ///
    /// # Errors
    /// Files that are no board, or of another schema.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let board: Self = json::read(path)?;
        if board.schema != SCHEMA {
            let message = format!("is `{}`, but this l4d reads `{SCHEMA}`", board.schema);
            return Err(DataError::invalid(path, "field `schema`", message, "run `l4d leaderboard` again"));
        }
        Ok(board)
    }

    /// The methods that compete.
    pub fn ranked(&self) -> &[Method] {
        &self.methods[..self.methods.partition_point(|method| method.rank.is_some())]
    }

    /// The methods that are shown for scale.
    pub fn unranked(&self) -> &[Method] {
        &self.methods[self.ranked().len()..]
    }

    /// The ranked methods of each track that has any.
    pub fn tracks(&self) -> impl Iterator<Item = (Track, &[Method])> {
        let alike = |a: &Method, b: &Method| a.track == b.track;
        self.ranked().chunk_by(alike).map(|methods| (methods[0].track, methods))
    }

    /// The methods that have groups and comparisons.
    pub fn compared(&self) -> &[Method] {
        &self.methods[..self.methods.len().min(MOST_COMPARED)]
    }

    /// All queries with their scene, in the order of [`Method::answers`].
    pub(crate) fn queries(&self) -> impl Iterator<Item = (&BoardScene, &BoardQuery)> {
        self.scenes.iter().flat_map(|scene| scene.queries.iter().map(move |query| (scene, query)))
    }

    /// The pairs by which the board is ranked.
    pub(crate) fn headline_pairs(&self) -> &[Pair] {
        let found = self.comparisons.iter().find(|found| found.metric == Metric::ALL[0]);
        found.map_or(&[], |found| &found.pairs)
    }

    /// Of the headline pairs those of methods that follow each other: ranked ones among themselves, and unranked ones.
    pub(crate) fn neighbours(&self) -> Vec<&Pair> {
        let is_ranked = |index: usize| self.methods[index].rank.is_some();
        let alike =
            self.headline_pairs().iter().filter(|pair| is_ranked(pair.first) == is_ranked(pair.second));
        let mut previous: Option<usize> = None;
        alike.filter(|pair| previous.replace(pair.first) != Some(pair.first)).collect()
    }

    /// Whether nothing on it says how much scenes differ: then it has no intervals and no tests.
    pub(crate) fn is_of_one_scene(&self) -> bool {
        self.heading.scenes < 2
    }

    /// Whether some track has rivals, so that a method can be called best.
    pub(crate) fn has_rivals(&self) -> bool {
        !self.is_of_one_scene() && self.tracks().any(|(_, methods)| methods.len() > 1)
    }
}
