"""Two cooks work at a kitchen island with three pots on its hob. One stirs a steel saucepan, tastes and stirs
the big enamel pot; the other pours from a jug into the twin of that saucepan and moves two of the pots.

Story. She stirs the first saucepan and holds its handle; he pours soup into its twin, puts the jug down and
pulls the big pot along the hob while she tastes; then she stirs that pot, and he pushes the filled saucepan
onto a wooden stand. The two saucepans look the same: one is stirred, the other poured into and moved. The big
pot is moved like the one and stirred like the other, and stirring passes from pot to pot.

Axes: the cooks stand on the +Y side of the island and face -Y, where the cameras are; metres.
"""

from __future__ import annotations

from math import degrees, radians
from typing import Any

import numpy as np

from l4d_blender.assets import chef_hat, kitchen_jug, kitchen_set, pot
from l4d_blender.assets import kitchen_units as units
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import cooks
from l4d_blender.motion.handling import Grip, grip, key_path, rest_hand, shift, still
from l4d_blender.motion.people import Person
from l4d_blender.motion.plan_person import ROWS
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import FRAME_COUNT, LAST_FRAME

SCALE = "room"

HOB_Z = units.HOB_TOP_M

# Pots on the hob: x, y.
STIRRED = (-0.47, -0.07)
BIG = (-0.10, -0.01)
POURED = (0.44, -0.06)
BIG_MOVES = 0.13
POURED_MOVES = (0.275, 0.04)
POURED_MOVING = (74, 92)
LONG_HANDLE = Grip(pot.SAUCEPAN.grip, (0, -1, 0.1), (0, -0.25, -1))
BURNERS = [(-0.47, -0.07), (-0.10, -0.01), (0.17, -0.01), (0.44, -0.06)]
BOARD = (-0.77, 0.00)
JUG_STARTS = (0.72, 0.14, 1.02)
JUG_ENDS = (0.93, 0.14, units.TOP_M)
STIRRER_X, POURER_X, COOKS_Y = -0.24, 0.50, 0.46


ENAMELS = {"red": (0.50, 0.035, 0.025), "blue": (0.03, 0.10, 0.33), "green": (0.05, 0.22, 0.11)}
SOUPS = {
    "tomato": ((0.62, 0.13, 0.03), (0.20, 0.30, 0.06)),
    "pumpkin": ((0.72, 0.33, 0.04), (0.25, 0.33, 0.07)),
    "pea": ((0.30, 0.36, 0.07), (0.66, 0.30, 0.05)),
}


BIG_COLOUR = "red"
SOUP = "pumpkin"
SHIRTS = ("white", "navy")
HAIR = ("dark_brown", "black")
FRONT = (0.115, 0.185, 0.165)
TILE = (0.68, 0.64, 0.55)
WALL = (0.62, 0.52, 0.36)


def build(scene: Scene) -> None:
    """Fits the kitchen, puts pots and tools in place, lets the cooks work, lights it."""
    fit_kitchen(scene)
    cook(scene)
    light(scene)
    scene.cameras(
        (0.10, 0.10, 1.14),
        radius_m=2.35,
        heights_m=(1.80, 2.00, 1.68),
        arc_deg=94,
        facing_deg=-90,
        fov_deg=47,
    )


# --- the kitchen ------------------------------------------------------------------------------------------


def fit_kitchen(scene: Scene) -> None:
    """The kitchen, and on the island the hob, a board beside it and a stand for hot pots."""
    rng = scene.rng("kitchen")
    finish = units.Finish(front=FRONT)
    kitchen = kitchen_set.build(rng, finish=finish, wall=WALL, tile=TILE)
    top = units.TOP_M
    burners = [(x + 0.02, y + 0.04) for x, y in BURNERS]
    hob = scene.put(
        "kitchen_units.hob", "hob", (-0.02, -0.04), on=top, rng=rng, burners=burners, size_m=(1.18, 0.46)
    )
    board = scene.put("kitchen_clutter.chopping_board", "chopping_board", BOARD, 82, on=top, rng=rng)
    scene.instance("hob", 1003, "hob", hob, front="+y")
    scene.add(
        1004,
        "kitchen_clutter.pot_stand",
        "wooden_stand",
        (POURED[0] + POURED_MOVES[0], POURED[1] + POURED_MOVES[1]),
        on=top,
        rng=rng,
        height_m=HOB_Z - top,
    )
    scene.instance("chopping_board", 1005, "board", board)
    scene.instance("fridge", 1006, "fridge", kitchen.fridge, front="-y")
    scene.instance("sink", 1007, "sink", kitchen.sink, front="-y")
    scene.instance("window", 1008, "window", kitchen.window, front="-y")


