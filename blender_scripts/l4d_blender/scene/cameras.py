"""The rig of 17 pinhole cameras: where they stand, what they mean in OpenCV terms, which of them train.

Square pixels, principal point at the image centre, horizontal field of view; poses are OpenCV
(x right, y down, z forward) as world_from_camera.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, sin, tan

import bpy
from mathutils import Matrix, Vector

from .timeline import CAMERA_COUNT, PROFILES

# Blender's cameras look along -Z with +Y up.
CAMERA_PREFIX = "cam"
OPENCV_FROM_BLENDER = Matrix.Diagonal((1.0, -1.0, -1.0, 1.0))


@dataclass(frozen=True)
class Camera:
    """A pinhole camera; `focal_over_width` times the image width is fx = fy in pixels."""

    name: str
    focal_over_width: float
    world_from_camera: Matrix

    def intrinsics(self, width: int, height: int) -> dict[str, float]:
        """fx, fy, cx, cy in pixels for an image size; pixel centres are at +0.5."""
        f = self.focal_over_width * width
        return {"fx": f, "fy": f, "cx": width / 2, "cy": height / 2}


def arc_rig(
    target: Vector,
    radius_m: float,
    heights_m: Sequence[float],
    arc: float,
    facing: float,
    fov: float,
    jitter: float,
    rng: random.Random,
) -> list[Camera]:
    """17 cameras, evenly spread over `arc` radians, heights in turn, each a little off its place."""
    rig = []
    for i in range(CAMERA_COUNT):
        step = arc / (CAMERA_COUNT - 1)
        azimuth = facing - arc / 2 + step * (i + rng.uniform(-0.2, 0.2) * min(1.0, jitter / 0.02))
        distance = radius_m * (1.0 + rng.uniform(-jitter, jitter))
        height = heights_m[i % len(heights_m)] + radius_m * rng.uniform(-jitter, jitter) / 2
        position = Vector((target.x + distance * cos(azimuth), target.y + distance * sin(azimuth), height))
        off = Vector([radius_m * rng.uniform(-jitter, jitter) for _ in range(3)])
        pose = _round(_look_at(position, target + off))
        rig.append(Camera(f"{CAMERA_PREFIX}{i:02}", round(0.5 / tan(fov / 2), 6), pose))
    return rig


def add_to_blender(camera: Camera) -> bpy.types.Object:
    """The Blender camera object with this pose and lens, added to the current scene."""
    data = bpy.data.cameras.new(camera.name)
    data.type, data.sensor_fit = "PERSP", "HORIZONTAL"
    data.sensor_width = 36.0
    data.lens = camera.focal_over_width * data.sensor_width
    obj = bpy.data.objects.new(camera.name, data)
    obj.matrix_world = camera.world_from_camera @ OPENCV_FROM_BLENDER
    data.clip_start, data.clip_end = 0.001, 10_000.0
    bpy.context.scene.collection.objects.link(obj)
    return obj


def nearer(
    rig: Sequence[Camera], centre: Vector, half_width_m: float, least_rise: float, rng: random.Random
) -> list[Camera]:
    """The same cameras closer to `centre`, with longer lenses: pictures are about two half widths wide there.

    None goes further away; all look down by `least_rise` (height over distance) or more.
    """
    closer, longer = [], rng.uniform(1.15, 1.35)
    for camera in rig:
        old = camera.world_from_camera.translation
        way = Vector((old.x - centre.x, old.y - centre.y))
        wanted = 2.0 * longer * camera.focal_over_width * half_width_m
        distance = min(way.length, wanted * rng.uniform(1.0, 1.04))
        rise = max((old.z - centre.z) / way.length, least_rise)
        flat = way.normalized() * (distance / hypot(1.0, rise))
        position = Vector((centre.x + flat.x, centre.y + flat.y, centre.z + rise * flat.length))
        off = Vector([half_width_m * rng.uniform(-0.03, 0.03) for _ in range(3)])
        pose = _round(_look_at(position, centre + off))
        focal = max(distance / (2.0 * half_width_m), camera.focal_over_width)
        closer.append(Camera(camera.name, round(focal, 6), pose))
    return closer


def training_subset(training: Sequence[str], count: int) -> list[str]:
    """`count` of the training views, spread evenly over the arc, both ends included."""
    if count >= len(training):
        return list(training)
    return [training[round(i * (len(training) - 1) / (count - 1))] for i in range(count)]


def profiles_of(name: str, test: str, rig: Sequence[Camera]) -> list[str]:
    """Names of the profiles that render a camera, given which one is held out as the test view."""
    training = [camera.name for camera in rig if camera.name != test]
    return [
        profile.name
        for profile in PROFILES.values()
        if name == test or name in training_subset(training, profile.training_views)
    ]


def _look_at(position: Vector, target: Vector) -> Matrix:
    """world_from_camera (OpenCV) of a camera that stays level."""
    forward = (target - position).normalized()
    right = forward.cross(Vector((0.0, 0.0, 1.0))).normalized()
    down = forward.cross(right)
    pose = Matrix((right, down, forward)).transposed().to_4x4()
    pose.translation = position
    return pose


def _round(matrix: Matrix) -> Matrix:
    return Matrix([[round(x, 6) for x in row] for row in matrix])
