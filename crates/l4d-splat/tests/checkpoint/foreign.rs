use std::fs;
use std::path::Path;

use l4d_data::json;
use l4d_splat::checkpoint::cfg_args::{CfgArgs, Literal};
use l4d_splat::checkpoint::foreign::{self, ForeignModel, Save, Stage, keys};
use l4d_splat::checkpoint::{pickle, ply};
use l4d_splat::deform::{Bounds, DeformConfig, DeformationField, Init, TimeAxis};
use l4d_splat::{Gaussians, Tensor};
use serde_json::Value;

use super::{bytes, digest, fixture};

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
    let model = foreign::read(&fixture("model"), None).unwrap();
    assert_eq!(model.save, SAVE);
    assert_eq!(model.field.config(), &config());
    assert_eq!(model.notes, Vec::<String>::new());
    assert_eq!((model.table, model.accumulated), (vec![true; 5], vec![[0.0; 3]; 5]));
    let expected = expected();
    let gaussians = &model.gaussians;
    assert_eq!(gaussians.len(), 5);
    for (field, numbers) in [
        ("means", gaussians.means.as_flattened()),
        ("log_scales", gaussians.log_scales.as_flattened()),
        ("rotations", gaussians.rotations.as_flattened()),
        ("opacity_logits", &gaussians.opacity_logits),
        ("sh", gaussians.sh.as_flattened()),
    ] {
        assert_eq!(digest(numbers), expected["gaussians"][field], "{field}");
    }
    let mut tensors = model.field.tensors();
    tensors.extend(model.beside);
    let theirs = expected["tensors"].as_object().unwrap();
    assert_eq!(tensors.keys().collect::<Vec<_>>().len(), theirs.len());
    for (name, theirs) in theirs {
        let tensor = &tensors[name];
        assert_eq!(serde_json::json!(tensor.shape), theirs["shape"], "{name}");
        assert_eq!(digest(&tensor.data), theirs["sha256"], "{name}");
    }
    // Row 0 is the larger corner.
    assert_eq!(tensors[keys::AABB].data, [1.5, 2.25, 3.0, -1.0, -2.0, -0.5]);
}

#[test]
fn names_and_shapes_are_those_of_the_field_and_of_the_ballast() {
    let model = foreign::read(&fixture("model"), None).unwrap();
    let shapes = |(name, tensor): (String, Tensor)| (name, tensor.shape);
    let mut listed = keys::field_shapes(&config());
    listed.sort();
    assert_eq!(listed, model.field.tensors().into_iter().map(shapes).collect::<Vec<_>>());
    let mut ballast: Vec<_> = keys::ballast(&model.args).into_iter().map(shapes).collect();
    ballast.sort();
    assert_eq!(ballast, model.beside.clone().into_iter().map(shapes).collect::<Vec<_>>());
    let tables = keys::ballast(&CfgArgs::default()).into_iter().filter(|(name, _)| name.ends_with("_poc"));
    tables.for_each(|(name, tensor)| assert_eq!(model.beside[&name], tensor, "{name}"));
}

#[test]
fn a_model_that_is_written_back_is_the_same_model() {
    let folder = tempfile::tempdir().unwrap();
    let model = foreign::read(&fixture("model"), None).unwrap();
    assert_eq!(foreign::write(folder.path(), &model).unwrap(), Vec::<String>::new());
    assert_eq!(foreign::read(folder.path(), None).unwrap(), model);
    for file in ["cfg_args", "point_cloud/iteration_7/point_cloud.ply"] {
        assert!(
            fs::read(folder.path().join(file)).unwrap() == bytes(&format!("model/{file}")),
            "{file} differs"
        );
    }
    let state =
        |path: &Path| pickle::read_state_dict(&path.join("point_cloud/iteration_7/deformation.pth")).unwrap();
    assert_eq!(state(folder.path()), state(&fixture("model")));
}

