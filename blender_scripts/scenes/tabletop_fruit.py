"""Apples on a kitchen table: one is pushed and rolls away, one is taken from the bowl, laid down and rolls.

Story. Two red apples are twins, each with a leaf; two are green, one of them bitten, the other small and
without its leaf. One red and one green apple lie in the bowl, one of each on the tea towel. The right hand
sends the green one rolling from the towel, then takes the red one beside it and turns it on the spot. The
left hand lifts the red apple out of the bowl and lays it on the table, where it rolls in its turn; the green
one left in the bowl rocks. So colour, place and rolling each hold for two, and any two of them for one.

Axes: the table top is z = 0; who sits there is at +Y and faces -Y, so the right hand is at -X; the window is
at -X.
"""

from __future__ import annotations

from math import degrees

from mathutils import Matrix, Vector

from l4d_blender.assets import apple, dining_table, fruit, kitchen_units, wooden_chair
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.person import Cloth
from l4d_blender.motion.rolling import Roller, Round, rock, roll
from l4d_blender.scene.placing import Loose, pose
from l4d_blender.scene.scene import Scene

SCALE = "tabletop"

FLOOR_M = -dining_table.HEIGHT_M
TABLE = (0.05, -0.01)
TABLE_M = (1.45, 0.86)
PULLOVER = (0.40, 0.36, 0.28)
TOWEL_M = 0.0018

# x, y in metres, heading in degrees.
BOWL = (0.215, 0.145)
TOWEL = ((-0.215, 0.105), 6)
BOARD = ((0.235, -0.235), -14)
JUG = ((-0.405, 0.285), 60)
LOAF = ((0.46, 0.02), 62)

# The apples, and where those that roll come to rest.
RED_IN_BOWL = (-0.062, 0.020)  # from the middle of the bowl
GREEN_IN_BOWL = (0.040, -0.052)
RED_ON_TOWEL = (-0.275, 0.085)
GREEN_ON_TOWEL = (-0.140, 0.150)
GREEN_ROLLS = ((-0.135, 0.06), (-0.105, -0.06), (-0.070, -0.185))
LAID_DOWN = (-0.012, 0.105)
RED_ROLLS = ((-0.006, 0.04), (0.020, -0.065))

HAND_RIGHT = ((-0.175, 0.535, 0.25), (-0.20, 0.34, 0.0))
HAND_LEFT = ((0.175, 0.535, 0.25), (0.325, 0.365, 0.0))

PLAIN = {"state": "whole", "size": "large"}
LOOKS = {
    "red": (apple.RED, {"colour": "red"}),
    "green": (apple.GREEN, {"colour": "green"}),
    "yellow": (apple.YELLOW, {"colour": "yellow"}),
}


TWINS = "red"
OTHERS = "green"
DAYLIGHT = (1.0, 0.90, 0.74)
BOWL_GLAZE = (0.06, 0.11, 0.22)
TOWEL_STRIPE = (0.40, 0.09, 0.06)


def build(scene: Scene) -> None:
    """Lays things out in the kitchen; the story happens in `_right_hand` and `_left_hand`."""
    _kitchen(scene)
    _light(scene)
    loose = Loose(scene.rng("layout"), 0.005, 4.0)
    _landmarks(scene, loose)
    _fruit(scene)
    apples = _apples(scene, loose)
    _right_hand(scene, apples)
    _left_hand(scene, apples)
    scene.cameras(
        (-0.01, 0.015, 0.04), radius_m=0.82, heights_m=(0.46, 0.59), arc_deg=128, facing_deg=-84, fov_deg=48
    )


