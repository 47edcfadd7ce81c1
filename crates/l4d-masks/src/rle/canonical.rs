//! Run lengths eight characters at a time: the fast path of [`super::decode_runs`].
//!
//! It reads what encoders write, canonical text: every run but the first has a pixel, and the runs end where the mask
//! does. All else, damage included, it leaves to the reference, which goes character by character and says what is wrong.

use super::ZERO;

/// Numbers that a window of eight characters nearly always holds.
const USUAL: usize = 4;
/// Characters of the longest number that is read here: 30 bits, more than any run of a sane mask needs.
const LONGEST: u8 = 6;

/// Puts in `edges` where the runs of canonical text start and end in turn, the first outside left out. Gives false for
/// other text, and then `edges` means nothing. `pixels` are those of a mask of sane size.
pub(super) fn read_edges(counts: &str, pixels: u32, edges: &mut Vec<u32>) -> bool {
    let text = counts.as_bytes();
    edges.clear();
    // Without an early end, so that it goes sixteen at a time.
    let is_sound = text.iter().fold(0, |bits, byte| bits | byte.wrapping_sub(ZERO)) < 64;
    // No more runs than pixels, but for an empty one at first: longer text need not be looked at.
    let most = pixels as usize + 1;
    if !is_sound || text.len() > usize::from(LONGEST) * most {
        return false;
    }
    // Numbers of one character each.
    edges.reserve(text.len().min(most));
    let Some((mut sums, mut offset)) = Sums::start(&Window::at(text, 0), edges) else { return false };
    while let Some(stretch) = text[offset..].first_chunk() {
        // Where numbers end is known before it is known where they begin: one window need not wait for the one before.
        let mut stops = stops_of(stretch);
        let mut read = 0;
        while let Some(&window) = stretch[read..].first_chunk() {
            let Some(used) = sums.take(&Window::new(window, stops as u8)) else { return false };
            stops >>= used;
            read += used;
        }
        offset += read;
    }
    while offset < text.len() {
        let Some(used) = sums.take(&Window::at(text, offset)) else { return false };
        offset += used;
    }
    sums.finish(pixels)
}

/// Which of 64 characters end a number: bit 0 for the first.
fn stops_of(text: &[u8; 64]) -> u64 {
    let of_window = |(index, window): (usize, &[u8; 8])| u64::from(stops_of_window(*window)) << (8 * index);
    text.as_chunks().0.iter().enumerate().map(of_window).fold(0, |stops, window| stops | window)
}

fn stops_of_window(window: [u8; 8]) -> u8 {
    const GOES_ON: u64 = u64::from_le_bytes([0x20; 8]);
    let stops = (!groups(window) & GOES_ON) >> 5;
    // The lowest bits of all bytes, side by side.
    (stops.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
}

/// The values of eight characters, the first lowest.
fn groups(window: [u8; 8]) -> u64 {
    u64::from_le_bytes(window).wrapping_sub(u64::from_le_bytes([ZERO; 8]))
}

/// Eight characters of sound text.
struct Window {
    /// Five bits a character, the first lowest.
    bits: u64,
    /// The numbers that end in them.
    cuts: &'static Cuts,
}

impl Window {
    fn new(window: [u8; 8], stops: u8) -> Self {
        Self { bits: packed(groups(window)), cuts: &CUTS[usize::from(stops)] }
    }

    fn at(text: &[u8], offset: usize) -> Self {
        let window = text[offset..].first_chunk().copied().unwrap_or_else(|| {
            // Past the end numbers go on: none seems to stop there.
            let mut window = [ZERO + 0x20; 8];
            window[..text.len() - offset].copy_from_slice(&text[offset..]);
            window
        });
        Self::new(window, stops_of_window(window))
    }

    fn number(&self, index: usize) -> i32 {
        // Its last bit is the sign.
        ((self.bits << self.cuts.left[index]) as i64 >> self.cuts.right[index]) as i32
    }
}

/// The low five bits of every byte, side by side.
fn packed(bytes: u64) -> u64 {
    let pairs = bytes & 0x001f_001f_001f_001f | bytes >> 3 & 0x03e0_03e0_03e0_03e0;
    let fours = pairs & 0x0000_03ff_0000_03ff | pairs >> 6 & 0x000f_fc00_000f_fc00;
    fours & 0xf_ffff | fours >> 12 & 0xff_fff0_0000
}

/// How to cut the packed bits of a window into numbers.
#[derive(Clone, Copy)]
// A power of two, so that finding one takes a shift.
#[repr(align(32))]
struct Cuts {
    /// Shifts to the left that leave a number at the top of a word, and back to the right.
    left: [u8; 8],
    right: [u8; 8],
    /// Characters up to the end of each number; 0 where there is none.
    used: [u8; 8],
    /// None from the first that is too long.
    count: u8,
}

/// Of all windows, by which characters end a number: bit 0 for the first.
static CUTS: [Cuts; 256] = cuts();

const fn cuts() -> [Cuts; 256] {
    let mut all = [Cuts { left: [0; 8], right: [0; 8], used: [0; 8], count: 0 }; 256];
    let mut stops = 0;
    while stops < all.len() {
        let cuts = &mut all[stops];
        let mut read = 0;
        let mut used = 1;
        while used <= 8 && used - read <= LONGEST {
            if stops >> (used - 1) & 1 == 1 {
                let number = cuts.count as usize;
                cuts.left[number] = 64 - 5 * used;
                cuts.right[number] = 64 - 5 * (used - read);
                cuts.used[number] = used;
                cuts.count += 1;
                read = used;
            }
            used += 1;
        }
        stops += 1;
    }
    all
}

/// Sums up run lengths, modulo 2^32. Nothing is lost by that: if the ends ascend to the pixels of a mask, every length
/// lies between none and all of them. It is a number of 30 bits more than such a length, and no other sum of the two
/// leaves the same remainder.
struct Sums<'a> {
    edges: &'a mut Vec<u32>,
    end: i32,
    /// The length of the last run and of the one before, which the next is a difference to; zero for the first run,
    /// from which none is counted.
    last: i32,
    before: i32,
}

