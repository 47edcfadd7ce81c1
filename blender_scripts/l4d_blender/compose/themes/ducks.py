"""Ducks on water: they swim and rest. Birds on a bank or lawn: they stand, walk, drink, eat, fly and land."""

from __future__ import annotations

import itertools
import random
from typing import TYPE_CHECKING, Any

from ...assets import lake
from ...assets import waterbird as shape
from ...assets.bird_feeder import DISH_RADIUS_M, SEED_Z_M, WATER_Z_M
from ...motion.waterbirds import DRAFT_M, WaterBird
from ...scene import keys
from ...scene.timeline import FPS, LAST_FRAME
from .. import looks
from ..animals import bodies, ways
from ..animals.members import Part, Plan, Planner, planned
from ..animals.ways import ahead
from ..areas import Area, Flat, heading_to
from ..errors import NoRoom, Rejected
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ..stage import Prop, Stage

DUCK = ways.Body(ahead_m=0.30, behind_m=0.32, half_width_m=0.15, turn_m=0.25)
GULL = ways.Body(ahead_m=0.24, behind_m=0.32, half_width_m=0.13, turn_m=0.22)
SHORTEST = 15  # frames of an act
UNFOLD, FOLD = 14, 20  # frames before a bird leaves the ground and after it has touched it
DUCKS = ("drake", "duck_hen", "white_duck", "black_duck")
GULLS = ("grey_backed", "black_backed", "mottled_young")


@theme("outdoor", needs=("water",), categories=("duck",), verbs=("swim", "rest"))
def ducks_on_water(stage: Stage) -> None:
    """Four or five ducks, of which two to four swim somewhere."""
    rng, water = stage.rng("ducks"), stage.area("water")
    count = rng.choice((4, 4, 5))
    cast = _ducks(rng, count)

    def make(middle: Flat) -> Plan:
        return _Swimmers(rng, water, middle, 1.3, DUCK).plan(count)

    plan = planned(stage, water, rng, "ducks", 3.0, make, least_rise=0.42)
    level = water.point(*water.centre)[2] - DRAFT_M
    for k, (look, part) in enumerate(zip(cast, plan.parts)):
        duck = _bird(stage, look, f"duck_{k + 1}", "duck", part, level)
        for what, (first, last), *about in part.acts:
            if what == "swim":
                path = keys.Path([(x, y, level) for x, y in about[0].points[::2]])
                duck.swim(path, first, last, lake.wake(f"wake_{k + 1}"))
            else:
                duck.rest(first, last)
        stage.perform(duck)
    swimmers = sum(bool(part.ways()) for part in plan.parts)
    stage.tell(f"{swimmers} of {count} ducks swim, at different times; the others rest on the water.")


@theme(
    "outdoor",
    needs=("lawn",),
    categories=("bird", "duck"),
    verbs=("walk", "stand", "drink", "eat", "fly", "land"),
)
def birds_at_food(stage: Stage) -> None:
    """Gulls or ducks round a dish of water and a tray of seeds."""
    rng, area = stage.rng("birds"), stage.area("lawn")
    count = rng.choice((3, 4, 4))
    category = rng.choice(("bird", "duck"))
    cast = _ducks(rng, count) if category == "duck" else _gulls(rng, count)
    body = DUCK if category == "duck" else GULL
    wanted, tries = rng.random() < 0.7, itertools.count()

    def make(middle: Flat) -> _FedPlan:
        flies = wanted and next(tries) < 220
        return _Feeders(rng, area, middle, 1.15, body).plan(count, category, flies)

    plan = planned(stage, area, rng, "birds", 2.2, make, height_m=0.2)
    rng.shuffle(cast)
    foods = {what: _food(stage, area, what, at) for what, at in plan.foods.items()}
    level = area.point(*area.centre)[2]
    for k, (look, part) in enumerate(zip(cast, plan.parts)):
        bird = _bird(stage, look, f"{category}_{k + 1}", category, part, level)
        for what, (first, last), *about in part.acts:
            if what == "walk":
                path = keys.Path([(x, y, level) for x, y in about[0].points[::2]])
                bird.walk(path, first, last)
            elif what == "drink":
                bird.drink(foods[what].instance, (*about[0], level + WATER_Z_M), first, last)
            elif what == "eat":
                bird.eat(foods[what].instance, (*about[0], level + SEED_Z_M), first, last)
            elif what == "fly":
                points, off, touch = about
                bird.fly_over([(x, y, level + z) for x, y, z in points], first, off, touch, last)
            elif what == "turn":
                bird.turn(about[0], first, last)
            elif last - first >= 12:
                bird.stand(first, last)
            else:
                bird.pause(first, last)
        stage.perform(bird)
    stage.tell(f"{count} {category}s about a dish of water and a tray of seeds.")


