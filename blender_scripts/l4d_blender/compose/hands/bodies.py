"""The bodies behind acting hands: torso, thighs and the arms that have nothing to do.

Scenery without an identity, in the cloth of the sleeves. Knows no hands but where their shoulders are.
"""

from __future__ import annotations

from math import radians

from mathutils import Matrix, Vector

from ...assets import mesh
from ...assets.hand import HandLook
from ...assets.materials import skin
from ...assets.person import CLOTH_COLOURS, SKIN_TONES
from ...assets.sitter import SHOULDER
from ..stage import Seat, Stage

JEANS = ((0.04, 0.07, 0.14), (0.10, 0.09, 0.075), (0.03, 0.03, 0.035), (0.16, 0.13, 0.09), (0.10, 0.12, 0.16))


def seat_body(stage: Stage, seat: Seat, number: int, look: HandLook, busy: set[str]) -> None:
    """Somebody at a seat; the arms that are not `busy` ("l", "r") lie in the lap."""
    name, rng = f"sitter_{number + 1}", stage.rng(f"sitter/{number}")
    assert isinstance(look.sleeve.colour, str)
    cloth = skin.cloth(f"{name}_cloth", CLOTH_COLOURS[look.sleeve.colour])
    body = stage.scene.make("sitter", name, rng, pullover=cloth, jeans=rng.choice(JEANS))
    base = seat.shoulder_m - SHOULDER.z * look.scale
    stage.scene.place(body, seat.at, seat.heading_deg, on=base, scale=look.scale)
    frame = (
        Matrix.Translation((*seat.at, base))
        @ Matrix.Rotation(radians(seat.heading_deg), 4, "Z")
        @ Matrix.Scale(look.scale, 4)
    )
    # It faces -Y: its right is at -X.
    for side, sign in (("r", -1.0), ("l", 1.0)):
        if side in busy:
            continue
        shoulder = Vector((0.178 * sign, 0.012, SHOULDER.z - 0.005))
        elbow, wrist = Vector((0.235 * sign, 0.06, 0.27)), Vector((0.12 * sign, -0.15, 0.185))
        sleeve = mesh.tube(
            f"{name}_{side}_sleeve",
            [shoulder, shoulder.lerp(elbow, 0.5), elbow, elbow.lerp(wrist, 0.5), wrist],
            [0.058, 0.050, 0.045, 0.040, 0.032],
            segments=18,
        )
        fist = mesh.ellipsoid(
            f"{name}_{side}_fist", (0.042, 0.055, 0.028), 16, 10, tuple(wrist - Vector((0, 0.05, 0.01)))
        )
        mesh.set_material(sleeve, cloth)
        mesh.set_material(fist, skin.skin(f"{name}_{side}_skin", SKIN_TONES[look.skin]))
        for part in (sleeve, fist):
            part.matrix_basis = frame
