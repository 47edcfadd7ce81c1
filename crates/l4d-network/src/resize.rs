//! Pictures at another size, averaged where they shrink and interpolated where they grow.

/// One channel-last picture at another size; `channels` values a pixel.
pub(crate) fn resized(
    from: &[f32],
    [width, height]: [usize; 2],
    [to_width, to_height]: [usize; 2],
    channels: usize,
) -> Vec<f32> {
    if [width, height] == [to_width, to_height] {
        return from.to_vec();
    }
    let columns = weights(width, to_width);
    let rows = weights(height, to_height);
    let mut wide = vec![0.0; to_width * height * channels];
    for row in 0..height {
        for (column, taps) in columns.iter().enumerate() {
            for &(source, weight) in taps {
                for channel in 0..channels {
                    wide[(row * to_width + column) * channels + channel] +=
                        weight * from[(row * width + source) * channels + channel];
                }
            }
        }
    }
    let mut small = vec![0.0; to_width * to_height * channels];
    let line = to_width * channels;
    for (row, taps) in rows.iter().enumerate() {
        for &(source, weight) in taps {
            let (into, out_of) = (&mut small[row * line..][..line], &wide[source * line..][..line]);
            into.iter_mut().zip(out_of).for_each(|(into, value)| *into += weight * value);
        }
    }
    small
}

/// For each target pixel the sources and their shares: a triangle as wide as the larger of both pixels.
fn weights(from: usize, to: usize) -> Vec<Vec<(usize, f32)>> {
    let scale = from as f32 / to as f32;
    let reach = scale.max(1.0);
    let of_target = |target: usize| {
        let middle = (target as f32 + 0.5) * scale - 0.5;
        let first = (middle - reach).ceil().max(0.0) as usize;
        let last = ((middle + reach).floor() as usize).min(from - 1);
        let share = |source: usize| (1.0 - (source as f32 - middle).abs() / reach).max(0.0);
        let total: f32 = (first..=last).map(share).sum();
        (first..=last).map(|source| (source, share(source) / total)).filter(|tap| tap.1 > 0.0).collect()
    };
    (0..to).map(of_target).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_pictures_stay_even_and_means_are_kept() {
        let even = vec![0.25; 9 * 7];
        assert!(resized(&even, [9, 7], [20, 3], 1).iter().all(|value| (value - 0.25).abs() < 1e-6));
        let ramp: Vec<f32> = (0..64).map(|index| index as f32).collect();
        let small = resized(&ramp, [64, 1], [16, 1], 1);
        let mean = small.iter().sum::<f32>() / 16.0;
        assert!((mean - 31.5).abs() < 0.2, "{mean}");
        assert!(small.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
