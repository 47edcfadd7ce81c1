"""How a farm yard looks: soil, grass, stone, weathered wood, straw, sheet metal, foliage, feathers.

Each function makes a new material for one instance or one piece of scenery. Knows surfaces; refuses to know
shapes, except that the ground brings an attribute "wear" and skinned bodies an attribute "rest_position".
"""

from __future__ import annotations

import random

import bpy

from ...scene.colour import Colour, rgb
from .base import Nodes, Socket, principled

#: Enamel paints for buckets and carts, linear RGB.
PAINTS: dict[str, Colour] = {
    "red": (0.52, 0.022, 0.018),
    "blue": (0.018, 0.085, 0.36),
    "green": (0.030, 0.20, 0.055),
    "yellow": (0.66, 0.38, 0.025),
    "white": (0.72, 0.70, 0.63),
    "orange": (0.68, 0.17, 0.02),
}

#: (body, edges of the feathers, hackle, tail) in linear RGB.
PLUMAGES: dict[str, tuple[Colour, Colour, Colour, Colour]] = {
    "russet": ((0.30, 0.085, 0.022), (0.11, 0.028, 0.010), (0.48, 0.19, 0.050), (0.030, 0.022, 0.018)),
    "white": ((0.72, 0.68, 0.60), (0.50, 0.46, 0.38), (0.78, 0.72, 0.60), (0.60, 0.56, 0.48)),
    "slate": ((0.085, 0.090, 0.10), (0.030, 0.032, 0.036), (0.16, 0.155, 0.15), (0.020, 0.024, 0.024)),
    "buff": ((0.56, 0.30, 0.090), (0.34, 0.15, 0.040), (0.64, 0.38, 0.13), (0.20, 0.085, 0.030)),
}

#: Colours that the feathers of a hen's neck may have instead of those of its plumage.
NECKS: dict[str, Colour] = {
    "white": (0.76, 0.72, 0.63),
    "black": (0.020, 0.020, 0.022),
    "golden": (0.66, 0.34, 0.06),
    "grey": (0.20, 0.20, 0.20),
}

#: Light that the air adds between the camera and something far away.
HAZE: Colour = (0.95, 0.90, 0.78)


def _new(name: str, colour: Colour) -> tuple[bpy.types.Material, Nodes]:
    """A material whose textures only camera rays pay for: light that bounces sees a plain diffuse `colour`.

    Noise costs more than tracing out here, and nobody can tell what a bounced ray has seen.
    """
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*tuple(colour)[:3], 1.0)
    # Haze is emission, and must not make a lamp of every leaf.
    material.cycles.emission_sampling = "NONE"
    n = Nodes(material)
    plain = n.node("ShaderNodeBsdfDiffuse")
    n.feed(plain.inputs["Color"], colour)
    either = n.node("ShaderNodeMixShader")
    n.feed(either.inputs["Fac"], n.node("ShaderNodeLightPath").outputs["Is Camera Ray"])
    n.feed(either.inputs[1], plain.outputs["BSDF"])
    n.feed(either.inputs[2], n.bsdf.outputs["BSDF"])
    output = next(node for node in n.tree.nodes if node.type == "OUTPUT_MATERIAL")
    n.feed(output.inputs["Surface"], either.outputs["Shader"])
    return material, n


def _translucent(n: Nodes, colour: Colour, share: float) -> None:
    """Lets light glow through what is thin (leaves, blades); nothing is seen through it."""
    glow = n.node("ShaderNodeBsdfTranslucent")
    n.feed(glow.inputs["Color"], colour)
    both = n.node("ShaderNodeMixShader")
    n.feed(both.inputs["Fac"], share)
    either = n.bsdf.outputs["BSDF"].links[0].to_node
    n.feed(both.inputs[1], n.bsdf.outputs["BSDF"])
    n.feed(both.inputs[2], glow.outputs["BSDF"])
    n.feed(either.inputs[2], both.outputs["Shader"])


