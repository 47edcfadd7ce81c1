"""scene.usdc read back with usd-core: prims, ids, labels, time samples, camera poses."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdSemantics


@pytest.fixture(scope="module")
def stage(planned) -> Usd.Stage:
    return Usd.Stage.Open(str(planned / "scene.usdc"))


def prim_of(stage: Usd.Stage, name: str) -> Usd.Prim:
    (found,) = [prim for prim in stage.Traverse() if prim.GetAttribute("l4d:name").Get() == name]
    return found


def test_the_stage_has_our_units_and_our_timeline(stage):
    assert stage.GetTimeCodesPerSecond() == 24.0
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0.0, 96.0)
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0


def test_every_instance_is_a_prim_with_id_and_labels(stage, tracks):
    for entry in tracks["instances"]:
        prim = prim_of(stage, entry["name"])
        assert prim.GetAttribute("l4d:id").Get() == entry["id"]
        assert prim.GetAttribute("l4d:category").Get() == entry["category"]
        for taxonomy, label in (("category", entry["category"]), ("name", entry["name"])):
            assert list(UsdSemantics.LabelsAPI(prim, taxonomy).GetLabelsAttr().Get()) == [label]


def test_a_rigid_mover_is_where_the_tracks_say(stage, tracks):
    crate = next(entry for entry in tracks["instances"] if entry["name"] == "crate_sliding")
    prim = prim_of(stage, "crate_sliding")
    for frame in (0, 36, 96):
        world = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(frame)
        centre = world.Transform(Gf.Vec3d(0.0, 0.0, 0.125))
        assert list(centre) == pytest.approx(crate["track"]["centre"][frame], abs=1e-5)


def test_a_deforming_body_has_baked_points(stage, tracks):
    body = prim_of(stage, "post")
    (mesh,) = [prim for prim in Usd.PrimRange(body) if prim.IsA(UsdGeom.Mesh)]
    points = UsdGeom.Mesh(mesh).GetPointsAttr()
    assert len(points.GetTimeSamples()) > 30
    post = next(entry for entry in tracks["instances"] if entry["name"] == "post")
    for frame in (0, 50, 96):
        world = UsdGeom.Xformable(mesh).ComputeLocalToWorldTransform(frame)
        moved = np.array([world.Transform(Gf.Vec3d(*map(float, p))) for p in points.Get(frame)])
        assert np.ptp(moved, axis=0) == pytest.approx(post["track"]["extents"][frame], abs=1e-5)
    assert not [prim for prim in stage.Traverse() if prim.GetTypeName() == "Skeleton"]


def test_cameras_stand_where_the_tracks_say_and_see_as_much(stage, tracks):
    cameras = {
        prim.GetParent().GetName(): UsdGeom.Camera(prim)
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Camera)
    }
    assert len(cameras) == 17
    for entry in tracks["cameras"]:
        camera = cameras[entry["name"]]
        lens = camera.GetCamera(0)
        assert lens.focalLength / lens.horizontalAperture == pytest.approx(
            entry["focal_over_width"], abs=1e-5
        )
        assert lens.horizontalAperture / lens.verticalAperture == pytest.approx(4 / 3, abs=1e-5)
        world = np.array(camera.ComputeLocalToWorldTransform(0)).T
        opencv = world @ np.diag([1.0, -1.0, -1.0, 1.0])
        assert opencv.ravel() == pytest.approx(entry["world_from_camera"][0], abs=1e-5)
