//! The queries of a scene from its tracks, or why it has too few.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use l4d_data::digest::sha256;
use l4d_data::layout::BenchDir;
use l4d_data::query::QueryIdError;
use l4d_data::tracks::Tracks;
use l4d_data::truth::Truth;
use l4d_data::{Category, DataError, Name, Query, QueryId, Report, Role, Severity, Temporal, json};
use l4d_query::Predicate;
use l4d_query::probes::Trial;
use l4d_query::prove::{Kind, Prover, SceneSet, check_scene, words};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::candidate::Candidate;
use crate::choose::{self, Entry};
use crate::enumerate::enumerate;
use crate::screen;
use crate::sentence;

/// Fewest single queries of a scene that is worth having.
pub const LEAST_QUERIES: usize = 8;

/// Fewest and most composites, and absent sentences, of a scene.
const COMPOSITES: [usize; 2] = [2, 4];
const ABSENTS: [usize; 2] = [1, 2];

/// All sound phrasings of a predicate, best first; none if it cannot be said.
pub type Say<'s> = &'s dyn Fn(&Predicate, Temporal) -> Vec<String>;

/// What is wanted beside the scene itself.
#[derive(Debug, Clone, Copy)]
pub struct QueriesRequest<'o> {
    /// Seed of every draw.
    pub seed: u64,
    /// Sentences that are not to be used, as [`l4d_query::prove::words`] joined by blanks.
    pub avoid: &'o BTreeSet<String>,
    /// What the held-out view sees, if that is known; else boxes tell it roughly.
    pub truth: Option<&'o Truth>,
}

/// The queries of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Composed {
    /// Of one category, numbered from 001.
    pub singles: Vec<Query>,
    /// Of two categories, numbered from 501.
    pub composites: Vec<Query>,
    /// Sentences that nothing satisfies, numbered from 901.
    pub absents: Vec<Query>,
}

/// Why a scene has no queries.
#[derive(Debug, thiserror::Error)]
pub enum Refused {
    /// It affords too few.
    #[error("scene `{scene}` affords {found} queries, but {LEAST_QUERIES} are the least: {}", short.join("; "))]
    TooFew {
        scene: Name,
        /// How many could be had.
        found: usize,
        /// What was short.
        short: Vec<String>,
    },
    /// The proof of the whole has a finding: tracks that contradict their events, or a mistake of this crate.
    #[error("scene `{scene}` is not proved: {code} at {place}: {message}")]
    Unproved {
        scene: Name,
        /// Of the first finding.
        code: &'static str,
        /// Which query or event.
        place: String,
        /// What is wrong.
        message: String,
    },
    /// More queries than numbers have digits.
    #[error(transparent)]
    Id(#[from] QueryIdError),
    /// A predicate that is no JSON.
    #[error("scene `{scene}`: a predicate cannot be written: {source}")]
    Unwritable { scene: Name, source: serde_json::Error },
}

/// The queries of a scene: a function of its tracks and the request alone.
///
/// # Errors
/// A scene that affords fewer than [`LEAST_QUERIES`], or whose tracks contradict themselves.
pub fn queries(tracks: &Tracks, request: &QueriesRequest<'_>, say: Say<'_>) -> Result<Composed, Refused> {
    let prover = Prover::new(tracks, request.truth, None);
    let boxes = if request.truth.is_none() { screen::seen(tracks) } else { None };
    let seen = request.truth.or(boxes.as_ref());
    let mut desk = Desk { prover: &prover, request, seen, say, said: BTreeSet::new() };
    let mut pools: BTreeMap<usize, Vec<Entry>> = BTreeMap::new();
    for candidate in enumerate(&prover).into_iter().filter(|candidate| desk.can_be_seen(candidate)) {
        let entry = desk.entry(candidate)?;
        pools.entry(entry.candidate.kind as usize).or_default().push(entry);
    }
    let mut random = desk.random("set");
    let mut pool = |kind: Kind| pools.remove(&(kind as usize)).unwrap_or_default();
    let [mut singles, mut composites, mut absents] =
        [Kind::Single, Kind::Composite, Kind::Absent].map(&mut pool);

    let chosen = desk.choose(&mut singles, &mut random)?;
    if chosen.len() < LEAST_QUERIES {
        let short = shortage(tracks, &singles);
        return Err(Refused::TooFew { scene: tracks.scene.clone(), found: chosen.len(), short });
    }
    let mut count = |[least, most]: [usize; 2]| random.random_range(least..=most);
    let (composite_count, absent_count) = (count(COMPOSITES), count(ABSENTS));
    let paired = desk.vary(&mut composites, composite_count, &mut random)?;
    let unmet = desk.vary(&mut absents, absent_count, &mut random)?;
    let composed = Composed {
        singles: desk.numbered(1, &singles, &chosen)?,
        composites: desk.numbered(501, &composites, &paired)?,
        absents: desk.numbered(901, &absents, &unmet)?,
    };
    prove(tracks, request.truth, &composed)?;
    Ok(composed)
}

/// Writes the queries of a scene into a benchmark folder.
///
/// # Errors
/// What the disk refuses.
pub fn write(bench: &BenchDir, scene: &Name, composed: &Composed) -> Result<(), DataError> {
    let Composed { singles, composites, absents } = composed;
    json::write_lines(&bench.queries(scene), singles)?;
    json::write_lines(&bench.composites(scene), composites)?;
    json::write_lines(&bench.absents(scene), absents)
}

/// What candidates are made into queries with.
struct Desk<'d, 'a> {
    prover: &'d Prover<'a>,
    request: &'d QueriesRequest<'d>,
    seen: Option<&'d Truth>,
    say: Say<'d>,
    /// Sentences of the scene so far.
    said: BTreeSet<String>,
}

impl Desk<'_, '_> {
    fn scene(&self) -> &Name {
        &self.prover.world().tracks().scene
    }

