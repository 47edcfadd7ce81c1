//! The scene with its answer made visible: proof that an answer is a part of the scene, not of a picture.
//!
//! Owns what becomes of Gaussians that do or don't belong to an answer. Refuses to know how they were told apart.

use l4d_splat::splats::{SplatError, SplatParts, Splats};

/// The constant spherical harmonic.
const CONSTANT: f32 = 0.282_094_8;

/// The scene with the answer in another colour: `share` of it, 0 to 1, over its own. Colours are display colours, and finite.
pub(crate) fn highlight(
    splats: &Splats,
    members: &[bool],
    colour: [f32; 3],
    share: f32,
) -> Result<Splats, SplatError> {
    let mut parts = splats.clone().into_parts();
    let coefficients = parts.sh_degree.coefficients();
    for (harmonics, _) in parts.sh.chunks_exact_mut(coefficients).zip(members).filter(|(_, member)| **member)
    {
        for (order, harmonic) in harmonics.iter_mut().enumerate() {
            for (value, colour) in harmonic.iter_mut().zip(colour) {
                let wanted = if order == 0 { (colour - 0.5) / CONSTANT } else { 0.0 };
                *value += share * (wanted - *value);
            }
        }
    }
    Splats::new(parts)
}

/// The answer alone.
pub(crate) fn extract(splats: &Splats, members: &[bool]) -> Result<Splats, SplatError> {
    keep(splats, |index| members.get(index).copied().unwrap_or(false))
}

/// The scene without the answer.
pub(crate) fn remove(splats: &Splats, members: &[bool]) -> Result<Splats, SplatError> {
    keep(splats, |index| !members.get(index).copied().unwrap_or(false))
}

fn keep(splats: &Splats, stays: impl Fn(usize) -> bool) -> Result<Splats, SplatError> {
    let rows: Vec<usize> = (0..splats.len()).filter(|&index| stays(index)).collect();
    Splats::new(SplatParts {
        sh_degree: splats.sh_degree(),
        means: rows.iter().map(|&row| splats.means()[row]).collect(),
        scales: rows.iter().map(|&row| splats.scales()[row]).collect(),
        rotations: rows.iter().map(|&row| splats.rotations()[row]).collect(),
        opacities: rows.iter().map(|&row| splats.opacities()[row]).collect(),
        sh: rows.iter().flat_map(|&row| splats.sh_of(row).iter().copied()).collect(),
    })
}
