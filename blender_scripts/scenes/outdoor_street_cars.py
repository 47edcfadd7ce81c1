"""In a shopping street on a clear morning a red car drives up and brakes before a zebra crossing, where
a woman in a dotted dress walks past its bonnet while a man at the bus stop ends a phone call and waves.
A mint-green car with a roof box pulls out from behind the red car's twin, which stays parked by the far
kerb.

What tells look-alikes apart: the red twins by place and by which one drives, brakes and waits; the
pedestrians by what they do and where they end up.
"""

from __future__ import annotations

from math import degrees, pi

import bpy
from mathutils import Vector

from l4d_blender.assets import car, mesh, shopfront
from l4d_blender.assets.materials import street
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import travellers
from l4d_blender.motion.driving import Driver
from l4d_blender.motion.people import Person
from l4d_blender.scene.scattering import scatter
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

NEAR_KERB_Y, FAR_KERB_Y, FACADE_Y = -0.75, 5.05, 7.2
PAVEMENT_M = 0.10
CROSSING = (2.55, 4.65)  # from x to x
ALONG, BACK = 90.0, -90.0  # headings towards +X and -X
ARRIVING = Vector((-2.2, 0.38, 0.0))
LEAVING = Vector((0.40, 4.05, 0.0))
PARKED = Vector((-5.1, 4.05, 0.0))
BUS_STOP = Vector((-2.45, -1.30, PAVEMENT_M))


TWIN = car.CarLook("red", roof="white")
OTHER = car.CarLook("mint", roof="rack")
DRESS = Cloth("yellow", "dots", "white", 0.06)
HAIR = ("bun", "dark_brown")
SHIRT = Cloth("white", "stripes", "blue", 0.06)
CALL_LAST = 38
WAVE = (58, 92)
PULL_OUT = 40
SUN_AZIMUTH_DEG = -52.0
SUN_ELEVATION_DEG = 46.0


def build(scene: Scene) -> None:
    """Lays the street, puts cars and pedestrians on it, and lights it."""
    _ground(scene)
    _houses(scene)
    _street_clutter(scene)
    _landmarks(scene)
    arriving = _cars(scene)
    crossing = _crosser(scene, arriving.instance)
    arriving.wait_for(crossing.instance, (50, LAST_FRAME))
    _waiter(scene)
    scene.sky(sun_elevation_deg=38.0, sun_azimuth_deg=SUN_AZIMUTH_DEG, strength=0.20)
    scene.sun(
        elevation_deg=SUN_ELEVATION_DEG,
        azimuth_deg=SUN_AZIMUTH_DEG,
        strength=4.6,
        angle_deg=1.2,
        colour=(1.0, 0.94, 0.85),
    )
    scene.cameras(
        (-0.35, 1.5, 1.05), radius_m=9.5, heights_m=(2.5, 3.7), arc_deg=140.0, facing_deg=-90.0, fov_deg=54.0
    )


# --- the street -------------------------------------------------------------------------------------------


def _pavement_height(x: float, y: float) -> float:
    """Level, but for the dropped kerb at the crossing."""
    low, high = CROSSING
    outside = max(low - 0.2 - x, x - high - 0.2, 0.0)
    return PAVEMENT_M * min(outside / 0.7, 1.0)


def _ground(scene: Scene) -> None:
    road_deep = FAR_KERB_Y - NEAR_KERB_Y
    road = mesh.move(mesh.grid("road", 130.0, road_deep, 24, 4), 0.0, NEAR_KERB_Y + 0.5 * road_deep)
    mesh.set_material(road, street.asphalt("asphalt", wetness=0.25, tone=0.085))
    slabs = street.paving("slabs", ((0.36, 0.33, 0.29), (0.29, 0.265, 0.235)), slab_m=(0.75, 0.50))
    for name, low, high in (("near", -11.0, NEAR_KERB_Y), ("far", FAR_KERB_Y, FACADE_Y + 0.5)):
        sheet = mesh.grid(f"pavement_{name}", 129.6, high - low, 432, 2, _pavement_height)
        mesh.set_material(mesh.move(sheet, 0.0, 0.5 * (low + high)), slabs)
    rng = scene.rng("kerbs")
    low, high = CROSSING[0] - 0.55, CROSSING[1] + 0.55
    for k, y in enumerate((NEAR_KERB_Y, FAR_KERB_Y)):
        for part, first, last, z in (
            ("west", low - 36.0, low, PAVEMENT_M + 0.004),
            ("crossing", low, high, 0.012),
            ("east", high, high + 36.0, PAVEMENT_M + 0.004),
        ):
            scene.put(
                "street_furniture.kerb",
                f"kerb_{part}_{k}",
                (0.5 * (first + last), y, z),
                rng=rng,
                length_m=last - first,
            )
    paint = street.road_paint("road_paint")
    dashes = [
        mesh.move(mesh.grid("dash", 2.0, 0.12, 4, 1), x, 2.15, 0.003)
        for x in (-28, -22, -16, -10, -4, 10, 16, 22)
    ]
    stop = mesh.move(mesh.grid("stop_line", 0.22, 2.6, 1, 6), CROSSING[0] - 0.26, 0.70, 0.003)
    mesh.set_material(mesh.join("lane_marks", [*dashes, stop]), paint)


