"""Splatting in PyTorch: the same pictures as the rasterizers of l4d-splat, written from the equations.

Vectorised over all Gaussians, and over the pixels and Gaussians of many tiles at once; differentiable. Its gradients
in float64 are the fixtures of crates/l4d-splat/tests/raster (see fixture.py there), its time in float32 is the
yardstick of perf/splats_forward.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch

TILE = 16
NEAR = 0.2
BLUR = 0.3
SIGMAS = 3.0
MARGIN = 1.3
ALPHA_MIN = 1.0 / 255.0
ALPHA_MAX = 0.99
TRANSMITTANCE_MIN = 1e-4


@dataclass
class View:
    """A pinhole camera; the centre of pixel (column, row) is (column + 0.5, row + 0.5)."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    camera_from_world: list[list[float]]  # three rows of four


@dataclass
class Splats:
    """Activated Gaussians, one row each; `sh` is [count, coefficients, 3]."""

    means: torch.Tensor
    scales: torch.Tensor
    rotations: torch.Tensor
    opacities: torch.Tensor
    sh: torch.Tensor


def draw(splats: Splats, view: View, background: tuple[float, float, float] = (0.0, 0.0, 0.0), batch: int = 16) -> dict[str, torch.Tensor]:
    """Colour [height, width, 3], accumulated alpha and summed depth [height, width]."""
    flat = project(splats, view)
    lists, offsets = tile_lists(flat, view)
    depth = flat["depth"][:, None]
    canvas = spread(flat, lists, offsets, torch.cat([flat["colour"], torch.ones_like(depth), depth], 1), view, batch)
    alpha = canvas[..., 3]
    colour = canvas[..., :3] + (1.0 - alpha)[..., None] * torch.tensor(background, dtype=alpha.dtype)
    return {"colour": colour, "alpha": alpha, "depth_sum": canvas[..., 4]}


def spread(flat: dict[str, torch.Tensor], lists: torch.Tensor, offsets: torch.Tensor, carried: torch.Tensor, view: View, batch: int = 16) -> torch.Tensor:
    """What the visible Gaussians carry, blended: [height, width, channels]."""
    columns, rows = math.ceil(view.width / TILE), math.ceil(view.height / TILE)
    channels = carried.shape[1]
    canvas = torch.zeros(columns * rows, TILE * TILE, channels, dtype=carried.dtype)
    lengths = offsets[1:] - offsets[:-1]
    # Tiles of about the same length together, so that little is padded.
    order = torch.argsort(lengths, descending=True)
    order = order[lengths[order] > 0]
    painted = []
    for tiles in order.split(batch):
        weight, chosen = weights(flat, lists, offsets, tiles, columns)
        painted.append(weight.transpose(1, 2) @ carried[chosen])
    if painted:
        canvas = canvas.index_put((order,), torch.cat(painted))
    canvas = canvas.reshape(rows, columns, TILE, TILE, channels).transpose(1, 2)
    return canvas.reshape(rows * TILE, columns * TILE, channels)[: view.height, : view.width]


def project(splats: Splats, view: View) -> dict[str, torch.Tensor]:
    """Means, inverse covariances, tiles and colours on the picture plane of the visible Gaussians, front to back."""
    pose = torch.tensor(view.camera_from_world, dtype=splats.means.dtype)
    rotation, centre = pose[:, :3], -pose[:, :3].T @ pose[:, 3]
    offset = splats.means - centre
    point = offset @ rotation.T
    x, y, z = point.unbind(1)
    safe = torch.where(z > NEAR, z, torch.ones_like(z))
    mean = torch.stack([view.fx * x / safe + view.cx, view.fy * y / safe + view.cy], 1) - 0.5

    def held(slope, size, focal, principal):
        beyond = (MARGIN - 1.0) * size / (2.0 * focal)
        return slope.clamp(-principal / focal - beyond, (size - principal) / focal + beyond)

    sx, sy = held(x / safe, view.width, view.fx, view.cx), held(y / safe, view.height, view.fy, view.cy)
    zero = torch.zeros_like(z)
    jacobian = torch.stack(
        [view.fx / safe, zero, -view.fx * sx / safe, zero, view.fy / safe, -view.fy * sy / safe], 1
    ).reshape(-1, 2, 3)
    spread = jacobian @ rotation @ (quaternion_matrices(splats.rotations) * splats.scales[:, None, :])
    covariance = spread @ spread.transpose(1, 2) + BLUR * torch.eye(2, dtype=z.dtype)
    a, b, c = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    determinant = a * c - b * b
    inverse = torch.stack([c, -b, a], 1) / determinant[:, None]
    with torch.no_grad():
        radius = torch.ceil(SIGMAS * torch.sqrt((a + c) / 2 + torch.sqrt(torch.clamp(((a - c) / 2) ** 2 + b * b, min=0.1))))
        grid = torch.tensor([math.ceil(view.width / TILE), math.ceil(view.height / TILE)])
        first = torch.clamp(torch.floor((mean - radius[:, None]) / TILE), min=0.0).minimum(grid).long()
        end = torch.clamp(torch.floor((mean + radius[:, None] + TILE - 1) / TILE), min=0.0).minimum(grid).long()
        visible = (z > NEAR) & (first < end).all(1) & (splats.opacities >= ALPHA_MIN)
        kept = visible.nonzero()[:, 0]
        kept = kept[torch.argsort(z[kept].float(), stable=True)]
    colour = torch.clamp(0.5 + torch.einsum("nk,nkc->nc", harmonics(offset, splats.sh.shape[1]), splats.sh), min=0.0)
    whole = {"mean": mean, "inverse": inverse, "depth": z, "opacity": splats.opacities, "colour": colour}
    return {name: value[kept] for name, value in whole.items()} | {"first": first[kept], "end": end[kept], "kept": kept}


