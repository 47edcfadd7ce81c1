//! The scenes: ordinary ones, and one for each way in which splatting is known to break.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::gaussians::{Gaussians, ShDegree};
use crate::raster::RasterSettings;
use crate::splats::{SplatParts, Splats};
use crate::view::View;

/// Splats, and how they are looked at.
#[derive(Debug, Clone)]
pub struct Case {
    pub name: &'static str,
    /// What is drawn.
    pub splats: Splats,
    pub view: View,
    /// With which constants.
    pub settings: RasterSettings,
}

/// All scenes, the ordinary ones first.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        case("nothing", Vec::new(), ahead([20, 12])),
        case("one Gaussian", vec![Blob::default()], ahead([33, 20])),
        case("one pixel", cloud(3, 6, [0.02, 0.4], [0.1, 0.9]), ahead([1, 1])),
        cloud_in_colours(),
        room(),
        case("equal depths", equal_depths(), ahead([32, 32])),
        case("near plane", near_plane(), ahead([40, 30])),
        case("beside the frustum", beside(), ahead([40, 30])),
        case("needles", stretched([1e-4, 1e-4, 1.5]), ahead([48, 48])),
        singular(),
        case("flat, edge on", stretched([0.0, 0.5, 0.5]), ahead([48, 48])),
        case("long needles", stretched([1e-12, 1e-3, 1e6]), ahead([48, 48])),
        case("huge", stretched([3e3, 2e5, 1e6]), ahead([32, 32])),
        case("tiny", stretched([1e-12, 0.0, 1e-20]), ahead([32, 32])),
        case("opacities", opacities(), ahead([32, 32])),
        case("10000 layers", layers(), ahead([16, 16])),
        far_away(),
        bad_quaternions(),
        case("dark", dark(), ahead([32, 32])),
    ];
    let mut soft = cloud_in_colours();
    soft.name = "no thresholds";
    soft.settings.alpha_min = 1e-30;
    soft.settings.transmittance_min = 0.0;
    soft.settings.coverage_sigmas = 40.0;
    cases.push(soft);
    cases
}

/// One Gaussian, with values that are fine.
#[derive(Debug, Clone)]
struct Blob {
    mean: [f32; 3],
    scale: [f32; 3],
    rotation: [f32; 4],
    opacity: f32,
    sh: Vec<[f32; 3]>,
}

impl Default for Blob {
    fn default() -> Self {
        Self {
            mean: [0.1, -0.05, 3.0],
            scale: [0.2, 0.1, 0.3],
            rotation: [1.0, 0.0, 0.0, 0.0],
            opacity: 0.7,
            sh: vec![[0.8, -0.3, 0.2]],
        }
    }
}

fn ahead(size: [u32; 2]) -> View {
    let [width, height] = size.map(f64::from);
    let focal = 1.1 * width.max(height);
    let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    view(size, [focal, focal], [width / 2.0, height / 2.0], pose)
}

#[expect(clippy::expect_used, reason = "the views of this file are fine")]
fn view(size: [u32; 2], focal: [f64; 2], principal: [f64; 2], pose: [[f64; 4]; 3]) -> View {
    View::new(size, focal, principal, pose).expect("a view that can be drawn from")
}

#[expect(clippy::expect_used, reason = "the splats of this file are fine")]
fn splats(blobs: Vec<Blob>) -> Splats {
    let count = blobs.first().map_or(1, |blob| blob.sh.len());
    let degree = (0..=3).filter_map(ShDegree::new).find(|degree| degree.coefficients() == count);
    let mut parts = SplatParts { sh_degree: degree.unwrap_or_default(), ..SplatParts::default() };
    for blob in blobs {
        parts.means.push(blob.mean);
        parts.scales.push(blob.scale);
        parts.rotations.push(blob.rotation);
        parts.opacities.push(blob.opacity);
        parts.sh.extend(blob.sh);
    }
    Splats::new(parts).expect("splats that can be drawn")
}

fn case(name: &'static str, blobs: Vec<Blob>, view: View) -> Case {
    Case { name, splats: splats(blobs), view, settings: RasterSettings::default() }
}

fn random_rotation(random: &mut ChaCha8Rng) -> [f32; 4] {
    loop {
        let quaternion: [f64; 4] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        let length = quaternion.iter().map(|value| value * value).sum::<f64>().sqrt();
        if (0.1..1.0).contains(&length) {
            return quaternion.map(|value| (value / length) as f32);
        }
    }
}

