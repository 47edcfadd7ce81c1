"""Athletes with dumbbells: one curls, another stretches, a third fetches a weight."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import crowd, errands, folk, weights
from ..wares import WARES
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_NOUNS = ("athlete", "man", "woman")
_VERBS = tuple("lift hold curl rise put_down stretch walk carry crouch bend_down stand wave".split())


@theme("room", needs=("floor",), categories=(*_NOUNS, "dumbbell"), verbs=_VERBS)
def training(stage: Stage) -> None:
    """Athletes train on the floor of a room."""
    area, rng = stage.area("floor"), stage.rng("training")
    noun = stage.pick("training/noun", ("athlete", *_NOUNS), stage.spec.categories)
    figures = folk.cast(rng, noun, crowd.head_count(rng, area))
    looks = WARES["dumbbell"].draw(rng, crowd.head_count(rng, area))
    crowd.play(stage, area, "training", _train, figures, WARES["dumbbell"], looks)
    stage.tell("Athletes train with dumbbells, others stretch or rest.")


def _train(group: crowd.Crowd) -> None:
    """One or two curl, perhaps one fetches or moves a weight, the others stretch."""
    rng, area = group.rng, group.area
    group.send(lambda *who: weights.train(rng, area, *who, rng.randint(0, 6)), item=group.spare.pop())
    for errand in rng.sample((weights.train, errands.fetch, errands.move), rng.choice((1, 1, 2))):
        if len(group.idle) > 1 and len(group.spare) > 1:
            group.send(lambda *who, do=errand: do(rng, area, *who, rng.randint(0, 4)), item=group.spare.pop())
    group.stand_about(("stretch", "crouch", "bend_down", "stretch"))
