//! The day of a board: when its newest numbers were counted, so that the same scores give the same page on any day.

use std::path::Path;
use std::time::{Duration, UNIX_EPOCH};

use l4d_score::score::counts_path;

use crate::board::Method;

/// Seconds since 1970, where what makes the page again says which day it is of.
const GIVEN: &str = "SOURCE_DATE_EPOCH";
/// The last second of the year 9999.
const LAST: u64 = 253_402_300_799;

/// As `2026-11-27`, in UTC: that of `SOURCE_DATE_EPOCH`, else of the newest `counts.csv`; none where neither says one.
pub(crate) fn of_scores(scores: &Path, methods: &[Method]) -> Option<String> {
    let given = std::env::var(GIVEN).ok().and_then(|seconds| seconds.parse::<u64>().ok());
    day(given.or_else(|| newest(scores, methods))?)
}

fn newest(scores: &Path, methods: &[Method]) -> Option<u64> {
    let counted = |method: &Method| {
        let path = counts_path(scores, method.name.as_str());
        path.metadata().ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()
    };
    methods.iter().filter_map(counted).max().map(|since| since.as_secs())
}

/// The day of a second since 1970; none after the year 9999.
fn day(seconds: u64) -> Option<String> {
    let at = UNIX_EPOCH + Duration::from_secs(Some(seconds).filter(|&seconds| seconds <= LAST)?);
    Some(humantime::format_rfc3339_seconds(at).to_string().split_once('T')?.0.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_of_the_day_that_calendars_say() {
        for (seconds, expected) in [
            (0, "1970-01-01"),
            (951_782_399, "2000-02-28"),
            (951_782_400, "2000-02-29"),
            (951_868_800, "2000-03-01"),
            (1_709_164_800, "2024-02-29"),
            (1_735_689_599, "2024-12-31"),
            (1_735_689_600, "2025-01-01"),
            (4_107_542_400, "2100-03-01"),
        ] {
            assert_eq!(day(seconds).as_deref(), Some(expected));
        }
    }
}
