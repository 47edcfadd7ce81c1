//! The part of the clip that is asked about: in frames or seconds, as options or within the sentence.

use std::fmt;
use std::str::FromStr;

use l4d_data::{Interval, StageError, Timeline};

/// A moment of the clip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClipTime {
    /// A frame of the timeline.
    Frame(u32),
    /// Seconds since the first frame.
    Seconds(f64),
}

impl FromStr for ClipTime {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let seconds = |number: &str| number.parse().ok().filter(|at: &f64| at.is_finite() && *at >= 0.0);
        let moment = match text.strip_suffix('s') {
            Some(number) => seconds(number).map(Self::Seconds),
            None => text.parse().ok().map(Self::Frame),
        };
        moment.ok_or_else(|| "neither a frame (`24`) nor a time (`1.5s`)".to_owned())
    }
}

impl fmt::Display for ClipTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame(frame) => write!(f, "{frame}"),
            Self::Seconds(seconds) => write!(f, "{seconds}s"),
        }
    }
}

impl ClipTime {
    /// The nearest frame, which may be beyond the clip.
    fn frame(self, timeline: Timeline) -> u32 {
        match self {
            Self::Frame(frame) => frame,
            Self::Seconds(seconds) => {
                let since_first = (seconds * timeline.frames_per_second()).round();
                timeline.whole().first().saturating_add(since_first as u32)
            }
        }
    }
}

/// The frames from one moment to another; none for the whole clip.
///
/// # Errors
/// Moments beyond the clip, and an end before its start.
pub(super) fn interval(
    [from, to]: [Option<ClipTime>; 2],
    timeline: Timeline,
) -> Result<Option<Interval>, StageError> {
    let whole = timeline.whole();
    for (flag, moment) in [("--from", from), ("--to", to)] {
        if let Some(moment) = moment.filter(|moment| !whole.contains(moment.frame(timeline))) {
            return Err(StageError::new(
                format!("{flag} {moment} is beyond the clip"),
                format!(
                    "frames are {} to {}, and the last is at {}s",
                    whole.first(),
                    whole.last(),
                    timeline.duration_s()
                ),
            ));
        }
    }
    let frame = |moment: Option<ClipTime>, usual| moment.map_or(usual, |moment| moment.frame(timeline));
    let range = Interval::new(frame(from, whole.first()), frame(to, whole.last())).map_err(|error| {
        StageError::new(format!("--from, --to: {error}"), "give the first moment to --from, the last to --to")
    })?;
    Ok((range != whole).then_some(range))
}

/// A sentence without what it says of seconds ("between second 1 and second 2", "after second 3", "before second 1.5"),
/// and that; none if it says nothing of them.
pub(super) fn in_sentence(text: &str) -> Option<(String, [Option<ClipTime>; 2])> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let plain: Vec<String> = words
        .iter()
        .map(|word| word.trim_end_matches(|end: char| ".,;:!?".contains(end)).to_lowercase())
        .collect();
    let plain: Vec<&str> = plain.iter().map(String::as_str).collect();
    let (place, length, span) = (0..plain.len()).find_map(|place| {
        let (length, span) = span_at(&plain[place..])?;
        Some((place, length, span))
    })?;
    let rest = [&words[..place], &words[place + length..]].concat().join(" ");
    Some((rest, span))
}

/// Words that speak of seconds at the beginning of these: how many, and what they say.
fn span_at(words: &[&str]) -> Option<(usize, [Option<ClipTime>; 2])> {
    let (first, rest) = words.split_first()?;
    let (from, used) = second(rest)?;
    match *first {
        "after" | "since" => Some((1 + used, [Some(from), None])),
        "before" | "until" => Some((1 + used, [None, Some(from)])),
        "between" | "from" => {
            let (joint, rest) = rest[used..].split_first()?;
            let is_joint = matches!((*first, *joint), ("between", "and") | ("from", "to" | "until"));
            // "from second 1 to 2": the unit is said once.
            let bare = || Some((ClipTime::Seconds(number(rest.first()?)?), 1));
            let (to, more) = is_joint.then(|| second(rest).or_else(bare)).flatten()?;
            Some((2 + used + more, [Some(from), Some(to)]))
        }
        _ => None,
    }
}

/// "second 1.5" or "1.5 seconds", and of how many words.
fn second(words: &[&str]) -> Option<(ClipTime, usize)> {
    let is_unit = |word: &str| matches!(word, "second" | "seconds" | "sec" | "s");
    match words {
        [unit, at, ..] if is_unit(unit) => Some((ClipTime::Seconds(number(at)?), 2)),
        [at, unit, ..] if is_unit(unit) => Some((ClipTime::Seconds(number(at)?), 2)),
        [at, ..] => at.strip_suffix('s').and_then(number).map(|at| (ClipTime::Seconds(at), 1)),
        [] => None,
    }
}

fn number(word: &(impl AsRef<str> + ?Sized)) -> Option<f64> {
    word.as_ref().parse().ok().filter(|at: &f64| at.is_finite() && *at >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(from: Option<f64>, to: Option<f64>) -> [Option<ClipTime>; 2] {
        [from, to].map(|at| at.map(ClipTime::Seconds))
    }

    #[test]
    fn moments_are_frames_or_seconds_within_the_clip() {
        assert_eq!("24".parse(), Ok(ClipTime::Frame(24)));
        assert_eq!("1.5s".parse(), Ok(ClipTime::Seconds(1.5)));
        for text in ["", "s", "-1", "-1s", "infs", "1.5", "two"] {
            assert!(text.parse::<ClipTime>().is_err(), "{text}");
        }
        let whole = Timeline::CANONICAL;
        let range =
            |from, to| interval([from, to], whole).map(|range| range.map(|it| (it.first(), it.last())));
        assert_eq!(range(None, None).unwrap(), None);
        assert_eq!(range(Some(ClipTime::Seconds(1.0)), Some(ClipTime::Frame(48))).unwrap(), Some((24, 48)));
        let error = range(None, Some(ClipTime::Seconds(9.0))).unwrap_err().to_string();
        assert!(error.contains("--to 9s is beyond the clip"), "{error}");
        assert!(range(Some(ClipTime::Seconds(f64::from(u32::MAX))), None).is_err());
        assert!(range(Some(ClipTime::Frame(9)), Some(ClipTime::Frame(3))).is_err());
    }

    #[test]
    fn sentences_say_seconds_in_several_ways() {
        let cases = [
            ("The cat that jumps between second 1 and second 2", Some(1.0), Some(2.0)),
            ("Between 1 second and 2.5 seconds the cat that jumps", Some(1.0), Some(2.5)),
            ("The cat that jumps from second 1 to 2.", Some(1.0), Some(2.0)),
            ("The cat that jumps after second 3", Some(3.0), None),
            ("The cat that jumps before 1.5s", None, Some(1.5)),
        ];
        for (text, from, to) in cases {
            let (rest, span) = in_sentence(text).unwrap();
            assert_eq!(span, seconds(from, to), "{text}");
            assert_eq!(rest.to_lowercase().trim_end_matches('.'), "the cat that jumps", "{text}");
        }
        for text in
            ["", "The cat between the table and the chair", "The second cat", "The cat after the second dog"]
        {
            assert_eq!(in_sentence(text), None, "{text}");
        }
    }
}
