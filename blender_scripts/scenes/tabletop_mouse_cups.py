"""Somebody works at a desk by a window: a mouse is slid over its mat, a cup is lifted and put down.

Story. Four cups and two mice stand about on an oak desk. Two cups are twins, white with a blue band and full
of coffee: one stands on the green book, the other beside the keyboard. A blue one with tea stands next to the
lamp, a red one is empty on a coaster. The mice are twins too: one on the mat, the other next to the notepad.
The right hand reaches for the mouse on the mat, slides it in a curve, lets go and withdraws. The left hand
rests under the window, then takes the twin beside the keyboard, lifts it and puts it down again. By looks
alone neither twin and neither mouse can be told from the other, and each hand is near things that it never
touches.

Axes: the desk top is z = 0; the sitter is at -X and faces +X, so the right hand is at -Y; the window at +Y.
"""

from __future__ import annotations

from math import degrees

from mathutils import Vector

from l4d_blender.assets import computer_mouse, cup, desk, desk_lamp, mouse_mat, notepad, office_chair, saucer
from l4d_blender.assets.hand import HandLook
from l4d_blender.assets.materials import products
from l4d_blender.assets.person import Cloth
from l4d_blender.motion.hands import Hand
from l4d_blender.scene.placing import Loose, pose
from l4d_blender.scene.scene import Instance, Scene

SCALE = "tabletop"

FLOOR_M = -desk.HEIGHT_M
BOOK_SIZE_M = (0.155, 0.225, 0.030)
PULLOVER = (0.045, 0.070, 0.110)

# Where things stand: x, y (and z) in metres, heading in degrees.
KEYBOARD = ((-0.195, 0.02), -90)
MOUSE_MAT = ((-0.155, -0.255), -90)
NOTEPAD = ((0.145, -0.28), -68)
GREEN_BOOK = ((0.13, 0.02), -78)
COASTER = ((0.255, -0.155), 0)
LAMP = ((0.165, 0.360), -20)
MOUSE_BY_NOTEPAD = ((0.045, -0.195), 78)
CUP_ON_BOOK = ((0.13, 0.03, BOOK_SIZE_M[2]), 200)
CUP_BY_KEYBOARD = ((-0.135, 0.228), -72)
CUP_BY_LAMP = ((0.044, 0.302), -75)
CUP_ON_COASTER = ((0.255, -0.155, saucer.COASTER_M), -100)

# Where the moved mouse starts, and the curve that it then takes over the mat.
MOUSE_ON_MAT = ((-0.170, -0.208, mouse_mat.THICKNESS_M), 84)
SLIDE_THROUGH = ((-0.118, -0.224), (-0.095, -0.262), (-0.125, -0.298), (-0.165, -0.310))
SLIDE_TURN_DEG = 12.0

# The lifted cup: the height of the grip above its foot, how high it goes, and how far off it is put down.
GRIP_M = 0.068
LIFT_M = 0.085
PUT_DOWN_BY = (0.010, -0.006)

# The sitter's shoulders and where the palms rest; the right hand is at -Y.
SHOULDER_RIGHT = (-0.60, -0.17, 0.25)
SHOULDER_LEFT = (-0.60, 0.17, 0.25)
REST_RIGHT = (-0.365, -0.215, 0.0)
REST_LEFT = (-0.335, 0.330, 0.0)

LOOK_OF_HANDS = HandLook(skin="fair", sleeve=Cloth("navy"), cuff="navy", scale=0.90)

Look = tuple[cup.Look, dict[str, str]]

TWIN: Look = (
    cup.Look(pattern="rim_band", liquid=cup.COFFEE),
    {"colour": "white", "pattern": "banded", "content": "coffee"},
)
BLUE: Look = (
    cup.Look(glaze=(0.045, 0.12, 0.34), liquid=cup.TEA),
    {"colour": "blue", "pattern": "plain", "content": "tea"},
)
RED: Look = (
    cup.Look(profile=cup.STRAIGHT, glaze=(0.46, 0.045, 0.035), pattern="dipped"),
    {"colour": "red", "pattern": "two_tone", "content": "empty"},
)


