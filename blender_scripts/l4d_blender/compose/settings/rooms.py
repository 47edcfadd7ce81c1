"""What the rooms of composed scenes share: walls, what fits along them, windows, light and cameras.

A `Room` is planned from its free floor outwards: cameras that see whoever is anywhere on the floor, walls
that leave the cameras inside, then furniture that hides nothing of the floor from them. Knows no particular
room.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import asin, atan2, cos, degrees, hypot, radians, sin, tan
from typing import TYPE_CHECKING, Any

from ...assets import floor_lamp
from ...scene import catalogue
from ...scene.colour import Colour
from ..areas import Area, Flat, heading_to
from ..errors import Rejected
from ..stage import Chair, Prop

if TYPE_CHECKING:
    from ..stage import Stage


HEADINGS = {"back": 0.0, "left": 90.0, "right": -90.0}
TALL_M = 1.85
"""Of the tallest person, hair included: has to fit into every picture."""
FEET_M = 0.2
_SLIGHTLY = 0.02
_ASPECT = 0.75

PLASTERS: tuple[Colour, ...] = (
    (0.60, 0.56, 0.48),
    (0.66, 0.63, 0.57),
    (0.46, 0.50, 0.42),
    (0.38, 0.46, 0.50),
    (0.60, 0.46, 0.30),
    (0.52, 0.33, 0.25),
    (0.50, 0.44, 0.50),
    (0.30, 0.37, 0.36),
    (0.62, 0.54, 0.36),
    (0.34, 0.40, 0.52),
)
TIMBERS: tuple[Colour, ...] = (
    (0.36, 0.215, 0.115),
    (0.25, 0.15, 0.085),
    (0.46, 0.32, 0.19),
    (0.17, 0.10, 0.06),
    (0.40, 0.34, 0.27),
)
CLOTHS = ("red", "orange", "yellow", "green", "teal", "blue", "navy", "purple", "brown", "beige", "grey")


@dataclass(frozen=True)
class Mood:
    """A light: how bright what comes from where is, and what is seen outside."""

    name: str
    sky: str
    glow: float
    sun: float
    daylight_w: float  # per square metre of window
    lamps_w: float  # per lamp
    fill_w: float  # from above, over the whole room
    world: float
    tint: Colour
    words: str


MOODS = (
    Mood("sun", "day", 1.15, 9.0, 40.0, 0.0, 80.0, 0.42, (1.0, 0.95, 0.88), "in the sun"),
    Mood("morning", "day", 1.0, 7.0, 40.0, 6.0, 80.0, 0.40, (1.0, 0.88, 0.74), "in the early sun"),
    Mood("overcast", "overcast", 0.9, 0.0, 42.0, 0.0, 85.0, 0.5, (0.90, 0.95, 1.0), "on a grey day"),
    Mood("noon", "day", 1.1, 0.0, 38.0, 0.0, 130.0, 0.55, (0.98, 0.99, 1.0), "at noon"),
    Mood("dusk", "dusk", 0.8, 0.0, 7.0, 50.0, 90.0, 0.2, (1.0, 0.84, 0.64), "at dusk"),
    Mood("evening", "night", 1.0, 0.0, 0.0, 62.0, 120.0, 0.2, (1.0, 0.80, 0.58), "in the evening"),
)


@dataclass(frozen=True)
class Box:
    """Room that something takes: in plan and in height."""

    x: tuple[float, float]
    y: tuple[float, float]
    z: tuple[float, float]

    def meets(self, other: Box, gap_m: float = 0.0) -> bool:
        """Whether both take the same room, or are closer than `gap_m` in plan."""
        return (
            self.x[0] < other.x[1] + gap_m
            and other.x[0] < self.x[1] + gap_m
            and self.y[0] < other.y[1] + gap_m
            and other.y[0] < self.y[1] + gap_m
            and self.z[0] < other.z[1]
            and other.z[0] < self.z[1]
        )


@dataclass(frozen=True)
class Lens:
    """The rig as `scene.cameras` gets it."""

    target: tuple[float, float, float]
    radius_m: float
    heights_m: tuple[float, float]
    arc_deg: float
    facing_deg: float
    fov_deg: float

    def eyes(self) -> list[tuple[float, float, float]]:
        """Where nine of the cameras are, both heights at each."""
        found = []
        for k in range(9):
            a = radians(self.facing_deg + self.arc_deg * (k / 8 - 0.5))
            at = self.target[0] + self.radius_m * cos(a), self.target[1] + self.radius_m * sin(a)
            found += [(*at, height) for height in self.heights_m]
        return found

    def shows(self, points: Sequence[tuple[float, float, float]], margin: float = 0.94) -> bool:
        """Whether every camera has all points in its picture."""
        wide = margin * tan(radians(self.fov_deg) / 2)
        for eye in self.eyes():
            dx, dy, dz = (self.target[k] - eye[k] for k in range(3))
            flat, length = hypot(dx, dy), hypot(dx, dy, dz)
            for p in points:
                px, py, pz = (p[k] - eye[k] for k in range(3))
                deep = (px * dx + py * dy + pz * dz) / length
                right = (px * dy - py * dx) / flat
                up = (pz * flat - (px * dx + py * dy) / flat * dz) / length
                if deep < 0.2 or abs(right) > wide * deep or abs(up) > _ASPECT * wide * deep:
                    return False
        return True


class Room:
    """A room that is being furnished."""

    def __init__(
        self,
        stage: Stage,
        key: str,
        *,
        floor_m: tuple[tuple[float, float], tuple[float, float]] = ((2.9, 3.4), (2.4, 2.8)),
        corners: Sequence[Flat] | None = None,
        in_sight: Sequence[tuple[float, float, float]] | None = None,
        back_m: tuple[float, float] = (0.45, 0.6),
        heights_m: tuple[tuple[float, float], tuple[float, float]] = ((1.45, 1.7), (1.9, 2.2)),
        moods: Sequence[str] = ("sun", "morning", "overcast", "noon", "dusk", "evening"),
    ) -> None:
        self.stage, self.scene, self.rng = stage, stage.scene, stage.rng(f"room/{key}")
        rng = self.rng
        width, depth = rng.uniform(*floor_m[0]), rng.uniform(*floor_m[1])
        corners = corners or _corners(width / 2, depth / 2)
        xs, ys = [x for x, _ in corners], [y for _, y in corners]
        self.floor_width_m, self.floor_depth_m = max(xs) - min(xs), max(ys) - min(ys)
        self.floor = stage.add_area(Area("floor", corners))
        in_sight = in_sight or [(0.92 * x, 0.92 * y, z) for x, y in corners for z in (0.0, TALL_M)]
        self.lens = _lens(rng, in_sight, heights_m)
        turned = radians(self.lens.arc_deg / 2 + abs(self.lens.facing_deg + 90))
        self.half_m = max(max(xs) + rng.uniform(0.55, 0.8), self.lens.radius_m * sin(turned) * 1.02 + 0.2)
        self.back_m = max(ys) + rng.uniform(*back_m)
        self.front_m = -self.lens.radius_m - 0.7
        self.mood = rng.choice([mood for mood in MOODS if mood.name in moods])
        self.taken: list[Box] = []
        self.openings: dict[str, list[tuple[float, float, float, float]]] = {}
        self.panes: list[tuple[str, float, float, float, float]] = []
        self.bulbs: list[tuple[float, float, float]] = []

    # ---- walls -----------------------------------------------------------------------------------

    def on_wall(self, wall: str, u: float, z: float = 0.0, out_m: float = 0.0) -> tuple[float, float, float]:
        """A world point on a wall: `u` is x of the back wall, y of the others; `out_m` into the room."""
        if wall == "back":
            return u, self.back_m - out_m, z
        return (-self.half_m + out_m, u, z) if wall == "left" else (self.half_m - out_m, u, z)

    def span(self, wall: str) -> tuple[float, float]:
        """From, to along a wall: what cameras see of it without standing in between."""
        if wall == "back":
            return -self.half_m + 0.08, self.half_m - 0.08
        return -0.8 * self.floor_depth_m, self.back_m - 0.08

    def free_on(
        self,
        walls: str | Sequence[str],
        size_m: tuple[float, float, float],
        *,
        z: float = 0.0,
        out_m: float = 0.02,
        gap_m: float = 0.06,
        near: float | None = None,
    ) -> tuple[str, float] | None:
        """A wall and where along it something of that size fits (its middle), or None.

        What is low and deep must not hide the floor from any camera. `near` prefers a place along the wall.
        """
        tries = []
        for wall in [walls] if isinstance(walls, str) else walls:
            low, high = self.span(wall)
            room = high - low - size_m[0]
            if room >= 0:
                tries += [(wall, low + size_m[0] / 2 + self.rng.random() * room) for _ in range(40)]
        self.rng.shuffle(tries)
        if near is not None:
            tries.sort(key=lambda at: abs(at[1] - near))
        for wall, u in tries:
            box = self.box_on(wall, u, size_m, z, out_m)
            if not any(box.meets(other, gap_m) for other in self.taken) and not self.hides(box, _SLIGHTLY):
                return wall, u
        return None

    def box_on(self, wall: str, u: float, size_m: tuple[float, float, float], z: float, out_m: float) -> Box:
        """The room of something with its back to a wall."""
        width, depth, height = size_m
        a, b = (
            self.on_wall(wall, u - width / 2, 0.0, out_m),
            self.on_wall(wall, u + width / 2, 0.0, out_m + depth),
        )
        return Box((min(a[0], b[0]), max(a[0], b[0])), (min(a[1], b[1]), max(a[1], b[1])), (z, z + height))

    def hides(self, box: Box, share: float = 0.0) -> bool:
        """Whether something there holds a camera, or hides the floor from more than a share of all views."""
        (x0, x1), (y0, y1) = box.x, box.y
        middle = self.floor.centre
        goals = [
            middle,
            *(
                (middle[0] + 0.75 * (x - middle[0]), middle[1] + 0.75 * (y - middle[1]))
                for x, y in self.floor.corners
            ),
        ]
        goals = [(x, y) for x, y in goals if not (x0 < x < x1 and y0 < y < y1)]
        eyes, hidden = self.lens.eyes(), 0
        for eye in eyes:
            if x0 - 0.25 < eye[0] < x1 + 0.25 and y0 - 0.25 < eye[1] < y1 + 0.25:
                return True
            hidden += sum(_passes(eye, (*goal, 0.15), box) for goal in goals)
        return hidden > share * len(eyes) * len(goals)

    # ---- things ----------------------------------------------------------------------------------

    def stand(
        self,
        kind: str,
        name: str,
        walls: str | Sequence[str],
        *,
        size_m: tuple[float, float, float] | None = None,
        out_m: float = 0.03,
        near: float | None = None,
        landmark: bool = True,
        origin: str = "middle",
        must: bool = False,
        turn_deg: float = 0.0,
        attributes: dict[str, str] | None = None,
        category: str | None = None,
        **words: Any,
    ) -> Prop | None:
        """Puts something with its back to a wall, where it fits; None (or a rejected draw) if nowhere.

        `origin` is where the kind has its own: in the "middle" of its depth, or at its "back".
        """
        size = size_m or catalogue.find(kind).size_m
        found = self.free_on(walls, size, out_m=out_m, near=near)
        if found is None:
            if must:
                raise Rejected(f"no room for the {name}")
            return None
        wall, u = found
        box = self.box_on(wall, u, size, 0.0, out_m)
        self.taken.append(box)
        at = self.on_wall(wall, u, 0.0, out_m + (size[1] / 2 if origin == "middle" else 0.0))
        heading = HEADINGS[wall] + turn_deg
        if not landmark:
            self.stage.dress(kind, name, at[:2], heading, **words)
            self.keep_clear(box, name)
            return None
        prop = self.stage.landmark(
            kind, name, at[:2], heading, attributes=attributes, category=category, **words
        )
        self.keep_clear(box, name)
        return prop

    def rim(
        self,
        kind: str,
        name: str,
        *,
        size_m: tuple[float, float] | None = None,
        sides: Sequence[str] = ("left", "right"),
        out_m: tuple[float, float] = (0.02, 0.2),
        hidden: float = 0.08,
        turned: bool = True,
        seat: bool = False,
        landmark: bool = True,
        attributes: dict[str, str] | None = None,
        category: str | None = None,
        **words: Any,
    ) -> Prop | None:
        """Puts something at the rim of the floor, turned to its middle; None if it hides too much there.

        `size_m` is its diameter in plan and its height, `out_m` how far outside its middle is, `hidden` the
        share of all views onto the floor that it may be in the way of; a `seat` has free floor before it.
        """
        rng = self.rng
        box_size = catalogue.find(kind).size_m
        wide, tall = size_m or (max(box_size[:2]), box_size[2])
        half_x, half_y = self.floor_width_m / 2, self.floor_depth_m / 2
        for _ in range(40):
            side, out = rng.choice(list(sides)), rng.uniform(*out_m)
            if side == "back":
                at = rng.uniform(-0.9, 0.9) * half_x, half_y + out
            else:
                at = (-1 if side == "left" else 1) * (half_x + out), rng.uniform(-0.25, 0.95) * half_y
            box = Box((at[0] - wide / 2, at[0] + wide / 2), (at[1] - wide / 2, at[1] + wide / 2), (0.0, tall))
            goal = rng.uniform(-0.3, 0.3), rng.uniform(-0.4, 0.1)
            heading = heading_to(at, goal) if turned else rng.uniform(-180, 180)
            inside = box.y[1] < self.back_m and max(-box.x[0], box.x[1]) < self.half_m
            if not inside or any(box.meets(other) for other in self.taken) or self.hides(box, hidden):
                continue
            if not seat or self.floor.is_free(self.feet(Chair((*at, 0.0), heading)), FEET_M + 0.1):
                break
        else:
            return None
        self.taken.append(box)
        more: dict[str, Any] = dict(area=self.floor, radius_m=0.44 * wide)
        if landmark:
            return self.stage.landmark(
                kind, name, at, heading, attributes=attributes, category=category, **more, **words
            )
        self.stage.dress(kind, name, at, heading, **more, **words)
        return None

    def bed(self, name: str, *, width_m: float = 0.98, **words: Any) -> Prop | None:
        """Along a side wall with its head in the corner, or with its head to the back wall."""
        rng, size = self.rng, (width_m, 2.07, 0.85)
        ways = [("left", 0.0), ("right", 0.0), ("back", 0.0)]
        rng.shuffle(ways)
        for wall, _ in ways:
            if wall == "back":
                found = self.free_on("back", size)
                if found is None:
                    continue
                box = self.box_on("back", found[1], size, 0.0, 0.03)
            else:
                side = -1 if wall == "left" else 1
                x = side * (self.half_m - 0.04 - width_m / 2)
                box = Box(
                    (x - width_m / 2, x + width_m / 2), (self.back_m - 2.1, self.back_m - 0.03), (0.0, 0.85)
                )
                if any(box.meets(other, 0.06) for other in self.taken) or self.hides(box, 0.03):
                    continue
            self.taken.append(box)
            at = (box.x[0] + box.x[1]) / 2, (box.y[0] + box.y[1]) / 2
            prop = self.stage.landmark("bed", name, at, width_m=width_m, **words)
            self.keep_clear(box, name)
            return prop
        return None

    def litter(self, kinds: Sequence[str], count: int) -> None:
        """Small things on the floor outside of where people act, as they were left."""
        rng = self.stage.rng("litter")
        for k in range(count):
            kind = rng.choice(list(kinds))
            size = catalogue.find(kind).size_m
            wide = max(size[:2])
            for _ in range(20):
                x = rng.choice((-1, 1)) * (self.floor_width_m / 2 + rng.uniform(0.05, 0.5))
                y = rng.uniform(-0.3, 0.5) * self.floor_depth_m
                box = Box((x - wide / 2, x + wide / 2), (y - wide / 2, y + wide / 2), (0.0, size[2]))
                if not any(box.meets(other, 0.03) for other in self.taken) and not self.hides(box):
                    self.taken.append(box)
                    self.stage.dress(kind, f"litter_{k + 1}", (x, y), rng.uniform(-180, 180))
                    break

    def reject(self, what: str) -> None:
        """Ends a draw in which something that the place offers found no room."""
        raise Rejected(f"no room for the {what}")

    def rim_bench(
        self,
        kind: str,
        name: str,
        *,
        length_m: float,
        depth_m: float,
        sides: Sequence[str] = ("left", "right", "back"),
        **words: Any,
    ) -> Prop:
        """A long seat along an edge of the floor, its front to the middle."""
        rng, half_x, half_y = self.rng, self.floor_width_m / 2, self.floor_depth_m / 2
        for _ in range(60):
            side = rng.choice(list(sides))
            out = rng.uniform(-0.25, 0.0) + depth_m / 2
            if side == "back":
                slack = max(0.0, half_x - length_m / 2)
                at, sizes = (rng.uniform(-slack, slack), half_y + out), (length_m, depth_m)
            else:
                at = (-1 if side == "left" else 1) * (half_x + out), rng.uniform(-0.1, half_y - length_m / 2)
                sizes = depth_m, length_m
            box = Box(
                (at[0] - sizes[0] / 2, at[0] + sizes[0] / 2),
                (at[1] - sizes[1] / 2, at[1] + sizes[1] / 2),
                (0.0, catalogue.find(kind).size_m[2]),
            )
            inside = box.y[1] < self.back_m and max(-box.x[0], box.x[1]) < self.half_m
            if inside and not any(box.meets(other) for other in self.taken) and not self.hides(box, 0.08):
                self.taken.append(box)
                prop = self.stage.landmark(kind, name, at, HEADINGS[side], **words)
                self.keep_clear(box, name)
                return prop
        raise Rejected(f"no room for the {name}")

    def lamp(self, name: str = "lamp", *, walls: Sequence[str] = ("back", "left", "right")) -> Prop | None:
        """A standing lamp, lit when it is dark outside."""
        glow = 1.4 if self.mood.lamps_w else 0.45
        prop = self.stand("floor_lamp", name, walls, size_m=(0.42, 0.42, 1.35), glow=glow)
        if prop is not None:
            self.bulbs.append((*prop.at, floor_lamp.SHADE_HEIGHT_M + 0.02))
        return prop

    def pendants(self, count: int, at: Flat = (0.0, 0.0), *, z: float = 2.15, spread_m: float = 0.8) -> None:
        """Lamps in a row under the ceiling, above everybody's head."""
        rng = self.stage.rng("pendants")
        looks: dict[str, Any] = dict(
            colour=rng.choice((*CLOTHS, "white", "black")),
            shape=rng.choice(("dome", "cone", "drum", "bowl")),
            glow=4.0 if self.mood.lamps_w else 0.6,
        )
        for k in range(count):
            x = at[0] + (k - (count - 1) / 2) * spread_m
            self.stage.dress("pendant_lamp", f"pendant_{k + 1}", (x, at[1], z), **looks)
            self.bulbs.append((x, at[1], z - 0.02))

    def plant(self, name: str = "plant", *, landmark: bool = True) -> Prop | None:
        """A plant in a pot on the floor, in a corner or beside something."""
        tall = self.rng.uniform(0.65, 1.15)
        return self.stand(
            "houseplant",
            name,
            ("back", "left", "right"),
            size_m=(tall, tall, 1.05 * tall),
            height_m=tall,
            landmark=landmark,
        )

    def keep_clear(self, box: Box, owner: str, *, in_front_m: float = 0.0) -> None:
        """Takes the part of the floor that a box on it covers; less where somebody sits down before it."""
        width, depth = box.x[1] - box.x[0], box.y[1] - box.y[0]
        radius = min(width, depth) / 2
        x, y = (box.x[0] + box.x[1]) / 2, (box.y[0] + box.y[1]) / 2
        if width >= depth:
            ends = (box.x[0] + radius, y), (box.x[1] - radius, y)
        else:
            ends = (x, box.y[0] + radius), (x, box.y[1] - radius)
        self.floor.take(ends[0], max(radius - in_front_m, 0.05), ends[1], owner=owner)

    def seat(
        self, prop: Prop, *, height_m: float, ahead_m: float = 0.1, along_m: float = 0.0
    ) -> Chair | None:
        """Makes a chair of a landmark: where on the seat, in the landmark's own axes (it faces -Y).

        None if there is no free floor for the feet.
        """
        a = radians(prop.heading_deg)
        x = prop.at[0] + along_m * cos(a) + ahead_m * sin(a)
        y = prop.at[1] + along_m * sin(a) - ahead_m * cos(a)
        chair = Chair((x, y, height_m), prop.heading_deg, prop)
        if not self.floor.is_free(self.feet(chair), FEET_M, ignoring=[prop.name]):
            return None
        self.stage.chairs.append(chair)
        return chair

    @staticmethod
    def feet(chair: Chair) -> Flat:
        """Where those who sit on a chair have their feet."""
        a = radians(chair.heading_deg)
        return chair.seat[0] + 0.45 * sin(a), chair.seat[1] - 0.45 * cos(a)

    def hang(
        self,
        kind: str,
        name: str,
        walls: str | Sequence[str],
        z: float,
        *,
        size_m: tuple[float, float, float] | None = None,
        near: float | None = None,
        landmark: bool = False,
        middle_m: float = 0.0,
        **words: Any,
    ) -> Prop | None:
        """Hangs something on a wall where nothing is; its origin is `middle_m` above its foot."""
        size = size_m or catalogue.find(kind).size_m
        found = self.free_on(walls, size, z=z, out_m=0.0, near=near, gap_m=0.1)
        if found is None:
            return None
        wall, u = found
        self.taken.append(self.box_on(wall, u, size, z, 0.0))
        at, heading = self.on_wall(wall, u, z + middle_m, 0.012), HEADINGS[wall]
        if landmark:
            return self.stage.landmark(kind, name, at, heading, **words)
        self.stage.dress(kind, name, at, heading, **words)
        return None

    def clock(self, walls: Sequence[str] = ("back", "left", "right"), *, z: float = 1.9) -> Prop | None:
        """A station clock; `z` is its lower edge."""
        return self.hang(
            "waiting_room.clock", "clock", walls, z, size_m=(0.36, 0.03, 0.36), landmark=True, middle_m=0.18
        )

    def window(
        self,
        name: str,
        walls: str | Sequence[str],
        *,
        width_m: float = 1.3,
        height_m: float = 1.2,
        sill_m: float = 0.9,
        near: float | None = None,
        landmark: bool = True,
        hanging: str | None = None,
        **words: Any,
    ) -> Prop | None:
        """Breaks a window into a wall."""
        size = (width_m + 0.5, 0.30, height_m + 0.2)
        found = self.free_on(walls, size, z=sill_m - 0.05, out_m=0.0, near=near)
        if found is None:
            return None
        wall, u = found
        self.taken.append(self.box_on(wall, u, size, sill_m - 0.05, 0.0))
        opening = (u - width_m / 2, u + width_m / 2, sill_m, sill_m + height_m)
        self.openings.setdefault(wall, []).append(opening)
        self.panes.append((wall, u, width_m, sill_m, height_m))
        looks: dict[str, Any] = (
            dict(
                width_m=width_m,
                height_m=height_m,
                sill_m=sill_m,
                sky=self.mood.sky,
                glow=self.mood.glow,
                hanging=hanging or self.rng.choice(("bare", "curtains", "curtains", "blind")),
                columns=self.rng.choice((1, 2, 2, 3)),
                rows=self.rng.choice((1, 2, 3)),
            )
            | words
        )
        at, heading = self.on_wall(wall, u), HEADINGS[wall]
        if landmark:
            return self.stage.landmark("lit_window", name, at[:2], heading, **looks)
        self.stage.dress("lit_window", name, at[:2], heading, **looks)
        return None

    def door(
        self,
        name: str,
        walls: str | Sequence[str],
        *,
        landmark: bool = True,
        kind: str = "panel_door",
        **words: Any,
    ) -> Prop | None:
        """Hangs a door, and keeps the way to it clear of furniture."""
        width, _, height = catalogue.find(kind).size_m
        found = self.free_on(walls, (width, 0.5, height), out_m=0.0)
        if found is None:
            return None
        wall, u = found
        self.taken.append(self.box_on(wall, u, (width, 0.5, height), 0.0, 0.0))
        at, heading = self.on_wall(wall, u), HEADINGS[wall]
        if landmark:
            return self.stage.landmark(kind, name, at[:2], heading, **words)
        self.stage.dress(kind, name, at[:2], heading, **words)
        return None

    def decorate(self, prop: Prop, kinds: Sequence[str], *, most: int = 3, depth_m: float = 0.3) -> None:
        """Small things in a row on top of a landmark."""
        rng = self.stage.rng(f"decorate/{prop.name}")
        points = [v.co for part in prop.instance.objects for v in part.data.vertices]
        top, half = max(p.z for p in points), max(p.x for p in points)
        chosen = rng.sample(list(kinds), rng.randint(1, min(most, len(kinds))))
        step = 2 * half / len(chosen)
        for k, kind in enumerate(chosen):
            x, y = (k + 0.5) * step - half + rng.uniform(-0.15, 0.15) * step, rng.uniform(-0.2, 0.2) * depth_m
            a = radians(prop.heading_deg)
            at = prop.at[0] + x * cos(a) - y * sin(a), prop.at[1] + x * sin(a) + y * cos(a)
            name = f"{prop.name}_top_{k + 1}"
            self.stage.dress(kind, name, at, prop.heading_deg + rng.uniform(-40, 40), on=top)

    def beside(self, box: Box) -> None:
        """Notes room that something takes which the place puts by itself."""
        self.taken.append(box)

    # ---- shell and light -------------------------------------------------------------------------

    def finish(self, **shell: Any) -> None:
        """Builds the shell round the openings, lights the room and sets up the cameras."""
        tall = 6.0 if self.mood.sun else 4.2
        self.scene.put(
            "plain_room",
            "room",
            rng=self.stage.rng("room/shell"),
            half_width_m=self.half_m,
            back_m=self.back_m,
            front_m=self.front_m,
            height_m=tall,
            openings=self.openings,
            **shell,
        )
        self.scene.exposure = _exposure(shell)
        self._light()
        lens = self.lens
        self.scene.cameras(
            lens.target,
            radius_m=lens.radius_m,
            heights_m=lens.heights_m,
            arc_deg=lens.arc_deg,
            facing_deg=lens.facing_deg,
            fov_deg=lens.fov_deg,
        )

    def _light(self) -> None:
        scene, rng, mood = self.scene, self.rng, self.mood
        scene.hdri("interior", mood.world * rng.uniform(0.9, 1.1), rotation_deg=rng.uniform(0, 360))
        for k, (wall, u, width, sill, height) in enumerate(self.panes):
            power = mood.daylight_w * width * height
            if power > 0:
                at = self.on_wall(wall, u, sill + height / 2, 0.25)
                scene.area_light(
                    f"daylight_{k}",
                    at,
                    self.on_wall(wall, u, 0.6, 3.0),
                    size_m=(width, height),
                    power_w=power,
                    colour=mood.tint,
                )
        scene.area_light(
            "ceiling",
            (0.0, 0.0, 2.9),
            (0.0, 0.0, 0.0),
            size_m=(1.6 * self.half_m, 2.6),
            power_w=mood.fill_w,
            colour=mood.tint,
        )
        for k, bulb in enumerate(self.bulbs):
            if mood.lamps_w > 0:
                scene.point_light(
                    f"bulb_{k}", bulb, power_w=mood.lamps_w * rng.uniform(0.85, 1.15), radius_m=0.09
                )
        if mood.sun and self.panes:
            self._sun()

    def rug(self, name: str = "rug", *, at: Flat | None = None, plain: bool | None = None) -> Prop:
        """Lays a rug, woven or tufted, somewhere in the middle of the floor."""
        rng = self.stage.rng(f"rug/{name}")
        at = at or (rng.uniform(-0.3, 0.3), rng.uniform(-0.25, 0.2))
        turn = rng.choice((0.0, rng.uniform(-8, 8)))
        size = rng.uniform(1.6, 2.3), rng.uniform(1.2, 1.6)
        if not (rng.random() < 0.75 if plain is None else plain):
            return self.stage.landmark("rug", name, at, turn, size_m=size, palette=rng.choice("012"))
        ground, accent = rng.sample((*CLOTHS, "white", "black"), 2)
        shape = rng.choice(("oblong", "oblong", "round"))
        pattern = rng.choice(
            ("banded", "bordered", "checked", "plain")
            if shape == "oblong"
            else ("rings", "bordered", "plain")
        )
        return self.stage.landmark(
            "flat_rug",
            name,
            at,
            turn,
            size_m=size,
            colour=ground,
            accent=accent,
            shape=shape,
            pattern=pattern,
        )

    def pictures(self, count: int, *, walls: Sequence[str] = ("back", "left", "right")) -> None:
        """Hangs pictures at eye height, single or side by side."""
        rng = self.stage.rng("pictures")
        for k in range(count):
            wide, tall = rng.uniform(0.28, 0.6), rng.uniform(0.32, 0.62)
            self.hang(
                "picture_frame",
                f"picture_{k + 1}",
                walls,
                1.62 - tall / 2 + rng.uniform(-0.06, 0.06),
                size_m=(wide, 0.03, tall),
                palette=rng.randrange(3),
            )

    def _sun(self) -> None:
        """Through the first window, towards the floor."""
        wall, u, _, sill, height = self.panes[0]
        at = self.on_wall(wall, u, sill + height / 2)
        goal = self.rng.uniform(-0.6, 0.6), self.rng.uniform(-0.5, 0.3)
        dx, dy = at[0] - goal[0], at[1] - goal[1]
        self.scene.sun(
            elevation_deg=degrees(asin(at[2] / hypot(dx, dy, at[2]))),
            azimuth_deg=degrees(atan2(dy, dx)),
            strength=self.mood.sun,
            angle_deg=1.2,
            colour=(1.0, 0.86, 0.68) if self.mood.name == "morning" else (1.0, 0.93, 0.82),
        )


