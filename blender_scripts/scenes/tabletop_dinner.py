"""Dinner by candlelight: a spoon is stirred in the soup and laid on the bread board, another is picked up.

Story. Four spoons: two wooden twins with red handles, two of metal. A wooden one stands in the big soup bowl,
its twin lies on a napkin; a metal one stands in the sauce bowl, the other lies on a napkin. The diner on the
left stirs the soup and lays the spoon on the bread board. The diner on the right slides the plate with the
sauce bowl towards the middle, the spoon in it riding along, then takes the metal spoon from its napkin and
stirs the soup in the plate. So wood, standing in a bowl and going round each hold for two, any two for one.

Axes: the table top is z = 0; the diners sit at -X and +X and face each other; the room behind is at +Y.
"""

from __future__ import annotations

from math import degrees, pi

from mathutils import Matrix, Vector

from l4d_blender.assets import bread_board, candle, cup, dining_table, soup_bowl, spoon, wooden_chair
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.person import Cloth
from l4d_blender.motion.diners import Diner
from l4d_blender.motion.servers import Stirring, spoon_between
from l4d_blender.scene.placing import Loose, pose
from l4d_blender.scene.scene import Instance, Scene

SCALE = "tabletop"

FLOOR_M = -dining_table.HEIGHT_M
SEAT_M = FLOOR_M + wooden_chair.SEAT_M
TABLE = (0.04, 0.05)
TABLE_M = (1.30, 0.98)
LEFT_KNIT = (0.10, 0.13, 0.22)
RIGHT_KNIT = (0.36, 0.16, 0.06)
CREAM, SAGE = (0.58, 0.55, 0.48), (0.20, 0.24, 0.22)
CLOTH = (0.15, 0.20, 0.17)
NAPKIN_M = 0.0022
STIR_SOUP_AT_M = 0.046

# x, y in metres, heading in degrees.
SOUP = (-0.045, 0.075)
BOARD = ((-0.225, -0.185), 6)
NAPKIN_FRONT = ((0.100, -0.290), 4)
NAPKIN_RIGHT = ((0.325, 0.270), 3)
PLATE_RIGHT = (0.315, 0.085)
DISH = (0.385, -0.150)
DISH_SLIDES = ((0.31, -0.140), (0.235, -0.115))
CANDLES = ((-0.175, 0.330), (0.085, 0.365))
CANDLE_HEIGHTS_M = (0.14, 0.11)

SPOON_ON_NAPKIN = ((0.125, -0.288, NAPKIN_M), 96)
SPOON_PICKED = ((0.295, 0.270, NAPKIN_M), -94)
SPOON_LAID = ((-0.135, -0.215, bread_board.BOARD_M), 102)

SHOULDERS = {
    "left_right": ((-0.60, -0.17, 0.25), (-0.36, -0.12, 0.0)),
    "left_left": ((-0.60, 0.17, 0.25), (-0.33, 0.25, 0.0)),
    "right_right": ((0.78, 0.17, 0.25), (0.52, 0.30, 0.0)),
    "right_left": ((0.78, -0.17, 0.25), (0.565, -0.215, 0.0)),
}

WOODEN = (
    spoon.Look(
        length_m=0.270,
        bowl_m=(0.056, 0.076),
        handle_m=(0.0135, 0.0190),
        thickness_m=0.0040,
        material="wood",
        colour=(0.46, 0.27, 0.12),
        grip=(0.36, 0.030, 0.020),
    ),
    {"material": "wood", "grip": "red", "end": "plain"},
)
PLAIN_METAL = (
    spoon.Look(length_m=0.222, bowl_m=(0.053, 0.076), handle_m=(0.0118, 0.0220), thickness_m=0.0028),
    {"material": "metal", "grip": "bare", "end": "plain"},
)


DINERS = {
    "left": (HandLook(skin="fair", sleeve=Cloth("navy"), cuff="navy", scale=0.92), LEFT_KNIT),
    "right": (HandLook(skin="brown", sleeve=Cloth("brown"), cuff="brown", scale=0.92), RIGHT_KNIT),
}


