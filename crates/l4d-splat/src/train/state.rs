//! What training has come to: all that goes into a checkpoint and back.

use std::collections::BTreeMap;

use serde_json::json;

use crate::checkpoint::own::{Checkpoint, Training};
use crate::gaussians::FIELDS;
use crate::model::Model;
use crate::optimise::{Adam, Group, Moments};
use crate::tensor::Tensor;

use super::TrainError;
use super::densify::RowChange;
use super::settings::Rates;

/// Everything that changes from one iteration to the next.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    pub(super) model: Model,
    /// Those Gaussians that move once the field is on, one flag each.
    pub(super) moves: Vec<bool>,
    /// Of the Gaussians.
    pub(super) splats: Adam,
    /// Of the field; no groups before there is one.
    pub(super) field: Adam,
    pub(super) iteration: u64,
    pub(super) stats: DensityStats,
    /// PSNR on training pictures at each look, dB.
    pub(super) history: Vec<f32>,
    /// Whether there is nothing left to gain.
    pub(super) settled: bool,
}

/// What is known of the Gaussians since their number last changed.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct DensityStats {
    /// Sum of the lengths of gradients by projected centres.
    pub(super) gradient_norms: Vec<f32>,
    /// Pictures in which they were visible.
    pub(super) seen: Vec<f32>,
    pub(super) peak: Vec<f32>,
}

impl DensityStats {
    pub(super) fn new(count: usize) -> Self {
        Self { gradient_norms: vec![0.0; count], seen: vec![0.0; count], peak: vec![0.0; count] }
    }
}

/// Coefficients of direction learn this many times slower than the base colour.
const SH_REST: f32 = 1.0 / 20.0;

impl State {
    pub(super) fn new(model: Model, moves: Vec<bool>, rates: &Rates) -> Self {
        let count = model.gaussians.len();
        let widths = model.gaussians.sh_degree.widths();
        let groups = FIELDS.iter().zip(widths).zip(rates.gaussians).map(|((&name, width), rate)| {
            let group = Group::new(name, rate, &[count * width]);
            let pattern = || (0..width).map(|place| if place < 3 { 1.0 } else { SH_REST }).collect();
            if name == "sh" { group.with_pattern(pattern()) } else { group }
        });
        Self {
            splats: Adam { groups: groups.collect() },
            field: Adam::default(),
            moves,
            model,
            iteration: 0,
            stats: DensityStats::new(count),
            history: Vec::new(),
            settled: false,
        }
    }

    /// Groups for the field that the model has now.
    pub(super) fn add_field(&mut self, rates: &Rates) {
        let Some(field) = &mut self.model.field else { return };
        let lists = field.parameters_mut();
        let lengths = |lists: &[&mut [f32]]| lists.iter().map(|list| list.len()).collect::<Vec<_>>();
        let groups = vec![
            Group::new("planes", rates.planes, &lengths(&lists.planes)),
            Group::new("layers", rates.layers, &lengths(&lists.layers)),
        ];
        self.field.groups = groups;
    }

    /// Follows a change of the Gaussians' rows.
    pub(super) fn follow(&mut self, change: &RowChange) {
        let widths = self.model.gaussians.sh_degree.widths();
        let sources: Vec<Option<u32>> =
            change.sources.iter().map(|&(row, keeps)| keeps.then_some(row)).collect();
        for (group, width) in self.splats.groups.iter_mut().zip(widths) {
            group.rearrange(width, &sources);
        }
        self.moves = change.sources.iter().map(|&(row, _)| self.moves[row as usize]).collect();
        self.stats = DensityStats::new(self.moves.len());
        if self.model.field.is_some() {
            self.model.dynamic = self.dynamic();
        }
    }

    /// Follows Gaussians that were appended to the first `count`.
    pub(super) fn follow_more(&mut self, count: usize) {
        let sources =
            (0..self.moves.len() as u32).map(|row| (row.min(count as u32 - 1), (row as usize) < count));
        let moves = self.moves.clone();
        self.follow(&RowChange { sources: sources.collect() });
        self.moves = moves;
        self.model.dynamic = self.dynamic();
    }

