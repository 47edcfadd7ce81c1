"""What somebody does in a drawn plan, act after act: where it happens, and how a body does it later.

A role moves over the plan while it is written (`rehearsal` judges it) and is performed once by a Person.
Knows acts and how long they take; draws nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import ceil, radians
from typing import Any

import numpy as np

from ...motion import lifters, playing, travellers
from ...motion.people import Person
from ...scene import keys
from ...scene.timeline import FRAME_COUNT, LAST_FRAME, MIN_EVENT_FRAMES
from ..areas import Area, Flat, heading_to
from ..errors import NoRoom
from ..looks import Look
from ..stage import Prop, Stage
from .bodies import add_person, middle_of
from .folk import Figure
from .rehearsal import Disc, ahead, ahead_of
from .wares import Ware

ROOM_M = 0.29  # radius of somebody who stands or walks
_SIGN = {"l": 1.0, "r": -1.0}
_STRIDE_M = 0.585
Frames = tuple[int, int]


@dataclass
class Item:
    """Something that people use: its look, where it is over time, and what it became."""

    name: str
    ware: Ware
    look: Look
    disc: Disc
    heading_deg: float
    prop: Prop = field(init=False, repr=False, compare=False)
    thing: Any = field(init=False, repr=False, compare=False)
    words: dict[str, Any] = field(default_factory=dict)
    on: float | None = None
    alike: bool = False
    holder: Role | None = None
    before: list[Callable[[], None]] = field(default_factory=list)
    after: list[Callable[[], None]] = field(default_factory=list)

    @property
    def at(self) -> Flat:
        """Where it is at first."""
        return float(self.disc.xy[0, 0]), float(self.disc.xy[0, 1])

    @classmethod
    def lying(
        cls, name: str, ware: Ware, look: Look, at: Flat, heading_deg: float, base_m: float = 0.0
    ) -> Item:
        """One that no one has moved yet."""
        disc = Disc.at(name, at, ware.radius_m, ware.radius_m * ware.wide, ware.height_m, base_m)
        return cls(name, ware, look, disc, heading_deg)

    def build(self, stage: Stage, area: Area) -> None:
        """Puts it on the stage; it is taken as moving, so that it takes no room for good."""
        base_m = float(self.disc.base_m[0]) if self.on is None else self.on
        if self.holder is not None:  # a handle points ahead; `Person.hold` turns what has none with the body
            self.heading_deg = 0.0 if self.ware.bar is None else float(self.holder.heading[0]) - 90.0
        self.thing = stage.scene.put(
            self.look.kind,
            self.name,
            self.at,
            self.heading_deg,
            rng=stage.rng(f"member/{self.ware.noun}" if self.alike else f"member/{self.name}"),
            on=area.point(*self.at)[2] + max(base_m, 0.0),
            **self.look.words,
            **self.words,
        )
        self.prop = stage.register(
            self.look.kind,
            self.name,
            self.thing,
            at=self.at,
            heading_deg=self.heading_deg,
            area=None,
            look=self.look,
            category=self.ware.noun,
        )


class Role:
    """One person of a plan; acts are added in rising time, each begins at `now`."""

    def __init__(self, figure: Figure, at: Flat, heading_deg: float) -> None:
        self.figure, self.name, self.k = figure, figure.name, figure.scale
        self.disc = Disc.at(figure.name, at, ROOM_M * self.k, 0.21 * self.k, 0.97 * figure.dress.height_m)
        self.heading = np.full(FRAME_COUNT, float(heading_deg))
        self.now = 0
        self.free_hands = {"l", "r"}
        self.held: dict[str, Item] = {}
        self.after: list[Callable[[], None]] = []
        self.waits_for: list[Role] = []
        self.touches: list[Prop] = []  # furniture
        self.start: Flat | None = None  # where its feet are at first, if that is not where its disc is
        self.person: Person
        self._steps: list[Callable[[Person], None]] = []
        self.ground_m = 0.0

    # ---- where it is -----------------------------------------------------------------------------

    @property
    def here(self) -> Flat:
        """Where it is at `now`."""
        f = min(self.now, LAST_FRAME)
        return float(self.disc.xy[f, 0]), float(self.disc.xy[f, 1])

    @property
    def facing(self) -> float:
        """Its heading at `now`."""
        return float(self.heading[min(self.now, LAST_FRAME)])

    @property
    def left(self) -> int:
        """How many frames are left."""
        return LAST_FRAME - self.now

    def hand(self) -> str:
        """A hand that holds nothing, the right one first."""
        for side in ("r", "l"):
            if side in self.free_hands:
                return side
        raise NoRoom("no hand is free")

    def spot_for(self, point: Flat, heading_deg: float, side: str | None, ahead_m: float = 0.36) -> Flat:
        """Where it must stand to take something from a point with one hand (None: with both)."""
        aside = 0.0 if side is None else _SIGN[side] * 0.14
        return ahead(point, heading_deg, -ahead_m * self.k, -aside * self.k)

    # ---- walking ---------------------------------------------------------------------------------

    def walk(self, points: Sequence[Flat], *, facing_deg: float | None = None, pace: float = 2.1) -> Frames:
        """Walks through points, `pace` steps a second."""
        first = self.now
        path = keys.Path([(*self.here, 0.0), *[(p[0], p[1], 0.0) for p in points]])
        steps = max(1, round(path.length / (_STRIDE_M * self.k)))
        last = first + max(MIN_EVENT_FRAMES + 3, ceil(24 * (steps + 1) / pace))
        if last > LAST_FRAME:
            raise NoRoom("there is no time to walk")
        span = last - first
        samples = np.linspace(0.0, path.length, 25)
        line = np.array([path.point(float(s))[:2] for s in samples])
        way = np.gradient(line, axis=0)
        tangents = np.unwrap(np.arctan2(way[:, 0], -way[:, 1]))
        rows = np.arange(first, FRAME_COUNT)
        at = path.length * np.minimum((rows - first) / span, 1.0)
        for axis in range(2):
            self.disc.xy[first:, axis] = np.interp(at, samples, line[:, axis])
        self.heading[first:] = np.degrees(np.interp(at, samples, tangents))
        if facing_deg is not None:
            self.heading[last:] = facing_deg
        self._steps.append(lambda p: p.walk_along(points, (first, last), facing_deg=facing_deg))
        self.hands_follow(first)
        self.now = last
        return first, last

    def turn(self, heading_deg: float) -> Frames:
        """Turns on the spot."""
        first = self.now
        way = (heading_deg - self.facing + 180) % 360 - 180
        pairs = max(1, ceil(abs(radians(way)) / 0.9))
        last = first + 11 * pairs + 2
        if last > LAST_FRAME:
            raise NoRoom("there is no time to turn")
        self.heading[first:] = np.interp(
            np.arange(first, FRAME_COUNT), [first, last], [self.facing, self.facing + way]
        )
        self._steps.append(lambda p: p.turn(heading_deg, (first, last)))
        self.hands_follow(first)
        self.now = last
        return first, last

    def wait(self, frames: int) -> None:
        """Lets time pass."""
        self.now += frames

    def mark(self) -> tuple[int, int, np.ndarray]:
        """What `back_to` needs to forget later acts on the spot."""
        return self.now, len(self._steps), self.disc.radius_m.copy()

    def back_to(self, mark: tuple[int, int, np.ndarray]) -> None:
        """Forgets acts on the spot that were added after a mark."""
        self.now, count, self.disc.radius_m = mark
        del self._steps[count:]

    # ---- gestures --------------------------------------------------------------------------------

    def stand(self, until: int | None = None) -> None:
        """Stands until a frame (None: to the end), if that is long enough to be told."""
        first, last = self.now, LAST_FRAME if until is None else until
        if last - first + 1 >= MIN_EVENT_FRAMES + 3:
            self._steps.append(lambda p: p.stand((first, last)))
        self.now = last

    def act(self, frames: int, do: Callable[[Person, Frames], None], room_m: float = ROOM_M) -> Frames:
        """Any act of a body on the spot that takes so many frames and so much room."""
        first, last = self.now, self.now + frames
        if last > LAST_FRAME:
            raise NoRoom("there is no time for another act")
        self._steps.append(lambda p: do(p, (first, last)))
        self.disc.radius_m[first : last + 1] = np.maximum(
            self.disc.radius_m[first : last + 1], room_m * self.k
        )
        self.now = last
        return first, last

    def wave(self, frames: int = 44) -> Frames:
        """Waves."""
        side = self.hand()
        return self.act(frames, lambda p, f: p.wave(f, side=side), 0.42)

    def phone(self, frames: int = 40) -> Frames:
        """Takes a phone from the pocket and holds it to the ear."""
        side = self.hand()
        self.wait(28 if self.now > 0 else 0)
        return self.act(frames, lambda p, f: travellers.phone(p, f, side=side))

    def stretch(self, frames: int = 56) -> Frames:
        """Stretches with both arms over the head."""
        if self.held:
            raise NoRoom("no hand is free")
        return self.act(frames, lambda p, f: lifters.stretch(p, f), 0.40)

    def cheer(self, frames: int = 40) -> Frames:
        """Throws up both arms."""
        if self.held:
            raise NoRoom("no hand is free")
        return self.act(frames, lambda p, f: playing.cheer(p, f), 0.42)

    def crouch(self, frames: int = 44) -> Frames:
        """Goes down and comes up again."""
        if self.held:
            raise NoRoom("no hand is free")
        return self.act(frames, lambda p, f: p.crouch_down(f, depth=1.2), 0.40)

    def bend_down(self, frames: int = 36) -> Frames:
        """Bends down and straightens up."""
        if self.held:
            raise NoRoom("no hand is free")
        return self.act(frames, lambda p, f: p.bend_down(f, depth=0.9), 0.45)

    def point_at(self, target: Callable[[], Prop], towards: Flat, frames: int = 40) -> Frames:
        """Points at something that stands still, from the hand on its side."""
        bearing = (heading_to(self.here, towards) - self.facing + 180) % 360 - 180
        if abs(bearing) > 75:
            raise NoRoom("somebody would point backwards")
        side = "l" if bearing > 0 else "r"
        if side not in self.free_hands:
            raise NoRoom("no hand is free")

        def do(p: Person, f: Frames) -> None:
            prop = target()
            p.point_at(middle_of(prop), f, side=side, target=prop.instance)

        return self.act(frames, do, 0.5)

    def look(self, point: tuple[float, float, float], frames: Frames) -> None:
        """Looks at a point during an interval."""
        self._steps.append(lambda p: p.look_at(point, frames))

    # ---- things ----------------------------------------------------------------------------------

    def hold(self, item: Item, side: str | None = None, grip: Sequence[float] | None = None) -> None:
        """Has something in the hand from the first frame on; `grip` if not the middle of its handle."""
        ware, side = item.ware, self._take(item, side)
        where = ware.hold_of(item.look) if grip is None else grip
        item.holder = self
        self._steps.append(
            lambda p: p.hold(
                item.prop.instance, where, side=side, bar=ware.bar, carry=ware.carry, clear_m=ware.clear_m
            )
        )
        self.hands_follow(0)

    def lift(self, item: Item, side: str | None = None, frames: int = 28) -> Frames:
        """Takes up something that lies before it."""
        ware, side, first = item.ware, self._take(item, side), self.now
        grasp = first + round(0.46 * frames)

        def do(p: Person, f: Frames) -> None:
            p.lift(
                item.prop.instance,
                ware.grip_of(item.look),
                f,
                side=side,
                bar=ware.bar,
                carry=ware.carry,
                clear_m=ware.clear_m,
            )

        span = self.act(frames, do, 0.40)
        self.hands_follow(grasp)
        return span

    def put_down(self, item: Item, frames: int = 24) -> Frames:
        """Sets what it holds down beside its feet (before them, if both hands hold it)."""
        first, at = self.now, self.put_spot(item)
        release = first + round(0.55 * frames)
        span = self.act(frames, lambda p, f: p.put_down(item.prop.instance, (*at, self.ground_m), f), 0.40)
        self.disc_of(item, release, at)
        self.let_go(item)
        return span

    def put_spot(self, item: Item) -> Flat:
        """Where something comes to stand that is put down here."""
        if item.ware.two_hands:
            return ahead(self.here, self.facing, item.ware.reach_m(item.look, self.k) - 0.03 * self.k)
        side = next(s for s, held in self.held.items() if held is item)
        return ahead(
            self.here, self.facing, 0.24 * self.k, _SIGN[side] * (0.19 * self.k + 0.8 * item.ware.clear_m)
        )

    def let_go(self, item: Item) -> None:
        """Has its hands free again."""
        self.held = {side: held for side, held in self.held.items() if held is not item}
        self.free_hands = {"l", "r"} - set(self.held)

    def disc_of(self, item: Item, frame: int, at: Flat) -> None:
        """Something stays at a point from a frame on."""
        item.disc.xy[frame:] = at
        item.disc.base_m[frame:] = 0.0

    def _take(self, item: Item, side: str | None) -> str:
        if item.ware.two_hands:
            if self.held:
                raise NoRoom("no hand is free")
            self.held = {"l": item, "r": item}
            self.disc.cover = 1.6  # arms and trunk before it
            side = "r"
        else:
            side = side or self.hand()
            if side not in self.free_hands:
                raise NoRoom("no hand is free")
            self.held[side] = item
        self.free_hands = {"l", "r"} - set(self.held)
        self.disc.friends.add(item.name)
        return side

    def hands_follow(self, first: int) -> None:
        """What is held goes along from a frame on."""
        for side, item in self.held.items():
            clear = item.ware.clear_m
            aside_m, ahead_m, base_m = 0.0, 0.36, 0.95 * self.k
            if not item.ware.two_hands:
                aside_m, ahead_m = _SIGN[side] * (0.165 * self.k + 0.86 * clear), 0.02
                base_m = 0.86 * self.k - item.ware.height_m
            item.disc.xy[first:] = ahead_of(self.disc.xy[first:], self.heading[first:], ahead_m, aside_m)
            item.disc.base_m[first:] = base_m

    # ---- the performance -------------------------------------------------------------------------

    def do(self, step: Callable[[Person], None]) -> None:
        """Adds something to the performance that does not show on the plan."""
        self._steps.append(step)

    def perform(self, stage: Stage) -> None:
        """Lets the body do all of it."""
        for step in self._steps:
            step(self.person)
        self.person.finish()
        for then in self.after:
            then()


def perform(stage: Stage, area: Area, roles: Sequence[Role], items: Sequence[Item]) -> None:
    """Builds things and bodies, then lets everybody act; who uses a thing later acts later."""
    for item in items:
        item.build(stage, area)
    for role in roles:
        at = role.start or (float(role.disc.xy[0, 0]), float(role.disc.xy[0, 1]))
        ground = area.point(*at)[2]
        role.ground_m = ground
        role.person = add_person(stage, role.figure, role.name, at, float(role.heading[0]), ground)
        for prop in role.touches:
            stage.may_touch(role.person.instance, prop)
    for item in items:
        for step in item.before:
            step()
    waiting = list(roles)
    while waiting:
        ready = next(role for role in waiting if not any(other in waiting for other in role.waits_for))
        ready.perform(stage)
        waiting.remove(ready)
    for item in items:
        for step in item.after:
            step()
