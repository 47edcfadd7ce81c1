from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, Optional, TypedDict, Union, final

import numpy as np
import numpy.typing as npt

_Path = Union[str, PathLike[str]]
_Rendered = Literal["tiny", "small", "full"]
_Profile = Literal["tiny", "small", "full", "real"]
_Split = Literal["train", "test"]
_Depth = Literal["median", "expected", "sum"]
_JudgedSet = Literal["queries", "composites"]
_Set = Literal["queries", "composites", "absents"]
_Bools = npt.NDArray[np.bool_]
_Bytes = npt.NDArray[np.uint8]
_Ids = npt.NDArray[np.uint32]
_Floats = npt.NDArray[np.float32]
_Doubles = npt.NDArray[np.float64]

__all__ = [
    "Benchmark",
    "Camera",
    "Capture",
    "Clips",
    "Event",
    "Finding",
    "Frame",
    "FrameClip",
    "Instance",
    "Picture",
    "PictureClip",
    "Query",
    "ResultsWriter",
    "Scene",
    "Splats",
    "Timeline",
    "Truth",
    "__version__",
    "check",
    "decode_colour",
    "decode_depth",
    "decode_ids",
    "rle_decode",
    "rle_encode",
    "score",
    "write_baseline",
]

__version__: Final[str]

@final
class Timeline:
    """The frames of a profile on the one canonical timeline: 97 frames at 24 a second, numbered 0 to 96.

    A profile (`"tiny"`, `"small"` or `"full"`) renders every `stride`-th of them and keeps their numbers, so that file
    names, intervals, masks and results of all profiles speak the same numbers.
    """
    def __new__(cls, profile: _Rendered) -> Timeline: ...
    @property
    def profile(self) -> _Profile:
        """Name of the profile."""
    @property
    def frames(self) -> list[int]:
        """Canonical numbers of the rendered frames, ascending."""
    @property
    def stride(self) -> int:
        """Every how many canonical frames one is rendered."""
    @property
    def frame_count(self) -> int:
        """Canonical frames of the whole clip: 97."""
    @property
    def fps(self) -> float:
        """Canonical frames a second: 24."""
    def seconds(self, frame: int) -> float:
        """Seconds from the start of the clip to a canonical frame."""
    def unit_time(self, frame: int) -> float:
        """A canonical frame as a time from 0 (start of the clip) to 1 (its end): what splats take."""

@final
class Camera:
    """A pinhole camera in OpenCV axes (x right, y down, z forward); the world is right-handed, +Z up, in metres.

    The centre of pixel (column, row) is (column + 0.5, row + 0.5), and `u = fx * x / z + cx`.
    `world_from_camera` is one 4x4 pose, or one for each frame from 0 on: 97 of them (97, 4, 4) on the canonical timeline.
    """
    def __new__(
        cls,
        name: str,
        width: int,
        height: int,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        world_from_camera: npt.ArrayLike,
        *,
        split: _Split = "train",
    ) -> Camera: ...
    @property
    def name(self) -> str:
        """View name, also the folder of its frames."""
    @property
    def split(self) -> _Split:
        """`"train"` (methods may use it) or `"test"` (held out: only the judge looks at it)."""
    @property
    def width(self) -> int:
        """Columns of its pictures, pixels."""
    @property
    def height(self) -> int:
        """Rows of its pictures, pixels."""
    @property
    def fx(self) -> float:
        """Focal length along columns, pixels."""
    @property
    def fy(self) -> float:
        """Focal length along rows, pixels."""
    @property
    def cx(self) -> float:
        """Principal point, column, pixels from the outer corner of the top left pixel."""
    @property
    def cy(self) -> float:
        """Principal point, row, pixels from the outer corner of the top left pixel."""
    @property
    def moves(self) -> bool:
        """Whether its pose changes over the clip."""
    @property
    def intrinsics(self) -> _Doubles:
        """Intrinsics: float64 (3, 3), pixels; `[u, v, 1] * z = intrinsics @ point_camera`."""
    def world_from_camera(self, frame: int = 0) -> _Doubles:
        """Pose at a canonical frame: float64 (4, 4), metres; `point_world = world_from_camera @ point_camera`."""
    def camera_from_world(self, frame: int = 0) -> _Doubles:
        """Inverse pose at a canonical frame: float64 (4, 4), metres."""
    def rays(self, frame: int = 0) -> tuple[_Doubles, _Doubles]:
        """Rays through the pixel centres at a canonical frame: the origin, float64 (3,), and directions, float64 (H, W, 3).

        Directions have length 1 along the optical axis, so that `origin + depth_m[..., None] * directions` is the surface
        point of a planar depth. Normalise them for the length of the ray.
        """
    def unproject(self, depth_m: npt.ArrayLike, frame: int = 0) -> _Doubles:
        """World points, float64 (H, W, 3), metres, of the planar depths (H, W) of a picture at a canonical frame.

        Where nothing was hit (+inf) the point is nan.
        """
    def project(self, points_world: npt.ArrayLike, frame: int = 0) -> tuple[_Doubles, _Doubles]:
        """Where world points (N, 3), metres, appear at a canonical frame: positions, float64 (N, 2), as (column, row) in
        pixels, and planar depths, float64 (N,), metres, negative behind the camera.

        The pixel of a position is its floor, since centres are at half pixels.
        """
    def resized(self, width: int, height: int) -> Camera:
        """The same camera for pictures of another size, pixels."""

