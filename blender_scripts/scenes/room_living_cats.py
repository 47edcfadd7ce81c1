"""Three cats in a sunny living room: one sleeps, one plays with a ball of wool, one comes and takes over.

Story. Two of the three cats are twins (grey tabbies; the third is orange and white), and so are
two red balls of wool. One twin lies curled up asleep on the sofa. The other sits by the window, gets up, then
walks across the rug and settles before a ball. Meanwhile the third cat bats that ball to and fro between its
paws and knocks it away over the rug; it rolls to where the walker arrives, who bats it in turn, while the
first player sits down and looks on. The twin ball lies still under the low table, a toy mouse on the rug. By
looks alone neither twin cat and neither ball can be told from the other, and who plays with the ball depends
on the time.

Axes: the floor is z = 0, the sofa's wall at +Y, cameras on the -Y side; metres; a heading of 0 faces -Y.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, degrees, radians, sin

import bpy

from l4d_blender.assets import cat, coffee_table, floor_lamp, rug, sofa
from l4d_blender.assets.materials import interior
from l4d_blender.motion.ball_games import Ball
from l4d_blender.motion.cats import Cat, Ground, Tap, level
from l4d_blender.scene.placing import Loose, Spot
from l4d_blender.scene.scene import Scene
from l4d_blender.scene.timeline import LAST_FRAME

SCALE = "room"

BACK_WALL_Y = 1.50
HALF_WIDTH = 3.1
FRONT_Y = -3.2

# Where things stand: x, y in metres, heading in degrees.
SOFA = ((-0.68, 1.05), 0.0)
LOW_TABLE = ((-0.42, 0.16), 0.0)
RUG = (0.06, -0.12)
WINDOW_X = 1.02
BOOKCASE = ((-2.06, 1.34), 0.0)
ARMCHAIR = ((1.86, 0.42), degrees(-1.15))
LAMP = ((0.40, 1.27), 0.0)
PLANT = ((1.95, 1.20), 0.0)
CAT_TREE = ((-2.15, 0.40), degrees(0.5))
BALL_UNDER_TABLE = (-0.40, 0.10)
TOY_MOUSE = ((0.76, -0.34), degrees(-0.5))
SLEEPER = ((-0.36, 0.90), degrees(-1.15))
WALKER = ((0.90, 0.88), degrees(-0.35))
PLAYER = ((-0.66, -0.40), degrees(0.60))

BALL_RADIUS_M = 0.076
REACH_M = 0.295  # from the middle of a poised cat to the ball that it bats
RUG_TOP_M = rug.THICKNESS_M
RUG_SIZE_M = (2.15, 1.50)


COLOURS = {
    "grey_tabby": {"colour": "grey", "pattern": "striped"},
    "orange": {"colour": "orange", "pattern": "white_bib"},
    "black": {"colour": "black", "pattern": "plain"},
}


class Stage:
    """The layout, everything a few centimetres off."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.jitter = scene.rng("stage")

    def spot(self, spot: Spot, loose_m: float = 0.02) -> Spot:
        """A spot near that of the layout."""
        return Loose(self.jitter, loose_m, degrees(2 * loose_m))(spot)


def build(scene: Scene) -> None:
    """Sets the stage, lets the cats act, lights it and places the cameras."""
    stage = Stage(scene)
    furnish(stage)
    toys = put_toys(stage)
    let_cats_play(stage, toys)
    light(stage)
    scene.cameras(
        (0.02, 0.20, 0.33),
        radius_m=2.68,
        heights_m=(1.15, 1.50, 0.95, 1.35),
        arc_deg=110,
        facing_deg=-90,
        fov_deg=47,
    )


