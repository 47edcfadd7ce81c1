"""What outdoor places share: season and hour, land with turf and a skyline, what is round an area, cameras.

Owns how a free area is framed, so that cameras see all of it and nothing tall is before it. Knows no place.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from math import atan2, cos, degrees, hypot, radians, sin
from typing import Any, Protocol

import bpy

from ...assets import autumn, mesh
from ...scene import catalogue
from ...scene.colour import Colour
from ...scene.placing import AnyThing, HeightField, Support, Thing, parts
from ...scene.scattering import NEARLY, scatter, skyline
from ..areas import Area, Flat
from ..looks import Look
from ..stage import Chair, Prop, Stage


@dataclass(frozen=True)
class Light:
    """An hour and its weather: ranges of the sun's elevation and strength, what the sky adds."""

    name: str
    elevation_deg: tuple[float, float]
    sun: tuple[float, float]
    sky: float
    haze: float
    soft_deg: float
    colour: Colour


LIGHTS = (
    Light("a clear morning", (26.0, 38.0), (3.6, 4.4), 0.27, 1.5, 1.2, (1.0, 0.90, 0.76)),
    Light("midday", (48.0, 60.0), (3.6, 4.2), 0.26, 1.0, 1.0, (1.0, 0.95, 0.88)),
    Light("a hazy day", (34.0, 50.0), (2.3, 2.9), 0.28, 5.0, 7.0, (1.0, 0.94, 0.86)),
    Light("a dull day", (40.0, 60.0), (1.2, 1.6), 0.34, 7.0, 30.0, (0.94, 0.97, 1.0)),
    Light("a late afternoon", (15.0, 22.0), (3.8, 4.6), 0.30, 2.5, 1.5, (1.0, 0.78, 0.52)),
)


@dataclass(frozen=True)
class Season:
    """Hue, saturation and value shifts of what is green, and how many leaves have turned."""

    name: str
    hue: float
    saturation: float
    value: float
    turned: float
    fallen: int


SEASONS = (
    Season("spring", 0.012, 1.08, 1.15, 0.0, 0),
    Season("summer", 0.0, 1.0, 1.0, 0.0, 0),
    Season("dry summer", -0.025, 0.92, 1.12, 0.0, 0),
    Season("early autumn", -0.015, 0.95, 0.98, 0.35, 250),
    Season("autumn", -0.03, 0.88, 0.92, 0.8, 900),
)


@dataclass(frozen=True)
class Day:
    """When a scene plays."""

    light: Light
    season: Season
    sun_azimuth_deg: float

    @property
    def words(self) -> str:
        """As in "on a hazy day in spring"."""
        return f"{self.light.name} in {self.season.name}"


def day(
    stage: Stage,
    *,
    seasons: Sequence[Season] = SEASONS,
    lights: Sequence[Light] = LIGHTS,
    facing_deg: float = -90.0,
) -> Day:
    """Draws season, hour and weather, and lights the scene; the sun is seldom before the cameras."""
    rng = stage.rng("day")
    light, season = rng.choice(lights), rng.choice(seasons)
    azimuth_deg = facing_deg + rng.choice((-1, 1)) * rng.uniform(15.0, 105.0)
    elevation_deg = rng.uniform(*light.elevation_deg)
    stage.scene.sky(
        sun_elevation_deg=elevation_deg, sun_azimuth_deg=azimuth_deg, strength=light.sky, haze=light.haze
    )
    stage.scene.sun(
        elevation_deg=elevation_deg,
        azimuth_deg=azimuth_deg,
        strength=rng.uniform(*light.sun),
        angle_deg=light.soft_deg,
        colour=light.colour,
    )
    return Day(light, season, azimuth_deg)


# ---- land ------------------------------------------------------------------------------------------------


