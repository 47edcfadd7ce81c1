//! Adam (Kingma and Ba 2015) over groups of parameters, each with its own learning rate.

use rayon::prelude::*;

use super::{LearningRate, OptimiseError, check, check_length};

/// What is kept of the mean gradient and of the mean squared gradient at each step: those of 4DGaussians.
const DECAYS: [f64; 2] = [0.9, 0.999];
/// Keeps the step finite where there has been no gradient.
const EPSILON: f32 = 1.0e-15;

/// What Adam remembers of one list of parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Moments {
    /// Running mean of the gradient.
    pub first: Vec<f32>,
    /// Running mean of its square.
    pub second: Vec<f32>,
}

/// Lists of parameters that learn at one rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// What errors call it.
    pub name: String,
    pub rate: LearningRate,
    /// Factors on the rate by place in a row of as many numbers; empty for none.
    pub pattern: Vec<f32>,
    /// One per list.
    pub moments: Vec<Moments>,
    pub steps: u64,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Adam {
    /// Groups in the order in which [`Self::step`] takes their shares.
    pub groups: Vec<Group>,
}

/// What one step needs of a group: its lists of parameters, and their gradients in the same order.
#[derive(Debug)]
pub struct GroupUpdate<'a> {
    /// To be changed.
    pub parameters: Vec<&'a mut [f32]>,
    /// As long as the parameters.
    pub gradients: Vec<&'a [f32]>,
}

/// Numbers that one task changes.
const CHUNK: usize = 1 << 14;

/// First moments smaller than this are set to zero: a parameter that no longer gets a gradient would otherwise keep
/// numbers so small that processors handle them a hundred times slower. They would move it by less than 1e-15 times the
/// rate.
const FORGOTTEN: f32 = 1.0e-30;

/// The same for second moments: their root is far below [`EPSILON`].
const FORGOTTEN_SQUARE: f32 = f32::MIN_POSITIVE;

impl Adam {
    /// One step with the rates of `iteration` (the schedule may have begun elsewhere than the moments).
    ///
    /// # Errors
    /// Updates that don't fit the groups, and a parameter or gradient that is not finite
    /// or whose square is not: the first by group. Nothing is then changed, in no group.
    pub fn step(&mut self, iteration: u64, updates: Vec<GroupUpdate<'_>>) -> Result<(), OptimiseError> {
        check_length("updates of an optimiser step", updates.len(), self.groups.len())?;
        for (group, update) in self.groups.iter().zip(&updates) {
            group.check(update)?;
        }
        for (group, update) in self.groups.iter_mut().zip(updates) {
            group.step(iteration, update);
        }
        Ok(())
    }
}

impl Group {
    /// A group that has not learned anything, with lists of these lengths.
    pub fn new(name: &str, rate: LearningRate, lengths: &[usize]) -> Self {
        let moments = |&length: &usize| Moments { first: vec![0.0; length], second: vec![0.0; length] };
        Self {
            name: name.to_owned(),
            rate,
            pattern: Vec::new(),
            moments: lengths.iter().map(moments).collect(),
            steps: 0,
        }
    }

    /// The group with factors on its rate.
    #[must_use]
    pub fn with_pattern(mut self, pattern: Vec<f32>) -> Self {
        self.pattern = pattern;
        self
    }

    /// Follows a change of rows: row `k` of every list was row `sources[k]`, or is new and has no past. Rows have
    /// `width` numbers.
    pub(crate) fn rearrange(&mut self, width: usize, sources: &[Option<u32>]) {
        let moved = |list: &[f32]| {
            let mut moved = vec![0.0; sources.len() * width];
            for (row, source) in moved.chunks_exact_mut(width).zip(sources) {
                if let Some(source) = source {
                    row.copy_from_slice(&list[*source as usize * width..][..width]);
                }
            }
            moved
        };
        for Moments { first, second } in &mut self.moments {
            (*first, *second) = (moved(first), moved(second));
        }
    }

    fn check(&self, update: &GroupUpdate<'_>) -> Result<(), OptimiseError> {
        let name = &self.name;
        check_length(&format!("lists of group `{name}`"), update.parameters.len(), self.moments.len())?;
        check_length(&format!("gradients of group `{name}`"), update.gradients.len(), self.moments.len())?;
        let lists = update.parameters.iter().zip(&update.gradients).zip(&self.moments).enumerate();
        for (index, ((parameters, gradient), moments)) in lists {
            for (what, list) in [("list", &**parameters), ("gradient", gradient)] {
                let what = || format!("{what} {index} of group `{name}`");
                check_length(&what(), list.len(), moments.first.len())?;
                check(list, what)?;
            }
        }
        Ok(())
    }

