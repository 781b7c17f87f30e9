"""What holds for every kernel."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

from solver.kernels import kernel as kernels
from solver.kernels.kernel import kernel

PATIENCE = 20_000_000_000
"""Turns of a loop, seconds of them, after which a kernel gives up waiting."""


@kernel
def wait_for(flags, told, turns):
    """Wait until another thread writes flags[told]; whether it did. The turns are counted among the flags, so that each
    reads anew."""
    while flags[told] == 0 and flags[turns] < PATIENCE:
        flags[turns] += 1
    return flags[told] != 0


def test_other_threads_run_while_a_kernel_does():
    flags = np.array([1, 0, 0])
    assert wait_for(flags, 0, 1)  # compiled
    begun = threading.Event()

    def tell() -> None:
        begun.set()
        while not flags[2]:  # the kernel has begun
            pass
        flags[0] = 1

    flags[:] = 0
    thread = threading.Thread(target=tell)
    thread.start()
    begun.wait()
    assert wait_for(flags, 0, 2)
    thread.join()


@kernel
def twice(i):
    """A number."""
    return 2 * i


@kernel
def sum_of_twice(i):
    """What is called with a number, and with two that are written in figures."""
    return twice(i) + twice(0) + twice(1)


def test_a_kernel_is_compiled_once_for_all_numbers_that_callers_write_in_figures():
    assert sum_of_twice(3) == 8
    sum_of_twice.recompile()  # one from the cache does not ask for what it calls
    assert len(twice.signatures) == 1


WRITTEN = """
import numpy as np
from typing import NamedTuple
from solver.kernels.handed import Reference
class {name}(NamedTuple):
    values: np.ndarray
Reference.to({name}(np.zeros(2)))
"""


def test_records_of_others_stand_in_no_cache(tmp_path):
    for name in ("mine", "theirs"):
        (tmp_path / f"{name}.py").write_text(WRITTEN.format(name=name.title()))
        environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kernels"), "HOCKLE_COMPILES": "1"}
        environment["PYTHONPATH"] = f"{tmp_path}{os.pathsep}{Path(__file__).parents[3]}"
        subprocess.run([sys.executable, "-c", f"import {name}"], env=environment, check=True)
        (tmp_path / f"{name}.py").unlink()


SOLVER = Path(kernels.__file__).parents[1]


def test_a_change_of_what_only_runs_methods_leaves_all_kernels_compiled(monkeypatch, tmp_path):
    solver = Path(shutil.copytree(SOLVER, tmp_path / "solver"))
    monkeypatch.setattr(kernels, "__file__", str(solver / "kernels" / "kernel.py"))

    def digest_with(change: str) -> str:
        with (solver / change).open("a") as source:
            source.write("# changed\n")
        return str(kernels.code_digest.__wrapped__())

    before = kernels.code_digest.__wrapped__()
    assert digest_with("run/simulation.py") == before
    assert digest_with("physics/section.py") != before


def test_no_kernel_depends_on_what_the_digest_leaves_out():
    upstairs = f"{kernels.OWN}.{kernels.UPSTAIRS}"
    for source in SOLVER.rglob("*.py"):
        place = source.relative_to(SOLVER)
        if place.parts[0] == kernels.UPSTAIRS:
            module = importlib.import_module(".".join((kernels.OWN, *place.with_suffix("").parts)))
            found = [it for it in vars(module).values() if isinstance(it, Dispatcher)]
            assert all(it.__module__ != module.__name__ for it in found), f"{source} has a kernel"
        elif place != Path("__init__.py"):
            assert upstairs not in source.read_text(), f"{source} imports {upstairs}"


def test_a_kernel_that_returns_arrays_must_say_so():
    @kernel
    def first_half(a):
        return 0, a[: len(a) // 2]

    with pytest.raises(TypeError, match="first_half returns arrays"):
        first_half(np.zeros(4))
