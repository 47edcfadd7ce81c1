"""The canonical timeline and the render profiles.

Owns the numbers that every module and the Rust side agree on; knows nothing of Blender.
"""

from __future__ import annotations

from dataclasses import dataclass

FPS = 24
FRAME_COUNT = 97
LAST_FRAME = FRAME_COUNT - 1
MIN_EVENT_FRAMES = 13
CAMERA_COUNT = 17
BPY_VERSION = "4.5.15"


@dataclass(frozen=True)
class Profile:
    """A sampling of the benchmark: image size in pixels, frame stride, number of training views."""

    name: str
    width: int
    height: int
    stride: int
    training_views: int

    @property
    def frames(self) -> range:
        """Canonical frame numbers that this profile renders."""
        return range(0, FRAME_COUNT, self.stride)


PROFILES = {
    profile.name: profile
    for profile in (
        Profile("tiny", 128, 96, 12, 4),
        Profile("small", 256, 192, 2, 12),
        Profile("full", 640, 480, 1, 16),
    )
}
