"""Themes of pens, spoons and laptops: ink comes out of the nib, spoons ride in bowls, lids swing open."""

from __future__ import annotations

from math import degrees

import bpy  # noqa: F401, it brings mathutils
import pytest
from mathutils import Vector

from l4d_blender.compose import build, themes
from l4d_blender.compose.errors import Rejected
from l4d_blender.compose.hands.penwork import Oblong, Spread, overlap
from l4d_blender.compose.hands.spoonwork import SHAPE
from l4d_blender.compose.looks import Look
from l4d_blender.compose.spec import Spec
from l4d_blender.motion import writing
from l4d_blender.scene import keys


def _played(theme: str, scale: str, seed: int):
    """The first draw of a seed that becomes a scene."""
    for draw in range(12):
        try:
            return build.build(Spec(f"{scale}_{seed}", scale, seed, draw, None, theme))
        except Rejected:
            continue
    raise AssertionError(f"no draw of {theme} becomes a scene")


def test_a_pen_writes_along_a_line_of_the_open_notebook() -> None:
    scene, stage = _played("writing", "tabletop", 3101)
    assert {event.verb for event in scene.events} <= themes.themes()["writing"].verbs
    (write,) = [event for event in scene.events if event.verb == "write"]
    (write_in,) = [event for event in scene.events if event.verb == "write_in"]
    pen, book = write.subject, write_in.object
    first, last = write.frames
    page = book.matrix(0).inverted()
    nibs = [page @ pen.matrix(f) @ writing.TIP for f in range(first + 2, last - 1)]
    assert all(0.02 < nib.x < 0.14 and abs(nib.y) < 0.09 for nib in nibs), "it leaves the right page"
    assert nibs[-1].x - nibs[0].x > 0.05
    words = [obj for obj in book.objects if ".word_" in obj.name]
    rises = [
        keys.object_matrix(word, 96).translation.z - keys.object_matrix(word, first).translation.z
        for word in words
    ]
    assert len(words) == 4 and min(rises) > 0.001, "a word does not come out of the page"
    still = (
        {prop.name for prop in stage.group("pen")}
        - {event.subject.name for event in scene.events}
        - {event.object.name for event in scene.events if event.object}
    )
    assert still, "all pens are used"


def test_notebooks_that_lie_on_each_other_overlap() -> None:
    look = Look("notebook.open_notebook", {}, {})
    spread = Spread("open", look, 0.1, half_m=0.06, heading_deg=0.0)
    shut = Oblong.shut("shut", Look("notebook.shut_notebook", {}, {}))
    shut.heading_deg = 0.0
    for x, found in ((0.20, True), (0.27, False), (-0.20, True), (-0.27, False)):
        shut.at = x, 0.0
        assert overlap(spread, shut) is found and overlap(shut, spread) is found
    shut.at, shut.heading_deg = (0.25, 0.0), 90.0
    assert overlap(spread, shut)


def test_laptops_swing_open_and_are_typed_on_by_both_hands() -> None:
    scene, stage = _played("laptops", "room", 3102)
    assert {event.verb for event in scene.events} <= themes.themes()["laptops"].verbs
    opened = [event for event in scene.events if event.verb == "swing_open"]
    assert opened
    for event in opened:
        base, lid = event.subject.objects[:2]
        first, last = event.frames

        def angle(frame: int, base=base, lid=lid) -> float:
            up = keys.object_matrix(lid, frame).to_3x3() @ Vector((0.0, -1.0, 0.0))
            flat = keys.object_matrix(base, frame).to_3x3() @ Vector((0.0, -1.0, 0.0))
            return degrees(up.angle(flat))

        assert angle(first) == pytest.approx(0.0, abs=1.0)
        assert angle(last) == pytest.approx(108.0, abs=1.0)
    used = {event.object.name for event in scene.events if event.verb in ("open", "type_on")}
    assert used and {prop.name for prop in stage.group("laptop")} - used, "all laptops are used"


def test_a_spoon_stirs_in_its_bowl_or_rides_in_it() -> None:
    seen: set[str] = set()
    for seed in (3103, 3104):
        scene, stage = _played("spoons", "tabletop", seed)
        verbs = {event.verb for event in scene.events}
        assert verbs <= themes.themes()["spoons"].verbs
        seen |= verbs
        bowls = stage.group("bowl")
        for event in scene.events:
            first, last = event.frames
            if event.verb == "circle":
                middle = next(
                    other.object.matrix(first).translation
                    for other in scene.events
                    if other.verb == "stir" and other.subject is event.subject
                )
                tips = [event.subject.matrix(f) @ SHAPE.tip - middle for f in range(first, last + 1)]
                assert all(tip.xy.length < 0.04 and 0.0 < tip.z < 0.05 for tip in tips)
            if event.verb == "ride":
                a, b = (event.subject.matrix(f).translation for f in (first, last))
                ways = [
                    prop.instance.matrix(last).translation - prop.instance.matrix(first).translation
                    for prop in bowls
                ]
                assert (b - a).length > 0.05
                assert min((b - a - way).length for way in ways) < 1e-4, "it leaves its bowl"
        used = {event.object.name for event in scene.events if event.object}
        used |= {event.subject.name for event in scene.events}
        assert {prop.name for prop in stage.group("spoon")} - used, "all spoons are used"
    assert seen & {"stir", "ride"}
