"""Dogs that are stroked: people come up to one or stand by it, stroke its head, and others wait about."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, hypot
from typing import TYPE_CHECKING

from ...motion import travellers
from ...scene.timeline import LAST_FRAME
from .. import looks
from ..animals import bodies, ways
from ..animals.members import Part, Plan, Planner, planned
from ..animals.ways import Way, ahead
from ..areas import Flat, heading_to
from ..errors import NoRoom
from ..people import folk
from ..people.bodies import add_person
from . import theme

if TYPE_CHECKING:
    from ...motion.dogs import Dog
    from ..stage import Stage

DOG = ways.Body(ahead_m=0.50, behind_m=0.50, half_width_m=0.22)
BODY_M = 0.27
CROWN_M = {"sit": 0.20, "stand": 0.375}  # from a dog's middle to the top of its head, in plan
LIE = 18  # frames
_NOUNS = ("person", "woman", "man")


@dataclass
class _Visit:
    """Somebody's way to a dog (none for somebody who only looks on), and when the hand is on its head."""

    dog: int | None
    facing_deg: float
    come: tuple[int, int] | None = None
    pet: tuple[int, int] | None = None


@theme(
    "outdoor",
    needs=("lawn",),
    categories=("dog", *_NOUNS),
    verbs=("pet", "walk", "sit", "stand", "lie_down", "phone", "wave"),
)
def dogs_petted(stage: Stage) -> None:
    """Three dogs and three people."""
    rng, area = stage.rng("dogs petted"), stage.area("lawn")
    options = {"coat": looks.words_of("dog", "coat"), "collar": ("red", "blue", "green", "orange", "yellow")}
    cast = looks.crossed(rng, "dog", 3, options)
    figures = folk.cast(rng, stage.pick("dogs petted/noun", _NOUNS, stage.spec.categories), 3)
    visits: list[_Visit] = []

    def make(middle: Flat) -> Plan:
        planner = _Planner(rng, area, middle, 1.5, DOG)
        plan = planner.plan()
        visits[:] = planner.visits
        return plan

    plan = planned(stage, area, rng, "dogs and people", 2.8, make, height_m=0.7, margin_m=0.75)
    dogs = []
    for k, (look, part) in enumerate(zip(cast, plan.parts[:3]), 1):
        dog = bodies.dog(stage, k, look, part)
        for what, frames in part.acts:
            if what == "lie_down":
                dog.lie_down(frames)
            elif what == "wag":
                dog.wag(frames)
            else:
                dog.scene.event(dog.instance, what, frames)
        dogs.append(stage.perform(dog))
    for figure, part, visit in zip(figures, plan.parts[3:], visits):
        _visit(stage, figure, part, visit, dogs)
    count = sum(visit.pet is not None for visit in visits)
    stage.tell(f"Three dogs and three people, {count} of whom stroke a dog.")


def _visit(stage: Stage, figure: folk.Figure, part: Part, visit: _Visit, dogs: list[Dog]) -> None:
    """Builds somebody and lets them come, stroke and stand."""
    area, rng = stage.area("lawn"), stage.rng(f"dogs petted/{figure.name}")
    person = add_person(stage, figure, figure.name, part.at, part.heading_deg, area.point(*part.at)[2])
    done = 0
    if visit.dog is not None and visit.pet is not None:
        dog, side = dogs[visit.dog], "r"
        crown = dog.crown(visit.pet[0])
        if visit.come is not None:
            spot = person.reach_spot(crown, visit.facing_deg, side=side)
            person.walk_to(spot, visit.come, facing_deg=visit.facing_deg)
        elif visit.pet[0] >= 15:
            person.stand((0, visit.pet[0]))
        person.pet(dog.instance, crown, visit.pet, side=side)
        person.look_at(dog.instance, (visit.pet[1], LAST_FRAME))
        stage.may_touch(person.instance, dog.instance)
        done = visit.pet[1]
        if LAST_FRAME - done >= 16:
            person.stand((done, LAST_FRAME))
    elif rng.random() < 0.5:
        first = rng.randint(20, 40)
        person.stand((0, first))
        person.wave((first, first + rng.randint(36, 44)))
    else:
        first = rng.randint(30, 50)
        person.stand((0, first - 14))
        travellers.phone(person, (first, min(first + rng.randint(28, 40), LAST_FRAME)))
    stage.perform(person)