@final
class Instance:
    """One annotated thing; the same id in every camera, frame and profile."""
    @property
    def id(self) -> int:
        """Its value in `Frame.id`: 1 to 999 objects, 1001 to 32767 landmarks."""
    @property
    def name(self) -> str:
        """Unique in the scene."""
    @property
    def role(self) -> Literal["object", "landmark"]:
        """`"object"` (queries may refer to it) or `"landmark"` (only named in relations)."""
    @property
    def category(self) -> str:
        """Common noun."""
    @property
    def attributes(self) -> dict[str, str]:
        """Visible properties, for example `{"colour": "red"}`."""
    @property
    def front(self) -> Optional[str]:
        """Axis of its box that points forward (`"-y"`), or None where it has no front."""

@final
class Event:
    """What an instance does, alone or to another."""
    @property
    def subject(self) -> str:
        """Name of who acts."""
    @property
    def verb(self) -> str:
        """What it does, base form."""
    @property
    def object(self) -> Optional[str]:
        """Name of whom it is done to; None for actions."""
    @property
    def interval(self) -> tuple[int, int]:
        """First and last canonical frame, both inclusive."""

@final
class Frame:
    """One picture of a scene.

    `rgb` and the other arrays are made once and handed out again: copy them before writing into them.
    """
    @property
    def view(self) -> str:
        """Name of the camera."""
    @property
    def frame(self) -> int:
        """Canonical frame."""
    @property
    def rgb(self) -> _Floats:
        """Linear, scene-referred light: float32 (H, W, 3), red, green, blue."""
    @property
    def depth_m(self) -> _Floats:
        """Planar depth (camera z) at the pixel centre, metres: float32 (H, W); +inf where nothing is hit."""
    @property
    def id(self) -> _Ids:
        """Instance at the pixel centre: uint32 (H, W); 0 where nothing is annotated."""
    def display(self) -> _Bytes:
        """What a screen shows: uint8 (H, W, 3), `clamp(sRGB_OETF(exposure * rgb))`."""

@final
class FrameClip:
    """Pictures of one camera, one after another."""
    @property
    def view(self) -> str:
        """Name of the camera."""
    @property
    def frames(self) -> list[int]:
        """Canonical frames, in the order of the arrays."""
    @property
    def rgb(self) -> _Floats:
        """Linear, scene-referred light: float32 (T, H, W, 3), red, green, blue."""
    @property
    def depth_m(self) -> _Floats:
        """Planar depth (camera z) at the pixel centre, metres: float32 (T, H, W); +inf where nothing is hit."""
    @property
    def id(self) -> _Ids:
        """Instance at the pixel centre: uint32 (T, H, W); 0 where nothing is annotated."""
    def display(self) -> _Bytes:
        """What a screen shows: uint8 (T, H, W, 3), `clamp(sRGB_OETF(exposure * rgb))`."""
    def __len__(self) -> int: ...

