"""A step allocates nothing: its kernels nothing at all, Python nothing that grows with the rod."""

from __future__ import annotations

import tracemalloc
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher
from numba.core.runtime import _nrt_python, rtsys

import solver.methods.box as box
import solver.methods.one_axis as one_axis
import solver.methods.staggered as staggered
import solver.methods.time.radau.method as radau
import solver.physics.contact.search as search
import solver.physics.contact.self_contact as self_contact
from solver import Curve, DistributedLoad, End, Fluid, Numerics, PointLoad, Scene
from solver.kernels.kernel import allocating, kernel
from solver.kernels.scratch import scratch, scratch_like
from solver.run.simulation import Simulation
from tests.solver.physics.contact.test_self_contact import CONTACT, looped
from tests.solver.scenes import ARC, FIXED_STEPS, LENGTH, ROD

PUSHED = Curve.table([0.0, 1.0], [0.0, 1e-3], "smoothstep")
NONE = Curve.constant(0.0)
LOADED = Scene(
    rod=ROD, initial=ARC, start=End.clamp(), end=End.free(), t_end=10.0, output_interval=10.0, damping=0.1,
    gravity=(0.0, -9.81, 0.0), fluid=Fluid(1000.0, current=(0.1, 0.0, 0.0)), topology=False,
    points=(PointLoad(LENGTH, (PUSHED, NONE, NONE)), PointLoad(0.4 * LENGTH, moment=(NONE, NONE, PUSHED))),
    distributed=(DistributedLoad(force=(NONE, Curve.constant(1e-3), NONE), frame="material", schedule=PUSHED),),
)  # fmt: skip
"""All loads there are, growing in time, a fluid with a current, bending and torsion in space."""
PLANAR = Scene(rod=ROD, initial=ARC, start=End.clamp(), end=End.free(), t_end=10.0, output_interval=10.0)
IN_CONTACT = replace(looped(replace(CONTACT, k1=3e-6), 0.02), output_interval=1.0)
SCENES = {
    "box": (LOADED, Numerics("box", intervals=40, dt_max=0.02)),
    "box by shooting": (PLANAR, Numerics("box", "shooting", intervals=5, dt_max=0.1)),
    "box in contact": (IN_CONTACT, Numerics("box", intervals=40, dt_max=0.02)),
    "staggered": (LOADED, Numerics("staggered", intervals=40, dt_max=0.02)),
    "staggered in contact": (IN_CONTACT, Numerics("staggered", intervals=40, dt_max=0.02)),
    "about one axis": (PLANAR, Numerics("staggered", intervals=40, dt_max=0.02)),
}
STEPS = 40
"""In which the loop's strands come to press on each other."""
MODULES = (box, staggered, one_axis, radau, search, self_contact)


def scene(name: str, **numerics: int) -> Scene:
    given, chosen = SCENES[name]
    return replace(given, numerics=replace(chosen, increment_tolerance=FIXED_STEPS, **numerics))


def go(simulation: Simulation, steps: int) -> Simulation:
    """The simulation, so many steps on."""
    if not simulation.statistics.steps:
        simulation._first_frame()
    for _ in range(steps):
        assert simulation._next_frame(simulation._outputs[-1]) is None
    return simulation


def arrays_in(value: Any) -> int:
    """How many arrays an argument holds: each is wrapped anew when Python calls a kernel that allocates."""
    return sum(map(arrays_in, value)) if isinstance(value, tuple) else int(isinstance(value, np.ndarray))


@pytest.fixture
def counted() -> Iterator[Callable[[], int]]:
    """How often compiled code has allocated so far."""
    before = _nrt_python.memsys_stats_enabled()
    _nrt_python.memsys_enable_stats()
    yield lambda: rtsys.get_allocation_stats().alloc
    if not before:
        _nrt_python.memsys_disable_stats()


def watched(function: Any, counted: Callable[[], int], found: Counter[str]) -> Callable[..., Any]:
    """A kernel that adds to `found` what it allocates beyond its arguments' wrappers and its result."""

    def call(*arguments: Any) -> Any:
        before = counted()
        result = function(*arguments)
        wrapped = arrays_in(arguments) + arrays_in(result) if function.targetoptions["_nrt"] else 0
        found[function.__name__] += counted() - before - wrapped
        return result

    return call


@pytest.mark.parametrize("name", SCENES)
def test_kernels_of_a_step_allocate_nothing(name, counted, monkeypatch):
    go(Simulation(scene(name)), STEPS)  # all is compiled
    simulation, found = Simulation(scene(name)), Counter[str]()
    for module in MODULES:
        for called, function in list(vars(module).items()):
            if isinstance(function, Dispatcher):
                monkeypatch.setattr(module, called, watched(function, counted, found))
    go(simulation, STEPS)
    assert simulation._method.pressing() > 0 or "contact" not in name
    assert "step" in found
    assert {function: many for function, many in found.items() if many} == {}


def test_an_allocation_is_seen(counted):
    @allocating
    def forgetful(n):
        return np.zeros(n).sum()

    forgetful(3)
    found = Counter[str]()
    watched(forgetful, counted, found)(3)
    assert found["forgetful"] == 1


@pytest.mark.parametrize("name", ["box", "box in contact", "staggered", "staggered in contact", "about one axis"])
def test_python_allocates_nothing_that_grows_with_the_rod(name):
    intervals = 4000
    simulation = go(Simulation(scene(name, intervals=intervals)), 12)
    tracemalloc.start()
    try:
        go(simulation, 2)
        tracemalloc.reset_peak()
        before, _ = tracemalloc.get_traced_memory()
        go(simulation, 3)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak - before < 8 * intervals  # bytes: one number a node


def test_scratch_is_zero_at_each_turn_and_as_its_example():
    @kernel
    def sums(x, turns):
        total = 0.0 * x[0]
        for turn in range(turns):
            row, like = scratch((2, 3)), scratch_like(4, x)
            row[1, 2] += turn
            like[3] += x[0]
            total += like[3] + row.sum() - turn
        return total

    assert sums(np.array([1.0 + 2.0j]), 5) == 5.0 + 10.0j
    assert sums(np.array([3.0]), 2) == 6.0
