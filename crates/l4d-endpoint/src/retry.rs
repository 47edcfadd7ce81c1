//! Patience: which failures are worth another try, and how long to wait for it.

use std::time::{Duration, Instant, SystemTime};

use crate::call::Response;
use crate::config::{Retry, Timeouts};
use crate::error::{EndpointError, Fault};

/// Statuses after which the same question may well succeed.
pub(crate) fn is_passing(status: u16) -> bool {
    matches!(status, 408 | 409 | 429 | 500..=599)
}

impl EndpointError {
    /// Whether the same question may well succeed in a while.
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Transport { fault, .. } => {
                matches!(fault, Fault::NoConnection | Fault::Timeout | Fault::Reset)
            }
            Self::Status { status, .. } | Self::RateLimit { status, .. } => is_passing(*status),
            Self::ErrorBody { code, .. } => code.is_some_and(is_passing),
            _ => false,
        }
    }

    fn retry_after(&self) -> Option<Duration> {
        match self {
            Self::Status { retry_after, .. } | Self::RateLimit { retry_after, .. } => *retry_after,
            _ => None,
        }
    }
}

/// Tries until something else than a passing failure comes back, or patience ends. `attempt` gets the time that is
/// left for it.
pub(crate) fn patiently<T>(
    retry: &Retry,
    timeouts: &Timeouts,
    mut attempt: impl FnMut(Duration) -> Result<T, EndpointError>,
) -> Result<T, EndpointError> {
    let deadline = Instant::now() + Duration::from_secs_f64(timeouts.total_seconds);
    let one_try = Duration::from_secs_f64(timeouts.request_seconds);
    let mut tries = 1;
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let error = match attempt(one_try.min(left).max(Duration::from_millis(1))) {
            Ok(value) => return Ok(value),
            Err(error) if tries < retry.tries && error.is_passing() => error,
            Err(error) => return Err(error),
        };
        let pause = pause(retry, tries, error.retry_after());
        if Instant::now() + pause >= deadline {
            return Err(error);
        }
        tracing::debug!("try {tries} of {}: {error}; next in {:.1} s", retry.tries, pause.as_secs_f64());
        std::thread::sleep(pause);
        tries += 1;
    }
}

/// A random part of an exponentially growing span ("full jitter"), so that clients which failed together do not
/// come back together; never less than the server asked for.
fn pause(retry: &Retry, tries: u32, retry_after: Option<Duration>) -> Duration {
    let doubled = retry.first_pause_seconds * 2_f64.powi(tries.min(32) as i32 - 1);
    let span = doubled.min(retry.longest_pause_seconds);
    let jittered = Duration::from_secs_f64(span * fastrand::f64());
    match retry_after {
        None => jittered,
        // The jitter stays: everyone was told the same moment.
        Some(asked) => asked + jittered.min(asked / 4 + Duration::from_millis(50)),
    }
}