@final
class Scene:
    """A rendered scene: a folder with `scene.json` and `frames/` that `l4d build-scenes` made.

    Pictures are read when they are asked for; nothing is kept in memory.
    """
    def __new__(cls, path: _Path) -> Scene: ...
    @property
    def name(self) -> str:
        """Scene name."""
    @property
    def scale(self) -> Literal["outdoor", "room", "tabletop"]:
        """`"outdoor"`, `"room"` or `"tabletop"`."""
    @property
    def variant(self) -> int:
        """Which permutation of looks, roles, layout and cameras; 0 is the benchmark."""
    @property
    def seed(self) -> int:
        """Seed of everything random in its recipe; 0 is the benchmark."""
    @property
    def profile(self) -> _Profile:
        """How much was rendered: `"tiny"`, `"small"` or `"full"`."""
    @property
    def width(self) -> int:
        """Columns of its pictures, pixels."""
    @property
    def height(self) -> int:
        """Rows of its pictures, pixels."""
    @property
    def exposure(self) -> float:
        """Factor on linear light before it is shown."""
    @property
    def frames(self) -> list[int]:
        """Canonical numbers of its frames, ascending."""
    @property
    def timeline(self) -> Timeline:
        """When its frames are."""
    @property
    def cameras(self) -> list[Camera]:
        """All views, sorted by name; exactly one is held out."""
    @property
    def training_cameras(self) -> list[Camera]:
        """The views that a method may train on."""
    @property
    def test_camera(self) -> Camera:
        """The held-out view. Methods may use its pose, never its pictures."""
    def camera(self, name: str) -> Camera:
        """The view of that name."""
    @property
    def instances(self) -> list[Instance]:
        """All annotated things, sorted by id."""
    def instance(self, name: str) -> Instance:
        """The annotated thing of that name."""
    @property
    def events(self) -> list[Event]:
        """Actions and interactions: part of the answers. A method must not look at them."""
    def frame(self, view: str, frame: int) -> Frame:
        """What a view sees at a canonical frame."""
    def clip(self, view: str, frames: Optional[Sequence[int]] = None) -> FrameClip:
        """What a view sees at canonical frames (all of the profile by default), read by all threads."""

@final
class Capture:
    """A capture: a folder with `capture.json` and `frames/` that `l4d import-scene` made.

    Its frames have numbers of their own; `is_metric` says whether a unit of its world is a metre.
    """
    def __new__(cls, path: _Path) -> Capture: ...
    @property
    def name(self) -> str:
        """Scene name."""
    @property
    def source(self) -> str:
        """Who recorded it."""
    @property
    def width(self) -> int:
        """Columns of its pictures, pixels."""
    @property
    def height(self) -> int:
        """Rows of its pictures, pixels."""
    @property
    def frames(self) -> list[int]:
        """Numbers of its moments, ascending."""
    @property
    def frames_per_second(self) -> Optional[float]:
        """Moments a second, or None if unknown."""
    @property
    def is_metric(self) -> bool:
        """Whether a unit of its world is a metre."""
    @property
    def notes(self) -> list[str]:
        """What was assumed or left out when it was imported, a sentence each."""
    @property
    def cameras(self) -> list[Camera]:
        """All views, sorted by name."""
    @property
    def training_cameras(self) -> list[Camera]:
        """The views that a method may train on."""
    def camera(self, name: str) -> Camera:
        """The view of that name."""
    def saw(self, view: str, frame: int) -> bool:
        """Whether a view saw a moment: some pictures are missing on purpose."""
    def picture(self, view: str, frame: int) -> _Bytes:
        """What a view saw at a moment: uint8 (H, W, 3), display colour."""
    def clip(self, view: str, frames: Optional[Sequence[int]] = None) -> _Bytes:
        """What a view saw at some moments (all that it saw by default): uint8 (T, H, W, 3), display colour."""

