"""A theme that finds no room plans again on the same stage; one that has built something does not."""

from __future__ import annotations

import random

import pytest

from l4d_blender.compose import build
from l4d_blender.compose.areas import Area
from l4d_blender.compose.errors import NoRoom
from l4d_blender.compose.looks import Look
from l4d_blender.compose.people import folk
from l4d_blender.compose.places import Place
from l4d_blender.compose.spec import Spec
from l4d_blender.compose.stage import Stage
from l4d_blender.compose.themes import Theme
from l4d_blender.scene.scene import Scene
from l4d_blender.worker import tracks  # noqa: F401  brings bpy


def _stage() -> Stage:
    spec = Spec("room_77", "room", 77, 3)
    stage = Stage(Scene(spec.scene, spec.scale, spec.seed), spec)
    stage.add_area(Area.rectangle("floor", (0.0, 0.0), (2.0, 2.0)))
    stage.area("floor").take((0.5, 0.5), 0.2, owner="lamp")
    stage.scene.cameras(
        (0.0, 0.0, 0.5), radius_m=3.0, heights_m=(1.2, 1.6), arc_deg=90.0, facing_deg=0.0, fov_deg=50.0
    )
    return stage


def _theme(play) -> Theme:
    return Theme("test", frozenset({"room"}), frozenset(), frozenset(), frozenset(), play)


def _failing(stage: Stage, times: int, seen: list, *, builds: bool = False):
    """A theme that takes room, tells a story, and fails so many times."""

    def play(stage: Stage) -> None:
        floor = stage.area("floor")
        cameras = [camera.world_from_camera.copy() for camera in stage.scene.camera_rig]
        seen.append((list(floor.taken), list(stage.sentences), cameras, stage.rng("x").random()))
        floor.take((0.0, 0.0), 0.5, owner="plan")
        stage.areas["floor"] = Area.rectangle("floor", (0.0, 0.0), (0.5, 0.5))
        stage.tell("A plan.")
        stage.film(list(reversed(stage.scene.camera_rig)))
        if builds:
            stage.member(Look("ball", {}, {}), "ball_1", (0.0, 0.0), area=floor)
        if len(seen) <= times:
            raise NoRoom("no room")

    build._play(stage, _theme(play))


def test_another_plan_starts_from_the_furnished_stage_with_other_numbers():
    stage, seen = _stage(), []
    first = stage.rng("x").random()
    _failing(stage, 1, seen)
    assert len(seen) == 2
    assert seen[0][:3] == seen[1][:3], "room, story and cameras are as they were"
    assert seen[0][3] == first, "the first plan is what it would be if there were no others"
    assert seen[1][3] != first
    assert stage.sentences == ["A plan."]


def test_plans_end():
    seen = []
    with pytest.raises(NoRoom):
        _failing(_stage(), 99, seen)
    assert len(seen) == build._PLANS


def test_what_has_been_built_is_not_planned_again():
    seen = []
    with pytest.raises(NoRoom):
        _failing(_stage(), 1, seen, builds=True)
    assert len(seen) == 1


@pytest.mark.parametrize(("times", "works"), [(1, True), (99, False)])
def test_a_place_without_room_is_furnished_anew(times, works):
    seen = []

    def furnish(stage: Stage) -> None:
        seen.append((len(stage.scene.instances), stage.rng("x").random()))
        stage.add_area(Area.rectangle("floor", (0.0, 0.0), (2.0, 2.0)))
        stage.landmark("ball", "ball_mark", (0.0, 0.0), area=stage.area("floor"))
        if len(seen) <= times:
            raise NoRoom("no room")

    place = Place("test", "room", frozenset({"floor"}), furnish)
    spec = Spec("room_77", "room", 77, 3)
    if works:
        stage = build._furnished(spec, place)
        assert [prop.name for prop in stage.landmarks] == ["ball_mark"]
    else:
        with pytest.raises(NoRoom):
            build._furnished(spec, place)
    assert [count for count, _ in seen] == [0] * len(seen), "on an empty scene"
    assert len({number for _, number in seen}) == len(seen) == (2 if works else build._PLANS)


def test_men_in_the_clothes_of_athletes_have_short_hair():
    for seed in range(60):
        figures = folk.cast(random.Random(seed), "man", 4, wardrobe="athlete")
        assert {figure.dress.hair for figure in figures} == {"short"}
        assert len({tuple(sorted(figure.look.attributes.items())) for figure in figures}) >= 2
