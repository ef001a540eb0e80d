"""What a picture of a mode draws: bodies fine enough to bend, with the displacement of every vertex."""

import json
import struct
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.mesh.places import Elements
from fem.structure import Structure
from geometry.atomic import write_with
from geometry.errors import BadInput
from geometry.frames import Array, Integers, freeze
from validation.diagnose.diagnosis import FoundNode
from validation.diagnose.everywhere import MASS, RESONATOR, NodeScores
from validation.report.charts.spec import FAINT, INK
from validation.report.charts.static import ABOUT, require_format, save
from validation.report.scenes import scene
from validation.report.scenes.scene import surface

CREASE = 30.0
"""Faces that meet at more than this angle [°] have an edge worth drawing."""

PASSES = 10
"""Of halving at most: a plate of one metre comes down to a millimetre."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MovingBody:
    """One body of a mode's picture.

    Attributes
    ----------
    name : as in the article
    vertices : (n, 3) [m], at rest, in the article's frame
    faces : (k, 3), indices of the vertices of each triangle
    edges : (e, 2), indices of the ends of each piece of a sharp edge
    displacement : (n, 3), of the mode, in any scale that all bodies of the picture share
    """

    name: str
    vertices: Array
    faces: Integers
    edges: Integers
    displacement: Array

    def __post_init__(self) -> None:
        n = len(self.vertices)
        freeze(self, vertices=(n, 3), displacement=(n, 3))

    @property
    def size(self) -> Array:
        """Length of the displacement (n,)."""
        return np.asarray(np.linalg.norm(self.displacement, axis=1))


def bendable(body: scene.DrawnBody, longest: float) -> scene.DrawnBody:
    """`body` with its triangles halved until no side is longer than `longest` [m]; the surface stays the same and closed."""
    mesh = surface(body.vertices, body.faces).subdivide_adaptive(max_edge_len=longest, max_tri_area=np.inf, max_n_passes=PASSES)
    return scene.DrawnBody(
        name=body.name,
        material=body.material,
        vertices=np.asarray(mesh.points, dtype=np.float64),
        faces=mesh.faces.reshape(-1, 4)[:, 1:],
        counted=body.counted,
    )


def sharp_edges(body: scene.DrawnBody) -> Integers:
    """The edges (e, 2) of `body` where its faces meet at an angle, as indices of its vertices."""
    mesh = surface(body.vertices, body.faces)
    mesh.point_data["number"] = np.arange(len(body.vertices))
    edges = mesh.extract_feature_edges(CREASE, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
    if not edges.n_cells:
        return np.zeros((0, 2), dtype=np.int64)
    return np.asarray(edges.point_data["number"][edges.lines.reshape(-1, 3)[:, 1:]], dtype=np.int64)


def largest(bodies: Sequence[MovingBody]) -> float:
    """Length of the largest displacement of all `bodies`."""
    return max((float(body.size.max(initial=0.0)) for body in bodies), default=0.0)


# A mode shape rendered: deformed and coloured by displacement, with the edges of the body at rest behind it.


STILL = "#d3d8e0"
"""What does not move; the colours from there on are those of `turbo`, whose own lowest ones are nearly black."""
AT_REST = "#b4bac4"

REACH = 0.09
"""Largest displacement drawn, as a share of the article's diagonal."""


def scale_of(bodies: Sequence[MovingBody]) -> float:
    """Factor [m per unit of displacement] that brings the largest displacement to `REACH`; 0 where nothing moves."""
    points = np.concatenate([body.vertices for body in bodies])
    most = largest(bodies)
    return REACH * float(np.linalg.norm(np.ptp(points, axis=0))) / most if most > 0 else 0.0


