"""Reads exports with the readers that other people use, and checks what they see.

    python readers.py FOLDER

FOLDER holds the exports `colmap`, `coco`, `davis`, `4dgaussians`, `4dgaussians-dynerf`,
`4d-langsplat-annotations`, those of a capture in `captured`, and `probes.json`: points of the world and where each view sees them.
Needs numpy, pillow, opencv-python-headless, plyfile, pycocotools and pycolmap.
"""

import json
import pathlib
import sys

import cv2
import numpy as np
import pycolmap
from PIL import Image
from plyfile import PlyData
from pycocotools.coco import COCO

TOLERANCE_PX = 1e-4


def check_colmap(root: pathlib.Path, probes: dict) -> int:
    seen = 0
    model = pycolmap.Reconstruction(root / "colmap" / "frame_0048" / "sparse" / "0")
    assert len(model.images) == 4 and len(model.points3D) > 300
    for image in model.images.values():
        for point, pixel in probes[image.name.removesuffix(".png")]:
            found = image.project_point(np.array(point))
            assert np.abs(found - pixel).max() < TOLERANCE_PX, (image.name, found, pixel)
            seen += 1
    for point in model.points3D.values():
        for element in point.track.elements:
            image = model.images[element.image_id]
            at = image.points2D[element.point2D_idx]
            assert at.point3D_id in model.points3D
            assert np.abs(image.project_point(point.xyz) - at.xy).max() < TOLERANCE_PX
            seen += 1
    return seen


def check_masks(root: pathlib.Path) -> int:
    coco = COCO(root / "coco" / "instances_train.json")
    numbers = {}
    manifest = json.loads((root / "davis" / "l4d-export.json").read_text())
    instances = json.loads((root / "coco" / "l4d-export.json").read_text())["instances"]
    ids = {entry["name"]: int(entry["called"]) for entry in instances}
    for entry in manifest["instances"]:
        numbers[ids[entry["name"]]] = int(entry["called"])
    seen = 0
    for annotation in coco.anns.values():
        image = coco.imgs[annotation["image_id"]]
        mask = coco.annToMask(annotation).astype(bool)
        assert mask.sum() == annotation["area"]
        number = numbers.get(annotation["instance_id"])
        if number is None:
            continue
        moment = manifest["frames"].index(image["frame"])
        sequence = root / "davis" / "Annotations" / "480p" / f"closed_form_{image['view']}"
        palette = Image.open(sequence / f"{moment:05}.png")
        assert palette.mode == "P"
        assert ((np.array(palette) == number) == mask).all(), annotation["id"]
        picture = sequence.parents[2] / "JPEGImages" / "480p" / sequence.name / f"{moment:05}.jpg"
        assert Image.open(picture).size == palette.size
        seen += 1
    return seen


def check_prompts(root: pathlib.Path) -> int:
    """OpenCV fills what the evaluator of 4D LangSplat would, and that is what COCO's tools decode."""
    truth = COCO(root / "coco" / "instances_test.json")
    document = json.loads((root / "4d-langsplat-annotations/annotations/train/_annotations.coco.json").read_text())
    names = {category["id"]: category["name"] for category in document["categories"]}
    meant = {"the ball that rolls": [1], "ball late": [7], "the two balls": [1, 7]}
    seen = 0
    for image in document["images"]:
        frame = 12 * int(image["file_name"].split("_")[0])
        for prompt, instances in meant.items():
            filled = np.zeros((image["height"], image["width"]), np.uint8)
            for annotation in document["annotations"]:
                if annotation["image_id"] == image["id"] and names[annotation["category_id"]] == prompt:
                    corners = np.array(annotation["segmentation"][0]).reshape(-1, 2).astype(np.int32)
                    cv2.fillPoly(filled, [corners], 1)
            expected = np.zeros((96, 128), np.uint8)
            for annotation in truth.anns.values():
                if truth.imgs[annotation["image_id"]]["frame"] == frame and annotation["instance_id"] in instances:
                    expected |= truth.annToMask(annotation)
            expected = np.array(Image.fromarray(expected).resize(filled.shape[::-1], Image.Resampling.NEAREST))
            assert (filled == expected).all(), (prompt, frame)
            seen += int(expected.sum())
    return seen


def check_arrays(root: pathlib.Path) -> int:
    points = np.load(root / "4dgaussians" / "init_pt_cld.npz")["data"]
    assert points.shape[1] == 6 and np.isfinite(points).all()
    poses = np.load(root / "4dgaussians-dynerf" / "poses_bounds.npy")
    assert poses.shape == (5, 17) and poses.dtype == np.float64
    vertices = PlyData.read(root / "4dgaussians-dynerf" / "points3D_downsample2.ply")["vertex"]
    for name in ("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"):
        assert len(vertices[name]) == len(points)
    assert np.abs(np.array(vertices["x"]) - points[:, 0]).max() < 1e-5
    return len(points)


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    expected = json.loads((folder / "probes.json").read_text())
    without = pycolmap.Reconstruction(folder / "captured/without/frame_0048/sparse/0")
    assert (len(without.images), len(without.points3D)) == (4, 0)
    seen = [check_colmap(folder, expected), check_colmap(folder / "captured", expected)]
    print(*seen, check_masks(folder), check_prompts(folder), check_arrays(folder))
