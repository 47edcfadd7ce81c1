"""Pictures with their truth: what was rendered for learning, as arrays of 8 and 16 bits, and drawn training samples.

A folder holds arrangements (`arrangement.json` in each) or built scenes (`frames/<view>/<frame>.exr`, described by
the tracks of a benchmark folder).
"""

from __future__ import annotations

import json
import random
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR
import torch
import torch.nn.functional as F
from torch import Tensor

from .model import OFFSET_PX, Vocabulary

LEAST_PX = 20
"""Pixels (of half resolution) of an object from which something can be learned."""
CENTRE_PX = 3.0


@dataclass(frozen=True)
class Thing:
    """An instance: its noun, whether queries may mean it, its properties."""

    kind: str
    is_object: bool
    attributes: dict[str, str]


@dataclass
class Scene:
    """Pictures of one scene: display colour (n, h, w, 3) and ids (n, h, w)."""

    name: str
    colour: np.ndarray
    ids: np.ndarray
    things: dict[int, Thing]


def read(folder: Path, bench: Path | None = None) -> list[Scene]:
    """All scenes below a folder, by name; those of built scenes are described in `bench`."""
    if bench is not None:
        built = sorted({path.parents[2] for path in folder.glob("*/frames/*/*.exr")})
        return [_built(path, json.loads((bench / "scenes" / f"{path.name}.json").read_text())) for path in built]
    found = [_arrangement(file) for file in sorted(folder.glob("*/arrangement.json"))]
    return [scene for scene in found if scene is not None]


def vocabulary(scenes: Sequence[Scene]) -> Vocabulary:
    """The words of training scenes."""
    things = [thing for scene in scenes for thing in scene.things.values()]
    kinds = sorted({thing.kind for thing in things})
    pairs = {pair for thing in things if thing.is_object for pair in thing.attributes.items()}
    several = {key for key, _ in pairs if len({value for k, value in pairs if k == key}) > 1}
    return Vocabulary(("", *kinds), tuple(sorted(pair for pair in pairs if pair[0] in several)))


def display(linear: np.ndarray, exposure: float) -> np.ndarray:
    """8-bit display colour, as `l4d-frames` makes it."""
    x = np.nan_to_num(linear.astype(np.float32) * exposure).clip(0.0, 1.0)
    y = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    return (y * 255.0 + 0.5).astype(np.uint8)


def _arrangement(file: Path) -> Scene | None:
    content = json.loads(file.read_text(encoding="utf-8"))
    if "rejected" in content:
        return None
    frames = [
        file.parent / "frames" / camera["name"] / f"{content['frame']:04}.exr" for camera in content["cameras"]
    ]
    return _scene(content["name"], frames, content["exposure"], content["instances"])


def _built(folder: Path, tracks: dict) -> Scene:
    frames = sorted(folder.glob("frames/*/*.exr"))
    return _scene(folder.name, frames, tracks["exposure"], tracks["instances"])


def _scene(name: str, frames: Sequence[Path], exposure: float, instances: list[dict]) -> Scene:
    colours, ids = [], []
    for path in frames:
        with OpenEXR.File(str(path), separate_channels=True) as picture:
            channels = {key: channel.pixels for key, channel in picture.channels().items()}
        colours.append(display(np.stack([channels[c] for c in "RGB"], -1), exposure))
        ids.append(channels["id"].astype(np.uint16))
    things = {
        entry["id"]: Thing(entry["category"], entry["role"] == "object", entry["attributes"])
        for entry in instances
    }
    return Scene(name, np.stack(colours), np.stack(ids), things)


@dataclass
class Sample:
    """A training picture (3, H, W) with its targets at half resolution."""

    scene: Scene
    picture: Tensor
    ids: Tensor
    centre: Tensor
    offset: Tensor
    masks: Tensor
    things: list[Thing]


