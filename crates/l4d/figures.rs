//! Figures of tables, where the feature `board` is built in.

#[cfg(feature = "board")]
mod stats;
#[cfg(feature = "board")]
mod tradeoffs;
#[cfg(feature = "board")]
mod views;

#[cfg(feature = "board")]
pub(crate) use self::{
    stats::publish_stats,
    tradeoffs::{publish_lift, publish_splats},
    views::publish_views,
};
#[cfg(not(feature = "board"))]
pub(crate) use left_out::*;

#[cfg(not(feature = "board"))]
mod left_out {
    use std::path::{Path, PathBuf};

    use anyhow::Result;
    use l4d_experiments::{ablation::Ablated, lift::Benched};
    use l4d_query::stats::SetStats;
    use l4d_splat::speed::Speed;

    use crate::out::Printer;

    fn none(out: &Printer) -> Result<Vec<PathBuf>> {
        out.note("no figures: this l4d was built without the feature `board` (cargo build --features board)");
        Ok(Vec::new())
    }

    pub(crate) fn publish_lift(_: &Benched, _: &str, _: &Path, out: &Printer) -> Result<Vec<PathBuf>> {
        none(out)
    }

    pub(crate) fn publish_splats(_: &Speed, _: &Path, out: &Printer) -> Result<Vec<PathBuf>> {
        none(out)
    }

    pub(crate) fn publish_views(_: &Ablated, _: &Path, out: &Printer) -> Result<Vec<PathBuf>> {
        none(out)
    }

    pub(crate) fn publish_stats(_: &SetStats, _: &Path, out: &Printer) -> Result<Vec<PathBuf>> {
        none(out)
    }
}
