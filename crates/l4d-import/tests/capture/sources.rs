//! One test or more a source.

use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use l4d_data::layout::CaptureDir;
use l4d_formats::colmap::{CameraModel, Model};
use l4d_formats::npy;
use l4d_import::capture::Source;
use l4d_import::export::{ExportRequest, Format, Origin, export};
use serde_json::json;

use crate::support::{TEST_VIEW, World};
use crate::{Bench, assert_rays, held_out, llff_row, painted, png, pose};

fn neu3d() -> Bench {
    let bench = Bench::new();
    // Two cameras were rejected: names have gaps.
    let rows: Vec<f64> = (0..3).flat_map(|number| llff_row(pose(number), 150.0)).collect();
    bench.put("poses_bounds.npy", npy::encode_f64(&[3, 17], &rows));
    bench
}

#[test]
fn neu3d_poses_follow_the_names_and_the_focal_length_the_pictures() {
    let bench = neu3d();
    for (number, name) in ["cam00", "cam04", "cam07"].into_iter().enumerate() {
        for moment in 0..3 {
            bench.put(&format!("{name}/images/{moment:04}.png"), png(64, 48, number as u32 * 3 + moment));
        }
    }
    let capture = bench.read(Source::Neu3d).unwrap();
    assert_eq!((capture.width, capture.height, &capture.frames[..]), (64, 48, &[0, 1, 2][..]));
    assert_eq!(held_out(&capture), ["cam00"]);
    for (number, camera) in capture.cameras.iter().enumerate() {
        // Stated at 128x96, pictures are half as large.
        assert_rays(camera, 0, pose(number), [75.0, 75.0, 32.0, 24.0]);
    }
    assert_eq!(bench.picture(&capture, "cam07", 2), painted(64, 48, 8));
    assert!(!capture.is_metric);
    let text = std::fs::read_to_string(bench.out().join("capture.json")).unwrap();
    assert!(text.contains("\"depth\": \"absent\""));
    assert_eq!(capture.inputs.keys().collect::<Vec<_>>(), ["poses_bounds.npy"]);
}

#[test]
fn neu3d_videos_go_through_ffmpeg() {
    let bench = neu3d();
    for name in ["cam00", "cam01", "cam02"] {
        bench.put(&format!("{name}.mp4"), format!("video of {name}"));
    }
    let error = bench.read(Source::Neu3d).unwrap_err();
    assert!(error.to_string().contains("needs the program `no-such-ffmpeg`"), "{error}");
    assert!(error.hint().contains("images/0000.png"));

    // Takes the place of ffmpeg: checks that it is asked about a video, and answers with two pictures.
    for moment in 0..2 {
        bench.put(&format!("pictures/{moment:06}.png"), png(64, 48, moment));
    }
    let script = bench.input().join("ffmpeg.sh");
    let pictures = bench.input().join("pictures");
    let text = format!(
        "#!/bin/sh\nfor last; do :; done\ncase \"$*\" in *cam0?.mp4*) ;; *) exit 1 ;; esac\ncp {}/*.png \"$(dirname \"$last\")\"\n",
        pictures.display()
    );
    std::fs::write(&script, text).unwrap();
    std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).unwrap();
    let capture = bench.read_with(Source::Neu3d, &["cam01".to_owned()], None, &script).unwrap();
    assert_eq!(capture.frames, [0, 1]);
    assert_eq!(held_out(&capture), ["cam01"]);
    assert_eq!(bench.picture(&capture, "cam02", 1), painted(64, 48, 1));
    let left: Vec<_> =
        std::fs::read_dir(bench.out()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name == ".videos"), "{left:?}");

    let failing = bench.input().join("failing.sh");
    std::fs::write(&failing, "#!/bin/sh\necho 'moov atom not found' >&2\nexit 1\n").unwrap();
    std::fs::set_permissions(&failing, std::fs::Permissions::from_mode(0o755)).unwrap();
    let error = bench.read_with(Source::Neu3d, &[], None, &failing).unwrap_err();
    assert!(error.to_string().contains("moov atom not found"), "{error}");
}

#[test]
fn neu3d_rows_without_a_camera_are_refused() {
    let bench = neu3d();
    bench.put("cam00/images/0000.png", png(64, 48, 0));
    let error = bench.read(Source::Neu3d).unwrap_err();
    assert!(error.to_string().contains("[3, 17], but there are 1 cameras"), "{error}");
}

