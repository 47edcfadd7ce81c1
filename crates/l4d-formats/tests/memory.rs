//! However a file is mutated: no panic, and memory in proportion to it. Its own program, since it counts what the whole
//! process allocates. `PROPTEST_CASES` (256 unless set) scales the number of mutations.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use l4d_formats::ply::Ply;
use l4d_formats::{Fault, arrays, npy, pickle, python, zip};
use peak_alloc::PeakAlloc;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

/// Bytes that `work` needs beyond what there was.
fn peak(work: impl FnOnce()) -> usize {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    work();
    MEMORY.peak_usage().saturating_sub(before)
}

/// Texts that make headers, JSON and counts absurd.
const SPLICES: [&[u8]; 12] = [
    b"18446744073709551615",
    b"9999999999",
    b"-1",
    b"1e308",
    b"nan",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"\0\0\0\0",
    b"[[[[[[[[[[[[[[[[",
    b"\nelement vertex 4000000000\n",
    b"PK\x05\x06",
    b"PK\x01\x02",
];

#[derive(Debug, Clone)]
enum Change {
    Byte(prop::sample::Index, u8),
    Insert(prop::sample::Index, usize),
    Overwrite(prop::sample::Index, usize),
    Remove(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
    Cut(prop::sample::Index),
}

fn change() -> impl Strategy<Value = Change> {
    let place = any::<prop::sample::Index>;
    prop_oneof![
        6 => (place(), any::<u8>()).prop_map(|(place, byte)| Change::Byte(place, byte)),
        3 => (place(), 0..SPLICES.len()).prop_map(|(place, splice)| Change::Insert(place, splice)),
        3 => (place(), 0..SPLICES.len()).prop_map(|(place, splice)| Change::Overwrite(place, splice)),
        1 => (place(), 1_usize..40).prop_map(|(place, count)| Change::Remove(place, count)),
        1 => (place(), 1_usize..40).prop_map(|(place, count)| Change::Repeat(place, count)),
        1 => place().prop_map(Change::Cut),
    ]
}

fn mutated(original: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for change in changes {
        let length = bytes.len();
        let span = |at: usize, count: usize| at.min(length)..(at + count).min(length);
        let at = |place: prop::sample::Index| place.index(length.max(1));
        match *change {
            Change::Byte(place, byte) => bytes[span(at(place), 1)].fill(byte),
            Change::Insert(place, splice) => {
                bytes.splice(span(at(place), 0), SPLICES[splice].iter().copied());
            }
            Change::Overwrite(place, splice) => {
                bytes.splice(span(at(place), SPLICES[splice].len()), SPLICES[splice].iter().copied());
            }
            Change::Remove(place, count) => drop(bytes.drain(span(at(place), count))),
            Change::Repeat(place, count) => {
                let span = span(at(place), count);
                let again = bytes[span.clone()].to_vec();
                bytes.splice(span.start..span.start, again);
            }
            Change::Cut(place) => bytes.truncate(at(place)),
        }
    }
    bytes
}

/// Feeds mutations of `original` to `read`, which may need `factor` times their length and 256 KiB.
fn storm(name: &str, original: &[u8], cases: u32, factor: usize, read: impl Fn(&[u8])) {
    let cases = cases * Config::default().cases / 256;
    let mut runner = TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() });
    let outcome = runner.run(&prop::collection::vec(change(), 0..5), |changes| {
        let bytes = mutated(original, &changes);
        let needed = peak(|| read(&bytes));
        let bound = factor * bytes.len() + (1 << 18);
        prop_assert!(needed <= bound, "{name}: {needed} bytes for a file of {}", bytes.len());
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{name}: {error}");
    }
}

/// All numbers of the last element.
fn rows(bytes: &[u8]) -> Result<Vec<f32>, Fault> {
    let file = Ply::open(Cursor::new(bytes))?;
    let Some(element) = file.elements().last().cloned() else { return Ok(Vec::new()) };
    let names: Vec<String> = element.properties.into_iter().map(|property| property.name).collect();
    let mut numbers = Vec::new();
    file.rows(&element.name, &names, "", |_, row| {
        numbers.extend_from_slice(row);
        Ok(())
    })?;
    Ok(numbers)
}

/// Programs that make the most of every byte: a node each, or a value from two bytes again and again.
fn greedy_pickles() -> [Vec<u8>; 4] {
    let many = |opcodes: &[u8]| opcodes.repeat((1 << 19) / opcodes.len());
    [
        [b"\x80\x02(", many(b"N").as_slice(), b"t."].concat(),
        [b"\x80\x02(", many(b"]q\0").as_slice(), b"t."].concat(),
        [b"\x80\x02](", many(b"K\x01").as_slice(), b"e."].concat(),
        [b"\x80\x02Nq\0(", many(b"h\0").as_slice(), b"t."].concat(),
    ]
}

#[test]
fn no_mutation_panics_or_allocates_out_of_proportion() {
    assert!(peak(|| drop(std::hint::black_box(vec![0_u8; 1 << 20]))) >= 1 << 20, "the measure measures");
    let bytes = |name: &str| fs::read(fixture(name)).unwrap();
    for name in ["degree1_ascii_double", "degree0_big_endian", "degree2_backwards_crlf"] {
        storm(name, &bytes(&format!("ply/{name}.ply")), 1500, 16, |bytes| drop(rows(bytes)));
    }
    storm("cfg_args", &bytes("cfg_args.txt"), 3000, 64, |bytes| {
        drop(python::namespace(&String::from_utf8_lossy(bytes)));
    });
    let array = npy::encode_f64(&[3, 4], &[0.5; 12]);
    storm("npy", &array, 1500, 64, |bytes| drop(npy::decode::<f32>(bytes)));
    let archive_of_arrays = arrays::encode_npz("a.npz".as_ref(), &[("a", array)]).unwrap();
    storm("npz", &archive_of_arrays, 1500, 64, |bytes| drop(arrays::from_npz(bytes, Some("a"))));
    for name in ["types", "chkpnt", "bools"] {
        storm(name, &bytes(&format!("pth/{name}.pth")), 3000, 64, |bytes| drop(pickle::decode(bytes)));
    }
    for pickle in greedy_pickles() {
        let file = zip::encode([("x/data.pkl", pickle.as_slice())]).unwrap();
        let needed = peak(|| drop(pickle::decode(&file)));
        assert!(needed < 200 * file.len(), "{needed} bytes for a file of {}", file.len());
    }
}
