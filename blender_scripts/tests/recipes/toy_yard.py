"""A box slides past its twin while a bending post leans over to touch a ball.

The smallest scene that has one of everything: a rigid mover, an armature-deformed body, twins, a landmark, a
solo event and an interaction.
"""

from math import radians

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene.keys import ease_between, key_bones, key_matrices
from l4d_blender.scene.scene import Scene
from l4d_blender.scene.timeline import FRAME_COUNT

SCALE = "tabletop"


def build(scene: Scene) -> None:
    ground = mesh.grid("ground", 6.0, 6.0, 8, 8)
    mesh.set_material(ground, principled("soil", (0.3, 0.25, 0.2), variation=0.5))
    rng = scene.rng("layout")

    slider = _crate("crate_sliding", (0.8, 0.2, 0.2))
    twin = _crate("crate_still", (0.8, 0.2, 0.2))
    start = rng.uniform(-0.9, -0.7)
    places = [(start + 1.2 * ease_between(frame, 12, 60), -0.5, 0.0) for frame in range(FRAME_COUNT)]
    turn = Matrix.Rotation(0.3, 4, "Z")
    key_matrices(slider, [Matrix.Translation(place) @ turn for place in places])
    twin.location = (0.9, 0.4, 0.0)
    sliding = scene.instance("crate_sliding", 1, "crate", slider, attributes={"colour": "red"}, front="-y")
    scene.instance("crate_still", 2, "crate", twin, attributes={"colour": "red"}, front="-y")
    scene.event(sliding, "slide", (12, 60))

    ball = mesh.ellipsoid("ball", (0.15, 0.15, 0.15), centre=(0.0, 0.0, 0.15))
    ball.location = (0.59, -0.1, 0.0)
    mesh.set_material(ball, principled("ball", (0.1, 0.3, 0.8)))
    ball_instance = scene.instance("ball", 3, "ball", ball)

    post, rig = _post()
    angles = [radians(-108.0) * ease_between(frame, 30, 70) for frame in range(FRAME_COUNT)]
    key_bones(rig, [{"upper": Matrix.Rotation(angle, 4, "Z"), "lower": Matrix()} for angle in angles])
    post_instance = scene.instance("post", 4, "post", post, front="-y")
    scene.event(post_instance, "lean", (30, 70))
    scene.event(post_instance, "touch", (66, 96), ball_instance)

    slab = mesh.cylinder("slab", 0.35, 0.1)
    slab.location = (-0.6, 0.7, 0.0)
    mesh.set_material(slab, principled("stone", (0.5, 0.5, 0.5)))
    scene.instance("slab", 1001, "slab", slab)

    scene.sun(elevation_deg=45.0, azimuth_deg=-60.0)
    scene.ambient((0.6, 0.7, 0.9), 0.6)
    scene.cameras(
        (0.0, 0.0, 0.25), radius_m=2.8, heights_m=(1.1, 1.8), arc_deg=150.0, facing_deg=-90.0, fov_deg=50.0
    )


def _crate(name: str, colour: tuple[float, float, float]) -> bpy.types.Object:
    crate = mesh.bevel_box(name, (0.3, 0.4, 0.25), 0.01)
    return mesh.set_material(crate, principled(name, colour, variation=0.3))


def _post() -> tuple[bpy.types.Object, bpy.types.Object]:
    """A rubber post 0.8 m tall with a joint half-way, and the rig that bends it."""
    post = mesh.tube("post", [(0.0, 0.0, 0.04 * i) for i in range(21)], 0.07)
    mesh.set_material(post, principled("rubber", (0.2, 0.6, 0.3)))
    rig = bpy.data.objects.new("post_rig", bpy.data.armatures.new("post_rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    lower = rig.data.edit_bones.new("lower")
    lower.head, lower.tail = (0.0, 0.0, 0.0), (0.0, 0.0, 0.4)
    upper = rig.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0.0, 0.0, 0.4), (0.0, 0.0, 0.8), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    groups = {name: post.vertex_groups.new(name=name) for name in ("lower", "upper")}
    for vertex in post.data.vertices:
        share = min(max((vertex.co.z - 0.3) / 0.2, 0.0), 1.0)
        groups["lower"].add([vertex.index], 1.0 - share, "REPLACE")
        groups["upper"].add([vertex.index], share, "REPLACE")
    post.parent = rig
    post.modifiers.new("rig", "ARMATURE").object = rig
    rig.location = Vector((0.1, -0.1, 0.0))
    return post, rig
