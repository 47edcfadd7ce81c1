"""Speed of `l4d score` against a plain numpy + Pillow loop and against decoding alone, in one run.

    cargo build --release && cargo build --release -p l4d-score --example decode_masks
    python benchmark/perf/score.py

Needs numpy and Pillow. Makes a benchmark of 21 scenes and 289 queries at the profile small (256x192; its clip has 49
frames, so there are 14161 masks) with the results of one method as PNG (8-bit, as Pillow writes them) and as RLE, times
everything as whole processes (the loop without start-up and without decoding the truth, which favours it), checks that
all count the same pixels, and prints JSON. `seconds_at_24_frames` scales to a clip of 24 frames by the mask.

Targets: PNG at least 5 times the loop and within 1.5 times of decoding alone; RLE at least 20 times the loop; memory
that does not grow with the number of queries.
"""

import argparse
import csv
import hashlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image

from reference_score import Scene

WIDTH, HEIGHT, FRAMES = 256, 192, list(range(0, 97, 2))
SCENES, QUERIES = 21, 289
OBJECTS, LANDMARKS = 6, 2


def encode_rle(mask: np.ndarray) -> str:
    flat = mask.ravel(order="F")
    edges = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    runs = np.diff([0, *edges, flat.size]).tolist()
    if flat[0]:
        runs.insert(0, 0)
    text = []
    for index, run in enumerate(runs):
        value, more = run - (runs[index - 2] if index > 2 else 0), True
        while more:
            group = value & 31
            value >>= 5
            more = value != (-1 if group & 16 else 0)
            text.append(chr(48 + group + 32 * more))
    return "".join(text)


def picture(centres: np.ndarray, radii: np.ndarray, frame: int) -> np.ndarray:
    """Instance ids: wobbly discs before two landmarks."""
    rows, cols = np.mgrid[:HEIGHT, :WIDTH]
    ids = np.where(rows > 150, 1001, np.where(cols > 220, 1002, 0))
    for index, ((row, col), radius) in enumerate(zip(centres, radii, strict=True), start=1):
        down, right = rows - row, cols - col - frame / 2
        edge = radius * (1 + 0.15 * np.sin(7 * np.arctan2(down, right) + frame / 5))
        ids[np.hypot(down, right) < edge] = index
    return ids


def text_digest(text: str) -> str:
    return hashlib.sha256(f"{text}\nnull".encode()).hexdigest()[:16]


