"""How a town looks: asphalt, paving, kerb stone, render and brick, glazing, car paint, tyres, street metal.

Each function makes a new material. Ground and walls take their textures from world positions (they never
move); what moves takes them from its own space. Knows surfaces; refuses to know shapes.
"""

from __future__ import annotations

import random

import bpy

from ...scene.colour import Colour
from .base import Nodes, Socket, principled
from .products import scaled


def asphalt(name: str, *, wetness: float = 0.0, tone: float = 0.055) -> bpy.types.Material:
    """Rolled asphalt with chippings, patches and tyre-polished tracks; `wetness` 0..1 leaves puddles."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (tone, tone, tone, 1.0)
    n = Nodes(material)
    flat = n.world_position()
    broad = n.noise(0.35, 3.0, vector=flat)
    grit = n.noise(55.0, 2.0, vector=flat)
    grey = (tone, tone * 1.0, tone * 1.03)
    base = n.ramp(broad, [(0.3, scaled(grey, 0.72)), (0.7, scaled(grey, 1.25))])
    speckled = n.mix(0.55, base, n.ramp(grit, [(0.35, 0.25), (0.62, 0.75)]), blend="OVERLAY")
    oil = n.ramp(n.noise(0.9, 2.0, vector=flat), [(0.58, 0.0), (0.72, 0.55)])
    colour = n.mix(oil, speckled, scaled(grey, 0.42))
    rough: Socket | float = n.map_range(grit, 0.3, 0.7, 0.78, 0.95)
    if wetness > 0.0:
        pool = n.ramp(n.noise(0.55, 4.0, vector=flat), [(0.60 - 0.25 * wetness, 0.0), (0.74, 1.0)])
        colour = n.mix(pool, colour, scaled(grey, 0.50))
        rough = n.map_range(pool, 0.0, 1.0, 0.62, 0.16)
    n.set("Base Color", colour)
    n.set("Roughness", rough)
    n.bump(grit, 0.35, 0.004)
    return material


def paving(
    name: str,
    colours: tuple[Colour, Colour],
    *,
    slab_m: tuple[float, float] = (0.60, 0.40),
    joint: Colour = (0.10, 0.095, 0.085),
    stain: float = 0.5,
) -> bpy.types.Material:
    """Slabs in courses along X, each of its own tone, with dirty joints and footworn stains."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    flat = n.world_position()
    slabs, in_joint = n.brick(
        1.0, colours, joint, vector=flat, width=slab_m[0], height=slab_m[1], mortar_size=0.008
    )
    dirt = n.ramp(n.noise(0.8, 4.0, vector=flat), [(0.35, 1.0 - 0.55 * stain), (0.65, 1.0)])
    grain = n.ramp(n.noise(70.0, 2.0, vector=flat), [(0.3, 0.82), (0.7, 1.0)])
    colour = n.mix(1.0, n.mix(1.0, slabs, dirt, blend="MULTIPLY"), grain, blend="MULTIPLY")
    spots = n.ramp(n.voronoi(2.3, vector=flat), [(0.035, 0.45), (0.055, 0.0)])
    n.set("Base Color", n.mix(spots, colour, (0.05, 0.047, 0.045)))
    n.set("Roughness", 0.82)
    n.bump(n.math("SUBTRACT", 1.0, in_joint), 0.6, 0.004)
    return material


def stone(name: str, colour: Colour = (0.40, 0.39, 0.37)) -> bpy.types.Material:
    """Kerb stones, sills and plinths: flecked granite, darker where it is soiled."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    place = n.world_position()
    fleck = n.ramp(
        n.noise(120.0, 2.0, vector=place), [(0.35, scaled(colour, 0.55)), (0.65, scaled(colour, 1.1))]
    )
    soil = n.ramp(n.noise(1.7, 3.0, vector=place), [(0.35, 0.62), (0.65, 1.0)])
    n.set("Base Color", n.mix(1.0, fleck, soil, blend="MULTIPLY"))
    n.set("Roughness", 0.8)
    n.bump(n.noise(45.0, 3.0, vector=place), 0.3, 0.003)
    return material


def road_paint(name: str, colour: Colour = (0.72, 0.71, 0.67)) -> bpy.types.Material:
    """Thermoplastic road marking, worn through in places."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    place = n.world_position()
    worn = n.ramp(n.noise(9.0, 5.0, roughness=0.7, vector=place), [(0.36, 0.75), (0.50, 0.0)])
    dirt = n.ramp(n.noise(1.3, 2.0, vector=place), [(0.3, scaled(colour, 0.72)), (0.7, colour)])
    n.set("Base Color", n.mix(worn, dirt, (0.07, 0.07, 0.072)))
    n.set("Roughness", 0.7)
    return material