# ---- cast ----------------------------------------------------------------------------------------------


def _ducks(rng: random.Random, count: int) -> list[Look]:
    return _crossed(rng, count, {"plumage": DUCKS, "head": ("green", "brown", "white", "black", "red")})


def _gulls(rng: random.Random, count: int) -> list[Look]:
    return _crossed(rng, count, {"plumage": GULLS, "head": ("white", "black", "brown")})


def _crossed(rng: random.Random, count: int, options: dict[str, tuple[str, ...]]) -> list[Look]:
    return looks.crossed(rng, "waterbird", count, options)


def _bird(stage: Stage, look: Look, name: str, category: str, part: Part, level: float) -> WaterBird:
    bird = WaterBird(
        stage.scene,
        name,
        stage.next_id(),
        species=shape.DUCK if category == "duck" else shape.GULL,
        **look.words,
        category=category,
        attributes=look.attributes,
        at=(*part.at, level),
        heading_deg=part.heading_deg,
    )
    bodies.enter(stage, "waterbird", bird, look, part)
    return bird


def _food(stage: Stage, area: Area, what: str, at: Flat) -> Prop:
    rng = stage.rng(f"food/{what}")
    kind, nouns = (
        ("bird_feeder.water_dish", ("dish", "bowl"))
        if what == "drink"
        else ("bird_feeder.seed_tray", ("tray", "box"))
    )
    taken = {instance.category for instance in stage.scene.instances}
    name = next((noun for noun in nouns if noun not in taken), None)
    if name is None:
        raise Rejected(f"the place has every noun for a {nouns[0]}")
    colour: dict[str, Any] = (
        {"colour": rng.choice(("blue", "teal", "white", "brown"))} if what == "drink" else {}
    )
    return stage.landmark(kind, name, at, rng.uniform(-180.0, 180.0), on=area.on, category=name, **colour)


# ---- on the water ----------------------------------------------------------------------------------------


class _Swimmers(Planner):
    """Draws which ducks swim when; those that do are planned first."""

    def plan(self, count: int) -> Plan:
        """Two to four swim, the others rest."""
        swimmers = self.rng.choice((2, 3, 3, 4))
        for k in range(count):
            if k < swimmers:
                self._swim()
            else:
                at, heading = self.spot(self.spread_m, astray_deg=180.0)
                part = Part(at, heading, "float", 0.11, 0.28)
                part.acts.append(("rest", (0, LAST_FRAME)))
                self.stay(at, heading)
                self.parts.append(part)
        return Plan(self.parts, [])

    def _swim(self) -> None:
        rng = self.rng
        way = self.stroll((0.6, 1.5))
        frames = max(26, round(way.length_m / rng.uniform(0.36, 0.60) * FPS))
        leave = _leave(rng, frames)
        part = Part(way.start, way.heading_deg, "float", 0.11, 0.28)
        arrive = leave + frames
        if leave > 0:
            part.acts.append(("rest", (0, leave - 1)))
        part.acts.append(("swim", (leave, arrive), way))
        if arrive < LAST_FRAME:
            part.acts.append(("rest", (arrive + 1, LAST_FRAME)))
        self.go(way)
        self.parts.append(part)