def _flat_noise(n: Nodes, scale: float, detail: float, *, roughness: float = 0.6) -> Socket:
    """Noise over the ground plane: half the price of noise in space."""
    socket = n.noise(scale, detail, roughness=roughness)
    socket.node.noise_dimensions = "2D"
    return socket


def _each(n: Nodes) -> Socket:
    """A number in 0..1 per mesh island: per blade, stone, board."""
    return n.node("ShaderNodeNewGeometry").outputs["Random Per Island"]


def _distant(n: Nodes, colour: Socket, *, half_at_m: float) -> None:
    """Base colour that gives way to haze with the distance from the camera."""
    distance = n.node("ShaderNodeCameraData").outputs["View Distance"]
    clear = n.math("POWER", 0.5, n.math("DIVIDE", distance, half_at_m))
    n.set("Base Color", n.mix(clear, (0.0, 0.0, 0.0), colour))
    n.set("Emission Color", HAZE)
    n.set("Emission Strength", n.math("SUBTRACT", 1.0, clear))


def _scaled(colour: Colour, factor: float) -> Colour:
    return rgb(min(1.0, factor * c) for c in colour)


# --- ground -----------------------------------------------------------------------------------------------


def yard_ground(name: str) -> bpy.types.Material:
    """Trodden soil with grit and dry stains where the attribute "wear" is 1, meadow where it is 0."""
    material, n = _new(name, (0.19, 0.15, 0.09))
    broad = _flat_noise(n, 0.45, 2.0)
    clods = _flat_noise(n, 4.5, 4.0, roughness=0.68)
    soil = n.ramp(
        clods, [(0.28, (0.095, 0.058, 0.034)), (0.5, (0.235, 0.155, 0.092)), (0.74, (0.40, 0.295, 0.19))]
    )
    soil = n.mix(n.map_range(broad, 0.46, 0.66, 0.0, 0.8), soil, (0.37, 0.285, 0.19))
    soil = n.mix(n.map_range(broad, 0.44, 0.30, 0.0, 0.55), soil, (0.095, 0.064, 0.040))
    cells = n.voronoi(30.0)
    cells.node.voronoi_dimensions = "2D"
    lot, shade, _ = n.separate(cells.node.outputs["Color"])
    is_grit = n.math("MULTIPLY", n.map_range(lot, 0.80, 0.84), n.map_range(cells, 0.42, 0.30), clamp=True)
    grit = n.ramp(shade, [(0.0, (0.13, 0.11, 0.095)), (0.6, (0.27, 0.235, 0.20)), (1.0, (0.46, 0.41, 0.34))])
    soil = n.mix(is_grit, soil, grit)

    blades = _flat_noise(n, 9.0, 3.0, roughness=0.72)
    lawn = n.ramp(
        blades, [(0.28, (0.032, 0.055, 0.012)), (0.5, (0.095, 0.140, 0.030)), (0.72, (0.22, 0.245, 0.070))]
    )
    lawn = n.mix(n.map_range(broad, 0.50, 0.70, 0.0, 0.6), lawn, (0.29, 0.26, 0.095))

    fray = n.math("MULTIPLY", n.math("SUBTRACT", blades, 0.5), 1.5)
    wear = n.map_range(n.math("ADD", n.attribute("wear"), fray), 0.30, 0.66)
    _distant(n, n.mix(wear, lawn, soil), half_at_m=320.0)
    n.set("Roughness", 0.95)
    n.set("Specular IOR Level", 0.15)
    n.bump(clods, 1.0, 0.045)
    return material