impl<'a> Sums<'a> {
    /// Takes the first number, and gives how many characters it has.
    fn start(window: &Window, edges: &'a mut Vec<u32>) -> Option<(Self, usize)> {
        let first = (window.cuts.count > 0).then(|| window.number(0))?;
        edges.push(first as u32);
        Some((Self { edges, end: first, last: 0, before: 0 }, window.cuts.used[0].into()))
    }

    /// Takes numbers from a window, and gives how many characters they have; none if the first is too long.
    #[inline(always)]
    fn take(&mut self, window: &Window) -> Option<usize> {
        let count = usize::from(window.cuts.count);
        if count >= USUAL {
            // A fixed count of steps is one that a processor need not guess.
            let ends: [u32; USUAL] = std::array::from_fn(|index| self.add(window.number(index)));
            self.edges.extend_from_slice(&ends);
            return Some(window.cuts.used[USUAL - 1].into());
        }
        let last = count.checked_sub(1)?;
        for index in 0..count {
            let end = self.add(window.number(index));
            self.edges.push(end);
        }
        Some(window.cuts.used[last].into())
    }

    fn add(&mut self, number: i32) -> u32 {
        let length = number.wrapping_add(self.before);
        self.end = self.end.wrapping_add(length);
        self.before = self.last;
        self.last = length;
        self.end as u32
    }

