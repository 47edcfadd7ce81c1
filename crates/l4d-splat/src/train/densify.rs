//! Adaptive density control: Gaussians are cloned, split and pruned.
//!
//! As in 3D Gaussian splatting, with a budget instead of thresholds on the count: what is nearly transparent or absurdly
//! large is pruned, and the room goes to those with the largest gradients by their projected centres.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::gaussians::Gaussians;

/// Gaussians of lower opacity are pruned.
const MIN_OPACITY: f32 = 0.02;
/// Length of the mean gradient by the projected centre (normalised device coordinates) above which a Gaussian is
/// cloned or split.
const GRADIENT_THRESHOLD: f32 = 1.0e-4;
/// Largest share of the Gaussians that is cloned or split at once.
const MOST_REFINED: f32 = 0.08;
/// Halves of a split Gaussian are so many times smaller.
const SPLIT_FACTOR: f32 = 1.6;

#[derive(Debug, PartialEq)]
pub(super) struct RowChange {
    /// Row `k` of the next state was row `sources[k].0`; true if it keeps its past.
    pub(super) sources: Vec<(u32, bool)>,
}

/// What decides which Gaussians are cloned, split and pruned.
#[derive(Debug)]
pub(super) struct DensityInput<'a> {
    /// Mean length of the gradient by the projected centre.
    pub(super) gradient_norm: &'a [f32],
    /// Opacities that count: the largest over the clip.
    pub(super) opacity: &'a [f32],
    /// Gaussians wider than this are pruned, metres.
    pub(super) widest_m: &'a [f32],
    /// Gaussians wider than this are split, others cloned, metres.
    pub(super) split_m: &'a [f32],
    /// Most Gaussians afterwards.
    pub(super) most: usize,
}

/// Changes the Gaussians in place.
pub(super) fn densify(
    gaussians: &mut Gaussians,
    input: &DensityInput<'_>,
    random: &mut ChaCha8Rng,
) -> RowChange {
    let width =
        |row: usize| gaussians.log_scales[row].iter().copied().fold(f32::NEG_INFINITY, f32::max).exp();
    let stays: Vec<u32> = (0..gaussians.len())
        .filter(|&row| input.opacity[row] >= MIN_OPACITY && width(row) <= input.widest_m[row])
        .map(|row| row as u32)
        .collect();
    let room = input.most.saturating_sub(stays.len()).min((MOST_REFINED * stays.len() as f32) as usize);
    let mut refined: Vec<u32> =
        stays.iter().copied().filter(|&row| input.gradient_norm[row as usize] > GRADIENT_THRESHOLD).collect();
    refined.sort_by(|&a, &b| {
        input.gradient_norm[b as usize].total_cmp(&input.gradient_norm[a as usize]).then(a.cmp(&b))
    });
    refined.truncate(room);
    refined.sort_unstable();

    let split = |row: u32| width(row as usize) > input.split_m[row as usize];
    let splits: Vec<bool> = refined.iter().map(|&row| split(row)).collect();
    let mut sources: Vec<(u32, bool)> = stays.iter().map(|&row| (row, true)).collect();
    sources.extend(refined.iter().map(|&row| (row, false)));
    let place: Vec<usize> = refined.iter().map(|row| stays.partition_point(|stay| stay < row)).collect();
    *gaussians = gaussians.select(&sources.iter().map(|&(row, _)| row).collect::<Vec<_>>());
    for (copy, (&first, &splits)) in place.iter().zip(&splits).enumerate() {
        let second = stays.len() + copy;
        if splits {
            // Both halves move: each to a place drawn from the whole.
            sources[first].1 = false;
            for half in [first, second] {
                let offset = sampled_offset(gaussians, half, random);
                for (mean, offset) in gaussians.means[half].iter_mut().zip(offset) {
                    *mean += offset;
                }
            }
            for half in [first, second] {
                for log_scale in &mut gaussians.log_scales[half] {
                    *log_scale -= SPLIT_FACTOR.ln();
                }
            }
        }
    }
    RowChange { sources }
}

