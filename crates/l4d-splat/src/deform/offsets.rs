//! Offsets that a field gives for Gaussians at one time.

use crate::gaussians::{FIELDS, Gaussians};

use super::DeformError;
use super::config::DeformConfig;
use super::network::SlicesMut;

/// Offsets of raw parameters, one per row, or their gradients. A list is empty where the field leaves that parameter
/// alone.
pub type Offsets = Gaussians;

impl DeformConfig {
    /// Offsets of zero for so many rows.
    pub fn zeros(&self, rows: usize) -> Offsets {
        let [means, log_scales, rotations, opacity_logits, sh] = self.lengths(rows);
        Offsets {
            means: vec![[0.0; 3]; means / 3],
            log_scales: vec![[0.0; 3]; log_scales / 3],
            rotations: vec![[0.0; 4]; rotations / 4],
            opacity_logits: vec![0.0; opacity_logits],
            sh: vec![[0.0; 3]; sh / 3],
            ..Offsets::default()
        }
    }

    /// Whether every list is as long as the field makes it for so many rows.
    pub(super) fn check_lengths(&self, offsets: &Offsets, rows: usize) -> Result<(), DeformError> {
        for ((field, list), expected) in FIELDS.into_iter().zip(offsets.flat()).zip(self.lengths(rows)) {
            if list.len() != expected {
                return Err(DeformError::length(field, list.len(), expected));
            }
        }
        Ok(())
    }

    /// Rows of a gradient that are not zero, ascending.
    pub(super) fn nonzero_rows(&self, gradient: &Offsets, rows: usize) -> Vec<u32> {
        let mut says = vec![false; rows];
        for (list, outputs) in gradient.flat().into_iter().zip(self.outputs()) {
            for (says, values) in says.iter_mut().zip(list.chunks_exact(outputs)) {
                *says |= values.iter().any(|&value| value != 0.0);
            }
        }
        (0..rows as u32).filter(|&row| says[row as usize]).collect()
    }

    /// The lists cut into blocks of so many rows.
    pub(super) fn blocks_mut<'a>(
        &self,
        offsets: &'a mut Offsets,
        rows: usize,
        count: usize,
    ) -> Vec<SlicesMut<'a>> {
        let mut outputs = self.outputs().into_iter();
        let mut blocks = offsets.flat_mut().map(|list| list.chunks_mut(rows * outputs.next().unwrap_or(1)));
        (0..count).map(|_| blocks.each_mut().map(|blocks| blocks.next().unwrap_or_default())).collect()
    }
}

impl Gaussians {
    /// Adds row `k` of `offsets` to the Gaussian `rows[k]`. The derivative is the identity: what a Gaussian's raw
    /// parameters get as gradient, its row gets too.
    ///
    /// # Errors
    /// Lists whose lengths do not belong to `rows` and to these Gaussians, and a row that names no Gaussian.
    /// The Gaussians are then unchanged.
    pub fn add_rows(&mut self, offsets: &Offsets, rows: &[u32]) -> Result<(), DeformError> {
        let (count, widths) = (self.len(), self.sh_degree.widths());
        for ((field, list), width) in FIELDS.into_iter().zip(offsets.flat()).zip(widths) {
            if !list.is_empty() && list.len() != rows.len() * width {
                return Err(DeformError::length(field, list.len(), rows.len() * width));
            }
        }
        if let Some((row, &index)) = rows.iter().enumerate().find(|&(_, &index)| index as usize >= count) {
            return Err(DeformError::row(row, index, count));
        }
        for ((list, offsets), width) in self.flat_mut().into_iter().zip(offsets.flat()).zip(widths) {
            for (&row, offsets) in rows.iter().zip(offsets.chunks_exact(width)) {
                let values = &mut list[row as usize * width..][..width];
                values.iter_mut().zip(offsets).for_each(|(value, offset)| *value += offset);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaussians::ShDegree;

    fn three() -> Gaussians {
        Gaussians {
            sh_degree: ShDegree::new(1).unwrap(),
            means: vec![[1.0; 3]; 3],
            log_scales: vec![[-3.0; 3]; 3],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 3],
            opacity_logits: vec![0.5; 3],
            sh: vec![[0.25; 3]; 12],
        }
    }

    #[test]
    fn each_row_changes_the_gaussian_it_names_and_no_other() {
        let mut gaussians = three();
        let mut sh = vec![[0.0; 3]; 8];
        sh[3] = [1.0, 2.0, 3.0];
        sh[4] = [4.0, 5.0, 6.0];
        let offsets = Offsets {
            means: vec![[1.0, 2.0, 3.0], [-1.0; 3]],
            rotations: vec![[0.0, 1.0, 0.0, 0.0]; 2],
            opacity_logits: vec![-0.5, 0.25],
            sh,
            ..Offsets::default()
        };
        gaussians.add_rows(&offsets, &[2, 0]).unwrap();
        let mut expected = three();
        expected.means = vec![[0.0; 3], [1.0; 3], [2.0, 3.0, 4.0]];
        expected.rotations = vec![[1.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]];
        expected.opacity_logits = vec![0.75, 0.5, 0.0];
        expected.sh[11] = [1.25, 2.25, 3.25];
        expected.sh[0] = [4.25, 5.25, 6.25];
        assert_eq!(gaussians, expected);
    }

    #[test]
    fn rows_and_lengths_that_do_not_fit_leave_everything_as_it_was() {
        let mut gaussians = three();
        let offsets = Offsets { means: vec![[1.0; 3]; 2], ..Offsets::default() };
        let message = gaussians.add_rows(&offsets, &[0, 3]).unwrap_err().to_string();
        assert_eq!(message, "dynamic row 1 names Gaussian 3, but there are 3");
        assert!(gaussians.add_rows(&offsets, &[0]).is_err());
        let full = Offsets { sh: vec![[1.0; 3]; 32], ..Offsets::default() };
        assert!(gaussians.add_rows(&full, &[0, 1]).unwrap_err().to_string().contains("24 belong"));
        assert_eq!(gaussians, three());
    }
}
