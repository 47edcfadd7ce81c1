"""A playground swing for two: an A-frame of painted tubes, rubber seats on galvanised chains.

The frame stands still; each seat with its chains is an object of its own whose origin lies on the beam, so
that turning it about its X axis swings it. Front = -Y, where those who sit on it look.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import playground, products
from .parts import Parts

BEAM_M = 1.92
SEAT_M = 0.395  # upper side of a seat that hangs still
CHAINS_APART_M = 0.40
SEATS_X_M = (-0.40, 0.40)
HANG_M = BEAM_M - SEAT_M

_BEAM_HALF_M = 0.98
_LINK_M = 0.042


@dataclass(frozen=True)
class Swing:
    """The frame and its seats, from -X to +X."""

    frame: bpy.types.Object
    seats: list[bpy.types.Object]

    @property
    def parts(self) -> list[bpy.types.Object]:
        """Everything that makes up the instance."""
        return [self.frame, *self.seats]

    def place(self, matrix: Matrix) -> None:
        """Moves the frame somewhere; the seats hang still, their pivots on the beam."""
        self.frame.matrix_basis = matrix
        for seat, hung in zip(self.seats, resting(matrix)):
            seat.matrix_basis = hung


def resting(matrix: Matrix) -> list[Matrix]:
    """Where the seats of a swing hang still: pivots on the beam."""
    return [matrix @ Matrix.Translation((x, 0.0, BEAM_M)) for x in SEATS_X_M]


@kind("swing", (2.31, 1.33, 3.62), "swings", "seat", front="-y")
def swing(name: str, rng: random.Random, *, legs: str = "blue", beam: str = "yellow") -> Swing:
    """A swing at the origin."""
    return Swing(
        _frame(name, rng, playground.PAINTS[legs], playground.PAINTS[beam]),
        [_seat(f"{name}_seat_{k}", rng) for k in range(2)],
    )


def _frame(name: str, rng: random.Random, legs: tuple, beam: tuple) -> bpy.types.Object:
    painted = products.lacquer(f"{name}_legs", legs, rng)
    top = products.lacquer(f"{name}_beam", beam, rng)
    foot = products.metal(f"{name}_foot", (0.42, 0.42, 0.41), rng)
    parts = Parts(name)
    for s in (-1, 1):
        head = Vector((s * (_BEAM_HALF_M - 0.03), 0.0, BEAM_M + 0.02))
        for y in (-0.62, 0.62):
            end = Vector((s * (_BEAM_HALF_M + 0.13), y, -0.05))
            parts.tube("leg", painted, [end, head], 0.030, 14)
            parts.cylinder("shoe", foot, 0.062, 0.014, 20, bevel_m=0.004, x=end.x * 0.985, y=y * 0.975)
        rung = [Vector((s * (_BEAM_HALF_M + 0.065), y, 0.80)) for y in (-0.355, 0.355)]
        parts.tube("rung", painted, rung, 0.020, 12)
        parts.ellipsoid("knot", top, (0.055, 0.055, 0.055), 20, 12, centre=head)
    bar = [(-_BEAM_HALF_M - 0.06, 0.0, BEAM_M + 0.045), (_BEAM_HALF_M + 0.06, 0.0, BEAM_M + 0.045)]
    parts.tube("bar", top, bar, 0.042, 18)
    for x in SEATS_X_M:
        for s in (-1, 1):
            clamp = mesh.cylinder(f"{name}_clamp", 0.050, 0.050, 18, bevel_m=0.006)
            parts.add(clamp, foot, x=x + s * CHAINS_APART_M / 2 - 0.025, z=BEAM_M + 0.045, turn=("Y", 90.0))
    return parts.join()


def _seat(name: str, rng: random.Random) -> bpy.types.Object:
    """Seat and chains below their pivot."""
    rubber = products.rubber(f"{name}_rubber", (0.035, 0.034, 0.036), rng)
    zinc = products.metal(f"{name}_chain", (0.50, 0.50, 0.49), rng, roughness=0.45)
    half = CHAINS_APART_M / 2
    sections = []
    for k in range(13):
        x = half * (k / 6 - 1.0)
        sag = 0.050 * math.cos(0.5 * math.pi * x / half) ** 0.8 - 0.050
        deep = 0.085 * (1.0 - 0.35 * abs(x / half) ** 6)
        ring = []
        for j in range(16):
            a = 2 * math.pi * j / 16
            ring.append(
                (
                    x,
                    deep * math.copysign(abs(math.cos(a)) ** 0.5, math.cos(a)),
                    -HANG_M
                    - 0.014
                    - sag
                    - 0.05
                    + 0.014 * math.copysign(abs(math.sin(a)) ** 0.5, math.sin(a)),
                )
            )
        sections.append(ring)
    parts = [mesh.set_material(mesh.loft(f"{name}_slab", sections), rubber)]
    links = round((HANG_M - 0.02) / (0.74 * _LINK_M))
    for s in (-1, 1):
        for k in range(links):
            link = mesh.torus(f"{name}_link", 0.36 * _LINK_M, 0.085 * _LINK_M, 10, 5)
            mesh.transform(link, Matrix.Diagonal((0.72, 1.32, 1.0, 1.0)))
            mesh.rotate(link, "X", 90.0)
            mesh.rotate(link, "Z", 90.0 * (k % 2))
            mesh.move(link, s * half, 0.0, -0.74 * _LINK_M * (k + 0.5))
            parts.append(mesh.set_material(link, zinc))
    return mesh.join(name, parts)
