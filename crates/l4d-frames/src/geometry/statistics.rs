//! Counts of a cross-view comparison, and the numbers that are reported.

use std::collections::BTreeMap;

use l4d_data::name::Name;
use serde::Serialize;

use crate::quantiles::Quantiles;

/// Fewer compared pixels than this say nothing about two views.
const FEWEST_COMPARED: u64 = 100;

/// Counts over any number of view pairs; merging adds.
#[derive(Debug, Clone, Default)]
pub(crate) struct CrossView {
    /// Pixels of A that land between four pixels of one id in B.
    pub(crate) landed: u64,
    /// Of these, where one of the views does not resolve a smooth surface.
    pub(super) unresolved: u64,
    /// Of these, where B sees something nearer.
    pub(super) occluded: u64,
    /// Compared pixels whose residual is above what the contract allows.
    beyond: u64,
    /// Compared pixels whose depths agree within the tolerance.
    pub(super) co_visible: u64,
    residual_m: Quantiles,
    ratio: Quantiles,
    misses: BTreeMap<(u32, u32), Miss>,
}

/// Pixels where A and B agree on the surface but not on its id; the place is the first one's.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Miss {
    /// Id in A.
    pub id_a: u32,
    /// Id in B, the one that it borders.
    pub id_b: u32,
    /// Number of pixels.
    pub count: u64,
    /// Of these, with the other id nowhere near in either view.
    pub away_from_contact: u64,
    /// Canonical frame of the example.
    pub frame: u32,
    /// View A of the example.
    pub view_a: Name,
    /// Column and row in A.
    pub pixel_a: [u32; 2],
    /// View B of the example.
    pub view_b: Name,
    /// Column and row in B.
    pub pixel_b: [u32; 2],
}

/// Quantiles of a distribution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the values lie below.
    pub median: f64,
    /// 95 % lie below.
    pub p95: f64,
    /// 99 % lie below.
    pub p99: f64,
    pub max: f64,
}

/// What `l4d check-scenes` reports of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Pixels whose depths were compared.
    pub compared: u64,
    /// |z_projected - z_B|, millimetres.
    pub residual_mm: Spread,
    /// The same, in units of 1 mm + 1e-4 z.
    pub residual_over_allowed: Spread,
    /// Share of compared pixels beyond 1 mm + 1e-4 z.
    pub beyond: f64,
    /// Share of landed pixels that B sees something nearer at.
    pub occluded: f64,
    /// Share of landed pixels where a view does not resolve one smooth surface.
    pub unresolved: f64,
    /// Interior pixels that both views see.
    pub co_visible: u64,
    /// Share of these whose ids agree.
    pub id_agreement: f64,
    /// Pairs of ids that disagree, most frequent first.
    pub misses: Vec<Miss>,
}

impl CrossView {
    pub(super) fn count_residual(&mut self, residual_m: f64, allowed_m: f64) {
        self.residual_m.add(residual_m as f32);
        self.ratio.add((residual_m / allowed_m) as f32);
        self.beyond += u64::from(residual_m > allowed_m);
    }

    pub(super) fn count_miss(&mut self, ids: (u32, u32), at_contact: bool, example: impl FnOnce() -> Miss) {
        let away = u64::from(!at_contact);
        match self.misses.get_mut(&ids) {
            // An example away from any contact tells more than one at a contact.
            Some(miss) if away == 1 && miss.away_from_contact == 0 => {
                *miss = Miss { count: miss.count + 1, away_from_contact: 1, ..example() };
            }
            Some(miss) => {
                miss.count += 1;
                miss.away_from_contact += away;
            }
            None => {
                self.misses.insert(ids, Miss { away_from_contact: away, ..example() });
            }
        }
    }

    /// Adds the counts of other pairs.
    pub(crate) fn merge(&mut self, other: Self) {
        self.landed += other.landed;
        self.unresolved += other.unresolved;
        self.occluded += other.occluded;
        self.beyond += other.beyond;
        self.co_visible += other.co_visible;
        self.residual_m.merge(&other.residual_m);
        self.ratio.merge(&other.ratio);
        for (ids, miss) in other.misses {
            match self.misses.get_mut(&ids) {
                Some(known) => {
                    let count = known.count + miss.count;
                    let away_from_contact = known.away_from_contact + miss.away_from_contact;
                    if known.away_from_contact == 0 && miss.away_from_contact > 0 {
                        *known = miss;
                    }
                    (known.count, known.away_from_contact) = (count, away_from_contact);
                }
                None => {
                    self.misses.insert(ids, miss);
                }
            }
        }
    }

    /// The median of residual over allowed, if it says that the views disagree.
    pub(crate) fn disagreement(&self) -> Option<f64> {
        let compared = self.residual_m.count();
        let median = f64::from(self.ratio.quantile(0.5));
        (compared >= FEWEST_COMPARED && median >= 1.0).then_some(median)
    }

    /// The numbers to report.
    pub(crate) fn summary(&self) -> Summary {
        let missed: u64 = self.misses.values().map(|miss| miss.count).sum();
        let mut misses: Vec<Miss> = self.misses.values().cloned().collect();
        misses.sort_by_key(|miss| (std::cmp::Reverse(miss.count), miss.id_a, miss.id_b));
        Summary {
            compared: self.residual_m.count(),
            residual_mm: spread(&self.residual_m, 1e3),
            residual_over_allowed: spread(&self.ratio, 1.0),
            beyond: share(self.beyond, self.residual_m.count()),
            occluded: share(self.occluded, self.landed),
            unresolved: share(self.unresolved, self.landed),
            co_visible: self.co_visible,
            id_agreement: 1.0 - share(missed, self.co_visible),
            misses,
        }
    }
}

fn spread(quantiles: &Quantiles, unit: f64) -> Spread {
    let at = |share: f64| f64::from(quantiles.quantile(share)) * unit;
    Spread { median: at(0.5), p95: at(0.95), p99: at(0.99), max: f64::from(quantiles.largest()) * unit }
}

fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}
