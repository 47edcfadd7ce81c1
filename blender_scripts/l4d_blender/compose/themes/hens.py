"""Hens in a yard: they walk, peck and stand, one after the other and at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mathutils import Vector

from ...motion.hens import Hen
from ...scene import keys
from ...scene.timeline import FPS, LAST_FRAME
from .. import looks
from ..animals import bodies, ways
from ..animals.members import Part, Plan, Planner, planned
from ..areas import Flat
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

HEN = ways.Body(ahead_m=0.24, behind_m=0.28, half_width_m=0.13, turn_m=0.22)
SHORTEST = 15  # frames of an act


@theme("outdoor", needs=("lawn",), categories=("hen",), verbs=("walk", "stand", "peck"))
def hens_outdoors(stage: Stage) -> None:
    """Four or five hens."""
    rng, area = stage.rng("hens"), stage.area("lawn")
    count = rng.choice((4, 4, 5))
    options = {"plumage": looks.words_of("hen", "plumage"), "neck": ("white", "black", "golden", "grey")}
    hens = looks.crossed(rng, "hen", count, options)

    def make(middle: Flat) -> Plan:
        return _Planner(rng, area, middle, 1.25, HEN).plan(count)

    plan = planned(stage, area, rng, "hens", 2.2, make)
    rng.shuffle(hens)
    for k, (look, part) in enumerate(zip(hens, plan.parts)):
        hen = Hen(
            stage.scene,
            f"hen_{k + 1}",
            stage.next_id(),
            **look.words,
            attributes=look.attributes,
            at=Vector(area.point(*part.at)),
            heading_deg=part.heading_deg,
        )
        bodies.enter(stage, "hen", hen, look, part)
        for what, (first, last), *about in part.acts:
            if what == "walk":
                hen.walk(keys.Path([area.point(*point) for point in about[0].points[::2]]), first, last)
            else:
                getattr(hen, what)(first, last)
        stage.perform(hen)
    walkers = sum(bool(part.ways()) for part in plan.parts)
    stage.tell(f"Of {count} hens {walkers} walk about; they peck and look round in turn.")


class _Planner(Planner):
    """Fills each hen's day with acts; those that walk are planned first."""

    def plan(self, count: int) -> Plan:
        """Draws who walks when, and what everybody does before and after."""
        walkers = self.rng.choice((1, 2, 2, 3))
        for k in range(count):
            if k < walkers:
                self._walk()
            else:
                self._stay()
        return Plan(self.parts, [])

    def _walk(self) -> None:
        rng = self.rng
        way = self.stroll((0.5, 1.1))
        frames = max(24, round(way.length_m / rng.uniform(0.32, 0.46) * FPS))
        latest = LAST_FRAME - frames
        if latest < 2 * SHORTEST:
            leave = rng.choice((0, latest))
        else:
            leave = rng.choice((0, rng.randint(SHORTEST, latest - SHORTEST), latest))
        if 0 < leave < SHORTEST:
            leave = 0
        arrive = leave + frames
        if LAST_FRAME - arrive < SHORTEST:
            arrive = LAST_FRAME
        part = _part(way.start, way.heading_deg)
        self._fill(part, 0, leave - 1)
        part.acts.append(("walk", (leave, arrive), way))
        self._fill(part, arrive + 1, LAST_FRAME)
        self.go(way)
        self.parts.append(part)

    def _stay(self) -> None:
        at, heading = self.spot(self.spread_m, astray_deg=180.0)
        part = _part(at, heading)
        self._fill(part, 0, LAST_FRAME)
        self.stay(at, heading)
        self.parts.append(part)

    def _fill(self, part: Part, first: int, last: int) -> None:
        """Pecks and stands from `first` to `last`."""
        what = self.rng.choice(("peck", "stand"))
        while last - first + 1 >= SHORTEST:
            least = 26 if what == "peck" else SHORTEST
            end = first + self.rng.randint(least, 56)
            if last - end < 26:
                end = last
            if what == "peck" and end - first < 26:
                what = "stand"
            part.acts.append((what, (first, end)))
            first, what = end + 1, "stand" if what == "peck" else "peck"


def _part(at: Flat, heading_deg: float) -> Part:
    return Part(at, heading_deg, "stand", 0.11, 0.38)
