//! From a folder of scores to a [`Board`]. Every file is read once: `summary.json` of all methods says what was scored and
//! gives the order, then `counts.csv` of each method of the board gives its numbers, with which the summary must agree.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::published::{Metric as PublishedMetric, Published};
use l4d_data::results::Track;
use l4d_data::store::list_folder;
use l4d_data::{DataError, Name, QueryId, Report, Role, Status};
use l4d_score::compare::Pair;
use l4d_score::counts::{self, FrameCount, Rows, State};
use l4d_score::eval_set::EvalScene;
use l4d_score::metrics::{QueryTally, taken};
use l4d_score::score::{counts_path, summary_path};
use l4d_score::{
    Breakdown, Estimate, EvalSet, GroupKind, Metric, Metrics, Missing, Options, QuerySet, Summary, all_pairs,
    groups,
};
use rayon::prelude::*;

use crate::board::{
    Answer, Board, BoardQuery, BoardScene, COMPARED, Choice, Comparisons, Heading, MOST_COMPARED,
    MOST_DETAILED, Method, PublishedRow, PublishedTable, SCHEMA, ScoredOn, Thing,
};
use crate::codes;
use crate::day;
use crate::error::BoardError;
use crate::protocols::gather_protocols;
use crate::ranking::arrange;

/// Tables of `benchmark/published`, in the order of the page.
const PUBLISHED: [&str; 7] = ["panoptic_l4d", "neu3d", "composites", "scales", "mvsc", "views", "vlm"];

/// Reads `scores/<method>/` of every method and makes the board of `eval_set`, with what was odd among the scores. `seed` is
/// that of the draws behind intervals.
///
/// # Errors
/// No scores, none of this set, and files that are damaged or contradict each other.
pub fn gather(scores: &Path, eval_set: &EvalSet, seed: u64) -> Result<(Board, Report), BoardError> {
    let mut report = Report::default();
    let summaries = read_summaries(scores, &mut report)?;
    let (heading, options) = heading(eval_set, &summaries);
    let all_options: BTreeMap<Name, Options> =
        summaries.iter().map(|summary| (summary.name.clone(), summary.options)).collect();
    let methods = summaries.into_iter().map(method).collect();
    let (mut methods, foreign) = arrange(&heading, methods)?;
    for method in foreign {
        let message = format!("was scored on {}", method.on.line());
        let hint = "it is left out here; score it again, or choose its --profile";
        report.warning(codes::OTHER_BOARD, &summary_path(scores, &method.name), "", message, hint);
    }
    let scenes: Vec<BoardScene> = eval_set.scenes.iter().map(|scene| board_scene(scene, &options)).collect();
    let count = |(place, method): (usize, &mut Method)| {
        let source = Source { scores, eval_set, scenes: &scenes, seed, options: all_options[&method.name] };
        source.count(method, place)
    };
    let tallies: Vec<Vec<QueryTally>> =
        methods.par_iter_mut().enumerate().map(count).collect::<Result<_, BoardError>>()?;
    let comparisons = COMPARED.map(|metric| compare(metric, &methods, &tallies, &heading, seed)).into();
    let protocols = gather_protocols(scores, &methods, &scenes, eval_set, &mut report)?;
    let published = published(eval_set)?;
    let schema = SCHEMA.to_owned();
    let day = day::of_scores(scores, &methods);
    Ok((Board { schema, heading, methods, comparisons, scenes, protocols, published, day }, report))
}

