"""What the originals' own readers see in exports.

    python original_readers.py CHECKOUTS FOLDER

CHECKOUTS holds the repositories 4DGaussians, 4DLangSplat and nerfstudio; FOLDER the exports `4dgaussians`, `4dgaussians-dynerf`,
`4d-langsplat`, `colmap`, `nerfstudio`, and `probes.json`: points of the world and where each view sees them. Their code runs as it is, on
a processor: `.cuda()` does nothing, and extensions that need a GPU are empty modules, since readers only name them. Needs
PyTorch 1.12, torchvision, numpy, pillow, opencv-python-headless, plyfile, tqdm and scipy; nerfstudio's reader what it imports.
"""

import importlib
import json
import pathlib
import sys
import tempfile
import types
from typing import NamedTuple

import numpy as np
import torch

# Readers keep poses and fields of view in single precision.
TOLERANCE_PX = 1e-4
SIZE = (128, 96)
# 4DGaussians and its kin read pictures of Neu3D at half of 2704x2028.
NEU3D = (1352, 1014)


class Settings(NamedTuple):
    """The camera as the rasterizer of 3DGS takes it."""

    image_height: int
    image_width: int
    tanfovx: float
    tanfovy: float
    bg: torch.Tensor
    scale_modifier: float
    viewmatrix: torch.Tensor
    projmatrix: torch.Tensor
    sh_degree: int
    campos: torch.Tensor
    prefiltered: bool
    debug: bool


def on_a_processor() -> None:
    torch.Tensor.cuda = lambda self, *_, **__: self
    tensor = torch.tensor
    torch.tensor = lambda *values, device=None, **rest: tensor(*values, **rest)


def module(name: str, **content) -> types.ModuleType:
    made = types.ModuleType(name)
    made.__dict__.update(content)
    sys.modules[name] = made
    return made


def reader(checkout: pathlib.Path) -> dict:
    """The readers of 4DGaussians or one of its kin, by name, and its data set, which makes cameras."""
    for name in [name for name in sys.modules if name.split(".")[0] in ("scene", "utils")]:
        del sys.modules[name]
    sys.path.insert(0, str(checkout))
    module("scene", __path__=[str(checkout / "scene")])
    graphics = importlib.import_module("utils.graphics_utils")
    module("scene.gaussian_model", BasicPointCloud=graphics.BasicPointCloud)
    module("diff_gaussian_rasterization", GaussianRasterizationSettings=Settings)
    readers = importlib.import_module("scene.dataset_readers").sceneLoadTypeCallbacks
    dataset = importlib.import_module("scene.dataset").FourDGSdataset
    sys.path.remove(str(checkout))
    return {"readers": readers, "dataset": dataset}


def pixels(points: np.ndarray, full_projection: torch.Tensor, size: tuple) -> np.ndarray:
    """Where the rasterizer of 3DGS draws points: its pixels have their centres at whole numbers, ours at halves."""
    places = np.concatenate([points, np.ones((len(points), 1))], 1) @ full_projection.reshape(4, 4).numpy().astype(np.float64)
    places = places[:, :2] / places[:, 3:]
    return ((places + 1) * size - 1) / 2 + 0.5


def agree(found: np.ndarray, probes: list, size: tuple, who: str) -> float:
    expected = np.array([pixel for _, pixel in probes]) * (np.array(size) / SIZE)
    worst = np.abs(found - expected).max() * SIZE[0] / size[0]
    assert worst < TOLERANCE_PX, (who, worst)
    return worst


def points_of(probes: list) -> np.ndarray:
    return np.array([point for point, _ in probes])


def panoptic(checkout: pathlib.Path, root: pathlib.Path, probes: dict) -> list:
    """Cameras and times of the reader PanopticSports."""
    card = json.loads((root / "l4d-export.json").read_text())
    called = {entry["called"]: entry["name"] for entry in card["cameras"]}
    info = reader(checkout)["readers"]["PanopticSports"](str(root))
    assert len(info.train_cameras) == len(card["frames"]) * (len(called) - 1)
    names = json.loads((root / "train_meta.json").read_text())["fn"]
    names = [pathlib.PurePath(name).parent.as_posix() for moment in names for name in moment]
    worst = []
    for index, camera in enumerate(info.train_cameras):
        view = called.get(f"ims/{names[index]}") or called[names[index]]
        settings = camera["camera"]
        assert tuple(camera["image"].shape) == (3, SIZE[1], SIZE[0])
        found = pixels(points_of(probes[view]), settings.projmatrix, SIZE)
        worst.append(agree(found, probes[view], SIZE, view))
        moment = index // (len(called) - 1)
        assert abs(camera["time"] - card["trained"]["times"][moment]) < 1e-6
    return worst


