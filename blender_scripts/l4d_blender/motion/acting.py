"""From a person's plan to keys: balance, arm swing, breathing, gaze, then one matrix per bone and frame.

Reads the tracks that people.py planned; also moves what hands hold and measures how well that
fits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import SIDES, vec
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FPS, FRAME_COUNT
from .ik import between, ease, smooth, turn_z
from .puppet import Foot, Reach, Stance

if TYPE_CHECKING:
    from .people import Person
    from .plan_person import Held, Wish

ROWS = np.arange(FRAME_COUNT)
SIGN = dict(SIDES)


@dataclass
class Played:
    """What was keyed: body to world and bone deformations per frame, kept for checks."""

    world: list[np.ndarray]
    bones: list[dict[str, np.ndarray]]


def bake_person(person: Person) -> Played:
    """Keys rig, bones and held things at all canonical frames."""
    stances = _stances(person)
    world = [_frame(person, f) for f in range(FRAME_COUNT)]
    _reach(person, stances, world)
    bones = [person.puppet.pose(stance) for stance in stances]
    rig = person.body.rig
    rest = {bone.name: np.array(bone.matrix_local) for bone in rig.data.bones}
    keys.key_matrices(rig, [Matrix(m) for m in world])
    keys.key_bones(
        rig, [{name: Matrix(m @ rest[name]) for name, m in pose.items()} for pose in bones], space="armature"
    )
    played = Played(world, bones)
    for held in person.held:
        _move_held(person, held, played)
    return played


def _frame(person: Person, f: int) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = turn_z(float(person.heading[f]))
    matrix[:3, 3] = (*person.xy[f], person.ground_m)
    return matrix


# ---- torso and legs ------------------------------------------------------------------------------


def _stances(person: Person) -> list[Stance]:
    k, feet, root = person.k, person.feet, person.body.anatomy.joints["root"]
    local = {s: _local(person, feet.ankle[s]) for s, _ in SIDES}
    ahead = smooth(-(local["l"][:, 1] - local["r"][:, 1]) / (0.62 * k), 1.0)
    loads = {s: smooth(feet.planted[s].astype(float), 2.2) for s, _ in SIDES}
    still = smooth((feet.planted["l"] & feet.planted["r"]).astype(float), 5.0)
    t = ROWS / FPS
    drift = 0.011 * np.sin(2 * np.pi * 0.21 * t + person.phase) * still
    sway = (0.030 * (loads["l"] - loads["r"]) + drift) * k
    middle = smooth(0.5 * (local["l"][:, 0] + local["r"][:, 0]), 3.0)
    back = 0.17 * np.sin(person.bend) * k + 0.12 * person.crouch
    slide = np.einsum("fij,fj->fi", np.stack([turn_z(-h)[:2, :2] for h in person.heading]), person.slide)
    stances = []
    for f in range(FRAME_COUNT):
        pelvis = root + vec(
            sway[f] + 0.6 * middle[f] + slide[f, 0], back[f] + slide[f, 1], -0.012 * k - person.crouch[f]
        )
        stances.append(
            Stance(
                pelvis=pelvis,
                pelvis_yaw=-0.13 * ahead[f],
                bend=float(person.bend[f]) + 0.035 * abs(ahead[f]),
                pelvis_roll=float(-0.05 * (loads["l"][f] - loads["r"][f])),
                twist=float(person.twist[f]) + 0.16 * ahead[f],
                side_bend=float(person.lean[f]),
                breath=0.016 * np.sin(2 * np.pi * 0.27 * t[f] + 2 * person.phase),
            )
        )
    _lower_pelvis(person, stances, local)
    for f, stance in enumerate(stances):
        for s, _ in SIDES:
            stance.feet[s] = Foot(
                local[s][f],
                float(feet.yaw[s][f] - person.heading[f]),
                float(feet.pitch[s][f]),
                float(feet.toe[s][f]),
            )
        stance.gaze = _gaze(person, stance, f)
    return stances


def _lower_pelvis(person: Person, stances: list[Stance], ankles: dict[str, np.ndarray]) -> None:
    """Sinks the pelvis smoothly to where both legs reach their feet."""
    wanted = np.array([stance.pelvis[2] for stance in stances])
    bound = np.full(FRAME_COUNT, 1e3)
    for f, stance in enumerate(stances):
        for s, _ in SIDES:
            hip = person.puppet.hip(stance, s)
            flat = np.hypot(*(ankles[s][f] - hip)[:2])
            reach = 0.994 * sum(person.puppet.leg[s])
            top = ankles[s][f, 2] + np.sqrt(max(reach**2 - flat**2, 0.0))
            bound[f] = min(bound[f], top - (hip[2] - stance.pelvis[2]))
    low = np.minimum(wanted, bound)
    around = np.min([np.roll(np.pad(low, 3, mode="edge"), n)[3:-3] for n in (-1, 0, 1)], axis=0)
    height = np.minimum(smooth(around, 1.3), bound)
    for stance, z in zip(stances, height):
        stance.pelvis = np.array([stance.pelvis[0], stance.pelvis[1], z])


def _local(person: Person, points: np.ndarray) -> np.ndarray:
    """World points (one per frame) in the body's space."""
    shifted = points - np.column_stack([person.xy, np.full(FRAME_COUNT, 0.0)])
    return np.stack([turn_z(-float(person.heading[f])) @ shifted[f] for f in range(FRAME_COUNT)])


