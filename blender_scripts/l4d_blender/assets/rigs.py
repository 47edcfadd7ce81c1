"""Armatures of whatever has bones, and meshes that hang on them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, Protocol

import bpy
import numpy as np
from mathutils import Matrix, Vector


class Bone(NamedTuple):
    """A bone at rest."""

    name: str
    head: Sequence[float]
    tail: Sequence[float]
    parent: str | None = None


class AnyBone(Protocol):
    """A bone at rest, of any kind that says so."""

    @property
    def name(self) -> str:
        """Of the bone."""

    @property
    def head(self) -> Sequence[float] | np.ndarray:
        """Its own joint."""

    @property
    def tail(self) -> Sequence[float] | np.ndarray:
        """Where it ends."""

    @property
    def parent(self) -> str | None:
        """The name of the bone that it hangs on."""


def armature(name: str, bones: Iterable[AnyBone]) -> bpy.types.Object:
    """An armature whose bones rest where they say; parents come before their children."""
    data = bpy.data.armatures.new(name)
    rig = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in bones:
        edit = data.edit_bones.new(bone.name)
        edit.head, edit.tail = Vector(bone.head), Vector(bone.tail)
        if bone.parent:
            edit.parent = data.edit_bones[bone.parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def upright_armature(name: str, heads: Mapping[str, Vector], length_m: float = 0.05) -> bpy.types.Object:
    """An armature of bones without parents that point up: for motion that places every bone by itself."""
    up = Vector((0.0, 0.0, length_m))
    return armature(name, [Bone(bone, head, head + up) for bone, head in heads.items()])


def hang(body: bpy.types.Object, rig: bpy.types.Object) -> bpy.types.Object:
    """Makes a weighted mesh follow the rig; returns the mesh."""
    body.parent = rig
    body.matrix_parent_inverse = Matrix.Identity(4)
    body.modifiers.new("rig", "ARMATURE").object = rig
    return body
