"""One arrangement from its seed: a place is drawn and furnished, filled, and seen by cameras near and far.

What is in it is laid out anew several times, since building it takes longer than drawing it. Writes
nothing and renders nothing.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import hypot

import bpy

from ...scene import cameras
from ...scene.placing import Thing
from ...scene.scene import RecipeError, Scene
from ..areas import Area, Flat
from ..errors import NoRoom, Rejected
from ..looks import Look
from ..places import Place, shipped_places
from ..spec import Spec
from ..stage import Stage
from . import animals, stock
from .casting import people

_LEAST_THINGS = 4
_TRIES = 220
_NEAR = 0.8
"""Share of layouts whose cameras come closer to some of the things."""


@dataclass
class _Movable:
    """A thing that another layout puts elsewhere."""

    thing: Thing
    area: Area
    radius_m: float
    owner: str


@dataclass
class Arrangement:
    """A filled place; `points` are where people and things are in the present layout."""

    stage: Stage
    place: Place
    rng: random.Random
    rig: list[cameras.Camera]
    points: list[Flat] = field(default_factory=list)
    fixed: list[Flat] = field(default_factory=list)
    movable: list[_Movable] = field(default_factory=list)

    def lay_out_again(self) -> None:
        """Puts everything that can be moved somewhere else; what finds no room stays where it is."""
        for item in self.movable:
            item.area.free(item.owner)
        self.points = list(self.fixed)
        for item in self.movable:
            at = _spot(self.rng, item.area, item.radius_m)
            if at is None:
                at = self.rng.choice(
                    item.area.corners
                )  # behind everything: at the edge, in whatever is there
            self.stage.scene.place(item.thing, at, self.rng.uniform(-180, 180), on=item.area.on)
            item.area.take(at, item.radius_m, owner=item.owner)
            self.points.append(at)

    def views(self, count: int) -> list[cameras.Camera]:
        """Drawn cameras of the place, most of the time closer to some of the things."""
        self.stage.scene.camera_rig = list(self.rig)
        rig = self.rig
        if self.rng.random() < _NEAR:
            rig = self._closer()
        return self.rng.sample(rig, count)

    def _closer(self) -> list[cameras.Camera]:
        x, y = self.rng.choice(self.points)
        by_distance = sorted(self.points, key=lambda at: hypot(at[0] - x, at[1] - y))
        some = by_distance[: self.rng.randint(5, max(6, len(self.points)))]
        is_table = self.place.scale == "tabletop"
        area = next(iter(self.stage.areas.values()))
        height_m = area.point(*area.centre)[2] + (0.06 if is_table else 0.3)
        return self.stage.closer(some, height_m=height_m, margin_m=0.1 if is_table else 0.5)


def build(name: str, seed: int) -> Arrangement:
    """Builds the arrangement of a seed in a fresh Blender scene; raises `Rejected` if it finds no room."""
    rng = random.Random(f"arrangement/{seed}")
    place = rng.choice(shipped_places())
    stage = Stage(Scene(name, place.scale, seed), Spec(name, place.scale, seed))
    made = Arrangement(stage, place, rng, [])
    try:
        place.furnish(stage)
        made.rig = list(stage.scene.camera_rig)
        for area in list(stage.areas.values()):
            _fill(made, area)
    except (NoRoom, RecipeError) as error:
        raise Rejected(f"{place.name}: {error}") from error
    if len(made.points) < _LEAST_THINGS:
        raise Rejected(f"{place.name}: room for {len(made.points)} things only")
    return made


def _fill(made: Arrangement, area: Area) -> None:
    """Puts people, animals and things on an area."""
    stage, rng = made.stage, made.rng
    fits = _Fits(area)
    if fits.for_people and rng.random() < 0.75:
        try:
            with _set_aside():
                made.fixed += people(stage, rng, area, rng.randint(1, 3))
        except NoRoom:
            pass  # a crowded place goes without them
    made.points += made.fixed
    wanted = rng.randint(9, 14) if fits.is_table else rng.randint(7, 12)
    if area.name == "lawn" and "road" in stage.areas:
        wanted = 4
    for _ in range(_TRIES):
        if wanted == 0:
            break
        item = stock.draw(rng, _noun(rng, area.name))
        at = _spot(rng, area, item.radius_m) if fits.takes(rng, item) else None
        if at is None:
            continue
        with _set_aside():
            _put(made, area, item, at)
        made.points.append(at)
        wanted -= 1


def _spot(rng: random.Random, area: Area, radius_m: float) -> Flat | None:
    """A free place not far from the middle of an area."""
    fits = _Fits(area)
    reach_m = max(0.45, min(fits.wide_m * 0.7, 0.6 if fits.is_table else 2.6))
    try:
        return area.spot(rng, radius_m + 0.01, near=area.centre, within_m=(0.0, reach_m), tries=60)
    except NoRoom:
        return None


@contextmanager
def _set_aside() -> Iterator[None]:
    """Takes all that is there out of the view layer for a while.

    Joining meshes updates the view layer, which takes the longer the more is in it.
    """
    scene = bpy.context.scene
    aside = bpy.data.collections.new("aside")
    there = list(scene.collection.objects)
    for obj in there:
        aside.objects.link(obj)
        scene.collection.objects.unlink(obj)
    try:
        yield
    finally:
        for obj in there:
            scene.collection.objects.link(obj)
        bpy.data.collections.remove(aside)


def _put(made: Arrangement, area: Area, item: stock.Item, at: Flat) -> None:
    stage, rng, kind = made.stage, made.rng, item.look.kind
    name = f"{item.noun}_{len(stage.scene.instances)}"
    heading_deg = rng.uniform(-180, 180)
    if kind in animals.BODIES:
        thing = animals.put(stage, rng, name, item, area.point(*at), heading_deg)
        made.fixed.append(at)
    else:
        words = {**item.look.words, **item.words}
        thing = stage.scene.put(
            kind, name, at, heading_deg, rng=stage.rng(f"member/{name}"), on=area.on, **words
        )
        made.movable.append(_Movable(thing, area, item.radius_m, name))
    stage.register(
        kind,
        name,
        thing,
        at=at,
        heading_deg=heading_deg,
        area=area,
        radius_m=item.radius_m,
        category=item.noun,
        look=Look(kind, {}, item.look.attributes),
    )


class _Fits:
    """Which things an area is for, by their size."""

    def __init__(self, area: Area) -> None:
        self.is_table = area.name in ("table", "counter")
        self.is_water, self.is_road = area.name == "water", area.name == "road"
        self.for_people = not (self.is_table or self.is_water)
        xs, ys = [x for x, _ in area.corners], [y for _, y in area.corners]
        self.wide_m = min(max(xs) - min(xs), max(ys) - min(ys))

    def takes(self, rng: random.Random, item: stock.Item) -> bool:
        """Small things stand on tables, and seldom on floors; on water there are birds and boats."""
        radius_m = item.radius_m
        if self.is_water:
            return item.look.kind in ("waterbird", "rowing_boat")
        if self.is_table:
            return radius_m <= (0.24 if rng.random() < 0.35 else 0.13)
        least_m = 0.1 if rng.random() < 0.7 else 0.045
        return radius_m >= least_m and (self.is_road or radius_m <= min(0.9, 0.3 * self.wide_m))


def _noun(rng: random.Random, area: str) -> str:
    if area == "road" and rng.random() < 0.35:
        return "car"
    if area == "water":
        return rng.choice(("duck", "bird", "boat"))
    if rng.random() < 0.7:
        return rng.choice(stock.cast_nouns())
    return rng.choice(tuple(stock.kinds_by_noun()))
