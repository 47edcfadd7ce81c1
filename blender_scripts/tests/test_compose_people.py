"""People of composed scenes: whom a draw casts, what a plan refuses, what is recorded of those who act."""

from __future__ import annotations

import random
from collections import Counter
from itertools import combinations

import bpy  # noqa: F401, it brings mathutils
import numpy as np
import pytest
from conftest import first_of

from l4d_blender.compose import build, checks
from l4d_blender.compose.areas import Area
from l4d_blender.compose.errors import NoRoom, Rejected
from l4d_blender.compose.people import crowd, folk
from l4d_blender.compose.people.errands import hand_over, pull_suitcase
from l4d_blender.compose.people.rehearsal import Disc, _behind, ahead
from l4d_blender.compose.people.roles import Item, Role
from l4d_blender.compose.people.wares import WARES
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Chair, Stage
from l4d_blender.compose.themes import themes
from l4d_blender.scene.scene import Scene
from l4d_blender.worker import tracks


def appearance(attributes) -> tuple:
    return tuple(sorted(attributes.items()))


@pytest.mark.parametrize("noun", sorted(folk.BUILDS))
@pytest.mark.parametrize("seed", range(4))
def test_a_group_has_twins_and_no_one_else_is_alone_with_a_property(noun: str, seed: int) -> None:
    figures = folk.cast(random.Random(f"{noun}/{seed}"), noun, 4)
    looks = Counter(appearance(figure.look.attributes) for figure in figures)
    assert sorted(looks.values()) == [1, 1, 2]
    twins = [f for f in figures if looks[appearance(f.look.attributes)] == 2]
    first, second = (twin.dress for twin in twins)
    worn = [(dress.build, dress.top, dress.lower, dress.skin) for dress in (first, second)]
    assert worn[0] == worn[1]
    assert abs(first.height_m / second.height_m - 1.0) < 0.04
    assert {figure.dress.build for figure in figures} <= set(folk.BUILDS[noun])


@pytest.mark.parametrize("noun", sorted(WARES))
def test_things_have_twins(noun: str) -> None:
    looks = Counter(appearance(look.attributes) for look in WARES[noun].draw(random.Random(noun), 4))
    assert sorted(looks.values()) == [1, 1, 2]


def test_scale_is_that_of_the_anatomy() -> None:
    from l4d_blender.assets.anatomy import Anatomy

    for figure in folk.cast(random.Random(5), "person", 3):
        dress = figure.dress
        assert figure.scale == pytest.approx(Anatomy(dress.build, dress.height_m, dress.girth).scale)


def test_ahead_is_where_somebody_looks() -> None:
    assert ahead((0.0, 0.0), 0.0, 1.0) == pytest.approx((0.0, -1.0))
    assert ahead((0.0, 0.0), 90.0, 1.0, 0.5) == pytest.approx((1.0, 0.5))


def test_a_cylinder_hides_what_is_behind_it() -> None:
    eye = np.array([0.0, -4.0, 1.5])
    points = np.array([[[[0.0, 2.0, 1.0], [1.5, 2.0, 1.0], [0.0, -2.0, 1.0]]]])
    hidden = _behind(eye, points, np.zeros((1, 2)), np.zeros(1), 0.3, 1.7)
    assert hidden.tolist() == [[[True, False, False]]]


def test_who_has_no_time_left_does_not_walk() -> None:
    (figure, *_) = folk.cast(random.Random(1), "woman", 3)
    role = Role(figure, (0.0, 0.0), 0.0)
    role.wait(90)
    with pytest.raises(NoRoom):
        role.walk([(0.0, -2.0)])


def test_a_pulled_suitcase_comes_behind() -> None:
    area = Area.rectangle("floor", (0.0, 0.0), (8.0, 8.0))
    rng = random.Random(3)
    (figure, *_) = folk.cast(rng, "person", 3)
    ware = WARES["suitcase"]
    item = Item.lying("suitcase_1", ware, ware.draw(rng, 3)[0], (3.0, 3.0), 0.0)
    role = pull_suitcase(rng, area, figure, item)
    way = role.disc.xy[20] - role.disc.xy[10]
    assert (item.disc.xy[20] - role.disc.xy[20]) @ way < 0.0


def test_those_who_hand_over_face_each_other() -> None:
    area = Area.rectangle("floor", (0.0, 0.0), (8.0, 8.0))
    rng = random.Random(4)
    one, two, _ = folk.cast(rng, "person", 3)
    ware = WARES["basket"]
    item = Item.lying("basket_1", ware, ware.draw(rng, 3)[0], (0.0, 0.0), 0.0)
    for _ in range(50):
        try:
            giver, taker = hand_over(rng, area, one, two, item)
            break
        except NoRoom:
            continue
    gap = np.linalg.norm(giver.disc.xy[46] - taker.disc.xy[46])
    assert 0.8 < gap < 1.2
    assert taker.waits_for == [giver]


