"""Speed of scoring against a numpy + Pillow loop, against pycocotools and against decoding alone, in one run.

    cargo build --release -p l4d-score --examples
    python perf/score.py                       # small: 256x192, 49 frames, 14161 masks
    python perf/score.py --profile full        # 640x480, 97 frames, 28033 masks
    python perf/score.py --profile full --scenes 3 --queries 42      # a seventh of it

Needs numpy, Pillow and pycocotools. Makes a benchmark (of 21 scenes and 289 queries) with the results of one method as PNG
(8-bit, as Pillow writes them) and as RLE, checks that all count the same pixels, and prints JSON. `score_masks` is what
`l4d score` calls, in a binary without the rest, and is timed as whole processes, with start-up, truth, checks and
`counts.csv`; the loops in this process, without start-up, truth or files of run lengths, which favours them. pycocotools gets the same strings, one pair of target and prediction at a time, and finds
their IoU alone, where scoring also finds the instance that is overlapped most.

Targets: PNG at least 5 times the loop and within 1.5 times of decoding alone; RLE at least 20 times the loop and 3 times
pycocotools; memory that does not grow with the number of queries.
"""

import argparse
import csv
import hashlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
from PIL import Image
from pycocotools import mask as coco

from reference_score import Scene

T = TypeVar("T")
PROFILES = {"small": (256, 192, 2), "full": (640, 480, 1)}
OBJECTS, LANDMARKS = 6, 2


class Clip:
    """Size and frames of a profile."""

    def __init__(self, profile: str) -> None:
        self.profile = profile
        self.width, self.height, stride = PROFILES[profile]
        self.frames = list(range(0, 97, stride))
        self.scale = self.width / 256


def encode_rle(mask: np.ndarray) -> str:
    return coco.encode(np.asfortranarray(mask.view(np.uint8)))["counts"].decode()


def picture(clip: Clip, centres: np.ndarray, radii: np.ndarray, frame: int) -> np.ndarray:
    """Instance ids: wobbly discs before two landmarks."""
    ids = np.zeros((clip.height, clip.width), np.uint16)
    ids[:, int(220 * clip.scale) :] = 1002
    ids[int(150 * clip.scale) :] = 1001
    for index, ((row, col), radius) in enumerate(zip(centres, radii, strict=True), start=1):
        col = col + clip.scale * frame / 2
        reach = int(1.2 * radius) + 1
        top, left = max(0, int(row) - reach), max(0, int(col) - reach)
        window = ids[top : int(row) + reach, left : int(col) + reach]
        if window.size:
            down, right = np.ogrid[: window.shape[0], : window.shape[1]]
            down, right = down + top - row, right + left - col
            edge = radius * (1 + 0.15 * np.sin(7 * np.arctan2(down, right) + frame / 5))
            window[np.hypot(down, right) < edge] = index
    return ids


def text_digest(text: str) -> str:
    return hashlib.sha256(f"{text}\nnull".encode()).hexdigest()[:16]


