"""People at a table, of whom only arms are seen: whose hands reach what, and which ways their arms need.

Plans in the plane, before anything is built: a theme finds a spot that an arm reaches, keeps the arm's way
clear, and gets the hand when it knows what the hand does. Knows no acts.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import atan2, cos, degrees, hypot, radians, sin, sqrt
from typing import TypeVar

from ...assets.hand import FOREARM_M, UPPER_ARM_M, HandLook
from ...assets.person import CLOTH_COLOURS, SKIN_TONES, Cloth
from ...motion.hands import Hand, wrist_bend
from ..areas import Area, Flat
from ..errors import NoRoom, Rejected
from ..stage import Seat, Stage
from . import bodies

AnyHand = TypeVar("AnyHand", bound=Hand)

WAY_M = 0.05
"""Half the width that a forearm needs."""
_APART_M = 0.18  # of a shoulder from the middle of the chest
_WRIST_M = 0.09  # from the wrist to what fingers take
_LEAN_M = 0.12  # how far the body leans in
_DROP_M = 0.17  # of a wrist below its shoulder
_SIDEWAYS = 0.75  # how much of an elbow's bend is outwards rather than down
_OUTWARDS_DEG, _ACROSS_DEG = 62.0, 38.0
_BEND_RAD = 1.35
_EASY_M = 0.30  # round the middle of what an arm reaches


@dataclass(frozen=True)
class Reach:
    """An arm of somebody at a seat, before it has a hand."""

    seat: Seat
    side: str
    look: HandLook
    owner: int  # number of the seat

    @property
    def name(self) -> str:
        """What its instance is called."""
        return f"{'left' if self.side == 'l' else 'right'}_hand" + (
            f"_{self.owner + 1}" if self.owner else ""
        )

    @property
    def forward(self) -> Flat:
        """The way its owner faces."""
        turn = radians(self.seat.heading_deg)
        return sin(turn), -cos(turn)

    @property
    def outward(self) -> Flat:
        """To the side that the arm is on."""
        ahead = self.forward
        return (ahead[1], -ahead[0]) if self.side == "r" else (-ahead[1], ahead[0])

    def _off(self, ahead_m: float, out_m: float) -> Flat:
        (fx, fy), (ox, oy) = self.forward, self.outward
        return self.seat.at[0] + fx * ahead_m + ox * out_m, self.seat.at[1] + fy * ahead_m + oy * out_m

    @property
    def shoulder(self) -> Flat:
        """In plan."""
        return self._off(0.0, _APART_M)

    @property
    def middle(self) -> Flat:
        """Of what it reaches with ease."""
        return self._off(0.42, _APART_M - 0.06)

    @property
    def rest(self) -> Flat:
        """Where the palm lies when it has nothing to do."""
        return self._off(self.seat.rest_m, _APART_M + 0.04)

    def reaches(self, table: Area, at: Flat) -> bool:
        """Whether fingers come to a spot without twisting the wrist."""
        dx, dy = at[0] - self.shoulder[0], at[1] - self.shoulder[1]
        (fx, fy), (ox, oy) = self.forward, self.outward
        angle = degrees(atan2(dx * ox + dy * oy, dx * fx + dy * fy))
        flat = max(hypot(dx, dy) - _WRIST_M, 0.0)
        rise = self.seat.shoulder_m - table.point(*at)[2] - 0.10
        far = (UPPER_ARM_M + FOREARM_M) * self.look.scale * 0.93 + _LEAN_M
        return -_ACROSS_DEG <= angle <= _OUTWARDS_DEG and flat > 0.20 and hypot(flat, rise) < far

    def ways(self, *targets: Flat) -> list[tuple[Flat, Flat]]:
        """Where the arm is on its way from rest to spots, one after another."""
        stops = [self.rest, *targets]
        elbows = [self._elbow(stop) for stop in stops]
        return [*((self.shoulder, elbow) for elbow in elbows), *zip(elbows, stops), *zip(stops, stops[1:])]

    def _elbow(self, at: Flat) -> Flat:
        """Where the elbow is in plan while fingers are at a spot: farther out the nearer the spot."""
        dx, dy = at[0] - self.shoulder[0], at[1] - self.shoulder[1]
        flat = max(hypot(dx, dy), 1e-6)
        dx, dy = dx / flat, dy / flat
        wrist = max(flat - _WRIST_M, 0.05)
        upper, fore = UPPER_ARM_M * self.look.scale, FOREARM_M * self.look.scale
        far = min(hypot(wrist, _DROP_M), 0.97 * (upper + fore))
        along = (far * far + upper * upper - fore * fore) / (2 * far)
        out_m = _SIDEWAYS * sqrt(max(upper * upper - along * along, 0.0))
        ox, oy = (dy, -dx) if self.side == "r" else (-dy, dx)
        ahead_m = along * wrist / far
        return self.shoulder[0] + dx * ahead_m + ox * out_m, self.shoulder[1] + dy * ahead_m + oy * out_m

    def is_clear(self, table: Area, *targets: Flat, ignoring: Sequence[str] = ()) -> bool:
        """Whether nothing is in the arm's way to spots."""
        ignoring = (*ignoring, self.name)
        return all(table.is_clear(a, b, WAY_M, ignoring=ignoring) for a, b in self.ways(*targets))

    def take(self, table: Area, *targets: Flat) -> None:
        """Keeps the arm's way to spots."""
        for a, b in self.ways(*targets):
            table.take(a, WAY_M, b, owner=self.name)

    def spot(
        self,
        rng: random.Random,
        table: Area,
        radius_m: float,
        *,
        near: Flat | None = None,
        within_m: tuple[float, float] = (0.0, float("inf")),
        after: Sequence[Flat] = (),
        tries: int = 200,
    ) -> Flat:
        """A free spot that the arm reaches by a clear way, if it was at the spots of `after` before."""
        if near is None:
            near, within_m = self.middle, (0.0, _EASY_M)
        for _ in range(tries):
            at = table.spot(rng, radius_m, near=near, within_m=within_m, tries=60)
            if self.reaches(table, at) and self.is_clear(table, *after, at):
                return at
        raise NoRoom(f"{self.name} reaches no free spot")

    def push(
        self,
        rng: random.Random,
        table: Area,
        radius_m: float,
        length_m: tuple[float, float],
        *,
        followed: float = 1.0,
        after: Sequence[Flat] = (),
        tries: int = 300,
    ) -> tuple[Flat, Flat]:
        """Where something lies that the arm pushes away, and where it comes to rest.

        Fingers follow it over a share of its way; what was at the spots of `after` has a clear way too.
        """
        for _ in range(tries):
            at = table.spot(rng, radius_m, near=self.middle, within_m=(0.0, _EASY_M), tries=60)
            if not self.reaches(table, at):
                continue
            turn = radians(self.heading_deg(at) + rng.uniform(-24.0, 24.0))
            way = rng.uniform(*length_m)
            dx, dy = way * sin(turn), -way * cos(turn)
            end = at[0] + dx, at[1] + dy
            stop = at[0] + followed * dx, at[1] + followed * dy
            if (
                table.is_free(at, radius_m, end)
                and self.reaches(table, stop)
                and self.is_clear(table, *after, at, stop)
            ):
                return at, end
        raise NoRoom(f"{self.name} has nowhere to push something")

    def heading_deg(self, at: Flat) -> float:
        """Where fingers point that take something there: away from the shoulder, a little inwards."""
        dx, dy = at[0] - self.shoulder[0], at[1] - self.shoulder[1]
        inwards = 12.6 if self.side == "r" else -12.6
        return degrees(atan2(dx, -dy)) + inwards

    def hand(self, stage: Stage, kind: type[AnyHand]) -> AnyHand:
        """The hand itself, resting; a landmark with its side and sleeve as properties."""
        height = stage.area("table").point(*self.rest)[2]
        assert isinstance(self.look.sleeve.colour, str)
        hand = kind(
            stage.scene,
            self.name,
            stage.next_id(landmark=True),
            side=self.side,
            look=self.look,
            attributes={
                "side": "left" if self.side == "l" else "right",
                "sleeve": self.look.sleeve.colour.replace("light_", ""),
            },
            shoulder=(*self.shoulder, self.seat.shoulder_m),
            rest_at=(*self.rest, height),
            table_m=height,
        )
        stage.perform(_Unbent(hand))
        if self.seat.sitter:
            _seat_body(stage, self)
        return hand


