//! Raw agreement, Krippendorff's alpha and Gwet's AC1 for nominal labels, with missing answers.
//!
//! With r_ik answers k among the r_i answers to item i:
//!
//! - raw: mean over items with r_i >= 2 of sum_k r_ik (r_ik - 1) / (r_i (r_i - 1)).
//! - alpha (Krippendorff, *Computing Krippendorff's Alpha-Reliability*, 2011): 1 - Do / De over the n answers that
//!   have a partner, Do = 1 - (1/n) sum_i sum_k r_ik (r_ik - 1) / (r_i - 1), De = 1 - sum_k n_k (n_k - 1) / (n (n - 1)).
//! - AC1 (Gwet, *Handbook of Inter-Rater Reliability*): (pa - pe) / (1 - pe), pa = raw, pe = sum_k pi_k (1 - pi_k) /
//!   (q - 1), pi_k = mean over items with r_i >= 1 of r_ik / r_i.
//!
//! All three are functions of sums over items, so a bootstrap over clusters adds up sums of clusters.

use std::collections::BTreeMap;
use std::fmt;

/// The answers to one item, as codes of labels; who gave them doesn't matter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unit {
    /// Which cluster of the bootstrap the item belongs to.
    pub cluster: usize,
    /// Missing answers are left out.
    pub labels: Vec<u32>,
}

/// Why a coefficient has no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Undefined {
    /// Nothing was answered.
    NoVotes,
    /// No item has two answers.
    NoPairs,
    /// All answers are the same: nothing can be said about chance.
    NoVariation,
}

impl fmt::Display for Undefined {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NoVotes => "no votes",
            Self::NoPairs => "no item has two votes",
            Self::NoVariation => "no variation",
        })
    }
}

/// Mean over items of the share of agreeing pairs of answers.
///
/// # Errors
/// The answers leave it undefined.
pub fn raw(units: &[Unit]) -> Result<f64, Undefined> {
    totals(units).raw()
}

/// Krippendorff's alpha for nominal data.
///
/// # Errors
/// The answers leave it undefined.
pub fn krippendorff_alpha(units: &[Unit]) -> Result<f64, Undefined> {
    totals(units).alpha()
}

/// Gwet's AC1 with `labels` possible labels.
///
/// # Errors
/// The answers leave it undefined.
pub fn gwet_ac1(units: &[Unit], labels: usize) -> Result<f64, Undefined> {
    totals(units).ac1(labels)
}

fn totals(units: &[Unit]) -> Totals {
    let clusters = units.iter().map(|unit| unit.cluster + 1).max().unwrap_or(0);
    let parts = Parts::new(units, clusters);
    let mut totals = parts.totals();
    parts.sum(&(0..clusters).collect::<Vec<_>>(), &mut totals);
    totals
}

/// Sums over the items of one cluster.
#[derive(Debug, Clone, Default)]
struct Part {
    rated: f64,
    paired: f64,
    agreed: f64,
    pairable: f64,
    matched: f64,
    /// Code -> (sum of r_ik / r_i, answers that have a partner).
    labels: BTreeMap<usize, (f64, f64)>,
}

impl Part {
    fn add(&mut self, labels: &[usize]) {
        let all = labels.len() as f64;
        if labels.is_empty() {
            return;
        }
        let mut counts: BTreeMap<usize, f64> = BTreeMap::new();
        for &label in labels {
            *counts.entry(label).or_default() += 1.0;
        }
        let has_pairs = labels.len() > 1;
        self.rated += 1.0;
        for (&label, &count) in &counts {
            let (share, partners) = self.labels.entry(label).or_default();
            *share += count / all;
            *partners += if has_pairs { count } else { 0.0 };
        }
        if has_pairs {
            let agreeing: f64 = counts.values().map(|count| count * (count - 1.0)).sum();
            self.paired += 1.0;
            self.agreed += agreeing / (all * (all - 1.0));
            self.pairable += all;
            self.matched += agreeing / (all - 1.0);
        }
    }
}

/// The sums of all clusters.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    parts: Vec<Part>,
    labels: usize,
}

impl Parts {
    /// `clusters` is more than the largest cluster of any unit.
    pub(super) fn new(units: &[Unit], clusters: usize) -> Self {
        // Codes may be sparse: number those that occur.
        let mut codes: BTreeMap<u32, usize> = BTreeMap::new();
        for label in units.iter().flat_map(|unit| &unit.labels) {
            let next = codes.len();
            codes.entry(*label).or_insert(next);
        }
        let mut parts = vec![Part::default(); clusters];
        for unit in units {
            let labels: Vec<usize> = unit.labels.iter().map(|label| codes[label]).collect();
            parts[unit.cluster].add(&labels);
        }
        Self { parts, labels: codes.len() }
    }

    /// Room for a sum.
    pub(super) fn totals(&self) -> Totals {
        Totals { part: Part::default(), shares: vec![0.0; self.labels], counts: vec![0.0; self.labels] }
    }

    /// Sums the parts of these clusters, each as often as it is named.
    pub(super) fn sum(&self, clusters: &[usize], totals: &mut Totals) {
        let Totals { part: sum, shares, counts } = totals;
        *sum = Part::default();
        shares.fill(0.0);
        counts.fill(0.0);
        for &cluster in clusters {
            let Part { rated, paired, agreed, pairable, matched, labels } = &self.parts[cluster];
            sum.rated += rated;
            sum.paired += paired;
            sum.agreed += agreed;
            sum.pairable += pairable;
            sum.matched += matched;
            for (&label, (share, count)) in labels {
                shares[label] += share;
                counts[label] += count;
            }
        }
    }
}

/// Sums over items, enough for all three coefficients.
#[derive(Debug, Clone)]
pub(super) struct Totals {
    part: Part,
    shares: Vec<f64>,
    counts: Vec<f64>,
}

impl Totals {
    pub(super) fn raw(&self) -> Result<f64, Undefined> {
        self.require_pairs()?;
        Ok(self.part.agreed / self.part.paired)
    }

    pub(super) fn alpha(&self) -> Result<f64, Undefined> {
        self.require_pairs()?;
        let n = self.part.pairable;
        // n_k (n - n_k) summed is n^2 - sum n_k^2, exact in integers: 0 only if one label has all answers.
        let differing: f64 = self.counts.iter().map(|count| count * (n - count)).sum();
        if differing == 0.0 {
            return Err(Undefined::NoVariation);
        }
        let observed = 1.0 - self.part.matched / n;
        let expected = differing / (n * (n - 1.0));
        Ok(1.0 - observed / expected)
    }

    pub(super) fn ac1(&self, labels: usize) -> Result<f64, Undefined> {
        self.require_pairs()?;
        if labels < 2 {
            return Err(Undefined::NoVariation);
        }
        let share = |sum: &f64| sum / self.part.rated;
        let spread: f64 = self.shares.iter().map(share).map(|pi| pi * (1.0 - pi)).sum();
        let expected = spread / (labels as f64 - 1.0);
        let observed = self.part.agreed / self.part.paired;
        Ok((observed - expected) / (1.0 - expected))
    }

    fn require_pairs(&self) -> Result<(), Undefined> {
        match (self.part.rated > 0.0, self.part.paired > 0.0) {
            (false, _) => Err(Undefined::NoVotes),
            (true, false) => Err(Undefined::NoPairs),
            (true, true) => Ok(()),
        }
    }
}
