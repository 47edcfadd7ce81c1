"""What tables of composed scenes share: sitters, what lies on them, the room round them, light, cameras.

The middle of a table's top is the origin and z = 0 is where things lie; sitters are at its back (+Y) and its
ends, cameras look from the front (-Y), where no one sits. Knows no particular table.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...scene import catalogue
from ...scene.catalogue import COLOURS
from ...scene.colour import Colour
from ..areas import Area, Flat, retried
from ..errors import NoRoom
from ..hands.arms import reaches
from ..stage import Seat
from . import rooms

if TYPE_CHECKING:
    from ..stage import Stage


SHOULDER_M = 0.25
_RESTING = "resting hands"
_BEHIND_M = 0.115  # how far behind the edge of the table a chest is
_WIDE_M = 0.128  # radius of landmarks of which one is enough
_ENDS = 0.74  # share of the half length beyond which the ends of a table begin
_REST_M = 0.28  # from the chest to where a palm rests
CLOTHS = tuple(word for word in COLOURS if word != "black")
OAK = ((0.40, 0.235, 0.115), (0.21, 0.105, 0.045))
WALNUT = ((0.20, 0.105, 0.055), (0.09, 0.045, 0.025))
PINE = ((0.56, 0.38, 0.19), (0.40, 0.25, 0.11))
BIRCH = ((0.62, 0.50, 0.34), (0.50, 0.37, 0.22))
GREY = ((0.36, 0.33, 0.29), (0.22, 0.20, 0.17))
PAINTED = ((0.52, 0.55, 0.50), (0.44, 0.47, 0.43))


@dataclass(frozen=True)
class Put:
    """How something lies or stands on a table: its kind, the room it needs, what may be drawn of its looks.

    `tall` things go to the ends, where they hide nothing; `facing` is the heading that shows their front to
    the cameras (None: any).
    """

    kind: str
    radius_m: float
    tall: bool = False
    facing: float | None = 0.0
    looks: Mapping[str, Sequence[Any]] = field(default_factory=dict)


_ANY = {"colour": CLOTHS}
PUTS: dict[str, Put] = {
    "lamp": Put(
        "desk_lamp",
        0.15,
        True,
        None,
        {"colour": ("red", "orange", "yellow", "green", "teal", "white", "black")},
    ),
    "book": Put("book", 0.135, False, None, _ANY),
    "plant": Put(
        "plant_pot", 0.14, True, None, {"colour": ("brown", "orange", "teal", "white", "grey", "blue")}
    ),
    "herbs": Put("kitchen_clutter.herb_pot", 0.10, True, None),
    "notepad": Put("notepad", 0.10),
    "keyboard": Put("keyboard", 0.15, False, 180.0),
    "laptop": Put("laptop", 0.23, True, 0.0, {"colour": ("silver", "black", "copper", "white")}),
    "pen_pot": Put("pen_pot", 0.06, True, None, _ANY),
    "mat": Put("mouse_mat", 0.155, False, 0.0, _ANY),
    "candle": Put("candle", 0.05, False, None, {"height_m": (0.06, 0.08, 0.1, 0.12)}),
    "vase": Put("flower_vase", 0.095, True, None),
    "jug": Put("kitchen_jug", 0.125, True, None, _ANY),
    "bowl": Put("fruit.fruit_bowl", 0.16, False, None, _ANY),
    "plate": Put("soup_bowl.plate", 0.102, False, None),
    "tray": Put("serving_tray", 0.18, False, None),
    "coaster": Put("saucer.coaster", 0.055, False, None),
    "saucer": Put("saucer", 0.075, False, None),
    "board": Put("bread_board", 0.21, False, 0.0),
    "tin": Put("biscuit_tin", 0.06, False, None, _ANY),
    "box": Put("wooden_box", 0.135, False, 0.0),
    "napkin": Put("dining_table.runner", 0.17, False, 0.0),
    "magazine": Put("magazine.pile", 0.2, False, None),
    "phone": Put("phone", 0.085, False, 180.0),
    "picture_book": Put("picture_book", 0.185, False, 180.0, _ANY),
    "trivet": Put("tray.trivet", 0.117, False, 0.0),
    "towel": Put("gym_equipment.folded_towel", 0.17, False, 0.0, _ANY),
    "crayons": Put("crayons.crayon_box", 0.075, False, None),
    "oil_can": Put("workshop_clutter.oil_can", 0.065, False, None),
    "screwdriver": Put("workshop_clutter.screwdriver", 0.10, False, None),
    "ruler": Put("drawing_tools.ruler", 0.107, False, None),
    "rubber": Put("drawing_tools.rubber", 0.03, False, None, _ANY),
    "glasses": Put("glasses", 0.1, False, 180.0),
    "headphones": Put("headphones", 0.125, False, 180.0, _ANY),
    "jar": Put("kitchen_clutter.jar", 0.062, True, None, _ANY),
    "parts": Put("workshop_clutter.loose_parts", 0.065, False, None),
    "spool": Put("workshop_clutter.spool", 0.022, False, None, _ANY),
    "notes": Put("paper_sheets.sticky_notes", 0.055, False, 180.0, _ANY),
    "paper": Put("paper_sheets", 0.15, False, 180.0),
    "loose_crayons": Put("crayons.loose_crayons", 0.085, False, None),
    "grapes": Put("fruit.grapes", 0.09, False, None),
    "pear": Put("fruit.pear", 0.037, False, None),
    "lemon": Put("fruit.lemon", 0.045, False, None),
    "loaf": Put("kitchen_clutter.loaf", 0.17, False, 0.0),
    "biscuits": Put("sugar_bowl.biscuits", 0.096, False, None),
}


@dataclass(frozen=True)
class Mood:
    """A light: the panorama, daylight from where the window is (or a sun outdoors), a lamp above."""

    name: str
    world: str
    world_strength: float
    daylight_w: float
    tint: Colour
    fill_w: float
    lamp_w: float
    sky: str
    words: str


MOODS = (
    Mood("morning", "sunrise", 0.30, 34.0, (1.0, 0.84, 0.66), 10.0, 0.0, "day", "in the early sun"),
    Mood("noon", "interior", 0.45, 30.0, (1.0, 0.98, 0.94), 16.0, 0.0, "day", "at noon"),
    Mood("overcast", "studio", 0.35, 24.0, (0.86, 0.93, 1.0), 15.0, 0.0, "overcast", "on a grey day"),
    Mood("dusk", "sunset", 0.16, 9.0, (0.80, 0.72, 0.82), 6.0, 11.0, "dusk", "at dusk"),
    Mood("evening", "interior", 0.10, 0.0, (1.0, 0.9, 0.8), 7.0, 18.0, "night", "in the evening"),
)


class Tabletop:
    """A table that is being laid, `size_m` long and deep, its top `height_m` above the floor."""

    def __init__(
        self,
        stage: Stage,
        key: str,
        size_m: tuple[float, float],
        height_m: float = 0.74,
        *,
        widest_m: float = 0.84,
    ) -> None:
        self.stage, self.scene, self.rng = stage, stage.scene, stage.rng(f"tabletop/{key}")
        self.size_m, self.height_m = size_m, height_m
        width, depth = min(size_m[0] - 0.10, widest_m), min(size_m[1] - 0.08, 0.56)
        self.table = stage.add_area(Area.rectangle("table", (0.0, 0.0), (width, depth)))
        self.mood = self.rng.choice(MOODS)
        self._aside = False
        self.window_at: tuple[float, float, float, float, float] | None = None

    # ---- people ----------------------------------------------------------------------------------

    def seats(
        self,
        *layouts: str,
        chair: str | None = "wooden_chair",
        shoulder_m: float = SHOULDER_M,
        chair_scale: float = 1.0,
        **looks: Any,
    ) -> None:
        """Draws one of some layouts: b is the middle of the back, B two at the back, l and r the ends."""
        half_x, half_y = self.size_m[0] / 2, self.size_m[1] / 2
        spots: list[tuple[Flat, float]] = []
        apart = min(0.31, half_x - 0.22)
        for letter in self.rng.choice(layouts):
            if letter in "bB":
                for x in (0.0,) if letter == "b" else (-apart, apart):
                    spots.append(((x + self.rng.uniform(-0.03, 0.03), half_y + _BEHIND_M), 0.0))
            else:
                side = -1 if letter == "l" else 1
                at = (side * (half_x + _BEHIND_M), self.rng.uniform(-0.02, 0.10))
                spots.append((at, 90.0 if side < 0 else -90.0))
        for k, (at, heading) in enumerate(spots):
            self.stage.seats.append(Seat(at, heading, shoulder_m, _REST_M, sitter=True))
            if chair:
                thing = self.scene.make(chair, f"chair_{k + 1}", self.stage.rng("chairs"), **looks)
                self.scene.place(
                    thing, at, heading + self.rng.uniform(-4, 4), on=-self.height_m, scale=chair_scale
                )
        for arm in reaches(self.stage, self.rng):
            ahead = arm.rest[0] + 0.06 * arm.forward[0], arm.rest[1] + 0.06 * arm.forward[1]
            self.table.take(arm.rest, 0.075, ahead, owner=_RESTING)
            for start, end in arm.ways():
                self.table.take(start, 0.07, end, owner=_RESTING)

    # ---- things ----------------------------------------------------------------------------------

    def landmarks(self, count: int, *choices: str, aside: bool = False) -> None:
        """Lays some of the choices on the table: things that sentences may mention, at most one a noun.

        `aside` keeps them to the ends, so that the middle is left for something large.
        """
        self._aside = aside
        for name, at in retried(self.table, 120, lambda: self._layout(count, choices)):
            put, looks = PUTS[name], self._looks(PUTS[name])
            self.stage.landmark(
                put.kind,
                catalogue.find(put.kind).category,
                at,
                self._heading(put),
                on=self.table.on,
                radius_m=put.radius_m,
                attributes={"colour": looks["colour"]} if "colour" in looks else {},
                **looks,
            )

    def _layout(self, count: int, choices: Sequence[str]) -> list[tuple[str, Flat]]:
        """What lies where; one of them may be wide, so that room is left."""
        names: list[str] = []
        nouns: set[str] = set()
        for name in self.rng.sample(list(choices), len(choices)):
            noun = catalogue.find(PUTS[name].kind).category
            wide = sum(PUTS[other].radius_m > _WIDE_M for other in names)
            tall = sum(PUTS[other].tall for other in names)
            if noun in nouns or (wide and PUTS[name].radius_m > _WIDE_M) or (tall > 1 and PUTS[name].tall):
                continue
            if len(names) < count:
                names.append(name)
                nouns.add(noun)
        found = []
        for name in sorted(names, key=lambda n: (not PUTS[n].tall, -PUTS[n].radius_m)):
            at = self._spot(PUTS[name])
            self.table.take(at, PUTS[name].radius_m, owner=catalogue.find(PUTS[name].kind).category)
            found.append((name, at))
        return found

    def clutter(self, count: int, *choices: str) -> None:
        """Small things near the edges, of kinds that no theme casts; what finds no room is left out."""
        half_x, half_y = self.size_m[0] / 2 - 0.02, self.size_m[1] / 2 - 0.02
        nouns = {prop.instance.category for prop in self.stage.landmarks}
        whole = Area.rectangle("top", (0.0, 0.0), (2 * half_x, 2 * half_y))
        whole.taken = list(self.table.taken)
        for name in self.rng.sample(list(choices), min(count, len(choices))):
            put = PUTS[name]
            if catalogue.find(put.kind).category in nouns:
                continue
            for _ in range(60):
                at = self.rng.uniform(-half_x, half_x), self.rng.uniform(-half_y, half_y)
                outer = max(abs(at[0]) / half_x, at[1] / half_y) > 0.62
                if outer and whole.is_free(at, put.radius_m) and not (put.tall and at[1] < 0.05):
                    break
            else:
                continue
            whole.take(at, put.radius_m, owner=name)
            self.table.take(at, put.radius_m, owner=name)
            self.stage.dress(put.kind, name, at, self._heading(put), on=self.table.on, **self._looks(put))

    def _spot(self, put: Put) -> Flat:
        """Tall things at the ends, or at the back between two sitters; low ones anywhere."""
        half = self.table.corners[1][0]
        for _ in range(100):
            at = self.table.spot(self.rng, put.radius_m)
            if put.tall and (at[1] < 0.0 or abs(at[0]) < 0.45 * half):
                continue
            if not put.tall and put.radius_m > 0.12 and abs(at[0]) < 0.2 * half:
                continue
            if self._aside and abs(at[0]) < _ENDS * half:
                continue
            return at
        raise NoRoom(f"no room for the {put.kind}")

    def _heading(self, put: Put) -> float:
        if put.facing is None:
            return self.rng.uniform(-180, 180)
        return put.facing + self.rng.uniform(-18, 18)

    def _looks(self, put: Put) -> dict[str, Any]:
        return {key: self.rng.choice(list(words)) for key, words in put.looks.items()}

    # ---- what is round it ------------------------------------------------------------------------

    def room(self, floors: Sequence[str], walls: Sequence[str], *, back_m: tuple[float, float]) -> float:
        """Walls round the table with a window in the back wall; returns where the back wall is (y)."""
        rng, scene = self.rng, self.scene
        back = self.size_m[1] / 2 + rng.uniform(*back_m)
        half = rng.uniform(1.9, 2.6)
        width, height, sill = rng.uniform(1.0, 1.6), rng.uniform(1.0, 1.3), rng.uniform(0.7, 0.95)
        middle = rng.uniform(-0.5, 0.5)
        scene.put(
            "plain_room",
            "room",
            on=-self.height_m,
            rng=self.stage.rng("tabletop/shell"),
            half_width_m=half,
            back_m=back,
            front_m=-2.4,
            height_m=2.6,
            openings={"back": [(middle - width / 2, middle + width / 2, sill, sill + height)]},
            **rooms.shell_looks(rng, floors, walls),
        )
        scene.put(
            "lit_window",
            "window",
            (middle, back),
            0.0,
            on=-self.height_m,
            width_m=width,
            height_m=height,
            sill_m=sill,
            sky=self.mood.sky,
            hanging=rng.choice(("bare", "curtains", "blind")),
            curtain=rng.choice(CLOTHS),
            columns=rng.choice((1, 2, 2, 3)),
            rows=rng.choice((1, 2)),
        )
        self.window_at = (middle, back, sill + height / 2 - self.height_m, width, height)
        return back

    def furnish(self, back: float, *choices: tuple[str, float, dict[str, Any]]) -> None:
        """Stands furniture along the back wall; each choice is a kind, its width and words."""
        x = -1.7 + self.rng.uniform(0.0, 0.3)
        for k, (kind, width, looks) in enumerate(self.rng.sample(list(choices), len(choices))):
            x += width / 2
            if x + width / 2 > 1.8:
                break
            depth = catalogue.find(kind).size_m[1]
            if kind == "cabinet":
                depth = 0.42
            self.stage.dress(
                kind, f"furniture_{k + 1}", (x, back - depth / 2 - 0.03), 0.0, on=-self.height_m, **looks
            )
            x += width / 2 + self.rng.uniform(0.08, 0.5)

    def light(self) -> None:
        """Panorama, daylight from the window side, light from above, a lamp over the table by night."""
        scene, mood, rng = self.scene, self.mood, self.rng
        scene.hdri(
            mood.world, mood.world_strength * rng.uniform(0.85, 1.15), rotation_deg=rng.uniform(0, 360)
        )
        x, y, z, width, height = self.window_at or (rng.uniform(-0.6, 0.6), 1.2, 0.8, 1.2, 1.0)
        if mood.daylight_w:
            scene.area_light(
                "daylight",
                (x, y - 0.1, z + 0.1),
                (0.0, 0.0, 0.0),
                size_m=(width, height),
                power_w=mood.daylight_w * rng.uniform(0.85, 1.15),
                colour=mood.tint,
            )
        scene.area_light(
            "above",
            (rng.uniform(-0.5, 0.5), rng.uniform(-1.0, -0.4), 1.7),
            (0.0, 0.0, 0.0),
            size_m=(1.4, 1.0),
            power_w=mood.fill_w * rng.uniform(0.9, 1.2),
            colour=(1.0, 0.96, 0.9),
        )
        if mood.lamp_w:
            scene.point_light(
                "lamp_light",
                (rng.uniform(-0.25, 0.25), rng.uniform(-0.1, 0.2), 0.85),
                power_w=mood.lamp_w * rng.uniform(0.85, 1.15),
                radius_m=0.1,
                colour=(1.0, 0.80, 0.56),
            )

    def cameras(self) -> None:
        """The rig in front, narrower where somebody sits at an end. The last step: all room is free now."""
        rng = self.rng
        self.table.free(_RESTING)
        ends = any(abs(abs(seat.heading_deg) - 90) < 1 for seat in self.stage.seats)
        self.scene.cameras(
            (rng.uniform(-0.02, 0.02), rng.uniform(-0.04, 0.0), 0.02),
            radius_m=rng.uniform(0.93, 1.0),
            heights_m=(rng.uniform(0.52, 0.62), rng.uniform(0.72, 0.86)),
            arc_deg=rng.uniform(92, 104) if ends else rng.uniform(110, 132),
            facing_deg=-90 + rng.uniform(-7, 7),
            fov_deg=rng.uniform(41.5, 44.0),
        )


def wood(rng: random.Random, *woods: tuple[Colour, Colour]) -> dict[str, Any]:
    """Light and dark of one of some timbers, a little off."""
    light, dark = rng.choice(woods or (OAK, WALNUT, PINE, BIRCH))
    off = rng.uniform(0.85, 1.12)
    return {"light": tuple(c * off for c in light), "dark": tuple(c * off for c in dark)}
