//! The judge: how well the masks of a method fit the truth of the benchmark.
//!
//! Counts come first: for every query and frame a [`counts::FrameCount`], written to `counts.csv`. Every number of
//! a table is derived from those rows by [`metrics`] and [`averages`], so that anyone can do it again. Definitions and worked
//! examples are in `docs/scoring.md`, which is also a test.
//!
//! Uncertainty comes last, from the same rows: [`Estimate::of_ratio`] is a mean with its standard error and interval,
//! [`Comparison::of`] holds two methods against each other, [`all_pairs`] all methods of a table. All of them take
//! [`metrics::QueryTally`]s, which [`score::tallies_of_counts`] reads from `counts.csv`, and a seed.
//!
//! The judge sees the truth, the queries and the masks of a method, nothing else: it links no solver, no
//! importer, no query language and no decoder of renders, and it refuses to rank (that is `l4d-board`).

pub mod averages;
pub mod baseline;
pub mod cluster;
pub mod codes;
pub mod compare;
pub mod counts;
pub mod eval_set;
mod folder;
pub mod groups;
pub mod judge;
pub mod labels;
pub mod metrics;
pub mod protocols;
pub mod reading;
pub mod results;
pub mod score;
pub mod summary;
pub mod table;
pub mod traits;
pub mod truth;

pub use averages::{Average, Breakdown};
pub use baseline::Baseline;
pub use cluster::Estimate;
pub use compare::{Comparison, Pair, all_pairs, holm};
pub use counts::{FrameCount, State};
pub use eval_set::EvalSet;
pub use groups::{Estimates, Group, GroupKind, groups};
pub use l4d_data::QuerySet;
pub use metrics::{Metric, Metrics, Missing, Options, PerMetric};
pub use protocols::Protocol;
pub use score::{Scored, check_results, score_results};
pub use summary::Summary;
