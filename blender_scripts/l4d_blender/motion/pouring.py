"""Pots that pour: where a pot has to go so that its spout fills a cup, and the tea that rises in it.

Adds to the hands that serve; knows the spouts of teapots and the walls of cups, decides nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
from mathutils import Vector

from ..assets import cup, tea, teapot
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT
from .hands import Frames
from .servers import _UPRIGHT_RAD, Server

FLOW_M_S = (0.26, -0.30)  # how tea leaves a spout: ahead and up
CLEARANCE_M = 0.055  # of a pouring spout over a lip
TIP_DEG = {"round": 50.0, "tall": 58.0}


@dataclass
class Drink:
    """The tea in one cup: its level per frame, as a share of the lip's height."""

    into: Instance
    look: cup.Look
    disc: bpy.types.Object
    level: float
    pours: list[tuple[Frames, float]] = field(default_factory=list)

    @property
    def lip_m(self) -> float:
        """Height of the lip over the foot."""
        return self.look.profile[-1][1]

    def levels(self) -> list[float]:
        """Metres over the foot at every frame."""
        found, level = [self.level * self.lip_m] * FRAME_COUNT, self.level
        for (first, last), goal in sorted(self.pours):
            rise = tea.rising(first, last, level * self.lip_m, goal * self.lip_m)
            found = [rise[f] if f >= first else found[f] for f in range(FRAME_COUNT)]
            level = goal
        return found

    def finish(self) -> None:
        """Keys the surface in the cup."""
        inner = [(r - cup.WALL_M, z) for r, z in self.look.profile if z > cup.BOTTOM_M]
        tea.key_level(self.disc, [self.into.matrix(f) for f in range(FRAME_COUNT)], inner, self.levels())


def spout_over(ahead: Vector, drink: Drink, foot: Vector) -> Vector:
    """Where a spout that points `ahead` has to be so that what leaves it falls into a cup."""
    flow = Vector((ahead.x * FLOW_M_S[0], ahead.y * FLOW_M_S[0], FLOW_M_S[1]))
    over = foot + Vector((0.0, 0.0, drink.lip_m + CLEARANCE_M))
    landing = tea.landing_point(over, flow, foot.z + 0.6 * drink.lip_m)
    return over - (landing - over) * Vector((1.0, 1.0, 0.0))


class Pourer(Server):
    """A hand that fills cups from a pot."""

    def carry_spout(self, spout: Vector, to: Vector, frames: Frames) -> None:
        """Brings a raised pot over another cup: its spout's tip arrives at a point."""
        thing = self._require("carry")
        self._swing(thing, spout, to, _UPRIGHT_RAD, frames)
        self.scene.event(self.instance, "carry", frames, thing)

    def fill(
        self,
        drink: Drink,
        look: teapot.Look,
        frames: Frames,
        *,
        to: float,
        colour: tuple[float, float, float],
    ) -> None:
        """Pours from the raised pot until a cup is filled to a share of its height."""
        pot = self._require("pour")
        wet = self.pour(drink.into, look.spout_tip, frames, tip_deg=TIP_DEG[look.shape])
        drink.pours.append(((wet[0] + 3, wet[1]), to))
        ahead = pot.matrix(frames[0]).to_3x3() @ Vector((0.0, -1.0, 0.0))
        flow = Vector((ahead.x * FLOW_M_S[0], ahead.y * FLOW_M_S[0], FLOW_M_S[1]))
        foot = drink.into.matrix(frames[0]).translation.z
        spout = pot.matrix(wet[0] + 3) @ look.spout_tip
        surface = [foot + z for z in drink.levels()]
        tea.stream(f"{pot.name}.stream_{frames[0]}", colour, spout, flow, surface, wet)
