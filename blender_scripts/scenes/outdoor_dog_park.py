"""In a fenced dog park in autumn a man throws a ball; one dog runs after it in a bow and shoves it on with
its nose, then another gets up and runs after it. A third dog sits by the bench, is stroked by a woman who
walks up, and lies down.

The second and the third dog are twins: who is stroked, who runs, who lies down and who is near the bench
tells them apart. The chase passes from the first dog to the second.
"""

from __future__ import annotations

import math
from math import degrees

import bpy
from mathutils import Vector

from l4d_blender.assets import autumn, ground, mesh
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import throwing
from l4d_blender.motion.ball_games import Ball
from l4d_blender.motion.dogs import Dog
from l4d_blender.motion.people import Person
from l4d_blender.scene.scattering import NEARLY, scatter, skyline
from l4d_blender.scene.scene import Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

BENCH = Vector((-1.55, 1.15, 0.0))
BENCH_HEADING_DEG = degrees(0.08)
FENCE_Y = 2.75
GATE_X = 2.10
BALL_RADIUS_M = 0.055
BALL_WAY = [(28, (0.04, -0.82)), (36, (-0.18, -1.01)), (41, (-0.28, -1.10))]
BALL_STOPS = (-0.42, -1.22)
BALL_ENDS = (1.28, -1.20)
CHASER = (0.66, -0.12)
CHASE = [(-0.30, -0.24), (-1.04, -0.42), (-1.42, -0.84)]

COLOURS = {
    "golden": {"colour": "golden", "pattern": "plain", "ears": "floppy"},
    "black_white": {"colour": "black_and_white", "pattern": "patched", "ears": "pricked"},
    "chocolate": {"colour": "brown", "pattern": "plain", "ears": "floppy"},
}


TWINS = "golden"
THIRD = "black_white"
COLLARS = ("red", "blue")
MAN_TOP = "green"
WOMAN_TOP = "purple"
PET = (33, 68)
SUN_AZIMUTH_DEG = -128.0
SUN_ELEVATION_DEG = 40.0


def build(scene: Scene) -> None:
    """Sets the park, lets dogs and people act, lights it and places the cameras."""
    _park(scene)
    toy = _landmarks(scene)
    _play(scene, toy)
    _light(scene)
    scene.cameras(
        (-0.06, -0.02, 0.64),
        radius_m=4.6,
        heights_m=(1.35, 2.05, 1.70),
        arc_deg=124.0,
        facing_deg=-90.0,
        fov_deg=47.0,
    )


# --- the place --------------------------------------------------------------------------------------------


