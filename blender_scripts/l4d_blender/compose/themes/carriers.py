"""People who carry things to and fro: buckets in a yard, baskets at a market, bags and suitcases in a hall."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from .. import errands, folk
from ..areas import Area
from ..looks import Look
from ..rehearsal import Board, rehearse, roomy_m2
from ..roles import Item, Role, perform
from ..wares import WARES, Ware
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_VERBS = (
    "walk lift carry hold put_down hand_over take swing wave phone stand stretch crouch bend_down point_at".split()
)
_INDOORS = ("person", "woman", "man"), ("bag", "basket", "bucket")
_OUTDOORS = ("person", "woman", "man", "pedestrian", "child"), ("bucket", "basket", "bag")


@theme(
    "room",
    needs=("floor",),
    categories=(*_INDOORS[0], *_INDOORS[1]),
    verbs=tuple(_VERBS),
)
def carriers_indoors(stage: Stage) -> None:
    """People carry bags, baskets or buckets about in a room."""
    _play(stage, stage.area("floor"), *_INDOORS)


@theme(
    "outdoor",
    needs=("lawn",),
    categories=(*_OUTDOORS[0], *_OUTDOORS[1]),
    verbs=tuple(_VERBS),
)
def carriers_outdoors(stage: Stage) -> None:
    """People carry buckets, baskets or bags about in a yard or on a lawn."""
    _play(stage, stage.area("lawn"), *_OUTDOORS)


def _play(stage: Stage, area: Area, nouns: tuple[str, ...], wares: tuple[str, ...]) -> None:
    rng = stage.rng("carriers")
    noun = stage.pick("carriers/noun", nouns, stage.spec.categories)
    ware = WARES[stage.pick("carriers/ware", wares, stage.spec.categories)]
    roomy = roomy_m2(area) > 8.0
    figures = folk.cast(rng, noun, rng.choice((3, 4)) if roomy else 3)
    things = ware.draw(rng, rng.choice((3, 4)) if roomy else 3)

    def draw(k: int) -> tuple[list[Role], list[Item]]:
        tried, board = stage.rng(f"carriers/{k}"), Board(stage.scene, area)
        items = [_lay(tried, board, ware, n, look) for n, look in enumerate(things)]
        roles = _errands(tried, board, figures, items)
        board.check_sight()
        return roles, items

    roles, items = rehearse(stage, "errands", draw)
    perform(stage, area, roles, items)
    stage.tell(f"People carry {ware.noun}s to and fro; some wait.")


def _lay(rng: random.Random, board: Board, ware: Ware, number: int, look: Look) -> Item:
    def lie() -> Item:
        spots = [board.area.spot(rng, ware.radius_m + 0.05) for _ in range(3)]
        at = min(spots, key=board.area.margin) if rng.random() < 0.7 else spots[0]
        return Item.lying(f"{ware.noun}_{number + 1}", ware, look, at, rng.uniform(-180, 180))

    return board.add(lie, lambda item: [item.disc])


def _errands(
    rng: random.Random, board: Board, figures: list[folk.Figure], items: list[Item]
) -> list[Role]:
    """Two or three people have errands with different things, the others pass the time."""
    area, spare = board.area, rng.sample(items, len(items))
    order = rng.sample(figures, len(figures))
    roles: list[Role] = []

    def send(errand: str, item: Item) -> None:
        start = item.disc.copy()

        def draw() -> list[Role]:
            item.disc.restore(start)
            figure = order[0]
            if errand == "hand_over":
                return list(errands.hand_over(rng, area, figure, order[1], item))
            if errand == "relay":
                one = errands.bring(rng, area, figure, item)
                return [one, errands.relay(rng, area, order[1], item, one)]
            return [getattr(errands, errand)(rng, area, figure, item, rng.randint(0, 8))]

        made = board.add(draw, lambda roles: [item.disc, *(role.disc for role in roles)])
        del order[: len(made)]
        roles.extend(made)

    send(rng.choice(("fetch", "bring", "move", "hand_over", "relay", "carry_about")), spare.pop())
    for errand in rng.sample(("fetch", "bring", "move", "carry_about"), rng.choice((1, 1, 2))):
        if len(order) > (0 if len(roles) < 2 else 1) and len(spare) > 1:
            send(errand, spare.pop())
    for figure in order:
        bystander = board.add(
            lambda figure=figure: errands.bystander(rng, area, figure, area.centre), lambda role: [role.disc]
        )
        if rng.random() < 0.6:
            bystander.stand(rng.randint(16, 34))
        roles.append(bystander)
    for role in roles:
        if role.left >= 16:
            errands.gesture(rng, role, ("wave", "phone", "stretch", "crouch", "bend_down"))
        if role.left >= 16:
            role.stand()
    return sorted(roles, key=lambda role: role.name)
