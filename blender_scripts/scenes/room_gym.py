"""Two athletes train in a gym with three dumbbells. One takes a dumbbell from a step, curls it and puts it
back; the other stretches, walks to a bench and lifts the biggest dumbbell from it.

Story. Two of the dumbbells look the same. He takes one of them up from an aerobics step, does two curls and
puts it back. Meanwhile she stretches beside the treadmill, walks over to the bench, on which the other twin
and the big dumbbell lie, and takes up the big one. The twin on the bench is never touched: it looks like the
first and lies where the second lay. Lifting passes from him to her.

Axes: the floor is z = 0, cameras on the -Y side; metres; a heading of 0 faces -Y.
"""

from __future__ import annotations

from math import degrees, radians

from l4d_blender.assets import dumbbell, gym_equipment
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import lifters
from l4d_blender.motion.handling import key_path, still
from l4d_blender.motion.people import Person
from l4d_blender.scene.scene import Instance, Scene

SCALE = "room"

HALF_WIDTH, BACK_Y, FRONT_Y = 3.3, 2.5, -3.6
STEP = ((-0.72, -0.27), 4.0)
BENCH = ((0.40, -0.22), -3.0)
TREADMILL = ((2.12, 1.12), -30.0)
LONER = ((-0.60, 0.20), degrees(0.30))
WAITS = ((0.96, 0.64), degrees(-0.30))
AT_BENCH, BENCH_HEADING_DEG = (0.82, 0.23), degrees(-0.20)
TAKEN = (-0.73, -0.25)
LEFT = (0.08, -0.21)
BIG = (0.54, -0.23)


PLACES = ("on_step", "left", "from_bench")
RUBBER = (0.032, 0.033, 0.036)
COATS = {
    "red": (0.45, 0.035, 0.025),
    "blue": (0.03, 0.12, 0.42),
    "yellow": (0.66, 0.42, 0.03),
    "grey": (0.26, 0.27, 0.28),
}


TWIN_COLOUR = "blue"
BIG_COLOUR = "yellow"
SHIRTS = ("green", "orange")
BUILDS = ("man", "woman")
SKINS = ("fair", "dark")
HAIR = ("brown", "black")
BRICK = (0.34, 0.13, 0.08)
PAINT = (0.36, 0.40, 0.40)
VINYL = (0.34, 0.045, 0.035)


def build(scene: Scene) -> None:
    """Builds the hall, sets the equipment, lets the athletes train, lights it."""
    build_hall(scene)
    set_equipment(scene)
    train(scene)
    light(scene)
    scene.cameras(
        (0.10, 0.10, 0.84), radius_m=3.1, heights_m=(1.40, 1.70, 1.25), arc_deg=88, facing_deg=-90, fov_deg=50
    )


def build_hall(scene: Scene) -> None:
    """Walls, windows and what stands along the walls."""
    rng = scene.rng("hall")
    scene.make(
        "gym_room",
        "hall",
        rng,
        half_width_m=HALF_WIDTH,
        back_m=BACK_Y,
        front_m=FRONT_Y,
        brick=BRICK,
        paint=PAINT,
    )
    panes = [
        scene.put("gym_room.window", f"window_{k}", (x, BACK_Y), rng=rng, columns=4)
        for k, x in enumerate((-1.95, 0.10, 2.15))
    ]
    side = scene.put("gym_room.window", "side_window", (HALF_WIDTH, 0.9), -90, rng=rng, columns=5)
    scene.instance("windows", 1006, "window", [*panes, side], front="-y")
    scene.add(1004, "gym_equipment.wall_bars", "wall_bars", (-HALF_WIDTH + 0.01, 0.75), 90, rng=rng, fields=2)
    scene.add(1005, "gym_equipment.kettlebell_rack", "rack", (-0.72, BACK_Y - 0.05), rng=rng)
    scene.add(
        1007, "gym_equipment.punching_bag", "punching_bag", (-1.85, 1.25), rng=rng, colour=(0.10, 0.03, 0.025)
    )
    scene.put(
        "gym_equipment.barbell_stand", "stand", (0.62, BACK_Y - 0.02), rng=rng, plate=(0.030, 0.030, 0.033)
    )
    scene.put("gym_equipment.exercise_ball", "ball_grey", (-2.65, -0.62), rng=rng, colour=(0.30, 0.32, 0.34))
    scene.put("gym_equipment.exercise_ball", "ball_teal", (2.75, -0.15), rng=rng, colour=(0.03, 0.24, 0.25))
    scene.put("gym_equipment.rolled_mats", "mats", (2.85, 0.75), rng=rng)
    scene.put("gym_room.pipes", "duct", (0.0, BACK_Y - 0.45), on=3.12, rng=rng, width_m=6.5)
    scene.put(
        "gym_equipment.folded_towel",
        "bar_towel",
        (-HALF_WIDTH + 0.11, 0.40),
        90,
        on=1.30,
        rng=rng,
        colour=(0.62, 0.58, 0.50),
    )


