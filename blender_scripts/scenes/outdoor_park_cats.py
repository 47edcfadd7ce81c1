"""On a park path in the evening a woman on her heels strokes a cat beside her, then another that comes
along and sits down before her, while a third gets up from under a lamp and walks past. Another woman walks
by and makes a phone call.

The first cat and the one that walks past are twins: who is stroked and who walks tells them apart. The
strokes pass from the first cat to the one that comes.
"""

from __future__ import annotations

import math
from math import degrees

from mathutils import Vector

from l4d_blender.assets import cat, ground, park_lamp
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import cat_friends, travellers
from l4d_blender.motion.people import Person
from l4d_blender.scene.placing import Spot
from l4d_blender.scene.scattering import scatter, skyline
from l4d_blender.scene.scene import Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "outdoor"

BENCH = Vector((-1.42, 0.98, 0.0))
BENCH_HEADING_DEG = degrees(0.19)
LAMP = Vector((1.42, 1.12, 0.0))
TREE = Vector((2.75, 2.55, 0.0))
FRIEND = (0.16, 0.42)
FIRST_CAT = ((0.50, 0.10), degrees(-0.25))
SECOND_SPOT = (-0.24, 0.0)
PASSER_CAT = ((1.22, 0.30), degrees(-0.55))

LOOKS = {
    "grey_tabby": {"colour": "grey", "pattern": "striped"},
    "orange": {"colour": "orange", "pattern": "white_bib"},
    "black": {"colour": "black", "pattern": "plain"},
}


TOP = "light_blue"
DRESS = "red"
SUN_AZIMUTH_DEG = -152.0
SUN_ELEVATION_DEG = 19.0


def build(scene: Scene) -> None:
    """Sets the park, lets cats and women act, lights the dusk and places the cameras."""
    _park(scene)
    _landmarks(scene)
    _act(scene)
    _light(scene)
    scene.cameras(
        (0.06, 0.12, 0.62),
        radius_m=3.40,
        heights_m=(1.05, 1.60, 1.32),
        arc_deg=118.0,
        facing_deg=-90.0,
        fov_deg=47.0,
    )


# --- the place --------------------------------------------------------------------------------------------


def _park(scene: Scene) -> None:
    """A trodden path through grass, flower beds, trees: none of it annotated."""
    terrain = ground.Terrain(
        seed=scene.rng("terrain").randrange(1 << 30),
        paths=[
            ground.Path([(-30.0, 1.6), (-7.0, 0.2), (0.0, 0.10), (6.0, 0.6), (30.0, 7.0)], 1.05),
            ground.Path([(0.4, 0.6), (0.9, 3.5), (-1.5, 9.0), (-3.0, 30.0)], 0.75),
        ],
        level_radius_m=5.0,
        hills_from_m=30.0,
        hill_height_m=4.0,
    )
    rng = scene.rng("park")
    scene.make("ground.grass", "lawn", terrain=terrain, tufts=2400, radius_m=9.0, length_m=(0.03, 0.075))

    def rim(x: float, y: float) -> float:
        at_feet = min(math.hypot(x - p.x, y - p.y) for p in (LAMP, TREE, BENCH))
        return 1.0 if at_feet < 0.40 else 0.05

    scene.make(
        "ground.grass", "uncut", terrain=terrain, tufts=330, radius_m=10.0, length_m=(0.10, 0.26), keep=rim
    )
    scene.make(
        "ground.stones",
        "pebbles",
        terrain=terrain,
        count=1300,
        radius_m=6.0,
        size_m=(0.006, 0.022),
        keep=terrain.wear,
    )
    scene.make("ground", "ground", terrain=terrain)

    trees = [scene.make("tree", f"tree_model_{k}", scene.rng(f"tree{k}"), height_m=7.4) for k in range(2)]
    spots = [
        (-3.9, 4.9),
        (-6.8, 2.6),
        (0.9, 9.6),
        (5.6, 6.4),
        (-2.6, 11.0),
        (7.4, 1.4),
        (-8.4, 8.2),
        (-7.6, -2.8),
        (8.4, -3.6),
    ]
    scatter(scene, "tree", trees, spots, rng, on=terrain, scale=(0.85, 1.2))
    bushes = [
        scene.make(
            "tree.bush", f"bush_model_{k}", scene.rng(f"bush{k}"), size_xyz=(1.3, 0.9, 0.75), tone=tone
        )
        for k, tone in enumerate([(0.070, 0.120, 0.028), (0.16, 0.045, 0.075), (0.10, 0.13, 0.05)])
    ]
    spots = [
        (-2.9, 2.5),
        (-1.7, 2.7),
        (-0.6, 2.55),
        (2.0, 3.2),
        (3.4, 3.4),
        (4.6, 2.6),
        (-4.2, 1.9),
        (-5.0, 3.6),
        (3.1, 5.2),
    ]
    scatter(scene, "bush", bushes, spots, rng, on=terrain, scale=(0.75, 1.15))
    woods = [scene.make("tree.far_wood", f"wood_model_{k}", scene.rng(f"wood{k}")) for k in range(2)]
    ring = (at for at, _ in skyline(rng, 12, (-15.0, 195.0), (32.0, 50.0)))
    scatter(scene, "wood", woods, ring, rng, on=terrain, scale=(0.8, 1.2))
    scene.make("fence", "rails", line=[(-7.0, 5.6), (-2.2, 6.4)], post_m=0.8, rails=2)
    scene.put("street_furniture.litter_bin", "litter_bin", (-2.72, 1.05))
    scene.put("street_furniture.planter", "planter", (2.15, 1.75))


