"""What a recipe may not do, and the helpers that recipes and assets stand on."""

from __future__ import annotations

import random
from math import pi, radians

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.scene import keys
from l4d_blender.scene.scene import Instance, RecipeError, Scene


@pytest.fixture
def scene() -> Scene:
    return Scene("toy", "tabletop")


def add(scene: Scene, name: str, id: int, **options) -> Instance:
    return scene.instance(name, id, "thing", mesh.box(name, (1, 1, 1)), **options)


@pytest.mark.parametrize(
    ("frames", "complaint"),
    [
        ((0, 11), "12 frames long"),
        ((-1, 20), "outside 0..96"),
        ((80, 97), "outside 0..96"),
        ((50, 40), "0 frames"),
    ],
)
def test_events_are_long_enough_and_inside_the_clip(scene, frames, complaint):
    thing = add(scene, "thing", 1)
    with pytest.raises(RecipeError, match=complaint):
        scene.event(thing, "roll", frames)
    scene.event(thing, "roll", (0, 12))
    assert len(scene.events) == 1


def test_events_name_registered_instances(scene):
    thing = add(scene, "thing", 1)
    other = add(Scene("elsewhere", "room"), "stranger", 2)
    with pytest.raises(RecipeError, match="stranger is not an instance"):
        scene.event(thing, "push", (0, 50), other)
    with pytest.raises(RecipeError, match="same instance"):
        scene.event(thing, "push", (0, 50), thing)


def test_ids_and_names_are_unique_and_in_range(scene):
    add(scene, "thing", 1)
    for name, id in (("thing", 2), ("other", 1)):
        with pytest.raises(RecipeError, match="clashes"):
            add(scene, name, id)
    for id in (0, 1000, 40000, -3):
        with pytest.raises(RecipeError, match="out of range"):
            add(scene, f"thing_{abs(id)}", id)
    with pytest.raises(RecipeError, match="out of range for a object"):
        add(scene, "table", 1001, role="object")
    with pytest.raises(RecipeError, match="snake_case"):
        add(scene, "Red Cup", 7)


def test_live_modifiers_and_constraints_are_refused(scene):
    thing = add(scene, "thing", 1)
    scene.cameras((0, 0, 0), radius_m=3, heights_m=(1, 2), arc_deg=90, facing_deg=0, fov_deg=50)
    scene.check()
    thing.objects[0].modifiers.new("bevel", "BEVEL")
    with pytest.raises(RecipeError, match="live modifiers: BEVEL"):
        scene.check()


def test_random_streams_depend_on_key_and_seed_only():
    draws = {
        (seed, key): Scene("toy", "room", seed).rng(key).random() for seed in (0, 1) for key in ("a", "b")
    }
    assert len(set(draws.values())) == 4
    assert Scene("toy", "room", 0).rng("a").random() == draws[0, "a"]
    # The streams of the shipped scenes, to the bit.
    assert draws[1, "a"] == random.Random("toy/a/1.0").random()


def test_keyed_matrices_come_back_at_their_frames(scene):
    cube, parent = mesh.box("cube", (1, 1, 1)), mesh.box("parent", (1, 1, 1))
    path = [Matrix.Translation((f / 10, 0, 0)) @ Matrix.Rotation(f * 0.1, 4, "Z") for f in range(97)]
    keys.key_matrices(cube, path)
    cube.parent, parent.location = parent, (0, 0, 5)
    for frame in (0, 17, 60, 96):
        bpy.context.scene.frame_set(frame)
        expected = Matrix.Translation((0, 0, 5)) @ path[frame]
        for matrix in (keys.object_matrix(cube, frame), cube.matrix_world):
            assert np.allclose(matrix, expected, atol=1e-5)


