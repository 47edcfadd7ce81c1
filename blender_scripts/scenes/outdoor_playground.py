"""A playground on a bright morning. A big ball rolls down the slide and comes to rest before a child on a
swing, who drags the feet, stops, and kicks it away; before that, another child has run up to a striped ball,
kicked it into a small goal and cheered. The twin of the striped ball lies in the sandbox all the time.

What tells look-alikes apart: the striped balls differ by which of them is kicked, rolls and ends where; both
children kick, first the one, then the other.
"""

from __future__ import annotations

import math
import random
from math import degrees

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

from l4d_blender.assets import ground, mesh, sandbox, slide, swing
from l4d_blender.assets.materials import playground
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import playing
from l4d_blender.motion.ball_games import RollingBall, downhill, slowing
from l4d_blender.motion.people import Person
from l4d_blender.scene import keys
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scattering import NEARLY, scatter, skyline
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

FLOOR_M = 0.008
SWING = ((1.18, 1.12, FLOOR_M), degrees(-0.25))
SLIDE = ((-2.21, 1.36, FLOOR_M), degrees(math.atan2(0.93, 0.37)))
SANDBOX = ((-1.50, -0.02, FLOOR_M), degrees(0.12))
SANDBOX_SIZE_M = (1.02, 0.92)
GOAL = ((1.46, -0.46, FLOOR_M), degrees(-math.pi / 2 + 0.14))

STRIPED_RADIUS_M = 0.135
BIG_RADIUS_M = 0.165


GIRL = Look(
    build="child",
    height_m=1.22,
    skin="fair",
    hair="ponytail",
    hair_colour="brown",
    top=Cloth("yellow"),
    sleeve="short",
    bottom="shorts",
    lower=Cloth("denim", "denim"),
    shoes="shoes",
    shoe_colour="red",
    seed=11,
)
BOY = Look(
    build="child",
    height_m=1.19,
    skin="brown",
    hair="short",
    hair_colour="black",
    top=Cloth("green", "stripes", "white", repeat_m=0.055),
    sleeve="short",
    bottom="shorts",
    lower=Cloth("navy"),
    shoes="shoes",
    shoe_colour="white",
    seed=23,
)


STRIPED = ("red", "white")
BIG = ("blue", "yellow")
KICK = 14
ROLL_OFF = 2
FLOOR = ((0.33, 0.115, 0.062), (0.55, 0.38, 0.22))
SUN_AZIMUTH_DEG = -62.0
SUN_ELEVATION_DEG = 47.0


def build(scene: Scene) -> None:
    """Sets the place, puts those who act into it, and lights it."""
    terrain = _ground(scene)
    _surroundings(scene, terrain)
    seats = _landmarks(scene)
    _play(scene, seats)
    _light(scene)
    scene.cameras(
        (0.08, 0.40, 0.60),
        radius_m=4.62,
        heights_m=(1.35, 2.05, 1.65),
        arc_deg=124.0,
        facing_deg=-90.0,
        fov_deg=47.0,
    )


# --- the place --------------------------------------------------------------------------------------------


def _ground(scene: Scene) -> ground.Terrain:
    """A lawn, and on it the rubber floor under what children fall from."""
    terrain = ground.Terrain(
        seed=scene.rng("terrain").randrange(1 << 30),
        paths=[ground.Path([(-30.0, 7.4), (-8.0, 6.2), (3.0, 6.0), (12.0, 8.5), (30.0, 10.0)], 0.9)],
        level_radius_m=4.62,
    )
    rng = scene.rng("floor")
    waves = [(rng.uniform(0, 6.28), rng.uniform(0.03, 0.11)) for _ in range(4)]

    def rim(angle: float) -> float:
        return 2.75 + sum(a * math.sin((k + 2) * angle + p) for k, (p, a) in enumerate(waves))

    def outside(x: float, y: float) -> float:
        return 1.0 if math.hypot(x, y - 0.45) > rim(math.atan2(y - 0.45, x)) + 0.06 else 0.0

    rings = [(0.0, FLOOR_M), (0.985, FLOOR_M), (1.0, FLOOR_M - 0.004), (1.012, -0.05)]
    count = 96
    verts = [(0.0, 0.45, FLOOR_M)]
    for share, z in rings[1:]:
        for k in range(count):
            angle = 2 * math.pi * k / count
            r = share * rim(angle)
            verts.append((r * math.cos(angle), 0.45 + r * math.sin(angle), z))
    faces: list[tuple[int, ...]] = [(0, 1 + k, 1 + (k + 1) % count) for k in range(count)]
    for ring in range(2):
        a, b = 1 + ring * count, 1 + (ring + 1) * count
        faces += [(a + k, b + k, b + (k + 1) % count, a + (k + 1) % count) for k in range(count)]
    floor = mesh.from_pydata("rubber_floor", verts, faces, smooth=False)
    mesh.set_material(floor, playground.rubber_granulate("rubber_floor", *FLOOR))
    scene.make(
        "ground.grass",
        "lawn",
        terrain=terrain,
        tufts=2300,
        radius_m=9.5,
        length_m=(0.035, 0.085),
        keep=outside,
    )
    scene.make("ground", "ground", terrain=terrain)
    return terrain


