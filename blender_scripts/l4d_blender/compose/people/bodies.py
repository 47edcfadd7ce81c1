"""Bodies of composed people: what a figure looks like becomes a `Person` on the stage."""

from __future__ import annotations

from ...assets import chef_hat
from ...motion.people import Person
from ...scene.placing import Point
from ..looks import Look
from ..stage import Prop, Stage
from .folk import Figure


def add_person(
    stage: Stage, figure: Figure, name: str, at: Point, heading_deg: float, ground_m: float = 0.0
) -> Person:
    """Builds the body of a figure and registers it as an object."""
    person = Person(
        stage.scene,
        name,
        stage.next_id(),
        category=figure.noun,
        look=figure.dress,
        attributes=figure.look.attributes,
        at=at,
        heading_deg=heading_deg,
        ground_m=ground_m,
    )
    if figure.hat:
        hat = chef_hat.put_on(f"{name}.hat", person.body)
        hat.pass_index = person.instance.id
        person.instance.objects.append(hat)
    stage.register(
        "person",
        name,
        person.instance,
        at=(at[0], at[1]),
        heading_deg=heading_deg,
        area=None,
        look=Look("person", {}, figure.look.attributes),
        radius_m=0.3,
    )
    return person


def middle_of(prop: Prop) -> tuple[float, float, float]:
    """A point in the middle of a thing where it stands at first."""
    at = prop.instance.matrix(0).translation
    return at.x, at.y, at.z + 0.5 * prop.height_m
