"""The worker's command line: bad input ends with one clear line, and nobody is left behind."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import PROJECT, TOY, events_of, start_worker, write_job

from l4d_blender.worker import recipes


def failure(*arguments: str) -> dict:
    """The error event of a command that must fail; its message is one line."""
    process = start_worker(*arguments)
    assert process.returncode == 2, process.stdout + process.stderr
    (event,) = events_of(process)
    assert event["event"] == "error"
    assert "\n" not in event["message"]
    return event


def recipe(folder: Path, body: str) -> Path:
    (folder / "broken.py").write_text(
        f'"""A broken recipe."""\nSCALE = "room"\n\n\ndef build(scene):\n{body}\n'
    )
    return folder


def test_an_unknown_scene_lists_those_that_exist(tmp_path):
    event = failure("plan", "--scene", "toy_yart", "--recipes", str(TOY), "--out", str(tmp_path))
    assert "toy_yart" in event["message"]
    assert "did you mean toy_yard?" in event["hint"]
    assert not list(tmp_path.iterdir())


def test_an_unwritable_folder_is_told_before_anything_is_built(tmp_path):
    (tmp_path / "file").write_text("")
    out = tmp_path / "file" / "scene"
    event = failure("plan", "--scene", "toy_yard", "--recipes", str(TOY), "--out", str(out))
    assert str(out) in event["message"]


def test_an_error_in_a_recipe_has_its_file_and_line(tmp_path):
    folder = recipe(tmp_path, "    width = 3\n    return width / 0")
    event = failure("plan", "--scene", "broken", "--recipes", str(folder), "--out", str(tmp_path / "out"))
    assert "broken.py:7: ZeroDivisionError" in event["message"]


def test_a_rule_broken_by_a_recipe_has_file_line_and_hint(tmp_path):
    body = (
        "    from l4d_blender.assets import mesh\n"
        "    cup = scene.instance('cup', 1, 'cup', mesh.box('cup', (1, 1, 1)))\n"
        "    scene.event(cup, 'roll', (0, 5))"
    )
    folder = recipe(tmp_path, body)
    event = failure("plan", "--scene", "broken", "--recipes", str(folder), "--out", str(tmp_path / "out"))
    assert "broken.py:8: event 'cup roll' 0..5: 6 frames long" in event["message"]
    assert "at least 13" in event["hint"]


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"schema": "l4d/render-job/9"}, "schema"),
        ({"width": "wide"}, "wide"),
        ({"seed": 3}, "made for"),
        ({"images": [{"view": "cam99", "frame": 0}]}, "cam99"),
        ({"images": [{"view": "cam01", "frame": 97}]}, "frame 97"),
        ({"scene": "nowhere"}, "nowhere"),
        ({"tracks": "/nowhere/tracks.json"}, "/nowhere/tracks.json"),
    ],
)
def test_a_bad_job_names_what_is_wrong(planned, tmp_path, changes, complaint):
    job = write_job(tmp_path / "job.json", tmp_path, planned / "tracks.json", [("cam00", 0)], changes)
    assert complaint in failure("render", str(job))["message"]


def test_a_torn_job_file_is_told(tmp_path):
    (tmp_path / "job.json").write_text('{"schema": ')
    assert "not JSON" in failure("render", str(tmp_path / "job.json"))["message"]


def test_cameras_that_moved_since_the_plan_are_refused(planned, tmp_path):
    tracks = json.loads((planned / "tracks.json").read_text())
    tracks["cameras"][0]["world_from_camera"][0][3] += 0.01
    (tmp_path / "tracks.json").write_text(json.dumps(tracks))
    job = write_job(tmp_path / "job.json", tmp_path, tmp_path / "tracks.json", [("cam00", 0)])
    assert "cam00 stands elsewhere" in failure("render", str(job))["message"]


_PARENT = """
import subprocess, sys, time
command = [sys.executable, '-m', 'l4d_blender', *sys.argv[1:]]
nowhere = subprocess.DEVNULL
worker = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=nowhere, stderr=nowhere)
print(worker.pid, flush=True)
time.sleep(600)
"""


def follows_its_killed_parent(*arguments: str, when: Callable[[], object]) -> bool:
    """Whether a worker ends by itself when the process that started it is killed at a moment."""
    command = [sys.executable, "-c", _PARENT, *arguments]
    with subprocess.Popen(command, cwd=PROJECT, stdout=subprocess.PIPE, text=True) as parent:
        worker = int(parent.stdout.readline())
        _until(when, 60)
        alive = _alive(worker)
        parent.kill()
    try:
        return alive and _until(lambda: not _alive(worker), 20)
    finally:
        if _alive(worker):
            os.kill(worker, signal.SIGKILL)


@pytest.mark.skipif(os.name != "posix", reason="needs kill -9")
def test_a_render_ends_with_its_killed_parent(planned, tmp_path):
    images = [(f"cam{i:02}", frame) for i in range(17) for frame in range(97)]
    job = write_job(tmp_path / "job.json", tmp_path, planned / "tracks.json", images)
    assert follows_its_killed_parent("render", str(job), when=lambda: list(tmp_path.glob("frames/*/*.exr")))
    assert list(tmp_path.glob("frames/*/*.exr"))


@pytest.mark.skipif(os.name != "posix", reason="needs kill -9")
@pytest.mark.parametrize("moment", ["while Python starts", "while it builds"])
def test_a_long_plan_ends_with_its_killed_parent(tmp_path, moment):
    out, building = tmp_path / "out", tmp_path / "building"
    body = f"    open({str(building)!r}, 'w').close()\n    while True:\n        pass"
    plan = ("plan", "--scene", "broken", "--recipes", str(recipe(tmp_path, body)), "--out", str(out))
    when = building.exists if moment == "while it builds" else lambda: True
    assert follows_its_killed_parent(*plan, when=when)
    assert building.exists() == (moment == "while it builds")


def _until(condition: Callable[[], object], seconds: float) -> bool:
    started = time.monotonic()
    while not condition():
        if time.monotonic() - started > seconds:
            return False
        time.sleep(0.05)
    return True


def _alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().split()[2] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("name", ["outdoor_try", "room_try", "tabletop_try"])
def test_a_new_scene_renders_and_plans_at_once(tmp_path, name):
    options = ("--recipes", str(tmp_path), "--size", "32x24", "--samples", "1", "--views", "1")
    process = start_worker(
        "preview", "--new", name, *options, "--frames", "0", "--out", str(tmp_path / "out")
    )
    assert process.returncode == 0, process.stdout + process.stderr
    assert [event["event"] for event in events_of(process)] == ["written", "preview"]
    assert (tmp_path / "out" / f"{name}.png").stat().st_size > 0
    options = ("--recipes", str(tmp_path), "--out", str(tmp_path / "plan"), "--without-usd")
    process = start_worker("plan", "--scene", name, *options)
    assert [event["event"] for event in events_of(process)] == ["done"], process.stdout


def test_a_new_scene_never_replaces_one_and_has_a_scale_in_its_name(tmp_path):
    (tmp_path / "room_here.py").write_text("mine")
    assert "exists" in failure("preview", "--new", "room_here", "--recipes", str(tmp_path))["message"]
    assert (tmp_path / "room_here.py").read_text() == "mine"
    for name in ("moon_base", "room", "room_../x", "Room_Tea"):
        event = failure("preview", "--new", name, "--recipes", str(tmp_path))
        assert "outdoor|room|tabletop" in event["hint"]


def test_requirements_and_pyproject_pin_the_same_versions():
    import tomllib

    project = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]
    lines = (PROJECT / "requirements.txt").read_text().splitlines()
    pinned = project["dependencies"] + project["optional-dependencies"]["test"]
    assert sorted(pinned) == sorted(line for line in lines if line and line[0] != "#")


@pytest.mark.slow
@pytest.mark.parametrize("name", recipes.names())
def test_the_benchmark_recipes_plan_without_findings(name, tmp_path):
    process = start_worker("plan", "--scene", name, "--out", str(tmp_path), "--without-usd")
    assert process.returncode == 0, process.stdout + process.stderr
    assert [event["event"] for event in events_of(process)] == ["done"]
    tracks = json.loads((tmp_path / "tracks.json").read_text())
    assert len([entry for entry in tracks["instances"] if entry["role"] == "object"]) >= 4
    assert any(event["frames"] != [0, 96] for event in tracks["events"])
