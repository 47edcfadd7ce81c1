//! The clock of a question: the n-th picture is labelled with second n, whatever its time in the clip.
//!
//! Models of the Qwen family were trained on labels such as `<7.0 seconds>` with one decimal. Real times would collide
//! there at 24 frames a second; counted pictures never do, and an answer's time is an index.

use l4d_data::Interval;
use serde_json::Value;

/// Times further than this from a label belong to no picture.
const TOLERANCE: f64 = 0.25;

/// Which frame each label means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Clock {
    sent: Vec<u32>,
    first: u32,
    last: u32,
}

impl Clock {
    /// A clock of the frames that are sent, ascending, out of the frames that are asked about.
    pub(crate) fn new(sent: Vec<u32>, asked: Interval) -> Self {
        Self { sent, first: asked.first(), last: asked.last() }
    }

    /// The frames that are sent, ascending.
    pub(crate) fn sent(&self) -> &[u32] {
        &self.sent
    }

    /// The text before the picture of this index.
    pub(crate) fn label(index: usize) -> String {
        format!("<{index}.0 seconds>")
    }

    /// The canonical frame that a time of an answer means: a number, or text with a number in it.
    pub(crate) fn frame(&self, time: &Value) -> Option<u32> {
        self.sent.get(self.index(time)?).copied()
    }

    /// The canonical frames between two times of an answer, up to half way to the next picture on either side, since
    /// nothing is known in between.
    pub(crate) fn interval(&self, start: &Value, end: &Value) -> Option<Interval> {
        let [start, end] = [seconds(start)?, seconds(end)?];
        let last = self.sent.len().checked_sub(1)? as f64;
        if !(start <= end && start <= last + TOLERANCE && end >= -TOLERANCE) {
            return None;
        }
        // Seconds between two labels count for the pictures that they enclose.
        let from = (start - TOLERANCE).ceil().clamp(0.0, last) as usize;
        let to = (end + TOLERANCE).floor().clamp(0.0, last) as usize;
        if from > to {
            return None;
        }
        let (first, before) =
            (*self.sent.get(from)?, from.checked_sub(1).and_then(|index| self.sent.get(index)));
        let (last, after) = (*self.sent.get(to)?, self.sent.get(to + 1));
        let first = before.map_or(self.first.min(first), |before| (before + first).div_ceil(2));
        let last = after.map_or(self.last.max(last), |after| (last + after) / 2);
        Interval::new(first, last).ok()
    }

    fn index(&self, time: &Value) -> Option<usize> {
        let seconds = seconds(time)?;
        let index = seconds.round();
        let is_label = index >= 0.0 && index < self.sent.len() as f64 && (seconds - index).abs() <= TOLERANCE;
        is_label.then_some(index as usize)
    }
}

/// Seconds in a number, in `7.0`, `<7.0 seconds>`, `7s` or `00:07.00`.
fn seconds(time: &Value) -> Option<f64> {
    if let Some(number) = time.as_f64() {
        return Some(number);
    }
    let text = time.as_str()?.trim().trim_start_matches('<').trim_end_matches('>');
    let number: String =
        text.chars().take_while(|letter| letter.is_ascii_digit() || matches!(letter, '.' | ':')).collect();
    // Words before the number, or a second number behind it, could mean anything.
    if text[number.len()..].chars().any(|letter| letter.is_ascii_digit()) {
        return None;
    }
    let mut total = 0.0;
    for part in number.split(':') {
        total = total * 60.0 + part.parse::<f64>().ok()?;
    }
    Some(total).filter(|total| total.is_finite())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn clock() -> Clock {
        Clock::new((0..12).map(|index| index * 8).collect(), Interval::WHOLE)
    }

    #[test]
    fn times_are_matched_as_numbers() {
        for (time, frame) in [
            (json!(1), Some(8)),
            (json!(11.0), Some(88)),
            (json!("1.0"), Some(8)),
            (json!("<11.0 seconds>"), Some(88)),
            (json!("7s"), Some(56)),
            (json!("00:07.00"), Some(56)),
            (json!("01:07"), None),
            (json!(0.2), Some(0)),
            (json!(0.5), None),
            (json!(12), None),
            (json!(-1), None),
            (json!(1e300), None),
            (json!("seven"), None),
            (json!(""), None),
            (json!("1.0 to 3.0"), None),
            (json!("1:2:3:4:5:6:7:8"), None),
            (json!(null), None),
            (json!([1]), None),
        ] {
            assert_eq!(clock().frame(&time), frame, "{time}");
        }
        assert_eq!(Clock::label(7), "<7.0 seconds>");
        assert_eq!(clock().frame(&Clock::label(7).into()), Some(56));
    }

    #[test]
    fn intervals_reach_half_way_to_the_next_picture() {
        let interval = |start: Value, end: Value| clock().interval(&start, &end).map(<[u32; 2]>::from);
        assert_eq!(interval(json!(1.0), json!(2.0)), Some([4, 20]));
        assert_eq!(interval(json!(0), json!("00:11.00")), Some([0, 96]));
        assert_eq!(interval(json!(11), json!(40)), Some([84, 96]));
        assert_eq!(interval(json!(1.5), json!(3.4)), Some([12, 28]));
        assert_eq!(interval(json!(3), json!(1)), None);
        assert_eq!(interval(json!(20), json!(30)), None);
        assert_eq!(interval(json!(1.4), json!(1.6)), None, "no picture in between");
        let none = Clock::new(Vec::new(), Interval::WHOLE);
        assert_eq!(none.interval(&json!(0), &json!(1)), None);
    }
}
