"""A playroom in soft daylight with three teddy bears. One child goes to the bear on the mat, picks it up with
both hands, hugs it and rocks it; another sits at a low table with an arm round a second bear, sets a block
on a tower and then waves. The third bear sits in a small rocking chair that sways and comes to rest.

What tells look-alikes apart: two bears are twins, the one in the rocking chair and the one on the table. Two
bears rock and two are held, but only the one of another look does both.
"""

from __future__ import annotations

from math import cos, degrees, exp, pi, radians

from mathutils import Vector

from l4d_blender.assets import coffee_table, mesh, play_mat, rocking_chair, teddy, toy_block, wooden_chair
from l4d_blender.assets.person import Cloth, Look
from l4d_blender.motion import nursery
from l4d_blender.motion.people import Person
from l4d_blender.scene import keys
from l4d_blender.scene.placing import pose
from l4d_blender.scene.scene import Instance, Scene
from l4d_blender.scene.timeline import FPS, LAST_FRAME

SCALE = "room"

BACK_WALL_Y = 1.72
HALF_WIDTH = 2.7
FRONT_Y = -3.2

# Where things stand: x, y in metres, heading in degrees.
TABLE = ((0.70, 0.20), 0.0)
TABLE_SIZE_M = (0.86, 0.50)
CHAIR = (0.62, 0.65)
CHEST = ((-0.86, 0.86), degrees(0.16))
ROCKER = ((-1.14, 0.16), degrees(0.42))
MAT = ((-0.32, 0.02), 0.0)
BOOKCASE = ((0.42, 1.56), 0.0)
WINDOW_X = -1.05
BEAR_ON_MAT = (-0.24, 0.10)
BEAR_ON_TABLE = (0.93, 0.28)
TOWER = (0.55, 0.29)
LOOSE_BLOCK = ((0.435, 0.325), degrees(0.35))

BLOCK_M = 0.062
SEAT_M = 0.27
MAT_M = play_mat.THICKNESS_M


GIRL = Look(
    build="child",
    height_m=1.10,
    skin="fair",
    hair="long",
    hair_colour="blond",
    sleeve="short",
    bottom="dress",
    lower=Cloth("purple", "dots", "white", repeat_m=0.045),
    shoes="shoes",
    shoe_colour="white",
    seed=5,
)
BOY = Look(
    build="child",
    height_m=1.12,
    skin="tan",
    hair="short",
    hair_colour="dark_brown",
    top=Cloth("red", "stripes", "white", repeat_m=0.05),
    sleeve="long",
    bottom="trousers",
    lower=Cloth("denim", "denim"),
    shoes="shoes",
    shoe_colour="blue",
    seed=31,
)
WALL, FIGURE = (0.60, 0.62, 0.52), (0.66, 0.67, 0.58)
TWINS = ("brown", "red")
OTHER = ("cream", "blue")
LIFT = 18
STACK = 16


def build(scene: Scene) -> None:
    """Furnishes the room, puts bears and children into it, lights it."""
    _room(scene)
    _clutter(scene)
    rocker = _landmarks(scene)
    bears = _bears(scene)
    _rock(bears["rocker"], rocker)
    _hugger(scene, bears["mat"])
    _builder(scene, bears["table"])
    _light(scene)
    scene.cameras(
        (-0.13, 0.22, 0.48),
        radius_m=2.85,
        heights_m=(1.05, 1.45, 0.85, 1.25),
        arc_deg=112.0,
        facing_deg=-90.0,
        fov_deg=49.0,
    )


# --- the room ---------------------------------------------------------------------------------------------


def _room(scene: Scene) -> None:
    """Walls, floor, window and what hangs on the walls."""
    rng = scene.rng("room")
    scene.make(
        "room",
        "room",
        rng,
        half_width_m=HALF_WIDTH,
        back_m=BACK_WALL_Y,
        front_m=FRONT_Y,
        wall=WALL,
        figure=FIGURE,
        boards=(0.50, 0.36, 0.22),
    )
    scene.add(
        1001,
        "window",
        "window",
        (WINDOW_X, BACK_WALL_Y),
        rng=rng,
        sill_m=0.62,
        width_m=1.25,
        height_m=1.25,
        curtain=(0.62, 0.40, 0.12),
    )
    for k, (x, z, size) in enumerate(
        ((-0.02, 1.06, (0.28, 0.36)), (1.16, 0.98, (0.42, 0.34)), (1.66, 1.08, (0.30, 0.38)))
    ):
        scene.put("picture_frame", f"picture_{k}", (x, BACK_WALL_Y, z), rng=rng, size_m=size, palette=k)


