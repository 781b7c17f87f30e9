"""The rod as a tube that moves: one binary glTF 2.0 file (.glb), which Blender, browsers and slides show.

Each frame is a morph target of the first one; the animation goes from one to the next on straight lines.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.query import NoFrames, Source, UnknownVariable

FACETS = 12
MOST_RINGS, MOST_FRAMES = 300, 120
FLOAT, UNSIGNED = 5126, 5125
VERTICES, INDICES = 34962, 34963
COLOUR = [0.93, 0.62, 0.20, 1.0]
SHAPE = ("r", "orientation")
Array = NDArray[np.float64]


def glb(source: Source, radius: Array) -> bytes:
    """The frames, thinned out to what can be drawn; `radius` (n,), m. Raises UnknownVariable where no shape was
    stored, NoFrames."""
    missing = [name for name in SHAPE if name not in source.variables]
    if missing:
        raise UnknownVariable(f"output.fields must have r and orientation for glTF, and has no {missing[0]}")
    if not len(source.time):
        raise NoFrames("the run failed before its first frame: there is no rod to show")
    nodes = np.linspace(0, len(source.s) - 1, min(len(source.s), MOST_RINGS)).round().astype(int)
    frames = slice(0, None, max(1, ceil(len(source.time) / MOST_FRAMES)))
    r, q = (source.read(source.variables[name], {"time": frames})[:, nodes] for name in SHAPE)
    shapes = np.stack([_surface(*frame, radius[nodes]) for frame in zip(r, q, strict=True)]).astype("<f4")
    file = _File()
    return file.packed(_document(file, shapes, source.time[frames].astype("<f4"), len(nodes)))


def _surface(r: Array, q: Array, radius: Array) -> Array:
    """Points (rings FACETS, 3) around the centreline."""
    w, x, y, z = q.T
    a1 = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
    a2 = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)
    angle = np.arange(FACETS) * 2 * np.pi / FACETS
    normal = np.cos(angle)[:, None] * a1[:, None, :] + np.sin(angle)[:, None] * a2[:, None, :]
    return np.asarray(r[:, None, :] + radius[:, None, None] * normal).reshape(-1, 3)


def _triangles(rings: int) -> NDArray[np.uint32]:
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(FACETS), indexing="ij")
    a, b = i * FACETS + j, i * FACETS + (j + 1) % FACETS
    return np.stack([a, b, a + FACETS, b, b + FACETS, a + FACETS], axis=-1).ravel().astype("<u4")


@dataclass
class _File:
    """The binary part, as it grows, with what describes it."""

    content: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, values: NDArray[Any], kind: str, target: int | None = None) -> int:
        """Add an array; gives the number of its accessor."""
        view = {"buffer": 0, "byteOffset": len(self.content), "byteLength": values.nbytes}
        self.views.append(view if target is None else view | {"target": target})
        flat = values.reshape(len(values), -1)
        self.accessors.append({
            "bufferView": len(self.views) - 1, "componentType": FLOAT if values.dtype.kind == "f" else UNSIGNED,
            "count": len(values), "type": kind, "min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist(),
        })  # fmt: skip
        self.content += values.tobytes()
        return len(self.accessors) - 1

    def packed(self, document: dict[str, Any]) -> bytes:
        """The file."""
        whole = {**document, "accessors": self.accessors, "bufferViews": self.views,
                 "buffers": [{"byteLength": len(self.content)}]}
        text = json.dumps(whole).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.content) + b"\0" * (-len(self.content) % 4)
        chunks = [(text, b"JSON"), (binary, b"BIN\0")]
        body = b"".join(len(chunk).to_bytes(4, "little") + kind + chunk for chunk, kind in chunks)
        return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body


def _document(file: _File, shapes: NDArray[np.float32], time: NDArray[np.float32], rings: int) -> dict[str, Any]:
    primitive: dict[str, Any] = {
        "attributes": {"POSITION": file.add(shapes[0], "VEC3", VERTICES)},
        "indices": file.add(_triangles(rings), "SCALAR", INDICES), "material": 0,
    }  # fmt: skip
    mesh: dict[str, Any] = {"primitives": [primitive]}
    surface = {"baseColorFactor": COLOUR, "metallicFactor": 0.0, "roughnessFactor": 0.6}
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "hockle"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "rod"}], "meshes": [mesh],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": surface}],
    }  # fmt: skip
    targets = len(shapes) - 1
    if targets:
        primitive["targets"] = [{"POSITION": file.add(shape - shapes[0], "VEC3", VERTICES)} for shape in shapes[1:]]
        mesh["weights"] = [0.0] * targets
        weights = np.vstack([np.zeros(targets), np.eye(targets)]).astype("<f4").ravel()
        sampler = {"input": file.add(time, "SCALAR"), "output": file.add(weights, "SCALAR"), "interpolation": "LINEAR"}
        channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
        document["animations"] = [{"name": "motion", "samplers": [sampler], "channels": [channel]}]
    return document
