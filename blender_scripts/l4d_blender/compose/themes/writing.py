"""Pens and notebooks: hands write lines and lay pens down, let pens roll, push a shut notebook aside."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

from ...scene.cameras import Camera
from .. import looks
from ..areas import Area, retried
from ..errors import NoRoom
from ..hands.arms import reaches, willing
from ..hands.graspables import GRASPABLES, apart
from ..hands.handling import Deed
from ..hands.penwork import SHUT_M, Lifting, Oblong, Rolling, Spread, Writing
from ..looks import Look
from ..sight import Bulk, hidden
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

BARRELS = ("red", "orange", "yellow", "green", "teal", "blue", "purple", "white", "navy")
STORIES = (("write", "roll"), ("write", "roll"), ("write", "lift"), ("write", "push"))


@theme(
    "tabletop",
    needs=("table", "clear", "paper"),
    categories=("pen", "notebook"),
    verbs=("write", "write_in", "lift", "put_down", "hold", "push", "roll", "slide"),
)
def writing(stage: Stage) -> None:
    """One hand writes, the other rolls or lifts a pen or pushes a notebook."""
    rng, table = stage.rng("writing"), stage.area("table")
    plan, rig = retried(table, 300, lambda: _plan(stage, rng, table))
    stage.film(rig)
    words = {book.name: book.open_on(stage, table) for book in plan.open}
    for item in (*plan.shut, *plan.pens):
        item.lay(stage, rng, table)
    for lying, book in plan.piled:
        assert lying.thing is not None and book.thing is not None
        stage.may_touch(lying.thing, book.thing)
    for deed in plan.deeds:
        if isinstance(deed, Writing):
            deed.play(stage, rng, words[deed.book.name])
        else:
            deed.play(stage, rng)
    stage.tell(f"{len(plan.pens)} pens and {1 + len(plan.shut)} notebooks on a desk; somebody writes.")


@dataclass
class _Plan:
    """What lies on a piece of a table, and what hands do with it."""

    pens: list[Oblong]
    open: list[Spread] = field(default_factory=list)
    shut: list[Oblong] = field(default_factory=list)
    deeds: list[Writing | Rolling | Lifting | Deed] = field(default_factory=list)
    piled: list[tuple[Oblong, Oblong]] = field(default_factory=list)


def _plan(stage: Stage, rng: random.Random, table: Area) -> tuple[_Plan, list[Camera]]:
    """The writer finds room first, then what else moves, then the rest, close enough to be seen from near."""
    pen, cover = GRASPABLES["marker_pen"], GRASPABLES["notebook.shut_notebook"]
    options = {"colour": apart(rng, BARRELS), "pattern": pen.options["pattern"]}
    cast = looks.crossed(rng, pen.kind, rng.choice((3, 3, 4)), options)
    plan = _Plan([Oblong.pen(f"pen_{k + 1}", look) for k, look in enumerate(cast)])
    free, arms = rng.sample(plan.pens, len(plan.pens)), reaches(stage, rng, table)
    covers = apart(rng, cover.options["colour"])
    for k, verb in enumerate(rng.choice(STORIES)):
        deed = _deed(rng, plan, verb, free, covers, _start(rng, k))
        willing(arms, partial(deed.plan, rng, table))
        plan.deeds.append(deed)
    middle = plan.open[0].at
    below = [deed.arm.name for deed in plan.deeds if deed.arm is not None]
    seat = stage.seats[0]
    for _ in range(rng.choice((1, 2)) - len(plan.shut)):
        book = _shut(rng, plan, covers)
        try:
            others = [*plan.open, *(other for other in plan.shut if other is not book)]
            book.lie_near(rng, table, middle, seat.heading_deg, 40.0, below, others)
        except NoRoom:
            plan.shut.pop()
    if not plan.shut:
        raise NoRoom("no room for a second notebook")
    moved = [deed.item for deed in plan.deeds if isinstance(deed, Deed)]
    still = [book for book in plan.shut if book not in moved]
    for item in free:
        if still and rng.random() < 0.6:
            book = still.pop()
            item.lie_on(rng, book)
            plan.piled.append((item, book))
        else:
            item.lie_near(rng, table, middle, 0.0, 180.0)
    writer = plan.deeds[0]
    assert isinstance(writer, Writing)
    if writer.pen.on_m:
        plan.piled.append((writer.pen, writer.book))
    return plan, _seen(stage, plan)


def _seen(stage: Stage, plan: _Plan) -> list[Camera]:
    """Cameras near enough to see pens well; refuses a plan that none sees."""
    books = [*plan.open, *plan.shut]
    rig = stage.closer([item.at for item in (*plan.pens, *books)], height_m=0.02, margin_m=0.08)
    thin, thick = GRASPABLES["marker_pen"].seen_m, GRASPABLES["notebook.shut_notebook"].seen_m
    hands_on = [deed.pen for deed in plan.deeds if not isinstance(deed, Deed)]
    bulks = [
        Bulk(item.at, (0.85 if item in hands_on else 0.95) * thin, 0.016, item.on_m) for item in plan.pens
    ]
    bulks += [Bulk(book.at, thick, 0.016) for book in books]
    marks = [Bulk(prop.at, 0.7 * prop.radius_m, prop.height_m) for prop in stage.landmarks]
    if hidden(rig, [bulks], marks):
        raise NoRoom("something would hardly be seen")
    return rig


def _start(rng: random.Random, k: int) -> int:
    """When a hand sets out; the writer may have its pen in its fingers."""
    if k == 0:
        return rng.choice((-16, rng.randint(1, 5)))
    return rng.choice((rng.randint(2, 10), rng.randint(30, 40)))


def _deed(
    rng: random.Random, plan: _Plan, verb: str, free: list[Oblong], covers: list[str], start: int
) -> Writing | Rolling | Lifting | Deed:
    """With one of the pens that are left, or with a notebook."""
    if verb == "write":
        look = Look("notebook.open_notebook", {"colour": covers[0]}, {"state": "open"})
        plan.open.append(Spread.open(rng, f"notebook_{len(plan.open) + 1}", look))
        return Writing(free.pop(), plan.open[-1], start)
    if verb == "push":
        book = _shut(rng, plan, covers)
        book.radius_m = SHUT_M
        return Deed("push", book, start, lengths_m=(0.07, 0.13), grip_m=0.008)
    return (Rolling if verb == "roll" else Lifting)(free.pop(), start)


def _shut(rng: random.Random, plan: _Plan, covers: list[str]) -> Oblong:
    """One more shut notebook, now of this colour and now of that, plain or dotted."""
    count = len(plan.shut)
    words = {"colour": covers[count % 2], "pattern": rng.choice(("plain", "dotted"))}
    book = Oblong.shut(
        f"notebook_{len(plan.open) + count + 3}", looks.of("notebook.shut_notebook", words, {"state": "shut"})
    )
    plan.shut.append(book)
    return book