NAPKIN = (0.50, 0.44, 0.33)
SOUP_COLOUR = (0.52, 0.17, 0.025)


def build(scene: Scene) -> None:
    """Sets the table; the story happens in `_left_diner` and `_right_diner`."""
    _room(scene)
    _light(scene)
    dishes = _landmarks(scene)
    spoons = _spoons(scene)
    _left_diner(scene, spoons, dishes)
    _right_diner(scene, spoons, dishes)
    scene.cameras(
        (0.075, -0.02, 0.035), radius_m=0.82, heights_m=(0.48, 0.64), arc_deg=120, facing_deg=-90, fov_deg=47
    )


def _room(scene: Scene) -> None:
    """The room at dusk, the table with its cloth, and the two who eat."""
    rng = scene.rng("room")
    for obj in scene.make("dining_room", "room", rng):
        obj.matrix_basis = pose((0.0, 0.0, FLOOR_M)) @ obj.matrix_basis
    table = scene.make(
        "dining_table",
        "table",
        rng,
        size_m=TABLE_M,
        light=(0.20, 0.095, 0.045),
        dark=(0.095, 0.040, 0.018),
        under_cloth=True,
    )
    linen = tableware.linen(
        "linen", CLOTH, rng, stripe=(0.40, 0.33, 0.20), stripe_at_m=(0.385, 0.405), stripe_m=0.008, axis="Y"
    )
    cloth = scene.make("dining_table.tablecloth", "cloth", rng, material=linen, table_m=TABLE_M)
    mug = cup.Look(profile=cup.STRAIGHT, glaze=(0.10, 0.14, 0.15), pattern="dipped")
    scene.place(table, TABLE)
    scene.place(cloth, TABLE)
    scene.put("cup", "left_mug", (-0.335, 0.085), 60, rng=rng, look=mug)
    scene.put("cup", "right_mug", (0.520, 0.055), 215, rng=rng, look=mug)
    scene.put("kitchen_clutter.bottle", "oil", (0.235, 0.375), rng=rng, colour=(0.16, 0.15, 0.03))
    for name, colour, x, heading in (
        ("left_diner", LEFT_KNIT, -0.62, 90),
        ("right_diner", RIGHT_KNIT, 0.80, -90),
    ):
        chair = scene.make("wooden_chair", f"{name}_chair", rng)
        body = scene.make("sitter", name, rng, pullover=products.knit(f"{name}_knit", colour, rng))
        scene.place(chair, (x, 0.0), heading, on=FLOOR_M)
        scene.place(body, (x, 0.0), heading, on=SEAT_M)


def _light(scene: Scene) -> None:
    """Candles, a warm lamp over the table, dusk in the window."""
    scene.hdri("night", 0.10, rotation_deg=degrees(0.6))
    scene.area_light(
        "lamp",
        (0.05, -0.15, 1.15),
        (0.05, 0.0, 0.0),
        size_m=(0.42, 0.42),
        power_w=12.0,
        colour=(1.0, 0.70, 0.42),
    )
    scene.area_light(
        "dusk", (1.15, 1.6, 0.75), (0.1, 0.0, 0.0), size_m=(1.1, 1.0), power_w=10.0, colour=(0.42, 0.58, 1.0)
    )
    for k, (x, y) in enumerate(CANDLES):
        at = candle.flame_at(CANDLE_HEIGHTS_M[k]) + Vector((x, y, 0.0))
        scene.point_light(f"flame{k}", at, power_w=3.8, radius_m=0.022, colour=(1.0, 0.60, 0.27))


