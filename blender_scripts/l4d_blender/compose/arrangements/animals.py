"""Animals of arrangements: a body with a drawn look, in a drawn posture. They stay as they are."""

from __future__ import annotations

import random
from collections.abc import Callable

from mathutils import Vector

from ...assets import waterbird
from ...motion.cats import Cat
from ...motion.dogs import Dog
from ...motion.hens import Hen
from ...motion.waterbirds import WaterBird
from ...scene import catalogue
from ...scene.scene import Instance
from ...scene.timeline import LAST_FRAME
from ..stage import Stage
from . import stock

Place = tuple[float, float, float]


def _cat(stage: Stage, rng: random.Random, name: str, item: stock.Item, at: Place, heading_deg: float) -> Cat:
    words = catalogue.find("cat").arguments(**item.look.words)
    posture = rng.choice(("stand", "stand", "sit", "sit", "crouch", "sleep"))
    return Cat(
        stage.scene,
        name,
        stage.next_id(),
        **words,
        at=at[:2],
        heading_deg=heading_deg,
        ground=lambda x, y: at[2],
        posture=posture,
        tail_side=rng.choice((-1.0, 1.0)),
        attributes=item.look.attributes,
    )


def _dog(stage: Stage, rng: random.Random, name: str, item: stock.Item, at: Place, heading_deg: float) -> Dog:
    words = catalogue.find("dog").arguments(**item.look.words)
    return Dog(
        stage.scene,
        name,
        stage.next_id(),
        **words,
        at=at[:2],
        heading_deg=heading_deg,
        posture=rng.choice(("stand", "stand", "sit", "lie")),
        attributes=item.look.attributes,
    )


def _hen(stage: Stage, rng: random.Random, name: str, item: stock.Item, at: Place, heading_deg: float) -> Hen:
    hen = Hen(
        stage.scene,
        name,
        stage.next_id(),
        **item.look.words,
        attributes=item.look.attributes,
        at=Vector(at),
        heading_deg=heading_deg,
    )
    if rng.random() < 0.4:
        hen.peck(0, LAST_FRAME)
    else:
        hen.stand(0, LAST_FRAME)
    return hen


def _waterbird(
    stage: Stage, rng: random.Random, name: str, item: stock.Item, at: Place, heading_deg: float
) -> WaterBird:
    bird = WaterBird(
        stage.scene,
        name,
        stage.next_id(),
        species=waterbird.DUCK if item.noun == "duck" else waterbird.GULL,
        **item.look.words,
        category=item.noun,
        attributes=item.look.attributes,
        at=at,
        heading_deg=heading_deg,
    )
    bird.pause(0, LAST_FRAME)
    return bird


BODIES: dict[str, Callable[..., Cat | Dog | Hen | WaterBird]] = {
    "cat": _cat,
    "dog": _dog,
    "hen": _hen,
    "waterbird": _waterbird,
}
"""By kind."""


def put(
    stage: Stage, rng: random.Random, name: str, item: stock.Item, at: Place, heading_deg: float
) -> Instance:
    """Builds an animal that stands at a point of the ground."""
    body = BODIES[item.look.kind](stage, rng, name, item, at, heading_deg)
    body.finish()
    return body.instance
