"""A child plays with four building blocks at a low table: one is pushed over a tray into another, which then
gets a third one on top; the last is pushed over the edge of a toy slide and comes down it.

Story. Two red blocks with a star are twins: one lies on the tray, the other on the table. Two blocks are
blue: a large one with a star on the tray, a small worn one with a moon on the deck of the slide. The right
hand pushes the red one on the tray, which shoves the large blue one along; then it puts the other red one on
top of that. The left hand pushes the worn one down the slide. Each colour has one that is pushed by a hand
and one that isn't, and so have the tray and the rest of the table.

Axes: the table top is z = 0; the child sits at +Y and faces -Y, so the right hand is at -X.
"""

from __future__ import annotations

from math import degrees, radians

from mathutils import Matrix, Vector

from l4d_blender.assets import coffee_table, mesh, rug, serving_tray, toy_block
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products
from l4d_blender.assets.person import Cloth
from l4d_blender.motion.toy_blocks import PushingHand, RampSlide
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scene import Instance, Scene

SCALE = "tabletop"

FLOOR_M = -coffee_table.HEIGHT_M
SEAT_M = 0.24
LEAN_DEG = 7.0
CHILD = 0.72  # of the size of the grown-up that hands and torso are modelled on

# x, y in metres, heading in degrees.
TRAY = ((-0.125, -0.030), 48.0)
TRAY_SIZE_M = (0.15, 0.25)
RAMP = ((0.150, 0.015), 5.0)
CAR = ((0.028, -0.162), 62.0)
BOOK = ((-0.400, -0.190), 16.0)
STACKER = ((0.335, 0.110), 0.0)
CRAYON_BOX = ((0.335, -0.115), -32.0)

# The blocks in the tray's axes, one on the table, and the stretch of the slide's axis along which one goes.
RED_ON_TRAY = (-0.004, 0.074)
LARGE_ON_TRAY = (0.0, -0.004)
RED_ON_TABLE = ((0.036, 0.062), 9.0)
SLIDE_Y = (0.112, -0.205)

SHOULDERS = {"r": (-0.140, 0.325, 0.195), "l": (0.140, 0.325, 0.195)}
RESTS = {"r": (-0.245, 0.130, 0.0), "l": (0.255, 0.170, 0.0)}

RED, BLUE, GREEN, YELLOW = ((0.52, 0.035, 0.03), (0.035, 0.11, 0.40), (0.06, 0.26, 0.09), (0.72, 0.43, 0.03))
PAINTS = {"red": RED, "blue": BLUE, "green": GREEN, "yellow": YELLOW}
JERSEY = (0.42, 0.30, 0.10)


TWINS = "red"
OTHERS = "blue"
FIGURES = ("star", "moon")
PUSH = (14, 40)
SLIDE = (50, 68)
SUN_AZIMUTH_DEG = -128.0


def build(scene: Scene) -> None:
    """The whole scene; the story happens in `_right_hand` and `_left_hand`."""
    _nursery(scene)
    _clutter(scene)
    _light(scene)
    marks = _landmarks(scene)
    slide = RampSlide(marks["ramp"].matrix(0), 0.046, *SLIDE_Y)
    blocks = _blocks(scene, marks["tray"], slide)
    _right_hand(scene, blocks)
    _left_hand(scene, blocks["block_on_ramp"], slide)
    scene.cameras(
        (0.0, -0.035, 0.035), radius_m=0.66, heights_m=(0.30, 0.44), arc_deg=140, facing_deg=-88, fov_deg=48
    )


def _nursery(scene: Scene) -> None:
    """The room behind: table, rug, shelves, window, cushions, and the child's body."""
    rng = scene.rng("room")
    shell = scene.make(
        "room",
        "room",
        rng,
        half_width_m=1.9,
        back_m=1.55,
        front_m=-1.6,
        wall=(0.50, 0.56, 0.55),
        figure=(0.62, 0.60, 0.48),
        boards=(0.42, 0.28, 0.16),
    )
    casement = scene.make("window", "window", rng, sill_m=0.62, curtain=(0.55, 0.26, 0.16))
    scene.place(shell, (0.0, 0.0), on=FLOOR_M)
    scene.place(casement, (-0.85, 1.54), on=FLOOR_M)
    torso = scene.make("sitter", "child", rng, pullover=products.knit("jersey", JERSEY, rng))
    mesh.transform(torso, Matrix.Rotation(radians(LEAN_DEG), 4, "X") @ Matrix.Scale(CHILD, 4))
    scene.put(
        "coffee_table",
        "table",
        (0.0, -0.09),
        on=FLOOR_M,
        rng=rng,
        size_m=(1.02, 0.70),
        colour=(0.60, 0.47, 0.32),
    )
    scene.put("rug", "rug", (0.1, 0.25), 8, on=FLOOR_M, rng=rng, size_m=(2.3, 1.5), palette=rug.PALETTES[2])
    scene.put("bookcase", "shelves", (0.75, 1.38), on=FLOOR_M, rng=rng, width_m=1.2, height_m=0.95, shelves=3)
    scene.place(torso, (0.0, 0.375), on=FLOOR_M + SEAT_M)


def _clutter(scene: Scene) -> None:
    """What lies about and is never asked for."""
    rng = scene.rng("clutter")
    scene.put("ring_stacker", "stacker", *STACKER, rng=rng)
    scene.put("crayons.crayon_box", "crayon_box", *CRAYON_BOX, rng=rng)
    scene.put("crayons.loose_crayons", "crayons", (0.305, -0.235), 24, rng=rng, count=4)
    scene.put(
        "cushion.block", "floor_cushion", (1.05, 0.55), 24, on=FLOOR_M, rng=rng, size_m=(0.55, 0.55, 0.16)
    )
    scene.put("yarn_ball", "ball", (-1.0, 0.75), on=FLOOR_M, rng=rng, radius_m=0.09)