def _landmarks(scene: Scene) -> dict[str, Instance]:
    """Bowls, plates, napkins, candles and the board."""
    rng = scene.rng("landmarks")
    cloth = tableware.linen("napkins", NAPKIN, rng, stripe=(0.62, 0.58, 0.50), stripe_at_m=(0.062,))
    vessels = {"soup_bowl": _soup(), "sauce_bowl": _sauce(), "deep_plate": _deep_plate()}
    things = {name: scene.make("soup_bowl", name, rng, look=look) for name, look in vessels.items()}
    things["dish"] = scene.make("soup_bowl.plate", "dish", rng, radius_m=0.102)
    things["bread_board"] = scene.make("bread_board", "bread_board", rng)
    things["napkin_front"] = scene.make(
        "dining_table.runner", "napkin_front", rng, material=cloth, size_m=(0.235, 0.135)
    )
    things["napkin_right"] = scene.make(
        "dining_table.runner", "napkin_right", rng, material=cloth, size_m=(0.20, 0.11)
    )
    for name, height in zip(("candle_left", "candle_right"), CANDLE_HEIGHTS_M):
        things[name] = scene.make("candle", name, rng, height_m=height)
    made = {}
    for id_, (name, category, spot) in enumerate(
        (
            ("soup_bowl", "bowl", (SOUP, 0.0)),
            ("sauce_bowl", "bowl", ((*DISH, soup_bowl.PLATE_M), 0.0)),
            ("deep_plate", "plate", (PLATE_RIGHT, 0.0)),
            ("dish", "plate", (DISH, 0.0)),
            ("bread_board", "board", BOARD),
            ("napkin_front", "napkin", NAPKIN_FRONT),
            ("napkin_right", "napkin", NAPKIN_RIGHT),
            ("candle_left", "candle", (CANDLES[0], 0.0)),
            ("candle_right", "candle", (CANDLES[1], 0.0)),
        ),
        start=1001,
    ):
        made[name] = scene.instance(name, id_, category, scene.place(things[name], *spot))
    return made


def _soup() -> soup_bowl.Look:
    return soup_bowl.Look(rim_m=(0.122, 0.126), level=0.60, soup=SOUP_COLOUR)


def _sauce() -> soup_bowl.Look:
    return soup_bowl.Look(
        rim_m=(0.086, 0.092), foot_m=0.042, level=0.58, glaze=(0.44, 0.30, 0.14), soup=(0.62, 0.56, 0.42)
    )


def _deep_plate() -> soup_bowl.Look:
    return soup_bowl.Look(
        rim_m=(0.116, 0.042), brim_m=0.024, foot_m=0.052, level=0.62, glaze=CREAM, band=SAGE, soup=SOUP_COLOUR
    )


def _spoons(scene: Scene) -> dict[str, Instance]:
    """The twins, one standing in the soup, and two of metal, one standing in the sauce."""
    look, attributes = WOODEN
    colour = attributes["grip"]
    ringed = (
        spoon.Look(0.205, (0.050, 0.068), (0.0115, 0.0205), 0.0028, grip=look.grip, ring=True),
        {"material": "metal", "grip": colour, "end": "ring"},
    )
    loose = Loose(scene.rng("layout"), 0.003, 2.0)
    made = {}
    for id_, name, (its, words), matrix in (
        (1, "spoon_in_soup", WOODEN, _stir_soup().at(pi)),
        (2, "spoon_on_napkin", WOODEN, pose(*loose(SPOON_ON_NAPKIN))),
        (3, "spoon_in_sauce", ringed, _leaning(ringed[0])),
        (4, "spoon_picked", PLAIN_METAL, pose(*loose(SPOON_PICKED))),
    ):
        obj = scene.make("spoon", name, look=its)
        obj.matrix_basis = matrix
        made[name] = scene.instance(name, id_, "spoon", obj, attributes=words)
    return made


