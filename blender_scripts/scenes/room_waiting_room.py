"""A waiting room in the evening: one woman sits in the chair row and leafs through a magazine, another walks
in with a duffel bag, sets it down and takes a backpack from the seat beside its twin.

Story. A brown duffel and a backpack stand on two of the seats. The standing woman comes in with the twin of
that duffel, puts it on the floor before the row, steps to the seats and lifts the backpack. The seated woman
turns two pages, one before the other arrives and one after, then looks up. By its look alone neither
duffel can be told from the other; what is carried, what stands on the seats and what is brown are two each.

Axes: the floor is z = 0, the door's wall at +Y, cameras on the -Y side; metres; a heading of 0 faces -Y.
"""

from __future__ import annotations

from math import degrees, pi

from mathutils import Euler, Matrix, Vector

from l4d_blender.assets import bags, chair_row, coffee_table, floor_lamp
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import reading, sitting, visitors
from l4d_blender.motion.people import Person
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "room"

HALF_WIDTH, BACK_Y, FRONT_Y = 3.1, 2.05, -3.4

# Where things stand: x, y in metres, heading in degrees.
CHAIRS = ((-0.18, 0.86), degrees(0.26))
LOW_TABLE = ((-1.30, -0.62), degrees(0.30))
MACHINE = ((0.42, 1.78), 0.0)
PLANT = ((1.50, 1.55), 0.0)
DOOR_X = 2.25
LAMP = ((-2.35, 1.55), 0.0)

# In the axes of the chair row.
READER_SEAT, DUFFEL_SEAT, BACKPACK_SEAT, SEATS = 0, 1, 2, 4
PUT_DOWN = Vector((-0.42, -0.56, 0.0))
ENTER = Vector((1.02, -0.93, 0.0))
ORIGIN = (0.0, 0.0)


TWINS = "brown"
OTHER = "green"
PATTERN = "stripes"
CLOTH = ("navy", "navy")
HAIR = ("bun", "ponytail")
HAIR_COLOUR = ("dark_brown", "dark_brown")
SKIN = ("brown", "fair")
PAGES = ((10, 28), (40, 58))
SHELL = (0.05, 0.16, 0.28)
LOWER = (0.17, 0.27, 0.24)


class Stage:
    """The layout."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        poses = (pose(*spot) for spot in (CHAIRS, LOW_TABLE, MACHINE, PLANT, LAMP))
        self.chairs, self.low_table, self.machine, self.plant, self.lamp = poses

    def seat(self, number: int) -> Matrix:
        """The middle of a seat's surface."""
        at = (chair_row.seat_x(number, SEATS), -0.02, chair_row.SEAT_M - 0.008)
        return self.chairs @ pose(at)


def build(scene: Scene) -> None:
    """Furnishes the room, lets the women act, lights it and places the cameras."""
    stage = Stage(scene)
    furnish(stage)
    carried, _, backpack = put_bags(stage)
    read(stage)
    walk_in(stage, carried, backpack)
    light(stage)
    scene.cameras(
        (-0.06, 0.40, 0.72),
        radius_m=3.05,
        heights_m=(1.30, 1.65),
        arc_deg=104.0,
        facing_deg=-90.0,
        fov_deg=52.0,
    )


# --- the room ---------------------------------------------------------------------------------------------


