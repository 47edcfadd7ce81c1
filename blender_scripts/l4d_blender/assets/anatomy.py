"""The human body in numbers: joints, flesh and skin weights of a standing figure in the rest pose.

Rest pose: facing -Y, arms straight and 57 degrees down, palms facing in, feet on z = 0. Owns proportions;
refuses to know meshes, clothes, Blender or motion. Metres.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .implicit import Blob, Cone, Ellipsoid, Stack, blended, smoothstep

SIDES = (("l", 1.0), ("r", -1.0))
FINGERS = ("index", "middle", "ring", "pinky")
CHIN_M = 1.473
HEAD_M = 0.227
ARM_SLOPE = np.radians(57.0)


def vec(x: float, y: float, z: float) -> np.ndarray:
    """A point or direction as an array."""
    return np.array([x, y, z], float)


@dataclass(frozen=True)
class Build:
    """Proportions of one kind of person; widths are factors on the reference woman of 1.70 m."""

    heads: float
    shoulder: float
    waist: float
    hips: float
    limbs: float
    bust_m: float
    arms: float = 1.0
    jaw: float = 1.0


BUILDS = {
    "woman": Build(heads=7.3, shoulder=1.0, waist=1.0, hips=1.0, limbs=1.0, bust_m=0.052),
    "man": Build(heads=7.5, shoulder=1.10, waist=1.20, hips=0.97, limbs=1.10, bust_m=0.0, arms=1.03, jaw=1.1),
    "child": Build(heads=6.2, shoulder=0.93, waist=1.16, hips=0.93, limbs=1.04, bust_m=0.0, arms=0.95),
}


@dataclass(frozen=True)
class Bone:
    """A bone at rest: joints in metres and its parent."""

    name: str
    head: np.ndarray
    tail: np.ndarray
    parent: str | None


class Anatomy:
    """Joints, bones and flesh of one person."""

    def __init__(self, build: str, height_m: float, girth: float = 1.0) -> None:
        self.build = BUILDS[build]
        self.height_m = height_m
        head = height_m / self.build.heads
        self.head_scale = head / HEAD_M
        self.scale = (height_m - head) / CHIN_M
        self.girth = girth
        self.joints = self._joints()
        self.bones = self._bones()
        self.torso, self.arms, self.legs = self._trunk(), self._limbs("arm"), self._limbs("leg")

    # ---- joints and bones ------------------------------------------------------------------------

    def _joints(self) -> dict[str, np.ndarray]:
        b = self.build
        joints = {
            "root": vec(0, 0.01, 0.925),
            "spine": vec(0, 0.015, 1.03),
            "chest": vec(0, 0.02, 1.17),
            "neck": vec(0, 0.02, 1.415),
            "head": vec(0, 0.005, CHIN_M + 0.045),
        }
        for side, s in SIDES:
            shoulder = vec(s * 0.150 * b.shoulder, 0.02, 1.360)
            along = vec(s * np.cos(ARM_SLOPE), 0, -np.sin(ARM_SLOPE))
            elbow = shoulder + 0.278 * b.arms * along
            wrist = elbow + 0.243 * b.arms * along
            joints |= {
                f"clavicle_{side}": vec(s * 0.02, 0.005, 1.395),
                f"upper_arm_{side}": shoulder,
                f"forearm_{side}": elbow,
                f"hand_{side}": wrist,
                f"thigh_{side}": vec(s * 0.083, 0.01, 0.895),
                f"calf_{side}": vec(s * 0.084, 0.0, 0.485),
                f"foot_{side}": vec(s * 0.082, 0.022, 0.082),
                f"toe_{side}": vec(s * 0.086, -0.098, 0.022),
                f"toe_tip_{side}": vec(s * 0.088, -0.165, 0.018),
            }
        joints = {name: p * self.scale for name, p in joints.items()}
        for side, s in SIDES:
            joints |= self._hand_joints(side, s, joints[f"hand_{side}"])
        joints["crown"] = vec(0, 0, self.height_m)
        return joints

    def hand_frame(self, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Unit axes of the rest hand: along the fingers, out of the palm, towards the thumb."""
        s = 1.0 if side == "l" else -1.0
        c, d = np.cos(ARM_SLOPE), np.sin(ARM_SLOPE)
        return vec(s * c, 0, -d), vec(-s * d, 0, -c), vec(0, -1, 0)

    def _hand_joints(self, side: str, s: float, wrist: np.ndarray) -> dict[str, np.ndarray]:
        along, palm, thumb = self.hand_frame(side)
        k = 0.98 * self.scale
        at = {}
        spread = {"index": 0.028, "middle": 0.0092, "ring": -0.0096, "pinky": -0.027}
        length = {"index": 0.076, "middle": 0.084, "ring": 0.078, "pinky": 0.060}
        for finger in FINGERS:
            base = wrist + k * ((0.088 - 0.18 * abs(spread[finger] - 0.005)) * along + spread[finger] * thumb)
            way = along + 0.5 * spread[finger] / 0.028 * 0.16 * thumb + 0.12 * palm
            way /= np.linalg.norm(way)
            at[f"{finger}_1_{side}"] = base
            at[f"{finger}_2_{side}"] = base + k * 0.48 * length[finger] * way
            at[f"{finger}_tip_{side}"] = base + k * length[finger] * way
        base = wrist + k * (0.024 * along + 0.022 * thumb + 0.008 * palm)
        way = 0.72 * along + 0.62 * thumb + 0.32 * palm
        way /= np.linalg.norm(way)
        at |= {
            f"thumb_1_{side}": base,
            f"thumb_2_{side}": base + k * 0.045 * way,
            f"thumb_tip_{side}": base + k * 0.078 * (way + 0.12 * along),
        }
        return at

    def _bones(self) -> list[Bone]:
        j = self.joints
        bones = [
            Bone("pelvis", j["root"], j["spine"], None),
            Bone("spine", j["spine"], j["chest"], "pelvis"),
            Bone("chest", j["chest"], j["neck"], "spine"),
            Bone("neck", j["neck"], j["head"], "chest"),
            Bone("head", j["head"], j["crown"], "neck"),
        ]

        def add(name: str, side: str, tail: str, parent: str, head: str | None = None) -> None:
            bones.append(Bone(f"{name}_{side}", j[f"{head or name}_{side}"], j[f"{tail}_{side}"], parent))

        for side, _ in SIDES:
            add("clavicle", side, "upper_arm", "chest")
            add("shoulder", side, "forearm", f"clavicle_{side}", head="upper_arm")
            add("upper_arm", side, "forearm", f"clavicle_{side}")
            add("elbow", side, "hand", f"upper_arm_{side}", head="forearm")
            add("forearm", side, "hand", f"upper_arm_{side}")
            add("wrist", side, "hand", f"forearm_{side}", head="forearm")
            add("hand", side, "middle_1", f"forearm_{side}")
            for finger in (*FINGERS, "thumb"):
                add(f"{finger}_1", side, f"{finger}_2", f"hand_{side}")
                add(f"{finger}_2", side, f"{finger}_tip", f"{finger}_1_{side}")
            add("hip", side, "calf", "pelvis", head="thigh")
            add("thigh", side, "calf", "pelvis")
            add("knee", side, "foot", f"thigh_{side}", head="calf")
            add("calf", side, "foot", f"thigh_{side}")
            add("foot", side, "toe", f"calf_{side}")
            add("toe", side, "toe_tip", f"foot_{side}")
        return bones

    # ---- flesh -----------------------------------------------------------------------------------

    def _trunk(self) -> list[Blob]:
        b, k, g = self.build, self.scale, self.girth
        heights = np.array([0.80, 0.86, 0.93, 1.00, 1.06, 1.14, 1.23, 1.31, 1.37, 1.405, 1.43])
        wide = np.array([0.120, 0.160, 0.158, 0.138, 0.122, 0.126, 0.137, 0.142, 0.140, 0.105, 0.062])
        deep = np.array([0.080, 0.108, 0.106, 0.096, 0.088, 0.092, 0.102, 0.098, 0.078, 0.066, 0.054])
        shift = np.array([0.015, 0.012, 0.008, 0.004, 0.0, 0.002, 0.006, 0.012, 0.018, 0.020, 0.020])
        blend = smoothstep(0.92, 1.06, heights) - smoothstep(1.10, 1.22, heights)
        upper = smoothstep(1.12, 1.28, heights)
        factor = (b.hips * (1 - blend) + b.waist * blend) * (1 - upper) + b.shoulder * upper
        stout = 1.0 + (g - 1.0) * (1.15 - 0.5 * upper)
        deep = deep * (1.0 + 0.5 * (factor - 1.0)) * stout * (1.0 + 0.06 * (b.bust_m == 0.0))
        blobs: list[Blob] = [Stack(heights * k, wide * factor * stout * k, deep * k, shift * k, blend=0.03)]
        neck, head = self.joints["neck"], self.joints["head"]
        thick = 0.050 * (0.75 + 0.25 * b.limbs + 0.25 * (b.limbs - 1.0)) * k
        blobs.append(
            Cone(neck - vec(0, 0, 0.04), head + vec(0, 0.004, 0.03), thick * 1.16, thick, blend=0.035)
        )
        for _, s in SIDES:
            trapezius = self.joints["neck"] + vec(s * 0.11, 0.006, -0.036) * k
            blobs.append(
                Cone(neck + vec(s * 0.03, 0.004, 0.012) * k, trapezius, 0.030 * k, 0.030 * k, blend=0.04)
            )
            blobs.append(
                Ellipsoid(vec(s * 0.072, 0.062, 0.872) * k, vec(0.078, 0.070, 0.082) * k * g, blend=0.04)
            )
            if b.bust_m:
                blobs.append(
                    Ellipsoid(
                        vec(s * 0.062, -0.070, 1.235) * k,
                        vec(1.12, 0.96, 1.05) * b.bust_m * k * g,
                        blend=0.045,
                    )
                )
        return blobs

    def _limbs(self, kind: str) -> dict[str, list[Blob]]:
        j, r = self.joints, self.build.limbs * self.scale * (1.0 + 0.7 * (self.girth - 1.0))
        limbs: dict[str, list[Blob]] = {}
        for side, s in SIDES:
            if kind == "arm":
                a, e, w = j[f"upper_arm_{side}"], j[f"forearm_{side}"], j[f"hand_{side}"]
                along = (e - a) / np.linalg.norm(e - a)
                limbs[side] = [
                    Cone(a + 0.006 * along, e, 0.0465 * r, 0.0385 * r, blend=0.035),
                    Ellipsoid(a + 0.035 * along, vec(0.048, 0.051, 0.055) * r, blend=0.03),
                    Cone(e, w, 0.038 * r, 0.026 * r, blend=0.02),
                    Cone(e + 0.05 * along, e + 0.09 * along, 0.0425 * r, 0.039 * r, blend=0.03),
                ]
            else:
                h, n, f = j[f"thigh_{side}"], j[f"calf_{side}"], j[f"foot_{side}"]
                limbs[side] = [
                    Cone(h + vec(s * 0.004, 0, 0), n, 0.083 * r, 0.052 * r, blend=0.028),
                    Cone(n + vec(0, -0.006, 0), f, 0.049 * r, 0.034 * r, blend=0.02),
                    Ellipsoid(
                        n + vec(0, 0.018, -0.12) * self.scale, vec(0.047, 0.050, 0.115) * r, blend=0.03
                    ),
                ]
        return limbs

    def flesh(self) -> list[Blob]:
        """All blobs of the body below the head; arms first reach their own shape, then join the trunk."""
        return [*self.torso, *self.legs["l"], *self.legs["r"], *self.arms["l"], *self.arms["r"]]

    # ---- skin weights ----------------------------------------------------------------------------

    def along_limb(self, points: np.ndarray, chain: list[str]) -> tuple[np.ndarray, list[float]]:
        """Arc length of the nearest point on a chain of joints, and the arc length of every joint."""
        knots = [self.joints[name] for name in chain]
        start, best, where, stops = 0.0, np.full(len(points), 1e9), np.zeros(len(points)), [0.0]
        for n, (a, b) in enumerate(zip(knots, knots[1:])):
            axis = b - a
            length = float(np.linalg.norm(axis))
            t = (points - a) @ axis / length**2
            low, high = (-1.0 if n == 0 else 0.0), (2.0 if n == len(knots) - 2 else 1.0)
            t = np.clip(t, low, high)
            gap = np.linalg.norm(points - a - t[:, None] * axis, axis=1)
            nearer = gap < best
            best, where = np.where(nearer, gap, best), np.where(nearer, start + t * length, where)
            start += length
            stops.append(start)
        return where, stops

    def body_weights(self, points: np.ndarray, softness_m: float = 0.011) -> dict[str, np.ndarray]:
        """Bone weights of points on or near trunk, arms and legs."""
        k = self.scale
        near = {"trunk": blended(self.torso, points)}
        near |= {f"arm_{side}": blended(self.arms[side], points) for side, _ in SIDES}
        near |= {f"leg_{side}": blended(self.legs[side], points) for side, _ in SIDES}
        hips = smoothstep(0.99 * k, 0.86 * k, points[:, 2])
        for side, s in SIDES:
            near[f"leg_{side}"] = near[f"leg_{side}"] + 0.06 * smoothstep(0.02, -0.03, s * points[:, 0])
            near[f"leg_{side}"] += 0.08 * (1.0 - hips)
        nearest = np.min(list(near.values()), axis=0)
        share = {name: np.exp(-np.clip((d - nearest) / softness_m, 0, 40)) for name, d in near.items()}
        total = np.sum(list(share.values()), axis=0)
        weights = self._trunk_weights(points, share["trunk"] / total)
        for side, _ in SIDES:
            weights |= self._arm_weights(points, side, share[f"arm_{side}"] / total)
            weights |= self._leg_weights(points, side, share[f"leg_{side}"] / total)
        return weights

    def _trunk_weights(self, points: np.ndarray, share: np.ndarray) -> dict[str, np.ndarray]:
        k, z = self.scale, points[:, 2]
        chin = self.joints["head"][2]
        steps = [
            smoothstep(0.95 * k, 1.08 * k, z),
            smoothstep(1.08 * k, 1.22 * k, z),
            smoothstep(1.40 * k, 1.46 * k, z),
            smoothstep(chin - 0.045, chin + 0.015, z),
        ]
        names = ("pelvis", "spine", "chest", "neck", "head")
        weights = dict(zip(names, _partition(steps), strict=True))
        for side, s in SIDES:
            lift = smoothstep(0.05 * k, 0.13 * k, s * points[:, 0]) * smoothstep(1.24 * k, 1.37 * k, z)
            weights[f"clavicle_{side}"] = 0.8 * lift * weights["chest"]
        weights["chest"] = weights["chest"] - weights["clavicle_l"] - weights["clavicle_r"]
        return {name: w * share for name, w in weights.items()}

    def _arm_weights(self, points: np.ndarray, side: str, share: np.ndarray) -> dict[str, np.ndarray]:
        s, stops = self.along_limb(
            points, [f"{n}_{side}" for n in ("upper_arm", "forearm", "hand", "middle_1")]
        )
        elbow, wrist, k = stops[1], stops[2], self.scale
        steps = [
            smoothstep(-0.03 * k, 0.085 * k, s),
            smoothstep(elbow - 0.045 * k, elbow - 0.003 * k, s),
            smoothstep(elbow + 0.003 * k, elbow + 0.045 * k, s),
            smoothstep(elbow + 0.06 * k, wrist - 0.05 * k, s),
            smoothstep(wrist - 0.02 * k, wrist + 0.012 * k, s),
        ]
        names = ("shoulder", "upper_arm", "elbow", "forearm", "wrist", "hand")
        return {f"{n}_{side}": w * share for n, w in zip(names, _partition(steps), strict=True)}

    def _leg_weights(self, points: np.ndarray, side: str, share: np.ndarray) -> dict[str, np.ndarray]:
        s, stops = self.along_limb(points, [f"{n}_{side}" for n in ("thigh", "calf", "foot")])
        knee, ankle, k = stops[1], stops[2], self.scale
        steps = [
            smoothstep(0.01 * k, 0.13 * k, s),
            smoothstep(knee - 0.07 * k, knee - 0.005 * k, s),
            smoothstep(knee + 0.005 * k, knee + 0.07 * k, s),
            smoothstep(ankle - 0.015 * k, ankle + 0.02 * k, s),
        ]
        names = ("hip", "thigh", "knee", "calf", "foot")
        return {f"{n}_{side}": w * share for n, w in zip(names, _partition(steps), strict=True)}


def _partition(steps: list[np.ndarray]) -> list[np.ndarray]:
    """Weights of len(steps)+1 consecutive bones from rising steps: they sum to one everywhere."""
    shares, rest = [], np.ones_like(steps[0])
    for step in steps:
        shares.append(rest * (1.0 - step))
        rest = rest * step
    return [*shares, rest]
