"""People who carry things to and fro: buckets in a yard, baskets at a market, bags in a hall."""

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
        "carry",
        "hold",
        "put_down",
        "hand_over",
        "take",
        "swing",
        "wave",
        "phone",
        "stand",
        "stretch",
        "crouch",
        "bend_down",
    ]
)
_INDOORS = ("person", "woman", "man"), ("bag", "basket", "bucket")
_OUTDOORS = ("person", "woman", "man", "pedestrian", "child"), ("bucket", "basket", "bag")


@theme("room", needs=("floor",), categories=(*_INDOORS[0], *_INDOORS[1]), verbs=_VERBS)
def carriers_indoors(stage: Stage) -> None:
    """People carry bags, baskets or buckets about in a room."""
    _play(stage, stage.area("floor"), *_INDOORS)


@theme("outdoor", needs=("lawn",), categories=(*_OUTDOORS[0], *_OUTDOORS[1]), verbs=_VERBS)
def carriers_outdoors(stage: Stage) -> None:
    """People carry buckets, baskets or bags about in a yard or on a lawn."""
    _play(stage, stage.area("lawn"), *_OUTDOORS)


def _play(stage: Stage, area: Area, nouns: tuple[str, ...], wares: tuple[str, ...]) -> None:
    rng = stage.rng("carriers")
    noun = stage.pick("carriers/noun", nouns, stage.spec.categories)
    ware = WARES[stage.pick("carriers/ware", wares, stage.spec.categories)]
    figures = folk.cast(rng, noun, crowd.head_count(rng, area))
    looks = ware.draw(rng, crowd.head_count(rng, area))
    crowd.play(stage, area, "carriers", _errands, figures, ware, looks)
    stage.tell(f"People carry {ware.noun}s to and fro; some wait.")


def _errands(group: crowd.Crowd) -> None:
    """Two or three people have errands with different things, the others pass the time."""
    rng, area = group.rng, group.area

    def send(errand: str) -> None:
        item = group.spare.pop()
        if errand == "hand_over":
            group.send(lambda *who: errands.hand_over(rng, area, *who), people=2, item=item)
        elif errand == "relay":
            group.send(lambda *who: errands.brought_and_taken(rng, area, *who), people=2, item=item)
        else:
            do, delay = getattr(errands, errand), rng.randint(0, 8)
            group.send(lambda *who: do(rng, area, *who, delay), item=item)

    send(rng.choice(("fetch", "bring", "move", "hand_over", "relay", "carry_about")))
    for errand in rng.sample(("fetch", "bring", "move", "carry_about"), rng.choice((1, 1, 2))):
        if len(group.idle) > (0 if len(group.roles) < 2 else 1) and len(group.spare) > 1:
            send(errand)
    group.stand_about()