def _light(scene: Scene) -> None:
    """A bright forenoon: low sun from the window's side, a pale room as fill."""
    scene.hdri("courtyard", 0.45, rotation_deg=degrees(2.2))
    scene.sun(
        elevation_deg=44, azimuth_deg=SUN_AZIMUTH_DEG, strength=2.8, angle_deg=3.0, colour=(1.0, 0.90, 0.76)
    )
    scene.area_light(
        "window_light",
        (-0.85, 1.35, 0.85),
        (0.0, 0.0, 0.0),
        size_m=(1.0, 1.2),
        power_w=26,
        colour=(0.90, 0.95, 1.0),
    )


def _landmarks(scene: Scene) -> dict[str, Instance]:
    """Things that sentences mention to say where something is."""
    rng = scene.rng("landmarks")
    marks = (
        (1001, "tray", scene.put("serving_tray", "tray", *TRAY, rng=rng, size_m=TRAY_SIZE_M)),
        (1002, "ramp", scene.put("toy_ramp", "ramp", *RAMP, rng=rng)),
        (1003, "toy_car", scene.put("toy_car", "toy_car", *CAR, rng=rng)),
        (1004, "picture_book", scene.put("picture_book", "picture_book", *BOOK, rng=rng)),
    )
    return {name: scene.instance(name, id_, name, obj) for id_, name, obj in marks}


def _blocks(scene: Scene, tray: Instance, slide: RampSlide) -> dict[str, Instance]:
    """Two twins and two others of one colour, at four places."""
    shared, own = FIGURES
    looks = {
        "block_pushed": (TWINS, shared, "small", "glossy"),
        "block_stacked": (TWINS, shared, "small", "glossy"),
        "block_bumped": (OTHERS, shared, "large", "glossy"),
        "block_on_ramp": (OTHERS, own, "small", "worn"),
    }
    level = tray.matrix(0) @ pose((0.0, 0.0, serving_tray.FLOOR_M))
    places = {
        "block_pushed": level @ pose(RED_ON_TRAY),
        "block_stacked": pose(*RED_ON_TABLE),
        "block_bumped": level @ pose(LARGE_ON_TRAY),
        "block_on_ramp": slide.block_matrix(0.0),
    }
    blocks = {}
    for id_, (name, (colour, figure, size, finish)) in enumerate(looks.items(), 1):
        look = toy_block.Look(
            PAINTS[colour], figure, 0.060 if size == "large" else 0.046, 0.42 if finish == "worn" else 0.12
        )
        obj = scene.make("toy_block", name, look=look)
        obj.matrix_basis = places[name]
        attributes = {"colour": colour, "figure": figure, "size": size, "finish": finish}
        blocks[name] = scene.instance(name, id_, "block", obj, attributes=attributes)
    return blocks


def _right_hand(scene: Scene, blocks: dict[str, Instance]) -> None:
    """Pushes one block over the tray into another, then puts the twin of the first on top of that."""
    hand = _hand(scene, "hand_right", 1005, "r")
    pushed, bumped, stacked = (blocks[name] for name in ("block_pushed", "block_bumped", "block_stacked"))
    first, last = PUSH
    ahead = Matrix.Rotation(radians(TRAY[1]), 3, "Z") @ Vector((0.0, -0.066, 0.0))
    hand.approach(pushed, (first - 12, first), grip="push", heading_deg=TRAY[1], point=_middle(pushed, 0.028))
    hand.push(ahead[:2], (first, last), bumped=bumped)
    hand.release((last, last + 7))

    hand.approach(stacked, (last + 7, 60), grip="top", heading_deg=24)
    top = bumped.matrix(96).translation + Vector((0.0, 0.0, 0.0602))
    hand.lift((60, 74), height_m=0.105, toward=top)
    hand.put_down(top, (74, 88))
    hand.release((88, 96))
    hand.finish()


def _left_hand(scene: Scene, block: Instance, slide: RampSlide) -> None:
    """Pushes a block over the edge of the slide's deck, then rests."""
    hand = _hand(scene, "hand_left", 1006, "l")
    first, last = SLIDE
    hand.approach(block, (first - 16, first), grip="push", heading_deg=RAMP[1], point=_middle(block, 0.026))
    hand.push_down(slide, (first, last), 90)
    hand.release((last + 6, last + 14))
    hand.withdraw((last + 14, 96))
    hand.finish()


def _hand(scene: Scene, name: str, id_: int, side: str) -> PushingHand:
    """A child's hand in the sleeve of the jersey."""
    look = HandLook(skin="fair", sleeve=Cloth("yellow"), cuff="brown", scale=CHILD)
    hand = PushingHand(
        scene,
        name,
        id_,
        side=side,
        look=look,
        shoulder=SHOULDERS[side],
        rest_at=RESTS[side],
        attributes={"side": {"r": "right", "l": "left"}[side]},
    )
    _, sleeve = hand.body.meshes
    sleeve.data.materials[0] = products.knit(f"{name}.knit", JERSEY, scene.rng(name), along="Y", bends=True)
    return hand


def _middle(block: Instance, height_m: float) -> Vector:
    """A point inside a block, some way above its base."""
    return block.matrix(0).translation + Vector((0.0, 0.0, height_m))
