//! Why graphics hardware did not do what was asked.

use l4d_splat::raster::RasterError;

use crate::adapter::AdapterChoice;

/// What went wrong between this program and a graphics adapter.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter, or not the one that was asked for.
    #[error(
        "no graphics adapter{}; found: {}. Name one of those found, install a Vulkan driver (on Debian and Ubuntu \
         `apt-get install mesa-vulkan-drivers` draws in software), or draw on the processor",
        asked_for(wanted),
        list(found)
    )]
    NoAdapter {
        /// What was asked for.
        wanted: AdapterChoice,
        /// Names of those that there are, in the order of their numbers.
        found: Vec<String>,
    },
    /// The adapter cannot do what every pass needs.
    #[error("graphics adapter `{adapter}` has {limit} = {has}, and {needs} is needed: choose another one")]
    Unfit {
        /// Name of the adapter.
        adapter: String,
        /// Name of its limit.
        limit: &'static str,
        /// What is needed.
        needs: u64,
        /// What it has.
        has: u64,
    },
    /// The adapter did not open.
    #[error("graphics adapter `{adapter}` does not open")]
    Closed {
        /// Name of the adapter.
        adapter: String,
        /// What the driver says.
        source: wgpu::RequestDeviceError,
    },
    /// Something larger than the adapter's limits.
    #[error(
        "{what} would take {needs}, the adapter's {limit} is {has}: draw fewer Gaussians or fewer pixels, or draw on the processor"
    )]
    TooLarge {
        /// What does not fit.
        what: &'static str,
        /// How much it would take; at least.
        needs: u64,
        /// Name of the limit.
        limit: &'static str,
        has: u64,
    },
    /// The adapter's memory is used up.
    #[error(
        "the graphics adapter is out of memory: close what else uses it, draw fewer Gaussians or pixels, or draw on the processor"
    )]
    OutOfMemory,
    /// The adapter is gone: unplugged, reset, or stopped by its driver.
    #[error("the graphics adapter was lost ({reason}): open it again")]
    Lost {
        /// What the driver says.
        reason: String,
    },
    /// Something else that the driver says.
    #[error("the graphics driver reports: {0}")]
    Driver(String),
}

fn asked_for(wanted: &AdapterChoice) -> String {
    match wanted {
        AdapterChoice::Best => String::new(),
        AdapterChoice::Numbered(place) => format!(" has the number {place}"),
        AdapterChoice::Named(name) => format!(" is named like `{name}`"),
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "none".into();
    }
    let numbered = |(place, name): (usize, &String)| format!("{place}: {name}");
    names.iter().enumerate().map(numbered).collect::<Vec<_>>().join(", ")
}

/// What ends a job: the adapter, or its input.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub(crate) enum Failure {
    Gpu(#[from] GpuError),
    Raster(#[from] RasterError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_has_no_adapter_reads_what_to_install_and_what_there_is() {
        let text = |wanted, found: &[&str]| {
            let found = found.iter().map(|&name| name.to_owned()).collect();
            GpuError::NoAdapter { wanted, found }.to_string()
        };
        let none = text(AdapterChoice::Best, &[]);
        assert!(
            none.contains("mesa-vulkan-drivers") && none.contains("no graphics adapter; found: none"),
            "{none}"
        );
        let other = text(AdapterChoice::Named("GeForce".into()), &["Iris", "llvmpipe"]);
        assert!(other.contains("named like `GeForce`") && other.contains("0: Iris, 1: llvmpipe"), "{other}");
        let place = text(AdapterChoice::Numbered(7), &["Iris"]);
        assert!(place.contains("has the number 7"), "{place}");
    }
}
