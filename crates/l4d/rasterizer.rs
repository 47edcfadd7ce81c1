//! What `--adapter` means: the processor, or graphics hardware.

use anyhow::{Context as _, Result};
use l4d_gpu::{AdapterChoice, Gpu};
use l4d_splat::raster::{Cpu, Rasterizer};
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
        // A graphics adapter in software is slower than the processor by itself.
        "auto" => match l4d_gpu::adapters().first() {
            Some(best) if best.kind != "software" => graphics(&AdapterChoice::Best),
            _ => Ok(processor()),
        },
        adapter => graphics(&adapter.parse()?),
    }
}

fn processor() -> Opened {
    Opened { rasterizer: Box::new(Cpu::new()), adapter: None }
}

fn graphics(choice: &AdapterChoice) -> Result<Opened> {
    let gpu = Gpu::open(choice).context("--adapter")?;
    let adapter = Some(serde_json::to_value(gpu.adapter())?);
    Ok(Opened { rasterizer: Box::new(gpu), adapter })
}
