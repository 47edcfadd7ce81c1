"""A farm yard in warm late-afternoon sun. Three buckets stand in a row between a haystack and a well; a
fourth, the twin of the middle one, stands apart behind them. One woman walks up to it, bends down, lifts it
and carries it away; another stands by the well and waves for a while. Three hens of one look share the
foreground: one pecks in bouts, one walks and stops, one only stands and looks about.

What tells look-alikes apart: the twin buckets differ by place and by who touches them, the women by what
they do, the hens by what they do and when.
"""

from __future__ import annotations

import math
from math import degrees

from mathutils import Vector

from l4d_blender.assets import bucket, ground
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion.birds import heading_on
from l4d_blender.motion.hens import Hen
from l4d_blender.motion.people import Person
from l4d_blender.scene import keys
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scattering import NEARLY, scatter, skyline
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

HAYSTACK = Vector((-1.95, 0.78, 0.0))
WELL = Vector((2.02, 0.85, 0.0))
BARN = Vector((-2.9, 8.9, 0.0))
BARN_HEADING_DEG = degrees(0.22)
BARN_DOOR = Vector((-2.35, 6.3, 0.0))

#: Where buckets stand: three in the row, one apart.
ROW = {
    "haystack": Vector((-1.33, -0.12, 0.0)),
    "middle": Vector((0.02, -0.42, 0.0)),
    "well": Vector((1.30, -0.18, 0.0)),
}
APART = Vector((0.20, 0.98, 0.0))
NAMES = {
    "haystack": "bucket_by_haystack",
    "middle": "bucket_in_between",
    "well": "bucket_by_well",
    "apart": "bucket_fetched",
}


TWINS = "galvanised"
OTHERS = ("red", "blue")
DRESSES = ("pink", "green")
HAIR = ("blond", "dark_brown")
PLUMAGE = "russet"
WAVE = (18, 74)
PECK = (17, 78)
SUN_AZIMUTH_DEG = -118.0
SUN_ELEVATION_DEG = 31.0


def build(scene: Scene) -> None:
    """Sets the yard, puts those who act into it, and lights it."""
    terrain = _yard(scene)
    _surroundings(scene, terrain)
    _landmarks(scene)
    buckets = _buckets(scene)
    _women(scene, buckets["apart"])
    _hens(scene)
    _light(scene)
    scene.cameras(
        (0.0, 0.2, 0.86), radius_m=5.2, heights_m=(1.45, 2.45), arc_deg=166.0, facing_deg=-90.0, fov_deg=47.0
    )


# --- the yard ---------------------------------------------------------------------------------------------


def _yard(scene: Scene) -> ground.Terrain:
    terrain = ground.Terrain(
        seed=scene.rng("terrain").randrange(1 << 30),
        yard=[((0.0, 0.2), 3.3), ((-1.2, 3.4), 2.4), ((-2.3, 5.6), 1.9)],
        paths=[
            ground.Path([(-2.4, 6.0), (-0.9, 2.8), (0.4, -1.5), (1.2, -4.5), (0.6, -14.0)], 0.75),
            ground.Path(
                [(-30.0, 5.5), (-11.0, 3.9), (-4.0, 3.2), (2.0, 3.9), (6.2, 5.6), (14.0, 12.0), (40.0, 24.0)],
                1.15,
                ruts=True,
            ),
        ],
    )
    covered = [(WELL, 0.62), (HAYSTACK, 0.75)]

    def free(x: float, y: float) -> float:
        inside_barn = abs(x - BARN.x) < 3.2 and abs(y - BARN.y) < 2.7
        return 0.0 if inside_barn or any(math.hypot(x - c.x, y - c.y) < r for c, r in covered) else 1.0

    scene.make(
        "ground.grass", "turf", terrain=terrain, tufts=1500, radius_m=8.5, length_m=(0.04, 0.11), keep=free
    )
    rim = [(WELL, 0.66, 0.22), (HAYSTACK, 0.85, 0.25)]

    def at_edges(x: float, y: float) -> float:
        """Scythes miss what grows against stones, fences and walls."""
        near = max((1.0 for c, r, w in rim if r < math.hypot(x - c.x, y - c.y) < r + w), default=0.0)
        return free(x, y) * max(near, 0.25 if math.hypot(x, y) > 5.5 else 0.0)

    scene.make(
        "ground.grass",
        "meadow",
        terrain=terrain,
        tufts=700,
        radius_m=13.0,
        length_m=(0.12, 0.34),
        keep=at_edges,
    )
    scene.make("ground.stones", "stones", terrain=terrain, count=240, radius_m=7.0, keep=free)
    scene.make(
        "ground.straw_litter",
        "litter",
        terrain=terrain,
        spots=[
            ((HAYSTACK.x, HAYSTACK.y), 1.5, 420),
            ((BARN_DOOR.x, BARN_DOOR.y), 1.3, 160),
            ((-0.3, -0.3), 2.6, 130),
        ],
    )
    scene.make("ground", "ground", terrain=terrain)
    return terrain