def retint(
    thing: AnyThing, *, hue: float = 0.0, saturation: float = 1.0, value: float = 1.0, only: str = ""
) -> AnyThing:
    """Shifts the base colours of materials whose names contain `only`; a hue of 1 is a whole turn."""
    for slot in (slot for obj in parts(thing) for slot in obj.material_slots):
        material = slot.material
        if only not in material.name or material.get("retinted") or material.node_tree is None:
            continue
        material["retinted"] = True
        tree = material.node_tree
        for shader in [node for node in tree.nodes if node.type in ("BSDF_PRINCIPLED", "BSDF_DIFFUSE")]:
            socket = shader.inputs[0]
            shift = tree.nodes.new("ShaderNodeHueSaturation")
            shift.inputs["Hue"].default_value = 0.5 + hue
            shift.inputs["Saturation"].default_value = saturation
            shift.inputs["Value"].default_value = value
            if socket.links:
                tree.links.new(socket.links[0].from_socket, shift.inputs["Color"])
            else:
                shift.inputs["Color"].default_value = socket.default_value
            tree.links.new(shift.outputs["Color"], socket)
    return thing


def in_season(thing: Thing, season: Season, only: str = "") -> Thing:
    """Gives what is green the tone of a season."""
    return retint(thing, hue=season.hue, saturation=season.saturation, value=season.value, only=only)


class Relief(Protocol):
    """Ground as `ground.Terrain` describes it."""

    def height(self, x: float, y: float) -> float:
        """Metres."""

    def wear(self, x: float, y: float) -> float:
        """0 grass .. 1 bare soil."""


def land(
    stage: Stage,
    season: Season,
    terrain: Relief,
    *,
    tufts: int = 2200,
    turf_m: float = 8.5,
    length_m: tuple[float, float] = (0.02, 0.05),
    keep: Callable[[float, float], float] | None = None,
    long_keep: Callable[[float, float], float] | None = None,
    long_tufts: int = 350,
    radius_m: float = 85.0,
    sectors: int = 132,
) -> None:
    """The ground with short grass; `long_keep` says where it is not mown."""
    scene = stage.scene
    rng = stage.rng("land")
    made = [
        scene.make("ground", "ground", rng, terrain=terrain, radius_m=radius_m, sectors=sectors),
        scene.make(
            "ground.grass",
            "turf",
            rng,
            terrain=terrain,
            tufts=tufts,
            radius_m=turf_m,
            length_m=length_m,
            keep=keep,
        ),
    ]
    if long_keep is not None:
        made.append(
            scene.make(
                "ground.grass",
                "uncut",
                rng,
                terrain=terrain,
                tufts=long_tufts,
                radius_m=turf_m + 1.5,
                length_m=(0.10, 0.26),
                keep=long_keep,
            )
        )
    for thing in made:
        in_season(thing, season)
    if season.fallen:
        scene.make(
            "autumn.fallen_leaves",
            "fallen_leaves",
            rng,
            terrain=terrain,
            count=season.fallen,
            radius_m=turf_m,
            **({"keep": keep} if keep else {}),
        )


def tree(stage: Stage, season: Season, name: str, rng: random.Random, **words: Any) -> bpy.types.Object:
    """A tree or bush (`kind`) in the colours of a season."""
    kind = str(words.pop("kind", "tree"))
    made = stage.scene.make(kind, name, rng, **words)
    return leaves(made, season, rng)


def leaves(plant: bpy.types.Object, season: Season, rng: random.Random) -> bpy.types.Object:
    """Turns or tints what has leaves."""
    if rng.random() < season.turned:
        return autumn.turned(plant, rng.choice(autumn.TONES))
    hue, saturation, value = (rng.uniform(*span) for span in ((-0.02, 0.015), (0.9, 1.1), (0.85, 1.2)))
    return retint(
        plant, hue=season.hue + hue, saturation=season.saturation * saturation, value=season.value * value
    )


