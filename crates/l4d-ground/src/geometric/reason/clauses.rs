//! How much each clause holds of each candidate at each frame.

use l4d_query::relations::related;
use l4d_query::thresholds::{DISTANCE_MARGIN, higher_m};
use l4d_query::{Clause, Party, Relation, Slack, Superlative, World};

use super::super::lexicon::Motion;
use super::super::looks::{likeness, tells_colour};
use super::super::motion::{Encounter, gap_m};
use super::super::settings::{ALONE_SHARE, CONTACT_FOOTPRINTS, KIND_SHARE, MOST_STRETCH, SURE_SHARE};
use super::super::stage::{name_of, stage};
use super::parties::Member;
use super::{Candidate, Grades, Reasoner, best_of};

/// Time over which an order in time fades, seconds.
const ORDER_S: f64 = 0.5;
/// An event has begun where its grade reaches this share of its best.
const ONSET_SHARE: f64 = 0.5;
/// Share of the clip that counts as its start, and as its end.
const CLIP_END_SHARE: f64 = 0.06;

/// What one of the two looks like by itself.
fn alone(motion: Motion, is_agent: bool) -> Option<Motion> {
    match (motion, is_agent) {
        (Motion::Lifting, false) => Some(Motion::Rise),
        (Motion::Lowering, false) => Some(Motion::Sink),
        (Motion::Carrying, _) | (Motion::Approaching, true) => Some(Motion::Travel),
        (Motion::Following, true) => Some(Motion::Dash),
        (Motion::Touching | Motion::Lifting | Motion::Lowering, true) => Some(Motion::Stir),
        (Motion::Pouring, true) => Some(Motion::Turn),
        _ => None,
    }
}