def _left_diner(scene: Scene, spoons: dict[str, Instance], dishes: dict[str, Instance]) -> None:
    """The right hand stirs the soup, lays the spoon on the board and withdraws; the left one rests."""
    hand = _hand(scene, "left_right", 1010)
    held, look = spoons["spoon_in_soup"], WOODEN[0]
    grip = held.matrix(0) @ look.tip.lerp(look.end, 0.90)
    hand.hold_from_start(held, grip="pen", point=grip, heading_deg=75.0)
    hand.stir(dishes["soup_bowl"], _stir_soup(), (3, 36), rounds=1.5, start_deg=180.0)
    up = Matrix.Translation((-0.02, -0.06, 0.13)) @ held.matrix(36)
    hand.bring(up, (36, 50))
    hand.lay_down(pose(*SPOON_LAID), (50, 70))
    hand.release((70, 80))
    hand.withdraw((80, 94))
    hand.finish()
    _hand(scene, "left_left", 1011).finish()


def _right_diner(scene: Scene, spoons: dict[str, Instance], dishes: dict[str, Instance]) -> None:
    """The left hand slides the dish with the sauce; the right one takes a spoon and stirs the plate."""
    left = _hand(scene, "right_left", 1013)
    dish = dishes["dish"]
    edge = dish.matrix(0).translation + Vector((0.0, 0.0, 0.012))
    left.approach(dish, (2, 16), grip="push", point=edge, heading_deg=-98.0)
    left.push_dish(DISH_SLIDES, (17, 48), load=(dishes["sauce_bowl"], spoons["spoon_in_sauce"]))
    left.release((48, 57))
    left.withdraw((57, 78))
    left.finish()

    right = _hand(scene, "right_right", 1012)
    taken = spoons["spoon_picked"]
    grip = taken.matrix(0) @ PLAIN_METAL[0].tip.lerp(PLAIN_METAL[0].end, 0.78)
    right.approach(taken, (12, 30), grip="pick", point=grip + Vector((0, 0, 0.004)), heading_deg=-80.0)
    right.lift((30, 43), height_m=0.10)
    way = _stir_plate()
    right.bring(way.at(pi), (43, 59))
    right.stir(dishes["deep_plate"], way, (59, 92), rounds=1.0, start_deg=180.0)
    right.finish()


def _stir_soup() -> Stirring:
    """How the wooden spoon goes round in the upper half of the soup."""
    foot = Vector((*SOUP, STIR_SOUP_AT_M))
    inner, height = _soup().inner_m
    rim = inner, height + soup_bowl.FLOOR_M - STIR_SOUP_AT_M
    return Stirring(foot, rim, Vector((-1.0, -0.30, 0.0)), WOODEN[0].tip, circle_m=0.050)


def _stir_plate() -> Stirring:
    """How the metal spoon lies in the deep plate, clear of its rim."""
    foot = Vector((*PLATE_RIGHT, soup_bowl.FLOOR_M + 0.004))
    inner, height = _deep_plate().inner_m
    lean = Vector((1.0, 0.45, 0.0))
    return Stirring(foot, (inner - 0.010, height + 0.012), lean, PLAIN_METAL[0].tip, circle_m=0.026)


def _leaning(look: spoon.Look) -> Matrix:
    """A spoon that leans across the sauce bowl, its tip in the far corner of the floor."""
    foot = Vector((*DISH, soup_bowl.PLATE_M + soup_bowl.FLOOR_M + 0.003))
    inner, height = _sauce().inner_m
    lean = Vector((1.0, -0.12, 0.0)).normalized()
    low, high = foot - lean * 0.048, foot + lean * (inner - 0.006) + Vector((0.0, 0.0, height + 0.002))
    return spoon_between(low, high, look.tip)


def _hand(scene: Scene, name: str, id_: int) -> Diner:
    """A hand (diner_side) in the sleeve of its owner's pullover."""
    owner, side = name.split("_")
    shoulder, rest = SHOULDERS[name]
    look, colour = DINERS[owner]
    hand = Diner(
        scene,
        f"hand_{name}",
        id_,
        side=side[0],
        look=look,
        shoulder=shoulder,
        rest_at=rest,
        attributes={"side": side, "owner": f"{owner}_diner"},
    )
    _, sleeve = hand.body.meshes
    knit = f"{name}.knit"
    sleeve.data.materials[0] = products.knit(knit, colour, scene.rng(knit), along="Y", bends=True)
    return hand