def write_scene(bench: Path, results: dict[str, Path], name: str, queries: int, rng: np.random.Generator) -> None:
    centres = rng.uniform((20, 10), (170, 200), (OBJECTS, 2))
    radii = rng.uniform(8, 35, OBJECTS)
    ids = {f"object_{index}": index for index in range(1, OBJECTS + 1)}
    ids |= {f"landmark_{index}": 1000 + index for index in range(1, LANDMARKS + 1)}
    masks = {instance: {} for instance in ids}
    pictures = {frame: picture(centres, radii, frame) for frame in FRAMES}
    for frame, pixels in pictures.items():
        for instance, number in ids.items():
            if (pixels == number).any():
                masks[instance][f"{frame:04}"] = encode_rle(pixels == number)
    truth = {
        "schema": "l4d/truth/1",
        "scene": name,
        "scale": "room",
        "variant": 0,
        "profile": "small",
        "width": WIDTH,
        "height": HEIGHT,
        "test_view": "test",
        "frames": FRAMES,
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
    (bench / "truth/small").mkdir(parents=True, exist_ok=True)
    (bench / "truth/small" / f"{name}.json").write_text(json.dumps(truth))
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
            predicted ^= rng.random(predicted.shape) < 0.001
            answered[f"{frame:04}"] = encode_rle(predicted)
            path = results["png"] / "masks" / name / f"{number:03}" / f"{frame:04}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            Image.fromarray(predicted.astype(np.uint8) * 255).save(path)
        path = results["rle"] / "masks" / name / f"{number:03}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"size": [HEIGHT, WIDTH], "frames": answered}))
    (bench / "queries").mkdir(exist_ok=True)
    (bench / "queries" / f"{name}.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))


def write_all(root: Path) -> list[str]:
    bench, results = root / "benchmark", {form: root / "results" / form for form in ("png", "rle")}
    names = [f"scene_{index:02}" for index in range(SCENES)]
    rng = np.random.default_rng(0)
    for index, name in enumerate(names):
        queries = QUERIES // SCENES + (index < QUERIES % SCENES)
        write_scene(bench, results, name, queries, rng)
    listed = ", ".join(f'"{name}"' for name in names)
    manifest = f'name = "Speed"\nversion = "0.1.0"\nlicence = "CC0-1.0"\nscenes = [{listed}]\n'
    (bench / "panoptic-l4d.toml").write_text(manifest)
    digests = [hashlib.sha256((bench / "truth/small" / f"{name}.json").read_bytes()).hexdigest() for name in names]
    lines = "".join(f"{digest}  {name}.json\n" for digest, name in zip(digests, names, strict=True))
    for form, path in results.items():
        card = {
            "name": form,
            "version": "1",
            "benchmark_version": "0.1.0",
            "truth_digest": hashlib.sha256(lines.encode()).hexdigest(),
            "profile": "small",
            "width": WIDTH,
            "height": HEIGHT,
            "frames": FRAMES,
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


def run(command: list[str | Path], folder: Path) -> float:
    """Wall seconds of a process."""
    start = time.perf_counter()
    subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - start


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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--l4d", type=Path, default=Path("target/release/l4d"))
    parser.add_argument("--decode", type=Path, default=Path("target/release/examples/decode_masks"))
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    l4d, decode = arguments.l4d.resolve(), arguments.decode.resolve()

    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        names = write_all(root)
        scenes = [Scene(root / "benchmark", "small", name) for name in names]
        score = [l4d, "--quiet", "score", "--profile", "small"]
        jobs = {
            "decode_png": [decode, "results/png"],
            "score_png": [*score, "results/png"],
            "score_rle": [*score, "results/rle"],
        }
        times: dict[str, list[float]] = {"numpy_loop": [], **{job: [] for job in jobs}}
        # Turn about, so that a slow spell of the machine meets all of them.
        for _ in range(arguments.repeats):
            start = time.perf_counter()
            expected = plain_loop(root, scenes)
            times["numpy_loop"].append(time.perf_counter() - start)
            for job, command in jobs.items():
                times[job].append(run(command, root))
        for form in ("png", "rle"):
            if read_counts(root / "scores" / form / "counts.csv") != expected:
                sys.exit(f"l4d score counts other pixels from {form} than the loop")
        few = ",".join(names[: os.cpu_count()])
        memory = {job: peak_memory_mib(command, root) for job, command in jobs.items()}
        for form in ("png", "rle"):
            part = [*score, f"results/{form}", "--scenes", few, "--scores", "few"]
            memory[f"score_{form}_of_{os.cpu_count()}_scenes"] = peak_memory_mib(part, root)

    best = {job: min(seconds) for job, seconds in times.items()}
    masks = QUERIES * len(FRAMES)
    report = {
        "masks": masks,
        "cores": os.cpu_count(),
        "seconds_best": best,
        "seconds_median": {job: statistics.median(seconds) for job, seconds in times.items()},
        "microseconds_per_mask": {job: 1e6 * seconds / masks for job, seconds in best.items()},
        "seconds_at_24_frames": {job: seconds * 24 / len(FRAMES) for job, seconds in best.items()},
        "png_times_loop": best["numpy_loop"] / best["score_png"],
        "png_over_decoding": best["score_png"] / best["decode_png"],
        "rle_times_loop": best["numpy_loop"] / best["score_rle"],
        "peak_memory_mib": memory,
        "counts_equal": True,
    }
    json.dump(report, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
