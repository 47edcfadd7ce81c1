"""Somebody at a desk takes a pen from an open notebook, writes a line and lays it down again, while the other
hand pushes two more pens that roll away one after the other.

Story. Two blue pens are twins: one lies on the open notebook and writes, the other lies on the desk pad. A
third pen, orange with white bands, lies on the shut notebook. The left hand first pushes the orange pen,
which rolls over the cover, then the blue one on the pad, which rolls up to the ruler. So blue are the writer
and one that rolls, on a notebook lie the writer and one that rolls, and only the writer is ever lifted.

Axes: the desk top is z = 0; the writer sits at +Y and faces -Y, so the right hand is at -X.
"""

from __future__ import annotations

from math import degrees

import bpy
from mathutils import Vector

from l4d_blender.assets import cup, desk, desk_pad, laptop, marker_pen, notebook
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products
from l4d_blender.assets.person import Cloth
from l4d_blender.motion import writing
from l4d_blender.motion.writing import PenHand
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scene import Instance, Scene

SCALE = "tabletop"

FLOOR_M = -desk.HEIGHT_M
SEAT_M = 0.46
PAD_M = desk_pad.THICKNESS_M
FORWARD = Vector((0.0, -1.0, 0.0))
SHIRT = (0.30, 0.38, 0.46)

# x, y in metres, heading in degrees.
OPEN = ((-0.160, 0.000), 178.0)
SHUT = ((0.248, 0.105), 172.0)
ROLLS_ON_PAD = ((0.116, -0.062), 183.0)
RULER = ((0.085, -0.238), 6.0)
ERASER = ((-0.085, -0.200), 28.0)
POT = ((0.400, 0.310), 0.0)
GLASSES = ((0.300, -0.190), 152.0)
LAPTOP = ((-0.540, -0.020), 188.0)
LAMP = ((0.500, 0.150), -62.0)

# On the notebooks' own axes: where the pens lie, and the line that is written.
WRITER_AT = ((0.080, -0.042), 4.0)
ROLLS_ON_COVER = ((0.004, -0.045), 3.0)
LINE = ((0.030, 0.046), (0.124, 0.046))
WORDS_M = (0.018, 0.026, 0.012, 0.022)

SHOULDERS = {"r": (-0.175, 0.42, 0.27), "l": (0.175, 0.42, 0.27)}
RESTS = {"r": (-0.235, 0.185, PAD_M), "l": (0.108, 0.175, PAD_M)}

BARRELS = {
    "blue": (0.030, 0.075, 0.26),
    "orange": (0.66, 0.20, 0.025),
    "green": (0.04, 0.22, 0.09),
    "red": (0.46, 0.035, 0.035),
}
COVERS = {"green": (0.06, 0.15, 0.13), "red": (0.36, 0.07, 0.05)}


TWINS = "blue"
OTHER = "orange"
PUSH = (15, 30)
WRITING = (32, 70)
SUN_AZIMUTH_DEG = 196.0


def build(scene: Scene) -> None:
    """The whole scene; the story happens in `_right_hand` and `_left_hand`."""
    _office(scene)
    _clutter(scene)
    _light(scene)
    _landmarks(scene)
    notebooks, words = _notebooks(scene)
    pens = _pens(scene, notebooks)
    _right_hand(scene, pens["pen_writing"], notebooks["notebook_open"], words)
    _left_hand(scene, pens)
    scene.cameras(
        (-0.012, -0.025, 0.012),
        radius_m=0.64,
        heights_m=(0.34, 0.46),
        arc_deg=136,
        facing_deg=-90,
        fov_deg=48,
    )


