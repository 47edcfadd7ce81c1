//! What `--adapter` means: the processor, or graphics hardware where the feature `gpu` is built in.

use anyhow::Result;
use l4d_splat::raster::{Cpu, Rasterizer};
use l4d_splat::speed::Backend;
use serde_json::Value;

/// A rasterizer that is ready, and the adapter that it runs on, for manifests.
pub(crate) struct Opened {
    pub(crate) rasterizer: Box<dyn Rasterizer>,
    /// None for the processor.
    pub(crate) adapter: Option<Value>,
}

/// `cpu`, `auto`, or an adapter by number or name.
pub(crate) fn open(adapter: &str) -> Result<Opened> {
    match adapter {
        "cpu" => Ok(processor()),
        "auto" => graphics::best().unwrap_or_else(|| Ok(processor())),
        adapter => graphics::open(adapter),
    }
}

/// An adapter to measure.
pub(crate) fn backend(adapter: &str) -> Result<Backend> {
    let Opened { rasterizer, adapter } = graphics::open(adapter)?;
    let name = adapter.as_ref().and_then(|adapter| adapter["name"].as_str()).unwrap_or_default();
    let label = format!("wgpu, {}", name.split(" (").next().unwrap_or_default());
    Ok(Backend { label, name: rasterizer.name(), rasterizer, pool: None })
}

fn processor() -> Opened {
    Opened { rasterizer: Box::new(Cpu::new()), adapter: None }
}

#[cfg(feature = "gpu")]
mod graphics {
    use anyhow::{Context as _, Result};
    use l4d_gpu::{AdapterChoice, Gpu};

    use super::Opened;

    /// A graphics adapter in software is slower than the processor by itself.
    pub(super) fn best() -> Option<Result<Opened>> {
        let adapters = l4d_gpu::adapters();
        let best = adapters.first().filter(|best| best.kind != "software")?;
        tracing::debug!("adapter {best}");
        Some(opened(&AdapterChoice::Best))
    }

    pub(super) fn open(adapter: &str) -> Result<Opened> {
        opened(&adapter.parse()?)
    }

    fn opened(choice: &AdapterChoice) -> Result<Opened> {
        let gpu = Gpu::open(choice).context("--adapter")?;
        let adapter = Some(serde_json::to_value(gpu.adapter())?);
        Ok(Opened { rasterizer: Box::new(gpu), adapter })
    }
}

#[cfg(not(feature = "gpu"))]
mod graphics {
    use anyhow::Result;

    use super::Opened;

    pub(super) fn best() -> Option<Result<Opened>> {
        None
    }

    pub(super) fn open(_: &str) -> Result<Opened> {
        Err(crate::out::not_built_in("drawing on graphics hardware", "gpu"))
    }
}
