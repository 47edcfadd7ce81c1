"""Town houses with a shop on the ground floor: display window with goods, awning, door, storeys of windows.

The facade stands on y = 0 and faces -Y, the house is centred on x = 0 and reaches back to +Y. Panes are left
out of display windows, so that one looks into their depth. Scenery or a landmark. Metres.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy

from l4d_blender.scene.catalogue import kind

from ..scene.colour import Colour
from . import mesh
from .lettering import lettering
from .materials import outdoors, products, street
from .materials.base import Nodes, principled

SHOP_M = 3.35  # height of the ground floor
DEPTH_M = 3.2
_WINDOW_SILL_M, _WINDOW_TOP_M = 0.62, 2.55
_BAY_M = 1.3  # depth of a display


@dataclass(frozen=True)
class ShopLook:
    """`wall` is brick or a colour of render; `awning` a colour of its stripes, or nothing."""

    sign: str = "BAKERY"
    wall: str | Colour = "brick"
    joinery: Colour = (0.03, 0.10, 0.07)
    awning: Colour | None = (0.42, 0.03, 0.03)
    goods: tuple[Colour, ...] = ((0.42, 0.22, 0.07), (0.30, 0.13, 0.04), (0.55, 0.36, 0.14))
    width_m: float = 5.6
    storeys: int = 2


@kind("shop", (5.64, 4.26, 9.11), "backdrop", front="-y")
def shopfront(name: str, rng: random.Random, *, look: ShopLook = ShopLook()) -> bpy.types.Object:
    """The whole house as one object."""
    wide = look.width_m
    wall = (
        street.brickwork(f"{name}_wall")
        if isinstance(look.wall, str)
        else street.render(f"{name}_wall", look.wall)
    )
    joinery = products.lacquer(f"{name}_joinery", look.joinery, rng)
    sill = street.stone(f"{name}_sill", (0.46, 0.44, 0.40))
    door_x = 0.5 * wide - 0.95
    shop_left, shop_right = -0.5 * wide + 0.35, door_x - 0.62
    parts = [
        *_ground_floor(name, wall, sill, wide, shop_left, shop_right, door_x),
        *_display(name, rng, look, shop_left, shop_right),
        *_joinery(name, joinery, shop_left, shop_right, door_x, wide),
        *_storeys(name, wall, sill, joinery, look),
        *_sign(name, joinery, look),
    ]
    if look.awning:
        parts += _awning(name, look.awning, shop_left - 0.1, shop_right + 0.1)
    return mesh.join(name, parts)


def _block(
    name: str, material: bpy.types.Material, low: tuple[float, float, float], high: tuple[float, float, float]
) -> bpy.types.Object:
    """A box from corner to corner."""
    size = tuple(b - a for a, b in zip(low, high))
    block = mesh.box(name, size)
    mesh.move(block, 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2])
    return mesh.set_material(block, material)


def _ground_floor(
    name: str,
    wall: bpy.types.Material,
    sill: bpy.types.Material,
    wide: float,
    left: float,
    right: float,
    door_x: float,
) -> list[bpy.types.Object]:
    """Piers, the stall riser under the window, the lintel, and the dark shop behind."""
    half = 0.5 * wide
    inside = principled(
        f"{name}_inside", (0.10, 0.085, 0.07), roughness=0.9, variation=0.4, variation_scale=1.4
    )
    return [
        _block(name, wall, (-half, 0.0, 0.0), (left, 0.35, SHOP_M)),
        _block(name, wall, (right, 0.0, 0.0), (door_x - 0.5, 0.35, SHOP_M)),
        _block(name, wall, (door_x + 0.5, 0.0, 0.0), (half, 0.35, SHOP_M)),
        _block(name, wall, (left, 0.0, 0.0), (right, 0.30, _WINDOW_SILL_M)),
        _block(name, wall, (left, 0.0, _WINDOW_TOP_M), (door_x + 0.5, 0.35, SHOP_M)),
        _block(name, sill, (-half, -0.04, 0.0), (door_x - 0.5, 0.0, 0.26)),
        _block(name, sill, (left - 0.06, -0.10, _WINDOW_SILL_M), (right + 0.06, 0.12, _WINDOW_SILL_M + 0.06)),
        _block(name, inside, (-half + 0.02, _BAY_M, 0.0), (half - 0.02, DEPTH_M, SHOP_M)),
        _block(
            name,
            inside,
            (-half + 0.02, 0.3, _WINDOW_TOP_M + 0.02),
            (half - 0.02, _BAY_M, _WINDOW_TOP_M + 0.1),
        ),
        _block(name, inside, (door_x - 0.5, 0.62, 0.0), (door_x + 0.5, 0.66, SHOP_M)),
    ]


def _display(
    name: str, rng: random.Random, look: ShopLook, left: float, right: float
) -> list[bpy.types.Object]:
    """Shelves with goods in the window: boxes, loaves and pots of a few colours."""
    board = outdoors.weathered_wood(f"{name}_board", (0.34, 0.22, 0.12), grain_axis="X")
    backdrop = principled(
        f"{name}_backdrop", (0.38, 0.31, 0.22), roughness=0.85, variation=0.3, variation_scale=2.0
    )
    wares = [
        principled(f"{name}_ware_{k}", colour, roughness=0.6, variation=0.35, variation_scale=14.0)
        for k, colour in enumerate(look.goods)
    ]
    parts = [
        _block(name, backdrop, (left - 0.1, _BAY_M - 0.06, 0.0), (right + 0.1, _BAY_M - 0.01, _WINDOW_TOP_M)),
        _block(name, board, (left, 0.12, _WINDOW_SILL_M - 0.05), (right, _BAY_M, _WINDOW_SILL_M)),
    ]
    for z, depth in ((_WINDOW_SILL_M, 0.18), (1.12, 0.62), (1.62, 0.80)):
        if z > _WINDOW_SILL_M:
            parts.append(_block(name, board, (left, depth, z - 0.03), (right, _BAY_M - 0.05, z)))
        x = left + 0.12
        while x < right - 0.2:
            size = rng.uniform(0.14, 0.30)
            ware = rng.choice(wares)
            y = depth + 0.14 + rng.uniform(0.0, 0.10)
            if rng.random() < 0.5:
                thing = mesh.ellipsoid(
                    name, (0.5 * size, 0.4 * size, 0.30 * size), 14, 9, (0.0, 0.0, 0.30 * size)
                )
            else:
                thing = mesh.bevel_box(name, (size, 0.7 * size, rng.uniform(0.6, 1.25) * size), 0.02, 2)
            parts.append(mesh.set_material(mesh.move(thing, x + 0.5 * size, y, z), ware))
            x += size + rng.uniform(0.03, 0.16)
    return parts


def _joinery(
    name: str, paint: bpy.types.Material, left: float, right: float, door_x: float, wide: float
) -> list[bpy.types.Object]:
    """Window bars, the panelled door with its light, a step."""
    pane = street.window_pane(f"{name}_door_pane")
    brass = principled(f"{name}_brass", (0.50, 0.34, 0.10), roughness=0.35, metallic=0.9)
    parts = []
    bars = 3
    for k in range(bars + 1):
        x = left + (right - left) * k / bars
        parts.append(_block(name, paint, (x - 0.035, 0.0, _WINDOW_SILL_M), (x + 0.035, 0.09, _WINDOW_TOP_M)))
    for z in (_WINDOW_SILL_M + 0.05, 2.12, _WINDOW_TOP_M - 0.06):
        parts.append(_block(name, paint, (left, 0.005, z), (right, 0.085, z + 0.06)))
    parts += [
        _block(name, paint, (door_x - 0.5, 0.36, 0.06), (door_x + 0.5, 0.42, 2.50)),
        _block(name, pane, (door_x - 0.30, 0.345, 0.95), (door_x + 0.30, 0.37, 2.22)),
        _block(name, brass, (door_x - 0.40, 0.31, 1.02), (door_x - 0.37, 0.36, 1.24)),
        _block(name, paint, (-0.5 * wide, -0.10, SHOP_M - 0.06), (0.5 * wide, 0.02, SHOP_M + 0.08)),
    ]
    return parts


def _storeys(
    name: str, wall: bpy.types.Material, sill: bpy.types.Material, joinery: bpy.types.Material, look: ShopLook
) -> list[bpy.types.Object]:
    """The wall over the shop with sash windows set back in it, and a cornice."""
    pane = street.window_pane(f"{name}_pane")
    white = principled(f"{name}_sash", (0.62, 0.60, 0.55), roughness=0.6, variation=0.15)
    half, tall = 0.5 * look.width_m, 2.75
    columns = max(2, round(look.width_m / 1.9))
    parts = []
    for storey in range(look.storeys):
        base = SHOP_M + tall * storey
        low, high = base + 0.75, base + 2.30
        parts.append(_block(name, wall, (-half, 0.02, base), (half, 0.30, low)))
        parts.append(_block(name, wall, (-half, 0.02, high), (half, 0.30, base + tall)))
        parts.append(_block(name, pane, (-half + 0.1, 0.22, low), (half - 0.1, 0.26, high)))
        edge = -half
        for k in range(columns):
            x = -half + look.width_m * (k + 0.5) / columns
            parts.append(_block(name, wall, (edge, 0.02, low), (x - 0.5, 0.30, high)))
            parts.append(_block(name, sill, (x - 0.60, -0.06, low - 0.08), (x + 0.60, 0.10, low)))
            middle = 0.5 * (low + high)
            for x0, z0, x1, z1 in (
                (x - 0.5, low, x - 0.44, high),
                (x + 0.44, low, x + 0.5, high),
                (x - 0.02, low, x + 0.02, high),
                (x - 0.5, low, x + 0.5, low + 0.06),
                (x - 0.5, high - 0.06, x + 0.5, high),
                (x - 0.5, middle - 0.025, x + 0.5, middle + 0.025),
            ):
                parts.append(_block(name, white, (x0, 0.14, z0), (x1, 0.21, z1)))
            edge = x + 0.5
        parts.append(_block(name, wall, (edge, 0.02, low), (half, 0.30, high)))
    top = SHOP_M + tall * look.storeys
    parts.append(_block(name, sill, (-half - 0.02, -0.28, top), (half + 0.02, 0.35, top + 0.26)))
    parts.append(_block(name, wall, (-half, 0.30, SHOP_M), (half, DEPTH_M, top)))
    return parts


def _sign(name: str, joinery: bpy.types.Material, look: ShopLook) -> list[bpy.types.Object]:
    """The painted board over the window with the trade's name."""
    gold = principled(f"{name}_gold", (0.74, 0.56, 0.22), roughness=0.45)
    half = 0.5 * look.width_m - 0.12
    board = _block(name, joinery, (-half, -0.05, _WINDOW_TOP_M + 0.16), (half, 0.02, SHOP_M - 0.10))
    word = mesh.rotate(lettering(f"{name}_word", look.sign, 0.36, spacing=1.15, bold_m=0.008), "X", 90.0)
    mesh.move(word, 0.0, -0.062, 0.5 * (_WINDOW_TOP_M + 0.16 + SHOP_M - 0.10))
    return [board, mesh.set_material(word, gold)]


