use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use l4d_data::reader::Reader;
use l4d_data::{DataError, json};
use l4d_splat::Gaussians;
use l4d_splat::checkpoint::foreign::{self, ForeignModel, Moments, ReaderOptions, Save, Stage};
use l4d_splat::checkpoint::ply;
use l4d_splat::deform::{DeformConfig, TimeAxis};
use l4d_splat::gaussians::{FIELDS, ShDegree};
use serde_json::Value;

use super::{digest, fixture};

fn read(folder: impl AsRef<Path>) -> Result<ForeignModel, DataError> {
    foreign::read(folder.as_ref(), ReaderOptions::default())
}

const SAVE: Save = Save { stage: Stage::Fine, iteration: 7 };

fn expected() -> Value {
    json::read(&fixture("model.json")).unwrap()
}

fn config() -> DeformConfig {
    DeformConfig {
        channels: 2,
        spatial_resolution: [3, 4, 5],
        time_resolution: 6,
        multires: vec![1, 2],
        width: 4,
        no_dx: false,
        no_ds: false,
        no_dr: false,
        no_do: false,
        no_dshs: false,
        sh_coefficients: 16,
        time_axis: TimeAxis::Half,
    }
}

#[test]
fn a_model_folder_is_read_to_the_last_bit() {
    let model = read(fixture("model")).unwrap();
    assert_eq!(model.save, SAVE);
    assert_eq!(model.field.config(), &config());
    assert_eq!(model.notes, Vec::<String>::new());
    let expected = expected();
    let gaussians = &model.gaussians;
    assert_eq!(gaussians.len(), 5);
    for (field, numbers) in FIELDS.into_iter().zip(gaussians.flat()) {
        assert_eq!(digest(numbers), expected["gaussians"][field], "{field}");
    }
    let tensors = model.field.tensors();
    let theirs = expected["tensors"].as_object().unwrap();
    let of_field: Vec<_> = theirs.iter().filter(|(name, _)| name.starts_with("deformation_net.")).collect();
    assert_eq!(tensors.len(), of_field.len());
    for (name, theirs) in of_field {
        let tensor = &tensors[name];
        assert_eq!(serde_json::json!(tensor.shape), theirs["shape"], "{name}");
        assert_eq!(digest(&tensor.data), theirs["sha256"], "{name}");
    }
    // Row 0 is the larger corner.
    assert_eq!(tensors["deformation_net.grid.aabb"].data, [1.5, 2.25, 3.0, -1.0, -2.0, -0.5]);
}

#[test]
fn the_newest_fine_save_is_read_by_default() {
    let folder = copied();
    let clouds = folder.path().join("point_cloud");
    for name in
        ["coarse_iteration_3000", "iteration_14000", "iteration_500", "iteration_x", "iteration_007", "notes"]
    {
        copy_folder(&clouds.join("iteration_7"), &clouds.join(name));
    }
    let newest = || read(folder.path()).map(|model| (model.save, model.drawn_field().is_some()));
    assert_eq!(newest().unwrap(), (Save { stage: Stage::Fine, iteration: 14000 }, true));
    for save in ["iteration_7", "iteration_500", "iteration_14000"] {
        fs::remove_dir_all(clouds.join(save)).unwrap();
    }
    let coarse = Save { stage: Stage::Coarse, iteration: 3000 };
    assert_eq!(newest().unwrap(), (coarse, false), "the coarse stage is drawn without the field");
    fs::remove_dir_all(clouds.join("coarse_iteration_3000")).unwrap();
    assert!(newest().unwrap_err().to_string().contains("holds no save"));
    let elsewhere = read(&clouds).unwrap_err();
    assert!(elsewhere.to_string().contains("folder `point_cloud`: is missing"), "{elsewhere}");
    assert!(elsewhere.hint().contains("cfg_args"), "{elsewhere:?}");
}