def colour_map() -> Any:
    """Light grey for what stands still, then blue, green, yellow, red."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap

    turbo = colormaps["turbo"]
    return LinearSegmentedColormap.from_list("motion", [STILL, *(turbo(x) for x in np.linspace(0.12, 0.95, 12))], N=256)


def view_of(modes: Sequence[Sequence[MovingBody]], size: tuple[int, int], margin: float) -> scene.Projection:
    """The view in which every one of `modes` fits, at both ends of its swing."""
    swings = []
    for bodies in modes:
        scale = scale_of(bodies)
        swings += [body.vertices + sign * scale * body.displacement for body in bodies for sign in (-1, 1)]
    return scene.fitted(np.concatenate(swings), size, margin)


def rendered(view: scene.Projection, bodies: Sequence[MovingBody], share: float) -> scene.Image:
    """`bodies` at `share` (-1 to 1) of their swing. To be called inside of `off_screen`."""
    return displaced(view, bodies, share * scale_of(bodies), largest(bodies))


def displaced(view: scene.Projection, bodies: Sequence[MovingBody], factor: float, most: float) -> scene.Image:
    """`bodies` with their displacement times `factor`, coloured from none to `most`. To be called inside of `off_screen`."""
    image = scene.shot(view, lambda plotter: _draw(plotter, bodies, factor, most), peels=0)
    return np.round(scene.averaged(image.astype(np.float64))).astype(np.uint8)


def _draw(plotter: scene.Plotter, bodies: Sequence[MovingBody], factor: float, most: float) -> None:
    for body in bodies:
        scene.draw_edges(plotter, body.edges, body.vertices, AT_REST)
        points = body.vertices + factor * body.displacement
        mesh = surface(points, body.faces)
        mesh.point_data["displacement"] = body.size / most if most > 0 else body.size
        look = {"ambient": 0.55, "diffuse": 0.55, "specular": 0.05, "show_scalar_bar": False}
        plotter.add_mesh(mesh, scalars="displacement", cmap=colour_map(), clim=(0, 1), **look)
        scene.draw_edges(plotter, body.edges, points, INK)


# Mode shapes on one sheet, each with its number, frequency and words; and one of them moving, as a GIF.


COLUMNS = 4
TILE = (400, 500)
CAPTION = 104
"""Pixels above a tile for number, frequency and words."""

LETTERS = 22
"""[pixel] of a sheet of `COLUMNS`, which is 182 mm wide on paper: 7 pt there. Held by test_mode_pictures.py."""

MEANS = "displacement over its largest"
"""What the colours of a mode are."""

HEAD, FOOT = 78, 108
MARGIN = 14.0

FRAMES = 24
PERIOD = 1560
"""Frames of one cycle of a GIF, and its duration [ms]."""

MOVING_TILE = (620, 640)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnMode:
    """One mode to be drawn.

    Attributes
    ----------
    number : from 1
    frequency : [Hz]
    text : what it is
    bodies : with their displacement
    heading : above it; by default number and frequency
    """

    number: int
    frequency: float
    text: str
    bodies: tuple[MovingBody, ...]
    heading: str = ""

    @property
    def caption(self) -> str:
        """Above the picture."""
        return self.heading or f"{self.number}   {self.frequency:.2f} Hz"


def mode_sheet(
    title: str, modes: Sequence[DrawnMode], path: Path, note: str = "", about: str = "", swing: float = 1.0, means: str = MEANS
) -> None:
    """Write all of `modes` on one sheet, all seen from the same side and in the same scale.

    A PNG carries the words `about` as its comment.

    Parameters
    ----------
    swing : share of the displacement that is drawn, beside its colour
    means : what the colours are

    Raises
    ------
    BadInput : there is no mode, or the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    from matplotlib.colorbar import ColorbarBase

    require_format(path)
    if not modes:
        raise BadInput(title, "", "there is no mode to draw", "A rigid article has none in this range")
    columns = min(COLUMNS, len(modes))
    rows = -(-len(modes) // columns)
    with scene.off_screen():
        view = view_of([mode.bodies for mode in modes], TILE, MARGIN)
        tiles = [rendered(view, mode.bodies, swing) for mode in modes]
    width, height = max(columns * TILE[0], 2 * TILE[0]), HEAD + rows * (TILE[1] + CAPTION) + FOOT
    figure, canvas = scene.blank(width, height)
    scene.write(canvas, 24, 40, title, 26, weight="bold", va="center")
    for k, (mode, tile) in enumerate(zip(modes, tiles, strict=True)):
        x = k % columns * TILE[0]
        y = HEAD + k // columns * (TILE[1] + CAPTION)
        canvas.imshow(tile, extent=(x, x + TILE[0], y + CAPTION + TILE[1], y + CAPTION), interpolation="none")
        scene.write(canvas, x + 24, y + 16, mode.caption, LETTERS + 2, weight="bold", va="center")
        for j, tile_line in enumerate(textwrap.wrap(mode.text, 30, max_lines=2, placeholder=" …")):
            scene.write(canvas, x + 24, y + 46 + 27 * j, tile_line, LETTERS, FAINT, va="center")
    # What the colours mean
    points = LETTERS * 72 / scene.DPI
    axes = figure.add_axes(((width - 380) / width, 46 / height, 340 / width, 16 / height))
    bar = ColorbarBase(axes, cmap=colour_map(), orientation="horizontal", ticks=[0, 0.5, 1])
    bar.ax.tick_params(labelsize=points, colors=FAINT, length=2, pad=2)
    bar.outline.set_visible(False)
    axes.set_title(means, fontsize=points, color=FAINT, pad=5)
    for i, line in enumerate(textwrap.wrap(note, (width - 470) // 12, max_lines=3, placeholder=" …")):
        scene.write(canvas, 24, height - FOOT + 22 + 30 * i, line, LETTERS, FAINT, va="center")
    more = {"metadata": {ABOUT: about}} if about else {}
    save(path, lambda temporary: figure.savefig(temporary, dpi=scene.DPI, **more))


def animation(title: str, mode: DrawnMode, path: Path) -> None:
    """Write one cycle of `mode` as an endless GIF.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    # The strip above the moving picture
    figure, canvas = scene.blank(MOVING_TILE[0], 84)
    scene.write(canvas, 18, 28, f"{title}, mode {mode.caption}", 20, weight="bold", va="center")
    scene.write(canvas, 18, 60, textwrap.shorten(mode.text, 84, placeholder=" …"), 14, FAINT, va="center")
    head = scene.pixels(figure)
    with scene.off_screen():
        view = view_of([mode.bodies], MOVING_TILE, MARGIN)
        shares = np.sin(2 * np.pi * np.arange(FRAMES) / FRAMES)
        frames = [np.vstack([head, rendered(view, mode.bodies, share)]) for share in shares]
    scene.write_gif(path, frames, PERIOD // FRAMES, FRAMES // 4)


# A moving mode as binary glTF 2.0: the surface at rest, one morph target (the mode), and an animation of its weight.
#
# Written here because no library at hand writes morph targets: trimesh and VTK export meshes as they stand. The layout is that
# of the Khronos glTF 2.0 specification: a header, a JSON chunk that names slices of a binary chunk, and that chunk. Every body
# is a mesh and a node of its own, which is what readers expect of a morph. Lengths are metres; glTF has y upwards, so the root
# turns the article's z there.


FLOAT, UNSIGNED_BYTE, UNSIGNED_INT = 5126, 5121, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
LINES, TRIANGLES = 1, 4
GLB, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942

CYCLE = 2.0
"""Seconds of one swing, whatever the frequency: nobody can watch 15 Hz."""

KEYFRAMES = 33

_UPRIGHT = [-float(np.sqrt(0.5)), 0.0, 0.0, float(np.sqrt(0.5))]
"""Quaternion of a quarter turn about -x: z becomes y."""


def write_glb(path: Path, title: str, mode: DrawnMode) -> None:
    """Write `mode` as an animated ``.glb``, whole or not at all."""
    binary = glb(title, mode)
    write_with(path, lambda temporary: temporary.write_bytes(binary))


def glb(title: str, mode: DrawnMode) -> bytes:
    """`mode` as the bytes of a ``.glb`` file."""
    buffer = _Buffer()
    scale = scale_of(mode.bodies)
    # Red, green and blue (n, 3) of every vertex of `mode.bodies`
    most = largest(mode.bodies) or 1.0
    colours = [np.round(255 * colour_map()(body.size / most)[:, :3]).astype(np.uint8) for body in mode.bodies]
    meshes = [mesh for body, colour in zip(mode.bodies, colours, strict=True) for mesh in _meshes(buffer, body, colour, scale)]
    children = list(range(1, 1 + len(meshes)))
    time = np.linspace(0, CYCLE, KEYFRAMES)
    sampler = {
        "input": buffer.add(time[:, None], "SCALAR", bounds=True),
        "output": buffer.add(np.sin(2 * np.pi * time / CYCLE)[:, None], "SCALAR"),
        "interpolation": "LINEAR",
    }
    tree = {
        "asset": {
            "version": "2.0",
            "generator": "massline",
            "extras": {"title": title, "mode": mode.number, "frequency_hz": mode.frequency, "what": mode.text},
        },
        "scene": 0,
        "scenes": [{"name": title, "nodes": [0]}],
        "nodes": [
            {"name": f"{title}, mode {mode.number}, {mode.frequency:.2f} Hz", "children": children, "rotation": _UPRIGHT},
            *({"name": mesh["name"], "mesh": index} for index, mesh in enumerate(meshes)),
        ],
        "meshes": meshes,
        "materials": _MATERIALS,
        "animations": [
            {
                "name": f"mode {mode.number}",
                "samplers": [sampler],
                "channels": [{"sampler": 0, "target": {"node": node, "path": "weights"}} for node in children],
            }
        ],
        **buffer.tables,
    }
    binary = bytes(buffer.content)
    text = json.dumps(tree, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks: Sequence[bytes] = (
        struct.pack("<II", len(text), JSON_CHUNK) + text,
        struct.pack("<II", len(binary), BINARY_CHUNK) + binary,
    )
    return struct.pack("<III", GLB, 2, 12 + sum(map(len, chunks))) + b"".join(chunks)


_MATERIALS = [
    {
        "name": "surface",
        "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.85},
    },
    {
        "name": "edges",
        "pbrMetallicRoughness": {"baseColorFactor": [0.02, 0.02, 0.03, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0},
    },
]


class _Buffer:
    """The binary chunk while it grows, and the tables that say what lies where in it."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    @property
    def tables(self) -> dict[str, Any]:
        return {"buffers": [{"byteLength": len(self.content)}], "bufferViews": self.views, "accessors": self.accessors}

    def add(self, values: npt.ArrayLike, kind: str, *, target: int | None = None, bounds: bool = False, of: int = FLOAT) -> int:
        """Append `values` (n, width) and return the number of their accessor."""
        array = np.asarray(values, dtype={FLOAT: "<f4", UNSIGNED_INT: "<u4", UNSIGNED_BYTE: "u1"}[of])
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.content), "byteLength": array.nbytes}
        self.views.append(view | ({} if target is None else {"target": target}))
        self.content += array.tobytes()
        self.content += b"\0" * (-len(self.content) % 4)
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1, "componentType": of, "count": len(array), "type": kind}
        if of == UNSIGNED_BYTE:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _meshes(buffer: _Buffer, body: MovingBody, colour: npt.NDArray[np.uint8], scale: float) -> list[dict[str, Any]]:
    """Surface and sharp edges of `body`, on the same vertices."""
    position = buffer.add(body.vertices, "VEC3", target=ARRAY_BUFFER, bounds=True)
    moved = buffer.add(scale * body.displacement, "VEC3", target=ARRAY_BUFFER, bounds=True)
    # Colours (n, 3) as screens show them, in the linear light that glTF wants, opaque: (n, 4)
    screen = colour / 255.0
    light = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
    opaque = np.full((len(colour), 1), 255)
    shade = buffer.add(np.hstack([np.round(255 * light), opaque]).astype(np.uint8), "VEC4", target=ARRAY_BUFFER, of=UNSIGNED_BYTE)

    def drawn(name: str, indices: npt.NDArray[np.int64], mode: int, material: int, **more: int) -> dict[str, Any]:
        primitive = {
            "attributes": {"POSITION": position, **more},
            "targets": [{"POSITION": moved}],
            "indices": buffer.add(np.reshape(indices, (-1, 1)), "SCALAR", target=ELEMENT_ARRAY_BUFFER, of=UNSIGNED_INT),
            "mode": mode,
            "material": material,
        }
        return {"name": name, "primitives": [primitive], "weights": [0.0]}

    surface = drawn(body.name, body.faces, TRIANGLES, 0, COLOR_0=shade)
    return [surface, drawn(f"{body.name}, edges", body.edges, LINES, 1)] if len(body.edges) else [surface]


