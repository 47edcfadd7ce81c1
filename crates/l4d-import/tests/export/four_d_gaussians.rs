//! The readers of 4DGaussians and 4D LangSplat.

use std::path::Path;

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use l4d_formats::Tensor;
use l4d_formats::npy::{self, Contents};
use l4d_import::export::{Format, HeldOut};

use crate::support::{TEST_VIEW, World};
use crate::{Kind, RAY_TOLERANCE_PX, exported, exported_as, json, matrix, png, probes, shown, try_export};

/// Where the rasterizer of 3DGS puts a point, in pixels with centres at integers.
fn rasterized(projection: DMat4, view: DMat4, point: DVec3, size: [f64; 2]) -> DVec2 {
    let clip: DVec4 = projection * view * point.extend(1.0);
    let ndc = clip.truncate() / clip.w;
    DVec2::new(((ndc.x + 1.0) * size[0] - 1.0) / 2.0, ((ndc.y + 1.0) * size[1] - 1.0) / 2.0)
}

/// What 3DGS readers build of intrinsics: how much they enlarge, and where they put the axis.
fn projection(scale: [f64; 2], shift: [f64; 2]) -> DMat4 {
    let (near, far) = (0.01, 100.0);
    let depth = [0.0, 0.0, far / (far - near), -(far * near) / (far - near)];
    let rows = [[scale[0], 0.0, shift[0], 0.0], [0.0, scale[1], shift[1], 0.0], depth, [0.0, 0.0, 1.0, 0.0]];
    DMat4::from_cols_array_2d(&rows).transpose()
}

#[test]
fn panoptic_sports_reads_cameras_moments_split_and_points() {
    let mut world = World::new();
    // What no other reader of 4DGaussians holds: a principal point off the centre, two focal lengths.
    world.change(|scene| {
        for (index, camera) in scene.cameras.iter_mut().enumerate() {
            camera.cx += 3.25 + index as f64;
            camera.cy -= 1.5;
            camera.fy = 133.0 + index as f64;
        }
    });
    for kind in Kind::ALL {
        let out = world.out(&format!("panoptic-{kind:?}"));
        exported_as(kind, &world, Format::FourDGaussians, HeldOut::Pose, &out);
        assert_panoptic_sports(&world, &out);
    }
}

fn assert_panoptic_sports(world: &World, out: &Path) {
    let train = json(&out.join("train_meta.json"));
    let test = json(&out.join("test_meta.json"));
    let test_camera = world.scene.test_camera().unwrap();
    for (meta, cameras) in [(&train, world.training()), (&test, vec![test_camera])] {
        let (w, h) = (meta["w"].as_f64().unwrap(), meta["h"].as_f64().unwrap());
        let moments = meta["fn"].as_array().unwrap().len();
        assert_eq!(moments, 9);
        for (moment, &frame) in world.frames().iter().enumerate() {
            for (index, camera) in cameras.iter().enumerate() {
                let k = &meta["k"][moment][index];
                let value = |row: usize, column: usize| k[row][column].as_f64().unwrap();
                let (fx, fy, cx, cy) = (value(0, 0), value(1, 1), value(0, 2), value(1, 2));
                let shift = [-(w - 2.0 * cx) / w, -(h - 2.0 * cy) / h];
                let projection = projection([2.0 * fx / w, 2.0 * fy / h], shift);
                let view = matrix(&meta["w2c"][moment][index]);
                for (point, at) in probes(camera, frame) {
                    let seen = rasterized(projection, view, point, [w, h]) + 0.5;
                    assert!((seen - at).length() < RAY_TOLERANCE_PX, "{}: {seen} for {at}", camera.name);
                }
                let name = meta["fn"][moment][index].as_str().unwrap();
                let picture = png(&out.join("ims").join(name), 128, 96);
                if camera.name.as_str() == TEST_VIEW {
                    assert!(picture.pixels().all(|pixel| pixel.0 == [128; 3]));
                } else {
                    assert_eq!(picture, shown(world, &camera.name, frame));
                }
            }
        }
    }
}

#[test]
fn the_first_points_lie_on_surfaces() {
    let world = World::new();
    let out = world.out("points");
    exported(&world, Format::FourDGaussians, HeldOut::Pose, &out);
    let points = l4d_formats::arrays::read(&out.join("init_pt_cld.npz"), Some("data")).unwrap();
    assert_eq!(points.shape[1], 6);
    assert!((1800..2200).contains(&points.shape[0]), "{} points for 2000", points.shape[0]);
    for row in points.data.chunks(6) {
        assert!(row[2] > -1e-5, "nothing lies below the ground, but {row:?}");
        assert!(row[3..].iter().all(|value| (0.0..=1.0).contains(value)));
    }
}

