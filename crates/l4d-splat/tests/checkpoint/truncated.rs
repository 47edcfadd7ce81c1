//! Files that end too early, wherever they end.

use std::fs;
use std::path::Path;

use l4d_splat::checkpoint::cfg_args::CfgArgs;
use l4d_splat::checkpoint::own::{self, Checkpoint};
use l4d_splat::checkpoint::{foreign, pickle, ply};

use super::poison::zip;
use super::{bytes, fixture};

/// Feeds every beginning of `whole` to `read`, which must refuse it with a place and a remedy.
fn each_beginning<T: std::fmt::Debug>(
    name: &str,
    whole: &[u8],
    read: impl Fn(&[u8]) -> Result<T, l4d_splat::checkpoint::Fault>,
) {
    read(whole).unwrap();
    for end in 0..whole.len() {
        let Err(fault) = read(&whole[..end]) else { panic!("{name} is read from its first {end} bytes") };
        assert!(!fault.place.is_empty() && !fault.remedy.is_empty(), "{name}, {end} bytes: {fault:?}");
    }
}

#[test]
fn no_beginning_of_a_file_passes_for_the_file() {
    each_beginning("PLY", &bytes("model/point_cloud/iteration_7/point_cloud.ply"), ply::decode);
    each_beginning("big-endian PLY", &bytes("ply/degree0_big_endian.ply"), ply::decode);
    for name in ["types", "protocol4", "tensor", "chkpnt"] {
        each_beginning(name, &bytes(&format!("pth/{name}.pth")), pickle::decode);
    }
    let options = bytes("cfg_args.txt");
    each_beginning("cfg_args", options.trim_ascii_end(), CfgArgs::decode);
}

#[test]
fn no_beginning_of_a_text_of_numbers_panics() {
    // The last number of ascii may be cut without a trace: `12.5` and `12.` are both numbers.
    for name in ["degree1_ascii_double", "degree2_backwards_crlf"] {
        let whole = bytes(&format!("ply/{name}.ply"));
        let rows = whole.windows(10).position(|window| window == b"end_header").unwrap();
        for end in 0..whole.len() {
            let is_refused = ply::decode(&whole[..end]).is_err();
            assert!(is_refused || end > rows + (whole.len() - rows) * 9 / 10, "{name}, {end} bytes");
        }
    }
}

/// The archive is whole, what stands in it is not.
#[test]
fn no_beginning_of_an_entry_passes_for_the_entry() {
    let whole = bytes("pth/types.pth");
    let archive = rawzip::ZipArchive::from_slice(&whole).unwrap();
    let mut entries: Vec<(String, Vec<u8>)> = Vec::new();
    for record in archive.entries() {
        let record = record.unwrap();
        let name = String::from_utf8(record.file_path().as_bytes().to_vec()).unwrap();
        entries.push((name, archive.get_entry(record.wayfinder()).unwrap().data().to_vec()));
    }
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

#[test]
fn no_beginning_of_our_numbers_passes_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let model = foreign::read(&fixture("model"), None).unwrap();
    let gaussians = model.gaussians;
    own::write(folder.path(), &Checkpoint { gaussians, ..Checkpoint::default() }).unwrap();
    let names = l4d_data::store::list_folder(folder.path()).unwrap();
    let [card, numbers] = names.as_slice() else { panic!("{names:?}") };
    let paths = [card, numbers].map(|name| folder.path().join(name));
    let whole = [&paths[0], &paths[1]].map(|path| fs::read(path).unwrap());
    for end in 0..whole[0].trim_ascii_end().len() {
        fs::write(&paths[0], &whole[0][..end]).unwrap();
        let error = own::read(folder.path()).unwrap_err();
        assert!(error.to_string().contains("checkpoint.json"), "{end} bytes: {error}");
    }
    let described: serde_json::Value = serde_json::from_slice(&whole[0]).unwrap();
    for end in (0..whole[1].len()).step_by(3) {
        // With a JSON that vouches for them, so that the digest does not tell.
        let mut described = described.clone();
        described["tensors"]["bytes"] = end.into();
        described["tensors"]["sha256"] = l4d_data::digest::sha256_hex(&whole[1][..end]).into();
        fs::write(&paths[0], described.to_string()).unwrap();
        fs::write(&paths[1], &whole[1][..end]).unwrap();
        assert!(own::read(folder.path()).is_err(), "{end} bytes");
    }
}

#[test]
fn a_model_folder_with_a_cut_or_replaced_file_is_refused_by_its_name() {
    let save = Path::new("point_cloud/iteration_7");
    let files = [
        Path::new("cfg_args").to_owned(),
        save.join("point_cloud.ply"),
        save.join("deformation.pth"),
        save.join("deformation_table.pth"),
        save.join("deformation_accum.pth"),
    ];
    for file in files {
        let folder = super::foreign::copied();
        let path = folder.path().join(&file);
        let whole = fs::read(&path).unwrap();
        for share in [0, 1, 2, 3] {
            fs::write(&path, &whole[..whole.len() * share / 4]).unwrap();
            let error = foreign::read(folder.path(), None).unwrap_err().to_string();
            assert!(error.contains(file.to_str().unwrap()), "{error}");
        }
        fs::remove_file(&path).unwrap();
        fs::create_dir(&path).unwrap();
        let error = foreign::read(folder.path(), None).unwrap_err().to_string();
        assert!(error.contains("is not a regular file"), "{error}");
    }
}
