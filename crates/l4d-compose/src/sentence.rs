//! Which of its phrasings a query gets.

use std::ops::RangeInclusive;

use l4d_query::prove::{wording_problem, words};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::candidate::Candidate;

/// Words that a sentence may have.
const LENGTHS: RangeInclusive<usize> = 3..=20;
/// The next best phrasing is drawn this much more rarely.
const FALL: f64 = 0.75;

/// One of the phrasings, the better ones more often; none if none is sound and new.
pub(crate) fn draw(
    candidate: &Candidate,
    forms: Vec<String>,
    is_taken: impl Fn(&str) -> bool,
    random: &mut ChaCha8Rng,
) -> Option<String> {
    let mut forms: Vec<String> =
        forms.into_iter().filter(|form| is_sound(candidate, form, &is_taken)).collect();
    let weights: Vec<f64> = (0..forms.len()).map(|place| FALL.powi(place as i32)).collect();
    let mut left = random.random::<f64>() * weights.iter().sum::<f64>();
    let drawn = weights.iter().position(|weight| {
        left -= weight;
        left <= 0.0
    });
    let drawn = drawn.unwrap_or(forms.len().saturating_sub(1));
    (drawn < forms.len()).then(|| forms.swap_remove(drawn))
}

fn is_sound(candidate: &Candidate, form: &str, is_taken: &dyn Fn(&str) -> bool) -> bool {
    let said = words(form);
    LENGTHS.contains(&said.len())
        && !is_taken(&said.join(" "))
        && wording_problem(form, candidate.temporal, &candidate.predicate).is_none()
}
