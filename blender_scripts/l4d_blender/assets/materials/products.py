"""Surfaces of made things: glaze, plastic, rubber, metal, wood, paper, cloth, leather, leaf and soil.

Owns how product materials look close up. Knows no object: sizes of features are given in metres or per metre.
Each call makes a new material; `rng` shifts its pattern, so that twins still differ in the grain.
"""

from __future__ import annotations

import random
from math import pi

import bpy

from ...scene.colour import Colour, rgb
from .base import Nodes, Socket, emission, principled


def scaled(colour: Colour, factor: float) -> Colour:
    """The colour darkened or lightened, within 0..1."""
    return rgb(min(max(c * factor, 0.0), 1.0) for c in colour)


def glaze(name: str, colour: Colour, rng: random.Random, *, speckle: float = 0.0) -> bpy.types.Material:
    """Fired glaze: glossy with slow variation of tone; `speckle` (0..1) scatters iron spots."""
    material, n, coords = _start(name, colour, rng)
    tone = n.ramp(
        n.noise(26.0, 3.0, vector=coords), [(0.3, scaled(colour, 0.90)), (0.7, scaled(colour, 1.05))]
    )
    if speckle > 0.0:
        size = n.noise(60.0, 1.0, vector=coords)
        near = n.math("LESS_THAN", n.voronoi(240.0, vector=coords), n.math("MULTIPLY", size, 0.62 * speckle))
        tone = n.mix(near, tone, scaled(colour, 0.22))
    n.set("Base Color", tone)
    n.set("Roughness", n.map_range(n.noise(40.0, 2.0, vector=coords), 0.3, 0.7, 0.10, 0.20))
    n.set("Coat Weight", 0.3)
    n.set("Coat Roughness", 0.06)
    n.bump(n.noise(90.0, 2.0, vector=coords), 0.25, 0.0004)
    return material


def stoneware(name: str, rng: random.Random, colour: Colour = (0.42, 0.30, 0.20)) -> bpy.types.Material:
    """Bare clay: matt, sandy, with dark grains."""
    material, n, coords = _start(name, colour, rng)
    grain = n.ramp(n.noise(420.0, 3.0, vector=coords), [(0.35, scaled(colour, 0.62)), (0.6, colour)])
    n.set("Base Color", grain)
    n.set("Roughness", 0.86)
    n.bump(n.noise(300.0, 3.0, vector=coords), 0.5, 0.0008)
    return material


def liquid(name: str, colour: Colour) -> bpy.types.Material:
    """The still surface of an opaque drink."""
    return principled(name, colour, roughness=0.14, specular=0.3)


def satin_plastic(
    name: str, colour: Colour, rng: random.Random, *, roughness: float = 0.42
) -> bpy.types.Material:
    """Moulded plastic: fine spark-eroded grain, slight wear where it is touched."""
    material, n, coords = _start(name, colour, rng)
    wear = n.noise(28.0, 3.0, vector=coords)
    n.set("Base Color", n.ramp(wear, [(0.3, scaled(colour, 0.9)), (0.75, scaled(colour, 1.12))]))
    n.set("Roughness", n.map_range(wear, 0.3, 0.7, max(roughness - 0.08, 0.05), min(roughness + 0.08, 1.0)))
    n.bump(n.noise(900.0, 2.0, vector=coords), 0.2, 0.0003)
    return material


