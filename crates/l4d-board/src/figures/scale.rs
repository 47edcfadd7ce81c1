//! The plane of costs and gains: costs on a logarithmic axis to the right, gains on a plain one upwards.

use super::drawing::{AXIS, Anchor, Drawing, GRID, Lettering, MARGIN, WIDTH};

pub(super) const LEFT: f64 = MARGIN + 34.0;
pub(super) const RIGHT: f64 = WIDTH - MARGIN - 8.0;
/// Free space between the outermost costs and the edges.
const INSET: f64 = 18.0;

/// Where costs and gains lie.
pub(super) struct Scale {
    /// Logarithms of the outermost costs.
    cost: (f64, f64),
    gain: (f64, f64),
    /// Free space above and below the outermost gains.
    inset: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl Scale {
    /// Fits costs and gains that have been measured. All are finite, costs above 0.
    pub(super) fn fitted(points: &[(f64, f64)], (top, bottom): (f64, f64)) -> Self {
        let cost = range(points.iter().map(|point| point.0.ln()), 0.2);
        Self { cost, gain: range(points.iter().map(|point| point.1), 1.0), inset: INSET, top, bottom }
    }

    /// Fits costs; gains go from 0 to 100.
    pub(super) fn of_percentages(
        costs: impl Iterator<Item = f64> + Clone,
        (top, bottom): (f64, f64),
    ) -> Self {
        Self { cost: range(costs.map(f64::ln), 1.0), gain: (0.0, 100.0), inset: 0.0, top, bottom }
    }

    pub(super) fn position(&self, cost: f64, gain: f64) -> (f64, f64) {
        (self.x(cost), self.y(gain))
    }

    fn x(&self, cost: f64) -> f64 {
        let share = (cost.ln() - self.cost.0) / (self.cost.1 - self.cost.0);
        LEFT + INSET + share * (RIGHT - LEFT - 2.0 * INSET)
    }

    fn y(&self, gain: f64) -> f64 {
        let share = (gain - self.gain.0) / (self.gain.1 - self.gain.0);
        self.bottom - self.inset - share * (self.bottom - self.top - 2.0 * self.inset)
    }

    /// Grid, numbers and titles; 34 print pixels below `bottom` are taken.
    pub(super) fn axes(&self, drawing: &mut Drawing, cost: &str, gain: &str) {
        let (top, bottom) = (self.top, self.bottom);
        let inside = |at: f64, from: f64, to: f64| (from..=to).contains(&at);
        let mut free_from = f64::NEG_INFINITY;
        for tick in round_costs(self.cost) {
            let x = self.x(tick);
            let label = plain(tick);
            let half = Lettering::NOTE.width(&label) / 2.0;
            if inside(x, LEFT + half, RIGHT - half) && x - half > free_from {
                drawing.line([(x, top), (x, bottom)], 0.5, GRID);
                drawing.text(x, bottom + 16.0, &label, Lettering::NOTE.anchored(Anchor::Middle));
                free_from = x + half + 6.0;
            }
        }
        for tick in round_gains(self.gain) {
            let y = self.y(tick);
            if inside(y, top - 1e-6, bottom + 1e-6) {
                drawing.line([(LEFT, y), (RIGHT, y)], 0.5, GRID);
                drawing.text(LEFT - 6.0, y + 3.5, &plain(tick), Lettering::NOTE.anchored(Anchor::End));
            }
        }
        drawing.line([(LEFT, top), (LEFT, bottom), (RIGHT, bottom)], 0.75, AXIS);
        drawing.text(MARGIN, top - 12.0, gain, Lettering::HEAD);
        drawing.text(RIGHT, bottom + 32.0, cost, Lettering::HEAD.anchored(Anchor::End));
    }
}

/// Lowest and highest value, with at least this between them.
fn range(values: impl Iterator<Item = f64> + Clone, least: f64) -> (f64, f64) {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let lacking = (least - (high - low)).max(0.0) / 2.0;
    (low - lacking, high + lacking)
}

/// 1, 2 and 5 times powers of ten, within a range of logarithms with some room.
fn round_costs((low, high): (f64, f64)) -> Vec<f64> {
    let first = (low / std::f64::consts::LN_10).floor() as i32 - 1;
    let last = (high / std::f64::consts::LN_10).ceil() as i32 + 1;
    let decade = |power: i32| [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|digit| digit * 10_f64.powi(power));
    let ticks: Vec<f64> = (first..=last).flat_map(decade).collect();
    // Few ticks on a wide axis, more on a narrow one.
    let digits: &[f64] = match high - low {
        width if width > 14.0 => &[1.0],
        width if width > 2.5 => &[1.0, 2.0, 5.0],
        _ => &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
    };
    ticks.into_iter().filter(|tick| digits.contains(&leading_digit(*tick))).collect()
}

fn leading_digit(value: f64) -> f64 {
    let digit = value / 10_f64.powf(value.log10().floor());
    (digit * 10.0).round() / 10.0
}

/// Multiples of a round step, about six of them.
fn round_gains((low, high): (f64, f64)) -> Vec<f64> {
    let steps = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0];
    let step = steps.into_iter().find(|step| (high - low) / step <= 7.0).unwrap_or((high - low) / 6.0);
    // One tick more on each side: the axes reach beyond the outermost points.
    let (first, last) = ((low / step).floor() as i64 - 1, (high / step).ceil() as i64 + 1);
    (first..=last).map(|index| index as f64 * step).collect()
}

/// A number in as few letters as it takes.
fn plain(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(round_gains((30.2, 35.1)), [29.0, 30.0, 31.0, 32.0, 33.0, 34.0, 35.0, 36.0, 37.0]);
        let wide: Vec<f64> = round_costs((1_f64.ln(), 100_f64.ln()))
            .into_iter()
            .filter(|t| (1.0..=100.0).contains(t))
            .collect();
        assert_eq!(wide, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!([plain(0.5), plain(20.0), plain(1.0)], ["0.5", "20", "1"]);
    }

    #[test]
    fn gains_grow_upwards_and_costs_to_the_right() {
        let scale = Scale::fitted(&[(2.0, 30.0), (20.0, 39.0)], (0.0, 300.0));
        let (cheap, dear) = (scale.position(2.0, 30.0), scale.position(20.0, 39.0));
        assert!(cheap.0 < dear.0 && cheap.1 > dear.1);
    }

    #[test]
    fn a_single_cost_and_costs_of_all_sizes_have_their_axis() {
        for costs in [vec![3.0], vec![3.0, 3.0], vec![1e-9, 1e12], vec![1e-300, 1e300]] {
            let scale = Scale::of_percentages(costs.iter().copied(), (40.0, 240.0));
            let mut drawing = Drawing::headed("costs", &[]).0;
            scale.axes(&mut drawing, "seconds", "mIoU");
            for cost in costs {
                let (x, y) = scale.position(cost, 0.0);
                assert!((LEFT..=RIGHT).contains(&x) && y == 240.0, "{cost}: {x}");
            }
        }
        assert_eq!([plain(1e-9), plain(2e7)], ["1e-9", "2e7"]);
    }
}
