//! What becomes of an answer on disk: candidates, proposals that want a predicate, and failed ones with reasons.

use std::path::{Path, PathBuf};

use l4d_data::query::Provenance;
use l4d_data::{DataError, Query};
use l4d_endpoint::{Endpoint, Reply};
use serde::Serialize;
use serde_json::Value;

use super::{Exam, Outcome, Proposal};
use crate::files::write_unless_other;
use crate::listing::{Listing, excerpt, listing};
use crate::reason::Reason;
use crate::run::provenance;

/// A proposal that is sound but for its predicate, which a person writes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unproved {
    /// The query with predicate null.
    pub query: Query,
    /// What was wrong with the predicate that the model gave, if it gave one.
    pub reasons: Vec<Reason>,
    /// The proposal in the model's words.
    pub said: Value,
}

/// A proposal that was not taken.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failed {
    /// Why.
    pub reasons: Vec<Reason>,
    /// The proposal, or the whole answer, in the model's words.
    pub said: Value,
    /// Who said it.
    pub provenance: Provenance,
}

/// An answer, sorted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sorted {
    /// Proposals in the answer.
    pub proposed: usize,
    /// Proved.
    pub candidates: Vec<Query>,
    /// Without a predicate.
    pub unproved: Vec<Unproved>,
    /// Not taken; the last one may be the answer itself, where it could not be read to its end.
    pub failed: Vec<Failed>,
    /// Why the answer could not be read to its end.
    pub problem: Option<Reason>,
}

/// Examines everything in an answer.
pub fn sort(exam: &mut Exam<'_>, endpoint: &Endpoint, reply: &Reply) -> Sorted {
    let provenance = provenance(endpoint, reply);
    let Listing { items, problem } = listing(reply, "proposals", "text", "L4D560");
    let mut sorted = Sorted { proposed: items.len(), problem: problem.clone(), ..Sorted::default() };
    for said in items {
        let outcome = match Proposal::read(&said) {
            Ok(proposal) => exam.judge(&proposal, provenance.clone()),
            Err(reasons) => Outcome::Failed(reasons),
        };
        match outcome {
            Outcome::Candidate(query) => sorted.candidates.push(query),
            Outcome::NeedsPredicate(query, reasons) => {
                sorted.unproved.push(Unproved { query, reasons, said });
            }
            Outcome::Failed(reasons) => {
                sorted.failed.push(Failed { reasons, said, provenance: provenance.clone() });
            }
        }
    }
    if let Some(problem) = problem {
        let said = Value::String(excerpt(&reply.text));
        sorted.failed.push(Failed { reasons: vec![problem], said, provenance });
    }
    sorted
}

/// The files of a scene's proposals.
#[derive(Debug, Clone)]
pub struct Records {
    /// `<scene>.jsonl`: candidates, lines of `benchmark/queries`.
    pub candidates: PathBuf,
    /// `<scene>.unproved.jsonl`.
    pub unproved: PathBuf,
    /// `<scene>.failed.jsonl`.
    pub failed: PathBuf,
}

impl Records {
    /// The files in a folder.
    pub fn new(folder: &Path, scene: &str) -> Self {
        let file = |ending: &str| folder.join(format!("{scene}{ending}"));
        Self { candidates: file(".jsonl"), unproved: file(".unproved.jsonl"), failed: file(".failed.jsonl") }
    }

    /// Writes an answer. Files that hold something else stay as they are unless `force`.
    pub fn write(&self, sorted: &Sorted, force: bool) -> Result<(), DataError> {
        let files = [
            (self.candidates.clone(), lines(&sorted.candidates)),
            (self.unproved.clone(), lines(&sorted.unproved)),
            (self.failed.clone(), lines(&sorted.failed)),
        ];
        write_unless_other(&files, force)
    }
}

