//! One scale from the question to its scenario files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use l4d_data::query::Provenance;
use l4d_data::{DataError, Report, Scale};
use l4d_endpoint::{Client, Request};
use serde::Serialize;
use serde_json::Value;

use super::spec::SCHEMA;
use super::{Draft, Known, Scenario, problems, question};
use crate::files::write_unless_other;
use crate::listing::{excerpt, listing};
use crate::quote::printable;
use crate::reason::Reason;
use crate::run::{AskOptions, origin, provenance};

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
    /// The scale.
    pub scale: Scale,
    /// Where its answer came from (`server`, `cache`, `recording`); null if there is none.
    pub answer: Option<&'static str>,
    /// Scenarios in the answer.
    pub proposed: usize,
    /// Names of those that were written.
    pub scenarios: Vec<String>,
    /// Not taken.
    pub failed: usize,
    /// What the client has to say of the answer.
    pub notes: Vec<String>,
}

/// A scenario that was not taken.
#[derive(Debug, Serialize)]
struct Failed {
    reasons: Vec<Reason>,
    said: Value,
    provenance: Provenance,
}

impl ScenarioProposer<'_> {
    /// The question about a scale.
    pub fn request(&self, scale: Scale) -> Request {
        self.manner.apply(question(scale, self.per_scale, self.known))
    }

    /// Asks about a scale and writes what becomes of the answer. `taken` holds the names of this run.
    pub fn invent(
        &self,
        scale: Scale,
        client: &Client,
        taken: &mut BTreeSet<String>,
        report: &mut Report,
    ) -> ScaleOutcome {
        let mut outcome = ScaleOutcome {
            scale,
            answer: None,
            proposed: 0,
            scenarios: Vec::new(),
            failed: 0,
            notes: Vec::new(),
        };
        let failures = self.out.join(format!("{}.failed.jsonl", scale.as_str()));
        let place = format!("question about scale {}", scale.as_str());
        let reply = match client.ask(&self.request(scale)) {
            Ok(reply) => reply,
            Err(error) => {
                report.error("L4D568", &failures, place, printable(&error.to_string()), error.hint());
                return outcome;
            }
        };
        outcome.answer = Some(origin(reply.origin));
        outcome.notes.clone_from(&reply.notes);
        let provenance = provenance(client.endpoint(), &reply);
        let found = listing(&reply, "scenarios", "events", "L4D570");
        outcome.proposed = found.items.len();
        let mut failed = Vec::new();
        for said in found.items {
            match self.taken(&said, scale, taken) {
                Ok(draft) => match self.write(&draft, &provenance) {
                    Ok(()) => outcome.scenarios.push(draft.name),
                    Err(error) => report.data_error("L4D569", &error),
                },
                Err(reasons) => failed.push(Failed { reasons, said, provenance: provenance.clone() }),
            }
        }
        outcome.failed = failed.len();
        if let Some(problem) = found.problem {
            let (code, message, hint) = (problem.code, problem.message.clone(), problem.hint.clone());
            match outcome.proposed {
                0 => report.error(code, &failures, place, message, hint),
                _ => report.warning(code, &failures, place, message, hint),
            }
            let said = Value::String(excerpt(&reply.text));
            failed.push(Failed { reasons: vec![problem], said, provenance });
        }
        let lines = failed.iter().filter_map(|failed| serde_json::to_string(failed).ok());
        let text: String = lines.map(|line| line + "\n").collect();
        if let Err(error) = write_unless_other(&[(failures, text)], self.force) {
            report.data_error("L4D569", &error);
        }
        outcome
    }

    /// The scenario in an item that keeps every rule.
    fn taken(&self, said: &Value, scale: Scale, taken: &mut BTreeSet<String>) -> Result<Draft, Vec<Reason>> {
        let draft = Draft::read(said).map_err(|reason| vec![reason])?;
        let mut reasons = problems(&draft, self.known);
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
        Ok(draft)
    }

    fn write(&self, draft: &Draft, provenance: &Provenance) -> Result<(), DataError> {
        // The rules have made sure that the name is one, and stays in the folder.
        let path: PathBuf = self.out.join(format!("{}.json", draft.name));
        let scenario = Scenario { schema: SCHEMA, draft: draft.clone(), provenance: provenance.clone() };
        let mut text = serde_json::to_string_pretty(&scenario).unwrap_or_default();
        text.push('\n');
        write_unless_other(&[(path, text)], self.force)
    }
}
