"""A moving mode as binary glTF 2.0: the surface at rest, one morph target (the mode), and an animation of its weight.

Written here because no library at hand writes morph targets: trimesh and VTK export meshes as they stand. The layout is that of
the Khronos glTF 2.0 specification: a header, a JSON chunk that names slices of a binary chunk, and that chunk. Every body is a
mesh and a node of its own, which is what readers expect of a morph. Lengths are metres; glTF has y upwards, so the root turns the
article's z there.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.atomic import write_with
from validation.pictures.mode_scene import colours_of, scale_of
from validation.pictures.mode_sheet import DrawnMode
from validation.pictures.moving import MovingBody

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
    colours = colours_of(mode.bodies)
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
    return _container(tree, bytes(buffer.content))


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
    shade = buffer.add(_linear(colour), "VEC4", target=ARRAY_BUFFER, of=UNSIGNED_BYTE)

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


def _linear(colour: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Colours (n, 3) as screens show them, in the linear light that glTF wants, opaque: (n, 4)."""
    screen = colour / 255.0
    light = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
    opaque = np.full((len(colour), 1), 255)
    return np.hstack([np.round(255 * light), opaque]).astype(np.uint8)


def _container(tree: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(tree, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks: Sequence[bytes] = (
        struct.pack("<II", len(text), JSON_CHUNK) + text,
        struct.pack("<II", len(binary), BINARY_CHUNK) + binary,
    )
    return struct.pack("<III", GLB, 2, 12 + sum(map(len, chunks))) + b"".join(chunks)
