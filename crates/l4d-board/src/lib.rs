//! Tables and pictures of scores: who did how well, on what, and what the numbers can tell.
//!
//! Owns the ranking, the tables (CSV by polars, Markdown, terminal text) and the figures (SVG and PNG by plotters).
//! Refuses to define a metric: every number comes from `l4d-score`, and nothing here looks at a mask.
//!
//! polars stays inside `table`, plotters inside `figures`; no type of either is public.

mod charts;
pub mod codes;
mod error;
mod figures;
mod gather;
mod latex;
mod layout;
mod markdown;
mod publish;
mod rank;
mod reported;
mod row;
mod statistics;
mod table;
mod terminal;
mod tradeoff;

#[cfg(test)]
mod sample;

pub use charts::{Chart, Layout, Panel, publish_charts};
pub use error::BoardError;
pub use gather::{Gathered, gather};
pub use publish::publish;
pub use rank::{Board, OtherBoard, Ranked, Unranked};
pub use row::{BoardRow, Heading, Metric};
pub use statistics::{COMPARED, Comparisons, MOST_METHODS, MethodGroups, Statistics};
pub use terminal::{text_statistics, text_table};
pub use tradeoff::{TradePoint, Tradeoff, front, publish_tradeoff};
