"""Tea or coffee on a table: pots pour into cups, one after another, and a spoon stirs."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from math import atan2, cos, radians, sin
from typing import TYPE_CHECKING

from mathutils import Vector

from ...assets import cup, spoon, tea
from ...motion.pouring import Drink, Pourer, spout_over
from ...motion.servers import Server, Stirring
from ...scene import catalogue
from .. import looks
from ..areas import Area, Flat, retried
from ..errors import NoRoom
from ..hands.arms import Reach, reaches
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

Frames = tuple[int, int]
GLAZES = ("red", "orange", "yellow", "green", "teal", "blue", "purple", "white", "brown")
DRINKS = {"tea": cup.TEA, "coffee": cup.COFFEE}
CUP_M, POT_M, EAR_M, SPOUT_M = 0.062, 0.082, 0.12, 0.165
SPOON = spoon.Look()


@dataclass
class Cup:
    """A cup before it is built; `drink` when it is."""

    name: str
    look: Look
    at: Flat = (0.0, 0.0)
    drink: Drink = field(init=False, repr=False, compare=False)


@dataclass
class Pot:
    """A teapot before it is built: where it is, who takes it and what it fills."""

    name: str
    look: Look
    at: Flat = (0.0, 0.0)
    heading_deg: float = 0.0
    arm: Reach | None = None
    fills: list[Cup] = field(default_factory=list)
    late: bool = False

    @property
    def ahead(self) -> Flat:
        """Where the spout points."""
        return sin(radians(self.heading_deg)), -cos(radians(self.heading_deg))

    def ear(self, at: Flat | None = None) -> Flat:
        """Where a hand takes it."""
        x, y = at or self.at
        return x - EAR_M * self.ahead[0], y - EAR_M * self.ahead[1]

    def pouring_at(self, into: Cup) -> Flat:
        """Where it is while it pours."""
        return into.at[0] - SPOUT_M * self.ahead[0], into.at[1] - SPOUT_M * self.ahead[1]


@dataclass
class Table:
    """The whole plan: cups, pots, and who stirs what."""

    cups: list[Cup]
    pots: list[Pot]
    stirrer: Reach | None = None
    stirred: Cup | None = None


@theme(
    "tabletop",
    needs=("table",),
    categories=("cup", "teapot"),
    verbs=("pour_into", "tip", "lift", "put_down", "carry", "hold", "stir", "circle"),
)
def tea_poured(stage: Stage) -> None:
    """Cups are filled by turns from one or two pots; in another somebody stirs."""
    rng, area = stage.rng("tea poured"), stage.area("table")
    plan = retried(area, 25, lambda: _plan(stage, rng, area))
    content = rng.choice(("tea", "tea", "coffee"))
    for cup_ in plan.cups:
        cup_.drink = _build_cup(stage, rng, area, cup_, DRINKS[content])
        stage.perform(cup_.drink)
    for pot in plan.pots:
        thing = stage.member(pot.look, pot.name, pot.at, pot.heading_deg, area=area, radius_m=0.0).instance
        if pot.arm is not None:
            _pour(stage, rng, pot, thing, DRINKS[content])
    if plan.stirrer is not None and plan.stirred is not None:
        _stir(stage, rng, plan.stirrer, plan.stirred)
    filled = sum(len(pot.fills) for pot in plan.pots)
    stage.tell(f"{len(plan.cups)} cups and {len(plan.pots)} pots of {content}; {filled} cups are filled.")


# ---- the plan ------------------------------------------------------------------------------------


def _plan(stage: Stage, rng: random.Random, area: Area) -> Table:
    """Pots that pour with their cups first, then what is stirred, then the rest."""
    cups, pots = _cast(rng)
    plan = Table(cups, pots)
    arms = reaches(stage, rng, area)
    order = rng.sample(cups, len(cups))
    pouring = rng.sample(pots, min(rng.choice((1, 1, 1, 2)), len(arms)))
    for k, pot in enumerate(pouring):
        pot.arm, pot.late = arms.pop(), k == 1
        twice = len(pouring) == 1 and rng.random() < 0.5
        again = k == 1 and rng.random() < 0.25
        pot.fills = [pouring[0].fills[0]] if again else [order.pop() for _ in range(2 if twice else 1)]
        _find_room(rng, area, pot)
    if arms and order and len(pouring) == 1 and rng.random() < 0.6:
        arm, cup_ = arms.pop(), order.pop()
        cup_.at = arm.spot(rng, area, CUP_M, tries=40)
        arm.take(area, cup_.at)
        area.take(cup_.at, CUP_M, owner=cup_.name)
        plan.stirrer, plan.stirred = arm, cup_
    for cup_ in order:
        cup_.at = area.spot(rng, CUP_M)
        area.take(cup_.at, CUP_M, owner=cup_.name)
    for pot in pots:
        if pot.arm is None:
            _rest(rng, area, pot)
    return plan


def _rest(rng: random.Random, area: Area, pot: Pot) -> None:
    """Where a pot is that no one takes."""
    for _ in range(60):
        pot.at, pot.heading_deg = area.spot(rng, POT_M), rng.uniform(-180.0, 180.0)
        if _is_room(area, pot.at, pot.ahead, 0.12, 0.12):
            break
    else:
        raise NoRoom(f"no room for {pot.name}")
    area.take(pot.at, POT_M, owner=pot.name)
    ahead, behind = ((pot.at[0] + m * pot.ahead[0], pot.at[1] + m * pot.ahead[1]) for m in (0.12, -0.12))
    area.take(behind, 0.03, ahead, owner=pot.name)


def _cast(rng: random.Random) -> tuple[list[Cup], list[Pot]]:
    options = {"colour": rng.sample(GLAZES, 3)}
    key = rng.choice(("shape", "pattern"))
    options[key] = rng.sample(looks.words_of("cup", key), 2)
    group = looks.crossed(rng, "cup", rng.choice((3, 3, 4)), options)
    cups = [Cup(f"cup_{k + 1}", look) for k, look in enumerate(group)]
    options = {"colour": rng.sample(GLAZES, 2), "shape": ["round", "tall"]}
    group = looks.crossed(rng, "teapot", 3, options)[:2]
    return cups, [Pot(f"teapot_{k + 1}", look) for k, look in enumerate(group)]


def _find_room(rng: random.Random, area: Area, pot: Pot) -> None:
    """Where a pot stands and its cups, so that the arm reaches all and nothing is in the pot's way."""
    arm, (first, *others) = pot.arm, pot.fills
    assert arm is not None
    left = 1.0 if arm.side == "r" else -1.0
    for _ in range(500):
        spot = area.spot(rng, POT_M)
        if not arm.reaches(area, spot):
            continue
        fingers = arm.heading_deg(spot) + rng.uniform(-16.0, 26.0) * left
        pot.at, pot.heading_deg = spot, fingers + 90.0 * left
        if not _is_room(area, pot.at, pot.ahead, 0.13, 0.13):
            continue
        if first.at == (0.0, 0.0):
            turn = radians(pot.heading_deg + rng.uniform(-30.0, 30.0))
            far = rng.uniform(0.195, 0.32)
            first.at = spot[0] + far * sin(turn), spot[1] - far * cos(turn)
            placed = True
        else:
            placed = False
        if _suits(area, arm, pot, first, is_new=placed) and all(
            _place_next(rng, area, arm, pot, first, other) for other in others
        ):
            break
        if placed:
            first.at = (0.0, 0.0)
        for other in others:
            other.at = (0.0, 0.0)
    else:
        raise NoRoom(f"no room for {pot.name} and what it fills")
    for cup_ in pot.fills:
        area.take(cup_.at, CUP_M, owner=cup_.name)
        area.take(pot.at, POT_M, pot.pouring_at(cup_), owner=pot.name)
    tip = pot.at[0] + 0.11 * pot.ahead[0], pot.at[1] + 0.11 * pot.ahead[1]
    area.take(pot.at, 0.03, tip, owner=pot.name)
    arm.take(area, pot.ear(), *(pot.ear(pot.pouring_at(cup_)) for cup_ in pot.fills))