def set_equipment(scene: Scene) -> None:
    """Step, bench and treadmill, a mat, bottles."""
    rng = scene.rng("equipment")
    step = scene.put("gym_equipment.step", "step", *STEP, rng=rng, colour=(0.10, 0.34, 0.36))
    scene.add(1001, "gym_equipment.bench", "bench", *BENCH, rng=rng, colour=VINYL)
    scene.instance("step", 1002, "step", step)
    scene.add(1003, "gym_equipment.treadmill", "treadmill", *TREADMILL, rng=rng)
    scene.put(
        "gym_equipment.floor_mat",
        "mat",
        (-0.66, 0.06),
        3,
        rng=rng,
        colour=(0.07, 0.12, 0.17),
        size_m=(1.7, 1.2),
    )
    scene.put("gym_equipment.drink_bottle", "bottle_0", (-1.28, -0.22), rng=rng, colour=(0.60, 0.58, 0.10))
    scene.put("gym_equipment.drink_bottle", "bottle_1", (1.30, -0.42), rng=rng, colour=(0.10, 0.30, 0.50))


# --- those who train --------------------------------------------------------------------------------------


def train(scene: Scene) -> None:
    """Everything that moves, in the order of time."""
    taken, left, heavy = (weight(scene, place, id) for id, place in enumerate(PLACES, 1))

    loner = hire(scene, 0, "athlete_curling", 4, *LONER)
    rest = lifters.rest_matrix(loner, (*TAKEN, gym_equipment.STEP_TOP_M), "r")
    lifters.train(
        loner,
        taken,
        rest,
        look_of("on_step").bar_height_m,
        side="r",
        take=(-4, 24),
        curl=(24, 62),
        reps=2,
        put_down=(63, 90),
    )
    loner.finish()

    key_path(left.frame_object, still((*LEFT, gym_equipment.BENCH_TOP_M), 66.0))

    comer = hire(scene, 1, "athlete_stretching", 5, *WAITS)
    lifters.stretch(comer, (0, 36))
    comer.walk_to(AT_BENCH, (36, 56), facing_deg=BENCH_HEADING_DEG)
    rest = still((*BIG, gym_equipment.BENCH_TOP_M), BENCH_HEADING_DEG + 78.0)[0]
    bar_m = look_of("from_bench").bar_height_m
    lifters.train(comer, heavy, rest, bar_m, side="r", take=(54, 78), curl=(78, 122), reps=2)
    comer.finish()


def look_of(place: str) -> dumbbell.DumbbellLook:
    """Two hexagonal twins and a big one with round plates."""
    if place == "from_bench":
        return dumbbell.round_plates(RUBBER, COATS[BIG_COLOUR])
    return dumbbell.hexagonal(RUBBER, COATS[TWIN_COLOUR])


def weight(scene: Scene, place: str, id: int) -> Instance:
    """The dumbbell for a place; it lies nowhere yet."""
    look, odd = look_of(place), place == "from_bench"
    return scene.add(
        id,
        "dumbbell",
        f"dumbbell_{place}",
        (0.0, 0.0),
        attributes={
            "colour": BIG_COLOUR if odd else TWIN_COLOUR,
            "shape": look.heads,
            "size": "large" if odd else "medium",
        },
        rng=scene.rng(f"dumbbell/{look.heads}"),
        look=look,
    )


def hire(scene: Scene, k: int, name: str, id: int, at: tuple[float, float], heading_deg: float) -> Person:
    """One of the two wears shorts and short sleeves, the other leggings and a sleeveless top."""
    build, in_shorts = BUILDS[k], k == 0
    man = build == "man"
    look = Look(
        build=build,
        height_m=1.79 if man else 1.70,
        girth=1.05 if man else 0.98,
        skin=SKINS[k],
        hair="short" if man else ("bun" if in_shorts else "ponytail"),
        hair_colour=HAIR[k],
        top=Cloth(SHIRTS[k]),
        sleeve="short" if in_shorts else "none",
        bottom="shorts" if in_shorts else "trousers",
        lower=Cloth("navy") if in_shorts else Cloth("black"),
        shoe_colour="grey" if in_shorts else "white",
        seed=scene.rng(name).randrange(1000),
    )
    return Person(
        scene,
        name,
        id,
        category="athlete",
        look=look,
        attributes={
            "top": SHIRTS[k],
            "sleeves": look.sleeve,
            "legs": "shorts" if in_shorts else "leggings",
            "hair": look.hair,
        },
        at=at,
        heading_deg=heading_deg,
    )


# --- light ------------------------------------------------------------------------------------------------


def light(scene: Scene) -> None:
    """Late sun that slants in from the side windows, cool sky from the back, tubes under the roof."""
    scene.exposure = 1.1
    scene.hdri("city", strength=0.42, rotation_deg=degrees(2.2))
    scene.area_light(
        "sky",
        (0.1, BACK_Y - 0.3, 2.2),
        (0.0, -0.5, 0.4),
        size_m=(4.5, 1.6),
        power_w=40,
        colour=(0.86, 0.93, 1.0),
    )
    beam = scene.area_light(
        "low_sun",
        (HALF_WIDTH - 0.2, 0.6, 2.5),
        (-0.2, -0.3, 0.4),
        size_m=(1.6, 1.4),
        power_w=170,
        colour=(1.0, 0.74, 0.45),
    )
    beam.data.spread = radians(60)
    scene.area_light(
        "tubes", (0.0, -0.9, 3.1), (0.0, 0.1, 0.8), size_m=(2.8, 0.25), power_w=30, colour=(1.0, 0.95, 0.88)
    )
