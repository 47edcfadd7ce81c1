//! One scene from its files to its proposals: look, ask, examine, write.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::layout::SceneDir;
use l4d_data::scene::{Instance, Scene};
use l4d_data::tracks::TrackedInstance;
use l4d_data::{Benchmark, DataError, Name, Profile, Report};
use l4d_endpoint::{Client, EndpointError, Plan, Reply, Request};
use l4d_frames::clip::Clip;
use l4d_query::prove::{SceneSet, Vocabulary};
use serde::Serialize;

use super::{Exam, PictureChoice, Records, Sorted, clip_pictures, question, sort};
use crate::quote::printable;
use crate::run::{AskOptions, origin};

/// Where everything is, and how much is asked of each scene.
#[derive(Debug, Clone, Copy)]
pub struct QueryProposer<'a> {
    /// Scenes, queries, truth.
    pub bench: &'a Benchmark,
    /// Which rendering is looked at.
    pub profile: Profile,
    /// Folder of the rendered scenes.
    pub data: &'a Path,
    /// Folder that receives the proposals.
    pub out: &'a Path,
    /// Reviewed words.
    pub vocabulary: Option<&'a Vocabulary>,
    /// Queries wanted of each of the four categories.
    pub per_category: u32,
    /// Moments of the clip that are shown.
    pub frames: usize,
    /// Training views that are shown beside the held-out one.
    pub training_views: usize,
    /// Pictures are at least this wide, pixels.
    pub width_px: u32,
    /// How it is asked.
    pub manner: AskOptions,
    /// Whether files that hold other proposals are replaced.
    pub force: bool,
}

/// A scene that is ready to be asked about.
#[derive(Debug)]
pub struct Prepared {
    set: SceneSet,
    scene: Scene,
    /// What is asked.
    pub request: Request,
}

/// What became of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneOutcome {
    /// The scene.
    pub scene: Name,
    /// Where its answer came from (`server`, `cache`, `recording`); null if there is none.
    pub answer: Option<&'static str>,
    /// Proposals in the answer.
    pub proposed: usize,
    /// Proved.
    pub candidates: usize,
    /// Sound, but without a predicate.
    pub unproved: usize,
    /// Not taken.
    pub failed: usize,
    /// Code -> proposals that failed for this reason, among others.
    pub reasons: BTreeMap<&'static str, usize>,
    /// Tokens of the question, as the server counted them.
    pub prompt_tokens: Option<u64>,
    /// Tokens of the answer.
    pub completion_tokens: Option<u64>,
    /// What the client has to say of the answer.
    pub notes: Vec<String>,
}

impl QueryProposer<'_> {
    /// Reads a scene, draws its pictures and writes the question. What is wrong with its files is reported.
    pub fn prepare(&self, name: &Name, report: &mut Report) -> Option<Prepared> {
        let set = SceneSet::read(self.bench, self.profile, name, report)?;
        let dir = SceneDir::new(self.data, name);
        let scene = Scene::read(&dir.scene()).map_err(|error| report.data_error("L4D101", &error)).ok()?;
        if let Some(error) = self.mismatch(&set, &scene, &dir) {
            report.data_error("L4D112", &error);
            return None;
        }
        let showing = PictureChoice::choose(&scene, self.frames, self.training_views);
        let clip = Clip::new(&scene, &dir, self.width_px);
        let drawn =
            clip_pictures(&clip, &showing).map_err(|error| report.data_error("L4D104", &error)).ok()?;
        match question(&set, drawn, self.per_category) {
            Ok(request) => Some(Prepared { set, scene, request: self.manner.apply(request) }),
            Err(error) => {
                self.report_endpoint(name, &error, report);
                None
            }
        }
    }

    /// What asking about a scene would mean; nothing is sent.
    pub fn plan(&self, name: &Name, client: &Client, report: &mut Report) -> Option<Plan> {
        let prepared = self.prepare(name, report)?;
        Some(client.plan([&prepared.request]))
    }

    /// Asks about a scene and writes what becomes of the answer. Trouble is reported, and the next scene may follow.
    pub fn propose(&self, name: &Name, client: &Client, report: &mut Report) -> SceneOutcome {
        let mut outcome = SceneOutcome::none(name);
        let Some(prepared) = self.prepare(name, report) else { return outcome };
        let reply = match client.ask(&prepared.request) {
            Ok(reply) => reply,
            Err(error) => {
                self.report_endpoint(name, &error, report);
                return outcome;
            }
        };
        let mut exam = Exam::new(&prepared.set, &prepared.scene, self.vocabulary);
        let sorted = sort(&mut exam, client.endpoint(), &reply);
        let records = Records::new(self.out, name);
        if let Err(error) = records.write(&sorted, self.force) {
            report.data_error("L4D569", &error);
        }
        if let Some(problem) = &sorted.problem {
            let place = format!("answer about {name}");
            let (code, message, hint) = (problem.code, problem.message.as_str(), problem.hint.as_str());
            if sorted.proposed == 0 {
                report.error(code, &records.failed, place, message, hint);
            } else {
                report.warning(code, &records.failed, place, message, hint);
            }
        }
        outcome.count(&sorted, &reply);
        outcome
    }

    /// Why the frames do not show what the benchmark describes.
    fn mismatch(&self, set: &SceneSet, scene: &Scene, dir: &SceneDir) -> Option<DataError> {
        let tracked: Vec<Instance> = set.tracks.instances.iter().map(TrackedInstance::instance).collect();
        let same = scene.name == set.scene
            && scene.profile == self.profile
            && (scene.variant, scene.seed) == (set.tracks.variant, set.tracks.seed)
            && scene.instances == tracked;
        let refuse = || {
            DataError::invalid(
                &dir.scene(),
                "scene",
                format!(
                    "is not the rendering (profile {}) of what {} describes",
                    self.profile,
                    set.paths[0].display()
                ),
                "choose another --data, --profile or --bench, or run `l4d build-scenes` again",
            )
        };
        (!same).then(refuse)
    }

    fn report_endpoint(&self, name: &Name, error: &EndpointError, report: &mut Report) {
        let path = Records::new(self.out, name).candidates;
        let message = printable(&error.to_string());
        report.error("L4D568", &path, format!("question about {name}"), message, error.hint());
    }
}

impl SceneOutcome {
    fn none(scene: &Name) -> Self {
        Self {
            scene: scene.clone(),
            answer: None,
            proposed: 0,
            candidates: 0,
            unproved: 0,
            failed: 0,
            reasons: BTreeMap::new(),
            prompt_tokens: None,
            completion_tokens: None,
            notes: Vec::new(),
        }
    }

    fn count(&mut self, sorted: &Sorted, reply: &Reply) {
        self.answer = Some(origin(reply.origin));
        self.proposed = sorted.proposed;
        self.candidates = sorted.candidates.len();
        self.unproved = sorted.unproved.len();
        self.failed = sorted.proposed - self.candidates - self.unproved;
        for failed in &sorted.failed {
            let mut codes: Vec<&'static str> = failed.reasons.iter().map(|reason| reason.code).collect();
            codes.dedup();
            codes.into_iter().for_each(|code| *self.reasons.entry(code).or_default() += 1);
        }
        self.prompt_tokens = reply.usage.prompt_tokens;
        self.completion_tokens = reply.usage.completion_tokens;
        self.notes.clone_from(&reply.notes);
    }
}
