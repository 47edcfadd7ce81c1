//! What is asked: version, truth digest, profile, scenes and their queries.

use std::path::PathBuf;
use std::sync::Arc;

use l4d_data::benchmark::how_truth_is_made;
use l4d_data::truth::Truth;
use l4d_data::{Benchmark, DataError, Name, Profile, Query, QuerySet, Report, Scale, Status};
use rayon::prelude::*;

use crate::codes;
use crate::results::MOST_BYTES;
use crate::traits::Traits;
use crate::truth::SceneTruth;

/// The benchmark as seen by the judge, for one profile.
#[derive(Debug, Clone)]
pub struct EvalSet {
    /// Where everything is read from.
    pub bench: Benchmark,
    /// The profile whose truth counts.
    pub profile: Profile,
    /// Which sentences are asked.
    pub set: QuerySet,
    /// [`Benchmark::truth_digest`] of the profile.
    pub truth_digest: String,
    /// Canonical frames of a rendered clip, ascending; none for real scenes, which have their own.
    pub clip: Vec<u32>,
    /// The scenes asked about, in table order.
    pub scenes: Vec<EvalScene>,
    /// Bytes of masks that a method may have: [`MOST_BYTES`], unless the caller says otherwise.
    pub most_bytes: u64,
}

/// One scene of it.
#[derive(Debug, Clone)]
pub struct EvalScene {
    pub name: Name,
    /// Its spatial scale.
    pub scale: Scale,
    /// All its queries, rejected ones included.
    pub queries: Vec<Query>,
    /// How the targets of these queries look, in the same order.
    pub traits: Vec<Traits>,
    /// The file that they come from.
    pub queries_path: PathBuf,
    /// Numbers of the queries of the other sets: a method may answer them, and they are not judged here.
    pub not_asked: Vec<Name>,
    /// Frames that masks may be of, ascending.
    pub clip: Vec<u32>,
    /// Frames of the clip that nothing is known of, ascending: a method need not answer them.
    pub unannotated: Vec<u32>,
    /// Mask size, pixels.
    pub size: (u32, u32),
    /// What the held-out view sees, masks encoded.
    pub truth: Arc<Truth>,
}

impl EvalScene {
    /// None, and a finding, if a file is lacking and `may_lack` one.
    fn open(
        bench: &Benchmark,
        profile: Profile,
        set: QuerySet,
        name: Name,
        may_lack: bool,
    ) -> Result<(Option<Self>, Report), DataError> {
        let mut report = Report::default();
        let queries_path = bench.dir.asked(set, &name);
        let truth_path = bench.dir.truth(profile, &name);
        let lacking = [&truth_path, &queries_path].into_iter().find(|path| !path.exists());
        if let (Some(path), true) = (lacking, may_lack) {
            let message = format!("is not there, so scene {name} is left out");
            let hint = format!("{}, or write its queries", how_truth_is_made(profile, &name));
            report.warning(codes::SCENE_LEFT_OUT, path, "", message, hint);
            return Ok((None, report));
        }
        let queries = bench.asked(set, &name)?;
        let not_asked = not_asked(bench, &name, &queries)?;
        let truth = Arc::new(bench.truth(profile, &name)?);
        let scene = Self {
            scale: truth.scale,
            traits: queries.iter().map(|query| Traits::of(query, &truth)).collect(),
            queries,
            queries_path,
            not_asked,
            clip: truth.clip(),
            size: (truth.width, truth.height),
            unannotated: truth.unannotated.clone(),
            truth,
            name,
        };
        Ok((Some(scene), report))
    }

    /// Frames that have to be answered, ascending.
    pub fn asked(&self) -> impl Iterator<Item = u32> {
        self.clip.iter().copied().filter(|frame| self.unannotated.binary_search(frame).is_err())
    }
}

impl EvalSet {
    /// Reads what is asked about some scenes; none means all that have queries and truth, and those without are
    /// reported.
    ///
    /// # Errors
    /// Files of the benchmark that are damaged, unknown scenes, and no scene with queries and truth.
    pub fn open(
        bench: Benchmark,
        profile: Profile,
        set: QuerySet,
        wanted: &[String],
        report: &mut Report,
    ) -> Result<Self, DataError> {
        let truth_digest = bench.truth_digest(profile)?;
        let opened: Vec<Result<(Option<EvalScene>, Report), DataError>> = bench
            .select(wanted)?
            .into_par_iter()
            .map(|name| EvalScene::open(&bench, profile, set, name, wanted.is_empty()))
            .collect();
        let mut scenes = Vec::new();
        for opened in opened {
            let (scene, found) = opened?;
            report.extend(found);
            scenes.extend(scene);
        }
        if scenes.is_empty() {
            let message = format!("no scene has both {} and truth of profile {profile}", set.as_str());
            let hint = "choose another --profile or build the scenes";
            return Err(DataError::invalid(bench.root(), "folder", message, hint));
        }
        Ok(Self {
            truth_digest,
            clip: profile.frames().collect(),
            bench,
            profile,
            set,
            scenes,
            most_bytes: MOST_BYTES,
        })
    }

    /// The truth of a scene.
    pub fn truth(&self, scene: &EvalScene) -> SceneTruth {
        SceneTruth::of(&scene.truth)
    }

    /// Queries that people have rejected: never scored, but counted, so that a table can say what it lacks.
    pub fn rejected(&self) -> usize {
        let queries = self.scenes.iter().flat_map(|scene| &scene.queries);
        queries.filter(|query| query.status == Status::Rejected).count()
    }

    /// Mask size of a rendered scene, pixels; zeros for real scenes, which have their own.
    pub fn size(&self) -> (u32, u32) {
        (self.profile.width(), self.profile.height())
    }
}

fn not_asked(bench: &Benchmark, scene: &Name, asked: &[Query]) -> Result<Vec<Name>, DataError> {
    let all = [bench.queries(scene)?, bench.composites(scene)?, bench.absents(scene)?].into_iter().flatten();
    let others = all.filter(|query| asked.iter().all(|other| other.id != query.id));
    Ok(others.map(|query| query.id.number).collect())
}
