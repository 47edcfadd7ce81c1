"""Tables, and themes of hands that move what lies on them."""

from __future__ import annotations

from collections import Counter

import pytest

from l4d_blender.compose import build
from l4d_blender.compose.errors import Rejected
from l4d_blender.compose.hands import graspables
from l4d_blender.compose.places import places
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Stage
from l4d_blender.compose.themes import themes
from l4d_blender.scene import catalogue
from l4d_blender.scene.scene import Scene
from l4d_blender.scene.timeline import MIN_EVENT_FRAMES

TABLES = [name for name, place in places().items() if "table" in place.offers and place.scale == "tabletop"]
THEMES = ("things_moved", "things_slid", "things_rolled")


def _furnished(place: str, seed: int) -> Stage:
    for draw in range(6):
        spec = Spec(f"tabletop_{seed}", "tabletop", seed, draw, place)
        stage = Stage(Scene(spec.scene, spec.scale, spec.seed), spec)
        try:
            places()[place].furnish(stage)
        except Rejected as error:
            print(error)
            continue
        return stage
    raise AssertionError(f"{place} is never furnished")


def _played(theme: str, seed: int):
    for draw in range(12):
        try:
            return build.build(Spec(f"tabletop_{seed}", "tabletop", seed, draw, None, theme))
        except Rejected:
            continue
    raise AssertionError(f"no draw of {theme} becomes a scene")


@pytest.mark.parametrize("place", TABLES)
def test_a_table_has_seats_landmarks_of_different_nouns_and_room(place: str) -> None:
    stage = _furnished(place, 3000)
    table = stage.area("table")
    xs, ys = [x for x, _ in table.corners], [y for _, y in table.corners]
    assert max(xs) - min(xs) >= 0.5 and max(ys) - min(ys) >= 0.4
    assert stage.seats and len(stage.scene.camera_rig) == 17
    nouns = [prop.instance.category for prop in stage.landmarks]
    assert len(nouns) >= 3 and len(set(nouns)) == len(nouns)
    for prop in stage.landmarks:
        assert table.margin(prop.at) >= 0.0
        assert all(
            other is prop
            or sum((a - b) ** 2 for a, b in zip(prop.at, other.at)) ** 0.5
            >= prop.radius_m + other.radius_m - 1e-6
            for other in stage.landmarks
        )


def test_another_seed_furnishes_otherwise() -> None:
    first, second = (_furnished("oak_table", seed) for seed in (3001, 3002))
    assert [p.at for p in first.landmarks] != [p.at for p in second.landmarks]


@pytest.mark.parametrize("theme", THEMES)
def test_hands_move_twins_and_others(theme: str) -> None:
    scene, stage = _played(theme, 3003)
    looks = Counter((p.instance.category, *sorted(p.look.attributes.items())) for p in stage.objects)
    assert max(looks.values()) >= 2 and len(looks) >= 2
    assert {p.instance.category for p in stage.objects} <= themes()[theme].categories
    assert {event.verb for event in scene.events} <= themes()[theme].verbs
    assert len(scene.events) >= 4
    for event in scene.events:
        assert event.frames[1] - event.frames[0] + 1 >= MIN_EVENT_FRAMES
        if event.verb in ("carry", "slide", "roll"):
            thing = event.object or event.subject
            a, b = (thing.matrix(frame).translation for frame in event.frames)
            assert (a - b).length > 0.05
    acted = {event.object.name for event in scene.events if event.object}
    assert any(p.name not in acted for p in stage.objects)


@pytest.mark.slow
def test_the_same_seed_moves_the_same_things() -> None:
    told = []
    for _ in range(2):
        scene, _stage = _played("things_slid", 3004)
        events = [(e.subject.name, e.verb, e.object.name if e.object else "", e.frames) for e in scene.events]
        told.append((events, [[i.matrix(f)[:] for f in (0, 50, 96)] for i in scene.instances]))
    assert told[0] == told[1]


@pytest.mark.parametrize("kind", sorted(graspables.GRASPABLES))
def test_what_is_graspable_is_in_the_catalogue_with_its_looks(kind: str) -> None:
    thing = graspables.GRASPABLES[kind]
    entry = catalogue.find(kind)
    for key, words in thing.options.items():
        entry_words = entry.attributes[key]
        assert isinstance(entry_words, catalogue.Choice)
        assert set(words) <= set(entry_words.values)