    /// A generator of its own for everything that is drawn, so that no draw depends on the others.
    fn random(&self, what: &str) -> ChaCha8Rng {
        ChaCha8Rng::from_seed(sha256(format!("{}/{}/{what}", self.request.seed, self.scene()).as_bytes()))
    }

    fn can_be_seen(&self, candidate: &Candidate) -> bool {
        let is_seen = |name: &Name| self.seen.is_none_or(|seen| screen::shows(seen, name));
        candidate.referent.as_ref().is_none_or(is_seen)
    }

    /// A candidate that has not been said yet: to shortcuts its text form is the sentence, whose colours are the same.
    fn entry(&self, candidate: Candidate) -> Result<Entry, Refused> {
        let above_chance = self.above_chance(&candidate, &candidate.predicate.to_string())?;
        Ok(Entry { candidate, text: None, above_chance })
    }

    fn above_chance(&self, candidate: &Candidate, text: &str) -> Result<Vec<f64>, Refused> {
        let query = self.query(candidate, text, 0)?;
        let trial = Trial::new(self.prover.world(), self.seen, &query, candidate.predicate.clone());
        Ok(trial.map_or_else(Vec::new, |trial| {
            let chance = trial.chance();
            trial.bounded().map(|(_, right)| right.map_or(0.0, |right| right - chance)).collect()
        }))
    }

    /// Says an entry in the phrasing that is drawn for it, unless it has been said; whether it can be.
    fn say(&mut self, entry: &mut Entry) -> Result<bool, Refused> {
        if entry.text.is_some() {
            return Ok(true);
        }
        let candidate = &entry.candidate;
        let mut random = self.random(&format!("{} {:?}", candidate.predicate, candidate.temporal));
        let forms = (self.say)(&candidate.predicate, candidate.temporal);
        let is_taken = |text: &str| self.request.avoid.contains(text) || self.said.contains(text);
        let Some(text) = sentence::draw(candidate, forms, is_taken, &mut random) else { return Ok(false) };
        self.said.insert(words(&text).join(" "));
        entry.above_chance = self.above_chance(candidate, &text)?;
        entry.text = Some(text);
        Ok(true)
    }