def grass_blades(name: str) -> bpy.types.Material:
    """Each blade its own green; some have dried."""
    material, n = _new(name, (0.12, 0.17, 0.04))
    fresh = n.ramp(
        _each(n),
        [
            (0.0, (0.045, 0.095, 0.016)),
            (0.4, (0.105, 0.175, 0.030)),
            (0.72, (0.19, 0.245, 0.050)),
            (0.86, (0.36, 0.32, 0.11)),
            (1.0, (0.47, 0.39, 0.17)),
        ],
    )
    dry = n.map_range(_flat_noise(n, 0.45, 1.0), 0.45, 0.66, 0.0, 0.5)
    n.set("Base Color", n.mix(dry, fresh, (0.35, 0.31, 0.11)))
    n.set("Roughness", 0.7)
    n.set("Specular IOR Level", 0.25)
    _translucent(n, (0.26, 0.33, 0.06), 0.3)
    return material


def field_stone(name: str) -> bpy.types.Material:
    """Grey to ochre stones, each of its own tone, with lichen."""
    material, n = _new(name, (0.26, 0.235, 0.20))
    tone = n.ramp(
        _each(n),
        [
            (0.0, (0.19, 0.17, 0.15)),
            (0.35, (0.33, 0.30, 0.26)),
            (0.7, (0.45, 0.385, 0.30)),
            (1.0, (0.28, 0.265, 0.255)),
        ],
    )
    grain = n.noise(16.0, 3.0, roughness=0.75)
    stone = n.mix(0.6, tone, n.ramp(grain, [(0.3, 0.25), (0.7, 1.0)]), blend="MULTIPLY")
    lichen = n.map_range(n.noise(6.0, 2.0), 0.57, 0.66, 0.0, 0.55)
    n.set("Base Color", n.mix(lichen, stone, (0.34, 0.35, 0.20)))
    n.set("Roughness", 0.9)
    n.set("Specular IOR Level", 0.2)
    n.bump(grain, 0.9, 0.015)
    return material


def mortar(name: str) -> bpy.types.Material:
    """What is left between old stones: dark, crumbling."""
    return principled(name, (0.13, 0.115, 0.095), roughness=0.95)


# --- wood, straw, rope ------------------------------------------------------------------------------------


def weathered_wood(
    name: str, tone: Colour = (0.20, 0.155, 0.115), *, grain_axis: str = "Z"
) -> bpy.types.Material:
    """Greyed boards: every board (mesh island) has its own tone; the grain runs along an object axis."""
    material, n = _new(name, tone)
    stretch = {"X": (0.8, 22.0, 22.0), "Y": (22.0, 0.8, 22.0), "Z": (22.0, 22.0, 0.8)}[grain_axis]
    each = _each(n)
    own = n.vector_math("ADD", n.object_coords(), n.combine(n.math("MULTIPLY", each, 37.0), 0.0, each))
    grain = n.noise(1.0, 3.0, roughness=0.7, vector=n.mapping(own, scale=stretch))
    wood = n.ramp(grain, [(0.28, _scaled(tone, 0.38)), (0.5, tone), (0.74, _scaled(tone, 1.7))])
    wood = n.hue(
        wood, saturation=n.map_range(each, 0.0, 1.0, 0.65, 1.25), value=n.map_range(each, 0.0, 1.0, 0.7, 1.35)
    )
    silver = n.map_range(n.noise(1.7, 1.0, vector=own), 0.48, 0.72, 0.0, 0.55)
    n.set("Base Color", n.mix(silver, wood, (0.30, 0.285, 0.26)))
    n.set("Roughness", 0.85)
    n.set("Specular IOR Level", 0.25)
    return material


def turned_wood(name: str) -> bpy.types.Material:
    """A handle polished by hands."""
    return principled(name, (0.36, 0.20, 0.085), roughness=0.45, variation=0.4, variation_scale=45.0)