def _park(scene: Scene) -> None:
    """A mown lawn under autumn trees: none of it annotated."""
    terrain = ground.Terrain(
        seed=scene.rng("terrain").randrange(1 << 30),
        yard=[((GATE_X, FENCE_Y), 1.0)],
        paths=[ground.Path([(-30.0, 6.2), (-8.0, 4.6), (GATE_X, 4.2), (9.0, 5.4), (30.0, 9.0)], 0.8)],
        level_radius_m=5.5,
        hills_from_m=30.0,
        hill_height_m=5.0,
    )
    rng = scene.rng("park")
    scene.make("ground.grass", "lawn", terrain=terrain, tufts=2600, radius_m=9.0, length_m=(0.025, 0.055))

    def rim(x: float, y: float) -> float:
        near_fence = abs(y - FENCE_Y) < 0.16 or abs(abs(x) - 4.6) < 0.16
        return 1.0 if near_fence or math.hypot(x - BENCH.x, y - BENCH.y - 0.1) < 0.45 else 0.06 * (y > 3.0)

    scene.make(
        "ground.grass", "uncut", terrain=terrain, tufts=420, radius_m=9.0, length_m=(0.10, 0.24), keep=rim
    )
    scene.make(
        "autumn.fallen_leaves",
        "fallen_leaves",
        scene.rng("fallen"),
        terrain=terrain,
        count=1500,
        radius_m=9.0,
    )
    scene.make("ground", "ground", terrain=terrain)

    trees = []
    for k, tone in enumerate(autumn.TONES):
        model = scene.make("tree", f"tree_model_{k}", scene.rng(f"tree{k}"), height_m=6.8)
        trees.append(autumn.turned(model, tone))
    spots = [
        (-3.6, 6.0),
        (0.2, 8.4),
        (3.9, 6.4),
        (-7.4, 7.6),
        (7.8, 8.0),
        (-6.6, 2.6),
        (6.4, 2.2),
        (-8.2, -2.4),
    ]
    spots += [(8.0, -2.8), (-2.2, 12.0), (4.4, 12.6), (11.5, 4.6), (-11.6, 4.2)]
    scatter(scene, "tree", trees, spots, rng, on=terrain, scale=(0.85, 1.2))
    hedge = [
        scene.make("tree.bush", f"hedge_model_{k}", scene.rng(f"hedge{k}"), size_xyz=(1.6, 0.9, 0.9))
        for k in range(2)
    ]
    autumn.turned(hedge[1], autumn.TONES[2])
    for k in range(9):
        x = -6.4 + 1.6 * k
        if abs(x - GATE_X) > 1.3:
            size, turn = rng.uniform(0.9, 1.2), rng.uniform(-0.2, 0.2)
            copy = mesh.duplicate(hedge[k % 2], f"hedge_{k}", linked=True)
            at = (x, 6.4 + 0.3 * math.sin(k), -0.05)
            scene.place(copy, at, degrees(turn), on=terrain, scale=size)
    for model in hedge:
        bpy.data.objects.remove(model)
    woods = [scene.make("tree.far_wood", f"wood_model_{k}", scene.rng(f"wood{k}")) for k in range(2)]
    autumn.turned(woods[1], (0.30, 0.16, 0.04))
    ring = skyline(rng, 13, (-20.0, 200.0), (24.0, 40.0))
    scatter(scene, "wood", woods, ring, rng, on=terrain, scale=(0.8, 1.2), turn_deg=NEARLY)


def _landmarks(scene: Scene) -> Ball:
    rng = scene.rng("fence")
    half = 0.62
    rails = [
        scene.make(
            "fence",
            "fence_left",
            rng,
            line=[(-4.6, -3.6), (-4.6, FENCE_Y), (GATE_X - half, FENCE_Y)],
            post_m=1.05,
        ),
        scene.make(
            "fence",
            "fence_right",
            rng,
            line=[(GATE_X + half, FENCE_Y), (4.6, FENCE_Y), (4.6, -3.6)],
            post_m=1.05,
        ),
    ]
    scene.add(1001, "street_bench", "bench", BENCH, BENCH_HEADING_DEG)
    scene.add(
        1002, "fence.gate", "gate", (GATE_X - half + 0.06, FENCE_Y), width_m=2 * half - 0.12, height_m=1.05
    )
    scene.instance("fence", 1003, "fence", rails)
    thrown = scene.add(
        1004, "ball", "ball", radius_m=BALL_RADIUS_M, colour="orange", mark="white", pattern="banded"
    )
    return Ball(thrown, BALL_RADIUS_M, BALL_STOPS)


# --- those who act ----------------------------------------------------------------------------------------


