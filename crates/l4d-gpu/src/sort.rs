//! Sums before each number, and stable sorting by keys: the two tools of ordering.

use wgpu::Buffer;

use crate::commands::{Commands, whole};
use crate::error::GpuError;
use crate::shaders::{BLOCK, DIGIT_BITS, Pass, RADIX};

/// Replaces each of the first `count` numbers by the sum of those before it. Sums stay at the largest u32 where they
/// would pass it.
pub(crate) fn scan(commands: &mut Commands<'_>, numbers: &Buffer, count: u32) -> Result<(), GpuError> {
    let blocks = count.div_ceil(BLOCK);
    let totals = commands.gpu.buffer("sums of blocks", 4 * u64::from(blocks))?;
    commands.run(Pass::Scan, blocks.into(), &[count, blocks], &[whole(numbers), whole(&totals)])?;
    if blocks > 1 {
        scan(commands, &totals, blocks)?;
        commands.run(Pass::ScanAdd, blocks.into(), &[count], &[whole(numbers), whole(&totals)])?;
    }
    Ok(())
}

/// Keys, and a value for each.
#[derive(Debug)]
pub(crate) struct Entries {
    pub(crate) keys: Buffer,
    pub(crate) values: Buffer,
}

impl Entries {
    pub(crate) fn new(commands: &Commands<'_>, what: &'static str, count: u32) -> Result<Self, GpuError> {
        let bytes = 4 * u64::from(count);
        Ok(Self { keys: commands.gpu.buffer(what, bytes)?, values: commands.gpu.buffer(what, bytes)? })
    }
}

/// Sorts by the lowest `bits` of the keys, least significant digits first; equal keys stay in order.
pub(crate) fn sort(
    commands: &mut Commands<'_>,
    entries: Entries,
    count: u32,
    bits: u32,
) -> Result<Entries, GpuError> {
    if count < 2 || bits == 0 {
        return Ok(entries);
    }
    let blocks = count.div_ceil(BLOCK);
    let histogram = commands.gpu.buffer("digits of blocks", 4 * u64::from(RADIX * blocks))?;
    let mut from = entries;
    let mut to = Entries::new(commands, "sorted keys", count)?;
    for shift in (0..bits).step_by(DIGIT_BITS as usize) {
        let part = &[count, shift, blocks];
        commands.run(Pass::SortCount, blocks.into(), part, &[whole(&from.keys), whole(&histogram)])?;
        scan(commands, &histogram, RADIX * blocks)?;
        commands.run(
            Pass::SortScatter,
            blocks.into(),
            part,
            &[whole(&from.keys), whole(&from.values), whole(&histogram), whole(&to.keys), whole(&to.values)],
        )?;
        std::mem::swap(&mut from, &mut to);
    }
    Ok(from)
}

/// Bits that the numbers up to `largest` have.
pub(crate) fn bits_of(largest: u32) -> u32 {
    u32::BITS - largest.leading_zeros()
}

#[cfg(test)]
mod tests {
    use std::sync::OnceLock;

    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::shaders::LANES;
    use crate::{AdapterChoice, Gpu};

    /// Around the size of a workgroup and of a block (1024); the last needs three levels of blocks.
    const SIZES: [u32; 11] = [0, 1, 2, 64, 1000, 1023, 1024, 1025, 5137, 40_000, 1_049_603];

