"""What a moving picture of a rod needs of its frames, in few bytes: positions, axes, and what colours it."""

from __future__ import annotations

import json
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.query import Source, UnknownVariable

MOST_NODES = 600
"""Of a finer rod only every so many-th node is in a film: more could not be told apart in a picture."""

MOST_NODE_FRAMES = 1_000_000
"""Nodes times frames of a film: 44 MB with all colours. Of more frames only every so many-th is in it."""

SHAPE = ("r", "orientation")
COLOURS = {"curvature": ("kappa", "rad/m"), "twist": ("kappa", "rad/m"), "tension": ("f", "N"),
           "error": ("r_error", "m")}
"""Numbers along the rod that may colour it: the variable that each follows from, and its unit."""

Array = NDArray[np.float32]


def film(source: Source, since: float | None = None) -> bytes:
    """The frames after the time `since` (s), thinned out to what can be drawn.

    Returns the length of a JSON header (4 bytes, little-endian), the header, and then little-endian float32 numbers:
    of each block in its `blocks` all frames, nodes and components. The header also has `time`, `s`, `contacts` of each
    frame, and of each block `name`, `units` and `components`. Raises UnknownVariable where no shape was stored.
    """
    missing = [name for name in SHAPE if name not in source.variables]
    if missing:
        raise UnknownVariable(f"output.fields must have r and orientation for a film, and has no {missing[0]}")
    frames, nodes = _thinned(len(source.time), len(source.s))
    chosen = frames if since is None else frames[source.time[frames] > since]
    part = slice(int(chosen[0]), int(chosen[-1]) + 1, _step(chosen)) if len(chosen) else slice(0)
    ranges = {"time": part, "s": nodes}

    def read(name: str) -> NDArray[np.float64]:
        return source.read(source.variables[name], ranges)

    blocks = {name: read(name).astype("<f4") for name in SHAPE}
    for name, (variable, _) in COLOURS.items():
        if variable in source.variables:
            blocks[name] = _colour(name, read(variable))[..., None].astype("<f4")
    header = {
        "time": source.time[part].tolist(), "s": source.s[nodes].tolist(), "contacts": read("contacts").tolist(),
        "blocks": [_block_header(name, block) for name, block in blocks.items()],
    }
    return _packed(header, list(blocks.values()))


def _thinned(frames: int, nodes: int) -> tuple[NDArray[np.intp], slice]:
    """The frames and the nodes that are in a film; both ends of the rod always are."""
    step = next((n for n in range(ceil(nodes / MOST_NODES), nodes) if (nodes - 1) % n == 0), 1)
    drawn_nodes = (nodes - 1) // step + 1
    return np.arange(0, frames, max(1, ceil(frames * drawn_nodes / MOST_NODE_FRAMES))), slice(None, None, step)


def _step(frames: NDArray[np.intp]) -> int:
    return int(frames[1] - frames[0]) if len(frames) > 1 else 1


def _colour(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    if name == "curvature":
        return np.hypot(values[..., 0], values[..., 1])
    if name == "error":
        return np.asarray(np.linalg.norm(values, axis=-1))
    return values[..., 2]


def _block_header(name: str, block: Array) -> dict[str, Any]:
    units = COLOURS[name][1] if name in COLOURS else {"r": "m", "orientation": "1"}[name]
    return {"name": name, "units": units, "components": block.shape[-1]}


def _packed(header: dict[str, Any], blocks: list[Array]) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([len(text).to_bytes(4, "little"), text, *(block.tobytes() for block in blocks)])
