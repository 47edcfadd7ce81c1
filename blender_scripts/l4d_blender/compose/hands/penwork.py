"""What hands do with pens and notebooks, planned in the plane and then played: write, roll a pen, lift one.

A deed finds room for what it needs and is played when that is built. Themes decide who does what when; the
motion code records what happens.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin

import bpy
from mathutils import Vector

from ...assets import marker_pen, notebook
from ...motion import writing
from ...motion.table_hands import TableHand
from ...motion.writing import PenHand
from ...scene.timeline import LAST_FRAME
from ..areas import Area, Flat, heading_to
from ..errors import NoRoom
from ..looks import Look
from ..stage import Stage
from .arms import Reach
from .handling import Item

PEN_M = 0.076
"""Radius of the disc that a pen needs if nothing is known of how it lies."""
SHUT_M = 0.134
"""The same of a shut notebook."""
_PEN = 0.062, 0.018  # half the length of a pen's middle line, and the radius round it
_OPEN = 0.060, 0.112
_SHUT = 0.040, 0.082
_PAPER_M = 0.5 * notebook.PAGE_M[0] + 0.008, 0.5 * notebook.PAGE_M[1] + 0.012
_GAP_M = 0.005  # between words
_NEAR_M = 0.32
_HAND_M = 0.055


@dataclass
class Oblong(Item):
    """Something longer than wide: it takes room along the line through its middle.

    That is its X axis for pens and open notebooks; a shut notebook is longest along Y.
    """

    half_m: float = 0.0
    on_m: float = 0.0  # how far above the table it lies
    turned_deg: float = 0.0  # from its heading to the line

    @classmethod
    def pen(cls, name: str, look: Look) -> Oblong:
        """A pen."""
        return cls(name, look, _PEN[1], half_m=_PEN[0])

    @classmethod
    def shut(cls, name: str, look: Look) -> Oblong:
        """A shut notebook."""
        return cls(name, look, _SHUT[1], half_m=_SHUT[0], turned_deg=90.0)

    def ends(self) -> tuple[Flat, Flat]:
        """Of the line through its middle."""
        turn = radians((self.heading_deg or 0.0) + self.turned_deg)
        dx, dy = self.half_m * cos(turn), self.half_m * sin(turn)
        return (self.at[0] - dx, self.at[1] - dy), (self.at[0] + dx, self.at[1] + dy)

    def world(self, point: Flat) -> Flat:
        """A point of its own axes on the table."""
        turn = radians(self.heading_deg or 0.0)
        c, s = cos(turn), sin(turn)
        return self.at[0] + c * point[0] - s * point[1], self.at[1] + s * point[0] + c * point[1]

    def corners(self) -> list[Flat]:
        """Of a notebook, with a little to spare."""
        x, y = _PAPER_M
        if isinstance(self, Spread):
            x += 0.5 * notebook.PAGE_M[0]
        return [self.world(point) for point in ((-x, -y), (x, -y), (x, y), (-x, y))]

    def is_free(self, table: Area, ignoring: Sequence[str] = ()) -> bool:
        """Whether it fits where it is."""
        start, end = self.ends()
        return table.is_free(start, self.radius_m, end, ignoring=ignoring)

    def place(self, table: Area, at: Flat) -> None:
        """Takes room."""
        self.at, self.placed = at, True
        start, end = self.ends()
        table.take(start, self.radius_m, end, owner=self.name)

    def lie_near(
        self,
        rng: random.Random,
        table: Area,
        middle: Flat,
        heading_deg: float,
        loose_deg: float,
        below: Sequence[str] = (),
        apart_from: Sequence[Oblong] = (),
    ) -> None:
        """Near a point of the table, turned roughly; arms that are named in `below` pass over it.

        What is thin enough to be `apart_from` other notebooks corner by corner takes less room than a disc.
        """
        for _ in range(400):
            turn, far = radians(rng.uniform(-180.0, 180.0)), rng.uniform(0.1, _NEAR_M)
            self.at = middle[0] + far * cos(turn), middle[1] + far * sin(turn)
            self.heading_deg = heading_deg + rng.uniform(-loose_deg, loose_deg)
            if self.is_free(table, below) and not any(overlap(self, book) for book in apart_from):
                self.place(table, self.at)
                return
        raise NoRoom(f"no room for {self.name}")

    def lie_on(self, rng: random.Random, book: Oblong) -> None:
        """On a notebook, near its middle, roughly across it; takes no room on the table."""
        turn = radians((book.heading_deg or 0.0) + rng.uniform(-180.0, 180.0))
        off = rng.uniform(0.0, 0.02)
        self.at = book.at[0] + off * cos(turn), book.at[1] + off * sin(turn)
        self.heading_deg = (book.heading_deg or 0.0) + rng.choice((0.0, 180.0)) + rng.uniform(-35.0, 35.0)
        self.on_m, self.placed = notebook.SHUT_M, True

    def lay(self, stage: Stage, rng: random.Random, table: Area) -> None:
        """Builds it where it was planned."""
        self.build(stage, rng, table, on=table.point(*self.at)[2] + self.on_m)


@dataclass
class Spread(Oblong):
    """An open notebook, and the line that will be written on its right page."""

    line: tuple[Flat, Flat] = ((0.0, 0.0), (0.0, 0.0))  # on the notebook's own axes
    words_m: tuple[float, ...] = ()

    @classmethod
    def open(cls, rng: random.Random, name: str, look: Look) -> Spread:
        """One with room for a few words; a theme says where it lies."""
        words = tuple(rng.uniform(0.012, 0.027) for _ in range(4))
        x, y = rng.uniform(0.024, 0.034), 0.078 - notebook.PITCH_M * rng.randint(2, 5)
        end = x + sum(words) + _GAP_M * (len(words) - 1)
        return cls(name, look, _OPEN[1], half_m=_OPEN[0], line=((x, y), (end, y)), words_m=words)

    def open_on(self, stage: Stage, table: Area) -> list[bpy.types.Object]:
        """Builds it with the words, which still hide below the page, and returns those."""
        scene, rng = stage.scene, stage.rng(f"member/{self.name}")
        heading = self.heading_deg or 0.0
        body = scene.put(self.look.kind, self.name, self.at, heading, rng=rng, on=table.on, **self.look.words)
        words, (x, y) = [], self.line[0]
        for k, length in enumerate(self.words_m):
            word = scene.make("notebook.word", f"{self.name}.word_{k}", rng, length_m=length)
            words.append(scene.place(word, (x, y, notebook.page_z(x) + 0.0003), on=body))
            x += length + _GAP_M
        prop = stage.register(
            self.look.kind,
            self.name,
            [body, *words],
            at=self.at,
            heading_deg=heading,
            area=None,
            look=self.look,
            radius_m=0.0,
        )
        self.thing = prop.instance
        return words


@dataclass
class Writing:
    """Takes a pen, writes a line in an open notebook, lays the pen down where it was.

    `start` is the frame at which the hand sets out; below 0 it has the pen between its fingers at frame 0.
    """

    pen: Oblong
    book: Spread
    start: int
    arm: Reach | None = None

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the notebook before its writer, for the pen on it or beside it, and for the arm."""
        book, pen = self.book, self.pen
        (ax, ay), (bx, _) = book.line
        for _ in range(240):
            book.heading_deg = arm.seat.heading_deg + 180.0 + rng.uniform(-12.0, 12.0)
            book.at = 0.0, 0.0
            aim = arm.middle[0] + rng.uniform(-0.16, 0.16), arm.middle[1] + rng.uniform(-0.16, 0.16)
            off = book.world((0.5 * (ax + bx), ay))
            book.at = aim[0] - off[0], aim[1] - off[1]
            ends = [book.world(point) for point in book.line]
            if not self._fits(table) or not all(arm.reaches(table, end) for end in ends):
                continue
            if not self._lay_pen(rng, table, arm):
                continue
            if arm.is_clear(table, pen.at, *ends, ignoring=(book.name,)):
                book.place(table, book.at)
                if not pen.on_m:
                    pen.place(table, pen.at)
                arm.take(table, pen.at, *ends)
                _keep_rest(table, arm)
                self.arm, pen.placed = arm, True
                return
        raise NoRoom(f"{arm.name} has no room to write")

    def _fits(self, table: Area) -> bool:
        """Whether the notebook is on the table, and clear of what is on it."""
        start, end = self.book.ends()
        on_table = min(map(table.margin, self.book.corners())) > 0.0
        return on_table and table.is_clear(start, end, self.book.radius_m + 0.02)

    def _lay_pen(self, rng: random.Random, table: Area, arm: Reach) -> bool:
        """On the right page below the line, or on the table to the side of the hand."""
        pen, book = self.pen, self.book
        if rng.random() < 0.5:
            pen.at = book.world((rng.uniform(0.070, 0.088), book.line[0][1] - rng.uniform(0.075, 0.095)))
            pen.on_m = notebook.page_z(0.08)
        else:
            pen.at = table.spot(rng, _PEN[1], near=book.at, within_m=(0.12, 0.30), tries=60)
            pen.on_m = 0.0
        # Its tail to the side of the hand, so that it only has to be tipped up.
        fingers = arm.heading_deg(pen.at)
        if arm.side == "r":
            pen.heading_deg = fingers + 180.0 + rng.uniform(-14.0, 4.0)
        else:
            pen.heading_deg = fingers + rng.uniform(-4.0, 14.0)
        if not arm.reaches(table, pen.at):
            return False
        return pen.on_m > 0.0 or (
            pen.is_free(table)
            and min(
                _apart(pen, book.world((x, y)))
                for x in (-0.15, -0.07, 0.0, 0.07, 0.15)
                for y in (-0.11, 0, 0.11)
            )
            > 0.07
        )

    def play(self, stage: Stage, rng: random.Random, words: Sequence[bpy.types.Object]) -> None:
        """Builds the hand and lets it write."""
        arm, pen, book = self.arm, self.pen.thing, self.book.thing
        assert arm is not None and pen is not None and book is not None
        hand, t = arm.hand(stage, PenHand), self.start
        grip = pen.matrix(0) @ (writing.TIP + Vector((writing.GRIP_M, 0.0, 0.0)))
        took = max(t + 15, 0)
        hand.approach(
            pen, (took - 15, took), grip="pinch", heading_deg=arm.heading_deg(self.pen.at), point=grip
        )
        first = took + 14
        last = min(first + rng.randint(32, 40), LAST_FRAME - 15)
        page = book.matrix(0)
        start, end = (page @ Vector((x, y, notebook.page_z(x) + 0.0004)) for x, y in self.book.line)
        shares = hand.write(
            book,
            (start, end),
            lift=(took, first),
            writing=(first, last),
            lay=(last, last + 14),
            forward=Vector((*arm.forward, 0.0)),
        )
        length = end - start
        written = [sum(self.book.words_m[: k + 1]) + _GAP_M * k for k in range(len(self.book.words_m))]
        writing.appear(words, [done / length.length for done in written], shares)
        down = last + 14
        if down + 8 <= LAST_FRAME:
            hand.release((down, down + 8))
            _go_back(hand, down + 8)


