"""The catalogue is complete, and what it says about its kinds is true."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import random
import re

import bpy
import pytest
from mathutils import Vector

from l4d_blender import assets
from l4d_blender.scene import catalogue, placing
from l4d_blender.scene.catalogue import Choice
from l4d_blender.scene.scene import FRONT_AXES, RecipeError, Scene

KINDS = catalogue.kinds()


def size_of(thing: placing.Thing) -> list[float]:
    bpy.context.view_layer.update()
    corners = [part.matrix_world @ Vector(c) for part in placing.parts(thing) for c in part.bound_box]
    return [max(c[axis] for c in corners) - min(c[axis] for c in corners) for axis in range(3)]


def test_every_asset_is_in_the_catalogue():
    assets_found = set()
    for module in pkgutil.iter_modules(assets.__path__):
        if module.ispkg:
            continue
        functions = vars(importlib.import_module(f"l4d_blender.assets.{module.name}")).values()
        for function in filter(inspect.isfunction, functions):
            parameters = list(inspect.signature(function).parameters.values())
            first = [parameter.name for parameter in parameters[:2]]
            own = function.__module__.endswith(f".{module.name}") and function.__name__[0] != "_"
            if own and first == ["name", "rng"]:
                assets_found.add(function)
                assert all(p.kind is p.KEYWORD_ONLY for p in parameters[2:]), function
                assert all(p.default is not p.empty for p in parameters[2:]), function
    assert assets_found == {kind.factory for kind in KINDS.values()}


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_can_be_built_and_is_as_large_as_it_says(name):
    kind = KINDS[name]
    assert re.fullmatch(r"[a-z]+(_[a-z]+)*", kind.category)
    assert kind.front is None or kind.front in FRONT_AXES
    Scene("toy", "room")
    thing = kind.build("thing", random.Random(0))
    assert all(part.type == "MESH" for part in placing.parts(thing))
    assert size_of(thing) == pytest.approx(kind.size_m, rel=0.02, abs=0.002)
    placing.place(thing, (1.0, 2.0, 0.5), 30.0)


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.attributes])
def test_every_kind_can_have_its_attributes(name):
    kind = KINDS[name]
    chosen = {
        key: list(attribute.values)[-1] if isinstance(attribute, Choice) else attribute.high
        for key, attribute in kind.attributes.items()
    }
    Scene("toy", "room").make(name, "thing", **chosen)


@pytest.mark.parametrize(
    ("kind", "attributes", "complaint", "hint"),
    [
        ("appel", {}, "no kind 'appel'", "apple"),
        ("apple", {"taste": "sour"}, "no attribute 'taste'", "colour"),
        ("apple", {"colour": "blue"}, "colour of apple is 'blue'", "green"),
        ("ball", {"radius_m": 3.0}, "radius_m of ball is 3.0", "0.02 to 0.2"),
    ],
)
def test_what_the_catalogue_lacks_is_refused_with_a_hint(kind, attributes, complaint, hint):
    with pytest.raises(RecipeError, match=complaint) as error:
        Scene("toy", "room").make(kind, "thing", **attributes)
    assert hint in error.value.hint


def test_added_things_are_of_their_kind():
    scene = Scene("toy", "room")
    lamp = scene.add(1, "desk_lamp", "lamp", (0.5, 0.0), 90.0, attributes={"colour": "red"}, colour="red")
    assert (lamp.category, lamp.front, lamp.attributes) == ("lamp", None, {"colour": "red"})
    case = scene.add(2, "suitcase", "case", on=0.5, front=None)
    assert case.front is None and len(case.objects) == 2
    assert scene.add(3, "suitcase", "other_case", category="luggage").front == "-y"