def _landmarks(scene: Scene) -> None:
    scene.add(1001, "street_bench", "bench", BENCH, BENCH_HEADING_DEG)
    scene.add(1002, "park_lamp", "lamp_post", LAMP)
    scene.add(1003, "tree", "tree", TREE, rng=scene.rng("old_tree"), height_m=6.6)


# --- those who act ----------------------------------------------------------------------------------------


def _act(scene: Scene) -> None:
    """Stroking passes from the first cat to the one that comes; the twin only walks past."""

    def animal(name: str, id: int, coat: cat.Coat, spot: Spot, posture: str) -> cat_friends.FriendlyCat:
        return cat_friends.FriendlyCat(
            scene,
            name,
            id,
            coat=coat,
            at=spot[0],
            heading_deg=spot[1],
            posture=posture,
            attributes=LOOKS[coat.name],
        )

    first = animal("cat_stroked_first", 1, cat.GREY_TABBY, FIRST_CAT, "sit")
    passer = animal("cat_passing", 2, cat.GREY_TABBY, PASSER_CAT, "sit")
    comer = animal("cat_coming", 3, cat.ORANGE, ((-1.02, -0.46), degrees(1.25)), "stand")

    comer.walk_along([(-0.58, -0.32), SECOND_SPOT], (12, 48))
    comer.sit_down((48, 58))
    comer.sit((58, LAST_FRAME))

    friend = Person(
        scene,
        "woman_crouching",
        4,
        category="woman",
        look=_friend_look(scene),
        attributes={"top": TOP, "pattern": "checked", "hair": "bun", "bottom": "trousers"},
        at=FRIEND,
        heading_deg=degrees(0.10),
    )
    cat_friends.squat(friend)
    cat_friends.stroke(friend, first, (4, 42), side="l")
    cat_friends.stroke(friend, comer, (58, 92), side="r")
    friend.finish()

    first.sit((0, LAST_FRAME))
    first.lean_in((14, 36))
    first.watch(Vector((-0.35, -0.35, 0.25)), (44, LAST_FRAME), ease_frames=12)
    comer.lean_in((68, 84), roll=-0.10)

    passer.sit((0, 24))
    passer.stand_up((24, 33))
    passer.walk_along([(1.08, -0.16), (0.72, -0.60), (0.20, -0.80)], (33, 86))
    for one in (first, passer, comer):
        one.finish()

    walker = Person(
        scene,
        "woman_phoning",
        5,
        category="woman",
        look=_walker_look(scene),
        attributes={"top": DRESS, "pattern": "dotted", "hair": "ponytail", "bottom": "dress"},
        at=(1.70, 1.62),
        heading_deg=degrees(-1.5),
    )
    walker.walk_along([(0.80, 1.58), (-0.12, 1.34)], (0, 48), facing_deg=degrees(-0.45))
    travellers.phone(walker, (70, LAST_FRAME))
    walker.finish()


def _friend_look(scene: Scene) -> Look:
    return Look(
        build="woman",
        height_m=1.66,
        skin="fair",
        hair="bun",
        hair_colour="red",
        top=Cloth(TOP, "checks", repeat_m=0.07),
        sleeve="long",
        bottom="trousers",
        lower=Cloth("navy"),
        shoes="shoes",
        shoe_colour="black",
        seed=scene.rng("friend").randrange(1000),
    )


def _walker_look(scene: Scene) -> Look:
    return Look(
        build="woman",
        height_m=1.71,
        skin="brown",
        hair="ponytail",
        hair_colour="black",
        bottom="dress",
        sleeve="elbow",
        lower=Cloth(DRESS, "dots", repeat_m=0.05),
        shoes="boots",
        shoe_colour="brown",
        seed=scene.rng("walker").randrange(1000),
    )


def _light(scene: Scene) -> None:
    """The sun is nearly down on the left; the lamp adds its own warmth."""
    azimuth, elevation = SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG
    scene.exposure = 1.5
    scene.sky(sun_elevation_deg=elevation - 9.0, sun_azimuth_deg=azimuth, strength=0.21, haze=2.5)
    scene.sun(
        elevation_deg=elevation, azimuth_deg=azimuth, strength=6.2, angle_deg=2.2, colour=(1.0, 0.68, 0.42)
    )
    scene.point_light(
        "lamp_glow",
        (LAMP.x, LAMP.y, park_lamp.LANTERN_Z_M + 0.6),
        power_w=60.0,
        radius_m=0.18,
        colour=(1.0, 0.72, 0.42),
    )
