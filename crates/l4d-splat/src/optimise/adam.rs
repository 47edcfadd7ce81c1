//! Adam (Kingma and Ba 2015) over groups of parameters, each with its own learning rate.

use rayon::prelude::*;

use super::error::OptimiseError;
use super::finite::{check, check_length};
use super::rate::LearningRate;

/// Constants of Adam; those of 4DGaussians are the default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamSettings {
    /// What is kept of the mean gradient at each step.
    pub first_decay: f64,
    /// What is kept of the mean squared gradient at each step.
    pub second_decay: f64,
    /// Keeps the step finite where there has been no gradient; at least [`LEAST_EPSILON`].
    pub epsilon: f32,
}

/// The smallest epsilon: the root of the smallest second moment that is kept stays far below it.
pub const LEAST_EPSILON: f32 = 1.0e-16;

impl Default for AdamSettings {
    fn default() -> Self {
        Self { first_decay: 0.9, second_decay: 0.999, epsilon: 1.0e-15 }
    }
}

impl AdamSettings {
    fn check(&self) -> Result<(), OptimiseError> {
        for (setting, value) in
            [("first decay of Adam", self.first_decay), ("second decay of Adam", self.second_decay)]
        {
            if !(0.0..1.0).contains(&value) {
                return Err(OptimiseError::Setting { setting, value, range: "at least 0 and below 1" });
            }
        }
        if !(LEAST_EPSILON..=1.0).contains(&self.epsilon) {
            let (setting, value) = ("epsilon of Adam", self.epsilon.into());
            return Err(OptimiseError::Setting { setting, value, range: "from 1e-16 to 1" });
        }
        Ok(())
    }
}

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
    /// The rate.
    pub rate: LearningRate,
    /// Factors on the rate by place in a row of as many numbers; empty for none.
    pub pattern: Vec<f32>,
    /// One a list.
    pub moments: Vec<Moments>,
    /// Steps taken.
    pub steps: u64,
}

