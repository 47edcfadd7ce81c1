//! Gaussians over time as OpenUSD's `ParticleField3DGaussianSplat` (OpenUSD 26.03 and later), in its text form.
//!
//! One prim holds all Gaussians, so that a renderer sorts them together. What changes has time samples, a time code a
//! canonical frame, between which readers interpolate; everything else has one value. Scales and opacities are linear.

use std::fmt::Write as _;
use std::path::Path;

use l4d_data::store::write_atomic;
use l4d_data::{DataError, Timeline};

use crate::splats::{Splats, turn_towards};

/// A Gaussian reaches so many standard deviations.
const REACH: f32 = 3.0;

/// Writes the states of a model at some frames, ascending.
///
/// # Errors
/// What the disk refuses.
pub fn write(path: &Path, states: &[(u32, Splats)], timeline: Timeline) -> Result<(), DataError> {
    write_atomic(path, encode(states, timeline).as_bytes())
}

/// The text of the file; all states have the same Gaussians.
pub fn encode(states: &[(u32, Splats)], timeline: Timeline) -> String {
    let mut text = head(states, timeline);
    let Some((_, first)) = states.first() else { return text + "}\n" };
    text.push_str("    def ParticleField3DGaussianSplat \"splats\"\n    {\n");
    let _ = writeln!(text, "        float3[] extent = {}", tuples(&extent(states)));
    attribute(&mut text, "point3f[] positions", states, |state| tuples(state.means()));
    let turned = turned(states);
    attribute(&mut text, "quatf[] orientations", &turned, |rotations| tuples(rotations));
    attribute(&mut text, "float3[] scales", states, |state| tuples(state.scales()));
    attribute(&mut text, "float[] opacities", states, |state| {
        let values: Vec<String> = state.opacities().iter().map(f32::to_string).collect();
        format!("[{}]", values.join(", "))
    });
    let degree = first.sh_degree().get();
    let _ = writeln!(text, "        uniform int radiance:sphericalHarmonicsDegree = {degree}");
    attribute(&mut text, "float3[] radiance:sphericalHarmonicsCoefficients", states, |state| {
        tuples(state.sh())
    });
    text.push_str("    }\n}\n");
    text
}

fn head(states: &[(u32, Splats)], timeline: Timeline) -> String {
    let frame = |state: Option<&(u32, Splats)>| state.map_or(0, |(frame, _)| *frame);
    let (first, last, rate) = (frame(states.first()), frame(states.last()), timeline.frames_per_second());
    format!(
        "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    doc = \"4D Gaussians, written by l4d; time codes are frames\"\n    \
         endTimeCode = {last}\n    framesPerSecond = {rate}\n    metersPerUnit = 1\n    startTimeCode = {first}\n    \
         timeCodesPerSecond = {rate}\n    upAxis = \"Z\"\n)\n\ndef Xform \"scene\"\n{{\n"
    )
}

/// One value where all states agree, else a sample each.
fn attribute<S>(text: &mut String, name: &str, states: &[(u32, S)], value: impl Fn(&S) -> String) {
    let values: Vec<String> = states.iter().map(|(_, state)| value(state)).collect();
    if values.windows(2).all(|pair| pair[0] == pair[1]) {
        let _ = writeln!(text, "        {name} = {}", values[0]);
        return;
    }
    let _ = writeln!(text, "        {name}.timeSamples = {{");
    for ((frame, _), value) in states.iter().zip(&values) {
        let _ = writeln!(text, "            {frame}: {value},");
    }
    text.push_str("        }\n");
}

fn tuples<const N: usize>(rows: &[[f32; N]]) -> String {
    let mut text = String::with_capacity(rows.len() * N * 10);
    text.push('[');
    for (index, row) in rows.iter().enumerate() {
        text.push_str(if index == 0 { "(" } else { ", (" });
        for (place, value) in row.iter().enumerate() {
            let _ = write!(text, "{}{value}", if place == 0 { "" } else { ", " });
        }
        text.push(')');
    }
    text.push(']');
    text
}

/// Rotations of all states, each turned towards the state before, since readers interpolate.
fn turned(states: &[(u32, Splats)]) -> Vec<(u32, Vec<[f32; 4]>)> {
    let mut turned: Vec<(u32, Vec<[f32; 4]>)> = Vec::with_capacity(states.len());
    for (frame, state) in states {
        let mut rotations = state.rotations().to_vec();
        if let Some((_, before)) = turned.last() {
            rotations.iter_mut().zip(before).for_each(|(rotation, before)| turn_towards(rotation, before));
        }
        turned.push((*frame, rotations));
    }
    turned
}

/// Least and largest corner of all states.
fn extent(states: &[(u32, Splats)]) -> [[f32; 3]; 2] {
    let mut corners = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for (_, state) in states {
        for (mean, scales) in state.means().iter().zip(state.scales()) {
            let reach = REACH * scales.iter().copied().fold(0.0, f32::max);
            for axis in 0..3 {
                corners[0][axis] = corners[0][axis].min(mean[axis] - reach);
                corners[1][axis] = corners[1][axis].max(mean[axis] + reach);
            }
        }
    }
    if corners[0][0] > corners[1][0] { [[0.0; 3]; 2] } else { corners }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaussians::ShDegree;
    use crate::splats::SplatParts;

    fn state(x: f32, rotation: [f32; 4]) -> Splats {
        Splats::new(SplatParts {
            sh_degree: ShDegree::ZERO,
            means: vec![[x, 0.5, 1.0], [0.0; 3]],
            scales: vec![[0.1, 0.2, 0.25]; 2],
            rotations: vec![rotation, [1.0, 0.0, 0.0, 0.0]],
            opacities: vec![0.75, 1.0],
            sh: vec![[0.1, 0.2, 0.3], [0.0; 3]],
        })
        .unwrap()
    }

    #[test]
    fn what_changes_has_samples_and_turns_the_short_way() {
        let states = [(0, state(1.0, [0.6, 0.8, 0.0, 0.0])), (24, state(2.0, [-0.6, -0.8, 0.0, 0.0]))];
        insta::assert_snapshot!(encode(&states, Timeline::CANONICAL), @r#"
        #usda 1.0
        (
            defaultPrim = "scene"
            doc = "4D Gaussians, written by l4d; time codes are frames"
            endTimeCode = 24
            framesPerSecond = 24
            metersPerUnit = 1
            startTimeCode = 0
            timeCodesPerSecond = 24
            upAxis = "Z"
        )

        def Xform "scene"
        {
            def ParticleField3DGaussianSplat "splats"
            {
                float3[] extent = [(-0.75, -0.75, -0.75), (2.75, 1.25, 1.75)]
                point3f[] positions.timeSamples = {
                    0: [(1, 0.5, 1), (0, 0, 0)],
                    24: [(2, 0.5, 1), (0, 0, 0)],
                }
                quatf[] orientations = [(0.6, 0.8, 0, 0), (1, 0, 0, 0)]
                float3[] scales = [(0.1, 0.2, 0.25), (0.1, 0.2, 0.25)]
                float[] opacities = [0.75, 1]
                uniform int radiance:sphericalHarmonicsDegree = 0
                float3[] radiance:sphericalHarmonicsCoefficients = [(0.1, 0.2, 0.3), (0, 0, 0)]
            }
        }
        "#);
    }
}
