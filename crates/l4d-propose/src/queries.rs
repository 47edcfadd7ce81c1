//! Queries: what a model is shown and asked about a scene, what it may answer, and what becomes of each answer.
//!
//! What happens in the scene is left out of the question on purpose: a model that knows the events would repeat them,
//! and the proof would compare the tracks with themselves. Names of objects often tell what they do, so they are left
//! out, too.

mod proposal;
mod screening;

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::layout::SceneDir;
use l4d_data::scene::{Event, Instance, Scene};
use l4d_data::tracks::TrackedInstance;
use l4d_data::{Benchmark, Camera, DataError, Name, Profile, Query, Report, Role, Split};
use l4d_endpoint::{Client, Image, Message, Part, Plan, Request, Schema};
use l4d_frames::clip::{Clip, caption};
use l4d_query::prove::{SceneSet, Vocabulary};
use serde::Serialize;
use serde_json::{Value, json};

use self::proposal::Proposal;
use self::screening::{Outcome, Screening};
use crate::answer::{AskOptions, Asked, Reason, Subject, lines, write_unless_other};
use crate::quote::data_block;

const INSTRUCTIONS: &str = include_str!("../briefs/queries.md");
/// Tokens of an answer apart from its proposals: thinking, a little prose.
const TOKENS_BESIDE: u32 = 2048;
const TOKENS_A_PROPOSAL: u32 = 250;

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

/// What became of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneOutcome {
    pub scene: Name,
    /// The question and its answer.
    #[serde(flatten)]
    pub asked: Asked,
    /// Proved: lines for the benchmark, once people have looked at them.
    pub candidates: usize,
    /// Sound, but without a predicate, which a person writes.
    pub unproved: usize,
}

/// A proposal that is sound but for its predicate.
#[derive(Serialize)]
struct Unproved {
    query: Query,
    /// What was wrong with the predicate that the model gave, if it gave one.
    reasons: Vec<Reason>,
    /// The proposal in the model's words.
    said: Value,
}

/// A scene that is ready to be asked about.
struct Prepared {
    set: SceneSet,
    scene: Scene,
    request: Request,
}

impl QueryProposer<'_> {
    /// What asking about a scene would mean; nothing is sent.
    pub fn plan(&self, name: &Name, client: &Client, report: &mut Report) -> Option<Plan> {
        Some(client.plan([&self.prepare(name, report)?.request]))
    }

    /// Asks about a scene and writes what becomes of the answer. Trouble is reported, and the next scene may follow.
    pub fn propose(&self, name: &Name, client: &Client, report: &mut Report) -> SceneOutcome {
        let mut outcome =
            SceneOutcome { scene: name.clone(), asked: Asked::default(), candidates: 0, unproved: 0 };
        let Some(Prepared { set, scene, request }) = self.prepare(name, report) else { return outcome };
        let file = |ending: &str| self.out.join(format!("{name}{ending}"));
        let failures = file(".failed.jsonl");
        let subject = Subject { name, list: "proposals", mark: "text", code: "L4D560", failures: &failures };
        let mut screening = Screening::new(&set, &scene, self.vocabulary);
        let (mut candidates, mut unproved) = (Vec::new(), Vec::new());
        let asked = subject.ask(client, &request, report, |said, provenance| {
            match screening.judge(&Proposal::read(said)?, provenance.clone()) {
                Outcome::Candidate(query) => candidates.push(query),
                Outcome::NeedsPredicate(query, reasons) => {
                    unproved.push(Unproved { query, reasons, said: said.clone() });
                }
                Outcome::Failed(reasons) => return Err(reasons),
            }
            Ok(())
        });
        let Some((asked, failed)) = asked else { return outcome };
        (outcome.asked, outcome.candidates, outcome.unproved) = (asked, candidates.len(), unproved.len());
        let files = [
            (file(".jsonl"), lines(&candidates)),
            (file(".unproved.jsonl"), lines(&unproved)),
            (failures, failed),
        ];
        if let Err(error) = write_unless_other(&files, self.force) {
            report.data_error("L4D569", &error);
        }
        outcome
    }

    /// Reads a scene, draws its pictures and writes the question. What is wrong with its files is reported.
    fn prepare(&self, name: &Name, report: &mut Report) -> Option<Prepared> {
        let set = SceneSet::read(self.bench, self.profile, name, report)?;
        let dir = SceneDir::new(self.data, name);
        let scene = Scene::read(&dir.scene()).map_err(|error| report.data_error("L4D101", &error)).ok()?;
        if let Some(error) = self.mismatch(&set, &scene, &dir) {
            report.data_error("L4D112", &error);
            return None;
        }
        let pictures =
            self.pictures(&scene, &dir).map_err(|error| report.data_error("L4D104", &error)).ok()?;
        let request = self.manner.apply(question(&set, pictures, self.per_category));
        Some(Prepared { set, scene, request })
    }

    /// Why the frames do not show what the benchmark describes.
    fn mismatch(&self, set: &SceneSet, scene: &Scene, dir: &SceneDir) -> Option<DataError> {
        let tracked: Vec<Instance> = set.tracks.instances.iter().map(TrackedInstance::instance).collect();
        let same = scene.name == set.scene
            && scene.profile == self.profile
            && (scene.variant, scene.seed) == (set.tracks.variant, set.tracks.seed)
            && scene.instances == tracked;
        (!same).then(|| {
            let (profile, tracks) = (self.profile, set.paths[0].display());
            let message = format!("is not the rendering (profile {profile}) of what {tracks} describes");
            let hint = "choose another --data, --profile or --bench, or run `l4d build-scenes` again";
            DataError::invalid(&dir.scene(), "scene", message, hint)
        })
    }

    /// Captions and pictures, view by view.
    fn pictures(&self, scene: &Scene, dir: &SceneDir) -> Result<Vec<Part>, DataError> {
        let clip = Clip::new(scene, dir, self.width_px);
        let mut parts = Vec::new();
        for (camera, frame) in shown(scene, self.frames, self.training_views) {
            let image = Image::new(clip.jpeg(camera, frame)?).map_err(|error| {
                let path = dir.frame(&camera.name, frame);
                DataError::invalid(&path, "picture", error.to_string(), error.hint())
            })?;
            parts.extend([Part::Text(caption(camera, frame)), Part::Image(image)]);
        }
        Ok(parts)
    }
}