/// f cu cv ar sk, quaternion and translation from world to camera.
fn interdigital(extra: &str) -> Bench {
    let bench = Bench::new();
    let mut text = "f cu cv ar sk  qw qx qy qz  tx ty tz\n".to_owned();
    for number in 0..16 {
        let seen = pose(number).inverse();
        let q = DQuat::from_mat4(&seen);
        let t = seen.w_axis;
        text.push_str(&format!(
            "80.5 {} 25 1.01 0{extra} {} {} {} {} {} {} {}\n",
            30 + number,
            q.w,
            q.x,
            q.y,
            q.z,
            t.x,
            t.y,
            t.z
        ));
    }
    bench.put("cameras_parameters.txt", text);
    for number in 0..16 {
        for moment in [150, 151, 172, 173] {
            bench.put(&format!("Birthday_undist_{moment:05}_{number:02}.png"), png(64, 48, number + moment));
        }
    }
    bench
}

#[test]
fn interdigital_takes_the_moments_and_the_camera_of_the_literature_and_mends_the_broken_file() {
    let bench = interdigital("");
    let whole = png(64, 48, 9 + 173);
    bench.put("Birthday_undist_00173_09.png", &whole[..whole.len() / 2]);
    let capture = bench.read(Source::InterDigital).unwrap();
    assert_eq!(capture.frames, [151, 172, 173]);
    assert_eq!(held_out(&capture), ["cam10"]);
    for (number, camera) in capture.cameras.iter().enumerate() {
        assert_rays(camera, 151, pose(number), [80.5, 80.5 * 1.01, 30.0 + number as f64, 25.0]);
    }
    assert_eq!(capture.substituted.len(), 1);
    let gone = &capture.substituted[0];
    assert_eq!((gone.view.as_str(), gone.frame, gone.shows), ("cam09", 173, 172));
    assert!(gone.why.contains("damaged"), "{}", gone.why);
    assert_eq!(bench.picture(&capture, "cam09", 173), painted(64, 48, 9 + 172));
    assert_eq!(bench.picture(&capture, "cam08", 173), painted(64, 48, 8 + 173));
}

#[test]
fn interdigital_with_lenses_is_refused_with_the_variant_to_take() {
    let bench = interdigital(" 0.1 0.02");
    let error = bench.read(Source::InterDigital).unwrap_err();
    assert!(error.to_string().contains("distortion"), "{error}");
    assert!(error.hint().contains("Undistorted"));
}

#[test]
fn a_view_without_a_whole_picture_is_refused() {
    let bench = interdigital("");
    for moment in [151, 172, 173] {
        bench.put(&format!("Birthday_undist_{moment:05}_03.png"), &png(64, 48, 1)[..200]);
    }
    let error = bench.read(Source::InterDigital).unwrap_err();
    assert!(error.to_string().contains("view cam03"), "{error}");
}

fn hypernerf(skew: f64) -> Bench {
    let bench = Bench::new();
    let mut metadata = serde_json::Map::new();
    let mut ids = Vec::new();
    for (moment, side) in [(0, "left1"), (0, "right1"), (1, "left1"), (2, "left1"), (2, "right1")] {
        let id = format!("{side}_{moment:06}");
        let number = moment + 3 * usize::from(side == "right1");
        let seen = pose(number).inverse();
        let rows: Vec<Vec<f64>> =
            (0..3).map(|row| (0..3).map(|column| seen.col(column)[row]).collect()).collect();
        let card = json!({
            "orientation": rows, "position": pose(number).w_axis.truncate().to_array(), "focal_length": 160.0,
            "principal_point": [66.0, 47.0], "skew": skew, "pixel_aspect_ratio": 1.02,
            "radial_distortion": [0.0, 0.0, 0.0], "tangential": [0.0, 0.0], "image_size": [128, 96],
        });
        bench.put(&format!("camera/{id}.json"), card.to_string());
        bench.put(&format!("rgb/2x/{id}.png"), png(64, 48, number as u32));
        metadata.insert(id.clone(), json!({"warp_id": moment, "appearance_id": moment, "camera_id": 0}));
        ids.push(id);
    }
    let (train, val): (Vec<&String>, Vec<&String>) = ids.iter().partition(|id| id.starts_with("left"));
    bench.put(
        "dataset.json",
        json!({"count": 5, "num_exemplars": 3, "ids": ids, "train_ids": train, "val_ids": val}).to_string(),
    );
    bench.put("metadata.json", serde_json::Value::Object(metadata).to_string());
    bench
}

