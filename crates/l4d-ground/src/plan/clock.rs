//! The clock of a question: the n-th picture is labelled with second n, whatever its time in the clip.
//!
//! Models of the Qwen family were trained on labels such as `<7.0 seconds>` with one decimal. Real times would collide
//! there at 24 frames a second; counted pictures never do, and an answer's time is an index.

use serde_json::Value;

/// Times further than this from a label belong to no picture.
const TOLERANCE: f64 = 0.25;

/// Which frame each label means: those that are sent, ascending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Clock(pub(crate) Vec<u32>);

impl Clock {
    /// The text before the picture of this index.
    pub(crate) fn label(index: usize) -> String {
        format!("<{index}.0 seconds>")
    }

    /// The canonical frame that a time of an answer means: a number, or text with a number in it.
    pub(crate) fn frame(&self, time: &Value) -> Option<u32> {
        let seconds = seconds(time)?;
        let index = seconds.round();
        let is_label = index >= 0.0 && (seconds - index).abs() <= TOLERANCE;
        self.0.get(index as usize).copied().filter(|_| is_label)
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

    #[test]
    fn times_are_matched_as_numbers() {
        let clock = Clock((0..12).map(|index| index * 8).collect());
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
            assert_eq!(clock.frame(&time), frame, "{time}");
        }
        assert_eq!(Clock::label(7), "<7.0 seconds>");
        assert_eq!(clock.frame(&Clock::label(7).into()), Some(56));
    }
}
