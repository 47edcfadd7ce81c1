//! Files that lie: none panics, none takes room that its length does not speak for, none leaves its folder.

use std::path::Path;

use l4d_import::results::arrays;
use l4d_import::results::codec;
use l4d_import::results::relevancy::{Decoder, TextsFile};
use proptest::prelude::*;

use crate::bench::{Bench, SCENE, codes, npy, npz, request};

fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn refusal(name: &str, bytes: &[u8]) -> String {
    let (_folder, path) = written(name, bytes);
    let error = arrays::read(&path, None).unwrap_err();
    assert!(error.hint().is_some_and(|hint| !hint.is_empty()), "{error} has no remedy");
    error.to_string()
}

#[test]
fn pickles_that_call_something_are_refused_by_name() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../l4d-splat/tests/fixtures/checkpoint/pth");
    for name in ["poison_system.pth", "poison_eval.pth", "poison_numpy.pth", "poison_module.pth"] {
        let error = Decoder::read(&fixtures.join(name)).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        assert!(arrays::read(&fixtures.join(name), None).is_err());
    }
}

#[test]
fn absurd_shapes_and_objects_are_refused() {
    let with = |header: &str| {
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.as_bytes());
        file
    };
    let huge = with("{'descr': '<f4', 'fortran_order': False, 'shape': (1099511627776, 3), }");
    assert!(refusal("huge.npy", &huge).contains("does not fit"));
    let objects = with("{'descr': '|O', 'fortran_order': False, 'shape': (1,), }");
    assert!(refusal("objects.npy", &objects).contains("executed"));
    assert!(refusal("masks.mp4", b"x").contains("mp4"));
}

#[test]
fn archives_that_leave_their_folder_or_repeat_themselves_are_refused() {
    let array = npy(&[2, 2], &[0.0; 4]);
    // Writers mend such names, so they are put in afterwards.
    for (name, evil) in
        [("ab/ab/evil.npy", "../../evil.npy"), ("aevil.npy", "/evil.npy"), ("ab/evil.npy", "..\\evil.npy")]
    {
        let mut archive = npz(&[(name, array.clone())]);
        let places: Vec<usize> = (0..archive.len() - name.len())
            .filter(|&at| archive[at..].starts_with(name.as_bytes()))
            .collect();
        assert_eq!(places.len(), 2, "the head of the entry and the directory");
        places.into_iter().for_each(|at| archive[at..at + name.len()].copy_from_slice(evil.as_bytes()));
        assert!(refusal("a.npz", &archive).contains("leaves its folder"), "{evil}");
    }
    assert!(refusal("a.npz", &npz(&[("a.npy", array.clone()), ("a.npy", array.clone())])).contains("twice"));
    assert!(refusal("a.npz", &npz(&[("a.npy", array.clone()), ("b.npy", array)])).contains("2 arrays"));
    assert!(refusal("a.npz", b"no zip").contains("no whole zip"));
}

/// A zip of one deflated entry: `inflated` zeros, whatever its directory claims.
fn bomb(inflated: usize, claimed: u32) -> Vec<u8> {
    let mut encoder = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut encoder, &vec![0; inflated]).unwrap();
    let data = encoder.finish().unwrap();
    let name = b"a.npy";
    let mut sizes = Vec::new();
    sizes.extend(0_u32.to_le_bytes());
    sizes.extend((data.len() as u32).to_le_bytes());
    sizes.extend(claimed.to_le_bytes());
    let mut file = b"PK\x03\x04\x14\x00\x00\x00\x08\x00\x00\x00\x00\x00".to_vec();
    file.extend(&sizes);
    file.extend([5, 0, 0, 0]);
    file.extend(name);
    file.extend(&data);
    let directory = file.len() as u32;
    file.extend(b"PK\x01\x02\x14\x00\x14\x00\x00\x00\x08\x00\x00\x00\x00\x00");
    file.extend(&sizes);
    file.extend([5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    file.extend(name);
    let length = file.len() as u32 - directory;
    file.extend(b"PK\x05\x06\x00\x00\x00\x00\x01\x00\x01\x00");
    file.extend(length.to_le_bytes());
    file.extend(directory.to_le_bytes());
    file.extend([0, 0]);
    file
}

#[test]
fn bombs_are_refused_by_what_they_claim_and_by_what_they_do() {
    assert!(refusal("a.npz", &bomb(1 << 20, u32::MAX - 1)).contains("grow beyond"));
    assert!(refusal("a.npz", &bomb(1 << 24, 100)).contains("size that it claims"));
    assert!(refusal("a.npz", &bomb(100, 1 << 20)).contains("size that it claims"));
}

#[test]
fn links_are_not_followed() {
    let bench = Bench::new();
    bench.write(&format!("{SCENE}/00001/x"), "x");
    let secret = bench.path("secret.png");
    std::fs::write(&secret, "x").unwrap();
    let link = bench.path("method").join(format!("{SCENE}/00001/chosen_the red cup.png"));
    std::os::unix::fs::symlink(&secret, link).unwrap();
    assert_eq!(codes(bench.import("langsplat-masks", |_| ()).1), ["L4D540", "L4D542"]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Flipped bytes of sound files end in an answer or an error.
    #[test]
    fn damage_never_panics(at in 0..4000_usize, flip in 1..=255_u8, cut in 0..4000_usize) {
        let array = npy(&[4, 5, 3], &[0.25; 60]);
        let archive = npz(&[("positives.npy", array.clone()), ("queries.npy", crate::bench::npy_texts(&["a", "b"]))]);
        let damaged = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            let length = bytes.len();
            bytes[at % length] ^= flip;
            bytes.truncate(length - cut % length);
            bytes
        };
        let (_folder, path) = written("a.npy", &damaged(&array));
        let _ = arrays::read(&path, None);
        let (_folder, path) = written("a.npz", &damaged(&archive));
        let _ = arrays::names(&path);
        let _ = TextsFile::read(&path);
        let _ = Decoder::read(&path);
        let bench = Bench::new();
        let benchmark = bench.open();
        let reading = request(&benchmark, "mevis-rle", &path).reading;
        let json = br#"{"001": [null, {"size": [3, 2], "counts": "024"}]}"#;
        let (_folder, path) = written("a.json", &damaged(json));
        let _ = codec::read(&path, &reading);
    }
}
