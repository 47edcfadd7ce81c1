"""How much faster a scene is learned when only what moves goes through the deformation field.

    cargo build --release
    python perf/splats_training.py tabletop_blocks room_office
    python perf/splats_training.py room_office --data data/small -- --coarse 200 --unfold 2 --fine 300

Trains each scene twice with `l4d train-splats`: as it is by default, and with everything dynamic
(`--dynamic-threshold 0`). Both run at the same time, each on half of the cores, so that other work slows both down; the
one that ends first begins anew until the other has ended, for the same reason. Both have the same budget of Gaussians, cameras an iteration, loss, rates and iterations
(neither stops early). With everything dynamic nothing is known to stand still, so that each iteration looks at whole
pictures, as 4DGaussians does. What stands behind `--` goes to both.

Compares processor time (of all threads) an iteration of the fine stage, and PSNR of the held-out view. A short training
understates the ratio: density control has not yet added what everything dynamic has to move as well. Prints a table to standard error and one JSON object to standard output.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RUNS = {"default": [], "everything dynamic": ["--dynamic-threshold", "0"]}


def main() -> None:
    """Trains every scene both ways and prints what came of it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--profile", default="small")
    parser.add_argument("--data", type=Path)
    parser.add_argument("--binary", type=Path, default=ROOT / "target" / "release" / "l4d")
    parser.add_argument("--keep", type=Path, help="folder for the models; they are thrown away without it")
    own = sys.argv[1:]
    further = own[own.index("--") + 1 :] if "--" in own else []
    options = parser.parse_args(own[: own.index("--")] if "--" in own else own)
    scenes = {}
    for scene in options.scenes:
        with tempfile.TemporaryDirectory(prefix="l4d-perf-") as scratch:
            models = (options.keep or Path(scratch)) / scene
            runs = side_by_side(
                {
                    kind: command(options, scene, [*more, *further], models / kind.split()[0])
                    for kind, more in RUNS.items()
                }
            )
        fast, slow = runs["default"], runs["everything dynamic"]
        scenes[scene] = {
            **runs,
            "cpu_ratio": round(slow["cpu_ms"] / fast["cpu_ms"], 2),
            "gained_db": round(fast["psnr_db"] - slow["psnr_db"], 2),
        }
        show(scene, scenes[scene])
    print(json.dumps({"threads": threads_each(), "profile": options.profile, "scenes": scenes}, indent=2))


def command(options: argparse.Namespace, scene: str, more: list[str], out: Path) -> list:
    """What trains a scene."""
    command = [
        options.binary.resolve(), "--quiet", "train-splats", scene, "--profile", options.profile, "--out", out,
        "--force", "--patience", "0", "--json", *more,
    ]
    return [*command, "--data", options.data] if options.data else command


def side_by_side(commands: dict[str, list]) -> dict[str, dict]:
    """Runs all commands at once, each over and over until every one has ended once; what their first runs report."""
    environment = os.environ | {"RAYON_NUM_THREADS": str(threads_each())}
    start = lambda kind: subprocess.Popen(commands[kind], stdout=subprocess.PIPE, env=environment)  # noqa: E731
    load = os.getloadavg()[0]
    running = {kind: start(kind) for kind in commands}
    reports: dict[str, dict] = {}
    try:
        while len(reports) < len(commands):
            for kind, process in running.items():
                try:
                    output, _ = process.communicate(timeout=1.0)
                except subprocess.TimeoutExpired:
                    continue
                if process.returncode:
                    raise subprocess.CalledProcessError(process.returncode, process.args)
                reports.setdefault(kind, {**summary(json.loads(output)["report"]), "load_before": round(load, 1)})
                running[kind] = start(kind)
    finally:
        for process in running.values():
            process.kill()
            process.wait()
    return {kind: reports[kind] for kind in commands}


def summary(report: dict) -> dict:
    """What one training took and how good its model is."""
    fine = report["fine"]
    return {
        "cpu_ms": round(1e3 * fine["cpu_seconds"] / fine["iterations"], 1),
        "ms": round(1e3 * fine["seconds"] / fine["iterations"], 1),
        "fine_iterations": fine["iterations"],
        "train_seconds": round(report["train_seconds"]),
        "gaussians": report["gaussians"],
        "dynamic": report["dynamic"],
        "psnr_db": round(report["test"]["psnr_db"], 2),
        "psnr_moving_db": round(report["test"]["psnr_moving_db"] or 0.0, 2),
        "depth_error_mm": round(1e3 * (report["test"]["depth_error_m"] or 0.0), 1),
    }


def threads_each() -> int:
    """Half of the cores, one at least."""
    return max(1, (os.cpu_count() or 1) // len(RUNS))


def show(scene: str, runs: dict) -> None:
    """A table of one scene."""
    fields = ["cpu_ms", "ms", "train_seconds", "gaussians", "dynamic", "psnr_db", "psnr_moving_db", "depth_error_mm"]
    say = lambda text: print(text, file=sys.stderr, flush=True)  # noqa: E731
    say(f"{scene}: {runs['cpu_ratio']} times, {runs['gained_db']:+} dB")
    say("  " + " " * 18 + "".join(f"{field:>16}" for field in fields))
    for kind in RUNS:
        say(f"  {kind:18}" + "".join(f"{runs[kind][field]:>16}" for field in fields))


if __name__ == "__main__":
    main()