/// Python has read these very bytes (`tests/fixtures/checkpoint/check.py`). After a change of the writer run this test
/// with `UPDATE_FIXTURES=1`, then that script.
#[test]
fn what_is_written_is_what_python_was_seen_to_read() {
    let folder = tempfile::tempdir().unwrap();
    let read = foreign::read(&fixture("model"), None).unwrap();
    let fresh = ForeignModel::new(SAVE, read.gaussians, read.field, &[0, 2, 3]);
    let notes = foreign::write(folder.path(), &fresh).unwrap();
    assert_eq!(notes, ["2 static Gaussians: 4DGaussians will deform them too, it ignores its table"]);
    let target = fixture("from_l4d");
    for file in
        ["cfg_args", "point_cloud.ply", "deformation.pth", "deformation_table.pth", "deformation_accum.pth"]
    {
        let file =
            if file == "cfg_args" { file.to_owned() } else { format!("point_cloud/iteration_7/{file}") };
        let written = fs::read(folder.path().join(&file)).unwrap();
        if std::env::var_os("UPDATE_FIXTURES").is_some() {
            fs::create_dir_all(target.join(&file).parent().unwrap()).unwrap();
            fs::write(target.join(&file), &written).unwrap();
        }
        assert!(
            written == fs::read(target.join(&file)).unwrap(),
            "{file} is not what Python was seen to read"
        );
    }
    let again = foreign::read(folder.path(), None).unwrap();
    assert_eq!(again.table, [true, false, true, true, false]);
    assert_eq!(again.notes.len(), 1);
    assert!(again.notes[0].contains("the original draws as if it did not"), "{:?}", again.notes);
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
    let coarse = Save { stage: Stage::Coarse, iteration: 3000 };
    let fine = |iteration| Save { stage: Stage::Fine, iteration };
    assert_eq!(foreign::saves(folder.path()).unwrap(), [coarse, fine(7), fine(500), fine(14000)]);
    let newest = foreign::read(folder.path(), None).unwrap();
    assert_eq!(newest.save, fine(14000));
    assert!(newest.drawn_field().is_some());
    assert_eq!(foreign::read(folder.path(), Some(fine(500))).unwrap().save, fine(500));
    let early = foreign::read(folder.path(), Some(coarse)).unwrap();
    assert!(early.drawn_field().is_none(), "the coarse stage is drawn without the field");
    let absent = foreign::read(folder.path(), Some(fine(8))).unwrap_err().to_string();
    assert!(absent.contains("has no iteration_8, only: coarse_iteration_3000, iteration_7"), "{absent}");
    for save in ["iteration_7", "iteration_500", "iteration_14000"] {
        fs::remove_dir_all(clouds.join(save)).unwrap();
    }
    assert_eq!(foreign::read(folder.path(), None).unwrap().save, coarse);
    fs::remove_dir_all(clouds.join("coarse_iteration_3000")).unwrap();
    assert!(foreign::read(folder.path(), None).unwrap_err().to_string().contains("holds no save"));
    let elsewhere = foreign::read(&clouds, None).unwrap_err();
    assert!(elsewhere.to_string().contains("folder `point_cloud`: is missing"), "{elsewhere}");
    assert!(elsewhere.hint().unwrap().contains("cfg_args"), "{elsewhere:?}");
}

