"""Cooks: people who stir, taste and pour, and the ways of their spoons and jugs.

Knows what a stove asks of hands; refuses to know the kitchen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi

import numpy as np

from ..assets.anatomy import vec
from ..scene.scene import Instance
from ..scene.timeline import FPS, FRAME_COUNT, LAST_FRAME
from .handling import Grip, grip, key_path
from .ik import ease, turn_y, turn_z, unit
from .people import Person
from .plan_person import ROWS, Frames


def stir(
    person: Person,
    way: SpoonPath,
    pot: Instance,
    pot_path: np.ndarray,
    frames: Frames,
    *,
    radius_m: float,
    height_m: float,
    lean: Sequence[float],
) -> None:
    """Plans rounds of a spoon in a pot, `height_m` above its base."""
    way.stir(pot_path, frames[0], radius_m=radius_m, height_m=height_m, lean=lean)
    person.scene.event(person.instance, "stir", frames, pot)


def taste(person: Person, way: SpoonPath, frames: Frames) -> None:
    """Plans that a spoon is at the lips, shortly after the first frame until shortly before the last."""
    way.taste(_mouth(person, frames[0] + 8), frames[0] + 4)
    person.scene.event(person.instance, "taste", frames)


def use_spoon(person: Person, spoon: Instance, way: SpoonPath, grip_m: float, *, side: str = "r") -> None:
    """Leads the spoon along its way in a fist, thumb up, all the time."""
    path = way.matrices()
    key_path(spoon.frame_object, path)
    how = Grip((0.0, 0.002, grip_m), (0, 0, 1), (-1, 0, 0))
    grip(person, spoon, path, how, (0, LAST_FRAME), side=side)


def pour(
    person: Person,
    jug: Instance,
    route: JugPath,
    handle: Grip,
    pot: Instance,
    frames: Frames,
    *,
    side: str,
    puts_down: Frames,
) -> np.ndarray:
    """Pours from a jug, held from the start, into a pot, and puts it down; returns the jug's path."""
    path = route.matrices()
    key_path(jug.frame_object, path)
    held = (0, puts_down[1])
    grip(person, jug, path, handle, held, side=side, elbow_out=0.8, puts_down=puts_down)
    person.scene.event(person.instance, "pour_into", frames, pot)
    return path


def _mouth(person: Person, frame: int) -> np.ndarray:
    """Where this cook's lips are (head upright), in the world."""
    k, stance = person.k, person.torso_at(frame, float(person.crouch[frame]), float(person.bend[frame]))
    at, chest = person.puppet.torso(stance)["chest"]
    neck = at + chest @ (person.puppet.joints["neck"] - person.puppet.joints["chest"])
    local = neck + vec(0.0, -0.105, 0.135) * k
    return np.array([*person.xy[frame], person.ground_m]) + turn_z(float(person.heading[frame])) @ local


@dataclass
class SpoonPath:
    """A spoon's way: its tip, the way up its shaft, and the way that the holding knuckles point."""

    tip: np.ndarray = field(default_factory=lambda: np.zeros((FRAME_COUNT, 3)))
    up: np.ndarray = field(default_factory=lambda: np.tile(vec(0, 0, 1), (FRAME_COUNT, 1)))
    knuckles: np.ndarray = field(default_factory=lambda: np.tile(vec(0, -1, 0), (FRAME_COUNT, 1)))

    def stir(
        self,
        pot: np.ndarray,
        first: int,
        *,
        radius_m: float,
        height_m: float,
        lean: Sequence[float],
        per_s: float = 1.15,
        blend: int = 14,
    ) -> None:
        """Rounds in a pot (a path) from a frame on; the spoon comes over in the `blend` frames before."""
        seconds = (ROWS - first) / FPS
        turn = 2 * pi * per_s * seconds + 0.6
        round_ = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
        tip = pot[:, :3, 3] + radius_m * round_ + vec(0, 0, height_m)
        up = unit_rows(np.array(lean, float) + 0.10 * round_)
        self._blend(tip, up, np.tile(vec(0.15, -1, 0), (FRAME_COUNT, 1)), first, blend, 0.16)

    def taste(self, mouth: np.ndarray, first: int, *, blend: int = 14) -> None:
        """Brings the bowl to the lips by a frame; the palm turns up on the way."""
        dip = 0.008 * np.sin(2 * pi * (ROWS - first) / 20.0)
        tip = mouth + vec(0.010, -0.026, -0.004) + dip[:, None] * vec(0, 0, 1)
        up = np.tile(unit(vec(-0.70, -0.70, 0.02)), (FRAME_COUNT, 1))
        self._blend(tip, up, np.tile(vec(0.6, -0.78, 0.15), (FRAME_COUNT, 1)), first, blend, 0.02)

    def matrices(self) -> np.ndarray:
        """World matrices: the shaft is +Z, the hollow of the bowl -Y, the knuckles point to -X."""
        z = unit_rows(self.up)
        x = -unit_rows(self.knuckles - np.sum(self.knuckles * z, axis=1, keepdims=True) * z)
        path = np.tile(np.eye(4), (FRAME_COUNT, 1, 1))
        path[:, :3, :3] = np.stack([x, np.cross(z, x), z], axis=2)
        path[:, :3, 3] = self.tip
        return path

    def _blend(
        self, tip: np.ndarray, up: np.ndarray, knuckles: np.ndarray, first: int, blend: int, arc_m: float
    ) -> None:
        u = np.ones(FRAME_COUNT) if first == 0 else ease((ROWS - first + blend) / blend)
        hump = arc_m * np.sin(pi * u)
        self.tip = self.tip + (tip - self.tip) * u[:, None] + hump[:, None] * vec(0, 0, 1)
        self.up = unit_rows(self.up + (up - self.up) * u[:, None])
        self.knuckles = unit_rows(self.knuckles + (knuckles - self.knuckles) * u[:, None])


