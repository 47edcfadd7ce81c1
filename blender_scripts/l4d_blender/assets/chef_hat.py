"""A cook's tall pleated hat that sits on a person's head and moves with it."""

from __future__ import annotations

import bpy
import numpy as np

from .anatomy import CHIN_M
from .materials.base import Nodes
from .person import PersonBody
from .shell import Shell, grid_faces, make_mesh, rigid

_SIDES = 56
# Radius across, height above the chin and depth of the pleats of each ring, on the reference head.
_RINGS = (
    (0.0855, 0.172, 0.0), (0.0875, 0.170, 0.0), (0.0885, 0.235, 0.0), (0.0860, 0.238, 0.0),
    (0.0870, 0.242, 0.002), (0.0960, 0.275, 0.004), (0.1080, 0.320, 0.006), (0.1120, 0.350, 0.006),
    (0.1040, 0.372, 0.004), (0.0700, 0.384, 0.002), (0.0300, 0.386, 0.0),
)  # fmt: skip


def put_on(name: str, body: PersonBody) -> bpy.types.Object:
    """Makes the hat for a person's head; the mesh is skinned to the person's rig."""
    turns = 2 * np.pi * np.arange(_SIDES) / _SIDES
    rings = []
    for radius, height, pleat in _RINGS:
        r = radius + pleat * np.sin(14 * turns) + 0.6 * pleat * np.sin(5 * turns + 1.0)
        lean = 0.30 * (height - 0.17)
        rings.append(
            np.stack(
                [
                    0.86 * r * np.sin(turns),
                    -1.03 * r * np.cos(turns) + 0.016 + lean * 0.35,
                    np.full(_SIDES, height),
                ],
                axis=1,
            )
        )
    top = np.array([[0.0, 0.016 + 0.022, 0.386]])
    verts = np.concatenate([*rings, top])
    faces = grid_faces(len(rings), _SIDES, wrap=True)
    last = (len(rings) - 1) * _SIDES
    faces += [(last + n, last + (n + 1) % _SIDES, len(verts) - 1) for n in range(_SIDES)]
    anatomy = body.anatomy
    placed = np.array([0, 0, CHIN_M * anatomy.scale]) + anatomy.head_scale * verts
    return make_mesh(
        Shell(name, placed, faces, rigid("head", len(verts)), [_linen(f"{name}.linen")]), body.rig
    )


def _linen(name: str) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    coords = n.rest_coords()
    n.set(
        "Base Color",
        n.mix(
            n.map_range(n.noise(12.0, 3.0, vector=coords), 0.3, 0.7), (0.66, 0.65, 0.62), (0.80, 0.79, 0.76)
        ),
    )
    n.set("Roughness", 0.85)
    n.bump(n.noise(420.0, 2.0, vector=coords), 0.4, 0.0008)
    return material