@dataclass
class Rolling:
    """Pushes a pen with the fingertips; it rolls on and comes to rest."""

    pen: Oblong
    start: int
    arm: Reach | None = None
    end: Flat = (0.0, 0.0)

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the pen, which lies across its way, and for the arm."""
        at, self.end = arm.push(rng, table, PEN_M, (0.07, 0.14), followed=0.45)
        dx, dy = self.end[0] - at[0], self.end[1] - at[1]
        self.pen.at, self.pen.placed, self.arm = at, True, arm
        table.take(at, PEN_M, self.end, owner=self.pen.name)
        arm.take(table, at, (at[0] + 0.45 * dx, at[1] + 0.45 * dy))
        far = (dx * dx + dy * dy) ** 0.5
        behind = [(at[0] - m * dx / far, at[1] - m * dy / far) for m in (0.06, 0.24)]
        table.take(behind[0], _HAND_M, behind[1], owner=f"{arm.name} pushing")
        _keep_rest(table, arm)
        self.pen.heading_deg = self.heading_deg + rng.uniform(-5.0, 5.0)

    @property
    def heading_deg(self) -> float:
        """Where the fingers point: along the pen's way."""
        return heading_to(self.pen.at, self.end)

    def play(self, stage: Stage, rng: random.Random) -> None:
        """Builds the hand and lets it push."""
        arm, pen, t = self.arm, self.pen.thing, self.start
        assert arm is not None and pen is not None
        hand = arm.hand(stage, PenHand)
        point = pen.matrix(0) @ Vector((0.008, 0.0, marker_pen.RADIUS_M + 0.0015))
        hand.approach(pen, (t, t + 16), grip="push", heading_deg=self.heading_deg, point=point)
        last = t + 16 + rng.randint(14, 17)
        way = Vector(self.end) - Vector(self.pen.at)
        hand.push_rolling(way.length, (t + 16, last), min(last + rng.randint(14, 22), LAST_FRAME))
        hand.release((last, last + 8))
        _go_back(hand, last + 8)


