"""Who will be seen, guessed from a plan: things as upright cylinders, cameras as they are.

Spares draws that would be thrown away for hidden or tiny objects; `visibility` measures what counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..scene.cameras import Camera
from ..scene.timeline import PROFILES
from ..worker.visibility import GATE_PIXELS, GATE_SHARE
from .areas import Flat

_SURE = 1.45  # so many times the pixels that the gate wants
_SHARE_OF_CAMERAS = 0.55
_ACROSS = np.array([-0.7, 0.0, 0.7, -0.7, 0.0, 0.7])
_UP = np.array([0.25, 0.25, 0.25, 0.8, 0.8, 0.8])


@dataclass(frozen=True)
class Bulk:
    """Something at a moment: as wide as it looks from its narrow side, on a floor at `floor_m`."""

    at: Flat
    half_width_m: float
    height_m: float
    floor_m: float = 0.0


def hidden(
    rig: Sequence[Camera], moments: Sequence[Sequence[Bulk]], others: Sequence[Bulk] = ()
) -> list[int]:
    """Indices of the things that too few cameras see well; empty if also one inner camera sees all of them.

    `moments` lists the same things at several times; `others` only stand in the way.
    """
    seen = np.array([_pixels(rig, things, others) for things in moments]) >= _SURE * GATE_PIXELS
    often = seen.mean(axis=0) >= GATE_SHARE
    rare = np.nonzero(seen.mean(axis=(0, 1)) < _SHARE_OF_CAMERAS)[0].tolist()
    if rare:
        return rare
    inner = often[1:-1]
    best = int(np.argmax(inner.sum(axis=1)))
    return np.nonzero(~inner[best])[0].tolist()


def _pixels(rig: Sequence[Camera], things: Sequence[Bulk], others: Sequence[Bulk]) -> np.ndarray:
    """Pixels by camera and thing at the size of the small profile."""
    width, height = PROFILES["small"].width, PROFILES["small"].height
    everything = [*things, *others]
    at = np.array([thing.at for thing in everything])
    radius = np.array([thing.half_width_m for thing in everything])
    tall = np.array([thing.height_m for thing in everything])
    floor = np.array([thing.floor_m for thing in everything])
    count = len(things)
    result = np.zeros((len(rig), count))
    for c, camera in enumerate(rig):
        pose = np.array(camera.world_from_camera)
        eye, focal = pose[:3, 3], camera.focal_over_width * width
        to = at[:count] - eye[:2]
        flat = np.linalg.norm(to, axis=1)
        side = np.stack([-to[:, 1], to[:, 0]], axis=1) / flat[:, None]
        points = np.empty((count, len(_UP), 3))
        offset = (_ACROSS[None, :] * radius[:count, None])[..., None]
        points[..., :2] = at[:count, None] + offset * side[:, None]
        points[..., 2] = floor[:count, None] + _UP[None, :] * tall[:count, None]
        local = (points - eye) @ pose[:3, :3]
        inside = (np.abs(local[..., 0]) * focal < 0.49 * width * local[..., 2]) & (
            np.abs(local[..., 1]) * focal < 0.49 * height * local[..., 2]
        )
        way = points[..., :2] - eye[:2]
        to_other = at - eye[:2]
        along = np.einsum("kpi,oi->kpo", way, to_other) / np.square(way).sum(axis=-1)[..., None]
        along = np.clip(along, 0.0, 1.0)
        gap = np.linalg.norm(along[..., None] * way[:, :, None] - to_other, axis=-1)
        ray = eye[2] + along * (points[..., 2] - eye[2])[..., None]
        blocked = (gap < 0.9 * radius) & (ray < floor + tall) & (ray > floor)
        blocked[np.arange(count), :, np.arange(count)] = False
        open_share = (inside & ~blocked.any(axis=-1)).mean(axis=1)
        distance = np.linalg.norm(np.append(to, (floor + 0.5 * tall)[:count, None] - eye[2], axis=1), axis=1)
        area = 0.8 * 2.0 * radius[:count] * np.maximum(tall, 1.4 * radius)[:count]
        result[c] = open_share * area * (focal / distance) ** 2
    return result
