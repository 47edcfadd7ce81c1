"""Which cameras see which objects, counted with a quick id-only render; and which camera is held out.

The id pass is bit-stable: the choice of the test view is a function of the recipe and the seed.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from statistics import median

import numpy as np

from ..scene.cameras import training_subset
from ..scene.scene import Scene
from ..scene.timeline import PROFILES
from .passes import Renderer

GATE_PIXELS = 150  # at the size of the small profile
GATE_SHARE = 0.8  # of the sampled frames
GATE_VIEWS = 6  # training views of the small profile that should see each object at any moment
_FRAMES = range(0, 97, 12)
_SHRINK = 2


@dataclass(frozen=True)
class Visibility:
    """Pixels by camera and object name: one count per sampled frame, scaled to the small profile."""

    pixels: dict[str, dict[str, list[int]]]

    def share(self, camera: str, name: str) -> float:
        """In which share of the sampled frames a camera sees enough of an object."""
        counts = self.pixels[camera][name]
        return sum(count >= GATE_PIXELS for count in counts) / len(counts)

    def failing(self, camera: str) -> list[str]:
        """Objects that a camera sees too little of to be the test view."""
        return [name for name in self.pixels[camera] if self.share(camera, name) < GATE_SHARE]

    def views(self, name: str, cameras: list[str]) -> list[int]:
        """How many of the cameras see enough of an object, per sampled frame."""
        seen = np.array([self.pixels[camera][name] for camera in cameras]) >= GATE_PIXELS
        return seen.sum(axis=0).tolist()


def measure(scene: Scene, threads: int = 0) -> Visibility:
    """Renders ids at a quarter of the small profile's pixels from all cameras and counts."""
    small = PROFILES["small"]
    renderer = Renderer(small.width // _SHRINK, small.height // _SHRINK, 1, threads=threads)
    objects = [instance for instance in scene.instances if instance.role == "object"]
    pixels: dict[str, dict[str, list[int]]] = {
        camera.name: {instance.name: [] for instance in objects} for camera in scene.camera_rig
    }
    for frame in _FRAMES:
        for camera, (_, ids) in renderer.exact(list(pixels), frame).items():
            counts = np.bincount(ids.ravel(), minlength=1000)
            for instance in objects:
                pixels[camera][instance.name].append(int(counts[instance.id]) * _SHRINK**2)
    renderer.close()
    return Visibility(pixels)


def choose_test(visibility: Visibility, rng: random.Random) -> str:
    """Draws the test view among the inner cameras that pass; the one that fails least if none does."""
    inner = list(visibility.pixels)[1:-1]
    passing = [camera for camera in inner if not visibility.failing(camera)]
    if passing:
        return rng.choice(passing)

    def badness(camera: str) -> tuple[int, float]:
        shares = [visibility.share(camera, name) for name in visibility.pixels[camera]]
        return len(visibility.failing(camera)), -sum(shares)

    return min(inner, key=badness)


def report(visibility: Visibility, test: str) -> dict:
    """The gate's numbers for plan.json."""
    cameras = list(visibility.pixels)
    others = [camera for camera in cameras if camera != test]
    training = training_subset(others, PROFILES["small"].training_views)
    views = {name: visibility.views(name, training) for name in visibility.pixels[test]}
    return {
        "pixels": GATE_PIXELS,
        "share": GATE_SHARE,
        "frames": list(_FRAMES),
        "test": test,
        "passing": [camera for camera in cameras[1:-1] if not visibility.failing(camera)],
        "test_share": {name: round(visibility.share(test, name), 6) for name in visibility.pixels[test]},
        "test_pixels": {name: int(median(counts)) for name, counts in visibility.pixels[test].items()},
        "small_training_views": {
            name: {"min": min(counts), "median": int(median(counts))} for name, counts in views.items()
        },
    }


def warnings(visibility: Visibility, test: str) -> list[tuple[str, dict[str, object]]]:
    """What falls short: (message, numbers)."""
    found: list[tuple[str, dict[str, object]]] = []
    failing = visibility.failing(test)
    if failing:
        found.append(
            (
                f"no inner camera sees every object well; {test} sees too little of {', '.join(failing)}",
                {name: round(visibility.share(test, name), 6) for name in failing},
            )
        )
    views = report(visibility, test)["small_training_views"]
    rare = {name: counts["median"] for name, counts in views.items() if counts["median"] < GATE_VIEWS}
    if rare:
        message = f"seen in fewer than {GATE_VIEWS} training views of small: {', '.join(rare)}"
        found.append((message, dict(rare)))
    return found
