//! From a question to the items of its answer, each taken or kept with the reasons against it: what both verbs do.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::error::inert;
use l4d_data::query::{Provenance, Source};
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{DataError, Report};
use l4d_endpoint::{Client, Endpoint, Finish, Origin, Reply, Request, documents};
use serde::Serialize;
use serde_json::Value;

use crate::quote::excerpt;

/// How far answers may stray from the likeliest one when something is asked again.
const TEMPERATURE_OF_REPEATS: f64 = 0.7;
const LONGEST_MODEL: usize = 80;
/// No answer has more items; what follows is not read.
const MOST_ITEMS: usize = 200;

/// Why a proposal was not taken: like a finding, but of a proposal, which is in no file of the benchmark.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Reason {
    /// Stable code (`docs/findings.md`).
    pub(crate) code: &'static str,
    /// Which part of the proposal.
    pub(crate) field: String,
    /// What is wrong.
    pub(crate) message: String,
    /// What a person can do about it.
    pub(crate) hint: String,
}

impl Reason {
    pub(crate) fn new(
        code: &'static str,
        field: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { code, field: field.into(), message: message.into(), hint: hint.into() }
    }
}

/// How a question is asked.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AskOptions {
    /// Which asking this is, from 0: the likeliest answer first, then others.
    pub repeat: u32,
    /// Longest answer, tokens; default: what the number of proposals needs.
    pub answer_tokens: Option<u32>,
}

impl AskOptions {
    /// The question in this manner.
    pub(crate) fn apply(self, mut request: Request) -> Request {
        request.max_tokens = self.answer_tokens.unwrap_or(request.max_tokens);
        if self.repeat > 0 {
            request.repeat = self.repeat;
            request.seed = Some(self.repeat);
            request.temperature = Some(TEMPERATURE_OF_REPEATS);
        }
        request
    }
}

/// What came of a question.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Asked {
    /// Where its answer came from (`server`, `cache`, `recording`); null if there is none.
    pub answer: Option<&'static str>,
    /// Proposals in the answer.
    pub proposed: usize,
    /// Of them, not taken.
    pub failed: usize,
    /// Code -> proposals that failed for this reason, among others.
    pub reasons: BTreeMap<&'static str, usize>,
    /// What the client has to say of the answer.
    pub notes: Vec<String>,
}

/// A proposal that was not taken, or the answer where it could not be read to its end.
#[derive(Debug, Serialize)]
struct Failed {
    reasons: Vec<Reason>,
    /// In the model's words.
    said: Value,
    provenance: Provenance,
}

/// What is asked about, and where its answer holds what.
pub(crate) struct Subject<'a> {
    pub(crate) name: &'a str,
    /// The field that holds the list of items.
    pub(crate) list: &'static str,
    /// A field that every item has: by it whole items of a broken list are recognised.
    pub(crate) mark: &'static str,
    /// Code of an answer that cannot be read to its end.
    pub(crate) code: &'static str,
    /// File of what was not taken.
    pub(crate) failures: &'a Path,
}

impl Subject<'_> {
    /// Asks, and hands each item of the answer to `take`, which says why it does not take it. The second of what comes
    /// back belongs into the file of failures. Trouble is reported.
    pub(crate) fn ask(
        &self,
        client: &Client,
        request: &Request,
        report: &mut Report,
        mut take: impl FnMut(&Value, &Provenance) -> Result<(), Vec<Reason>>,
    ) -> Option<(Asked, String)> {
        let reply = match client.ask(request) {
            Ok(reply) => reply,
            Err(error) => {
                let place = format!("question about {}", self.name);
                report.error("L4D568", self.failures, place, error.to_string(), error.hint());
                return None;
            }
        };
        let provenance = provenance(client.endpoint(), &reply);
        let (items, problem) = listing(&reply, self);
        let proposed = items.len();
        let mut failed = Vec::new();
        for said in items {
            if let Err(reasons) = take(&said, &provenance) {
                failed.push(Failed { reasons, said, provenance: provenance.clone() });
            }
        }
        let mut asked = Asked {
            answer: Some(match reply.origin {
                Origin::Server => "server",
                Origin::Cache => "cache",
                Origin::Recording => "recording",
            }),
            proposed,
            failed: failed.len(),
            reasons: BTreeMap::new(),
            notes: reply.notes,
        };
        if let Some(problem) = problem {
            let Reason { code, message, hint, .. } = problem.clone();
            let place = format!("answer about {}", self.name);
            match proposed {
                0 => report.error(code, self.failures, place, message, hint),
                _ => report.warning(code, self.failures, place, message, hint),
            }
            let said = Value::String(excerpt(&reply.text));
            failed.push(Failed { reasons: vec![problem], said, provenance });
        }
        for failed in &failed {
            let mut codes: Vec<&'static str> = failed.reasons.iter().map(|reason| reason.code).collect();
            codes.dedup();
            codes.into_iter().for_each(|code| *asked.reasons.entry(code).or_default() += 1);
        }
        Some((asked, lines(&failed)))
    }
}