@final
class Query:
    """One sentence of the benchmark."""
    @property
    def id(self) -> str:
        """`<scene>/<nnn>`."""
    @property
    def scene(self) -> str:
        """Name of its scene."""
    @property
    def text(self) -> str:
        """The sentence."""
    @property
    def categories(self) -> list[Literal["attribute", "action", "spatial", "interaction"]]:
        """One of `"attribute"`, `"action"`, `"spatial"`, `"interaction"`, or two for a composite."""
    @property
    def referents(self) -> list[str]:
        """Names of the instances that it means: the answer. A method must not look at them."""
    @property
    def temporal(self) -> Literal["whole", "while"]:
        """`"whole"` (names an identity: the referent counts in the whole clip) or `"while"` (counts only in `intervals`)."""
    @property
    def intervals(self) -> list[tuple[int, int]]:
        """When it holds: first and last canonical frames, both inclusive. Part of the answer."""
    @property
    def predicate(self) -> Any:
        """The machine-readable meaning (docs/queries.md) as dicts and lists, or None. Part of the answer."""
    @property
    def status(self) -> Literal["candidate", "verified", "rejected"]:
        """`"candidate"` (proved by machine), `"verified"` (by people too) or `"rejected"` (by people; never scored)."""
    def holds_at(self, frame: int) -> bool:
        """Whether the sentence holds at a canonical frame."""

@final
class Truth:
    """The truth of one scene at one profile."""
    @property
    def scene(self) -> str:
        """Scene name."""
    @property
    def frames(self) -> list[int]:
        """Annotated canonical frames, ascending."""
    @property
    def instances(self) -> list[str]:
        """Names of the annotated things, ascending by id."""
    def mask(self, query: Union[Query, str], frame: int) -> _Bools:
        """What a query asks to find at a frame: bool (H, W). No pixel where it does not hold or nothing is visible."""
    def masks(self, query: Union[Query, str]) -> _Bools:
        """What a query asks to find in the whole clip: bool (T, H, W), in the order of `frames`."""
    def instance_masks(self, name: str) -> _Bools:
        """Where an annotated thing is visible in the whole clip: bool (T, H, W), in the order of `frames`."""

@final
class Benchmark:
    """A benchmark folder (with `panoptic-l4d.toml`) at one profile. No render is needed: cameras come from the tracks."""
    def __new__(cls, path: _Path, profile: _Profile = "small") -> Benchmark: ...
    @property
    def name(self) -> str:
        """Title."""
    @property
    def version(self) -> str:
        """Semantic version: major = changed answers, minor = additions, patch = written anew."""
    @property
    def profile(self) -> _Profile:
        """`"tiny"`, `"small"`, `"full"`, or `"real"` for captures."""
    @property
    def width(self) -> int:
        """Columns of masks, pixels. Captures (profile `"real"`) have no common one: see `size`."""
    @property
    def height(self) -> int:
        """Rows of masks, pixels. Captures (profile `"real"`) have no common one: see `size`."""
    @property
    def frames(self) -> list[int]:
        """Canonical frames that a method answers, ascending. Captures (profile `"real"`) have no common ones: see `clip`."""
    @property
    def timeline(self) -> Timeline:
        """When these frames are."""
    @property
    def scenes(self) -> list[str]:
        """Names of the scenes, in table order."""
    @property
    def truth_digest(self) -> str:
        """SHA-256 over the truth of the profile: results carry it, so that masks of another version are refused."""
    def size(self, scene: str) -> tuple[int, int]:
        """Columns and rows of the masks of a scene, pixels: (width, height)."""
    def clip(self, scene: str) -> list[int]:
        """Frames of a scene that masks may be of, ascending: those of the profile, or the moments of a capture."""
    def queries(self, scene: Optional[str] = None, *, set: _Set = "queries") -> list[Query]:
        """Sentences of a scene (of all scenes by default). `set` is `"queries"` (those that count), `"composites"` (of two
        categories) or `"absents"` (that nothing in the scene satisfies).
        """
    def query(self, id: Union[Query, str]) -> Query:
        """The sentence of an id, `<scene>/<nnn>`, from any set."""
    def truth(self, scene: str) -> Truth:
        """What the held-out view of a scene shows: the answers. Only judges, baselines and oracles look at it."""
    def cameras(self, scene: str) -> list[Camera]:
        """Views that the profile has of a scene, sorted by name, for pictures of its size."""
    def test_camera(self, scene: str) -> Camera:
        """The held-out view of a scene, from which every query is answered."""
    def instances(self, scene: str) -> list[Instance]:
        """All annotated things of a scene, sorted by id."""
    def events(self, scene: str) -> list[Event]:
        """Actions and interactions of a scene: part of the answers."""

