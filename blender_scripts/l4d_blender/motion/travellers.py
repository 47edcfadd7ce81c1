"""People on their way: they pull a trolley suitcase and park it, keep a hand on one, telephone, cross a road.

A pulled case hangs on the fist like a trailer: its wheels follow on the ground, so that hand, handle and
pavement agree at every frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..assets import phone as phones
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


# ---- luggage ---------------------------------------------------------------------------------


def pull(person: Person, case: Suitcase, instance: Instance, last: int, *, side: str = "r") -> int:
    """Pulls a tilted trolley case from frame 0 to `last`, then lets it come upright and lets go.

    Returns the frame at which it stands. The walking itself is planned with `walk_along`.
    """
    length = case.grip.z - WHEEL_RADIUS_M
    s, k = SIGN[side], person.k
    aside, behind, height = (c * k for c in _PULL_GRIP)
    slope = float(np.arccos((height - WHEEL_RADIUS_M) / length))
    up = ease((ROWS - last) / UPRIGHT_FRAMES)
    tilt = slope * (1.0 - up)
    fist = np.stack(
        [np.full(FRAME_COUNT, s * aside), behind + 0.03 * up, WHEEL_RADIUS_M + length * np.cos(tilt)], axis=1
    )
    turned = person.puppet.hand_rotation(side, vec(0.0, 0.30, -0.95), vec(0.0, 0.95, 0.30))
    wrist = fist - person.puppet.grip_offset(side, turned)
    person.wish(side, (-2, -1), wrist, turned, "body", pole=vec(0.30 * s, 1.0, -0.6))
    person.curl[side][:] = 0.86
    parked = last + UPRIGHT_FRAMES
    person.close_hand(side, parked + 1, 0.12, within=8)
    person.close_hand(side, parked + 14, 0.28)
    person.lower_arm(side, (parked + 3, parked + 19))
    person.late.append(partial(_key_towed, person, case, instance, side, parked))
    person.scene.event(person.instance, "pull", (0, last), instance)
    person.scene.event(person.instance, "hold", (0, parked), instance)
    person.scene.event(instance, "roll", (0, last))
    return parked


def hand_on(
    person: Person, instance: Instance, grip: Sequence[float], last: int, *, side: str, bar: Sequence[float]
) -> None:
    """Holds the handle of something that stands by, from frame 0 to `last`, then lets the arm sink.

    `grip` is a point in the world, `bar` the direction of the handle there.
    """
    turned = person.grip_rotation(side, 0, np.array(bar, float), False)
    wrist = np.array(grip, float) - person.puppet.grip_offset(side, turned)
    pole = turn_z(float(person.heading[0])) @ vec(0.9 * SIGN[side], 0.6, -0.3)
    person.wish(side, (-2, -1), wrist, turned, "world", pole=pole)
    person.curl[side][:] = 0.86
    person.close_hand(side, last + 1, 0.15, within=6)
    person.lower_arm(side, (last + 3, last + 18))
    person.scene.event(person.instance, "hold", (0, last), instance)


# ---- in the street ---------------------------------------------------------------------------


def cross(
    person: Person, points: Sequence[Sequence[float]], frames: Frames, *, before: Instance, passing: Frames
) -> None:
    """Walks over a road; `passing` is when this leads past the front of the car `before`."""
    person.walk_along(points, frames)
    person.look_at(before, (frames[0] - 12, passing[1]))
    person.scene.event(person.instance, "pass", passing, before)


# ---- telephone -------------------------------------------------------------------------------


def phone(person: Person, frames: Frames, *, side: str = "r", draw: int = 14) -> None:
    """Draws a phone from the pocket within `draw` frames and holds it to the ear until the interval ends.

    The recorded interval begins where the phone reaches the ear (from frame 0 on it is there already);
    later it stays in the hanging hand.
    """
    first, last = frames
    hip, ear = _phone_places(person, side, first), _phone_places(person, side, last)
    s = SIGN[side]
    down = person.puppet.hand_rotation(side, vec(0.15 * s, -0.2, -1.0), vec(-s, 0.15, 0.0))
    up = person.puppet.hand_rotation(side, vec(-0.15 * s, 0.72, 0.68), vec(-s, -0.15, 0.10))
    at_hip = hip["pocket"] - person.puppet.palm_offset(side, down)
    at_ear = ear["ear"] - person.puppet.palm_offset(side, up)
    elbow = vec(0.40 * s, -0.20, -1.0)
    if first > 0:
        person.wish(side, (first - 2 * draw, first - draw), at_hip, down, "body")
        person.wish(side, (first - draw, first), at_ear, up, "body", pole=elbow)
        person.close_hand(side, first - draw - 2, 0.42, within=6)
    else:
        person.wish(side, (-2, -1), at_ear, up, "body", pole=elbow)
        person.curl[side][:] = 0.42
    if last < LAST_FRAME:
        person.lower_arm(side, (last, last + 16))
    thing = phones.phone(f"{person.instance.name}_phone", person.scene.rng(f"{person.instance.name}/phone"))
    person.late.append(partial(_key_phone, person, thing, side, first - draw))
    person.scene.event(person.instance, "phone", frames)


def _phone_places(person: Person, side: str, frame: int) -> dict[str, np.ndarray]:
    """Ear and trouser pocket at a frame, less what the plan's body space adds by itself."""
    s, j = SIGN[side], person.body.anatomy.joints
    slide = turn_z(-float(person.heading[frame])) @ np.array([*person.slide[frame], 0.0])
    bend, crouch = float(person.bend[frame]), float(person.crouch[frame])
    back = 0.17 * np.sin(bend) * person.k + 0.12 * crouch
    pelvis = j["root"] + vec(slide[0], back + slide[1], -0.012 * person.k - crouch)
    at, chest = person.puppet.torso(Stance(pelvis=pelvis, bend=bend))["chest"]
    scale = person.body.anatomy.head_scale
    ear = at + chest @ (j["neck"] - j["chest"]) + vec(s * 0.103, -0.010, 0.112) * scale
    added = vec(0.8 * slide[0], 0.0, -0.012 * person.k)
    return {"ear": ear - added, "pocket": pelvis + vec(s * 0.185, -0.06, -0.02) * person.k - added}