/// Which model said it, where, in answer to which question. Never a key: an endpoint doesn't hold any.
fn provenance(endpoint: &Endpoint, reply: &Reply) -> Provenance {
    let own_name = reply.model.as_ref().filter(|model| **model != endpoint.model);
    let own_name = own_name.map_or_else(String::new, |model| {
        format!(" (says it is {})", inert(model).chars().take(LONGEST_MODEL).collect::<String>())
    });
    let (model, host) = (&endpoint.model, endpoint.base_url.authority());
    let note = format!("model {model}{own_name}, endpoint {host}, question {}", reply.digest);
    Provenance { source: Source::Model, note }
}

/// The items in an answer, and why there may have been more, or none.
fn listing(reply: &Reply, subject: &Subject<'_>) -> (Vec<Value>, Option<Reason>) {
    let problem = |message: String, hint: &str| Some(Reason::new(subject.code, "answer", message, hint));
    let mut loose = Vec::new();
    for document in documents(&reply.text).flatten() {
        if document.get(subject.mark).is_some() {
            loose.push(document);
        } else if let Some(mut items) = listed(document, subject.list) {
            let count = items.len();
            items.truncate(MOST_ITEMS);
            let message = || format!("has {count} items, of which {MOST_ITEMS} were read");
            let is_cut = count > MOST_ITEMS;
            return (
                items,
                is_cut.then(message).and_then(|text| problem(text, "ask for fewer with --per-category")),
            );
        }
        if loose.len() == MOST_ITEMS {
            break;
        }
    }
    let problem = match (&reply.finish, loose.len()) {
        (Finish::Refused(words), _) => problem(
            format!("the model refused: {}", excerpt(words)),
            "ask another model, or look at what the pictures show",
        ),
        (Finish::Length, count) => problem(
            format!("was cut off at the limit of tokens; {count} whole items of it were read"),
            "raise the limit of tokens of the endpoint, or ask for fewer",
        ),
        (_, 0) if reply.text.trim().is_empty() => {
            problem("is empty".to_owned(), "ask another model, or raise the limit of tokens of the endpoint")
        }
        (_, 0) => problem(
            format!("holds no list of proposals: {}", excerpt(&reply.text)),
            "ask a model that can follow instructions and answer in JSON",
        ),
        (_, count) => problem(
            format!("is not the list that was asked for; {count} whole items in it were read"),
            "nothing is lost but what the model did not finish",
        ),
    };
    (loose, problem)
}

/// The list in a field of an object, at any depth of wrapping, or a bare one of objects.
fn listed(value: Value, list: &str) -> Option<Vec<Value>> {
    match value {
        Value::Array(items) if !items.is_empty() && items.iter().all(Value::is_object) => Some(items),
        Value::Object(mut fields) => match fields.remove(list) {
            Some(Value::Array(items)) => Some(items),
            _ => fields
                .into_iter()
                .filter(|(_, value)| value.is_object())
                .find_map(|(_, value)| listed(value, list)),
        },
        _ => None,
    }
}

pub(crate) fn lines<T: Serialize>(values: &[T]) -> String {
    values.iter().filter_map(|value| serde_json::to_string(value).ok()).map(|line| line + "\n").collect()
}