def _play(scene: Scene, toy: Ball) -> None:
    """Throw, chase, shove and second chase in the order of time; beside it the stroked dog."""

    def animal(
        name: str, id: int, coat: str, at: tuple[float, float], heading_deg: float, posture: str
    ) -> Dog:
        collar = COLLARS[0] if coat == TWINS else COLLARS[1]
        looks = COLOURS[coat] | {"collar": collar}
        return Dog(
            scene,
            name,
            id,
            coat=coat,
            collar=collar,
            at=at,
            heading_deg=heading_deg,
            posture=posture,
            attributes=looks,
        )

    chaser = animal("dog_chasing", 1, THIRD, CHASER, degrees(-1.45), "stand")
    waiting = animal("dog_waiting", 2, TWINS, (0.24, 0.58), degrees(1.72), "sit")
    stroked = animal("dog_stroked", 3, TWINS, (-0.98, 0.36), degrees(0.25), "sit")

    man = Person(
        scene,
        "man_throwing",
        4,
        category="person",
        look=_man(scene),
        attributes={"top": MAN_TOP, "pattern": "checked", "hair": "short"},
        at=(1.42, 0.42),
        heading_deg=degrees(-0.95),
    )
    throwing.hold_ball(man, toy.instance, BALL_RADIUS_M)
    throwing.throw(man, toy.instance, (2, 36), release=17, towards=(*BALL_STOPS, 0.1))
    man.look_at((*BALL_STOPS, 0.2), (30, 70))
    man.look_at((*BALL_ENDS, 0.2), (72, LAST_FRAME))
    man.finish()
    throwing.toss(toy, 17, BALL_WAY, (58, BALL_STOPS))

    chaser.watch(toy.centres, (12, 22))
    stop = _stop(chaser)
    chaser.run_along([*CHASE, (stop[0] - 0.24, stop[1] - 0.01), stop], (20, 60), after=toy.instance)
    toy.roll_to(BALL_ENDS, (69, LAST_FRAME))
    chaser.nudge(toy.instance, (59, 80), strike=69)
    chaser.watch(toy.centres, (80, LAST_FRAME), ease_frames=10)
    chaser.wag((62, LAST_FRAME), 0.3)
    chaser.finish()

    waiting.sit((0, 56))
    waiting.watch(toy.centres, (4, 56))
    waiting.stand_up((56, 69))
    waiting.run_along([(0.78, 0.30), (0.98, -0.38)], (69, LAST_FRAME), after=toy.instance)
    waiting.finish()

    first, last = PET
    stroked.sit((0, last + 4))
    stroked.wag((first - 4, last + 4), 0.28)
    stroked.lie_down((last + 5, min(last + 30, LAST_FRAME)))
    _woman(scene, stroked)
    stroked.finish()
    toy.finish()


def _stop(chaser: Dog) -> tuple[float, float]:
    """Where the chaser's middle must come to so that its nose, put down, is behind the ball."""
    reach = (chaser.nose_spot(0) - Vector((*CHASER, 0.0))).to_2d().length + BALL_RADIUS_M + 0.018
    return BALL_STOPS[0] - reach, BALL_STOPS[1]


def _woman(scene: Scene, dog: Dog) -> None:
    """Walks up to the dog by the bench and strokes its head."""
    first, last = PET
    look = Look(
        build="woman",
        height_m=1.68,
        skin="tan",
        hair="ponytail",
        hair_colour="dark_brown",
        top=Cloth(WOMAN_TOP, "stripes", repeat_m=0.06),
        sleeve="long",
        bottom="trousers",
        lower=Cloth("denim", "denim"),
        shoes="boots",
        shoe_colour="brown",
        seed=scene.rng("woman").randrange(1000),
    )
    woman = Person(
        scene,
        "woman_stroking",
        5,
        category="person",
        look=look,
        attributes={"top": WOMAN_TOP, "pattern": "striped", "hair": "ponytail"},
        at=(-0.02, 1.42),
        heading_deg=degrees(-0.7),
    )
    facing_deg = degrees(-0.95)
    crown = dog.crown(first)
    woman.walk_to(woman.reach_spot(crown, facing_deg, side="r"), (0, first - 2), facing_deg=facing_deg)
    woman.pet(dog.instance, crown, (first, last), side="r")
    woman.look_at(dog.instance, (last, LAST_FRAME))
    woman.finish()


def _man(scene: Scene) -> Look:
    return Look(
        build="man",
        height_m=1.82,
        skin="fair",
        hair="short",
        hair_colour="brown",
        top=Cloth(MAN_TOP, "checks", repeat_m=0.09),
        sleeve="long",
        bottom="trousers",
        lower=Cloth("beige"),
        shoes="shoes",
        shoe_colour="brown",
        seed=scene.rng("man").randrange(1000),
    )


def _light(scene: Scene) -> None:
    """Thin cloud: a big soft sun, a bright sky."""
    azimuth, elevation = SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG
    scene.sky(sun_elevation_deg=elevation, sun_azimuth_deg=azimuth, strength=0.30, haze=5.0)
    scene.sun(
        elevation_deg=elevation, azimuth_deg=azimuth, strength=3.0, angle_deg=7.0, colour=(1.0, 0.93, 0.83)
    )