def rubber(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Soft matt rubber with a pimpled grip."""
    material, n, coords = _start(name, colour, rng)
    n.set(
        "Base Color", n.ramp(n.noise(60.0, 3.0, vector=coords), [(0.3, scaled(colour, 0.8)), (0.7, colour)])
    )
    n.set("Roughness", 0.78)
    n.set("Sheen Weight", 0.08)
    n.bump(n.voronoi(700.0, vector=coords), 0.35, 0.0005)
    return material


def metal(name: str, colour: Colour, rng: random.Random, *, roughness: float = 0.32) -> bpy.types.Material:
    """Brushed metal."""
    material, n, coords = _start(name, colour, rng)
    brushed = n.noise(30.0, 4.0, vector=n.mapping(coords, scale=(1.0, 1.0, 24.0)))
    n.set("Base Color", n.ramp(brushed, [(0.3, scaled(colour, 0.86)), (0.7, colour)]))
    n.set("Metallic", 1.0)
    n.set("Roughness", n.map_range(brushed, 0.3, 0.7, roughness - 0.08, roughness + 0.1))
    return material


def lacquer(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Powder-coated or enamelled sheet metal: even colour, soft highlight, orange peel."""
    material, n, coords = _start(name, colour, rng)
    tone = n.noise(14.0, 3.0, vector=coords)
    n.set("Base Color", n.ramp(tone, [(0.3, scaled(colour, 0.9)), (0.7, scaled(colour, 1.06))]))
    n.set("Roughness", 0.34)
    n.set("Coat Weight", 0.15)
    n.bump(n.noise(500.0, 2.0, vector=coords), 0.25, 0.0003)
    return material


def wood(
    name: str,
    light: Colour,
    dark: Colour,
    rng: random.Random,
    *,
    grain_axis: str = "Y",
    stave_m: float | None = None,
    stave_length_m: float = 0.9,
) -> bpy.types.Material:
    """Oiled wood with growth rings and pores along an axis; `stave_m` glues it from staves of that width."""
    material, n, coords = _start(name, light, rng)
    along = {"X": (0.07, 1.0, 1.0), "Y": (1.0, 0.07, 1.0), "Z": (1.0, 1.0, 0.07)}[grain_axis]
    shift: Socket | float = 0.0
    tint = None
    if stave_m is not None:
        turned = n.mapping(n.object_coords(), rotation=(0.0, 0.0, pi / 2 if grain_axis == "Y" else 0.0))
        staves, joint = n.brick(
            1.0,
            ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
            (0.5, 0.5, 0.5),
            vector=turned,
            width=stave_length_m,
            height=stave_m,
            mortar_size=0.0006,
            offset=0.37,
        )
        tint = n.math("MULTIPLY", staves, 1.0)
        shift = n.combine(n.math("MULTIPLY", tint, 3.0), n.math("MULTIPLY", tint, 1.7), 0.0)
        coords = n.vector_math("ADD", coords, shift)
    stretched = n.mapping(coords, scale=along)
    bend = n.noise(5.0, 3.0, vector=stretched, distortion=0.4)
    rings = n.math("FRACT", n.math("MULTIPLY", bend, 11.0))
    pores = n.noise(330.0, 4.0, vector=n.mapping(coords, scale=tuple(0.35 * a for a in along)), roughness=0.7)
    middle = tuple(0.5 * (a + b) for a, b in zip(light, dark))
    figure = n.ramp(rings, [(0.0, dark), (0.12, middle), (0.55, light), (0.9, middle), (1.0, dark)])
    figure = n.mix(n.map_range(pores, 0.42, 0.62, 0.55, 0.0), figure, scaled(dark, 0.55))
    if tint is not None:
        figure = n.mix(
            0.42, figure, n.ramp(tint, [(0.0, scaled(dark, 0.85)), (1.0, scaled(light, 1.1))]), blend="MIX"
        )
        figure = n.mix(n.math("MULTIPLY", joint, 0.6), figure, scaled(dark, 0.5))
    n.set("Base Color", figure)
    n.set("Roughness", n.map_range(pores, 0.35, 0.65, 0.52, 0.36))
    n.bump(pores, 0.3, 0.0006)
    return material


def paper(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Uncoated paper: matt, faintly mottled."""
    material, n, coords = _start(name, colour, rng)
    n.set(
        "Base Color", n.ramp(n.noise(45.0, 4.0, vector=coords), [(0.3, scaled(colour, 0.93)), (0.7, colour)])
    )
    n.set("Roughness", 0.92)
    n.set("Specular IOR Level", 0.25)
    n.bump(n.noise(800.0, 2.0, vector=coords), 0.2, 0.0002)
    return material


def ruled_paper(
    name: str, colour: Colour, line: Colour, rng: random.Random, *, pitch_m: float = 0.007
) -> bpy.types.Material:
    """Paper with printed lines across Y."""
    material = paper(name, colour, rng)
    n = Nodes(material)
    _, y, _ = n.separate(n.object_coords())
    phase = n.math("FRACT", n.math("DIVIDE", n.math("ADD", y, 10.0), pitch_m))
    printed = n.math("LESS_THAN", phase, 0.13)
    tone = n.ramp(n.noise(45.0, 4.0), [(0.3, scaled(colour, 0.93)), (0.7, colour)])
    n.set("Base Color", n.mix(printed, tone, line))
    return material


def page_block(name: str, rng: random.Random, colour: Colour = (0.72, 0.66, 0.54)) -> bpy.types.Material:
    """The cut edges of a stack of pages."""
    material, n, coords = _start(name, colour, rng)
    layers = n.noise(120.0, 3.0, vector=n.mapping(coords, scale=(0.08, 0.08, 8.0)))
    n.set("Base Color", n.ramp(layers, [(0.3, scaled(colour, 0.66)), (0.62, colour)]))
    n.set("Roughness", 0.95)
    n.bump(layers, 0.5, 0.0005)
    return material


def book_cloth(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Bookbinder's linen: fine weave, rubbed lighter in patches."""
    material, n, coords = _start(name, colour, rng)
    weave = _weave(n, coords, threads_per_m=900.0)
    rubbed = n.noise(22.0, 4.0, vector=coords)
    tone = n.ramp(rubbed, [(0.3, scaled(colour, 0.82)), (0.62, colour), (0.8, scaled(colour, 1.3))])
    n.set("Base Color", n.mix(n.math("MULTIPLY", weave, 0.35), tone, scaled(colour, 0.55)))
    n.set("Roughness", 0.8)
    n.set("Sheen Weight", 0.1)
    n.bump(weave, 0.4, 0.0005)
    return material


def woven_cloth(
    name: str, colour: Colour, rng: random.Random, *, threads_per_m: float = 500.0, contrast: float = 0.45
) -> bpy.types.Material:
    """Coarser cloth: mouse mats, curtains, chair covers."""
    material, n, coords = _start(name, colour, rng)
    weave = _weave(n, coords, threads_per_m)
    tone = n.ramp(
        n.noise(18.0, 4.0, vector=coords), [(0.3, scaled(colour, 0.82)), (0.7, scaled(colour, 1.1))]
    )
    n.set("Base Color", n.mix(n.math("MULTIPLY", weave, contrast), tone, scaled(colour, 0.5)))
    n.set("Roughness", 0.9)
    n.set("Sheen Weight", 0.2)
    n.bump(weave, 0.5, 0.3 / threads_per_m)
    return material


def knit(
    name: str,
    colour: Colour,
    rng: random.Random,
    *,
    along: str = "Z",
    rib_m: float = 0.007,
    bends: bool = False,
) -> bpy.types.Material:
    """Ribbed knitwear; `along` is the axis that the ribs follow: Z on a torso, Y on a sleeve.

    `bends` reads the stored rest position, for meshes that an armature deforms.
    """
    material, n, coords = _start(name, colour, rng)
    if bends:
        coords = n.rest_coords()
    scale = 2.0 * pi / 20.0 / rib_m
    across, other = [axis for axis in "XYZ" if axis != along]
    ribs = n.math("MULTIPLY", n.wave(scale, axis=across, vector=coords, distortion=0.8), 0.6)
    ribs = n.math(
        "ADD", ribs, n.math("MULTIPLY", n.wave(scale, axis=other, vector=coords, distortion=0.8), 0.4)
    )
    stitches = n.wave(1.6 * scale, axis=along, vector=coords, distortion=2.0)
    height = n.mix(0.35, ribs, stitches)
    heather = n.noise(160.0, 3.0, vector=coords)
    tone = n.ramp(heather, [(0.3, scaled(colour, 0.62)), (0.5, colour), (0.72, scaled(colour, 1.45))])
    n.set("Base Color", n.mix(n.map_range(height, 0.2, 0.7, 0.55, 0.0), tone, scaled(colour, 0.35)))
    n.set("Roughness", 0.95)
    n.set("Specular IOR Level", 0.2)
    n.bump(height, 0.8, 0.0018)
    return material


def cork(name: str, rng: random.Random) -> bpy.types.Material:
    """Pressed cork: grains of several browns."""
    light, dark = (0.42, 0.24, 0.12), (0.20, 0.10, 0.045)
    material, n, coords = _start(name, light, rng)
    grains = n.voronoi(260.0, vector=coords, output="Color")
    n.set(
        "Base Color",
        n.ramp(n.math("MULTIPLY", grains, 1.0), [(0.15, dark), (0.5, light), (0.9, scaled(light, 1.25))]),
    )
    n.set("Roughness", 0.9)
    n.bump(n.voronoi(260.0, vector=coords), 0.4, 0.0008)
    return material


def leather(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Grained leather or leatherette."""
    material, n, coords = _start(name, colour, rng)
    grain = n.voronoi(380.0, feature="SMOOTH_F1", vector=coords)
    n.set(
        "Base Color", n.ramp(n.noise(20.0, 4.0, vector=coords), [(0.3, scaled(colour, 0.75)), (0.7, colour)])
    )
    n.set("Roughness", n.map_range(grain, 0.0, 0.6, 0.42, 0.62))
    n.bump(grain, 0.4, 0.0006)
    return material


def leaf(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Waxy leaves, each patch of them a different green."""
    material, n, coords = _start(name, colour, rng)
    patch = n.noise(38.0, 2.0, vector=coords)
    n.set(
        "Base Color",
        n.ramp(patch, [(0.28, scaled(colour, 0.45)), (0.5, colour), (0.75, scaled(colour, 1.7))]),
    )
    n.set("Roughness", 0.42)
    n.bump(n.noise(160.0, 3.0, vector=coords), 0.3, 0.0008)
    return material


def soil(name: str, rng: random.Random) -> bpy.types.Material:
    """Potting soil."""
    material, n, coords = _start(name, (0.05, 0.032, 0.02), rng)
    crumbs = n.noise(260.0, 4.0, vector=coords)
    n.set("Base Color", n.ramp(crumbs, [(0.35, (0.012, 0.008, 0.005)), (0.65, (0.09, 0.06, 0.04))]))
    n.set("Roughness", 0.95)
    n.bump(crumbs, 0.9, 0.003)
    return material


def plaster(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """A painted wall: roller texture and slow unevenness."""
    material, n, coords = _start(name, colour, rng)
    slow = n.noise(1.7, 4.0, vector=coords)
    n.set("Base Color", n.ramp(slow, [(0.3, scaled(colour, 0.90)), (0.7, scaled(colour, 1.04))]))
    n.set("Roughness", 0.88)
    n.bump(n.noise(120.0, 3.0, vector=coords), 0.35, 0.0015)
    return material


def rug(
    name: str, colour: Colour, accent: Colour, rng: random.Random, *, band_m: float = 0.22
) -> bpy.types.Material:
    """A tufted rug with woven bands along Y."""
    material, n, coords = _start(name, colour, rng)
    _, y, _ = n.separate(n.object_coords())
    phase = n.math("FRACT", n.math("DIVIDE", n.math("ADD", y, 10.0), band_m))
    tuft = n.noise(220.0, 3.0, vector=coords)
    tone = n.mix(n.math("LESS_THAN", phase, 0.28), colour, accent)
    n.set("Base Color", n.mix(n.map_range(tuft, 0.3, 0.7, 0.0, 0.5), tone, scaled(colour, 0.4)))
    n.set("Roughness", 0.97)
    n.set("Sheen Weight", 0.2)
    n.bump(tuft, 0.8, 0.004)
    return material


def glow(name: str, colour: Colour, strength: float) -> bpy.types.Material:
    """A surface that shines by itself: a screen's pixels, a bulb."""
    material = emission(name, colour, strength)
    material.cycles.emission_sampling = "NONE"  # seen, but too small to light anything: no light tree for it
    return material


def window_view(name: str, rng: random.Random, *, horizon_m: float, strength: float) -> bpy.types.Material:
    """A garden far behind a window, out of focus: foliage below `horizon_m` (object z), bright haze above."""
    material, n, coords = _start(name, (0.7, 0.8, 0.9), rng)
    _, _, z = n.separate(n.object_coords())
    clumps = n.noise(2.6, 3.0, vector=coords)
    height = n.math(
        "ADD", n.math("SUBTRACT", z, horizon_m), n.math("MULTIPLY", n.math("SUBTRACT", clumps, 0.5), 0.55)
    )
    sunlit = n.noise(9.0, 2.0, vector=coords)
    foliage = n.ramp(
        sunlit, [(0.3, (0.035, 0.085, 0.03)), (0.55, (0.14, 0.26, 0.07)), (0.75, (0.42, 0.50, 0.18))]
    )
    haze = n.ramp(clumps, [(0.3, (0.72, 0.86, 1.0)), (0.7, (1.0, 0.98, 0.94))])
    n.set("Base Color", (0.0, 0.0, 0.0))
    n.set("Specular IOR Level", 0.0)
    n.set("Emission Color", n.mix(n.map_range(height, -0.08, 0.10), foliage, haze))
    n.set("Emission Strength", strength)
    material.cycles.emission_sampling = "NONE"  # the recipe's area light brings this light in
    return material


def _start(name: str, colour: Colour, rng: random.Random) -> tuple[bpy.types.Material, Nodes, Socket]:
    """A fresh material, its nodes, and object coordinates shifted to a random place of the pattern."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*colour, 1.0)
    n = Nodes(material)
    place = tuple(rng.uniform(-8.0, 8.0) for _ in range(3))
    return material, n, n.vector_math("ADD", n.object_coords(), place)


def _weave(n: Nodes, coords: Socket, threads_per_m: float) -> Socket:
    """0 on the threads, 1 between them; scale of Blender's wave is 2 pi / 20 bands per unit."""
    scale = threads_per_m * 2.0 * pi / 20.0
    warp = n.wave(scale, axis="X", vector=coords, distortion=0.6)
    weft = n.wave(scale, axis="Y", vector=coords, distortion=0.6)
    return n.math("MULTIPLY", warp, weft)