def furnish(stage: Stage) -> None:
    """The room, its furniture as landmarks, and the clutter that nobody asks about."""
    scene, rng = stage.scene, stage.scene.rng("furniture")
    scene.make(
        "room",
        "room",
        rng,
        half_width_m=HALF_WIDTH,
        back_m=BACK_WALL_Y,
        front_m=FRONT_Y,
        wall=(0.44, 0.47, 0.38),
        figure=(0.58, 0.60, 0.50),
    )

    couch_at = stage.spot(SOFA)
    couch = scene.put("sofa", "sofa_body", *couch_at, rng=rng, colour=(0.10, 0.19, 0.21))
    scene.instance("sofa", 1001, "sofa", [couch, *cushions(stage, couch_at)], front="-y")

    table_at = stage.spot(LOW_TABLE)
    scene.add(1002, "coffee_table", "low_table", *table_at, rng=rng, size_m=(0.84, 0.48))
    for thing, dx, dy, turn in (
        (scene.make("coffee_table.fruit_bowl", "fruit_bowl", rng), 0.05, 0.03, 0.0),
        (scene.make("coffee_table.mug", "mug", rng, colour=(0.62, 0.24, 0.12)), 0.30, -0.12, 0.8),
        (scene.make("coffee_table.book_stack", "table_books", rng), -0.27, -0.02, 0.3),
    ):
        at = (table_at[0][0] + dx, table_at[0][1] + dy)
        scene.place(thing, at, degrees(turn), on=coffee_table.HEIGHT_M)

    scene.add(1003, "rug", "rug", (RUG[0], RUG[1]), rng=rng, size_m=RUG_SIZE_M, palette=rug.PALETTES[0])

    scene.add(1004, "window", "window", (WINDOW_X, BACK_WALL_Y), rng=rng, curtain=(0.62, 0.45, 0.22))

    scene.add(1005, "bookcase", "bookcase", *stage.spot(BOOKCASE, 0.01), rng=rng)
    scene.add(1006, "armchair", "armchair", *stage.spot(ARMCHAIR), rng=rng, colour=(0.52, 0.30, 0.07))

    scene.put("floor_lamp", "floor_lamp", *stage.spot(LAMP), rng=rng)
    scene.put("houseplant", "plant", *stage.spot(PLANT), rng=rng)
    scene.put(
        "houseplant",
        "small_plant",
        *stage.spot(((-2.62, 1.05), 0.0)),
        rng=rng,
        height_m=0.55,
        stems=8,
        pot=(0.45, 0.16, 0.08),
    )
    scene.put("cat_tree", "cat_tree", *stage.spot(CAT_TREE), rng=rng)
    for k, (x, z, size) in enumerate(
        ((-1.16, 0.97, (0.36, 0.46)), (-0.68, 1.02, (0.44, 0.34)), (-0.20, 0.97, (0.34, 0.44)))
    ):
        scene.put("picture_frame", f"picture_{k}", (x, BACK_WALL_Y, z), rng=rng, size_m=size, palette=k)


def cushions(stage: Stage, couch: Spot) -> list[bpy.types.Object]:
    """Scatter cushions that lean on the sofa's back and arms."""
    rng = stage.scene.rng("cushions")
    stripes = interior.striped_cloth("cushion_stripes", ((0.62, 0.55, 0.42), (0.45, 0.12, 0.07)), rng)
    plain = interior.cloth("cushion_plain", (0.58, 0.36, 0.08), rng)
    pale = interior.cloth("cushion_pale", (0.60, 0.56, 0.48), rng)
    made = []
    for k, (cloth, dx, dy, turn, size) in enumerate(
        (
            (stripes, -0.55, 0.03, 0.45, 0.40),
            (plain, -0.33, 0.09, -0.10, 0.36),
            (pale, 0.57, 0.05, -0.55, 0.38),
        )
    ):
        pillow = stage.scene.make("cushion", f"cushion_{k}", rng, size_m=(size, size), material=cloth)
        at = (couch[0][0] + dx, couch[0][1] + dy, sofa.SEAT_HEIGHT_M - 0.005)
        heading_deg, tilt_deg = degrees(turn), -rng.uniform(16, 22)
        made.append(stage.scene.place(pillow, at, heading_deg, tilt_deg=tilt_deg))
    return made


@dataclass(frozen=True)
class Toys:
    """The two balls: one that is played with, one that lies under the table."""

    played: Ball
    still: Ball


def put_toys(stage: Stage) -> Toys:
    """Two equal balls of wool and a toy mouse; the first ball lies within reach of the player's paws."""
    scene = stage.scene
    ball_at = ahead_of(stage, PLAYER)
    spin = scene.rng("spin")
    balls = []
    for name, id, (x, y), floor in (
        ("yarn_ball_played", 4, ball_at, RUG_TOP_M),
        ("yarn_ball_still", 5, (BALL_UNDER_TABLE[0], BALL_UNDER_TABLE[1]), RUG_TOP_M),
    ):
        toy = scene.add(
            id,
            "yarn_ball",
            name,
            (0.0, 0.0),
            attributes={"kind": "yarn_ball", "colour": "red"},
            rng=scene.rng("wool"),
            radius_m=BALL_RADIUS_M,
        )
        balls.append(Ball(toy, BALL_RADIUS_M, (x, y), floor, turn=spin.uniform(0, 6)))
    scene.add(
        6,
        "toy_mouse",
        "toy_mouse",
        *stage.spot(TOY_MOUSE),
        attributes={"kind": "mouse", "colour": "grey"},
        on=RUG_TOP_M,
    )
    return Toys(*balls)


