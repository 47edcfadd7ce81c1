"""Flat printed letters from Blender's built-in typeface.

Owns the way from a string to a mesh; knows nothing of what it is printed on. Letters lie in z = 0, face +Z,
read from -Y, centred on the origin.
"""

from __future__ import annotations

import bpy

from l4d_blender.assets import mesh


def lettering(
    name: str, text: str, height_m: float, *, spacing: float = 1.0, bold_m: float = 0.0
) -> bpy.types.Object:
    """One line of text whose capitals are `height_m` tall; `bold_m` fattens the strokes."""
    curve = bpy.data.curves.new(name, "FONT")
    curve.body = text
    curve.size = height_m / 0.73  # the typeface's capitals are 0.73 of its nominal size
    curve.space_character = spacing
    curve.offset = bold_m
    curve.resolution_u = 2
    curve.align_x, curve.align_y = "CENTER", "CENTER"
    typeset = bpy.data.objects.new(name, curve)
    bpy.context.scene.collection.objects.link(typeset)
    bpy.context.view_layer.update()
    data = bpy.data.meshes.new_from_object(typeset.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(typeset)
    bpy.data.curves.remove(curve)

    data.name = name
    printed = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(printed)
    printed.data.materials.clear()
    if printed.data.polygons and printed.data.polygons[0].normal.z < 0.0:
        printed.data.flip_normals()
    return mesh.shade_smooth(printed, 20.0)