    /// The single queries: chosen, said, and chosen again without what cannot be said, until all of them can.
    fn choose(&mut self, pool: &mut Vec<Entry>, random: &mut ChaCha8Rng) -> Result<Vec<usize>, Refused> {
        let objects = self.prover.world().objects().count();
        let wanted = choose::wanted(objects, random);
        let mut chosen = Vec::new();
        loop {
            chosen = choose::singles(pool, wanted, chosen, random);
            let mut mute = BTreeSet::new();
            for &place in &chosen {
                if !self.say(&mut pool[place])? {
                    mute.insert(place);
                }
            }
            if mute.is_empty() {
                return Ok(chosen);
            }
            let moved = |place: &usize| place - mute.range(..place).count();
            chosen = chosen.iter().filter(|place| !mute.contains(place)).map(moved).collect();
            let mut places = 0..;
            pool.retain(|_| places.next().is_some_and(|place| !mute.contains(&place)));
        }
    }

    /// Up to `count` of the others, as they differ.
    fn vary(
        &mut self,
        pool: &mut [Entry],
        count: usize,
        random: &mut ChaCha8Rng,
    ) -> Result<Vec<usize>, Refused> {
        let whims: Vec<f64> = pool.iter().map(|_| random.random::<f64>()).collect();
        let mut left: Vec<usize> = (0..pool.len()).collect();
        let mut chosen = Vec::new();
        while chosen.len() < count
            && let Some(next) = choose::next_varied(pool, &chosen, &left, &whims)
        {
            left.retain(|place| *place != next);
            if self.say(&mut pool[next])? {
                chosen.push(next);
            }
        }
        Ok(chosen)
    }

    fn numbered(&self, first: usize, pool: &[Entry], chosen: &[usize]) -> Result<Vec<Query>, Refused> {
        let query = |(place, &index): (usize, &usize)| {
            let Entry { candidate, text, .. } = &pool[index];
            self.query(candidate, text.as_deref().unwrap_or_default(), first + place)
        };
        chosen.iter().enumerate().map(query).collect()
    }

    fn query(&self, candidate: &Candidate, text: &str, number: usize) -> Result<Query, Refused> {
        let id: QueryId = format!("{}/{number:03}", self.scene()).parse()?;
        let unwritable = |source| Refused::Unwritable { scene: self.scene().clone(), source };
        candidate.query(id, text).map_err(unwritable)
    }
}

/// What keeps a scene from having more queries.
fn shortage(tracks: &Tracks, singles: &[Entry]) -> Vec<String> {
    let mut short = Vec::new();
    for category in Category::ALL {
        let of = singles.iter().filter(|entry| entry.candidate.categories() == [category]).count();
        if of < 3 {
            short.push(format!("{of} predicates of category {} mean one object", category.as_str()));
        }
    }
    let objects = || tracks.instances.iter().filter(|instance| instance.role == Role::Object);
    for object in objects() {
        if objects().filter(|other| other.category == object.category).count() == 1 {
            short.push(format!("`{}` has no look-alike", object.name));
        } else if !singles.iter().any(|entry| entry.candidate.referent.as_ref() == Some(&object.name)) {
            short.push(format!("no predicate means `{}` alone", object.name));
        }
    }
    if short.is_empty() {
        short.push("too many predicates say the same of the same object".to_owned());
    }
    short
}

/// What `l4d check-queries` will say of the scene.
fn prove(tracks: &Tracks, truth: Option<&Truth>, composed: &Composed) -> Result<(), Refused> {
    let set = SceneSet {
        scene: tracks.scene.clone(),
        tracks: tracks.clone(),
        truth: truth.cloned(),
        queries: composed.singles.clone(),
        composites: composed.composites.clone(),
        absents: composed.absents.clone(),
        paths: [const { PathBuf::new() }; 4],
    };
    let mut report = Report::default();
    check_scene(&set, None, &mut report);
    let mut errors = report.into_sorted().into_iter().filter(|finding| finding.severity == Severity::Error);
    errors.next().map_or(Ok(()), |finding| {
        let (code, place, message) = (finding.code, finding.location, finding.message);
        Err(Refused::Unproved { scene: tracks.scene.clone(), code, place, message })
    })
}