def ahead_of(stage: Stage, spot: Spot, aside_m: float = 0.0) -> tuple[float, float]:
    """Where a cat poised at a spot of the layout has a ball before its paws (`aside_m` to its left)."""
    (x, y), heading = spot[0], radians(spot[1])
    return (
        x + REACH_M * sin(heading) + aside_m * cos(heading),
        y - REACH_M * cos(heading) + aside_m * sin(heading),
    )


def let_cats_play(stage: Stage, toys: Toys) -> None:
    """The action, in the order of time: batting, the long roll, the walk, the second player."""
    scene, ball = stage.scene, toys.played

    def animal(name: str, id: int, coat: cat.Coat, spot: Spot, posture: str, ground: Ground) -> Cat:
        (x, y), heading_deg = spot
        return Cat(
            scene,
            name,
            id,
            coat=coat,
            at=(x, y),
            heading_deg=heading_deg,
            ground=ground,
            posture=posture,
            attributes=COLOURS[coat.name],
        )

    def on_floor(x: float, y: float) -> float:
        on_rug = abs(x - RUG[0]) < RUG_SIZE_M[0] / 2 and abs(y - RUG[1]) < RUG_SIZE_M[1] / 2
        return RUG_TOP_M if on_rug else 0.0

    sleeper = animal("cat_sleeper", 1, cat.GREY_TABBY, SLEEPER, "sleep", level(sofa.SEAT_HEIGHT_M - 0.004))
    walker = animal("cat_walker", 2, cat.GREY_TABBY, WALKER, "sit", on_floor)
    player = animal("cat_player", 3, cat.ORANGE, PLAYER, "poise", on_floor)

    sleeper.sleep((0, LAST_FRAME))

    near, far = ahead_of(stage, PLAYER, -0.045), ahead_of(stage, PLAYER, 0.055)
    rest = ahead_of(stage, PLAYER, 0.70)
    ball.place(far)
    player.play_with(
        ball,
        [
            Tap(6, "fore.L", near, 17),
            Tap(17, "fore.R", far, 28),
            Tap(28, "fore.L", near, 39),
            Tap(39, "fore.R", rest, 68),
        ],
        (0, 46),
    )

    (start, _), goal = WALKER, (0.36, 0.02)
    toward = atan2(rest[0] - goal[0], goal[1] - rest[1])
    stop = (rest[0] - REACH_M * sin(toward), rest[1] + REACH_M * cos(toward))
    walker.sit((0, 13))
    walker.stand_up((13, 23))
    walker.walk_along(
        [((0.5 * start[0] + 0.5 * stop[0] + 0.08), 0.5 * start[1] + 0.5 * stop[1]), (stop[0], stop[1])],
        (23, 66),
    )
    walker.poise((66, 75))
    left = ahead_of(stage, (stop, degrees(toward)), 0.10)
    walker.play_with(ball, [Tap(76, "fore.R", left, 86), Tap(86, "fore.L", rest, 96)], (72, LAST_FRAME))

    player.sit_down((56, 72))
    player.watch(ball.centres, (46, LAST_FRAME), event_object=ball.instance)
    player.sit((72, LAST_FRAME))
    for actor in (sleeper, walker, player, ball, toys.still):
        actor.finish()


def light(stage: Stage) -> None:
    """Daylight from the window, a sunbeam on the rug, the house from the open side, a warm lamp."""
    scene = stage.scene
    scene.exposure = 1.12
    scene.hdri("interior", strength=0.46, rotation_deg=degrees(1.2))
    scene.area_light(
        "window_light",
        (WINDOW_X, BACK_WALL_Y - 0.22, 1.35),
        (0.2, -0.5, 0.1),
        size_m=(1.0, 1.2),
        power_w=13,
        colour=(0.92, 0.96, 1.0),
    )
    patch = scene.area_light(
        "sunbeam",
        (2.1, 1.2, 2.6),
        (0.35, -0.25, 0.0),
        size_m=(0.7, 0.9),
        power_w=13,
        colour=(1.0, 0.83, 0.58),
    )
    patch.data.spread = radians(26)
    lamp_x, lamp_y = LAMP[0]
    scene.point_light(
        "lamp_glow", (lamp_x, lamp_y - 0.02, floor_lamp.SHADE_HEIGHT_M - 0.2), power_w=5, radius_m=0.12
    )
