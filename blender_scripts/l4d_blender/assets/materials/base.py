"""Materials from nodes: a Principled surface and a small builder for what drives it.

Knows how nodes connect; refuses to know what wood, skin or grass look like (the sibling modules do).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import bpy

from ...scene.colour import Colour

Socket: TypeAlias = bpy.types.NodeSocket
Value: TypeAlias = Socket | float | Sequence[float]


def principled(
    name: str,
    colour: Colour,
    *,
    roughness: float = 0.6,
    metallic: float = 0.0,
    specular: float = 0.5,
    sheen: float = 0.0,
    coat: float = 0.0,
    variation: float = 0.0,
    variation_scale: float = 6.0,
    bump: tuple[float, float] | None = None,
) -> bpy.types.Material:
    """A new Principled material of a linear RGB colour.

    `variation` (0..1) lets noise darken and lighten the colour, `variation_scale` is in features per metre;
    `bump` = (features per metre, height in metres).
    """
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    n.set("Roughness", roughness)
    n.set("Metallic", metallic)
    n.set("Specular IOR Level", specular)
    n.set("Sheen Weight", sheen)
    n.set("Coat Weight", coat)
    rgb = tuple(colour[:3])
    if variation > 0.0:
        dark = tuple(c * (1.0 - variation) for c in rgb)
        light = tuple(min(c * (1.0 + 0.6 * variation), 1.0) for c in rgb)
        n.set("Base Color", n.ramp(n.noise(variation_scale, 4.0), [(0.3, dark), (0.7, light)]))
    else:
        n.set("Base Color", rgb)
    if bump is not None:
        scale, height = bump
        n.bump(n.noise(scale, 3.0), 1.0, height)
    material.diffuse_color = (*rgb, 1.0)
    return material


def emission(name: str, colour: Colour, strength: float) -> bpy.types.Material:
    """A new material that only shines (a lamp's shade, a bright window)."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    n.set("Base Color", (0.0, 0.0, 0.0))
    n.set("Specular IOR Level", 0.0)
    n.set("Emission Color", colour)
    n.set("Emission Strength", strength)
    material.diffuse_color = (*colour[:3], 1.0)
    return material


class Nodes:
    """Adds nodes to a material and returns their outputs; every input takes a number, a tuple or an output.

    Texture scales are in features per metre: without an explicit `vector` textures live in object
    coordinates, so that they stick to an object that moves (use `rest_coords` on one that deforms).
    """

    def __init__(self, material: bpy.types.Material) -> None:
        material.use_nodes = True
        self.tree = material.node_tree
        self.bsdf: bpy.types.Node = next(x for x in self.tree.nodes if x.type == "BSDF_PRINCIPLED")
        self._object_coords: Socket | None = None

    def set(self, input_name: str, value: Value) -> None:
        """Sets or connects an input of the Principled node: n.set("Roughness", 0.4)."""
        self.feed(self.bsdf.inputs[input_name], value)

    def feed(self, socket: Socket, value: Value) -> None:
        """Connects an output to an input, or writes a constant into it; RGB gains an alpha of 1."""
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif socket.type == "RGBA" and not isinstance(value, (int, float)):
            socket.default_value = (*tuple(value)[:3], 1.0)
        elif socket.type == "RGBA":
            socket.default_value = (value, value, value, 1.0)
        elif socket.type == "VECTOR" and isinstance(value, (int, float)):
            socket.default_value = (value, value, value)
        else:
            socket.default_value = value

    def node(self, kind: str, **attributes: object) -> bpy.types.Node:
        """A raw node, for what this class has no method for: n.node("ShaderNodeTexBrick", offset=0.5)."""
        node = self.tree.nodes.new(kind)
        for key, value in attributes.items():
            setattr(node, key, value)
        return node

    def object_coords(self) -> Socket:
        """Metres in the object's own space."""
        if self._object_coords is None:
            self._object_coords = self.node("ShaderNodeTexCoord").outputs["Object"]
        return self._object_coords

    def generated_coords(self) -> Socket:
        """0..1 over the undeformed bounding box: sticks to armature-deformed bodies too."""
        return self.node("ShaderNodeTexCoord").outputs["Generated"]

    def attribute(self, name: str, output: str = "Fac") -> Socket:
        """A mesh attribute (a vertex colour, a stored rest position: output "Vector" or "Color")."""
        return self.node("ShaderNodeAttribute", attribute_name=name).outputs[output]

    def rest_coords(self) -> Socket:
        """Metres in the rest pose, for bodies prepared with `mesh.store_rest_position`."""
        return self.attribute("rest_position", "Vector")

    def world_position(self) -> Socket:
        """Metres in world space: for scenery only, it slides over anything that moves."""
        return self.node("ShaderNodeNewGeometry").outputs["Position"]

    def world_normal(self) -> Socket:
        """Shading normal in world space."""
        return self.node("ShaderNodeNewGeometry").outputs["Normal"]

    def object_random(self) -> Socket:
        """A number in 0..1 that differs between objects which share this material."""
        return self.node("ShaderNodeObjectInfo").outputs["Random"]

    def mapping(
        self, vector: Socket, *, location: Value = 0.0, rotation: Value = 0.0, scale: Value = 1.0
    ) -> Socket:
        """Moves, turns (radians) and scales texture coordinates."""
        node = self.node("ShaderNodeMapping")
        self.feed(node.inputs["Vector"], vector)
        self.feed(node.inputs["Location"], location)
        self.feed(node.inputs["Rotation"], rotation)
        self.feed(node.inputs["Scale"], scale)
        return node.outputs["Vector"]

    def noise(
        self,
        scale: Value,
        detail: float = 2.0,
        *,
        roughness: float = 0.5,
        distortion: float = 0.0,
        vector: Socket | None = None,
        output: str = "Fac",
    ) -> Socket:
        """Perlin noise around 0.5; output "Color" gives three independent channels."""
        node = self.node("ShaderNodeTexNoise")
        self.feed(node.inputs["Vector"], vector or self.object_coords())
        self.feed(node.inputs["Scale"], scale)
        self.feed(node.inputs["Detail"], detail)
        self.feed(node.inputs["Roughness"], roughness)
        self.feed(node.inputs["Distortion"], distortion)
        return node.outputs[output]

    def voronoi(
        self,
        scale: Value,
        *,
        feature: str = "F1",
        randomness: float = 1.0,
        vector: Socket | None = None,
        output: str = "Distance",
    ) -> Socket:
        """Cells; feature F1, F2, SMOOTH_F1 or DISTANCE_TO_EDGE; output "Color" gives a colour per cell."""
        node = self.node("ShaderNodeTexVoronoi", feature=feature)
        self.feed(node.inputs["Vector"], vector or self.object_coords())
        self.feed(node.inputs["Scale"], scale)
        self.feed(node.inputs["Randomness"], randomness)
        return node.outputs[output]

    def wave(
        self,
        scale: Value,
        *,
        kind: str = "BANDS",
        axis: str = "X",
        profile: str = "SIN",
        distortion: float = 0.0,
        detail: float = 2.0,
        detail_scale: float = 1.0,
        vector: Socket | None = None,
    ) -> Socket:
        """Bands or rings, 0..1; Blender's scale 1 is about 3.2 bands per metre."""
        node = self.node("ShaderNodeTexWave", wave_type=kind, wave_profile=profile)
        setattr(node, "bands_direction" if kind == "BANDS" else "rings_direction", axis)
        self.feed(node.inputs["Vector"], vector or self.object_coords())
        self.feed(node.inputs["Scale"], scale)
        self.feed(node.inputs["Distortion"], distortion)
        self.feed(node.inputs["Detail"], detail)
        self.feed(node.inputs["Detail Scale"], detail_scale)
        return node.outputs["Fac"]

    def brick(
        self,
        scale: Value,
        colours: tuple[Colour, Colour],
        mortar: Colour,
        *,
        vector: Socket | None = None,
        width: float = 0.5,
        height: float = 0.25,
        mortar_size: float = 0.02,
        offset: float = 0.5,
    ) -> tuple[Socket, Socket]:
        """Bricks or planks in the XY plane of the vector: (colour, 1 in the mortar)."""
        node = self.node("ShaderNodeTexBrick", offset=offset)
        self.feed(node.inputs["Vector"], vector or self.object_coords())
        self.feed(node.inputs["Scale"], scale)
        self.feed(node.inputs["Color1"], colours[0])
        self.feed(node.inputs["Color2"], colours[1])
        self.feed(node.inputs["Mortar"], mortar)
        self.feed(node.inputs["Mortar Size"], mortar_size)
        self.feed(node.inputs["Brick Width"], width)
        self.feed(node.inputs["Row Height"], height)
        return node.outputs["Color"], node.outputs["Fac"]

    def ramp(
        self,
        factor: Value,
        stops: Sequence[tuple[float, Sequence[float] | float]],
        *,
        interpolation: str = "LINEAR",
    ) -> Socket:
        """A colour (or grey) that depends on a factor: stops are (position 0..1, colour)."""
        node = self.node("ShaderNodeValToRGB")
        ramp = node.color_ramp
        ramp.interpolation = interpolation
        while len(ramp.elements) < len(stops):
            ramp.elements.new(0.5)
        while len(ramp.elements) > len(stops):
            ramp.elements.remove(ramp.elements[-1])
        for element, (position, colour) in zip(ramp.elements, sorted(stops, key=lambda stop: stop[0])):
            element.position = position
            if isinstance(colour, (int, float)):
                element.color = (colour, colour, colour, 1.0)
            else:
                element.color = (*tuple(colour)[:3], 1.0)
        self.feed(node.inputs["Fac"], factor)
        return node.outputs["Color"]

    def mix(self, factor: Value, a: Value, b: Value, *, blend: str = "MIX") -> Socket:
        """Mixes two colours; blend as in Blender: MIX, MULTIPLY, OVERLAY, ADD, ..."""
        node = self.node("ShaderNodeMix", data_type="RGBA", blend_type=blend)
        self.feed(_named(node.inputs, "Factor", "VALUE"), factor)
        self.feed(_named(node.inputs, "A", "RGBA"), a)
        self.feed(_named(node.inputs, "B", "RGBA"), b)
        return _named(node.outputs, "Result", "RGBA")

    def hue(self, colour: Value, *, hue: Value = 0.5, saturation: Value = 1.0, value: Value = 1.0) -> Socket:
        """Turns hue (0.5 leaves it), scales saturation and value."""
        node = self.node("ShaderNodeHueSaturation")
        self.feed(node.inputs["Color"], colour)
        self.feed(node.inputs["Hue"], hue)
        self.feed(node.inputs["Saturation"], saturation)
        self.feed(node.inputs["Value"], value)
        return node.outputs["Color"]

    def math(self, operation: str, a: Value, b: Value = 0.0, *, clamp: bool = False) -> Socket:
        """A number from numbers: n.math("MULTIPLY", x, 2.0)."""
        node = self.node("ShaderNodeMath", operation=operation, use_clamp=clamp)
        self.feed(node.inputs[0], a)
        self.feed(node.inputs[1], b)
        return node.outputs["Value"]

    def map_range(
        self, value: Value, from_min: float, from_max: float, to_min: float = 0.0, to_max: float = 1.0
    ) -> Socket:
        """Rescales a number and clamps it."""
        node = self.node("ShaderNodeMapRange")
        for key, x in zip(
            ("Value", "From Min", "From Max", "To Min", "To Max"), (value, from_min, from_max, to_min, to_max)
        ):
            self.feed(_named(node.inputs, key, "VALUE"), x)
        return _named(node.outputs, "Result", "VALUE")

    def vector_math(self, operation: str, a: Value, b: Value = (0.0, 0.0, 0.0)) -> Socket:
        """A vector from vectors: n.vector_math("ADD", coords, offset)."""
        node = self.node("ShaderNodeVectorMath", operation=operation)
        self.feed(node.inputs[0], a)
        self.feed(node.inputs[1], b)
        return node.outputs["Value" if operation in {"LENGTH", "DISTANCE", "DOT_PRODUCT"} else "Vector"]

    def separate(self, vector: Value) -> tuple[Socket, Socket, Socket]:
        """x, y, z of a vector (or of a colour)."""
        node = self.node("ShaderNodeSeparateXYZ")
        self.feed(node.inputs["Vector"], vector)
        return node.outputs["X"], node.outputs["Y"], node.outputs["Z"]

    def combine(self, x: Value = 0.0, y: Value = 0.0, z: Value = 0.0) -> Socket:
        """A vector from three numbers."""
        node = self.node("ShaderNodeCombineXYZ")
        for socket, value in zip(node.inputs, (x, y, z)):
            self.feed(socket, value)
        return node.outputs["Vector"]

    def bump(
        self, height: Value, strength: Value, distance: Value, *, normal: Socket | None = None
    ) -> Socket:
        """Bends the surface's normal by a height (0..1) of `distance` metres, and connects it."""
        node = self.node("ShaderNodeBump")
        self.feed(node.inputs["Height"], height)
        self.feed(node.inputs["Strength"], strength)
        self.feed(node.inputs["Distance"], distance)
        if normal is not None:
            self.feed(node.inputs["Normal"], normal)
        self.feed(self.bsdf.inputs["Normal"], node.outputs["Normal"])
        return node.outputs["Normal"]


def _named(sockets: Sequence[Socket], name: str, kind: str) -> Socket:
    """Mix and Map Range carry one hidden set of sockets per data type under the same names."""
    return next(socket for socket in sockets if socket.name == name and socket.type == kind)