fn lines<T: Serialize>(values: &[T]) -> String {
    values.iter().filter_map(|value| serde_json::to_string(value).ok()).map(|line| line + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queries::exam::tests::{kitchen, rendered};

    fn endpoint() -> Endpoint {
        Endpoint::new("http://127.0.0.1:8000/v1", "tiny").unwrap()
    }

    fn answer(text: &str) -> Sorted {
        let (set, scene) = (kitchen(), rendered());
        sort(&mut Exam::new(&set, &scene, None), &endpoint(), &Reply::saying(text))
    }

    const LIFTED: &str = r#"{"category":"interaction","text":"The cup that the hand lifts","referents":[1],"temporal":"whole","frames":[],"predicate":"[{\"category\":\"cup\"},{\"undergoes\":{\"verb\":\"lift\",\"by\":{\"category\":\"hand\"}}}]"}"#;
    const UNPROVED: &str = r#"{"category":"action","text":"The cup that wobbles","referents":[2],"temporal":"whole","frames":[],"predicate":"wobble(x)"}"#;
    const UNKNOWN: &str = r#"{"category":"action","text":"The cup that flies","referents":[77],"temporal":"whole","frames":[],"predicate":""}"#;

    #[test]
    fn an_answer_is_sorted_and_nothing_is_lost() {
        let sorted = answer(&format!(r#"{{"proposals":[{LIFTED},{UNPROVED},{UNKNOWN},{{"text":7}}]}}"#));
        assert_eq!(
            (sorted.proposed, sorted.candidates.len(), sorted.unproved.len(), sorted.failed.len()),
            (4, 1, 1, 2)
        );
        let provenance = &sorted.candidates[0].provenance;
        assert_eq!(provenance.source, "model");
        assert_eq!(
            provenance.note,
            format!("model tiny, endpoint 127.0.0.1:8000, question {}", "d".repeat(64))
        );
        assert_eq!(sorted.unproved[0].said["predicate"], "wobble(x)");
        assert_eq!(sorted.unproved[0].reasons[0].code, "L4D567");
        assert_eq!(sorted.failed[0].reasons[0].code, "L4D563");
        assert_eq!(sorted.failed[1].said["text"], 7);
    }

    #[test]
    fn what_arrived_of_half_an_answer_counts() {
        let sorted = answer(&format!(r#"{{"proposals":[{LIFTED},{{"text":"The"#));
        assert_eq!((sorted.candidates.len(), sorted.failed.len()), (1, 1));
        assert_eq!(sorted.failed[0].reasons[0].code, "L4D560");
        assert!(sorted.failed[0].said.as_str().unwrap().starts_with(r#"{"proposals":"#));
        let garbage = answer("no");
        assert_eq!((garbage.proposed, garbage.failed.len()), (0, 1));
    }

    #[test]
    fn candidates_are_lines_of_the_benchmark() {
        let folder = tempfile::tempdir().unwrap();
        let records = Records::new(folder.path(), "kitchen");
        let sorted = answer(&format!("[{LIFTED}]"));
        records.write(&sorted, false).unwrap();
        assert_eq!(l4d_data::query::read_queries(&records.candidates, "kitchen").unwrap(), sorted.candidates);
        assert_eq!(std::fs::read_to_string(&records.failed).unwrap(), "");
    }

    #[test]
    fn what_stands_there_is_not_overwritten_silently() {
        let folder = tempfile::tempdir().unwrap();
        let records = Records::new(folder.path(), "kitchen");
        let (first, second) = (answer(&format!("[{LIFTED}]")), answer("no"));
        records.write(&first, false).unwrap();
        records.write(&first, false).expect("the same again is fine");
        let error = records.write(&second, false).unwrap_err();
        assert!(
            error.to_string().contains("kitchen.jsonl") && error.hint().unwrap().contains("--force"),
            "{error}"
        );
        assert!(std::fs::read_to_string(&records.failed).unwrap().is_empty(), "nothing was written");
        records.write(&second, true).unwrap();
        assert!(std::fs::read_to_string(&records.candidates).unwrap().is_empty());
    }
}
