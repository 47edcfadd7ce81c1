//! Tables and pictures of scores: who did how well, on what, and what the numbers can tell.
//!
//! Owns the ranking, the tables (CSV by polars, Markdown, terminal text), the figures (SVG and PNG by plotters) and
//! the page (HTML). Refuses to define a metric: every number comes from `l4d-score`, and masks are only carried to
//! where a person sees them.
//!
//! polars stays inside `table`, plotters inside `figures`; no type of either is public.

mod charts;
pub mod codes;
mod detail;
mod error;
mod figures;
mod gather;
mod latex;
mod layout;
mod markdown;
mod page;
mod protocols;
mod publish;
mod rank;
mod reliability;
mod reported;
mod row;
mod statistics;
mod table;
mod taken;
mod terminal;
mod tradeoff;
mod trend;

#[cfg(test)]
mod sample;

pub use charts::{Chart, Layout, Panel, publish_charts};
pub use detail::{Details, MOST_DETAILED, MethodChoice};
pub use error::BoardError;
pub use gather::{Gathered, gather};
pub use page::{Backdrop, Exhibit, LONGEST_SIDE_PX, publish_page};
pub use protocols::{ProtocolRow, ProtocolTable, gather_protocols};
pub use publish::publish;
pub use rank::{Board, OtherBoard, Ranked, Unranked};
pub use reliability::{Answered, Reliability, publish_reliability};
pub use row::{BoardRow, Heading, Metric};
pub use statistics::{COMPARED, Comparisons, MOST_METHODS, MethodGroups, Statistics};
pub use terminal::{text_statistics, text_table};
pub use tradeoff::{TradePoint, Tradeoff, front, publish_tradeoff};
pub use trend::{Trend, TrendPanel, TrendPoint, publish_trend};
