//! Powers of two for eight numbers at once.

use fearless_simd::{f32x8, i32x8, prelude::*};

/// 1.5 * 2^23: added to a small number it leaves the nearest integer in the low bits.
const ROUNDER: f32 = 12_582_912.0;
/// 2^-126 is the smallest normal number.
const FARTHEST: f32 = 126.0;

/// 2^f for |f| <= 1/2, lowest power first: exact at 0, elsewhere the relative error is at most 9.2e-8, minimax.
#[expect(
    clippy::approx_constant,
    reason = "the best polynomial of this degree has almost the terms of the series"
)]
const POLYNOMIAL: [f32; 6] = [1.0, 0.693_147, 0.240_222_42, 0.055_507_34, 0.009_671_518, 0.001_326_473_5];

/// 2^-x for x >= -64, with a relative error below 3e-7; x above 126 counts as 126.
#[inline(always)]
pub(super) fn exp2_negative<S: Simd>(simd: S, x: f32x8<S>) -> f32x8<S> {
    let x = x.min(FARTHEST);
    let rounder = f32x8::splat(simd, ROUNDER);
    let shifted = rounder - x;
    let fraction = (rounder - shifted) - x;
    let coefficient = |power: usize| f32x8::splat(simd, POLYNOMIAL[power]);
    let mut power = coefficient(5);
    for lower in [4, 3, 2, 1, 0] {
        power = power.mul_add(fraction, coefficient(lower));
    }
    let exponent: i32x8<S> = shifted.bitcast::<i32x8<S>>() << 23;
    (power.bitcast::<i32x8<S>>() + exponent).bitcast()
}

#[cfg(test)]
mod tests {
    use super::super::{Cpu, Kernel};
    use super::*;

    struct Exponentials<'a>(&'a mut [[f32; 8]]);

    impl Kernel for Exponentials<'_> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            for values in self.0 {
                exp2_negative(simd, f32x8::load_array_ref(simd, values)).store_array(values);
            }
        }
    }

    #[test]
    fn the_error_is_below_the_stated_bound() {
        // Everywhere, and densely where alphas above 1/255 come from.
        let mut inputs: Vec<f32> = (0..2_000_000).map(|i| i as f32 * 5e-6 - 1.0).collect();
        inputs.extend((0..1_000_000).map(|i| i as f32 * 1.26e-4));
        for cpu in [Cpu::new(), Cpu::portable()] {
            let mut values = inputs.clone();
            cpu.run(Exponentials(values.as_chunks_mut().0));
            let mut worst = 0.0_f64;
            for (&x, &value) in inputs.iter().zip(&values) {
                worst = worst.max((f64::from(value) / (-f64::from(x)).exp2() - 1.0).abs());
            }
            println!("{cpu:?}: relative error at most {worst:.2e}");
            assert!(worst < 3e-7, "{worst:e}");
        }
    }

    #[test]
    fn far_away_it_stays_positive_and_tiny() {
        let mut values = [[126.0, 127.0, 1e3, 1e30, f32::INFINITY, 0.0, 1.0, -10.0]];
        Cpu::new().run(Exponentials(&mut values));
        assert!(values[0][..5].iter().all(|&value| value == values[0][0] && value > 0.0 && value < 2e-38));
        assert_eq!(values[0][7], 1024.0 * values[0][5]);
    }
}
