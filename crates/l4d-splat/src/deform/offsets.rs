//! Offsets that a field gives for Gaussians at one time.

use crate::gaussians::Gaussians;

use super::config::{DeformConfig, Head};
use super::error::DeformError;
use super::network::SlicesMut;

/// Offsets of raw parameters, one per row, or their gradients. A list is empty where the field leaves that parameter
/// alone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Offsets {
    /// Of centres, metres.
    pub means: Vec<[f32; 3]>,
    /// Of logarithms of scales.
    pub log_scales: Vec<[f32; 3]>,
    /// Of quaternions before they are normalised.
    pub rotations: Vec<[f32; 4]>,
    /// Of opacities before the sigmoid.
    pub opacity_logits: Vec<f32>,
    /// Of spherical harmonics, laid out as [`Gaussians::sh`].
    pub sh: Vec<[f32; 3]>,
}

impl Offsets {
    /// Offsets of zero for so many rows.
    pub fn zeros(config: &DeformConfig, rows: usize) -> Self {
        let rows_of = |head: Head| if head.is_on(config) { rows } else { 0 };
        Self {
            means: vec![[0.0; 3]; rows_of(Head::Means)],
            log_scales: vec![[0.0; 3]; rows_of(Head::LogScales)],
            rotations: vec![[0.0; 4]; rows_of(Head::Rotations)],
            opacity_logits: vec![0.0; rows_of(Head::OpacityLogits)],
            sh: vec![[0.0; 3]; rows_of(Head::Sh) * config.sh_coefficients],
        }
    }

    /// Adds row `k` to the Gaussian `rows[k]`. The derivative is the identity: what a Gaussian's raw parameters get
    /// as gradient, its row gets too.
    ///
    /// # Errors
    /// Lists whose lengths do not belong to `rows` and to these Gaussians, and a row that names no Gaussian.
    /// The Gaussians are then unchanged.
    pub fn add_to(&self, gaussians: &mut Gaussians, rows: &[u32]) -> Result<(), DeformError> {
        let coefficients = gaussians.sh_degree.coefficients();
        let lengths = [
            ("means", self.means.len(), rows.len()),
            ("log_scales", self.log_scales.len(), rows.len()),
            ("rotations", self.rotations.len(), rows.len()),
            ("opacity_logits", self.opacity_logits.len(), rows.len()),
            ("sh", self.sh.len(), rows.len() * coefficients),
        ];
        for (field, found, expected) in lengths {
            if found != 0 && found != expected {
                return Err(DeformError::length(field, found, expected));
            }
        }
        let count = gaussians.len();
        if let Some((row, &index)) = rows.iter().enumerate().find(|&(_, &index)| index as usize >= count) {
            return Err(DeformError::row(row, index, count));
        }
        add_rows(&mut gaussians.means, &self.means, rows, 1);
        add_rows(&mut gaussians.log_scales, &self.log_scales, rows, 1);
        add_rows(&mut gaussians.rotations, &self.rotations, rows, 1);
        add_rows(gaussians.opacity_logits.as_chunks_mut::<1>().0, self.opacity_logits.as_chunks().0, rows, 1);
        add_rows(&mut gaussians.sh, &self.sh, rows, coefficients);
        Ok(())
    }

    /// Rows of a gradient that are not zero, ascending.
    pub(super) fn nonzero_rows(&self, config: &DeformConfig, rows: usize) -> Vec<u32> {
        let mut says = vec![false; rows];
        for (head, list) in Head::ALL.into_iter().zip(self.flat()) {
            for (says, values) in says.iter_mut().zip(list.chunks_exact(head.outputs(config))) {
                *says |= values.iter().any(|&value| value != 0.0);
            }
        }
        (0..rows as u32).filter(|&row| says[row as usize]).collect()
    }

