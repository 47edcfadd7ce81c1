//! How far a method's own certainty can be trusted: how often it is right where it is how sure.

use std::path::{Path, PathBuf};

use l4d_data::Name;
use l4d_score::Estimate;

use crate::error::BoardError;
use crate::figures;

/// Certainties are shown in so many bins of equal width.
pub(crate) const BINS: usize = 5;
/// Seed of the intervals, as everywhere.
const SEED: u64 = 0;

/// One answer of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Answered {
    /// The scene, since answers of one scene hang together.
    pub scene: Name,
    /// How sure the method is, 0 to 1.
    pub certainty: f64,
    /// Whether the answer is right.
    pub is_right: bool,
}

/// A method and what it answered with a certainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Reliability {
    /// The method.
    pub method: String,
    /// In any order.
    pub answers: Vec<Answered>,
    /// Answers that state no certainty.
    pub uncertain: usize,
}

/// One bin of certainties.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bin {
    /// Mean certainty of its answers, 0 to 1.
    pub(crate) certainty: f64,
    /// Share of right ones, percent; the interval is clustered by scene.
    pub(crate) right: Estimate,
}

impl Reliability {
    /// The bins that hold an answer, from unsure to sure.
    pub(crate) fn bins(&self) -> Vec<Bin> {
        let bin_of = |answer: &Answered| ((answer.certainty * BINS as f64) as usize).min(BINS - 1);
        let bin = |index: usize| {
            let members: Vec<&Answered> =
                self.answers.iter().filter(|answer| bin_of(answer) == index).collect();
            let right =
                members.iter().map(|answer| (&answer.scene, if answer.is_right { 100.0 } else { 0.0 }));
            let right = Estimate::of(right, SEED)?.within(0.0, 100.0);
            let certainty = members.iter().map(|answer| answer.certainty).sum::<f64>() / members.len() as f64;
            Some(Bin { certainty, right })
        };
        (0..BINS).filter_map(bin).collect()
    }
}

/// Writes `reliability.svg` and `reliability.png` into `folder`; gives the paths. `about` says what certainty and right
/// mean.
///
/// # Errors
/// No method with an answer, certainties outside 0 to 1, and what the disk refuses.
pub fn publish_reliability(
    methods: &[Reliability],
    about: &[String],
    folder: &Path,
) -> Result<Vec<PathBuf>, BoardError> {
    const NAME: &str = "reliability";
    let failed = |message: String| BoardError::Figure { figure: NAME.to_owned(), message };
    let mut answers = methods.iter().flat_map(|method| &method.answers);
    if answers.clone().next().is_none() {
        return Err(failed("no answer states a certainty".to_owned()));
    }
    if let Some(answer) = answers.find(|answer| !(0.0..=1.0).contains(&answer.certainty)) {
        return Err(failed(format!("an answer of {} is {} sure", answer.scene, answer.certainty)));
    }
    figures::write(NAME, &figures::reliability(methods, about), folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(scene: &str, certainty: f64, is_right: bool) -> Answered {
        Answered { scene: Name::new(scene).unwrap(), certainty, is_right }
    }

    #[test]
    fn bins_hold_what_lies_in_them() {
        let answers = vec![
            answered("a", 0.0, false),
            answered("a", 0.1, true),
            answered("b", 0.9, true),
            answered("b", 1.0, true),
            answered("a", 0.8, false),
        ];
        let bins = Reliability { method: "m".into(), answers, uncertain: 0 }.bins();
        assert_eq!(bins.len(), 2);
        assert!((bins[0].certainty - 0.05).abs() < 1e-12 && bins[0].right.value == 50.0);
        assert_eq!((bins[0].right.queries, bins[0].right.interval), (2, None));
        assert!((bins[1].certainty - 0.9).abs() < 1e-12);
        assert!((bins[1].right.value - 200.0 / 3.0).abs() < 1e-9 && bins[1].right.scenes == 2);
        let [low, high] = bins[1].right.interval.unwrap();
        assert!((0.0..=100.0).contains(&low) && (0.0..=100.0).contains(&high));
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let one = |answers| [Reliability { method: "m".into(), answers, uncertain: 3 }];
        let refused = |methods: &[Reliability]| {
            publish_reliability(methods, &[], folder.path()).unwrap_err().to_string()
        };
        assert!(refused(&one(Vec::new())).contains("no answer"));
        assert!(refused(&one(vec![answered("a", f64::NAN, true)])).contains("NaN"));
        let paths = publish_reliability(&one(vec![answered("a", 0.5, true)]), &[], folder.path()).unwrap();
        assert!(paths.iter().all(|path| path.is_file()));
    }
}
