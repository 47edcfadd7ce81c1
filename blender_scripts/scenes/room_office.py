"""Two men in an office with the sun between the slats of a blind: the seated one opens his laptop and types,
the other writes on a whiteboard, walks to a high table and types there later. A twin of the first laptop
stands open on the high table and is never used.

Story. The seated man opens the laptop on his desk, types, stops and drinks from his mug. Meanwhile the other
writes on the whiteboard, lays the marker on its tray, walks to the end of the high table, opens the laptop
there and types. The silver twin stands open on the high table all the time and is never touched. Who types,
and on what, depends on the time; silver alone, typed on alone and on the high table alone mean two each.

Axes: the floor is z = 0, the whiteboard's wall at +Y, the window at -X, cameras on the -Y side; metres.
"""

from __future__ import annotations

import random
from math import cos, degrees, pi, sin

from mathutils import Matrix, Vector

from l4d_blender.assets import desk, high_table, laptop, office_chair, whiteboard
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import deskwork, sitting
from l4d_blender.motion.deskwork import Computer
from l4d_blender.motion.people import Person
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "room"

HALF_WIDTH, BACK_Y, FRONT_Y = 3.3, 1.95, -3.4
WINDOW_Y = (-0.95, 1.05)

# Where things stand: x, y in metres, heading in degrees.
DESK = ((-1.12, -0.12), degrees(1.36))
HIGH_TABLE = ((0.92, 0.50), degrees(0.05))
WHITEBOARD = ((0.46, 1.62), degrees(0.06))
BOOKCASE = ((-1.12, 1.78), 0.0)
PLANT = ((2.02, 1.02), 0.0)

# On the furniture, in its own axes.
DESK_SEAT_X = 0.16
HIGH_TABLE_SPOTS = {"left": -0.36, "right": 0.35}
STANDING_GAP_M = 0.25
ORIGIN = (0.0, 0.0)


MODELS = {
    "silver": laptop.COMPACT_SILVER,
    "black": laptop.LARGE_BLACK,
    "copper": laptop.COMPACT_COPPER,
    "white": laptop.LARGE_WHITE,
}


TWINS = "silver"
OTHER = "black"
SHIRT = "light_blue"
TROUSERS = ("beige", "black")
HAIR = ("dark_brown", "grey")
SKIN = ("fair", "tan")
WRITE = 18
TYPING = (30, 56)
SUN_DEG = 203.0
ACCENT = (0.10, 0.24, 0.26)
WALL = (0.56, 0.58, 0.57)


