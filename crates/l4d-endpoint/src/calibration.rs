//! Which convention of coordinates a model follows, found by asking about pictures whose answer is known, and the
//! file that remembers it. The caller draws the pictures.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::{DataError, json};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::client::Client;
use crate::config::Endpoint;
use crate::coordinates::{BoxPx, Convention, WrittenBox, written_boxes};
use crate::error::{EndpointError, excerpt};
use crate::request::{Image, Message, Part, Request};

/// Below this mean overlap a convention does not fit.
const LEAST_IOU: f64 = 0.5;
/// A runner-up that comes closer than this makes the winner uncertain.
const CLEAR_LEAD: f64 = 0.05;

/// A picture with squares of known places, one of each colour.
#[derive(Debug, Clone)]
pub struct Sample {
    pub image: Image,
    /// Colour and place of its squares.
    pub squares: Vec<(String, BoxPx)>,
}

/// How well a convention explains a model's answers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Name of the convention.
    pub convention: String,
    /// Field name with which the model was asked.
    pub key: String,
    /// Overlap of what the model wrote with the squares, mean over all of them; a square not named counts as 0.
    pub mean_iou: f64,
}

/// What a calibration found.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// All conventions with the field name that suited them best, the best first.
    pub scores: Vec<Score>,
    /// Answers that held no boxes at all, and why.
    pub failures: Vec<String>,
    /// Squares that were asked for, over all pictures.
    pub squares: usize,
}

impl Calibration {
    /// The convention that fits and that no other fits about as well.
    pub fn winner(&self) -> Option<&Score> {
        self.fit().filter(|_| self.rival().is_none())
    }

    /// The convention that fits best, if it fits at all.
    pub fn fit(&self) -> Option<&Score> {
        self.scores.first().filter(|best| best.mean_iou >= LEAST_IOU)
    }

    /// A convention that fits about as well as the best, so that either may be right.
    pub fn rival(&self) -> Option<&Score> {
        let fit = self.fit()?;
        self.scores.get(1).filter(|second| second.mean_iou > fit.mean_iou - CLEAR_LEAD)
    }
}

/// Asks a model for the squares of each sample, once with each field name that a convention knows.
///
/// # Errors
/// If the server gives no answer; an answer without boxes is a finding, not an error.
pub fn calibrate(client: &Client, samples: &[Sample], max_tokens: u32) -> Result<Calibration, EndpointError> {
    let mut keys: Vec<&str> = Convention::all().iter().map(|convention| convention.key.as_str()).collect();
    keys.sort_unstable();
    keys.dedup();
    let squares = samples.iter().map(|sample| sample.squares.len()).sum::<usize>();
    let mut failures = Vec::new();
    let mut best: BTreeMap<&str, Score> = BTreeMap::new();
    for key in keys {
        let mut written = Vec::new();
        for sample in samples {
            let reply = client.ask(&question(key, sample, max_tokens))?;
            match reply.json::<Value>() {
                Ok(document) => written.push((sample, written_boxes(&document))),
                Err(error) => failures.push(format!("asked for `{key}`: {error}")),
            }
        }
        for convention in Convention::all() {
            let overlap: f64 = written.iter().map(|(sample, boxes)| overlap(convention, sample, boxes)).sum();
            // An empty sum of floats is -0.
            let overlap = overlap.max(0.0);
            let score = Score {
                convention: convention.name.clone(),
                key: key.to_owned(),
                mean_iou: overlap / squares.max(1) as f64,
            };
            let best = best.entry(&convention.name).or_insert_with(|| score.clone());
            // At a tie the field name of the convention itself is the better one.
            let rank = |score: &Score| (score.mean_iou, score.key == convention.key);
            if rank(&score) > rank(best) {
                *best = score;
            }
        }
    }
    // In the order of the table first, so that ties fall the same way each time.
    let mut scores: Vec<Score> =
        Convention::all().iter().filter_map(|convention| best.remove(convention.name.as_str())).collect();
    scores.sort_by(|a, b| b.mean_iou.total_cmp(&a.mean_iou));
    Ok(Calibration { scores, failures, squares })
}

/// The question says nothing about order or scale: the model shall answer as it was trained to.
fn question(key: &str, sample: &Sample, max_tokens: u32) -> Request {
    let colours: Vec<&str> = sample.squares.iter().map(|(colour, _)| colour.as_str()).collect();
    let text = format!(
        "The picture shows {} squares on a grey ground: {}. Report the bounding box of each as a JSON list, one object \
         a square with the fields \"{key}\" (four numbers) and \"label\" (its colour, one word). Answer with the JSON \
         alone.",
        colours.len(),
        colours.join(", "),
    );
    let parts = vec![Part::Image(sample.image.clone()), Part::Text(text)];
    Request::new(vec![Message::user(parts)]).with_max_tokens(max_tokens)
}

fn overlap(convention: &Convention, sample: &Sample, boxes: &[WrittenBox]) -> f64 {
    let of_square = |(colour, place): &(String, BoxPx)| {
        let is_it = |found: &&WrittenBox| {
            found.label.as_ref().is_some_and(|label| label.to_lowercase().contains(colour.as_str()))
        };
        let found = boxes.iter().find(is_it)?;
        Some(convention.pixels(found.numbers, sample.image.size())?.iou(place))
    };
    sample.squares.iter().filter_map(of_square).sum()
}

/// What is remembered of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Remembered {
    base_url: String,
    model: String,
    #[serde(flatten)]
    winner: Score,
    /// Width and height of the pictures that were shown, pixels: others of this size are to be sent.
    size: (u32, u32),
}

/// The file of all calibrations: endpoint id -> what is remembered.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Calibrations(BTreeMap<String, Remembered>);

impl Calibrations {
    /// Reads the file; a missing one is empty.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        if path.exists() { json::read(path) } else { Ok(Self::default()) }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), DataError> {
        json::write(path, self)
    }

    /// Remembers a winner, or forgets the last one if none fits any more.
    pub fn note(&mut self, endpoint: &Endpoint, winner: Option<&Score>, size: (u32, u32)) {
        self.0.remove(&endpoint.id());
        if let Some(winner) = winner.cloned() {
            let (base_url, model) = (endpoint.base_url.to_string(), endpoint.model.clone());
            self.0.insert(endpoint.id(), Remembered { base_url, model, winner, size });
        }
    }
}

impl Endpoint {
    /// The convention of its model: as configured, else as calibrated.
    ///
    /// # Errors
    /// If neither is known.
    pub fn convention(&self, calibrations: &Calibrations) -> Result<&'static Convention, EndpointError> {
        let remembered = || Some(calibrations.0.get(&self.id())?.winner.convention.as_str());
        match self.coordinates.as_deref().or_else(remembered) {
            Some(name) => Convention::named(name),
            None => Err(EndpointError::not_asked(
                "coordinates",
                format!("it is not known how `{}` writes boxes", excerpt(&self.model)),
                "run `l4d endpoint calibrate`, or set `coordinates` in the endpoint file",
            )),
        }
    }
}
