//! Which graphics adapter draws.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use serde::Serialize;
use wgpu::{Adapter, DeviceType, Instance, InstanceDescriptor, InstanceFlags};

use crate::error::GpuError;

/// Which adapter is wanted: what the value of a flag `--adapter` says.
///
/// ```
/// use l4d_gpu::AdapterChoice;
///
/// let choice = |text: &str| text.parse::<AdapterChoice>().unwrap();
/// assert_eq!(choice("best"), AdapterChoice::Best);
/// assert_eq!(choice("0"), AdapterChoice::Numbered(0));
/// assert_eq!(choice("GeForce"), AdapterChoice::Named("GeForce".into()));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AdapterChoice {
    /// Dedicated hardware before shared, virtual and software; the first of equals.
    Best,
    /// The one with this place, from 0, in the list of [`adapters`].
    Numbered(usize),
    /// The best of those whose name contains this, whatever the case.
    Named(String),
}

impl FromStr for AdapterChoice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.trim() {
            "best" => Self::Best,
            text => text.parse().map_or_else(|_| Self::Named(text.into()), Self::Numbered),
        })
    }
}

impl fmt::Display for AdapterChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Best => f.write_str("best"),
            Self::Numbered(place) => write!(f, "{place}"),
            Self::Named(name) => f.write_str(name),
        }
    }
}

/// An adapter as manifests and `l4d doctor` name it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AdapterReport {
    /// Name of the hardware, or of the software adapter.
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// Name and version of the driver.
    pub driver: String,
}

impl fmt::Display for AdapterReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, kind, backend, driver } = self;
        write!(f, "{name} ({kind}, {backend}, driver {driver})")
    }
}

impl AdapterReport {
    pub(crate) fn of(adapter: &Adapter) -> Self {
        let info = adapter.get_info();
        let driver = format!("{} {}", info.driver, info.driver_info);
        let driver = driver.trim();
        Self {
            name: info.name,
            kind: match info.device_type {
                DeviceType::DiscreteGpu => "discrete",
                DeviceType::IntegratedGpu => "integrated",
                DeviceType::VirtualGpu => "virtual",
                DeviceType::Cpu => "software",
                DeviceType::Other => "other",
            },
            backend: info.backend.to_str().to_owned(),
            driver: if driver.is_empty() { "unknown".into() } else { driver.to_owned() },
        }
    }
}

/// All adapters of this machine, the best first; none if there is no driver.
pub fn adapters() -> Vec<AdapterReport> {
    best_first().iter().map(AdapterReport::of).collect()
}

pub(crate) fn choose(choice: &AdapterChoice) -> Result<Adapter, GpuError> {
    let candidates = best_first();
    let names: Vec<String> = candidates.iter().map(|adapter| adapter.get_info().name).collect();
    place_of(&names, choice)
        .and_then(|place| candidates.into_iter().nth(place))
        .ok_or(GpuError::NoAdapter { wanted: choice.clone(), found: names })
}

/// Place of the chosen one among adapters of these names, the best of which comes first.
fn place_of(names: &[String], choice: &AdapterChoice) -> Option<usize> {
    match choice {
        AdapterChoice::Best => (!names.is_empty()).then_some(0),
        AdapterChoice::Numbered(place) => (*place < names.len()).then_some(*place),
        AdapterChoice::Named(wanted) => {
            let wanted = wanted.to_lowercase();
            names.iter().position(|name| name.to_lowercase().contains(&wanted))
        }
    }
}

fn best_first() -> Vec<Adapter> {
    // A build for a system without any of its interfaces.
    if Instance::enabled_backend_features().is_empty() {
        return Vec::new();
    }
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    // Validation layers only where the environment asks for them: they are slow.
    descriptor.flags = InstanceFlags::empty();
    let descriptor = descriptor.with_env();
    let backends = descriptor.backends;
    let instance = Instance::new(descriptor);
    let mut found = pollster::block_on(instance.enumerate_adapters(backends));
    found.sort_by_key(|adapter| match adapter.get_info().device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(text: &str) -> AdapterChoice {
        text.parse().unwrap()
    }

    #[test]
    fn a_part_of_a_name_is_enough_and_the_case_does_not_matter() {
        let names = ["NVIDIA GeForce RTX 4090".to_owned(), "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned()];
        let place = |text: &str| place_of(&names, &choice(text));
        assert_eq!(place("geforce"), Some(0));
        assert_eq!(place("LLVM"), Some(1));
        assert_eq!(place("radeon"), None);
        assert_eq!(place("best"), Some(0));
        assert_eq!(place_of(&[], &AdapterChoice::Best), None);
    }

    #[test]
    fn numbers_are_places_in_the_list() {
        let names = ["Iris".to_owned(), "llvmpipe".to_owned()];
        assert_eq!(place_of(&names, &choice("1")), Some(1));
        assert_eq!(place_of(&names, &choice("2")), None);
        assert_eq!(choice("RTX 4090"), AdapterChoice::Named("RTX 4090".into()));
        assert_eq!(choice("-1"), AdapterChoice::Named("-1".into()));
    }
}
