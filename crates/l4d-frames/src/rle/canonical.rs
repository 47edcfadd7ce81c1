//! Run lengths eight characters at a time: the fast path of [`super::decode_runs`].
//!
//! It reads what encoders write, canonical text: every run but the first has a pixel, and the runs end where the mask
//! does. All else, damage included, it leaves to the reference, which goes character by character and says what is wrong.

use super::{LONGEST, ZERO};

/// Numbers that a window of eight characters nearly always holds.
const USUAL: usize = 4;

/// Puts in `edges` where the runs of canonical text start and end in turn, the first outside left out. Gives false for
/// other text, and then `edges` means nothing.
pub(super) fn read_edges(counts: &str, pixels: u32, edges: &mut Vec<u32>) -> bool {
    let text = counts.as_bytes();
    edges.clear();
    // Without an early end, so that it goes sixteen at a time.
    let is_sound = text.iter().fold(true, |sound, byte| sound & (byte.wrapping_sub(ZERO) < 64));
    // No more runs than pixels, but for an empty one at first: longer text need not be looked at.
    let most = pixels as usize + 1;
    if !is_sound || text.len() > LONGEST * most {
        return false;
    }
    // Numbers of one character each.
    edges.reserve(text.len().min(most));
    let mut sums = Sums { edges, end: 0, last: 0, before: 0, soundness: 0 };
    let mut offset = 0;
    while offset < text.len() {
        let window = Window::at(text, offset);
        let count = window.cuts.count();
        if count == 0 || window.cuts.used[0] as usize > LONGEST {
            return false;
        }
        // A fixed count of steps is one that a processor need not guess.
        let count = if count < USUAL {
            (0..count).for_each(|index| sums.push(window.number(index)));
            count
        } else {
            (0..USUAL).for_each(|index| sums.push(window.number(index)));
            USUAL
        };
        offset += usize::from(window.cuts.used[count - 1]);
    }
    sums.finish(pixels)
}

/// Eight characters of sound text.
struct Window {
    /// Five bits a character, the first lowest.
    bits: u64,
    /// The numbers that end in them.
    cuts: &'static Cuts,
}

impl Window {
    fn at(text: &[u8], offset: usize) -> Self {
        const GOES_ON: u64 = u64::from_le_bytes([0x20; 8]);
        let window = text[offset..].first_chunk().copied().unwrap_or_else(|| {
            // Past the end numbers go on: none seems to stop there.
            let mut window = [ZERO + 0x20; 8];
            window[..text.len() - offset].copy_from_slice(&text[offset..]);
            window
        });
        let groups = u64::from_le_bytes(window).wrapping_sub(u64::from_le_bytes([ZERO; 8]));
        let stops = (!groups & GOES_ON) >> 5;
        // The lowest bits of all bytes, side by side.
        let stops = stops.wrapping_mul(0x0102_0408_1020_4080) >> 56;
        Self { bits: packed(groups), cuts: &CUTS[stops as usize] }
    }

    fn number(&self, index: usize) -> i64 {
        // Its last bit is the sign.
        (self.bits << self.cuts.left[index]) as i64 >> self.cuts.right[index]
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
struct Cuts {
    /// Shifts to the left that leave a number at the top of a word, and back to the right.
    left: [u8; 8],
    right: [u8; 8],
    /// Characters up to the end of each number; 0 where there is none.
    used: [u8; 8],
    count: u8,
}

impl Cuts {
    fn count(&self) -> usize {
        self.count.into()
    }
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
        while used <= 8 {
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

/// Sums up run lengths.
struct Sums<'a> {
    edges: &'a mut Vec<u32>,
    end: i64,
    /// The length of the last run and of the one before, which the next is a difference to; zero for the first run,
    /// from which none is counted.
    last: i64,
    before: i64,
    /// Negative once a run was empty or less.
    soundness: i64,
}

impl Sums<'_> {
    fn push(&mut self, number: i64) {
        let is_first = self.edges.is_empty();
        // Sums of numbers of 35 bits, as many as fit a file: far from overflow.
        let length = number + self.before;
        self.end += length;
        self.soundness |= length - i64::from(!is_first);
        self.before = self.last;
        self.last = if is_first { 0 } else { length };
        // What does not fit is no edge of a mask, and is thrown away at the end.
        self.edges.push(self.end as u32);
    }

    fn finish(self, pixels: u32) -> bool {
        if self.edges.len() % 2 == 1 {
            // Outside to the end.
            self.edges.pop();
        }
        self.soundness >= 0 && self.end == i64::from(pixels)
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
        // Empty runs, a number of eight characters, an end inside a number, another size.
        for (text, is_read) in
            [("2004", true), ("60", true), ("6P0", true), ("6PPPPPPP0", false), ("6P", false), ("5", false)]
        {
            assert_eq!(reference(text, 3, 2).is_ok(), is_read, "{text}");
            assert_eq!(decode_runs(text, 3, 2), reference(text, 3, 2), "{text}");
            assert_eq!(edges(text, 6), None, "{text}");
        }
        assert_eq!(edges("6", 6), Some(Vec::new()));
        assert_eq!(edges("06", 6), Some(vec![0, 6]));
        // More characters than a number needs, up to seven, are no other number.
        assert_eq!(edges("0VPPPPP0", 6), Some(vec![0, 6]));
    }
}