#[test]
fn options_that_the_parameters_contradict_are_named() {
    let refused = |from: &str, to: &str| {
        let folder = copied();
        let path = folder.path().join("cfg_args");
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{from}");
        fs::write(&path, text.replace(from, to)).unwrap();
        read(folder.path()).unwrap_err().to_string()
    };
    for (from, to, why) in [
        (
            "multires=[1, 2]",
            "multires=[1, 2, 4]",
            "option `multires`: has 3 levels, but the parameters have 2",
        ),
        (
            "multires=[1, 2]",
            "multires=[1, 4]",
            "parameter `deformation_net.grid.grids.1.0`: has the shape [1, 2, 8, 6], but the configuration needs [1, 2, 16, 12]",
        ),
        ("multires=[1, 2]", "multires=[1, 0]", "option `multires`: is `[1, 0]`"),
        ("multires=[1, 2]", "multires=[]", "option `multires`: is `[]`"),
        ("multires=[1, 2], ", "", "option `multires`: is missing"),
        ("no_do=False", "no_do=0", "option `no_do`: is `0`, but True or False belongs there"),
        ("apply_rotation=False", "apply_rotation=True", "option `apply_rotation`: is on"),
        ("empty_voxel=False", "empty_voxel=True", "option `empty_voxel`: is on"),
        ("static_mlp=False", "static_mlp=True", "option `static_mlp`: is on"),
        ("no_grid=False", "no_grid=True", "option `no_grid`: is on"),
        ("grid_pe=0", "grid_pe=2", "option `grid_pe`: is above 0"),
        ("defor_depth=0", "defor_depth=4", "option `defor_depth`: is above 1"),
        ("defor_depth=0", "defor_depth=exec('')", "is no literal"),
    ] {
        let found = refused(from, to);
        assert!(found.contains(why), "{to}: {found}");
    }
}

#[test]
fn options_of_older_runs_stand_at_their_defaults() {
    let folder = copied();
    let path = folder.path().join("cfg_args");
    fs::write(&path, "Namespace(multires=[1, 2])").unwrap();
    let model = read(folder.path()).unwrap();
    assert_eq!(model.field.config(), &DeformConfig { no_do: true, no_dshs: true, ..config() });
}

#[test]
fn files_that_do_not_belong_together_are_named() {
    let folder = copied();
    let save = folder.path().join("point_cloud/iteration_7");
    let original = ply::read(&save.join("point_cloud.ply")).unwrap();
    // Harmonics of degree 1 under a head that changes degree 3.
    let sh_degree = l4d_splat::ShDegree::new(1).unwrap();
    let low = Gaussians { sh_degree, sh: original.sh[..20].to_vec(), ..original };
    ply::write(&save.join("point_cloud.ply"), &low).unwrap();
    let options = fs::read_to_string(folder.path().join("cfg_args")).unwrap();
    let error = read(folder.path()).unwrap_err().to_string();
    assert!(error.contains("changes 16 coefficients a channel, but point_cloud.ply has 4"), "{error}");
    fs::write(folder.path().join("cfg_args"), options.replace("no_dshs=False", "no_dshs=True")).unwrap();
    assert_eq!(read(folder.path()).unwrap().gaussians, low);

    for file in ["point_cloud.ply", "deformation.pth"] {
        let folder = copied();
        fs::remove_file(folder.path().join("point_cloud/iteration_7").join(file)).unwrap();
        assert!(read(folder.path()).unwrap_err().to_string().contains(file));
    }
}

/// Replaces text of the state dict; names keep their length, so that the pickle stays whole.
fn with_state_dict(from: &str, to: &str) -> Result<Vec<String>, String> {
    assert_eq!(from.len(), to.len());
    let folder = copied();
    let path = folder.path().join("point_cloud/iteration_7/deformation.pth");
    let mut file = fs::read(&path).unwrap();
    let at = file.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
    file[at..at + to.len()].copy_from_slice(to.as_bytes());
    // The checksum of the pickle, which is the first entry: behind its bytes and in the directory.
    let end = file.windows(4).position(|window| window == b"PK\x07\x08").unwrap();
    let start = file.windows(2).position(|window| window == b"\x80\x02").unwrap();
    let checksum = crc32(&file[start..end]);
    file[end + 4..end + 8].copy_from_slice(&checksum);
    let directory = file.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    file[directory + 16..directory + 20].copy_from_slice(&checksum);
    fs::write(&path, file).unwrap();
    read(folder.path()).map(|model| model.notes).map_err(|error| error.to_string())
}

fn crc32(bytes: &[u8]) -> [u8; 4] {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
    let crc = bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step));
    (!crc).to_le_bytes()
}