class Stage:
    """The layout."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        poses = (pose(*spot) for spot in (DESK, HIGH_TABLE, WHITEBOARD, BOOKCASE, PLANT))
        self.desk, self.high_table, self.whiteboard, self.bookcase, self.plant = poses


def build(scene: Scene) -> None:
    """Furnishes the office, lets the men work, lights it and places the cameras."""
    stage = Stage(scene)
    furnish(stage)
    board = put_whiteboard(stage)
    computers = put_laptops(stage)
    sit_and_type(stage, computers["first"])
    write_and_type(stage, board, computers["later"])
    for computer in computers.values():
        computer.finish()
    light(stage)
    scene.cameras(
        (0.24, 0.36, 0.96),
        radius_m=3.2,
        heights_m=(1.60, 2.00),
        arc_deg=106.0,
        facing_deg=-90.0,
        fov_deg=53.0,
    )


# --- the office -------------------------------------------------------------------------------------------


def furnish(stage: Stage) -> None:
    """The room, its furniture as landmarks, and the clutter that nobody asks about."""
    scene, rng = stage.scene, stage.scene.rng("furniture")
    scene.make(
        "office_room",
        "office",
        rng,
        half_width_m=HALF_WIDTH,
        back_m=BACK_Y,
        front_m=FRONT_Y,
        window_y_m=WINDOW_Y,
        wall=WALL,
        accent=ACCENT,
    )
    scene.add(1001, "desk", "desk", ORIGIN, on=stage.desk, rng=rng, size_m=(1.30, 0.70))
    scene.add(1002, "high_table", "high_table", ORIGIN, on=stage.high_table, rng=rng)
    scene.add(1004, "bookcase", "bookcase", ORIGIN, on=stage.bookcase, rng=rng, height_m=1.85)
    scene.add(
        1005,
        "houseplant",
        "tall_plant",
        ORIGIN,
        on=stage.plant,
        rng=rng,
        height_m=1.25,
        stems=14,
        pot=(0.16, 0.17, 0.18),
    )

    pot = scene.make("houseplant", "small_plant", rng, height_m=0.42, stems=9, pot=(0.50, 0.20, 0.10))
    pot.data.transform(Matrix.Scale(0.72, 4))
    scene.place(pot, (-0.66, 0.10, high_table.HEIGHT_M), on=stage.high_table)
    scene.instance("small_plant", 1006, "plant", pot)

    clutter(stage, rng)


def clutter(stage: Stage, rng: random.Random) -> None:
    """Papers, pens, books, lamps and chairs: none annotated."""

    scene, low, high = stage.scene, desk.HEIGHT_M, high_table.HEIGHT_M
    for kind, name, on, at, turn, looks in (
        ("paper_sheets", "sheets", stage.desk, (-0.42, -0.14, low), 0.3, {}),
        ("paper_sheets", "more_sheets", stage.high_table, (0.05, -0.12, high), 2.9, {"count": 2}),
        ("paper_sheets.sticky_notes", "notes", stage.high_table, (0.10, 0.16, high), 0.4, {}),
        ("pen_pot", "pens", stage.desk, (-0.30, 0.22, low), 0.0, {}),
        ("desk_lamp", "lamp", stage.desk, (0.52, 0.10, low), -0.7, {"enamel": (0.08, 0.09, 0.10)}),
        ("coffee_table.book_stack", "manuals", stage.desk, (-0.48, 0.16, low), 0.2, {}),
        ("office_chair", "chair", stage.desk, (DESK_SEAT_X, -0.655), pi, {}),
        ("office_chair", "other_chair", stage.high_table, (1.50, -0.10), 1.9, {"cloth": (0.16, 0.05, 0.04)}),
        ("floor_lamp", "corner_lamp", 0.0, (-2.45, 1.40), 0.0, {}),
    ):
        scene.put(kind, name, at, degrees(turn), on=on, rng=rng, **looks)


def put_whiteboard(stage: Stage) -> Instance:
    """The board with the line that will be written, still hidden inside it."""
    scene = stage.scene
    body, stand = scene.make("whiteboard", "whiteboard")
    strokes = whiteboard.ink("written", handwriting(WRITE))
    whole = scene.place([body, stand, *strokes], ORIGIN, on=stage.whiteboard)
    return scene.instance("whiteboard", 1003, "whiteboard", whole, front="-y")


def handwriting(frames: int) -> list[Vector]:
    """A looping line in the board's axes, one point per frame: it leans and advances like script."""
    points = []
    for k in range(frames + 1):
        a = 2 * pi * 2.6 * k / 24.0
        x = 0.10 + 0.27 * k / frames + 0.016 * cos(a)
        points.append(Vector((x, whiteboard.SURFACE_Y_M, 1.46 + 0.030 * sin(a) - 0.01 * cos(0.3 * k))))
    return points


def put_laptops(stage: Stage) -> dict[str, Computer]:
    """Two twins, one on the desk and one on the high table, and a bigger one beside the latter."""
    scene = stage.scene
    desk_at = stage.desk @ pose((DESK_SEAT_X, -0.13, desk.HEIGHT_M))
    over = stage.high_table @ pose((0.0, 0.0, high_table.HEIGHT_M))
    spots = {side: over @ pose((x, 0.09), 180.0) for side, x in HIGH_TABLE_SPOTS.items()}
    plan = (
        ("first", "laptop_first", TWINS, desk_at, False, 0),
        ("idle", "laptop_idle", TWINS, spots["left"], True, 1),
        ("later", "laptop_later", OTHER, spots["right"], False, 2),
    )
    computers = {}
    for id, (role, name, look, at, is_open, page) in enumerate(plan, 1):
        made = scene.make("laptop", name, scene.rng(f"laptop/{role}"), model=MODELS[look], page=page)
        size = "large" if MODELS[look].size_m[0] > 0.35 else "compact"
        instance = scene.instance(
            name, id, "laptop", made, attributes={"colour": look, "size": size}, front="-y"
        )
        computers[role] = Computer(instance, made, at, is_open)
    return computers


# --- those who work ---------------------------------------------------------------------------------------


def clothes(role: str) -> tuple[Look, dict[str, str]]:
    """Shirts of one colour: one checked with long sleeves, one plain with short ones."""
    n = ("seated", "standing").index(role)
    checked = role == "seated"
    look = Look(
        build="man",
        height_m=(1.79, 1.76)[n],
        girth=(1.0, 1.07)[n],
        skin=SKIN[n],
        hair="short",
        hair_colour=HAIR[n],
        top=Cloth(SHIRT, "checks", "navy", 0.045) if checked else Cloth(SHIRT),
        sleeve="long" if checked else "short",
        lower=Cloth(TROUSERS[n]),
        shoe_colour=("brown", "black")[n],
        seed=11 + n,
    )
    seen = {
        "shirt": SHIRT,
        "pattern": "checked" if checked else "plain",
        "sleeves": look.sleeve,
        "trousers": TROUSERS[n],
        "hair": HAIR[n],
    }
    return look, seen