/// What a server asks for in `Retry-After` (seconds or an HTTP date) or `retry-after-ms`.
pub(crate) fn retry_after(response: &Response) -> Option<Duration> {
    /// Longer waits are the same as never.
    const LONGEST_SECONDS: f64 = 1e6;
    let span = |seconds: f64| (seconds >= 0.0).then(|| Duration::from_secs_f64(seconds.min(LONGEST_SECONDS)));
    if let Some(milliseconds) =
        response.header("retry-after-ms").and_then(|text| text.trim().parse::<f64>().ok())
    {
        return span(milliseconds / 1000.0);
    }
    let text = response.header("retry-after")?.trim();
    if let Ok(seconds) = text.parse::<f64>() {
        return span(seconds);
    }
    let date = httpdate::parse_http_date(text).ok()?;
    // Counted from the server's own clock where it tells, since ours may be off.
    let now = response.header("date").and_then(|date| httpdate::parse_http_date(date).ok());
    let now = now.unwrap_or_else(SystemTime::now);
    span(date.duration_since(now).unwrap_or_default().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn response(headers: &[(&str, &str)]) -> Response {
        let headers = headers.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        Response { status: 429, headers, body: String::new() }
    }

    fn asked(headers: &[(&str, &str)]) -> Option<f64> {
        retry_after(&response(headers)).map(|span| span.as_secs_f64())
    }

    fn status(status: u16, retry_after: Option<Duration>) -> EndpointError {
        EndpointError::Status { url: String::new(), status, retry_after, message: String::new() }
    }

    #[test]
    fn retry_after_is_read_as_seconds_milliseconds_or_date() {
        let date = ("date", "Fri, 20 Nov 2026 10:00:00 GMT");
        assert_eq!(asked(&[("retry-after", "7")]), Some(7.0));
        assert_eq!(asked(&[("retry-after", "0.5")]), Some(0.5));
        assert_eq!(asked(&[("retry-after", "7"), ("retry-after-ms", "250")]), Some(0.25));
        assert_eq!(asked(&[("retry-after", "Fri, 20 Nov 2026 10:00:30 GMT"), date]), Some(30.0));
        assert_eq!(asked(&[("retry-after", "Fri, 20 Nov 2026 09:00:00 GMT"), date]), Some(0.0));
        let future = SystemTime::now() + Duration::from_secs(100);
        let seconds = asked(&[("retry-after", &httpdate::fmt_http_date(future))]).unwrap();
        assert!((97.0..=100.0).contains(&seconds), "{seconds}");
    }

    #[test]
    fn nonsense_in_retry_after_is_no_wait_and_no_panic() {
        for text in ["", "soon", "-3", "NaN", "inf", "1e400", "99999999999999999999"] {
            let seconds = asked(&[("retry-after", text)]);
            assert!(seconds.is_none_or(|seconds| seconds <= 1e6), "{text}: {seconds:?}");
        }
    }

    #[test]
    fn pauses_grow_to_their_cap_and_are_spread_over_the_whole_span() {
        let retry = Retry { first_pause_seconds: 1.0, longest_pause_seconds: 5.0, ..Retry::default() };
        for (tries, span) in [(1, 1.0), (2, 2.0), (3, 4.0), (4, 5.0), (90, 5.0)] {
            let pauses: Vec<f64> = (0..400).map(|_| pause(&retry, tries, None).as_secs_f64()).collect();
            let (low, high) =
                pauses.iter().fold((f64::MAX, 0.0_f64), |(low, high), &s| (low.min(s), high.max(s)));
            assert!(high <= span && high > 0.9 * span && low < 0.1 * span, "{tries}: {low} to {high}");
        }
        let asked = Duration::from_secs(8);
        assert!(pause(&retry, 1, Some(asked)) >= asked);
    }

    #[test]
    fn only_passing_failures_are_tried_again() {
        let retry = Retry { tries: 4, first_pause_seconds: 0.001, ..Retry::default() };
        let tries = |code: u16| {
            let mut count = 0;
            let result: Result<(), _> = patiently(&retry, &Timeouts::default(), |_| {
                count += 1;
                Err(status(code, None))
            });
            assert!(result.is_err());
            count
        };
        assert_eq!([400, 401, 403, 404, 413, 422].map(tries), [1; 6]);
        assert_eq!([408, 409, 429, 500, 503].map(tries), [4; 5]);
    }

    #[test]
    fn a_wait_beyond_the_deadline_ends_at_once_with_the_failure() {
        let timeouts = Timeouts { total_seconds: 2.0, ..Timeouts::default() };
        let start = Instant::now();
        let mut count = 0;
        let result: Result<(), _> = patiently(&Retry::default(), &timeouts, |left| {
            assert!(left <= Duration::from_secs(2));
            count += 1;
            Err(status(503, Some(Duration::from_secs(60))))
        });
        assert!(matches!(result, Err(EndpointError::Status { status: 503, .. })));
        assert_eq!(count, 1);
        assert!(start.elapsed() < Duration::from_secs(1));
    }
}
