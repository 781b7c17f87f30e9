"""What holds for every kernel."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np

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


WRITTEN = """
import numpy as np
from typing import NamedTuple
from solver.kernels.handed import Handed
class {name}(NamedTuple):
    values: np.ndarray
Handed.over({name}(np.zeros(2)))
"""


def test_records_of_others_stand_in_no_cache(tmp_path):
    for name in ("mine", "theirs"):
        (tmp_path / f"{name}.py").write_text(WRITTEN.format(name=name.title()))
        environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kernels"), "HOCKLE_COMPILES": "1"}
        environment["PYTHONPATH"] = f"{tmp_path}{os.pathsep}{Path(__file__).parents[3]}"
        subprocess.run([sys.executable, "-c", f"import {name}"], env=environment, check=True)
        (tmp_path / f"{name}.py").unlink()