def _surroundings(scene: Scene, terrain: ground.Terrain) -> None:
    """Fence, trees, hedges and the houses of the neighbourhood: none annotated but the fence."""
    rng = scene.rng("surroundings")

    trees = [scene.make("tree", f"tree_model_{k}", scene.rng(f"tree{k}"), height_m=6.0) for k in range(2)]
    spots = [
        (-5.6, 8.4),
        (-0.9, 9.9),
        (3.6, 12.5),
        (7.4, 8.0),
        (10.5, 2.2),
        (-9.6, 4.4),
        (-9.2, -1.6),
        (9.8, -3.8),
        (-4.0, 15.0),
        (-12.0, 12.0),
        (13.0, 11.0),
    ]
    scatter(scene, "tree", trees, spots, rng, on=terrain, scale=(0.8, 1.1))
    hedge = scene.make("tree.bush", "hedge_model", scene.rng("hedge"), size_xyz=(1.9, 0.9, 1.0))
    spots = [
        (-6.9, 5.4),
        (-2.6, 5.9),
        (3.4, 6.0),
        (7.4, 3.8),
        (7.0, 0.4),
        (-6.4, 1.2),
        (-6.8, -2.9),
        (6.9, -4.4),
    ]
    scatter(scene, "hedge", [hedge], spots, rng, on=terrain, scale=(0.75, 1.15), turn_deg=NEARLY)
    woods = scene.make("tree.far_wood", "wood_model", scene.rng("wood"))
    ring = skyline(rng, 15, (-35.0, 215.0), (36.0, 60.0))
    scatter(scene, "wood", [woods], ring, rng, on=terrain, scale=(0.9, 1.4), turn_deg=NEARLY)
    for k, (x, y, turn) in enumerate(
        [
            (-20.0, 25.0, 0.45),
            (-4.5, 33.0, 0.12),
            (13.0, 29.0, -0.30),
            (30.0, 14.0, -1.1),
            (-31.0, 9.0, 1.25),
            (-29.0, -9.0, 1.7),
            (30.0, -7.0, -1.6),
        ]
    ):
        scene.put(
            "house",
            f"house_{k}",
            (x, y),
            degrees(turn),
            on=terrain,
            rng=scene.rng(f"house{k}"),
            size_xy=(rng.uniform(8.0, 11.0), 7.0),
        )


def _landmarks(scene: Scene) -> list[tuple[bpy.types.Object, Matrix]]:
    """Swing, slide, sandbox, goal and fence; returns the swing's seats with their resting matrices."""
    made = scene.put("swing", "swing", *SWING)
    scene.instance("swing", 1001, "swing", made, front="-y")
    scene.add(1002, "slide", "slide", *SLIDE)

    rng = scene.rng("sandbox")
    sand = sandbox.sand_of(rng, ((0.15, 0.14, 0.34),))
    scene.add(1003, "sandbox", "sandbox", *SANDBOX, rng=rng, sand=sand, size_m=SANDBOX_SIZE_M)
    for thing, x, y, turn in (
        (scene.make("sandbox.pail", "pail", rng), -0.28, -0.08, 0.4),
        (scene.make("sandbox.spade", "spade", rng), -0.06, -0.26, 1.9),
        (scene.make("sandbox.sand_cake", "cake_0", rng), -0.33, 0.20, 0.0),
        (scene.make("sandbox.sand_cake", "cake_1", rng), -0.16, 0.29, 1.0),
    ):
        scene.place(thing, (x, y, sand.height(x, y)), degrees(turn), on=pose(*SANDBOX))

    scene.add(1004, "goal", "goal", *GOAL, width_m=1.10, height_m=0.72, depth_m=0.50)
    scene.add(
        1005,
        "picket_fence",
        "fence",
        line=[(-6.2, -1.5), (-5.2, 2.6), (-3.6, 4.7), (0.2, 5.2), (4.2, 4.7), (5.6, 2.2), (6.2, -2.0)],
        colours=("yellow", "light_green", "light_blue", "orange"),
    )
    return list(zip(made.seats, swing.resting(pose(*SWING))))


# --- those who play ---------------------------------------------------------------------------------------


def _make_ball(
    scene: Scene, name: str, id: int, radius_m: float, look: tuple[str, str], pattern: str, size: str
) -> Instance:
    return scene.add(
        id,
        "ball",
        name,
        (0.0, 0.0),
        attributes={"colour": look[0], "pattern": pattern, "size": size},
        rng=scene.rng(f"{name}/look"),
        radius_m=radius_m,
        colour=look[0],
        mark=look[1],
        pattern=pattern,
    )


