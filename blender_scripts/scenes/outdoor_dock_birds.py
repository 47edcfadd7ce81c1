"""Three gulls at a water dish on a lake dock on a clear morning: one drinks and walks away, one glides in,
lands and only stands there, one walks up and drinks later. A drake swims a curve behind the dock while a
brown duck eats from a tray of seeds.

The first drinker and the one that lands are twins: who comes flying, who drinks and who is where at the end
tells them apart. The dish passes from the first drinker to the third gull.
"""

from __future__ import annotations

import math
from math import degrees

from mathutils import Vector

from l4d_blender.assets import bird_feeder, lake, waterbird
from l4d_blender.motion.waterbirds import DRAFT_M, WaterBird
from l4d_blender.scene import keys
from l4d_blender.scene.scattering import NEARLY, scatter, skyline
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

WATER_M = -0.27
DECK_X = (-3.5, 0.92)
HALF_WIDTH_M = 0.66
DISH = Vector((-0.02, 0.02, 0.0))
TRAY = Vector((-0.70, -0.30, 0.0))
POST = Vector((0.93, 0.78, 0.0))
WAIT = Vector((0.66, 0.27, 0.0))
BOAT = Vector((-1.48, 1.70, WATER_M))
REACH_M = 0.205  # from a gull's middle to where its bill meets the water
DUCK_REACH_M = 0.303

LOOKS = {
    "grey_backed": {"back": "grey", "head": "white", "legs": "pink", "bill": "yellow"},
    "hooded": {"back": "grey", "head": "dark_hood", "legs": "red", "bill": "red"},
    "mottled_young": {"back": "brown", "head": "mottled", "legs": "pink", "bill": "black"},
    "drake": {"head": "green", "collar": "white", "pattern": "plain"},
    "duck_hen": {"head": "brown", "collar": "none", "pattern": "mottled"},
}


TWINS = "grey_backed"
THIRD = "hooded"
GLAZE = (0.10, 0.23, 0.42)
BOAT_COLOUR = (0.62, 0.60, 0.54)
SUN_AZIMUTH_DEG = -28.0
SUN_ELEVATION_DEG = 33.0


def build(scene: Scene) -> None:
    """Sets lake and dock, lets the birds act, lights the morning and places the cameras."""
    shore = lake.Shore(
        seed=scene.rng("shore").randrange(1 << 30), water_m=WATER_M, shore_x_m=-2.35, hill_height_m=9.0
    )
    _lakeside(scene, shore)
    marks = _landmarks(scene)
    _gulls(scene, marks["dish"])
    _ducks(scene, marks["tray"])
    _light(scene)
    scene.cameras(
        (0.12, 0.24, 0.22),
        radius_m=2.65,
        heights_m=(1.02, 1.42, 1.22),
        arc_deg=112.0,
        facing_deg=-92.0,
        fov_deg=48.0,
    )


# --- the place --------------------------------------------------------------------------------------------


def _lakeside(scene: Scene, shore: lake.Shore) -> None:
    """Land, water and what grows: none of it annotated but the reeds."""
    rng = scene.rng("lakeside")

    def dry(x: float, y: float) -> float:
        return 1.0 if shore.depth_into_lake(x, y) < -0.12 else 0.0

    scene.make("ground.grass", "turf", terrain=shore, tufts=420, radius_m=7.5, keep=dry)
    scene.make(
        "ground.grass", "meadow", terrain=shore, tufts=420, radius_m=11.0, length_m=(0.16, 0.42), keep=dry
    )
    scene.make(
        "ground.stones",
        "stones",
        terrain=shore,
        count=900,
        radius_m=9.0,
        size_m=(0.02, 0.11),
        keep=lambda x, y: 1.0 if -1.1 < shore.depth_into_lake(x, y) < 0.25 else 0.0,
    )
    scene.make("ground", "land", terrain=shore, radius_m=92.0)
    scene.make("lake.water", "lake", shore=shore)
    pads = [(2.15, 1.75), (2.75, 1.20), (1.05, 2.60), (2.3, 0.2), (3.2, 2.4)]
    scene.make("lake.lily_pads", "lily_pads", spots=pads, water_m=WATER_M)

    trees = [scene.make("tree", f"tree_model_{k}", scene.rng(f"tree{k}"), height_m=7.0) for k in range(2)]
    spots = [(-6.4, 6.8), (-8.8, 2.6), (-10.5, 9.0), (-7.8, 12.5), (-7.2, -2.4), (-13.0, 4.5)]
    scatter(scene, "tree", trees, spots, rng, on=shore, scale=(0.8, 1.15))
    bushes = [scene.make("tree.bush", f"bush_model_{k}", scene.rng(f"bush{k}")) for k in range(2)]
    spots = [(-4.6, 3.4), (-5.2, 0.9), (-4.4, 5.6), (-5.4, -1.8), (-6.1, 4.4)]
    scatter(scene, "bush", bushes, spots, rng, on=shore, scale=(0.8, 1.3))
    woods = [scene.make("tree.far_wood", f"wood_model_{k}", scene.rng(f"wood{k}")) for k in range(2)]
    ring = skyline(rng, 15, (-8.0, 168.0), (46.0, 66.0))
    scatter(
        scene,
        "wood",
        woods,
        ring,
        rng,
        on=shore,
        sunk_m=0.3,
        scale=(0.8, 1.4),
        turn_deg=NEARLY,
        turn_first=True,
    )