/// Writes all of the files, or none of them if one holds something else and `force` is off: proposals of another
/// model, or edited by hand, are not lost.
pub(crate) fn write_unless_other(files: &[(PathBuf, String)], force: bool) -> Result<(), DataError> {
    for (path, text) in files.iter().filter(|(path, _)| !force && path.exists()) {
        let standing = read_bounded(path, l4d_data::json::MAX_BYTES)?;
        if !standing.is_empty() && standing != text.as_bytes() {
            let message = "holds something else: of another model, of another run, or edited by hand";
            let hint =
                "choose another --out, or replace it with --force; the new answer is kept in the cache";
            return Err(DataError::invalid(path, "file", message, hint));
        }
    }
    files.iter().try_for_each(|(path, text)| write_atomic(path, text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read(reply: &Reply) -> (Vec<Value>, String) {
        let subject = Subject {
            name: "room",
            list: "proposals",
            mark: "text",
            code: "L4D560",
            failures: Path::new(""),
        };
        let (items, problem) = listing(reply, &subject);
        (items, problem.map_or_else(String::new, |problem| problem.message))
    }

    #[test]
    fn prose_fences_and_wrapping_do_not_matter() {
        for text in [
            r#"{"proposals":[{"text":"The cat"}]}"#,
            "Sure! [1] Here {you} go:\n```json\n{\"proposals\": [{\"text\": \"The cat\"}]}\n```\nAnything else?",
            r#"[{"text":"The cat"}]"#,
            r#"{"answer":{"proposals":[{"text":"The cat"}]}}"#,
        ] {
            let expected = (vec![json!({ "text": "The cat" })], String::new());
            assert_eq!(read(&Reply::saying(text)), expected, "{text}");
        }
        assert_eq!(read(&Reply::saying(r#"{"proposals":[]}"#)), (vec![], String::new()));
    }

    #[test]
    fn of_other_answers_whole_items_are_read_and_the_rest_has_a_reason() {
        let half = r#"{"proposals":[{"text":"a","frames":[[1,2]]},{"text":"b"},{"text":"c","fra"#;
        let many = format!("[{}]", vec![r#"{"text":"x"}"#; 1000].join(","));
        let deep = "{\"a\":[".repeat(2_000);
        let wide = "ä{".repeat(1 << 18);
        for (text, finish, count, reason) in [
            (half, Finish::Stop, 2, "2 whole items"),
            (half, Finish::Length, 2, "limit of tokens"),
            ("", Finish::Stop, 0, "is empty"),
            ("I am sorry, I see nothing.", Finish::Stop, 0, "I am sorry, I see nothing."),
            ("{{{{[[[[]]}}", Finish::Stop, 0, "no list"),
            ("", Finish::Refused("no people".into()), 0, "the model refused: no people"),
            (&many, Finish::Stop, MOST_ITEMS, "1000 items"),
            (&deep, Finish::Stop, 0, "no list"),
            (&wide, Finish::Stop, 0, "no list"),
        ] {
            let (items, problem) = read(&Reply { finish, ..Reply::saying(text) });
            assert_eq!(items.len(), count, "{text:.80}");
            assert!(problem.contains(reason), "{text:.80}: {problem:.80}");
        }
    }

    #[test]
    fn provenance_tames_what_the_server_calls_itself() {
        let endpoint = Endpoint::new("https://host.example:9/v1", "small-vl").unwrap();
        let model = Some(format!("big\u{1b}[0m{}", "x".repeat(1000)));
        let note = provenance(&endpoint, &Reply { model, ..Reply::saying("") }).note;
        assert!(note.starts_with("model small-vl (says it is big\u{fffd}[0mxxx") && note.len() < 300);
    }

    #[test]
    fn one_foreign_file_keeps_all_of_them_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        std::fs::write(&b, "of another model").unwrap();
        let files = [(a.clone(), "one".to_owned()), (b.clone(), "two".to_owned())];
        assert_eq!(write_unless_other(&files, false).unwrap_err().path(), b);
        assert!(!a.exists());
        write_unless_other(&files, true).unwrap();
        write_unless_other(&files, false).expect("the same again is fine");
        std::fs::write(&b, "").unwrap();
        write_unless_other(&files, false).expect("nothing is lost with an empty file");
    }
}
