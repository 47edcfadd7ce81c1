"""Tea in a garden: two pots are tipped one after the other over two of three cups while somebody stirs.

Story. Host and guest sit at a table with a checked cloth. Two cups are twins, wide and white with a blue
band: one stands on a saucer in front of the host, the other on the tray next to a tall striped cup. The host
lifts the pot from its trivet with the right hand, pours into the cup on the saucer and puts the pot back;
later the guest fills the tall cup on the tray from the other pot. Meanwhile the host's left hand stirs the
twin on the tray and leaves the spoon in it. So of the banded cups one is filled, of the cups on the tray one
is filled, and the banded one on the tray is only stirred.

Axes: the table top is z = 0; the host is at -X and faces +X, the guest at +Y faces -Y.
"""

from __future__ import annotations

import bpy
from mathutils import Vector

from l4d_blender.assets import cup, dining_table, saucer, spoon, tea, teapot, tray, wooden_chair
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.person import Cloth
from l4d_blender.motion.servers import Server, Stirring
from l4d_blender.scene.placing import Loose
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import FRAME_COUNT

SCALE = "tabletop"

FLOOR_M = -dining_table.HEIGHT_M
TABLE = (0.13, -0.03)
TABLE_M = (1.22, 1.12)
CARDIGAN = (0.24, 0.055, 0.06)
SHIRT = (0.06, 0.15, 0.13)

# x, y in metres and heading in degrees; pots head where their spout points.
TRIVET = ((-0.205, -0.345), 8)
TRAY = ((0.075, 0.115), 0)
SUGAR = ((0.085, -0.165), 0)
BISCUITS = ((0.295, -0.240), 0)
FLOWERS = ((0.375, 0.355), 40)
POT_ON_TRIVET = ((-0.205, -0.345), 180)
POT_BEHIND_TRAY = ((0.015, 0.345), 90)
CUP_BY_HOST = ((-0.125, -0.115), 215)
CUP_STIRRED = ((-0.115, 0.105), 140)
CUP_TALL = ((0.245, 0.100), -60)

TEA = (0.17, 0.052, 0.010)
CUP_LOW, CUP_HIGH = 0.60, 0.89  # levels as shares of the lip's height
SPOON = spoon.Look(length_m=0.142)
CLEARANCE_M = 0.082  # of a spout over a lip
FLOW_M_S = (0.32, -0.25)  # how fast tea leaves the spout, forwards and upwards

HOST_RIGHT = ((-0.60, -0.17, 0.25), (-0.40, -0.44, 0.0))
HOST_LEFT = ((-0.60, 0.17, 0.25), (-0.34, 0.27, 0.0))
GUEST_RIGHT = ((-0.03, 0.74, 0.25), (-0.14, 0.48, 0.0))
GUEST_LEFT = ((0.31, 0.74, 0.25), (0.24, 0.47, 0.0))

BANDED = (
    cup.Look(profile=cup.BOWL, pattern="rim_band"),
    {"colour": "white", "pattern": "banded", "shape": "wide"},
)
STRIPED = (cup.Look(pattern="stripes"), {"colour": "white", "pattern": "striped", "shape": "tall"})

ROUND_POT = (
    teapot.Look(knob="wood"),
    {"colour": "blue", "shape": "round", "material": "ceramic", "knob": "wooden"},
)
TALL_POT = (
    teapot.Look(shape="tall", material="enamel", pattern="banded"),
    {"colour": "blue", "shape": "tall", "material": "enamel", "knob": "round"},
)


SUN_AZIMUTH_DEG = -150.0
CLOTH = (0.30, 0.36, 0.24)


def build(scene: Scene) -> None:
    """Lays the table in the garden; the story happens in `_host` and `_guest`."""
    scene.make("garden", "garden", floor_m=FLOOR_M)
    _seats(scene)
    _light(scene)

    loose = Loose(scene.rng("layout"), 0.005, 5.0)
    _landmarks(scene, loose)
    cups = _cups(scene, loose)
    pots = _pots(scene, loose)
    _host(scene, cups, pots["pot_on_trivet"])
    _guest(scene, cups["cup_tall"], pots["pot_behind_tray"])

    scene.cameras(
        (0.0, -0.02, 0.05), radius_m=0.88, heights_m=(0.42, 0.58), arc_deg=132, facing_deg=-46, fov_deg=48
    )