def _leave(rng: random.Random, frames: int) -> int:
    """When something that takes so many frames begins: what is before and after is long enough to tell."""
    latest = LAST_FRAME - frames
    if latest < 0:
        raise NoRoom("time for a way")
    between = range(SHORTEST, latest - SHORTEST)
    choices = [latest if latest >= SHORTEST else None, rng.choice(between) if between else None]
    if latest > SHORTEST:
        choices.append(0)
    fitting = [choice for choice in choices if choice is not None]
    if not fitting:
        raise NoRoom("time for a way")
    return rng.choice(fitting)


# ---- at food ---------------------------------------------------------------------------------------------


class _FedPlan(Plan):
    """A plan with a dish and a tray."""

    def __init__(self, parts: list[Part], foods: dict[str, Flat]) -> None:
        super().__init__(parts, [])
        self.foods = foods


class _Feeders(Planner):
    """Draws who eats and drinks when, who flies and who walks."""

    def plan(self, count: int, category: str, flies: bool) -> _FedPlan:
        """One at a dish early, one later; one flies if wished; the others walk or stand."""
        rng = self.rng
        self._reach_m = 0.24 if category == "duck" else 0.20
        self._category = category
        turn = rng.uniform(-180.0, 180.0)
        apart = rng.uniform(0.32, 0.5)
        self._foods = {"drink": ahead(self.middle, turn, apart), "eat": ahead(self.middle, turn, -apart)}
        for what, at in self._foods.items():
            room = DISH_RADIUS_M + 0.02 if what == "drink" else 0.22
            if not self.area.is_free(at, room):
                raise NoRoom("a dish")
            self.area.take(at, room, owner=what)
        what = rng.choice(("drink", "eat"))
        other = "eat" if what == "drink" else "drink"
        self._feed_first(what, leaves=rng.random() < 0.6)
        self._come_to(what if rng.random() < 0.65 else other)
        left = count - len(self.parts)
        if flies and left:
            self._fly()
            left -= 1
        for _ in range(left):
            rng.choice((self._walk, self._come_to_either, self._stand))()
        return _FedPlan(self.parts, self._foods)

    def _part(self, at: Flat, heading_deg: float) -> Part:
        return Part(at, heading_deg, "stand", 0.10, 0.30)

    def _at(self, what: str) -> tuple[Flat, float, Flat]:
        """A free place before a dish, the heading, and where the bill goes."""
        food = self._foods[what]
        for _ in range(16):
            heading = self.rng.uniform(-180.0, 180.0)
            inside = 0.09 if what == "drink" else 0.10
            at = ahead(food, heading, -(self._reach_m + inside))
            if ways.fits(self.area, self.body, at, heading, (what, self.owner)):
                return at, heading, ahead(food, heading, -inside)
        raise NoRoom("a bird at the food")

    def _feed_first(self, what: str, leaves: bool) -> None:
        rng = self.rng
        at, heading, dip = self._at(what)
        part = self._part(at, heading)
        first = rng.choice((0, rng.randint(SHORTEST, 20)))
        if first:
            part.acts.append(("stand", (0, first - 1)))
        last = first + rng.randint(26, 40)
        part.acts.append((what, (first, last), dip))
        self.stay(at, heading)
        if leaves:
            away = ways.wrapped(heading + rng.choice((-1, 1)) * rng.uniform(110.0, 170.0))
            way = self.stroll((0.3, 0.6), (at, away))
            part.acts.append(("turn", (last + 1, last + 16), away))
            frames = max(20, round(way.length_m / rng.uniform(0.30, 0.40) * FPS))
            begin, end = last + 17, min(last + 17 + frames, LAST_FRAME)
            if end - begin < 20:
                raise NoRoom("time to leave")
            part.acts.append(("walk", (begin, end), way))
            self.go(way)
            last = end
        if last < LAST_FRAME:
            part.acts.append(("stand", (last + 1, LAST_FRAME)))
        self.parts.append(part)

    def _come_to_either(self) -> None:
        self._come_to(self.rng.choice(("drink", "eat")))

    def _come_to(self, what: str) -> None:
        rng = self.rng
        at, heading, dip = self._at(what)
        for _ in range(24):
            aside, far = rng.uniform(-60.0, 60.0), rng.uniform(0.35, 0.75)
            start = ahead(at, heading + aside, -far)
            facing = ways.wrapped(heading + 1.5 * aside + rng.uniform(-20.0, 20.0))
            if not self.inside(start) or not ways.fits(self.area, self.body, start, facing):
                continue
            way = ways.find_way(
                self.area, self.body, rng, (start, facing), (at, heading), ignoring=(what,), tries=4
            )
            if way is not None:
                break
        else:
            raise NoRoom("a way to the food")
        frames = max(20, round(way.length_m / rng.uniform(0.28, 0.40) * FPS))
        latest = LAST_FRAME - 28 - frames
        if latest < 0:
            raise NoRoom("time to come")
        leave = rng.choice((0, rng.randint(SHORTEST, latest))) if latest > SHORTEST else 0
        part = self._part(way.start, way.heading_deg)
        if leave:
            part.acts.append(("stand", (0, leave - 1)))
        arrive = leave + frames
        part.acts.append(("walk", (leave, arrive), way))
        part.acts.append((what, (arrive + 1, LAST_FRAME), dip))
        self.go(way)
        self.parts.append(part)

    def _fly(self) -> None:
        rng = self.rng
        for _ in range(60):
            start, heading = self.spot(self.spread_m, astray_deg=70.0)
            far, aside = rng.uniform(0.9, 1.5), rng.uniform(-25.0, 25.0)
            end = ahead(start, heading + aside, far)
            facing = heading_to(start, end)
            if (
                self.inside(end)
                and ways.fits(self.area, self.body, end, facing)
                and self.area.is_free(start, 0.36, end)
            ):
                break
        else:
            raise NoRoom("room to fly")
        off = rng.randint(UNFOLD, 34)
        touch = off + rng.randint(28, 36)
        first, last = off - UNFOLD, touch + FOLD
        part = self._part(start, heading)
        if first < SHORTEST:
            off, touch, last, first = off - first, touch - first, last - first, 0
        if first:
            part.acts.append(("stand", (0, first - 1)))
        high = rng.uniform(0.40, 0.60)
        points = [
            (*start, 0.0),
            (*ahead(start, heading + 0.3 * aside, 0.22 * far), 0.55 * high),
            (*ahead(start, heading + 0.8 * aside, 0.5 * far), high),
            (*ahead(end, facing, -0.22 * far), 0.45 * high),
            (*end, 0.0),
        ]
        part.acts.append(("fly", (first, last), points, off, touch))
        part.acts.append(("stand", (last + 1, LAST_FRAME)))
        self.area.take(start, 0.34, end, owner=self.owner)
        self.stay(start, heading)
        self.stay(end, facing)
        self.parts.append(part)

    def _walk(self) -> None:
        rng = self.rng
        way = self.stroll((0.4, 0.9))
        frames = max(22, round(way.length_m / rng.uniform(0.28, 0.40) * FPS))
        leave = _leave(rng, frames)
        part = self._part(way.start, way.heading_deg)
        if leave:
            part.acts.append(("stand", (0, leave - 1)))
        part.acts.append(("walk", (leave, leave + frames), way))
        if leave + frames < LAST_FRAME:
            part.acts.append(("stand", (leave + frames + 1, LAST_FRAME)))
        self.go(way)
        self.parts.append(part)

    def _stand(self) -> None:
        at, heading = self.spot(self.spread_m)
        part = self._part(at, heading)
        part.acts.append(("stand", (0, LAST_FRAME)))
        self.stay(at, heading)
        self.parts.append(part)
