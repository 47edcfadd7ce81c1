//! Polygons to pixels. Tools disagree about the border, so the rule is part of what an annotation says.

use l4d_masks::Mask;

/// Fractional bits of a column while an edge goes down.
const SHIFT: u32 = 16;
/// Corners farther out than this many pixels are moved there: no picture is that large, and nothing overflows.
const FARTHEST: f64 = 100_000.0;

/// How a polygon becomes pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// As `cv2.fillPoly` of OpenCV up to 4.10 after a cast to int32: corners lose their fraction, the border belongs to the polygon,
    /// and rows end at the nearest column. Later versions (4.12, 5.0) round inwards, which takes a pixel from some slanted edges.
    Cv2,
    /// A pixel belongs if its centre lies inside, by the even-odd rule.
    Centres,
}

/// The pixels of a polygon.
pub fn fill(rule: Rule, corners: &[[f64; 2]], width: u32, height: u32) -> Mask {
    let mut mask = Mask::empty(width, height);
    let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.map(tamed)).collect();
    match rule {
        Rule::Cv2 => {
            let corners: Vec<[i64; 2]> =
                corners.iter().map(|corner| corner.map(|value| value as i64)).collect();
            cv2(&mut mask, &corners);
        }
        Rule::Centres => centres(&mut mask, &corners),
    }
    mask
}

/// What is no number becomes 0.
fn tamed(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-FARTHEST, FARTHEST) }
}

fn cv2(mask: &mut Mask, corners: &[[i64; 2]]) {
    for (from, to) in edges(corners) {
        line(mask, from, to);
    }
    let is_level = |(from, to): &([i64; 2], [i64; 2])| from[1] == to[1];
    let sloped: Vec<Edge> = edges(corners).filter(|edge| !is_level(edge)).map(Edge::new).collect();
    for row in 0..mask.height() {
        let y = i64::from(row);
        let mut crossings: Vec<i64> = sloped
            .iter()
            .filter(|edge| (edge.top..edge.bottom).contains(&y))
            .map(|edge| edge.at(y))
            .collect();
        crossings.sort_unstable();
        for pair in crossings.chunks_exact(2) {
            let nearest = |crossing: i64| (crossing + (1 << (SHIFT - 1))) >> SHIFT;
            span(mask, row, nearest(pair[0]), nearest(pair[1]));
        }
    }
}

fn centres(mask: &mut Mask, corners: &[[f64; 2]]) {
    for row in 0..mask.height() {
        let y = f64::from(row) + 0.5;
        let mut crossings: Vec<f64> = edges(corners)
            .filter(|(from, to)| (from[1] <= y) != (to[1] <= y))
            .map(|(from, to)| from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0]))
            .collect();
        crossings.sort_unstable_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            // Columns whose centre lies in [first, last).
            span(mask, row, (pair[0] - 0.5).ceil() as i64, (pair[1] - 0.5).ceil() as i64 - 1);
        }
    }
}

/// Each corner with the next, the last with the first.
fn edges<T: Copy>(corners: &[T]) -> impl Iterator<Item = (T, T)> {
    let next = corners.iter().skip(1).chain(corners.first());
    corners.iter().copied().zip(next.copied())
}

/// An edge that goes down, columns in fixed point.
struct Edge {
    top: i64,
    bottom: i64,
    start: i64,
    step: i64,
}

impl Edge {
    fn new((from, to): ([i64; 2], [i64; 2])) -> Self {
        let (upper, lower) = if from[1] < to[1] { (from, to) } else { (to, from) };
        let step = ((lower[0] - upper[0]) << SHIFT) / (lower[1] - upper[1]);
        Self { top: upper[1], bottom: lower[1], start: upper[0] << SHIFT, step }
    }

    fn at(&self, y: i64) -> i64 {
        self.start + (y - self.top) * self.step
    }
}

/// Pixels first..=last of a row.
fn span(mask: &mut Mask, row: u32, first: i64, last: i64) {
    let last = last.min(i64::from(mask.width()) - 1);
    for column in first.max(0)..=last {
        mask.set(column as u32, row, true);
    }
}

/// Pixels on a line, one a step of the longer axis, from left to right.
fn line(mask: &mut Mask, from: [i64; 2], to: [i64; 2]) {
    let ([x0, y0], [x1, y1]) = if from[0] <= to[0] { (from, to) } else { (to, from) };
    let (wide, tall) = (x1 - x0, (y1 - y0).abs());
    let down = (y1 - y0).signum();
    let (long, short) = (wide.max(tall), wide.min(tall));
    let (mut x, mut y, mut error) = (x0, y0, long - 2 * short);
    for _ in 0..=long {
        let (width, height) = (i64::from(mask.width()), i64::from(mask.height()));
        if (0..width).contains(&x) && (0..height).contains(&y) {
            mask.set(x as u32, y as u32, true);
        }
        let is_sideways = error < 0;
        error += if is_sideways { 2 * long - 2 * short } else { -2 * short };
        if wide > tall || is_sideways {
            x += 1;
        }
        if wide <= tall || is_sideways {
            y += down;
        }
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Deserialize)]
    struct Case {
        points: Vec<[f64; 2]>,
        rows: Vec<String>,
    }

    #[test]
    fn polygons_have_the_pixels_that_opencv_gives_them() {
        let cases = include_str!("../../tests/data/fill_poly.jsonl");
        let mut count = 0;
        for line in cases.lines() {
            let case: Case = serde_json::from_str(line).unwrap();
            let mask = fill(Rule::Cv2, &case.points, 24, 24);
            let rows: Vec<String> = (0..24)
                .map(|row| (0..24).map(|column| if mask.get(column, row) { '#' } else { '.' }).collect())
                .collect();
            assert_eq!(rows, case.rows, "{:?}", case.points);
            count += 1;
        }
        assert_eq!(count, 120);
    }

    #[test]
    fn the_rules_differ_by_the_border() {
        let square = [[2.0, 2.0], [6.0, 2.0], [6.0, 6.0], [2.0, 6.0]];
        assert_eq!(fill(Rule::Centres, &square, 9, 9).area(), 16);
        assert_eq!(fill(Rule::Cv2, &square, 9, 9).area(), 25);
        let ring = [
            [0.0, 0.0],
            [8.0, 0.0],
            [8.0, 8.0],
            [0.0, 8.0],
            [0.0, 0.0],
            [2.0, 2.0],
            [6.0, 2.0],
            [6.0, 6.0],
            [2.0, 6.0],
            [2.0, 2.0],
        ];
        assert_eq!(fill(Rule::Centres, &ring, 9, 9).area(), 64 - 16);
    }

    #[test]
    fn absurd_corners_end_at_the_border() {
        let wild = [[f64::NAN, -1e300], [1e300, f64::INFINITY], [-5.0, 3.0]];
        for rule in [Rule::Cv2, Rule::Centres] {
            assert!(fill(rule, &wild, 7, 5).area() <= 35);
            assert!(fill(rule, &[], 7, 5).is_empty());
        }
    }
}
