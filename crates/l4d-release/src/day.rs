//! A day of the calendar, as people write it into files.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// `YYYY-MM-DD`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Day(String);

impl FromStr for Day {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.len() == 10 && humantime::parse_rfc3339(&format!("{text}T00:00:00Z")).is_ok() {
            true => Ok(Self(text.to_owned())),
            false => {
                Err(format!("`{}` is no day: write YYYY-MM-DD, for example 2026-11-22", text.escape_debug()))
            }
        }
    }
}

impl TryFrom<String> for Day {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Day> for String {
    fn from(day: Day) -> Self {
        day.0
    }
}

impl fmt::Display for Day {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Day;

    #[test]
    fn days_of_the_calendar_alone() {
        assert_eq!("2028-02-29".parse::<Day>().unwrap().to_string(), "2028-02-29");
        for bad in
            ["", "2026-02-29", "2026-13-01", "26-01-01", "2026-1-1", "2026-01-01T", "2026/01/01", "today"]
        {
            assert!(bad.parse::<Day>().is_err(), "{bad}");
        }
    }
}
