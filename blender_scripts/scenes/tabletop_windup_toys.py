"""Wind-up robots and spinning tops on a work table in an attic: one robot walks and stops, then another is
let go and walks off, a third turns on a box; one top runs down and topples, later a hand spins the other.

Story. Two red robots are twins. One walks over the cutting mat, stops, and then turns round on the spot. The
other is held by the right hand until it is let go and walks to the biscuit tin. The large robot stands on a
wooden box, is held by the left hand at first, and then turns on the spot. The tin top spins from the start,
wobbles and topples; the wooden one lies there until the left hand stands it up and twirls it.

Axes: the table top is z = 0; the tinkerer sits at -X and faces +X, so the right hand is at -Y.
"""

from __future__ import annotations

from math import degrees

from mathutils import Vector

from l4d_blender.assets import cutting_mat, desk, desk_lamp, spinning_top, toy_robot
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products
from l4d_blender.assets.person import Cloth
from l4d_blender.motion import spinning_tops
from l4d_blender.motion.spinning_tops import TopHand
from l4d_blender.motion.windup_robots import WindUpRobot
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scene import Instance, Scene

SCALE = "tabletop"

FLOOR_M = -desk.HEIGHT_M
SEAT_M = 0.47
MAT_M = cutting_mat.THICKNESS_M
BOX_SIZE_M = (0.21, 0.15, 0.060)
WOOL = (0.17, 0.060, 0.035)

# Where things are: x, y in metres, heading in degrees.
MAT = ((0.060, -0.020), 0.0)
BOX = ((-0.050, 0.258), 78.0)
TIN = ((0.150, 0.262), 0.0)
LAMP = ((-0.165, 0.465), 40.0)
WALKER = ((0.112, -0.035), 27.0)
RELEASED = ((-0.080, -0.105), 92.0)
TURNER = ((-0.036, 0.245), 40.0)
WOODEN_TOP = (0.125, 0.075)
TIN_TOP = (0.010, -0.215)

SHOULDERS = {"r": (-0.44, -0.17, 0.26), "l": (-0.44, 0.15, 0.26)}
RESTS = {"r": (-0.190, -0.215, MAT_M), "l": (-0.225, 0.060, MAT_M)}

PAINTS = {
    "red": (0.48, 0.045, 0.03),
    "teal": (0.045, 0.20, 0.23),
    "yellow": (0.66, 0.40, 0.03),
    "green": (0.10, 0.26, 0.08),
}


TWINS = "red"
LARGE = "teal"
CHESTS = ("dial", "gears")
WALK = (4, 44)
TURN_DEG = 150.0
LAMP_W = 6.0


def build(scene: Scene) -> None:
    """The whole scene; who does what is in `_robots`, `_right_hand` and `_left_hand`."""
    _attic(scene)
    _clutter(scene)
    _light(scene)
    _landmarks(scene)
    robots = _robots(scene)
    tops = _tops(scene)
    _right_hand(scene, robots["robot_released"])
    _left_hand(scene, robots["robot_on_box"], tops["top_wooden"])
    scene.cameras(
        (0.050, -0.005, 0.065), radius_m=0.66, heights_m=(0.34, 0.50), arc_deg=140, facing_deg=-22, fov_deg=48
    )


def _attic(scene: Scene) -> None:
    """The room under the roof, the table, the stool and whoever sits there."""
    rng = scene.rng("room")
    scene.put("attic_room", "attic", (-0.25, 0.0), on=FLOOR_M, rng=rng)
    scene.put(
        "desk",
        "table",
        (0.06, 0.0),
        -90,
        on=FLOOR_M,
        rng=rng,
        size_m=(1.30, 0.72),
        light=(0.25, 0.135, 0.060),
        dark=(0.12, 0.06, 0.026),
        steel=(0.16, 0.085, 0.04),
    )
    scene.put(
        "sitter",
        "tinkerer",
        (-0.45, 0.0),
        90,
        on=FLOOR_M + SEAT_M,
        rng=rng,
        pullover=products.knit("pullover", WOOL, rng),
        jeans=(0.09, 0.075, 0.05),
    )


def _clutter(scene: Scene) -> None:
    """What lies about and is never asked for."""
    rng = scene.rng("clutter")
    scene.put("workshop_clutter.screwdriver", "screwdriver", (0.245, -0.10), 80, on=MAT_M, rng=rng)
    scene.put("workshop_clutter.loose_parts", "parts", (0.225, 0.065), 20, on=MAT_M, rng=rng)
    scene.put("workshop_clutter.oil_can", "oil_can", (0.235, 0.345), -30, rng=rng)
    scene.put("workshop_clutter.spool", "spool", (-0.11, -0.375), rng=rng)
    scene.put("workshop_clutter.spool", "spool_red", (-0.06, -0.405), rng=rng, thread=(0.34, 0.05, 0.03))


def _light(scene: Scene) -> None:
    """A warm desk lamp against the last blue light of the window."""
    scene.hdri("interior", 0.16, rotation_deg=degrees(2.4))
    scene.area_light(
        "dusk", (0.1, 1.15, 0.75), (0.0, 0.0, 0.0), size_m=(0.8, 0.8), power_w=9, colour=(0.62, 0.74, 1.0)
    )
    scene.area_light(
        "ceiling",
        (0.75, -0.55, 1.25),
        (0.0, 0.0, 0.0),
        size_m=(0.5, 0.5),
        power_w=17,
        colour=(1.0, 0.80, 0.56),
    )
    scene.point_light(
        "lamp_light", pose(*LAMP) @ desk_lamp.LIGHT, power_w=LAMP_W, radius_m=0.03, colour=(1.0, 0.68, 0.36)
    )