fn random_colour(random: &mut ChaCha8Rng) -> [f32; 3] {
    // Display colour 0 to 1 in the constant coefficient.
    std::array::from_fn(|_| random.random_range(-1.7..1.7))
}

/// Gaussians in front of a camera at the origin, most of them in the picture.
fn cloud(seed: u64, count: usize, scales: [f32; 2], opacities: [f32; 2]) -> Vec<Blob> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let z = random.random_range(1.5..6.0_f32);
            Blob {
                mean: [z * random.random_range(-0.5..0.5), z * random.random_range(-0.45..0.45), z],
                scale: std::array::from_fn(|_| {
                    scales[0] * (scales[1] / scales[0]).powf(random.random_range(0.0..1.0))
                }),
                rotation: random_rotation(&mut random),
                opacity: random.random_range(opacities[0]..opacities[1]),
                sh: vec![random_colour(&mut random)],
            }
        })
        .collect()
}

/// Colours by direction, a turned camera, an uneven size, a background.
fn cloud_in_colours() -> Case {
    let mut blobs = cloud(1, 150, [0.02, 0.35], [0.05, 0.98]);
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for blob in &mut blobs {
        blob.sh.extend((1..16).map(|_| random_colour(&mut random).map(|value| 0.2 * value)));
    }
    // Turned about y by asin 0.28 and about the optical axis by asin 0.6, then moved.
    let pose =
        [[0.8 * 0.96, 0.6, -0.8 * 0.28, 0.2], [-0.6 * 0.96, 0.8, 0.6 * 0.28, -0.1], [0.28, 0.0, 0.96, 0.3]];
    let mut case = case("cloud", blobs, view([61, 43], [58.0, 66.0], [27.5, 24.0], pose));
    case.settings.background = [0.3, 0.6, 0.1];
    case
}

/// Surfaces of overlapping discs: a floor, a wall and a ball.
fn room() -> Case {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let blobs = (0..500)
        .map(|index| {
            let (a, b) = (random.random_range(-1.0..1.0_f32), random.random_range(-1.0..1.0_f32));
            let mean = match index % 3 {
                0 => [2.5 * a, 1.0, 4.0 + 2.0 * b],
                1 => [2.5 * a, 1.2 * b, 6.0],
                _ => {
                    let angle = std::f32::consts::PI * b;
                    let ring = 0.6 * (1.0 - a * a).sqrt();
                    [ring * angle.cos(), 0.3 + 0.6 * a, 4.0 + ring * angle.sin()]
                }
            };
            let size = random.random_range(0.08..0.25);
            Blob {
                mean,
                scale: [size, size * random.random_range(0.5..1.0), 0.1 * size],
                rotation: random_rotation(&mut random),
                opacity: random.random_range(0.3..0.999),
                sh: vec![random_colour(&mut random)],
            }
        })
        .collect();
    case("room", blobs, ahead([64, 48]))
}

/// Coplanar and partly identical Gaussians: only their order in the list decides.
fn equal_depths() -> Vec<Blob> {
    let mut blobs = cloud(4, 40, [0.1, 0.6], [0.2, 0.95]);
    for (index, blob) in blobs.iter_mut().enumerate() {
        blob.mean[2] = 3.0;
        if index % 4 == 0 {
            blob.mean = [0.0, 0.0, 3.0];
        }
    }
    blobs
}

/// On both sides of the near plane, on it, around the camera and behind it.
fn near_plane() -> Vec<Blob> {
    let depths = [0.2, 0.200_000_03, 0.21, 0.25, 0.0, -1.0, -0.2, 0.5, 1.0];
    let mut blobs = cloud(5, 2 * depths.len(), [0.02, 0.3], [0.1, 0.6]);
    for (blob, z) in blobs.iter_mut().zip(depths.into_iter().cycle()) {
        blob.mean = [0.05 * blob.mean[0], 0.05 * blob.mean[1], z];
    }
    blobs[4].mean = [0.0; 3];
    blobs
}

/// Large Gaussians whose centres lie outside the field of view, where the affine approximation is held back.
fn beside() -> Vec<Blob> {
    let mut blobs = cloud(6, 24, [0.3, 1.2], [0.3, 0.9]);
    for (index, blob) in blobs.iter_mut().enumerate() {
        let side = if index % 2 == 0 { 1.0 } else { -1.0 };
        blob.mean[index / 2 % 2] = side * blob.mean[2] * (0.5 + 0.06 * index as f32);
    }
    blobs
}

