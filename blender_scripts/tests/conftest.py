"""The toy yard, planned and rendered once by the real worker, for all tests that read its files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parent
TOY = HERE / "recipes"
WIDTH, HEIGHT = 128, 96
EXIT_STATUS = pytest.StashKey[int]()


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """Ends the process at once: the destructors of bpy's C++ code sometimes wait for a thread for ever."""
    status = config.stash.get(EXIT_STATUS, None)
    if "bpy" in sys.modules and status is not None:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    session.config.stash[EXIT_STATUS] = int(exitstatus)


def first_of(values: Iterable[Any]) -> list:
    """Parameters of a long test: the first value is in the plain suite, the others are slow."""
    return [pytest.param(value, marks=[pytest.mark.slow] * bool(k)) for k, value in enumerate(values)]


def start_worker(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs `python -m l4d_blender` to its end."""
    command = [sys.executable, "-m", "l4d_blender", *arguments]
    no_input = subprocess.DEVNULL  # a worker whose stdin is a pipe ends when that closes
    return subprocess.run(command, cwd=PROJECT, stdin=no_input, capture_output=True, text=True, timeout=300)


def events_of(process: subprocess.CompletedProcess[str]) -> list[dict]:
    """stdout, which must be JSON Lines and nothing else."""
    return [json.loads(line) for line in process.stdout.splitlines()]


def write_job(
    path: Path, out: Path, tracks: Path, images: list[tuple[str, int]], changes: dict | None = None
) -> Path:
    """A render job of the toy yard at a tiny size."""
    job = {
        "schema": "l4d/render-job/1",
        "scene": "toy_yard",
        "seed": 0,
        "profile": "tiny",
        "width": WIDTH,
        "height": HEIGHT,
        "samples": 1,
        "denoise": False,
        "threads": 2,
        "out": str(out),
        "images": [{"view": view, "frame": frame} for view, frame in images],
        "tracks": str(tracks),
        "recipes": str(TOY),
    }
    path.write_text(json.dumps(job | (changes or {})))
    return path


@pytest.fixture(scope="session")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with tracks.json, scene.usdc and plan.json of the toy yard."""
    out = tmp_path_factory.mktemp("planned")
    process = start_worker("plan", "--scene", "toy_yard", "--recipes", str(TOY), "--out", str(out))
    assert process.returncode == 0, process.stdout + process.stderr
    return out


@pytest.fixture(scope="session")
def tracks(planned: Path) -> dict:
    return json.loads((planned / "tracks.json").read_text())


@pytest.fixture(scope="session")
def test_view(tracks: dict) -> str:
    return next(camera["name"] for camera in tracks["cameras"] if camera["split"] == "test")


@pytest.fixture(scope="session")
def rendered(planned: Path, test_view: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with frames 0, 48 and 96 of two views, rendered in one session."""
    out = tmp_path_factory.mktemp("rendered")
    images = [(view, frame) for view in ("cam00", test_view) for frame in (96, 0, 48)]
    process = start_worker("render", str(write_job(out / "job.json", out, planned / "tracks.json", images)))
    assert process.returncode == 0, process.stdout + process.stderr
    events = events_of(process)
    assert [event["event"] for event in events] == ["start"] + ["image"] * 6 + ["done"]
    assert [event["frame"] for event in events[1:-1]] == [0, 0, 48, 48, 96, 96], "frames outer, cameras inner"
    return out
