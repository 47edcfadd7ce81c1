//! Running the network on a picture.

use std::sync::Arc;

use rten::{Model, NodeId, RunOptions, ThreadPool, ValueOrView};
use rten_tensor::NdTensor;
use rten_tensor::prelude::*;

use crate::pool::{Level, rows};
use crate::resize::resized;
use crate::segment::Pixels;
use crate::weights::{Description, WeightsError};

/// Width at which pictures are looked at, pixels.
const WIDTH: usize = 256;
/// Sides of what is looked at are a multiple of this, pixels.
const MULTIPLE: usize = 32;
/// Most rows of what is looked at, pixels.
const MOST_ROWS: usize = 512;

/// Display colour, R, G, B from 0 to 1 a pixel, row after row.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three values a pixel.
    pub colour: Vec<f32>,
}

/// A thing in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Logits by number of [`Description::kinds`].
    pub kinds: Vec<f32>,
    /// Logits by number of [`Description::values`]; those of one key compete.
    pub values: Vec<f32>,
}

/// What a picture shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Number of the thing at each pixel of the picture, from 1; 0 where there is none.
    pub labels: Vec<u32>,
    /// The things; the first is number 1. One that has no pixel is none in the labels either.
    pub found: Vec<Found>,
}

/// The network, ready to run. Runs on the calling thread: many pictures are looked at side by side, and every one is
/// seen the same on any number of threads.
pub struct Network {
    model: Model,
    description: Description,
    pool: Arc<ThreadPool>,
    picture: NodeId,
    pixels: NodeId,
    parts: NodeId,
    levels: Vec<NodeId>,
    objects: NodeId,
    kinds: NodeId,
    values: NodeId,
}

impl Network {
    /// The weights that l4d ships.
    ///
    /// # Errors
    /// None that a tested build can have.
    pub fn shipped() -> Result<Self, WeightsError> {
        let weights = include_bytes!("../weights/perception.onnx");
        Self::load(weights.to_vec(), include_str!("../weights/perception.json"))
    }

    /// Loads weights that belong to a description.
    ///
    /// # Errors
    /// Damaged weights, those of another version, or with parts that are missing.
    pub fn load(weights: Vec<u8>, description: &str) -> Result<Self, WeightsError> {
        let description = Description::of(description, &weights)?;
        let model = Model::load(weights).map_err(|error| WeightsError::Model(error.to_string()))?;
        let node = |name: &str| {
            model.find_node(name).ok_or_else(|| WeightsError::Model(format!("there is no `{name}` in them")))
        };
        let levels = (0..=description.widths.len()).map(|level| node(&format!("level{level}")));
        Ok(Self {
            pool: Arc::new(ThreadPool::with_num_threads(1)),
            picture: node("picture")?,
            pixels: node("pixels")?,
            parts: node("parts")?,
            levels: levels.collect::<Result<_, _>>()?,
            objects: node("objects")?,
            kinds: node("kinds")?,
            values: node("values")?,
            description,
            model,
        })
    }

