//! The shaders: which there are, and the constants that they share with the host.
//!
//! A pass is a file under `shaders/`; what passes share is under `shaders/shared/` and is put in front.

use l4d_splat::raster::TILE;

/// Invocations of a workgroup: a tile has four pixels for each.
pub(crate) const LANES: u32 = 64;
/// Numbers that one lane scans or sorts.
pub(crate) const RUN: u32 = 16;
/// Numbers that one workgroup scans or sorts.
pub(crate) const BLOCK: u32 = LANES * RUN;
/// Bits of a digit of the radix sort.
pub(crate) const DIGIT_BITS: u32 = 4;
/// Values of a digit; as many as the numbers of a lane, which lets one scan serve both.
pub(crate) const RADIX: u32 = 1 << DIGIT_BITS;
/// Gaussians whose sums over a tile are taken together: bounded by the workgroup's memory.
const SUMMED: u32 = 4;
/// Channels that spread and gather carry at a time.
pub(crate) const CHANNELS: u32 = 8;
/// Gaussians of a tile that one dispatch blends; longer lists take several. Drivers stop what takes too long, and
/// llvmpipe ends all loops of a lane after 65 535 turns altogether silently.
pub(crate) const WINDOW: u32 = 2048;
/// Tiles of a picture, for the same reason: a Gaussian may cover all of them.
pub(crate) const MOST_TILES: u32 = 60_000;
/// Sums over pixels that backward keeps of a pair.
pub(crate) const GRADIENT_SUMS: u32 = 10;
/// Numbers in which the gradient of a Gaussian leaves the adapter, spherical harmonics apart.
pub(crate) const GRADIENT_FLOATS: u32 = 16;

macro_rules! shader {
    ($name:literal) => {
        include_str!(concat!("../shaders/", $name, ".wgsl"))
    };
}

const GRID: &str = shader!("shared/grid");
const PREFIX: &str = shader!("shared/prefix");
const DIGITS: &str = shader!("shared/digits");
const SCENE: &str = shader!("shared/scene");
const GAUSSIAN: &str = shader!("shared/gaussian");
const PROJECTION: &str = shader!("shared/projection");
const HARMONICS: &str = shader!("shared/harmonics");
const BLEND: &str = shader!("shared/blend");
const STAGING: &str = shader!("shared/staging");
const TILE_SUMS: &str = shader!("shared/tile_sums");

/// Defines the passes by name, file and the shared parts that are put in front.
macro_rules! passes {
    ($($pass:ident $file:literal [$($shared:ident),*];)*) => {
        /// One compute pass.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Pass {
            $($pass),*
        }

        impl Pass {
            pub(crate) const ALL: [Self; [$($file),*].len()] = [$(Self::$pass),*];

            fn parts(self) -> (&'static str, &'static [&'static str], &'static str) {
                match self {
                    $(Self::$pass => ($file, &[$($shared),*], shader!($file)),)*
                }
            }
        }
    };
}

passes! {
    Project "project" [GRID, SCENE, GAUSSIAN, PROJECTION, HARMONICS];
    Count "count" [GRID];
    Scan "scan" [GRID, PREFIX];
    ScanAdd "scan_add" [GRID, PREFIX];
    SortCount "sort_count" [GRID, DIGITS];
    SortScatter "sort_scatter" [GRID, PREFIX, DIGITS];
    Emit "emit" [GRID];
    Ranges "ranges" [GRID];
    Draw "draw" [GRID, SCENE, GAUSSIAN, BLEND, STAGING];
    SplatFeatures "splat_features" [GRID, SCENE, GAUSSIAN, BLEND, STAGING];
    GatherFeatures "gather_features" [GRID, SCENE, GAUSSIAN, BLEND, STAGING, TILE_SUMS];
    Backward "backward" [GRID, SCENE, GAUSSIAN, BLEND, STAGING, TILE_SUMS];
    Reduce "reduce" [GRID];
    ProjectBackward "project_backward" [GRID, SCENE, GAUSSIAN, PROJECTION, HARMONICS];
}