def _landmarks(scene: Scene) -> None:
    """Things that sentences mention to say where something is."""
    rng = scene.rng("landmarks")
    scene.add(1001, "wooden_box", "wooden_box", *BOX, on=MAT_M, rng=rng, size_m=BOX_SIZE_M)
    scene.add(1002, "biscuit_tin", "biscuit_tin", *TIN, on=MAT_M, rng=rng)
    scene.add(1003, "desk_lamp", "lamp", *LAMP, rng=rng, enamel=(0.09, 0.10, 0.085))
    scene.add(1007, "cutting_mat", "cutting_mat", *MAT, rng=rng)
    notes = scene.make(
        "book",
        "notebook",
        rng,
        size_m=(0.135, 0.190, 0.022),
        cover=(0.10, 0.055, 0.03),
        title=("NOTES", "II"),
    )
    atlas = scene.make(
        "book",
        "atlas",
        rng,
        size_m=(0.19, 0.245, 0.028),
        cover=(0.06, 0.09, 0.16),
        title=("CLOCKS", "& TOYS"),
    )
    scene.instance(
        "books",
        1006,
        "book",
        [scene.place(atlas, (0.135, -0.405), -70), scene.place(notes, (0.14, -0.405), -94, on=0.0285)],
    )


def _robots(scene: Scene) -> dict[str, Instance]:
    """Two twins on the mat and a larger one on the box; they walk and turn by themselves."""
    spots = {
        "robot_walker": (WALKER, MAT_M, TWINS, CHESTS[0], "small"),
        "robot_released": (RELEASED, MAT_M, TWINS, CHESTS[0], "small"),
        "robot_on_box": (TURNER, MAT_M + BOX_SIZE_M[2], LARGE, CHESTS[1], "large"),
    }
    robots, movers = {}, {}
    for id_, (name, ((at, heading_deg), z, paint, chest, size)) in enumerate(spots.items(), 1):
        look = toy_robot.Look(paint=PAINTS[paint], chest=chest, scale=1.20 if size == "large" else 1.0)
        robot = scene.make("toy_robot", name, look=look)
        attributes = {"colour": paint, "chest": chest, "size": size}
        robots[name] = scene.instance(name, id_, "robot", robot, attributes=attributes, front="-y")
        movers[name] = WindUpRobot(robots[name], robot, pose((*at, z), heading_deg))
    walk = WALK
    movers["robot_walker"].walk(walk)
    movers["robot_walker"].turn((walk[1] + 8, walk[1] + 48), -130.0)
    movers["robot_released"].walk((54, 94), step_m=0.026, turn_deg=36.0)
    movers["robot_on_box"].turn((43, 91), TURN_DEG)
    for mover in movers.values():
        mover.finish()
    return robots


def _tops(scene: Scene) -> dict[str, Instance]:
    """A tin top that spins from the start and a wooden one that lies there."""
    tin = spinning_top.Look()
    wooden = spinning_top.Look(
        profile=spinning_top.PEAR,
        material="wood",
        segments=(spinning_top.GREEN, spinning_top.CREAM, spinning_top.YELLOW, spinning_top.CREAM),
    )
    looks = {"top_tin": (tin, "tin", "broad"), "top_wooden": (wooden, "wood", "pear")}
    tops = {}
    for id_, (name, (look, material, shape)) in enumerate(looks.items(), 4):
        tops[name] = scene.add(
            id_,
            "spinning_top",
            name,
            (0.0, 0.0),
            attributes={"material": material, "shape": shape},
            look=look,
        )
    spinning_tops.run_down(
        tops["top_tin"],
        spinning_top.BROAD,
        Vector((*TIN_TOP, MAT_M)),
        falls=(36, 62),
        towards_deg=degrees(1.0),
    )
    spinning_tops.lie(tops["top_wooden"], spinning_top.PEAR, Vector((*WOODEN_TOP, MAT_M)), towards_deg=180)
    return tops


def _right_hand(scene: Scene, robot: Instance) -> None:
    """Takes a robot by its head, holds it for a while and lets it go."""
    hand = _hand(scene, "hand_right", 1004, "r")
    hand.approach(robot, (12, 28), grip="top")
    hand.release((46, 54))
    hand.withdraw((56, 76))
    hand.finish()


def _left_hand(scene: Scene, robot: Instance, top: Instance) -> None:
    """Holds the large robot and lets it go, then stands a top up and twirls it."""
    hand = _hand(scene, "hand_left", 1005, "l")
    hand.approach(robot, (0, 13), grip="top")
    hand.release((33, 41))
    hand.twirl(
        top,
        spinning_top.PEAR,
        at=Vector((*WOODEN_TOP, MAT_M)),
        towards_deg=180,
        approach=(41, 57),
        upright=66,
        let_go=80,
        heading_deg=90,
    )
    hand.move_to((-0.14, 0.05, 0.10), (87, 96))
    hand.finish()


def _hand(scene: Scene, name: str, id_: int, side: str) -> TopHand:
    """A hand in the sleeve of the tinkerer's pullover."""
    look = HandLook(skin="fair", sleeve=Cloth("brown"), cuff="brown", scale=0.94)
    hand = TopHand(
        scene,
        name,
        id_,
        side=side,
        look=look,
        shoulder=SHOULDERS[side],
        rest_at=RESTS[side],
        table_m=MAT_M,
        attributes={"side": {"r": "right", "l": "left"}[side]},
    )
    _, sleeve = hand.body.meshes
    sleeve.data.materials[0] = products.knit(f"{name}.knit", WOOL, scene.rng(name), along="Y", bends=True)
    return hand
