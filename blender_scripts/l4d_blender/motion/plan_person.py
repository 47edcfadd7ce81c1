"""The plan of one person: tracks over all frames, and the strokes that actions draw on them.

Holds where body, feet, hands and gaze shall be, who holds what, how deep a stoop reaches something, and what
remains to be done once the body is keyed. Knows no verbs and records no events but holding; people.py does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi, radians
from typing import TYPE_CHECKING

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import SIDES, vec
from ..assets.person import Look, person
from ..scene.scene import Instance, RecipeError, Scene
from ..scene.timeline import FRAME_COUNT, LAST_FRAME, MIN_EVENT_FRAMES
from . import gait
from .ik import ease, turn_z
from .puppet import Puppet, Stance

if TYPE_CHECKING:
    from .acting import Played

ROWS = np.arange(FRAME_COUNT)
SIGN = dict(SIDES)
Frames = tuple[int, int]
CROUCH_M, BEND_RAD = 0.225, 1.10  # share of knees and of hips in a stoop of depth 1


@dataclass
class Wish:
    """A hand's target over time: wins over earlier wishes as `weight` rises from 0 to 1."""

    weight: np.ndarray
    wrist: np.ndarray
    rotation: np.ndarray | None
    space: str
    pole: np.ndarray | None = None

    def rotation_at(self, frame: int) -> np.ndarray:
        """Of the hand, if it is to be turned at all."""
        assert self.rotation is not None
        return self.rotation[frame]


@dataclass
class Held:
    """Something that moves with one or two hands from `first` to `last`."""

    instance: Instance
    sides: tuple[str, ...]
    grips: list[np.ndarray]
    first: int
    last: int | None = None
    rest_at: Matrix = field(default_factory=Matrix)
    goal: Matrix | None = None
    from_start: bool = False
    bar_yaw: float | None = None
    again: dict[str, Matrix] | None = None