def _gaze(person: Person, stance: Stance, f: int) -> tuple[float, float]:
    t = f / FPS
    yaw = 0.05 * np.sin(2 * np.pi * 0.17 * t + person.phase) + 0.03 * np.sin(2 * np.pi * 0.31 * t)
    pitch = 0.02 * np.sin(2 * np.pi * 0.23 * t + person.phase) + 0.30 * stance.bend
    eyes = person.puppet.torso(stance)["chest"][0] + vec(0, -0.06, 0.40) * person.k
    for weight, target in person.gazes:
        goal = target.matrix(f).translation if isinstance(target, Instance) else target
        way = (
            turn_z(-float(person.heading[f])) @ (np.array(goal) - np.array([*person.xy[f], person.ground_m]))
            - eyes
        )
        limit = np.clip(np.arctan2(way[0], -way[1]), -1.15, 1.15)
        look = (limit, np.clip(np.arctan2(-way[2], np.hypot(way[0], way[1])), -0.6, 0.95))
        w = float(np.broadcast_to(weight, FRAME_COUNT)[f])
        yaw, pitch = yaw + (look[0] - yaw) * w, pitch + (look[1] - pitch) * w
    return float(yaw), float(pitch)


# ---- arms ----------------------------------------------------------------------------------------


def _reach(person: Person, stances: list[Stance], world: list[np.ndarray]) -> None:
    """Blends hanging arms with every wish, in the body's space."""
    k, puppet, feet = person.k, person.puppet, person.feet
    local = {s: _local(person, feet.ankle[s]) for s, _ in SIDES}
    ahead = smooth(-(local["l"][:, 1] - local["r"][:, 1]) / (0.62 * k), 2.0)
    walk_pelvis = np.array([stance.pelvis for stance in stances]) - puppet.joints["root"]
    bob = walk_pelvis * np.array([0.8, 0.0, 1.0]) + person.crouch[:, None] * vec(0, 0, 1)
    apart = 0.21 if person.body.skirt else 0.12
    for side, s in SIDES:
        for f, stance in enumerate(stances):
            wrist, rotation, pole = _hanging(puppet, stance, side, -s * 0.34 * float(ahead[f]), apart)
            still = (wrist, rotation)
            for wish in person.wishes[side]:
                w = float(wish.weight[f])
                if w <= 0.0:
                    continue
                goal, turned = _goal(wish, f, world[f], still, bob[f])
                wrist = wrist + (goal - wrist) * w
                rotation = between(rotation, turned, w)
                aim = _default_pole(puppet, stance, s) if wish.pole is None else wish.pole
                pole = pole + (aim - pole) * w
            stance.hands[side] = Reach(
                wrist,
                rotation,
                float(person.curl[side][f]),
                float(person.curl[side][f] * (1 - 0.95 * person.pointing[side][f])),
                pole,
            )