fn read_summaries(scores: &Path, report: &mut Report) -> Result<Vec<Summary>, DataError> {
    let mut summaries = Vec::new();
    for entry in list_folder(scores)? {
        let folder = scores.join(&entry);
        if !folder.is_dir() {
            continue;
        }
        let path = summary_path(scores, &entry);
        if !path.exists() {
            let message = "holds no summary.json, so it is left out";
            let hint = "run `l4d score`, or remove the folder";
            report.warning(codes::NOT_SCORED, &folder, "", message, hint);
            continue;
        }
        let summary = Summary::read(&path)?;
        let again = "run `l4d score` again";
        if summary.name.as_str() != entry {
            let message = format!("is `{}`, but the folder is `{entry}`", summary.name);
            return Err(DataError::invalid(&path, "field `name`", message, again));
        }
        if let Some((field, value)) = impossible(&summary) {
            let message = format!("is {value}, which no score can be");
            return Err(DataError::invalid(&path, format!("field `{field}`"), message, again));
        }
        summaries.push(summary);
    }
    Ok(summaries)
}

/// A percentage that is none, or a time that is none.
fn impossible(summary: &Summary) -> Option<(String, f64)> {
    let Breakdown { headline, categories, scales, scenes, averages } = &summary.scores;
    let named = |name: String, metrics: &Metrics| (name, *metrics);
    let tables = std::iter::once(named(String::new(), headline))
        .chain(
            categories.iter().map(|(key, metrics)| named(format!("categories.{}.", key.as_str()), metrics)),
        )
        .chain(scales.iter().map(|(key, metrics)| named(format!("scales.{}.", key.as_str()), metrics)))
        .chain(scenes.iter().map(|(key, metrics)| named(format!("scenes.{key}."), metrics)))
        .chain(averages.iter().map(|(key, metrics)| named(format!("averages.{key:?}."), metrics)));
    let numbers = tables.flat_map(|(name, metrics)| {
        Metric::ALL.map(|metric| (format!("{name}{}", metric.key()), metrics.get(metric)))
    });
    // A mean of ones times a hundred may miss 100 by a rounding step.
    let is_percentage = |value: f64| (0.0..=100.0 + 1e-6).contains(&value);
    let mut numbers = numbers.filter_map(|(field, value)| Some((field, value?)));
    let seconds = summary.seconds.filter(|seconds| !(seconds.is_finite() && *seconds >= 0.0));
    numbers.find(|(_, value)| !is_percentage(*value)).or(seconds.map(|value| ("seconds".to_owned(), value)))
}

fn is_of_eval_set(summary: &Summary, eval_set: &EvalSet) -> bool {
    summary.set == eval_set.set
        && summary.profile == eval_set.profile
        && summary.benchmark_version == eval_set.bench.manifest.version
        && summary.truth_digest == eval_set.truth_digest
}

/// The board is of the protocol and options that most methods were scored with, among equals the plainest.
fn heading(eval_set: &EvalSet, summaries: &[Summary]) -> (Heading, Options) {
    let mut votes: BTreeMap<String, (usize, Options)> = BTreeMap::new();
    for summary in summaries.iter().filter(|summary| is_of_eval_set(summary, eval_set)) {
        votes.entry(protocol(summary)).or_insert((0, summary.options)).0 += 1;
    }
    let most = votes.values().map(|(count, _)| *count).max();
    let chosen = votes.into_iter().find(|(_, (count, _))| Some(*count) == most);
    let (protocol, (_, options)) =
        chosen.unwrap_or_else(|| (l4d_score::results::PROTOCOL.to_owned(), (0, Options::default())));
    let asked =
        || eval_set.scenes.iter().flat_map(|scene| &scene.queries).filter(|query| options.takes(query));
    let has_any = |scene: &&EvalScene| scene.queries.iter().any(|query| options.takes(query));
    let heading = Heading {
        benchmark: eval_set.bench.manifest.name.clone(),
        on: ScoredOn {
            profile: eval_set.profile,
            protocol,
            benchmark_version: eval_set.bench.manifest.version.clone(),
            truth_digest: eval_set.truth_digest.clone(),
        },
        queries: asked().count(),
        scenes: eval_set.scenes.iter().filter(has_any).count(),
        verified: asked().filter(|query| query.status == Status::Verified).count(),
        rejected: eval_set.rejected(),
    };
    (heading, options)
}

