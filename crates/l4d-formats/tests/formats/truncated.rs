//! Files that end too early, wherever they end.

use l4d_formats::{Fault, pickle, python};

use super::ply::rows;
use super::poison::zip;
use super::{bytes, entries};

/// Feeds every beginning of `whole` to `read`, which must refuse it with a place and a hint.
fn each_beginning<T: std::fmt::Debug>(name: &str, whole: &[u8], read: impl Fn(&[u8]) -> Result<T, Fault>) {
    read(whole).unwrap();
    for end in 0..whole.len() {
        let Err(fault) = read(&whole[..end]) else { panic!("{name} is read from its first {end} bytes") };
        assert!(!fault.place.is_empty() && !fault.hint.is_empty(), "{name}, {end} bytes: {fault:?}");
    }
}

#[test]
fn no_beginning_of_a_file_passes_for_the_file() {
    each_beginning("big-endian PLY", &bytes("ply/degree0_big_endian.ply"), rows);
    for name in ["types", "protocol4", "tensor"] {
        each_beginning(name, &bytes(&format!("pth/{name}.pth")), pickle::decode);
    }
    let options = bytes("cfg_args.txt");
    // It has letters of several bytes, which a cut may divide.
    each_beginning("cfg_args", options.trim_ascii_end(), |bytes| {
        python::namespace(&String::from_utf8_lossy(bytes))
    });
}

#[test]
fn no_beginning_of_a_text_of_numbers_panics() {
    // The last number of ascii may be cut without a trace: `12.5` and `12.` are both numbers.
    for name in ["degree1_ascii_double", "degree2_backwards_crlf"] {
        let whole = bytes(&format!("ply/{name}.ply"));
        let rows = whole.windows(10).position(|window| window == b"end_header").unwrap();
        for end in 0..whole.len() {
            let is_refused = super::ply::rows(&whole[..end]).is_err();
            assert!(is_refused || end > rows + (whole.len() - rows) * 9 / 10, "{name}, {end} bytes");
        }
    }
}

/// The archive is whole, what is in it is not.
#[test]
fn no_beginning_of_an_entry_passes_for_the_entry() {
    let whole = bytes("pth/types.pth");
    let entries = entries(&whole);
    let cut = |index: usize, end: usize| {
        let entry = |(place, (name, content)): (usize, &(String, Vec<u8>))| {
            (name.clone(), if place == index { content[..end].to_vec() } else { content.clone() })
        };
        let entries: Vec<(String, Vec<u8>)> = entries.iter().enumerate().map(entry).collect();
        let entries: Vec<(&str, &[u8])> =
            entries.iter().map(|(name, content)| (name.as_str(), content.as_slice())).collect();
        pickle::decode(&zip(&entries))
    };
    let mut storages = 0;
    for (index, (name, content)) in entries.iter().enumerate() {
        let needed = name.ends_with("/data.pkl") || name.contains("/data/");
        for end in (0..content.len()).filter(|_| needed) {
            assert!(cut(index, end).is_err(), "{name} is read from its first {end} bytes");
            storages += usize::from(name.contains("/data/"));
        }
    }
    assert!(storages > 20, "the storages were met");
}
