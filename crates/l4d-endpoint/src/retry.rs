//! Which failures are tried again, and how long to wait before.

use std::time::{Duration, Instant, SystemTime};

use backon::{BackoffBuilder, ExponentialBuilder};

use crate::config::{Retry, Timeouts};
use crate::error::EndpointError;
use crate::exchange::Response;

const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// Statuses after which the same question may succeed.
pub(crate) fn is_passing(status: u16) -> bool {
    matches!(status, 408 | 409 | 429 | 500..=599)
}

/// Tries until something other than a passing failure comes back, or time or tries are used up. `attempt` gets the
/// time that is left for it; `seed` spreads the pauses of questions that failed together.
///
/// The loop is not backon's own, which cannot take a longer pause from an error.
pub(crate) fn with_retries<T>(
    retry: &Retry,
    timeouts: &Timeouts,
    seed: u64,
    sleep: impl Fn(Duration),
    mut attempt: impl FnMut(Duration) -> Result<T, EndpointError>,
) -> Result<T, EndpointError> {
    let mut pauses = ExponentialBuilder::new()
        .with_factor(2.0)
        .with_min_delay(Duration::from_secs_f64(retry.first_pause_seconds))
        .with_max_delay(LONGEST_PAUSE)
        .with_max_times(retry.tries as usize - 1)
        .with_jitter()
        .with_jitter_seed(seed)
        .build();
    let deadline = Instant::now() + Duration::from_secs_f64(timeouts.total_seconds);
    let one_try = Duration::from_secs_f64(timeouts.request_seconds);
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let error = match attempt(one_try.min(left).max(Duration::from_millis(1))) {
            Err(EndpointError::Server(failure)) if failure.is_passing => failure,
            result => return result,
        };
        let asked = error.retry_after.unwrap_or_default();
        match pauses.next().map(|pause| pause.max(asked)) {
            Some(pause) if Instant::now() + pause < deadline => {
                tracing::debug!("{error}; next try in {:.1} s", pause.as_secs_f64());
                sleep(pause);
            }
            _ => return Err(error.into()),
        }
    }
}

/// What a server asks for in `Retry-After` (seconds or an HTTP date) or `retry-after-ms`.
pub(crate) fn retry_after(response: &Response) -> Option<Duration> {
    /// Longer waits are the same as never.
    const LONGEST_SECONDS: f64 = 1e6;
    let span = |seconds: f64| (seconds >= 0.0).then(|| Duration::from_secs_f64(seconds.min(LONGEST_SECONDS)));
    let number = |header: &str| response.header(header)?.trim().parse::<f64>().ok();
    if let Some(milliseconds) = number("retry-after-ms") {
        return span(milliseconds / 1000.0);
    }
    if let Some(seconds) = number("retry-after") {
        return span(seconds);
    }
    let date = |header: &str| httpdate::parse_http_date(response.header(header)?.trim()).ok();
    // Counted from the server's own clock where it tells, since ours may be off.
    let now = date("date").unwrap_or_else(SystemTime::now);
    span(date("retry-after")?.duration_since(now).unwrap_or_default().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;
    use crate::error::Failure;

    /// The pauses between tries of a server that always fails in this way, seconds.
    fn pauses(retry: &Retry, is_passing: bool, retry_after: Option<f64>) -> Vec<f64> {
        let slept = RefCell::new(Vec::new());
        let sleep = |pause: Duration| slept.borrow_mut().push(pause.as_secs_f64());
        let result: Result<(), _> = with_retries(retry, &Timeouts::default(), 7, sleep, |left| {
            assert!(left <= Duration::from_secs(300));
            let retry_after = retry_after.map(Duration::from_secs_f64);
            Err(Failure { is_passing, retry_after, ..Failure::lasting("", "", "") }.into())
        });
        assert!(result.is_err());
        slept.into_inner()
    }

    #[test]
    fn pauses_double_to_their_cap_and_never_undercut_what_the_server_asks() {
        let retry = Retry { tries: 6, first_pause_seconds: 10.0 };
        let spans = [10.0, 20.0, 40.0, 60.0, 60.0];
        let found = pauses(&retry, true, None);
        assert_eq!(found.len(), spans.len());
        assert!(found.iter().zip(spans).all(|(pause, span)| (span..2.0 * span).contains(pause)), "{found:?}");
        assert_eq!(found, pauses(&retry, true, None), "one seed, two answers");
        assert_eq!(pauses(&retry, true, Some(150.0)), [150.0; 5]);
        assert!(pauses(&retry, false, None).is_empty());
        assert!(pauses(&retry, true, Some(3600.0)).is_empty(), "a wait beyond the deadline");
    }

    #[test]
    fn retry_after_is_seconds_milliseconds_or_a_date_and_nonsense_is_no_wait() {
        let asked = |headers: &[(&str, &str)]| {
            let headers = headers.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
            let response = Response { status: 429, headers: headers.collect(), body: String::new() };
            retry_after(&response).map(|span| span.as_secs_f64())
        };
        let date = ("date", "Fri, 20 Nov 2026 10:00:00 GMT");
        assert_eq!(asked(&[("retry-after", "7")]), Some(7.0));
        assert_eq!(asked(&[("retry-after", "0.5")]), Some(0.5));
        assert_eq!(asked(&[("retry-after", "7"), ("retry-after-ms", "250")]), Some(0.25));
        assert_eq!(asked(&[("retry-after", "Fri, 20 Nov 2026 10:00:30 GMT"), date]), Some(30.0));
        assert_eq!(asked(&[("retry-after", "Fri, 20 Nov 2026 09:00:00 GMT"), date]), Some(0.0));
        for text in ["", "soon", "-3", "NaN", "inf", "1e400", "99999999999999999999"] {
            let seconds = asked(&[("retry-after", text)]);
            assert!(seconds.is_none_or(|seconds| seconds <= 1e6), "{text}: {seconds:?}");
        }
    }
}
