"""Themes of toys, tea, writing, dinner and blocks: what they cast and what happens in them."""

from __future__ import annotations

from collections import Counter

import pytest
from conftest import first_of

from l4d_blender.compose import build, themes
from l4d_blender.compose.areas import Area
from l4d_blender.compose.errors import Rejected
from l4d_blender.compose.hands import arms
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Seat
from l4d_blender.scene.timeline import MIN_EVENT_FRAMES

THEMES = ("windup_toys", "spinning_tops", "tea_poured", "building_blocks", "rolling_toys", "dinner_laid")
_PLACE = "garden_table"


def _played(theme: str, seed: int):
    """The first draw of a seed that becomes a scene."""
    for draw in range(20):
        try:
            return build.build(Spec(f"tabletop_{seed}", "tabletop", seed, draw, _PLACE, theme))
        except Rejected:
            continue
    raise AssertionError(f"no draw of {theme} becomes a scene")


def _told(scene) -> list[tuple[str, str, str, int, int]]:
    return [(e.subject.name, e.verb, e.object.name if e.object else "", *e.frames) for e in scene.events]


@pytest.mark.parametrize("theme", THEMES)
def test_a_theme_casts_twins_and_lets_several_things_happen(theme: str) -> None:
    entry = themes.themes()[theme]
    scene, stage = _played(theme, 2000)
    looks = Counter((p.instance.category, *sorted(p.look.attributes.items())) for p in stage.objects)
    groups = Counter(p.instance.category for p in stage.objects)
    assert set(groups) <= entry.categories
    assert max(groups.values()) >= 3
    assert max(looks.values()) >= 2, "no twins"
    assert len(looks) >= 2, "all alike"
    assert 3 <= len(scene.events) <= 14
    for event in scene.events:
        assert event.frames[1] - event.frames[0] + 1 >= MIN_EVENT_FRAMES
    seen = {event.verb for event in scene.events}
    assert seen <= entry.verbs
    assert len(seen) >= 2


@pytest.mark.parametrize("theme", first_of(THEMES))
def test_the_same_seed_tells_the_same_story(theme: str) -> None:
    first, _ = _played(theme, 2003)
    places = {i.name: [[i.matrix(f) for f in (0, 48, 96)]] for i in first.instances}
    told = _told(first)
    again, _ = _played(theme, 2003)
    assert _told(again) == told
    assert {i.name: [[i.matrix(f) for f in (0, 48, 96)]] for i in again.instances} == places


def test_an_arm_reaches_what_is_before_its_shoulder_and_knows_its_way() -> None:
    table = Area.rectangle("table", (0.0, 0.0), (0.8, 0.6))
    seat = Seat((0.0, -0.5), 180.0, 0.25, 0.2)
    right = arms.Reach(seat, "r", arms.HandLook(), 0)
    left = arms.Reach(seat, "l", arms.HandLook(), 0)
    assert right.shoulder[0] > 0 > left.shoulder[0]
    assert right.reaches(table, (0.15, 0.0)) and not right.reaches(table, (-0.35, -0.2))
    assert left.reaches(table, (-0.35, -0.05)) and not left.reaches(table, (0.0, 0.5))
    assert right.is_clear(table, (0.15, 0.0))
    table.take((0.16, -0.15), 0.03, owner="cup")
    assert not right.is_clear(table, (0.15, 0.0))
    assert right.is_clear(table, (0.15, 0.0), ignoring=("cup",))
