"""Children with teddy bears: they fetch them, hug and rock them, carry them about."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..areas import Area
from ..people import crowd, errands, folk
from ..people.wares import WARES
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_VERBS = tuple(
    [
        "walk",
        "lift",
        "hold",
        "hug",
        "rock",
        "carry",
        "put_down",
        "wave",
        "stand",
        "crouch",
        "stretch",
        "cheer",
    ]
)


@theme("room", needs=("floor",), categories=("child", "teddy"), verbs=_VERBS)
def teddies_indoors(stage: Stage) -> None:
    """Children with teddies on the floor of a room."""
    _play(stage, stage.area("floor"))


def _play(stage: Stage, area: Area) -> None:
    rng, ware = stage.rng("teddies"), WARES["teddy"]
    figures = folk.cast(rng, "child", crowd.head_count(rng, area))
    looks = ware.draw(rng, crowd.head_count(rng, area))
    crowd.play(stage, area, "teddies", _cuddle, figures, ware, looks)
    stage.tell("Children play with their teddies.")


def _cuddle(group: crowd.Crowd) -> None:
    """One or two hug a bear, others carry one about or put it down."""
    rng, area = group.rng, group.area
    dos = [
        errands.fetch_and_hug,
        *rng.sample((errands.fetch_and_hug, errands.bring, errands.move, errands.carry_about), 2),
    ]
    for do in dos:
        if len(group.idle) > rng.choice((0, 1)) and len(group.spare) > 1:
            group.send(lambda *who, do=do: do(rng, area, *who, rng.randint(0, 8)), item=group.spare.pop())
    group.stand_about(("wave", "crouch", "cheer", "stretch"))