@final
class ResultsWriter:
    """Writes results of a method, which the last part of `path` names: `method.json` and `masks/<scene>/<nnn>.json`.

    A run that was killed is continued by the same call: `remaining()` leaves out what is there whole. `ground_truth`
    says that the method saw any (such results are shown and never ranked), `test_view` that it saw pictures of the
    held-out view, `depth` that it learned from rendered depth of the training views, itself or through a model (such results
    are ranked in a track of their own), `endpoints` which model servers it asked. `overwrite` removes what is there.
    """
    def __new__(
        cls,
        path: _Path,
        benchmark: Benchmark,
        *,
        version: str,
        link: str = "",
        ground_truth: bool = False,
        test_view: bool = False,
        depth: bool = False,
        endpoints: Optional[Sequence[str]] = None,
        overwrite: bool = False,
    ) -> ResultsWriter: ...
    @property
    def name(self) -> str:
        """Name of the method."""
    @property
    def path(self) -> Path:
        """The folder."""
    def remaining(self, scene: Optional[str] = None, *, set: _Set = "queries") -> list[Query]:
        """Sentences whose answer is not there whole yet; `set` as in `Benchmark.queries`."""
    def write(
        self, query: Union[Query, str], masks: Union[_Bools, Mapping[int, Optional[_Bools]]]
    ) -> None:
        """Writes the answer to a query (or to the query of that id).

        `masks` is bool (T, H, W) in the order of `Benchmark.clip(scene)`, or a dict from each of these frames to bool (H, W)
        or None. None, and a mask without a pixel, say that what is asked for cannot be seen. Frames of a capture that
        no one annotated may be left out.
        """
    def finish(self, seconds: float) -> None:
        """Writes into the card how many wall seconds the method took for all queries. A folder is whole without it."""

@final
class Finding:
    """One problem that a check found, with a stable code (docs/findings.md)."""
    @property
    def code(self) -> str:
        """`L4D` and three digits."""
    @property
    def severity(self) -> Literal["error", "warning"]:
        """`"error"` or `"warning"`."""
    @property
    def path(self) -> str:
        """File or folder."""
    @property
    def place(self) -> str:
        """Field, line, view, frame or entry inside it."""
    @property
    def message(self) -> str:
        """What is wrong."""
    @property
    def hint(self) -> str:
        """What to do."""

@final
class Picture:
    """What a model shows a camera."""
    @property
    def rgb(self) -> _Floats:
        """Display colour over the background, not clamped: float32 (H, W, 3), 0 to 1."""
    @property
    def depth_m(self) -> _Floats:
        """Planar depth (camera z), metres: float32 (H, W); +inf where there is none."""
    @property
    def alpha(self) -> Optional[_Floats]:
        """How much of a pixel the splats fill: float32 (H, W), 0 to 1; None where the pictures do not say."""
    def display(self) -> _Bytes:
        """What a screen shows: uint8 (H, W, 3)."""