def write_scene(
    clip: Clip, bench: Path, results: dict[str, Path], name: str, queries: int, rng: np.random.Generator
) -> None:
    centres = clip.scale * rng.uniform((20, 10), (170, 200), (OBJECTS, 2))
    radii = clip.scale * rng.uniform(8, 35, OBJECTS)
    ids = {f"object_{index}": index for index in range(1, OBJECTS + 1)}
    ids |= {f"landmark_{index}": 1000 + index for index in range(1, LANDMARKS + 1)}
    masks = {instance: {} for instance in ids}
    pictures = {frame: picture(clip, centres, radii, frame) for frame in clip.frames}
    for frame, pixels in pictures.items():
        for instance, number in ids.items():
            if (pixels == number).any():
                masks[instance][f"{frame:04}"] = encode_rle(pixels == number)
    truth = {
        "schema": "l4d/truth/1",
        "scene": name,
        "scale": "room",
        "variant": 0,
        "profile": clip.profile,
        "width": clip.width,
        "height": clip.height,
        "test_view": "test",
        "frames": clip.frames,
        "instances": [
            {
                "name": instance,
                "id": number,
                "role": "landmark" if number > 1000 else "object",
                "category": "thing",
                "masks": masks[instance],
            }
            for instance, number in ids.items()
        ],
        "visible": {},
    }
    folder = bench / "truth" / clip.profile
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(truth))
    lines = []
    for number in range(1, queries + 1):
        text = f"thing {number}"
        referent = 1 + number % OBJECTS
        lines.append(
            {
                "id": f"{name}/{number:03}",
                "text": text,
                "categories": [("attribute", "action", "spatial", "interaction")[number % 4]],
                "referents": [f"object_{referent}"],
                "temporal": "whole",
                "frames": [[0, 96]],
                "predicate": None,
                "text_digest": text_digest(text),
                "provenance": {"source": "author"},
                "status": "candidate",
            }
        )
        answered = {}
        for frame, pixels in pictures.items():
            # The truth, moved by a few pixels and frayed: about what a solver gives.
            predicted = np.roll(pixels == referent, rng.integers(-4, 5, 2), (0, 1))
            stray = rng.integers(0, predicted.size, predicted.size // 1000)
            predicted.flat[stray] ^= True
            answered[f"{frame:04}"] = encode_rle(predicted)
            path = results["png"] / "masks" / name / f"{number:03}" / f"{frame:04}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            Image.fromarray(predicted.astype(np.uint8) * 255).save(path)
        path = results["rle"] / "masks" / name / f"{number:03}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"size": [clip.height, clip.width], "frames": answered}))
    (bench / "queries").mkdir(exist_ok=True)
    (bench / "queries" / f"{name}.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))


def write_all(clip: Clip, root: Path, scenes: int, queries: int) -> list[str]:
    bench, results = root / "benchmark", {form: root / "results" / form for form in ("png", "rle")}
    names = [f"scene_{index:02}" for index in range(scenes)]
    rng = np.random.default_rng(0)
    for index, name in enumerate(names):
        write_scene(clip, bench, results, name, queries // scenes + (index < queries % scenes), rng)
    listed = ", ".join(f'"{name}"' for name in names)
    manifest = f'name = "Speed"\nversion = "0.1.0"\nlicence = "CC0-1.0"\nscenes = [{listed}]\n'
    (bench / "panoptic-l4d.toml").write_text(manifest)
    truth = bench / "truth" / clip.profile
    digests = [hashlib.sha256((truth / f"{name}.json").read_bytes()).hexdigest() for name in names]
    lines = "".join(f"{digest}  {name}.json\n" for digest, name in zip(digests, names, strict=True))
    for form, path in results.items():
        card = {
            "name": form,
            "version": "1",
            "benchmark_version": "0.1.0",
            "truth_digest": hashlib.sha256(lines.encode()).hexdigest(),
            "profile": clip.profile,
            "width": clip.width,
            "height": clip.height,
            "frames": clip.frames,
            "protocol": "l4d",
            "used": {"ground_truth": False, "test_view": False},
            "seconds": None,
        }
        (path / "method.json").write_text(json.dumps(card))
    return names


def plain_loop(root: Path, scenes: list[Scene]) -> list[tuple[int, ...]]:
    """Intersection, union, predicted, truth of every query and frame, as one writes it in an afternoon."""
    counts = []
    for scene in scenes:
        for query in scene.queries:
            for frame in scene.frames:
                path = root / "results/png/masks" / query["id"] / f"{frame:04}.png"
                predicted = np.asarray(Image.open(path)) > 0
                truth = scene.masks.get((query["referents"][0], frame))
                if truth is None:
                    truth = np.zeros_like(predicted)
                counts.append(((predicted & truth).sum(), (predicted | truth).sum(), predicted.sum(), truth.sum()))
    return [tuple(map(int, row)) for row in counts]


def coco_pairs(root: Path, clip: Clip, names: list[str]) -> list[tuple[dict | None, dict]]:
    """Target and prediction of every query and frame as pycocotools takes them."""
    pairs = []
    size = [clip.height, clip.width]
    for name in names:
        truth = json.loads((root / "benchmark/truth" / clip.profile / f"{name}.json").read_text())
        masks = {instance["name"]: instance["masks"] for instance in truth["instances"]}
        for line in (root / "benchmark/queries" / f"{name}.jsonl").read_text().splitlines():
            query = json.loads(line)
            answers = json.loads((root / "results/rle/masks" / f"{query['id']}.json").read_text())["frames"]
            for key, counts in answers.items():
                target = masks[query["referents"][0]].get(key)
                target = target and {"size": size, "counts": target.encode()}
                pairs.append((target, {"size": size, "counts": counts.encode()}))
    return pairs


def coco_loop(pairs: list[tuple[dict | None, dict]]) -> list[float]:
    """IoU of every pair; 0 where nothing is to be found."""
    return [0.0 if target is None else float(coco.iou([predicted], [target], [0])[0, 0]) for target, predicted in pairs]


class Clock:
    """Wall and processor seconds of jobs. The latter can be compared on a machine that others use as well."""

    def __init__(self) -> None:
        self.wall: dict[str, list[float]] = {}
        self.processor: dict[str, list[float]] = {}

    def time(self, job: str, work: Callable[[], T]) -> T:
        start, spent = time.perf_counter(), processor_seconds()
        result = work()
        self.wall.setdefault(job, []).append(time.perf_counter() - start)
        self.processor.setdefault(job, []).append(processor_seconds() - spent)
        return result


def processor_seconds() -> float:
    """Of this process and its finished children."""
    return sum(
        usage.ru_utime + usage.ru_stime
        for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )


def run(command: list[str | Path], folder: Path, threads: int | None = None) -> None:
    environment = os.environ | ({"RAYON_NUM_THREADS": str(threads)} if threads else {})
    subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, check=True, env=environment)


def peak_memory_mib(command: list[str | Path], folder: Path) -> float:
    """Peak memory of a process. A child inherits the peak of who starts it, so a small process does."""
    starter = (
        "import resource, subprocess, sys;"
        "subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True);"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024)"
    )
    command = [sys.executable, "-S", "-E", "-c", starter, *command]
    return float(subprocess.run(command, cwd=folder, capture_output=True, check=True, text=True).stdout)


def read_counts(path: Path) -> list[tuple[int, ...]]:
    with path.open() as file:
        names = ("intersection", "union", "predicted", "truth")
        return [tuple(int(row[name]) for name in names) for row in csv.DictReader(file)]


def ratios(seconds: dict[str, list[float]], masks: int) -> dict:
    best = {job: min(all_seconds) for job, all_seconds in seconds.items()}
    return {
        "microseconds_per_mask": {job: 1e6 * job_seconds / masks for job, job_seconds in best.items()},
        "png_times_loop": best["numpy_loop"] / best["score_png"],
        "png_over_decoding": best["score_png"] / best["decode_png"],
        "rle_times_loop": best["numpy_loop"] / best["score_rle"],
        "rle_times_pycocotools": best["pycocotools"] / best["score_rle"],
        "rle_one_thread_times_pycocotools": best["pycocotools"] / best["score_rle_one_thread"],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--score", type=Path, default=Path("target/release/examples/score_masks"))
    parser.add_argument("--decode", type=Path, default=Path("target/release/examples/decode_masks"))
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--profile", choices=PROFILES, default="small")
    parser.add_argument("--scenes", type=int, default=21)
    parser.add_argument("--queries", type=int, default=289)
    arguments = parser.parse_args()
    binary, decode = arguments.score.resolve(), arguments.decode.resolve()
    clip = Clip(arguments.profile)

    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        names = write_all(clip, root, arguments.scenes, arguments.queries)
        scenes = [Scene(root / "benchmark", clip.profile, name) for name in names]
        pairs = coco_pairs(root, clip, names)
        score = [binary, clip.profile]
        jobs = {
            "decode_png": ([decode, "results/png"], None),
            "score_png": ([*score, "results/png", "scores"], None),
            "score_rle": ([*score, "results/rle", "scores"], None),
            "score_rle_one_thread": ([*score, "results/rle", "one"], 1),
        }
        clock = Clock()
        # Turn about, so that a slow spell of the machine meets all of them. The slow loop goes once.
        expected = clock.time("numpy_loop", lambda: plain_loop(root, scenes))
        for _ in range(arguments.repeats):
            ious = clock.time("pycocotools", lambda: coco_loop(pairs))
            for job, (command, threads) in jobs.items():
                clock.time(job, lambda: run(command, root, threads))
        for form in ("png", "rle"):
            if read_counts(root / "scores" / form / "counts.csv") != expected:
                sys.exit(f"score_masks counts other pixels from {form} than the loop")
        ours = [intersection / union if truth else 0.0 for intersection, union, _, truth in expected]
        if not np.allclose(ours, ious, rtol=0, atol=1e-12):
            sys.exit("pycocotools finds another IoU")
        few = names[: os.cpu_count()]
        memory = {job: peak_memory_mib(command, root) for job, (command, _) in jobs.items()}
        for form in ("png", "rle"):
            part = [*score, f"results/{form}", "few", *few]
            memory[f"score_{form}_of_{os.cpu_count()}_scenes"] = peak_memory_mib(part, root)

    masks = arguments.queries * len(clip.frames)
    report = {
        "profile": clip.profile,
        "scenes": arguments.scenes,
        "masks": masks,
        "cores": os.cpu_count(),
        "wall": ratios(clock.wall, masks),
        "processor": ratios(clock.processor, masks),
        "peak_memory_mib": memory,
        "counts_equal": True,
    }
    json.dump(report, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
