"""People who wait or sit together: they read, telephone, wave, sit down, walk about and point at things."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..areas import Area, heading_to
from ..errors import NoRoom
from ..people import crowd, errands, folk, seated
from ..people.roles import Role
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_INDOORS = ("person", "woman", "man")
_OUTDOORS = ("person", "woman", "man", "pedestrian")
_VERBS = tuple(
    [
        "sit",
        "hold",
        "turn_page",
        "phone",
        "wave",
        "walk",
        "stand",
        "point_at",
        "crouch",
        "stretch",
        "bend_down",
    ]
)


@theme("room", needs=("floor", "chairs"), categories=_INDOORS, verbs=_VERBS)
def company_indoors(stage: Stage) -> None:
    """People on chairs and on their feet in a room."""
    _play(stage, stage.area("floor"), _INDOORS)


@theme("outdoor", needs=("lawn", "chairs"), categories=_OUTDOORS, verbs=_VERBS)
def company_outdoors(stage: Stage) -> None:
    """People on a bench and on their feet outdoors."""
    _play(stage, stage.area("lawn"), _OUTDOORS)


def _play(stage: Stage, area: Area, nouns: tuple[str, ...]) -> None:
    rng = stage.rng("company")
    noun = stage.pick("company/noun", nouns, stage.spec.categories)
    figures = folk.cast(rng, noun, rng.choice((3, 4, 4)))
    crowd.play(stage, area, "company", _pass_time, figures)
    stage.tell("Some people sit, others stand or walk about.")


def _pass_time(group: crowd.Crowd) -> None:
    """One or two use chairs, one points at something, one walks, the others make gestures."""
    rng, stage = group.rng, group.stage
    chairs = rng.sample(stage.chairs, len(stage.chairs))
    ways = rng.sample(("read", "sit", "sit_down", "stand_then_sit"), 4)
    for chair, way in list(zip(chairs, ways))[: rng.choice((1, 2, 2))]:

        def take_seat(figure: folk.Figure, chair=chair, way: str = way) -> Role:
            if way == "read":
                return seated.read(rng, stage, figure, chair)
            if way == "sit":
                gestures = rng.choice((("wave",), ("phone",), ("wave", "wave")))
                return seated.sit(rng, figure, chair, gestures)
            if way == "sit_down":
                return seated.sit_down(rng, group.area, figure, chair)
            return seated.stand_then_sit(rng, figure, chair)

        group.send(take_seat)
    if not group.roles:
        raise NoRoom("there is no chair")
    for errand in rng.sample((_stroll, _point), 2):
        if len(group.idle) > rng.choice((0, 1)):
            group.send(lambda figure, errand=errand: errand(group, figure))
    group.stand_about(("wave", "phone", "stretch", "crouch", "wave"))


def _stroll(group: crowd.Crowd, figure: folk.Figure) -> Role:
    """Walks somewhere."""
    rng, area = group.rng, group.area
    role = Role(figure, area.spot(rng, 0.28), 0.0)
    role.wait(rng.randint(0, 30))
    errands.walk_off(rng, area, role, 0.3, fresh=True)
    return role


def _point(group: crowd.Crowd, figure: folk.Figure) -> Role:
    """Points at a landmark."""
    rng = group.rng
    target = rng.choice([prop for prop in group.stage.landmarks if prop.height_m > 0.05])
    role = errands.bystander(rng, group.area, figure, target.at, 50.0, group.board.discs)
    bearing = heading_to(role.here, target.at)
    role.wait(rng.randint(0, 24))
    if abs((bearing - role.facing + 180) % 360 - 180) > 70:
        raise NoRoom("somebody would point backwards")
    role.point_at(lambda: target, target.at, rng.randint(36, 46))
    return role
