//! Figures of tables, where the feature `board` is built in.

#[cfg(feature = "board")]
mod stats;
#[cfg(feature = "board")]
mod tradeoffs;
#[cfg(feature = "board")]
mod views;

#[cfg(feature = "board")]
pub(crate) use self::{
    stats::draw_stats,
    tradeoffs::{publish_lift, publish_splats},
    views::publish_views,
};
#[cfg(not(feature = "board"))]
pub(crate) use left_out::*;

#[cfg(not(feature = "board"))]
mod left_out {
    use std::path::{Path, PathBuf};

    use anyhow::Result;
    use l4d_experiments::lift::Benched;
    use l4d_query::stats::SetStats;

    use crate::out::Printer;

    pub(crate) fn publish_lift(_: &Benched, _: &str, folder: &Path, out: &Printer) -> Result<Vec<PathBuf>> {
        publish_nothing(&(), folder, out)
    }

    pub(crate) fn draw_stats(stats: &SetStats, out: &Printer) -> Result<Vec<(String, Vec<u8>)>> {
        publish_nothing(stats, Path::new(""), out).map(|_| Vec::new())
    }

    pub(crate) fn publish_nothing<T>(_: &T, _: &Path, out: &Printer) -> Result<Vec<PathBuf>> {
        out.note("no figures: this l4d was built without the feature `board` (cargo build --features board)");
        Ok(Vec::new())
    }

    pub(crate) use publish_nothing as publish_splats;
    pub(crate) use publish_nothing as publish_views;
}
