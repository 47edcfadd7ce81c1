//! The soft reading: which of the things that are believed to be there a predicate describes, how well, and when.
//!
//! Clauses mean what `eval` and `relations` say. Here things are of a noun, have a property and take part in an event
//! with a probability, and a comparison is as sure as the boxes are known. Knows of no pictures: who perceives makes a
//! [`Belief`]. With beliefs that are the tracks themselves the first of the ranked is the answer of the hard reading.

mod belief;
mod degrees;
pub mod derive;
mod read;
pub mod settings;
#[cfg(test)]
mod tests;

use l4d_data::{Name, Temporal};

pub use belief::{Belief, BeliefError, BelievedEvent, Meant, Odds, Thing};
pub use degrees::Degrees;
pub use settings::Noise;

use crate::ast::{Clause, Predicate};
use crate::eval::{over_clip, truth};
use crate::reading::{Reading as _, Truth as _};
use read::Soft;
use settings::{ABSENT_SCORE, LEAST_STRETCH, weighed};

/// A thing that may be meant.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    pub name: Name,
    /// How well noun and clauses fit, compared with the best among its rivals; 0 to 1.
    pub score: f64,
    /// Probability that this is what is meant, among all that may be meant and nothing.
    pub confidence: f64,
    /// When, given that it is what is meant: above 0.5 where the predicate rather holds. The whole clip for what names
    /// an identity.
    pub when: Degrees,
    /// How far each discriminating clause holds of it, in their order.
    pub clauses: Vec<f64>,
}

/// All that the predicate may mean, the best first; empty only of a scene without objects.
///
/// Where nothing is believed to be of the noun, everything is a candidate: a guess is better than no answer.
pub fn rank(belief: &Belief<'_>, predicate: &Predicate, temporal: Temporal) -> Vec<Ranked> {
    let reading = Soft::new(belief);
    let clauses: Vec<&Clause> = predicate.discriminating().collect();
    let candidates = candidates(&reading, predicate, temporal, &clauses);
    let stretches: Vec<f64> = (0..clauses.len()).map(|clause| stretch(&candidates, clause)).collect();
    let mut ranked: Vec<Ranked> =
        candidates.into_iter().map(|candidate| candidate.judged(&clauses, &stretches)).collect();
    let total = ABSENT_SCORE + ranked.iter().map(|one| one.score).sum::<f64>();
    for one in &mut ranked {
        one.confidence = one.score / total;
    }
    ranked.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.name.cmp(&b.name)));
    ranked
}

/// A thing of the noun, with what each clause says of it.
struct Candidate {
    name: Name,
    /// Probability that it is of the noun.
    prior: f64,
    grades: Vec<Grade>,
}

/// How far a clause holds of a thing.
struct Grade {
    /// As the question takes it: over the clip, or at its best.
    degree: f64,
    /// Over time; none where the question is about an identity.
    times: Option<Degrees>,
}

fn candidates(
    reading: &Soft<'_>,
    predicate: &Predicate,
    temporal: Temporal,
    clauses: &[&Clause],
) -> Vec<Candidate> {
    let noun = predicate.noun();
    let of_noun = reading.world().objects().map(|thing| (thing, reading.is_a(thing, noun)));
    let mut things: Vec<_> = of_noun.collect();
    if things.iter().any(|(_, prior)| *prior > 0.0) {
        things.retain(|(_, prior)| *prior > 0.0);
    } else {
        things.iter_mut().for_each(|(_, prior)| *prior = settings::UNHEARD_OF);
    }
    let judge = |thing, clause: &&Clause| match temporal {
        Temporal::Whole => Grade { degree: over_clip(reading, clause, thing, noun), times: None },
        Temporal::While => {
            let times = truth(reading, clause, thing, noun);
            Grade { degree: times.ever(), times: Some(times) }
        }
    };
    things
        .into_iter()
        .map(|(thing, prior)| Candidate {
            name: thing.name.clone(),
            prior,
            grades: clauses.iter().map(|clause| judge(thing, clause)).collect(),
        })
        .collect()
}

/// By what a clause is multiplied so that it holds of the likeliest of the noun at its best: the sentence says that
/// there is one of which it holds.
fn stretch(candidates: &[Candidate], clause: usize) -> f64 {
    let most = candidates.iter().map(|candidate| candidate.prior).fold(f64::MIN_POSITIVE, f64::max);
    let best = |candidate: &Candidate| candidate.grades[clause].degree * candidate.prior / most;
    1.0 / candidates.iter().map(best).fold(LEAST_STRETCH, f64::max)
}

impl Candidate {
    fn judged(self, clauses: &[&Clause], stretches: &[f64]) -> Ranked {
        let Self { name, prior, grades } = self;
        let weigh = |at: usize, degree: f64| weighed(clauses[at], (degree * stretches[at]).min(1.0));
        let identity: f64 = grades.iter().enumerate().map(|(at, grade)| weigh(at, grade.degree)).product();
        let is_timed = grades.iter().any(|grade| grade.times.is_some());
        let together = Degrees::when(|frame| {
            let at_frame = grades
                .iter()
                .enumerate()
                .filter_map(|(at, grade)| grade.times.as_ref().map(|times| weigh(at, times.at(frame))));
            at_frame.product()
        });
        let fit = if is_timed { together.ever() } else { identity };
        Ranked {
            name,
            score: prior * fit,
            confidence: 0.0,
            when: together.relative(),
            clauses: grades.iter().map(|grade| grade.degree).collect(),
        }
    }
}
