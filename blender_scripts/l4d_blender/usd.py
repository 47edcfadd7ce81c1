"""scene.usdc: the same scene as a USD stage, for everyone who doesn't read our files.

Blender exports geometry, animation (baked: no skeletons) and cameras; usd-core then writes what Blender
can't: ids and semantic labels on the prims of each instance.
"""

from __future__ import annotations

from pathlib import Path

import bpy
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSemantics

from .files import atomic
from .scene import Scene
from .timeline import FPS, LAST_FRAME, PROFILES
from .tracks import rounded

_NAME_ATTRIBUTE = "userProperties:blender:object_name"


def write(scene: Scene, path: Path) -> None:
    """Writes the stage whole or not at all."""
    full = PROFILES["full"]
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = full.width, full.height  # the vertical aperture follows it
    with atomic(path) as temporary:
        as_usdc = temporary.with_suffix(".usdc")  # the suffix chooses the format
        try:
            _export(as_usdc)
            layer = _sorted_copy(Sdf.Layer.OpenAsAnonymous(str(as_usdc)))
            _annotate(Usd.Stage.Open(layer), scene)
            layer.Export(str(as_usdc))
            as_usdc.replace(temporary)
        finally:
            as_usdc.unlink(missing_ok=True)


def _export(path: Path) -> None:
    bpy.context.scene.frame_set(0)
    bpy.ops.wm.usd_export(
        filepath=str(path),
        check_existing=False,
        export_animation=True,
        export_armatures=False,
        export_shapekeys=False,
        export_hair=False,
        export_uvmaps=False,
        export_mesh_colors=False,
        export_normals=True,
        export_materials=True,
        generate_preview_surface=True,
        export_textures_mode="KEEP",
        convert_world_material=False,
        export_lights=True,
        export_cameras=True,
        export_custom_properties=True,
        author_blender_name=True,
        use_instancing=True,
        evaluation_mode="RENDER",
        root_prim_path="/scene",
    )


def _sorted_copy(source: Sdf.Layer) -> Sdf.Layer:
    """The same layer with prims and properties by name: Blender's order changes from run to run."""
    copy = Sdf.Layer.CreateAnonymous("scene.usdc")

    def wanted(spec: Sdf.PropertySpec) -> bool:
        """Normals of a deforming mesh are four fifths of a file, and readers can compute them."""
        return spec.name != "normals" or source.GetNumTimeSamplesForPath(spec.path) == 0

    def copy_prim(prim: Sdf.PrimSpec) -> None:
        made = Sdf.CreatePrimInLayer(copy, prim.path)
        for key in sorted(prim.ListInfoKeys()):
            made.SetInfo(key, prim.GetInfo(key))
        for spec in sorted(filter(wanted, prim.properties), key=lambda spec: spec.name):
            Sdf.CopySpec(source, spec.path, copy, spec.path)
        for child in sorted(prim.nameChildren, key=lambda child: child.name):
            copy_prim(child)

    for root in sorted(source.rootPrims, key=lambda prim: prim.name):
        copy_prim(root)
    copy.defaultPrim = source.defaultPrim
    return copy


def _annotate(stage: Usd.Stage, scene: Scene) -> None:
    stage.SetTimeCodesPerSecond(float(FPS))
    stage.SetFramesPerSecond(float(FPS))
    stage.SetStartTimeCode(0.0)
    stage.SetEndTimeCode(float(LAST_FRAME))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    layer = stage.GetRootLayer()
    layer.documentation = f"{scene.name}, variant {scene.variant}, seed {scene.seed}"
    prims = {
        prim.GetAttribute(_NAME_ATTRIBUTE).Get(): prim
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Xform) and prim.HasAttribute(_NAME_ATTRIBUTE)
    }
    for instance in scene.instances:
        for obj in instance.objects:
            prim = prims[obj.name]
            _attribute(prim, "l4d:id", Sdf.ValueTypeNames.Int, instance.id)
            _attribute(prim, "l4d:name", Sdf.ValueTypeNames.String, instance.name)
            _attribute(prim, "l4d:category", Sdf.ValueTypeNames.String, instance.category)
            for taxonomy, label in (("category", instance.category), ("name", instance.name)):
                UsdSemantics.LabelsAPI.Apply(prim, taxonomy).CreateLabelsAttr([label])
    for camera, obj in zip(scene.camera_rig, scene.camera_objects):
        prim = prims[obj.name]
        _attribute(prim, "l4d:focal_over_width", Sdf.ValueTypeNames.Double, camera.focal_over_width)
        matrix = Gf.Matrix4d(*rounded([x for column in camera.world_from_camera.col for x in column]))
        _attribute(prim, "l4d:world_from_camera", Sdf.ValueTypeNames.Matrix4d, matrix)


def _attribute(prim: Usd.Prim, name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    prim.CreateAttribute(name, kind, custom=True).Set(value)