def draw(scenes: Sequence[Scene], rng: random.Random) -> Sample:
    """A drawn picture: scaled, cut, mirrored, blurred as clips of splats are, in other light."""
    scene = rng.choice(scenes)
    number = rng.randrange(len(scene.colour))
    picture = torch.from_numpy(scene.colour[number]).permute(2, 0, 1).float()[None] / 255.0
    ids = torch.from_numpy(scene.ids[number].astype(np.float32))[None, None]
    picture, ids = _zoomed(picture, ids, float(np.exp(rng.uniform(-0.35, 0.45))), rng)
    if rng.random() < 0.5:
        picture, ids = picture.flip(-1), ids.flip(-1)
    if rng.random() < 0.5:
        picture = _blurred(picture, rng.choice((1.3, 1.6, 2.0)))
    picture = picture * rng.uniform(0.75, 1.25) + rng.uniform(-0.06, 0.06)
    grey = picture.mean(1, keepdim=True)
    picture = grey + (picture - grey) * rng.uniform(0.8, 1.2)
    noise = torch.from_numpy(np.random.default_rng(rng.randrange(1 << 30)).standard_normal(picture.shape, np.float32))
    picture = (picture + noise * rng.uniform(0.0, 0.03)).clamp(0.0, 1.0)
    return _targets(scene, picture[0], ids[0, 0].long()[::2, ::2], rng)


def _zoomed(picture: Tensor, ids: Tensor, scale: float, rng: random.Random) -> tuple[Tensor, Tensor]:
    height, width = picture.shape[-2:]
    if scale > 1.0:
        h, w = int(height / scale), int(width / scale)
        top, left = rng.randint(0, height - h), rng.randint(0, width - w)
        picture, ids = (x[..., top : top + h, left : left + w] for x in (picture, ids))
        return _resized(picture, height, width), F.interpolate(ids, (height, width), mode="nearest")
    h, w = int(height * scale), int(width * scale)
    picture, ids = _resized(picture, h, w), F.interpolate(ids, (h, w), mode="nearest")
    dx, dy = width - w, height - h
    around = (dx // 2, dx - dx // 2, dy // 2, dy - dy // 2)
    return F.pad(picture, around, mode="replicate"), F.pad(ids, around, mode="replicate")


def _resized(picture: Tensor, height: int, width: int) -> Tensor:
    if height < picture.shape[-2]:
        return F.interpolate(picture, (height, width), mode="area")
    return F.interpolate(picture, (height, width), mode="bilinear", align_corners=False)


def _blurred(picture: Tensor, factor: float) -> Tensor:
    height, width = picture.shape[-2:]
    return _resized(_resized(picture, int(height / factor), int(width / factor)), height, width)


def _targets(scene: Scene, picture: Tensor, ids: Tensor, rng: random.Random) -> Sample:
    height, width = ids.shape
    rows, columns = torch.meshgrid(torch.arange(height), torch.arange(width), indexing="ij")
    centre, offset = torch.zeros(height, width), torch.zeros(2, height, width)
    masks, things = [], []
    for number in torch.unique(ids).tolist():
        thing = scene.things.get(number)
        mask = ids == number
        pixels = int(mask.sum())
        if thing is None or pixels < 6:
            continue
        row, column = rows[mask].float().mean(), columns[mask].float().mean()
        near = torch.exp(-((rows - row) ** 2 + (columns - column) ** 2) / (2 * CENTRE_PX**2))
        centre = torch.maximum(centre, near)
        offset[0][mask] = (row - rows[mask]) / OFFSET_PX
        offset[1][mask] = (column - columns[mask]) / OFFSET_PX
        if pixels >= LEAST_PX:
            masks.append(_shaken(mask.float(), rng))
            things.append(thing)
    stacked = torch.stack(masks) if masks else torch.zeros(0, height, width)
    return Sample(scene, picture, ids, centre, offset, stacked, things)


def _shaken(mask: Tensor, rng: random.Random) -> Tensor:
    """A mask as the network itself might find it: grown, shrunk, or a pixel off."""
    drawn = rng.random()
    if drawn < 0.5:
        return mask
    if drawn < 0.7:
        return F.max_pool2d(mask[None, None], 3, 1, 1)[0, 0]
    if drawn < 0.85:
        shrunk = 1.0 - F.max_pool2d(1.0 - mask[None, None], 3, 1, 1)[0, 0]
        return shrunk if shrunk.sum() >= 6 else mask
    return torch.roll(mask, (rng.randint(-1, 1), rng.randint(-1, 1)), (0, 1))
