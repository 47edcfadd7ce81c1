"""scene.usdc: the same scene as a USD stage, for everyone who doesn't read our files.

Blender exports geometry, animation (bodies with bones as skeletons) and cameras; usd-core then writes what
Blender can't: ids and semantic labels on the prims of each instance.
"""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSemantics, UsdShade, UsdSkel, Vt

from ..scene.scene import Scene
from ..scene.timeline import FPS, LAST_FRAME, PROFILES
from .files import atomic
from .tracks import rounded

_NAME_ATTRIBUTE = "userProperties:blender:object_name"
_DATA_ATTRIBUTE = "userProperties:blender:data_name"
_SET_OTHERWISE = {"connectionPaths", "custom", "default", "timeSamples", "typeName", "variability"}
_SAME_NORMAL = 1e-4


def write(scene: Scene, path: Path) -> None:
    """Writes the stage whole or not at all."""
    full = PROFILES["full"]
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = full.width, full.height  # the vertical aperture follows it
    with atomic(path) as temporary:
        as_usdc = temporary.with_suffix(".usdc")  # the suffix chooses the format
        try:
            _export(as_usdc)
            layer = _tidy_copy(Sdf.Layer.OpenAsAnonymous(str(as_usdc)))
            stage = Usd.Stage.Open(layer)
            _share_normals(stage)
            _colour_materials(stage)
            _annotate(stage, scene)
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
        export_armatures=True,
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


def _tidy_copy(source: Sdf.Layer) -> Sdf.Layer:
    """The same layer in one order and without what no reader needs.

    Blender's order of prims and properties changes from run to run. So does the order in which `Sdf.CopySpec`
    sets the fields of a property (by the addresses of their names), and usdc keeps all of these orders: every
    field is set here by itself, by name.
    """
    copy = Sdf.Layer.CreateAnonymous("scene.usdc")

    def wanted(spec: Sdf.AttributeSpec) -> bool:
        """Not what only Blender's materials read, nor normals per frame, which can be computed."""
        if spec.name == "normals":
            return source.GetNumTimeSamplesForPath(spec.path) == 0
        if spec.name.startswith(
            "inputs:"
        ):  # Blender takes any attribute behind a colour for the colour itself
            return not spec.connectionPathList.GetAddedOrExplicitItems()
        return not spec.name.startswith("primvars:") or spec.name.startswith("primvars:skel:")

    def reads_primvar(prim: Sdf.PrimSpec) -> bool:
        kind = prim.attributes.get("info:id")
        return kind is not None and str(kind.default).startswith("UsdPrimvarReader")

    def copy_prim(prim: Sdf.PrimSpec) -> None:
        made = Sdf.CreatePrimInLayer(copy, prim.path)
        for key in sorted(prim.ListInfoKeys()):
            made.SetInfo(key, prim.GetInfo(key))
        for spec in sorted(prim.properties, key=lambda spec: spec.name):
            if isinstance(spec, Sdf.RelationshipSpec):
                relationship = Sdf.RelationshipSpec(made, spec.name, spec.custom, spec.variability)
                relationship.targetPathList.explicitItems = spec.targetPathList.GetAddedOrExplicitItems()
            elif wanted(spec):
                copy_attribute(spec, made)
        for child in sorted(prim.nameChildren, key=lambda child: child.name):
            if not reads_primvar(child):
                copy_prim(child)

    def copy_attribute(spec: Sdf.AttributeSpec, owner: Sdf.PrimSpec) -> None:
        made = Sdf.AttributeSpec(owner, spec.name, spec.typeName, spec.variability, spec.custom)
        for key in sorted(set(spec.ListInfoKeys()) - _SET_OTHERWISE):
            made.SetInfo(key, spec.GetInfo(key))
        connections = spec.connectionPathList.GetAddedOrExplicitItems()
        if connections:
            made.connectionPathList.explicitItems = connections
        if spec.HasDefaultValue():
            made.default = spec.default
        for time in source.ListTimeSamplesForPath(spec.path):
            copy.SetTimeSample(spec.path, time, source.QueryTimeSample(spec.path, time))

    for root in sorted(source.rootPrims, key=lambda prim: prim.name):
        copy_prim(root)
    copy.defaultPrim = source.defaultPrim
    return copy


def _share_normals(stage: Usd.Stage) -> None:
    """Each normal once where corners of a vertex or a face have the same: half of a file otherwise."""
    for prim in stage.Traverse():
        mesh = UsdGeom.Mesh(prim)
        if not mesh or mesh.GetNormalsInterpolation() != UsdGeom.Tokens.faceVarying:
            continue
        normals = np.array(mesh.GetNormalsAttr().Get())
        vertices = np.array(mesh.GetFaceVertexIndicesAttr().Get())
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
        faces = np.repeat(np.arange(len(counts)), counts)
        for interpolation, owners, number in (
            (UsdGeom.Tokens.vertex, vertices, len(mesh.GetPointsAttr().Get())),
            (UsdGeom.Tokens.uniform, faces, len(counts)),
        ):
            shared = np.zeros((number, 3), np.float32)
            shared[owners] = normals
            if np.abs(shared[owners] - normals).max(initial=0.0) <= _SAME_NORMAL:
                mesh.GetNormalsAttr().Set(Vt.Vec3fArray.FromNumpy(shared))
                mesh.SetNormalsInterpolation(interpolation)
                break
        else:
            if not prim.HasAPI(UsdSkel.BindingAPI):  # skinning reads the attribute alone
                _index_normals(mesh, normals)


def _index_normals(mesh: UsdGeom.Mesh, normals: np.ndarray) -> None:
    """The attribute as a primvar, which may have indices; in the order of the corners, which packs best."""
    _, first, which = np.unique(normals, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order))
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "normals", Sdf.ValueTypeNames.Normal3fArray, UsdGeom.Tokens.faceVarying
    )
    primvar.Set(Vt.Vec3fArray.FromNumpy(normals[first[order]]))
    primvar.SetIndices(Vt.IntArray.FromNumpy(rank[which.ravel()]))
    mesh.GetPrim().RemoveProperty("normals")


def _colour_materials(stage: Usd.Stage) -> None:
    """One colour for each material whose colour varies: that with which Blender's own viewport shows it."""
    for prim in stage.Traverse():
        if not prim.IsA(UsdShade.Material):
            continue
        material = bpy.data.materials.get(prim.GetAttribute(_DATA_ATTRIBUTE).Get())
        nodes = material.node_tree.nodes if material and material.use_nodes else ()
        if any(node.type == "BSDF_PRINCIPLED" and node.inputs["Base Color"].is_linked for node in nodes):
            colour = Gf.Vec3f(*material.diffuse_color[:3])
            for shader in map(UsdShade.Shader, prim.GetChildren()):
                shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(colour)


def _annotate(stage: Usd.Stage, scene: Scene) -> None:
    stage.SetTimeCodesPerSecond(float(FPS))
    stage.SetFramesPerSecond(float(FPS))
    stage.SetStartTimeCode(0.0)
    stage.SetEndTimeCode(float(LAST_FRAME))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    layer = stage.GetRootLayer()
    layer.documentation = f"{scene.name}, variant 0, seed {scene.seed}"
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
