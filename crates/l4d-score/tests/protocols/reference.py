"""The protocols of others, done again in numpy, OpenCV and pycocotools: what `l4d-score` is held against.

    python crates/l4d-score/tests/protocols/reference.py > crates/l4d-score/tests/protocols/reference.json

Needs numpy, opencv-python-headless and pycocotools. Prints made-up scenes as run lengths (written by pycocotools) with the
numbers of every protocol. It shares nothing with the Rust code: overlaps are counted by pycocotools, contours dilated and
boundaries eroded by OpenCV, and each evaluation is one plain loop over frames.
"""

import json
import math
import sys

import cv2
import numpy as np
from pycocotools import mask as coco

FRAMES = [0, 2, 4, 6, 8, 10, 12, 14, 16]


def blob(rng, height, width, centre, radius):
    rows, cols = np.mgrid[:height, :width]
    down, right = rows - centre[0], cols - centre[1]
    edge = radius * (1 + 0.2 * np.sin(5 * np.arctan2(down, right) + rng.uniform(0, 6)))
    return np.hypot(down, right) < edge


def encode(mask):
    return coco.encode(np.asfortranarray(mask.astype(np.uint8)))["counts"].decode()


def make_query(rng, number, height, width, holds, kind):
    """Masks of the referents by frame, and answers: a mask, None for absent, or no key at all."""
    visible, answers = {}, {}
    centre = rng.uniform((0.2 * height, 0.2 * width), (0.8 * height, 0.8 * width))
    radius = rng.uniform(6, 0.3 * height)
    for step, frame in enumerate(FRAMES):
        centre = centre + rng.uniform(-4, 4, 2)
        parts = [blob(rng, height, width, centre, radius)]
        if number % 3 == 1:
            parts.append(blob(rng, height, width, centre + (radius / 2, radius), radius / 2))
        if kind == "late" and step < 3 or kind == "gap" and step in (4, 5) or kind == "never":
            parts = [np.zeros((height, width), bool) for _ in parts]
        visible[frame] = parts
        union = np.any(parts, axis=0)
        guess = np.roll(union, rng.integers(-3, 4, 2), (0, 1))
        if number % 2:
            guess ^= rng.random((height, width)) < 0.002
        if kind == "wrong":
            guess = blob(rng, height, width, (height - centre[0], width - centre[1]), radius)
        if kind == "full":
            guess = np.ones((height, width), bool)
        answers[frame] = guess if guess.any() else None
        if step in (2, 7) and kind != "full":
            answers[frame] = None
        if kind == "alarm" and step == 8:
            answers[frame] = blob(rng, height, width, (5, 5), 6)
    if kind == "missing":
        del answers[4], answers[6]
    if kind == "silent":
        answers = {}
    return {"number": number, "holds": holds, "visible": visible, "answers": answers}


def make_scenes():
    rng = np.random.default_rng(8)
    kinds = ["", "late", "gap", "wrong", "full", "alarm", "missing", "silent", "never", ""]
    scenes = []
    for name, height, width in (("room_a", 120, 160), ("table_b", 97, 130)):
        queries = []
        for index, kind in enumerate(kinds):
            holds = [[4, 11]] if index in (3, 5) else [[0, 3], [8, 12]] if index == 9 else None
            queries.append(make_query(rng, index + 1, height, width, holds, kind))
        scenes.append({"name": name, "height": height, "width": width, "queries": queries})
    # A scene that a method did not touch.
    queries = [make_query(rng, index + 1, 40, 50, None, "silent") for index in range(2)]
    scenes.append({"name": "yard_c", "height": 40, "width": 50, "queries": queries})
    return scenes


class Seen:
    """One query in one frame."""

    def __init__(self, query, frame, shape):
        self.visible = np.any(query["visible"][frame], axis=0)
        self.holds = query["holds"] is None or any(first <= frame <= last for first, last in query["holds"])
        self.target = self.visible & self.holds
        self.is_missing = frame not in query["answers"]
        answer = query["answers"].get(frame)
        self.predicted = np.zeros(shape, bool) if answer is None else answer


def iou(one, other):
    if not one.any() and not other.any():
        return math.nan
    pair = [coco.encode(np.asfortranarray(mask.astype(np.uint8))) for mask in (one, other)]
    return float(coco.iou([pair[0]], [pair[1]], [0])[0, 0])


