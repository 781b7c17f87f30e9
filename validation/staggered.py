"""The staggered method by itself, and against the box method, with which it shares no discretization.

What it conserves by construction (Tw + Wr = Lk, in free flight momentum and angular momentum), its energy balance, the
paper's scene to the reference's tolerances, and that both methods find the same.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from solver import Frame, Numerics, simulate
from solver.arrays import Array
from solver.methods.staggered import StaggeredMethod
from validation.free_flight import throw
from validation.goyal import FINE, REFERENCE, at, mismatch, run
from validation.row import Row, against, at_most

CONTACT_AT = 28.5
"""s; before it nothing touches."""


@cache
def frames_of(intervals: int) -> tuple[Frame, ...]:
    """The paper's scene to 34 s."""
    return run(numerics__method="staggered", numerics__intervals=intervals, numerics__dt_max=0.1,
               numerics__increment_tolerance=1e-3, t_end=34.0)  # fmt: skip


def imbalance(frames: tuple[Frame, ...], since: float, until: float) -> float:
    """The largest energy balance relative to what the ends have put in by then."""
    return max(abs(f.energy_balance) / abs(f.work_ends) for f in frames if since <= f.t <= until)


def goyal_rows() -> list[Row]:
    """Exactness, balance, and agreement with the reference and with the box method."""
    frames = frames_of(400)
    box = run(**{key.replace(".", "__"): value for key, value in FINE.items()})
    table = [
        at_most("staggered goyal |Tw+Wr-Lk| before contact", mismatch(frames, CONTACT_AT), 1e-8),
        at_most("staggered goyal |Tw+Wr-Lk| to 34 s", mismatch(frames, 34.0), 1e-6),
        at_most("staggered goyal energy balance of the input, before contact", imbalance(frames, 1, CONTACT_AT), 1e-5),
        at_most("staggered goyal energy balance of the input, to 34 s", imbalance(frames, CONTACT_AT, 34), 2e-3),
    ]
    for t, aim in ((25, 5e-4), (32, 5e-3)):
        table.append(against(f"both methods, goyal Wr at {t} s", at(frames, t).Wr, at(box, t).Wr, aim))
    for t, aim in ((25, 1e-3), (32, 1e-2), (34, 2e-2)):
        value = REFERENCE["values"]["Wr"][str(t)]
        table.append(against(f"staggered goyal Wr at {t} s", at(frames, t).Wr, value, aim))
        better = at(frames, t).Wr + (at(frames, t).Wr - at(frames_of(200), t).Wr) / 3.0
        table.append(against(f"staggered goyal Wr at {t} s, from N = 200 and 400", better, value, aim))
    return table


def momenta(method: StaggeredMethod) -> tuple[Array, Array]:
    """Momentum and angular momentum of the segments, lab."""
    (place, velocity, _), chain = method._centres, method.chain
    spin = np.einsum("jkm,jm->jk", method._R[1:-1], chain.inertia * method.state.omega[1:-1])
    momentum = chain.mass[:, None] * velocity
    return chain.h * momentum.sum(axis=0), chain.h * (np.cross(place, momentum) + spin).sum(axis=0)


def flight_rows() -> list[Row]:
    """The free flight of the box method's scene: the largest changes, relative to the vectors' lengths."""
    numerics = Numerics(method="staggered", intervals=100, dt_max=0.05, increment_tolerance=3e-6)
    scene = replace(throw(100, 1.25e-3), numerics=numerics)
    simulation = simulate(scene)
    method = simulation._method
    assert isinstance(method, StaggeredMethod)
    series = [momenta(method) for _ in simulation]
    P, H = (np.array(vectors) for vectors in zip(*series, strict=True))
    lost = [float(np.linalg.norm(x - x[0], axis=1).max() / np.linalg.norm(x[0])) for x in (P, H)]
    return [
        at_most("staggered free flight 10 s, momentum", lost[0], 1e-10),
        at_most("staggered free flight 10 s, angular momentum", lost[1], 5e-7),
    ]


def rows() -> list[Row]:
    """All of it."""
    return goyal_rows() + flight_rows()
