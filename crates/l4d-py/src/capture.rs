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

use crate::arrays::{Array3, Array4, array3, array4, shape_of};
use crate::camera::Camera;
use crate::error::{Failure, Result, unknown};

/// No picture is larger, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A capture: a folder with `capture.json` and `frames/` that `l4d import-scene` made.
///
/// Its frames have numbers of their own; `is_metric` says whether a unit of its world is a metre.
#[pyclass(frozen, module = "l4d")]
#[derive(Debug)]
pub(crate) struct Capture {
    dir: CaptureDir,
    capture: Recorded,
}

#[pymethods]
impl Capture {
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        let capture = Recorded::read(&path)?;
        let refuse = |place: String, message: String| {
            let path = path.join(l4d_data::capture::CAPTURE);
            Err(DataError::invalid(&path, place, message, "import the scene again").into())
        };
        if !Mask::is_sane_size(capture.width, capture.height) {
            let message = format!("{}x{} is no size of a picture", capture.width, capture.height);
            return refuse("fields `width`, `height`".to_owned(), message);
        }
        if let Some((name, problem)) =
            capture.cameras.iter().find_map(|camera| Some((&camera.name, camera.problem()?)))
        {
            return refuse(format!("camera {name}"), problem);
        }
        Ok(Self { dir: CaptureDir::new(&path, ""), capture })
    }

    /// Scene name.
    #[getter]
    fn name(&self) -> &str {
        &self.capture.name
    }

    /// Who recorded it.
    #[getter]
    fn source(&self) -> &str {
        &self.capture.source
    }

    /// Columns of its pictures, pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.capture.width
    }

    /// Rows of its pictures, pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.capture.height
    }

    /// Numbers of its moments, ascending.
    #[getter]
    fn frames(&self) -> Vec<u32> {
        self.capture.frames.clone()
    }

    /// Moments a second, or None if unknown.
    #[getter]
    fn frames_per_second(&self) -> Option<f64> {
        self.capture.frames_per_second
    }

    /// Whether a unit of its world is a metre.
    #[getter]
    fn is_metric(&self) -> bool {
        self.capture.is_metric
    }

    /// What was assumed or left out when it was imported, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.capture.notes.clone()
    }

    /// All views, sorted by name.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        self.capture.cameras.iter().map(|camera| Camera::new(camera, self.size())).collect()
    }

    /// The views that a method may train on.
    #[getter]
    fn training_cameras(&self) -> Vec<Camera> {
        let training = self.capture.cameras.iter().filter(|camera| camera.split == Split::Train);
        training.map(|camera| Camera::new(camera, self.size())).collect()
    }

    /// The view of that name.
    fn camera(&self, name: &str) -> Result<Camera> {
        let found = self.capture.cameras.iter().find(|camera| camera.name.as_str() == name);
        found
            .map(|camera| Camera::new(camera, self.size()))
            .ok_or_else(|| unknown("view", name, &self.views()))
    }

    /// Whether a view saw a moment: some pictures are missing on purpose.
    fn saw(&self, view: &str, frame: u32) -> bool {
        self.views().contains(&view) && self.capture.frames.contains(&frame) && self.capture.saw(view, frame)
    }

    /// What a view saw at a moment: uint8 (H, W, 3), display colour.
    fn picture<'py>(&self, py: Python<'py>, view: &str, frame: u32) -> Result<Array3<'py, u8>> {
        self.check(view, &[frame])?;
        let bytes = py.detach(|| self.read(view, frame))?;
        let [rows, columns] = shape_of(self.capture.width, self.capture.height);
        array3(py, bytes, [rows, columns, 3])
    }

    /// What a view saw at some moments (all that it saw by default): uint8 (T, H, W, 3), display colour.
    #[pyo3(signature = (view, frames = None))]
    fn clip<'py>(&self, py: Python<'py>, view: &str, frames: Option<Vec<u32>>) -> Result<Array4<'py, u8>> {
        let all = || self.capture.frames.iter().copied().filter(|&frame| self.capture.saw(view, frame));
        let frames = frames.unwrap_or_else(|| all().collect());
        self.check(view, &frames)?;
        let pictures = py.detach(|| {
            let read = frames.par_iter().map(|&frame| self.read(view, frame));
            read.collect::<Result<Vec<Vec<u8>>>>()
        })?;
        let [rows, columns] = shape_of(self.capture.width, self.capture.height);
        array4(py, pictures.concat(), [frames.len(), rows, columns, 3])
    }

    fn __repr__(&self) -> String {
        let Recorded { name, cameras, frames, width, height, .. } = &self.capture;
        format!("Capture('{name}', {} views, {} frames, {width}x{height})", cameras.len(), frames.len())
    }
}

impl Capture {
    fn size(&self) -> [u32; 2] {
        [self.capture.width, self.capture.height]
    }

    fn views(&self) -> Vec<&str> {
        self.capture.cameras.iter().map(|camera| camera.name.as_str()).collect()
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
        let picture =
            decode_colour(&read_bounded(&path, MAX_BYTES)?, self.capture.width, self.capture.height);
        let damaged = |error: l4d_frames::photo::PhotoError| {
            DataError::invalid(&path, "picture", error.to_string(), "import the scene again")
        };
        Ok(picture.map_err(damaged)?.into_raw())
    }
}
