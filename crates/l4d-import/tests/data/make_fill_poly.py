"""Writes fill_poly.jsonl: polygons and the pixels that cv2.fillPoly gives them.

Run with numpy and opencv-python-headless (4.10.0 wrote the committed file):

    python make_fill_poly.py
"""

import json
import pathlib
import random

import cv2
import numpy as np

SIDE = 24


def polygon(number: int) -> list[list[int]]:
    source = random.Random(f"fill_poly/{number}")
    corners = source.choice([1, 2, 3, 3, 4, 5, 6, 8, 12])
    return [[source.randrange(SIDE), source.randrange(SIDE)] for _ in range(corners)]


def rows(points: list[list[int]]) -> list[str]:
    mask = np.zeros((SIDE, SIDE), np.uint8)
    cv2.fillPoly(mask, [np.array(points, np.int32)], 1)
    return ["".join("#" if value else "." for value in row) for row in mask]


path = pathlib.Path(__file__).with_name("fill_poly.jsonl")
with path.open("w", encoding="utf-8") as file:
    for number in range(120):
        points = polygon(number)
        file.write(json.dumps({"points": points, "rows": rows(points)}) + "\n")