def render(name: str, colour: Colour) -> bpy.types.Material:
    """Painted render of a facade: rain streaks from above, soiled towards the pavement."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    place = n.world_position()
    streaks = n.noise(2.2, 4.0, vector=n.mapping(place, scale=(1.6, 1.6, 0.12)))
    tone = n.ramp(streaks, [(0.3, scaled(colour, 0.78)), (0.7, scaled(colour, 1.04))])
    _, _, height = n.separate(place)
    splash = n.map_range(height, 0.0, 0.9, 0.66, 1.0)
    n.set("Base Color", n.mix(1.0, tone, splash, blend="MULTIPLY"))
    n.set("Roughness", 0.9)
    n.bump(n.noise(60.0, 3.0, vector=place), 0.35, 0.004)
    return material


def brickwork(name: str, colours: tuple[Colour, Colour] | None = None) -> bpy.types.Material:
    """Brick courses on walls that run along X or Y."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    x, y, z = n.separate(n.world_position())
    along = n.combine(n.math("ADD", x, y), z, 0.0)
    colour, joint = n.brick(
        1.0,
        colours or ((0.30, 0.105, 0.06), (0.20, 0.075, 0.05)),
        (0.34, 0.31, 0.27),
        vector=along,
        width=0.24,
        height=0.08,
        mortar_size=0.010,
    )
    soot = n.ramp(n.noise(0.7, 4.0, vector=along), [(0.3, 0.65), (0.7, 1.05)])
    n.set("Base Color", n.mix(1.0, colour, soot, blend="MULTIPLY"))
    n.set("Roughness", 0.9)
    n.bump(n.math("SUBTRACT", 1.0, joint), 0.5, 0.006)
    return material


def window_pane(name: str, *, lit: Colour | None = None, strength: float = 0.6) -> bpy.types.Material:
    """An opaque pane: dark rooms with a pale sky over them; `lit` lamps glow behind it in some places."""
    material = bpy.data.materials.new(name)
    material.cycles.emission_sampling = "NONE"
    n = Nodes(material)
    place = n.world_position()
    _, _, height = n.separate(place)
    cloud = n.noise(0.5, 3.0, vector=place)
    sky = n.math("ADD", n.map_range(height, 0.4, 7.0, 0.0, 0.55), n.math("MULTIPLY", cloud, 0.5))
    n.set("Base Color", n.ramp(sky, [(0.2, (0.012, 0.016, 0.020)), (0.75, (0.10, 0.13, 0.16))]))
    n.set("Roughness", 0.09)
    n.set("Specular IOR Level", 0.7)
    if lit is not None:
        rooms, _, _ = n.separate(n.voronoi(0.45, vector=place, output="Color"))
        n.set("Emission Color", n.mix(1.0, lit, rooms, blend="MULTIPLY"))
        n.set("Emission Strength", strength)
    return material


def car_paint(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Clear-coated car paint with dust along the sills."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*colour, 1.0)
    n = Nodes(material)
    place = n.object_coords()
    shift = tuple(rng.uniform(-9.0, 9.0) for _ in range(3))
    moved = n.vector_math("ADD", place, shift)
    flake = n.noise(260.0, 1.0, vector=moved)
    tone = n.ramp(flake, [(0.3, scaled(colour, 0.86)), (0.7, scaled(colour, 1.10))])
    _, _, height = n.separate(place)
    dusty = n.math(
        "MULTIPLY",
        n.map_range(height, 0.62, 0.18, 0.0, 0.75),
        n.map_range(n.noise(4.0, 4.0, vector=moved), 0.35, 0.7, 0.1, 1.0),
    )
    n.set("Base Color", n.mix(dusty, tone, (0.20, 0.18, 0.155)))
    n.set("Metallic", 0.15)
    n.set("Roughness", n.map_range(dusty, 0.0, 0.6, 0.30, 0.75))
    n.set("Coat Weight", 0.8)
    n.set("Coat Roughness", 0.06)
    return material


def car_glass(name: str) -> bpy.types.Material:
    """Tinted car windows, opaque: almost black, bright only by what they reflect."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    _, _, height = n.separate(n.object_coords())
    n.set("Base Color", n.ramp(height, [(0.9, (0.012, 0.014, 0.016)), (1.0, (0.05, 0.06, 0.068))]))
    n.set("Roughness", 0.06)
    n.set("Specular IOR Level", 0.75)
    return material


def tyre(name: str) -> bpy.types.Material:
    """Black rubber, greyed by the road."""
    return principled(
        name, (0.022, 0.022, 0.023), roughness=0.86, variation=0.35, variation_scale=18.0, bump=(140.0, 0.002)
    )


def street_metal(name: str, colour: Colour = (0.06, 0.065, 0.07)) -> bpy.types.Material:
    """Powder-coated posts and frames, scuffed."""
    material = principled(name, colour, roughness=0.45, variation=0.25, variation_scale=7.0, metallic=0.2)
    material.node_tree.nodes["Principled BSDF"].inputs["Coat Weight"].default_value = 0.1
    return material


def steel(name: str) -> bpy.types.Material:
    """Brushed stainless steel, dull enough not to mirror."""
    return principled(
        name, (0.48, 0.49, 0.50), roughness=0.38, metallic=0.9, variation=0.18, variation_scale=25.0
    )