# A sweep that passes a resonance, moving: the article as it bends, and below it the load with the moment that is shown.


PACE = 90
"""[ms] a frame."""

PASSING_HEAD, STRIP = 84, 250
"""Pixels above and below the article."""

SHOWN, TO_COME, NOW = "#2456c4", "#c9d3ea", "#c8283c"


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """One moment.

    Attributes
    ----------
    time : [s]
    frequency : of the sweep [Hz]
    bodies : with their displacement [m]
    """

    time: float
    frequency: float
    bodies: tuple[MovingBody, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Passing:
    """All that is drawn.

    Attributes
    ----------
    title, text : above the article
    frames : in the order of their times
    time, load : (n,) [s], [N, N m] the curve below
    rigid : (n,) amplitude of the rigid body's load
    label : of the load, with its unit
    resonance : when [s] the sweep has the resonance's frequency
    """

    title: str
    text: str
    frames: tuple[Frame, ...]
    time: Array
    load: Array
    rigid: Array
    label: str
    resonance: float


def animate(passing: Passing, path: Path) -> None:
    """Write `passing` as an endless GIF.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    most = max(largest(frame.bodies) for frame in passing.frames)
    rest = np.concatenate([body.vertices for body in passing.frames[0].bodies])
    factor = REACH * float(np.linalg.norm(np.ptp(rest, axis=0))) / most if most > 0 else 0.0
    figure, canvas = scene.blank(MOVING_TILE[0], PASSING_HEAD)
    scene.write(canvas, 18, 28, passing.title, 20, weight="bold", va="center")
    scene.write(canvas, 18, 60, f"{passing.text}, displacement drawn {factor:.0f} times as large", 14, FAINT, va="center")
    head = scene.pixels(figure)
    with scene.off_screen():
        swung = np.concatenate([b.vertices + factor * b.displacement for frame in passing.frames for b in frame.bodies])
        view = scene.fitted(np.concatenate([rest, swung]), MOVING_TILE, MARGIN)
        images = [
            np.vstack([head, displaced(view, frame.bodies, factor, most), _strip(passing, frame)]) for frame in passing.frames
        ]
    # The frame with the largest displacement, which has all the colours
    scene.write_gif(path, images, PACE, int(np.argmax([largest(frame.bodies) for frame in passing.frames])))


def _strip(passing: Passing, frame: Frame) -> scene.Image:
    """The load up to the moment of `frame` and, paler, what is still to come."""
    width = MOVING_TILE[0]
    figure, canvas = scene.blank(width, STRIP)
    scene.write(canvas, 18, 20, f"{frame.frequency:.2f} Hz", 22, weight="bold", va="center")
    scene.write(canvas, 150, 21, f"at {frame.time:.2f} s", 15, FAINT, va="center")
    scene.write(canvas, width - 18, 21, "dashed: the rigid body, M a", 14, FAINT, va="center", ha="right")
    axes = figure.add_axes((78 / width, 46 / STRIP, (width - 98) / width, (STRIP - 90) / STRIP))
    past = passing.time <= frame.time
    axes.plot(passing.time, passing.load, color=TO_COME, linewidth=0.7)
    axes.plot(passing.time[past], passing.load[past], color=SHOWN, linewidth=0.8)
    for sign in (-1, 1):
        axes.plot(passing.time, sign * passing.rigid, color=INK, linewidth=1.0, linestyle=(0, (5, 3)))
    axes.axvline(passing.resonance, color=FAINT, linewidth=0.9)
    axes.axvline(frame.time, color=NOW, linewidth=1.2)
    axes.set_xlim(passing.time[0], passing.time[-1])
    reach = 1.08 * max(float(np.abs(passing.load).max()), float(passing.rigid.max()), float(np.finfo(np.float64).tiny))
    axes.set_ylim(-reach, reach)
    axes.tick_params(labelsize=13 * 72 / scene.DPI, colors=INK)
    axes.set_xlabel("time [s]", fontsize=13 * 72 / scene.DPI, labelpad=1)
    axes.set_ylabel(passing.label, fontsize=13 * 72 / scene.DPI)
    return scene.pixels(figure)


# The nodes of a user's own mesh, coloured by what the data say of something that may sit there.


WORDS = {
    MASS: "a mass",
    "cable:x": "a ground spring along x",
    "cable:y": "a ground spring along y",
    "cable:z": "a ground spring along z",
    RESONATOR: "a resonator",
}
"""What is looked for, in words."""

EVIDENCE_MEANS = "evidence over that of the best node"

NOTE = "Each node alone; best node and number as in the table. Grey: nothing."

THIN = 0.004
"""[share] of the structure's size: of the stick that stands for a beam."""

MARKS = (0.009, 0.025)
"""[share] of the structure's size: of the mark of a node without elements, where they are many and where they are few."""

LEAST = 1.0
"""[nats] below which there is nothing to be coloured."""

_MARK = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=np.float64)
_SIDES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