def _seats(scene: Scene) -> None:
    """Table, cloth, chairs, and the two who sit there."""
    rng = scene.rng("seats")
    table = scene.make("dining_table", "table", rng, size_m=TABLE_M, under_cloth=True)
    cloth = scene.make(
        "dining_table.tablecloth",
        "cloth",
        rng,
        material=tableware.gingham("gingham", CLOTH, rng, check_m=0.032),
        table_m=TABLE_M,
    )
    scene.place(table, TABLE)
    scene.place(cloth, TABLE)
    for name, colour, (x, y), heading in (
        ("host", CARDIGAN, (-0.62, 0.0), 90),
        ("guest", SHIRT, (0.14, 0.76), 0),
    ):
        chair = scene.make("wooden_chair", f"{name}_chair", rng)
        body = scene.make("sitter", name, rng, pullover=products.knit(f"{name}_knit", colour, rng))
        scene.place(chair, (x, y), heading, on=FLOOR_M)
        scene.place(body, (x, y), heading, on=FLOOR_M + wooden_chair.SEAT_M)
    napkin = scene.make(
        "dining_table.runner",
        "napkin",
        rng,
        material=tableware.linen("linen", (0.62, 0.58, 0.48), rng),
        size_m=(0.17, 0.13),
    )
    spare = scene.make("saucer", "spare_saucer", rng, rim=(0.10, 0.20, 0.34))
    scene.place(napkin, (0.10, -0.33), 22, on=0.002)
    scene.place(spare, (0.47, 0.07))


def _light(scene: Scene) -> None:
    """Late morning: sun through haze, open sky."""
    scene.sky(sun_elevation_deg=32.0, sun_azimuth_deg=SUN_AZIMUTH_DEG, strength=0.20)
    scene.sun(
        elevation_deg=50.0, azimuth_deg=SUN_AZIMUTH_DEG, strength=3.6, angle_deg=3.0, colour=(1.0, 0.87, 0.68)
    )


def _landmarks(scene: Scene, loose: Loose) -> None:
    """Things that sentences mention to say where something is."""
    rng = scene.rng("landmarks")
    bowl = scene.make("sugar_bowl", "sugar_bowl", rng)
    flowers = scene.make("flower_vase", "flowers", rng)
    for id_, name, category, obj in (
        (1001, "trivet", "trivet", scene.put("tray.trivet", "trivet", *loose(TRIVET, 0.5), rng=rng)),
        (1002, "tray", "tray", scene.put("tray", "tray", *TRAY, rng=rng, size_m=(0.50, 0.27))),
        (1003, "sugar_bowl", "sugar_bowl", scene.place(bowl, *loose(SUGAR))),
        (1004, "biscuits", "plate", scene.put("sugar_bowl.biscuits", "biscuits", *loose(BISCUITS), rng=rng)),
        (1005, "flowers", "vase", scene.place(flowers, *loose(FLOWERS))),
    ):
        scene.instance(name, id_, category, obj)


def _cups(scene: Scene, loose: Loose) -> dict[str, Instance]:
    """Two twins and another, each with some tea in it."""
    scene.put("saucer", "saucer", *loose((CUP_BY_HOST[0], 0.0), 0.0))
    cups = {}
    for id_, name, (look, attributes), spot, height_m in (
        (1, "cup_by_host", BANDED, CUP_BY_HOST, saucer.SAUCER_WELL_M),
        (2, "cup_stirred", BANDED, CUP_STIRRED, tray.TRAY_M),
        (3, "cup_tall", STRIPED, CUP_TALL, tray.TRAY_M),
    ):
        body = scene.put("cup", name, *loose(spot, 0.4), on=height_m, look=look)
        drink = tea.surface(f"{name}.tea", TEA)
        cups[name] = scene.instance(name, id_, "cup", [body, drink], attributes=attributes)
        _fill(drink, cups[name], look, [CUP_LOW * look.profile[-1][1]] * FRAME_COUNT)
    return cups


def _pots(scene: Scene, loose: Loose) -> dict[str, Instance]:
    """The pot that pours first stands on the trivet, the other behind the tray."""
    pots = {}
    for id_, name, (look, attributes), spot, height_m in (
        (4, "pot_on_trivet", ROUND_POT, POT_ON_TRIVET, tray.TRIVET_M),
        (5, "pot_behind_tray", TALL_POT, POT_BEHIND_TRAY, 0.0),
    ):
        pots[name] = scene.add(
            id_, "teapot", name, *loose(spot, 0.5), attributes=attributes, on=height_m, look=look
        )
    return pots


