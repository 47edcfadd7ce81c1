"""Meshes from numbers: solids of revolution, bevelled boxes, tubes, lofts, and what one does to them.

All sizes are metres. Every function that makes an object links it to the current scene, at the world's
origin with unit scale. Knows shapes; refuses to know what they are for, and sets no materials by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, radians, sin

import bmesh
import bpy
from mathutils import Matrix, Vector

Point = Sequence[float]


def from_pydata(
    name: str, verts: Sequence[Point], faces: Sequence[Sequence[int]], smooth: bool = True
) -> bpy.types.Object:
    """An object from vertices and faces (counter-clockwise seen from outside)."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in verts], [], [tuple(f) for f in faces])
    mesh.validate()
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    return _link(name, mesh)


def lathe(
    name: str,
    profile: Sequence[tuple[float, float]],
    segments: int = 48,
    close_bottom: bool = True,
    close_top: bool = False,
) -> bpy.types.Object:
    """A solid of revolution round +Z from (radius, z) points, listed from the bottom upwards outside.

    For a vessel go up the outer wall, over the rim and down the inner wall to (0, z). A radius of 0 makes
    a pole; open ends are closed with a flat disc if asked.
    """
    verts: list[Point] = []
    rings: list[list[int]] = []
    points = list(profile)
    if close_bottom and points[0][0] > 0.0:
        points.insert(0, (0.0, points[0][1]))
    if close_top and points[-1][0] > 0.0:
        points.append((0.0, points[-1][1]))
    for r, z in points:
        count = 1 if r <= 0.0 else segments
        first = len(verts)
        rings.append(list(range(first, first + count)))
        verts += [(r * cos(2 * pi * i / segments), r * sin(2 * pi * i / segments), z) for i in range(count)]
    faces = [face for lower, upper in zip(rings, rings[1:]) for face in _strip(lower, upper)]
    return from_pydata(name, verts, faces)


def box(name: str, size_xyz: Point) -> bpy.types.Object:
    """A sharp box that stands on z = 0."""
    return bevel_box(name, size_xyz, 0.0)


def bevel_box(name: str, size_xyz: Point, bevel_m: float, segments: int = 3) -> bpy.types.Object:
    """A box with rounded edges that stands on z = 0, flat sides shaded flat."""
    x, y, z = size_xyz
    bm = bmesh.new()
    bmesh.ops.create_cube(
        bm, size=1.0, matrix=Matrix.Translation((0, 0, z / 2)) @ Matrix.Diagonal((x, y, z, 1))
    )
    bevel_m = min(bevel_m, 0.49 * min(size_xyz))
    if bevel_m > 0.0:
        bmesh.ops.bevel(
            bm,
            geom=bm.edges[:],
            offset=bevel_m,
            segments=segments,
            profile=0.5,
            affect="EDGES",
            clamp_overlap=True,
        )
    obj = _from_bmesh(name, bm)
    shade_smooth(obj, 35.0 if bevel_m > 0.0 else 1.0)
    return obj


def cylinder(
    name: str,
    radius: float,
    height: float,
    segments: int = 32,
    bevel_m: float = 0.0,
    top_radius: float | None = None,
) -> bpy.types.Object:
    """An upright cylinder (with `top_radius`: a cone or its stump) on z = 0, rims rounded by `bevel_m`."""
    top = radius if top_radius is None else top_radius
    b = min(bevel_m, 0.45 * height, 0.9 * max(min(radius, top), 0.0))
    if b > 0.0:
        arc = [(b * (1 - sin(a)), b * (1 - cos(a))) for a in (0, pi / 8, pi / 4, 3 * pi / 8, pi / 2)]
        profile = [(radius - inset, rise) for inset, rise in arc]
        profile += [(top - inset, height - rise) for inset, rise in reversed(arc)]
    else:
        profile = [(radius, 0.0), (top, height)]
    obj = lathe(name, profile, segments, close_bottom=True, close_top=True)
    shade_smooth(obj, 40.0)
    return obj


def ellipsoid(
    name: str, radii: Point, segments: int = 24, rings: int = 16, centre: Point = (0.0, 0.0, 0.0)
) -> bpy.types.Object:
    """An ellipsoid round `centre` with half axes `radii`."""
    profile = [(sin(pi * i / rings), -cos(pi * i / rings)) for i in range(rings + 1)]
    profile[0], profile[-1] = (0.0, -1.0), (0.0, 1.0)
    obj = lathe(name, profile, segments, close_bottom=False)
    transform(obj, Matrix.Translation(Vector(centre)) @ Matrix.Diagonal((*radii, 1.0)))
    return obj


