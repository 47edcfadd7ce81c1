"""The scene that a recipe talks to, and the register of its ground truth.

Owns which objects are which instance, what happens when, where the cameras and lights are. Motion code calls
`event` while it animates, so that what is recorded can't drift from what is seen. Knows nothing of rendering
or of files.
"""

from __future__ import annotations

import random
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import bpy
from mathutils import Matrix, Vector

from . import cameras, catalogue, keys, placing
from .placing import AnyThing, Point, Support, Thing
from .timeline import FPS, LAST_FRAME, MIN_EVENT_FRAMES

SCALES = ("outdoor", "room", "tabletop")
OBJECT_IDS = range(1, 1000)
LANDMARK_IDS = range(1001, 32768)
FRONT_AXES = ("-x", "+x", "-y", "+y")
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")


class RecipeError(Exception):
    """A recipe asks for something that the benchmark forbids; `hint` says what to do about it."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


@dataclass(eq=False)
class Instance:
    """A thing with an identity: an object that queries may refer to, or a landmark they only mention."""

    scene: Scene
    name: str
    id: int
    category: str
    objects: list[bpy.types.Object]
    frame_object: bpy.types.Object
    attributes: dict[str, str] = field(default_factory=dict)
    front: str | None = None
    role: str = "object"

    def matrix(self, frame: float) -> Matrix:
        """World matrix of the object that carries this instance's axes, from its keys at a frame."""
        return keys.object_matrix(self.frame_object, frame)


@dataclass(frozen=True)
class Event:
    """`subject` does `verb` (to `object`) during canonical frames first..last, both inclusive."""

    subject: Instance
    verb: str
    frames: tuple[int, int]
    object: Instance | None = None


