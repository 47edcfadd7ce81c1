//! Scenes that others recorded: their cameras and pictures. They have neither depth nor ids.

use std::path::PathBuf;

use l4d_data::capture::Capture as Recorded;
use l4d_data::layout::CaptureDir;
use l4d_data::store::read_bounded;
use l4d_data::{DataError, Split};
use l4d_frames::drawn::decode_colour;
use l4d_masks::Mask;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Array, array, shape_of};
use crate::camera::Camera;
use crate::error::{Failure, Result};

/// No picture is larger, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A capture: a folder with `capture.json` and `frames/` that `l4d import-scene` made.
///
/// Its frames have numbers of their own; `is_metric` says whether a unit of its world is a metre.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Capture {
    /// Scene name.
    #[pyo3(get)]
    name: String,
    /// Who recorded it.
    #[pyo3(get)]
    source: String,
    /// Columns of its pictures, pixels.
    #[pyo3(get)]
    width: u32,
    /// Rows of its pictures, pixels.
    #[pyo3(get)]
    height: u32,
    /// Numbers of its moments, ascending.
    #[pyo3(get)]
    frames: Vec<u32>,
    /// Moments a second, or None if unknown.
    #[pyo3(get)]
    frames_per_second: Option<f64>,
    /// Whether a unit of its world is a metre.
    #[pyo3(get)]
    is_metric: bool,
    /// What was assumed or left out when it was imported, a sentence each.
    #[pyo3(get)]
    notes: Vec<String>,
    dir: CaptureDir,
    capture: Recorded,
}

#[pymethods]
impl Capture {
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        let capture = Recorded::read(&path)?;
        if !Mask::is_sane_size(capture.width, capture.height) {
            let message = format!("{}x{} is no size of a picture", capture.width, capture.height);
            let path = path.join(l4d_data::capture::CAPTURE);
            let place = "fields `width`, `height`";
            return Err(DataError::invalid(&path, place, message, "import the scene again").into());
        }
        Ok(Self {
            name: capture.name.to_string(),
            source: capture.source.clone(),
            width: capture.width,
            height: capture.height,
            frames: capture.frames.clone(),
            frames_per_second: capture.frames_per_second,
            is_metric: capture.is_metric,
            notes: capture.notes.clone(),
            dir: CaptureDir::new(&path, ""),
            capture,
        })
    }

    /// All views, sorted by name.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        Camera::all(&self.capture.cameras, self.size())
    }

    /// The views that a method may train on.
    #[getter]
    fn training_cameras(&self) -> Vec<Camera> {
        Camera::of_split(&self.capture.cameras, Split::Train, self.size())
    }

    /// The view of that name.
    fn camera(&self, name: &str) -> Result<Camera> {
        Camera::find(&self.capture.cameras, name, self.size())
    }

    /// Whether a view saw a moment: some pictures are missing on purpose.
    fn saw(&self, view: &str, frame: u32) -> bool {
        self.camera(view).is_ok() && self.frames.contains(&frame) && self.capture.saw(view, frame)
    }

    /// What a view saw at a moment: uint8 (H, W, 3), display colour.
    fn picture<'py>(&self, py: Python<'py>, view: &str, frame: u32) -> Result<Array<'py, u8, 3>> {
        self.check(view, &[frame])?;
        let bytes = py.detach(|| self.read(view, frame))?;
        let [rows, columns] = shape_of(self.size());
        array(py, bytes, [rows, columns, 3])
    }

    /// What a view saw at some moments (all that it saw by default): uint8 (T, H, W, 3), display colour.
    #[pyo3(signature = (view, frames = None))]
    fn clip<'py>(&self, py: Python<'py>, view: &str, frames: Option<Vec<u32>>) -> Result<Array<'py, u8, 4>> {
        let all = || self.frames.iter().copied().filter(|&frame| self.capture.saw(view, frame));
        let frames = frames.unwrap_or_else(|| all().collect());
        self.check(view, &frames)?;
        let pictures = py.detach(|| {
            let read = frames.par_iter().map(|&frame| self.read(view, frame));
            read.collect::<Result<Vec<Vec<u8>>>>()
        })?;
        let [rows, columns] = shape_of(self.size());
        array(py, pictures.concat(), [frames.len(), rows, columns, 3])
    }

    fn __repr__(&self) -> String {
        let Recorded { name, cameras, frames, width, height, .. } = &self.capture;
        format!("Capture('{name}', {} views, {} frames, {width}x{height})", cameras.len(), frames.len())
    }
}

impl Capture {
    fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    fn check(&self, view: &str, frames: &[u32]) -> Result<()> {
        self.camera(view)?;
        match frames.iter().find(|frame| !self.saw(view, **frame)) {
            None => Ok(()),
            Some(frame) => {
                let message = format!("{view} has no picture of moment {frame}");
                Err(Failure::argument("frame", message, "give one of `Capture.frames` that the view saw"))
            }
        }
    }

    fn read(&self, view: &str, frame: u32) -> Result<Vec<u8>> {
        let path = self.dir.picture(view, frame);
        let picture = decode_colour(&read_bounded(&path, MAX_BYTES)?, self.width, self.height);
        let damaged = |error: l4d_frames::photo::PhotoError| {
            DataError::invalid(&path, "picture", error.to_string(), "import the scene again")
        };
        Ok(picture.map_err(damaged)?.into_raw())
    }
}