def furnish(stage: Stage) -> None:
    """The room, its furniture as landmarks, and the clutter that nobody asks about."""
    scene, rng = stage.scene, stage.scene.rng("furniture")
    scene.make(
        "waiting_room", "room", rng, half_width_m=HALF_WIDTH, back_m=BACK_Y, front_m=FRONT_Y, lower=LOWER
    )
    scene.add(1001, "chair_row", "chair_row", ORIGIN, on=stage.chairs, rng=rng, count=SEATS, shell=SHELL)

    scene.add(
        1002,
        "coffee_table",
        "low_table",
        ORIGIN,
        on=stage.low_table,
        rng=rng,
        size_m=(0.68, 0.44),
        colour=(0.42, 0.27, 0.14),
    )
    for n, (dx, turn) in enumerate(((-0.17, 0.3), (0.16, -0.5))):
        scene.put(
            "magazine.pile",
            f"pile_{n}",
            (dx, 0.0, coffee_table.HEIGHT_M),
            degrees(turn),
            on=stage.low_table,
            rng=rng,
            count=5 - 2 * n,
        )

    scene.add(1003, "coffee_machine", "coffee_machine", ORIGIN, on=stage.machine, rng=rng)
    scene.add(
        1004,
        "houseplant",
        "plant",
        ORIGIN,
        on=stage.plant,
        rng=rng,
        height_m=1.35,
        stems=15,
        pot=(0.52, 0.46, 0.36),
    )
    scene.add(1005, "waiting_room.door", "door", (DOOR_X, BACK_Y), rng=rng)

    scene.put("floor_lamp", "lamp", ORIGIN, on=stage.lamp, rng=rng)
    scene.put(
        "houseplant", "small_plant", (-2.62, 0.55), rng=rng, height_m=0.6, stems=9, pot=(0.40, 0.14, 0.07)
    )
    for n, (title, paper, figure, x) in enumerate(
        (
            ("FEEL WELL", (0.52, 0.56, 0.50), (0.10, 0.34, 0.26), -1.72),
            ("TAKE CARE", (0.60, 0.50, 0.36), (0.52, 0.12, 0.06), -1.06),
            ("BE KIND", (0.42, 0.50, 0.58), (0.08, 0.20, 0.42), -0.40),
        )
    ):
        scene.put(
            "waiting_room.poster",
            f"poster_{n}",
            (x, BACK_Y, 1.28),
            rng=rng,
            title=title,
            paper=paper,
            figure=figure,
        )
    scene.put("waiting_room.clock", "clock", (1.30, BACK_Y, 2.05), rng=rng)


def put_bags(stage: Stage) -> tuple[Instance, ...]:
    """The duffel that is carried in, its twin on a seat, and the backpack on the next one."""
    scene = stage.scene
    bodies = []
    for name in ("bag_brought", "bag_waiting"):
        bodies.append(scene.make("bags.duffel", name, scene.rng(f"bags/{name}"), colour=TWINS))
    bodies.append(scene.make("bags.backpack", "bag_fetched", scene.rng("bags/backpack"), colour=OTHER))
    scene.place(bodies[0], ENTER, on=stage.chairs)
    scene.place(bodies[1], ORIGIN, degrees(0.10), on=stage.seat(DUFFEL_SEAT))
    scene.place(bodies[2], (0.0, -0.03), on=stage.seat(BACKPACK_SEAT))
    looks = (
        {"kind": "duffel", "colour": TWINS},
        {"kind": "duffel", "colour": TWINS},
        {"kind": "backpack", "colour": OTHER},
    )
    return tuple(
        scene.instance(body.name, id, "bag", body, attributes=seen)
        for id, (body, seen) in enumerate(zip(bodies, looks), 1)
    )


# --- those who wait ---------------------------------------------------------------------------------------


def clothes(n: int) -> tuple[Look, dict[str, str]]:
    """Two women in tops of one colour: one patterned with half sleeves, one plain with long ones."""
    top = Cloth(CLOTH[n], PATTERN, "white", 0.045) if n == 0 else Cloth(CLOTH[n])
    look = Look(
        build="woman",
        height_m=(1.66, 1.72)[n],
        skin=SKIN[n],
        hair=HAIR[n],
        hair_colour=HAIR_COLOUR[n],
        top=top,
        sleeve=("elbow", "long")[n],
        bottom="trousers",
        lower=(Cloth("beige"), Cloth("denim", "denim"))[n],
        shoes="shoes",
        shoe_colour=("black", "brown")[n],
        seed=21 + n,
    )
    seen = {
        "top": CLOTH[n],
        "pattern": PATTERN if n == 0 else "plain",
        "sleeves": look.sleeve,
        "trousers": ("beige", "blue")[n],
        "hair": HAIR[n],
    }
    return look, seen