def _is_room(area: Area, at: Flat, ahead: Flat, before_m: float, behind_m: float) -> bool:
    """Whether spout and ear have room too."""
    tip = at[0] + before_m * ahead[0], at[1] + before_m * ahead[1]
    ear = at[0] - behind_m * ahead[0], at[1] - behind_m * ahead[1]
    return area.is_clear(ear, tip, 0.03)


def _suits(area: Area, arm: Reach, pot: Pot, cup_: Cup, *, is_new: bool) -> bool:
    """Whether a pot can be brought to a cup."""
    there = pot.pouring_at(cup_)
    return (
        (not is_new or area.is_free(cup_.at, CUP_M))
        and area.is_clear(pot.at, there, POT_M, ignoring=(cup_.name,))
        and arm.reaches(area, pot.ear())
        and arm.reaches(area, pot.ear(there))
        and arm.is_clear(area, pot.ear(), pot.ear(there), ignoring=(cup_.name,))
        and _apart(pot.at, cup_.at) > 0.19
    )


def _place_next(rng: random.Random, area: Area, arm: Reach, pot: Pot, first: Cup, other: Cup) -> bool:
    for _ in range(12):
        other.at = area.spot(rng, CUP_M, near=first.at, within_m=(0.135, 0.24))
        there = pot.pouring_at(other)
        clear_of_first = _apart(there, first.at) > POT_M + CUP_M + 0.004
        if clear_of_first and _suits(area, arm, pot, other, is_new=True):
            return True
    return False