def _goal(
    wish: Wish, f: int, world: np.ndarray, still: tuple[np.ndarray, np.ndarray], bob: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    if wish.space == "hang":
        return still
    if wish.space == "world":
        back = world[:3, :3].T
        return back @ (wish.wrist[f] - world[:3, 3]), back @ wish.rotation_at(f)
    return wish.wrist[f] + bob, wish.rotation_at(f)


def _default_pole(puppet, stance: Stance, s: float) -> np.ndarray:
    return puppet.torso(stance)["chest"][1] @ vec(s * 0.55, 0.75, -0.55)


def _hanging(
    puppet, stance: Stance, side: str, swing: float, apart: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Wrist, hand and elbow of an arm that hangs and swings."""
    s, (upper, lower) = SIGN[side], puppet.arm[side]
    facing = turn_z(0.6 * stance.twist)
    shoulder = puppet.shoulder(stance, side)

    def way(forward: float, out: float) -> np.ndarray:
        return facing @ vec(s * np.sin(out), -np.sin(forward) * np.cos(out), -np.cos(forward) * np.cos(out))

    flexed = 0.20 + 0.45 * max(swing, 0.0)
    first, second = way(swing - 0.06, apart), way(swing + flexed, 0.45 * apart)
    wrist = shoulder + upper * first + lower * second
    pole = shoulder + upper * first - 0.5 * (shoulder + wrist)
    rotation = puppet.hand_rotation(side, second + 0.25 * way(swing + 0.9, 0.0), facing @ vec(-s, 0.35, 0))
    return wrist, rotation, pole / max(float(np.linalg.norm(pole)), 1e-6)


# ---- held things ---------------------------------------------------------------------------------


def grip_points(person: Person, played: Played, f: int, sides: tuple[str, ...]) -> list[np.ndarray]:
    """World positions of the middle of each fist."""
    points = []
    for side in sides:
        along, palm, _ = person.body.anatomy.hand_frame(side)
        rest = person.body.anatomy.joints[f"hand_{side}"] + person.puppet.hand_scale * (
            0.094 * along + 0.024 * palm
        )
        points.append((played.world[f] @ played.bones[f][f"hand_{side}"] @ np.append(rest, 1.0))[:3])
    return points


def _yaw(person: Person, played: Played, f: int, sides: tuple[str, ...]) -> float:
    """Heading of what the hands hold: the line between two fists, or the thumb side of one."""
    if len(sides) == 2:
        a, b = grip_points(person, played, f, sides)
        return float(np.arctan2(b[1] - a[1], b[0] - a[0]))
    hand = (played.world[f] @ played.bones[f][f"hand_{sides[0]}"])[:3, :3]
    _, _, thumb = person.body.anatomy.hand_frame(sides[0])
    way = hand @ thumb
    return float(np.arctan2(way[1], way[0]))


def _move_held(person: Person, held: Held, played: Played) -> None:
    """Keys the held thing: still before, rigid under the fist while held, still again after."""
    last = FRAME_COUNT - 1 if held.last is None else held.last
    start_yaw = _yaw(person, played, held.first, held.sides)
    anchor = np.mean(grip_points(person, played, held.first, held.sides), axis=0)
    rest_grip = np.mean(held.grips, axis=0)
    if held.from_start:
        anchor = rest_grip
        start_yaw = held.bar_yaw if held.bar_yaw is not None else start_yaw - float(person.heading[0])
    yaws = np.unwrap([_yaw(person, played, f, held.sides) for f in range(FRAME_COUNT)]) - start_yaw
    yaws -= 2 * np.pi * np.round(yaws[held.first] / (2 * np.pi))
    moves = []
    for f in range(FRAME_COUNT):
        g = min(max(f, held.first), last)
        now = np.mean(grip_points(person, played, g, held.sides), axis=0)
        moves.append(
            Matrix.Translation(now) @ Matrix.Rotation(float(yaws[g]), 4, "Z") @ Matrix.Translation(-anchor)
        )
    if held.goal is not None:
        missing = np.array(held.goal.translation) - np.array((moves[last] @ held.rest_at).translation)
        moves = [
            Matrix.Translation(missing * float(ease((f - last + 12) / 12))) @ m for f, m in enumerate(moves)
        ]
    for obj in held.instance.objects:
        if obj.parent is None:
            before = [keys.object_matrix(obj, f) for f in range(FRAME_COUNT)]
            rest = before[held.first] if held.again is None else held.again[obj.name]
            matrices = [before[f] if f < held.first else moves[f] @ rest for f in range(FRAME_COUNT)]
            keys.key_matrices(obj, matrices)


# ---- proof ---------------------------------------------------------------------------------------


def foot_slide(person: Person, played: Played) -> float:
    """Largest distance in metres that the resting part of a planted foot moves in one stand."""
    worst, feet = 0.0, person.feet
    for side, _ in SIDES:
        j, sole = person.body.anatomy.joints, feet.soles[side]
        ground = j[f"foot_{side}"] - sole.ankle
        pivot_of = {True: ground + sole.ball, False: ground + sole.heel}
        for on_ball in (True, False):
            start = None
            for f in range(FRAME_COUNT):
                rests = feet.planted[side][f] and (
                    feet.pitch[side][f] >= -1e-6 if on_ball else feet.pitch[side][f] <= 1e-6
                )
                if not rests:
                    start = None
                    continue
                at = (played.world[f] @ played.bones[f][f"foot_{side}"] @ np.append(pivot_of[on_ball], 1.0))[
                    :3
                ]
                start = at if start is None else start
                worst = max(worst, float(np.linalg.norm(at - start)))
    return worst


def grip_gap(person: Person, played: Played) -> float:
    """Largest distance in metres between a fist's middle and the point that it holds."""
    worst = 0.0
    for held in person.held:
        carrier = held.instance.frame_object
        last = FRAME_COUNT - 1 if held.last is None else held.last
        at_rest = np.linalg.inv(np.array(held.rest_at))
        local = [(at_rest @ np.append(g, 1.0)) for g in held.grips]
        for f in range(held.first, last + 1):
            matrix = np.array(keys.object_matrix(carrier, f))
            for g, fist in zip(local, grip_points(person, played, f, held.sides)):
                worst = max(worst, float(np.linalg.norm((matrix @ g)[:3] - fist)))
    return worst


def check(person: Person, played: Played) -> None:
    """Refuses motion in which a planted foot slides or a hand floats off what it holds (2 cm)."""
    slide, gap = foot_slide(person, played), grip_gap(person, played)
    if slide > 0.02:
        raise RecipeError(
            f"{person.instance.name}: a planted foot slides {100 * slide:.1f} cm",
            "give the walk more frames or a gentler turn, or step before the body moves on",
        )
    if gap > 0.02:
        raise RecipeError(
            f"{person.instance.name}: a hand is {100 * gap:.1f} cm off its grip",
            "stand closer, or key nobody else's motion on the held thing",
        )
