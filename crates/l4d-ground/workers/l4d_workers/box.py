"""Fills boxes; between two boxes of an object it goes straight, before the first and after the last it stands still.

No network and no look at the pictures: what a segmenter has to beat, and what tests can compute by hand.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator

from l4d_workers import __version__, rle
from l4d_workers.protocol import Found, Refusal, Request

Box = tuple[float, float, float, float]


class Boxes:
    """A worker that believes in boxes."""

    def hello(self) -> dict:
        """Boxes alone."""
        return {"name": "box", "version": __version__, "prompts": ["box"], "text": None}

    def segment(self, request: Request) -> Iterator[Found]:
        """A filled box an object and frame."""
        tracks: dict[int, dict[int, Box]] = {}
        for prompt in request.prompts:
            if "box_px" not in prompt:
                raise Refusal("bad_prompt", "it takes boxes alone")
            tracks.setdefault(prompt["obj"], {})[prompt["frame"]] = tuple(prompt["box_px"])
        for obj, boxes in sorted(tracks.items()):
            for frame in range(request.first, request.last + 1):
                pixels = covered(between(boxes, frame), request.width, request.height)
                counts = rle.of_box(pixels, request.width, request.height)
                yield Found(frame, obj, (request.height, request.width), counts)


def between(boxes: dict[int, Box], frame: int) -> Box:
    """The box at a frame, interpolated between the nearest known ones."""
    before = max((known for known in boxes if known <= frame), default=min(boxes))
    after = min((known for known in boxes if known >= frame), default=max(boxes))
    share = 0.0 if before == after else (frame - before) / (after - before)
    return tuple(a + (b - a) * share for a, b in zip(boxes[before], boxes[after]))


def covered(box: Box, width: int, height: int) -> tuple[int, int, int, int]:
    """The pixels whose centres lie in a box."""
    left, top, right, bottom = box

    def first(edge: float, side: int) -> int:
        return min(max(math.ceil(edge - 0.5), 0), side)

    return first(left, width), first(top, height), first(right, width), first(bottom, height)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """It has no options."""


def open_worker(options: argparse.Namespace) -> Boxes:
    """The worker."""
    return Boxes()
