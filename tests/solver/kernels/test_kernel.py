"""What holds for every kernel."""

from __future__ import annotations

import threading

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
