"""Builds of hockle in which a feature is not compiled: copies of its sources with the feature's tests made false."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
PACKAGES = ("outcomes", "solver", "service", "validation", "benchmarks")
CONTACT = (("return bool(touch.present and touch.pairs.counts[0] > 0)", "return False"),
           ("self.present = contact is not None", "self.present = False"))  # fmt: skip
FLUID = (("    added_mass,\n", ""), ("    drag,\n", ""))
LOADS = (("    dead,\n", ""), ("    following,\n", ""))
SPACE = (("axis = axis_of(scene)", "axis = None"),)
WITHOUT: dict[str, tuple[tuple[str, str], ...]] = {"": (), "contact": CONTACT, "fluid": FLUID, "loads": LOADS,
                                                 "turning in space": SPACE}  # fmt: skip
"""By the feature that is left out: what is replaced, wherever it stands in the solver's sources. A load is left out by
its line in the registry.

Turning in space is the other way about: the whole build leaves it out by itself, and the one named after it never does.
"""


class Build:
    """A process that runs one build, a scene at a time."""

    def __init__(self, folder: Path) -> None:
        command = [sys.executable, "-m", "benchmarks.skipping.server"]
        environment = os.environ | {"PYTHONPATH": str(folder), "XDG_CACHE_HOME": str(folder / "cache")}
        environment.pop("NUMBA_CACHE_DIR", None)
        self._process = subprocess.Popen(command, cwd=folder, env=environment, text=True,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)  # fmt: skip

    def cpu(self, scene: str, method: str) -> float:
        """CPU time (s) of one run of a scene."""
        assert self._process.stdin and self._process.stdout
        print(json.dumps([scene, method]), file=self._process.stdin, flush=True)
        return float(self._process.stdout.readline())

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin
        self._process.stdin.close()
        self._process.wait()


@contextmanager
def build(without: str) -> Iterator[Build]:
    """hockle without a feature, "" for the whole. Raises LookupError if its sources no longer say what is replaced."""
    with ExitStack() as cleanup:
        folder = Path(cleanup.enter_context(TemporaryDirectory(prefix="hockle-without-")))
        for package in PACKAGES:
            shutil.copytree(ROOT / package, folder / package, ignore=shutil.ignore_patterns("__pycache__", "results"))
        for old, new in WITHOUT[without]:
            holding = [f for f in (folder / "solver").rglob("*.py") if old in f.read_text(encoding="utf-8")]
            if not holding:
                raise LookupError(f"no source of the solver says {old!r}")
            for file in holding:
                file.write_text(file.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
        running = Build(folder)
        cleanup.callback(running.close)
        yield running
