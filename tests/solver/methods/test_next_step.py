"""The first guess of a step, by the last one: exact where motion is a cubic of time and forces are a parabola."""

from __future__ import annotations

import numpy as np
import pytest

from solver import End, Initial, Numerics, Scene
from solver.arrays import Array
from solver.methods.one_axis import OneAxisMethod
from solver.methods.staggered import StaggeredMethod
from solver.methods.time.radau import tableau
from solver.methods.time.radau.next_step import go_on
from tests.solver.scenes import ROD

LAST, DT = 0.3, 0.2
SCENE = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, gravity=(1.0, 0.0, 0.0),
              numerics=Numerics(method="staggered", intervals=6))  # fmt: skip


def motion(t: Array) -> Array:
    return 0.5 * t - 1.5 * t**2 + 2.0 * t**3


def force(t: Array) -> Array:
    return 1.0 - 2.0 * t + 5.0 * t**2


def along(values: Array, like: Array) -> Array:
    """An array as another, that has a value at each stage."""
    return np.asarray(np.broadcast_to(values.reshape(-1, *(1 for _ in like.shape[1:])), like.shape))


@pytest.mark.parametrize("kind", [StaggeredMethod, OneAxisMethod])
def test_a_guess_goes_on_as_the_last_step_went(kind: type[StaggeredMethod | OneAxisMethod]) -> None:
    method = kind.of(SCENE)
    assert method is not None
    last, stages, nodes = method._last, method.stages, LAST * tableau.C
    last.theta[:], last.shift[:] = along(motion(nodes), last.theta), along(motion(nodes), last.shift)
    last.F[:] = along(force(nodes), last.F)
    for name in method.state._fields:  # the rod was and is at rest: all rotation departs from a steady one
        getattr(method.trial, name)[:] = getattr(method.state, name)
    go_on(method._hand_over(), last, method.trial, method.state, LAST, DT)
    ahead = LAST + DT * tableau.C
    assert stages.theta == pytest.approx(along(motion(ahead), last.theta), abs=1e-14)
    assert stages.shift == pytest.approx(along(motion(ahead) - motion(np.array([LAST])), last.shift), abs=1e-14)
    assert stages.F == pytest.approx(along(force(ahead), last.F), abs=1e-14)