def _host(scene: Scene, cups: dict[str, Instance], pot: Instance) -> None:
    """The right hand pours into the cup in front of the host and puts the pot back; the left hand stirs."""
    look = HandLook(skin="fair", sleeve=Cloth("brown"), cuff="brown", scale=0.90)
    right = _hand(scene, "host_right", 1006, "r", look, HOST_RIGHT, CARDIGAN)
    stand = pot.matrix(0).translation.copy()
    _serve(right, ROUND_POT[0], pot, cups["cup_by_host"], BANDED[0], (2, 14, 29, 60), 90.0)
    right.put_down(stand, (61, 80))
    right.release((80, 90))
    right.finish()

    left = _hand(scene, "host_left", 1007, "l", look, HOST_LEFT, CARDIGAN)
    stirred = cups["cup_stirred"]
    foot = stirred.matrix(0).translation + Vector((0, 0, cup.BOTTOM_M + 0.003))
    lip_r, lip_z = BANDED[0].profile[-1]
    inside = lip_r - cup.WALL_M, lip_z - cup.BOTTOM_M
    way = Stirring(foot, inside, Vector((-1.0, 0.35, 0.0)), SPOON.tip)
    body = scene.make("spoon", "spoon", look=SPOON)
    body.matrix_basis = way.at(0.0)
    held = scene.instance("spoon", 1010, "spoon", body)
    left.hold_from_start(held, grip="pinch", point=body.matrix_basis @ (SPOON.tip.lerp(SPOON.end, 0.82)))
    left.stir(stirred, way, (6, 58), rounds=2.0)
    left.release((62, 72))
    left.withdraw((72, 90))
    left.finish()


def _guest(scene: Scene, filled: Instance, pot: Instance) -> None:
    """The guest's right hand fills the cup on the tray; the left one rests."""
    look = HandLook(skin="brown", sleeve=Cloth("green"), cuff="green", scale=0.90)
    right = _hand(scene, "guest_right", 1008, "r", look, GUEST_RIGHT, SHIRT)
    _serve(right, TALL_POT[0], pot, filled, STRIPED[0], (26, 40, 55, 90), 0.0)
    right.finish()
    _hand(scene, "guest_left", 1009, "l", look, GUEST_LEFT, SHIRT).finish()


def _serve(
    hand: Server,
    look: teapot.Look,
    pot: Instance,
    into: Instance,
    cup_look: cup.Look,
    frames: tuple[int, int, int, int],
    heading_deg: float,
) -> None:
    """Takes a pot by its ear, brings the spout over a cup and pours: `frames` part reach, lift and pour."""
    reach, lift, tip, end = frames
    lip = cup_look.profile[-1][1]
    foot = into.matrix(0).translation
    ahead = pot.matrix(0).to_3x3() @ Vector((0.0, -1.0, 0.0))
    flow = Vector((ahead.x * FLOW_M_S[0], ahead.y * FLOW_M_S[0], FLOW_M_S[1]))
    over = foot + Vector((0, 0, lip + CLEARANCE_M))
    over -= (tea.landing_point(over, flow, foot.z + 0.6 * lip) - over) * Vector((1, 1, 0))
    hand.approach(pot, (reach, lift), grip="ear", point=pot.matrix(0) @ look.grip, heading_deg=heading_deg)
    hand.raise_spout(look.spout_tip, over + Vector((0, 0, 0.012)), (lift, tip))
    wet = hand.pour(into, look.spout_tip, (tip, end), tip_deg=50.0 if look.shape == "round" else 58.0)
    levels = tea.rising(wet[0] + 3, wet[1], CUP_LOW * lip, CUP_HIGH * lip)
    _fill(into.objects[1], into, cup_look, levels)
    spout = pot.matrix(wet[0] + 3) @ look.spout_tip
    tea.stream(f"{pot.name}.stream", TEA, spout, flow, [foot.z + z for z in levels], wet)


def _fill(drink: bpy.types.Object, into: Instance, look: cup.Look, levels: list[float]) -> None:
    """Keys the level of the tea in a cup, in metres over its foot."""
    inner = [(r - cup.WALL_M, z) for r, z in look.profile if z > cup.BOTTOM_M]
    tea.key_level(drink, [into.matrix(f) for f in range(FRAME_COUNT)], inner, levels)


def _hand(
    scene: Scene,
    name: str,
    id_: int,
    side: str,
    look: HandLook,
    where: tuple[tuple[float, float, float], tuple[float, float, float]],
    colour: tuple[float, float, float],
) -> Server:
    """A hand in the sleeve of its owner's pullover; `where` is the shoulder and where the palm rests."""
    owner, side_name = name.split("_")
    hand = Server(
        scene,
        name,
        id_,
        side=side,
        look=look,
        shoulder=where[0],
        rest_at=where[1],
        attributes={"side": side_name, "owner": owner},
    )
    _, sleeve = hand.body.meshes
    knit = f"{name}.knit"
    sleeve.data.materials[0] = products.knit(knit, colour, scene.rng(knit), along="Y", bends=True)
    return hand
