"""A composition becomes a scene: draws theme and place, lets them play, and throws away what went wrong."""

from __future__ import annotations

import random
from dataclasses import replace

from ..scene.scene import RecipeError, Scene
from .errors import Rejected
from .places import Place, places
from .spec import Spec, SpecError
from .stage import Stage
from .themes import Theme, themes

_PLANS = 3
"""Plans of a place, and of a theme on it, before a draw is thrown away for want of room."""


def build(spec: Spec) -> tuple[Scene, Stage]:
    """Runs one draw.

    Raises `Rejected` if it does not become a scene, `SpecError` if no draw of this composition ever could.
    """
    spec = pinned(spec)
    assert spec.place is not None and spec.theme is not None
    place, theme = places()[spec.place], themes()[spec.theme]
    try:
        stage = _furnished(spec, place)
        _play(stage, theme)
        for performer in stage.performers:
            performer.finish()
        stage.scene.check()
    except (RecipeError, Rejected) as error:
        raise Rejected(f"{theme.name} in {place.name}: {error}") from error
    _demands(spec, stage.scene)
    return stage.scene, stage


def _furnished(spec: Spec, place: Place) -> Stage:
    """An empty scene with the place in it; one without room for all of its landmarks is furnished anew."""
    plan = 0
    while True:
        stage = Stage(Scene(spec.scene, spec.scale, spec.seed), spec, plan)
        try:
            place.furnish(stage)
            return stage
        except Rejected:
            plan += 1
            if plan == _PLANS:
                raise


def _play(stage: Stage, theme: Theme) -> None:
    """Lets the theme act. One that finds no room before it has built anything plans again, on the same stage.

    A plan costs a fraction of what furnishing another place does. The first is what it would be if there were
    no others.
    """
    furnished = stage.memory()
    for plan in range(_PLANS):
        stage.plan = plan
        try:
            return theme.play(stage)
        except Rejected:
            if plan + 1 == _PLANS or not stage.recall(furnished):
                raise


def pinned(spec: Spec) -> Spec:
    """The same composition with theme and place drawn: places that are added later do not change it."""
    place, theme = _setting(spec)
    return replace(spec, place=place.name, theme=theme.name)


def settings(scale: str) -> list[tuple[Theme, list[Place]]]:
    """The themes of a scale with the places that offer what each needs."""
    found = []
    for theme in themes().values():
        fitting = [
            place for place in places().values() if place.scale == scale and theme.needs <= place.offers
        ]
        if scale in theme.scales and fitting:
            found.append((theme, fitting))
    return found


def _setting(spec: Spec) -> tuple[Place, Theme]:
    """Draws the theme first, then one of the places that suit it."""
    known = settings(spec.scale)
    _refuse_unknown(spec, known)
    choices = [
        (theme, [place for place in fitting if spec.place in (None, place.name)])
        for theme, fitting in known
        if spec.theme in (None, theme.name)
        and set(spec.categories) <= theme.categories
        and set(spec.verbs) <= theme.verbs
    ]
    choices = [(theme, fitting) for theme, fitting in choices if fitting]
    if not choices:
        wanted = ", ".join([*spec.categories, *spec.verbs, *filter(None, (spec.place, spec.theme))])
        raise SpecError(
            f"no {spec.scale} theme has all of: {wanted}",
            "ask for fewer things at once; `l4d compose --list` says what each theme can show",
        )
    rng = random.Random(f"{spec.scene}/setting/{spec.seed}.{spec.draw}")
    theme, fitting = rng.choice(choices)
    return rng.choice(fitting), theme


def _refuse_unknown(spec: Spec, known: list[tuple[Theme, list[Place]]]) -> None:
    words = {
        "place": ({place.name for _, fitting in known for place in fitting}, filter(None, [spec.place])),
        "theme": ({theme.name for theme, _ in known}, filter(None, [spec.theme])),
        "categories": ({word for theme, _ in known for word in theme.categories}, spec.categories),
        "verbs": ({word for theme, _ in known for word in theme.verbs}, spec.verbs),
    }
    for key, (possible, asked) in words.items():
        for word in asked:
            if word not in possible:
                raise SpecError(
                    f"{key}: no {spec.scale} scene has {word!r}", f"known: {', '.join(sorted(possible))}"
                )


def _demands(spec: Spec, scene: Scene) -> None:
    categories = {instance.category for instance in scene.instances}
    verbs = {event.verb for event in scene.events}
    missing = [*(set(spec.categories) - categories), *(set(spec.verbs) - verbs)]
    if missing:
        raise Rejected(f"lacks {', '.join(sorted(missing))}")
