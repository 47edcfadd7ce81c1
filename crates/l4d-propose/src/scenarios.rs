//! Scenarios: what a model is asked for, which specs it may give, and what becomes of each.
//!
//! A spec is an idea with a structure, no scene: a person turns it into a recipe under `blender_scripts/scenes`.

mod rules;
mod spec;

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::{Benchmark, Report, Scale};
use l4d_endpoint::{Client, Message, Part, Request, Schema};
use l4d_query::verbs::lexicon;
use serde::Serialize;
use serde_json::json;

use self::spec::{Draft, SCHEMA, Scenario};
use crate::answer::{AskOptions, Asked, Reason, Subject, write_unless_other};
use crate::quote::data_block;

const INSTRUCTIONS: &str = include_str!("../briefs/scenarios.md");
/// Tokens of an answer apart from its scenarios: thinking, a little prose.
const TOKENS_BESIDE: u32 = 2048;
const TOKENS_A_SCENARIO: u32 = 2500;

/// What a new scenario must fit to.
#[derive(Debug, Clone, Default)]
pub struct Known {
    scenes: BTreeSet<String>,
    /// Those with a meaning for geometry, and those of the scenes that exist.
    verbs: BTreeSet<String>,
}

impl Known {
    /// What a benchmark has. Scenes whose tracks cannot be read lend no verbs.
    pub fn of(bench: &Benchmark) -> Self {
        let mut verbs: BTreeSet<String> = lexicon().into_iter().map(str::to_owned).collect();
        for tracks in bench.manifest.scenes.iter().filter_map(|scene| bench.tracks(scene).ok()) {
            verbs.extend(tracks.events.into_iter().map(|event| event.verb));
        }
        let scenes = bench.manifest.scenes.iter().map(ToString::to_string).collect();
        Self { scenes, verbs }
    }
}

/// How many scenarios are asked for, and where they go.
#[derive(Debug, Clone, Copy)]
pub struct ScenarioProposer<'a> {
    /// What they must fit to.
    pub known: &'a Known,
    /// Folder that receives them.
    pub out: &'a Path,
    /// Scenarios of each scale.
    pub per_scale: u32,
    /// How it is asked.
    pub manner: AskOptions,
    /// Whether files that hold something else are replaced.
    pub force: bool,
}

/// What became of a scale.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScaleOutcome {
    pub scale: Scale,
    /// The question and its answer.
    #[serde(flatten)]
    pub asked: Asked,
    /// Names of the scenarios that were written.
    pub scenarios: Vec<String>,
}

impl ScenarioProposer<'_> {
    /// The question about a scale: scenarios that differ from what exists.
    pub fn request(&self, scale: Scale) -> Request {
        let data = data_block(&json!({ "existing_scenes": self.known.scenes, "verbs": self.known.verbs }));
        let (count, scale) = (self.per_scale, scale.as_str());
        let parts = vec![
            Part::text(format!("What exists:\n{data}")),
            Part::text(format!(
                "Invent {count} scenes of scale {scale}, as different from each other and from the existing ones as \
                 you can. Answer with the JSON object alone."
            )),
        ];
        let request = Request::new(vec![Message::system(INSTRUCTIONS), Message::user(parts)])
            .with_schema(Schema::new("scenarios", spec::schema()))
            .with_max_tokens(TOKENS_BESIDE + TOKENS_A_SCENARIO * count);
        self.manner.apply(request)
    }

    /// Asks about a scale and writes what becomes of the answer. `taken` holds the names of this run.
    pub fn invent(
        &self,
        scale: Scale,
        client: &Client,
        taken: &mut BTreeSet<String>,
        report: &mut Report,
    ) -> ScaleOutcome {
        let mut outcome = ScaleOutcome { scale, asked: Asked::default(), scenarios: Vec::new() };
        let failures = self.out.join(format!("{}.failed.jsonl", scale.as_str()));
        let subject = Subject {
            name: &format!("scale {}", scale.as_str()),
            list: "scenarios",
            mark: "events",
            code: "L4D570",
            failures: &failures,
        };
        let mut scenarios = Vec::new();
        let asked = subject.ask(client, &self.request(scale), report, |said, provenance| {
            let draft = Draft::read(said).map_err(|reason| vec![reason])?;
            let mut reasons = rules::problems(&draft, self.known);
            if draft.scale != scale {
                let message = format!("is {}, but {} was asked for", draft.scale.as_str(), scale.as_str());
                reasons.push(Reason::new("L4D571", "scale", message, "ask for that scale"));
            }
            if taken.contains(&draft.name) {
                let message = "another scenario of this run has the name";
                reasons.push(Reason::new("L4D572", "name", message, "rename one of them"));
            }
            if !reasons.is_empty() {
                return Err(reasons);
            }
            taken.insert(draft.name.clone());
            scenarios.push(Scenario { schema: SCHEMA, draft, provenance: provenance.clone() });
            Ok(())
        });
        let Some((asked, failed)) = asked else { return outcome };
        outcome.asked = asked;
        for scenario in scenarios {
            let name = &scenario.draft.name;
            // The rules have made sure that the name is one, and stays in the folder.
            let path = self.out.join(format!("{name}.json"));
            let text = serde_json::to_string_pretty(&scenario).unwrap_or_default() + "\n";
            match write_unless_other(&[(path, text)], self.force) {
                Ok(()) => outcome.scenarios.push(name.clone()),
                Err(error) => report.data_error("L4D569", &error),
            }
        }
        if let Err(error) = write_unless_other(&[(failures, failed)], self.force) {
            report.data_error("L4D569", &error);
        }
        outcome
    }
}
