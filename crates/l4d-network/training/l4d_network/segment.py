"""Pixels to segments: centres are peaks, and every pixel of a thing goes to the centre that it points at.

`l4d-ground` does the same in Rust; the constants are written into the weights' description.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

from .model import OFFSET_PX

PEAK = 0.12
"""Least height of a peak."""
PEAK_PX = 3
"""A peak is the highest within so many pixels."""
MOST = 64
"""Most segments of a picture."""


def segment(pixels: Tensor) -> Tensor:
    """Numbers of segments (h, w) from the per-pixel output (4, h, w); 0 is the background."""
    thing, centre, offset = pixels[0] > 0.0, pixels[1], pixels[2:] * OFFSET_PX
    size = 2 * PEAK_PX + 1
    is_peak = (F.max_pool2d(centre[None, None], size, 1, PEAK_PX)[0, 0] == centre) & (centre > PEAK)
    places = is_peak.nonzero()
    numbers = torch.zeros(centre.shape, dtype=torch.long)
    if not len(places):
        return numbers
    order = centre[is_peak].argsort(descending=True, stable=True)[:MOST]
    places = places[order].float()
    rows, columns = torch.meshgrid(torch.arange(centre.shape[0]), torch.arange(centre.shape[1]), indexing="ij")
    aims = torch.stack([rows + offset[0], columns + offset[1]], -1)[thing]
    numbers[thing] = torch.cdist(aims, places).argmin(1) + 1
    return numbers
