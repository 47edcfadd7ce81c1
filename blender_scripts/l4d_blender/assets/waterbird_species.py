"""Which water birds there are: joints and volumes of gull and duck, plumages by name.

Numbers only: meshes are made of them by waterbird.py. Lengths are metres, colours linear RGB; front is -Y,
left is +X, the origin lies between the feet.
"""

from __future__ import annotations

from dataclasses import dataclass

from mathutils import Vector

from ..scene.colour import Colour

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Species:
    """Joints in metres, left side at +X; volumes are (centre, radii, blend) or (a, b, ra, rb, blend)."""

    name: str
    joints: dict[str, Point]
    volumes: tuple[tuple, ...]
    wing_open: tuple[Point, Point, Point, Point]
    wing_folded: tuple[Point, Point, Point, Point]
    primary_m: tuple[float, float]
    secondary_m: float
    folded_tips: Point
    tail_root: Point
    tail_m: float
    bill: tuple[tuple[Point, tuple[float, float]], ...]
    leg_m: tuple[float, float]
    web_m: float

    def joint(self, name: str, side: str = "left") -> Vector:
        """A rest joint; those of legs exist on both sides."""
        x, y, z = self.joints[name]
        return Vector((x if side == "left" else -x, y, z))


GULL = Species(
    "gull",
    joints={
        "pivot": (0.0, 0.010, 0.185),
        "neck_low": (0.0, -0.078, 0.222),
        "neck_mid": (0.0, -0.118, 0.262),
        "neck_top": (0.0, -0.120, 0.304),
        "bill_tip": (0.0, -0.218, 0.299),
        "eye": (0.0228, -0.156, 0.319),
        "hip": (0.030, 0.012, 0.158),
        "hock": (0.034, 0.034, 0.088),
        "ankle": (0.034, 0.006, 0.009),
    },
    volumes=(
        ((0, -0.020, 0.190), (0.063, 0.100, 0.064), 0.03),
        ((0, 0.050, 0.193), (0.054, 0.105, 0.052), 0.04),
        ((0, -0.070, 0.202), (0.050, 0.050, 0.056), 0.03),
        ((0, 0.120, 0.201), (0.034, 0.072, 0.026), 0.03),
        ((0, -0.080, 0.222), (0, -0.120, 0.266), 0.046, 0.036, 0.03),
        ((0, -0.120, 0.266), (0, -0.124, 0.300), 0.036, 0.029, 0.02),
        ((0, -0.140, 0.312), (0.0268, 0.037, 0.0285), 0.014),
        ((0, -0.160, 0.306), (0.0185, 0.026, 0.0185), 0.010),
    ),
    wing_open=(
        (0.040, -0.050, 0.232),
        (0.152, -0.030, 0.262),
        (0.276, -0.078, 0.272),
        (0.366, -0.056, 0.266),
    ),
    wing_folded=(
        (0.040, -0.050, 0.232),
        (0.058, 0.062, 0.222),
        (0.062, -0.068, 0.200),
        (0.063, 0.022, 0.186),
    ),
    primary_m=(0.150, 0.255),
    secondary_m=0.138,
    folded_tips=(-0.17, 1.0, 0.05),
    tail_root=(0.0, 0.140, 0.205),
    tail_m=0.115,
    bill=(
        ((0, -0.168, 0.305), (0.0105, 0.0125)),
        ((0, -0.186, 0.306), (0.0080, 0.0105)),
        ((0, -0.204, 0.304), (0.0058, 0.0092)),
        ((0, -0.214, 0.300), (0.0040, 0.0070)),
        ((0, -0.218, 0.296), (0.0012, 0.0018)),
    ),
    leg_m=(0.0068, 0.0055),
    web_m=0.052,
)

DUCK = Species(
    "duck",
    joints={
        "pivot": (0.0, 0.020, 0.140),
        "neck_low": (0.0, -0.120, 0.180),
        "neck_mid": (0.0, -0.172, 0.228),
        "neck_top": (0.0, -0.166, 0.292),
        "bill_tip": (0.0, -0.282, 0.288),
        "eye": (0.0268, -0.198, 0.316),
        "hip": (0.046, 0.020, 0.116),
        "hock": (0.050, 0.048, 0.062),
        "ankle": (0.050, 0.014, 0.009),
    },
    volumes=(
        ((0, -0.040, 0.142), (0.084, 0.125, 0.072), 0.03),
        ((0, 0.070, 0.145), (0.080, 0.130, 0.066), 0.05),
        ((0, -0.110, 0.156), (0.060, 0.062, 0.060), 0.03),
        ((0, 0.165, 0.163), (0.044, 0.080, 0.030), 0.04),
        ((0, -0.124, 0.180), (0, -0.170, 0.232), 0.047, 0.033, 0.03),
        ((0, -0.170, 0.232), (0, -0.170, 0.286), 0.033, 0.028, 0.02),
        ((0, -0.184, 0.306), (0.0300, 0.042, 0.0310), 0.014),
        ((0, -0.212, 0.298), (0.0190, 0.026, 0.0190), 0.012),
    ),
    wing_open=(
        (0.055, -0.080, 0.190),
        (0.155, -0.060, 0.215),
        (0.262, -0.100, 0.222),
        (0.340, -0.080, 0.218),
    ),
    wing_folded=(
        (0.055, -0.080, 0.190),
        (0.076, 0.020, 0.186),
        (0.083, -0.088, 0.160),
        (0.084, -0.008, 0.150),
    ),
    primary_m=(0.120, 0.185),
    secondary_m=0.125,
    folded_tips=(-0.16, 1.0, 0.16),
    tail_root=(0.0, 0.185, 0.175),
    tail_m=0.095,
    bill=(
        ((0, -0.216, 0.300), (0.0135, 0.0130)),
        ((0, -0.238, 0.296), (0.0128, 0.0085)),
        ((0, -0.262, 0.290), (0.0145, 0.0055)),
        ((0, -0.277, 0.288), (0.0120, 0.0045)),
        ((0, -0.283, 0.287), (0.0050, 0.0020)),
    ),
    leg_m=(0.0080, 0.0068),
    web_m=0.060,
)