def read(stage: Stage) -> None:
    """The seated woman: turns two pages and then looks up."""
    scene = stage.scene
    seat, turn = stage.seat(READER_SEAT), stage.chairs.to_euler().z
    look, seen = clothes(0)
    feet = seat @ Vector((0.0, -0.40, 0.0))
    woman = Person(
        scene,
        "woman_reading",
        4,
        category="woman",
        look=look,
        attributes=seen,
        at=feet,
        heading_deg=degrees(turn),
    )
    made = scene.make("magazine", "magazine", leaves=len(PAGES))
    held = scene.instance("magazine", 1006, "magazine", made, front="-y")
    # Held over the lap, its top away from her and raised towards her eyes: her left is the page at -X.
    tilt = Euler((0.75, 0.0, pi)).to_matrix().to_4x4()
    spread = reading.Spread(held, made, seat @ Matrix.Translation((0.0, -0.39, 0.30)) @ tilt)
    sitting.be_seated(woman, seat @ Vector((0.0, 0.0, 0.0)), lean_deg=degrees(0.06))
    reading.hold_open(woman, spread)
    for leaf, frames in enumerate(PAGES):
        reading.turn_page(woman, spread, leaf, frames)
    spread.finish()
    woman.look_at(tuple(stage.seat(BACKPACK_SEAT) @ Vector((0.05, -0.3, 0.9))), (70, LAST_FRAME))
    woman.finish()


def walk_in(stage: Stage, carried: Instance, backpack: Instance) -> None:
    """The standing woman: walks in with the duffel, sets it down, steps to the seats, lifts the backpack."""
    scene, turn = stage.scene, stage.chairs.to_euler().z
    look, seen = clothes(1)
    along_deg = degrees(turn - 0.5 * pi)
    start = stage.chairs @ ENTER
    woman = Person(
        scene,
        "woman_arriving",
        5,
        category="woman",
        look=look,
        attributes=seen,
        at=start,
        heading_deg=along_deg,
    )
    woman.hold(carried, tuple(bags.DUFFEL_GRIP), bar=(-1.0, 0.0, 0.0), clear_m=0.13)
    target = stage.chairs @ PUT_DOWN
    woman.walk_to(
        woman.reach_spot(target, along_deg, ahead_m=0.22, aside_m=0.37), (0, 30), facing_deg=along_deg
    )
    visitors.put_down(woman, carried, target, (30, 47))
    facing_deg = degrees(turn + pi)
    grip = stage.seat(BACKPACK_SEAT) @ Vector((0.0, -0.03, 0.0)) + bags.BACKPACK_GRIP
    woman.walk_to(
        woman.reach_spot(grip, facing_deg, ahead_m=0.53, aside_m=0.25), (46, 67), facing_deg=facing_deg
    )
    visitors.fetch(woman, backpack, tuple(bags.BACKPACK_GRIP), (63, 90), bar=(1.0, 0.0, 0.0), clear_m=0.12)
    woman.finish()


# --- light ------------------------------------------------------------------------------------------------


def light(stage: Stage) -> None:
    """Evening: two ceiling panels, a floor lamp, a little blue from outside."""
    scene = stage.scene
    scene.exposure = 1.1
    scene.hdri("night", strength=0.5, rotation_deg=degrees(0.6))
    for n, x in enumerate((-1.1, 1.1)):
        scene.area_light(
            f"ceiling_{n}",
            (x, 0.1, 2.75),
            (x * 0.9, 0.35, 0.0),
            size_m=(1.2, 0.35),
            power_w=46,
            colour=(1.0, 0.90, 0.74),
        )
    scene.area_light(
        "from_hall",
        (0.4, -3.2, 2.0),
        (0.0, 0.6, 0.7),
        size_m=(2.2, 1.2),
        power_w=22,
        colour=(0.86, 0.93, 1.0),
    )
    lamp = stage.lamp.translation
    scene.point_light(
        "lamp_glow", (lamp.x, lamp.y - 0.02, floor_lamp.SHADE_HEIGHT_M - 0.2), power_w=12, radius_m=0.12
    )