    fn finish(self, pixels: u32) -> bool {
        let begins = self.edges[0] as i32 >= 0;
        let steps = self.edges.iter().zip(&self.edges[1..]);
        let ascends = steps.fold(true, |ascends, (&one, &next)| ascends & ((one as i32) < next as i32));
        if self.edges.len() % 2 == 1 {
            // Outside to the end.
            self.edges.pop();
        }
        begins && ascends && self.end as u32 == pixels
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{RleError, decode_runs, encode, push_number, read_runs};
    use super::*;
    use crate::mask::Mask;
    use crate::runs::Runs;

    fn edges(text: &str, pixels: u32) -> Option<Vec<u32>> {
        // What stood there before plays no part.
        let mut edges = vec![7; 9];
        read_edges(text, pixels, &mut edges).then_some(edges)
    }

    fn reference(text: &str, width: u32, height: u32) -> Result<Runs, RleError> {
        let mut runs = Runs::new(width, height);
        read_runs(text, &mut runs).map(|()| runs)
    }

    /// Text of run lengths as encoders write it, whatever the lengths are.
    fn written(lengths: &[i64]) -> String {
        let mut text = String::new();
        for (run, &length) in lengths.iter().enumerate() {
            push_number(&mut text, if run > 2 { length - lengths[run - 2] } else { length });
        }
        text
    }

    /// Runs that are short, long, empty, or no lengths at all.
    fn lengths() -> impl Strategy<Value = Vec<i64>> {
        let length = prop_oneof![8 => 1..20_i64, 4 => 20..900_i64, 1 => Just(0_i64), 1 => -3..0_i64];
        prop_oneof![
            4 => proptest::collection::vec(prop_oneof![4 => 1..20_i64, 1 => 20..900_i64], 0..40),
            2 => proptest::collection::vec(length, 0..40),
            1 => proptest::collection::vec(-(1_i64 << 42)..1 << 42, 0..9),
        ]
    }

    /// What happens to a text: characters are put in the place of others, added or lost.
    fn damage() -> impl Strategy<Value = Vec<(usize, u8, u8)>> {
        prop_oneof![2 => Just(Vec::new()), 1 => proptest::collection::vec((any::<usize>(), 0..3_u8, 40..120_u8), 1..4)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn any_text_is_read_as_the_reference_reads_it(
            lengths in lengths(), damage in damage(), off_by in prop_oneof![4 => Just(0_i64), 1 => -2..3_i64],
        ) {
            let mut text = written(&lengths).into_bytes();
            for (place, kind, byte) in damage {
                let place = place % (text.len() + 1);
                match kind {
                    0 => text.insert(place, byte),
                    1 if place < text.len() => text[place] = byte,
                    _ if place < text.len() => drop(text.remove(place)),
                    _ => {}
                }
            }
            let text = String::from_utf8(text).unwrap();
            let total: i64 = lengths.iter().sum();
            let pixels = (total + off_by).clamp(1, i64::from(Mask::MAX_SIDE)) as u32;
            let reference = reference(&text, pixels, 1);
            if let Some(edges) = edges(&text, pixels) {
                let expected = reference.as_ref().map(|runs| runs.runs().as_flattened());
                prop_assert_eq!(Ok(edges.as_slice()), expected);
            }
            prop_assert_eq!(decode_runs(&text, pixels, 1), reference);
        }

        #[test]
        fn text_of_encoders_is_canonical(lengths in proptest::collection::vec(1..300_i64, 1..27), is_inside in any::<bool>()) {
            let lengths: Vec<i64> = is_inside.then_some(0).into_iter().chain(lengths).collect();
            let pixels = lengths.iter().sum::<i64>() as u32;
            let expected: Vec<u32> = lengths.iter().scan(0, |end, length| { *end += length; Some(*end as u32) }).collect();
            let found = edges(&written(&lengths), pixels).unwrap();
            prop_assert_eq!(&found, &expected[..lengths.len() / 2 * 2]);
        }

        #[test]
        fn text_of_masks_is_canonical(
            (width, height, pixels) in (1..70_u32, 1..70_u32).prop_flat_map(|(width, height)| {
                (Just(width), Just(height), proptest::collection::vec(any::<bool>(), (width * height) as usize))
            })
        ) {
            let text = encode(&Mask::from_bools(width, height, &pixels).unwrap());
            let expected = reference(&text, width, height).unwrap();
            let found = edges(&text, width * height);
            prop_assert_eq!(found.as_deref(), Some(expected.runs().as_flattened()));
        }
    }

    #[test]
    fn what_is_not_canonical_is_left_to_the_reference() {
        // Empty runs, numbers of eight and seven characters, an end inside a number, another size, a run below zero.
        for (text, is_read) in [
            ("2004", true),
            ("60", true),
            ("6P0", true),
            ("6PPPPPPP0", false),
            ("0VPPPPPP0", false),
            ("0VPPPPP0", true),
            ("VPPPPP0", true),
            ("6P", false),
            ("5", false),
            ("O7", false),
        ] {
            assert_eq!(reference(text, 3, 2).is_ok(), is_read, "{text}");
            assert_eq!(decode_runs(text, 3, 2), reference(text, 3, 2), "{text}");
            assert_eq!(edges(text, 6), None, "{text}");
        }
        assert_eq!(edges("6", 6), Some(Vec::new()));
        assert_eq!(edges("06", 6), Some(vec![0, 6]));
        // More characters than a number needs, up to six, are no other number.
        assert_eq!(edges("0VPPPP0", 6), Some(vec![0, 6]));
    }
}