#[test]
fn parameters_that_are_missing_or_unknown_are_named() {
    let head = "deformation_net.pos_deform.3.bias";
    let missing = with_state_dict(head, "deformation_nut.pos_deform.3.bias").unwrap_err();
    assert!(missing.contains(&format!("parameter `{head}`: is missing")), "{missing}");
    let unknown = with_state_dict("timenet.0.bias", "uncertainty.x.").unwrap();
    assert_eq!(unknown, ["deformation.pth has parameters that 4DGaussians does not: `uncertainty.x.`"]);
}

#[test]
fn a_folder_with_a_cut_file_is_refused_by_its_name() {
    let save = Path::new("point_cloud/iteration_7");
    for file in ["point_cloud.ply", "deformation.pth"] {
        let folder = copied();
        let path = folder.path().join(save).join(file);
        let whole = fs::read(&path).unwrap();
        for share in 0..4 {
            fs::write(&path, &whole[..whole.len() * share / 4]).unwrap();
            let error = read(folder.path()).unwrap_err().to_string();
            assert!(error.contains(file), "{error}");
        }
    }
}

/// What an export says beside the data, with the times of its reader.
fn export(frames: &[u32], reader: Option<Reader>) -> String {
    let trained = reader.map(|reader| reader.trained(frames.len()));
    let card = serde_json::json!({
        "schema": "l4d/export/1", "complete": true, "scene": "wall", "profile": "tiny", "format": "4dgaussians",
        "held_out": "pose", "depth": true, "scene_sha256": "", "frames": frames, "cameras": [], "trained": trained,
        "notes": [],
    });
    card.to_string()
}