impl Reasoner<'_> {
    /// Grades of all candidates, in their order.
    pub(super) fn grade(&self, clause: &Clause, candidates: &[Candidate]) -> Vec<Grades> {
        let grades = self.graded(clause, candidates);
        match clause {
            Clause::Does { .. } | Clause::Undergoes { .. } | Clause::Relation { .. } => {
                self.stretched(candidates, grades)
            }
            _ => grades,
        }
    }

    /// The best rival at its best counts as what is meant: the sentence says that there is one.
    fn stretched(&self, candidates: &[Candidate], grades: Vec<Grades>) -> Vec<Grades> {
        let rivals = (0..grades.len()).filter(|&index| self.is_rival(candidates, index));
        let best = rivals.map(|index| best_of(&grades[index])).fold(0.0, f64::max);
        let factor = (1.0 / best.max(1e-9)).min(MOST_STRETCH);
        grades
            .into_iter()
            .map(|grades| grades.into_iter().map(|grade| (grade * factor).min(1.0)).collect())
            .collect()
    }

    fn graded(&self, clause: &Clause, candidates: &[Candidate]) -> Vec<Grades> {
        match clause {
            Clause::Category(_) => vec![vec![1.0; self.frames()]; candidates.len()],
            Clause::Attribute { key, value } => {
                let like = |candidate: &Candidate| {
                    likeness(&self.seen.tracks[candidate.track], self.lexicon, key, value)
                };
                let values: Vec<f64> = candidates.iter().map(like).collect();
                // Something is red or isn't, but only patterned or wide beside others.
                let is_absolute = tells_colour(self.lexicon, key, value);
                self.constant(&if is_absolute { values } else { self.among_rivals(candidates, &values) })
            }
            Clause::Superlative(extreme) => self.extreme(*extreme, candidates),
            Clause::Does { verb, to: None } => {
                let motion = self.lexicon.motion(verb, false).unwrap_or(Motion::Move);
                let looks = |candidate: &Candidate| self.moves[candidate.track].looks_like(motion);
                candidates.iter().map(looks).collect()
            }
            Clause::Does { verb, to: Some(party) } => self.encounters(verb, party, candidates, true),
            Clause::Undergoes { verb, by } => self.encounters(verb, by, candidates, false),
            Clause::Relation { kind, of } => self.relation(*kind, of, candidates),
            Clause::Not(inner) => {
                let inner = self.grade(inner, candidates);
                inner
                    .into_iter()
                    .map(|grades| grades.into_iter().map(|grade| 1.0 - grade).collect())
                    .collect()
            }
            Clause::AtStart(inner) => self.at_end_of_clip(inner, candidates, true),
            Clause::AtEnd(inner) => self.at_end_of_clip(inner, candidates, false),
            Clause::First(inner) => self.order(inner, candidates, 1.0),
            Clause::Last(inner) => self.order(inner, candidates, -1.0),
            Clause::Then(steps) => self.then(&steps[0], &steps[1], candidates),
        }
    }

    fn frames(&self) -> usize {
        self.seen.frames.len()
    }

    fn constant(&self, grades: &[f64]) -> Vec<Grades> {
        grades.iter().map(|&grade| vec![grade; self.frames()]).collect()
    }

    /// Whether a candidate is sure enough of its kind for others to be compared with it.
    fn is_rival(&self, candidates: &[Candidate], index: usize) -> bool {
        let best = candidates.first().map_or(0.0, |best| best.prior);
        candidates[index].prior >= KIND_SHARE * best
    }

    /// Values as shares of the largest among the rivals.
    fn among_rivals(&self, candidates: &[Candidate], values: &[f64]) -> Vec<f64> {
        let rivals = (0..values.len()).filter(|&index| self.is_rival(candidates, index));
        let most = rivals.map(|index| values[index]).fold(0.0, f64::max);
        values.iter().map(|value| if most > 0.0 { (value / most).min(1.0) } else { 0.0 }).collect()
    }

    fn extreme(&self, extreme: Superlative, candidates: &[Candidate]) -> Vec<Grades> {
        let track = |candidate: &Candidate| &self.seen.tracks[candidate.track];
        let over = |measure: &dyn Fn(&Candidate) -> f64| {
            let values: Vec<f64> = candidates.iter().map(measure).collect();
            self.constant(&self.among_rivals(candidates, &values))
        };
        let longest_m =
            |candidate: &Candidate| track(candidate).median(|seen| (seen.high - seen.low).length().max(1e-6));
        match extreme {
            Superlative::Largest => over(&|candidate| longest_m(candidate).powi(3)),
            Superlative::Smallest => over(&|candidate| longest_m(candidate).powi(-3)),
            Superlative::Tallest => {
                over(&|candidate| track(candidate).median(|seen| seen.high.z - seen.low.z).powi(2))
            }
            Superlative::Highest => {
                self.rank_by_frame(candidates, higher_m(self.seen.scale), |candidate, index| {
                    self.height_m(candidate, index)
                })
            }
            Superlative::Lowest => {
                self.rank_by_frame(candidates, higher_m(self.seen.scale), |candidate, index| {
                    self.height_m(candidate, index).map(|height| -height)
                })
            }
        }
    }

    fn height_m(&self, candidate: &Candidate, index: usize) -> Option<f64> {
        Some(self.seen.tracks[candidate.track].nearest(index)?.centre.z)
    }

    /// 1 for the largest value at a frame, fading for what is less: to 1/e over `fade`.
    fn rank_by_frame(
        &self,
        candidates: &[Candidate],
        fade: f64,
        value: impl Fn(&Candidate, usize) -> Option<f64>,
    ) -> Vec<Grades> {
        let mut grades = vec![vec![0.0; self.frames()]; candidates.len()];
        for index in 0..self.frames() {
            let values: Vec<Option<f64>> =
                candidates.iter().map(|candidate| value(candidate, index)).collect();
            let rivals =
                (0..values.len()).filter(|&at| self.is_rival(candidates, at)).filter_map(|at| values[at]);
            let most = rivals.fold(f64::NEG_INFINITY, f64::max);
            for (grades, value) in grades.iter_mut().zip(&values) {
                grades[index] = value.map_or(0.0, |value| ((value - most) / fade).exp().min(1.0));
            }
        }
        grades
    }

    fn encounters(&self, verb: &str, party: &Party, candidates: &[Candidate], is_agent: bool) -> Vec<Grades> {
        let motion = self.lexicon.motion(verb, true).unwrap_or(Motion::Touching);
        let members = self.members(party);
        candidates
            .iter()
            .map(|candidate| self.encounter(motion, candidate.track, &members, is_agent))
            .collect()
    }

    fn encounter(&self, motion: Motion, track: usize, members: &[Member], is_agent: bool) -> Grades {
        let contact_m = CONTACT_FOOTPRINTS * self.seen.spacing_m;
        // What is lifted rises, whether or not the lifter is seen.
        let mut grades = match alone(motion, is_agent) {
            Some(looks) => {
                let own = self.moves[track].looks_like(looks);
                own.into_iter().map(|grade| grade * ALONE_SHARE).collect()
            }
            None => vec![0.0_f64; self.frames()],
        };
        for member in members.iter().filter(|member| !self.is_same(member.track, track)) {
            let (agent, other) = if is_agent { (track, member.track) } else { (member.track, track) };
            for (index, grade) in grades.iter_mut().enumerate() {
                let pair = self.seen.tracks[agent].glimpses[index]
                    .as_ref()
                    .zip(self.seen.tracks[other].glimpses[index].as_ref());
                let Some((first, second)) = pair else { continue };
                let met = Encounter {
                    agent: (first, &self.moves[agent]),
                    other: (second, &self.moves[other]),
                    index,
                    gap_m: gap_m(first, second),
                    contact_m,
                };
                *grade = grade.max(met.looks_like(motion) * member.weight.sqrt());
            }
        }
        grades
    }

    fn relation(&self, kind: Relation, of: &[Party], candidates: &[Candidate]) -> Vec<Grades> {
        let parties: Vec<Vec<Member>> = of.iter().map(|party| self.members(party)).collect();
        let distance_fade = 2.0 * DISTANCE_MARGIN.ln();
        let first = parties.first().map_or(&[][..], Vec::as_slice);
        match kind {
            Relation::ClosestTo => self.rank_by_frame(candidates, distance_fade, |candidate, index| {
                self.distance_m(candidate, first, index)
                    .map(|distance| -distance.max(self.seen.spacing_m).ln())
            }),
            Relation::FarthestFrom => self.rank_by_frame(candidates, distance_fade, |candidate, index| {
                self.distance_m(candidate, first, index)
                    .map(|distance| distance.max(self.seen.spacing_m).ln())
            }),
            _ => self
                .placed(kind, first, parties.get(1).map_or(&[][..], Vec::as_slice), candidates)
                .unwrap_or_else(|| vec![vec![0.0; self.frames()]; candidates.len()]),
        }
    }

    /// Distance to the nearest member that is surely one, metres.
    fn distance_m(&self, candidate: &Candidate, members: &[Member], index: usize) -> Option<f64> {
        let own = self.seen.tracks[candidate.track].nearest(index)?;
        let others = members
            .iter()
            .filter(|member| member.weight >= SURE_SHARE && !self.is_same(member.track, candidate.track));
        let distance = |member: &Member| Some(gap_m(own, self.seen.tracks[member.track].nearest(index)?));
        others.filter_map(distance).min_by(f64::total_cmp)
    }

    /// Relations that `l4d-query` decides, on the boxes that are seen: the share of its slacks under which they hold.
    fn placed(
        &self,
        kind: Relation,
        first: &[Member],
        second: &[Member],
        candidates: &[Candidate],
    ) -> Option<Vec<Grades>> {
        let subjects: Vec<usize> = candidates.iter().map(|candidate| candidate.track).collect();
        let others: Vec<usize> = first.iter().chain(second).map(|member| member.track).collect();
        let tracks = stage(self.seen, &self.moves, &subjects, &others)?;
        let world = World::new(&tracks);
        let slacks = [Slack::Loose, Slack::Nominal, Slack::Tight].map(|slack| world.with_slack(slack));
        let alone = [Member { track: usize::MAX, weight: 1.0 }];
        let second = if second.is_empty() { &alone[..] } else { second };
        let grade = |candidate: &Candidate| -> Option<Grades> {
            let subject = world.instance(&name_of(candidate.track)?)?;
            let mut grades = vec![0.0_f64; self.frames()];
            for one in first.iter().filter(|member| !self.is_same(member.track, candidate.track)) {
                for two in second.iter().filter(|member| {
                    member.track != one.track
                        && (member.track == usize::MAX || !self.is_same(member.track, candidate.track))
                }) {
                    let to = [world.instance(&name_of(one.track)?)?];
                    let and =
                        (two.track != usize::MAX).then(|| world.instance(&name_of(two.track)?)).flatten();
                    let and: Vec<_> = and.into_iter().collect();
                    let times = [0, 1, 2].map(|slack| related(&slacks[slack], subject, kind, &to, &and));
                    let weight = (one.weight * two.weight).sqrt();
                    for (grade, &frame) in grades.iter_mut().zip(&self.seen.frames) {
                        let frame = self.seen.timeline.canonical(frame);
                        let holds = times.iter().filter(|times| times.at(frame)).count() as f64 / 3.0;
                        *grade = grade.max(holds * weight);
                    }
                }
            }
            Some(grades)
        };
        candidates.iter().map(grade).collect()
    }

    fn at_end_of_clip(&self, inner: &Clause, candidates: &[Candidate], is_start: bool) -> Vec<Grades> {
        let count = ((self.frames() as f64 * CLIP_END_SHARE).ceil() as usize).clamp(1, self.frames().max(1));
        let grades = self.grade(inner, candidates);
        let end = |grades: &Grades| {
            let part = if is_start {
                &grades[..count.min(grades.len())]
            } else {
                &grades[grades.len().saturating_sub(count)..]
            };
            part.iter().sum::<f64>() / part.len().max(1) as f64
        };
        self.constant(&grades.iter().map(end).collect::<Vec<f64>>())
    }

    /// Second at which an event begins, and how much of an event it is.
    fn onset(&self, grades: &[f64]) -> (f64, f64) {
        let best = best_of(grades);
        let index = grades.iter().position(|grade| *grade >= ONSET_SHARE * best).unwrap_or(0);
        (self.seen.frames.get(index).map_or(0.0, |&frame| self.seen.timeline.seconds(frame)), best)
    }

    fn order(&self, inner: &Clause, candidates: &[Candidate], sign: f64) -> Vec<Grades> {
        let onsets: Vec<(f64, f64)> =
            self.grade(inner, candidates).iter().map(|grades| self.onset(grades)).collect();
        let strongest = onsets.iter().map(|onset| onset.1).fold(0.0, f64::max);
        let takes_part =
            |index: usize| self.is_rival(candidates, index) && onsets[index].1 >= 0.5 * strongest;
        let lead = (0..onsets.len())
            .filter(|&index| takes_part(index))
            .map(|index| sign * onsets[index].0)
            .fold(f64::INFINITY, f64::min);
        let grade =
            |(start, strength): &(f64, f64)| strength * (-((sign * start - lead).max(0.0) / ORDER_S)).exp();
        self.constant(&onsets.iter().map(grade).collect::<Vec<f64>>())
    }

    fn then(&self, before: &Clause, after: &Clause, candidates: &[Candidate]) -> Vec<Grades> {
        let [before, after] = [before, after].map(|clause| self.grade(clause, candidates));
        let grade = |(before, after): (&Grades, &Grades)| {
            let mut earlier = 0.0_f64;
            let mut best = 0.0_f64;
            for index in 1..before.len() {
                earlier = earlier.max(before[index - 1]);
                best = best.max(earlier * after[index]);
            }
            // Both at once all the time is no order.
            let (first, second) = (self.onset(before).0, self.onset(after).0);
            if second > first { best } else { 0.5 * best }
        };
        self.constant(&before.iter().zip(&after).map(grade).collect::<Vec<f64>>())
    }
}
