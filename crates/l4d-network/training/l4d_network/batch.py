"""Training batches, drawn and cut on the device that learns: pictures scaled, mirrored, blurred, in other light, and
what the network should say of them, at half resolution.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from .data import Scene
from .model import OFFSET_PX, Vocabulary

LEAST_PX = 20
"""Pixels (of half resolution) of an object from which something can be learned."""
SEEN_PX = 6
"""Pixels (of half resolution) of an object that has a centre."""
CENTRE_PX = 3.0


@dataclass
class Batch:
    """Pictures (B, 3, H, W) with their targets at half resolution (h, w).

    `kinds` (B, h, w) are noun numbers of pixels; `masks` (B, K, h, w) of 0 and 1 cover the things of each picture.
    `rows` says which N of them can be learned from: numbers of pictures, and of things in those. Their nouns are `nouns`
    (N), their properties `values` (N, keys), numbers of values or -1.
    """

    pictures: Tensor
    kinds: Tensor
    centre: Tensor
    offset: Tensor
    masks: Tensor
    rows: tuple[Tensor, Tensor]
    nouns: Tensor
    values: Tensor


class Pictures:
    """All pictures of some scenes on one device. Things of a scene have slots: 0 is the background."""

    def __init__(self, scenes: Sequence[Scene], words: Vocabulary, device: torch.device) -> None:
        kind = {noun: number for number, noun in enumerate(words.kinds)}
        value = {pair: number for number, pair in enumerate(words.values)}
        keys = {key: number for number, key in enumerate(words.by_key())}
        slots = 1 + max(len(scene.things) for scene in scenes)
        self._device = device
        self._nouns = torch.zeros(len(scenes), slots, dtype=torch.long)
        self._values = torch.full((len(scenes), slots, len(keys)), -1, dtype=torch.long)
        colour, ids, of_scene = [], [], []
        for number, scene in enumerate(scenes):
            table = np.zeros(65536, np.uint8)
            for slot, (instance, thing) in enumerate(sorted(scene.things.items()), 1):
                table[instance] = slot
                self._nouns[number, slot] = kind.get(thing.kind, 0)
                for pair in thing.attributes.items() if thing.is_object else ():
                    if pair in value:
                        self._values[number, slot, keys[pair[0]]] = value[pair]
            colour.append(torch.from_numpy(scene.colour).permute(0, 3, 1, 2))
            ids.append(torch.from_numpy(table[scene.ids]))
            of_scene += [number] * len(scene.colour)
        self._of_scene = torch.tensor(of_scene, device=device)
        self._colour, self._ids = torch.cat(colour).to(device), torch.cat(ids).to(device)
        self._nouns, self._values = self._nouns.to(device), self._values.to(device)

    def __len__(self) -> int:
        return len(self._of_scene)

    def pixels_of_kinds(self, kinds: int) -> Tensor:
        """How many pixels each noun covers, the background first."""
        counts = torch.zeros(kinds, device=self._device)
        for ids, scene in zip(self._ids.split(64), self._of_scene.split(64)):
            nouns = torch.gather(self._nouns[scene], 1, ids.flatten(1).long())
            counts += torch.bincount(nouns.flatten(), minlength=kinds)
        return counts

    def draw(self, size: int, seed: int) -> Batch:
        """A batch of drawn pictures; the same for the same seed on the same device."""
        rng = np.random.default_rng(seed)
        noise = torch.Generator(self._device).manual_seed(seed)
        which = torch.from_numpy(rng.integers(len(self), size=size)).to(self._device)
        grid = _grid(rng, size, self._ids.shape[-2:]).to(self._device)
        colour = self._colour[which].float() / 255.0
        picture = F.grid_sample(colour, grid, "bilinear", "border", align_corners=False)
        ids = F.grid_sample(self._ids[which][:, None].float(), grid[:, ::2, ::2], "nearest", "border", align_corners=False)
        picture = _in_other_light(_blurred(picture, rng), rng)
        shaken = torch.randn(picture.shape, generator=noise, device=self._device)
        picture = (picture + shaken * _drawn(rng, picture, 0.0, 0.03)).clamp(0.0, 1.0)
        return self._targets(picture, ids[:, 0].long(), self._of_scene[which], rng)

    def _targets(self, picture: Tensor, ids: Tensor, scene: Tensor, rng: np.random.Generator) -> Batch:
        size, height, width = ids.shape
        counts = torch.zeros(size, self._nouns.shape[1], device=self._device)
        counts.scatter_add_(1, ids.flatten(1), torch.ones_like(ids.flatten(1), dtype=torch.float32))
        masks = F.one_hot(ids, counts.shape[1]).permute(0, 3, 1, 2)[:, 1:].float()
        counts = counts[:, 1:]
        rows = torch.arange(height, device=self._device, dtype=torch.float32)
        columns = torch.arange(width, device=self._device, dtype=torch.float32)
        row = (masks.sum(3) @ rows) / counts.clamp(min=1.0)
        column = (masks.sum(2) @ columns) / counts.clamp(min=1.0)
        away = (rows - row[..., None])[..., None] ** 2 + (columns - column[..., None])[:, :, None] ** 2
        near = torch.exp(-away / (2 * CENTRE_PX**2)) * (counts >= SEEN_PX)[..., None, None]
        aim_row, aim_column = (
            torch.gather(F.pad(place, (1, 0)), 1, ids.flatten(1)).view(ids.shape) for place in (row, column)
        )
        offset = torch.stack([aim_row - rows[:, None], aim_column - columns], 1) / OFFSET_PX
        has_centre = F.pad(counts >= SEEN_PX, (1, 0))
        counted = torch.gather(has_centre, 1, ids.flatten(1)).view(ids.shape)
        kinds = torch.gather(self._nouns[scene], 1, ids.flatten(1)).view(ids.shape)
        learnable = (counts >= LEAST_PX).nonzero(as_tuple=True)
        return Batch(
            pictures=picture,
            kinds=kinds,
            centre=near.amax(1),
            offset=offset * counted[:, None],
            masks=_shaken(masks, rng),
            rows=learnable,
            nouns=self._nouns[scene][:, 1:][learnable],
            values=self._values[scene][:, 1:][learnable],
        )


def _grid(rng: np.random.Generator, size: int, shape: Sequence[int]) -> Tensor:
    """Where each pixel of the drawn pictures is taken from: zoomed, stretched, turned a little, moved, mirrored."""
    zoom = np.exp(rng.uniform(-0.35, 0.45, size))
    stretch = np.exp(rng.uniform(-0.08, 0.08, size))
    angle = np.radians(rng.uniform(-6.0, 6.0, size))
    mirror = rng.choice((-1.0, 1.0), size)
    aspect = shape[1] / shape[0]
    room = np.abs(1.0 - 1.0 / zoom) * (zoom > 1.0)
    across, down = rng.uniform(-1.0, 1.0, size) * room, rng.uniform(-1.0, 1.0, size) * room
    cosine, sine = np.cos(angle), np.sin(angle)
    matrix = np.zeros((size, 2, 3), np.float32)
    matrix[:, 0, 0] = mirror * cosine / zoom * stretch
    matrix[:, 0, 1] = -mirror * sine / zoom / aspect
    matrix[:, 0, 2] = across
    matrix[:, 1, 0] = sine / zoom * aspect
    matrix[:, 1, 1] = cosine / zoom / stretch
    matrix[:, 1, 2] = down
    return F.affine_grid(torch.from_numpy(matrix), [size, 3, *shape], align_corners=False)


def _blurred(picture: Tensor, rng: np.random.Generator) -> Tensor:
    """Half of the pictures as soft as clips that are drawn from splats."""
    height, width = picture.shape[-2:]
    factor = rng.choice((1.3, 1.6, 2.0))
    small = F.interpolate(picture, (int(height / factor), int(width / factor)), mode="area")
    soft = F.interpolate(small, (height, width), mode="bilinear", align_corners=False)
    chosen = torch.from_numpy(rng.random(len(picture)) < 0.5).to(picture.device)
    return torch.where(chosen[:, None, None, None], soft, picture)


def _in_other_light(picture: Tensor, rng: np.random.Generator) -> Tensor:
    gain, tint = _drawn(rng, picture, 0.75, 1.25), _drawn(rng, picture, 0.95, 1.05, 3)
    picture = picture * gain * tint + _drawn(rng, picture, -0.06, 0.06)
    grey = picture.mean(1, keepdim=True)
    return grey + (picture - grey) * _drawn(rng, picture, 0.8, 1.2)


def _drawn(rng: np.random.Generator, picture: Tensor, low: float, high: float, channels: int = 1) -> Tensor:
    """A number for each picture, or for each of its channels."""
    numbers = rng.uniform(low, high, (len(picture), channels, 1, 1)).astype(np.float32)
    return torch.from_numpy(numbers).to(picture.device)


def _shaken(masks: Tensor, rng: np.random.Generator) -> Tensor:
    """Masks as the network itself might find them: half as they are, others grown, shrunk, or a pixel off."""
    drawn = torch.from_numpy(rng.random(masks.shape[:2]).astype(np.float32)).to(masks.device)[..., None, None]
    grown = F.max_pool2d(masks, 3, 1, 1)
    shrunk = 1.0 - F.max_pool2d(1.0 - masks, 3, 1, 1)
    shrunk = torch.where(shrunk.sum((2, 3), keepdim=True) >= SEEN_PX, shrunk, masks)
    moved = torch.roll(masks, tuple(int(step) for step in rng.integers(-1, 2, 2)), (2, 3))
    others = torch.where(drawn < 0.7, grown, torch.where(drawn < 0.85, shrunk, moved))
    return torch.where(drawn < 0.5, masks, others)