    fn step(&mut self, iteration: u64, update: GroupUpdate<'_>) {
        self.steps += 1;
        // Moments start at zero and are therefore too small at first.
        let [first_share, second_share] = DECAYS.map(|decay| 1.0 - decay.powf(self.steps as f64));
        let rate = (self.rate.at(iteration) / first_share) as f32;
        let root_share = (1.0 / second_share.sqrt()) as f32;
        let [kept, kept_square] = DECAYS.map(|decay| decay as f32);
        let [taken, taken_square] = DECAYS.map(|decay| (1.0 - decay) as f32);
        let adapt = |rate: f32, parameter: &mut f32, gradient: f32, first: &mut f32, second: &mut f32| {
            let mean = kept * *first + taken * gradient;
            *first = if mean.abs() < FORGOTTEN { 0.0 } else { mean };
            let square = kept_square * *second + taken_square * gradient * gradient;
            *second = if square < FORGOTTEN_SQUARE { 0.0 } else { square };
            *parameter -= rate * *first / (second.sqrt() * root_share + EPSILON);
        };
        let row = self.pattern.len();
        // Whole rows, so that every chunk begins where the pattern does.
        let chunk = if row == 0 { CHUNK } else { CHUNK.next_multiple_of(row) };
        let lists = update.parameters.into_iter().zip(update.gradients).zip(&mut self.moments);
        for ((parameters, gradient), Moments { first, second }) in lists {
            let chunks = (parameters.par_chunks_mut(chunk), gradient.par_chunks(chunk)).into_par_iter();
            let chunks = chunks.zip(first.par_chunks_mut(chunk)).zip(second.par_chunks_mut(chunk));
            chunks.for_each(|(((parameters, gradient), first), second)| {
                let numbers = parameters.iter_mut().zip(gradient).zip(first).zip(second);
                if row == 0 {
                    for (((parameter, &gradient), first), second) in numbers {
                        adapt(rate, parameter, gradient, first, second);
                    }
                } else {
                    for ((((parameter, &gradient), first), second), &factor) in
                        numbers.zip(self.pattern.iter().cycle())
                    {
                        adapt(rate * factor, parameter, gradient, first, second);
                    }
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(adam: &mut Adam, parameters: &mut [f32], gradient: &[f32]) -> Result<(), OptimiseError> {
        adam.step(0, vec![GroupUpdate { parameters: vec![parameters], gradients: vec![gradient] }])
    }

    fn adam(pattern: Vec<f32>) -> Adam {
        let rate = LearningRate::constant(0.1).unwrap();
        Adam { groups: vec![Group::new("means", rate, &[4]).with_pattern(pattern)] }
    }

    #[test]
    fn the_first_step_is_the_rate_whatever_the_size_of_the_gradient() {
        let mut parameters = [1.0; 4];
        step(&mut adam(vec![]), &mut parameters, &[1.0e-6, -1.0e6, 0.0, 3.0]).unwrap();
        for (parameter, expected) in parameters.into_iter().zip([0.9, 1.1, 1.0, 0.9]) {
            assert!((parameter - expected).abs() < 1.0e-6, "{parameters:?}");
        }
    }

    #[test]
    fn a_pattern_slows_its_places_down() {
        let mut parameters = [1.0; 4];
        step(&mut adam(vec![1.0, 0.5]), &mut parameters, &[1.0; 4]).unwrap();
        for (parameter, expected) in parameters.into_iter().zip([0.9, 0.95, 0.9, 0.95]) {
            assert!((parameter - expected).abs() < 1.0e-6, "{parameters:?}");
        }
    }

    #[test]
    fn a_poisoned_gradient_changes_nothing() {
        for poison in [f32::NAN, f32::INFINITY, 1.0e20] {
            let (mut adam, mut parameters) = (adam(vec![]), [1.0; 4]);
            let error = step(&mut adam, &mut parameters, &[1.0, 1.0, poison, 1.0]).unwrap_err().to_string();
            let expected = format!("gradient 0 of group `means`: value 2 is {poison}");
            assert!(error.starts_with(&expected), "{error}");
            assert_eq!((adam, parameters), (self::adam(vec![]), [1.0; 4]));
        }
        let mut parameters = [1.0, f32::NAN, 1.0, 1.0];
        let error = step(&mut adam(vec![]), &mut parameters, &[1.0; 4]).unwrap_err().to_string();
        assert!(error.starts_with("list 0 of group `means`: value 1 is NaN"), "{error}");
        assert!(step(&mut adam(vec![]), &mut [1.0; 3], &[1.0; 3]).is_err());
    }

    #[test]
    fn moments_follow_their_rows() {
        let rate = LearningRate::constant(0.1).unwrap();
        let mut group = Group::new("means", rate, &[6]);
        group.moments[0] =
            Moments { first: vec![1., 2., 3., 4., 5., 6.], second: vec![10., 20., 30., 40., 50., 60.] };
        group.rearrange(2, &[Some(2), None, Some(0), Some(2)]);
        assert_eq!(group.moments[0].first, [5., 6., 0., 0., 1., 2., 5., 6.]);
        assert_eq!(group.moments[0].second, [50., 60., 0., 0., 10., 20., 50., 60.]);
    }

    #[test]
    fn a_parameter_without_gradient_comes_to_rest() {
        let (mut adam, mut parameters) = (adam(vec![]), [1.0; 4]);
        step(&mut adam, &mut parameters, &[1.0; 4]).unwrap();
        for _ in 0..1000 {
            step(&mut adam, &mut parameters, &[0.0; 4]).unwrap();
        }
        assert_eq!(adam.groups[0].moments[0].first, [0.0; 4]);
        assert!(parameters.iter().all(|parameter| parameter.is_finite()));
    }

    #[test]
    fn moments_are_never_too_small_for_fast_arithmetic() {
        let (mut adam, mut parameters) = (adam(vec![]), [1.0; 4]);
        let is_fast = |value: &f32| *value == 0.0 || value.is_normal();
        for gradient in [1.0e-21, 1.0e-18, 1.0e-16, 0.0, 0.0, 0.0] {
            step(&mut adam, &mut parameters, &[gradient; 4]).unwrap();
            let Moments { first, second } = &adam.groups[0].moments[0];
            assert!(first.iter().chain(second).all(is_fast), "{first:?} {second:?}");
        }
        assert!(parameters.iter().all(|parameter| (0.5..1.0).contains(parameter)), "{parameters:?}");
    }
}