impl Pass {
    /// As its file is called.
    pub(crate) fn name(self) -> &'static str {
        self.parts().0
    }

    /// The whole shader.
    pub(crate) fn source(self) -> String {
        let (_, shared, own) = self.parts();
        shared.iter().fold(constants(), |text, part| text + part) + own
    }
}

fn constants() -> String {
    let whole = [
        ("TILE", TILE as u32),
        ("LANES", LANES),
        ("RUN", RUN),
        ("BLOCK", BLOCK),
        ("RADIX", RADIX),
        ("SUMMED", SUMMED),
        ("CHANNELS", CHANNELS),
        ("GRADIENT_SUMS", GRADIENT_SUMS),
        ("GRADIENT_FLOATS", GRADIENT_FLOATS),
    ];
    let mut text: String =
        whole.iter().map(|(name, value)| format!("const {name}: u32 = {value}u;\n")).collect();
    // A variance along an axis to its squared conic factor, and the derivative of 2^x at 0.
    text += &format!("const HALF_LOG2_E: f32 = {:?};\n", 0.5 * std::f32::consts::LOG2_E);
    text += &format!("const PER_EXPONENT: f32 = {:?};\n", std::f32::consts::LN_2);
    text
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    /// What WebGPU promises of every adapter.
    const WORKGROUP_BYTES: u32 = 16_384;
    const STORAGE_BUFFERS: usize = 8;

    #[test]
    fn every_shader_is_valid_and_asks_for_nothing_optional() {
        for pass in Pass::ALL {
            let source = pass.source();
            let module = naga::front::wgsl::parse_str(&source)
                .unwrap_or_else(|error| panic!("{}: {}", pass.name(), error.emit_to_string(&source)));
            // No subgroups, no float atomics, no f64, no f16.
            Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|error| panic!("{}: {}", pass.name(), error.emit_to_string(&source)));

            let storage = module
                .global_variables
                .iter()
                .filter(|(_, variable)| matches!(variable.space, naga::AddressSpace::Storage { .. }))
                .count();
            assert!(storage <= STORAGE_BUFFERS, "{}: {storage} storage buffers", pass.name());
            let workgroup: u32 = module
                .global_variables
                .iter()
                .filter(|(_, variable)| variable.space == naga::AddressSpace::WorkGroup)
                .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()))
                .sum();
            assert!(workgroup <= WORKGROUP_BYTES, "{}: {workgroup} bytes of workgroup memory", pass.name());
        }
    }

    #[test]
    fn every_file_belongs_to_a_pass() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .filter_map(|entry| entry.unwrap().file_name().to_str()?.strip_suffix(".wgsl").map(str::to_owned))
            .collect();
        files.sort();
        let mut passes = Pass::ALL.map(Pass::name);
        passes.sort_unstable();
        assert_eq!(files, passes);
    }

    #[test]
    fn the_layout_of_lanes_fits_the_tile() {
        assert_eq!(LANES as usize * 4, TILE * TILE);
        assert_eq!(RUN, RADIX);
        assert!(SUMMED * GRADIENT_SUMS.max(CHANNELS) <= LANES);
    }

    #[test]
    fn no_loop_takes_more_turns_than_a_driver_allows() {
        // Of the longest pass: each batch of staged Gaussians, in it each tile sum, in it each Gaussian and each lane;
        // then those that are not visible.
        let batch = 1 + LANES / SUMMED * (1 + SUMMED + LANES);
        let unseen = 1 + GRADIENT_SUMS;
        assert!(WINDOW.div_ceil(LANES) * (batch + unseen) + 100 < 65_535);
        assert_eq!(WINDOW % LANES, 0);
        const { assert!(MOST_TILES + 5000 < 65_535) };
    }
}
