//! Raw agreement, Krippendorff's alpha and Gwet's AC1 for nominal labels, with missing answers.
//!
//! An item is the labels of its answers, as codes; who gave them doesn't matter. With r_ik answers k among the r_i
//! answers to item i:
//!
//! - raw: mean over items with r_i >= 2 of sum_k r_ik (r_ik - 1) / (r_i (r_i - 1)).
//! - alpha (Krippendorff, *Computing Krippendorff's Alpha-Reliability*, 2011): 1 - Do / De over the n answers that
//!   have a partner, Do = 1 - (1/n) sum_i sum_k r_ik (r_ik - 1) / (r_i - 1), De = 1 - sum_k n_k (n_k - 1) / (n (n - 1)).
//! - AC1 (Gwet, *Handbook of Inter-Rater Reliability*): (pa - pe) / (1 - pe), pa = raw, pe = sum_k pi_k (1 - pi_k) /
//!   (q - 1), pi_k = mean over items with r_i >= 1 of r_ik / r_i.

use std::collections::BTreeMap;

/// Why a number has no value.
pub(super) type Undefined = &'static str;
pub(super) const NO_VOTES: Undefined = "no votes";
pub(super) const NO_PAIRS: Undefined = "no item has two votes";
pub(super) const NO_VARIATION: Undefined = "no variation";

/// Mean over items of the share of agreeing pairs of answers.
pub(super) fn raw(items: &[&[u32]]) -> Result<f64, Undefined> {
    let paired = paired(items)?;
    let pairs = |labels: &[u32]| labels.len() as f64 * (labels.len() as f64 - 1.0);
    Ok(paired.iter().map(|labels| equal_pairs(labels) / pairs(labels)).sum::<f64>() / paired.len() as f64)
}

/// Krippendorff's alpha for nominal data.
pub(super) fn alpha(items: &[&[u32]]) -> Result<f64, Undefined> {
    let paired = paired(items)?;
    let all = paired.concat();
    let n = all.len() as f64;
    // n_k (n - n_k) summed is n^2 - sum n_k^2, exact in integers: 0 only if one label has all answers.
    let differing: f64 = counts(&all).values().map(|count| count * (n - count)).sum();
    if differing == 0.0 {
        return Err(NO_VARIATION);
    }
    let matched: f64 = paired.iter().map(|labels| equal_pairs(labels) / (labels.len() as f64 - 1.0)).sum();
    let (observed, expected) = (1.0 - matched / n, differing / (n * (n - 1.0)));
    Ok(1.0 - observed / expected)
}

/// Gwet's AC1 with `labels` possible labels.
pub(super) fn ac1(items: &[&[u32]], labels: usize) -> Result<f64, Undefined> {
    let observed = raw(items)?;
    if labels < 2 {
        return Err(NO_VARIATION);
    }
    let rated: Vec<&[u32]> = items.iter().copied().filter(|labels| !labels.is_empty()).collect();
    let mut shares: BTreeMap<u32, f64> = BTreeMap::new();
    for labels in &rated {
        for (label, count) in counts(labels) {
            *shares.entry(label).or_default() += count / labels.len() as f64;
        }
    }
    let spread: f64 = shares.values().map(|sum| sum / rated.len() as f64).map(|pi| pi * (1.0 - pi)).sum();
    let expected = spread / (labels as f64 - 1.0);
    Ok((observed - expected) / (1.0 - expected))
}

/// Items with two answers or more.
fn paired<'i>(items: &[&'i [u32]]) -> Result<Vec<&'i [u32]>, Undefined> {
    let paired: Vec<&[u32]> = items.iter().copied().filter(|labels| labels.len() > 1).collect();
    match paired.is_empty() {
        false => Ok(paired),
        true if items.iter().all(|labels| labels.is_empty()) => Err(NO_VOTES),
        true => Err(NO_PAIRS),
    }
}

/// sum_k r_k (r_k - 1).
fn equal_pairs(labels: &[u32]) -> f64 {
    counts(labels).values().map(|count| count * (count - 1.0)).sum()
}

fn counts(labels: &[u32]) -> BTreeMap<u32, f64> {
    let mut counts = BTreeMap::new();
    labels.iter().for_each(|label| *counts.entry(*label).or_default() += 1.0);
    counts
}