class Scene:
    """A fresh Blender scene plus everything that is annotated in it."""

    def __init__(self, name: str, scale: str, seed: int = 0) -> None:
        if scale not in SCALES:
            raise RecipeError(f"SCALE of {name} is {scale!r}", f"one of {', '.join(SCALES)}")
        self.name = name
        self.scale = scale
        self.seed = seed
        self.exposure = 1.0
        self.instances: list[Instance] = []
        self.events: list[Event] = []
        self.camera_rig: list[cameras.Camera] = []
        self.camera_objects: list[bpy.types.Object] = []
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy_scene = bpy.context.scene
        bpy_scene.name = name
        bpy_scene.frame_start, bpy_scene.frame_end = 0, LAST_FRAME
        bpy_scene.render.fps, bpy_scene.render.fps_base = FPS, 1.0
        bpy_scene.unit_settings.system, bpy_scene.unit_settings.scale_length = "METRIC", 1.0
        bpy_scene.view_settings.view_transform = "Standard"
        bpy_scene.frame_set(0)

    def rng(self, key: str) -> random.Random:
        """A random stream of its own per key: adding one elsewhere leaves the others as they are."""
        # The last digit counted variants once; what was drawn stays drawn.
        return random.Random(f"{self.name}/{key}/{self.seed}.0")

    def instance(
        self,
        name: str,
        id: int,
        category: str,
        thing: Thing,
        *,
        attributes: Mapping[str, str] | None = None,
        front: str | None = None,
        role: str | None = None,
        frame_object: bpy.types.Object | None = None,
    ) -> Instance:
        """Registers a thing (all its mesh objects) as one instance.

        `front` names the axis of the box frame that the thing faces with (None: it has no front);
        `frame_object` carries the box's axes (default: the first part; for a body that an armature deforms,
        the heading of its rig).
        """
        objects = placing.parts(thing)
        allowed_role = "object" if id in OBJECT_IDS else "landmark" if id in LANDMARK_IDS else None
        if allowed_role is None or role not in (None, allowed_role):
            raise RecipeError(
                f"instance {name}: id {id} is out of range for a {role or 'instance'}",
                "objects have ids 1..999, landmarks 1001..32767",
            )
        for label, value in (("name", name), ("category", category)):
            if not _NAME.fullmatch(value):
                raise RecipeError(f"instance {name}: {label} {value!r} is not snake_case")
        if front is not None and front not in FRONT_AXES:
            raise RecipeError(f"instance {name}: front {front!r}", f"one of {', '.join(FRONT_AXES)} or None")
        if not objects or any(obj.type != "MESH" for obj in objects):
            raise RecipeError(
                f"instance {name}: parts must be mesh objects", "convert curves and texts to meshes"
            )
        for other in self.instances:
            if other.id == id or other.name == name:
                raise RecipeError(f"instance {name} (id {id}) clashes with {other.name} (id {other.id})")
            shared = {obj.name for obj in other.objects} & {obj.name for obj in objects}
            if shared:
                raise RecipeError(f"instances {name} and {other.name} share {', '.join(sorted(shared))}")
        for obj in objects:
            obj.pass_index = id
        made = Instance(
            self,
            name,
            id,
            category,
            objects,
            frame_object or objects[0],
            dict(attributes or {}),
            front,
            allowed_role,
        )
        self.instances.append(made)
        return made

    def make(self, kind: str, name: str, rng: random.Random | None = None, **attributes: Any) -> Any:
        """Builds a thing of the catalogue at the origin; its own random stream unless one is shared."""
        try:
            return catalogue.find(kind).build(name, rng or self.rng(name), **attributes)
        except catalogue.CatalogueError as error:
            raise RecipeError(f"{name}: {error}", error.hint) from error

    def place(
        self,
        thing: AnyThing,
        at: Point,
        heading_deg: float = 0.0,
        *,
        on: Support = 0.0,
        tilt_deg: float = 0.0,
        scale: float = 1.0,
    ) -> AnyThing:
        """Puts a thing somewhere and returns it: see `placing.place`."""
        return placing.place(thing, at, heading_deg, on=on, tilt_deg=tilt_deg, scale=scale)

    def put(
        self,
        kind: str,
        name: str,
        at: Point = (0.0, 0.0),
        heading_deg: float = 0.0,
        *,
        rng: random.Random | None = None,
        on: Support = 0.0,
        tilt_deg: float = 0.0,
        **attributes: Any,
    ) -> Any:
        """Builds a thing of the catalogue and places it: `make`, then `place`. It has no identity."""
        thing = self.make(kind, name, rng, **attributes)
        return self.place(thing, at, heading_deg, on=on, tilt_deg=tilt_deg)

    def add(
        self,
        id: int,
        kind: str,
        name: str,
        at: Point = (0.0, 0.0),
        heading_deg: float = 0.0,
        *,
        category: str | None = None,
        attributes: Mapping[str, str] | None = None,
        front: str | None = "of its kind",
        rng: random.Random | None = None,
        on: Support = 0.0,
        tilt_deg: float = 0.0,
        **looks: Any,
    ) -> Instance:
        """Builds, places and registers a thing: category and front are those of its kind unless given."""
        thing = self.put(kind, name, at, heading_deg, rng=rng, on=on, tilt_deg=tilt_deg, **looks)
        entry = catalogue.find(kind)
        front = entry.front if front == "of its kind" else front
        return self.instance(name, id, category or entry.category, thing, attributes=attributes, front=front)

    def event(
        self, subject: Instance, verb: str, frames: tuple[int, int], object: Instance | None = None
    ) -> None:
        """Records that `subject` does `verb` (to `object`) during frames first..last, both inclusive."""
        first, last = int(frames[0]), int(frames[1])
        what = f"event '{getattr(subject, 'name', subject)} {verb}' {first}..{last}"
        for party in (subject, object):
            if party is not None and not any(party is instance for instance in self.instances):
                raise RecipeError(
                    f"{what}: {getattr(party, 'name', party)} is not an instance of this scene",
                    "register it with scene.instance first",
                )
        if subject is object:
            raise RecipeError(f"{what}: subject and object are the same instance")
        if not _NAME.fullmatch(verb):
            raise RecipeError(f"{what}: the verb is not snake_case")
        if not (first >= 0 and last <= LAST_FRAME):
            raise RecipeError(f"{what}: outside 0..{LAST_FRAME}")
        if last - first + 1 < MIN_EVENT_FRAMES:
            raise RecipeError(
                f"{what}: {max(last - first + 1, 0)} frames long",
                f"an interval has at least {MIN_EVENT_FRAMES} frames, so that every profile samples it",
            )
        self.events.append(Event(subject, verb, (first, last), object))

    def cameras(
        self,
        target: Sequence[float],
        *,
        radius_m: float,
        heights_m: Sequence[float],
        arc_deg: float,
        facing_deg: float,
        fov_deg: float,
        jitter: float = 0.02,
    ) -> None:
        """Places the rig of 17 cameras on an arc round `target`.

        They stand `radius_m` away (horizontally) at the world heights `heights_m` in turn, spread over
        `arc_deg` degrees centred on the azimuth `facing_deg` (counter-clockwise from +X, seen from the
        target), and look near the target with a horizontal field of view of `fov_deg`. `jitter` is a share
        of the radius.
        """
        if self.camera_rig:
            raise RecipeError("cameras were placed twice")
        self.camera_rig = cameras.arc_rig(
            Vector(target),
            radius_m,
            heights_m,
            radians(arc_deg),
            radians(facing_deg),
            radians(fov_deg),
            jitter,
            self.rng("cameras"),
        )
        self.camera_objects = [cameras.add_to_blender(camera) for camera in self.camera_rig]
        bpy.context.scene.camera = self.camera_objects[0]

    def sun(
        self,
        *,
        elevation_deg: float,
        azimuth_deg: float,
        strength: float = 3.0,
        angle_deg: float = 1.5,
        colour: Sequence[float] = (1.0, 0.93, 0.82),
    ) -> bpy.types.Object:
        """Sunlight from an azimuth (counter-clockwise from +X); a larger angle softens its shadows."""
        light = bpy.data.lights.new("sun", "SUN")
        light.energy, light.angle, light.color = strength, radians(angle_deg), tuple(colour)
        obj = self._link(bpy.data.objects.new("sun", light))
        e, a = radians(elevation_deg), radians(azimuth_deg)
        towards_sun = Vector((cos(e) * cos(a), cos(e) * sin(a), sin(e)))
        obj.rotation_euler = (-towards_sun).to_track_quat("-Z", "Y").to_euler()
        return obj

    def area_light(
        self,
        name: str,
        location: Sequence[float],
        target: Sequence[float],
        *,
        size_m: tuple[float, float],
        power_w: float,
        colour: Sequence[float] = (1.0, 1.0, 1.0),
    ) -> bpy.types.Object:
        """A rectangular lamp that looks at a target; itself invisible to cameras."""
        light = bpy.data.lights.new(name, "AREA")
        light.shape, (light.size, light.size_y) = "RECTANGLE", size_m
        light.energy, light.color = power_w, tuple(colour)
        obj = self._link(bpy.data.objects.new(name, light))
        obj.location = location
        obj.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
        obj.visible_camera = False
        return obj

    def point_light(
        self,
        name: str,
        location: Sequence[float],
        *,
        power_w: float,
        radius_m: float = 0.05,
        colour: Sequence[float] = (1.0, 0.85, 0.65),
    ) -> bpy.types.Object:
        """A glowing ball without a visible surface (a bulb inside a shade)."""
        light = bpy.data.lights.new(name, "POINT")
        light.energy, light.shadow_soft_size, light.color = power_w, radius_m, tuple(colour)
        obj = self._link(bpy.data.objects.new(name, light))
        obj.location = location
        return obj

    def hdri(self, name: str, strength: float = 1.0, rotation_deg: float = 0.0) -> None:
        """Light and backdrop from one of the CC0 panoramas inside the bpy wheel (city, courtyard, forest,
        interior, night, studio, sunrise, sunset), turned by `rotation_deg` round +Z."""
        folder = Path(bpy.utils.system_resource("DATAFILES")) / "studiolights" / "world"
        file = folder / f"{name}.exr"
        if not file.is_file():
            known = ", ".join(sorted(path.stem for path in folder.glob("*.exr")))
            raise RecipeError(f"no HDRI named {name!r}", f"one of {known}")
        nodes, links, background = self._world()
        coordinates = nodes.new("ShaderNodeTexCoord")
        mapping = nodes.new("ShaderNodeMapping")
        mapping.inputs["Rotation"].default_value = (0.0, 0.0, radians(rotation_deg))
        picture = nodes.new("ShaderNodeTexEnvironment")
        picture.image = bpy.data.images.load(str(file), check_existing=True)
        links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
        links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
        links.new(picture.outputs["Color"], background.inputs["Color"])
        background.inputs["Strength"].default_value = strength

    def sky(
        self, *, sun_elevation_deg: float, sun_azimuth_deg: float, strength: float = 0.3, haze: float = 1.0
    ) -> None:
        """A clear physical sky without its sun disc: pair it with `sun` from the same direction."""
        nodes, links, background = self._world()
        sky = nodes.new("ShaderNodeTexSky")
        sky.sky_type, sky.sun_disc = "NISHITA", False
        sky.sun_elevation = radians(sun_elevation_deg)
        sky.sun_rotation = radians(90.0 - sun_azimuth_deg)
        sky.dust_density = haze
        links.new(sky.outputs["Color"], background.inputs["Color"])
        background.inputs["Strength"].default_value = strength

    def ambient(self, colour: Sequence[float], strength: float = 1.0) -> None:
        """Even light from everywhere (a room's rest of the world)."""
        _, _, background = self._world()
        background.inputs["Color"].default_value = (*tuple(colour)[:3], 1.0)
        background.inputs["Strength"].default_value = strength

    def check(self) -> None:
        """What can only be judged when the recipe has finished."""
        if not self.camera_rig:
            raise RecipeError("the recipe places no cameras", "call scene.cameras(...)")
        if not any(instance.role == "object" for instance in self.instances):
            raise RecipeError("the recipe registers no object", "call scene.instance(...)")
        registered = {obj.name for instance in self.instances for obj in instance.objects}
        for obj in bpy.context.scene.objects:
            if obj.name not in registered:
                obj.pass_index = 0
            if obj.instance_type != "NONE":
                raise RecipeError(
                    f"{obj.name} instances others", "duplicate the object with linked data instead"
                )
            live = [modifier.type for modifier in obj.modifiers if modifier.type != "ARMATURE"]
            if live and obj.type == "MESH":
                raise RecipeError(
                    f"{obj.name} has live modifiers: {', '.join(live)}", "bake them into the mesh"
                )
            if len(obj.constraints):
                raise RecipeError(f"{obj.name} has constraints", "key its matrix at every frame instead")

    def _link(self, obj: bpy.types.Object) -> bpy.types.Object:
        bpy.context.scene.collection.objects.link(obj)
        return obj

    def _world(self):
        world = bpy.data.worlds.new("world")
        bpy.context.scene.world = world
        world.use_nodes = True
        nodes = world.node_tree.nodes
        return nodes, world.node_tree.links, next(node for node in nodes if node.type == "BACKGROUND")