@final
class PictureClip:
    """What a model shows a camera, one frame after another."""
    @property
    def frames(self) -> list[int]:
        """Canonical frames, in the order of the arrays."""
    @property
    def rgb(self) -> _Floats:
        """Display colour over the background, not clamped: float32 (T, H, W, 3), 0 to 1."""
    @property
    def depth_m(self) -> _Floats:
        """Planar depth (camera z), metres: float32 (T, H, W); +inf where there is none."""
    @property
    def alpha(self) -> Optional[_Floats]:
        """How much of a pixel the splats fill: float32 (T, H, W), 0 to 1; None where the pictures do not say."""
    def display(self) -> _Bytes:
        """What a screen shows: uint8 (T, H, W, 3)."""
    def __len__(self) -> int: ...

@final
class Splats:
    """A model on disk: a checkpoint folder of `l4d train-splats`, a model folder of 4DGaussians, or a PLY of 3D Gaussians.

    Drawn on the processor. Colours are display colours, as those that it was trained on.
    """
    def __new__(cls, path: _Path) -> Splats: ...
    @property
    def family(self) -> Literal["l4d", "4dgaussians", "ply"]:
        """Who wrote it: `"l4d"`, `"4dgaussians"` or `"ply"`."""
    @property
    def scene(self) -> Optional[str]:
        """Scene that it was trained on, or None where it does not say so."""
    @property
    def profile(self) -> Optional[_Profile]:
        """Profile of the pictures that it was trained on, or None where it does not say so."""
    @property
    def gaussian_count(self) -> int:
        """How many Gaussians there are."""
    @property
    def dynamic_count(self) -> int:
        """How many of them go through the deformation field."""
    @property
    def saw_depth(self) -> Optional[bool]:
        """Whether it learned from rendered depth of the training views, or None where it does not say so."""
    @property
    def notes(self) -> list[str]:
        """What was ignored or assumed when it was read, a sentence each."""
    def render(
        self,
        camera: Camera,
        *,
        frame: Optional[int] = None,
        time: Optional[float] = None,
        size: Optional[tuple[int, int]] = None,
        background: Optional[tuple[float, float, float]] = None,
        depth: _Depth = "median",
    ) -> Picture:
        """What a camera sees at a canonical frame, or at a time from 0 to 1 (one of the two; a camera that moves has poses at
        frames alone).

        `size` is (width, height), pixels: that of the camera by default. `background` is a display colour, each channel
        0 to 1: what the model was trained to show, else black. `depth` is `"median"` (where transmittance crosses a half),
        `"expected"` (sum z a T / sum a T) or `"sum"` (sum z a T, as 4DGaussians has it).
        """
    def gaussians(
        self,
        *,
        frame: Optional[int] = None,
        time: Optional[float] = None,
    ) -> dict[str, npt.NDArray[np.float32]]:
        """The Gaussians as they are drawn, at a canonical frame or at a time from 0 to 1 (one of the two).

        float32 arrays by name: `means` (N, 3), centres in metres; `scales` (N, 3), standard deviations in metres;
        `rotations` (N, 4), unit quaternions (w, x, y, z) from own to world axes; `opacities` (N,), 0 to 1; `sh` (N, K, 3),
        spherical harmonics, the constant one first.
        """
    def clip(
        self,
        camera: Camera,
        frames: Sequence[int],
        *,
        size: Optional[tuple[int, int]] = None,
        background: Optional[tuple[float, float, float]] = None,
        depth: _Depth = "median",
    ) -> PictureClip:
        """What a camera sees at canonical frames; arguments as in `render`. The model is deformed once a frame."""

@final
class Clips:
    """A folder of clips: what a model shows several cameras over time."""
    def __new__(cls, path: _Path) -> Clips: ...
    @property
    def width(self) -> int:
        """Columns of the pictures, pixels."""
    @property
    def height(self) -> int:
        """Rows of the pictures, pixels."""
    @property
    def depth_kind(self) -> _Depth:
        """Which depth was drawn: `"median"`, `"expected"` or `"sum"`."""
    @property
    def views(self) -> list[str]:
        """Names of the views, sorted."""
    def camera(self, view: str) -> Camera:
        """The camera of a view."""
    def frames(self, view: str) -> list[int]:
        """Canonical frames that are there of a view, ascending. Times between frames are left out."""
    def read(self, view: str, frames: Optional[Sequence[int]] = None) -> PictureClip:
        """Reads pictures of a view at canonical frames (all that are there by default). Colours were stored with 8 bits.
        Depth that was stored as PNG comes without alpha.
        """