def quaternion_matrices(rotations: torch.Tensor) -> torch.Tensor:
    """Rotation matrices [count, 3, 3] of quaternions (w, x, y, z), taken as they are."""
    w, x, y, z = rotations.unbind(1)
    entries = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return torch.stack(entries, 1).reshape(-1, 3, 3)


def harmonics(offset: torch.Tensor, count: int) -> torch.Tensor:
    """Real spherical harmonics [count of offsets, count] in the directions of the offsets."""
    x, y, z = (offset / offset.norm(dim=1, keepdim=True)).unbind(1)
    c0, c1, c2 = math.sqrt(1 / (4 * math.pi)), math.sqrt(3 / (4 * math.pi)), math.sqrt(15 / (4 * math.pi))
    c3 = [math.sqrt(35 / (32 * math.pi)), math.sqrt(105 / (4 * math.pi)), math.sqrt(21 / (32 * math.pi)), math.sqrt(7 / (16 * math.pi))]
    values = [torch.full_like(x, c0), -c1 * y, c1 * z, -c1 * x]
    values += [c2 * x * y, -c2 * y * z, c2 / (2 * math.sqrt(3)) * (2 * z * z - x * x - y * y), -c2 * x * z, c2 / 2 * (x * x - y * y)]
    values += [
        -c3[0] * y * (3 * x * x - y * y), c3[1] * x * y * z, -c3[2] * y * (4 * z * z - x * x - y * y),
        c3[3] * z * (2 * z * z - 3 * x * x - 3 * y * y), -c3[2] * x * (4 * z * z - x * x - y * y),
        c3[1] / 2 * z * (x * x - y * y), -c3[0] * x * (x * x - 3 * y * y),
    ]  # fmt: skip
    return torch.stack(values[:count], 1)


@torch.no_grad()
def tile_lists(flat: dict[str, torch.Tensor], view: View) -> tuple[torch.Tensor, torch.Tensor]:
    """Gaussians of all tiles, front to back within each, and where each tile's begin."""
    columns, rows = math.ceil(view.width / TILE), math.ceil(view.height / TILE)
    extent = flat["end"] - flat["first"]
    counts = extent.prod(1)
    gaussian = torch.repeat_interleave(torch.arange(len(counts)), counts)
    place = torch.arange(len(gaussian)) - (counts.cumsum(0) - counts)[gaussian]
    column = flat["first"][gaussian, 0] + place % extent[gaussian, 0]
    row = flat["first"][gaussian, 1] + torch.div(place, extent[gaussian, 0], rounding_mode="floor")
    tile, order = torch.sort(row * columns + column, stable=True)
    lengths = torch.bincount(tile, minlength=columns * rows)
    return gaussian[order], torch.cat([torch.zeros(1, dtype=torch.long), lengths.cumsum(0)])


def weights(flat: dict[str, torch.Tensor], lists: torch.Tensor, offsets: torch.Tensor, tiles: torch.Tensor, columns: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Blend weights in some tiles [tiles, Gaussians, pixels], and which Gaussians they are of [tiles, Gaussians]."""
    lengths = offsets[tiles + 1] - offsets[tiles]
    steps = torch.arange(int(lengths.max()))
    present = steps < lengths[:, None]
    chosen = lists[torch.where(present, offsets[tiles][:, None] + steps, torch.zeros(1, dtype=torch.long))]
    pixel = torch.arange(TILE * TILE)
    across = (tiles % columns * TILE)[:, None] + pixel % TILE
    down = torch.div(tiles, columns, rounding_mode="floor")[:, None] * TILE + torch.div(pixel, TILE, rounding_mode="floor")
    mean, inverse = flat["mean"][chosen], flat["inverse"][chosen]
    # [tiles, Gaussians, pixels]
    dx = mean[..., 0, None] - across[:, None, :]
    dy = mean[..., 1, None] - down[:, None, :]
    power = -0.5 * (inverse[..., 0, None] * dx * dx + inverse[..., 2, None] * dy * dy) - inverse[..., 1, None] * dx * dy
    opacity = torch.where(present, flat["opacity"][chosen], torch.zeros((), dtype=power.dtype))
    alpha = torch.clamp(opacity[..., None] * torch.exp(power), max=ALPHA_MAX)
    alpha = torch.where((alpha >= ALPHA_MIN) & (power <= 0), alpha, torch.zeros((), dtype=alpha.dtype))
    after = torch.cumprod(1.0 - alpha, 1)
    before = torch.cat([torch.ones_like(after[:, :1]), after[:, :-1]], 1)
    weight = torch.where(after >= TRANSMITTANCE_MIN, alpha * before, torch.zeros((), dtype=alpha.dtype))
    return weight, chosen