def _clutter(scene: Scene) -> None:
    """Toys that lie about and what else a playroom has: none annotated."""
    rng = scene.rng("clutter")
    on_mat = (
        (scene.make("ring_stacker", "rings", rng), (-0.66, -0.36), degrees(0.3), 2.4),
        (scene.make("picture_book", "book", rng), (0.16, -0.40), degrees(0.5), 1.0),
    )
    for thing, at, heading_deg, size in on_mat:
        scene.place(thing, at, heading_deg, on=MAT_M, scale=size)
    paints = ((0.50, 0.035, 0.03), (0.05, 0.16, 0.42), (0.66, 0.40, 0.03), (0.08, 0.28, 0.08))
    spots = (((0.30, -0.12), 0.4), ((0.40, -0.22), 1.2), ((-0.10, -0.48), 0.2), ((-0.86, -0.24), 0.9))
    for k, (paint, (at, turn)) in enumerate(zip(paints, spots)):
        look = toy_block.Look(paint=paint, figure=toy_block.FIGURES[k], size_m=BLOCK_M)
        scene.put("toy_block", f"strewn_{k}", at, degrees(turn), on=MAT_M, rng=rng, look=look)
    scene.put("houseplant", "plant", (1.75, 1.30), rng=rng, height_m=0.95)
    scene.put("floor_lamp", "lamp", (-2.05, 1.40), rng=rng)
    scene.put("bookcase", "low_shelf", (1.36, 1.56), rng=rng, height_m=0.80, width_m=0.95, shelves=2)


def _landmarks(scene: Scene) -> Instance:
    """Furniture that sentences speak of; returns the rocking chair."""
    rng = scene.rng("furniture")
    scene.add(1002, "play_mat", "mat", *MAT, rng=rng, tiles=(5, 4), tile_m=0.44)
    scene.add(
        1003,
        "coffee_table",
        "low_table",
        *TABLE,
        on=MAT_M,
        rng=rng,
        size_m=TABLE_SIZE_M,
        colour=(0.50, 0.33, 0.17),
    )
    scene.add(1004, "toy_chest", "toy_chest", *CHEST, on=MAT_M, rng=rng, paint=(0.10, 0.30, 0.36))
    scene.add(1005, "bookcase", "bookcase", *BOOKCASE, rng=rng, width_m=0.86, height_m=1.30, shelves=4)
    rocker = scene.add(1006, "rocking_chair", "rocking_chair", *ROCKER, on=MAT_M, rng=rng)
    chair = scene.make("wooden_chair", "stool", rng)
    size = (SEAT_M - MAT_M) / wooden_chair.SEAT_M
    scene.place(chair, (CHAIR[0], CHAIR[1] + 0.02), on=MAT_M, scale=size)
    return rocker


# --- bears and children -----------------------------------------------------------------------------------


def _bears(scene: Scene) -> dict[str, Instance]:
    """The twins are equal to the last stitch."""
    table_top = MAT_M + coffee_table.HEIGHT_M
    seat = pose((0.0, rocking_chair.SEAT_Y_M + 0.02, rocking_chair.SEAT_M - 0.004))
    stand = pose((*ROCKER[0], MAT_M), ROCKER[1])
    plan = {
        "mat": ("teddy_hugged", OTHER, pose((*BEAR_ON_MAT, MAT_M))),
        "rocker": ("teddy_in_rocking_chair", TWINS, stand @ seat),
        "table": ("teddy_on_table", TWINS, pose((*BEAR_ON_TABLE, table_top - 0.002))),
    }
    bears = {}
    for id, (place, (name, look, at)) in enumerate(plan.items(), 1):
        key = "other" if place == "mat" else "twins"
        body = scene.make("teddy", name, scene.rng(f"teddy/{key}"), plush=look[0], ribbon=look[1])
        body.matrix_basis = at
        bears[place] = scene.instance(
            name, id, "teddy", body, attributes={"colour": look[0], "ribbon": look[1]}, front="-y"
        )
    return bears


def _rock(bear: Instance, chair: Instance) -> None:
    """The rocking chair has been given a push: it sways ever less and comes to rest."""
    stop = 64
    level = chair.objects[0].matrix_basis.copy()
    seated = level.inverted() @ bear.objects[0].matrix_basis
    moves = []
    for frame in range(LAST_FRAME + 1):
        fading = exp(-0.012 * frame) * (1.0 - keys.ease_between(frame, 20, stop))
        moves.append(level @ rocking_chair.rocked(0.24 * fading * cos(2 * pi * 0.95 * frame / FPS)))
    keys.key_matrices(chair.objects[0], moves)
    keys.key_matrices(bear.objects[0], [move @ seated for move in moves])
    bear.scene.event(bear, "rock", (0, stop - 6))