def bark(name: str) -> bpy.types.Material:
    """Furrowed bark, mossy on one side."""
    material, n = _new(name, (0.11, 0.08, 0.055))
    furrows = n.noise(1.0, 3.0, roughness=0.7, vector=n.mapping(n.object_coords(), scale=(15, 15, 2.6)))
    colour = n.ramp(
        furrows, [(0.3, (0.040, 0.029, 0.020)), (0.55, (0.14, 0.105, 0.075)), (0.78, (0.29, 0.235, 0.18))]
    )
    n.set("Base Color", colour)
    n.set("Roughness", 0.95)
    n.bump(furrows, 1.0, 0.03)
    return material


def straw(name: str, tone: Colour = (0.52, 0.37, 0.135)) -> bpy.types.Material:
    """Dry stalks, each (mesh island) of its own gold."""
    material, n = _new(name, tone)
    n.set(
        "Base Color", n.ramp(_each(n), [(0.0, _scaled(tone, 0.42)), (0.45, tone), (1.0, _scaled(tone, 1.45))])
    )
    n.set("Roughness", 0.75)
    n.set("Specular IOR Level", 0.3)
    return material


def packed_straw(name: str, tone: Colour = (0.40, 0.275, 0.095)) -> bpy.types.Material:
    """The weathered mass of a stack: combed downwards, with dark gaps."""
    material, n = _new(name, _scaled(tone, 0.8))
    stalks = n.noise(1.0, 3.0, roughness=0.75, vector=n.mapping(n.object_coords(), scale=(34.0, 34.0, 7.0)))
    stops = [(0.30, _scaled(tone, 0.16)), (0.48, _scaled(tone, 0.75)), (0.74, _scaled(tone, 1.45))]
    grey = n.map_range(n.noise(1.4, 1.0), 0.48, 0.7, 0.0, 0.6)
    n.set("Base Color", n.mix(grey, n.ramp(stalks, stops), (0.25, 0.195, 0.115)))
    n.set("Roughness", 0.9)
    return material


def rope(name: str) -> bpy.types.Material:
    """Laid hemp: oblique strands."""
    material, n = _new(name, (0.36, 0.275, 0.16))
    strands = n.wave(26.0, axis="DIAGONAL", detail=0.0)
    n.set("Base Color", n.ramp(strands, [(0.0, (0.20, 0.145, 0.08)), (1.0, (0.46, 0.36, 0.22))]))
    n.set("Roughness", 0.9)
    return material


def clay_tiles(name: str) -> bpy.types.Material:
    """Burnt roof tiles, each (mesh island) of its own red, with soot."""
    material, n = _new(name, (0.30, 0.12, 0.07))
    tile = n.ramp(
        _each(n),
        [
            (0.0, (0.17, 0.062, 0.038)),
            (0.4, (0.33, 0.125, 0.065)),
            (0.8, (0.42, 0.19, 0.10)),
            (1.0, (0.24, 0.13, 0.10)),
        ],
    )
    soot = n.map_range(n.noise(1.1, 2.0), 0.48, 0.68, 0.0, 0.7)
    n.set("Base Color", n.mix(soot, tile, (0.085, 0.070, 0.058)))
    n.set("Roughness", 0.85)
    return material


# --- metal ------------------------------------------------------------------------------------------------


def galvanised(name: str, rng: random.Random) -> bpy.types.Material:
    """Hot-dip zinc: grey spangle, white bloom, mud near the ground and a little rust at the rim."""
    material, n = _new(name, (0.5, 0.51, 0.52))
    place = n.mapping(n.object_coords(), location=(rng.uniform(0, 9), rng.uniform(0, 9), rng.uniform(0, 9)))
    spangle = n.voronoi(26.0, vector=place, output="Color")
    zinc = n.ramp(n.separate(spangle)[0], [(0.0, (0.36, 0.375, 0.39)), (1.0, (0.56, 0.57, 0.575))])
    stains = n.noise(8.0, 3.0, roughness=0.65, vector=place)
    zinc = n.mix(n.map_range(stains, 0.5, 0.7, 0.0, 0.5), zinc, (0.62, 0.61, 0.58))
    height = n.separate(n.object_coords())[2]
    mud = n.math("MULTIPLY", n.map_range(height, 0.13, 0.0), n.map_range(stains, 0.38, 0.6), clamp=True)
    n.set("Base Color", n.mix(mud, zinc, (0.17, 0.125, 0.085)))
    n.set("Metallic", n.math("MULTIPLY", n.math("SUBTRACT", 1.0, mud), 0.75))
    n.set("Roughness", n.map_range(n.separate(spangle)[1], 0.0, 1.0, 0.36, 0.56))
    return material


