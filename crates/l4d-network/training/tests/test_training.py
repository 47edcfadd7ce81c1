"""The commands of docs/network.md on 2 % of the data: 12 seeds of arrangements, 120 iterations.

Needs torch, so it is no part of `tests/run`; CONTRIBUTING.md has its command.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]
TRAINING = Path(__file__).parents[1]
L4D = os.environ.get("L4D", str(ROOT / "target/release/l4d"))
SEEDS = 12
ITERATIONS = 120


def _module(name: str, *arguments: object) -> list[str]:
    return [sys.executable, "-m", f"l4d_network.{name}", *map(str, arguments)]


def _run(command: list[str], **options: object) -> None:
    subprocess.run(command, check=True, cwd=TRAINING, **options)


@pytest.fixture(scope="module")
def arrangements(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Rendered by the first command; a folder of them in L4D_ARRANGEMENTS spares that."""
    if given := os.environ.get("L4D_ARRANGEMENTS"):
        return Path(given)
    out = tmp_path_factory.mktemp("arrangements")
    blender = ["--python", os.environ["L4D_BLENDER_PYTHON"]] if "L4D_BLENDER_PYTHON" in os.environ else []
    subprocess.run([L4D, "arrange", "--out", out, "--count", str(SEEDS), *blender], check=True, cwd=ROOT)
    return out


def _train(arrangements: Path, out: Path) -> list[str]:
    every = ("--every", 10, "--report", 10, "--unseen", 3)
    return _module("train", "--data", arrangements, "--out", out, "--iterations", ITERATIONS, *every)


def _lines(path: Path) -> list[dict]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_it_learns_goes_on_where_it_was_killed_and_is_computed_in_rust(arrangements: Path, tmp_path: Path) -> None:
    run, weights = tmp_path / "run", tmp_path / "weights"
    command = _train(arrangements, run)
    with subprocess.Popen(command, cwd=TRAINING) as process:
        while not (run / "checkpoint.pt").is_file():
            assert process.poll() is None, "ended before its first checkpoint"
            time.sleep(0.5)
        process.send_signal(signal.SIGKILL)
    _run(command)
    curve = _lines(run / "curve.jsonl")
    assert [line["iteration"] for line in curve] == list(range(10, ITERATIONS + 1, 10))
    losses = [sum(line["losses"]) for line in curve]
    assert losses[-1] < 0.8 * losses[0], losses
    assert _lines(run / "unseen.jsonl")[-1]["iteration"] == ITERATIONS

    _run(_module("export", "--checkpoint", run / "checkpoint.pt", "--out", weights))
    assert (weights / "perception.onnx").stat().st_size < 12e6
    parity = ["cargo", "test", "-p", "l4d-network", "--lib", "with_other_weights", "--", "--ignored"]
    subprocess.run(parity, check=True, cwd=ROOT, env=os.environ | {"L4D_WEIGHTS": str(weights)})
