"""Outdoor places: what they offer is there and in the pictures, nothing tall is before it, draws repeat."""

from __future__ import annotations

from math import cos, radians, sin

import bpy
import pytest
from conftest import first_of
from mathutils import Vector

from l4d_blender.compose import checks
from l4d_blender.compose.areas import Area
from l4d_blender.compose.places import shipped_places
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Stage
from l4d_blender.scene.scene import Scene
from l4d_blender.worker import tracks

OUTDOORS = [place for place in shipped_places() if place.scale == "outdoor"]
LEAST_M = {"lawn": (5.0, 4.0), "road": (18.0, 5.0), "water": (3.5, 2.0)}
TALL_M = {"lawn": 1.8, "road": 1.5, "water": 0.4}


def furnished(place, seed: int) -> Stage:
    spec = Spec(f"outdoor_{seed}", "outdoor", seed)
    stage = Stage(Scene(spec.scene, "outdoor", seed), spec)
    place.furnish(stage)
    bpy.context.view_layer.update()
    return stage


@pytest.mark.parametrize("place", OUTDOORS, ids=lambda place: place.name)
def test_an_outdoor_place_keeps_what_it_offers(place, monkeypatch) -> None:
    stage = furnished(place, 31)
    monkeypatch.setattr(tracks, "FRAME_COUNT", 1)  # nothing moves yet
    checks.collisions(stage, tracks.measure(stage.scene))
    nouns = [prop.instance.category for prop in stage.landmarks]
    assert len(set(nouns)) >= 4, nouns
    assert len(nouns) == len(set(nouns)), f"which of {nouns}?"
    for offer in sorted(place.offers & set(LEAST_M)):
        size = extent(stage.area(offer))
        assert size[0] >= LEAST_M[offer][0] and size[1] >= LEAST_M[offer][1]
    if place.offers & {"road", "water"}:
        assert min(extent(stage.area("lawn"))) >= 2.0
    if "chairs" in place.offers:
        assert len(stage.chairs) >= 2
        for chair in stage.chairs:
            a = radians(chair.heading_deg)
            feet = chair.seat[0] + 0.45 * sin(a), chair.seat[1] - 0.45 * cos(a)
            assert stage.area("lawn").is_free(feet, 0.15, ignoring=[chair.of.name])
    for offer in sorted(place.offers & {"lawn", "water"}):
        area = stage.area(offer)
        rng = stage.rng("test")
        for k in range(5):
            at = area.spot(rng, 0.3)
            area.take(at, 0.3, owner=f"somebody_{k}")
            top = area.point(*at)[2] + TALL_M[offer]
            seen = sum(is_seen(camera, (*at, z)) for camera in stage.scene.camera_rig for z in (top, top / 2))
            assert seen >= 22, f"{at} of {offer} is in {seen} of 34 pictures"


@pytest.mark.parametrize("place", first_of(OUTDOORS), ids=lambda place: place.name)
def test_draws_of_an_outdoor_place_repeat_and_differ(place) -> None:
    first = plan(furnished(place, 41))
    assert plan(furnished(place, 41)) == first
    assert plan(furnished(place, 42)) != first


def extent(area: Area) -> tuple[float, float]:
    xs, ys = [x for x, _ in area.corners], [y for _, y in area.corners]
    return max(xs) - min(xs), max(ys) - min(ys)


def plan(stage: Stage) -> list[tuple]:
    return [
        (prop.name, prop.at, prop.heading_deg, [len(part.data.vertices) for part in prop.instance.objects])
        for prop in stage.landmarks
    ]


def is_seen(camera, point: tuple[float, float, float]) -> bool:
    """Whether a point is in a camera's picture with nothing before it."""
    x, y, z = camera.world_from_camera.inverted() @ Vector(point)
    half = 0.5 / camera.focal_over_width
    if z <= 0 or abs(x / z) > half or abs(y / z) > 0.75 * half:
        return False
    start = camera.world_from_camera.translation
    way = Vector(point) - start
    hit, *_ = bpy.context.scene.ray_cast(
        bpy.context.evaluated_depsgraph_get(), start, way.normalized(), distance=way.length - 0.2
    )
    return not hit