def behind_counter(
    stage: Stage, key: str, size_m: tuple[float, float], top_m: float, aisle_m: tuple[float, float]
) -> Room:
    """A room round a counter at the origin, seen from its front: whoever uses it stands behind, in the aisle.

    The cameras are close, since what lies on a counter is small. Adds the area "counter", whose first two
    corners are its back edge.
    """
    x, y = size_m[0] / 2, size_m[1] / 2
    wide, aisle = x + 0.35, stage.rng(f"{key}/aisle").uniform(*aisle_m)
    room = Room(
        stage,
        key,
        corners=[(-wide, y), (wide, y), (wide, y + aisle), (-wide, y + aisle)],
        in_sight=[
            *((a, b, z) for a in (-x, x) for b in (-y, y) for z in (top_m - 0.35, top_m + 0.05)),
            *((a, b, TALL_M) for a in (-x, x) for b in (y + 0.1, y + aisle)),
        ],
        back_m=(0.66, 0.7),
    )
    room.beside(Box((-x, x), (-y, y), (0.0, top_m + 0.05)))
    corners = [(x - 0.03, y - 0.03), (0.03 - x, y - 0.03), (0.03 - x, 0.03 - y), (x - 0.03, 0.03 - y)]
    stage.add_area(Area("counter", corners, on=top_m))
    return room


