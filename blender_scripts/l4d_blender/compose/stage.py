"""What places and themes talk to: the scene, where room is left, who is there, and who acts.

Owns ids, free room and the story's text. Draws nothing by itself: a theme decides what it wants.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import hypot
from typing import Any, Protocol, TypeVar

import bpy
from mathutils import Vector

from ..scene import cameras, catalogue
from ..scene.placing import Point, Support, Thing
from ..scene.scene import Instance, Scene
from .areas import Area, Flat, Taken
from .errors import Rejected
from .looks import Look
from .spec import Spec

T = TypeVar("T")


class Performer(Protocol):
    """Whom `finish` keys: a Person, Hand, Cat, Dog, Bird, Driver, ..."""

    def finish(self) -> None:
        """Turns what was planned into keys."""


@dataclass(eq=False)
class Prop:
    """A thing with an identity and a place: an object of a group, or a landmark."""

    instance: Instance
    kind: catalogue.Kind
    look: Look
    at: Flat
    heading_deg: float
    area: Area | None
    radius_m: float

    @property
    def name(self) -> str:
        """Of its instance."""
        return self.instance.name

    @property
    def height_m(self) -> float:
        """Of one with default attributes."""
        return self.kind.size_m[2]


@dataclass(frozen=True)
class Seat:
    """Where somebody sits at a table, or reaches over it: shoulders, and where hands rest."""

    at: Flat
    heading_deg: float
    shoulder_m: float  # world height of the shoulders
    rest_m: float  # from `at` towards the table, to where palms rest
    sitter: bool = False  # whether cameras see the body that the arms belong to


@dataclass(frozen=True)
class Chair:
    """Something to sit down on: a point on the seat right behind the sitter's feet, and where they face."""

    seat: tuple[float, float, float]
    heading_deg: float
    of: Prop | None = None
    """What it is, if that is a landmark: who sits touches it, and walks into the room that it takes."""


@dataclass(frozen=True)
class Memory:
    """A stage before a theme plans: room, cameras, words, and how much was built."""

    areas: dict[str, tuple[Area, list[Taken]]]
    camera_rig: list[cameras.Camera]
    sentences: list[str]
    allowed_contact: set[frozenset[str]]
    built: tuple[int, ...]