def _office(scene: Scene) -> None:
    """The room, the desk and whoever sits there."""
    rng = scene.rng("room")
    scene.put(
        "office_room",
        "office",
        (0.0, 0.0),
        on=FLOOR_M,
        rng=rng,
        half_width_m=2.1,
        back_m=1.7,
        front_m=-2.0,
        window_y_m=(-0.9, 0.9),
        accent=(0.12, 0.20, 0.27),
    )
    table = scene.make(
        "desk",
        "desk",
        rng,
        size_m=(1.5, 0.80),
        light=(0.50, 0.46, 0.40),
        dark=(0.33, 0.29, 0.24),
        steel=(0.42, 0.42, 0.43),
    )
    writer = scene.make(
        "sitter", "writer", rng, pullover=products.knit("jumper", SHIRT, rng), jeans=(0.05, 0.05, 0.06)
    )
    scene.place(table, (0.0, -0.05), 180, on=FLOOR_M)
    scene.place(writer, (0.0, 0.44), on=FLOOR_M + SEAT_M)
    scene.put("bookcase", "shelves", (0.75, 1.5), on=FLOOR_M, rng=rng, width_m=1.5, height_m=1.1, shelves=3)


def _clutter(scene: Scene) -> None:
    """What lies about and is never asked for."""
    rng = scene.rng("clutter")
    scene.add(1005, "laptop", "laptop", *LAPTOP, front=None, rng=rng, model=laptop.COMPACT_SILVER)
    scene.put("desk_pad", "pad", (0.0, -0.035), rng=rng)
    scene.put("glasses", "glasses", *GLASSES, on=PAD_M, rng=rng)
    scene.put(
        "cup", "cup", (-0.395, 0.235), 40, rng=rng, look=cup.Look(glaze=(0.30, 0.34, 0.33), liquid=cup.COFFEE)
    )
    scene.put("paper_sheets", "sheets", (-0.300, -0.345), 24, rng=rng)
    scene.put("paper_sheets.sticky_notes", "sticky_notes", (-0.335, -0.185), 14, on=PAD_M, rng=rng)
    scene.put("plant_pot", "plant", (0.560, 0.285), rng=rng)


def _light(scene: Scene) -> None:
    """Cool daylight through the blind at the right hand's side."""
    scene.hdri("studio", 0.55, rotation_deg=degrees(1.2))
    scene.area_light(
        "window",
        (-1.5, -0.15, 0.95),
        (0.0, 0.0, 0.0),
        size_m=(1.3, 0.9),
        power_w=58,
        colour=(0.84, 0.92, 1.0),
    )
    scene.sun(
        elevation_deg=30, azimuth_deg=SUN_AZIMUTH_DEG, strength=1.4, angle_deg=2.0, colour=(1.0, 0.92, 0.80)
    )


def _landmarks(scene: Scene) -> None:
    """Things that sentences mention to say where something is."""
    rng = scene.rng("landmarks")
    marks = (
        (1001, "ruler", scene.put("drawing_tools.ruler", "ruler", *RULER, on=PAD_M, rng=rng)),
        (1002, "eraser", scene.put("drawing_tools.rubber", "eraser", *ERASER, on=PAD_M, rng=rng)),
        (1003, "pen_pot", scene.put("pen_pot", "pen_pot", *POT, on=PAD_M, rng=rng)),
        (1004, "lamp", scene.put("desk_lamp", "lamp", *LAMP, rng=rng, enamel=(0.62, 0.60, 0.55))),
    )
    for id_, name, obj in marks:
        scene.instance(name, id_, name, obj)


def _notebooks(scene: Scene) -> tuple[dict[str, Instance], list[bpy.types.Object]]:
    """One open, one shut; and the words that will be written."""
    rng = scene.rng("notebook_open")
    opened = scene.put(
        "notebook.open_notebook",
        "notebook_open",
        *OPEN,
        on=PAD_M,
        rng=rng,
        look=notebook.Look(cover=COVERS["green"]),
    )
    words, x = [], LINE[0][0]
    for k, length in enumerate(WORDS_M):
        word = scene.make("notebook.word", f"word_{k}", rng, length_m=length)
        z = notebook.page_z(x) + 0.0003
        words.append(scene.place(word, (x, LINE[0][1], z), on=opened))
        x += length + 0.005
    plain = {"colour": "green", "pattern": "plain", "state": "open"}
    dotted = {"colour": "red", "pattern": "dotted", "state": "shut"}
    return {
        "notebook_open": scene.instance("notebook_open", 4, "notebook", [opened, *words], attributes=plain),
        "notebook_shut": scene.add(
            5,
            "notebook.shut_notebook",
            "notebook_shut",
            *SHUT,
            attributes=dotted,
            on=PAD_M,
            look=notebook.Look(cover=COVERS["red"], dotted=True),
        ),
    }, words