# --- those who work ---------------------------------------------------------------------------------------


def cook(scene: Scene) -> None:
    """Everything that moves, in the order of time."""
    big_look = pot.stock_pot(ENAMELS[BIG_COLOUR])
    ways = {
        "stirred": still((*STIRRED, HOB_Z), -24.0),
        "big": shift(still((*BIG, HOB_Z), 48.0), (BIG_MOVES, 0.0, 0.0), (50, 66)),
        "poured": shift(still((*POURED, HOB_Z), 4.0), (*POURED_MOVES, 0.0), POURED_MOVING),
    }
    level = np.full(FRAME_COUNT, pot.SAUCEPAN.soup_m)
    pots = {
        "stirred": put_pot(scene, "pot_stirred_first", 1, pot.SAUCEPAN, ways["stirred"], level),
        "big": put_pot(scene, "pot_big", 2, big_look, ways["big"], level * 0.0 + big_look.soup_m),
        "poured": put_pot(
            scene,
            "pot_poured_into",
            3,
            pot.SAUCEPAN,
            ways["poured"],
            level - 0.030 + 0.024 * np.clip((ROWS - 10) / 28, 0, 1),
        ),
    }
    spoon = scene.add(1002, "kitchen_tools.wooden_spoon", "spoon")
    jug = scene.add(1001, "kitchen_jug", "jug", colour=(0.66, 0.63, 0.54))

    stir_and_taste(scene, pots, ways, spoon)
    pour_and_move(scene, pots, ways, jug, big_look)


def put_pot(
    scene: Scene, name: str, id: int, look: pot.PotLook, way: np.ndarray, level: np.ndarray
) -> Instance:
    """A pot with its soup, moved along its way; `level` is the soup's height in the pot at every frame."""
    colour, bits = SOUPS[SOUP]
    body = scene.make("pot", name, scene.rng("pot"), look=look)
    surface = scene.make("pot.soup", f"{name}_soup", scene.rng(name), look=look, colour=colour, bits=bits)
    lifted = way.copy()
    lifted[:, 2, 3] += level
    key_path(body, way)
    key_path(surface, lifted)
    enamelled = look.enamel is not None
    attributes = {
        "material": "enamel" if enamelled else "steel",
        "colour": BIG_COLOUR if enamelled else "grey",
        "size": "large" if enamelled else "small",
        "handles": look.handles,
        "lid": "none",
    }
    return scene.instance(name, id, "pot", [body, surface], attributes=attributes)


def dress(stirs: bool, seed: int) -> Look:
    """One of them wears a plain apron, the other a striped apron and short sleeves."""
    shirt = SHIRTS[0] if stirs else SHIRTS[1]
    return Look(
        build="woman" if stirs else "man",
        height_m=1.69 if stirs else 1.78,
        girth=1.02 if stirs else 1.06,
        skin="fair" if stirs else "brown",
        hair="bun" if stirs else "short",
        hair_colour=HAIR[0 if stirs else 1],
        top=Cloth(shirt),
        sleeve="long" if stirs else "short",
        lower=Cloth("grey", "checks", second="black", repeat_m=0.02),
        apron=Cloth("brown") if stirs else Cloth("white", "stripes", second="blue", repeat_m=0.05),
        shoe_colour="black",
        seed=seed,
    )


def hire(scene: Scene, name: str, id: int, x: float, heading_deg: float, *, stirs: bool) -> Person:
    """One cook behind the island; one of the two wears the tall hat."""
    look = dress(stirs, scene.rng(name).randrange(1000))
    person = Person(
        scene,
        name,
        id,
        category="cook",
        look=look,
        attributes={
            "hat": "tall" if stirs else "none",
            "apron": "plain" if stirs else "striped",
            "sleeves": look.sleeve,
            "shirt": SHIRTS[0 if stirs else 1],
        },
        at=(x, COOKS_Y),
        heading_deg=heading_deg,
    )
    if stirs:
        hat = chef_hat.put_on(f"{name}.hat", person.body)
        hat.pass_index = id
        person.instance.objects.append(hat)
    return person