/// An offset from the centre, distributed as the Gaussian is.
fn sampled_offset(gaussians: &Gaussians, row: usize, random: &mut ChaCha8Rng) -> [f32; 3] {
    let own: [f32; 3] = std::array::from_fn(|axis| normal(random) * gaussians.log_scales[row][axis].exp());
    rotated(gaussians.rotations[row], own)
}

/// A standard normal number (Box and Muller).
fn normal(random: &mut ChaCha8Rng) -> f32 {
    let radius = (-2.0 * (1.0 - random.random::<f32>()).max(f32::MIN_POSITIVE).ln()).sqrt();
    radius * (std::f32::consts::TAU * random.random::<f32>()).cos()
}

fn rotated(quaternion: [f32; 4], vector: [f32; 3]) -> [f32; 3] {
    let [w, x, y, z] = quaternion;
    let rotation = glam::Quat::from_xyzw(x, y, z, w);
    let rotation =
        if rotation.length_squared() > 1e-20 { rotation.normalize() } else { glam::Quat::IDENTITY };
    rotation.mul_vec3(glam::Vec3::from_array(vector)).to_array()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;
    use crate::gaussians::ShDegree;

    fn four() -> Gaussians {
        Gaussians {
            sh_degree: ShDegree::ZERO,
            means: (0..4).map(|index| [index as f32, 0.0, 0.0]).collect(),
            log_scales: vec![[0.1_f32.ln(); 3], [0.1_f32.ln(); 3], [1e-3_f32.ln(); 3], [9.0_f32.ln(); 3]],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 4],
            opacity_logits: vec![0.0; 4],
            sh: (0..4).map(|index| [index as f32; 3]).collect(),
        }
    }

    #[test]
    fn the_faint_and_the_huge_go_and_the_pulled_are_split_or_doubled() {
        let mut gaussians = four();
        gaussians.append(four().select(&[2; 30]));
        let count = gaussians.len();
        let mut gradient_norm = vec![0.0; count];
        (gradient_norm[1], gradient_norm[2]) = (1.0, 2.0);
        let mut opacity = vec![0.5; count];
        opacity[0] = 0.001;
        let input = DensityInput {
            gradient_norm: &gradient_norm,
            opacity: &opacity,
            widest_m: &vec![5.0; count],
            split_m: &vec![0.01; count],
            most: 100,
        };
        let change = densify(&mut gaussians, &input, &mut ChaCha8Rng::seed_from_u64(3));
        // 0 was faint, 3 huge; both refined ones have a second row at the end.
        assert_eq!(gaussians.len(), count - 2 + 2);
        assert_eq!(change.sources[..3], [(1, false), (2, true), (4, true)]);
        assert_eq!(change.sources[count - 2..], [(1, false), (2, false)]);
        assert_eq!((gaussians.means[1], gaussians.means[count - 1]), ([2.0, 0.0, 0.0], [2.0, 0.0, 0.0]));
        assert!((gaussians.log_scales[0][0] - (0.1_f32 / 1.6).ln()).abs() < 1e-6);
        assert_eq!(gaussians.log_scales[count - 1], four().log_scales[2]);
        assert_ne!(gaussians.means[0], gaussians.means[count - 2]);
        assert_eq!(gaussians.sh[count - 2], [1.0; 3]);
    }

    #[test]
    fn there_are_never_more_than_allowed() {
        let mut gaussians = four();
        let input = DensityInput {
            gradient_norm: &[1.0; 4],
            opacity: &[0.5; 4],
            widest_m: &[100.0; 4],
            split_m: &[100.0; 4],
            most: 4,
        };
        densify(&mut gaussians, &input, &mut ChaCha8Rng::seed_from_u64(3));
        assert_eq!(gaussians, four());
    }
}
