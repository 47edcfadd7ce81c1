//! Tables and pictures of scores: which method did how well, on what, and what the numbers can tell.
//!
//! [`gather`] reads every score once and makes a [`Board`], the published document `board.json`. Tables (CSV, Markdown,
//! LaTeX, terminal text), figures (SVG and PNG) and the page (HTML) are pure functions of it. No metric is defined here:
//! every number comes from `l4d-score`.
//!
//! polars stays inside `tables`, plotters inside `figures`; no type of either is public.

pub mod board;
mod charts;
pub mod codes;
mod day;
mod error;
mod figures;
mod gather;
mod latex;
mod layout;
mod markdown;
mod page;
mod protocols;
mod publish;
mod ranking;
mod tables;
mod terminal;

#[cfg(test)]
mod sample;

pub use board::Board;
pub use charts::{
    Chart, Layout, Panel, TradePoint, Tradeoff, Trend, TrendPanel, TrendPoint, draw_charts, publish_tradeoff,
    publish_trend,
};
pub use error::BoardError;
pub use gather::gather;
pub use page::{Backdrop, LONGEST_SIDE_PX, Media};
pub use protocols::{ProtocolRow, ProtocolTable};
pub use publish::{Answers, publish};
pub use terminal::{text_statistics, text_table};
