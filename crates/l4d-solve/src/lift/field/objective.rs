//! The two losses (paper, equations 5 and 6), as functions of differences of logits, and their derivatives: finite for logits of any size.

/// ln(1 + e^x).
fn softplus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

fn sigmoid(x: f64) -> f64 {
    if x >= 0.0 { 1.0 / (1.0 + (-x).exp()) } else { x.exp() / (1.0 + x.exp()) }
}

/// Cross-entropy of softmax over two classes whose logits differ by `logit`, against a pixel that is or is not inside;
/// and its derivative.
pub(super) fn cross_entropy(logit: f64, is_inside: bool) -> (f64, f64) {
    if is_inside { (softplus(-logit), -sigmoid(-logit)) } else { (softplus(logit), sigmoid(logit)) }
}

/// Divergence D(p || q) of two distributions over two classes, by the differences of their logits; and its derivatives
/// by both.
pub(super) fn divergence(of: f64, from: f64) -> (f64, [f64; 2]) {
    let (p, not_p) = (sigmoid(of), sigmoid(-of));
    // ln p - ln q and ln (1 - p) - ln (1 - q), without a probability that could be 0.
    let (is, is_not) = (softplus(-from) - softplus(-of), softplus(from) - softplus(of));
    let loss = (p * is + not_p * is_not).max(0.0);
    (loss, [p * not_p * (of - from), sigmoid(from) - p])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_those_of_the_probabilities() {
        let (loss, slope) = cross_entropy(0.5, true);
        let p = 1.0 / (1.0 + (-0.5_f64).exp());
        assert!((loss + p.ln()).abs() < 1e-12 && (slope - (p - 1.0)).abs() < 1e-12);
        let (loss, slope) = cross_entropy(0.5, false);
        assert!((loss + (1.0 - p).ln()).abs() < 1e-12 && (slope - p).abs() < 1e-12);
        let q: f64 = 1.0 / (1.0 + 2.0_f64.exp());
        let (loss, _) = divergence(0.5, -2.0);
        let expected = p * (p / q).ln() + (1.0 - p) * ((1.0 - p) / (1.0 - q)).ln();
        assert!((loss - expected).abs() < 1e-12);
        assert_eq!(divergence(1.25, 1.25), (0.0, [0.0, 0.0]));
    }

    #[test]
    fn slopes_are_those_of_central_differences() {
        let h = 1e-5;
        for (of, from) in [(0.5, -2.0), (3.0, 2.5), (-4.0, 1.0)] {
            let (_, [by_of, by_from]) = divergence(of, from);
            let along_of = (divergence(of + h, from).0 - divergence(of - h, from).0) / (2.0 * h);
            let along_from = (divergence(of, from + h).0 - divergence(of, from - h).0) / (2.0 * h);
            assert!((by_of - along_of).abs() < 1e-8 && (by_from - along_from).abs() < 1e-8);
        }
        for (logit, inside) in [(0.3, true), (-2.0, true), (4.0, false)] {
            let along = (cross_entropy(logit + h, inside).0 - cross_entropy(logit - h, inside).0) / (2.0 * h);
            assert!((cross_entropy(logit, inside).1 - along).abs() < 1e-8);
        }
    }

    #[test]
    fn probabilities_of_0_and_1_give_finite_losses() {
        for logit in [1e4, -1e4, 1e30, -1e30] {
            for inside in [true, false] {
                let (loss, slope) = cross_entropy(logit, inside);
                assert!(loss.is_finite() && loss >= 0.0 && (-1.0..=1.0).contains(&slope));
            }
            for other in [0.0, 1e4, -1e4, logit] {
                for (of, from) in [(logit, other), (other, logit)] {
                    let (loss, [by_of, by_from]) = divergence(of, from);
                    assert!(loss.is_finite() && loss >= 0.0, "{of} {from}");
                    assert!(by_of.is_finite() && (-1.0..=1.0).contains(&by_from));
                }
            }
        }
        assert_eq!(divergence(1e4, -1e4).0, 1e4);
    }
}