def plant(
    stage: Stage,
    season: Season,
    name: str,
    spots: Iterable[Flat | tuple[Flat, float]],
    *,
    kind: str = "tree",
    models: int = 2,
    on: Support = 0.0,
    scale: tuple[float, float] = (0.85, 1.2),
    sunk_m: float = 0.05,
    loose_m: float = 0.0,
    any_way: bool = True,
    **words: Any,
) -> None:
    """Copies of some models of trees or bushes at spots: scenery."""
    rng = stage.rng(f"plant/{name}")
    made = [tree(stage, season, f"{name}_model_{k}", rng, kind=kind, **words) for k in range(models)]
    turn = (-180.0, 180.0) if any_way else (-6.0, 6.0)
    spots = list(spots)
    for k in range(len(spots), models):
        bpy.data.objects.remove(made[k])
    scatter(
        stage.scene,
        name,
        made[: max(len(spots), 1)] if spots else [],
        spots,
        rng,
        on=on,
        sunk_m=sunk_m,
        scale=scale,
        turn_deg=turn,
        loose_m=loose_m,
    )


def houses(
    stage: Stage,
    rng: random.Random,
    count: int,
    *,
    size_m: tuple[tuple[float, float], tuple[float, float]] = ((7.5, 10.0), (6.0, 7.5)),
    eaves_m: tuple[float, float] = (4.0, 5.2),
) -> list[bpy.types.Object]:
    """Models of houses whose walls and tiles differ."""
    made = []
    for k in range(count):
        size = rng.uniform(*size_m[0]), rng.uniform(*size_m[1])
        model = stage.scene.make(
            "house", f"house_model_{k}", rng, size_xy=size, eaves_m=rng.uniform(*eaves_m)
        )
        retint(
            model,
            hue=rng.uniform(-0.02, 0.03),
            saturation=rng.uniform(0.5, 1.2),
            value=rng.uniform(0.75, 0.95),
            only="_wall",
        )
        retint(model, hue=rng.uniform(-0.02, 0.02), saturation=rng.uniform(0.3, 1.0), only="_tiles")
        made.append(model)
    return made


def house_row(
    stage: Stage,
    models: Sequence[bpy.types.Object],
    spots: Sequence[tuple[Flat, float]],
    *,
    on: Support = 0.0,
) -> Prop:
    """Copies of the models at spots; the one nearest to the middle is the landmark "house"."""
    middle = min(spots, key=lambda spot: abs(spot[0][0]))
    house = stage.scene.place(mesh.duplicate(models[0], "house", linked=True), *middle, on=on)
    others = [spot for spot in spots if spot is not middle]
    turned = [*models[1:], models[0]]
    scatter(stage.scene, "house", turned, others, stage.rng("houses"), on=on, sunk_m=0.0, turn_deg=(0.0, 0.0))
    return named(stage, "house", "house", house, *middle)


def woods(
    stage: Stage,
    season: Season,
    terrain: Support,
    *,
    count: int = 13,
    azimuth_deg: tuple[float, float] = (-25.0, 205.0),
    distance_m: tuple[float, float] = (26.0, 44.0),
    scale: tuple[float, float] = (0.8, 1.3),
) -> None:
    """Strips of wood along the skyline, as far round as cameras see."""
    rng = stage.rng("woods")
    models = [
        leaves(stage.scene.make("tree.far_wood", f"wood_model_{k}", rng), season, rng) for k in range(2)
    ]
    ring = list(skyline(rng, count, azimuth_deg, distance_m))
    scatter(stage.scene, "wood", models, ring, rng, on=terrain, sunk_m=0.3, scale=scale, turn_deg=NEARLY)


# ---- round an area ---------------------------------------------------------------------------------------


def yard(
    name: str,
    size_m: tuple[float, float],
    *,
    centre: Flat = (0.0, 0.0),
    cut_m: float = 0.9,
    on: Support = 0.0,
) -> Area:
    """A rectangle whose corners are cut off, because cameras see them last."""
    x, y, c = size_m[0] / 2, size_m[1] / 2, cut_m
    corners = [
        (-x + c, -y),
        (x - c, -y),
        (x, -y + c),
        (x, y - c),
        (x - c, y),
        (-x + c, y),
        (-x, y - c),
        (-x, -y + c),
    ]
    return Area(name, [(centre[0] + u, centre[1] + v) for u, v in corners], on)