class PersonPlan:
    """State and strokes of a person's plan; `Person` and the functions over it add the verbs.

    Tracks have one row per canonical frame. `xy` (n, 2) and `heading` (n, radians) say where the body is in
    the world, `slide` (n, 2) how far the pelvis is off that, `crouch` how far it is lowered (metres). `bend`,
    `twist` and `lean` turn the trunk forward, about its axis and sideways, in radians. `curl` closes the
    fingers of a side (0 to 1), `pointing` stretches its index finger. `k` is the body's scale; what is in
    `late` is called in the end with the keyed motion.
    """

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        category: str,
        look: Look,
        attributes: Mapping[str, str] | None = None,
        at: Sequence[float] = (0.0, 0.0),
        heading_deg: float = 0.0,
        ground_m: float = 0.0,
    ) -> None:
        self.scene, self.look, self.ground_m = scene, look, ground_m
        self.body = person(name, scene.rng(name), look=look)
        self.puppet = Puppet(self.body.anatomy, self.body.skirt)
        self.instance = scene.instance(
            name,
            id,
            category,
            self.body.meshes,
            attributes=attributes,
            front="-y",
            frame_object=self.body.rig,
        )
        self.k = self.body.anatomy.scale
        self.phase = scene.rng(f"{name}/idle").uniform(0.0, 2.0 * pi)
        xy = np.array(at[:2], float)
        self.xy = np.tile(xy, (FRAME_COUNT, 1))
        self.heading = np.full(FRAME_COUNT, float(radians(heading_deg)))
        spots = {s: gait.stance_spot(self.body.anatomy, s, xy, radians(heading_deg)) for s, _ in SIDES}
        self.feet = gait.FootTrack(self.body.anatomy, spots, radians(heading_deg))
        self.crouch, self.bend = np.zeros(FRAME_COUNT), np.zeros(FRAME_COUNT)
        self.twist, self.lean = np.zeros(FRAME_COUNT), np.zeros(FRAME_COUNT)
        self.slide = np.zeros((FRAME_COUNT, 2))
        self.wishes: dict[str, list[Wish]] = {s: [] for s, _ in SIDES}
        self.curl = {s: np.full(FRAME_COUNT, 0.28) for s, _ in SIDES}
        self.pointing = {s: np.zeros(FRAME_COUNT) for s, _ in SIDES}
        self.gazes: list[tuple[np.ndarray, object]] = []
        self.held: list[Held] = []
        self.lead = "l"
        self.finished = False
        self.late: list[Callable[[Played], None]] = []

    @property
    def stands_at(self) -> tuple[float, float]:
        """Where it is in the first frame."""
        return float(self.xy[0, 0]), float(self.xy[0, 1])

    def stoop(self, first: int, last: int, depth: float, twist: float = 0.0) -> None:
        """Bends hips and knees and stays so; 0.3 is a nod of the trunk, 1 brings the hands to the shins."""
        u = ease((ROWS - first) / max(last - first, 1))
        for name, goal in (
            ("crouch", CROUCH_M * self.k * depth),
            ("bend", min(BEND_RAD * depth, 1.45)),
            ("twist", twist),
        ):
            track = getattr(self, name)
            setattr(self, name, np.where(first > ROWS, track, track[first] + (goal - track[first]) * u))

    def squat(self, first: int, last: int, depth: float) -> None:
        """Turns a stoop into a squat: deeper knees, a more upright back."""
        u = ease((ROWS - first) / max(last - first, 1))
        self.crouch = self.crouch + 0.10 * self.k * depth * u
        self.bend = self.bend * (1.0 - 0.35 * u)

    def depth_for(self, wrists: dict[str, np.ndarray], frame: int) -> float:
        """How deep to stoop so that the arms reach their targets comfortably."""
        heading = float(self.heading[frame])
        for depth in np.linspace(0.0, 2.0, 41):
            stance = self.torso_at(frame, crouch=CROUCH_M * self.k * depth, bend=min(BEND_RAD * depth, 1.45))
            gaps = []
            for side, wrist in wrists.items():
                local = turn_z(-heading) @ (wrist - np.array([*self.xy[frame], self.ground_m]))
                arm = sum(self.puppet.arm[side])
                gaps.append(float(np.linalg.norm(local - self.puppet.shoulder(stance, side))) / arm)
            if max(gaps) < 0.93:
                return float(depth)
        raise RecipeError(
            f"{self.instance.name} can't reach at frame {frame}: {100 * (max(gaps) - 0.93):.0f} % of an "
            "arm's length is missing",
            "stand closer, about where Person.reach_spot says",
        )

    def wish(
        self,
        side: str,
        frames: Frames,
        wrist: np.ndarray,
        rotation: np.ndarray | None,
        space: str,
        *,
        pole: np.ndarray | None = None,
        arc: float = 0.0,
    ) -> None:
        """Leads a wrist to a place (3, or n x 3) in a space: "world", "body", or "carry" for what is held.

        It gets there at the end of the interval and stays; `rotation` is the hand's, `pole` the way that the
        elbow points, `arc` how far the wrist is raised on the way, in metres.
        """
        first, last = frames
        u = ease((ROWS - first) / max(last - first, 1))
        track = np.broadcast_to(wrist, (FRAME_COUNT, 3)).astype(float).copy()
        track[:, 2] += arc * np.sin(pi * u) * (1 - u)
        turned = None if rotation is None else np.broadcast_to(rotation, (FRAME_COUNT, 3, 3))
        self.wishes[side].append(Wish(u, track, turned, space, pole))

    def lower_arm(self, side: str, frames: Frames) -> None:
        """Lets an arm sink to where it hangs."""
        first, last = frames
        if first < LAST_FRAME:
            self.wishes[side].append(
                Wish(ease((ROWS - first) / (last - first)), np.zeros((FRAME_COUNT, 3)), None, "hang")
            )

    def close_hand(self, side: str, frame: int, curl: float, within: int = 10) -> None:
        """Curls the fingers (0 straight, 1 a fist) from a frame on, within so many frames."""
        u = ease((ROWS - frame) / within)
        start = self.curl[side][max(frame, 0)]
        self.curl[side] = np.where(frame > ROWS, self.curl[side], start + (curl - start) * u)

    def wish_rotation_at(self, side: str, frame: int) -> np.ndarray:
        """The hand's rotation in the world that is planned for a frame."""
        wish = [w for w in self.wishes[side] if w.space == "world" and w.weight[frame] > 0.99][-1:]
        if wish:
            return wish[0].rotation_at(frame)
        return turn_z(float(self.heading[frame])) @ self.wishes[side][-1].rotation_at(frame)

    def track_of(self, target: Instance | Sequence[float]) -> np.ndarray:
        """Where something is at every frame (n, 3)."""
        if isinstance(target, Instance):
            return np.array([np.array(target.matrix(f).translation) for f in range(FRAME_COUNT)])
        return np.tile(np.array(target, float), (FRAME_COUNT, 1))

    def to_world(self, local: np.ndarray) -> np.ndarray:
        """Where a point of the body's space is at every frame (n, 3)."""
        return np.array(
            [
                np.array([*self.xy[f], self.ground_m]) + turn_z(float(self.heading[f])) @ local
                for f in range(FRAME_COUNT)
            ]
        )

    def torso_at(self, frame: int, crouch: float, bend: float) -> Stance:
        """The trunk of somebody who stands, lowered by `crouch` metres and bent by `bend` radians."""
        k, root = self.k, self.body.anatomy.joints["root"]
        back = 0.17 * np.sin(bend) * k + 0.12 * crouch
        return Stance(pelvis=root + vec(0, back, -0.012 * k - crouch), bend=bend)

    def report_hold(self, held: Held) -> None:
        """Records that something was held, if that took long enough to be seen."""
        last = LAST_FRAME if held.last is None else held.last
        if last - held.first + 1 >= MIN_EVENT_FRAMES:
            self.scene.event(self.instance, "hold", (held.first, last), held.instance)