def stir_and_taste(
    scene: Scene, pots: dict[str, Instance], ways: dict[str, np.ndarray], spoon: Instance
) -> None:
    """Her right hand leads the spoon all the time; the left holds the first saucepan still."""
    chef = hire(scene, "cook_stirring", 4, STIRRER_X, 0.0, stirs=True)
    chef.stoop(-2, -1, 0.16)
    chef.stoop(32, 46, 0.05)
    chef.stoop(54, 70, 0.26)

    way = cooks.SpoonPath()
    first, second = (0, 34), (70, LAST_FRAME)
    saucepan: dict[str, Any] = {"radius_m": 0.046, "height_m": 0.030, "lean": (-0.20, 0.42, 1.0)}
    stock_pot: dict[str, Any] = {"radius_m": 0.062, "height_m": 0.055, "lean": (-0.26, 0.36, 1.0)}
    cooks.stir(chef, way, pots["stirred"], ways["stirred"], first, **saucepan)
    cooks.taste(chef, way, (42, 60))
    cooks.stir(chef, way, pots["big"], ways["big"], second, **stock_pot)
    cooks.use_spoon(chef, spoon, way, 0.255)
    grip(chef, pots["stirred"], ways["stirred"], LONG_HANDLE, first, side="l")
    rest_hand(chef, "l", (STIRRER_X + 0.26, 0.20, units.TOP_M), (62, LAST_FRAME))
    chef.look_at((STIRRED[0], -0.55, 1.05), (0, 30))
    chef.look_at((BIG[0] + BIG_MOVES, -0.55, 1.05), (66, LAST_FRAME))
    chef.finish()


def pour_and_move(
    scene: Scene, pots: dict[str, Instance], ways: dict[str, np.ndarray], jug: Instance, big: pot.PotLook
) -> None:
    """The left hand pours and puts the jug down; the right pulls the big pot, the left pushes the other."""
    helper = hire(scene, "cook_pouring", 5, POURER_X, 0.0, stirs=False)
    helper.stoop(-2, -1, 0.10)
    helper.stoop(40, 52, 0.30)
    helper.stoop(66, 78, 0.22)

    turn = radians(16)
    route = cooks.JugPath(kitchen_jug.LIP, turn)
    over = np.array([POURED[0] + 0.035, POURED[1] + 0.005, HOB_Z + pot.SAUCEPAN.height_m + 0.135])
    route.stand(0, JUG_STARTS)
    route.at(10, over, 1.00)
    route.at(36, over + np.array((0, 0, 0.004)), 1.20)
    route.at(46, over + np.array((0.10, 0.04, 0.02)), 0.10)
    route.stand(60, JUG_ENDS)
    handle = Grip(kitchen_jug.GRIP, (0, 0, 1), (-0.30, -0.95, 0))
    jug_path = cooks.pour(helper, jug, route, handle, pots["poured"], (10, 38), side="l", puts_down=(44, 60))
    colour, _ = SOUPS[SOUP]
    falling = kitchen_jug.stream("stream", colour=colour)
    surface = np.full(FRAME_COUNT, HOB_Z + pot.SAUCEPAN.soup_m - 0.012)
    key_path(falling, cooks.stream_matrices(jug_path, kitchen_jug.LIP, surface, (9, 36), turn))

    grip(
        helper,
        pots["big"],
        ways["big"],
        Grip(big.grip, (0, -1, 0), (-0.75, 0, -0.55)),
        (48, 68),
        side="r",
        arc_m=0.08,
        moves=(50, 66),
    )
    grip(
        helper,
        pots["poured"],
        ways["poured"],
        LONG_HANDLE,
        (74, 94),
        side="l",
        arc_m=0.10,
        moves=POURED_MOVING,
    )
    helper.look_at((POURED[0], -0.5, 1.0), (0, 38))
    helper.look_at((BIG[0], -0.5, 1.0), (46, 66))
    helper.look_at((POURED[0] + 0.2, -0.5, 1.0), (70, LAST_FRAME))
    helper.finish()


# --- light ------------------------------------------------------------------------------------------------


def light(scene: Scene) -> None:
    """Cool morning light through the window, warm lamps over the island, the rest of the house in front."""
    scene.exposure = 1.05
    scene.hdri("studio", strength=0.50, rotation_deg=degrees(0.6))
    scene.area_light(
        "window_light",
        (0.15, kitchen_set.BACK_Y - 0.25, 1.75),
        (0.1, -0.2, 0.9),
        size_m=(1.25, 1.0),
        power_w=26,
        colour=(0.88, 0.95, 1.0),
    )
    for k, x in enumerate((-0.55, 0.75)):
        scene.area_light(
            f"lamp_{k}",
            (x, -0.75, 2.45),
            (x * 0.8, 0.1, 1.0),
            size_m=(0.45, 0.45),
            power_w=15,
            colour=(1.0, 0.80, 0.58),
        )