def sit_and_type(stage: Stage, computer: Computer) -> None:
    """The seated man: opens his laptop, types, stops, drinks."""
    scene, (first, last) = stage.scene, TYPING
    look, seen = clothes("seated")
    feet = stage.desk @ Vector((DESK_SEAT_X, -0.22, 0.0))
    seat = stage.desk @ Vector((DESK_SEAT_X, -0.66, office_chair.SEAT_M))
    heading_deg = degrees(stage.desk.to_euler().z + pi)
    mug = scene.add(
        1007,
        "coffee_table.mug",
        "mug",
        (DESK_SEAT_X + 0.27, -0.14, desk.HEIGHT_M),
        on=stage.desk,
        colour=(0.62, 0.20, 0.08),
    )
    man = Person(
        scene, "man_seated", 4, category="man", look=look, attributes=seen, at=feet, heading_deg=heading_deg
    )
    sitting.be_seated(man, seat)
    lap = {
        s: stage.desk @ Vector((DESK_SEAT_X - x, -0.30, desk.HEIGHT_M))
        for s, x in (("l", 0.20), ("r", -0.20))
    }
    sitting.rest_hands(man, lap, (-2, -1))
    deskwork.open_lid(man, computer, (7, 25))
    deskwork.type_on(man, computer, (first, last), arrive=6)
    sitting.rest_hands(man, {"l": lap["l"]}, (last + 1, last + 12))
    deskwork.drink_from(man, mug, (0.070, 0.0, 0.048), (0.040, 0.092), (last + 3, LAST_FRAME))
    man.finish()


def write_and_type(stage: Stage, board: Instance, computer: Computer) -> None:
    """The standing man: writes, lays the marker down, walks to the table's end, opens the laptop, types."""
    scene = stage.scene
    look, seen = clothes("standing")
    pen = scene.add(1008, "whiteboard.marker", "marker")
    start = stage.whiteboard @ Vector((0.10, -0.50, 0.0))
    man = Person(
        scene,
        "man_standing",
        5,
        category="man",
        look=look,
        attributes=seen,
        at=start,
        heading_deg=degrees(stage.whiteboard.to_euler().z + pi),
    )
    done = WRITE
    tray = Vector((0.20, whiteboard.TRAY_Y_M, whiteboard.TRAY_Z_M + 0.0095))
    strokes = [part for part in board.objects if part.name.startswith("written")]
    deskwork.write_on(man, board, pen, handwriting(done), strokes, (0, done), tray, (done, done + 13))
    x, depth = HIGH_TABLE_SPOTS["right"], 0.31
    goal = stage.high_table @ Vector((x, depth + STANDING_GAP_M, 0.0))
    halfway = 0.5 * (start + goal) + Vector((0.0, 0.07, 0.0))
    man.walk_along(
        [halfway[:2], goal[:2]], (done + 12, 59), facing_deg=degrees(stage.high_table.to_euler().z + 2 * pi)
    )
    deskwork.open_lid(man, computer, (59, 73))
    deskwork.type_on(man, computer, (78, LAST_FRAME), arrive=5)
    man.finish()


# --- light ------------------------------------------------------------------------------------------------


def light(stage: Stage) -> None:
    """Low sun through the blind, daylight from the window, cool panels overhead."""
    scene = stage.scene
    scene.exposure = 1.1
    scene.hdri("interior", strength=0.34, rotation_deg=degrees(2.0))
    scene.sun(
        elevation_deg=24.0, azimuth_deg=SUN_DEG - 25.0, strength=12.0, angle_deg=0.7, colour=(1.0, 0.80, 0.56)
    )
    middle = 0.5 * sum(WINDOW_Y)
    scene.area_light(
        "window_light",
        (-HALF_WIDTH + 0.25, middle, 1.6),
        (0.0, 0.2, 0.8),
        size_m=(1.9, 1.2),
        power_w=26,
        colour=(0.86, 0.93, 1.0),
    )
    scene.area_light(
        "ceiling_panel",
        (0.2, -0.3, 2.65),
        (0.2, 0.3, 0.0),
        size_m=(2.4, 0.6),
        power_w=30,
        colour=(1.0, 0.97, 0.92),
    )