def _houses(scene: Scene) -> None:
    """A terrace of shops behind the far pavement, more of them opposite and across both ends."""
    looks = {
        "books": shopfront.ShopLook(
            "BOOKS",
            (0.58, 0.47, 0.30),
            (0.02, 0.05, 0.16),
            None,
            ((0.35, 0.05, 0.04), (0.05, 0.12, 0.30), (0.60, 0.52, 0.36), (0.06, 0.20, 0.10)),
        ),
        "flowers": shopfront.ShopLook(
            "FLOWERS",
            (0.62, 0.56, 0.50),
            (0.20, 0.03, 0.08),
            (0.05, 0.24, 0.10),
            ((0.60, 0.10, 0.16), (0.62, 0.42, 0.04), (0.07, 0.26, 0.05), (0.50, 0.20, 0.50)),
        ),
        "cafe": shopfront.ShopLook("CAFE", "brick", (0.06, 0.05, 0.045), (0.12, 0.09, 0.06), storeys=3),
    }
    models = {
        name: scene.make("shopfront", f"house_{name}", scene.rng(f"house/{name}"), look=look)
        for name, look in looks.items()
    }
    rows = [("books", 4.2, FACADE_Y, 0.0), ("flowers", -8.8, FACADE_Y, 0.0)]
    order = ["cafe", "flowers", "books"]
    for k in range(3):
        rows.append((order[k % 3], 9.8 + 5.6 * k, FACADE_Y, 0.0))
        rows.append((order[(k + 1) % 3], -14.4 - 5.6 * k, FACADE_Y, 0.0))
        for side in (-1.0, 1.0):
            rows.append((order[(k + 2) % 3], side * (11.0 + 5.6 * k), -10.5, 180.0))
    for side in (-1.0, 1.0):
        for k in range(3):
            rows.append((order[k], side * 31.0, -3.4 + 5.6 * k, -side * 90.0))
    for k, (name, x, y, turn_deg) in enumerate(rows):
        house = mesh.duplicate(models[name], f"terrace_{k}", linked=True)
        scene.place(house, (x, y), turn_deg)
    for model in models.values():
        bpy.data.objects.remove(model)


def _street_clutter(scene: Scene) -> None:
    """Trees, lamps, bins, planters and a bus further off: none annotated (and no car that is not)."""
    rng = scene.rng("clutter")
    model = scene.make("tree", "tree_model", scene.rng("tree"), height_m=5.6, sprays=2200)
    spots = ((-9.6, 5.75), (7.0, 5.75), (14.5, 5.75), (-17.0, 5.75), (13.0, -2.2), (-12.5, -2.4))
    any_way = (0.0, degrees(6.28))
    scatter(
        scene,
        "tree",
        [model],
        spots,
        rng,
        on=PAVEMENT_M,
        sunk_m=0.0,
        scale=(0.9, 1.15),
        turn_deg=any_way,
        turn_first=True,
    )
    for k, x in enumerate((-6.3, 1.55, 10.4, 20.0, -16.0)):
        scene.put("street_furniture.lamp_post", f"lamp_{k}", (x, FAR_KERB_Y + 0.38), on=PAVEMENT_M, glow=0.0)
    for k, (x, y) in enumerate(((2.0, 6.75), (-6.4, 6.8), (-4.55, -1.35))):
        scene.put("street_furniture.litter_bin", f"bin_{k}", (x, y), on=PAVEMENT_M)
    for k, x in enumerate((1.75, 5.45)):
        scene.put("street_furniture.bollard", f"bollard_{k}", (x, NEAR_KERB_Y - 0.30), on=PAVEMENT_M - 0.02)
    scene.put("bus", "bus", (25.0, 3.0), BACK, rng=rng, colour=(0.52, 0.50, 0.46), line="5 MARKET")
    for k, (x, y) in enumerate(((4.2, 6.7), (8.9, 6.7), (-10.9, 6.7), (6.4, -2.6), (-8.2, -2.6))):
        scene.put(
            "street_furniture.planter", f"planter_{k}", (x, y), on=PAVEMENT_M, rng=scene.rng(f"planter {k}")
        )


