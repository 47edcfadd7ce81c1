"""Bodies of animals: what a plan's part and a look become in the scene. Knows no acts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from ...motion.dogs import Dog
from ...scene import catalogue
from ...scene.scene import Instance
from ..looks import Look
from .members import Part

if TYPE_CHECKING:
    from ..stage import Stage


class Animal(Protocol):
    """A body in the scene."""

    instance: Instance


def enter(stage: Stage, kind: str, animal: Animal, look: Look, part: Part) -> None:
    """Registers an animal that begins where its part says; it moves, so it belongs to no area."""
    stage.register(
        kind,
        animal.instance.name,
        animal.instance,
        at=part.at,
        heading_deg=part.heading_deg,
        area=None,
        look=look,
    )


def dog(stage: Stage, number: int, look: Look, part: Part) -> Dog:
    """A dog of a plan, built and registered."""
    body = Dog(
        stage.scene,
        f"dog_{number}",
        stage.next_id(),
        **catalogue.find("dog").arguments(**look.words),
        at=part.at,
        heading_deg=part.heading_deg,
        posture=part.posture,
        attributes=look.attributes,
    )
    enter(stage, "dog", body, look, part)
    return body