    /// Some of the rows, in place of what `into` held.
    pub(crate) fn gather(&self, coefficients: usize, rows: &[u32], into: &mut Self) {
        fn picked<T: Copy>(from: &[T], into: &mut Vec<T>, rows: &[u32], numbers: usize) {
            into.clear();
            if !from.is_empty() {
                let row = |&row: &u32| from[row as usize * numbers..][..numbers].iter().copied();
                into.extend(rows.iter().flat_map(row));
            }
        }
        picked(&self.means, &mut into.means, rows, 1);
        picked(&self.log_scales, &mut into.log_scales, rows, 1);
        picked(&self.rotations, &mut into.rotations, rows, 1);
        picked(&self.opacity_logits, &mut into.opacity_logits, rows, 1);
        picked(&self.sh, &mut into.sh, rows, coefficients);
    }

    /// All numbers, list after list in the order of the fields.
    pub fn flat(&self) -> [&[f32]; 5] {
        [
            self.means.as_flattened(),
            self.log_scales.as_flattened(),
            self.rotations.as_flattened(),
            &self.opacity_logits,
            self.sh.as_flattened(),
        ]
    }

    /// As [`Self::flat`], to be changed.
    pub fn flat_mut(&mut self) -> [&mut [f32]; 5] {
        [
            self.means.as_flattened_mut(),
            self.log_scales.as_flattened_mut(),
            self.rotations.as_flattened_mut(),
            &mut self.opacity_logits,
            self.sh.as_flattened_mut(),
        ]
    }

    /// The lists cut into blocks of so many rows.
    pub(super) fn blocks_mut(
        &mut self,
        config: &DeformConfig,
        rows: usize,
        count: usize,
    ) -> Vec<SlicesMut<'_>> {
        let outputs = Head::ALL.map(|head| head.outputs(config));
        let mut index = 0;
        let mut blocks = self.flat_mut().map(|list| {
            index += 1;
            list.chunks_mut(rows * outputs[index - 1])
        });
        (0..count).map(|_| blocks.each_mut().map(|blocks| blocks.next().unwrap_or_default())).collect()
    }

    /// The first value that is not finite: field, row, value.
    pub(super) fn bad_value(&self, config: &DeformConfig) -> Option<(&'static str, usize, f32)> {
        Head::ALL.into_iter().zip(self.flat()).find_map(|(head, list)| {
            let place = list.iter().position(|value| !value.is_finite())?;
            Some((head.field(), place / head.outputs(config), list[place]))
        })
    }

    /// Whether every list is as long as the field makes it for so many rows.
    pub(super) fn check_lengths(&self, config: &DeformConfig, rows: usize) -> Result<(), DeformError> {
        for (head, list) in Head::ALL.into_iter().zip(self.flat()) {
            let expected = if head.is_on(config) { rows * head.outputs(config) } else { 0 };
            if list.len() != expected {
                return Err(DeformError::length(head.field(), list.len(), expected));
            }
        }
        Ok(())
    }
}

fn add_rows<const N: usize>(to: &mut [[f32; N]], offsets: &[[f32; N]], rows: &[u32], lists: usize) {
    for (offsets, &row) in offsets.chunks_exact(lists).zip(rows) {
        let to = &mut to[row as usize * lists..][..lists];
        for (to, offset) in to.as_flattened_mut().iter_mut().zip(offsets.as_flattened()) {
            *to += offset;
        }
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
        offsets.add_to(&mut gaussians, &[2, 0]).unwrap();
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
        let message = offsets.add_to(&mut gaussians, &[0, 3]).unwrap_err().to_string();
        assert_eq!(message, "dynamic row 1 names Gaussian 3, but there are 3");
        assert!(offsets.add_to(&mut gaussians, &[0]).is_err());
        let full = Offsets { sh: vec![[1.0; 3]; 32], ..Offsets::default() };
        assert!(full.add_to(&mut gaussians, &[0, 1]).unwrap_err().to_string().contains("8 belong"));
        assert_eq!(gaussians, three());
    }
}