/// The held-out view and some training views, spread over the rig, each at moments spread over the clip.
fn shown(scene: &Scene, frames: usize, training_views: usize) -> Vec<(&Camera, u32)> {
    let training: Vec<&Camera> = scene.cameras.iter().filter(|camera| camera.split == Split::Train).collect();
    let views = training_views.min(training.len());
    let along = (0..views).map(|index| training[training.len() * (2 * index + 1) / (2 * views)]);
    let rendered: Vec<u32> = scene.profile.frames().collect();
    let moments = frames.clamp(2, rendered.len());
    let moment = |index: usize| rendered[index * (rendered.len() - 1) / (moments - 1)];
    let cameras = scene.test_camera().into_iter().chain(along);
    cameras.flat_map(|camera| (0..moments).map(move |index| (camera, moment(index)))).collect()
}

/// The question about a scene for `per_category` queries of each of the four categories.
fn question(set: &SceneSet, pictures: Vec<Part>, per_category: u32) -> Request {
    let total = per_category * 4;
    let mut parts = vec![Part::text(format!("The scene:\n{}", data_block(&description(set))))];
    parts.extend(pictures);
    parts.push(Part::Text(format!(
        "Propose {total} queries, {per_category} of each category (attribute, action, spatial, interaction), \
         about different objects where you can. Answer with the JSON object alone."
    )));
    Request::new(vec![Message::system(INSTRUCTIONS), Message::user(parts)])
        .with_schema(Schema::new("query_proposals", proposal::schema()))
        .with_max_tokens(TOKENS_BESIDE + TOKENS_A_PROPOSAL * total)
}

/// What a model may know of a scene besides its pictures.
fn description(set: &SceneSet) -> Value {
    let tracks = &set.tracks;
    let described = |role: Role| -> Value {
        let of_role = tracks.instances.iter().zip(1..).filter(|(instance, _)| instance.role == role);
        of_role
            .map(|(instance, number)| {
                let mut fields = json!({
                    "number": number, "category": instance.category, "has_front": instance.front.is_some(),
                });
                match role {
                    Role::Object => fields["properties"] = json!(instance.attributes),
                    Role::Landmark => fields["name"] = json!(instance.name),
                }
                fields
            })
            .collect()
    };
    let verbs = |takes_part: fn(&&Event) -> bool| -> BTreeSet<&str> {
        tracks.events.iter().filter(takes_part).map(|event| event.verb.as_str()).collect()
    };
    let sentences = [&set.queries, &set.composites, &set.absents];
    json!({
        "scale": tracks.scale,
        "objects": described(Role::Object),
        "landmarks": described(Role::Landmark),
        "verbs_alone": verbs(|event| event.object.is_none()),
        "verbs_upon_somebody": verbs(|event| event.object.is_some()),
        "existing_sentences": sentences.into_iter().flatten().map(|query| &query.text).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::screening::tests::{kitchen, rendering};
    use super::*;

    #[test]
    fn a_question_tells_what_is_there_and_not_what_happens() {
        let request = question(&kitchen(), vec![Part::text("cam0, frame 0, 0.00 s")], 3);
        assert_eq!(request.messages[0], Message::system(INSTRUCTIONS));
        let [Part::Text(scene), _, Part::Text(last)] = request.messages[1].parts.as_slice() else { panic!() };
        assert!(last.starts_with("Propose 12 queries, 3 of each"), "the question comes last");
        assert!(!scene.contains("cup_lifted"), "a name would tell what happens");
        let data = description(&kitchen());
        assert_eq!(
            (&data["objects"][0]["number"], data["objects"].as_array().unwrap().len()),
            (&json!(1), 4)
        );
        let tray = json!({"number": 5, "name": "tray", "category": "tray", "has_front": false});
        assert_eq!(data["landmarks"][0], tray);
        assert_eq!(
            (&data["verbs_upon_somebody"], &data["verbs_alone"]),
            (&json!(["lift"]), &json!(["roll"]))
        );
        assert_eq!(data["existing_sentences"], json!(["The blue cup"]));
    }

    #[test]
    fn moments_and_views_are_spread() {
        let scene = rendering(&kitchen().tracks, Profile::Tiny);
        let places = |frames, views| -> Vec<(&str, u32)> {
            shown(&scene, frames, views)
                .iter()
                .map(|(camera, frame)| (camera.name.as_str(), *frame))
                .collect()
        };
        // The held-out view, and two of cam0, cam1, cam3, cam4.
        let expected = ["cam2", "cam1", "cam4"].map(|view| [0, 48, 96].map(|frame| (view, frame)));
        assert_eq!(places(3, 2), expected.concat());
        assert_eq!(places(0, 0), [("cam2", 0), ("cam2", 96)]);
        assert_eq!(places(1000, 1000).len(), 5 * 9);
    }
}
