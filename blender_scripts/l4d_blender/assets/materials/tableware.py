"""Surfaces of a laid table: checked and striped cloth, enamel, crust, fruit skin, wax, petals.

Owns how food and table linen look close up. Knows no object: features are in metres or per metre. Each call
makes a new material; `rng` shifts its pattern.
"""

from __future__ import annotations

import random

import bpy

from ...scene.colour import Colour
from .base import Nodes, Socket
from .products import scaled


def gingham(
    name: str,
    colour: Colour,
    rng: random.Random,
    *,
    ground: Colour = (0.72, 0.69, 0.62),
    check_m: float = 0.04,
) -> bpy.types.Material:
    """Checked cotton: stripes of one colour both ways, darkest where they cross."""
    material, n, coords = _start(name, colour, rng)
    x, y, _ = n.separate(n.object_coords())
    threads = n.noise(700.0, 2.0, vector=coords)
    both = n.math("ADD", _stripe(n, x, check_m), _stripe(n, y, check_m))
    tone = n.ramp(
        n.math("MULTIPLY", both, 0.5),
        [(0.0, ground), (0.5, tuple(0.52 * g + 0.48 * c for g, c in zip(ground, colour))), (1.0, colour)],
    )
    slow = n.noise(7.0, 3.0, vector=coords)
    tone = n.mix(n.map_range(slow, 0.3, 0.7), n.hue(tone, value=0.88), n.hue(tone, value=1.05))
    n.set("Base Color", n.mix(n.map_range(threads, 0.35, 0.65), n.hue(tone, value=0.82), tone))
    n.set("Roughness", 0.92)
    n.set("Sheen Weight", 0.2)
    n.bump(threads, 0.6, 0.0012)
    return material


def linen(
    name: str,
    colour: Colour,
    rng: random.Random,
    *,
    stripe: Colour | None = None,
    stripe_at_m: tuple[float, ...] = (),
    stripe_m: float = 0.006,
    axis: str = "X",
) -> bpy.types.Material:
    """Slubbed linen; `stripe` is woven in where the coordinate along `axis` has these distances from 0."""
    material, n, coords = _start(name, colour, rng)
    warp = n.noise(420.0, 2.0, vector=n.mapping(coords, scale=(1.0, 0.06, 1.0)))
    weft = n.noise(420.0, 2.0, vector=n.mapping(coords, scale=(0.06, 1.0, 1.0)))
    weave = n.math("MULTIPLY", n.math("ADD", warp, weft), 0.5)
    slow = n.noise(9.0, 3.0, vector=coords)
    tone = n.ramp(slow, [(0.3, scaled(colour, 0.86)), (0.7, scaled(colour, 1.05))])
    if stripe is not None:
        x, y, _ = n.separate(n.object_coords())
        along = n.math("ABSOLUTE", x if axis == "X" else y)
        for place in stripe_at_m:
            near = n.math("LESS_THAN", n.math("ABSOLUTE", n.math("SUBTRACT", along, place)), 0.5 * stripe_m)
            tone = n.mix(near, tone, stripe)
    n.set(
        "Base Color", n.mix(n.map_range(weave, 0.38, 0.62), n.hue(tone, value=0.78), n.hue(tone, value=1.08))
    )
    n.set("Roughness", 0.93)
    n.set("Sheen Weight", 0.2)
    n.bump(weave, 0.7, 0.0010)
    return material