def _turned(rng: random.Random) -> Quaternion:
    return Quaternion((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)), rng.uniform(0.5, 2.8))


def _child(
    scene: Scene, name: str, id: int, look: Look, at: tuple[float, float], heading_deg: float
) -> Person:
    return Person(
        scene,
        name,
        id,
        category="child",
        look=look,
        attributes={
            "shirt": str(look.top.colour),
            "pattern": {"stripes": "striped"}.get(look.top.pattern, look.top.pattern),
            "trousers": "shorts",
            "hair": look.hair,
        },
        at=at,
        heading_deg=heading_deg,
        ground_m=0.0,
    )


def _play(scene: Scene, seats: list[tuple[bpy.types.Object, Matrix]]) -> None:
    """The story in the order of time: a ball on the slide, a shot at the goal, a stop, a second kick."""
    rng = scene.rng("balls")
    striped, big = STRIPED_RADIUS_M, BIG_RADIUS_M
    kicked = _make_ball(scene, "ball_shot", 1, striped, STRIPED, "striped", "small")
    left = _make_ball(scene, "ball_in_sand", 2, striped, STRIPED, "striped", "small")
    slid = _make_ball(scene, "ball_from_slide", 3, big, BIG, "dotted", "large")

    # The rider swings, drags the feet and hangs still; the shove of the kick rocks the seat a little.
    drag, stop, second = 37, 58, 74
    angles = playing.swing_angles(0.50, (0, stop), drag=drag, length_m=swing.HANG_M)
    frames = np.arange(LAST_FRAME + 1)
    angles = angles - 0.045 * np.exp(-(((frames - second - 3) / 7.0) ** 2))
    seat, hung = seats[0]
    keys.key_matrices(seat, [hung @ Matrix.Rotation(-a, 4, "X") for a in angles])
    rider = _child(scene, "child_on_swing", 5, BOY, (0.0, 0.0), 0.0)
    rides = playing.ride(
        rider, hung, angles, hang_m=swing.HANG_M, chains_apart_m=swing.CHAINS_APART_M, drag=drag, stop=stop
    )

    # The big ball comes down the slide to the rider's feet.
    line = [pose(*SLIDE) @ p for p in slide.chute_line(big, from_y_m=-0.12)]
    stops = Vector((*playing.seated_kick_point(rider, rides, big), FLOOR_M + big))
    run_out = line[-1] + 0.12 * (line[-1] - line[-2]).normalized()
    run_out.z = FLOOR_M + big
    roller = RollingBall(slid, big, line[0], _turned(rng))
    on_slope = keys.Path(line).length
    whole = keys.Path([*line, run_out, stops]).length
    roll = (ROLL_OFF, ROLL_OFF + 58)
    roller.roll_along([*line[1:], run_out, stops], roll, downhill(on_slope / whole, 0.56))
    scene.event(slid, "roll_down", (roll[0], roll[0] + 32), scene.instances[1])
    playing.kick_seated(rider, rides, slid, (second - 12, second + 14), strike=second)
    away = stops + Vector((-0.22, -0.68, 0.0))
    roller.roll_along([away], (second, 95), slowing())

    # The other child runs up and shoots at the goal.
    shot_from = Vector((0.06, -0.72, FLOOR_M + striped))
    target = Vector((1.58, -0.50, FLOOR_M + striped))
    way = target - shot_from
    heading_deg = degrees(math.atan2(way.x, -way.y))
    spot = playing.kick_spot(GIRL, shot_from, heading_deg, striped)
    start = Vector(spot) - 0.44 * Vector(way[:2]).normalized()
    kicker = _child(scene, "child_at_ball", 4, GIRL, start, heading_deg)
    first = KICK
    strike = first + 10
    kicker.walk_to(spot, (0, first), facing_deg=heading_deg)
    playing.kick(kicker, kicked, (first, strike + 16), strike=strike)
    shot = RollingBall(kicked, striped, shot_from, _turned(rng))
    shot.roll_along([target], (strike, strike + 36), slowing(2.0))
    playing.cheer(kicker, (strike + 24, strike + 58))

    at_rest = pose(*SANDBOX) @ Vector((0.15, 0.14, 0.075 + striped - 0.004))
    still = RollingBall(left, striped, at_rest, _turned(rng))
    for actor in (roller, shot, still, rider, kicker):
        actor.finish()


def _light(scene: Scene) -> None:
    """A clear morning: strong sun, blue shadows."""
    scene.exposure = 0.92
    azimuth, elevation = SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG
    scene.sky(sun_elevation_deg=elevation, sun_azimuth_deg=azimuth, strength=0.15)
    scene.sun(
        elevation_deg=elevation, azimuth_deg=azimuth, strength=4.2, angle_deg=1.2, colour=(1.0, 0.93, 0.82)
    )