class _Planner(Planner):
    """Dogs take room first, then the people who come to them, then those who only look on."""

    def plan(self) -> Plan:
        """Two dogs are stroked, one after the other or at once; the third is not."""
        rng = self.rng
        self.visits: list[_Visit] = []
        for k in range(3):
            posture = rng.choice(("sit", "sit", "stand")) if k else "sit"
            at, heading = self.spot(self.spread_m, astray_deg=180.0)
            self.stay(at, heading)
            self.parts.append(Part(at, heading, posture, 0.2, 0.62))
        early = rng.randint(2, 8)
        for k, start in ((0, None), (1, rng.choice((early, rng.randint(34, 44))))):
            self._come(k, start)
        at = self.area.spot(rng, BODY_M, near=self.middle, within_m=(0.6, self.spread_m + 0.4))
        self.area.take(at, BODY_M, owner=self.owner)
        self.parts.append(
            Part(at, heading_to(at, self.middle) + rng.uniform(-40.0, 40.0), "person", 0.2, 1.6)
        )
        self.visits.append(_Visit(None, 0.0))
        for part, visit in zip(self.parts, [*self.visits[:2], None]):
            self._pass(part, visit)
        return Plan(self.parts, [])

    def _come(self, k: int, start: int | None) -> None:
        """Somebody stands before a dog's head, or comes from a few steps away if there is no start."""
        rng, dog = self.rng, self.parts[k]
        crown = ahead(dog.at, dog.heading_deg, CROWN_M[dog.posture])
        for _ in range(40):
            facing = dog.heading_deg + 180.0 + rng.choice((-1.0, 1.0)) * rng.uniform(15.0, 75.0)
            spot = ahead(crown, facing, -0.36, 0.14)
            if not self.area.is_free(spot, BODY_M, ignoring=(f"member {k}",)):
                continue
            far, aside = rng.uniform(0.8, 1.5), facing + rng.uniform(-50.0, 50.0)
            origin = ahead(spot, aside, -far) if start is None else spot
            if start is None and not (
                self.inside(origin) and self.area.is_free(origin, BODY_M, spot, ignoring=(f"member {k}",))
            ):
                continue
            self.area.take(origin, BODY_M, spot, owner=self.owner)
            part = Part(origin, aside if start is None else facing, "person", 0.2, 1.6)
            visit = _Visit(k, facing)
            if start is None:
                leave = rng.randint(0, 6)
                arrive = leave + ceil(24 * (round(far / 0.55) + 1.5) / 2.0)
                visit.come, start = (leave, arrive), arrive + 2
                points = tuple(
                    (origin[0] + t * (spot[0] - origin[0]), origin[1] + t * (spot[1] - origin[1]))
                    for t in (0.0, 0.25, 0.5, 0.75, 1.0)
                )
                length = hypot(spot[0] - origin[0], spot[1] - origin[1])
                part.acts.append(("walk", visit.come, Way(points, aside, facing, length)))
            visit.pet = start, min(start + rng.randint(34, 44), LAST_FRAME)
            self.parts.append(part)
            self.visits.append(visit)
            return
        raise NoRoom("a place before a dog")

    def _pass(self, part: Part, visit: _Visit | None) -> None:
        """What a dog does: it keeps still while a hand is on its head, and may lie down later."""
        rng = self.rng
        free = visit.pet[1] + 2 if visit is not None and visit.pet is not None else rng.randint(20, 50)
        last = LAST_FRAME
        if part.posture == "sit" and free + LIE <= LAST_FRAME and rng.random() < 0.6:
            part.acts.append(("lie_down", (free, free + LIE)))
            last = free
        part.acts.append((part.posture, (0, last)))
        if visit is None or rng.random() < 0.5:
            part.acts.append(("wag", (rng.randint(0, 20), last)))
