"""An independent evaluator: the same counts and scores as `l4d score`, in plain numpy, written from docs/scoring.md.

    python reference_score.py --bench benchmark --profile tiny results/oracle > counts.csv
    python reference_score.py --bench benchmark --profile tiny results/oracle --summary

It is slow and simple on purpose: whole bool arrays, one frame after the other. Tests compare it with the judge to the
last pixel, and perf/score.py takes its time as the yardstick (with Pillow to read PNG).
"""

import argparse
import csv
import json
import struct
import sys
import tomllib
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

FIELDS = "scene query frame state intersection union predicted truth instance instance_overlap".split()


def decode_rle(counts: str, height: int, width: int) -> np.ndarray:
    """Compressed COCO counts to a bool array."""
    runs: list[int] = []
    position = 0
    while position < len(counts):
        value, shift, more = 0, 0, True
        while more:
            group = ord(counts[position]) - 48
            value |= (group & 31) << shift
            more = bool(group & 32)
            position += 1
            shift += 5
            if not more and group & 16:
                value -= 1 << shift
        runs.append(value + runs[-2] if len(runs) > 2 else value)
    inside = np.arange(len(runs)) % 2 == 1
    return np.repeat(inside, runs).reshape((height, width), order="F")


def decode_png(path: Path) -> np.ndarray:
    """A grayscale PNG of 1 or 8 bits to a bool array; by hand, so that numpy is all that tests need."""
    data, position, stream = path.read_bytes(), 8, b""
    while position < len(data):
        length, kind = struct.unpack_from(">I4s", data, position)
        body = data[position + 8 : position + 8 + length]
        if kind == b"IHDR":
            width, height, depth = struct.unpack_from(">IIB", body)
        elif kind == b"IDAT":
            stream += body
        position += length + 12
    stride = (width * depth + 7) // 8
    raw = np.frombuffer(zlib.decompress(stream), np.uint8).reshape(height, stride + 1)
    rows = np.zeros((height + 1, stride + 1), int)  # a row and a column of zeros before the picture
    for row, (kind, *line) in enumerate(raw.tolist(), start=1):
        for col, value in enumerate(line, start=1):
            left, above, corner = rows[row, col - 1], rows[row - 1, col], rows[row - 1, col - 1]
            slope = left + above - corner
            nearest = min((abs(slope - left), 0, left), (abs(slope - above), 1, above), (abs(slope - corner), 2, corner))
            predictor = (0, left, above, (left + above) // 2, nearest[2])[kind]
            rows[row, col] = (value + predictor) % 256
    pixels = rows[1:, 1:].astype(np.uint8)
    return (np.unpackbits(pixels, axis=1)[:, :width] if depth == 1 else pixels) > 0


class Scene:
    """Truth and queries of one scene."""

    def __init__(self, bench: Path, profile: str, name: str) -> None:
        truth = json.loads((bench / "truth" / profile / f"{name}.json").read_text())
        self.name = name
        self.scale = truth["scale"]
        self.height, self.width = truth["height"], truth["width"]
        self.frames: list[int] = truth["frames"]
        self.instances = sorted(truth["instances"], key=lambda instance: instance["id"])
        self.masks = {
            (instance["name"], int(frame)): decode_rle(counts, self.height, self.width)
            for instance in self.instances
            for frame, counts in instance["masks"].items()
        }
        lines = (bench / "queries" / f"{name}.jsonl").read_text().splitlines()
        self.queries = [query for query in map(json.loads, filter(None, lines)) if query["status"] != "rejected"]

    def target(self, query: dict, frame: int) -> np.ndarray:
        target = np.zeros((self.height, self.width), bool)
        holds = any(first <= frame <= last for first, last in query["frames"])
        if query["temporal"] == "whole" or holds:
            for name in query["referents"]:
                target |= self.masks.get((name, frame), False)
        return target

    def most_overlapped(self, query: dict, frame: int, predicted: np.ndarray) -> tuple[str, int]:
        overlaps = [
            (int((self.masks[name, frame] & predicted).sum()), name not in query["referents"], -instance["id"], name)
            for instance in self.instances
            if (name := instance["name"], frame) in self.masks
        ]
        overlap, _, _, name = max(overlaps, default=(0, False, 0, ""))
        return (name, overlap) if overlap else ("", 0)


def answers(method: Path, query: dict, scene: Scene) -> Iterator[np.ndarray | None]:
    """One mask a frame; None where there is no answer."""
    base = method / "masks" / query["id"]
    if base.is_dir():
        for frame in scene.frames:
            path = base / f"{frame:04}.png"
            yield decode_png(path) if path.exists() else None
        return
    path = base.with_suffix(".json")
    answered = json.loads(path.read_text())["frames"] if path.exists() else {}
    for frame in scene.frames:
        key = f"{frame:04}"
        if key not in answered:
            yield None
        elif answered[key] is None:
            yield np.zeros((scene.height, scene.width), bool)
        else:
            yield decode_rle(answered[key], scene.height, scene.width)


def judge(scene: Scene, query: dict, method: Path) -> Iterator[dict]:
    for frame, answer in zip(scene.frames, answers(method, query, scene), strict=True):
        target = scene.target(query, frame)
        predicted = np.zeros_like(target) if answer is None else answer
        intersection, union = int((predicted & target).sum()), int((predicted | target).sum())
        if answer is None:
            state = "missing"
        elif target.any():
            state = "hit" if intersection else "miss"
        else:
            state = "false_alarm" if predicted.any() else "true_absent"
        instance, overlap = scene.most_overlapped(query, frame, predicted)
        scene_name, number = query["id"].split("/")
        areas = int(predicted.sum()), int(target.sum())
        values = scene_name, number, frame, state, intersection, union, *areas, instance, overlap
        yield dict(zip(FIELDS, values, strict=True))


def query_scores(rows: list[dict], referents: list[str]) -> dict[str, float]:
    """Scores of one query, 0 to 1; a score that is not defined is left out. Missing frames count as empty."""
    scores: dict[str, float] = {}
    ious = np.array([row["intersection"] / row["union"] for row in rows if row["truth"]])
    absent = [row["predicted"] > 0 for row in rows if not row["truth"]]
    if absent:
        scores["false_positive_rate"] = float(np.mean(absent))
    if ious.size:
        scores["miou"] = float(ious.mean())
        for name, threshold in (("macc", 0), ("acc25", 0.25), ("acc50", 0.5)):
            scores[name] = float((ious > threshold).mean())
        scores["tube_iou"] = sum(row["intersection"] for row in rows) / sum(row["union"] for row in rows)
        overlaps: dict[str, int] = {}
        for row in rows:
            overlaps[row["instance"]] = overlaps.get(row["instance"], 0) + row["instance_overlap"]
        meant = max((overlaps.get(name, 0) for name in referents), default=0)
        others = max((value for name, value in overlaps.items() if name not in referents), default=0)
        scores["select"] = float(meant > others)
    return scores


def average(scores: list[dict[str, float]]) -> dict[str, float]:
    """Means over queries, percent."""
    names = sorted({name for score in scores for name in score})
    return {name: 100 * float(np.mean([score[name] for score in scores if name in score])) for name in names}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("method", type=Path, help="folder of one method")
    parser.add_argument("--bench", type=Path, default=Path("benchmark"))
    parser.add_argument("--profile", default="small")
    parser.add_argument("--summary", action="store_true", help="print scores as JSON instead of counts as CSV")
    arguments = parser.parse_args()

    manifest = tomllib.loads((arguments.bench / "panoptic-l4d.toml").read_text())
    rows, scores, by_category = [], [], {}
    for name in manifest["scenes"]:
        scene = Scene(arguments.bench, arguments.profile, name)
        for query in scene.queries:
            of_query = list(judge(scene, query, arguments.method))
            rows += of_query
            scores.append(query_scores(of_query, query["referents"]))
            for category in query["categories"]:
                by_category.setdefault(category, []).append(scores[-1])
    if arguments.summary:
        categories = {category: average(group) for category, group in by_category.items()}
        json.dump({**average(scores), "categories": categories}, sys.stdout, indent=2)
        print()
        return
    writer = csv.DictWriter(sys.stdout, FIELDS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)


if __name__ == "__main__":
    main()