def _pens(scene: Scene, notebooks: dict[str, Instance]) -> dict[str, Instance]:
    """Two twins and a banded one; two of the three lie on notebooks."""
    page = notebooks["notebook_open"].matrix(0) @ pose((0.0, 0.0, notebook.page_z(0.08)))
    cover = notebooks["notebook_shut"].matrix(0) @ pose((0.0, 0.0, notebook.SHUT_M))
    spots = {
        "pen_writing": (page, WRITER_AT, TWINS, 0),
        "pen_on_pad": (PAD_M, ROLLS_ON_PAD, TWINS, 0),
        "pen_on_cover": (cover, ROLLS_ON_COVER, OTHER, 3),
    }
    pens = {}
    for id_, (name, (level, spot, barrel, bands)) in enumerate(spots.items(), 1):
        attributes = {"colour": barrel, "pattern": "banded" if bands else "plain"}
        pens[name] = scene.add(
            id_,
            "marker_pen",
            name,
            *spot,
            attributes=attributes,
            on=level,
            look=marker_pen.Look(barrel=BARRELS[barrel], bands=bands),
        )
    return pens


def _right_hand(scene: Scene, pen: Instance, page: Instance, words: list[bpy.types.Object]) -> None:
    """Takes the pen that lies on the page, writes a line, lays it down and withdraws."""
    hand = _hand(scene, "hand_right", 1006, "r")
    first, last = WRITING
    grip = pen.matrix(0) @ (writing.TIP + Vector((writing.GRIP_M, 0.0, 0.0)))
    hand.approach(pen, (2, first - 14), grip="pinch", heading_deg=8, point=grip)
    z = notebook.page_z(LINE[0][0]) + 0.0004
    start, end = (page.matrix(0) @ Vector((x, y, z)) for x, y in LINE)
    shares = hand.write(
        page,
        (start, end),
        lift=(first - 14, first),
        writing=(first, last),
        lay=(last, last + 14),
        forward=FORWARD,
    )
    written = [sum(WORDS_M[: k + 1]) + 0.005 * k for k in range(len(WORDS_M))]
    writing.appear(words, [length / (LINE[1][0] - LINE[0][0]) for length in written], shares)
    hand.release((last + 14, 95))
    hand.finish()


def _left_hand(scene: Scene, pens: dict[str, Instance]) -> None:
    """Pushes the pen on the cover, then the one on the pad."""
    hand = _hand(scene, "hand_left", 1007, "l")
    first, last = PUSH
    _push(hand, pens["pen_on_cover"], (first - 13, first), (first, last), last + 14, 0.050)
    hand.release((last, last + 7))
    _push(hand, pens["pen_on_pad"], (last + 7, last + 24), (last + 24, last + 40), last + 62, 0.118)
    hand.release((last + 40, last + 47))
    hand.withdraw((last + 47, 96))
    hand.finish()


def _push(
    hand: PenHand, pen: Instance, approach: tuple[int, int], push: tuple[int, int], rest: int, way: float
) -> None:
    """Lays the fingertips against a pen's middle and makes it roll."""
    start = pen.matrix(0)
    heading_deg = degrees(start.to_euler().z) - 180.0
    hand.approach(
        pen, approach, grip="push", heading_deg=heading_deg, point=start @ Vector((0.010, 0.0, 0.0095))
    )
    hand.push_rolling(way, push, rest)


def _hand(scene: Scene, name: str, id_: int, side: str) -> PenHand:
    """A hand in the sleeve of the writer's jumper."""
    look = HandLook(skin="tan", sleeve=Cloth("light_blue"), cuff="grey", scale=0.90)
    hand = PenHand(
        scene,
        name,
        id_,
        side=side,
        look=look,
        shoulder=SHOULDERS[side],
        rest_at=RESTS[side],
        table_m=PAD_M,
        attributes={"side": {"r": "right", "l": "left"}[side]},
    )
    _, sleeve = hand.body.meshes
    sleeve.data.materials[0] = products.knit(f"{name}.knit", SHIRT, scene.rng(name), along="Y", bends=True)
    return hand
