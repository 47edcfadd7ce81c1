//! How many views are swapped, against the closed form.

use super::*;

/// Chance of k swapped views among n, in closed form: with p and rho, the beta-binomial distribution.
fn beta_binomial(n: usize, p: f64, rho: f64) -> Vec<f64> {
    let rising = |from: f64, steps: usize| (0..steps).map(|step| from + step as f64).product::<f64>();
    let choose = |k: usize| (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
    let chance = |k: usize| {
        if rho == 0.0 {
            return choose(k) * p.powi(k as i32) * (1.0 - p).powi((n - k) as i32);
        }
        let weight = 1.0 / rho - 1.0;
        let (a, b) = (p * weight, (1.0 - p) * weight);
        choose(k) * rising(a, k) * rising(b, n - k) / rising(a + b, n)
    };
    (0..=n).map(chance).collect()
}

/// How many of `queries` have k swapped views among n.
fn histogram(swap: Swap, queries: usize, n: usize) -> Vec<usize> {
    let scene = name("yard");
    let views: Vec<Name> = (0..n).map(|view| name(&format!("cam{view:02}"))).collect();
    let mut counts = vec![0; n + 1];
    for query in 0..queries {
        let number = name(&query.to_string());
        let draws = Draws { seed: 3, scene: &scene, number: &number };
        counts[views.iter().filter(|view| draws.is_swapped(&swap, view)).count()] += 1;
    }
    counts
}

/// The first k whose count lies more than 4.5 standard deviations from what the chances promise.
fn misfit(counts: &[usize], chances: &[f64]) -> Option<usize> {
    let queries = counts.iter().sum::<usize>() as f64;
    (0..counts.len()).find(|&k| {
        let deviation = (queries * chances[k] * (1.0 - chances[k])).sqrt();
        (counts[k] as f64 - queries * chances[k]).abs() > 4.5 * deviation + 0.5
    })
}

#[test]
fn swapped_views_are_beta_binomial() {
    let (queries, n) = (4000, 8);
    for p in [0.05, 0.2, 0.4] {
        for rho in CORRELATIONS {
            let counts = histogram(Swap { probability: p, correlation: rho }, queries, n);
            let chances = beta_binomial(n, p, rho);
            assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert_eq!(misfit(&counts, &chances), None, "p {p}, rho {rho}: {counts:?}");
            // The bounds can fail: they tell the correlations of the ablation apart, and shares that differ by 0.1.
            for other in CORRELATIONS.into_iter().filter(|&other| other != rho) {
                assert!(misfit(&counts, &beta_binomial(n, p, other)).is_some(), "{rho} passes for {other}");
            }
            assert!(misfit(&counts, &beta_binomial(n, p + 0.1, rho)).is_some(), "p {p}, rho {rho}");
        }
    }
}

#[test]
fn correlations_next_to_one_and_shares_of_nothing_and_all_are_drawn() {
    for (probability, correlation) in
        [(0.3, 1.0 - 1e-12), (1e-9, 0.999_999), (1.0 - 1e-9, 0.5), (0.3, 1e-300)]
    {
        let counts = histogram(Swap { probability, correlation }, 400, 4);
        let mean = counts.iter().enumerate().map(|(k, &count)| (k * count) as f64).sum::<f64>() / 1600.0;
        assert!((mean - probability).abs() < 0.1, "p {probability}, rho {correlation}: {mean}");
    }
    for (probability, swapped) in [(0.0, 0), (1.0, 4)] {
        assert_eq!(histogram(Swap { probability, correlation: 0.5 }, 50, 4)[swapped], 50);
    }
    // At a correlation of 1 all views are swapped or none.
    let counts = histogram(Swap { probability: 0.3, correlation: 1.0 }, 2000, 8);
    assert_eq!(counts[1..8], [0; 7]);
}
