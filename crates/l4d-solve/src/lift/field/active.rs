//! Which Gaussians a step needs.
//!
//! Those with no blend weight in a picture change neither its loss nor any derivative, so that leaving them out is
//! exact. Of the others only those learn by whose logits the loss changes: leaving out the rest is the bounded
//! approximation of [`super::FieldSettings::left_out`].

/// Gaussians that show in a picture, ascending; `weights` holds the sum of each one's blend weights over its pixels.
pub(super) fn visible(weights: &[f32]) -> Vec<u32> {
    (0..weights.len() as u32).filter(|&row| weights[row as usize] > 0.0).collect()
}

/// Places of the derivatives that matter, ascending: the smallest are left out as long as they add up to no more than
/// the share `left_out` of all, signs aside.
pub(super) fn steep(slopes: &[f32], left_out: f64) -> Vec<u32> {
    let size = |place: u32| slopes[place as usize].abs();
    let mut places: Vec<u32> = (0..slopes.len() as u32).collect();
    places.sort_unstable_by(|&a, &b| size(a).total_cmp(&size(b)).then(a.cmp(&b)));
    let budget = left_out * places.iter().map(|&place| f64::from(size(place))).sum::<f64>();
    let mut spent = 0.0;
    let dropped = places.iter().take_while(|&&place| {
        spent += f64::from(size(place));
        spent <= budget
    });
    let dropped = dropped.count();
    places.drain(..dropped);
    places.sort_unstable();
    places
}

/// Rows of one step without repetition, and where each Gaussian stands among them.
#[derive(Debug)]
pub(super) struct Rows {
    /// The Gaussians, in the order in which they were first asked for.
    pub(super) list: Vec<u32>,
    places: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

impl Rows {
    pub(super) fn new(gaussians: usize) -> Self {
        Self { list: Vec::new(), places: vec![ABSENT; gaussians] }
    }

    pub(super) fn clear(&mut self) {
        for &row in &self.list {
            self.places[row as usize] = ABSENT;
        }
        self.list.clear();
    }

    /// Where a Gaussian stands; a new one is added.
    pub(super) fn place(&mut self, gaussian: u32) -> usize {
        let place = &mut self.places[gaussian as usize];
        if *place == ABSENT {
            *place = self.list.len() as u32;
            self.list.push(gaussian);
        }
        *place as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_weight_is_not_visible() {
        assert_eq!(visible(&[0.0, 3.0, 1e-9, 0.0, 2.0]), [1, 2, 4]);
    }

    #[test]
    fn what_is_left_out_adds_up_to_no_more_than_allowed() {
        let slopes = [1.0, -5.0, 2.0, 0.0, -2.0];
        assert_eq!(steep(&slopes, 0.05), [0, 1, 2, 4]);
        assert_eq!(steep(&slopes, 0.1), [1, 2, 4]);
        assert_eq!(steep(&slopes, 0.3), [1, 4]);
        assert_eq!(steep(&slopes, 0.5), [1]);
        assert_eq!(steep(&[0.0, 0.0], 0.1), [0; 0]);
    }

    #[test]
    fn a_row_stands_once() {
        let mut rows = Rows::new(5);
        assert_eq!([3, 1, 3, 0].map(|row| rows.place(row)), [0, 1, 0, 2]);
        assert_eq!(rows.list, [3, 1, 0]);
        rows.clear();
        assert_eq!(rows.place(1), 0);
    }
}