/// The protocol with the options that make its numbers incomparable with others.
fn protocol(summary: &Summary) -> String {
    let mut label = summary.protocol.clone();
    if summary.options.hit_iou != 0.0 {
        label.push_str(&format!(" with hits above IoU {}", summary.options.hit_iou));
    }
    if summary.set != QuerySet::default() {
        label.push_str(&format!(" on {}", summary.set.as_str()));
    }
    if summary.options.verified_only {
        label.push_str(" on verified queries only");
    }
    label
}

/// What a summary says of a method.
fn method(summary: Summary) -> Method {
    Method {
        on: ScoredOn {
            profile: summary.profile,
            protocol: protocol(&summary),
            benchmark_version: summary.benchmark_version.clone(),
            truth_digest: summary.truth_digest.clone(),
        },
        track: summary.used.track(),
        rank: None,
        unranked_because: summary.unranked_because().into_iter().map(str::to_owned).collect(),
        name: summary.name,
        version: summary.version,
        link: summary.link,
        partial: summary.partial,
        seconds: summary.seconds,
        asked: summary.asked_queries,
        resize: summary.options.resize,
        scores: summary.scores,
        reported: summary.reported,
        miou: None,
        groups: Vec::new(),
        iou_of_frames: BTreeMap::new(),
        answers: Vec::new(),
        choices: BTreeMap::new(),
    }
}

pub(crate) fn board_scene(scene: &EvalScene, options: &Options) -> BoardScene {
    let things = scene.truth.instances.iter().map(|instance| Thing {
        category: instance.category.clone(),
        name: instance.name.clone(),
        role: instance.role,
    });
    let (width, height) = scene.size;
    BoardScene {
        name: scene.name.clone(),
        scale: scene.scale,
        width,
        height,
        clip: scene.clip.clone(),
        unannotated: scene.unannotated.clone(),
        queries: scene.queries.iter().filter(|query| options.takes(query)).map(BoardQuery::from).collect(),
        things: things.collect(),
    }
}

/// Where the numbers of a method come from.
pub(crate) struct Source<'a> {
    pub(crate) scores: &'a Path,
    pub(crate) eval_set: &'a EvalSet,
    pub(crate) scenes: &'a [BoardScene],
    pub(crate) seed: u64,
    pub(crate) options: Options,
}

/// What `counts.csv` says of a method.
pub(crate) struct Counted {
    /// In the order of the board's queries.
    tallies: Vec<QueryTally>,
    /// In the same order, where they were asked for.
    pub(crate) answers: Vec<Answer>,
    frames: FrameIous,
    /// What contradicts the benchmark.
    problem: Option<String>,
}

/// Of each canonical frame the sum of the IoUs that count, percent, and how many they are. A sum goes along with the rows,
/// so that no table of a method is held while many are read.
#[derive(Default)]
struct FrameIous(BTreeMap<u32, (f64, u32)>);

