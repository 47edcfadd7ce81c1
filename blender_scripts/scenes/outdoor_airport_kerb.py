"""At dusk before an airport terminal one traveller pulls a ribbed suitcase out to the kerb, parks it and
waves for a taxi, while another waves, sits down on a bench beside a big soft suitcase and telephones.
The twin of the pulled suitcase stands at the other end of the bench, and nobody touches it.

What tells look-alikes apart: the twin suitcases by place and by who pulls one, the travellers by what they do
and who waves first.
"""

from __future__ import annotations

from math import degrees

from mathutils import Vector

from l4d_blender.assets import mesh, street_bench, suitcase
from l4d_blender.assets.materials import street
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import travellers
from l4d_blender.motion.people import Person
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

KERB_Y = -1.75
ROAD_Z = -0.13
FACADE_Y = 4.3
BENCH = Vector((-0.95, 0.95, 0.0))
TROLLEY = Vector((2.44, 0.52, 0.0))
SITTER_AT = (-0.95, 0.38)
#: Upright suitcases: beside the sitter's left hand, and at the far end of the bench.
BY_HAND = Vector((-0.44, 0.13, 0.0))
BY_BENCH = Vector((-2.12, 0.72, 0.0))


TWIN = suitcase.CaseLook("medium", "ribbed", "teal")
OTHER = suitcase.CaseLook("large", "soft", "red", strap="cream")
WALKER_JACKET = "yellow"
WALKER_TOP = Cloth("white", "stripes", "navy", 0.045)
WALKER_HAIR = ("ponytail", "dark_brown")
SITTER_TOP = Cloth("light_blue", "checks")
SITTER_HAIR = "grey"
GREET_LAST = 28
WALK_LAST = 50
SUN_AZIMUTH_DEG = 70.0


def build(scene: Scene) -> None:
    """Sets the kerb, puts luggage and travellers on it, and lights it."""
    _ground(scene)
    _surroundings(scene)
    _landmarks(scene)
    cases = _suitcases(scene)
    _walker(scene, *cases["pulled"])
    _sitter(scene, *cases["by_hand"])
    _light(scene)
    scene.cameras(
        (0.1, 0.25, 0.82), radius_m=5.3, heights_m=(1.55, 2.35), arc_deg=150.0, facing_deg=-90.0, fov_deg=50.0
    )


# --- the place --------------------------------------------------------------------------------------------


def _ground(scene: Scene) -> None:
    slabs = street.paving(
        "slabs", ((0.20, 0.195, 0.185), (0.155, 0.15, 0.145)), slab_m=(0.60, 0.60), stain=0.4
    )
    depth = FACADE_Y - KERB_Y
    pavement = mesh.move(mesh.grid("pavement", 90.0, depth, 30, 4), 0.0, KERB_Y + 0.5 * depth)
    road = mesh.move(mesh.grid("road", 120.0, 40.0, 24, 8), 0.0, KERB_Y - 20.0, ROAD_Z)
    scene.put("street_furniture.kerb", "kerb", (0.0, KERB_Y), length_m=72.0)
    yellow = street.road_paint("yellow_line", (0.62, 0.40, 0.04))
    white = street.road_paint("white_line")
    mesh.set_material(pavement, slabs)
    mesh.set_material(road, street.asphalt("asphalt", wetness=0.6))
    for y in (KERB_Y - 0.32, KERB_Y - 0.50):
        line = mesh.move(mesh.grid("no_waiting", 72.0, 0.09, 40, 1), 0.0, y, ROAD_Z + 0.004)
        mesh.set_material(line, yellow)
    for k in range(12):
        dash = mesh.move(
            mesh.grid("lane_dash", 2.0, 0.12, 4, 1), -33.0 + 6.0 * k, KERB_Y - 6.4, ROAD_Z + 0.004
        )
        mesh.set_material(dash, white)