@dataclass(frozen=True)
class Plumage:
    """Linear RGB per part; `hood` colours the head down to the neck, `mottle` 0..1 breaks feathers up."""

    body: Colour
    hood: Colour
    breast: Colour
    mantle: Colour
    wing: Colour
    tips: Colour
    tail: Colour
    bill: Colour
    legs: Colour
    eye: Colour
    ring: Colour | None = None
    mottle: float = 0.0
    hood_to_z_m: float | None = None


_WHITE = (0.70, 0.69, 0.66)
PLUMAGES: dict[str, Plumage] = {
    "grey_backed": Plumage(
        *(_WHITE, _WHITE, _WHITE),
        mantle=(0.165, 0.18, 0.205),
        wing=(0.175, 0.19, 0.215),
        tips=(0.025, 0.025, 0.028),
        tail=_WHITE,
        bill=(0.75, 0.47, 0.04),
        legs=(0.66, 0.40, 0.30),
        eye=(0.55, 0.45, 0.12),
    ),
    "hooded": Plumage(
        _WHITE,
        hood=(0.055, 0.028, 0.018),
        breast=_WHITE,
        mantle=(0.20, 0.215, 0.24),
        wing=(0.21, 0.225, 0.25),
        tips=(0.025, 0.025, 0.028),
        tail=_WHITE,
        bill=(0.40, 0.020, 0.015),
        legs=(0.48, 0.022, 0.015),
        eye=(0.03, 0.02, 0.02),
        hood_to_z_m=0.282,
    ),
    "mottled_young": Plumage(
        body=(0.44, 0.35, 0.26),
        hood=(0.50, 0.41, 0.31),
        breast=(0.48, 0.39, 0.29),
        mantle=(0.21, 0.145, 0.090),
        wing=(0.20, 0.135, 0.085),
        tips=(0.030, 0.024, 0.020),
        tail=(0.12, 0.08, 0.05),
        bill=(0.05, 0.04, 0.04),
        legs=(0.52, 0.33, 0.26),
        eye=(0.03, 0.02, 0.02),
        mottle=0.8,
    ),
    "drake": Plumage(
        body=(0.46, 0.44, 0.41),
        hood=(0.004, 0.075, 0.030),
        breast=(0.115, 0.040, 0.020),
        mantle=(0.24, 0.19, 0.15),
        wing=(0.28, 0.245, 0.21),
        tips=(0.075, 0.055, 0.040),
        tail=(0.62, 0.60, 0.57),
        bill=(0.60, 0.47, 0.05),
        legs=(0.70, 0.20, 0.02),
        eye=(0.03, 0.02, 0.015),
        ring=(0.80, 0.79, 0.76),
        hood_to_z_m=0.246,
    ),
    "duck_hen": Plumage(
        body=(0.36, 0.235, 0.125),
        hood=(0.30, 0.205, 0.115),
        breast=(0.30, 0.185, 0.095),
        mantle=(0.17, 0.10, 0.052),
        wing=(0.19, 0.115, 0.060),
        tips=(0.075, 0.048, 0.030),
        tail=(0.38, 0.26, 0.15),
        bill=(0.42, 0.22, 0.045),
        legs=(0.66, 0.22, 0.03),
        eye=(0.03, 0.02, 0.015),
        mottle=1.0,
    ),
    "black_backed": Plumage(
        *(_WHITE, _WHITE, _WHITE),
        mantle=(0.028, 0.028, 0.031),
        wing=(0.034, 0.034, 0.038),
        tips=(0.015, 0.015, 0.016),
        tail=_WHITE,
        bill=(0.75, 0.47, 0.04),
        legs=(0.66, 0.40, 0.30),
        eye=(0.55, 0.45, 0.12),
    ),
    "white_duck": Plumage(
        *(_WHITE, _WHITE, _WHITE),
        mantle=_WHITE,
        wing=(0.66, 0.65, 0.62),
        tips=(0.60, 0.58, 0.54),
        tail=_WHITE,
        bill=(0.75, 0.33, 0.03),
        legs=(0.72, 0.26, 0.02),
        eye=(0.03, 0.02, 0.015),
        hood_to_z_m=0.256,
    ),
    "black_duck": Plumage(
        body=(0.030, 0.030, 0.033),
        hood=(0.020, 0.020, 0.022),
        breast=(0.026, 0.026, 0.028),
        mantle=(0.022, 0.022, 0.025),
        wing=(0.026, 0.027, 0.030),
        tips=(0.015, 0.015, 0.016),
        tail=(0.020, 0.020, 0.022),
        bill=(0.62, 0.42, 0.05),
        legs=(0.66, 0.26, 0.04),
        eye=(0.30, 0.16, 0.02),
        hood_to_z_m=0.256,
    ),
}

HEADS: dict[str, Colour] = {
    "green": (0.004, 0.075, 0.030),
    "brown": (0.115, 0.050, 0.024),
    "white": _WHITE,
    "black": (0.020, 0.020, 0.022),
    "red": (0.26, 0.040, 0.018),
}
"""Colours that a head may have instead of that of its plumage."""