def test_bones_can_be_keyed_in_the_space_of_their_armature(scene):
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    upper = rig.data.edit_bones.new("upper")
    upper.head, upper.tail = (0, 0, 0), (0, 0, 1)
    lower = rig.data.edit_bones.new("lower")
    lower.head, lower.tail, lower.parent = (0, 0, 1), (0, 0.2, 2), upper
    bpy.ops.object.mode_set(mode="OBJECT")
    rest = {bone.name: bone.matrix_local.copy() for bone in rig.data.bones}
    turn = Matrix.Rotation(radians(40), 4, "X")
    poses = [
        {"upper": turn @ rest["upper"], "lower": Matrix.Translation((0, 0, f / 96)) @ rest["lower"]}
        for f in range(97)
    ]
    keys.key_bones(rig, poses, space="armature")
    bpy.context.scene.frame_set(48)
    for name in ("upper", "lower"):
        assert np.allclose(rig.pose.bones[name].matrix, poses[48][name], atol=1e-5)


def test_easing_starts_and_ends_at_rest():
    assert [keys.ease(t) for t in (-1, 0, 0.5, 1, 2)] == [0, 0, 0.5, 1, 1]
    assert keys.ease(0.01) < 1e-4
    assert keys.ease_between(36, 12, 60) == 0.5


def test_a_path_is_measured_by_its_length():
    around = [(np.cos(a), np.sin(a)) for a in np.linspace(0, 2 * pi, 16, endpoint=False)]
    circle = keys.Path(around, closed=True)
    assert circle.length == pytest.approx(2 * pi, rel=5e-3)
    assert circle.point(circle.length * 1.25).to_tuple() == pytest.approx((0, 1, 0), abs=2e-2)
    assert circle.tangent(0).to_tuple() == pytest.approx((0, 1, 0), abs=2e-2)
    line = keys.Path([(0, 0, 0), (3, 0, 0)])
    assert line.point(99).to_tuple() == pytest.approx((3, 0, 0))


def volume(obj: bpy.types.Object) -> float:
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    assert all(edge.is_manifold for edge in bm.edges), obj.name
    signed = bm.calc_volume(signed=True)
    bm.free()
    return signed


def test_solids_are_closed_and_face_outwards(scene):
    bar = [(0, 0, 0), (0, 0, 1), (0, 0, 2)]
    solids = {
        "box": (mesh.box("box", (1, 2, 3)), 6.0),
        "bevelled": (mesh.bevel_box("bevelled", (1, 2, 3), 0.01), 6.0),
        "cylinder": (mesh.cylinder("cylinder", 1, 2, 256), 2 * pi),
        "cone": (mesh.cylinder("cone", 1, 3, 256, top_radius=0.0), pi),
        "ball": (mesh.ellipsoid("ball", (1, 1, 1), 96, 64), 4 * pi / 3),
        "ring": (mesh.torus("ring", 2, 0.5, 128, 64), pi**2),
        "tube": (mesh.tube("tube", bar, 0.5, 128), pi / 2),
        "oval tube": (mesh.tube("oval tube", bar, [(1.0, 0.25)] * 3, 128), pi / 2),
        "sheet": (mesh.solidify(mesh.grid("sheet", 1, 1, 3, 3), 0.1), 0.1),
        "melted": (
            mesh.voxel_union("melted", [mesh.box("a", (1, 1, 1)), mesh.box("b", (1, 1, 2))], 0.05, 0),
            2.0,
        ),
    }
    for name, (obj, expected) in solids.items():
        assert volume(obj) == pytest.approx(expected, rel=0.02), name


def test_joining_applies_transforms_and_keeps_materials_and_groups(scene):
    a, b = mesh.box("a", (1, 1, 1)), mesh.box("b", (1, 1, 1))
    b.location, b.scale = (3, 0, 0), (2, 1, 1)
    for obj in (a, b):
        mesh.set_material(obj, bpy.data.materials.new(obj.name))
        obj.vertex_groups.new(name=obj.name).add(range(8), 1.0, "REPLACE")
    joined = mesh.join("both", [a, b])
    assert volume(joined) == pytest.approx(3.0)
    assert joined.matrix_world == Matrix.Identity(4)
    assert max(vertex.co.x for vertex in joined.data.vertices) == pytest.approx(4.0)
    assert [slot.name for slot in joined.material_slots] == ["a", "b"]
    assert {group.name for group in joined.vertex_groups} == {"a", "b"}
    assert Vector(joined.scale) == Vector((1, 1, 1))
