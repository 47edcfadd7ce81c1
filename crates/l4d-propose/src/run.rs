//! What both verbs do with a question and its answer.

use l4d_data::query::Provenance;
use l4d_endpoint::{Endpoint, Origin, Reply, Request};

use crate::quote::printable;

/// How far answers may stray from the likeliest one when something is asked again.
const TEMPERATURE_OF_REPEATS: f64 = 0.7;
const LONGEST_MODEL: usize = 80;

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

/// Which model said it, where, in answer to which question. Never a key: an endpoint doesn't hold any.
pub(crate) fn provenance(endpoint: &Endpoint, reply: &Reply) -> Provenance {
    let own_name = reply.model.as_ref().filter(|model| **model != endpoint.model);
    let own_name = own_name.map_or_else(String::new, |model| {
        format!(" (says it is {})", printable(model).chars().take(LONGEST_MODEL).collect::<String>())
    });
    let (model, host) = (&endpoint.model, endpoint.base_url.authority());
    let note = format!("model {model}{own_name}, endpoint {host}, question {}", reply.digest);
    Provenance { source: "model".to_owned(), note }
}

/// Where an answer came from.
pub(crate) fn origin(origin: Origin) -> &'static str {
    match origin {
        Origin::Server => "server",
        Origin::Cache => "cache",
        Origin::Recording => "recording",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asking_again_is_another_question() {
        let question = || Request::new(Vec::new());
        let first = AskOptions::default().apply(question());
        assert_eq!(first, question());
        let again = AskOptions { repeat: 2, answer_tokens: Some(7) }.apply(question());
        assert_eq!((again.seed, again.repeat, again.max_tokens), (Some(2), 2, 7));
        assert_ne!(again.temperature, first.temperature);
    }

    #[test]
    fn provenance_says_who_and_tames_what_the_server_calls_itself() {
        let endpoint = Endpoint::new("https://host.example:9/v1", "small-vl").unwrap();
        let mut answer = Reply::saying("");
        let plain = format!("model small-vl, endpoint host.example:9, question {}", "d".repeat(64));
        assert_eq!(provenance(&endpoint, &answer).note, plain);
        answer.model = Some(format!("big\u{1b}[0m{}", "x".repeat(1000)));
        let note = provenance(&endpoint, &answer).note;
        assert!(
            note.starts_with("model small-vl (says it is big\u{fffd}[0mxxx") && note.len() < 300,
            "{note}"
        );
    }
}
