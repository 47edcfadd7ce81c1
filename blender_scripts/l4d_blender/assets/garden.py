"""A cottage garden round the origin: lawn, a border of bushes with flowers before it, a fence, trees.

Owns the planting. Knows nothing of who sits in it; bushes stand at -X and +Y, where cameras look.
"""

from __future__ import annotations

import random
from math import cos, degrees, radians, sin

import bpy

from l4d_blender.assets import fence, flower_vase, ground, mesh, tree
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.placing import place

_BUSHES = (
    (-3.3, -1.6),
    (-3.6, -0.2),
    (-3.2, 1.1),
    (-2.7, 2.3),
    (-1.7, 3.1),
    (-0.4, 3.3),
    (0.9, 3.5),
    (2.2, 3.2),
)
_TREES = ((-5.6, 5.4), (3.0, 6.2))
_TONES = ((0.070, 0.120, 0.028), (0.10, 0.15, 0.04), (0.045, 0.10, 0.035))
_FLOWERS = ((flower_vase.ROSE, flower_vase.DAISY), (flower_vase.DAISY,))


@kind("garden", (84.6, 84.6, 5.57), "backdrop")
def garden(name: str, rng: random.Random, *, floor_m: float = 0.0) -> list[bpy.types.Object]:
    """All of it, with the lawn at `floor_m`; worn bare round the origin."""
    terrain = ground.Terrain(seed=rng.randrange(1 << 30), yard=[((0.1, 0.0), 1.1)], level_radius_m=9.0)
    lawn = ground.ground(f"{name}_ground", rng, terrain=terrain, radius_m=40.0, sectors=96)
    turf = ground.grass(
        f"{name}_turf",
        rng,
        terrain=terrain,
        tufts=800,
        radius_m=5.0,
        blades_per_tuft=9,
        length_m=(0.03, 0.09),
    )
    rails = fence.fence(f"{name}_fence", rng, line=[(-5.2, -4.0), (-4.6, 3.4), (-1.0, 5.2), (4.5, 5.0)])
    made = [place(obj, (0.0, 0.0), on=floor_m) for obj in (lawn, turf, rails)]
    for k, (x, y) in enumerate(_TREES):
        made.append(place(tree.tree(f"{name}_tree{k}", rng, height_m=5.5, sprays=900), (x, y), on=floor_m))

    bushes = [
        tree.bush(f"{name}_bush{k}", rng, size_xyz=(1.5, 1.1, 1.15), sprays=420, tone=tone)
        for k, tone in enumerate(_TONES)
    ]
    for k, (x, y) in enumerate(_BUSHES):
        plant = (
            bushes[k] if k < len(bushes) else mesh.duplicate(bushes[k % 3], f"{name}_bush{k}", linked=True)
        )
        x, y = x + rng.uniform(-0.2, 0.2), y + rng.uniform(-0.2, 0.2)
        made.append(place(plant, (x, y), degrees(rng.uniform(0.0, 6.28)), on=floor_m - 0.05))

    heads = [
        flower_vase.flower_vase(f"{name}_flowers{k}", rng, kinds=kinds, heads=15)
        for k, kinds in enumerate(_FLOWERS)
    ]
    for k in range(11):
        bloom = (
            heads[k] if k < len(heads) else mesh.duplicate(heads[k % 2], f"{name}_flowers{k}", linked=True)
        )
        angle, away = radians(80.0 + 13.0 * k + rng.uniform(-4.0, 4.0)), rng.uniform(2.1, 2.5)
        at = away * cos(angle), away * sin(angle)
        # The jug that they grow from is below the lawn.
        heading_deg, scale = degrees(rng.uniform(0.0, 6.28)), rng.uniform(1.8, 2.4)
        made.append(place(bloom, at, heading_deg, on=floor_m - 0.16, scale=scale))
    return made