def painted_sheet(name: str, paint: str, rng: random.Random) -> bpy.types.Material:
    """Enamelled sheet: fading, scuffed to bare metal in patches and at the rim, mud near the ground."""
    colour = PAINTS[paint]
    material, n = _new(name, colour)
    place = n.mapping(n.object_coords(), location=(rng.uniform(0, 9), rng.uniform(0, 9), rng.uniform(0, 9)))
    fading = n.noise(5.0, 2.0, vector=place)
    enamel = n.ramp(fading, [(0.3, _scaled(colour, 0.65)), (0.7, _scaled(colour, 1.3))])
    height = n.separate(n.object_coords())[2]
    flakes = n.noise(17.0, 3.0, roughness=0.75, vector=place)
    near_rim = n.map_range(height, 0.29, 0.315, 0.0, 0.13)
    scuffed = n.map_range(n.math("ADD", flakes, near_rim), 0.66, 0.69)
    n.set("Metallic", n.math("MULTIPLY", scuffed, 0.6))
    bare = n.mix(n.map_range(fading, 0.45, 0.6), (0.33, 0.32, 0.31), (0.19, 0.085, 0.040))
    surface = n.mix(scuffed, enamel, bare)
    mud = n.math("MULTIPLY", n.map_range(height, 0.11, 0.0), n.map_range(fading, 0.36, 0.6), clamp=True)
    n.set("Base Color", n.mix(mud, surface, (0.17, 0.125, 0.085)))
    n.set("Roughness", n.map_range(n.math("ADD", scuffed, mud), 0.0, 1.0, 0.34, 0.8))
    return material


def bare_wire(name: str) -> bpy.types.Material:
    """Drawn wire and pressed fittings."""
    return principled(name, (0.34, 0.335, 0.33), roughness=0.45, metallic=0.7)


def wrought_iron(name: str) -> bpy.types.Material:
    """Forged, dark, rusting."""
    return principled(
        name, (0.085, 0.058, 0.042), roughness=0.75, metallic=0.3, variation=0.6, variation_scale=12.0
    )


# --- fillings ---------------------------------------------------------------------------------------------


def still_water(name: str) -> bpy.types.Material:
    """Opaque on purpose: depth and ids must end at the surface."""
    return principled(name, (0.030, 0.048, 0.048), roughness=0.04, specular=0.8)


def grain(name: str) -> bpy.types.Material:
    """Oats in a heap."""
    material, n = _new(name, (0.50, 0.36, 0.16))
    kernels = n.voronoi(120.0, output="Color")
    n.set(
        "Base Color", n.ramp(n.separate(kernels)[0], [(0.0, (0.30, 0.19, 0.07)), (1.0, (0.62, 0.47, 0.23))])
    )
    n.set("Roughness", 0.8)
    return material


# --- foliage ----------------------------------------------------------------------------------------------