@dataclass(frozen=True, eq=False, kw_only=True)
class Outline:
    """A structure as it is drawn: the skin of its elements and a stick a beam, or a mark a node where no elements are known.

    Attributes
    ----------
    vertices : (v, 3) [m]
    faces : (f, 3)
    owner : (v,) of the nodes that it was made with, the one that a vertex goes with; -1 for none
    """

    vertices: Array
    faces: Integers
    owner: Integers

    @classmethod
    def of(cls, structure: Structure, nodes: Array) -> "Outline":
        """`structure`, of which `nodes` (p, 3) [m] move."""
        elements = structure.elements
        if not isinstance(elements, Elements):
            vertices, faces = marks(nodes, np.clip(0.25 / np.sqrt(len(nodes)), *MARKS) * float(np.ptp(nodes, axis=0).max()))
            return cls(vertices=vertices, faces=faces, owner=np.repeat(np.arange(len(nodes)), 6))
        from scipy.spatial import cKDTree

        away, nearest = cKDTree(nodes).query(elements.points)
        size = float(np.ptp(elements.points, axis=0).max())
        owner = np.where(away < 1e-9 * size, nearest, -1)
        triangles, lines = elements.skin()
        along = elements.points[lines[:, 1]] - elements.points[lines[:, 0]]
        across = np.cross(
            along, np.where(np.abs(along[:, [0]]) < np.abs(along).max(axis=1, keepdims=True), [1.0, 0, 0], [0, 1.0, 0])
        )
        across *= THIN * size / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), np.finfo(np.float64).tiny)
        other = np.cross(along, across) / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(np.float64).tiny)
        corners = [across, -0.5 * across + 0.87 * other, -0.5 * across - 0.87 * other]
        sticks = np.stack([elements.points[lines[:, end]] + each for end in (0, 1) for each in corners], axis=1)
        own = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]
        begin = len(elements.points) + 6 * np.arange(len(lines))[:, None, None]
        return cls(
            vertices=np.vstack([elements.points, sticks.reshape(-1, 3)]),
            faces=np.vstack([triangles, (begin + np.array(own)).reshape(-1, 3)]).astype(np.int64),
            owner=np.concatenate([owner, np.repeat(owner[lines], 3, axis=1).ravel()]),
        )

    def carried(self, of_nodes: Array) -> Array:
        """(v, ...) what every vertex has of what the nodes have (p, ...); nothing where it goes with none."""
        known = self.owner.reshape(-1, *(1,) * (of_nodes.ndim - 1)) >= 0
        return np.asarray(np.where(known, of_nodes[np.maximum(self.owner, 0)], 0.0))

    def moving(self, name: str, of_nodes: Array) -> MovingBody:
        """With the displacement (p, 3) of its nodes, in any scale."""
        edges = np.zeros((0, 2), dtype=np.int64)
        moved = self.carried(of_nodes)
        return MovingBody(name=name, vertices=self.vertices, faces=self.faces, edges=edges, displacement=moved)