def torus(name: str, major: float, minor: float, segments: int = 48, sides: int = 16) -> bpy.types.Object:
    """A ring in the XY plane round the origin."""
    loops = []
    for i in range(segments):
        a = 2 * pi * i / segments
        out = Vector((cos(a), sin(a), 0.0))
        angles = [2 * pi * j / sides for j in range(sides)]
        loops.append([out * (major + minor * cos(b)) + Vector((0, 0, -minor * sin(b))) for b in angles])
    return loft(name, loops, cap=False, closed=True)


def tube(
    name: str,
    points: Sequence[Point],
    radii: float | Sequence[float | tuple[float, float]],
    segments: int = 16,
    cap: bool = True,
    up: Point | None = None,
    closed: bool = False,
) -> bpy.types.Object:
    """A tube along points; radii per point, a number or a pair (sideways, along `up`) for an oval one.

    The section is carried along without twist. `up` is where the second radius of the first section points
    (default: +Z, or something perpendicular if the first span is upright).
    """
    line = [Vector(p).to_3d() for p in points]
    sizes = [radii] * len(line) if isinstance(radii, (int, float)) else list(radii)
    if len(sizes) != len(line):
        raise ValueError(f"{name}: {len(line)} points but {len(sizes)} radii")
    tangents = _tangents(line, closed)
    normal = _perpendicular(tangents[0], up)
    loops = []
    for i, (centre, size) in enumerate(zip(line, sizes)):
        if i > 0:
            normal = tangents[i - 1].rotation_difference(tangents[i]) @ normal
            normal = (normal - normal.project(tangents[i])).normalized()
        side = tangents[i].cross(normal)
        rx, ry = (size, size) if isinstance(size, (int, float)) else size
        angles = [2 * pi * k / segments for k in range(segments)]
        loops.append([centre + side * (rx * cos(a)) - normal * (ry * sin(a)) for a in reversed(angles)])
    return loft(name, loops, cap=cap, closed=closed)


def loft(
    name: str, sections: Sequence[Sequence[Point]], cap: bool = True, closed: bool = False
) -> bpy.types.Object:
    """A skin over closed sections with equally many points each; normals are made to point outwards."""
    count = len(sections[0])
    verts = [Vector(p) for section in sections for p in section]
    rings = [list(range(i * count, (i + 1) * count)) for i in range(len(sections))]
    faces = [face for lower, upper in zip(rings, rings[1:]) for face in _strip(lower, upper)]
    if closed:
        faces += _strip(rings[-1], rings[0])
    elif cap:
        for ring, flip in ((rings[0], True), (rings[-1], False)):
            middle = len(verts)
            verts.append(sum((verts[i] for i in ring), Vector()) / count)
            fan = [(ring[i], ring[(i + 1) % count], middle) for i in range(count)]
            faces += [face[::-1] for face in fan] if flip else fan
    obj = from_pydata(name, verts, faces)
    _face_outwards(obj)
    return obj


