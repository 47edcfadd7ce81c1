"""Hands at a table that move things: who does what with which thing, where to, and when.

All of it is planned in the plane before anything is built: spots that an arm reaches, ways that are clear,
times that fit into the clip. Then `perform` builds the things and lets the hands act. Knows no kinds: see
graspables.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import atan2, cos, degrees, hypot, pi, radians, sin
from typing import TYPE_CHECKING

from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...assets import apple
from ...motion.rolling import Round
from ...motion.table_hands import TableHand
from ...scene import keys
from ...scene.timeline import LAST_FRAME
from .. import sight
from ..areas import Area, Flat
from ..errors import NoRoom, Rejected
from ..looks import Look
from ..stage import Prop
from .arms import Reach, reaches
from .graspables import Graspable

if TYPE_CHECKING:
    from ..stage import Stage

LOW_M = 0.035
"""What is lower is no hindrance to an arm."""
FLAT_M = 0.01
"""What is lower is no hindrance to a hand on the table."""
_PALM_M, _REST_M = 0.052, 0.062
_OVER_M = 0.05  # between what is carried and what it is carried to
SPANS: dict[str, tuple[int, int]] = {
    # fewest and most frames between the grip and the release
    "transfer": (40, 50),
    "lift": (28, 38),
    "push": (15, 24),
    "pull": (15, 24),
    "move": (15, 24),
    "turn": (15, 24),
    "touch": (14, 22),
    "roll": (30, 40),
    "point": (16, 26),
}
_REACH, _RELEASE, _BACK = (14, 17), 8, (12, 16)
VERBS = {
    "transfer": ("lift", "carry", "put_down", "hold"),
    "lift": ("lift", "put_down", "hold"),
    "push": ("push", "slide"),
    "pull": ("pull", "slide", "hold"),
    "move": ("move", "slide", "hold"),
    "turn": ("turn", "hold"),
    "touch": ("touch",),
    "roll": ("push", "roll"),
    "point": ("point_at",),
}
"""What the acts of hands may show."""
_EVENTS = {"transfer": 4, "lift": 3, "touch": 1, "point": 1}  # at least; two if not listed


@dataclass(eq=False)
class Item:
    """A thing before it is built: what it looks like, where it is and where it ends."""

    name: str
    of: Graspable
    look: Look
    at: Flat = (0.0, 0.0)
    heading_deg: float = 0.0
    end: Flat | None = None
    axle_deg: float | None = None  # lies on its side, its axle along this heading
    prop: Prop | None = None

    @property
    def radius_m(self) -> float:
        """In plan; elbows keep away from what is tall."""
        return self.of.radius_m + (0.025 if self.of.height_m > 0.15 else 0.0)


@dataclass
class Task:
    """What one arm does with one thing during some frames."""

    arm: Reach
    act: str
    item: Item
    start: int
    grips: int  # the frame in which flesh touches
    lets_go: int
    to: Flat | None = None
    on: Prop | None = None
    to_m: float = 0.0
    heading_deg: float | None = None
    turn_deg: float = 0.0


@dataclass
class Plan:
    """All things and all tasks."""

    items: list[Item]
    tasks: list[Task] = field(default_factory=list)

    def arms(self) -> list[Reach]:
        """Those that act, once each."""
        found: list[Reach] = []
        for task in self.tasks:
            if task.arm not in found:
                found.append(task.arm)
        return found


# ---- who does what ---------------------------------------------------------------------------------


def draw(
    stage: Stage,
    rng: random.Random,
    table: Area,
    groups: Sequence[tuple[Graspable, int]],
    weights: Mapping[str, float],
    must: str | None = None,
) -> Plan:
    """A plan for groups (kind and count); `weights` says how often each act is drawn, `must` is the first.

    Raises `NoRoom` if this draw does not fit.
    """
    items = []
    for kind, count in groups:
        cast = kind.group(rng, count)
        items += [Item(f"{kind.noun}_{k + 1}", kind, look) for k, look in enumerate(cast)]
    arms = reaches(stage, rng)[: rng.choice((2, 2, 3))]
    plan = Plan(items)
    free = rng.sample(items, len(items))
    if must is not None:
        free.sort(key=lambda item: not can(item.of, must))
    again = must
    for k, arm in enumerate(arms):
        clock = rng.randint(1, 8) if k == 0 else rng.randint(1, 24)
        while len(free) > 1:
            item = free[0]
            possible = {
                act: weight
                for act, weight in weights.items()
                if can(item.of, act) and clock + _REACH[1] + SPANS[act][0] + _RELEASE <= LAST_FRAME
            }
            if again in possible and (not plan.tasks or rng.random() < 0.55):
                possible = {again: 1.0}
            if not possible or not any(possible.values()):
                break
            act = rng.choices(list(possible), list(possible.values()))[0]
            grips = clock + rng.randint(*_REACH)
            lets_go = min(grips + rng.randint(*SPANS[act]), LAST_FRAME - _RELEASE)
            plan.tasks.append(Task(arm, act, free.pop(0), clock, grips, lets_go))
            again = None if act == again and len(plan.tasks) > 1 else act
            clock = lets_go + _RELEASE + _BACK[1] + rng.randint(1, 4)
    if must is not None and all(task.act != must for task in plan.tasks):
        raise NoRoom(f"no time to {must} something")
    if len(plan.tasks) < 2 or sum(_EVENTS.get(task.act, 2) for task in plan.tasks) < 4:
        raise NoRoom("too little happens")
    _settle(stage, rng, table, plan)
    _show(stage, plan)
    return plan


def _show(stage: Stage, plan: Plan) -> None:
    """Refuses a plan in which cameras miss something."""
    others = [sight.Bulk(prop.at, 0.7 * prop.radius_m, prop.height_m) for prop in stage.landmarks]
    moments = []
    for late in (False, True):
        ends = {id(task.item): task.to for task in plan.tasks if late and task.to is not None}
        moments.append(
            [sight.Bulk(ends.get(id(item), item.at), item.of.seen_m, item.of.height_m) for item in plan.items]
        )
    missed = sight.hidden(stage.scene.camera_rig, moments, others)
    if missed:
        raise NoRoom(f"{plan.items[missed[0]].name} would hardly be seen")


def can(kind: Graspable, act: str) -> bool:
    """Whether hands do that with such a thing."""
    if act in ("transfer", "lift"):
        return kind.grip is not None
    if act == "roll":
        return kind.rolls_m is not None
    if act == "push":
        return kind.rolls_m is None and kind.height_m < 0.16
    if act in ("pull", "move"):
        return kind.slide not in (None, "push") and (kind.rolls_m is None)
    if act == "turn":
        return kind.slide not in (None, "push") and kind.axle is None and kind.rolls_m is None
    if act == "touch":
        return kind.rolls_m is None and kind.height_m < 0.12 and kind.radius_m > 0.05 and kind.grip != "pinch"
    return True


# ---- where ------------------------------------------------------------------------------------------


def _settle(stage: Stage, rng: random.Random, table: Area, plan: Plan) -> None:
    """Finds spots: first what moves, the widest first, then the rest."""
    low = tuple(prop.name for prop in stage.landmarks if prop.height_m < LOW_M)
    flat = tuple(prop.name for prop in stage.landmarks if prop.height_m < FLAT_M)
    places = [prop for prop in stage.landmarks if prop.name in surfaces(stage)]
    rng.shuffle(places)
    done: dict[str, list[Flat]] = {}
    for arm in plan.arms():
        ahead = arm.rest[0] + 0.06 * arm.forward[0], arm.rest[1] + 0.06 * arm.forward[1]
        if not table.is_clear(arm.rest, ahead, _REST_M, ignoring=(*flat, arm.name)):
            raise NoRoom(f"{arm.name} has nowhere to rest")
        table.take(arm.rest, _REST_M, ahead, owner=arm.name)
    for task in sorted(plan.tasks, key=lambda t: (t.act == "point", -t.item.radius_m)):
        _find(rng, table, task, low, flat, places, done.setdefault(task.arm.name, []))
    acting = {id(task.item) for task in plan.tasks}
    for item in sorted(plan.items, key=lambda i: -i.radius_m):
        if id(item) in acting:
            continue
        item.at = table.spot(rng, item.radius_m)
        item.heading_deg = rng.uniform(-180, 180)
        if item.of.axle == "z" and rng.random() < 0.4:
            item.axle_deg = rng.uniform(-180, 180)
        table.take(item.at, item.radius_m, owner=item.name)


def _find(
    rng: random.Random,
    table: Area,
    task: Task,
    low: tuple[str, ...],
    flat: tuple[str, ...],
    places: list[Prop],
    before: list[Flat],
) -> None:
    arm, item, radius = task.arm, task.item, task.item.radius_m
    for _ in range(80):
        at = table.spot(rng, radius)
        if not _reaches(arm, table, at) or not arm.is_clear(table, *before, at, ignoring=low):
            continue
        item.heading_deg, item.axle_deg = rng.uniform(-180, 180), None
        task.to, task.on, task.heading_deg = None, None, None
        way = atan2(at[1] - arm.shoulder[1], at[0] - arm.shoulder[0])
        distance = hypot(at[0] - arm.shoulder[0], at[1] - arm.shoulder[1])
        if task.act == "transfer":
            if not _goal(rng, table, task, at, low, places, before):
                continue
        elif task.act in ("push", "pull", "move", "roll"):
            if not _way(rng, table, task, at, way, distance, low):
                continue
        elif task.act == "turn":
            task.turn_deg = rng.choice((-1, 1)) * rng.uniform(35.0, 60.0)
        elif task.act == "point":
            here = arm.rest
            bend = atan2(at[1] - here[1], at[0] - here[0]) - way
            if hypot(at[0] - here[0], at[1] - here[1]) < 0.18 or abs((bend + pi) % (2 * pi) - pi) > radians(
                32
            ):
                continue
        stops = [at] if task.to is None else [at, task.to]
        skip = flat if task.on is None else (*flat, task.on.name)
        if task.act != "roll" and not all(_has_room(task, table, at, stop, skip) for stop in stops):
            continue
        if task.act == "roll" and not _has_room(task, table, at, at, skip):
            continue
        item.at = at
        break
    else:
        raise NoRoom(f"{arm.name} has no room to {task.act} {item.name}")
    end = task.to if task.to is not None and task.on is None else item.at
    table.take(item.at, radius, None if task.act == "transfer" else end, owner=item.name)
    if task.act == "transfer" and task.on is None:
        table.take(end, radius, owner=item.name)
    if task.on is not None:
        places.remove(task.on)
    if task.act == "point":
        arm.take(table)
    else:
        stops = [item.at] if task.to is None else [item.at, task.to]
        if task.act == "roll":
            assert task.to is not None
            stops = [item.at, _between(item.at, task.to, 0.45)]
        arm.take(table, *before, *stops)
        for stop in [item.at] if task.act == "roll" else stops:
            for a, b in _hand_room(task, item.at, stop):
                table.take(a, _PALM_M, b, owner=arm.name)
        before += stops


def _hand_room(task: Task, start: Flat, at: Flat) -> list[tuple[Flat, Flat]]:
    """Middle lines of the hand while it has something at a spot: as it comes and as it holds."""
    arm, of = task.arm, task.item.of
    if task.act in ("push", "roll"):
        turn = radians(task.heading_deg or 0.0)
    else:
        turn = radians(arm.heading_deg(at if task.act == "transfer" else start))
    ahead = (sin(turn), -cos(turn))

    def off(forward_m: float, side_m: float = 0.0) -> Flat:
        right = (ahead[1], -ahead[0]) if arm.side == "r" else (-ahead[1], ahead[0])
        return (
            at[0] + ahead[0] * forward_m + right[0] * side_m,
            at[1] + ahead[1] * forward_m + right[1] * side_m,
        )

    if task.act == "point":
        return []
    if task.act in ("push", "roll"):
        edge = -0.7 * task.item.radius_m
        return [(off(edge), off(edge - 0.27))]
    if of.grip == "side":
        out = of.foot_m + 0.03
        return [(off(-0.09, out), off(0.05, out)), (off(-0.09, out + 0.06), off(0.05, out + 0.06))]
    return [(off(-0.10), off(0.06))]


def _has_room(task: Task, table: Area, start: Flat, at: Flat, ignoring: Sequence[str]) -> bool:
    ignoring = (*ignoring, task.arm.name)
    return all(table.is_clear(a, b, _PALM_M, ignoring=ignoring) for a, b in _hand_room(task, start, at))


def _reaches(arm: Reach, table: Area, at: Flat) -> bool:
    """With three centimetres to spare."""
    dx, dy = at[0] - arm.shoulder[0], at[1] - arm.shoulder[1]
    far = max(hypot(dx, dy), 1e-6)
    return arm.reaches(table, at) and arm.reaches(table, (at[0] + 0.03 * dx / far, at[1] + 0.03 * dy / far))


def _goal(
    rng: random.Random,
    table: Area,
    task: Task,
    at: Flat,
    low: tuple[str, ...],
    places: list[Prop],
    before: list[Flat],
) -> bool:
    """Where something is carried: onto a landmark, next to one, or to a free spot."""
    arm, item = task.arm, task.item
    kind = rng.choice(("on", "on", "beside", "free"))
    if kind == "on":
        fitting = [prop for prop in places if _ROOM[prop.kind.name][0] >= item.of.foot_m + 0.004]
        if not fitting:
            return False
        task.on = rng.choice(fitting)
        task.to = task.on.at
        ignoring = (*low, task.on.name)
    else:
        near = rng.choice([*places, None]) if kind == "beside" else None
        try:
            if near is not None:
                gap = near.radius_m + item.radius_m
                task.to = table.spot(rng, item.radius_m, near=near.at, within_m=(gap, gap + 0.06), tries=30)
            else:
                task.to = table.spot(rng, item.radius_m, tries=30)
        except NoRoom:
            return False
        ignoring = low
    far = hypot(task.to[0] - at[0], task.to[1] - at[1])
    return (
        0.13 < far < 0.5
        and _reaches(arm, table, task.to)
        and arm.is_clear(table, *before, at, task.to, ignoring=ignoring)
    )


def _way(
    rng: random.Random, table: Area, task: Task, at: Flat, ahead: float, distance: float, low: tuple[str, ...]
) -> bool:
    """Along which straight line something slides or rolls, and where fingers point then."""
    item, arm = task.item, task.arm
    length = rng.uniform(0.12, 0.28) if task.act == "roll" else rng.uniform(0.09, 0.2)
    if task.act in ("push", "roll"):
        if distance < 0.34:
            return False
        turn = ahead + radians(rng.uniform(-42, 42))
    elif task.act == "pull":
        turn = ahead + pi + radians(rng.uniform(-35, 35))
    else:
        turn = ahead + rng.choice((-1, 1)) * radians(rng.uniform(50, 120))
    to = at[0] + length * cos(turn), at[1] + length * sin(turn)
    reach = _between(at, to, 0.5) if task.act == "roll" else to
    if not _reaches(arm, table, reach) or not table.is_free(at, item.radius_m, to):
        return False
    if task.act != "roll" and not arm.is_clear(table, at, to, ignoring=low):
        return False
    task.to = to
    if task.act in ("push", "roll"):
        task.heading_deg = degrees(atan2(cos(turn), -sin(turn)))
    if item.of.slide == "push" and item.of.kind == "toy_car":
        item.heading_deg = degrees(atan2(cos(turn), -sin(turn)))
    if task.act == "roll" and item.of.axle == "z":
        item.axle_deg = degrees(turn) + 90.0
    elif task.act == "roll" and item.of.axle == "x":
        item.heading_deg = degrees(turn) + 90.0
    return True


def _between(a: Flat, b: Flat, t: float) -> Flat:
    return a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])


# ---- what things are put on --------------------------------------------------------------------------

_ROOM: dict[str, tuple[float, str]] = {
    # how far from the middle it is level, and how things are then
    "serving_tray": (0.085, "on"),
    "fruit.fruit_bowl": (0.085, "in"),
    "soup_bowl.plate": (0.055, "on"),
    "book": (0.065, "on"),
    "notepad": (0.05, "on"),
    "mouse_mat": (0.09, "on"),
    "bread_board": (0.09, "on"),
    "wooden_box": (0.06, "on"),
    "dining_table.runner": (0.09, "on"),
    "tray.trivet": (0.07, "on"),
    "saucer.coaster": (0.045, "on"),
    "picture_book": (0.09, "on"),
}


def surfaces(stage: Stage) -> set[str]:
    """The names of landmarks that something can be put on or into."""
    return {prop.name for prop in stage.landmarks if prop.kind.name in _ROOM}


def top_of(prop: Prop, foot_m: float) -> float:
    """World height of what stands in the middle of a landmark; refuses what is not level there."""
    heights = []
    trees = []
    for obj in prop.instance.objects:
        matrix = keys.object_matrix(obj, 0)
        trees.append(
            BVHTree.FromPolygons(
                [matrix @ v.co for v in obj.data.vertices], [tuple(p.vertices) for p in obj.data.polygons]
            )
        )
    ring = [(0.0, 0.0)] + [(foot_m * cos(a), foot_m * sin(a)) for a in (2 * pi * k / 8 for k in range(8))]
    for dx, dy in ring:
        start = Vector((prop.at[0] + dx, prop.at[1] + dy, 1.0))
        hits = [hit.z for tree in trees for hit in [tree.ray_cast(start, Vector((0, 0, -1)))[0]] if hit]
        heights += [max(hits)] if hits else []
    if len(heights) < 5:
        raise Rejected(f"nothing stands on the {prop.name}")
    if max(heights) - min(heights) > 0.004:
        raise Rejected(f"the {prop.name} is not level")
    return max(heights)


# ---- what happens ------------------------------------------------------------------------------------


def perform(stage: Stage, rng: random.Random, table: Area, plan: Plan) -> None:
    """Builds the things, then lets each arm do its tasks in the order of time."""
    for item in plan.items:
        _build(stage, table, item)
    for arm in plan.arms():
        hand = arm.hand(stage, TableHand)
        tasks = sorted((task for task in plan.tasks if task.arm == arm), key=lambda t: t.start)
        for task in tasks:
            if task.on is not None:
                task.to_m = top_of(task.on, task.item.of.foot_m)
                assert task.item.prop is not None
                stage.may_touch(task.item.prop, task.on)
            _act(rng, hand, table, task)


def _build(stage: Stage, table: Area, item: Item) -> None:
    """Its room was taken before."""
    rng = stage.rng(f"member/{item.name}")
    thing = stage.scene.put(
        item.of.kind,
        item.name,
        item.at,
        item.heading_deg,
        rng=rng,
        on=table.on,
        **item.look.words,
        **item.of.fixed,
    )
    item.prop = stage.register(
        item.of.kind,
        item.name,
        thing,
        at=item.at,
        heading_deg=item.heading_deg,
        area=None,
        look=item.look,
        radius_m=item.radius_m,
    )
    if item.axle_deg is not None:
        obj = item.prop.instance.objects[0]
        obj.matrix_basis = _round(item).lying(table.point(*item.at), item.axle_deg, rng.uniform(0, 360))


def _round(item: Item) -> Round:
    assert item.prop is not None and item.of.rolls_m is not None
    radius = item.of.rolls_m
    middle = Vector((0.0, 0.0, radius))
    if item.of.kind == "apple":
        middle = apple.Look(radius_m=radius).middle
    return Round(item.prop.instance, radius, middle)


def _act(rng: random.Random, hand: TableHand, table: Area, task: Task) -> None:
    """The reach, the act, the release and the way back to rest, if there is time for it."""
    assert task.item.prop is not None
    thing, of = task.item.prop.instance, task.item.of
    first, grips, lets_go = task.start, task.grips, task.lets_go
    if task.act == "point":
        hand.point_at(thing, (first, lets_go), height_m=rng.uniform(0.07, 0.11))
        hand.withdraw((lets_go, min(lets_go + _BACK[1], LAST_FRAME)))
        return
    at = thing.matrix(first).translation
    point = (at.x, at.y, at.z + of.aim_m) if of.aim_m else None
    grip = {"push": "push", "roll": "push", "touch": "flat", "transfer": of.grip, "lift": of.grip}.get(
        task.act, of.slide
    )
    hand.approach(
        thing,
        (first, grips),
        grip=grip or "top",
        heading_deg=task.heading_deg,
        point=point if grip == "side" else None,
    )
    if task.act == "roll":
        _roll(rng, hand, table, task)
        return
    if task.act == "transfer":
        _carry(rng, hand, table, task)
    elif task.act == "lift":
        up = grips + rng.randint(13, 16)
        hand.lift((grips, up), height_m=rng.uniform(0.06, 0.11))
        hand.put_down((at.x, at.y, at.z), (max(lets_go - rng.randint(13, 16), up), lets_go))
    elif task.act == "turn":
        hand.twist(Round(thing, 0.0, Vector()), task.turn_deg, (grips, lets_go))
    elif task.act == "touch":
        hand.touch((grips, lets_go))
    else:
        assert task.to is not None
        hand.slide([(*task.to, at.z)], (grips, lets_go), verb=task.act)
    hand.release((lets_go, lets_go + _RELEASE))
    _go_back(rng, hand, lets_go + _RELEASE)


def _carry(rng: random.Random, hand: TableHand, table: Area, task: Task) -> None:
    """Up, over and down onto what waits there."""
    assert task.to is not None
    span = task.lets_go - task.grips
    a, b = task.grips + round(span * 0.33), task.grips + round(span * 0.67)
    height = max(task.to_m, table.point(*task.to)[2])
    over = _OVER_M + rng.uniform(0.0, 0.03)
    hand.lift((task.grips, a), height_m=height + over)
    turn = task.arm.heading_deg(task.to) - task.arm.heading_deg(task.item.at)
    hand.carry((*task.to, height + over), (a, b), turn_deg=(turn + 180.0) % 360.0 - 180.0)
    hand.put_down((*task.to, height), (b, task.lets_go))


def _roll(rng: random.Random, hand: TableHand, table: Area, task: Task) -> None:
    """A push, after which the thing rolls on by itself."""
    assert task.to is not None
    free = task.grips + rng.randint(12, 14)
    way = [(*task.to, table.point(*task.to)[2])]
    hand.send_rolling(_round(task.item), way, (task.grips, task.lets_go), let_go=free)
    _go_back(rng, hand, free + 9)


def _go_back(rng: random.Random, hand: TableHand, first: int) -> None:
    last = min(first + rng.randint(*_BACK), LAST_FRAME)
    if last - first >= 9:
        hand.withdraw((first, last))
