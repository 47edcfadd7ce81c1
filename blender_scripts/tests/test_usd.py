"""scene.usdc read back with usd-core: prims, ids, labels, time samples, camera poses."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from conftest import PROJECT, TOY
from pxr import Gf, Usd, UsdGeom, UsdSemantics, UsdShade, UsdSkel


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


def test_a_deforming_body_is_moved_by_its_bones(stage, tracks):
    body = prim_of(stage, "post")
    (mesh,) = [prim for prim in Usd.PrimRange(body) if prim.IsA(UsdGeom.Mesh)]
    assert not UsdGeom.Mesh(mesh).GetPointsAttr().GetTimeSamples(), "bones in place of points per frame"
    root = UsdSkel.Root.Find(mesh)
    skeletons = UsdSkel.Cache()
    skeletons.Populate(root, Usd.PrimDefaultPredicate)
    (binding,) = skeletons.ComputeSkelBindings(root, Usd.PrimDefaultPredicate)
    skeleton = skeletons.GetSkelQuery(binding.GetSkeleton())
    skinning = skeletons.GetSkinningQuery(mesh)
    post = next(entry for entry in tracks["instances"] if entry["name"] == "post")
    for frame in (0, 50, 96):
        points = UsdGeom.Mesh(mesh).GetPointsAttr().Get()
        assert skinning.ComputeSkinnedPoints(skeleton.ComputeSkinningTransforms(frame), points, frame)
        world = UsdGeom.Xformable(skeleton.GetPrim()).ComputeLocalToWorldTransform(frame)
        moved = np.array([world.Transform(Gf.Vec3d(*map(float, p))) for p in points])
        assert np.ptp(moved, axis=0) == pytest.approx(post["track"]["extents"][frame], abs=1e-5)
        centre = (moved.min(axis=0) + moved.max(axis=0)) / 2
        assert centre == pytest.approx(post["track"]["centre"][frame], abs=1e-5)


def test_normals_are_stored_once_and_face_outwards(stage):
    interpolations = set()
    for mesh in filter(None, map(UsdGeom.Mesh, stage.Traverse())):
        corners = np.array(mesh.GetFaceVertexIndicesAttr().Get())
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
        points = np.array(mesh.GetPointsAttr().Get(), np.float64)
        faces = np.repeat(np.arange(len(counts)), counts)
        primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
        stored, kind = mesh.GetNormalsAttr().Get(), mesh.GetNormalsInterpolation()
        if primvar.HasValue():
            assert primvar.IsIndexed()
            stored, kind, normals = primvar.Get(), "indexed", np.array(primvar.ComputeFlattened())
        else:
            normals = np.array(stored)[{"vertex": corners, "uniform": faces}[kind]]
        interpolations.add(kind)
        assert len(stored) < len(corners)
        assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-5)
        starts = np.cumsum(counts) - counts
        a, b, c = (points[corners[starts + i]] for i in range(3))
        outwards = np.cross(b - a, c - a)[faces]
        assert (np.einsum("ij,ij->i", normals, outwards) > 0.0).all()
    assert interpolations == {"vertex", "indexed"}


def test_a_stage_holds_nothing_twice_and_nothing_for_blender_alone(stage, planned):
    assert (planned / "scene.usdc").stat().st_size < 50_000
    primvars = {
        primvar.GetPrimvarName()
        for prim in stage.Traverse()
        for primvar in UsdGeom.PrimvarsAPI(prim).GetAuthoredPrimvars()
    }
    assert primvars == {"normals", "skel:geomBindTransform", "skel:jointIndices", "skel:jointWeights"}


def test_materials_have_their_colour_and_read_nothing(stage):
    shaders = {
        prim.GetParent().GetName(): UsdShade.Shader(prim)
        for prim in stage.Traverse()
        if prim.IsA(UsdShade.Shader)
    }
    assert {shader.GetIdAttr().Get() for shader in shaders.values()} == {"UsdPreviewSurface"}
    assert not [i for shader in shaders.values() for i in shader.GetInputs() if i.HasConnectedSource()]
    for name, colour in {
        "crate_sliding": (0.8, 0.2, 0.2),
        "ball": (0.1, 0.3, 0.8),
        "soil": (0.3, 0.25, 0.2),
    }.items():
        assert list(shaders[name].GetInput("diffuseColor").Get()) == pytest.approx(colour, abs=1e-6)


def test_the_bytes_do_not_depend_on_addresses(planned, tmp_path):
    """A second plan, in which USD meets the names of its fields in another order."""
    script = (
        "import sys\n"
        "from pxr import Trace\n"
        "collector = Trace.Collector()\n"
        "collector.enabled = True\n"
        "for name in ('interpolation', 'elementSize', 'default', 'connectionPaths'):\n"
        "    collector.BeginEvent(name)\n"
        "collector.enabled = False\n"
        "from l4d_blender.worker.cli import main\n"
        "main(['plan', '--scene', 'toy_yard', '--recipes', *sys.argv[1:]])\n"
    )
    command = [sys.executable, "-c", script, str(TOY), "--out", str(tmp_path)]
    subprocess.run(command, cwd=PROJECT, stdin=subprocess.DEVNULL, check=True, timeout=300)
    assert (tmp_path / "scene.usdc").read_bytes() == (planned / "scene.usdc").read_bytes()


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