    /// Rows that move, ascending.
    pub(super) fn dynamic(&self) -> Vec<u32> {
        (0..self.moves.len() as u32).filter(|&row| self.moves[row as usize]).collect()
    }

    /// All of it, beside what says where it comes from.
    pub(super) fn checkpoint(&self) -> Checkpoint {
        let mut tensors = BTreeMap::new();
        let mut keep = |name: String, data: &[f32]| {
            tensors.insert(name, Tensor { shape: vec![data.len()], data: data.to_vec() });
        };
        for (adam, owner) in [(&self.splats, "splats"), (&self.field, "field")] {
            for group in &adam.groups {
                for (index, moments) in group.moments.iter().enumerate() {
                    keep(format!("{owner}/{}/{index}/first", group.name), &moments.first);
                    keep(format!("{owner}/{}/{index}/second", group.name), &moments.second);
                }
            }
        }
        let flags: Vec<f32> = self.moves.iter().map(|&moves| f32::from(u8::from(moves))).collect();
        keep("moves".to_owned(), &flags);
        keep("blame".to_owned(), &self.stats.gradient_norms);
        keep("seen".to_owned(), &self.stats.seen);
        keep("peak".to_owned(), &self.stats.peak);
        keep("history".to_owned(), &self.history);
        let steps = |adam: &Adam| adam.groups.first().map_or(0, |group| group.steps);
        let values = json!({
            "splat_steps": steps(&self.splats),
            "field_steps": steps(&self.field),
            "settled": self.settled,
        });
        let values = values.as_object().cloned().unwrap_or_default();
        Checkpoint {
            iteration: self.iteration,
            training: Training { tensors, values },
            model: self.model.clone(),
            ..Checkpoint::default()
        }
    }

    /// The state that [`Self::checkpoint`] wrote.
    pub(super) fn restored(checkpoint: Checkpoint, rates: &Rates) -> Result<Self, TrainError> {
        let Checkpoint { model, iteration, training, .. } = checkpoint;
        let Training { mut tensors, values } = training;
        let mut state = Self::new(model, Vec::new(), rates);
        state.add_field(rates);
        let number = |name: &'static str| {
            values.get(name).and_then(serde_json::Value::as_u64).ok_or_else(|| missing(name))
        };
        let mut take = |name: String, length: Option<usize>| match tensors.remove(&name) {
            Some(tensor) if length.is_none_or(|length| length == tensor.data.len()) => Ok(tensor.data),
            _ => Err(missing(&name)),
        };
        for (adam, owner, steps) in [
            (&mut state.splats, "splats", number("splat_steps")?),
            (&mut state.field, "field", number("field_steps")?),
        ] {
            for group in &mut adam.groups {
                group.steps = steps;
                for (index, moments) in group.moments.iter_mut().enumerate() {
                    let length = Some(moments.first.len());
                    *moments = Moments {
                        first: take(format!("{owner}/{}/{index}/first", group.name), length)?,
                        second: take(format!("{owner}/{}/{index}/second", group.name), length)?,
                    };
                }
            }
        }
        let count = Some(state.model.gaussians.len());
        state.moves = take("moves".into(), count)?.iter().map(|&flag| flag != 0.0).collect();
        state.stats = DensityStats {
            gradient_norms: take("blame".into(), count)?,
            seen: take("seen".into(), count)?,
            peak: take("peak".into(), count)?,
        };
        state.history = take("history".into(), None)?;
        state.settled = values.get("settled").and_then(serde_json::Value::as_bool).unwrap_or_default();
        state.iteration = iteration;
        Ok(state)
    }
}

fn missing(name: &str) -> TrainError {
    TrainError::Invalid(format!("the state of training lacks `{name}`, or it has another size: train again"))
}