def _exposure(shell: dict[str, Any]) -> float:
    """As a camera would: a pale room is exposed less than a dark one."""
    wall = shell["wall_colour"]
    if shell["wall"] in ("panelled", "tiled", "two_tone"):
        wall = tuple(0.6 * a + 0.4 * b for a, b in zip(wall, shell["second_colour"]))
    pale = 0.5 * sum(wall) / 3 + 0.5 * sum(shell["floor_colour"]) / 3
    return round(min(1.35, max(0.75, (0.32 / pale) ** 0.5)), 3)


def shell_looks(rng: random.Random, floors: Sequence[str], walls: Sequence[str]) -> dict[str, Any]:
    """Finishes of floor and walls in colours that go together."""
    floor, wall = rng.choice(list(floors)), rng.choice(list(walls))
    floor_colour = {
        "boards": lambda: rng.choice(TIMBERS),
        "tiles": lambda: rng.choice(
            ((0.3, 0.13, 0.07), (0.30, 0.28, 0.25), (0.44, 0.38, 0.30), (0.16, 0.20, 0.22))
        ),
        "chequered": lambda: rng.choice(((0.5, 0.47, 0.38), (0.52, 0.50, 0.46), (0.42, 0.46, 0.44))),
        "carpet": lambda: rng.choice(
            ((0.13, 0.15, 0.17), (0.22, 0.18, 0.14), (0.12, 0.18, 0.16), (0.2, 0.1, 0.1))
        ),
        "rubber": lambda: (0.1, 0.1, 0.1),
        "concrete": lambda: rng.choice(((0.30, 0.29, 0.28), (0.38, 0.36, 0.33))),
    }[floor]()
    plaster = rng.choice(PLASTERS)
    if wall == "brick":
        plaster = rng.choice(((0.34, 0.13, 0.08), (0.42, 0.24, 0.16), (0.52, 0.48, 0.42)))
    elif wall == "boards":
        plaster = rng.choice(((0.46, 0.34, 0.22), (0.30, 0.19, 0.11), (0.58, 0.56, 0.50)))
    second = {
        "wallpaper": tuple(min(1.0, c * rng.choice((0.7, 1.3))) for c in plaster),
        "two_tone": rng.choice(
            ((0.17, 0.27, 0.24), (0.14, 0.20, 0.30), (0.30, 0.14, 0.10), (0.30, 0.27, 0.18))
        ),
        "panelled": rng.choice(
            ((0.60, 0.58, 0.52), (0.24, 0.30, 0.27), (0.34, 0.21, 0.12), (0.20, 0.25, 0.32))
        ),
        "tiled": rng.choice(((0.68, 0.64, 0.55), (0.30, 0.42, 0.42), (0.62, 0.62, 0.60), (0.25, 0.32, 0.42))),
    }.get(wall, (0.3, 0.3, 0.3))
    trim = rng.choice(((0.68, 0.66, 0.61), (0.68, 0.66, 0.61), (0.30, 0.18, 0.10), (0.20, 0.22, 0.23)))
    return dict(
        floor=floor,
        wall=wall,
        floor_colour=floor_colour,
        wall_colour=plaster,
        second_colour=second,
        trim_colour=trim,
    )


