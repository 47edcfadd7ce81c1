# %% [markdown]
# Scores a method of thirty lines. Open this file as a notebook (VS Code and Jupyter know the `# %%`), or run it:
#
#     l4d build-scenes --profile tiny --scenes tabletop_tea
#     python crates/l4d-py/examples/score_your_method.py benchmark data/tiny/tabletop_tea results scores
#
# The method answers every query with whatever moves. It looks at the training cameras alone: where their light changes
# over time, it takes the points of the surface into the held-out camera.

# %%
import sys
from pathlib import Path
from time import perf_counter

import numpy as np

import l4d

BENCHMARK, SCENE, RESULTS, SCORES = map(Path, sys.argv[1:5])

# %% [markdown]
# ## What there is

# %%
scene = l4d.Scene(SCENE)
benchmark = l4d.Benchmark(BENCHMARK, profile=scene.profile)
print(scene, benchmark)
for query in benchmark.queries(scene.name):
    print(f"{query.id}  {query.text}")

# %% [markdown]
# ## A trivial method: points that move, seen from the held-out camera


# %%
def moving_points(camera: l4d.Camera) -> list[np.ndarray]:
    """World points (N, 3) that move at each frame, as one training camera sees them."""
    clip = scene.clip(camera.name)
    still = np.median(clip.rgb, axis=0)
    changes = np.abs(clip.rgb - still).max(axis=-1) > 0.1
    seen = changes & np.isfinite(clip.depth_m)
    return [camera.unproject(clip.depth_m[at], frame)[seen[at]] for at, frame in enumerate(clip.frames)]


def splatted(points: np.ndarray, camera: l4d.Camera, frame: int) -> np.ndarray:
    """The pixels (H, W) of a camera that points fall into, and their neighbours."""
    mask = np.zeros((camera.height, camera.width), dtype=bool)
    positions, depth_m = camera.project(points, frame)
    columns, rows = np.floor(positions[depth_m > 0]).astype(int).T
    inside = (columns >= 1) & (columns < camera.width - 1) & (rows >= 1) & (rows < camera.height - 1)
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            mask[rows[inside] + down, columns[inside] + right] = True
    return mask


start = perf_counter()
clouds = [moving_points(camera) for camera in scene.training_cameras]
target = scene.test_camera
whatever_moves = {
    frame: splatted(np.concatenate([cloud[at] for cloud in clouds]), target, frame)
    for at, frame in enumerate(scene.frames)
}

# %% [markdown]
# ## Results: a run that is killed here goes on where it was
#
# `depth`: the depth of the training views is that of the renderer, which no camera has. Methods that learn from it are
# ranked in a track of their own.

# %%
writer = l4d.ResultsWriter(RESULTS / "whatever-moves", benchmark, version="1", depth=True)
for query in writer.remaining(scene.name):
    writer.write(query, whatever_moves)
writer.finish(perf_counter() - start)
for finding in l4d.check(writer.path, benchmark, scenes=[scene.name]):
    print(finding)

# %% [markdown]
# ## Scores, beside a baseline that knows the answers and one that marks everything

# %%
for baseline in ("oracle", "all"):
    l4d.write_baseline(baseline, benchmark, RESULTS, scenes=[scene.name])
document = l4d.score(RESULTS, benchmark, scenes=[scene.name], scores=SCORES)
print(f"{'method':<16}{'mIoU':>8}{'mAcc':>8}{'tube':>8}{'select':>8}")
for method in document["methods"]:
    numbers = (method[metric] for metric in ("miou", "macc", "tube_iou", "select"))
    print(f"{method['name']:<16}" + "".join(f"{number:8.2f}" for number in numbers))