def leaves(
    name: str, tone: Colour = (0.075, 0.135, 0.028), *, half_at_m: float = 320.0
) -> bpy.types.Material:
    """Leaf sprays, each (mesh island) of its own green; deeper ones are darker by shade alone."""
    material, n = _new(name, tone)
    stops = [(0.0, _scaled(tone, 0.45)), (0.5, tone), (0.9, _scaled(tone, 1.75)), (1.0, (0.30, 0.25, 0.06))]
    colour = n.ramp(_each(n), stops)
    whole = n.map_range(n.object_random(), 0.0, 1.0, 0.8, 1.2)
    turn = n.map_range(n.object_random(), 0.0, 1.0, 0.482, 0.512)
    _distant(n, n.hue(colour, hue=turn, value=whole), half_at_m=half_at_m)
    n.set("Roughness", 0.65)
    n.set("Specular IOR Level", 0.25)
    _translucent(n, _scaled((tone[0] * 2.6, tone[1] * 2.4, tone[2] * 1.4), 1.0), 0.38)
    return material


def foliage_mass(
    name: str, tone: Colour = (0.050, 0.085, 0.020), *, half_at_m: float = 320.0
) -> bpy.types.Material:
    """A crown seen as one body: clumps of light and shade from noise and bump."""
    material, n = _new(name, tone)
    place = n.vector_math(
        "ADD", n.object_coords(), n.combine(n.math("MULTIPLY", n.object_random(), 60.0), 0.0, 0.0)
    )
    clumps = n.noise(2.6, 2.0, roughness=0.75, vector=place)
    stops = [(0.30, _scaled(tone, 0.25)), (0.5, tone), (0.72, _scaled(tone, 2.3))]
    turn = n.map_range(n.object_random(), 0.0, 1.0, 0.470, 0.515)
    _distant(
        n,
        n.hue(n.ramp(clumps, stops), hue=turn, value=n.map_range(n.object_random(), 0.0, 1.0, 0.75, 1.25)),
        half_at_m=half_at_m,
    )
    n.set("Roughness", 0.9)
    n.set("Specular IOR Level", 0.1)
    n.bump(clumps, 1.0, 0.45)
    return material


# --- hens -------------------------------------------------------------------------------------------------


def _plumage(
    name: str, body: Colour, edge: Colour, scale: float, stretch: tuple[float, float, float]
) -> bpy.types.Material:
    """Overlapping feathers: rounded cells with dark edges, long along the body, fixed to the rest pose."""
    material, n = _new(name, body)
    cells = n.voronoi(scale, vector=n.mapping(n.rest_coords(), scale=stretch))
    tones = n.separate(cells.node.outputs["Color"])[0]
    feather = n.ramp(tones, [(0.0, _scaled(body, 0.72)), (1.0, _scaled(body, 1.35))])
    n.set("Base Color", n.mix(n.map_range(cells, 0.36, 0.72, 0.0, 0.8), feather, edge))
    n.set("Roughness", 0.6)
    n.set("Sheen Weight", 0.2)
    n.set("Specular IOR Level", 0.3)
    return material


def hen_tissues(name: str, plumage: str, neck: str = "own") -> dict[str, bpy.types.Material]:
    """Materials of a hen by tissue: feathers, wing, hackle, tail, comb, horn, scales, eye."""
    body, edge, hackle, tail = PLUMAGES[plumage]
    hackle = NECKS.get(neck, hackle)
    return {
        "feathers": _plumage(f"{name}_feathers", body, edge, 52.0, (1.0, 0.6, 1.0)),
        "wing": _plumage(f"{name}_wing", _scaled(body, 0.85), edge, 44.0, (1.0, 0.45, 1.0)),
        "hackle": _plumage(f"{name}_hackle", hackle, body, 85.0, (1.0, 1.0, 0.35)),
        "tail": _plumage(f"{name}_tail", tail, _scaled(tail, 0.5), 60.0, (1.0, 0.3, 1.0)),
        "comb": principled(f"{name}_comb", (0.56, 0.022, 0.018), roughness=0.5),
        "horn": principled(f"{name}_horn", (0.58, 0.40, 0.15), roughness=0.4),
        "scales": principled(f"{name}_scales", (0.60, 0.36, 0.065), roughness=0.55),
        "eye": principled(f"{name}_eye", (0.10, 0.030, 0.008), roughness=0.15),
    }