#[test]
fn hypernerf_cameras_move_and_the_one_that_is_not_trained_on_is_held_out() {
    let bench = hypernerf(0.0);
    let capture = bench.read(Source::HyperNerf).unwrap();
    assert_eq!(capture.frames, [0, 1, 2]);
    assert_eq!(held_out(&capture), ["right1"]);
    let intrinsics = [80.0, 80.0 * 1.02, 33.0, 23.5];
    for moment in 0..3 {
        assert_rays(&capture.cameras[0], moment, pose(moment as usize), intrinsics);
    }
    assert_rays(&capture.cameras[1], 2, pose(5), intrinsics);
    assert_eq!(capture.unseen.len(), 1);
    assert_eq!(capture.unseen[&capture.cameras[1].name], [1]);
    assert!(capture.notes.iter().any(|note| note.contains("rgb/2x")));
}

#[test]
fn hypernerf_skew_and_ids_that_leave_the_folder_are_refused() {
    assert!(hypernerf(0.1).read(Source::HyperNerf).is_err());
    let bench = hypernerf(0.0);
    bench.put("dataset.json", json!({"ids": ["../../etc/passwd"]}).to_string());
    let error = bench.read(Source::HyperNerf).unwrap_err();
    assert!(error.to_string().contains("leaves the folder"), "{error}");
}

/// Exports one moment of the world into the folder of a source.
fn exported(format: Format) -> (World, Bench) {
    let (world, bench) = (World::new(), Bench::new());
    let (scene, out) = (world.dir(), world.out("exported"));
    let request = ExportRequest {
        frames: &[48],
        points: 500,
        ..ExportRequest::new(Origin::Rendered(&scene), format, &out)
    };
    export(request, &|| {}).unwrap();
    std::fs::rename(out.join("frame_0048"), bench.input()).unwrap();
    (world, bench)
}

#[test]
fn what_we_export_for_colmap_and_nerfstudio_comes_back() {
    for (format, source) in [(Format::Colmap, Source::Colmap), (Format::Nerfstudio, Source::Nerfstudio)] {
        let (world, bench) = exported(format);
        let capture = bench.read(source).unwrap();
        assert_eq!((capture.width, capture.height, &capture.frames[..]), (128, 96, &[0][..]));
        for camera in &capture.cameras {
            let ours = world.scene.camera(&camera.name).unwrap();
            assert_rays(camera, 0, ours.world_from_camera(0), [ours.fx, ours.fy, ours.cx, ours.cy]);
            if camera.name.as_str() != TEST_VIEW {
                let shown =
                    l4d_frames::Display::new(world.scene.exposure).picture(&world.frame(&camera.name, 48));
                assert_eq!(bench.picture(&capture, &camera.name, 0), shown);
            }
        }
        let expected: &[&str] = if source == Source::Nerfstudio { &[TEST_VIEW] } else { &[] };
        assert_eq!(held_out(&capture), expected, "{format}");
    }
}

#[test]
fn points_and_tracks_of_a_model_survive_the_way_in_and_out() {
    let (world, bench) = exported(Format::Colmap);
    let theirs = Model::read(&bench.input().join("sparse/0")).unwrap();
    let capture = bench.read(Source::Colmap).unwrap();
    assert_eq!(capture.points, theirs.points.len());
    assert!(capture.inputs.contains_key("sparse/0/points3D.bin"));
    // The capture is in a folder of another name than its own.
    let dir = CaptureDir::new(bench.out().parent().unwrap(), "out");
    let out = world.out("again");
    let request = ExportRequest {
        points: usize::MAX,
        ..ExportRequest::new(Origin::Captured(&dir), Format::Colmap, &out)
    };
    export(request, &|| {}).unwrap();
    let ours = Model::read(&out.join("frame_0000/sparse/0")).unwrap();
    let name_of =
        |model: &Model, id: u32| model.images.iter().find(|image| image.id == id).unwrap().name.clone();
    let seen = |model: &Model, index: usize| -> Vec<String> {
        model.points[index].track.iter().map(|(image, _)| name_of(model, *image)).collect()
    };
    // Points of one picture alone are not triangulated ones.
    let kept: Vec<usize> =
        (0..theirs.points.len()).filter(|&index| theirs.points[index].track.len() > 1).collect();
    assert!(kept.len() > 250 && kept.len() == ours.points.len());
    for (index, there) in kept.into_iter().enumerate() {
        let (ours_at, theirs_at) = (&ours.points[index], &theirs.points[there]);
        assert_eq!((ours_at.position, ours_at.rgb), (theirs_at.position, theirs_at.rgb));
        assert_eq!(seen(&ours, index), seen(&theirs, there));
    }
}

