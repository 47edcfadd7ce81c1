//! Pixels to segments: centres are peaks, and every pixel of a thing goes to the centre that it points at.
//!
//! `training/l4d_network/segment.py` does the same.

use crate::weights::Description;

/// What the network says of the pixels of a picture at half resolution: four planes, a thing, a centre, offsets down and
/// to the right.
pub(crate) struct Pixels<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) planes: &'a [f32],
}

impl Pixels<'_> {
    fn plane(&self, number: usize) -> &[f32] {
        let size = self.width * self.height;
        &self.planes[number * size..][..size]
    }

    /// Places of the peaks (row, column) of half resolution, the highest first.
    pub(crate) fn centres(&self, described: &Description) -> Vec<[f32; 2]> {
        let centre = self.plane(1);
        let reach = described.peak_px;
        let mut peaks: Vec<(f32, usize)> = Vec::new();
        for row in 0..self.height {
            for column in 0..self.width {
                let value = centre[row * self.width + column];
                let rows = row.saturating_sub(reach)..(row + reach + 1).min(self.height);
                let is_highest = |at: usize| {
                    let columns = column.saturating_sub(reach)..(column + reach + 1).min(self.width);
                    centre[at * self.width..][columns].iter().all(|other| *other <= value)
                };
                if value > described.peak && rows.clone().all(is_highest) {
                    peaks.push((value, row * self.width + column));
                }
            }
        }
        peaks.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        peaks.truncate(described.most);
        let place = |(_, at): &(f32, usize)| [(at / self.width) as f32, (at % self.width) as f32];
        peaks.iter().map(place).collect()
    }

    /// Number of the centre of each pixel, 0 for the background, at a size of its own: between pixels of half resolution
    /// what the network says is interpolated.
    pub(crate) fn labels(
        &self,
        centres: &[[f32; 2]],
        offset_px: f32,
        [width, height]: [usize; 2],
    ) -> Vec<u32> {
        if centres.is_empty() {
            return vec![0; width * height];
        }
        let [by_column, by_row] = [self.width as f32 / width as f32, self.height as f32 / height as f32];
        let mut labels = Vec::with_capacity(width * height);
        for row in 0..height {
            let y = ((row as f32 + 0.5) * by_row - 0.5).clamp(0.0, (self.height - 1) as f32);
            for column in 0..width {
                let x = ((column as f32 + 0.5) * by_column - 0.5).clamp(0.0, (self.width - 1) as f32);
                if self.between(0, x, y) <= 0.0 {
                    labels.push(0);
                    continue;
                }
                let aim = [y + offset_px * self.between(2, x, y), x + offset_px * self.between(3, x, y)];
                let distance =
                    |centre: &[f32; 2]| (centre[0] - aim[0]).powi(2) + (centre[1] - aim[1]).powi(2);
                let nearest = (0..centres.len())
                    .min_by(|a, b| distance(&centres[*a]).total_cmp(&distance(&centres[*b])));
                labels.push(nearest.map_or(0, |number| number as u32 + 1));
            }
        }
        labels
    }

    fn between(&self, plane: usize, x: f32, y: f32) -> f32 {
        let values = self.plane(plane);
        let (left, top) = (x as usize, y as usize);
        let (right, bottom) = ((left + 1).min(self.width - 1), (top + 1).min(self.height - 1));
        let (dx, dy) = (x - left as f32, y - top as f32);
        let at = |row: usize, column: usize| values[row * self.width + column];
        let upper = at(top, left) * (1.0 - dx) + at(top, right) * dx;
        let lower = at(bottom, left) * (1.0 - dx) + at(bottom, right) * dx;
        upper * (1.0 - dy) + lower * dy
    }
}
