"""Ball games: kicks, passes and throws on a lawn or in a room, and those who cheer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..areas import Area
from ..people import ball_play, crowd, errands, folk
from ..people.wares import balls
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_NOUNS = ("child", "person", "woman", "man")
_VERBS = tuple(["kick", "throw", "roll", "cheer", "wave", "walk", "stand", "lift", "hold", "carry", "crouch"])


@theme("room", needs=("floor",), categories=(*_NOUNS, "ball"), verbs=_VERBS)
def balls_indoors(stage: Stage) -> None:
    """Ball games on the floor of a room."""
    _play(stage, stage.area("floor"), 0.14, ("kick", "throw", "kicked_back"))


@theme("outdoor", needs=("lawn",), categories=(*_NOUNS, "ball"), verbs=_VERBS)
def balls_outdoors(stage: Stage) -> None:
    """Ball games on a lawn."""
    _play(stage, stage.area("lawn"), 0.19, ("kick", "kicked_back"))


def _play(stage: Stage, area: Area, radius_m: float, games: tuple[str, ...]) -> None:
    """`radius_m` is what can still be seen from the cameras; who throws needs a ball that fits a hand."""
    rng, ware = stage.rng("balls"), balls(radius_m)
    noun = stage.pick("balls/noun", _NOUNS, stage.spec.categories)
    figures = folk.cast(rng, noun, crowd.head_count(rng, area))
    looks = ware.draw(rng, crowd.head_count(rng, area))
    crowd.play(stage, area, "ball games", lambda g: _games(g, games), figures, ware, looks, edges=0.3)
    stage.tell("Balls are kicked or thrown; some watch and cheer.")


def _games(group: crowd.Crowd, games: tuple[str, ...]) -> None:
    """One or two games with different balls, perhaps somebody who picks a third one up."""
    rng, area = group.rng, group.area

    def send(errand: str) -> None:
        item, delay = group.spare.pop(), rng.randint(0, 26)
        if errand == "kicked_back":
            group.send(lambda *who: ball_play.kicked_back(rng, area, *who), people=2, item=item)
        elif errand == "fetch":
            group.send(lambda *who: errands.fetch(rng, area, *who), item=item)
        else:
            do = getattr(ball_play, errand)
            group.send(lambda *who: do(rng, area, *who, delay), item=item)

    send(rng.choice(games))
    for errand in rng.sample((*games[:-1], "fetch"), rng.choice((1, 1, 2))):
        if group.idle and len(group.spare) > 1:
            send(errand)
    group.stand_about(("cheer", "wave", "crouch", "cheer"))