    /// What the network knows.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Looks at a picture of any size.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn look(&self, picture: &Picture) -> Result<Seen, WeightsError> {
        if picture.width == 0 || picture.height == 0 {
            return Ok(Seen { labels: Vec::new(), found: Vec::new() });
        }
        let size = looked_at(picture);
        let mut colour = resized(&picture.colour, [picture.width, picture.height], size, 3);
        colour
            .iter_mut()
            .for_each(|value| *value = if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 });
        let outputs = self.features(&colour, size)?;
        let half = [size[0] / 2, size[1] / 2];
        let pixels = Pixels { width: half[0], height: half[1], planes: &outputs[0].values };
        let centres = pixels.centres(&self.description);
        let labels = pixels.labels(&centres, self.description.offset_px, [picture.width, picture.height]);
        let small = pixels.labels(&centres, self.description.offset_px, half);
        let found = self.describe(&rows_of(&outputs, &small, centres.len(), &colour, size))?;
        Ok(Seen { labels, found })
    }

    /// Says what things are of which the pixels are known: `labels` has the number of the thing at each pixel, from 1 to
    /// `count`.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn describe_things(
        &self,
        picture: &Picture,
        labels: &[u32],
        count: usize,
    ) -> Result<Vec<Found>, WeightsError> {
        let size = looked_at(picture);
        let colour = resized(&picture.colour, [picture.width, picture.height], size, 3);
        let outputs = self.features(&colour, size)?;
        let half = [size[0] / 2, size[1] / 2];
        let nearest = |at: usize| {
            let (row, column) =
                (at / half[0] * picture.height / half[1], at % half[0] * picture.width / half[0]);
            labels.get(row * picture.width + column).copied().unwrap_or(0)
        };
        let small: Vec<u32> = (0..half[0] * half[1]).map(nearest).collect();
        self.describe(&rows_of(&outputs, &small, count, &colour, size))
    }

    /// Kinds and values of objects by their rows.
    pub(crate) fn describe(&self, rows: &[Vec<f32>]) -> Result<Vec<Found>, WeightsError> {
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let objects = NdTensor::from_data([rows.len(), self.description.object], rows.concat());
        let inputs = vec![(self.objects, objects.view().into())];
        let [kinds, values] = self.run(inputs, [self.kinds, self.values])?;
        let (k, v) = (self.description.kinds.len(), self.description.values.len());
        if kinds.values.len() != rows.len() * k || values.values.len() != rows.len() * v {
            return Err(WeightsError::Model("the words do not fit the heads".to_owned()));
        }
        let found = (0..rows.len()).map(|row| Found {
            kinds: kinds.values[row * k..][..k].to_vec(),
            values: values.values[row * v..][..v].to_vec(),
        });
        Ok(found.collect())
    }

    /// Pixels, parts, then the levels.
    pub(crate) fn features(
        &self,
        colour: &[f32],
        [width, height]: [usize; 2],
    ) -> Result<Vec<Planes>, WeightsError> {
        let planar: Vec<f32> =
            (0..3).flat_map(|channel| colour.chunks_exact(3).map(move |pixel| pixel[channel])).collect();
        let picture = NdTensor::from_data([1, 3, height, width], planar);
        let nodes: Vec<NodeId> =
            [self.pixels, self.parts].into_iter().chain(self.levels.iter().copied()).collect();
        self.run_all(vec![(self.picture, picture.view().into())], &nodes)
    }

    fn run<const N: usize>(
        &self,
        inputs: Vec<(NodeId, ValueOrView<'_>)>,
        nodes: [NodeId; N],
    ) -> Result<[Planes; N], WeightsError> {
        let outputs = self.run_all(inputs, &nodes)?;
        outputs
            .try_into()
            .map_err(|_outputs| WeightsError::Model("it gave another number of outputs".to_owned()))
    }

    fn run_all(
        &self,
        inputs: Vec<(NodeId, ValueOrView<'_>)>,
        nodes: &[NodeId],
    ) -> Result<Vec<Planes>, WeightsError> {
        let options = RunOptions::default().with_thread_pool(Some(Arc::clone(&self.pool)));
        let outputs = self
            .model
            .run(inputs, nodes, Some(options))
            .map_err(|error| WeightsError::Model(error.to_string()))?;
        let planes = |value: rten::Value| {
            let tensor: rten_tensor::Tensor<f32> = value
                .try_into()
                .map_err(|_value| WeightsError::Model("an output is not of numbers".to_owned()))?;
            Ok(Planes { shape: tensor.shape().to_vec(), values: tensor.to_vec() })
        };
        outputs.into_iter().map(planes).collect()
    }
}

/// Rows for objects by what [`Network::features`] gave of a picture of this size and colour; labels are of half of it.
pub(crate) fn rows_of(
    outputs: &[Planes],
    labels: &[u32],
    count: usize,
    colour: &[f32],
    size: [usize; 2],
) -> Vec<Vec<f32>> {
    let levels: Vec<Level<'_>> = outputs[2..].iter().map(Planes::level).collect();
    rows(labels, [size[0] / 2, size[1] / 2], count, &halved(colour, size), &outputs[1].level(), &levels)
}

/// An output of the network.
pub(crate) struct Planes {
    shape: Vec<usize>,
    pub(crate) values: Vec<f32>,
}

impl Planes {
    pub(crate) fn level(&self) -> Level<'_> {
        let at = |axis: usize| self.shape.get(axis).copied().unwrap_or(0);
        Level { channels: at(1), width: at(3), height: at(2), values: &self.values }
    }
}

/// The size at which a picture is looked at.
fn looked_at(picture: &Picture) -> [usize; 2] {
    let rows = WIDTH as f64 * picture.height as f64 / picture.width as f64;
    let multiple = (rows / MULTIPLE as f64).round().max(1.0) as usize * MULTIPLE;
    [WIDTH, multiple.min(MOST_ROWS)]
}

/// Means of four pixels each.
pub(crate) fn halved(colour: &[f32], [width, height]: [usize; 2]) -> Vec<f32> {
    let mut small = Vec::with_capacity(colour.len() / 4);
    for row in (0..height).step_by(2) {
        for column in (0..width).step_by(2) {
            for channel in 0..3 {
                let at = |row: usize, column: usize| colour[(row * width + column) * 3 + channel];
                let sum =
                    at(row, column) + at(row, column + 1) + at(row + 1, column) + at(row + 1, column + 1);
                small.push(sum / 4.0);
            }
        }
    }
    small
}