#[test]
fn the_export_says_when_moments_were_and_how_they_were_drawn() {
    let folder = copied();
    let options = fs::read_to_string(folder.path().join("cfg_args")).unwrap();
    let untouched = read(folder.path()).unwrap();
    assert_eq!((&untouched.moments, untouched.background), (&Moments::Unknown, Some([1.0; 3])));

    // The path as it was typed, relative to the folder above `output`.
    let output = folder.path().join("output/wall");
    copy_folder(&fixture("model"), &output);
    fs::write(output.join("cfg_args"), options.replace(r#""/data/it's here""#, "'data/wall'")).unwrap();
    let data = folder.path().join("data/wall");
    fs::create_dir_all(&data).unwrap();
    fs::write(data.join("l4d-export.json"), export(&[0, 48, 96], Some(Reader::Panoptic))).unwrap();
    let model = read(&output).unwrap();
    assert_eq!(model.moments, Moments::Listed(vec![0, 48, 96], vec![0.0, 1.0 / 3.0, 2.0 / 3.0]));
    assert_eq!((model.background, model.gaussians.sh_degree), (Some([0.0; 3]), ShDegree::ZERO));
    assert_eq!(model.field.config().sh_coefficients, 1);
    assert!(model.notes.concat().contains("cfg_args says another background"), "{:?}", model.notes);
    let (path, export_card) = model.export.unwrap();
    assert_eq!((path, export_card.depth), (data.join("l4d-export.json"), true));
    // What is left are the rows of the first coefficient.
    let (cut, whole) = (model.field.tensors(), untouched.field.tensors());
    let bias = "deformation_net.shs_deform.3.bias";
    assert_eq!(cut[bias].data, whole[bias].data[..3]);

    // A user knows better, and an older export says nothing.
    let reader_options = ReaderOptions {
        reader: Some(Reader::Dynerf),
        sh_degree: ShDegree::new(2),
        ..ReaderOptions::default()
    };
    let model = foreign::read(&output, reader_options).unwrap();
    assert_eq!(model.moments, Moments::Listed(vec![0, 48, 96], Reader::Dynerf.trained(3).times));
    assert_eq!((model.background, model.gaussians.sh_degree.get()), (Some([1.0; 3]), 2));
    fs::write(data.join("l4d-export.json"), export(&[0, 48, 96], None)).unwrap();
    assert_eq!(read(&output).unwrap().moments, Moments::Unknown);
    let counted = foreign::read(
        folder.path(),
        ReaderOptions { reader: Some(Reader::Panoptic), ..ReaderOptions::default() },
    )
    .unwrap();
    assert_eq!(counted.moments, Moments::Counted(Reader::Panoptic));

    // A copy beside the options counts first; damage is named.
    fs::write(output.join("l4d-export.json"), export(&[0, 96], Some(Reader::Dynerf))).unwrap();
    assert_eq!(read(&output).unwrap().moments, Moments::Listed(vec![0, 96], vec![0.0, 1.0 / 300.0]));
    fs::write(
        output.join("l4d-export.json"),
        export(&[0, 96], Some(Reader::Dynerf)).replace("[0,96]", "[0]"),
    )
    .unwrap();
    let error = read(&output).unwrap_err().to_string();
    assert!(
        error.contains("l4d-export.json") && error.contains("has not one time from 0 to 1 for each"),
        "{error}"
    );
}

#[test]
fn colours_that_never_learned_directions_are_noticed() {
    let folder = copied();
    let path = folder.path().join("point_cloud/iteration_7/point_cloud.ply");
    let mut gaussians = ply::read(&path).unwrap();
    gaussians.sh.chunks_mut(16).for_each(|sh| sh[1..].fill([0.0; 3]));
    ply::write(&path, &gaussians).unwrap();
    let notes = read(folder.path()).unwrap().notes.concat();
    assert!(notes.contains("say --reader panoptic"), "{notes}");
    let reader_options = ReaderOptions { reader: Some(Reader::Panoptic), ..ReaderOptions::default() };
    let notes = foreign::read(folder.path(), reader_options).unwrap().notes.concat();
    assert!(!notes.contains("say --reader panoptic"), "{notes}");
}

#[test]
fn stages_of_4d_langsplat_are_read_with_what_their_gaussians_mean() {
    let expected: Value = json::read(&fixture("trainers/language.json")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    copy_folder(&fixture("trainers/language"), folder.path());
    let newest = |stage: &str| {
        let model = read(folder.path()).unwrap();
        let save = stage.split(',').next().unwrap();
        assert_eq!(model.save.to_string(), format!("{save}_iteration_10000"));
        let found = model.language.unwrap().at(&model.gaussians.means, 0.25).unwrap();
        let expected: Vec<f64> = expected[stage]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|row| row.as_array().unwrap())
            .map(|value| value.as_f64().unwrap())
            .collect();
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((f64::from(*found) - expected).abs() < 1e-5, "{stage}: {found} instead of {expected}");
        }
        assert_eq!(model.gaussians, read(fixture("model")).unwrap().gaussians);
    };
    newest("fine-lang-discrete");
    fs::remove_dir_all(folder.path().join("point_cloud/fine-lang-discrete_iteration_10000")).unwrap();
    newest("fine-lang");
    // As its options say where latents are changed by `lang_deform`.
    let options = fs::read_to_string(folder.path().join("cfg_args")).unwrap();
    fs::write(folder.path().join("cfg_args"), options.replace("no_dlang=1", "no_dlang=0")).unwrap();
    newest("fine-lang, no_dlang 0");
}

/// Runs the fields of 4DGaussians and 4D LangSplat themselves on these models: what the tests compare with is theirs.
#[test]
#[ignore = "needs checkouts of 4DGaussians and 4DLangSplat, and Python with PyTorch (docs/import/verified.md)"]
fn the_originals_fields_say_the_same() {
    let [checkouts, python] =
        ["L4D_ORIGINALS", "L4D_ORIGINALS_PYTHON"].map(|name| std::env::var(name).expect(name));
    let checkouts = fs::canonicalize(checkouts).unwrap();
    let output = Command::new(python).arg(fixture("originals.py")).arg(checkouts).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let last = said.lines().last().unwrap_or_default();
    let differences: BTreeMap<String, f64> = serde_json::from_str(last)
        .unwrap_or_else(|error| panic!("{error}: {said}{}", String::from_utf8_lossy(&output.stderr)));
    println!("{last}");
    assert_eq!(differences.len(), 4);
    for (what, difference) in differences {
        assert!(difference < 5e-6, "{what}: {difference}");
    }
}

fn copied() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy_folder(&fixture("model"), folder.path());
    folder
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            fs::write(target, fs::read(entry.path()).unwrap()).unwrap();
        }
    }
}
