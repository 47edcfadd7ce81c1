"""Where things end up that are placed, and how scattered copies draw."""

from __future__ import annotations

import random
from math import radians

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.ground import Terrain
from l4d_blender.scene.placing import Loose, pose
from l4d_blender.scene.scattering import scatter, skyline
from l4d_blender.scene.scene import Scene


@pytest.fixture
def scene() -> Scene:
    return Scene("toy", "room")


def test_a_pose_is_a_point_a_heading_a_tilt_and_a_scale():
    expected = (
        Matrix.Translation((1.0, 2.0, 3.0))
        @ Matrix.Rotation(radians(30.0), 4, "Z")
        @ Matrix.Rotation(radians(-10.0), 4, "X")
        @ Matrix.Scale(2.0, 4)
    )
    assert pose((1.0, 2.0, 3.0), 30.0, tilt_deg=-10.0, scale=2.0) == expected
    assert pose((1.0, 2.0)) == Matrix.Translation((1.0, 2.0, 0.0))


def test_things_stand_on_heights_terrain_and_other_things(scene):
    terrain = Terrain(seed=3)
    table, cup = mesh.box("table", (1, 1, 1)), mesh.box("cup", (0.1, 0.1, 0.1))
    assert scene.place(table, (2.0, 0.0), 90.0) is table
    scene.place(cup, (0.2, 0.0, 0.5), 45.0, on=table)
    assert np.allclose(cup.matrix_basis, table.matrix_basis @ pose((0.2, 0.0, 0.5), 45.0), atol=1e-6)
    scene.place(cup, (30.0, 5.0, -0.1), on=terrain)
    assert cup.location.z == pytest.approx(terrain.height(30.0, 5.0) - 0.1, abs=1e-5)
    scene.place([table, cup], (0.0, 1.0), on=0.75)
    assert table.location.to_tuple() == cup.location.to_tuple() == (0.0, 1.0, 0.75)


def test_loose_things_are_near_their_spots():
    loose = Loose(random.Random(1), 0.01, 4.0)
    for _ in range(20):
        (x, y, z), heading_deg = loose(((1.0, 2.0, 0.5), 90.0), 0.5)
        assert abs(x - 1.0) <= 0.005 and abs(y - 2.0) <= 0.005 and z == 0.5
        assert abs(heading_deg - 90.0) <= 2.0


def test_scattered_copies_take_turns_and_face_the_middle(scene):
    models = [mesh.box("a", (1, 1, 1)), mesh.box("b", (1, 1, 2))]
    spots = skyline(random.Random(2), 5, (0.0, 180.0), (10.0, 10.0))
    scatter(scene, "wood", models, spots, random.Random(3), turn_deg=(0.0, 0.0), sunk_m=0.0)
    woods = [bpy.data.objects[f"wood_{k}"] for k in range(5)]
    assert {"a", "b"}.isdisjoint(obj.name for obj in bpy.data.objects)
    assert [wood.data.name for wood in woods] == ["a", "b", "a", "b", "a"]
    for wood in woods:
        assert wood.location.length == pytest.approx(10.0, abs=1e-4)
        inwards = wood.matrix_basis.to_3x3().col[1]
        assert inwards.dot(wood.location.normalized()) == pytest.approx(-1.0, abs=1e-5)