def beside(area: Area, azimuth_deg: float, out_m: float) -> Flat:
    """The point `out_m` metres outside an area's edge, in a direction from its middle."""
    cx, cy = area.centre
    ux, uy = cos(radians(azimuth_deg)), sin(radians(azimuth_deg))
    far = 0.0
    while area.margin((cx + far * ux, cy + far * uy)) > -out_m:
        far += 0.02
    return cx + far * ux, cy + far * uy


def facing(at: Flat, other: Flat) -> float:
    """The heading of something at a point that faces another."""
    return degrees(atan2(other[0] - at[0], -(other[1] - at[1])))


@dataclass(frozen=True)
class Mark:
    """A landmark that may be beside or in an area; `away_m` from the area's edge, negative inside.

    `turn` says how its heading is: "in" (its front to the middle), "any", or degrees relative to "in". Only
    what is low may be between the area and the cameras.
    """

    kind: str
    name: str
    radius_m: float
    turn: str | float = "in"
    low: bool = True
    away_m: float | None = None
    category: str | None = None
    words: tuple[tuple[str, Any], ...] = ()

    def of(self, **words: Any) -> Mark:
        """The same with attributes."""
        return replace(self, words=tuple(words.items()))


def put_round(
    stage: Stage,
    area: Area,
    marks: Sequence[Mark],
    *,
    on: Support = 0.0,
    back_deg: tuple[float, float] = (12.0, 168.0),
    front_deg: tuple[float, float] = (200.0, 340.0),
    clear: Sequence[tuple[Flat, float]] = (),
) -> dict[str, Prop]:
    """Puts landmarks round an area: tall ones behind it, low ones anywhere, none in another."""
    rng = stage.rng(f"round {area.name}")
    taken = [(at, radius) for at, radius in clear]
    made = {}
    for mark in marks:
        for attempt in range(200):
            away_m = mark.away_m if mark.away_m is not None else mark.radius_m + rng.uniform(-0.25, 0.25)
            span = front_deg if mark.low and rng.random() < 0.35 else back_deg
            at = beside(area, rng.uniform(*span), away_m)
            grow = 0.5 if attempt < 120 else 0.15
            if all(hypot(at[0] - x, at[1] - y) > mark.radius_m + r + grow for (x, y), r in taken):
                break
        else:
            continue
        taken.append((at, mark.radius_m))
        made[mark.name] = _put(stage, mark, at, area, rng, on)
    return made


def put_in(
    stage: Stage, area: Area, marks: Sequence[Mark], *, on: Support = 0.0, away_m: float = 1.4
) -> dict[str, Prop]:
    """Puts landmarks on an area, out of its middle, with free room round them."""
    rng = stage.rng(f"in {area.name}")
    made = {}
    for mark in marks:
        at = area.spot(rng, mark.radius_m + 0.3, near=area.centre, within_m=(away_m, 6.0))
        made[mark.name] = _put(stage, mark, at, area, rng, on)
    return made


def _put(stage: Stage, mark: Mark, at: Flat, area: Area, rng: random.Random, on: Support) -> Prop:
    return stage.landmark(
        mark.kind,
        mark.name,
        at,
        _heading(mark, at, area, rng),
        on=on,
        area=area,
        radius_m=mark.radius_m,
        category=mark.category,
        **dict(mark.words),
    )


def _heading(mark: Mark, at: Flat, area: Area, rng: random.Random) -> float:
    if mark.turn == "any":
        return rng.uniform(-180.0, 180.0)
    turn_deg = 0.0 if mark.turn == "in" else float(mark.turn)
    return facing(at, area.centre) + turn_deg + rng.uniform(-9.0, 9.0)


