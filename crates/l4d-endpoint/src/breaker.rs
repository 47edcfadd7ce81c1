//! A circuit breaker: after so many failures in a row, an endpoint is left alone for a while.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::config::Retry;
use crate::error::{EndpointError, Kind};

#[derive(Debug, Default)]
struct State {
    failures: u32,
    last: String,
    closed_until: Option<Instant>,
}

/// Counts failures of one endpoint.
#[derive(Debug)]
pub(crate) struct Breaker {
    url: String,
    limit: u32,
    rest: Duration,
    state: Mutex<State>,
}

impl Breaker {
    pub(crate) fn new(url: String, retry: &Retry) -> Self {
        let rest = Duration::from_secs_f64(retry.rest_seconds);
        Self { url, limit: retry.failures_in_a_row, rest, state: Mutex::default() }
    }

    /// Whether a question may be asked now. After the rest a single one may, to see whether the server is back.
    pub(crate) fn admit(&self) -> Result<(), EndpointError> {
        let mut state = self.lock();
        match state.closed_until {
            Some(until) if Instant::now() < until => Err(EndpointError::Broken {
                url: self.url.clone(),
                failures: state.failures,
                last: state.last.clone(),
            }),
            Some(_) => {
                state.closed_until = Some(Instant::now() + self.rest);
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Takes note of how a question ended.
    pub(crate) fn note<T>(&self, result: &Result<T, EndpointError>) {
        let mut state = self.lock();
        match result {
            Err(error) if is_the_servers_fault(error) => {
                state.failures += 1;
                state.last = error.to_string();
                if state.failures >= self.limit {
                    state.closed_until = Some(Instant::now() + self.rest);
                }
            }
            // It answered, if only to say no.
            _ => *state = State::default(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn is_the_servers_fault(error: &EndpointError) -> bool {
    error.is_passing() || matches!(error.kind(), Kind::Transport | Kind::RateLimit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Fault;

    fn down() -> Result<(), EndpointError> {
        let (url, message) = (String::new(), "connection refused".to_owned());
        Err(EndpointError::Transport { url, fault: Fault::NoConnection, message })
    }

    #[test]
    fn opens_after_so_many_failures_in_a_row_and_lets_one_through_after_the_rest() {
        let retry = Retry { failures_in_a_row: 3, rest_seconds: 0.05, ..Retry::default() };
        let breaker = Breaker::new("http://x".to_owned(), &retry);
        for result in [down(), down(), Ok(()), down(), down()] {
            breaker.note(&result);
            breaker.admit().unwrap();
        }
        breaker.note(&down());
        let error = breaker.admit().unwrap_err();
        assert!(error.to_string().contains("3 failures in a row") && error.to_string().contains("refused"));
        std::thread::sleep(Duration::from_millis(60));
        breaker.admit().unwrap();
        assert!(breaker.admit().is_err(), "a second question came through with the first");
        breaker.note(&Ok::<_, EndpointError>(()));
        breaker.admit().unwrap();
    }

    #[test]
    fn a_server_that_says_no_is_not_broken() {
        let breaker = Breaker::new(String::new(), &Retry { failures_in_a_row: 1, ..Retry::default() });
        breaker.note(&Err::<(), _>(EndpointError::Refused { message: String::new() }));
        breaker.admit().unwrap();
    }
}
