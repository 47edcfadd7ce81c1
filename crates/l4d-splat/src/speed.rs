//! What makes drawing a model faster, and what that costs (`l4d bench splats`).
//!
//! Everything is measured on the same pictures in one run: times as medians, errors against the unreduced model drawn
//! in f64, and against pictures of the held-out view where there are some.

mod measure;
mod subject;
mod table;
mod variants;

use std::error::Error;
use std::path::{Path, PathBuf};

use l4d_data::store::write_atomic;
use l4d_data::{Name, Progress, StageError, Workspace};

pub use self::measure::CLIP_VIEWS;
use self::measure::{Truth, measure};
use self::subject::Subject;
use self::table::csv_of;
pub use self::table::{INVISIBLE_DB, Row, text};
pub use self::variants::{Backend, Sweep};
use self::variants::{backends, variants};

type Result<T, E = StageError> = std::result::Result<T, E>;

fn plain(error: impl Error) -> StageError {
    StageError::of(&error, None)
}

/// What is drawn, and by what.
pub struct Order<'a> {
    /// A trained scene; none for a made-up room.
    pub scene: Option<&'a Name>,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// The model, if not the one among the work.
    pub model: Option<PathBuf>,
    /// Gaussians of the made-up room.
    pub gaussians: usize,
    /// Of the made-up room.
    pub seed: u64,
    /// Width and height of its pictures; none for the usual ones.
    pub size: Option<[u32; 2]>,
    /// What is changed; empty for everything.
    pub sweeps: &'a [Sweep],
    /// Views, the held-out one among them.
    pub views: usize,
    /// Times, evenly spaced.
    pub times: usize,
    /// Timed passes over all pictures.
    pub repeats: u32,
    /// Receives `splats.csv`.
    pub folder: &'a Path,
}

/// What was measured.
#[derive(Debug)]
pub struct Speed {
    /// One line about what was drawn.
    pub about: String,
    /// One row per way of drawing, the model as it is first.
    pub rows: Vec<Row>,
    /// Whether there are pictures of a held-out view.
    pub has_held_out: bool,
}

/// Measures ways of drawing a model, on the processor and on these adapters.
///
/// # Errors
/// A scene or model that cannot be read or drawn.
pub fn measure_speed(order: &Order<'_>, adapters: Vec<Backend>, progress: &dyn Progress) -> Result<Speed> {
    let backends = backends(adapters)?;
    let subject = Subject::open(order)?;
    let variants = variants(&subject, order.sweeps, &backends)?;
    progress.note(&format_args!("{}: {} variants", subject.about, variants.len()));
    let truth = Truth::draw(&subject)?;
    progress.start("measuring", variants.len() as u64 * (u64::from(order.repeats) + 1));
    let advance = || progress.advance(1);
    let measured = measure(&subject, &truth, &variants, order.repeats, &advance)?;
    progress.finish();
    let rows: Vec<Row> =
        variants.iter().zip(&measured).map(|(variant, measured)| Row::new(variant, measured)).collect();
    write_atomic(&order.folder.join("splats.csv"), &csv_of(&rows)?)?;
    Ok(Speed { about: subject.about, rows, has_held_out: subject.seen.is_some() })
}