def dynerf(checkout: pathlib.Path, root: pathlib.Path, probes: dict) -> list:
    """Cameras and times of the reader dynerf."""
    card = json.loads((root / "l4d-export.json").read_text())
    views = [entry["name"] for entry in sorted(card["cameras"], key=lambda entry: entry["called"])]
    parts = reader(checkout)
    info = parts["readers"]["dynerf"](str(root), False, True)
    data = parts["dataset"](info.train_cameras, None, "dynerf")
    moments = len(data) // (len(views) - 1)
    worst = []
    for place in range(0, len(data), max(1, moments // 3)):
        view, moment = views[1 + place // moments], place % moments
        camera = data[place]
        assert (camera.image_width, camera.image_height) == NEU3D
        found = pixels(points_of(probes[view]), camera.full_proj_transform, NEU3D)
        worst.append(agree(found, probes[view], NEU3D, view))
        if moment < len(card["frames"]):
            assert abs(float(camera.time) - card["trained"]["times"][moment]) < 1e-6, (camera.time, moment)
    return worst


def colmap(checkout: pathlib.Path, root: pathlib.Path, probes: dict) -> list:
    """Cameras of a model of COLMAP, by the loader of 3DGS that 4DGaussians carries."""
    parts = reader(checkout)
    loader, readers = (importlib.import_module(f"scene.{name}") for name in ("colmap_loader", "dataset_readers"))
    moment = root / "frame_0048"
    extrinsics = loader.read_extrinsics_binary(str(moment / "sparse/0/images.bin"))
    intrinsics = loader.read_intrinsics_binary(str(moment / "sparse/0/cameras.bin"))
    found = readers.readColmapCameras(extrinsics, intrinsics, str(moment / "images"))
    data = parts["dataset"](found, None, "colmap")
    worst = []
    for place, info in enumerate(found):
        at = pixels(points_of(probes[info.image_name]), data[place].full_proj_transform, SIZE)
        worst.append(agree(at, probes[info.image_name], SIZE, info.image_name))
    assert len(worst) == len(probes)
    return worst


def nerfstudio(checkout: pathlib.Path, root: pathlib.Path, probes: dict) -> list:
    """Cameras of the default reader of nerfstudio, with the options that the page of the export names."""
    sys.path.insert(0, str(checkout))
    parsers = importlib.import_module("nerfstudio.data.dataparsers.nerfstudio_dataparser")
    config = parsers.NerfstudioDataParserConfig(
        data=root / "frame_0048", orientation_method="none", center_method="none", auto_scale_poses=False, load_3D_points=False
    )
    parsed = config.setup().get_dataparser_outputs(split="train")
    worst = []
    for index, path in enumerate(parsed.image_filenames):
        camera, view = parsed.cameras[index], path.stem
        world_from_camera = np.eye(4)
        world_from_camera[:3] = camera.camera_to_worlds.numpy()
        assert (int(camera.width), int(camera.height)) == SIZE
        back = np.linalg.inv(parsed.dataparser_transform.numpy()[:, :3]) if parsed.dataparser_scale == 1 else None
        assert back is not None and np.allclose(back, np.eye(3)), "the world is turned"
        points = points_of(probes[view])
        seen = (points - world_from_camera[:3, 3]) @ world_from_camera[:3, :3] * [1, -1, -1]
        found = seen[:, :2] / seen[:, 2:] * [float(camera.fx), float(camera.fy)] + [float(camera.cx), float(camera.cy)]
        worst.append(agree(found, probes[view], SIZE, view))
    assert len(worst) == len(probes)
    return worst


def main() -> None:
    checkouts = pathlib.Path(sys.argv[1])
    on_a_processor()
    # The reader dynerf cuts paths at their first full stop, and temporary folders begin with one.
    with tempfile.TemporaryDirectory(prefix="exports") as folder:
        root = pathlib.Path(folder) / "all"
        root.symlink_to(pathlib.Path(sys.argv[2]).resolve())
        said = seen(checkouts, root)
    print(json.dumps({name: {"cameras": len(worst), "worst_px": max(worst)} for name, worst in said.items()}))


def seen(checkouts: pathlib.Path, root: pathlib.Path) -> dict:
    """Format -> how far off the reader's cameras are, pixels."""
    probes = json.loads((root / "probes.json").read_text())
    return {
        "4dgaussians": panoptic(checkouts / "4DGaussians", root / "4dgaussians", probes),
        "4dgaussians-dynerf": dynerf(checkouts / "4DGaussians", root / "4dgaussians-dynerf", probes),
        "4d-langsplat": dynerf(checkouts / "4DLangSplat", root / "4d-langsplat", probes),
        "colmap": colmap(checkouts / "4DGaussians", root / "colmap", probes),
        "nerfstudio": nerfstudio(checkouts / "nerfstudio", root / "nerfstudio", probes),
    }


if __name__ == "__main__":
    main()