class _Metrics(TypedDict):
    miou: Optional[float]
    macc: Optional[float]
    acc25: Optional[float]
    acc50: Optional[float]
    tube_iou: Optional[float]
    select: Optional[float]
    false_positive_rate: Optional[float]
    queries: int

class _Summary(_Metrics):
    name: str
    version: str
    profile: _Profile
    partial: bool
    missing_frames: int
    categories: dict[str, _Metrics]
    scales: dict[str, _Metrics]
    scenes: dict[str, _Metrics]
    averages: dict[str, _Metrics]

class _Scores(TypedDict):
    protocol: str
    profile: _Profile
    set: _JudgedSet
    benchmark_version: str
    truth_digest: str
    scenes: list[str]
    methods: list[_Summary]
    findings: list[dict[str, str]]

def score(
    results: _Path,
    benchmark: Benchmark,
    *,
    set: _JudgedSet = "queries",
    scenes: Optional[Sequence[str]] = None,
    missing: Literal["error", "zero", "skip"] = "error",
    hit_iou: float = 0.0,
    verified_only: bool = False,
    resize: bool = False,
    scores: Optional[_Path] = None,
    max_megabytes: int = 4000,
    force: bool = False,
) -> _Scores:
    """Scores a results folder, or a folder of them: the document that `l4d score --json` prints, number for number.

    Percentages are under `document["methods"]`; a method with an error finding is not among them, and
    `document["findings"]` says why. `set` is `"queries"` or `"composites"`; `scenes` are all by default; `missing` is
    `"error"`, `"zero"` or `"skip"`; mAcc counts frames whose IoU is above `hit_iou`. `counts.csv` and `summary.json` of
    each method are written below `scores`, or nowhere; files of others there are replaced only if `force` is set. A
    method with more than `max_megabytes` of masks is not read.
    """
def check(
    results: _Path,
    benchmark: Benchmark,
    *,
    set: _JudgedSet = "queries",
    scenes: Optional[Sequence[str]] = None,
    max_megabytes: int = 4000,
) -> list[Finding]:
    """Every problem of a results folder, or of a folder of them: what `l4d check-results` finds. A method with more than
    `max_megabytes` of masks is not read.
    """
def write_baseline(
    name: Literal["oracle", "time-agnostic", "look-alike-union", "random-look-alike", "all", "none"],
    benchmark: Benchmark,
    results: _Path,
    *,
    scenes: Optional[Sequence[str]] = None,
    seed: int = 0,
    force: bool = False,
) -> Path:
    """Writes the results of a baseline to `<results>/<name>/` and gives that folder: what `l4d baseline` does.

    `name` is `"oracle"`, `"time-agnostic"`, `"look-alike-union"`, `"random-look-alike"`, `"all"` or `"none"`. Files with
    the right bytes are kept; other bytes are replaced only if `force` is set.
    """
def rle_encode(mask: _Bools) -> str:
    """A mask, bool (H, W), as compressed COCO counts."""
def rle_decode(counts: str, height: int, width: int) -> _Bools:
    """The mask, bool (H, W), of compressed COCO counts."""

def decode_colour(png: bytes) -> _Bytes:
    """Colours of the member `png` of a sample: uint8 (H, W, 3), what a screen shows."""

def decode_depth(png: bytes, scale_m: float, rest: Optional[bytes] = None) -> _Floats:
    """Planar depth of the member `depth.png` of a sample, metres: float32 (H, W); +inf where nothing is hit.

    `scale_m` is `depth_scale_m` of the sample. With `rest`, the member `depth_rest.png`, depth is what was rendered to the last
    bit; without it, it is off by half of `scale_m` at most.
    """

def decode_ids(png: bytes) -> _Ids:
    """Instance ids of the member `ids.png` of a sample: uint32 (H, W); 0 where nothing is annotated."""
