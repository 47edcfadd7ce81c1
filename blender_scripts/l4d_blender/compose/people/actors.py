"""People of composed scenes: one body that can do all that the people of the motion library do.

Adds what a drawn plan needs and a written recipe does not: gestures that also work while sitting, pointing at
the middle of something. Draws nothing; knows no places.
"""

from __future__ import annotations

from math import pi

import numpy as np

from ...assets import chef_hat
from ...assets.anatomy import SIDES, vec
from ...motion.cooks import Cook
from ...motion.deskwork import OfficeWorker
from ...motion.ik import ease, turn_z
from ...motion.lifters import Lifter
from ...motion.nursery import Toddler
from ...motion.plan_person import ROWS, SIGN, Frames
from ...motion.playing import Player
from ...motion.reading import Reader
from ...motion.throwing import Thrower
from ...motion.traders import Trader
from ...motion.travellers import Traveller
from ...scene.placing import Point
from ...scene.scene import Instance
from ...scene.timeline import FPS, LAST_FRAME
from ..looks import Look
from ..stage import Prop, Stage
from .folk import Figure


class Actor(Cook, Lifter, Reader, OfficeWorker, Traveller, Thrower, Player, Trader, Toddler):
    """A person with all verbs."""

    @property
    def stands_at(self) -> tuple[float, float]:
        """Where it stands in the first frame."""
        return float(self._xy[0, 0]), float(self._xy[0, 1])

    def point_out(self, target: Instance, spot: Point, frames: Frames, *, side: str = "r") -> None:
        """Points at `spot`, a world point of something, such as its middle."""
        before = len(self.scene.events)
        self.point_at(tuple(spot), frames, side=side)
        del self.scene.events[before:]
        self.scene.event(self.instance, "point_at", frames, target)

    def sit_all_along(self, seat: Point) -> None:
        """Sits from the first frame to the last, hands on the knees."""
        self.be_seated(seat)
        self.scene.event(self.instance, "sit", (0, LAST_FRAME))
        self.hands_on_knees((-2, -1))

    def hands_on_knees(self, frames: Frames) -> None:
        """Lays both hands on the thighs of a seated body."""
        for side, _ in SIDES:
            self.hand_on_knee(side, frames)

    def hand_on_knee(self, side: str, frames: Frames) -> None:
        """Lays one hand on the thigh of a seated body."""
        s, k = SIGN[side], self._k
        hip_m = self.body.anatomy.joints["root"][2] - float(self._crouch[frames[1] if frames[1] > 0 else 0])
        wrist = vec(s * 0.115 * k, -0.06 * k, hip_m + 0.07 * k)
        turned = self.puppet.hand_rotation(side, vec(-0.25 * s, -0.95, -0.12), vec(0.1 * s, 0, -1))
        facing = turn_z(float(self._heading[0]))
        world = np.array([*self._xy[0], self.ground_m]) + facing @ wrist
        self._wish(side, frames, world, facing @ turned, "world")
        self._close(side, max(frames[0], 0), 0.22)

    def wave_sitting(self, frames: Frames, *, side: str = "r", per_s: float = 1.5) -> None:
        """Raises a hand beside the head of a seated body, waves, and lays it on the knee again."""
        first, last = frames
        s, k = SIGN[side], self._k
        swing = np.sin(2 * pi * per_s * (ROWS - first) / FPS)
        facing = turn_z(float(self._heading[0]))
        slide = turn_z(-float(self._heading[0])) @ np.array([*self._slide[first], 0.0])
        drop = float(self._crouch[first])
        back = slide[1] + 0.12 * drop
        wrist = np.stack(
            [s * (0.32 + 0.085 * swing), -0.16 + back / k + 0.0 * swing, 1.56 - drop / k - 0.022 * swing**2],
            axis=1,
        )
        along = np.stack([s * (0.16 + 0.42 * swing), -0.08 + 0 * swing, 1.0 + 0 * swing], axis=1)
        turned = np.stack([facing @ self.puppet.hand_rotation(side, a, vec(0, -1, 0.1)) for a in along])
        world = np.array([*self._xy[0], self.ground_m]) + (k * wrist) @ facing.T
        self._wish(side, (first, first + 14), world, turned, "world", pole=vec(s * 0.8, 0.25, -0.9))
        self._close(side, first, 0.06)
        if last < LAST_FRAME:
            self.hand_on_knee(side, (last - 12, last))
        self.scene.event(self.instance, "wave", frames)

    def ease_grip(self, side: str, curl: float) -> None:
        """Fingers that lie round something big instead of closing to a fist."""
        self._curl[side][:] = curl

    def nod(self, frames: Frames, depth: float = 0.12) -> None:
        """Leans forward a little for a while, without a word."""
        first, last = frames
        lean = ease((ROWS - first) / 10) * (1.0 - ease((ROWS - last + 10) / 10))
        self._bend = self._bend + depth * lean


def hire(
    stage: Stage, figure: Figure, name: str, at: Point, heading_deg: float, ground_m: float = 0.0
) -> Actor:
    """Builds the body of a figure and registers it as an object."""
    actor = Actor(
        stage.scene,
        name,
        stage.next_id(),
        category=figure.noun,
        look=figure.dress,
        attributes=figure.look.attributes,
        at=at,
        heading_deg=heading_deg,
        ground_m=ground_m,
    )
    if figure.hat:
        hat = chef_hat.put_on(f"{name}.hat", actor.body)
        hat.pass_index = actor.instance.id
        actor.instance.objects.append(hat)
    stage.register(
        "person",
        name,
        actor.instance,
        at=(at[0], at[1]),
        heading_deg=heading_deg,
        area=None,
        look=Look("person", {}, figure.look.attributes),
        radius_m=0.3,
    )
    return actor


def middle_of(prop: Prop) -> tuple[float, float, float]:
    """A point in the middle of a thing where it stands at first."""
    at = prop.instance.matrix(0).translation
    return at.x, at.y, at.z + 0.5 * prop.height_m
