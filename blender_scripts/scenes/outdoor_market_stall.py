"""A fruit stall on a cobbled market square under a bright, hazy sky. A customer with a basket in one hand
walks up; the vendor holds out a basket of fruit, the customer takes it and walks on with both, and the vendor
waves. A third basket, the twin of the customer's own, stands on the ground before the stall.

What tells look-alikes apart: two of the three baskets are twins, one carried and one left standing; the
basket of fruit changes hands, so who holds it depends on the time.
"""

from __future__ import annotations

from math import degrees, pi

from mathutils import Matrix

from l4d_blender.assets import basket
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import traders
from l4d_blender.motion.people import Person
from l4d_blender.scene.colour import Colour
from l4d_blender.scene.scattering import scatter
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

STALL = (0.10, 1.28)
VENDOR = ((-0.86, 0.46), degrees(pi / 2 - 0.35))
HANDOVER = (-0.01, 0.15)  # where the customer stands to take the basket
ON_GROUND = ((0.92, 0.56), degrees(0.5))

GRIP = (0.0, 0.0, basket.GRIP_Z_M)
NEAR_END = (-basket.GRIP_HALF_M, 0.0, basket.GRIP_Z_M)
FAR_END = (basket.GRIP_HALF_M, 0.0, basket.GRIP_Z_M)
CLEAR_M = 0.185


VENDOR_LOOK = Look(
    build="woman",
    height_m=1.66,
    girth=1.05,
    skin="tan",
    hair="bun",
    hair_colour="dark_brown",
    top=Cloth("light_blue"),
    sleeve="elbow",
    bottom="skirt",
    lower=Cloth("navy"),
    apron=Cloth("beige"),
    shoes="shoes",
    shoe_colour="brown",
    seed=71,
)
CUSTOMER_LOOK = Look(
    build="man",
    height_m=1.78,
    skin="fair",
    hair="short",
    hair_colour="brown",
    top=Cloth("red", "checks", "white", repeat_m=0.07),
    sleeve="long",
    bottom="trousers",
    lower=Cloth("denim", "denim"),
    shoes="shoes",
    shoe_colour="black",
    seed=52,
)
STRIPES: tuple[tuple[Colour, Colour], ...] = (
    ((0.46, 0.04, 0.04), (0.74, 0.70, 0.62)),
    ((0.06, 0.26, 0.12), (0.74, 0.70, 0.62)),
    ((0.06, 0.14, 0.40), (0.74, 0.70, 0.62)),
    ((0.66, 0.40, 0.05), (0.72, 0.68, 0.60)),
)


TWINS = ("light", "red")
HANDED = ("dark", "green", "apples")
RELEASE = 46
SUN_AZIMUTH_DEG = -148.0


def build(scene: Scene) -> None:
    """Sets up the market, lets two people deal, lights it."""
    _square(scene)
    _stalls(scene)
    _deal(scene, _baskets(scene))
    _light(scene)
    scene.cameras(
        (0.02, 0.30, 0.86),
        radius_m=3.95,
        heights_m=(1.35, 1.85, 1.60),
        arc_deg=112.0,
        facing_deg=-90.0,
        fov_deg=45.0,
    )


def _square(scene: Scene) -> None:
    """Paving, the houses round the square, trees in front of them: none annotated."""
    scene.make("cobbles", "paving")
    rng = scene.rng("square")
    for k, (x, y, turn) in enumerate(
        (
            (-15.6, 14.0, 0.75),
            (-5.6, 17.5, 0.06),
            (4.6, 18.0, -0.03),
            (14.8, 15.0, -0.60),
            (20.0, 6.0, -1.35),
            (-20.0, 5.0, 1.40),
            (21.0, -5.0, -1.6),
            (-21.0, -6.0, 1.6),
        )
    ):
        scene.put(
            "house",
            f"house_{k}",
            (x, y),
            degrees(turn),
            rng=scene.rng(f"house{k}"),
            size_xy=(rng.uniform(9.0, 10.4), 7.0),
            eaves_m=rng.uniform(4.6, 6.2),
        )
    model = scene.make("tree", "tree_model", scene.rng("tree"), height_m=5.2)
    spots = ((-7.0, 9.4), (7.6, 9.8), (10.6, 3.6), (-10.4, 2.6), (0.8, 11.6))
    scatter(scene, "tree", [model], spots, rng, sunk_m=0.0)


