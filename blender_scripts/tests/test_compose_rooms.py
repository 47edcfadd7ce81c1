"""Rooms of composed scenes: what they offer is there, free, reachable, and in every picture."""

from __future__ import annotations

from itertools import combinations

import bpy  # noqa: F401, it brings mathutils
import pytest
from conftest import first_of
from mathutils import Vector

from l4d_blender.compose.errors import Rejected
from l4d_blender.compose.places import shipped_places
from l4d_blender.compose.settings.rooms import FEET_M, TALL_M, Room
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Stage
from l4d_blender.scene.scene import Scene

ROOMS = [place for place in shipped_places() if place.scale == "room"]


def furnished(place, seed: int) -> Stage:
    for draw in range(4):
        spec = Spec(f"room_{seed}", "room", seed, draw)
        stage = Stage(Scene(spec.scene, "room", seed), spec)
        try:
            place.furnish(stage)
        except Rejected:
            continue
        return stage
    raise AssertionError(f"four draws of {place.name} in a row found no room")


def plan(stage: Stage) -> list[tuple]:
    return [
        (
            prop.name,
            prop.kind.name,
            prop.at,
            prop.heading_deg,
            [len(o.data.vertices) for o in prop.instance.objects],
        )
        for prop in stage.landmarks
    ]


@pytest.mark.parametrize("place", ROOMS, ids=lambda place: place.name)
def test_a_room_keeps_what_it_offers(place) -> None:
    stage = furnished(place, 11)
    nouns = [prop.instance.category for prop in stage.landmarks]
    assert len(set(nouns)) >= 3
    if "floor" in place.offers:
        floor = stage.area("floor")
        xs, ys = [x for x, _ in floor.corners], [y for _, y in floor.corners]
        assert max(xs) - min(xs) >= 2.5 and max(ys) - min(ys) >= 2.0
    if "chairs" in place.offers:
        assert len(stage.chairs) >= 2
        floor = stage.area("floor")
        for chair in stage.chairs:
            own = [chair.of.name] if chair.of else []
            assert floor.is_free(Room.feet(chair), FEET_M, ignoring=own), f"{own} has no free floor before it"
    if "counter" in place.offers:
        counter = stage.area("counter")
        assert 0.8 <= counter.on <= 1.0
        assert counter.margin(counter.centre) > 0.2
        (ax, ay), (bx, by) = counter.corners[:2]
        out = (by - ay, ax - bx)
        length = (out[0] ** 2 + out[1] ** 2) ** 0.5
        floor = stage.area("floor")
        for share in (0.3, 0.5, 0.7):
            at = (
                ax + share * (bx - ax) + 0.4 * out[0] / length,
                ay + share * (by - ay) + 0.4 * out[1] / length,
            )
            assert floor.is_free(at, 0.25)
    if "floor" in place.offers:
        rng, found = stage.rng("people"), []
        for k in range(4):
            at = floor.spot(rng, 0.35)
            floor.take(at, 0.35, owner=f"somebody_{k}")
            found.append(at)
        for at in found:
            assert pictures_with(stage, [(*at, 0.0), (*at, TALL_M)]) == 17


@pytest.mark.parametrize("place", first_of(ROOMS), ids=lambda place: place.name)
def test_landmarks_are_apart_and_draws_repeat(place) -> None:
    first, again, other = furnished(place, 21), None, None
    assert first.landmarks
    names = [prop.name for prop in first.landmarks]
    assert len(names) == len(set(names))
    for a, b in combinations([prop for prop in first.landmarks if prop.at], 2):
        assert a.at != b.at, f"{a.name} and {b.name} are at the same point"
    kept = plan(first)
    again = plan(furnished(place, 21))
    other = plan(furnished(place, 22))
    assert kept == again
    assert kept != other


def pictures_with(stage: Stage, points: list[tuple[float, float, float]]) -> int:
    """In how many of the 17 cameras' pictures all these points are."""
    count = 0
    for camera in stage.scene.camera_rig:
        inverse = camera.world_from_camera.inverted()
        inside = True
        for point in points:
            x, y, z = inverse @ Vector(point)
            half = 0.5 / camera.focal_over_width
            inside &= z > 0 and abs(x / z) <= half and abs(y / z) <= 0.75 * half
        count += inside
    return count