def _child(
    scene: Scene, name: str, id: int, look: Look, at: tuple[float, float], heading_deg: float
) -> Person:
    wears_dress = look.bottom == "dress"
    cloth = look.lower if wears_dress else look.top
    return Person(
        scene,
        name,
        id,
        category="child",
        look=look,
        attributes={
            "clothes": "dress" if wears_dress else "trousers",
            "colour": str(cloth.colour),
            "pattern": {"stripes": "striped", "dots": "dotted"}[cloth.pattern],
            "hair": look.hair,
            "hair_colour": look.hair_colour,
        },
        at=at,
        heading_deg=heading_deg,
        ground_m=MAT_M,
    )


def _hugger(scene: Scene, bear: Instance) -> None:
    """Comes from the bookcase, picks the bear up and hugs it."""
    hugger = _child(scene, "child_hugging", 4, GIRL, (-0.04, 0.86), degrees(-0.45))
    spot = (BEAR_ON_MAT[0], BEAR_ON_MAT[1] + 0.26)
    first = LIFT
    hugger.walk_to(spot, (0, first), facing_deg=0.0)
    hugger.lift(bear, teddy.SIDES_M, (first, first + 32), carry="chest")
    nursery.hug(hugger, bear, (first + 32, LAST_FRAME), half_m=abs(teddy.SIDES_M[0][0]))
    hugger.finish()


def _builder(scene: Scene, bear: Instance) -> None:
    """Sits behind the table, an arm round the bear, and sets the last block on the tower."""
    rng = scene.rng("blocks")
    top = MAT_M + coffee_table.HEIGHT_M
    paints = ((0.05, 0.16, 0.42), (0.66, 0.40, 0.03), (0.08, 0.28, 0.08), (0.50, 0.035, 0.03))
    blocks = []
    for k, paint in enumerate(paints):
        look = toy_block.Look(paint=paint, figure=toy_block.FIGURES[k], size_m=BLOCK_M)
        blocks.append(scene.make("toy_block", f"block_{k}", rng, look=look))
    for k, block in enumerate(blocks[:3]):
        shift = (rng.uniform(-0.004, 0.004), rng.uniform(-0.004, 0.004), rng.uniform(-0.15, 0.15))
        scene.place(
            block, (TOWER[0] + shift[0], TOWER[1] + shift[1]), degrees(shift[2]), on=top + k * BLOCK_M
        )
    tower = mesh.join("tower", blocks[:3])
    scene.instance("tower", 1007, "tower", tower)
    loose = scene.instance("block", 1008, "block", scene.place(blocks[3], *LOOSE_BLOCK, on=top))

    builder = _child(scene, "child_building", 5, BOY, CHAIR, 0.0)
    nursery.sit_at(builder, (*CHAIR, SEAT_M), 0.0)
    back = Vector((BEAR_ON_TABLE[0] - 0.045, BEAR_ON_TABLE[1] + 0.066, top + 0.165))
    nursery.keep_hand_on(builder, bear, back, side="l")
    first = STACK
    nursery.stack(
        builder,
        loose,
        (TOWER[0], TOWER[1], top + 3 * BLOCK_M),
        (first, first + 40),
        height_m=BLOCK_M,
        side="r",
    )
    nursery.wave_seated(builder, (first + 42, LAST_FRAME), side="r")
    builder.finish()


def _light(scene: Scene) -> None:
    """Cool daylight from the window, soft light from the open side, a sunlit patch on the mat."""
    scene.exposure = 1.22
    scene.hdri("interior", strength=0.40, rotation_deg=degrees(2.2))
    scene.area_light(
        "window_light",
        (WINDOW_X, BACK_WALL_Y - 0.25, 1.35),
        (0.0, -0.2, 0.2),
        size_m=(1.1, 1.1),
        power_w=15,
        colour=(0.90, 0.95, 1.0),
    )
    scene.area_light(
        "open_side",
        (1.4, -2.6, 2.4),
        (0.0, 0.3, 0.3),
        size_m=(1.8, 1.4),
        power_w=15,
        colour=(1.0, 0.96, 0.90),
    )
    patch = scene.area_light(
        "sun_patch",
        (-1.9, 1.3, 2.4),
        (-0.30, -0.15, 0.0),
        size_m=(0.6, 0.8),
        power_w=4.5,
        colour=(1.0, 0.88, 0.66),
    )
    patch.data.spread = radians(24)
