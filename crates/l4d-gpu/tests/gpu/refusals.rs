//! What cannot be done is said, with what would help.

use l4d_gpu::{AdapterChoice, Gpu, GpuError, adapters};
use l4d_splat::conformance::{Case, cases};
use l4d_splat::raster::{RasterError, Rasterizer};
use l4d_splat::splats::{SplatParts, Splats};

use crate::{gpu, open};

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).unwrap()
}

#[test]
fn an_adapter_that_is_not_there_is_named_with_those_that_are() {
    for wanted in [AdapterChoice::Named("no such adapter".into()), AdapterChoice::Numbered(999)] {
        let error = Gpu::open(&wanted).unwrap_err();
        let GpuError::NoAdapter { wanted: told, found } = &error else { panic!("{error}") };
        assert_eq!(told, &wanted);
        assert_eq!(found.len(), adapters().len());
        let text = error.to_string();
        assert!(
            text.contains("mesa-vulkan-drivers") && text.contains("999") != text.contains("no such"),
            "{text}"
        );
    }
}

#[test]
fn an_adapter_is_found_by_a_part_of_its_name_and_by_its_number() {
    let report = gpu().adapter();
    let part = report.name.split(' ').next().unwrap().to_uppercase();
    let again = Gpu::open(&AdapterChoice::Named(part.clone())).unwrap();
    assert!(again.adapter().name.to_uppercase().contains(&part));
    let place = adapters().iter().position(|listed| listed == report).unwrap();
    assert_eq!(Gpu::open(&AdapterChoice::Numbered(place)).unwrap().adapter(), report);
    let name = gpu().name();
    assert!(name.contains(&report.name) && name.contains(&report.backend) && name.contains(&report.driver));
}

#[test]
fn what_has_no_room_names_the_limit() {
    let small = open().with_binding_limit(4_000);
    let case = case("room");
    let error = small.prepare(&case.splats, &case.view, &case.settings).err().unwrap();
    let RasterError::Backend { source, .. } = &error else { panic!("{error}") };
    let text = source.to_string();
    assert!(text.contains("max_storage_buffer_binding_size") && text.contains("4000"), "{text}");
}

#[test]
fn a_gaussian_that_overflows_is_named() {
    let case = case("cloud");
    let with = |change: &dyn Fn(&mut SplatParts)| {
        let mut parts = case.splats.clone().into_parts();
        change(&mut parts);
        let splats = Splats::new(parts).unwrap();
        match gpu().prepare(&splats, &case.view, &case.settings).map(|_| ()).unwrap_err() {
            RasterError::Overflow(bad) => (bad.index, bad.field),
            other => panic!("{other}"),
        }
    };
    // Straight ahead, where the four functions that turn about z are all positive and sum up to 1.9.
    let (centre, [_, _, ahead]) = (case.view.centre(), case.view.rotation());
    let straight: [f32; 3] = std::array::from_fn(|axis| (centre[axis] + 3.0 * ahead[axis]) as f32);
    let blind = |parts: &mut SplatParts, index: usize| {
        parts.means[index] = straight;
        for k in [0, 2, 6, 12] {
            parts.sh[16 * index + k] = [3e38; 3];
        }
    };
    // In front of the camera, and as far below its axis as a number can be.
    assert_eq!(with(&|parts| parts.means[7] = [0.0, 3e38, 3.0]), (7, "means"));
    assert_eq!(with(&|parts| parts.scales[70] = [3e38; 3]), (70, "scales"));
    assert_eq!(with(&|parts| blind(parts, 33)), (33, "sh"));
    // The first of several, whichever the adapter comes to first.
    let both = |parts: &mut SplatParts| {
        parts.scales[90] = [3e38; 3];
        blind(parts, 20);
    };
    assert_eq!(with(&both), (20, "sh"));
}
