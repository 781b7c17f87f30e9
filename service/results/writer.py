"""A dataset on its way: frames come in while the simulation runs, one file comes out at its end."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from service.cases import CaseSpec
from service.results import netcdf
from service.results.durable import discard, scratch, sha256_of, sync, syncing
from service.results.schema import stored_variables
from service.results.segments import Segment, Segments
from solver import Frame, Run


@dataclass(frozen=True)
class Published:
    """A dataset under its final name: its checksum (hexadecimal) and its size."""

    sha256: str
    bytes: int


class DatasetWriter:
    """Writes one dataset; under `path` there is nothing, or what was there, until it is complete.

    `with DatasetWriter(path, spec) as writer:` append the frames, then publish. Whatever way the
    block is left, what is not published is discarded; but not in a `directory` that is given, where a
    later writer may go on from the segments that were `written`.
    """

    def __init__(
        self, path: Path, spec: CaseSpec, directory: Path | None = None, written: Sequence[Segment] = ()
    ) -> None:
        self._path, self._spec = path.absolute(), spec
        self._variables = stored_variables(spec)
        self._tries = 0
        self._cleanup = ExitStack()
        self._directory = directory or self._cleanup.enter_context(scratch(self._path))
        self._segments = Segments(self._directory, self._variables, path.stem, written)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._cleanup.close()

    def append(self, frame: Frame) -> None:
        """Take one frame. Raises OSError where those so far cannot be written; `flush` tries that again."""
        self._segments.append(frame)

    @property
    def frames(self) -> int:
        """How many it has."""
        return self._segments.frames

    @property
    def waiting(self) -> int:
        """Bytes of those that are not on the disk yet."""
        return self._segments.waiting

    def flush(self) -> list[Segment]:
        """Bring all frames so far to the disk, and tell where they are. Raises OSError."""
        self._segments.flush()
        return list(self._segments.written)

    def publish(self, outcome: str, message: str, run: Run) -> Published:
        """Write the dataset beside its place, read it back, and give it its name.

        `outcome` and `message` say how the run ended. Raises OSError where that cannot be done; then nothing is left
        under the name that was not there before, and it may be tried again.
        """
        self._tries += 1  # HDF5 keeps a file open that it could not write, and never writes under its name again
        beside = self._directory / f"{self._path.stem}.{self._tries}{self._path.suffix}.part"
        try:
            return self._publish(beside, run.s, self._attributes(outcome, message, run))
        except OSError:
            discard(beside)
            raise

    def _publish(self, beside: Path, s: NDArray[np.float64], attributes: Mapping[str, Any]) -> Published:
        blocks = self._segments.blocks
        netcdf.write(beside, self._variables, s, self._segments.frames, blocks, attributes)
        with syncing(beside):
            netcdf.verify(beside, blocks)
            published = Published(sha256_of(beside), beside.stat().st_size)
        beside.replace(self._path)
        sync(self._path.parent)
        return published

    def _history(self, run: Run) -> str:
        """How the values came about."""
        intervals = len(run.s) - 1
        history = f"simulated by hockle with {intervals} intervals"
        if self._spec.numerics.tolerance is not None:
            if run.accuracy is None or run.accuracy.unknown:
                return f"{history}; nothing tells the errors"
            return f"{history} and with fewer; the values are extrapolated (Richardson, order 2), with their errors"
        if not self._spec.numerics.verify:
            return history
        return (f"{history} and with {2 * intervals} and steps half as long; the values are extrapolated from both "
                "(Richardson, order 2), the errors are those of the finer run")  # fmt: skip

    def _attributes(self, outcome: str, message: str, run: Run) -> dict[str, Any]:
        """The global attributes: CF, ACDD, what a reader needs to run the case again, and what the run noticed."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        spec, history, statistics = self._spec, self._history(run), run.statistics
        return {
            "Conventions": "CF-1.11, ACDD-1.3",
            "title": spec.title or spec.name,
            "summary": spec.description or f"An elastic rod, {spec.analysis} analysis: case {spec.name}.",
            "keywords": "Kirchhoff rod, elastic rod dynamics, self-contact, twist, writhe",
            "source": "hockle, a simulator of Kirchhoff rod dynamics",
            "institution": "hockle",
            "references": "Goyal, Perkins & Lee (2003), Writhing dynamics of cables with self-contact",
            "history": f"{now} {history}",
            "date_created": now,
            "cdm_data_type": "Other",
            "case_name": spec.name,
            "case": json.dumps(spec.document()),
            "outcome": outcome,
            "message": message,
            "cpu_time": statistics.cpu_time,
            "steps": statistics.steps,
            "failed_steps": statistics.failed_steps,
            "newton_iterations": statistics.newton_iterations,
            **run.attributes(),
            **netcdf.versions(),
        }
