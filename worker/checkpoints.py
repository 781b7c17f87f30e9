"""What a job has reached, on the disk: the full state of its solver, and the segments of its frames so far."""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from io import BytesIO
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.durable import write_whole
from service.results.segments import Segment

KEPT = 2
DIGEST = 32
HEAD, PLACES, WORDS = "head", "places", "words"
WORD = 8

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Checkpoint:
    """After `steps` steps: the solver's arrays and numbers by name, and the segments that hold all frames."""

    steps: int
    state: Mapping[str, Any]
    segments: tuple[Segment, ...]


class Checkpoints:
    """The checkpoints of one job in `directory`, of which the newest two are kept.

    A file is the SHA-256 of the rest, then NumPy's npz: the state's arrays one after the other, as words of which
    zeros are left out (they are most), with the places of those that are there, and the other things as JSON. `key`
    tells what must be the same for a run to go on: the case and the solver's code.
    """

    def __init__(self, directory: Path, epoch: int, key: str) -> None:
        self._directory, self._epoch, self._key = directory, epoch, key

    def save(self, checkpoint: Checkpoint) -> None:
        """Write a checkpoint, to the disk. Raises OSError where that cannot be done."""
        write_whole(self._directory / f"checkpoint-{checkpoint.steps:012d}.{self._epoch}",
                    packed(checkpoint, self._key))
        for path in self._files()[KEPT:]:
            if int(path.suffix[1:]) <= self._epoch:  # another attempt's files are its own
                path.unlink(missing_ok=True)

    def newest(self) -> Checkpoint | None:
        """The farthest checkpoint that is whole, with all of its segments; None to begin anew."""
        for path in self._files():
            try:
                checkpoint = unpacked(path.read_bytes(), self._key)
            except (OSError, ValueError) as error:
                log.warning("%s is passed over: %s", path, error)
                continue
            if all(segment.is_whole(self._directory) for segment in checkpoint.segments):
                return checkpoint
            log.warning("%s is passed over: a segment is damaged", path)
        return None

    def _files(self) -> list[Path]:
        paths = self._directory.glob("checkpoint-*")
        return sorted((path for path in paths if path.suffix != ".part"), reverse=True)


def packed(checkpoint: Checkpoint, key: str) -> bytes:
    """A checkpoint as a file holds it."""
    arrays = {name: value for name, value in checkpoint.state.items() if isinstance(value, np.ndarray)}
    numbers = {name: value for name, value in checkpoint.state.items() if name not in arrays}
    head = {"key": key, "steps": checkpoint.steps, "numbers": numbers,
            "segments": [asdict(segment) for segment in checkpoint.segments],
            "arrays": [(name, value.dtype.str, value.shape) for name, value in arrays.items()]}
    head_bytes = np.frombuffer(json.dumps(head).encode(), np.uint8)
    whole = b"".join([*(value.tobytes() for value in arrays.values()), bytes(WORD)])
    words = np.frombuffer(whole[: len(whole) // WORD * WORD], np.uint64)
    content = BytesIO()
    nonzero = words != 0
    np.savez(content, **{HEAD: head_bytes, PLACES: np.packbits(nonzero), WORDS: words[nonzero]})
    return hashlib.sha256(content.getbuffer()).digest() + content.getvalue()


def unpacked(file_content: bytes, key: str) -> Checkpoint:
    """The checkpoint in a file. Raises ValueError where it is damaged, or has another key."""
    digest, content = file_content[:DIGEST], file_content[DIGEST:]
    if hashlib.sha256(content).digest() != digest:
        raise ValueError("it is damaged")
    with np.load(BytesIO(content)) as file:
        arrays = {name: file[name] for name in file.files}
    head = json.loads(arrays.pop(HEAD).tobytes())
    if head["key"] != key:
        raise ValueError("it is of another case, or of another version of the solver")
    if WORDS in arrays:  # else it is of a version that wrote each array by itself
        arrays = dict(_arrays(head["arrays"], np.unpackbits(arrays[PLACES]).astype(bool), arrays[WORDS]))
    segments = tuple(Segment(**segment) for segment in head["segments"])
    return Checkpoint(head["steps"], arrays | head["numbers"], segments)


def _arrays(headers: list[tuple[str, str, list[int]]], places: NDArray[np.bool_],
            words: NDArray[np.uint64]) -> Iterator[tuple[str, NDArray[Any]]]:  # fmt: skip
    whole, at = np.zeros(len(places), np.uint64), 0
    whole[places] = words
    content = whole.tobytes()
    for name, kind, shape in headers:
        array = np.frombuffer(content, kind, prod(shape), at).reshape(shape).copy()
        at += array.nbytes
        yield name, array
