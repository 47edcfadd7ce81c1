//! What asking and segmenting cost. Kept apart from answers, which must not depend on a clock or a cache.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use l4d_endpoint::{EndpointError, Origin, Reply};
use serde::Serialize;

/// What a grounder has spent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Account {
    /// Replies that a server gave.
    pub replies: u64,
    /// Replies that came from the cache or a recording.
    pub kept: u64,
    /// Questions without a reply.
    pub failed: u64,
    /// Tokens of questions that a server answered, as far as it counts them.
    pub prompt_tokens: u64,
    /// Tokens of its answers.
    pub completion_tokens: u64,
    /// Waited for replies, over all threads.
    pub asking_seconds: f64,
    /// Requests to the segmenter.
    pub segmented: u64,
    /// Of them, without an answer.
    pub segmenting_failed: u64,
    /// Waited for masks, over all threads.
    pub segmenting_seconds: f64,
}

/// An account that threads share.
#[derive(Debug, Default)]
pub(super) struct Books(Mutex<Account>);

impl Books {
    pub(super) fn account(&self) -> Account {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn note_asking(&self, result: &Result<Reply, EndpointError>, waited: Duration) {
        let mut account = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        account.asking_seconds += waited.as_secs_f64();
        match result {
            Ok(reply) if reply.origin == Origin::Server => {
                account.replies += 1;
                account.prompt_tokens += reply.usage.prompt_tokens.unwrap_or(0);
                account.completion_tokens += reply.usage.completion_tokens.unwrap_or(0);
            }
            Ok(_) => account.kept += 1,
            Err(_) => account.failed += 1,
        }
    }

    pub(super) fn note_segmenting(&self, is_ok: bool, waited: Duration) {
        let mut account = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        account.segmented += 1;
        account.segmenting_failed += u64::from(!is_ok);
        account.segmenting_seconds += waited.as_secs_f64();
    }
}
