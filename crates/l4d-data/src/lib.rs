//! The vocabulary of l4d: names, shapes, units and places of everything on disk.
//!
//! Every stage of the pipeline is a function from directories to a directory; this crate owns the types that
//! those directories hold and refuses to know how any of them is made, drawn, judged or shown. It decodes no
//! image and evaluates no predicate.
//!
//! Conventions (units, axes, pixel centres, frame numbers): see `docs/formats.md`.

pub mod benchmark;
pub mod camera;
pub mod capture;
pub mod composition;
pub mod digest;
pub mod error;
pub mod finding;
pub mod html;
pub mod json;
pub mod layout;
pub mod name;
pub mod parallel;
pub mod published;
pub mod query;
pub mod reader;
pub mod results;
pub mod rig;
pub mod rle;
pub mod scene;
pub mod stage;
pub mod status;
pub mod store;
pub mod sums;
pub mod timeline;
pub mod toml_file;
pub mod tracks;
pub mod truth;
mod words;
pub mod workspace;

pub use benchmark::{Benchmark, Draw};
pub use camera::{Camera, Split};
pub use error::DataError;
pub use finding::{Finding, Report, Severity};
pub use name::Name;
pub use query::{Category, Query, QueryId, QuerySet, Status, Temporal};
pub use rig::Rig;
pub use rle::Rle;
pub use scene::{Event, Role, Scale, Scene};
pub use stage::{At, Progress, Shard, Silent, StageError};
pub use timeline::{Interval, Profile, Timeline};
pub use words::counted;
pub use workspace::Workspace;