@dataclass
class JugPath:
    """A jug's way: where its lip is, how far it is tilted, which way its spout is turned."""

    lip: tuple[float, float, float]
    turn: float
    places: list[tuple[int, np.ndarray, float]] = field(default_factory=list)

    def at(self, frame: int, lip: Sequence[float], tilt: float = 0.0) -> None:
        """Where the lip is at a frame; between two such moments it moves with ease."""
        self.places.append((frame, np.array(lip, float), tilt))

    def stand(self, frame: int, base: Sequence[float]) -> None:
        """Upright with its base at a point."""
        self.at(frame, np.array(base, float) + turn_z(self.turn) @ np.array(self.lip))

    def matrices(self) -> np.ndarray:
        """World matrices over all frames."""
        lip = np.tile(self.places[0][1], (FRAME_COUNT, 1))
        tilt = np.full(FRAME_COUNT, self.places[0][2])
        for (f0, p0, a0), (f1, p1, a1) in zip(self.places, self.places[1:]):
            u = ease((ROWS - f0) / (f1 - f0))
            lip += u[:, None] * (p1 - p0)
            tilt += u * (a1 - a0)
        path = np.tile(np.eye(4), (FRAME_COUNT, 1, 1))
        for f in range(FRAME_COUNT):
            rotation = turn_z(self.turn) @ turn_y(-float(tilt[f]))
            path[f, :3, :3], path[f, :3, 3] = rotation, lip[f] - rotation @ np.array(self.lip)
        return path


def stream_matrices(
    jug: np.ndarray,
    lip: Sequence[float],
    surface_m: np.ndarray,
    frames: Frames,
    turn: float,
    *,
    fall: int = 5,
) -> np.ndarray:
    """A stream of unit length hung from a jug's lip: its head falls, it flows, its tail falls.

    Before and after it hides, shrunk, under the surface that it falls on (`surface_m`: heights per frame).
    """
    first, last = frames
    path = np.tile(np.eye(4), (FRAME_COUNT, 1, 1))
    for f in range(FRAME_COUNT):
        mouth = jug[f, :3, :3] @ np.array(lip) + jug[f, :3, 3]
        height = mouth[2] - surface_m[f]
        top = mouth[2] - height * float(np.clip((f - last) / fall, 0.0, 1.0)) ** 2
        low = mouth[2] - height * float(np.clip((f - first + 1) / fall, 0.0, 1.0)) ** 2
        flowing = first <= f < last + fall and top - low > 0.004
        held = min(max(f, first), last)
        column = jug[held, :3, :3] @ np.array(lip) + jug[held, :3, 3]
        size = (1.0, 1.0, top - low) if flowing else (0.2, 0.2, 0.005)
        path[f, :3, :3] = turn_z(turn) @ np.diag(size)
        path[f, :3, 3] = (column[0], column[1], top if flowing else surface_m[f] - 0.02)
    return path


def unit_rows(rows: np.ndarray) -> np.ndarray:
    """Every row of length one."""
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)