def _landmarks(scene: Scene) -> dict[str, Instance]:
    tray = scene.put("bird_feeder.seed_tray", "seed_tray", TRAY, degrees(0.25), rng=scene.rng("seeds"))
    post = scene.put("dock.mooring_post", "mooring_post", POST, rng=scene.rng("post"))
    scene.put("dock.rope_coil", "rope_coil", (0.74, -0.42), degrees(2.4), rng=scene.rng("coil"))
    return {
        "dish": scene.add(1001, "bird_feeder.water_dish", "water_dish", DISH, glaze=GLAZE),
        "tray": scene.instance("seed_tray", 1002, "tray", tray),
        "dock": scene.add(1003, "dock", "dock", x_range=DECK_X, half_width_m=HALF_WIDTH_M),
        "post": scene.instance("mooring_post", 1004, "post", post),
        "boat": scene.add(1005, "rowing_boat", "rowing_boat", BOAT, degrees(1.42), colour=BOAT_COLOUR),
        "reeds": scene.add(
            1006,
            "reeds",
            "reeds",
            clumps=[
                (-2.55, 2.5, 0.5, 170),
                (-2.0, 3.1, 0.5, 150),
                (-2.9, 1.55, 0.35, 90),
                (-1.3, 3.6, 0.45, 110),
            ],
            foot_m=WATER_M - 0.12,
        ),
    }


# --- those who act ----------------------------------------------------------------------------------------


def _towards(a: Vector, b: Vector) -> float:
    """The heading in degrees of one who stands at a and faces b."""
    return degrees(math.atan2(b.x - a.x, a.y - b.y))


def _bird(scene: Scene, name: str, id: int, look: str, at: Vector, heading_deg: float) -> WaterBird:
    is_duck = look in ("drake", "duck_hen")
    return WaterBird(
        scene,
        name,
        id,
        species=waterbird.DUCK if is_duck else waterbird.GULL,
        plumage=look,
        category="duck" if is_duck else "bird",
        attributes=LOOKS[look],
        at=at,
        heading_deg=heading_deg,
    )


def _at_dish(way_deg: float) -> tuple[Vector, Vector]:
    """(where to stand, where to dip the bill) on the side of the dish that lies in a direction."""
    out = Vector((math.cos(math.radians(way_deg)), math.sin(math.radians(way_deg)), 0.0))
    dip = DISH + 0.062 * out
    return dip + REACH_M * out, dip + Vector((0.0, 0.0, bird_feeder.WATER_Z_M - 0.004))


def _gulls(scene: Scene, dish: Instance) -> None:
    """The dish passes from the first drinker to the last; the one that lands only stands there."""
    spot, dip = _at_dish(168.0)
    first = _bird(scene, "gull_first_drinker", 1, TWINS, spot, _towards(spot, DISH))
    first.drink(dish, dip, 0, 40)
    first.turn(degrees(-1.85), 41, 55)
    away = keys.Path([spot, spot + Vector((-0.34, 0.10, 0.0)), Vector((-0.93, 0.30, 0.0))])
    first.walk(away, 56, 88)
    first.pause(89, LAST_FRAME)
    first.finish()

    landing = DISH + Vector((-0.09, 0.47, 0.0))
    lander = _bird(scene, "gull_landing", 2, TWINS, landing, 0.0)
    way = [
        landing + Vector(p) for p in ((0.66, 1.08, 0.54), (0.36, 0.66, 0.34), (0.0, 0.17, 0.07), (0, 0, 0))
    ]
    lander.glide_in(way, 0, 32, 54)
    lander.stand(55, LAST_FRAME)
    lander.finish()

    spot, dip = _at_dish(12.0)
    bend = spot + 0.9 * (spot - dip)
    bend.z = spot.z
    come = keys.Path([WAIT, WAIT.lerp(bend, 0.35), bend, spot])
    last = _bird(scene, "gull_last_drinker", 3, THIRD, WAIT, _towards(WAIT, bend))
    last.pause(0, 20)
    last.walk(come, 21, 52)
    last.pause(53, 57)
    last.drink(dish, dip, 58, LAST_FRAME)
    last.finish()


def _ducks(scene: Scene, tray: Instance) -> None:
    way = keys.Path(
        [(-0.28, 1.44, 0.0), (0.12, 1.56, 0.0), (0.50, 1.60, 0.0), (0.80, 1.56, 0.0), (1.02, 1.44, 0.0)]
    )
    afloat = Vector((0.0, 0.0, WATER_M - DRAFT_M))
    course = keys.Path([way.point(way.length * k / 12) + afloat for k in range(13)])
    start = course.tangent(0.0)
    drake = _bird(
        scene, "duck_swimming", 4, "drake", course.point(0.0), degrees(math.atan2(start.x, -start.y))
    )
    wake = lake.wake("wake")
    drake.rest(0, 13)
    drake.swim(course, 14, 78, wake)
    drake.rest(79, LAST_FRAME)
    drake.finish()

    seeds = TRAY + Vector((0.02, -0.03, bird_feeder.SEED_Z_M))
    place = seeds + DUCK_REACH_M * Vector((math.cos(2.75), math.sin(2.75), 0.0))
    place.z = 0.0
    eater = _bird(scene, "duck_eating", 5, "duck_hen", place, _towards(place, seeds))
    eater.stand(0, 15)
    eater.eat(tray, seeds, 16, 72)
    eater.stand(73, LAST_FRAME)
    eater.finish()


def _light(scene: Scene) -> None:
    """A clear, cool morning: the sun low on the right, sky light from the lake."""
    azimuth, elevation = SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG
    scene.sky(sun_elevation_deg=elevation, sun_azimuth_deg=azimuth, strength=0.20, haze=2.0)
    scene.sun(
        elevation_deg=elevation, azimuth_deg=azimuth, strength=3.6, angle_deg=1.0, colour=(1.0, 0.92, 0.80)
    )