class Stage:
    """A composed scene while it is being made."""

    def __init__(self, scene: Scene, spec: Spec, plan: int = 0) -> None:
        self.scene, self.spec = scene, spec
        self.plan = plan  # how many plans of the place, or of the theme, found no room before
        self.areas: dict[str, Area] = {}
        self.seats: list[Seat] = []
        self.chairs: list[Chair] = []
        self.landmarks: list[Prop] = []
        self.objects: list[Prop] = []
        self.performers: list[Performer] = []
        self.sentences: list[str] = []
        self.allowed_contact: set[frozenset[str]] = set()

    # ---- planning again --------------------------------------------------------------------------

    def memory(self) -> Memory:
        """What a theme changes while it plans, to be recalled when the plan does not work."""
        return Memory(
            {name: (area, list(area.taken)) for name, area in self.areas.items()},
            list(self.scene.camera_rig),
            list(self.sentences),
            set(self.allowed_contact),
            self._built(),
        )

    def recall(self, memory: Memory) -> bool:
        """Forgets what was planned since then; false if something has been built, which cannot be undone."""
        if self._built() != memory.built:
            return False
        self.areas = {name: area for name, (area, _) in memory.areas.items()}
        for area, taken in memory.areas.values():
            area.taken = list(taken)
        if self.scene.camera_rig != memory.camera_rig:
            self.film(memory.camera_rig)
        self.sentences = list(memory.sentences)
        self.allowed_contact = set(memory.allowed_contact)
        return True

    def _built(self) -> tuple[int, ...]:
        """How much there is of what themes build."""
        scene = self.scene
        made = (bpy.data.objects, bpy.data.meshes, scene.instances, scene.events, self.performers)
        return tuple(map(len, made))

    # ---- drawing ---------------------------------------------------------------------------------

    def rng(self, key: str) -> random.Random:
        """A random stream per key; another draw of the same seed has others, as has another plan of it."""
        draw = f"{self.spec.draw}.{self.plan}" if self.plan else self.spec.draw
        return self.scene.rng(f"compose/{draw}/{key}")

    def pick(self, key: str, options: Sequence[T], demanded: Iterable[str] = ()) -> T:
        """One of the options; those that the composition demands come first (compared as words)."""
        if not options:
            raise Rejected(f"nothing to pick for {key}")
        wanted = [option for option in options if str(option) in set(demanded)]
        return self.rng(key).choice(wanted or list(options))

    def tell(self, sentence: str) -> None:
        """Adds a sentence to the description of the scene."""
        self.sentences.append(sentence)

    @property
    def description(self) -> str:
        """The story, for people."""
        return " ".join(self.sentences)

    # ---- room ------------------------------------------------------------------------------------

    def add_area(self, area: Area) -> Area:
        """Offers room; a place names its areas after what they are: table, floor, lawn, road, water."""
        self.areas[area.name] = area
        return area

    def area(self, *names: str) -> Area:
        """The first of these areas that the place offers."""
        for name in names:
            if name in self.areas:
                return self.areas[name]
        raise Rejected(f"the place offers no {' or '.join(names)}")

    # ---- cameras ---------------------------------------------------------------------------------

    def closer(
        self,
        points: Sequence[Flat],
        *,
        height_m: float = 0.15,
        margin_m: float = 0.4,
        least_rise: float = 0.5,
    ) -> list[cameras.Camera]:
        """The place's cameras nearer to where things happen, if that is a small part of what they show."""
        low = min(x for x, _ in points), min(y for _, y in points)
        high = max(x for x, _ in points), max(y for _, y in points)
        centre = Vector(((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, height_m))
        half_width_m = margin_m + max(hypot(x - centre.x, y - centre.y) for x, y in points)
        rng = self.rng("closer cameras")
        return cameras.nearer(self.scene.camera_rig, centre, half_width_m, least_rise, rng)

    def film(self, rig: Sequence[cameras.Camera]) -> None:
        """Has the scene seen by these cameras instead of those that the place chose."""
        for camera, obj in zip(rig, self.scene.camera_objects):
            obj.matrix_world = camera.world_from_camera @ cameras.OPENCV_FROM_BLENDER
            obj.data.lens = camera.focal_over_width * obj.data.sensor_width
        self.scene.camera_rig = list(rig)

    # ---- things ----------------------------------------------------------------------------------

    def dress(
        self,
        kind: str,
        name: str,
        at: Point,
        heading_deg: float = 0.0,
        *,
        on: Support = 0.0,
        area: Area | None = None,
        radius_m: float | None = None,
        **words: Any,
    ) -> Thing:
        """Puts something that no query asks for; with an area, it takes room there."""
        rng = self.rng(f"dress/{name}")
        thing = self.scene.put(kind, name, at, heading_deg, rng=rng, on=on, **words)
        if area is not None:
            area.take((at[0], at[1]), plan_radius(kind) if radius_m is None else radius_m, owner=name)
        return thing

    def landmark(
        self,
        kind: str,
        name: str,
        at: Point,
        heading_deg: float = 0.0,
        *,
        on: Support = 0.0,
        area: Area | None = None,
        radius_m: float | None = None,
        category: str | None = None,
        attributes: dict[str, str] | None = None,
        **words: Any,
    ) -> Prop:
        """Puts something that sentences may mention ("next to the lamp"); in an area, it takes room."""
        thing = self.scene.put(kind, name, at, heading_deg, rng=self.rng(f"landmark/{name}"), on=on, **words)
        return self.register(
            kind,
            name,
            thing,
            at=(at[0], at[1]),
            heading_deg=heading_deg,
            area=area,
            radius_m=radius_m,
            landmark=True,
            category=category,
            look=Look(kind, {}, attributes or {}),
        )

    def member(
        self,
        look: Look,
        name: str,
        at: Flat,
        heading_deg: float = 0.0,
        *,
        area: Area,
        on: Support | None = None,
        radius_m: float | None = None,
        category: str | None = None,
        **words: Any,
    ) -> Prop:
        """Puts an object that queries may mean; takes room on its area. Bodies that act register themselves:
        see `register`."""
        support = area.on if on is None else on
        thing = self.scene.put(
            look.kind,
            name,
            at,
            heading_deg,
            rng=self.rng(f"member/{name}"),
            on=support,
            **look.words,
            **words,
        )
        return self.register(
            look.kind,
            name,
            thing,
            at=at,
            heading_deg=heading_deg,
            area=area,
            radius_m=radius_m,
            category=category,
            look=look,
        )

    def register(
        self,
        kind: str,
        name: str,
        thing: Thing | Instance,
        *,
        at: Flat,
        heading_deg: float,
        area: Area | None,
        look: Look,
        radius_m: float | None = None,
        landmark: bool = False,
        category: str | None = None,
        front: str | None = "of its kind",
    ) -> Prop:
        """Gives a thing its identity; an Instance (of a body that registered itself) is taken as it is."""
        entry = catalogue.find(kind)
        if isinstance(thing, Instance):
            instance = thing
        else:
            instance = self.scene.instance(
                name,
                self.next_id(landmark=landmark),
                category or entry.category,
                thing,
                attributes=look.attributes,
                front=entry.front if front == "of its kind" else front,
            )
        radius = plan_radius(kind) if radius_m is None else radius_m
        prop = Prop(instance, entry, look, (at[0], at[1]), heading_deg, area, radius)
        (self.landmarks if instance.role == "landmark" else self.objects).append(prop)
        if area is not None:
            area.take(prop.at, radius, owner=name)
        return prop

    def next_id(self, *, landmark: bool = False) -> int:
        """The next free id of an object or landmark."""
        role, first = ("landmark", 1001) if landmark else ("object", 1)
        return max((i.id for i in self.scene.instances if i.role == role), default=first - 1) + 1

    def perform(self, performer: T) -> T:
        """Notes somebody whose plan is keyed when the theme has finished."""
        self.performers.append(performer)  # type: ignore[arg-type]
        return performer

    def may_touch(self, a: Prop | Instance, b: Prop | Instance) -> None:
        """These two meet on purpose: they don't count as colliding."""
        self.allowed_contact.add(frozenset((a.name, b.name)))

    # ---- what is there ---------------------------------------------------------------------------

    def group(self, category: str) -> list[Prop]:
        """All objects of a category."""
        return [prop for prop in self.objects if prop.instance.category == category]


def plan_radius(kind: str) -> float:
    """Radius in metres of the disc that one of a kind needs in plan."""
    x, y, _ = catalogue.find(kind).size_m
    return hypot(x, y) / 2
