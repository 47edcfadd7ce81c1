//! What of a picture of numbers belongs to a mask.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

use l4d_masks::Mask;
use serde::{Deserialize, Serialize};

use super::codec::Problem;
use super::codes;
use super::relevancy::{self, Rules, Smoothing};

/// The rule, as presets and the command line write it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Inside {
    /// `mask`: two values, one of them 0; everything else is refused rather than guessed.
    Mask,
    /// `nonzero`: whatever is not 0.
    Nonzero,
    /// `above 127`: whatever is larger.
    Above(f32),
    /// `index 3`: one index of a palette, one id of a map.
    Index(u32),
    /// `selected`: the ids that a selection lists for the sentence.
    Selected,
    /// `relative 0.4`: above `(1 + t) / 2` of the picture's own range.
    Relative(f32),
    /// `langsplat 0.4`: the same after LangSplat's smoothing, and with its majority of neighbours.
    LangSplat(f32),
    /// `4d-langsplat 0.4`: the same with the smoothing of LangSplatV2 and 4D LangSplat.
    FourDLangSplat(f32),
}

impl FromStr for Inside {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (word, number) = text.split_once(' ').unwrap_or((text, ""));
        let number = number.trim();
        let share = || number.parse().ok().filter(|share| (0.0..1.0).contains(share));
        let rule = match (word, number.is_empty()) {
            ("mask", true) => Some(Self::Mask),
            ("nonzero", true) => Some(Self::Nonzero),
            ("selected", true) => Some(Self::Selected),
            ("above", false) => number.parse().ok().filter(|n: &f32| n.is_finite()).map(Self::Above),
            ("index", false) => number.parse().ok().map(Self::Index),
            ("relative", false) => share().map(Self::Relative),
            ("langsplat", false) => share().map(Self::LangSplat),
            ("4d-langsplat", false) => share().map(Self::FourDLangSplat),
            _ => None,
        };
        rule.ok_or_else(|| {
            format!(
                "`{}` is no rule: use mask, nonzero, above <n>, index <n>, selected, relative <t>, langsplat <t> or \
                 4d-langsplat <t>, with t from 0 to below 1",
                l4d_data::error::inert(text)
            )
        })
    }
}

impl TryFrom<String> for Inside {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Inside> for String {
    fn from(rule: Inside) -> Self {
        rule.to_string()
    }
}

impl fmt::Display for Inside {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mask => formatter.write_str("mask"),
            Self::Nonzero => formatter.write_str("nonzero"),
            Self::Above(number) => write!(formatter, "above {number}"),
            Self::Index(index) => write!(formatter, "index {index}"),
            Self::Selected => formatter.write_str("selected"),
            Self::Relative(share) => write!(formatter, "relative {share}"),
            Self::LangSplat(share) => write!(formatter, "langsplat {share}"),
            Self::FourDLangSplat(share) => write!(formatter, "4d-langsplat {share}"),
        }
    }
}

