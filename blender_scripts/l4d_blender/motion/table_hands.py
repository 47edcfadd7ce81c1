"""Hands that move all sorts of small things on a table.

Adds to `Roller` what is no grip: fingertips that push, a palm that lies on something. Knows timing and touch.
"""

from __future__ import annotations

from ..scene.scene import Instance
from .hands import Frames, Point
from .rolling import Roller

_LOOSE = ("push", "touch", "flat", "mouse")  # the palm or the fingertips lie on the thing


class TableHand(Roller):
    """A hand that knows when it holds something and when it only touches it."""

    _grip = ""

    def approach(
        self,
        thing: Instance,
        frames: Frames,
        *,
        grip: str = "top",
        heading_deg: float | None = None,
        point: Point | None = None,
    ) -> None:
        """As `Hand.approach`; fingertips that only push don't hold."""
        self._grip = grip
        super().approach(thing, frames, grip=grip, heading_deg=heading_deg, point=point)

    def touch(self, frames: Frames) -> None:
        """Lies on what it reached for, and neither holds nor moves it."""
        thing = self._require("touch")
        self._grip = "touch"
        self.scene.event(self.instance, "touch", frames, thing)

    def _note_hold(self, thing: Instance, until: int) -> None:
        if self._grip not in _LOOSE:
            super()._note_hold(thing, until)