impl Source<'_> {
    /// Fills in what `counts.csv` says of the method at a place of the board; gives its tallies if it is compared.
    fn count(&self, method: &mut Method, place: usize) -> Result<Vec<QueryTally>, BoardError> {
        let path = counts_path(self.scores, &method.name);
        let Counted { tallies, answers, frames, problem } =
            self.counted(counts::by_query(Rows::open(&path)?), place < MOST_DETAILED)?;
        let contradicts =
            |message: String| DataError::invalid(&path, "rows", message, "run `l4d score` again");
        // A method that was scored on other scenes cannot be derived from the queries of these.
        if method.asked == tallies.len() {
            let derived = Breakdown::of(&tallies);
            if !agree(&derived, &method.scores) {
                let message = "the numbers of summary.json do not follow from these rows";
                return Err(contradicts(message.to_owned()).into());
            }
            method.scores = derived;
        }
        if let Some(problem) = problem {
            return Err(contradicts(problem).into());
        }
        method.miou = Estimate::of_ratio(&tallies, |ratios| ratios.miou, self.seed);
        method.iou_of_frames = frames.means();
        if place < MOST_DETAILED {
            method.groups = groups(&tallies, self.eval_set, |kind| has_group(kind, place), self.seed);
            fill(method, answers);
        }
        Ok(if place < MOST_COMPARED { tallies } else { Vec::new() })
    }

    /// Adds up rows, query by query; says what the method did in each query if the answers are `wanted`.
    pub(crate) fn counted(
        &self,
        blocks: impl Iterator<Item = Result<Vec<FrameCount>, DataError>>,
        wanted: bool,
    ) -> Result<Counted, DataError> {
        let asked: Vec<(&BoardScene, &BoardQuery)> = self
            .scenes
            .iter()
            .flat_map(|scene| scene.queries.iter().map(move |query| (scene, query)))
            .collect();
        let places: BTreeMap<&QueryId, usize> =
            asked.iter().enumerate().map(|(place, (_, query))| (&query.id, place)).collect();
        let mut frames = FrameIous::default();
        let mut problem = None;
        let mut found: Vec<Option<(QueryTally, Option<Answer>)>> = asked.iter().map(|_| None).collect();
        for block in blocks {
            let block = block?;
            block.iter().for_each(|row| frames.add(row, &self.options));
            let Some(&place) = places.get(&block[0].query) else { continue };
            let (scene, query) = asked[place];
            if found[place].is_some() {
                problem.get_or_insert_with(|| format!("those of query {} are not together", query.id));
            } else if wanted && block.iter().map(|row| row.frame).ne(scene.clip.iter().copied()) {
                problem.get_or_insert_with(|| {
                    format!("query {} has not one row per frame of its clip", query.id)
                });
            }
            found[place] = Some(self.of_query(scene, query, &block, wanted));
        }
        let or_nothing = |(found, (scene, query)): (Option<_>, (&BoardScene, &BoardQuery))| {
            found.unwrap_or_else(|| self.of_query(scene, query, &[], wanted))
        };
        let (tallies, answers): (Vec<QueryTally>, Vec<Option<Answer>>) =
            found.into_iter().zip(asked).map(or_nothing).unzip();
        Ok(Counted { tallies, answers: answers.into_iter().flatten().collect(), frames, problem })
    }

    fn of_query(
        &self,
        scene: &BoardScene,
        query: &BoardQuery,
        rows: &[FrameCount],
        wanted: bool,
    ) -> (QueryTally, Option<Answer>) {
        let tally = QueryTally::of(query.facts(scene.scale), rows, &self.options);
        let answer = wanted.then(|| answer(scene, query, &tally, rows));
        (tally, answer)
    }
}

/// Adds what a method did query by query.
pub(crate) fn fill(method: &mut Method, answers: Vec<Answer>) {
    for choice in answers.iter().filter_map(|answer| answer.choice) {
        *method.choices.entry(choice).or_default() += 1;
    }
    method.answers = answers;
}

impl FrameIous {
    fn add(&mut self, count: &FrameCount, options: &Options) {
        let is_counted = match count.state {
            State::NotAnnotated => false,
            State::Missing => options.missing != Missing::Skip && count.union > 0,
            _ => count.union > 0,
        };
        if is_counted {
            let (sum, counted) = self.0.entry(count.frame).or_default();
            *sum += 100.0 * count.intersection as f64 / count.union as f64;
            *counted += 1;
        }
    }

    /// Canonical frame -> mean IoU, percent, over the queries with a true or predicted pixel there; a false alarm counts 0.
    fn means(self) -> BTreeMap<u32, f64> {
        self.0.into_iter().map(|(frame, (sum, counted))| (frame, sum / f64::from(counted))).collect()
    }
}

