//! Which of the things that are seen a predicate describes, and when: the semantics of `l4d_query::eval`, by degrees.
//!
//! Every clause grades every candidate at every frame, 0 to 1; events count at their best, states all the time.
//! `reason/clauses` grades, `reason/parties` finds the others that a clause speaks of.

mod clauses;
mod parties;

use std::cell::RefCell;
use std::collections::BTreeMap;

use l4d_data::Temporal;
use l4d_masks::Mask;
use l4d_query::{Clause, Party, Predicate};

use super::kinds::{alike, fits};
use super::lexicon::Lexicon;
use super::looks::is_visible;
use super::motion::Kinematics;
use super::parse::Parsed;
use super::perceive::{Perceived, Track};
use super::settings::{ALIKE_POWER, FLOOR, GATE_SHARE, LEAST_SCORE, PLURAL_SHARE};
use crate::unreadable::{Reason, Unreadable};

/// Most candidates that are looked at closely.
const MOST_CANDIDATES: usize = 50;
/// Candidates whose kind fits worse than this share of the best are dropped.
const LEAST_SHARE: f64 = 0.05;
/// Tracks that share this much of the smaller one are readings of the same thing.
const SAME_SHARE: f64 = 0.3;
/// Share of the frames in which an event is at its best.
const EVENT_SHARE: f64 = 0.15;

/// What is meant, and why.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    /// Canonical frame and mask, only where it is seen and meant.
    pub(crate) masks: Vec<(u32, Mask)>,
    /// How it was decided.
    pub(crate) notes: Vec<String>,
}

/// A grade for each frame of the clip, 0 to 1.
type Grades = Vec<f64>;

/// A track that may be of the kind that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Candidate {
    track: usize,
    prior: f64,
}

/// Everything that a question is answered from.
struct Reasoner<'s> {
    seen: &'s Perceived,
    lexicon: &'s Lexicon,
    moves: Vec<Kinematics>,
    alike: Vec<f64>,
    same: RefCell<BTreeMap<(usize, usize), bool>>,
}

/// The words on which the whole answer depends although nothing measured tells of them; none if something else can
/// decide.
pub(crate) fn unmeasured(lexicon: &Lexicon, parsed: &Parsed) -> Option<Unreadable> {
    let predicate = &parsed.predicate;
    if predicate.discriminating().any(|clause| can_judge(lexicon, clause)) {
        return None;
    }
    let clauses = predicate.clauses();
    let is_meant = |word: &&String| clauses.iter().any(|clause| says(lexicon, word, clause));
    let mut words: Vec<&String> = parsed.words.iter().filter(is_meant).collect();
    if words.is_empty() {
        words.extend(&parsed.words);
    }
    Some(Unreadable::words(Reason::Unmeasured, words))
}

/// Whether a property comes from this word: "closed" of (state, shut), "knob" and "wooden" of (knob, wood), "ponytail"
/// of (hair, ponytail), "lid" of (lid, any).
fn says(lexicon: &Lexicon, word: &str, clause: &Clause) -> bool {
    let Clause::Attribute { key, value } = clause else { return false };
    let is_value = word == value
        || word.split_once('-').is_some_and(|(first, _)| first == value)
        || lexicon.attribute(word).is_some_and(|(_, meant)| meant == value);
    word == key || (is_value && value != "any")
}

/// Whether anything measured tells of a clause.
fn can_judge(lexicon: &Lexicon, clause: &Clause) -> bool {
    match clause {
        Clause::Attribute { key, value } => is_visible(lexicon, key, value),
        Clause::Not(inner) => can_judge(lexicon, inner),
        _ => true,
    }
}

/// Answers a sentence.
pub(crate) fn answer(seen: &Perceived, lexicon: &Lexicon, parsed: &Parsed) -> Answer {
    let moves = seen.tracks.iter().map(|track| Kinematics::new(track, seen)).collect();
    let reasoner = Reasoner { seen, lexicon, moves, alike: alike(seen), same: RefCell::default() };
    reasoner.answer(parsed)
}

