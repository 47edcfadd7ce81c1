//! The positional encodings gamma: numbers, their sines and cosines at doubling frequencies (SA4D, without a factor of
//! pi; places as they are, in metres; times from 0 to 1).

/// Frequencies of a coordinate.
const PLACE_FREQUENCIES: usize = 10;
/// Frequencies of a time.
const TIME_FREQUENCIES: usize = 4;

/// Numbers of an encoded place: x, y, z, then all sines, then all cosines, coordinate by coordinate.
pub(super) const PLACE: usize = 3 + 2 * 3 * PLACE_FREQUENCIES;
/// Numbers of an encoded time.
pub(super) const TIME: usize = 1 + 2 * TIME_FREQUENCIES;

/// Encoded places, which stay the same at all times.
#[derive(Debug)]
pub(super) struct Places(Vec<[f32; PLACE]>);

impl Places {
    pub(super) fn new(means: &[[f32; 3]]) -> Self {
        Self(means.iter().map(|mean| encode(mean, PLACE_FREQUENCIES)).collect())
    }

    /// Those of some Gaussians, one after the other.
    pub(super) fn of(&self, rows: &[u32], into: &mut Vec<f32>) {
        into.clear();
        for &row in rows {
            into.extend_from_slice(&self.0[row as usize]);
        }
    }
}

/// An encoded time.
pub(super) fn time(time: f32) -> [f32; TIME] {
    encode(&[time], TIME_FREQUENCIES)
}

fn encode<const N: usize>(numbers: &[f32], frequencies: usize) -> [f32; N] {
    let mut encoded = [0.0; N];
    let count = numbers.len();
    encoded[..count].copy_from_slice(numbers);
    let angles =
        numbers.iter().flat_map(|&number| (0..frequencies).map(move |power| number * (1 << power) as f32));
    let (sines, cosines) = encoded[count..].split_at_mut(count * frequencies);
    for ((angle, sine), cosine) in angles.zip(sines).zip(cosines) {
        // In f64: an angle of thousands has few digits left in f32, but they are the same for everybody.
        let angle = f64::from(angle);
        (*sine, *cosine) = (angle.sin() as f32, angle.cos() as f32);
    }
    encoded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_double_coordinate_by_coordinate() {
        let encoded = time(0.25);
        assert_eq!(encoded[0], 0.25);
        for (power, angle) in [0.25_f32, 0.5, 1.0, 2.0].into_iter().enumerate() {
            assert!((encoded[1 + power] - angle.sin()).abs() < 1e-6);
            assert!((encoded[5 + power] - angle.cos()).abs() < 1e-6);
        }
        let mut place = Vec::new();
        Places::new(&[[9.0; 3], [0.5, -1.0, 2.0]]).of(&[1], &mut place);
        assert_eq!((place.len(), &place[..3]), (63, &[0.5, -1.0, 2.0][..]));
        // The third frequency of y, and the first cosine of z.
        assert!((place[3 + 10 + 2] - (-4.0_f32).sin()).abs() < 1e-6);
        assert!((place[33 + 20] - 2.0_f32.cos()).abs() < 1e-6);
    }
}
