//! The day of a board: when its newest numbers were counted, so that the same scores give the same page on any day.

use std::path::Path;
use std::time::UNIX_EPOCH;

use l4d_score::score::counts_path;

use crate::board::Method;

/// Seconds since 1970, where what makes the page again says which day it is of.
const GIVEN: &str = "SOURCE_DATE_EPOCH";
const SECONDS_A_DAY: u64 = 86_400;

/// As `2026-11-27`, in UTC: that of `SOURCE_DATE_EPOCH`, else of the newest `counts.csv`; none where neither says one.
pub(crate) fn of_scores(scores: &Path, methods: &[Method]) -> Option<String> {
    let given = std::env::var(GIVEN).ok().and_then(|seconds| seconds.parse::<u64>().ok());
    given.or_else(|| newest(scores, methods)).map(day)
}

fn newest(scores: &Path, methods: &[Method]) -> Option<u64> {
    let counted = |method: &Method| {
        let path = counts_path(scores, method.name.as_str());
        path.metadata().ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()
    };
    methods.iter().filter_map(counted).max().map(|since| since.as_secs())
}

/// The Gregorian day of a second since 1970. Years begin in March, so that the day of a leap year is their last.
fn day(seconds: u64) -> String {
    // Days since the first of March of the year 0; 400 years have 146 097 of them.
    let days = seconds / SECONDS_A_DAY + 719_468;
    let (age, left) = (days / 146_097, days % 146_097);
    let year = (left - left / 1460 + left / 36_524 - left / 146_096) / 365;
    let day_of_year = left - (365 * year + year / 4 - year / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let (month, later) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    format!("{:04}-{month:02}-{day:02}", 400 * age + year + later)
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
            assert_eq!(day(seconds), expected);
        }
    }
}