def grid(
    name: str,
    size_x: float,
    size_y: float,
    cells_x: int,
    cells_y: int,
    height: Callable[[float, float], float] | None = None,
) -> bpy.types.Object:
    """A flat or hilly sheet round the origin facing +Z; `height(x, y)` gives z."""
    verts = []
    for j in range(cells_y + 1):
        for i in range(cells_x + 1):
            x, y = size_x * (i / cells_x - 0.5), size_y * (j / cells_y - 0.5)
            verts.append((x, y, height(x, y) if height else 0.0))
    row = cells_x + 1
    faces = [
        (j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
        for j in range(cells_y)
        for i in range(cells_x)
    ]
    return from_pydata(name, verts, faces)


def duplicate(obj: bpy.types.Object, name: str, *, linked: bool = False) -> bpy.types.Object:
    """A copy of an object; `linked` shares its mesh (cheap: for scenery that repeats)."""
    copy = obj.copy()
    copy.name = name
    if not linked:
        copy.data = obj.data.copy()
        copy.data.name = name
    copy.animation_data_clear()
    bpy.context.scene.collection.objects.link(copy)
    return copy


def join(name: str, objects: Sequence[bpy.types.Object]) -> bpy.types.Object:
    """Joins mesh objects into one at the world's origin: materials and groups stay, the parts don't."""
    objects = [apply_modifiers(obj) for obj in objects]
    if any(obj.parent for obj in objects):
        bpy.context.view_layer.update()
    for obj in objects:
        matrix = obj.matrix_world.copy() if obj.parent else obj.matrix_basis.copy()
        obj.parent = None
        if obj.data.users > 1:
            obj.data = obj.data.copy()
        obj.data.transform(matrix)
        if matrix.is_negative:
            obj.data.flip_normals()
        obj.matrix_basis = Matrix.Identity(4)
    target = objects[0]
    if len(objects) > 1:
        meshes = [obj.data for obj in objects[1:]]
        with bpy.context.temp_override(
            active_object=target, object=target, selected_objects=objects, selected_editable_objects=objects
        ):
            bpy.ops.object.join()
        bpy.data.batch_remove(meshes)  # one by one, each walks all that Blender has
    target.name = target.data.name = name
    return target


def apply_modifiers(obj: bpy.types.Object) -> bpy.types.Object:
    """Bakes all modifiers into the mesh."""
    if not obj.modifiers:
        return obj
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(depsgraph)
    baked = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)
    old, name = obj.data, obj.data.name
    obj.modifiers.clear()
    obj.data = baked
    if old.users == 0:
        bpy.data.meshes.remove(old)
    baked.name = name
    return obj


def subdivide(obj: bpy.types.Object, levels: int) -> bpy.types.Object:
    """Catmull-Clark subdivision, baked."""
    modifier = obj.modifiers.new("subdivide", "SUBSURF")
    modifier.levels = modifier.render_levels = levels
    return apply_modifiers(obj)


def solidify(obj: bpy.types.Object, thickness: float, *, offset: float = -1.0) -> bpy.types.Object:
    """Gives a sheet a thickness in metres (offset -1: inwards, 0: both ways, 1: outwards), baked."""
    modifier = obj.modifiers.new("solidify", "SOLIDIFY")
    modifier.thickness, modifier.offset = thickness, offset
    return apply_modifiers(obj)


def bevel(
    obj: bpy.types.Object, width_m: float, segments: int = 3, angle_deg: float = 30.0
) -> bpy.types.Object:
    """Rounds all edges sharper than an angle, baked."""
    modifier = obj.modifiers.new("bevel", "BEVEL")
    modifier.width, modifier.segments = width_m, segments
    modifier.limit_method, modifier.angle_limit = "ANGLE", radians(angle_deg)
    return apply_modifiers(obj)


def decimate(obj: bpy.types.Object, ratio: float) -> bpy.types.Object:
    """Collapses edges until about `ratio` of the faces remain, baked."""
    modifier = obj.modifiers.new("decimate", "DECIMATE")
    modifier.ratio = ratio
    return apply_modifiers(obj)


def voxel_union(
    name: str, objects: Sequence[bpy.types.Object], voxel_m: float, smooth_iterations: int = 4
) -> bpy.types.Object:
    """Melts overlapping closed solids into one skin of `voxel_m` resolution; materials are lost."""
    obj = join(name, objects)
    remesh = obj.modifiers.new("remesh", "REMESH")
    remesh.mode, remesh.voxel_size, remesh.use_smooth_shade = "VOXEL", voxel_m, True
    if smooth_iterations > 0:
        smooth = obj.modifiers.new("smooth", "SMOOTH")
        smooth.factor, smooth.iterations = 0.5, smooth_iterations
    apply_modifiers(obj)
    shade_smooth(obj)
    return obj


def displace(obj: bpy.types.Object, offset: Callable[[Vector, Vector], Vector | float]) -> bpy.types.Object:
    """Moves each vertex by `offset(position, normal)`: a vector, or metres along the normal."""
    moved = []
    for vertex in obj.data.vertices:
        by = offset(vertex.co.copy(), vertex.normal.copy())
        moved.append(vertex.co + (vertex.normal * by if isinstance(by, (int, float)) else by))
    for vertex, co in zip(obj.data.vertices, moved):
        vertex.co = co
    obj.data.update()
    return obj


def set_material(obj: bpy.types.Object, material: bpy.types.Material) -> bpy.types.Object:
    """Gives the whole mesh one material."""
    obj.data.materials.clear()
    obj.data.materials.append(material)
    obj.data.polygons.foreach_set("material_index", [0] * len(obj.data.polygons))
    return obj