def seats(
    stage: Stage, bench: Prop, *, height_m: float = 0.455, ahead_m: float = 0.05, apart_m: float = 0.44
) -> None:
    """Offers the two places of a bench that faces its heading; `height_m` of the seat over its ground."""
    heading = radians(bench.heading_deg)
    ahead, right = (sin(heading), -cos(heading)), (-cos(heading), -sin(heading))
    base = bench.instance.frame_object.matrix_basis.translation.z
    for side in (-1.0, 1.0):
        x = bench.at[0] + ahead_m * ahead[0] + side * apart_m * right[0]
        y = bench.at[1] + ahead_m * ahead[1] + side * apart_m * right[1]
        stage.chairs.append(Chair((x, y, base + height_m), bench.heading_deg, bench))


# ---- cameras ---------------------------------------------------------------------------------------------


def cameras(
    stage: Stage,
    target: tuple[float, float, float],
    *,
    radius_m: float,
    fov_deg: float,
    heights_m: tuple[float, float] = (1.7, 2.6),
    arc_deg: tuple[float, float] = (100.0, 130.0),
    lean_deg: float = 8.0,
    facing_deg: float = -90.0,
) -> None:
    """Cameras from about -Y, drawn a little each time."""
    rng = stage.rng("cameras")
    low, high = heights_m
    heights = [
        low + rng.uniform(-0.1, 0.1),
        high + rng.uniform(-0.1, 0.2),
        (low + high) / 2 + rng.uniform(-0.1, 0.1),
    ]
    stage.scene.cameras(
        target,
        radius_m=radius_m * rng.uniform(0.97, 1.04),
        heights_m=heights,
        arc_deg=rng.uniform(*arc_deg),
        facing_deg=facing_deg + rng.uniform(-lean_deg, lean_deg),
        fov_deg=fov_deg + rng.uniform(-1.0, 1.0),
    )


def road_cameras(stage: Stage) -> None:
    """Cameras that see cars on both lanes of a road along X."""
    cameras(
        stage,
        (0.0, -1.3, 0.8),
        radius_m=12.0,
        fov_deg=62.0,
        heights_m=(2.4, 4.0),
        arc_deg=(96.0, 116.0),
        lean_deg=5.0,
    )


def height_at(terrain: HeightField | float, at: Flat) -> float:
    """Of the ground at a point."""
    return terrain.height(*at) if hasattr(terrain, "height") else float(terrain)


def row(start: Flat, end: Flat, step_m: float) -> list[tuple[Flat, float]]:
    """Spots along a line, each with the heading of something whose length runs along it."""
    length = hypot(end[0] - start[0], end[1] - start[1])
    count = max(1, round(length / step_m))
    heading = degrees(atan2(end[1] - start[1], end[0] - start[0]))
    return [
        (
            (
                start[0] + (end[0] - start[0]) * (k + 0.5) / count,
                start[1] + (end[1] - start[1]) * (k + 0.5) / count,
            ),
            heading,
        )
        for k in range(count)
    ]


def paint(word: str) -> Colour:
    """A colour of the catalogue."""
    return catalogue.COLOURS[word]


def sheet(
    name: str,
    material: bpy.types.Material,
    low: Flat,
    high: Flat,
    z: float = 0.0,
    *,
    cells: tuple[int, int] = (12, 4),
) -> bpy.types.Object:
    """A level rectangle from corner to corner."""
    made = mesh.grid(name, high[0] - low[0], high[1] - low[1], *cells)
    mesh.move(made, (low[0] + high[0]) / 2, (low[1] + high[1]) / 2, z)
    return mesh.set_material(made, material)


def named(stage: Stage, kind: str, name: str, thing: Thing, at: Flat, heading_deg: float = 0.0) -> Prop:
    """Makes a landmark of something that was built and placed."""
    return stage.register(
        kind, name, thing, at=at, heading_deg=heading_deg, area=None, look=Look(kind, {}, {}), landmark=True
    )