    /// Without an adapter the tests fail, and say what to install.
    fn gpu() -> &'static Gpu {
        static GPU: OnceLock<Gpu> = OnceLock::new();
        GPU.get_or_init(|| Gpu::open(&AdapterChoice::Best).unwrap_or_else(|error| panic!("{error}")))
    }

    fn random_numbers(count: u32, seed: u64) -> Vec<u32> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count).map(|_| random.random_range(0..=u32::MAX)).collect()
    }

    fn scanned(numbers: &[u32]) -> Vec<u32> {
        let gpu = gpu();
        let buffer = gpu.filled("numbers", numbers).unwrap();
        let mut commands = gpu.commands();
        scan(&mut commands, &buffer, numbers.len() as u32).unwrap();
        let readback = commands.copy_out(&buffer, 0, 4 * numbers.len() as u64).unwrap();
        commands.submit();
        gpu.read_back(&readback).unwrap()
    }

    fn sums_before(numbers: &[u32]) -> Vec<u32> {
        let mut sum = 0_u32;
        let before = |&number: &u32| {
            let before = sum;
            sum = before.saturating_add(number);
            before
        };
        numbers.iter().map(before).collect()
    }

    #[test]
    fn scans_are_sums_of_what_comes_before() {
        for count in SIZES {
            let small: Vec<u32> = random_numbers(count, 1).iter().map(|number| number % 1000).collect();
            assert!(scanned(&small) == sums_before(&small), "{count}");
            let ones = vec![1; count as usize];
            assert!(scanned(&ones) == sums_before(&ones), "{count}");
        }
    }

    #[test]
    fn sums_that_do_not_fit_stay_at_the_largest_number() {
        for count in [3, BLOCK + 5, 20 * BLOCK] {
            let large = random_numbers(count, 2);
            let expected = sums_before(&large);
            assert_eq!(expected.last(), Some(&u32::MAX), "the test wants an overflow");
            assert!(scanned(&large) == expected, "{count}");
        }
        assert_eq!(scanned(&[u32::MAX, 1, u32::MAX, 7]), [0, u32::MAX, u32::MAX, u32::MAX]);
    }

    fn sorted(keys: &[u32], bits: u32) -> (Vec<u32>, Vec<u32>) {
        let gpu = gpu();
        let count = keys.len() as u32;
        let values: Vec<u32> = (0..count).collect();
        let mut commands = gpu.commands();
        let entries = Entries {
            keys: gpu.filled("keys", keys).unwrap(),
            values: gpu.filled("values", &values).unwrap(),
        };
        let sorted = sort(&mut commands, entries, count, bits).unwrap();
        let bytes = 4 * u64::from(count);
        let (keys, values) =
            (commands.copy_out(&sorted.keys, 0, bytes), commands.copy_out(&sorted.values, 0, bytes));
        commands.submit();
        (gpu.read_back(&keys.unwrap()).unwrap(), gpu.read_back(&values.unwrap()).unwrap())
    }

    fn check(keys: &[u32], bits: u32, name: &str) {
        let mask = if bits == 32 { u32::MAX } else { (1 << bits) - 1 };
        let mut expected: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
        expected.sort_by_key(|&(key, _)| key & mask);
        let expected: (Vec<u32>, Vec<u32>) = expected.into_iter().unzip();
        assert!(sorted(keys, bits) == expected, "{name}: {} keys, {bits} bits", keys.len());
    }

    #[test]
    fn sorting_random_keys_is_that_of_the_standard_library() {
        for count in SIZES {
            check(&random_numbers(count, 3), 32, "random");
        }
    }

    #[test]
    fn sorting_is_stable_whatever_the_keys_are_like() {
        let count = 3 * BLOCK + 29;
        let all: Vec<u32> = (0..count).collect();
        let with = |key: fn(u32) -> u32| all.iter().map(|&i| key(i)).collect::<Vec<u32>>();
        check(&with(|_| 0), 32, "all zero");
        check(&with(|_| u32::MAX), 32, "all the largest");
        check(&with(|i| i), 32, "sorted");
        check(&with(|i| u32::MAX - i), 32, "reversed");
        check(&with(|i| i % 2), 1, "two values, one bit");
        check(&with(|i| i % 7), 3, "seven values");
        check(&with(|i| (i % 16) << 28), 32, "only the highest digit differs");
        check(&with(|i| if i == 1500 { 0 } else { 5 }), 32, "one that differs");
        check(&with(|i| i.rotate_right(4)), 32, "many digits, few keys a digit");
        check(&with(|i| (0.2 + (i % 50) as f32 * 0.1).to_bits()), 31, "depths");
        check(&with(|i| i.wrapping_mul(0x9e37_79b9)), 12, "higher bits that don't count");
        check(&with(|i| i / LANES % 16), 4, "runs as long as a lane's");
    }

    #[test]
    fn bits_are_those_of_the_largest_number() {
        assert_eq!([0, 1, 2, 255, 256, u32::MAX].map(bits_of), [0, 1, 2, 8, 9, 32]);
    }
}