def _awning(name: str, colour: Colour, left: float, right: float) -> list[bpy.types.Object]:
    """Striped cloth on a slanting frame, with a scalloped valance."""
    material = bpy.data.materials.new(f"{name}_awning")
    n = Nodes(material)
    x, _, _ = n.separate(n.object_coords())
    stripe = n.math("GREATER_THAN", n.math("FRACT", n.math("MULTIPLY", x, 2.2)), 0.5)
    faded = n.ramp(n.noise(3.0, 3.0), [(0.3, 0.78), (0.7, 1.0)])
    n.set("Base Color", n.mix(1.0, n.mix(stripe, colour, (0.66, 0.62, 0.54)), faded, blend="MULTIPLY"))
    n.set("Roughness", 0.85)
    columns = 48
    verts: list[tuple[float, float, float]] = []
    for k in range(columns + 1):
        px = left + (right - left) * k / columns
        scallop = 0.05 * abs(((k / 4.0) % 1.0) - 0.5)
        verts += [(px, -0.02, 2.86), (px, -0.55, 2.60), (px, -1.05, 2.37), (px, -1.06, 2.13 + scallop)]
    faces = [
        (4 * k + row, 4 * k + row + 1, 4 * k + row + 5, 4 * k + row + 4)
        for k in range(columns)
        for row in range(3)
    ]
    cloth = mesh.solidify(mesh.from_pydata(f"{name}_awning", verts, faces), 0.012)
    return [mesh.set_material(cloth, material)]