def paint(
    obj: bpy.types.Object, materials: Sequence[bpy.types.Material], choose: Callable[[Vector, Vector], int]
) -> bpy.types.Object:
    """Several materials on one mesh: `choose(face centre, face normal)` gives the index of each face's."""
    obj.data.materials.clear()
    for material in materials:
        obj.data.materials.append(material)
    for polygon in obj.data.polygons:
        polygon.material_index = choose(polygon.center.copy(), polygon.normal.copy())
    return obj


def shade_smooth(obj: bpy.types.Object, angle_deg: float | None = None) -> bpy.types.Object:
    """Smooth shading, except over edges sharper than `angle_deg` if that is given."""
    mesh = obj.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if angle_deg is not None:
        mesh.set_sharp_from_angle(angle=radians(angle_deg))
    return obj


def transform(obj: bpy.types.Object, matrix: Matrix) -> bpy.types.Object:
    """Moves the mesh itself (not the object's matrix)."""
    obj.data.transform(matrix)
    if matrix.is_negative:
        obj.data.flip_normals()
    obj.data.update()
    return obj


def move(obj: bpy.types.Object, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> bpy.types.Object:
    """Shifts the mesh itself."""
    return transform(obj, Matrix.Translation((x, y, z)))


def rotate(obj: bpy.types.Object, axis: str, angle_deg: float) -> bpy.types.Object:
    """Turns the mesh itself round an axis ("X", "Y" or "Z") through the origin."""
    return transform(obj, Matrix.Rotation(radians(angle_deg), 4, axis))


def drop_to_base(obj: bpy.types.Object) -> bpy.types.Object:
    """Shifts the mesh so that its lowest point is at z = 0."""
    return move(obj, z=-min(vertex.co.z for vertex in obj.data.vertices))


def store_rest_position(obj: bpy.types.Object) -> bpy.types.Object:
    """Keeps the undeformed coordinates as an attribute, so that textures stick to a body that bends."""
    mesh = obj.data
    attribute = mesh.attributes.get("rest_position") or mesh.attributes.new(
        "rest_position", "FLOAT_VECTOR", "POINT"
    )
    flat = [0.0] * (3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", flat)
    attribute.data.foreach_set("vector", flat)
    return obj


def triangle_count(obj: bpy.types.Object) -> int:
    """Triangles of the mesh as it is stored."""
    return sum(len(polygon.vertices) - 2 for polygon in obj.data.polygons)


def _link(name: str, mesh: bpy.types.Mesh) -> bpy.types.Object:
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def _from_bmesh(name: str, bm: bmesh.types.BMesh) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    bm.normal_update()
    bm.to_mesh(mesh)
    bm.free()
    return _link(name, mesh)


def _strip(lower: Sequence[int], upper: Sequence[int]) -> list[tuple[int, ...]]:
    """Faces between two rings, either of which may be a pole; outwards if the rings turn left and rise."""
    count = max(len(lower), len(upper))
    if len(lower) == 1 and len(upper) == 1:
        return []
    if len(lower) == 1:
        return [(lower[0], upper[(i + 1) % count], upper[i]) for i in range(count)]
    if len(upper) == 1:
        return [(lower[i], lower[(i + 1) % count], upper[0]) for i in range(count)]
    return [(lower[i], lower[(i + 1) % count], upper[(i + 1) % count], upper[i]) for i in range(count)]


def _tangents(line: Sequence[Vector], closed: bool) -> list[Vector]:
    last = len(line) - 1
    tangents = []
    for i in range(len(line)):
        before = line[i - 1] if i > 0 or closed else line[0]
        after = line[i + 1] if i < last else (line[0] if closed else line[last])
        tangents.append((after - before).normalized())
    return tangents


def _perpendicular(tangent: Vector, up: Point | None) -> Vector:
    wanted = Vector(up) if up is not None else Vector((0.0, 0.0, 1.0))
    if abs(tangent.dot(wanted.normalized())) > 0.95:
        wanted = Vector((0.0, 1.0, 0.0)) if abs(tangent.y) < 0.9 else Vector((1.0, 0.0, 0.0))
    return (wanted - wanted.project(tangent)).normalized()


def _face_outwards(obj: bpy.types.Object) -> None:
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])
    bm.to_mesh(obj.data)
    bm.free()