/// The optimiser.
#[derive(Debug, Clone, PartialEq)]
pub struct Adam {
    /// Constants.
    pub settings: AdamSettings,
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
/// numbers so small that processors handle them a hundred times slower. With the default epsilon they would move it
/// by less than 1e-15 times the rate.
const FORGOTTEN: f32 = 1.0e-30;

/// The same for second moments: their root is a thousandth of [`LEAST_EPSILON`].
const FORGOTTEN_SQUARE: f32 = f32::MIN_POSITIVE;

impl Adam {
    /// One step with the rates of `iteration` (the schedule may have begun elsewhere than the moments).
    ///
    /// # Errors
    /// Settings outside their ranges, shares that don't fit the groups, and a parameter or gradient that is not finite
    /// or whose square is not: the first by group. Nothing is then changed, in no group.
    pub fn step(&mut self, iteration: u64, shares: Vec<GroupUpdate<'_>>) -> Result<(), OptimiseError> {
        self.settings.check()?;
        check_length("shares of an optimiser step", shares.len(), self.groups.len())?;
        for (group, share) in self.groups.iter().zip(&shares) {
            group.check(share)?;
        }
        for (group, share) in self.groups.iter_mut().zip(shares) {
            group.step(&self.settings, iteration, share);
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
    ///
    /// # Errors
    /// A source that there is not. The group is then unchanged.
    pub fn rearrange(&mut self, width: usize, sources: &[Option<u32>]) -> Result<(), OptimiseError> {
        let lengths = self.moments.iter().flat_map(|moments| [moments.first.len(), moments.second.len()]);
        let shortest = lengths.min().unwrap_or_default();
        let needed = sources.iter().flatten().max().map_or(0, |&last| (last as usize + 1) * width);
        if needed > shortest {
            let list = format!("group `{}`", self.name);
            return Err(OptimiseError::Length { list, found: shortest, expected: needed });
        }
        let moved = |list: &[f32]| {
            let mut moved = vec![0.0; sources.len() * width];
            for (row, source) in moved.chunks_exact_mut(width.max(1)).zip(sources) {
                if let Some(source) = source {
                    row.copy_from_slice(&list[*source as usize * width..][..width]);
                }
            }
            moved
        };
        for Moments { first, second } in &mut self.moments {
            (*first, *second) = (moved(first), moved(second));
        }
        Ok(())
    }

    /// Forgets the past of all parameters, for values that were set from outside.
    pub fn forget(&mut self) {
        for Moments { first, second } in &mut self.moments {
            first.fill(0.0);
            second.fill(0.0);
        }
    }

    fn check(&self, share: &GroupUpdate<'_>) -> Result<(), OptimiseError> {
        let name = &self.name;
        check_length(&format!("lists of group `{name}`"), share.parameters.len(), self.moments.len())?;
        check_length(&format!("gradients of group `{name}`"), share.gradients.len(), self.moments.len())?;
        let lists = share.parameters.iter().zip(&share.gradients).zip(&self.moments).enumerate();
        for (index, ((parameters, gradient), moments)) in lists {
            let length = moments.first.len();
            check_length(&format!("list {index} of group `{name}`"), parameters.len(), length)?;
            check_length(&format!("gradient {index} of group `{name}`"), gradient.len(), length)?;
            check_length(&format!("second moments {index} of group `{name}`"), moments.second.len(), length)?;
            check(parameters, || format!("list {index} of group `{name}`"))?;
            check(gradient, || format!("gradient {index} of group `{name}`"))?;
        }
        Ok(())
    }

    fn step(&mut self, settings: &AdamSettings, iteration: u64, share: GroupUpdate<'_>) {
        self.steps += 1;
        let decays = [settings.first_decay, settings.second_decay];
        // Moments start at zero and are therefore too small at first.
        let [first_share, second_share] = decays.map(|decay| 1.0 - decay.powf(self.steps as f64));
        let rate = (self.rate.at(iteration) / first_share) as f32;
        let root_share = (1.0 / second_share.sqrt()) as f32;
        let [kept, kept_square] = decays.map(|decay| decay as f32);
        let [taken, taken_square] = decays.map(|decay| (1.0 - decay) as f32);
        let update = |rate: f32, parameter: &mut f32, gradient: f32, first: &mut f32, second: &mut f32| {
            let mean = kept * *first + taken * gradient;
            *first = if mean.abs() < FORGOTTEN { 0.0 } else { mean };
            let square = kept_square * *second + taken_square * gradient * gradient;
            *second = if square < FORGOTTEN_SQUARE { 0.0 } else { square };
            *parameter -= rate * *first / (second.sqrt() * root_share + settings.epsilon);
        };
        let row = self.pattern.len();
        // Whole rows, so that every chunk begins where the pattern does.
        let chunk = if row == 0 { CHUNK } else { CHUNK.next_multiple_of(row) };
        let lists = share.parameters.into_iter().zip(share.gradients).zip(&mut self.moments);
        for ((parameters, gradient), Moments { first, second }) in lists {
            let chunks = (parameters.par_chunks_mut(chunk), gradient.par_chunks(chunk)).into_par_iter();
            let chunks = chunks.zip(first.par_chunks_mut(chunk)).zip(second.par_chunks_mut(chunk));
            chunks.for_each(|(((parameters, gradient), first), second)| {
                let numbers = parameters.iter_mut().zip(gradient).zip(first).zip(second);
                if row == 0 {
                    for (((parameter, &gradient), first), second) in numbers {
                        update(rate, parameter, gradient, first, second);
                    }
                } else {
                    for ((((parameter, &gradient), first), second), &factor) in
                        numbers.zip(self.pattern.iter().cycle())
                    {
                        update(rate * factor, parameter, gradient, first, second);
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
        Adam {
            settings: AdamSettings::default(),
            groups: vec![Group::new("means", rate, &[4]).with_pattern(pattern)],
        }
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
        let before = group.clone();
        assert!(group.rearrange(2, &[Some(3)]).is_err());
        assert_eq!(group, before);
        let mut uneven = before.clone();
        uneven.moments[0].second.truncate(3);
        assert!(uneven.rearrange(2, &[Some(2)]).is_err());
        group.rearrange(2, &[Some(2), None, Some(0), Some(2)]).unwrap();
        assert_eq!(group.moments[0].first, [5., 6., 0., 0., 1., 2., 5., 6.]);
        assert_eq!(group.moments[0].second, [50., 60., 0., 0., 10., 20., 50., 60.]);
        group.forget();
        assert_eq!(group.moments[0], Moments { first: vec![0.0; 8], second: vec![0.0; 8] });
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

    #[test]
    fn settings_outside_their_ranges_are_named() {
        let refused = |settings: AdamSettings| {
            let mut adam = Adam { settings, ..adam(vec![]) };
            let mut parameters = [1.0; 4];
            let error = step(&mut adam, &mut parameters, &[1.0; 4]).unwrap_err().to_string();
            assert_eq!(parameters, [1.0; 4]);
            error
        };
        let settings = AdamSettings::default();
        for first_decay in [1.0, -0.1, f64::NAN] {
            assert!(refused(AdamSettings { first_decay, ..settings }).starts_with("first decay of Adam is"));
        }
        assert!(refused(AdamSettings { second_decay: 1.5, ..settings }).contains("below 1"));
        for epsilon in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(refused(AdamSettings { epsilon, ..settings }).starts_with("epsilon of Adam is"));
        }
    }
}