def contour(mask):
    mask = mask.astype(np.uint8)
    east, south, diagonal = (np.zeros_like(mask) for _ in range(3))
    east[:, :-1], south[:-1], diagonal[:-1, :-1] = mask[:, 1:], mask[1:], mask[1:, 1:]
    edge = (mask ^ east) | (mask ^ south) | (mask ^ diagonal)
    edge[-1] = mask[-1] ^ east[-1]
    edge[:, -1] = mask[:, -1] ^ south[:, -1]
    edge[-1, -1] = 0
    return edge


def f_measure(predicted, target):
    reach = math.ceil(0.008 * np.linalg.norm(target.shape))
    span = np.arange(-reach, reach + 1)
    disc = (span[:, None] ** 2 + span**2 <= reach**2).astype(np.uint8)
    ours, theirs = contour(predicted), contour(target)
    if not ours.any() or not theirs.any():
        return 1.0 if not ours.any() and not theirs.any() else 0.0
    precision = (ours * cv2.dilate(theirs, disc)).sum() / ours.sum()
    recall = (theirs * cv2.dilate(ours, disc)).sum() / theirs.sum()
    return 0.0 if precision + recall == 0 else 2 * precision * recall / (precision + recall)


def boundary(mask):
    depth = max(1, round(0.02 * math.hypot(*mask.shape)))
    framed = cv2.copyMakeBorder(mask.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    core = cv2.erode(framed, np.ones((3, 3), np.uint8), iterations=depth)[1:-1, 1:-1]
    return mask & (core == 0)


def average(values):
    values = [value for value in values if value is not None and not math.isnan(value)]
    return float(np.mean(values)) if values else None


def pairs(seen):
    return [frame for frame in seen if frame.target.any()]


def langsplat(clips):
    return {"miou": average([iou(frame.predicted, frame.target) for seen, *_ in clips for frame in pairs(seen)])}


def four_d_langsplat(clips):
    ious, vious, accuracies = [], [], []
    for seen, query, _ in clips:
        if query["holds"] is None:
            ious.append(average([iou(frame.predicted, frame.target) for frame in pairs(seen)]))
            continue
        annotated = [frame for frame in seen if frame.visible.any()]
        if not annotated:
            continue
        said = [frame.predicted.any() for frame in annotated]
        accuracies.append(float(np.mean([on == frame.holds for on, frame in zip(said, annotated)])))
        total, union = 0.0, 0
        for on, frame in zip(said, annotated):
            union += on or frame.holds
            if on and frame.holds:
                total += iou(frame.predicted, frame.visible)
        vious.append(total / union if union else 0.0)
    return {"miou": average(ious), "viou": average(vious), "acc": average(accuracies)}


def gaussian_grouping(clips):
    regions, boundaries = [], []
    for seen, *_ in clips:
        answered = [frame for frame in pairs(seen) if not frame.is_missing]
        regions.append(average([iou(frame.predicted, frame.target) for frame in answered]))
        boundaries.append(average([iou(boundary(frame.predicted), boundary(frame.target)) for frame in answered]))
    return {"miou": average(regions), "boundary_miou": average(boundaries)}


def j_and_f(seen):
    j = [iou(frame.predicted, frame.target) for frame in seen]
    return [1.0 if math.isnan(value) else value for value in j], [
        f_measure(frame.predicted, frame.target) for frame in seen
    ]


def statistics(values):
    ends = np.round(np.linspace(1, len(values), 5) + 1e-10).astype(int) - 1
    bins = [values[ends[index] : ends[index + 1] + 1] for index in range(4)]
    return np.mean(values), np.mean(np.array(values) > 0.5), np.mean(bins[0]) - np.mean(bins[3])


def davis(clips):
    rows = []
    for seen, *_ in clips:
        if seen[0].target.any():
            j, f = j_and_f(seen[1:-1])
            rows.append([*statistics(j), *statistics(f)])
    names = ["j_mean", "j_recall", "j_decay", "f_mean", "f_recall", "f_decay"]
    found = dict(zip(names, map(float, np.mean(rows, axis=0))))
    return {"j_and_f": (found["j_mean"] + found["f_mean"]) / 2, **found}


def mevis(clips):
    rows = []
    for seen, _, is_scene_answered in clips:
        if not is_scene_answered:
            rows.append((0.0, 0.0))
        elif not any(frame.is_missing for frame in seen):
            rows.append(tuple(map(np.mean, j_and_f(seen))))
    j, f = map(float, np.mean(rows, axis=0))
    return {"j_and_f": (j + f) / 2, "j": j, "f": f}


def r4d(clips):
    """Time codes are positions in the clip; the loop is that of the source."""
    rows = []
    for seen, *_ in clips:
        rendered = [place for place, frame in enumerate(seen) if not frame.is_missing]
        if not rendered:
            continue
        masks = [place for place, frame in enumerate(seen) if frame.target.any()]
        there = set(range(min(masks), max(masks) + 1)) if masks else set()
        active = {place for place in rendered if seen[place].predicted.any()}
        acc = sum((place in active) == (place in there) for place in rendered) / len(rendered)
        union = len(active | there)
        tiou = len(active & there) / union if union else 1.0
        total = 0.0
        for place in masks:
            before = [other for other in rendered if other <= place]
            after = [other for other in rendered if other >= place]
            ends = before[-1:] + after[:1]
            nearest = min(ends, key=lambda other: (abs(other - place), other))
            if nearest in active:
                total += iou(seen[nearest].predicted, seen[place].target)
        viou = total / len(masks) if masks else float(union == 0)
        rows.append((acc, viou, tiou))
    return dict(zip(("acc", "viou", "tiou"), map(float, np.mean(rows, axis=0))))


def votsr(clips):
    sequences = []
    for seen, *_ in clips:
        overlaps = []
        for frame in seen:
            truth, said = frame.target.any(), frame.predicted.any()
            overlaps.append(1.0 if not truth and not said else iou(frame.predicted, frame.target) if truth and said else 0.0)
        sequences.append((np.mean(overlaps), len(seen)))
    return {"accuracy": float(sum(value * length for value, length in sequences) / sum(n for _, n in sequences))}


def saco(clips):
    """Counts and epsilons as in demo_eval.py: a sentence has at most one mask, and the IoU is that over the clip."""
    thresholds = np.linspace(0.5, 0.95, 10)
    tp, fp, fn, confusion = np.zeros(10), np.zeros(10), np.zeros(10), np.zeros((2, 2))
    for seen, *_ in clips:
        target = np.stack([frame.target for frame in seen])
        said = np.stack([frame.predicted for frame in seen])
        confusion[int(target.any()), int(said.any())] += 1
        if target.any():
            overlap = (target & said).sum() / (target | said).sum()
            hits = np.where(said.any() & (overlap >= thresholds), 1, 0)
            tp, fp, fn = tp + hits, fp + said.any() - hits, fn + 1 - hits
    precision, recall = tp / (tp + fp + 1e-4), tp / (tp + fn + 1e-4)
    pmf1 = float((2 * precision * recall / (precision + recall + 1e-4)).mean())
    (tn, alarms), (lost, found) = confusion
    product = (found + alarms) * (found + lost) * (tn + alarms) * (tn + lost)
    mcc = float((found * tn - alarms * lost) / (product**0.5 + 1e-6))
    return {"cgf1": pmf1 * mcc, "pmf1": pmf1, "il_mcc": mcc, "n_acc": float(tn / (tn + alarms))}


def clips_of(scene):
    shape = scene["height"], scene["width"]
    is_answered = any(query["answers"] for query in scene["queries"])
    return [([Seen(query, frame, shape) for frame in FRAMES], query, is_answered) for query in scene["queries"]]


def by_scene(scenes, evaluation):
    found = [evaluation(clips_of(scene)) for scene in scenes]
    return {key: average([one[key] for one in found]) for key in found[0]}


def written(query):
    answers = {f"{frame}": None if mask is None else encode(mask) for frame, mask in query["answers"].items()}
    visible = {f"{frame}": [encode(part) for part in parts] for frame, parts in query["visible"].items()}
    return {"number": query["number"], "holds": query["holds"], "visible": visible, "answers": answers}


def main():
    scenes = make_scenes()
    pooled = [clip for scene in scenes for clip in clips_of(scene)]
    expected = {
        "langsplat": by_scene(scenes, langsplat),
        "4d-langsplat": by_scene(scenes, four_d_langsplat),
        "davis": davis(pooled),
        "mevis": mevis(pooled),
        "gaussian-grouping": by_scene(scenes, gaussian_grouping),
        "r4d": r4d(pooled),
        "votsr": votsr(pooled),
        "saco": saco(pooled),
    }
    for scene in scenes:
        scene["queries"] = [written(query) for query in scene["queries"]]
    document = {"frames": FRAMES, "expected": expected, "scenes": scenes}
    json.dump(document, sys.stdout, separators=(",", ":"))
    print()


if __name__ == "__main__":
    main()