def _passes(eye: Sequence[float], goal: Sequence[float], box: Box) -> bool:
    """Whether the line between two points meets a box."""
    low, high = 0.0, 1.0
    for start, end, (a, b) in zip(eye, goal, (box.x, box.y, box.z)):
        if abs(end - start) < 1e-9:
            if not a < start < b:
                return False
            continue
        first, last = sorted(((a - start) / (end - start), (b - start) / (end - start)))
        low, high = max(low, first), min(high, last)
    return low < high


def _corners(x: float, y: float) -> list[Flat]:
    """A floor without the two corners that are nearest to the cameras."""
    cut = 0.55
    return [(cut - x, -y), (x - cut, -y), (x, cut - y), (x, y), (-x, y), (-x, cut - y)]


def _lens(
    rng: random.Random,
    points: Sequence[tuple[float, float, float]],
    heights: tuple[tuple[float, float], tuple[float, float]],
) -> Lens:
    """The closest rig that has these points in all its pictures."""
    fov, arc = rng.uniform(54.0, 62.0), rng.uniform(92.0, 104.0)
    facing = -90.0 + rng.uniform(-4.0, 4.0)
    low, high = rng.uniform(*heights[0]), rng.uniform(*heights[1])
    for step in range(70):
        for target_z in (0.7, 0.62, 0.78, 0.54, 0.86, 0.46):
            lens = Lens((0.0, 0.0, target_z), 2.2 + 0.05 * step, (low, high), arc, facing, fov)
            if lens.shows(points):
                return lens
    raise Rejected("no cameras see the whole floor")


def words_if(wanted: bool, **words: Any) -> dict[str, Any]:
    """These words of the catalogue, or none."""
    return words if wanted else {}
