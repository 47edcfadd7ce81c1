"""How long clips of a trained scene take: eight views at all frames of the profile, files and all.

    cargo build --release
    python perf/splats_clips.py tabletop_tea
    python perf/splats_clips.py tabletop_tea --model other/checkpoint --rounds 5

Runs `l4d render-splats` into a fresh folder once a round, from start to end: reading the model, deforming it once for
each time, drawing, and writing colour as PNG and depth as EXR. Prints one JSON object. On a busy machine only the
best round means anything; `load_before` says how busy it was.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VIEWS = 8


def main() -> None:
    """Times every round and prints them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--profile", default="small")
    parser.add_argument("--data", type=Path)
    parser.add_argument("--model", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--adapter", default="cpu")
    parser.add_argument("--binary", type=Path, default=ROOT / "target" / "release" / "l4d")
    options = parser.parse_args()
    data = options.data or Path("data") / options.profile
    cameras = json.loads((data / options.scene / "scene.json").read_text())["cameras"]
    views = [camera["name"] for camera in cameras if camera["split"] == "train"][:VIEWS]
    command = [
        options.binary.resolve(), "--quiet", "render-splats", options.scene, "--profile", options.profile,
        "--data", data, "--views", ",".join(views), "--adapter", options.adapter,
    ]
    if options.model:
        command += ["--splats", options.model]
    load = os.getloadavg()[0]
    rounds = [one_round(command) for _ in range(options.rounds)]
    seconds = [taken for taken, _, _ in rounds]
    _, pictures, size = rounds[0]
    result = {
        "scene": options.scene,
        "views": len(views),
        "pictures": pictures,
        "megabytes": round(size * 1e-6, 1),
        "threads": os.cpu_count(),
        "load_before": round(load, 1),
        "seconds": [round(taken, 2) for taken in seconds],
        "best_seconds": round(min(seconds), 2),
        "best_ms_a_picture": round(1000 * min(seconds) / pictures, 2),
    }
    print(json.dumps(result, indent=2))


def one_round(command: list) -> tuple[float, int, int]:
    """Seconds, number of pictures, bytes of all files."""
    with tempfile.TemporaryDirectory(prefix="l4d-perf-") as scratch:
        begin = time.perf_counter()
        subprocess.run([*command, "--out", Path(scratch) / "clips"], check=True, stdout=subprocess.DEVNULL)
        taken = time.perf_counter() - begin
        files = [path for path in Path(scratch).rglob("*") if path.is_file()]
        return taken, sum(path.suffix == ".png" for path in files), sum(path.stat().st_size for path in files)


if __name__ == "__main__":
    main()
