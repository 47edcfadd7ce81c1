//! Arrays and archives that mean harm.

use l4d_formats::{arrays, npy};

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
    assert!(error.hint().is_some_and(|hint| !hint.is_empty()), "{error} has no remedy");
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