def _surroundings(scene: Scene) -> None:
    """Terminal, street furniture, a bus at its stop and woods behind the car parks: none annotated."""
    rng = scene.rng("surroundings")
    for part in scene.make("terminal", "terminal"):
        part.location.y = FACADE_Y
    for k, x in enumerate((-8.9, -7.0, -5.1, -3.2, 2.9, 4.8, 6.7, 8.6)):
        scene.put("street_furniture.bollard", f"bollard_{k}", (x, KERB_Y + 0.33))
    for k, x in enumerate((-9.5, 6.2, 17.0, -22.0)):
        scene.put("street_furniture.lamp_post", f"lamp_{k}", (x, KERB_Y + 0.7))
    for k, (x, y) in enumerate(((3.6, 3.2), (-5.3, 3.3))):
        scene.put("street_furniture.litter_bin", f"bin_{k}", (x, y), colour=(0.09, 0.095, 0.10))
    for k, x in enumerate((-7.4, -5.9, 5.3, 6.8)):
        scene.put("street_furniture.planter", f"planter_{k}", (x, 3.3), rng=scene.rng(f"planter {k}"))
    scene.put(
        "street_furniture.sign_post",
        "stop_sign",
        (-4.4, 0.2),
        text="BUS",
        face=(0.02, 0.16, 0.10),
        timetable=True,
    )
    scene.put("bus", "bus", (-22.5, 1.5), degrees(-0.35), on=ROAD_Z, rng=rng, colour=(0.52, 0.50, 0.46))
    scene.put(
        "bus",
        "bus_behind",
        (22.5, 1.0),
        degrees(0.30),
        on=ROAD_Z,
        rng=rng,
        colour=(0.46, 0.16, 0.03),
        line="X4 HARBOUR",
    )
    model = scene.make("tree.far_wood", "wood_model", scene.rng("wood"))
    for k in range(10):
        wood = mesh.duplicate(model, f"wood_{k}", linked=True)
        side = -1.0 if k % 2 else 1.0
        at = (side * rng.uniform(38.0, 48.0), -16.0 + 4.2 * (k // 2), -0.4)
        turn, size = 1.5708 + rng.uniform(-0.3, 0.3), rng.uniform(0.8, 1.2)
        scene.place(wood, at, degrees(turn), scale=size)
    scene.place(model, (0.0, -60.0, -0.4))


def _landmarks(scene: Scene) -> None:
    scene.add(1001, "street_bench", "bench", BENCH)
    scene.add(1002, "luggage_trolley", "trolley", TROLLEY, degrees(0.55))
    scene.add(
        1003,
        "street_furniture.sign_post",
        "sign",
        (0.72, 1.75),
        text="TAXI",
        face=(0.55, 0.36, 0.02),
        height_m=2.55,
    )


# --- luggage and travellers -------------------------------------------------------------------------------


def _suitcases(scene: Scene) -> dict[str, tuple[suitcase.Suitcase, Instance]]:
    rng = scene.rng("suitcases")
    plan = {
        "pulled": (TWIN, Vector((2.6, 2.6, 0.0)), 0.0),
        "by_bench": (TWIN, BY_BENCH, 0.45),
        "by_hand": (OTHER, BY_HAND, 0.22),
    }
    made = {}
    for id, (place, (look, spot, turn)) in enumerate(plan.items(), 1):
        case = scene.put(
            "suitcase",
            f"suitcase_{place}",
            spot,
            degrees(turn + rng.uniform(-0.08, 0.08)),
            rng=scene.rng(f"suitcase/{place}"),
            look=look,
        )
        instance = scene.instance(
            f"suitcase_{place}",
            id,
            "suitcase",
            case,
            attributes={
                "colour": look.colour,
                "shell": look.shell,
                "material": "cloth" if look.shell == "soft" else "plastic",
                "size": look.size,
                "strap": look.strap or "none",
            },
            front="-y",
        )
        made[place] = case, instance
    return made


def _walker(scene: Scene, case: suitcase.Suitcase, instance: Instance) -> None:
    """Comes from the doors, stops near the kerb, parks the suitcase and hails a taxi."""
    hair, hair_colour = WALKER_HAIR
    look = Look(
        build="woman",
        height_m=1.69,
        skin="tan",
        hair=hair,
        hair_colour=hair_colour,
        top=WALKER_TOP,
        sleeve="long",
        jacket=Cloth(WALKER_JACKET),
        shoes="boots",
        shoe_colour="brown",
        seed=scene.rng("walker").randrange(1000),
    )
    walker = Person(
        scene,
        "person_pulling",
        4,
        category="person",
        look=look,
        attributes={"hair": hair, "jacket": WALKER_JACKET, "top": "striped", "trousers": "jeans"},
        at=(1.72, 1.74),
        heading_deg=degrees(-0.36),
    )
    parked = travellers.pull(walker, case, instance, WALK_LAST, side="r")
    walker.walk_along([(1.32, 0.40), (1.24, -0.66)], (0, WALK_LAST))
    walker.wave((parked + 2, LAST_FRAME - 2), side="l")
    walker.finish()


def _sitter(scene: Scene, case: suitcase.Suitcase, instance: Instance) -> None:
    """Waves with one hand, the other on the suitcase; then sits down and telephones."""
    look = Look(
        build="man",
        height_m=1.79,
        girth=1.03,
        skin="fair",
        hair="short",
        hair_colour=SITTER_HAIR,
        top=SITTER_TOP,
        sleeve="elbow",
        lower=Cloth("beige"),
        shoe_colour="brown",
        seed=scene.rng("sitter").randrange(1000),
    )
    sitter = Person(
        scene,
        "person_by_bench",
        5,
        category="person",
        look=look,
        attributes={"hair": "short", "jacket": "none", "top": "checked", "trousers": "plain"},
        at=SITTER_AT,
    )
    frame = case.body.matrix_basis
    hold_last = GREET_LAST + 3
    travellers.hand_on(
        sitter, instance, frame @ case.grip, hold_last, side="l", bar=frame.to_3x3() @ Vector((1.0, 0.0, 0.0))
    )
    sitter.wave((1, GREET_LAST), side="r")
    seat = (SITTER_AT[0], BENCH.y - 0.06, street_bench.SEAT_M)
    sitter.sit(seat, (hold_last + 2, LAST_FRAME), down=20)
    travellers.phone(sitter, (hold_last + 40, LAST_FRAME), side="r", draw=12)
    sitter.finish()


# --- light ------------------------------------------------------------------------------------------------


def _light(scene: Scene) -> None:
    """Blue hour: what is left of the sky, the glow of the hall, and the lamps over the kerb."""
    scene.sky(sun_elevation_deg=1.0, sun_azimuth_deg=SUN_AZIMUTH_DEG, strength=0.6)
    warm, neutral = (1.0, 0.78, 0.52), (1.0, 0.90, 0.76)
    for k, x in enumerate((-9.0, 0.0, 9.0)):
        scene.area_light(
            f"hall_{k}",
            (x, FACADE_Y + 4.0, 3.75),
            (x, FACADE_Y + 4.0, 0.0),
            size_m=(8.5, 7.0),
            power_w=520.0,
            colour=neutral,
        )
    for k, x in enumerate((-3.4, 3.6)):
        scene.area_light(
            f"lamp_{k}", (x, -2.6, 5.4), (0.6 * x, 0.6, 0.3), size_m=(1.6, 1.0), power_w=280.0, colour=warm
        )
