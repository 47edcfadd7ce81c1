"""Keyframes: matrices, bone poses and easing, baked to one linear key per frame.

Motion code computes where things are at each canonical frame and hands the answer to this module, so that
the render, the USD stage and the tracks all interpolate nothing and agree.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence

import bpy
from mathutils import Euler, Matrix, Quaternion, Vector

_LINEAR = 1  # Keyframe.interpolation as foreach_set wants it

Matrices = Mapping[int, Matrix] | Sequence[Matrix]
Poses = Mapping[int, Mapping[str, Matrix]] | Sequence[Mapping[str, Matrix]]


def key_matrices(obj: bpy.types.Object, matrices: Matrices) -> None:
    """Keys location, rotation and scale of `obj` (in its parent's space) at the given frames.

    A list is read as frames 0, 1, 2, ...; frames between two keys are interpolated linearly.
    """
    by_frame = _by_frame(matrices)
    frames = sorted(by_frame)
    locations, rotations, scales = _decompose([by_frame[frame] for frame in frames])
    obj.rotation_mode = "QUATERNION"
    curves = _curves(obj)
    _replace_vector(curves, "location", frames, locations)
    _replace_vector(curves, "rotation_quaternion", frames, rotations)
    _replace_vector(curves, "scale", frames, scales)
    obj.location, obj.rotation_quaternion, obj.scale = locations[0], rotations[0], scales[0]


def key_bones(rig: bpy.types.Object, poses: Poses, *, space: str = "basis") -> None:
    """Keys pose bones: per frame a mapping from bone name to matrix.

    `space` is "basis" (relative to the bone's rest pose: what `PoseBone.matrix_basis` holds) or "armature"
    (the posed bone in the rig's space: what `PoseBone.matrix` holds). In armature space a bone that a frame
    doesn't mention keeps its rest pose relative to its parent. Every frame must name the same bones.
    """
    by_frame = _by_frame(poses)
    frames = sorted(by_frame)
    names = sorted(by_frame[frames[0]])
    if space == "armature":
        by_frame = {frame: _basis_from_armature(rig, pose) for frame, pose in by_frame.items()}
    elif space != "basis":
        raise ValueError(f"space is 'basis' or 'armature', not {space!r}")
    curves = _curves(rig)
    for name in names:
        bone = rig.pose.bones[name]
        bone.rotation_mode = "QUATERNION"
        locations, rotations, scales = _decompose([by_frame[frame][name] for frame in frames])
        prefix = f'pose.bones["{name}"].'
        _replace_vector(curves, prefix + "location", frames, locations)
        _replace_vector(curves, prefix + "rotation_quaternion", frames, rotations)
        _replace_vector(curves, prefix + "scale", frames, scales)


def key_values(
    owner: bpy.types.ID, data_path: str, values: Mapping[int, float] | Sequence[float], *, index: int = 0
) -> None:
    """Keys one number (a shape key's value, a light's energy) at the given frames."""
    by_frame = _by_frame(values)
    frames = sorted(by_frame)
    _replace_curve(_curves(owner), data_path, index, frames, [by_frame[frame] for frame in frames])


def object_matrix(obj: bpy.types.Object, frame: float) -> Matrix:
    """World matrix of a keyed object at a frame, read from its keys and its parents' (bones excepted).

    Needs no scene update, so motion code may ask where something will be while it still animates.
    """
    local = obj.matrix_basis.copy()
    animation = obj.animation_data
    if animation and animation.action:
        local = _evaluate_basis(obj, frame)
    if obj.parent is None:
        return local
    if obj.parent_type != "OBJECT":
        raise ValueError(f"{obj.name} hangs on a bone; key its matrix instead")
    return object_matrix(obj.parent, frame) @ obj.matrix_parent_inverse @ local


def ease(t: float) -> float:
    """Smootherstep: 0 to 1 with zero speed and zero acceleration at both ends."""
    t = min(max(t, 0.0), 1.0)
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)


def ease_between(frame: float, first: float, last: float) -> float:
    """How far an eased move from frame `first` to frame `last` has come at `frame`: 0 before, 1 after."""
    return ease((frame - first) / (last - first))


def lerp(a: Vector, b: Vector, t: float) -> Vector:
    """The point at `t` between two points."""
    return Vector(a).lerp(Vector(b), t)


def slerp(a: Quaternion, b: Quaternion, t: float) -> Quaternion:
    """The rotation at `t` on the short way between two rotations."""
    a, b = a.normalized(), b.normalized()
    return a.slerp(-b if a.dot(b) < 0.0 else b, t)


def look_matrix(position: Vector, forward: Vector, up: Sequence[float] = (0.0, 0.0, 1.0)) -> Matrix:
    """World matrix of an asset (front = -Y, up = +Z) that stands at `position` and faces `forward`."""
    back = -Vector(forward).normalized()
    right = back.cross(Vector(up)).normalized()
    matrix = Matrix((right, back, right.cross(back))).transposed().to_4x4()
    matrix.translation = position
    return matrix


class Path:
    """A Catmull-Rom curve (centripetal) through points, measured by arc length in metres."""

    _STEPS = 48

    def __init__(self, points: Iterable[Sequence[float]], closed: bool = False) -> None:
        anchors = [Vector(point).to_3d() for point in points]
        if len(anchors) < 2:
            raise ValueError("a path needs two points")
        self.closed = closed
        if closed:
            ring = [anchors[-1], *anchors, anchors[0], anchors[1 % len(anchors)]]
        else:
            ring = [2 * anchors[0] - anchors[1], *anchors, 2 * anchors[-1] - anchors[-2]]
        self._points = [ring[1]]
        for i in range(len(ring) - 3):
            a, b, c, d = ring[i : i + 4]
            self._points += [
                _catmull_rom(a, b, c, d, step / self._STEPS) for step in range(1, self._STEPS + 1)
            ]
        self._lengths = [0.0]
        for a, b in zip(self._points, self._points[1:]):
            self._lengths.append(self._lengths[-1] + (b - a).length)
        self.length: float = self._lengths[-1]

    def point(self, s: float) -> Vector:
        """The point `s` metres from the start; beyond the ends it stays there (or goes round, if closed)."""
        i, t = self._locate(s)
        return self._points[i].lerp(self._points[i + 1], t)

    def tangent(self, s: float) -> Vector:
        """Unit direction of travel at `s` metres, smoothed over a hundredth of the path."""
        h = self.length / 200.0
        if not self.closed:
            s = min(max(s, h), self.length - h)
        return (self.point(s + h) - self.point(s - h)).normalized()

    def _locate(self, s: float) -> tuple[int, float]:
        s = s % self.length if self.closed else min(max(s, 0.0), self.length)
        i = min(max(bisect_right(self._lengths, s) - 1, 0), len(self._points) - 2)
        span = self._lengths[i + 1] - self._lengths[i]
        return i, (s - self._lengths[i]) / span if span > 0.0 else 0.0


def _catmull_rom(p0: Vector, p1: Vector, p2: Vector, p3: Vector, t: float) -> Vector:
    """Point at t in 0..1 between p1 and p2; the centripetal knots rule out cusps and loops."""
    t0 = 0.0
    t1 = t0 + max((p1 - p0).length ** 0.5, 1e-9)
    t2 = t1 + max((p2 - p1).length ** 0.5, 1e-9)
    t3 = t2 + max((p3 - p2).length ** 0.5, 1e-9)
    x = t1 + (t2 - t1) * t
    a1 = p0.lerp(p1, (x - t0) / (t1 - t0))
    a2 = p1.lerp(p2, (x - t1) / (t2 - t1))
    a3 = p2.lerp(p3, (x - t2) / (t3 - t2))
    return a1.lerp(a2, (x - t0) / (t2 - t0)).lerp(a2.lerp(a3, (x - t1) / (t3 - t1)), (x - t1) / (t2 - t1))


def _by_frame(values: Mapping | Sequence) -> dict:
    return dict(values) if isinstance(values, Mapping) else dict(enumerate(values))


def _decompose(matrices: Sequence[Matrix]) -> tuple[list[Vector], list[Quaternion], list[Vector]]:
    locations: list[Vector] = []
    rotations: list[Quaternion] = []
    scales: list[Vector] = []
    for matrix in matrices:
        location, rotation, scale = matrix.decompose()
        if rotations and rotation.dot(rotations[-1]) < 0.0:
            rotation.negate()
        locations.append(location)
        rotations.append(rotation)
        scales.append(scale)
    return locations, rotations, scales


def _basis_from_armature(rig: bpy.types.Object, pose: Mapping[str, Matrix]) -> dict[str, Matrix]:
    rest = {bone.name: bone.matrix_local for bone in rig.data.bones}
    posed: dict[str, Matrix] = {}
    basis: dict[str, Matrix] = {}
    for bone in rig.data.bones:  # parents come before children
        name, parent = bone.name, bone.parent
        carried = posed[parent.name] @ rest[parent.name].inverted() @ rest[name] if parent else rest[name]
        posed[name] = pose.get(name, carried)
        basis[name] = carried.inverted() @ posed[name]
    return basis


def _curves(owner: bpy.types.ID) -> bpy.types.ActionChannelbagFCurves:
    """The animation curves of a datablock, made on first use."""
    animation = owner.animation_data or owner.animation_data_create()
    if animation.action is None:
        action = bpy.data.actions.new(f"{owner.name}.keys")
        slot = action.slots.new(owner.id_type, owner.name)
        animation.action, animation.action_slot = action, slot
        action.layers.new("keys").strips.new(type="KEYFRAME")
    strip = animation.action.layers[0].strips[0]
    return strip.channelbag(animation.action_slot, ensure=True).fcurves


def _replace_vector(curves, data_path: str, frames: Sequence[int], values: Sequence[Sequence[float]]) -> None:
    for index in range(len(values[0])):
        _replace_curve(curves, data_path, index, frames, [value[index] for value in values])


def _replace_curve(
    curves, data_path: str, index: int, frames: Sequence[int], values: Sequence[float]
) -> None:
    curve = curves.find(data_path, index=index)
    if curve is not None:
        curves.remove(curve)
    curve = curves.new(data_path, index=index)
    curve.keyframe_points.add(len(frames))
    curve.keyframe_points.foreach_set("co", [x for pair in zip(frames, values) for x in pair])
    curve.keyframe_points.foreach_set("interpolation", [_LINEAR] * len(frames))
    curve.update()


def _evaluate_basis(obj: bpy.types.Object, frame: float) -> Matrix:
    curves = _curves(obj)

    def values(data_path: str, default: Sequence[float]) -> list[float]:
        found = [curves.find(data_path, index=i) for i in range(len(default))]
        return [curve.evaluate(frame) if curve else x for curve, x in zip(found, default)]

    location = values("location", obj.location)
    scale = values("scale", obj.scale)
    if obj.rotation_mode == "QUATERNION":
        rotation = Quaternion(values("rotation_quaternion", obj.rotation_quaternion)).normalized()
    else:
        euler = values("rotation_euler", obj.rotation_euler)
        rotation = Euler(euler, obj.rotation_mode).to_quaternion()
    return Matrix.LocRotScale(Vector(location), rotation, Vector(scale))
