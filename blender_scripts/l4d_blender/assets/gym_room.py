"""The shell of a gym in an old works hall, open towards -Y and above: rubber, brick, tall steel windows."""

from __future__ import annotations

import random
from math import radians

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import gym, interior
from l4d_blender.assets.materials.products import window_view
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind

WALL_HEIGHT_M = 3.4


@kind("room", (6.6, 6.1, 3.4), "backdrop")
def gym_room(
    name: str,
    rng: random.Random,
    *,
    half_width_m: float = 3.3,
    back_m: float = 2.5,
    front_m: float = -3.6,
    brick: tuple[float, float, float] = (0.34, 0.13, 0.08),
    paint: tuple[float, float, float] = (0.36, 0.40, 0.40),
) -> list[bpy.types.Object]:
    """Floor, three walls and a painted dado."""
    w, top = half_width_m, WALL_HEIGHT_M
    floor = mesh.from_pydata(
        f"{name}_floor",
        [(-w, front_m, 0), (w, front_m, 0), (w, back_m, 0), (-w, back_m, 0)],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    parts = Parts(name)
    parts.add(floor, gym.rubber_floor(f"{name}_rubber", rng))
    bricks = gym.brickwork(f"{name}_bricks", brick, rng)
    dado = interior.plaster(f"{name}_dado", paint, rng)
    for k, (a, b) in enumerate(
        (((-w, back_m), (w, back_m)), ((-w, front_m), (-w, back_m)), ((w, back_m), (w, front_m)))
    ):
        for low, high, inset, material in ((0.0, top, 0.0, bricks), (0.0, 1.05, 0.012, dado)):
            sheet = mesh.from_pydata(
                f"{name}_wall_{k}",
                [(*a, low), (*b, low), (*b, high), (*a, high)],
                [(0, 1, 2, 3)],
                smooth=False,
            )
            shift = ((0, -inset), (inset, 0), (-inset, 0))[k]
            parts.add(sheet, material, x=shift[0], y=shift[1])
    return parts


@kind("window", (1.84, 0.2, 2.09), "hangs", front="-y")
def window(
    name: str,
    rng: random.Random,
    *,
    columns: int = 4,
    rows: int = 5,
    pane_m: tuple[float, float] = (0.385, 0.35),
    sill_m: float = 1.22,
    strength: float = 0.72,
) -> bpy.types.Object:
    """A steel window with many panes, the middle ones tilted open; the wall is y = 0, the room at -Y."""
    width_m, height_m = columns * pane_m[0], rows * pane_m[1]
    half = width_m / 2
    view = mesh.from_pydata(
        f"{name}_view",
        [(-half, 0, 0), (half, 0, 0), (half, 0, height_m), (-half, 0, height_m)],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    parts = Parts(name)
    parts.add(view, window_view(f"{name}_view", rng, horizon_m=sill_m + 0.38 * height_m, strength=strength))
    iron = gym.powder_coat(f"{name}_iron", (0.035, 0.045, 0.045), rng)
    stone = interior.plaster(f"{name}_stone", (0.44, 0.42, 0.38), rng)

    def bar(size: tuple[float, float, float], x: float, z: float, y: float = -0.015) -> None:
        parts.box("bar", iron, size, 0.004, 2, x=x, y=y, z=z)

    for i in range(columns + 1):
        wide = 0.05 if i in (0, columns) else 0.026
        bar((wide, 0.05, height_m), width_m * (i / columns - 0.5), 0.0)
    for j in range(rows + 1):
        tall = 0.05 if j in (0, rows) else 0.026
        bar((width_m, 0.045, tall), 0.0, height_m * j / rows - tall / 2)
    parts.box("sill", stone, (width_m + 0.16, 0.20, 0.07), 0.01, y=-0.09, z=-0.095)
    parts.box("head", stone, (width_m + 0.30, 0.06, 0.22), 0.008, y=-0.02, z=height_m + 0.025)
    return mesh.move(parts.join(), y=-0.014, z=sill_m)


@kind("pipes", (6.5, 0.37, 0.37), "hangs")
def pipes(name: str, rng: random.Random, *, width_m: float = 6.5) -> bpy.types.Object:
    """A ventilation duct under the roof, along X, with collars; axis at z = 0."""
    tin = gym.powder_coat(f"{name}_tin", (0.42, 0.43, 0.44), rng)
    duct = mesh.transform(
        mesh.cylinder(f"{name}_duct", 0.17, width_m, 40), Matrix.Rotation(radians(90), 4, "Y")
    )
    parts = [mesh.move(duct, x=-width_m / 2)]
    for k in range(int(width_m / 0.9) + 1):
        collar = mesh.transform(
            mesh.cylinder(f"{name}_collar", 0.185, 0.04, 40, 0.008), Matrix.Rotation(radians(90), 4, "Y")
        )
        parts.append(mesh.move(collar, x=-width_m / 2 + 0.9 * k))
    return mesh.set_material(mesh.join(name, parts), tin)