def build(scene: Scene) -> None:
    """The whole scene; the story happens in `_right_hand` and `_left_hand`."""
    _room(scene)
    _clutter(scene)
    _light(scene)

    loose = Loose(scene.rng("layout"), 0.006, 4.0)
    _landmarks(scene, loose)
    cups = _cups(scene, loose)
    mice = _mice(scene, loose)
    _right_hand(scene, mice["mouse_on_mat"])
    _left_hand(scene, cups["cup_by_keyboard"])

    scene.cameras(
        (-0.02, -0.03, 0.03), radius_m=0.88, heights_m=(0.42, 0.60), arc_deg=150, facing_deg=-58, fov_deg=48
    )


def _room(scene: Scene) -> None:
    """Walls, window, shelves, desk, chair, and whoever sits there."""
    rng = scene.rng("room")
    scene.put(
        "study_room",
        "room",
        (0.0, 0.0),
        on=FLOOR_M,
        rng=rng,
        wall_y_m=0.74,
        window_x_m=(-1.05, 0.32),
        sill_m=0.86,
    )
    scene.put("desk", "desk", (0.02, 0.0), -90, on=FLOOR_M, rng=rng, size_m=(1.36, 0.80))
    scene.put(
        "bookcase",
        "shelf",
        (1.15, 0.63),
        on=0.05,
        rng=rng,
        width_m=1.1,
        depth_m=0.22,
        height_m=0.38,
        shelves=1,
    )
    scene.put("bookcase", "bookcase", (-2.42, -0.1), 90, on=FLOOR_M, rng=rng, width_m=1.3)
    scene.put(
        "bookcase", "cabinet", (2.42, -0.2), -90, on=FLOOR_M, rng=rng, width_m=1.2, height_m=1.1, shelves=3
    )
    scene.put("office_chair", "chair", (-0.70, 0.0), 90, on=FLOOR_M, rng=rng)
    scene.put(
        "sitter",
        "sitter",
        (-0.60, 0.0),
        90,
        on=FLOOR_M + office_chair.SEAT_M,
        rng=rng,
        pullover=products.knit("pullover", PULLOVER, rng),
    )


def _clutter(scene: Scene) -> None:
    """What lies about and is never asked for."""
    rng = scene.rng("clutter")
    scene.put("monitor", "monitor", (0.30, 0.50), -62, rng=rng)
    scene.put("headphones", "headphones", (0.275, 0.17), -150, rng=rng)
    scene.put("paper_sheets", "sheets", (0.0, -0.47), -75, rng=rng)
    scene.put("paper_sheets.sticky_notes", "sticky_notes", (0.14, -0.46), -60, rng=rng)
    scene.put("pen_pot", "pen_pot", (-0.02, 0.58), rng=rng)
    scene.put("plant_pot", "plant", (-0.24, 0.52), rng=rng)
    scene.put("pen", "pen", (0.16, -0.29), 160, on=notepad.THICKNESS_M, rng=rng)


def _light(scene: Scene) -> None:
    """Soft daylight through the window, a warm lamp, the rest of the room as fill."""
    scene.hdri("interior", 0.38, rotation_deg=degrees(1.0))
    scene.area_light(
        "daylight",
        (-0.35, 0.70, 0.62),
        (0.05, -0.2, 0.0),
        size_m=(1.2, 0.9),
        power_w=30,
        colour=(0.86, 0.93, 1.0),
    )
    scene.point_light(
        "lamp_light", pose(*LAMP) @ desk_lamp.LIGHT, power_w=5.0, radius_m=0.03, colour=(1.0, 0.66, 0.34)
    )


