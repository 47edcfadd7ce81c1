//! What is asked: version, truth digest, profile, scenes and their queries.

use std::path::PathBuf;

use l4d_data::{Benchmark, DataError, Name, Profile, Query, Report, Status};

use crate::codes;
use crate::truth::SceneTruth;

/// The benchmark as seen by the judge, for one profile.
#[derive(Debug, Clone)]
pub struct Exam {
    /// Where everything is read from.
    pub bench: Benchmark,
    /// The profile whose truth counts.
    pub profile: Profile,
    /// [`Benchmark::truth_digest`] of the profile.
    pub truth_digest: String,
    /// Canonical frames of the clip, ascending.
    pub clip: Vec<u32>,
    /// The scenes asked about, in table order.
    pub scenes: Vec<SceneExam>,
}

/// One scene of an exam.
#[derive(Debug, Clone)]
pub struct SceneExam {
    /// The scene.
    pub name: Name,
    /// All its queries, rejected ones included.
    pub queries: Vec<Query>,
    /// The file that they come from.
    pub queries_path: PathBuf,
}

impl Exam {
    /// Reads what is asked about some scenes; none means all that have queries and truth, and those without are
    /// reported.
    pub fn open(
        bench: Benchmark,
        profile: Profile,
        wanted: &[String],
        report: &mut Report,
    ) -> Result<Self, DataError> {
        let truth_digest = bench.truth_digest(profile)?;
        let mut scenes = Vec::new();
        for name in bench.select(wanted)? {
            let files = [bench.dir.truth(profile, &name), bench.dir.queries(&name)];
            let lacking = files.iter().find(|path| !path.exists());
            if let (Some(path), true) = (lacking, wanted.is_empty()) {
                let message = format!("is not there, so scene {name} is left out");
                let hint = format!(
                    "run `l4d build-scenes --profile {profile} --scenes {name}` or write its queries"
                );
                report.warning(codes::SCENE_LEFT_OUT, path, "", message, hint);
                continue;
            }
            let queries = bench.queries(&name)?;
            scenes.push(SceneExam { queries, queries_path: bench.dir.queries(&name), name });
        }
        if scenes.is_empty() {
            let message = format!("no scene has both queries and truth of profile {profile}");
            let remedy = "choose another --profile or build the scenes";
            return Err(DataError::invalid(bench.root(), "folder", message, remedy));
        }
        Ok(Self { truth_digest, clip: profile.frames().collect(), bench, profile, scenes })
    }

    /// Reads and decodes the truth of a scene.
    pub fn truth(&self, scene: &Name) -> Result<SceneTruth, DataError> {
        SceneTruth::load(&self.bench, self.profile, scene)
    }

    /// Queries that people have rejected: never scored, but counted, so that a table can say what it lacks.
    pub fn rejected(&self) -> usize {
        let queries = self.scenes.iter().flat_map(|scene| &scene.queries);
        queries.filter(|query| query.status == Status::Rejected).count()
    }

    /// Mask size, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.profile.width(), self.profile.height())
    }
}
