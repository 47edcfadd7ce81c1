"""A ball of wool: bundles of parallel strands wound in many directions."""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.scene.catalogue import colours, kind

from ..scene.colour import rgb

RED = (0.50, 0.022, 0.030)


@kind("toy", (0.143, 0.142, 0.143), "graspable", "rolls", colour=colours("colour"))
def yarn_ball(
    name: str, rng: random.Random, *, radius_m: float = 0.072, colour: tuple[float, float, float] = RED
) -> bpy.types.Object:
    """Origin at the bottom; balls built from equal random states are twins to the last strand."""
    strand = 0.0052
    wool = interior.wool(f"{name}_wool", colour, rng)
    deep = interior.wool(f"{name}_inner", rgb(0.45 * c for c in colour), rng)
    core = mesh.set_material(mesh.ellipsoid(f"{name}_core", (radius_m - 0.007,) * 3, 28, 18), deep)
    parts = [core]
    for bundle in range(9):
        axis = Vector((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1))).normalized()
        turn = axis.to_track_quat("Z", "Y").to_matrix().to_4x4()
        count = rng.choice((3, 4, 5))
        middle = rng.uniform(-0.30, 0.30) * radius_m
        layer = radius_m - strand - 0.0032 * (1 - bundle / 8)
        for k in range(count):
            offset = middle + (k - (count - 1) / 2) * strand * 1.85
            parts.append(mesh.set_material(_loop(f"{name}_strand", rng, layer, offset, strand, turn), wool))
    ball = mesh.join(name, parts)
    return mesh.move(ball, z=radius_m)


def _loop(
    name: str, rng: random.Random, layer: float, offset: float, strand: float, turn: Matrix
) -> bpy.types.Object:
    """A strand once round the ball, `offset` metres off its middle plane, not quite flat."""
    segments, sides = 40, 5
    phase, sway = rng.uniform(0, 6.28), rng.uniform(0.001, 0.003)
    verts, faces = [], []
    for i in range(segments):
        a = 2 * math.pi * i / segments
        z = offset + sway * math.sin(2 * a + phase)
        ring = math.sqrt(max(layer * layer - z * z, 1e-8))
        centre = Vector((ring * math.cos(a), ring * math.sin(a), z))
        out = centre.normalized()
        along = Vector((-math.sin(a), math.cos(a), 0))
        across = out.cross(along)
        for j in range(sides):
            b = 2 * math.pi * j / sides
            verts.append(turn @ (centre + strand * (math.cos(b) * out + math.sin(b) * across)))
    for i in range(segments):
        k, n = i * sides, ((i + 1) % segments) * sides
        faces += [(k + j, n + j, n + (j + 1) % sides, k + (j + 1) % sides) for j in range(sides)]
    obj = mesh.from_pydata(name, verts, faces)
    obj.data.flip_normals()
    return obj
