"""Writes pycocotools.jsonl: masks and what pycocotools makes of them.

Run with numpy and pycocotools (2.0.11 wrote the committed file):

    python make_pycocotools.py

`rows` is one string of `.` and `#` a row; large masks give `packed` instead, row-major bits as hex (most
significant first, rows padded to bytes).
"""

import json
from pathlib import Path

import numpy as np
from pycocotools import mask as coco


def blobs(width: int, height: int, count: int, rng: np.random.Generator) -> np.ndarray:
    rows, cols = np.mgrid[:height, :width]
    mask = np.zeros((height, width), bool)
    for _ in range(count):
        row, col = rng.integers(height), rng.integers(width)
        mask |= (rows - row) ** 2 + (cols - col) ** 2 < rng.integers(2, 30) ** 2
    return mask


def masks() -> list[np.ndarray]:
    rng = np.random.default_rng(4)
    sizes = [(1, 1), (1, 7), (7, 1), (4, 4), (5, 3), (64, 2), (65, 3), (3, 65), (31, 33)]
    found = [np.zeros((4, 4), bool), np.ones((4, 4), bool), np.ones((1, 1), bool), np.zeros((3, 130), bool)]
    for width, height in sizes:
        found += [rng.random((height, width)) < share for share in (0.1, 0.5, 0.9)]
    found += [blobs(128, 96, 3, rng), blobs(256, 192, 5, rng), ~blobs(256, 192, 2, rng)]
    # One pixel far down the last column: a single run of more than 15 bits.
    corner = np.zeros((192, 256), bool)
    corner[-1, -1] = True
    return [*found, corner]


def line(mask: np.ndarray) -> dict:
    height, width = mask.shape
    counts = coco.encode(np.asfortranarray(mask, np.uint8))["counts"].decode()
    record = {"width": width, "height": height, "counts": counts}
    if mask.size <= 100:
        record["rows"] = ["".join(".#"[int(value)] for value in row) for row in mask]
    else:
        record["packed"] = np.packbits(mask, axis=1).tobytes().hex()
    return record


if __name__ == "__main__":
    path = Path(__file__).with_name("pycocotools.jsonl")
    path.write_text("".join(json.dumps(line(mask)) + "\n" for mask in masks()))
