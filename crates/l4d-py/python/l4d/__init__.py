"""l4d: scenes, truth, results, scores and splats of the benchmark for 4D language grounding, as numpy arrays.

Metres, seconds, radians; the world is right-handed, +Z up; cameras have OpenCV axes; the centre of pixel (column, row)
is (column + 0.5, row + 0.5). Arrays are row-major: pictures are (H, W, ...), clips (T, H, W, ...).
Whatever goes wrong raises `L4dError`, with path, field and hint. `l4d.torch` needs PyTorch, and is imported when it is
first named.
"""

from typing import Any

from l4d._error import L4dError
from l4d._native import (
    Benchmark,
    Camera,
    Capture,
    Clips,
    Event,
    Finding,
    Frame,
    FrameClip,
    Instance,
    Picture,
    PictureClip,
    Query,
    ResultsWriter,
    Scene,
    Splats,
    Timeline,
    Truth,
    __version__,
    check,
    decode_colour,
    decode_depth,
    decode_ids,
    rle_decode,
    rle_encode,
    score,
    write_baseline,
)

__all__ = [
    "Benchmark",
    "Camera",
    "Capture",
    "Clips",
    "Event",
    "Finding",
    "Frame",
    "FrameClip",
    "Instance",
    "L4dError",
    "Picture",
    "PictureClip",
    "Query",
    "ResultsWriter",
    "Scene",
    "Splats",
    "Timeline",
    "Truth",
    "__version__",
    "check",
    "decode_colour",
    "decode_depth",
    "decode_ids",
    "rle_decode",
    "rle_encode",
    "score",
    "write_baseline",
]


def __getattr__(name: str) -> Any:
    if name == "torch":
        from importlib import import_module

        return import_module("l4d.torch")
    raise AttributeError(f"module 'l4d' has no attribute {name!r}")
