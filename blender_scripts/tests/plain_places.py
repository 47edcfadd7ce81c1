"""Bare places for tests of themes: a lawn, a floor, a pond with a bank, a road. Importing enters them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials.base import principled
from l4d_blender.compose.areas import Area
from l4d_blender.compose.places import place

if TYPE_CHECKING:
    from l4d_blender.compose.stage import Stage


def _plane(
    name: str, colour: tuple[float, float, float], size_m: tuple[float, float], z: float = 0.0
) -> None:
    sheet: bpy.types.Object = mesh.grid(name, *size_m, 4, 4)
    mesh.set_material(sheet, principled(name, colour, roughness=0.9))
    sheet.location.z = z


def _daylight(stage: Stage) -> None:
    stage.scene.sky(sun_elevation_deg=40.0, sun_azimuth_deg=-60.0, strength=0.15)
    stage.scene.sun(elevation_deg=40.0, azimuth_deg=-60.0, strength=2.0)


def _cameras(stage: Stage, radius_m: float, heights_m: tuple[float, float], fov_deg: float = 50.0) -> None:
    stage.scene.cameras(
        (0.0, 0.0, 0.2), radius_m=radius_m, heights_m=heights_m, arc_deg=130, facing_deg=-90, fov_deg=fov_deg
    )


@place("outdoor", "lawn")
def plain_lawn(stage: Stage) -> None:
    """Seven by five metres of green, three landmarks at its edge."""
    _plane("ground", (0.10, 0.17, 0.04), (60.0, 60.0), -0.002)
    lawn = stage.add_area(Area.rectangle("lawn", (0.0, 0.0), (7.0, 5.0)))
    stage.landmark("street_bench", "bench", (-1.2, 2.0), area=lawn)
    stage.landmark("bucket", "bucket", (1.6, 1.5), 30.0, area=lawn)
    stage.landmark("park_lamp", "lamp_post", (2.9, -0.4), area=lawn)
    _daylight(stage)
    _cameras(stage, 6.5, (1.6, 2.4))


@place("room", "floor")
def plain_floor(stage: Stage) -> None:
    """Three by two and a half metres of board, three landmarks at its edge."""
    _plane("ground", (0.30, 0.19, 0.10), (20.0, 20.0), -0.002)
    floor = stage.add_area(Area.rectangle("floor", (0.0, 0.0), (3.2, 2.6)))
    stage.landmark("basket", "basket", (-1.2, 0.9), area=floor)
    stage.landmark("plant_pot", "plant", (1.3, 0.8), area=floor)
    stage.landmark("cushion", "cushion", (0.2, 1.0), area=floor)
    stage.scene.ambient((0.8, 0.85, 0.9), 0.6)
    _daylight(stage)
    _cameras(stage, 3.6, (1.2, 1.7))


@place("outdoor", "water", "lawn")
def plain_pond(stage: Stage) -> None:
    """Six by three and a half metres of water with a strip of lawn behind it."""
    _plane("ground", (0.03, 0.07, 0.08), (60.0, 60.0), -0.12)
    bank = mesh.set_material(
        mesh.move(mesh.bevel_box("bank", (9.0, 4.6, 0.4), 0.02, 1), 0.0, 3.4, -0.4),
        principled("bank", (0.12, 0.17, 0.05), roughness=0.9),
    )
    bank.pass_index = 0
    stage.add_area(Area.rectangle("water", (0.0, -0.9), (6.0, 3.6), on=-0.12))
    lawn = stage.add_area(Area.rectangle("lawn", (0.0, 3.3), (7.0, 4.2)))
    stage.landmark("street_bench", "bench", (-1.8, 3.4), area=lawn)
    stage.landmark("bucket", "bucket", (1.9, 2.6), 30.0, area=lawn)
    stage.landmark("park_lamp", "lamp_post", (0.6, 4.2), area=lawn)
    _daylight(stage)
    _cameras(stage, 6.5, (1.8, 2.6))


@place("outdoor", "road")
def plain_road(stage: Stage) -> None:
    """Twenty-two metres of asphalt, seven wide."""
    _plane("ground", (0.12, 0.12, 0.12), (80.0, 80.0), -0.002)
    stage.add_area(Area.rectangle("road", (0.0, 0.0), (22.0, 7.0)))
    stage.landmark("street_bench", "bench", (-4.0, 4.6))
    stage.landmark("park_lamp", "lamp_post", (3.0, 4.2))
    stage.landmark("tree", "tree", (7.0, 6.0))
    _daylight(stage)
    _cameras(stage, 15.0, (3.0, 4.5))
