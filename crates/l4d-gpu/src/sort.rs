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

    #[test]
    fn scans_are_sums_of_what_comes_before_and_stay_at_the_largest_number() {
        let check = |numbers: &[u32]| {
            let mut sum = 0_u32;
            let mut expected = vec![0];
            expected.extend(numbers.iter().map(|&number| {
                sum = sum.saturating_add(number);
                sum
            }));
            expected.truncate(numbers.len());
            assert!(scanned(numbers) == expected, "{} numbers", numbers.len());
            expected.last().copied()
        };
        for count in SIZES {
            check(&random_numbers(count, 1).iter().map(|number| number % 1000).collect::<Vec<_>>());
        }
        for count in [3, BLOCK + 5, 20 * BLOCK] {
            assert_eq!(check(&random_numbers(count, 2)), Some(u32::MAX), "the test wants an overflow");
        }
        check(&[u32::MAX, 1, u32::MAX, 7]);
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
        let [keys, values] =
            [&sorted.keys, &sorted.values].map(|list| commands.copy_out(list, 0, bytes).unwrap());
        commands.submit();
        (gpu.read_back(&keys).unwrap(), gpu.read_back(&values).unwrap())
    }

    fn check(keys: &[u32], bits: u32, name: &str) {
        let mask = if bits == 32 { u32::MAX } else { (1 << bits) - 1 };
        let mut expected: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
        expected.sort_by_key(|&(key, _)| key & mask);
        let expected: (Vec<u32>, Vec<u32>) = expected.into_iter().unzip();
        assert!(sorted(keys, bits) == expected, "{name}: {} keys, {bits} bits", keys.len());
    }

    #[test]
    fn sorting_is_stable_whatever_the_keys_are_like() {
        let count = 3 * BLOCK + 29;
        type Key = fn(u32) -> u32;
        let keys: [(&str, u32, Key); 12] = [
            ("all zero", 32, |_| 0),
            ("all the largest", 32, |_| u32::MAX),
            ("sorted", 32, |i| i),
            ("reversed", 32, |i| u32::MAX - i),
            ("two values, one bit", 1, |i| i % 2),
            ("seven values", 3, |i| i % 7),
            ("only the highest digit differs", 32, |i| (i % 16) << 28),
            ("one that differs", 32, |i| if i == 1500 { 0 } else { 5 }),
            ("many digits, few keys a digit", 32, |i| i.rotate_right(4)),
            ("depths", 31, |i| (0.2 + (i % 50) as f32 * 0.1).to_bits()),
            ("higher bits that don't count", 12, |i| i.wrapping_mul(0x9e37_79b9)),
            ("runs as long as a lane's", 4, |i| i / LANES % 16),
        ];
        for (name, bits, key) in keys {
            check(&(0..count).map(key).collect::<Vec<_>>(), bits, name);
        }
        for count in SIZES {
            check(&random_numbers(count, 3), 32, "random");
        }
    }

    #[test]
    fn bits_are_those_of_the_largest_number() {
        assert_eq!([0, 1, 2, 255, 256, u32::MAX].map(bits_of), [0, 1, 2, 8, 9, 32]);
    }
}