def planned(theme: str, monkeypatch, draw: int = 0) -> tuple[Stage, list[Role], list[Item]]:
    """A theme's plan on a bare floor with two chairs and a plant, without bodies."""
    scene = Scene("room_5", "room", 5)
    stage = Stage(scene, Spec("room_5", "room", 5, draw))
    scene.cameras((0, 0.2, 0.7), radius_m=4.2, heights_m=(1.6, 2.0), arc_deg=120, facing_deg=-90, fov_deg=54)
    floor = stage.add_area(Area.rectangle("floor", (0.0, 0.2), (3.8, 3.0)))
    stage.landmark("houseplant", "plant", (1.7, 1.5), area=floor, radius_m=0.3)
    stage.chairs += [Chair((-1.2, 1.5, 0.45), 0.0), Chair((-0.4, 1.5, 0.45), 0.0)]
    found: list[tuple] = []

    def perform(_, __, roles, items) -> None:
        found.append((roles, items))
        for item in items:
            item.prop = stage.landmarks[0]

    monkeypatch.setattr(crowd, "perform", perform)
    themes()[theme].play(stage)
    return stage, *found[0]


INDOORS = ("balls", "carriers", "company", "luggage", "teddies")
PEOPLE = [*(f"{theme}_indoors" for theme in INDOORS), "training"]


@pytest.mark.parametrize("theme", PEOPLE)
def test_a_plan_keeps_people_apart_and_draws_the_same_twice(theme: str, monkeypatch) -> None:
    _, roles, items = planned(theme, monkeypatch)
    assert len({role.name for role in roles}) == len(roles) >= 3
    discs = [role.disc for role in roles] + [item.disc for item in items]
    for a, b in combinations(discs, 2):
        if b.name not in a.friends and a.name not in b.friends:
            assert (np.linalg.norm(a.xy - b.xy, axis=1) >= a.radius_m + b.radius_m).all()
    _, again, things = planned(theme, monkeypatch)
    assert [role.disc.xy.tolist() for role in roles] == [role.disc.xy.tolist() for role in again]
    assert [item.disc.xy.tolist() for item in items] == [item.disc.xy.tolist() for item in things]
    _, other, _ = planned(theme, monkeypatch, draw=1)
    assert [role.disc.xy.tolist() for role in roles] != [role.disc.xy.tolist() for role in other]


def test_every_theme_tells_what_it_may_cast() -> None:
    for name in [*PEOPLE, "cooking"]:
        theme = themes()[name]
        assert theme.categories & set(folk.BUILDS)
        assert len(theme.verbs) >= 6


CARRIERS = [("room", "carriers_indoors"), ("outdoor", "carriers_outdoors")]


@pytest.fixture(scope="module", params=first_of(CARRIERS))
def played(request):
    scale, theme = request.param
    if theme not in {t.name for t, _ in build.settings(scale)}:
        pytest.skip("no place offers what the theme needs")
    for draw in range(6):
        try:
            return build.build(Spec(f"{scale}_7", scale, 7, draw, theme=theme))
        except Rejected:
            continue
    raise AssertionError("six draws of seed 7 were thrown away")


def test_carriers_carry(played) -> None:
    scene, _ = played
    verbs = {event.verb for event in scene.events}
    assert "hold" in verbs and verbs & {"lift", "put_down", "carry", "hand_over"}
    categories = Counter(i.category for i in scene.instances if i.role == "object")
    assert all(count >= 3 for count in categories.values()) and len(categories) == 2
    people = {i.name for i in scene.instances if i.category in folk.BUILDS}
    assert {event.subject.name for event in scene.events} <= people | {i.name for i in scene.instances}
    assert all(0 <= e.frames[0] < e.frames[1] <= 96 for e in scene.events)


def test_who_walks_travels_and_what_is_held_is_near(played) -> None:
    scene, stage = played
    shapes = {shape.instance.name: shape for shape in tracks.measure(scene)}
    for event in scene.events:
        if event.verb == "walk":
            first, last = (shapes[event.subject.name].centre[f] for f in event.frames)
            assert np.linalg.norm((last - first)[:2]) > 0.3
        if event.verb == "hold":
            middle = sum(event.frames) // 2
            a, b = shapes[event.subject.name], shapes[event.object.name]
            gap = np.maximum(a.low[middle] - b.high[middle], b.low[middle] - a.high[middle]).max()
            assert gap < 0.02
    checks.collisions(stage, list(shapes.values()))


def test_discs_can_be_restored() -> None:
    disc = Disc.at("cup", (0.0, 0.0), 0.1, 0.1, 0.2)
    before = disc.copy()
    disc.xy[40:] = 1.0
    disc.restore(before)
    assert not disc.xy.any()
