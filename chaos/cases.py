"""The cases that are run, of a second or two each and by every method in time, and what a run of each must give."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from service.cases import apply_settings, build_scene, load_case, parse_case
from service.results import DatasetWriter, open_dataset
from solver import simulate

HALF = ", half"
SETTINGS: dict[str, dict[str, Any]] = {
    "goyal-2003": {"t_end": 20.0, "numerics.intervals": 160, "output.interval": 0.2, "numerics.dt_max": 0.005},
    "short-loop": {"t_end": 8.0, "numerics.intervals": 80, "output.interval": 0.08, "numerics.method": "staggered"},
    "cantilever-vibration": {"t_end": 160.0, "numerics.intervals": 160, "output.interval": 0.4,
                             "numerics.dt_max": 0.04, "numerics.method": "staggered"},  # about one axis
    "free-flight": {"t_end": 40.0, "numerics.intervals": 120, "output.interval": 0.2},
    "hanging-cable": {"t_end": 30.0, "numerics.intervals": 120, "numerics.dt_max": 0.005},
}


def cases() -> dict[str, dict[str, Any]]:
    """The cases by name."""
    return {name: apply_settings(load_case(name), settings) for name, settings in SETTINGS.items()}


def with_halves(cases: Mapping[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """The same, and each to half its end, from which a run of the whole goes on: the members of an ensemble."""
    return {**cases, **{f"{name}{HALF}": apply_settings(case, {"t_end": case["t_end"] / 2})
                        for name, case in cases.items()}}  # fmt: skip


def digest(dataset: Path) -> str:
    """What is the same in equal runs: every value of every variable to the bit, how it ended, its steps."""
    sha256 = hashlib.sha256()
    with open_dataset(dataset) as opened:
        for name in sorted(map(str, opened.variables)):
            values = opened[name].values
            plain = values.astype("U") if values.dtype.kind == "O" else values
            sha256.update(name.encode() + np.ascontiguousarray(plain).tobytes())
        for name in ("outcome", "message", "steps", "failed_steps", "newton_iterations"):
            sha256.update(f"{name} {opened.attrs[name]}".encode())
    return sha256.hexdigest()


def undisturbed(case: dict[str, Any]) -> str:
    """The digest of a run that nothing happens to, in this process."""
    spec = parse_case(case)
    simulation = simulate(build_scene(spec))
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "undisturbed.nc"
        with DatasetWriter(path, spec) as writer:
            for frame in simulation:
                writer.append(frame)
            writer.publish("completed", "", simulation)
        return digest(path)
