"""People on their way: they pull a trolley suitcase and park it, keep a hand on one, telephone, cross a road.

A `Traveller` is a `Person` with these verbs. A pulled case hangs on the fist like a trailer: its wheels
follow on the ground, so that hand, handle and pavement agree at every frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..assets import phone
from ..assets.anatomy import vec
from ..assets.suitcase import WHEEL_RADIUS_M, Suitcase
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FRAME_COUNT, LAST_FRAME
from .acting import Played, grip_points
from .ik import ease, turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames
from .puppet import Stance

UPRIGHT_FRAMES = 16  # a parked case comes upright in so many frames
_PULL_GRIP = (0.295, 0.20, 0.800)  # aside, behind, above: where the fist pulls, on the reference body


@dataclass
class Towed:
    """A case behind one hand from frame 0 until it stands at `parked`."""

    case: Suitcase
    instance: Instance
    side: str
    parked: int
    tilt: np.ndarray


@dataclass
class Carried:
    """The telephone: in the pocket before `drawn`, in the hand from then on."""

    thing: bpy.types.Object
    side: str
    drawn: int


class Traveller(Person):
    """A person with luggage. Call `pull` before `walk_along`, and `phone` after `sit`."""

    _towed: Towed | None = None
    _phone: Carried | None = None

    # ---- luggage ---------------------------------------------------------------------------------

    def pull(self, case: Suitcase, instance: Instance, last: int, *, side: str = "r") -> int:
        """Pulls a tilted trolley case from frame 0 to `last`, then lets it come upright and lets go.

        Returns the frame at which it stands. The walking itself is planned with `walk_along`.
        """
        length = case.grip.z - WHEEL_RADIUS_M
        s, k = SIGN[side], self._k
        aside, behind, height = (c * k for c in _PULL_GRIP)
        slope = float(np.arccos((height - WHEEL_RADIUS_M) / length))
        up = ease((ROWS - last) / UPRIGHT_FRAMES)
        tilt = slope * (1.0 - up)
        fist = np.stack(
            [np.full(FRAME_COUNT, s * aside), behind + 0.03 * up, WHEEL_RADIUS_M + length * np.cos(tilt)],
            axis=1,
        )
        turned = self.puppet.hand_rotation(side, vec(0.0, 0.30, -0.95), vec(0.0, 0.95, 0.30))
        wrist = fist - self.puppet.grip_offset(side, turned)
        self._wish(side, (-2, -1), wrist, turned, "body", pole=vec(0.30 * s, 1.0, -0.6))
        self._curl[side][:] = 0.86
        parked = last + UPRIGHT_FRAMES
        self._close(side, parked + 1, 0.12, within=8)
        self._close(side, parked + 14, 0.28)
        self._lower(side, (parked + 3, parked + 19))
        self._towed = Towed(case, instance, side, parked, tilt)
        self.scene.event(self.instance, "pull", (0, last), instance)
        self.scene.event(self.instance, "hold", (0, parked), instance)
        self.scene.event(instance, "roll", (0, last))
        return parked

    def hand_on(
        self, instance: Instance, grip: Sequence[float], last: int, *, side: str, bar: Sequence[float]
    ) -> None:
        """Holds the handle of something that stands by, from frame 0 to `last`, then lets the arm sink.

        `grip` is a point in the world, `bar` the direction of the handle there.
        """
        turned = self._grip_rotation(side, 0, np.array(bar, float), False)
        wrist = np.array(grip, float) - self.puppet.grip_offset(side, turned)
        pole = turn_z(float(self._heading[0])) @ vec(0.9 * SIGN[side], 0.6, -0.3)
        self._wish(side, (-2, -1), wrist, turned, "world", pole=pole)
        self._curl[side][:] = 0.86
        self._close(side, last + 1, 0.15, within=6)
        self._lower(side, (last + 3, last + 18))
        self.scene.event(self.instance, "hold", (0, last), instance)

    # ---- in the street ---------------------------------------------------------------------------

    def cross(
        self, points: Sequence[Sequence[float]], frames: Frames, *, before: Instance, passing: Frames
    ) -> None:
        """Walks over a road; `passing` is when this leads past the front of the car `before`."""
        self.walk_along(points, frames)
        self.look_at(before, (frames[0] - 12, passing[1]))
        self.scene.event(self.instance, "pass", passing, before)

    # ---- telephone -------------------------------------------------------------------------------

    def phone(self, frames: Frames, *, side: str = "r", draw: int = 14) -> None:
        """Draws a phone from the pocket within `draw` frames and holds it to the ear until the interval ends.

        The recorded interval begins where the phone reaches the ear (from frame 0 on it is there already);
        later it stays in the hanging hand.
        """
        first, last = frames
        hip, ear = self._phone_places(side, first), self._phone_places(side, last)
        s = SIGN[side]
        down = self.puppet.hand_rotation(side, vec(0.15 * s, -0.2, -1.0), vec(-s, 0.15, 0.0))
        up = self.puppet.hand_rotation(side, vec(-0.15 * s, 0.72, 0.68), vec(-s, -0.15, 0.10))
        at_hip = hip["pocket"] - self.puppet.palm_offset(side, down)
        at_ear = ear["ear"] - self.puppet.palm_offset(side, up)
        elbow = vec(0.40 * s, -0.20, -1.0)
        if first > 0:
            self._wish(side, (first - 2 * draw, first - draw), at_hip, down, "body")
            self._wish(side, (first - draw, first), at_ear, up, "body", pole=elbow)
            self._close(side, first - draw - 2, 0.42, within=6)
        else:
            self._wish(side, (-2, -1), at_ear, up, "body", pole=elbow)
            self._curl[side][:] = 0.42
        if last < LAST_FRAME:
            self._lower(side, (last, last + 16))
        thing = phone.phone(f"{self.instance.name}_phone", self.scene.rng(f"{self.instance.name}/phone"))
        self._phone = Carried(thing, side, first - draw)
        self.scene.event(self.instance, "phone", frames)

    def _phone_places(self, side: str, frame: int) -> dict[str, np.ndarray]:
        """Ear and trouser pocket at a frame, less what the plan's body space adds by itself."""
        s, j = SIGN[side], self.body.anatomy.joints
        slide = turn_z(-float(self._heading[frame])) @ np.array([*self._slide[frame], 0.0])
        bend, crouch = float(self._bend[frame]), float(self._crouch[frame])
        back = 0.17 * np.sin(bend) * self._k + 0.12 * crouch
        pelvis = j["root"] + vec(slide[0], back + slide[1], -0.012 * self._k - crouch)
        at, chest = self.puppet.torso(Stance(pelvis=pelvis, bend=bend))["chest"]
        scale = self.body.anatomy.head_scale
        ear = at + chest @ (j["neck"] - j["chest"]) + vec(s * 0.103, -0.010, 0.112) * scale
        added = vec(0.8 * slide[0], 0.0, -0.012 * self._k)
        return {"ear": ear - added, "pocket": pelvis + vec(s * 0.185, -0.06, -0.02) * self._k - added}

    # ---- keys ------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Turns the plan into keys, then moves what is towed and carried."""
        super().finish()
        if self._towed:
            self._key_towed(self._towed, self.played)
        if self._phone:
            self._key_phone(self._phone, self.played)

    def _key_towed(self, towed: Towed, played: Played) -> None:
        case = towed.case
        length = case.grip.z - WHEEL_RADIUS_M
        fists = [grip_points(self, played, f, (towed.side,))[0] for f in range(FRAME_COUNT)]
        heading = float(self._heading[0])
        behind = (turn_z(heading) @ vec(0, 1, 0))[:2]
        axle, rolled, bodies, axles = fists[0][:2] + behind, 0.0, [], []
        for f in range(FRAME_COUNT):
            if f <= towed.parked:
                fist = fists[f]
                reach = float(np.sqrt(max(length**2 - (fist[2] - WHEEL_RADIUS_M) ** 2, 0.0)))
                reach *= float(1.0 - ease((f - towed.parked + 6) / 6))
                way = axle - fist[:2]
                if f < towed.parked - UPRIGHT_FRAMES:
                    behind = way / max(float(np.linalg.norm(way)), 1e-9)
                before, axle = axle, fist[:2] + behind * reach
                tilt = float(np.arcsin(min(reach / length, 1.0)))
                rolled += 0.0 if f == 0 else float((before - axle) @ behind) / WHEEL_RADIUS_M
            yaw = float(np.arctan2(behind[0], -behind[1]))
            foot = Matrix.Translation((*axle, WHEEL_RADIUS_M)) @ Matrix.Rotation(yaw, 4, "Z")
            bodies.append(foot @ Matrix.Rotation(-tilt, 4, "X") @ Matrix.Translation(-case.axle_at))
            axles.append(foot @ Matrix.Rotation(-rolled, 4, "X"))
        keys.key_matrices(case.body, bodies)
        keys.key_matrices(case.axle, axles)
        gap = max(
            float(np.linalg.norm(np.array(bodies[f] @ case.grip) - fists[f])) for f in range(towed.parked + 1)
        )
        if gap > 0.025:
            raise RecipeError(
                f"{self.instance.name}: the fist is {100 * gap:.1f} cm off {towed.instance.name}"
            )

    def _key_phone(self, carried: Carried, played: Played) -> None:
        """Inside the hip while pocketed, then flat in the palm; handed over within three frames."""
        along, palm, _ = self.body.anatomy.hand_frame(carried.side)
        wrist = self.body.anatomy.joints[f"hand_{carried.side}"]
        centre = wrist + self.puppet.hand_scale * (0.088 * along + 0.026 * palm)
        in_hand = Matrix(np.stack([np.cross(-along, palm), -along, palm], axis=1).tolist()).to_4x4()
        in_hand.translation = Vector(centre)
        root = self.body.anatomy.joints["root"]
        in_hip = Matrix.Translation(Vector(root + vec(SIGN[carried.side] * 0.07, 0.0, -0.05) * self._k))
        in_hip = in_hip @ Matrix.Rotation(np.pi / 2, 4, "X") @ Matrix.Rotation(np.pi / 2, 4, "Y")
        matrices = []
        for f in range(FRAME_COUNT):
            world = Matrix(played.world[f])
            hip = world @ Matrix(played.bones[f]["pelvis"]) @ in_hip
            hand = world @ Matrix(played.bones[f][f"hand_{carried.side}"]) @ in_hand
            matrices.append(hip.lerp(hand, float(ease((f - carried.drawn + 3) / 3))))
        keys.key_matrices(carried.thing, matrices)