def _surroundings(scene: Scene, terrain: ground.Terrain) -> None:
    """Trees and bushes behind the yard, woods on the skyline, tools that stand about: none annotated."""
    rng = scene.rng("surroundings")

    trees = [scene.make("tree", f"tree_model_{k}", scene.rng(f"tree{k}"), height_m=6.5) for k in range(3)]
    spots = [
        (2.6, 11.5),
        (5.4, 9.2),
        (8.8, 8.6),
        (12.0, 4.6),
        (10.8, -1.6),
        (15.5, 10.0),
        (-8.4, 9.6),
        (-10.2, 5.4),
        (-12.5, 0.6),
        (-10.6, -4.2),
        (-14.5, 9.0),
        (13.0, -5.5),
    ]
    scatter(scene, "tree", trees, spots, rng, on=terrain, scale=(0.8, 1.15), loose_m=0.4)
    bushes = [
        scene.make("tree.bush", f"bush_model_{k}", scene.rng(f"bush{k}"), size_xyz=(1.7, 1.0, 1.1))
        for k in range(2)
    ]
    spots = [
        (1.2, 7.4),
        (-6.9, 6.5),
        (6.9, 5.7),
        (8.6, 2.4),
        (8.9, 0.7),
        (-8.2, 2.9),
        (-8.4, -1.2),
        (-8.9, -2.6),
        (4.6, 7.3),
    ]
    scatter(scene, "bush", bushes, spots, rng, on=terrain, scale=(0.75, 1.25))
    woods = [scene.make("tree.far_wood", f"wood_model_{k}", scene.rng(f"wood{k}")) for k in range(2)]
    ring = skyline(rng, 17, (-38.0, 218.0), (32.0, 58.0))
    scatter(scene, "wood", woods, ring, rng, on=terrain, scale=(0.9, 1.5), turn_deg=NEARLY)

    door = pose(BARN, BARN_HEADING_DEG)
    ladder_foot = door @ Vector((1.75, -3.2, 0.0))
    scene.put(
        "farm_tools.ladder",
        "ladder",
        ladder_foot.xy,
        BARN_HEADING_DEG,
        on=terrain,
        tilt_deg=degrees(-0.19),
        rng=rng,
    )
    for k, (x, y, turn) in enumerate([(2.2, -3.3, 0.1), (2.35, -3.85, -0.25)]):
        spot = door @ Vector((x, y, 0.0))
        scene.put(
            "haystack.hay_bale", f"bale_{k}", spot.xy, BARN_HEADING_DEG + degrees(turn), on=terrain, rng=rng
        )
    for k, (x, y) in enumerate([(-1.75, -2.95), (-2.15, -3.05)]):
        spot = door @ Vector((x, y, 0.0))
        churn = scene.make("farm_tools.milk_churn", f"churn_{k}", rng)
        scene.place(churn, spot.xy, degrees(rng.uniform(0, 3)), on=terrain)
    fork = scene.make("farm_tools.hay_fork", "fork")
    leaning = HAYSTACK + Vector((0.62, -0.60, 0.0))
    scene.place(fork, leaning, degrees(0.75), tilt_deg=degrees(-0.30))


def _landmarks(scene: Scene) -> None:
    rails = scene.make("fence", "fence", line=[(0.9, 7.0), (3.6, 6.6)])
    east = scene.make("fence", "fence_east", line=[(6.4, 4.7), (7.5, 2.2), (7.6, -2.0), (7.2, -5.5)])
    west = scene.make("fence", "fence_west", line=[(-6.0, 6.6), (-7.3, 4.6)])
    far_west = scene.make("fence", "fence_far_west", line=[(-7.6, 1.9), (-7.6, -1.5), (-7.3, -5.0)])
    scene.add(1001, "well", "well", WELL, degrees(-0.35))
    scene.add(1002, "haystack", "haystack", HAYSTACK)
    scene.add(1003, "barn", "barn", BARN, BARN_HEADING_DEG)
    scene.instance("fence", 1004, "fence", [rails, east, west, far_west])
    scene.add(1005, "farm_tools.wheelbarrow", "wheelbarrow", (-1.05, 3.60), degrees(1.0))


# --- those who act ----------------------------------------------------------------------------------------


