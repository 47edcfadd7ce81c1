"""Frames: the EXR contract, exact ids and depth, and equality between sessions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import raycast
from conftest import HEIGHT, TOY, WIDTH, events_of, start_worker, write_job

from l4d_blender.worker import recipes
from l4d_blender.worker.exr import read_frame, write_frame


def frames(folder: Path) -> list[Path]:
    return sorted((folder / "frames").glob("*/*.exr"))


def test_a_frame_is_one_zip_part_of_three_halves_a_float_and_a_uint(rendered):
    for path in frames(rendered):
        with OpenEXR.File(str(path), separate_channels=True) as picture:
            assert len(picture.parts) == 1
            header = dict(picture.header())
            kinds = {name: channel.pixels.dtype for name, channel in picture.channels().items()}
            shapes = {channel.pixels.shape for channel in picture.channels().values()}
        assert kinds == {"R": "float16", "G": "float16", "B": "float16", "Z": "float32", "id": "uint32"}
        assert shapes == {(HEIGHT, WIDTH)}
        assert header["compression"] == OpenEXR.ZIP_COMPRESSION
        assert header["type"] == OpenEXR.scanlineimage
        told = {"capDate", "owner", "comments", "Date", "Host", "Software", "RenderTime"} & set(header)
        assert not told, "a header must not say when, where or by whom"


def test_colour_is_finite_and_depth_is_positive_or_infinite(rendered):
    for path in frames(rendered):
        rgb, depth, ids = read_frame(path)
        assert np.isfinite(rgb).all()
        assert (rgb >= 0.0).all()
        assert (rgb.astype(np.float32).mean(axis=(0, 1)) > 0.02).all()
        assert (depth > 0.0).all()
        assert not np.isnan(depth).any()
        assert (ids[np.isinf(depth)] == 0).all()


def test_view_json_has_square_pixels_and_a_central_principal_point(rendered, tracks):
    for camera in tracks["cameras"]:
        path = rendered / "frames" / camera["name"] / "view.json"
        if not path.exists():
            continue
        view = json.loads(path.read_text())
        assert view["schema"] == "l4d/view/1"
        assert view["split"] == camera["split"]
        assert view["fx"] == view["fy"] == pytest.approx(camera["focal_over_width"] * WIDTH)
        assert (view["cx"], view["cy"]) == (WIDTH / 2, HEIGHT / 2)
        assert view["world_from_camera"] == camera["world_from_camera"]


def test_ids_and_depth_equal_float64_ray_casting_at_pixel_centres(rendered):
    recipes.build("toy_yard", folder=TOY)
    for frame in (0, 48, 96):
        triangles, numbers = raycast.scene_triangles(frame)
        for folder in sorted((rendered / "frames").iterdir()):
            view = json.loads((folder / "view.json").read_text())
            expected_depth, expected_ids = raycast.cast(triangles, numbers, view, WIDTH, HEIGHT)
            _, depth, ids = read_frame(folder / f"{frame:04}.exr")
            assert (ids != expected_ids).sum() == 0
            assert {1, 2, 3, 4, 1001} & set(np.unique(ids)), "an empty picture proves nothing"
            both = np.isfinite(depth) & np.isfinite(expected_depth)
            assert (np.isinf(depth) != np.isinf(expected_depth)).sum() == 0
            relative = np.abs(depth[both] - expected_depth[both]) / expected_depth[both]
            assert np.quantile(relative, 0.999) < 1e-5
            assert relative.max() < 1e-4, "a surface seen edge-on magnifies the camera's float32 rounding"


def test_a_fresh_session_writes_the_same_depth_and_ids(rendered, planned, test_view, tmp_path):
    job = write_job(
        tmp_path / "job.json", tmp_path, planned / "tracks.json", [(test_view, 48)], {"threads": 1}
    )
    assert start_worker("render", str(job)).returncode == 0
    again, before = (folder / "frames" / test_view / "0048.exr" for folder in (tmp_path, rendered))
    for a, b in zip(read_frame(again)[1:], read_frame(before)[1:]):
        assert np.array_equal(a, b)
    colour_a, colour_b = (read_frame(path)[0].astype(np.float32) for path in (again, before))
    assert np.abs(colour_a - colour_b).max() <= 1e-4 + np.spacing(np.float16(colour_b.max()))


def test_only_whole_files_remain(rendered):
    left = {path.name for path in (rendered / "frames").rglob("*") if path.is_file()}
    assert left == {"view.json", "0000.exr", "0048.exr", "0096.exr"}


def test_the_same_arrays_give_the_same_bytes(tmp_path):
    rgb = np.linspace(0, 2, 5 * 4 * 3, dtype=np.float32).reshape(4, 5, 3)
    depth = np.full((4, 5), np.inf, dtype=np.float32)
    ids = np.arange(20, dtype=np.uint32).reshape(4, 5)
    for name in ("a.exr", "b.exr"):
        write_frame(tmp_path / name, rgb, depth, ids)
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    assert np.array_equal(read_frame(tmp_path / "a.exr")[2], ids)


def test_a_failed_write_leaves_the_old_frame_and_no_rubbish(tmp_path, monkeypatch):
    path = tmp_path / "0000.exr"
    rgb, depth, ids = np.zeros((2, 2, 3)), np.ones((2, 2)), np.ones((2, 2), dtype=np.uint32)
    write_frame(path, rgb, depth, ids)
    before = path.read_bytes()

    def torn(self, name):
        Path(name).write_bytes(b"half a fra")
        raise RuntimeError("write failed")

    monkeypatch.setattr(OpenEXR.File, "write", torn)
    with pytest.raises(OSError, match="write failed"):
        write_frame(path, rgb, depth, ids)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["0000.exr"]


def test_the_start_event_names_the_device(planned, test_view, tmp_path):
    job = write_job(tmp_path / "job.json", tmp_path, planned / "tracks.json", [(test_view, 0)])
    process = start_worker("render", str(job))
    start = events_of(process)[0]
    assert start["event"] == "start"
    assert start["device"] in {"CPU", "OPTIX", "CUDA", "HIP", "ONEAPI", "METAL"}
