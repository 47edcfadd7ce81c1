"""A group of people and their things while a theme plans: who has an errand, who passes the time.

Takes errands from a theme, tries them on the plan until they fit, and lets everybody else rest. Builds
nothing before the whole plan works.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from ..areas import Area
from ..errors import NoRoom
from ..looks import Look
from ..stage import Stage
from . import errands
from .folk import Figure
from .rehearsal import Board, rehearse, roomy_m2
from .roles import Item, Role, perform
from .wares import Ware

Errand = Callable[..., Role | Sequence[Role]]
GESTURES = ("wave", "phone", "stretch", "crouch", "bend_down")


class Crowd:
    """People of one noun and things of one kind on one area, in one try of a plan."""

    def __init__(self, stage: Stage, rng: random.Random, area: Area, figures: Sequence[Figure]) -> None:
        self.stage, self.rng, self.area = stage, rng, area
        self.board = Board(stage.scene, area)
        self.items: list[Item] = []
        self.roles: list[Role] = []
        self.spare: list[Item] = []
        self.idle = rng.sample(list(figures), len(figures))

    def lay(self, ware: Ware, looks: Sequence[Look], *, edges: float = 0.7) -> None:
        """Puts things here and there, a share of them rather along the edges than in the middle."""
        for n, look in enumerate(looks, 1):

            def lie(n: int = n, look: Look = look) -> Item:
                spots = [self.area.spot(self.rng, ware.radius_m + 0.05) for _ in range(3)]
                at = min(spots, key=self.area.margin) if self.rng.random() < edges else spots[0]
                return Item.lying(f"{ware.noun}_{n}", ware, look, at, self.rng.uniform(-180, 180))

            self.items.append(self.board.add(lie, lambda item: [item.disc]))
        self.spare = self.rng.sample(self.items, len(self.items))

    def send(
        self, errand: Errand, *, people: int = 1, item: Item | None = None, tries: int = 30
    ) -> list[Role]:
        """Gives the next idle people an errand: `errand(figures..., item)`; the item only if there is one."""
        if len(self.idle) < people:
            raise NoRoom("there are too few people")
        figures, things = self.idle[:people], [] if item is None else [item]
        before = [thing.disc.copy() for thing in things]

        def draw() -> list[Role]:
            for thing, disc in zip(things, before):
                thing.disc.restore(disc)
                thing.holder, thing.before, thing.after = None, [], []
            made = errand(*figures, *things)
            return [made] if isinstance(made, Role) else list(made)

        made = self.board.add(
            draw, lambda roles: [*(thing.disc for thing in things), *(role.disc for role in roles)], tries
        )
        del self.idle[:people]
        self.roles += made
        return made

    def stand_about(self, gestures: Sequence[str] = GESTURES) -> None:
        """Everybody else stands somewhere; who has time left makes a gesture."""
        for figure in list(self.idle):

            def stand(figure: Figure) -> Role:
                return errands.bystander(
                    self.rng, self.area, figure, self.area.centre, apart_from=self.board.discs
                )

            (role,) = self.send(stand)
            if self.rng.random() < 0.6:
                role.stand(self.rng.randint(16, 34))
        for role in self.roles:
            if role.left >= 16:
                before = role.mark()
                errands.gesture(self.rng, role, gestures)
                if self.board.is_hit(role.disc):  # arms need room
                    role.back_to(before)
            if role.left >= 16:
                role.stand()


def play(
    stage: Stage,
    area: Area,
    key: str,
    plan: Callable[[Crowd], None],
    figures: Sequence[Figure],
    ware: Ware | None = None,
    looks: Sequence[Look] = (),
    *,
    edges: float = 0.7,
) -> Crowd:
    """Plans until a plan works, then builds and performs it."""

    def draw(k: int) -> Crowd:
        crowd = Crowd(stage, stage.rng(f"{key}/{k}"), area, figures)
        if ware is not None:
            crowd.lay(ware, looks, edges=edges)
        plan(crowd)
        crowd.board.check_sight()
        return crowd

    crowd = rehearse(stage, key, draw)
    crowd.roles.sort(key=lambda role: role.name)
    perform(stage, area, crowd.roles, crowd.items)
    return crowd


def head_count(rng: random.Random, area: Area) -> int:
    """How many people have room on an area."""
    return rng.choice((3, 4)) if roomy_m2(area) > 8.0 else 3