def _buckets(scene: Scene) -> dict[str, Instance]:
    rng = scene.rng("buckets")
    looks = {"middle": TWINS, "apart": TWINS}
    looks["haystack"], looks["well"] = OTHERS
    plan = {
        "haystack": (ROW["haystack"], 1.25, None),
        "middle": (ROW["middle"], 0.0, None),
        "well": (ROW["well"], -1.25, "water"),
        "apart": (APART, 0.0, None),
    }
    instances = {}
    for id, (place, (spot, bail, filling)) in enumerate(plan.items(), 1):
        name = NAMES[place]
        jitter = Vector((rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0.0))
        material = "metal" if looks[place] == "galvanised" else "painted"
        instances[place] = scene.add(
            id,
            "bucket",
            name,
            spot + jitter,
            degrees(rng.uniform(-0.6, 0.6)),
            attributes={
                "colour": "grey" if looks[place] == "galvanised" else looks[place],
                "material": material,
                "content": filling or "empty",
            },
            rng=scene.rng(f"bucket/{place}"),
            look=looks[place],
            bail_angle=bail,
            filling=filling,
        )
    return instances


def _women(scene: Scene, wanted: Instance) -> None:
    """One fetches the bucket that stands apart, the other waves from the well."""
    rng = scene.rng("women")
    fetcher_look = Look(
        build="woman",
        height_m=1.67,
        skin="fair",
        hair="ponytail",
        hair_colour=HAIR[0],
        bottom="dress",
        sleeve="short",
        lower=Cloth(DRESSES[0]),
        apron=Cloth("beige"),
        shoes="boots",
        shoe_colour="brown",
        seed=rng.randrange(1000),
    )
    waver_look = Look(
        build="woman",
        height_m=1.71,
        girth=1.06,
        skin="tan",
        hair="bun",
        hair_colour=HAIR[1],
        bottom="dress",
        sleeve="elbow",
        lower=Cloth(DRESSES[1], "dots", repeat_m=0.05),
        shoes="boots",
        shoe_colour="black",
        seed=rng.randrange(1000),
    )

    fetcher = Person(
        scene,
        "woman_fetching",
        5,
        category="woman",
        look=fetcher_look,
        attributes={"dress": DRESSES[0], "pattern": "plain", "apron": "beige"},
        at=(0.22, 2.80),
        heading_deg=degrees(0.10),
    )
    facing_deg = degrees(-0.80)
    fetcher.walk_to(
        fetcher.reach_spot(wanted.matrix(0).translation, facing_deg, side="l"), (0, 30), facing_deg=facing_deg
    )
    fetcher.lift(
        wanted,
        (0.0, 0.0, bucket.GRIP_Z_M),
        (30, 58),
        side="l",
        bar=(1.0, 0.0, 0.0),
        clear_m=bucket.RIM_RADIUS_M,
    )
    fetcher.walk_along([(-0.22, 1.42), (-0.62, 1.72)], (58, LAST_FRAME))
    fetcher.finish()

    waver = Person(
        scene,
        "woman_waving",
        6,
        category="woman",
        look=waver_look,
        attributes={"dress": DRESSES[1], "pattern": "dotted", "apron": "none"},
        at=(1.06, 0.66),
        heading_deg=degrees(-0.45),
    )
    waver.stand()
    waver.wave(WAVE, side="r")
    waver.finish()


def _hens(scene: Scene) -> None:
    def actor(name: str, id: int, at: Vector, heading_deg: float) -> Hen:
        return Hen(scene, name, id, plumage=PLUMAGE, at=at, heading_deg=heading_deg)

    pecker = actor("hen_pecking", 7, Vector((-0.62, -1.18, 0.0)), degrees(0.9))
    first, last = PECK
    pecker.stand(0, first - 1)
    pecker.peck(first, last)
    pecker.stand(last + 1, LAST_FRAME)
    pecker.finish()

    way = keys.Path([(0.02, -1.56), (0.35, -1.52), (0.62, -1.36), (0.80, -1.14)])
    walker = actor("hen_walking", 8, way.point(0.0), degrees(heading_on(way, 0.0)))
    walker.walk(way, 0, 72)
    walker.stand(73, LAST_FRAME)
    walker.finish()

    watcher = actor("hen_watching", 9, Vector((0.60, -0.12, 0.0)), degrees(-0.7))
    watcher.stand(0, LAST_FRAME)
    watcher.finish()


# --- light ------------------------------------------------------------------------------------------------


def _light(scene: Scene) -> None:
    azimuth, elevation = SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG
    # The sky of a lower sun is the warmer one; shadows keep the length that leaves the yard readable.
    scene.sky(sun_elevation_deg=elevation - 12.0, sun_azimuth_deg=azimuth, strength=0.22)
    scene.sun(
        elevation_deg=elevation, azimuth_deg=azimuth, strength=6.2, angle_deg=1.6, colour=(1.0, 0.77, 0.50)
    )