/// Single queries are groups of which [`Method::answers`] say everything.
fn has_group(kind: GroupKind, place: usize) -> bool {
    match kind {
        GroupKind::Query => false,
        GroupKind::All | GroupKind::Category | GroupKind::Scale | GroupKind::ScaleCategory => true,
        _ => place < MOST_COMPARED,
    }
}

fn answer(scene: &BoardScene, query: &BoardQuery, tally: &QueryTally, rows: &[FrameCount]) -> Answer {
    let ratios = tally.ratios();
    let taken = taken(&query.referents, rows).cloned();
    let column = |value: fn(&FrameCount) -> u64| rows.iter().map(value).collect();
    let missing = rows.iter().enumerate().filter(|(_, row)| row.state == State::Missing);
    Answer {
        choice: ratios.select.map(|selected| choice(scene, query, taken.as_ref(), selected > 0.5)),
        ratios,
        taken,
        intersection: column(|row| row.intersection),
        union: column(|row| row.union),
        predicted: column(|row| row.predicted),
        missing: missing.map(|(position, _)| position).collect(),
    }
}

fn choice(scene: &BoardScene, query: &BoardQuery, taken: Option<&Name>, is_selected: bool) -> Choice {
    let Some(taken) = taken else { return Choice::Nothing };
    if query.referents.contains(taken) {
        return if is_selected { Choice::Meant } else { Choice::Tied };
    }
    let thing = |name: &Name| scene.things.iter().find(|thing| thing.name == *name);
    let mut meant = query.referents.iter().filter_map(thing);
    match thing(taken) {
        Some(found) if found.role == Role::Landmark => Choice::Landmark,
        Some(found) if meant.any(|referent| referent.category == found.category) => Choice::LookAlike,
        _ => Choice::OtherObject,
    }
}

fn agree(derived: &Breakdown, told: &Breakdown) -> bool {
    let same = |metric: &Metric| match (derived.headline.get(*metric), told.headline.get(*metric)) {
        (Some(derived), Some(told)) => (derived - told).abs() < 1e-6,
        (derived, told) => derived == told,
    };
    derived.headline.queries == told.headline.queries && Metric::ALL.iter().all(same)
}

/// All pairs of complete methods of each track.
fn compare(
    metric: Metric,
    methods: &[Method],
    tallies: &[Vec<QueryTally>],
    heading: &Heading,
    seed: u64,
) -> Comparisons {
    let of_track = |track: Track| -> Vec<Pair> {
        let is_rival = |&index: &usize| methods[index].track == track && methods[index].is_complete(heading);
        let rivals: Vec<usize> = (0..methods.len().min(MOST_COMPARED)).filter(is_rival).collect();
        let compared: Vec<&[QueryTally]> = rivals.iter().map(|&index| tallies[index].as_slice()).collect();
        let mut pairs = all_pairs(&compared, |ratios| ratios.get(metric), seed);
        for pair in &mut pairs {
            (pair.first, pair.second) = (rivals[pair.first], rivals[pair.second]);
        }
        pairs
    };
    Comparisons { metric, pairs: Track::ALL.into_iter().flat_map(of_track).collect() }
}

/// The tables of papers that the benchmark has.
fn published(eval_set: &EvalSet) -> Result<Vec<PublishedTable>, DataError> {
    let mut tables = Vec::new();
    for name in PUBLISHED {
        let path = eval_set.bench.dir.published(name);
        if !path.exists() {
            continue;
        }
        let table = Published::read(&path)?;
        let columns = table.columns();
        let row = |setting: &&str| PublishedRow {
            setting: (*setting).to_owned(),
            values: columns
                .iter()
                .map(|column| {
                    [PublishedMetric::Macc, PublishedMetric::Miou]
                        .map(|metric| table.value(setting, column, metric))
                })
                .collect(),
        };
        let rows = table.settings().iter().map(row).collect();
        let columns = columns.iter().map(|column| (*column).to_owned()).collect();
        tables.push(PublishedTable { name: name.to_owned(), columns, rows });
    }
    Ok(tables)
}
