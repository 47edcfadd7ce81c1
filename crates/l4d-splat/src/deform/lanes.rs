//! A few channels at a time, in a form that compilers turn into vector code.

/// Channels that are handled together.
pub(super) const LANES: usize = 8;

/// Numbers of so many channels.
pub(super) type Lanes = [f32; LANES];

/// The first channels of a list, zeros where it is shorter.
#[inline(always)]
pub(super) fn load(values: &[f32]) -> Lanes {
    match values.first_chunk() {
        Some(lanes) => *lanes,
        None => load_part(values),
    }
}

/// Apart, so that the common case stays a single vector instruction.
#[cold]
fn load_part(values: &[f32]) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (lane, value) in lanes.iter_mut().zip(values) {
        *lane = *value;
    }
    lanes
}

pub(super) fn times(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

pub(super) fn minus(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] - b[lane])
}

/// `a` where the fraction is 0, `b` where it is 1.
pub(super) fn lerp(a: Lanes, b: Lanes, fraction: f32) -> Lanes {
    std::array::from_fn(|lane| a[lane] + (b[lane] - a[lane]) * fraction)
}

pub(super) fn add_scaled(into: &mut Lanes, values: Lanes, scale: f32) {
    for (into, value) in into.iter_mut().zip(values) {
        *into += scale * value;
    }
}

pub(super) fn sum([a, b, c, d, e, f, g, h]: Lanes) -> f32 {
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}