#[test]
fn distortion_is_removed() {
    let (world, bench) = exported(Format::Colmap);
    let sparse = bench.input().join("sparse/0");
    let mut model = Model::read(&sparse).unwrap();
    for camera in &mut model.cameras {
        camera.model = CameraModel::OpenCv;
        camera.parameters.extend([0.1, 0.0, 0.0, 0.0]);
    }
    model.write(&sparse).unwrap();
    let capture = bench.read(Source::Colmap).unwrap();
    assert!(capture.notes.iter().any(|note| note.contains("distortion is removed")));
    let shown = l4d_frames::Display::new(world.scene.exposure).picture(&world.frame("cam00", 48));
    let straight = bench.picture(&capture, "cam00", 0);
    // The lens widens: a corner of the pinhole lies outside of what it saw, the middle stays.
    assert_eq!(straight.get_pixel(0, 0).0, [0; 3]);
    for (a, b) in straight.get_pixel(64, 48).0.into_iter().zip(shown.get_pixel(64, 48).0) {
        assert!(a.abs_diff(b) < 12);
    }
}

#[test]
fn nerfstudio_without_a_lens_or_with_a_path_that_leaves_is_refused() {
    let frame = |path: &str| json!({"file_path": path, "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]});
    let document = |more: serde_json::Value, path: &str| {
        let mut document = json!({"w": 64, "h": 48, "fl_x": 70.0, "frames": [frame(path)]});
        document.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        document.to_string()
    };
    for (text, said) in [
        (document(json!({}), "../secret.png"), "leaves the folder"),
        (document(json!({"camera_model": "OPENCV_FISHEYE"}), "a.png"), "no perspective lens"),
        (document(json!({"fl_x": null}), "a.png"), "focal length"),
        (document(json!({}), "missing.png"), "none of them is there"),
    ] {
        let bench = Bench::new();
        bench.put("transforms.json", text);
        let error = bench.read(Source::Nerfstudio).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
    let bench = Bench::new();
    bench.put("transforms.json", document(json!({}), "images/a.png"));
    bench.put("images/a.png", png(64, 48, 3));
    let capture = bench.read(Source::Nerfstudio).unwrap();
    let looking_down = DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0));
    assert_rays(&capture.cameras[0], 0, looking_down, [70.0, 70.0, 32.0, 24.0]);
}

#[test]
fn pictures_of_several_sizes_are_refused() {
    let bench = neu3d();
    for (number, name) in ["cam00", "cam04", "cam07"].into_iter().enumerate() {
        bench.put(&format!("{name}/images/0000.png"), png(64, if number == 2 { 40 } else { 48 }, 0));
    }
    let error = bench.read(Source::Neu3d).unwrap_err();
    assert!(error.to_string().contains("64x40, but the first picture is 64x48"), "{error}");
    assert!(Path::new(&bench.out()).join("capture.json").metadata().is_err());
}

#[test]
fn a_folder_of_something_else_is_left_alone_and_ours_is_written_again() {
    let bench = neu3d();
    for name in ["cam00", "cam04", "cam07"] {
        bench.put(&format!("{name}/images/0000.png"), png(64, 48, 1));
    }
    bench.read(Source::Neu3d).unwrap();
    let first = crate::support::files(&bench.out());
    std::fs::remove_file(bench.out().join("frames/cam04/0000.png")).unwrap();
    bench.read(Source::Neu3d).unwrap();
    assert!(crate::support::files(&bench.out()) == first);
    let error = bench.read(Source::Colmap).unwrap_err();
    assert!(error.to_string().contains("no cameras.bin"), "{error}");
    std::fs::write(bench.out().join("notes.txt"), "mine").unwrap();
    let error = bench.read(Source::Neu3d).unwrap_err();
    assert!(error.to_string().contains("`notes.txt` is there"), "{error}");
}