impl Reasoner<'_> {
    fn answer(&self, parsed: &Parsed) -> Answer {
        let mut notes = vec![format!("reads the sentence as {}", parsed.predicate)];
        let ranked = self.ranked(&parsed.predicate, parsed.temporal == Temporal::While);
        notes.push(format!(
            "sees {} things, of which {} may be a {}",
            self.seen.tracks.len(),
            ranked.len(),
            parsed.predicate.noun()
        ));
        for scored in ranked.iter().take(3) {
            notes.push(self.describe(scored));
        }
        let Some(best) = ranked.first().filter(|best| best.score >= LEAST_SCORE) else {
            notes.push("nothing fits well enough: absent".to_owned());
            return Answer { masks: Vec::new(), notes };
        };
        let mut chosen = vec![best];
        if parsed.is_plural {
            for other in ranked.iter().skip(1).filter(|other| other.score >= PLURAL_SHARE * best.score) {
                if chosen.iter().all(|taken| !self.is_same(taken.candidate.track, other.candidate.track)) {
                    chosen.push(other);
                }
            }
        }
        let mut masks: BTreeMap<u32, Mask> = BTreeMap::new();
        for scored in chosen {
            let gate = (parsed.temporal == Temporal::While).then(|| self.gate(&scored.together));
            let track = &self.seen.tracks[scored.candidate.track];
            for (index, glimpse) in
                track.seen().filter(|(index, _)| gate.as_ref().is_none_or(|gate| gate[*index]))
            {
                let frame = self.seen.frames[index];
                masks
                    .entry(frame)
                    .and_modify(|mask| mask.union_with(&glimpse.mask))
                    .or_insert_with(|| glimpse.mask.clone());
            }
        }
        Answer { masks: masks.into_iter().collect(), notes }
    }

    /// Candidates by score, the best first.
    fn ranked(&self, predicate: &Predicate, is_while: bool) -> Vec<Scored> {
        let mut candidates = self.candidates(predicate.noun());
        for candidate in &mut candidates {
            candidate.prior *= self.alike[candidate.track].max(0.2).powf(ALIKE_POWER);
        }
        let clauses: Vec<&Clause> =
            predicate.discriminating().filter(|clause| can_judge(self.lexicon, clause)).collect();
        let grades: Vec<Vec<Grades>> = clauses.iter().map(|clause| self.grade(clause, &candidates)).collect();
        let scored = |(index, candidate): (usize, &Candidate)| {
            let of_clause: Vec<f64> = clauses
                .iter()
                .zip(&grades)
                .map(|(clause, grades)| self.over_clip(clause, &grades[index], candidate, is_while))
                .collect();
            let count = self.seen.frames.len();
            let together = (0..count)
                .map(|frame| grades.iter().map(|grades| grades[index][frame]).fold(1.0, f64::min))
                .collect();
            let score = of_clause.iter().map(|grade| grade.max(FLOOR)).product::<f64>() * candidate.prior;
            Scored { candidate: *candidate, score, of_clause, together }
        };
        let mut ranked: Vec<Scored> = candidates.iter().enumerate().map(scored).collect();
        ranked.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.candidate.track.cmp(&b.candidate.track)));
        ranked
    }

    /// Tracks that may be of a kind, the most likely first.
    fn candidates(&self, noun: &str) -> Vec<Candidate> {
        let fit = |(track, seen): (usize, &Track)| Candidate {
            track,
            prior: fits(self.seen, seen, &self.moves[track], noun, self.lexicon),
        };
        let mut candidates: Vec<Candidate> = self.seen.tracks.iter().enumerate().map(fit).collect();
        candidates.sort_by(|a, b| b.prior.total_cmp(&a.prior).then(a.track.cmp(&b.track)));
        let least = candidates.first().map_or(0.0, |best| best.prior * LEAST_SHARE).max(1e-6);
        candidates.retain(|candidate| candidate.prior >= least);
        candidates.truncate(MOST_CANDIDATES);
        candidates
    }

    /// A clause over the whole clip: events at their best, what never happens at its worst, states all the time.
    fn over_clip(&self, clause: &Clause, grades: &[f64], candidate: &Candidate, is_while: bool) -> f64 {
        let track = &self.seen.tracks[candidate.track];
        let seen: Vec<f64> = track.seen().map(|(index, _)| grades[index]).collect();
        match clause {
            Clause::Not(inner) if inner.is_event() && !is_while => {
                1.0 - best_of(&seen.iter().map(|grade| 1.0 - grade).collect::<Vec<f64>>())
            }
            clause if clause.is_event() || (is_while && !clause.is_constant()) => best_of(&seen),
            _ => mean(&seen),
        }
    }

    /// Where a clause that gates holds: most of its best, holes of one frame closed.
    fn gate(&self, together: &[f64]) -> Vec<bool> {
        let best = best_of(together);
        let mut open: Vec<bool> = together.iter().map(|grade| *grade >= GATE_SHARE * best).collect();
        for index in 1..open.len().saturating_sub(1) {
            if open[index - 1] && open[index + 1] {
                open[index] = true;
            }
        }
        open
    }

    /// Whether two tracks are readings of the same pixels.
    fn is_same(&self, a: usize, b: usize) -> bool {
        if a == b {
            return true;
        }
        let key = (a.min(b), a.max(b));
        *self.same.borrow_mut().entry(key).or_insert_with(|| {
            let (mut shared, mut areas) = (0, [0, 0]);
            let pairs = self.seen.tracks[a].glimpses.iter().zip(&self.seen.tracks[b].glimpses);
            for (first, second) in pairs.filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?))) {
                shared += first.shared_px(second);
                areas[0] += first.area_px;
                areas[1] += second.area_px;
            }
            shared as f64 > SAME_SHARE * areas[0].min(areas[1]) as f64
        })
    }

    fn describe(&self, scored: &Scored) -> String {
        let track = &self.seen.tracks[scored.candidate.track];
        let (index, glimpse) = match track.seen().next() {
            Some(first) => first,
            None => return String::new(),
        };
        let grades: Vec<String> = scored.of_clause.iter().map(|grade| format!("{grade:.2}")).collect();
        format!(
            "thing {} (first at frame {}, {:.2} m long, at {:.1} {:.1} {:.1}): kind {:.2}, clauses {}, score {:.3}",
            scored.candidate.track,
            self.seen.frames[index],
            glimpse.longest_m(),
            glimpse.centre.x,
            glimpse.centre.y,
            glimpse.centre.z,
            scored.candidate.prior,
            grades.join(" "),
            scored.score
        )
    }
}

/// A candidate, judged.
#[derive(Debug, Clone)]
struct Scored {
    candidate: Candidate,
    score: f64,
    of_clause: Vec<f64>,
    /// All clauses at once, by frame.
    together: Grades,
}

/// Mean over the best frames.
fn best_of(grades: &[f64]) -> f64 {
    let mut sorted = grades.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    sorted.truncate(((grades.len() as f64 * EVENT_SHARE).ceil() as usize).max(1));
    mean(&sorted)
}

fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// The noun of a party.
fn noun_of(party: &Party) -> &str {
    match party {
        Party::Name(name) => name.as_str(),
        Party::Category(noun) => noun,
        Party::Such(predicate) => predicate.noun(),
    }
}
