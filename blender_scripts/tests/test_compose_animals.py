"""Themes with animals and cars: draws have twins and crossing looks, events agree, bytes come again."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

import plain_places  # noqa: F401  enters the places
from agreement import disagreements
from conftest import first_of

from l4d_blender.compose import build, checks
from l4d_blender.compose.animals.ways import Body, ahead, find_way, fits
from l4d_blender.compose.areas import Area
from l4d_blender.compose.errors import Rejected
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Stage
from l4d_blender.motion.acting import grip_points
from l4d_blender.scene.scene import Scene
from l4d_blender.worker import tracks

THEMES = {
    "cats_outdoors": ("outdoor", "plain_lawn", "cat"),
    "cats_indoors": ("room", "plain_floor", "cat"),
    "dogs_outdoors": ("outdoor", "plain_lawn", "dog"),
    "hens_outdoors": ("outdoor", "plain_lawn", "hen"),
    "ducks_on_water": ("outdoor", "plain_pond", "duck"),
    "birds_at_food": ("outdoor", "plain_lawn", ""),
    "cars_on_road": ("outdoor", "plain_road", "car"),
}


def _draw(theme: str, seed: int) -> tuple[Scene, Stage]:
    scale, place, _ = THEMES[theme]
    for draw in range(5):
        try:
            return build.build(Spec(f"{scale}_{seed}", scale, seed, draw, place, theme))
        except Rejected:
            continue
    pytest.fail(f"{theme}: five draws of seed {seed} were thrown away")


@pytest.mark.parametrize("theme", THEMES)
def test_what_is_declared_is_seen(theme: str) -> None:
    scene, stage = _draw(theme, 7)
    category = THEMES[theme][2] or stage.objects[0].instance.category
    shapes = tracks.measure(scene)
    content = tracks.tracks(scene, stage.description, shapes, [])
    assert disagreements(content) == []
    checks.collisions(stage, shapes)
    group = [prop for prop in stage.objects if prop.instance.category == category]
    assert 3 <= len(group) <= 5
    looks = Counter(tuple(sorted(prop.look.attributes.items())) for prop in group)
    assert max(looks.values()) >= 2, "no twins"
    assert len(looks) >= 2, "all look the same"
    acting = {event.subject.name for event in scene.events if event.subject.category == category}
    assert len(acting) >= 2
    assert len({event.verb for event in scene.events}) >= 2


@pytest.mark.parametrize("theme", first_of(THEMES))
def test_the_same_seed_draws_the_same(theme: str) -> None:
    def told() -> list:
        scene, stage = _draw(theme, 11)
        return [
            stage.description,
            [(e.subject.name, e.verb, e.frames, e.object and e.object.name) for e in scene.events],
            [(i.name, i.attributes, [list(row) for row in i.matrix(48)]) for i in scene.instances],
            [list(row) for camera in scene.camera_rig for row in camera.world_from_camera],
        ]

    assert told() == told()


def test_ways_are_clear_and_no_tighter_than_a_body_turns() -> None:
    import random

    area = Area.rectangle("lawn", (0.0, 0.0), (6.0, 4.0))
    area.take((0.0, 0.0), 0.4, owner="bench")
    body = Body(0.3, 0.4, 0.15, 0.3)
    rng, found = random.Random(3), 0
    for _ in range(60):
        start = (rng.uniform(-2, -1), rng.uniform(-1, 1)), rng.uniform(40, 140)
        end = (rng.uniform(1, 2), rng.uniform(-1, 1)), rng.uniform(40, 140)
        way = find_way(area, body, rng, start, end)
        if way is None:
            continue
        found += 1
        assert all(x * x + y * y > 0.5**2 for x, y in way.points)
        assert way.beyond(0.2)[-1] == way.end
        assert way.length_m > 2.0
    assert found > 20
    assert not fits(area, body, (0.2, 0.2), 0.0)
    assert ahead((1.0, 1.0), 0.0, 0.5, 0.2) == pytest.approx((1.2, 0.5))


def test_hands_come_to_the_heads_of_dogs_that_are_stroked() -> None:
    for draw in range(5):
        try:
            scene, stage = build.build(Spec("outdoor_7", "outdoor", 7, draw, "plain_lawn", "dogs_petted"))
        except Rejected:
            continue
        break
    petted = [event for event in scene.events if event.verb == "pet"]
    assert len(petted) == 2 and petted[0].object is not petted[1].object
    performers = {performer.instance.name: performer for performer in stage.performers}
    for event in petted:
        actor, dog = performers[event.subject.name], performers[event.object.name]
        first, last = event.frames
        palm = min(
            float(np.linalg.norm(grip_points(actor, actor.played, frame, ("r",))[0] - dog.crown(frame)))
            for frame in range(first + (last - first) // 3, last - (last - first) // 3)
        )
        assert palm < 0.12, f"{100 * palm:.0f} cm from the crown"
    stroked = {event.object.name for event in petted}
    assert any(prop.name not in stroked for prop in stage.group("dog"))