/// Gaussians of these scales in all orientations, a few of them aligned with the axes.
fn stretched(scale: [f32; 3]) -> Vec<Blob> {
    let mut blobs = cloud(7, 24, [0.1, 0.2], [0.2, 0.9]);
    let half = 0.5_f32.sqrt();
    let aligned = [[1.0, 0.0, 0.0, 0.0], [half, half, 0.0, 0.0], [half, 0.0, half, 0.0]];
    for (index, blob) in blobs.iter_mut().enumerate() {
        blob.scale = scale;
        if let Some(&rotation) = aligned.get(index) {
            blob.rotation = rotation;
        }
    }
    blobs
}

/// Lines without width under little blur: projected covariances whose determinant is almost 0.
fn singular() -> Case {
    let mut case = case("singular", stretched([1e-9, 1e-9, 3.0]), ahead([48, 48]));
    case.settings.blur_px2 = 0.03;
    case
}

fn opacities() -> Vec<Blob> {
    let levels = [0.0, 1e-9, 0.003_9, 1.0 / 255.0, 0.004, 0.5, 0.989, 0.99, 0.991, 1.0, 1.0, 1.0];
    let mut blobs = cloud(8, 2 * levels.len(), [0.1, 0.5], [0.1, 0.2]);
    for (blob, opacity) in blobs.iter_mut().zip(levels.into_iter().cycle()) {
        blob.opacity = opacity;
    }
    blobs
}

/// More layers than the transmittance can pass; each pixel blends hundreds of them.
fn layers() -> Vec<Blob> {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    (0..10_000)
        .map(|layer| Blob {
            mean: [random.random_range(-0.2..0.2), random.random_range(-0.2..0.2), 1.0 + layer as f32 * 3e-4],
            scale: [0.5, 0.4, 0.1],
            rotation: random_rotation(&mut random),
            opacity: random.random_range(0.0042..0.012),
            sh: vec![random_colour(&mut random)],
        })
        .collect()
}

/// A scene and its camera 100 km from the origin: coordinates in f32 are multiples of 8 mm.
fn far_away() -> Case {
    let there = [1e5, -2e5, 3e4];
    let mut blobs = cloud(10, 80, [0.03, 0.4], [0.1, 0.9]);
    for blob in &mut blobs {
        for (value, shift) in blob.mean.iter_mut().zip(there) {
            *value += shift as f32;
        }
    }
    let pose = [[1.0, 0.0, 0.0, -there[0]], [0.0, 1.0, 0.0, -there[1]], [0.0, 0.0, 1.0, -there[2]]];
    case("far from origin", blobs, view([48, 36], [50.0, 50.0], [24.0, 18.0], pose))
}

/// Quaternions without length, and of lengths far from 1, as checkpoints may hold them.
#[expect(clippy::expect_used, reason = "the Gaussians are fine")]
fn bad_quaternions() -> Case {
    let blobs = cloud(12, 12, [0.1, 0.5], [0.2, 0.9]);
    let lengths = [0.0, 1e-20, 1e-6, 0.5, 30.0, 1e15];
    let gaussians = Gaussians {
        sh_degree: ShDegree::ZERO,
        means: blobs.iter().map(|blob| blob.mean).collect(),
        log_scales: blobs.iter().map(|blob| blob.scale.map(f32::ln)).collect(),
        rotations: blobs
            .iter()
            .zip(lengths.into_iter().cycle())
            .map(|(blob, length)| blob.rotation.map(|value| value * length))
            .collect(),
        opacity_logits: blobs.iter().map(|blob| (blob.opacity / (1.0 - blob.opacity)).ln()).collect(),
        sh: blobs.iter().map(|blob| blob.sh[0]).collect(),
    };
    let splats = gaussians.activate().expect("Gaussians that can be drawn");
    Case { name: "quaternions", splats, view: ahead([32, 32]), settings: RasterSettings::default() }
}

/// Colours that some directions make negative.
fn dark() -> Vec<Blob> {
    let mut blobs = cloud(13, 30, [0.1, 0.4], [0.2, 0.9]);
    let mut random = ChaCha8Rng::seed_from_u64(14);
    for blob in &mut blobs {
        blob.sh = (0..4).map(|_| random_colour(&mut random).map(|value| value - 1.0)).collect();
    }
    blobs
}