def _landmarks(scene: Scene, loose: Loose) -> None:
    """Things that sentences mention to say where something is."""
    rng = scene.rng("landmarks")
    marks = (
        (
            1001,
            "green_book",
            "book",
            scene.put("book", "green_book", *loose(GREEN_BOOK), rng=rng, size_m=BOOK_SIZE_M),
        ),
        (1002, "keyboard", "keyboard", scene.put("keyboard", "keyboard", *loose(KEYBOARD, 0.4), rng=rng)),
        (1003, "lamp", "lamp", scene.put("desk_lamp", "lamp", *LAMP, rng=rng)),
        (1004, "notepad", "notepad", scene.put("notepad", "notepad", *loose(NOTEPAD), rng=rng)),
        (
            1005,
            "mouse_mat",
            "mouse_mat",
            scene.put("mouse_mat", "mouse_mat", *loose(MOUSE_MAT, 0.5), rng=rng),
        ),
        (1008, "coaster", "coaster", scene.put("saucer.coaster", "coaster", *loose(COASTER, 0.5), rng=rng)),
    )
    for id_, name, category, obj in marks:
        scene.instance(name, id_, category, obj)


def _cups(scene: Scene, loose: Loose) -> dict[str, Instance]:
    """Four cups at four places; two of them are twins."""
    looks = (TWIN, TWIN, BLUE, RED)
    spots = (
        (1, "cup_on_book", CUP_ON_BOOK),
        (2, "cup_by_keyboard", CUP_BY_KEYBOARD),
        (3, "cup_by_lamp", CUP_BY_LAMP),
        (4, "cup_on_coaster", CUP_ON_COASTER),
    )
    cups = {}
    for (id_, name, spot), (look, attributes) in zip(spots, looks):
        cups[name] = scene.add(id_, "cup", name, *loose(spot, 0.7), attributes=attributes, look=look)
    return cups


def _mice(scene: Scene, loose: Loose) -> dict[str, Instance]:
    """Two mice of one make."""
    shell = computer_mouse.SHELLS["black"]
    attributes = {"colour": "black"}
    return {
        "mouse_on_mat": scene.add(
            5, "computer_mouse", "mouse_on_mat", *loose(MOUSE_ON_MAT, 0.5), attributes=attributes, shell=shell
        ),
        "mouse_by_notepad": scene.add(
            6,
            "computer_mouse",
            "mouse_by_notepad",
            *loose(MOUSE_BY_NOTEPAD),
            attributes=attributes,
            shell=shell,
        ),
    }


def _right_hand(scene: Scene, mouse: Instance) -> None:
    """Takes the mouse on the mat, slides it in a curve, lets go and withdraws."""
    hand = Hand(
        scene,
        "hand_right",
        1006,
        side="r",
        look=LOOK_OF_HANDS,
        shoulder=SHOULDER_RIGHT,
        rest_at=REST_RIGHT,
        attributes={"side": "right"},
    )
    _dress(scene, hand)
    behind_the_buttons = mouse.matrix(0) @ Vector((0.0, 0.038, 0.0))
    hand.approach(mouse, (2, 18), grip="mouse", point=behind_the_buttons)
    hand.slide(SLIDE_THROUGH, (18, 58), verb="move", turn_deg=SLIDE_TURN_DEG)
    hand.release((58, 68))
    hand.withdraw((68, 84))
    hand.finish()


def _left_hand(scene: Scene, lifted: Instance) -> None:
    """Rests under the window, then takes a cup round its body, lifts it and puts it down again."""
    hand = Hand(
        scene,
        "hand_left",
        1007,
        side="l",
        look=LOOK_OF_HANDS,
        shoulder=SHOULDER_LEFT,
        rest_at=REST_LEFT,
        attributes={"side": "left"},
    )
    _dress(scene, hand)
    stand = lifted.matrix(0).translation
    hand.approach(lifted, (36, 56), grip="side", point=stand + Vector((0.0, 0.0, GRIP_M)))
    hand.lift((56, 72), height_m=LIFT_M)
    hand.put_down((stand.x + PUT_DOWN_BY[0], stand.y + PUT_DOWN_BY[1], stand.z), (74, 89))
    hand.release((89, 96))
    hand.finish()


def _dress(scene: Scene, hand: Hand) -> None:
    """Puts an arm into a sleeve of the sitter's own pullover."""
    name = f"{hand.instance.name}.knit"
    _, sleeve = hand.body.meshes
    sleeve.data.materials[0] = products.knit(name, PULLOVER, scene.rng(name), along="Y", bends=True)
