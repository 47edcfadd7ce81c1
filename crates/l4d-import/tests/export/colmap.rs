//! COLMAP models as 3DGS and LangSplat read them.

use std::path::Path;

use glam::{DVec2, DVec3};
use l4d_formats::colmap::Model;
use l4d_import::export::{Format, HeldOut};

use crate::support::{TEST_VIEW, World};
use crate::{Kind, RAY_TOLERANCE_PX, exported, exported_as, png, probes, shown, try_export};

#[test]
fn models_have_the_rays_of_the_scene_and_points_that_project_where_they_are_seen() {
    let world = World::new();
    let formats = [Format::LangSplat, Format::Colmap];
    for (kind, format) in Kind::ALL.into_iter().flat_map(|kind| formats.map(|format| (kind, format))) {
        let out = world.out(&format!("{format}-{kind:?}"));
        exported_as(kind, &world, format, HeldOut::Pose, &out);
        for frame in world.frames() {
            let folder = out.join(format!("frame_{frame:04}"));
            let sparse = folder.join("sparse/0");
            let model = Model::read(&sparse).unwrap();
            assert_eq!(model.images.len(), 4);
            for image in &model.images {
                let view = image.name.strip_suffix(".png").unwrap();
                assert_ne!(view, TEST_VIEW);
                let camera = world.scene.camera(view).unwrap();
                let intrinsics = model.camera(image.camera).unwrap();
                assert_eq!((intrinsics.width, intrinsics.height), (128, 96));
                let [fx, fy, cx, cy] = intrinsics.pinhole();
                let seen = |point: DVec3| {
                    let local = image.rotation * point + image.translation;
                    DVec2::new(fx * local.x / local.z + cx, fy * local.y / local.z + cy)
                };
                for (point, at) in probes(camera, frame) {
                    assert!(
                        (seen(point) - at).length() < RAY_TOLERANCE_PX,
                        "{view}: {} for {at}",
                        seen(point)
                    );
                }
                for observation in &image.observations {
                    let point = &model.points[observation.point.unwrap() as usize - 1];
                    let distance = (seen(point.position) - DVec2::from_array(observation.position)).length();
                    assert!(distance < RAY_TOLERANCE_PX, "point {} is {distance} px off", point.id);
                }
                assert_eq!(
                    png(&folder.join("images").join(&image.name), 128, 96),
                    shown(&world, view, frame)
                );
            }
        }
    }
}

#[test]
fn langsplat_would_drop_a_principal_point_off_the_centre() {
    let mut world = World::new();
    world.change(|scene| scene.cameras[1].cx += 2.0);
    let error = try_export(&world, Format::LangSplat, HeldOut::Pose, &world.out("no")).unwrap_err();
    assert!(error.to_string().contains("the principal point of cam01"), "{error}");
    assert!(error.hint().contains("--format colmap"));
    exported(&world, Format::Colmap, HeldOut::Pose, &world.out("yes"));
}

#[test]
fn tracks_and_observations_name_each_other_and_most_points_have_several() {
    let world = World::new();
    for kind in Kind::ALL {
        let out = world.out(&format!("tracks-{kind:?}"));
        exported_as(kind, &world, Format::Colmap, HeldOut::Pose, &out);
        assert_tracks(&out);
    }
}

fn assert_tracks(out: &Path) {
    let model = Model::read(&out.join("frame_0000/sparse/0")).unwrap();
    let mut observed = 0;
    for point in &model.points {
        assert!(!point.track.is_empty(), "point {} is seen by no camera", point.id);
        for &(image, place) in &point.track {
            let image = model.images.iter().find(|other| other.id == image).unwrap();
            assert_eq!(image.observations[place as usize].point, Some(point.id));
        }
        observed += point.track.len();
    }
    assert_eq!(observed, model.images.iter().map(|image| image.observations.len()).sum::<usize>());
    let several = model.points.iter().filter(|point| point.track.len() > 1).count();
    assert!(several * 2 > model.points.len(), "{several} of {} points", model.points.len());
}

#[test]
fn the_pose_of_the_held_out_camera_stands_apart() {
    let world = World::new();
    let out = world.out("apart");
    exported(&world, Format::Colmap, HeldOut::Pose, &out);
    let rig = l4d_data::Rig::read(&out.join("held_out_camera.json")).unwrap();
    assert_eq!(rig.held_out(), world.scene.test_camera());
    let nothing = world.out("nothing");
    exported(&world, Format::Colmap, HeldOut::Nothing, &nothing);
    assert!(!nothing.join("held_out_camera.json").exists());
    let pictures = world.out("pictures");
    exported(&world, Format::Colmap, HeldOut::Pictures, &pictures);
    let path = pictures.join(format!("frame_0048/held_out/{TEST_VIEW}.png"));
    assert_eq!(png(&path, 128, 96), shown(&world, TEST_VIEW, 48));
    assert_eq!(Model::read(&pictures.join("frame_0048/sparse/0")).unwrap().images.len(), 4);
}
