//! Arrays and archives that mean harm.

use std::io::Write as _;

use flate2::write::DeflateEncoder;
use l4d_formats::{arrays, npy};
use rawzip::{CompressionMethod, ZipArchiveWriter};

use super::fixture;
use super::poison::zip;

fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn refusal(name: &str, bytes: &[u8]) -> String {
    let (_folder, path) = written(name, bytes);
    let error = arrays::read(&path, None).unwrap_err();
    assert!(!error.hint().is_empty(), "{error} has no hint");
    error.to_string()
}

fn array() -> Vec<u8> {
    npy::encode_f64(&[2, 2], &[0.0; 4])
}

#[test]
fn pickles_that_call_something_are_refused_by_name() {
    for name in ["poison_system.pth", "poison_eval.pth", "poison_numpy.pth", "poison_module.pth"] {
        assert!(arrays::read(&fixture("pth").join(name), None).unwrap_err().to_string().contains(name));
    }
    assert_eq!(arrays::read(&fixture("pth/tensor.pth"), None).unwrap().shape, [2, 3, 4, 5]);
    assert_eq!(arrays::read(&fixture("pth/types.pth"), Some("sliced")).unwrap().data, [5.0, 7.0, 9.0]);
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
    let array = array();
    for evil in ["../../evil.npy", "/evil.npy", "..\\evil.npy"] {
        assert!(refusal("a.npz", &zip(&[(evil, &array)])).contains("leaves its folder"), "{evil}");
    }
    assert!(refusal("a.npz", &zip(&[("a.npy", &array), ("a.npy", &array)])).contains("twice"));
    assert!(refusal("a.npz", &zip(&[("a.npy", &array), ("b.npy", &array)])).contains("2 arrays"));
    assert!(refusal("a.npz", b"no zip").contains("no whole zip"));
}

/// A zip of one deflated entry: `inflated` zeros, whatever its directory claims.
fn bomb(inflated: usize, claimed: u32) -> Vec<u8> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    let file = archive.new_file("a.npy").compression_method(CompressionMethod::DEFLATE);
    let (mut entry, config) = file.start().unwrap();
    let mut writer = config.wrap(DeflateEncoder::new(&mut entry, flate2::Compression::best()));
    writer.write_all(&vec![0; inflated]).unwrap();
    let (encoder, descriptor) = writer.finish().unwrap();
    encoder.finish().unwrap();
    entry.finish(descriptor).unwrap();
    let mut file = archive.finish().unwrap();
    let directory = file.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    file[directory + 24..directory + 28].copy_from_slice(&claimed.to_le_bytes());
    file
}

#[test]
fn bombs_are_refused_by_what_they_claim_and_by_what_they_do() {
    assert!(refusal("a.npz", &bomb(1 << 20, u32::MAX - 1)).contains("grow beyond"));
    assert!(refusal("a.npz", &bomb(1 << 24, 100)).contains("size that it claims"));
    assert!(refusal("a.npz", &bomb(100, 1 << 20)).contains("size that it claims"));
}