def _kitchen(scene: Scene) -> None:
    """Room, units along the wall, table, chair, and whoever sits there."""
    rng = scene.rng("kitchen")
    finish = kitchen_units.Finish(front=(0.30, 0.36, 0.36), stone=(0.36, 0.31, 0.25))
    room = scene.make(
        "study_room",
        "room",
        rng,
        wall_y_m=2.05,
        window_x_m=(-1.25, 0.05),
        sill_m=1.06,
        wall=(0.60, 0.55, 0.45),
    )
    units = scene.make("kitchen_units.base_run", "units", rng, width_m=3.4, finish=finish, sink_x=-0.6)
    basin = scene.make("kitchen_units.sink", "basin", rng)
    top = FLOOR_M + kitchen_units.TOP_M
    scene.place(room, (0.0, 0.0), on=FLOOR_M)
    scene.place(units, (0.0, 2.04), on=FLOOR_M)
    scene.place(basin, (-0.6, 2.04), on=top)
    scene.put(
        "kitchen_clutter.kettle", "kettle", (0.75, 1.75), 140, on=top, rng=rng, colour=(0.50, 0.10, 0.06)
    )
    scene.put(
        "kitchen_clutter.plate_stack", "plates", (0.25, 1.78), on=top, rng=rng, colour=(0.62, 0.60, 0.54)
    )
    scene.put("kitchen_clutter.herb_pot", "basil", (-1.15, 1.80), on=top, rng=rng)
    for k, colour in enumerate(((0.42, 0.23, 0.08), (0.60, 0.52, 0.36), (0.22, 0.09, 0.04))):
        scene.put("kitchen_clutter.jar", f"jar{k}", (1.15 + 0.17 * k, 1.84), on=top, rng=rng, content=colour)
    scene.put(
        "dining_table",
        "table",
        TABLE,
        rng=rng,
        size_m=TABLE_M,
        light=(0.56, 0.40, 0.22),
        dark=(0.36, 0.22, 0.10),
    )
    scene.put("wooden_chair", "chair", (0.0, 0.59), on=FLOOR_M, rng=rng)
    scene.put("wooden_chair", "other_chair", (-0.95, 0.62), 68, on=FLOOR_M, rng=rng)
    scene.put(
        "sitter",
        "sitter",
        (0.0, 0.55),
        on=FLOOR_M + wooden_chair.SEAT_M,
        rng=rng,
        pullover=products.knit("pullover", PULLOVER, rng),
    )


def _light(scene: Scene) -> None:
    """Low morning light from a window on the left, the rest of the kitchen as fill."""
    scene.hdri("interior", 0.24, rotation_deg=degrees(2.4))
    scene.area_light(
        "morning", (-1.55, -0.25, 0.78), (0.05, 0.05, 0.0), size_m=(0.5, 0.7), power_w=78, colour=DAYLIGHT
    )
    scene.area_light(
        "window", (-0.6, 1.9, 0.9), (0.0, 0.2, 0.0), size_m=(1.2, 0.8), power_w=10, colour=(0.85, 0.93, 1.0)
    )


def _landmarks(scene: Scene, loose: Loose) -> None:
    """Things that sentences mention to say where something is."""
    rng = scene.rng("landmarks")
    stripes = tableware.linen(
        "towel_linen",
        (0.66, 0.63, 0.56),
        rng,
        stripe=TOWEL_STRIPE,
        stripe_at_m=(0.135, 0.146, 0.124),
        stripe_m=0.005,
    )
    towel = scene.make("dining_table.runner", "towel", rng, material=stripes, size_m=(0.34, 0.25))
    jug = scene.make("kitchen_jug", "jug", rng, colour=(0.55, 0.50, 0.40))
    for id_, name, category, obj in (
        (
            1001,
            "fruit_bowl",
            "bowl",
            scene.put("fruit.fruit_bowl", "fruit_bowl", BOWL, 20, rng=rng, glaze=BOWL_GLAZE),
        ),
        (1002, "towel", "towel", scene.place(towel, *TOWEL)),
        (
            1003,
            "board",
            "board",
            scene.put("kitchen_clutter.chopping_board", "board", *loose(BOARD), rng=rng),
        ),
        (1004, "jug", "jug", scene.place(jug, *loose(JUG))),
        (1005, "loaf", "loaf", scene.put("kitchen_clutter.loaf", "loaf", *loose(LOAF), rng=rng)),
    ):
        scene.instance(name, id_, category, obj)


def _fruit(scene: Scene) -> None:
    """What else lies in the bowl and about it."""
    rng = scene.rng("fruit")
    x, y = BOWL
    floor = fruit.BOWL_FLOOR_M
    scene.put("fruit.orange", "orange", (x + 0.058, y + 0.040), on=floor, rng=rng)
    scene.put(
        "fruit.orange", "second_orange", (x - 0.012, y + 0.086), 80, on=floor + 0.006, rng=rng, radius_m=0.034
    )
    scene.put("fruit.lemon", "lemon", (x - 0.050, y - 0.068), 35, on=floor + 0.004, rng=rng)
    scene.put("fruit.pear", "pear", (x + 0.102, y - 0.022), 35, on=floor + 0.009, rng=rng)
    scene.put("fruit.grapes", "grapes", (0.47, 0.245), 25, rng=rng)
    scene.put("fruit.lemon", "loose_lemon", (-0.385, -0.185), 130, rng=rng)


