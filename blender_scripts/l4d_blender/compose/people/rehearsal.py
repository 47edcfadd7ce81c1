"""A plan of who is where at every frame, before anything is built: what would collide or hide is drawn anew.

People and things are discs with a height that move over the plan. Knows cameras and free floor; knows no
acts, bodies or looks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, product
from math import cos, radians, sin
from typing import TypeVar

import numpy as np

from ...scene.scene import Scene
from ...scene.timeline import FRAME_COUNT, PROFILES
from ..areas import Area, Flat
from ..errors import NoRoom, Rejected
from ..stage import Stage

T = TypeVar("T")
TRIES = 80
_SAMPLED = range(0, FRAME_COUNT, 12)
_PIXELS = 180.0  # more than visibility.GATE_PIXELS: discs are not bodies
_VIEWS = 9  # of 17 cameras, so that more than six of the twelve training views remain
_SEEN_FROM = [(u, v) for u in (-0.6, 0.0, 0.6) for v in (0.12, 0.4, 0.68, 0.93)]


@dataclass
class Disc:
    """Something on the plan: where it is, how much room it needs, and what of it can be seen."""

    name: str
    xy: np.ndarray
    radius_m: np.ndarray
    body_m: float  # half of its visible width
    height_m: float
    base_m: np.ndarray = field(default_factory=lambda: np.zeros(FRAME_COUNT))
    friends: set[str] = field(default_factory=set)  # whom it may touch
    ignores: set[str] = field(default_factory=set)  # furniture that it may touch
    cover: float = 1.0  # how much wider it is for what it hides than for what is seen of it
    leaves_floor: int = FRAME_COUNT  # from here on it sits somewhere

    @classmethod
    def at(
        cls, name: str, xy: Flat, radius_m: float, body_m: float, height_m: float, base_m: float = 0.0
    ) -> Disc:
        """One that stays where it is."""
        return cls(
            name,
            np.tile(np.array(xy, float), (FRAME_COUNT, 1)),
            np.full(FRAME_COUNT, radius_m),
            body_m,
            height_m,
            np.full(FRAME_COUNT, base_m),
        )

    def copy(self) -> Disc:
        """The same, to be restored if what is drawn for it does not fit."""
        return replace(self, xy=self.xy.copy(), base_m=self.base_m.copy(), friends=set(self.friends))

    def restore(self, before: Disc) -> None:
        """As it was when it was copied."""
        self.xy, self.base_m = before.xy.copy(), before.base_m.copy()
        self.friends = set(before.friends)


class Board:
    """The plan while it grows: whoever is added fits the free floor and meets none of those before."""

    def __init__(self, scene: Scene, area: Area) -> None:
        self.scene, self.area = scene, area
        self.discs: list[Disc] = []

    def add(self, draw: Callable[[], T], discs: Callable[[T], Sequence[Disc]], tries: int = 30) -> T:
        """The first of some drawn people or things that fits."""
        reason = "there is no room"
        for _ in range(tries):
            try:
                made = draw()
                news = discs(made)
                self._check(news)
            except NoRoom as error:
                reason = str(error)
                continue
            self.discs += [disc for disc in news if not any(disc is other for other in self.discs)]
            return made
        raise NoRoom(reason)

    def check_sight(self) -> None:
        """Refuses a plan in which something would be hidden from the held-out view or from most cameras."""
        _check_sight(self.scene, self.discs)

    def is_hit(self, disc: Disc) -> bool:
        """Whether somebody meets another of those on the plan."""
        return any(_meet(disc, other) for other in self.discs if other is not disc)

    def _check(self, news: Sequence[Disc]) -> None:
        olds = [disc for disc in self.discs if not any(disc is other for other in news)]
        if any(_meet(a, b) for a, b in [*combinations(news, 2), *product(news, olds)]):
            raise NoRoom("two are in each other's way")
        for disc in news:
            if not self._is_free(disc):
                raise NoRoom("somebody leaves the free floor")
        for disc in news:
            _check_sight(self.scene, [disc])

    def _is_free(self, disc: Disc) -> bool:
        """Whether a disc is on the area, clear of the furniture, all the time (arms may reach over it)."""
        frames = range(0, disc.leaves_floor, 4)
        if not frames:
            return True
        at, radius = disc.xy[frames], np.minimum(disc.radius_m[frames], 0.24)
        corners = np.array(self.area.corners)
        edges = np.roll(corners, -1, axis=0) - corners
        inwards = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
        margins = np.einsum("fcx,cx->fc", at[:, None] - corners, inwards).min(axis=1)
        if (margins < radius).any():
            return False
        for taken in self.area.taken:
            if taken.owner in disc.ignores:
                continue
            start, way = np.array(taken.start), np.array(taken.end) - np.array(taken.start)
            t = np.clip((at - start) @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
            if (np.linalg.norm(at - start - t[:, None] * way, axis=1) < radius + taken.radius_m).any():
                return False
        return True


def _meet(a: Disc, b: Disc) -> bool:
    if b.name in a.friends or a.name in b.friends:
        return False
    return bool((np.linalg.norm(a.xy - b.xy, axis=1) < a.radius_m + b.radius_m).any())


def rehearse(stage: Stage, key: str, draw: Callable[[int], T], tries: int = TRIES) -> T:
    """The first of `tries` drawn plans that works; `draw` gets the number of the try and raises `NoRoom`."""
    reasons: dict[str, int] = {}
    for k in range(tries):
        try:
            return draw(k)
        except NoRoom as error:
            reason = str(error)
            reasons[reason] = reasons.get(reason, 0) + 1
    worst = max(reasons, key=lambda reason: reasons[reason])
    raise Rejected(f"no plan of {key} fits, mostly because {worst}")


def _check_sight(scene: Scene, discs: Sequence[Disc]) -> None:
    good = _seen(scene, discs)  # discs x cameras x frames
    views = np.median(good.sum(axis=1), axis=1)
    if views.min() < _VIEWS:
        raise NoRoom("something is hidden from most cameras")
    steady = good.mean(axis=2) >= 0.85
    if not steady[:, 1:-1].all(axis=0).any():
        raise NoRoom("no camera sees all of them")


def _seen(scene: Scene, discs: Sequence[Disc]) -> np.ndarray:
    """Per disc, camera and sampled frame, whether enough of it is in the picture and not behind others."""
    small, frames = PROFILES["small"], list(_SAMPLED)
    at = np.array([disc.xy[frames] for disc in discs])  # discs x frames x 2
    base = np.array([disc.base_m[frames] for disc in discs])
    wide = np.array([disc.body_m for disc in discs])
    hiding = wide * np.array([disc.cover for disc in discs])
    tall = np.array([disc.height_m for disc in discs])
    u, v = np.array(_SEEN_FROM).T
    found = []
    for camera in scene.camera_rig:
        pose = np.array(camera.world_from_camera)
        eye, turn = pose[:3, 3], pose[:3, :3]
        f_px = camera.focal_over_width * small.width
        away = at - eye[:2]
        across = np.stack([-away[..., 1], away[..., 0]], axis=-1)
        across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
        flat = at[:, :, None] + (u * wide[:, None])[:, None, :, None] * across[:, :, None]
        z = base[:, :, None] + v * tall[:, None, None]
        points = np.concatenate([flat, z[..., None]], axis=-1)  # discs x frames x points x 3
        local = (points - eye) @ turn
        depth = np.maximum(local[..., 2], 0.1)
        free = (np.abs(f_px * local[..., 0] / depth) < 0.5 * small.width) & (
            np.abs(f_px * local[..., 1] / depth) < 0.5 * small.height
        )
        for k in range(len(discs)):
            hidden = _behind(eye, points, at[k], base[k], hiding[k], tall[k])
            hidden[k] = False
            free &= ~hidden
        pixels = (f_px / depth.mean(axis=2)) ** 2 * (2 * wide * tall * 0.7)[:, None] * free.mean(axis=2)
        found.append(pixels >= _PIXELS)
    return np.stack(found, axis=1)


def _behind(
    eye: np.ndarray, points: np.ndarray, at: np.ndarray, base_m: np.ndarray, wide_m: float, tall_m: float
) -> np.ndarray:
    """Which points (discs x frames x points) a standing cylinder, at a place per frame, hides from an eye."""
    way = points - eye
    flat = way[..., :2]
    centre = (at - eye[:2])[None, :, None]
    t = (centre * flat).sum(axis=-1) / np.maximum((flat**2).sum(axis=-1), 1e-12)
    gap = np.linalg.norm(t[..., None] * flat - centre, axis=-1)
    z = eye[2] + t * way[..., 2]
    low = base_m[None, :, None]
    return (t > 0.0) & (t < 1.0) & (gap < wide_m) & (z > low) & (z < low + tall_m)


def ahead(at: Flat, heading_deg: float, forward_m: float, left_m: float = 0.0) -> Flat:
    """A point before (and to the left of) somebody who stands at a point; a heading of 0 faces -Y."""
    a = radians(heading_deg)
    return (at[0] + forward_m * sin(a) + left_m * cos(a), at[1] - forward_m * cos(a) + left_m * sin(a))


def ahead_of(at: np.ndarray, heading_deg: np.ndarray, forward_m: float, left_m: float = 0.0) -> np.ndarray:
    """`ahead` for a row of places and headings."""
    a = np.radians(heading_deg)
    c, s = np.cos(a), np.sin(a)
    return at + np.stack([forward_m * s + left_m * c, -forward_m * c + left_m * s], axis=1)


def roomy_m2(area: Area) -> float:
    """How much of an area no furniture stands on."""
    corners = np.array(area.corners)
    x, y = corners.T
    whole = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    return whole - sum(np.pi * taken.radius_m**2 for taken in area.taken if area.margin(taken.start) > 0.0)