#[test]
fn options_that_the_parameters_contradict_are_named() {
    let refused = |from: &str, to: &str| {
        let folder = copied();
        let path = folder.path().join("cfg_args");
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{from}");
        fs::write(&path, text.replace(from, to)).unwrap();
        foreign::read(folder.path(), None).unwrap_err().to_string()
    };
    for (from, to, why) in [
        ("net_width=4", "net_width=64", "option `net_width`: is `64`, but the parameters have 4"),
        ("net_width=4", "net_width='4'", "option `net_width`: is `'4'`, but the parameters have 4"),
        (
            "'output_coordinate_dim': 2",
            "'output_coordinate_dim': 16",
            "output_coordinate_dim`: is `16`, but the parameters have 2",
        ),
        (
            "[3, 4, 5, 6]",
            "[3, 4, 5, 75]",
            "kplanes_config.resolution`: is `[3, 4, 5, 75]`, but the parameters have [3, 4, 5, 6]",
        ),
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
        (
            "sh_degree=3",
            "sh_degree=2",
            "option `sh_degree`: is `2`, but point_cloud.ply has harmonics of degree 3",
        ),
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
    let model = foreign::read(folder.path(), None).unwrap();
    assert_eq!(model.field.config(), &DeformConfig { no_do: true, no_dshs: true, ..config() });
}

#[test]
fn files_that_do_not_belong_together_are_named() {
    let folder = copied();
    let save = folder.path().join("point_cloud/iteration_7");
    let original = ply::read(&save.join("point_cloud.ply")).unwrap().gaussians;
    let mut fewer = original.clone();
    fewer.means.pop();
    fewer.log_scales.pop();
    fewer.rotations.pop();
    fewer.opacity_logits.pop();
    fewer.sh.truncate(64);
    ply::write(&save.join("point_cloud.ply"), &fewer).unwrap();
    let error = foreign::read(folder.path(), None).unwrap_err().to_string();
    assert!(
        error.contains(
            "deformation_table.pth: tensor: has the shape [5], but the Gaussians of point_cloud.ply need [4]"
        ),
        "{error}"
    );
    fs::remove_file(save.join("deformation_table.pth")).unwrap();
    let error = foreign::read(folder.path(), None).unwrap_err().to_string();
    assert!(error.contains("deformation_accum.pth: tensor: has the shape [5, 3]"), "{error}");
    fs::remove_file(save.join("deformation_accum.pth")).unwrap();
    let model = foreign::read(folder.path(), None).unwrap();
    assert_eq!((model.table, model.accumulated), (vec![true; 4], vec![[0.0; 3]; 4]));

    // Harmonics of degree 1 under a head that changes degree 3.
    let sh_degree = l4d_splat::ShDegree::new(1).unwrap();
    let low = Gaussians { sh_degree, sh: original.sh[..20].to_vec(), ..original };
    ply::write(&save.join("point_cloud.ply"), &low).unwrap();
    let options = fs::read_to_string(folder.path().join("cfg_args")).unwrap().replace("sh_degree=3, ", "");
    fs::write(folder.path().join("cfg_args"), &options).unwrap();
    let error = foreign::read(folder.path(), None).unwrap_err().to_string();
    assert!(error.contains("changes 16 coefficients a channel, but point_cloud.ply has 4"), "{error}");
    fs::write(folder.path().join("cfg_args"), options.replace("no_dshs=False", "no_dshs=True")).unwrap();
    assert_eq!(foreign::read(folder.path(), None).unwrap().gaussians, low);

    for file in ["point_cloud.ply", "deformation.pth"] {
        let folder = copied();
        fs::remove_file(folder.path().join("point_cloud/iteration_7").join(file)).unwrap();
        assert!(foreign::read(folder.path(), None).unwrap_err().to_string().contains(file));
    }
}

#[test]
fn parameters_that_are_missing_misshapen_or_unknown_are_named() {
    type Change = fn(&mut std::collections::BTreeMap<String, Tensor>);
    let refused = |change: Change| {
        let folder = copied();
        let path = folder.path().join("point_cloud/iteration_7/deformation.pth");
        let mut tensors = pickle::read_state_dict(&path).unwrap();
        change(&mut tensors);
        fs::write(&path, pickle::encode_state_dict("deformation", &tensors).unwrap()).unwrap();
        foreign::read(folder.path(), None).map(|model| model.notes).map_err(|error| error.to_string())
    };
    let missing = refused(|tensors| drop(tensors.remove("deformation_net.pos_deform.3.bias"))).unwrap_err();
    assert!(missing.contains("parameter `deformation_net.pos_deform.3.bias`: is missing"), "{missing}");
    let deeper = refused(|tensors| {
        let weight = tensors["deformation_net.pos_deform.1.weight"].clone();
        tensors.insert("deformation_net.feature_out.2.weight".to_owned(), weight);
    });
    assert!(deeper.unwrap_err().contains("`deformation_net.feature_out.2.weight`: is no part of a field"));
    let flat = refused(|tensors| tensors.get_mut(keys::AABB).unwrap().data[4] = 2.25).unwrap_err();
    assert!(flat.contains("axis y"), "{flat}");
    let poisoned =
        refused(|tensors| tensors.get_mut("deformation_net.grid.grids.0.2").unwrap().data[3] = f32::NAN);
    assert!(poisoned.unwrap_err().contains("`deformation_net.grid.grids.0.2`, number 3: is NaN"));
    let squeezed =
        refused(|tensors| tensors.get_mut("deformation_net.grid.grids.0.0").unwrap().shape = vec![24]);
    assert!(
        squeezed.unwrap_err().contains("`deformation_net.grid.grids.0.0`: has the shape [24], but 4 axes")
    );
    let extra = refused(|tensors| {
        drop(tensors.insert("uncertainty".to_owned(), Tensor { shape: vec![0], data: vec![] }));
    });
    assert_eq!(extra.unwrap(), ["deformation.pth has parameters that 4DGaussians does not: `uncertainty`"]);
    let bare = refused(|tensors| tensors.retain(|name, _| name.starts_with(keys::PREFIX)));
    assert_eq!(bare, Ok(vec![]), "the ballast is not needed");
}

#[test]
fn a_field_on_the_whole_time_axis_is_written_as_the_same_field() {
    let whole = DeformConfig { time_axis: TimeAxis::Whole, ..config() };
    let bounds = Bounds::new([[1.0; 3], [-1.0; 3]]).unwrap();
    let mut field = DeformationField::new(whole, bounds, Init::Foreign, 3).unwrap();
    // Planes of time start at 1 everywhere; these differ from place to place.
    for (place, number) in field.parameters_mut().planes.into_iter().flatten().enumerate() {
        *number = 0.5 + (place as f32 * 0.7).sin() / 3.0;
    }
    let gaussians = foreign::read(&fixture("model"), None).unwrap().gaussians;
    let means = gaussians.means.clone();
    let folder = tempfile::tempdir().unwrap();
    foreign::write(folder.path(), &ForeignModel::new(SAVE, gaussians, field.clone(), &[])).unwrap();
    let read = foreign::read(folder.path(), None).unwrap();
    assert_eq!(read.field.config(), &DeformConfig { time_resolution: 11, ..config() });
    let resolution = [3, 4, 5, 11].map(Literal::Int).to_vec();
    let Some(Literal::Dict(planes)) = read.args.get("kplanes_config") else { panic!("{:?}", read.args) };
    assert!(planes.iter().any(|(_, value)| *value == Literal::List(resolution.clone())), "{planes:?}");
    for time in [0.0, 0.13, 0.5, 0.8, 1.0] {
        let (ours, theirs) =
            (field.offsets(&means, time).unwrap(), read.field.offsets(&means, time).unwrap());
        let pairs = ours.means.as_flattened().iter().zip(theirs.means.as_flattened());
        pairs.for_each(|(ours, theirs)| assert!((ours - theirs).abs() < 1e-5, "{time}: {ours} {theirs}"));
    }
}

#[test]
fn lists_of_another_length_are_not_written() {
    let mut model = foreign::read(&fixture("model"), None).unwrap();
    model.table.pop();
    let folder = tempfile::tempdir().unwrap();
    let error = foreign::write(folder.path(), &model).unwrap_err().to_string();
    assert!(error.contains("field `table`: has 4 rows for 5 Gaussians"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

pub(crate) fn copied() -> tempfile::TempDir {
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