def marks(points: Array, size: float) -> tuple[Array, Integers]:
    """Vertices (6 p, 3) and faces of octahedra of `size` [m] at `points` (p, 3) [m]."""
    faces = (6 * np.arange(len(points))[:, None, None] + np.array(_SIDES)).reshape(-1, 3)
    return (points[:, None] + size * _MARK).reshape(-1, 3), faces.astype(np.int64)


def body_of(scores: NodeScores, told: Sequence[FoundNode]) -> MovingBody:
    """The structure as it is drawn, its colours those of the evidence for what is `told` of its nodes, the best first: there they
    are what is told, and nowhere more than at the best. Nodes that nothing moves have none."""
    evidence = np.maximum(scores.evidence[told[0].kind], 0.0)
    evidence *= (told[0].evidence + told[0].looked) / max(float(evidence.max()), LEAST)
    for one in reversed(told):
        evidence[scores.nearest(one.position)] = one.evidence + one.looked
    shown = evidence[:, None] * np.array([1.0, 0.0, 0.0])
    return Outline.of(scores.structure, scores.points).moving(scores.article, shown)


def draw_nodes(found: Sequence[NodeScores], told: Sequence[FoundNode], path: Path) -> Path | None:
    """Write what is `told` of the nodes of the structures `found`, a picture each kind; none where nothing explains anything.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    tiles: list[DrawnMode] = []
    for scores in found:
        for kind in scores.evidence:
            own = [one for one in told if one.kind == kind and one.article == scores.article]
            if not own or own[0].evidence + own[0].looked < LEAST:
                continue
            x, y, z = 1e3 * np.array(own[0].position)
            whose, bodies = f"{scores.article}: " if len(found) > 1 else "", (body_of(scores, own),)
            text = f"{whose}{own[0].evidence:.1f} nats at ({x:.4g}, {y:.4g}, {z:.4g}) mm"
            tiles.append(DrawnMode(number=len(tiles) + 1, frequency=0.0, text=text, bodies=bodies, heading=WORDS[kind]))
    if not tiles:
        return None
    mode_sheet("Everywhere on the mesh", tiles, path, NOTE, swing=0.0, means=EVIDENCE_MEANS)
    return path