impl Inside {
    /// The pixels that belong to the mask. `selected` are the ids that count under [`Inside::Selected`].
    ///
    /// # Errors
    /// Numbers that the rule cannot read.
    pub fn cut(
        &self,
        values: &[f32],
        width: u32,
        height: u32,
        selected: &BTreeSet<u32>,
    ) -> Result<Mask, Problem> {
        let problem = |code, message: String, hint| Err(Problem::new(code, "numbers", message, hint));
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            let (row, col) = (index / width as usize, index % width as usize);
            let hint = "find out where the method divides by zero; numbers that are none are no answer";
            return problem(codes::NOT_FINITE, format!("pixel ({col}, {row}) is {}", values[index]), hint);
        }
        let peak = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let floor = values.iter().copied().fold(f32::INFINITY, f32::min);
        let by = |test: &dyn Fn(f32) -> bool| {
            Mask::from_fn(width, height, |col, row| {
                test(values[row as usize * width as usize + col as usize])
            })
        };
        let is_id = |value: f32, id: u32| value >= 0.0 && value.fract() == 0.0 && value as u32 == id;
        let mask = match *self {
            Self::Mask => {
                if let Some(stray) = values.iter().find(|&&value| value != 0.0 && value != peak) {
                    let message =
                        format!("has the values 0, {stray} and {peak}, but a mask has 0 and one other");
                    let hint = "say what is inside: --inside nonzero, \"above 127\" or \"index 3\"";
                    return problem(codes::AMBIGUOUS_MASK, message, hint);
                }
                by(&|value| value != 0.0)
            }
            Self::Nonzero => by(&|value| value != 0.0),
            Self::Above(bound) => by(&|value| value > bound),
            Self::Index(id) => by(&|value| is_id(value, id)),
            Self::Selected => by(&|value| selected.iter().any(|&id| is_id(value, id))),
            Self::Relative(_) | Self::LangSplat(_) | Self::FourDLangSplat(_) if peak == floor => {
                let message = format!("is {peak} everywhere, so that nothing can stand out");
                let hint = "the map is blank: check that the checkpoint was loaded and that the decoder belongs to the latents";
                return problem(codes::CONSTANT, message, hint);
            }
            Self::Relative(share) => {
                by(&|value| (value - floor) / ((peak - floor) + 1e-9) * 2.0 - 1.0 > share)
            }
            Self::LangSplat(threshold) => {
                return Ok(smoothed(values, width, height, Smoothing::Box30, threshold));
            }
            Self::FourDLangSplat(threshold) => {
                return Ok(smoothed(values, width, height, Smoothing::Pool29, threshold));
            }
        };
        Ok(mask)
    }
}

fn smoothed(values: &[f32], width: u32, height: u32, smoothing: Smoothing, threshold: f32) -> Mask {
    let rules = Rules { smoothing, threshold, stretch_positive: false };
    relevancy::of_map(values.to_vec(), width, height, &rules).mask
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(rule: &str, values: &[f32]) -> Result<Vec<bool>, Problem> {
        let selected = BTreeSet::from([3, 5]);
        let rule: Inside = rule.parse().unwrap();
        rule.cut(values, values.len() as u32, 1, &selected).map(|mask| mask.to_bools())
    }

    #[test]
    fn each_rule_takes_its_pixels() {
        let values = [0.0, 3.0, 128.0, 255.0];
        assert_eq!(cut("nonzero", &values).unwrap(), [false, true, true, true]);
        assert_eq!(cut("above 128", &values).unwrap(), [false, false, false, true]);
        assert_eq!(cut("index 3", &values).unwrap(), [false, true, false, false]);
        assert_eq!(cut("selected", &values).unwrap(), [false, true, false, false]);
        assert_eq!(cut("relative 0", &values).unwrap(), [false, false, true, true]);
        assert_eq!(cut("mask", &[0.0, 255.0]).unwrap(), [false, true]);
        assert_eq!(cut("mask", &[0.0, 0.0]).unwrap(), [false, false]);
    }

    #[test]
    fn numbers_that_a_rule_cannot_read_are_refused() {
        for (rule, values, code) in [
            ("mask", &[0.0, 128.0, 255.0][..], codes::AMBIGUOUS_MASK),
            ("mask", &[7.0, 255.0], codes::AMBIGUOUS_MASK),
            ("relative 0.4", &[0.5, 0.5], codes::CONSTANT),
            ("nonzero", &[0.0, f32::NAN], codes::NOT_FINITE),
        ] {
            assert_eq!(cut(rule, values).unwrap_err().code, code, "{rule}");
        }
    }

    #[test]
    fn rules_are_written_as_they_are_read() {
        for text in [
            "mask",
            "nonzero",
            "above 0.5",
            "index 3",
            "selected",
            "relative 0.4",
            "langsplat 0.4",
            "4d-langsplat 0.4",
        ] {
            assert_eq!(text.parse::<Inside>().unwrap().to_string(), text);
        }
        for text in ["", "above", "above x", "index -1", "relative 1", "mask 3", "above nan"] {
            assert!(text.parse::<Inside>().is_err(), "{text}");
        }
    }
}
