"""Travellers with trolley suitcases: they pull and park them, wait beside them, wave and telephone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..areas import Area
from ..people import crowd, errands, folk
from ..people.wares import WARES
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_NOUNS = ("person", "woman", "man")
_VERBS = tuple(["walk", "pull", "hold", "roll", "wave", "phone", "stand", "stretch"])


@theme("room", needs=("floor",), categories=(*_NOUNS, "suitcase"), verbs=_VERBS)
def luggage_indoors(stage: Stage) -> None:
    """Travellers in a room."""
    _play(stage, stage.area("floor"))


@theme("outdoor", needs=("lawn",), categories=(*_NOUNS, "pedestrian", "suitcase"), verbs=_VERBS)
def luggage_outdoors(stage: Stage) -> None:
    """Travellers outdoors."""
    _play(stage, stage.area("lawn"), "pedestrian")


def _play(stage: Stage, area: Area, *more: str) -> None:
    rng, ware = stage.rng("luggage"), WARES["suitcase"]
    noun = stage.pick("luggage/noun", (*_NOUNS, *more), stage.spec.categories)
    figures = folk.cast(rng, noun, crowd.head_count(rng, area))
    looks = ware.draw(rng, crowd.head_count(rng, area))
    crowd.play(stage, area, "luggage", _travel, figures, ware, looks)
    stage.tell("Travellers with suitcases, on their way or waiting.")


def _travel(group: crowd.Crowd) -> None:
    """One or two pull a suitcase, one waits beside another."""
    rng, area = group.rng, group.area
    dos = [errands.pull_suitcase, *rng.sample((errands.pull_suitcase, errands.wait_with_suitcase), 2)]
    for do in dos:
        if len(group.idle) > rng.choice((0, 1)) and len(group.spare) > 1:
            group.send(lambda *who, do=do: do(rng, area, *who), item=group.spare.pop())
    group.stand_about(("wave", "phone", "wave", "stretch"))
