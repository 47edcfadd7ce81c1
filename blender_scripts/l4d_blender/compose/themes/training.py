"""Athletes with dumbbells: two curl, others stretch."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..people import crowd, folk, weights
from ..people.roles import Item, Role
from ..people.wares import WARES
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_NOUNS = ("athlete", "man", "woman")
_VERBS = tuple(
    ["lift", "hold", "curl", "rise", "put_down", "stretch", "walk", "crouch", "bend_down", "stand"]
)


@theme("room", needs=("floor",), categories=(*_NOUNS, "dumbbell"), verbs=_VERBS)
def training(stage: Stage) -> None:
    """Athletes train on the floor of a room."""
    area, rng = stage.area("floor"), stage.rng("training")
    noun = stage.pick("training/noun", ("athlete", *_NOUNS), stage.spec.categories)
    figures = folk.cast(rng, noun, crowd.head_count(rng, area), wardrobe="athlete")
    ware = replace(WARES["dumbbell"], radius_m=0.38, wide=0.5)  # the room of a step
    looks = ware.draw(rng, crowd.head_count(rng, area))
    made = crowd.play(stage, area, "training", _train, figures, ware, looks)
    mats = stage.rng("training/steps")
    colour = mats.choice(((0.10, 0.34, 0.36), (0.36, 0.10, 0.10), (0.14, 0.16, 0.36), (0.20, 0.21, 0.22)))
    for n, item in enumerate(made.items, 1):
        stage.dress(
            "gym_equipment.step", f"step_{n}", item.at, item.heading_deg + 90.0, on=area.on, colour=colour
        )
    stage.tell("Athletes train with dumbbells, others stretch or rest.")


def _train(group: crowd.Crowd) -> None:
    """Two curl, one after the other or both at once, the others stretch."""
    rng, area = group.rng, group.area
    for item in group.items:
        item.on = weights.STEP_M
        item.disc.base_m[:] = weights.STEP_M
    for latest in (6, 20):
        if len(group.idle) > 1:

            def train(figure: folk.Figure, item: Item, latest: int = latest) -> Role:
                return weights.train(rng, area, figure, item, rng.randint(0, latest))

            group.send(train, item=group.spare.pop())
    group.stand_about(("stretch", "crouch", "bend_down", "stretch"))