def _landmarks(scene: Scene) -> None:
    paint = street.road_paint("zebra_paint")
    low, high = CROSSING
    stripes = [
        mesh.move(
            mesh.grid("stripe", high - low, 0.5, 8, 2),
            0.5 * (low + high),
            NEAR_KERB_Y + 0.55 + 0.98 * k,
            0.004,
        )
        for k in range(6)
    ]
    zebra = mesh.set_material(mesh.join("crossing", stripes), paint)
    scene.instance("crossing", 1001, "crossing", zebra)
    scene.add(
        1002, "shopfront", "bakery", (-2.3, FACADE_Y), category="bakery", look=shopfront.ShopLook(width_m=7.4)
    )
    scene.add(
        1003,
        "street_furniture.sign_post",
        "bus_stop",
        BUS_STOP,
        90.0,
        category="bus_stop",
        text="BUS STOP",
        face=(0.46, 0.02, 0.02),
        timetable=True,
    )
    scene.add(1004, "street_bench", "bench", (-3.55, -2.05), 180.0, on=PAVEMENT_M)


# --- those who act ----------------------------------------------------------------------------------------


def _cars(scene: Scene) -> Driver:
    """The twin that drives up, the car that pulls out, the twin that stays; the first one's driver."""
    plan = {
        "arriving": (TWIN, ARRIVING, ALONG),
        "pulling_out": (OTHER, LEAVING, BACK),
        "parked": (TWIN, PARKED, BACK),
    }
    drivers = {}
    for id, (what, (look, spot, heading)) in enumerate(plan.items(), 1):
        made = scene.put("car", f"car_{what}", spot, heading, rng=scene.rng(f"car/{what}"), look=look)
        instance = scene.instance(
            f"car_{what}",
            id,
            "car",
            made,
            attributes={"colour": look.colour, "roof": "box" if look.roof == "rack" else f"{look.roof}_roof"},
            front="-y",
        )
        drivers[what] = Driver(instance, made, spot, heading)
    drivers["arriving"].drive([(0, 2.1), (10, 2.1), (48, 0.0)])
    start = PULL_OUT
    drivers["pulling_out"].drive(
        [(0, 0.0), (start, 0.0), (start + 30, 1.8), (LAST_FRAME, 1.8)],
        [(0, 0.0), (start - 8, 0.0), (start + 5, 0.62), (start + 31, 0.62), (start + 54, -0.25)],
        verb="pull_out",
    )
    return drivers["arriving"]


def _crosser(scene: Scene, stopped: Instance) -> Person:
    """Waits at the dropped kerb until the red car has stopped, then walks over."""
    style, colour = HAIR
    look = Look(
        build="woman",
        height_m=1.68,
        skin="brown",
        hair=style,
        hair_colour=colour,
        bottom="dress",
        sleeve="short",
        lower=DRESS,
        shoe_colour="black",
        seed=scene.rng("crosser").randrange(1000),
    )
    person = Person(
        scene,
        "pedestrian_crossing",
        4,
        category="pedestrian",
        look=look,
        attributes={"clothes": "dress", "pattern": "dotted", "hair": style},
        at=(3.20, -1.10),
        heading_deg=degrees(pi - 0.25),
    )
    travellers.cross(
        person, [(3.30, 0.5), (3.35, 2.15)], (38, LAST_FRAME - 1), before=stopped, passing=(50, 84)
    )
    person.finish()
    return person


def _waiter(scene: Scene) -> None:
    """Stands at the bus stop on the phone, puts it away and waves."""
    look = Look(
        build="man",
        height_m=1.80,
        skin="fair",
        hair="short",
        hair_colour="black",
        top=SHIRT,
        sleeve="short",
        bottom="shorts",
        lower=Cloth("navy"),
        shoe_colour="grey",
        seed=scene.rng("waiter").randrange(1000),
    )
    person = Person(
        scene,
        "pedestrian_waiting",
        5,
        category="pedestrian",
        look=look,
        attributes={"clothes": "shorts", "pattern": "striped", "hair": "short"},
        at=(-1.75, -1.55),
        heading_deg=degrees(2.0),
        ground_m=PAVEMENT_M,
    )
    travellers.phone(person, (0, CALL_LAST), side="r")
    person.wave(WAVE, side="l")
    person.finish()