@dataclass
class Lifting:
    """Takes a pen between thumb and fingers, holds it up and lays it down again."""

    pen: Oblong
    start: int
    arm: Reach | None = None

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the pen and the arm."""
        at = arm.spot(rng, table, PEN_M, tries=80)
        self.pen.heading_deg = arm.heading_deg(at) + 90.0 * rng.choice((-1, 1)) + 90.0 + rng.uniform(-14, 14)
        self.pen.place(table, at)
        arm.take(table, at)
        _keep_rest(table, arm)
        self.arm = arm

    def play(self, stage: Stage, rng: random.Random) -> None:
        """Builds the hand and lets it lift."""
        arm, pen, t = self.arm, self.pen.thing, self.start
        assert arm is not None and pen is not None
        hand, here = arm.hand(stage, TableHand), pen.matrix(0).translation
        hand.approach(pen, (t, t + 16), grip="pinch", heading_deg=arm.heading_deg(self.pen.at))
        top = t + 16 + rng.randint(14, 17)
        down = top + rng.randint(16, 22)
        hand.lift((t + 16, top), height_m=rng.uniform(0.06, 0.10))
        hand.put_down(tuple(here), (top, down))
        hand.release((down, down + 8))
        _go_back(hand, down + 8)


def _keep_rest(table: Area, arm: Reach) -> None:
    """The palm begins and ends there: nothing else may lie below it."""
    (x, y), (dx, dy) = arm.rest, arm.forward
    table.take((x, y), _HAND_M, (x + 0.06 * dx, y + 0.06 * dy), owner=f"{arm.name} at rest")


def _go_back(hand: PenHand | TableHand, first: int) -> None:
    if first + 12 <= LAST_FRAME:
        hand.withdraw((first, min(first + 20, LAST_FRAME)))


def overlap(a: Oblong, b: Oblong) -> bool:
    """Whether two notebooks lie on each other: no side of either parts them."""
    for book, other in ((a, b), (b, a)):
        corners = book.corners()
        for (px, py), (qx, qy) in zip(corners, [*corners[1:], corners[0]]):
            if all((qx - px) * (y - py) - (qy - py) * (x - px) < 0.0 for x, y in other.corners()):
                return False
    return True


def _apart(pen: Oblong, point: Flat) -> float:
    """Of a point from the middle line of a pen."""
    (ax, ay), (bx, by) = pen.ends()
    a, way, at = Vector((ax, ay)), Vector((bx - ax, by - ay)), Vector(point)
    t = min(max((at - a).dot(way) / way.length_squared, 0.0), 1.0)
    return float((a + t * way - at).length)
