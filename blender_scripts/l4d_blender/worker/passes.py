"""The two Cycles passes of an image: beauty for people, and an exact one for depth and ids.

Two Blender scenes share all objects; each keeps its own Cycles session (persistent data), so that going from
one pass to the other costs little. The exact pass is one sample through each pixel's centre with every
material replaced by a plain emitter: nothing to blend, nothing to denoise, bit-stable. Writes only Blender's
own multilayer EXR files into a scratch folder; `exr` turns them into frames.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import OpenEXR

from ..scene.cameras import CAMERA_PREFIX

NO_HIT_M = 1.0e9  # Cycles writes 1e10 where the ray meets nothing
_GPU_KINDS = ("OPTIX", "CUDA", "HIP", "ONEAPI", "METAL")


class Renderer:
    """Renders images of the current Blender scene; make one per process, after the recipe has been built."""

    def __init__(
        self,
        width: int,
        height: int,
        samples: int,
        *,
        denoise: bool = True,
        threads: int = 0,
        exact: bool = True,
    ) -> None:
        self._scratch = tempfile.TemporaryDirectory(prefix="l4d-render-")
        self._beauty = bpy.context.scene
        self.device = choose_device()
        _common(self._beauty, width, height, threads, "GPU" if self.device != "CPU" else "CPU")
        _set_up_beauty(self._beauty, samples, denoise)
        self._exact = _exact_scene(self._beauty, width, height, threads) if exact else None

    @property
    def scenes(self) -> list[bpy.types.Scene]:
        """The Blender scenes of the passes: beauty, then exact."""
        return [scene for scene in (self._beauty, self._exact) if scene is not None]

    def beauty(self, camera: str, frame: int) -> np.ndarray:
        """Linear RGB, float32, height x width x 3.

        One camera at a time: in a multi-view render the noise of a view depends on the views before it, and
        a frame must not depend on which others are still missing.
        """
        channels = self._render(self._beauty, [camera], frame)
        return np.stack([channels[f"ViewLayer.Combined.{camera}.{c}"] for c in "RGB"], axis=-1)

    def exact(self, cameras: Sequence[str], frame: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Per camera planar depth in metres (float32, +inf where nothing is hit) and ids (uint32).

        One multi-view render: Cycles takes over the scene and builds its BVH once for all cameras, which
        is ten times as fast.
        """
        channels = self._render(self._exact, cameras, frame)
        images = {}
        for camera in cameras:
            depth = channels[f"ViewLayer.Depth.{camera}.Z"].astype(np.float32)
            ids = np.rint(channels[f"ViewLayer.IndexOB.{camera}.X"]).astype(np.uint32)
            images[camera] = np.where(depth >= NO_HIT_M, np.float32(np.inf), depth), ids
        return images

    def close(self) -> None:
        """Removes the scratch folder."""
        self._scratch.cleanup()

    def _render(self, scene: bpy.types.Scene, cameras: Sequence[str], frame: int) -> dict[str, np.ndarray]:
        file = Path(self._scratch.name) / "pass.exr"
        for view in scene.render.views:
            view.use = view.name in cameras
        scene.camera = bpy.data.objects[cameras[0]]
        scene.frame_set(frame)
        scene.render.filepath = str(file)
        # The operator's own `scene` argument would overwrite the scene's frame with the current scene's.
        with bpy.context.temp_override(scene=scene):
            bpy.ops.render.render(write_still=True)
        with OpenEXR.File(str(file), separate_channels=True) as picture:
            return {name: channel.pixels for name, channel in picture.channels().items()}


def choose_device() -> str:
    """Makes Cycles use the machine's GPUs if there are any; the kind used, or "CPU"."""
    if "cycles" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="cycles")
    preferences = bpy.context.preferences.addons["cycles"].preferences
    offered = {item[0] for item in preferences.get_device_types(bpy.context)}
    for kind in _GPU_KINDS:
        if kind not in offered:
            continue
        preferences.compute_device_type = kind
        preferences.refresh_devices()
        gpus = [device for device in preferences.devices if device.type == kind]
        if gpus:
            for device in preferences.devices:
                device.use = device.type == kind
            return kind
    preferences.compute_device_type = "NONE"
    return "CPU"


def _common(scene: bpy.types.Scene, width: int, height: int, threads: int, device: str) -> None:
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    cycles.device = device
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    render.use_persistent_data = True
    render.use_motion_blur = False
    render.use_compositing = render.use_sequencer = False
    render.film_transparent = False
    render.threads_mode = "FIXED" if threads > 0 else "AUTO"
    if threads > 0:
        render.threads = threads
    render.use_stamp = False
    render.use_multiview, render.views_format = True, "MULTIVIEW"
    for view in list(render.views)[1:]:
        render.views.remove(view)
    cameras = sorted(obj.name for obj in bpy.data.objects if obj.type == "CAMERA")
    for name, view in zip(cameras, [render.views[0], *(render.views.new(name) for name in cameras[1:])]):
        view.name = name
        view.camera_suffix = name.removeprefix(CAMERA_PREFIX)
    settings = render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    settings.exr_codec, settings.views_format = "NONE", "MULTIVIEW"
    cycles.seed = 0
    cycles.use_animated_seed = False
    cycles.use_auto_tile = False


def _set_up_beauty(scene: bpy.types.Scene, samples: int, denoise: bool) -> None:
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling = samples, False
    cycles.use_denoising = denoise
    cycles.denoiser, cycles.denoising_prefilter = "OPENIMAGEDENOISE", "FAST"
    cycles.max_bounces = 4
    cycles.diffuse_bounces, cycles.glossy_bounces = 3, 2
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.blur_glossy = 1.0
    cycles.sample_clamp_indirect = 4.0
    layer = scene.view_layers[0]
    layer.name = "ViewLayer"
    layer.use_pass_z = layer.use_pass_object_index = False


def _exact_scene(beauty: bpy.types.Scene, width: int, height: int, threads: int) -> bpy.types.Scene:
    scene = bpy.data.scenes.new(f"{beauty.name}.exact")
    _common(scene, width, height, threads, "CPU")
    for obj in beauty.objects:
        if obj.type != "LIGHT":
            scene.collection.objects.link(obj)
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 1, False, False
    cycles.max_bounces = 0
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    layer = scene.view_layers[0]
    layer.name = "ViewLayer"
    layer.use_pass_combined = True
    layer.use_pass_z = layer.use_pass_object_index = True
    layer.material_override = _plain_emitter()
    return scene


def _plain_emitter() -> bpy.types.Material:
    material = bpy.data.materials.new("exact pass")
    material.use_nodes = True
    material.cycles.emission_sampling = "NONE"  # else every triangle joins the light tree, a second per image
    tree = material.node_tree
    tree.nodes.clear()
    emitter = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(emitter.outputs["Emission"], output.inputs["Surface"])
    return material