# ---- keys ------------------------------------------------------------------------------------


def _key_towed(
    person: Person, case: Suitcase, instance: Instance, side: str, parked: int, played: Played
) -> None:
    """Trails a case behind a fist from frame 0 until it stands at `parked`."""
    length = case.grip.z - WHEEL_RADIUS_M
    fists = [grip_points(person, played, f, (side,))[0] for f in range(FRAME_COUNT)]
    heading = float(person.heading[0])
    behind = (turn_z(heading) @ vec(0, 1, 0))[:2]
    axle, rolled, bodies, axles = fists[0][:2] + behind, 0.0, [], []
    for f in range(FRAME_COUNT):
        if f <= parked:
            fist = fists[f]
            reach = float(np.sqrt(max(length**2 - (fist[2] - WHEEL_RADIUS_M) ** 2, 0.0)))
            reach *= float(1.0 - ease((f - parked + 6) / 6))
            way = axle - fist[:2]
            if f < parked - UPRIGHT_FRAMES:
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
    gap = max(float(np.linalg.norm(np.array(bodies[f] @ case.grip) - fists[f])) for f in range(parked + 1))
    if gap > 0.025:
        raise RecipeError(f"{person.instance.name}: the fist is {100 * gap:.1f} cm off {instance.name}")


def _key_phone(person: Person, thing: bpy.types.Object, side: str, drawn: int, played: Played) -> None:
    """Inside the hip while pocketed, then flat in the palm; handed over within three frames."""
    along, palm, _ = person.body.anatomy.hand_frame(side)
    wrist = person.body.anatomy.joints[f"hand_{side}"]
    centre = wrist + person.puppet.hand_scale * (0.088 * along + 0.026 * palm)
    in_hand = Matrix(np.stack([np.cross(-along, palm), -along, palm], axis=1).tolist()).to_4x4()
    in_hand.translation = Vector(centre)
    root = person.body.anatomy.joints["root"]
    in_hip = Matrix.Translation(Vector(root + vec(SIGN[side] * 0.07, 0.0, -0.05) * person.k))
    in_hip = in_hip @ Matrix.Rotation(np.pi / 2, 4, "X") @ Matrix.Rotation(np.pi / 2, 4, "Y")
    matrices = []
    for f in range(FRAME_COUNT):
        world = Matrix(played.world[f])
        hip = world @ Matrix(played.bones[f]["pelvis"]) @ in_hip
        hand = world @ Matrix(played.bones[f][f"hand_{side}"]) @ in_hand
        matrices.append(hip.lerp(hand, float(ease((f - drawn + 3) / 3))))
    keys.key_matrices(thing, matrices)
