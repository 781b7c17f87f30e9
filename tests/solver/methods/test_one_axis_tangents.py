"""The tangents about one axis are the derivatives of the residuals, for every term and kind of end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from solver import End, Fluid, Initial, Numerics, Scene
from solver.arrays import Array
from solver.methods.one_axis import OneAxisMethod
from solver.methods.space.one_axis.axis import axis_of
from solver.methods.space.one_axis.balances import balance, tangents_at
from solver.physics.ends import LOAD, LOAD_LAB, RATE, RATE_LAB
from solver.physics.loads.following import Record as Following
from solver.physics.loads.registry import LoadsAbout
from tests.solver.methods.as_in_runs import call
from tests.solver.scenes import ROD

N, STAGE, STEP = 5, 1, 1e-6
FORCE = 1e-3
LARGEST_ERROR = 1e-7
WATER = Fluid(1000.0, 1.0, 1.2, 0.3, (0.4, 0.0, 0.1))
KINDS = {
    "held": [[RATE, RATE, RATE]] * 2,
    "free": [[LOAD, LOAD, LOAD]] * 2,
    "mixed": [[RATE, LOAD, LOAD], [LOAD_LAB, RATE_LAB, RATE]],
}


@dataclass
class Problem:
    """One stage of a chain in an arbitrary state."""

    method: OneAxisMethod
    loads: LoadsAbout

    def residuals(self) -> Array:
        """Of rotation (N + 2), of translation (N, 2), and of the ends (2, 2), one after the other."""
        method, stages, found = self.method, self.method.stages, self.method.work.residuals
        stages.T[STAGE] = np.exp(1j * stages.phi[STAGE])
        call(balance, method.chain, self.loads, method.driven, stages, found, STAGE)
        return np.concatenate([found.rotation[STAGE], found.translation[STAGE].ravel(), found.ends[STAGE].ravel()])

    def changed(self, change: Callable[[float], None]) -> Array:
        """The derivative of the residuals along a change of the stage."""
        sides = []
        for step in (STEP, -2.0 * STEP):
            change(step)
            sides.append(self.residuals())
        change(STEP)
        return np.asarray((sides[0] - sides[1]) / (2.0 * STEP))


def problem(kinds: str, fluid: Fluid | None) -> Problem:
    random = np.random.default_rng(7)
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, fluid=fluid, damping=0.7,
                  numerics=Numerics(method="staggered", intervals=N))  # fmt: skip
    axis = axis_of(scene)
    assert axis is not None
    method = OneAxisMethod(scene, axis)
    stages, driven, following = method.stages, method.driven, np.zeros((3, N), complex)
    for array in (stages.phi, stages.omega, stages.alpha, stages.V, stages.A, stages.base):
        array[:] = random.normal(size=array.shape)
    for array in (stages.V, stages.A, stages.base):
        array += 1j * random.normal(size=array.shape)
    for array in (stages.F, driven.dead, following):
        array[:] = FORCE * (random.normal(size=array.shape) + 1j * random.normal(size=array.shape))
    driven.kinds[:] = KINDS[kinds]
    found = Problem(method, method.applied.records._replace(following=Following(True, following, np.zeros((3, N)))))
    found.residuals()
    call(tangents_at, method.chain, found.loads, driven, stages, STAGE, method.work.tangents)
    return found


def pairs(z: Array) -> Array:
    return np.stack([z.real, z.imag], axis=-1)


@pytest.mark.parametrize(("kinds", "fluid"), [(kinds, None) for kinds in KINDS] + [("mixed", WATER)])
def test_the_tangents_by_rotation_are_derivatives(kinds: str, fluid: Fluid | None) -> None:
    case = problem(kinds, fluid)
    chain, stages, tangents = case.method.chain, case.method.stages, case.method.work.tangents
    k = chain.elastic.K / chain.span
    loaded = [case.method.driven.kinds[side, 2] == LOAD for side in range(2)]
    for a in range(N + 2):
        def turn(step: float, a: int = a) -> None:
            stages.phi[STAGE, a] += step

        found, expected = case.changed(turn), np.zeros(N + 2 + 2 * N + 4)
        # by itself, and by its neighbours; the start's condition has the opposite sign in the system
        expected[a] = tangents.stiff[a]
        expected[a + 1 : min(a + 2, N + 2)] = -k[a : a + 1]
        expected[max(a - 1, 0) : a] = -k[max(a - 1, 0) : a]
        expected[0] *= -1.0 if loaded[0] else 0.0
        expected[N + 1] *= 1.0 if loaded[1] else 0.0
        if 0 < a <= N:
            expected[N + 2 : -4].reshape(N, 2)[a - 1] = -pairs(tangents.E[a - 1])
            compared = slice(0, -4)  # the last node's velocity turns with the last segment, which the system knows
        else:
            expected[-4:].reshape(2, 2)[0 if a == 0 else 1] = tangents.turn[0 if a == 0 else 1]
            compared = slice(None)
        assert np.abs(found - expected)[compared].max() <= LARGEST_ERROR * max(1.0, np.abs(tangents.stiff).max())


@pytest.mark.parametrize("fluid", [None, WATER])
def test_the_tangents_by_rates_are_derivatives(fluid: Fluid | None) -> None:
    case = problem("free", fluid)
    chain, stages, tangents = case.method.chain, case.method.stages, case.method.work.tangents
    for array, blocks in ((stages.V, tangents.C), (stages.A, tangents.M)):
        for side, T in ((0, 1.0), (1, 1j)):

            def push(step: float, array: Array = array, T: complex = T) -> None:
                array[STAGE] += step * T

            found = case.changed(push)[N + 2 : -4].reshape(N, 2)
            assert np.abs(found - blocks[:, :, side]).max() <= LARGEST_ERROR * np.abs(blocks).max()
    for rates, expected in ((stages.omega, tangents.spin), (stages.alpha, chain.h * chain.inertia)):
        def spin(step: float, rates: Array = rates) -> None:
            rates[STAGE] += step

        assert np.abs(case.changed(spin)[1 : N + 1] - expected).max() <= LARGEST_ERROR * np.abs(expected).max()