def enamel(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Vitreous enamel on sheet steel: glossy, faintly speckled, with slow waves in the coat."""
    material, n, coords = _start(name, colour, rng)
    specks = n.math("LESS_THAN", n.voronoi(190.0, vector=coords), 0.11)
    tone = n.ramp(
        n.noise(18.0, 3.0, vector=coords), [(0.3, scaled(colour, 0.88)), (0.7, scaled(colour, 1.06))]
    )
    n.set("Base Color", n.mix(n.math("MULTIPLY", specks, 0.55), tone, scaled(colour, 0.35)))
    n.set("Roughness", 0.16)
    n.set("Coat Weight", 0.4)
    n.set("Coat Roughness", 0.05)
    n.bump(n.noise(45.0, 2.0, vector=coords), 0.3, 0.0006)
    return material


def crust(
    name: str, rng: random.Random, *, colour: Colour = (0.46, 0.22, 0.075), floured: float = 0.35
) -> bpy.types.Material:
    """Baked dough: brown ridges, paler cracks, a dusting of flour where it looks up."""
    material, n, coords = _start(name, colour, rng)
    bubbles = n.noise(70.0, 5.0, vector=coords, roughness=0.65)
    tone = n.ramp(bubbles, [(0.28, scaled(colour, 0.40)), (0.5, colour), (0.72, scaled(colour, 1.7))])
    if floured > 0.0:
        _, _, up = n.separate(n.world_normal())
        dust = n.math(
            "MULTIPLY", n.map_range(up, 0.2, 0.9), n.map_range(n.noise(55.0, 4.0, vector=coords), 0.45, 0.7)
        )
        tone = n.mix(n.math("MULTIPLY", dust, floured), tone, (0.80, 0.74, 0.64))
    n.set("Base Color", tone)
    n.set("Roughness", 0.85)
    n.bump(bubbles, 0.8, 0.0022)
    return material


def crumb(name: str, rng: random.Random, *, colour: Colour = (0.72, 0.56, 0.34)) -> bpy.types.Material:
    """The cut face of bread: pale, full of holes."""
    material, n, coords = _start(name, colour, rng)
    holes = n.voronoi(170.0, vector=n.mapping(coords, scale=(1.0, 0.7, 1.3)))
    tone = n.ramp(holes, [(0.10, scaled(colour, 0.55)), (0.35, colour), (0.8, scaled(colour, 1.15))])
    n.set("Base Color", tone)
    n.set("Roughness", 0.95)
    n.bump(holes, 0.7, 0.0018)
    return material


def apple_skin(name: str, ground: Colour, blush: Colour, rng: random.Random) -> bpy.types.Material:
    """Streaks from stem to calyx (the Z axis), a blush on one side, pale lenticels, russet in the hollow."""
    material, n, coords = _start(name, ground, rng)
    x, y, z = n.separate(n.object_coords())
    around = n.vector_math("NORMALIZE", n.combine(x, y, 0.0))
    flow = n.vector_math(
        "ADD", around, n.combine(rng.uniform(0, 9), rng.uniform(0, 9), n.math("MULTIPLY", z, 5.0))
    )
    streaks = n.noise(9.0, 4.0, vector=flow, roughness=0.62)
    side = n.noise(0.9, 1.0, vector=flow)
    level = n.math("ADD", n.math("MULTIPLY", streaks, 0.62), n.math("MULTIPLY", side, 0.75))
    tone = n.ramp(
        level,
        [
            (0.50, ground),
            (0.62, tuple(0.5 * (a + b) for a, b in zip(ground, blush))),
            (0.74, blush),
            (0.92, scaled(blush, 0.62)),
        ],
    )
    spots = n.math("LESS_THAN", n.voronoi(150.0, vector=coords), 0.13)
    tone = n.mix(n.math("MULTIPLY", spots, 0.55), tone, scaled(ground, 1.35))
    radius = n.math("SQRT", n.math("ADD", n.math("POWER", x, 2.0), n.math("POWER", y, 2.0)))
    hollow = n.math("MULTIPLY", n.map_range(radius, 0.015, 0.004), n.map_range(z, 0.03, 0.05))
    n.set("Base Color", n.mix(n.math("MULTIPLY", hollow, 0.8), tone, (0.17, 0.13, 0.04)))
    n.set("Roughness", n.map_range(n.noise(60.0, 2.0, vector=coords), 0.3, 0.7, 0.22, 0.36))
    n.set("Coat Weight", 0.2)
    n.bump(n.noise(140.0, 2.0, vector=coords), 0.2, 0.0004)
    return material


def peel(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Citrus peel: pores all over."""
    material, n, coords = _start(name, colour, rng)
    pores = n.voronoi(330.0, vector=coords)
    tone = n.ramp(
        n.noise(30.0, 3.0, vector=coords), [(0.3, scaled(colour, 0.82)), (0.7, scaled(colour, 1.1))]
    )
    n.set("Base Color", n.mix(n.map_range(pores, 0.25, 0.0), tone, scaled(colour, 0.6)))
    n.set("Roughness", 0.42)
    n.bump(pores, 0.5, 0.0010)
    return material


def ripe_skin(name: str, colour: Colour, spots: Colour, rng: random.Random) -> bpy.types.Material:
    """Smooth fruit skin with brown flecks (bananas, pears)."""
    material, n, coords = _start(name, colour, rng)
    flecks = n.math("LESS_THAN", n.noise(120.0, 3.0, vector=coords), 0.36)
    tone = n.ramp(
        n.noise(22.0, 3.0, vector=coords), [(0.3, scaled(colour, 0.84)), (0.7, scaled(colour, 1.08))]
    )
    n.set("Base Color", n.mix(n.math("MULTIPLY", flecks, 0.75), tone, spots))
    n.set("Roughness", 0.46)
    n.bump(n.noise(90.0, 2.0, vector=coords), 0.25, 0.0008)
    return material


def wax(name: str, colour: Colour, rng: random.Random, *, glow: float = 0.0) -> bpy.types.Material:
    """Candle wax; `glow` lets the top shine as if the flame lit it from inside."""
    material, n, coords = _start(name, colour, rng)
    n.set(
        "Base Color", n.ramp(n.noise(25.0, 3.0, vector=coords), [(0.3, scaled(colour, 0.9)), (0.7, colour)])
    )
    n.set("Roughness", 0.45)
    if glow > 0.0:
        _, _, z = n.separate(n.generated_coords())
        n.set("Emission Color", (1.0, 0.52, 0.20))
        n.set("Emission Strength", n.math("MULTIPLY", n.math("POWER", z, 6.0), glow))
        material.cycles.emission_sampling = "NONE"  # the recipe's lamp brings the flame's light
    n.bump(n.noise(60.0, 2.0, vector=coords), 0.3, 0.0010)
    return material


def petal(name: str, colour: Colour, heart: Colour, rng: random.Random) -> bpy.types.Material:
    """Petals that differ from each other, veined."""
    material, n, coords = _start(name, colour, rng)
    each = n.node("ShaderNodeNewGeometry").outputs["Random Per Island"]
    veins = n.noise(240.0, 2.0, vector=coords)
    tone = n.mix(each, scaled(colour, 0.78), n.mix(0.35, scaled(colour, 1.12), heart))
    n.set("Base Color", n.mix(n.map_range(veins, 0.35, 0.65), n.hue(tone, value=0.85), tone))
    n.set("Roughness", 0.7)
    n.set("Sheen Weight", 0.2)
    return material


def soup(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """A thick soup with herbs and pools of cream or oil."""
    material, n, coords = _start(name, colour, rng)
    pools = n.noise(38.0, 3.0, vector=coords, distortion=1.2)
    tone = n.ramp(
        pools, [(0.3, scaled(colour, 0.8)), (0.55, colour), (0.72, tuple(0.6 * c + 0.28 for c in colour))]
    )
    herbs = n.math("LESS_THAN", n.voronoi(190.0, vector=coords), 0.16)
    n.set("Base Color", n.mix(herbs, tone, (0.045, 0.13, 0.025)))
    n.set("Roughness", 0.42)
    n.set("Specular IOR Level", 0.3)
    n.bump(n.noise(70.0, 3.0, vector=coords), 0.5, 0.0015)
    return material


def _stripe(n: Nodes, along: Socket, check_m: float) -> Socket:
    """1 on every other stripe of `check_m` metres."""
    return n.math(
        "LESS_THAN", n.math("FRACT", n.math("DIVIDE", n.math("ADD", along, 10.0), 2.0 * check_m)), 0.5
    )


def _start(name: str, colour: Colour, rng: random.Random) -> tuple[bpy.types.Material, Nodes, Socket]:
    """A fresh material, its nodes, and object coordinates shifted to a random place of the pattern."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*colour, 1.0)
    n = Nodes(material)
    place = tuple(rng.uniform(-8.0, 8.0) for _ in range(3))
    return material, n, n.vector_math("ADD", n.object_coords(), place)
