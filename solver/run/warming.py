"""Kernels compiled, or loaded from the cache, before the clock of a run starts."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from operator import itemgetter

import numpy as np

from solver.kernels.kernel import compile_apart
from solver.measures.holonomy import swept
from solver.measures.topology import NO_RAYS, tangents_of_ends, writhe_of_rod, writhe_shares
from solver.methods.registry import METHODS, discretized
from solver.scene.contact import Contact
from solver.scene.ends import End
from solver.scene.fluid import Fluid
from solver.scene.initial import Initial
from solver.scene.numerics import Numerics
from solver.scene.rod import Rod
from solver.scene.scene import Scene

LEAVES_ITS_PLANE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 2.0, 2.0]])
"""A centreline that has a writhe."""


def warm(*methods: str) -> None:
    """Load every kernel of some methods, or of all, from the cache, after other processes have compiled, side by side,
    what is not there; once."""
    kinds = [(method, kind.touches) for method in methods or METHODS for kind in METHODS[method]]
    longest_first = sorted(kinds, key=itemgetter(1), reverse=True)  # with contact
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda kind: compile_for(*kind), longest_first))
    for method, touching in kinds:
        load(method, touching)


@cache
def load(method: str, touching: bool, linear_solver: str = Numerics.linear_solver, wide: bool = False) -> None:
    """Load the kernels of the class that takes scenes which can touch themselves, or which cannot.

    `linear_solver` of the box method; `wide`: with auxiliary derivatives along s, rho_inf_space < 1.
    """
    compile_for(method, touching, linear_solver, wide)
    exercise(method, touching, linear_solver, wide)


def compile_for(method: str, touching: bool, linear_solver: str = Numerics.linear_solver, wide: bool = False) -> None:
    """Have another process compile those kernels, if nobody has."""
    arguments = (method, touching, linear_solver, wide)
    parts = [method, "touching" * touching, linear_solver * (linear_solver != Numerics.linear_solver), "wide" * wide]
    compile_apart("-".join(filter(None, parts)), f"from solver.run.warming import exercise; exercise(*{arguments!r})")


def exercise(method: str, touching: bool, linear_solver: str = Numerics.linear_solver, wide: bool = False) -> None:
    """Call a method's kernels by two steps of a tiny scene that can, or cannot, touch itself."""
    contact = Contact(k1=1e-7, k2=3.0, k3=1e-6, k4=1.0, aperture=1.0, cutoff=0.1, skip=0.3, spacing=0.05)
    numerics = Numerics(method=method, linear_solver=linear_solver, intervals=4, dt_max=1e-3,  # type: ignore[arg-type]
                        rho_inf_space=0.5 if wide else 1.0)  # fmt: skip
    scene = Scene(
        rod=Rod.circular(1.0, 0.01, 1e7, 5e6, 1500.0), initial=Initial.straight(), start=End.clamp(), end=End.free(),
        t_end=1e-3, output_interval=1e-3, fluid=Fluid(1000.0), numerics=numerics, contact=contact if touching else None,
    )  # fmt: skip
    moving, dt = discretized(scene), 1e-6
    for t in (0.0, dt):
        moving.try_step(t, dt, consistent=True)
        moving.relative_increment(dt)
        moving.strain(), moving.refusal(), moving.turn()
        moving.take_step(t, dt)
    fields = moving.fields()
    moving.energies(), moving.twist(), moving.smallest_gap()
    writhe_of_rod(LEAVES_ITS_PLANE, fields.orientation)
    for tangents in (tangents_of_ends(fields.orientation), NO_RAYS):
        writhe_shares(LEAVES_ITS_PLANE, tangents)
    swept(fields.orientation, fields.orientation, 0.0)
    moving.compile()