def _stalls(scene: Scene) -> None:
    """The stall of the story, and the others further off."""
    scene.add(1001, "market_stall", "stall", STALL, stripes=STRIPES[0])
    others = STRIPES[1:]
    for k, (x, y, turn) in enumerate(
        ((-3.1, 4.3, 0.25), (2.7, 4.6, -0.15), (5.2, 1.9, -0.9), (-5.0, 1.2, 1.0), (0.1, 7.2, 0.05))
    ):
        scene.put(
            "market_stall",
            f"other_stall_{k}",
            (x, y),
            degrees(turn),
            rng=scene.rng(f"stall{k}"),
            stripes=others[k % 3],
            skirt=((0.30, 0.05, 0.05), (0.06, 0.10, 0.24), (0.34, 0.26, 0.12))[k % 3],
            crates=3,
        )
    for k, (x, y, tall) in enumerate(((1.62, 1.02, 0.85), (1.86, 1.42, 0.60), (-1.42, 1.62, 0.95))):
        scene.put(
            "houseplant", f"plant_{k}", (x, y), degrees(1.3 * k), rng=scene.rng(f"plant{k}"), height_m=tall
        )


def _baskets(scene: Scene) -> dict[str, Instance]:
    """The one that changes hands and two twins, equal to the last rod."""
    plan = {
        "handed": ("basket_handed_over", HANDED, "handed", Matrix()),
        "standing": ("basket_on_ground", (*TWINS, "empty"), "twins", None),
        "carried": ("basket_of_customer", (*TWINS, "empty"), "twins", Matrix()),
    }
    baskets = {}
    for id, (role, (name, look, key, at)) in enumerate(plan.items(), 1):
        body = scene.make(
            "basket", name, scene.rng(f"basket/{key}"), wicker=look[0], cloth=look[1], content=look[2]
        )
        if at is None:
            scene.place(body, *ON_GROUND)
        else:
            body.matrix_basis = at
        baskets[role] = scene.instance(
            name, id, "basket", body, attributes={"wicker": look[0], "cloth": look[1], "content": look[2]}
        )
    return baskets


def _person(
    scene: Scene, name: str, id: int, look: Look, at: tuple[float, float], heading_deg: float
) -> Person:
    return Person(
        scene,
        name,
        id,
        category="person",
        look=look,
        attributes={
            "shirt": str(look.top.colour),
            "pattern": {"checks": "checked"}.get(look.top.pattern, look.top.pattern),
            "apron": str(look.apron.colour) if look.apron else "none",
            "hair": look.hair,
        },
        at=at,
        heading_deg=heading_deg,
    )


def _deal(scene: Scene, baskets: dict[str, Instance]) -> None:
    """The customer comes, takes the basket that the vendor holds out, and goes on."""
    release = RELEASE
    vendor = _person(scene, "person_selling", 4, VENDOR_LOOK, *VENDOR)
    vendor.hold(baskets["handed"], NEAR_END, side="r", bar=(1.0, 0.0, 0.0), clear_m=CLEAR_M)
    traders.offer(vendor, baskets["handed"], (release - 24, release + 20), release=release, side="r")
    vendor.wave((release + 26, LAST_FRAME), side="r")

    customer = _person(scene, "person_buying", 5, CUSTOMER_LOOK, (1.02, -0.11), degrees(-pi / 2 + 0.35))
    customer.hold(baskets["carried"], GRIP, side="l", bar=(1.0, 0.0, 0.0), clear_m=CLEAR_M)
    customer.walk_to(HANDOVER, (0, 32), facing_deg=VENDOR[1] - 180.0)
    vendor.look_at((HANDOVER[0], HANDOVER[1], 1.5), (0, LAST_FRAME))
    vendor.finish()
    traders.take(
        customer,
        baskets["handed"],
        FAR_END,
        (release - 16, release + 18),
        release=release,
        side="r",
        clear_m=CLEAR_M,
    )
    leave = release + 20
    customer.walk_along([(-0.20, -0.10), (-0.26, -0.50)], (leave, LAST_FRAME))
    customer.finish()
    traders.swing_while_carried(baskets["carried"], GRIP, [(0, 32), (leave, LAST_FRAME)])
    traders.swing_while_carried(baskets["handed"], FAR_END, [(leave, LAST_FRAME)])


def _light(scene: Scene) -> None:
    """Sun behind thin haze: soft shadows, much light from all over the sky."""
    scene.exposure = 1.0
    azimuth = SUN_AZIMUTH_DEG
    scene.sky(sun_elevation_deg=24.0, sun_azimuth_deg=azimuth, strength=0.24, haze=4.0)
    scene.sun(elevation_deg=33.0, azimuth_deg=azimuth, strength=2.6, angle_deg=9.0, colour=(1.0, 0.90, 0.76))
