//! Hostile files: none panics, none leaves its folder. `l4d-formats` tests its readers itself.

use l4d_import::results::codec;
use l4d_import::results::relevancy::{Decoder, TextEmbeddingsFile};
use l4d_testing::foreign::{npy, npy_texts, npz};
use proptest::prelude::*;

use crate::bench::{Bench, SCENE, codes, request};

fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = l4d_testing::folder();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn links_are_not_followed() {
    let bench = Bench::new();
    bench.write(&format!("eval_result/{SCENE}/00001/x"), "x");
    let secret = bench.path("secret.png");
    std::fs::write(&secret, "x").unwrap();
    let link = bench.path("method").join(format!("eval_result/{SCENE}/00001/chosen_the red cup.png"));
    std::os::unix::fs::symlink(&secret, link).unwrap();
    assert_eq!(codes(bench.import("langsplat-masks", |_| ()).1), ["L4D540", "L4D542"]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Flipped bytes of sound files end in an answer or an error.
    #[test]
    fn damage_never_panics(at in 0..4000_usize, flip in 1..=255_u8, cut in 0..4000_usize) {
        let array = npy(&[4, 5, 3], &[0.25; 60]);
        let archive = npz(&[("positives", array.clone()), ("queries", npy_texts(&["a", "b"]))]);
        let damaged = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            let length = bytes.len();
            bytes[at % length] ^= flip;
            bytes.truncate(length - cut % length);
            bytes
        };
        let (_folder, path) = written("a.npy", &damaged(&array));
        let _ = Decoder::read(&path);
        let (_folder, path) = written("a.npz", &damaged(&archive));
        let _ = TextEmbeddingsFile::read(&path);
        let _ = Decoder::read(&path);
        let bench = Bench::new();
        let benchmark = bench.open();
        let reading = request(&benchmark, "mevis-rle", &path).reading;
        let json = br#"{"001": [null, {"size": [3, 2], "counts": "024"}]}"#;
        let (_folder, path) = written("a.json", &damaged(json));
        let _ = codec::read(&path, &reading, (3, 2));
    }
}