/// Rotation and translation that the reader of Neu3D hands to the rasterizer, and the focal length that it uses.
fn neu3d_camera(row: &[f64], first: &[f64]) -> (DMat4, f64) {
    let column = |index: usize| DVec3::new(row[index], row[5 + index], row[10 + index]);
    let focal = first[14] / 2.0;
    // Its own axes: columns 1, -0, 2; then the matrix is negated and its first column turned back.
    let pose = DMat3::from_cols(column(1), -column(0), column(2));
    let rotation = DMat3::from_cols(pose.x_axis, -pose.y_axis, -pose.z_axis);
    let centre = column(3);
    let translation = -(rotation.transpose() * centre);
    let view = DMat4::from_mat3(rotation.transpose());
    (DMat4::from_translation(translation) * view, focal)
}

#[test]
fn dynerf_reads_the_same_rays_at_its_own_size() {
    let world = World::new();
    let formats = [(Format::Dynerf, 9), (Format::FourDLangSplat, 300)];
    for (kind, (format, moments)) in
        Kind::ALL.into_iter().flat_map(|kind| formats.map(|format| (kind, format)))
    {
        let out = world.out(&format!("{format}-{kind:?}"));
        exported_as(kind, &world, format, HeldOut::Pose, &out);
        let bytes = std::fs::read(out.join("poses_bounds.npy")).unwrap();
        let poses: Tensor<f64> = npy::decode(&bytes).and_then(Contents::into_numbers).unwrap();
        assert_eq!(poses.shape, [5, 17]);
        let rows: Vec<&[f64]> = poses.data.chunks(17).collect();
        let videos = std::fs::read_dir(&out).unwrap().filter(|entry| {
            let name = entry.as_ref().unwrap().file_name().into_string().unwrap();
            name.starts_with("cam") && name.ends_with(".mp4")
        });
        assert_eq!(videos.count(), 5);
        let mut cameras = vec![world.scene.test_camera().unwrap()];
        cameras.extend(world.training());
        for (number, camera) in cameras.iter().enumerate() {
            let (view, focal) = neu3d_camera(rows[number], rows[0]);
            let size = [1352.0, 1014.0];
            let half_angles = size.map(|side| (side / 2.0 / focal).atan());
            let projection = projection(half_angles.map(|angle| 1.0 / angle.tan()), [0.0; 2]);
            for (point, at) in probes(camera, 0) {
                // Pictures are enlarged to the reader's size.
                let seen = (rasterized(projection, view, point, size) + 0.5) * (128.0 / 1352.0);
                assert!((seen - at).length() < RAY_TOLERANCE_PX, "{}: {seen} for {at}", camera.name);
            }
            let [near, far] = [rows[number][15], rows[number][16]];
            assert!(0.5 < near && near < far && far < 40.0, "bounds {near} to {far}");
            let images = out.join(format!("cam{number:02}/images"));
            let mut names: Vec<_> = std::fs::read_dir(&images).unwrap().map(|e| e.unwrap().path()).collect();
            names.sort();
            assert_eq!(names.len(), moments);
            for (moment, path) in names.iter().enumerate() {
                let frame = world.frames()[moment.min(8)];
                let picture = png(path, 128, 96);
                match number {
                    0 => assert!(picture.pixels().all(|pixel| pixel.0 == [128; 3])),
                    _ => assert_eq!(picture, shown(&world, &camera.name, frame)),
                }
            }
        }
    }
}

#[test]
fn what_a_reader_would_drop_is_refused_with_the_format_that_keeps_it() {
    type Change = fn(&mut l4d_data::Scene);
    let changes: [(&str, Change); 3] = [
        ("principal point", |scene| scene.cameras[1].cx += 0.5),
        ("focal length", |scene| scene.cameras[3].fy *= 1.01),
        ("moves", |scene| {
            let pose = scene.cameras[0].world_from_camera[0];
            scene.cameras[0].world_from_camera = vec![pose; 97];
        }),
    ];
    for (said, change) in changes {
        let mut world = World::new();
        world.change(change);
        let error = try_export(&world, Format::Dynerf, HeldOut::Pose, &world.out("no")).unwrap_err();
        assert!(!world.out("no").exists(), "nothing is written before it is refused");
        assert!(error.to_string().contains(said), "{error}");
        assert!(error.hint().contains("--format 4dgaussians"));
        exported(&world, Format::FourDGaussians, HeldOut::Pose, &world.out("yes"));
    }
}