def _apples(scene: Scene, loose: Loose) -> dict[str, Round]:
    """Two twins that have their leaves, and two others; those that will roll lie on their sides."""
    skin, colour = LOOKS[TWINS]
    other_skin, other_colour = LOOKS[OTHERS]
    twin = (apple.Look(skin=skin), {**colour, **PLAIN, "leaf": "yes"})
    bitten = (
        apple.Look(skin=other_skin, bitten=True),
        {**other_colour, "state": "bitten", "size": "large", "leaf": "yes"},
    )
    small = (
        apple.Look(skin=other_skin, leaf=False, radius_m=0.0335),
        {**other_colour, "state": "whole", "size": "small", "leaf": "no"},
    )
    made = {}
    for id_, name, (look, attributes) in (
        (1, "apple_from_bowl", twin),
        (2, "apple_on_towel", twin),
        (3, "apple_left_in_bowl", bitten),
        (4, "apple_pushed", small),
    ):
        made[name] = Round(
            scene.add(id_, "apple", name, (0.0, 0.0), attributes=attributes, look=look),
            look.radius_m,
            look.middle,
        )
    x, y = BOWL
    floor = fruit.BOWL_FLOOR_M + 0.0004
    at = (x + RED_IN_BOWL[0], y + RED_IN_BOWL[1], floor)
    poses = {
        "apple_from_bowl": made["apple_from_bowl"].lying(at, 5.0),
        "apple_pushed": made["apple_pushed"].lying((*loose.point(GREEN_ON_TOWEL, 0.4), TOWEL_M), 3.0),
        "apple_on_towel": pose((*loose.point(RED_ON_TOWEL, 0.6), TOWEL_M), 40.0),
    }
    left = made["apple_left_in_bowl"]
    centre = Vector((x + GREEN_IN_BOWL[0], y + GREEN_IN_BOWL[1], floor + left.radius_m))
    poses["apple_left_in_bowl"] = pose(centre, 14.0, tilt_deg=-6.0) @ Matrix.Translation(-left.middle)
    for name, matrix in poses.items():
        made[name].instance.objects[0].matrix_basis = matrix
    return made


def _right_hand(scene: Scene, apples: dict[str, Round]) -> None:
    """Sends one apple rolling with the fingertips, then turns its neighbour on the spot."""
    hand = _hand(scene, "hand_right", 1006, "r", HAND_RIGHT)
    pushed, turned = apples["apple_pushed"], apples["apple_on_towel"]
    middle = pushed.instance.matrix(0) @ pushed.middle
    hand.approach(
        pushed.instance, (0, 13), grip="push", point=middle + Vector((0, 0, 0.004)), heading_deg=4.0
    )
    hand.send_rolling(pushed, list(GREEN_ROLLS), (13, 54), let_go=27)
    stem = turned.instance.matrix(0) @ (turned.middle * 1.95)
    hand.move_to((-0.24, 0.30, 0.0), (37, 52))
    hand.approach(turned.instance, (50, 66), grip="pinch", point=stem)
    hand.twist(turned, 75.0, (67, 88))
    hand.finish()


def _left_hand(scene: Scene, apples: dict[str, Round]) -> None:
    """Lays an apple from the bowl down on its side; let go, it rolls; the one beside it in the bowl rocks."""
    hand = _hand(scene, "hand_left", 1007, "l", HAND_LEFT)
    taken = apples["apple_from_bowl"]
    lying = taken.instance.matrix(0)
    hand.approach(taken.instance, (2, 18), grip="crown", point=lying @ taken.middle)
    hand.lift((18, 32), height_m=0.13)
    shift = Vector((*LAID_DOWN, taken.radius_m)) - lying @ taken.middle
    hand.lay_down(Matrix.Translation(shift) @ lying, (32, 56))
    hand.release((56, 66))
    roll(taken, list(RED_ROLLS), (62, 91), free=72)
    hand.withdraw((66, 84))
    hand.finish()
    rock(apples["apple_left_in_bowl"], Vector((0.9, 0.35, 0.0)), (22, 62), swing_deg=13.0)


def _hand(
    scene: Scene,
    name: str,
    id_: int,
    side: str,
    where: tuple[tuple[float, float, float], tuple[float, float, float]],
) -> Roller:
    """A hand in the sleeve of the sitter's pullover; `where` is the shoulder and where the palm rests."""
    hand = Roller(
        scene,
        name,
        id_,
        side=side,
        look=HandLook(skin="tan", sleeve=Cloth("beige"), cuff="beige", scale=0.92),
        shoulder=where[0],
        rest_at=where[1],
        attributes={"side": "right" if side == "r" else "left"},
    )
    _, sleeve = hand.body.meshes
    knit = f"{name}.knit"
    sleeve.data.materials[0] = products.knit(knit, PULLOVER, scene.rng(knit), along="Y", bends=True)
    return hand
