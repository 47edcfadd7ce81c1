"""Writes the smallest recipe of a new scene, which builds and renders as it is: a start to change."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from . import files
from .recipes import WorkerError

SCALES = ("outdoor", "room", "tabletop")

_RECIPE = '''\
"""One of two red balls rolls past two blue ones.

Story. What happens, who is the twin of whom, and which of place, time and contact tells them apart.

Axes: the floor is z = 0, cameras are on the -Y side; metres; a heading of 0 degrees faces -Y.
"""

from __future__ import annotations

from l4d_blender.motion.ball_games import RollingBall, slowing
from l4d_blender.scene.scene import Scene

SCALE = "{scale}"

RADIUS_M = {radius}
BALLS = {{
    "ball_rolling": ("red", (-{far}, -{near})),
    "ball_still": ("red", ({far}, {mid})),
    "ball_left": ("blue", (-{mid}, {far})),
    "ball_right": ("blue", ({mid}, -{far})),
}}


def build(scene: Scene) -> None:
    """Sets the place, lets things happen, lights it and places the cameras."""
    {place}
    scene.add(1001, "{landmark}", "{landmark}", (0.0, {behind}))
    balls = {{}}
    for id, (name, (colour, (x, y))) in enumerate(BALLS.items(), 1):
        ball = scene.add(id, "ball", name, attributes={{"colour": colour}}, colour=colour, radius_m=RADIUS_M)
        balls[name] = RollingBall(ball, RADIUS_M, (x, y, RADIUS_M))
    balls["ball_rolling"].roll_along([({mid}, -{near}, RADIUS_M)], (12, 72), slowing())
    for ball in balls.values():
        ball.finish()
    {light}
    scene.cameras(
        (0, 0, {look}), radius_m={away}, heights_m=({low}, {high}), arc_deg=110, facing_deg=-90, fov_deg=48
    )
'''

_PLACES: dict[str, dict[str, Any]] = {
    "outdoor": {
        "unit": 1.0,
        "place": 'scene.make("ground", "ground")',
        "landmark": "haystack",
        "light": "scene.sky(sun_elevation_deg=35.0, sun_azimuth_deg=-60.0)\n"
        "    scene.sun(elevation_deg=35.0, azimuth_deg=-60.0)",
    },
    "room": {
        "unit": 0.6,
        "place": 'scene.make("room", "room")',
        "landmark": "toy_chest",
        "light": 'scene.hdri("interior", 0.5)\n'
        '    scene.area_light("ceiling", (0.0, -0.5, 2.4), (0.0, 0.0, 0.0), size_m=(2.0, 1.0), power_w=60)',
    },
    "tabletop": {
        "unit": 0.16,
        "place": 'scene.make("dining_table", "table")',
        "landmark": "biscuit_tin",
        "light": 'scene.hdri("interior", 0.5)\n'
        '    scene.area_light("lamp", (0.5, -0.3, 1.0), (0.0, 0.0, 0.0), size_m=(0.5, 0.5), power_w=15)',
    },
}
_LENGTHS = {
    "radius": 0.16,
    "near": 0.45,
    "mid": 0.70,
    "far": 0.95,
    "behind": 1.3,
    "look": 0.25,
    "away": 4.4,
    "low": 1.4,
    "high": 2.2,
}


def write(name: str, folder: Path) -> Path:
    """Writes `folder`/`name`.py; the part of the name before its first _ is the scene's scale."""
    scale = name.partition("_")[0]
    if scale not in SCALES or not re.fullmatch(r"[a-z]+(_[a-z0-9]+)+", name):
        raise WorkerError(f"no scene can be called {name!r}", f"<{'|'.join(SCALES)}>_<what>, in snake_case")
    path = folder / f"{name}.py"
    if path.exists():
        raise WorkerError(f"{path} exists", "look at it with --scene, or choose another name")
    lengths = {key: f"{length * _PLACES[scale]['unit']:.3g}" for key, length in _LENGTHS.items()}
    folder.mkdir(parents=True, exist_ok=True)
    files.write_bytes(path, _RECIPE.format(scale=scale, **_PLACES[scale], **lengths).encode())
    return path