def _apart(a: Flat, b: Flat) -> float:
    return ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5


# ---- what happens --------------------------------------------------------------------------------


def _build_cup(
    stage: Stage, rng: random.Random, area: Area, cup_: Cup, colour: tuple[float, float, float]
) -> Drink:
    """A cup with a moving surface in it, its handle anywhere."""
    heading = rng.uniform(-180.0, 180.0)
    words = {**cup_.look.words, "content": "empty"}
    body = stage.scene.put(
        "cup", cup_.name, cup_.at, heading, rng=stage.rng(f"member/{cup_.name}"), on=area.on, **words
    )
    disc = tea.surface(f"{cup_.name}.drink", colour)
    prop = stage.register(
        "cup",
        cup_.name,
        [body, disc],
        at=cup_.at,
        heading_deg=heading,
        area=None,
        look=cup_.look,
        radius_m=CUP_M,
    )
    look = catalogue.find("cup").arguments(**words)["look"]
    return Drink(prop.instance, look, disc, rng.uniform(0.30, 0.55))


def _pour(stage: Stage, rng: random.Random, pot: Pot, thing, colour: tuple[float, float, float]) -> None:
    """Takes a pot by its ear and fills one cup, or two one after the other."""
    arm = pot.arm
    assert arm is not None
    hand = arm.hand(stage, Pourer)
    look = catalogue.find("teapot").arguments(**pot.look.words)["look"]
    stand = thing.matrix(0).translation.copy()
    ahead = Vector((*pot.ahead, 0.0))
    overs = [spout_over(ahead, cup_.drink, cup_.drink.into.matrix(0).translation) for cup_ in pot.fills]
    raised = Vector((0.0, 0.0, 0.012))
    fingers = pot.heading_deg - 90.0 * (1.0 if arm.side == "r" else -1.0)
    grip = thing.matrix(0) @ look.grip
    full = rng.uniform(0.80, 0.88)
    if len(pot.fills) == 2:
        hand.hold_from_start(thing, grip="ear", point=grip, heading_deg=fingers)
        hand.raise_spout(look.spout_tip, overs[0] + raised, (2, 18))
        hand.fill(pot.fills[0].drink, look, (18, 47), to=full, colour=colour)
        hand.carry_spout(look.spout_tip, overs[1] + raised, (47, 60))
        hand.fill(pot.fills[1].drink, look, (60, 90), to=full, colour=colour)
        return
    t = rng.randint(22, 30) if pot.late else rng.randint(1, 5)
    hand.approach(thing, (t, t + 15), grip="ear", point=grip, heading_deg=fingers)
    hand.raise_spout(look.spout_tip, overs[0] + raised, (t + 15, t + 31))
    end = t + 31 + rng.randint(29, 33)
    hand.fill(pot.fills[0].drink, look, (t + 31, end), to=full, colour=colour)
    if end + 17 <= 95:
        down = min(end + rng.randint(17, 20), 95)
        hand.put_down(stand, (end, down))
        if down + 8 <= 96:
            hand.release((down, down + 8))


def _stir(stage: Stage, rng: random.Random, arm: Reach, cup_: Cup) -> None:
    """A spoon that is held from the start goes round in a cup."""
    drink = cup_.drink
    assert drink is not None
    hand = arm.hand(stage, Server)
    foot = drink.into.matrix(0).translation + Vector((0.0, 0.0, cup.BOTTOM_M + 0.003))
    lip_r, lip_z = drink.look.profile[-1]
    to_arm = atan2(arm.shoulder[1] - cup_.at[1], arm.shoulder[0] - cup_.at[0])
    side = 1.0 if arm.side == "r" else -1.0
    lean = to_arm + side * radians(rng.uniform(10.0, 35.0))
    way = Stirring(
        foot, (lip_r - cup.WALL_M, lip_z - cup.BOTTOM_M), Vector((cos(lean), sin(lean), 0.0)), SPOON.tip
    )
    body = stage.scene.make("spoon", "spoon", look=SPOON)
    body.matrix_basis = way.at(0.0)
    held = stage.scene.instance("spoon", stage.next_id(landmark=True), "spoon", body)
    point = body.matrix_basis @ SPOON.tip.lerp(SPOON.end, 0.82)
    hand.hold_from_start(held, grip="pinch", point=point)
    first = rng.choice((rng.randint(2, 8), rng.randint(28, 40)))
    hand.stir(drink.into, way, (first, first + rng.randint(34, 50)), rounds=2.0)