@dataclass(frozen=True)
class _Unbent:
    """A hand that is refused when its wrist bends more than wrists do."""

    hand: Hand

    def finish(self) -> None:
        self.hand.finish()
        bend = wrist_bend(self.hand)
        if bend > _BEND_RAD:
            raise Rejected(f"{self.hand.instance.name} bends its wrist by {degrees(bend):.0f} degrees")


@dataclass
class _Body:
    """Who owns the hands of a seat; built when it is known which arms act."""

    stage: Stage
    arm: Reach
    busy: set[str]

    def finish(self) -> None:
        bodies.seat_body(self.stage, self.arm.seat, self.arm.owner, self.arm.look, self.busy)


def _seat_body(stage: Stage, arm: Reach) -> None:
    """One body a seat, whichever of its arms asks first."""
    for performer in stage.performers:
        if isinstance(performer, _Body) and performer.arm.owner == arm.owner:
            performer.busy.add(arm.side)
            return
    stage.perform(_Body(stage, arm, {arm.side}))


def willing(arms: list[Reach], plan: Callable[[Reach], object]) -> Reach:
    """The first arm with which a plan finds room; it is taken from the list."""
    for arm in list(arms):
        try:
            plan(arm)
        except NoRoom:
            continue
        arms.remove(arm)
        return arm
    raise NoRoom("no arm has room for what it should do")


def reaches(stage: Stage, rng: random.Random, table: Area | None = None) -> list[Reach]:
    """All arms at the table, in random order; those of one owner look alike, those of two differ.

    Places keep room on their tables for all arms; on `table` it is free again, for arms that don't act lie in
    the lap.
    """
    skins, sleeves = list(SKIN_TONES), [c for c in CLOTH_COLOURS if c not in ("denim", "light_blue", "black")]
    rng.shuffle(skins)
    rng.shuffle(sleeves)
    found = []
    for owner, seat in enumerate(stage.seats):
        sleeve = sleeves[owner % len(sleeves)]
        look = HandLook(
            skin=skins[owner % len(skins)],
            sleeve=Cloth(sleeve),
            cuff=rng.choice((sleeve, "navy", "grey", "white")),
            scale=rng.uniform(0.92, 1.0),
        )
        found += [Reach(seat, side, look, owner) for side in ("l", "r")]
    if not found:
        raise Rejected("no one sits at the table")
    if table is not None:
        for arm in found:
            table.free(arm.name)
    rng.shuffle(found)
    return found
